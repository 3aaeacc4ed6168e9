"""Boxes of a phase space by the hundred thousand, and maps that send each to boxes that hold its image.

A map is named by its charts, rectangles with two coordinates each; one of the plane is given by a formula in balls
and that of its derivative, and takes a box by the mean-value theorem.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic.arrays import BallArray, hull

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Boxes(NamedTuple):
    """Boxes in the charts of a phase space: the chart, and the ends of both coordinates, one entry for each box."""

    chart: Indices
    x: tuple[Array, Array]
    y: tuple[Array, Array]

    def chosen(self, which: Indices | NDArray[np.bool_] | slice) -> "Boxes":
        """Some of the boxes, by their numbers, by which they are, or a stretch of them."""
        return Boxes(self.chart[which], *((low[which], high[which]) for low, high in (self.x, self.y)))

    def parts(self, across: int, up: int) -> tuple["Boxes", Indices]:
        """The boxes cut into equal parts, and for each part the index of its box."""
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
        """The boxes of `(-theta, -phi)`."""
        return Boxes(self.chart, *((-high, -low) for low, high in (self.x, self.y)))


class Images(NamedTuple):
    """Rectangles: the box each belongs to, and where it lies; `lost` are boxes of which nothing is proved."""

    source: Indices
    boxes: Boxes
    lost: Indices


class Chart(NamedTuple):
    """A rectangle of phase space, closed; with `period` its first coordinate runs around once."""

    name: str
    x: tuple[float, float]
    y: tuple[float, float]
    period: bool = False
    kept: bool = False  # does the map keep to the charts? Then what juts out of one is rounding


class BoxMap(Protocol):
    """A map of a phase space in charts, with outer images."""

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts."""

    @property
    def label(self) -> str:
        """The map and its parameters, in words."""

    def images(self, boxes: Boxes) -> Images:
        """Rectangles that hold the image of each box, a part outside all charts included."""


@dataclass(frozen=True)
class PlaneImages:
    """A map of a rectangle of the plane, given by its formula in balls and by that of its derivative matrix.

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

    @property
    def charts(self) -> tuple[Chart, ...]:
        return (self.chart,)

    def images(self, boxes: Boxes) -> Images:
        centre, reach, whole = centred(boxes)
        (a, b), (c, d) = self.derivative(*whole)
        values = self.formula(*centre)
        x, y = (value + p * reach[0] + q * reach[1] for value, (p, q) in zip(values, ((a, b), (c, d)), strict=True))
        ends = x.lower(), x.upper(), y.lower(), y.upper()
        return collected([(np.arange(boxes.chart.size), boxes.chart, *ends)], boxes.chart.size)


def centred(boxes: Boxes) -> tuple[list[BallArray], list[BallArray], list[BallArray]]:
    """Midpoints, what the boxes hold beside them, and the boxes, for both coordinates."""
    whole = [hull(*boxes.x), hull(*boxes.y)]
    return [BallArray(b.m) for b in whole], [BallArray(0.0 * b.m, b.r) for b in whole], whole


Row = tuple[Indices, Indices, Array, Array, Array, Array]


def collected(rows: list[Row], count: int) -> Images:
    """Images of so many boxes, from rows of `source, chart, x low, x high, y low, y high`.

    A box without a row, or with an end that is not finite, is lost.
    """
    source, chart, *ends = (np.concatenate(column) for column in zip(*rows, strict=True))
    good = np.logical_and.reduce([np.isfinite(end) for end in ends])
    known = np.zeros(count, dtype=bool)
    known[source] = True
    known[source[~good]] = False
    keep = known[source]
    a, b, c, d = (end[keep] for end in ends)
    return Images(source[keep], Boxes(chart[keep], (a, b), (c, d)), np.flatnonzero(~known))
