"""Arrays of boxes of a phase space, and maps that send each box to boxes which hold its image.

A phase space consists of charts: rectangles with two coordinates each. A map of the plane is given by its formula and
that of its derivative, evaluated in balls; the image of a box follows by the mean-value theorem.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, WideOps, hull


class Boxes(NamedTuple):
    """Boxes of a phase space: an array of charts, and arrays of the low and high ends of both coordinates."""

    chart: Indices
    x: tuple[Array, Array]
    y: tuple[Array, Array]

    @classmethod
    def one(cls, x: tuple[float, float], y: tuple[float, float], *, chart: int = 0) -> "Boxes":
        """A single box, from the low and high ends of its sides."""
        return cls(np.array([chart]), *((np.array([low]), np.array([high])) for low, high in (x, y)))

    def chosen(self, which: Indices | Mask | slice) -> "Boxes":
        """Some of the boxes, by their indices, a mask or a slice."""
        return Boxes(self.chart[which], *((low[which], high[which]) for low, high in (self.x, self.y)))

    def parts(self, across: int, up: int) -> tuple["Boxes", Indices]:
        """The boxes cut into `across` by `up` equal parts, and for each part the index of its box."""
        source = np.repeat(np.arange(self.chart.size), across * up)
        sides = [np.tile(np.repeat(np.arange(across), up), self.chart.size), np.tile(np.arange(up), source.size // up)]
        ends = []
        for (low, high), step, count in zip((self.x, self.y), sides, (across, up), strict=True):
            low, high = low[source], high[source]
            size = np.abs(low) + np.abs(high)
            cut = [low + (high - low) * ((step + end) / count) for end in (0, 1)]
            ends.append((np.maximum(cut[0] - 1e-15 * size, low), np.minimum(cut[1] + 1e-15 * size, high)))
        return Boxes(self.chart[source], *ends), source

    def mirrored(self) -> "Boxes":
        """The images of the boxes under `(x, y) -> (-x, -y)`."""
        return Boxes(self.chart, *((-high, -low) for low, high in (self.x, self.y)))


class Images(NamedTuple):
    """Rectangles that hold images: `source` has indices of the mapped boxes, `lost` those of boxes without an image."""

    source: Indices
    boxes: Boxes
    lost: Indices

    @classmethod
    def exact(cls, boxes: Boxes) -> "Images":
        """The boxes themselves, as images under the identity."""
        return cls(np.arange(boxes.chart.size), boxes, np.zeros(0, dtype=np.int64))


class Chart(NamedTuple):
    """A closed rectangle of phase space; with `period`, its first coordinate is an angle, with its ends identified."""

    name: str
    x: tuple[float, float]
    y: tuple[float, float]
    period: bool = False
    kept: bool = False  # the map stays in the charts: an image beyond one is rounding


class BoxMap(Protocol):
    """A map of a phase space in charts, which encloses the images of boxes."""

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts of the phase space."""

    @property
    def label(self) -> str:
        """The map and its parameters, as a text for messages."""

    def images(self, boxes: Boxes) -> Images:
        """Rectangles that hold the image of each box, including any part outside of the charts."""


@dataclass(frozen=True)
class Turned:
    """A map of phase space with one periodic chart, modulo a rotation symmetry of order `turns`."""

    map: BoxMap
    turns: int

    @property
    def charts(self) -> tuple[Chart, ...]:
        """One periodic chart: the middle one of `turns` equal parts of the map's own chart."""
        (chart,) = self.map.charts
        middle, half = (chart.x[1] + chart.x[0]) / 2, (chart.x[1] - chart.x[0]) / 2 / self.turns
        return (chart._replace(x=(middle - half, middle + half)),)

    @property
    def label(self) -> str:
        """The map and the order of the symmetry, in words."""
        return f"{self.map.label}, up to {self.turns} turns"

    def images(self, boxes: Boxes) -> Images:
        """The images under the map itself; the grid reduces them modulo the rotation."""
        return self.map.images(boxes)


