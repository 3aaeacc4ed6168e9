"""Maps `(x, y) -> (f(x) + y, b*x)` with a piecewise linear `f` and one chart per piece, such as Lozi maps.

And statements on their attractors, and three charts that may be joined round.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.flights import LandingArcs, Slopes
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors
from verification.rigorous.boxes import Boxes, Chart, Images, Indices, centred, collected

CHARTS = tuple(
    Chart(name, ends, (-1.0, 1.0)) for name, ends in (("a", (-1.0, 0.0)), ("b", (3.0, 5.0)), ("c", (0.0, 1.0)))
)


@dataclass(frozen=True)
class BrokenLine:
    """The map on `|y| <= height` whose `f` is linear between the `knots` `(x, f(x))`, with the factor `b`.

    >>> lozi(1.7, 0.5).joins
    ((0, 1),)
    """

    knots: tuple[tuple[float, float], ...]
    b: float
    height: float

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts, one per linear piece."""
        ends = (-self.height, self.height)
        return tuple(
            Chart(f"piece {i}", (a, c), ends, kept=True) for i, ((a, _), (c, _)) in enumerate(pairwise(self.knots))
        )

    @property
    def joins(self) -> tuple[tuple[int, int], ...]:
        """Each piece ends where the next one starts."""
        return tuple((i, i + 1) for i in range(len(self.knots) - 2))

    @property
    def label(self) -> str:
        """The map and its parameters as text."""
        return f"(x, y) -> (f(x) + y, {self.b}*x)"

    @property
    def homeomorphism(self) -> bool:
        """True: `f` is continuous, and the image determines first `x`, by its second coordinate, and then `y`."""
        return self.b != 0

    def _lines(self, chart: Indices) -> tuple[BallArray, BallArray, BallArray]:
        """The slope of each piece, and the point `(x, f(x))` at which it starts."""
        knots = np.array(self.knots)
        (x0, y0), (x1, y1) = knots[:-1].T, knots[1:].T
        slope = (BallArray(y1) - BallArray(y0)) / (BallArray(x1) - BallArray(x0))
        return slope[chart], BallArray(x0[chart]), BallArray(y0[chart])

    def images(self, boxes: Boxes) -> Images:
        """The image of each box, cut at ends of charts; a box whose image leaves the charts is marked lost."""
        _, _, (x, y) = centred(boxes)
        slope, first, value = self._lines(boxes.chart)
        ends = value + slope * (x - first) + y, BallArray(self.b) * x
        low, high, (down, up) = ends[0].lower(), ends[0].upper(), (ends[1].lower(), ends[1].upper())
        edge, tall = (self.knots[0][0], self.knots[-1][0]), self.height * (1 + 1e-12)
        known = (low >= edge[0]) & (high <= edge[1]) & (down >= -tall) & (up <= tall)
        down, rows = np.where(known, down, np.nan), []
        for i, (left, right) in enumerate(pairwise(knot for knot, _ in self.knots)):
            on = np.flatnonzero(((high >= left) & (low <= right)) | ~known)
            rows.append((on, np.full(on.size, i), *np.clip((low[on], high[on]), left, right), down[on], up[on]))
        return collected(rows, boxes.chart.size)

    def derivatives(self, boxes: Boxes) -> list[tuple[LandingArcs, Slopes]]:
        """The derivative `((slope, 1), (b, 0))` on each box, as for a flight, for each chart that its image meets."""
        found = self.images(boxes)
        on, chart = found.source, found.boxes.chart
        slope = self._lines(boxes.chart[on])[0]
        one, b = BallArray(np.ones(on.size)), BallArray(np.full(on.size, self.b))
        piece = LandingArcs(on, chart, *found.boxes.x, True)
        return [(piece, Slopes(slope, one, -(one + slope), one * 0.0, -b, -b))]


def lozi(a: float, b: float) -> BrokenLine:
    """Lozi's map `(x, y) -> (1 - a*abs(x) + y, b*x)`, for `abs(x) <= 2`."""
    return BrokenLine(((-2.0, 1 - 2 * a), (0.0, 1.0), (2.0, 1 - 2 * a)), b, 2.0 * abs(b))


def at(chart, x, y) -> Boxes:
    """Points as boxes of width 0."""
    return Boxes(np.array(chart), (np.array(x),) * 2, (np.array(y),) * 2)


def about_the_fixed_point(a: float, b: float) -> NoTwoAttractors:
    """The statement for a Lozi map and the region grown from its right fixed point."""
    x = 1 / (1 + a - b)
    return NoTwoAttractors(lozi(a, b), 512, 512, at([1], [x], [b * x]), (1, x, b * x), 1, 0.1)


class Unfolded(BrokenLine):
    """A map that says of no join where it folds."""

    joins = ()
