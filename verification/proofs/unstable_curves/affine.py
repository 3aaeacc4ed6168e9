"""Maps `(x, y) -> (f(x) + y, b*x)` with a broken line `f`, a chart for each of its pieces: Lozi maps and their kin."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics import Boxes, Indices, Piece
from verification.proofs.global_dynamics.boxes import Chart, Images, centred, collected
from verification.proofs.global_dynamics.flights import Slopes


@dataclass(frozen=True)
class BrokenLine:
    """The map of a broken line through `knots`, as `(x, f(x))`, and of `b`, on `|y| <= height`.

    >>> lozi(1.7, 0.5).joins
    ((0, 1),)
    """

    knots: tuple[tuple[float, float], ...]
    b: float
    height: float

    @property
    def charts(self) -> tuple[Chart, ...]:
        """One for each piece of the line."""
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
        """The map and its parameters, in words."""
        return f"(x, y) -> (f(x) + y, {self.b}*x)"

    @property
    def homeomorphism(self) -> bool:
        """A broken line is continuous; and the second coordinate gives `x`, the first one then `y`."""
        return self.b != 0

    def _lines(self, chart: Indices) -> tuple[BallArray, BallArray, BallArray]:
        """The slope of each piece, and the point at which it starts."""
        knots = np.array(self.knots)
        (x0, y0), (x1, y1) = knots[:-1].T, knots[1:].T
        slope = (BallArray(y1) - BallArray(y0)) / (BallArray(x1) - BallArray(x0))
        return slope[chart], BallArray(x0[chart]), BallArray(y0[chart])

    def images(self, boxes: Boxes) -> Images:
        """The image of each box, cut where pieces meet; a box of which some part leaves the charts is lost."""
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

    def derivatives(self, boxes: Boxes) -> list[tuple[Piece, Slopes]]:
        """The derivative `((slope, 1), (b, 0))`, written as that of a flight, for each chart in which boxes land."""
        found = self.images(boxes)
        on, chart = found.source, found.boxes.chart
        slope = self._lines(boxes.chart[on])[0]
        one, b = BallArray(np.ones(on.size)), BallArray(np.full(on.size, self.b))
        piece = Piece(on, chart, *found.boxes.x, True)
        return [(piece, Slopes(slope, one, -(one + slope), one * 0.0, -b, -b))]


def lozi(a: float, b: float) -> BrokenLine:
    """Lozi's map `(x, y) -> (1 - a*abs(x) + y, b*x)`, for `abs(x) <= 2`."""
    return BrokenLine(((-2.0, 1 - 2 * a), (0.0, 1.0), (2.0, 1 - 2 * a)), b, 2.0 * abs(b))