@dataclass(frozen=True)
class PlaneImages:
    """A map of a rectangle of the plane, from `formula(x, y)` and the matrix entries `derivative(x, y)`, evaluated in
    balls.

    The formula is continuous on the chart. The entries hold the derivative at every point of the box where there is
    one: over a box that meets a kink, the hull of the derivatives on both sides. A formula that jumps needs a `BoxMap`
    of its own. A float in a formula is a double, so 1.4 is not exactly 7/5; `from_text` reads exact numbers.

    >>> half = PlaneImages("halving", Chart("plane", (-1, 1), (-1, 1)), lambda x, y: (x / 2, y / 2),
    ...     lambda x, y: ((0.5, 0), (0, 0.5)))
    >>> box = Boxes(np.array([0]), (np.array([0.5]), np.array([1.0])), (np.array([0.0]), np.array([0.5])))
    >>> [round(float(end[0]), 9) for end in half.images(box).boxes.x]
    [0.25, 0.5]
    """

    label: str
    chart: Chart
    formula: Any
    derivative: Any

    @classmethod
    def from_text(cls, label: str, chart: Chart, x: str, y: str) -> "PlaneImages":
        """The map whose coordinates are two formulas in `x` and `y`; SymPy differentiates them.

        Numbers are exact: `1.4*x` and `7/5*x` are the same. `ValueError` for a text that is not a formula,
        or whose derivative is not one, as for `abs(x)`.

        >>> henon = PlaneImages.from_text("Henon", Chart("plane", (-2, 2), (-1, 1)), "1 - 1.4*x**2 + y", "0.3*x")
        >>> box = Boxes(np.array([0]), (np.array([1.0]), np.array([1.0])), (np.array([0.5]), np.array([0.5])))
        >>> [round(float(end[0]), 9) for end in (*henon.images(box).boxes.x, *henon.images(box).boxes.y)]
        [0.1, 0.1, 0.3, 0.3]
        """
        from sympy import Symbol

        from symbolic.expressions.text import kernel, load
        from symbolic.tables.formula import parse

        letters = Symbol("x", real=True), Symbol("y", real=True)
        values = [parse(text, {"x": letters[0], "y": letters[1]}) for text in (x, y)]
        slopes = [value.diff(letter) for value in values for letter in letters]
        formula, entries = (
            load(kernel("image", letters, {f"value{i}": each for i, each in enumerate(some)}), WideOps())
            for some in (values, slopes)
        )

        def derivative(x: BallArray, y: BallArray) -> tuple[tuple[BallArray, ...], ...]:
            found = entries(x, y)
            return found[:2], found[2:]

        return cls(label, chart, formula, derivative)

    @property
    def charts(self) -> tuple[Chart, ...]:
        return (self.chart,)

    def images(self, boxes: Boxes) -> Images:
        """The images by the mean-value theorem; lost if not finite, or if a box has a low end above its high end."""
        with np.errstate(all="ignore"):  # infinite and NaN entries count as not proved
            centre, reach, whole = centred(boxes)
            (a, b), (c, d) = self.derivative(*whole)
            values = self.formula(*centre)
            x, y = (value + p * reach[0] + q * reach[1] for value, (p, q) in zip(values, ((a, b), (c, d)), strict=True))
            sound = (boxes.x[0] <= boxes.x[1]) & (boxes.y[0] <= boxes.y[1])
            ends = np.where(sound, x.lower(), np.nan), x.upper(), y.lower(), y.upper()
        return collected([(np.arange(boxes.chart.size), boxes.chart, *ends)], boxes.chart.size)


def centred(boxes: Boxes) -> tuple[list[BallArray], list[BallArray], list[BallArray]]:
    """Midpoints of boxes, deviations from these as balls about 0, and whole boxes as balls, for both coordinates."""
    whole = [hull(*boxes.x), hull(*boxes.y)]
    return [BallArray(b.m) for b in whole], [BallArray(0.0 * b.m, b.r) for b in whole], whole


Row = tuple[Indices, Indices, Array, Array, Array, Array]


def collected(rows: list[Row], count: int) -> Images:
    """The images of `count` boxes, from rows of arrays `source, chart, x low, x high, y low, y high`.

    A box without a row, or with a row whose ends are not finite, is lost.
    """
    source, chart, *ends = (np.concatenate(column) for column in zip(*rows, strict=True))
    good = np.logical_and.reduce([np.isfinite(end) for end in ends])
    known = np.zeros(count, dtype=bool)
    known[source] = True
    known[source[~good]] = False
    keep = known[source]
    a, b, c, d = (end[keep] for end in ends)
    return Images(source[keep], Boxes(chart[keep], (a, b), (c, d)), np.flatnonzero(~known))
