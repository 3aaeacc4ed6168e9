"""Almost every orbit ends in one of two sets: a cycle of two bounces, or a trapping region without stable orbits.

Orbits return only in certain boxes. Some lie in the tube around the cycle, or are mapped there by a bounce, or belong
to the trapping region. The remaining boxes surround unstable cycles, or fill annuli in which the boxes are too coarse
to prove that orbits drift. The points that stay in the remaining boxes for ever have measure 0:

- *Saddles* are clusters of boxes around unstable cycles, as in `fates`.
- An *annulus* is the set `low <= |theta| <= high`, `|phi - slope*theta - sign(theta)*offset| <= width` on the tube's
  component: two convex parts, mirror images. Over it the derivative of two bounces maps vectors whose slopes
  `dphi/dtheta` are within `cone` of `slope` to such vectors, and stretches `|dtheta|` by `growth > 1` or more. The
  distance of two points on a line of that slope, whose orbits visit the same parts, grows by this factor in each round,
  since the segment between them lies in the convex part. Each box belongs to the right or the left part, and a round
  from either leads to one part only. So the sequence of parts is the same for all points that start in one part, and
  the points that stay meet each such line in at most one point. They have measure 0 (Fubini).

For `lam > 0` the map is a diffeomorphism wherever it is smooth, so the points that reach a set of measure 0, or a join,
have measure 0. The theorem holds for every contraction of a range. Paper: section 5.2.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse.csgraph import connected_components

from verification.arithmetic.arrays import BallArray, Indices, Mask, hull
from verification.proofs.global_dynamics.fates import NEAR, clusters
from verification.proofs.global_dynamics.images import PinballImages, RangeTheorem, invertible
from verification.proofs.global_dynamics.regions import expansion
from verification.proofs.starts.core import NEARLY, AbsorbingTube, attracts, derivative
from verification.proofs.starts.parallelograms import Parallelograms, push_forward
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import Grid, MorseGraph, morse_graph, refined
from verification.rigorous.theorem import hypothesis

LONG = 200  # the length of walks whose least mean bounds the exponent
PARTS = 1500  # boxes along theta that cover a part of the annulus


@dataclass(frozen=True)
class ExpandingAnnulus:
    """An annulus as in the module docstring: two convex parts, one on each side of the cycle."""

    low: float
    high: float
    slope: float
    offset: float
    width: float
    cone: float
    growth: float

    def __post_init__(self) -> None:
        if not (0 <= self.low < self.high and self.width > 0 and self.cone > 0):
            raise ValueError(f"{self} is out of range; accepted: 0 <= low < high, width > 0 and cone > 0")

    def part(self, chart: int, side: int) -> Boxes:
        """Boxes that cover the part of the annulus on one side (1 or -1)."""
        edges = np.linspace(self.low, self.high, PARTS + 1)
        middle = self.slope * edges + self.offset
        low = np.minimum(middle[:-1], middle[1:]) - self.width
        high = np.maximum(middle[:-1], middle[1:]) + self.width
        x = (edges[:-1], edges[1:]) if side > 0 else (-edges[1:], -edges[:-1])
        y = (low, high) if side > 0 else (-high, -low)
        slack = 1e-12  # above the rounding of an edge
        wide = [(a - slack, b + slack) for a, b in (x, y)]
        return Boxes(np.full(PARTS, chart), *wide)

    def sides(self, boxes: Boxes, chart: int) -> Indices:
        """For each box, the part of the annulus in which it lies: 1, -1, or 0 for neither."""
        found = np.zeros(boxes.chart.size, dtype=np.int64)
        for side in (1, -1):
            (left, right), (low, high) = (boxes.x, boxes.y) if side > 0 else (boxes.mirrored().x, boxes.mirrored().y)
            inside = (boxes.chart == chart) & (self.low <= left) & (right <= self.high)
            middles = self.slope * left + self.offset, self.slope * right + self.offset
            inside &= low >= np.maximum(*middles) - self.width * NEARLY
            inside &= high <= np.minimum(*middles) + self.width * NEARLY
            found[inside] = side
        return found

    def stretches(self, map: PinballImages, chart: int) -> bool:
        """True if the derivative of two bounces is proved to keep the cone and stretch its vectors on the annulus."""
        slopes = hull(self.slope - self.cone, self.slope + self.cone)
        for side in (1, -1):
            entries = derivative(map, self.part(chart, side))
            if entries is None:
                return False
            (a, b), (c, d) = entries
            first, second = a + b * slopes, c + d * slopes
            with np.errstate(all="ignore"):
                turned = second / first - BallArray(self.slope)
            least = np.abs(first.m) - first.r
            one = np.all(np.sign(first.m) == np.sign(first.m).flat[0])
            if not (one and np.all(least * NEARLY >= self.growth) and np.all(turned.magnitude() <= self.cone)):
                return False
        return self.growth > 1


@dataclass(frozen=True)
class Division(RangeTheorem):
    """Almost every orbit converges to the cycle of `tube`, or ends in a trapping region, for each `lam` of a range.

    The cycle has two bounces and is its own mirror image; `grid` is the numbers of columns and rows, and the graph
    starts with blocks of `coarsest` cells. `rate` is a lower bound for the exponent of every orbit in the region.
    """

    grid: tuple[int, int]
    coarsest: int
    tube: AbsorbingTube
    annulus: ExpandingAnnulus
    rate: float

    @cached_property
    def graph(self) -> MorseGraph:
        """The Morse graph of boxes that cover phase space."""
        return morse_graph(refined(self.map, Grid(self.map.charts, *self.grid), self.coarsest))

    @cached_property
    def entering(self) -> Mask:
        """The recurrent leaves that lie in the tube or an entry tube, or are mapped there by one bounce."""
        graph = self.graph.transitions
        some = np.flatnonzero(graph.recurrent[:-1] & graph.leaf)
        boxes = graph.grid.boxes(graph.cells).chosen(some)
        sets = Parallelograms.about(boxes)
        source, images = push_forward(self.map, sets)
        home = np.bincount(source, minlength=some.size) > 0
        home[source[~self.tube.enters(images)]] = False
        found = np.zeros(graph.count + 1, dtype=bool)
        found[some] = home | self.tube.enters(sets)
        return found

    @cached_property
    def region(self) -> Mask | None:
        """The leaves reached from attracting Morse sets that are not within `entering`; None if there are none, if the
        leaves form no trapping region, or if they may hold the cycle.
        """
        graph = self.graph.transitions
        beside = [i for i in self.graph.attracting if not np.all(self.entering[self.graph.sets[i]])]
        if not beside:
            return None
        found = np.logical_or.reduce([self.graph.trapping(i) for i in beside])
        boxes = graph.grid.boxes(graph.chosen(found))
        at_cycle = [(low <= 0) & (high >= 0) for low, high in (boxes.x, boxes.y)]
        return None if found[-1] or np.any(at_cycle[0] & at_cycle[1]) else found

    @hypothesis
    def core(self) -> bool:
        """All orbits in the tube converge to the cycle."""
        return all(attracts(self.map, self.tube).values())

    @hypothesis(name="region")
    def region_traps(self) -> bool:
        """The region is trapping, and does not contain the cycle."""
        return self.region is not None

    @hypothesis
    def unstable(self) -> bool:
        """Every orbit in the region has an exponent of at least `rate`, above 0."""
        graph = self.graph.transitions
        if self.region is None:
            return False
        return expansion(self.map, graph, self.region & graph.recurrent, LONG, 1).low >= self.rate > 0

    @hypothesis
    def ring(self) -> bool:
        """Two bounces keep the cone of the annulus, and stretch its vectors."""
        return self.annulus.stretches(self.map, self.tube.chart)

    @hypothesis
    def saddles(self) -> bool:
        """The other recurrent boxes belong to saddles; the map is a diffeomorphism where it is smooth."""
        if self.region is None or not (invertible(self.map) and self.lam[0] > 0):
            return False
        graph = self.graph.transitions
        rest = graph.recurrent & ~self.region & ~self.entering
        others = clusters(self.map, graph, NEAR, rest & ~self._around(rest))
        return others is not None and all(not p.sink and p.factor is not None and p.factor < 1 for p in others)

    def _around(self, rest: Mask) -> Mask:
        """The leaves of `rest` whose orbits, while they stay, are in the annulus at every other bounce.

        They form strongly connected parts of `rest` in which walks alternate between the components of the table. Each
        box on the core's component lies in one of the two parts of the annulus, and two steps from there lead to the
        opposite part.
        """
        graph = self.graph.transitions
        some = np.flatnonzero(rest[:-1])
        inner = graph.edges[:-1, :-1][some][:, some].tocsr()
        count, labels = connected_components(inner, directed=True, connection="strong")
        boxes = graph.grid.boxes(graph.cells).chosen(some)
        sides, own = self.annulus.sides(boxes, self.tube.chart), boxes.chart == self.tube.chart
        good = np.ones(count, dtype=bool)
        good[labels[own & (sides == 0)]] = False
        source, target = np.repeat(np.arange(some.size), np.diff(inner.indptr)), inner.indices
        together = labels[source] == labels[target]
        good[labels[source[together & (own[source] == own[target])]]] = False
        twice = (inner @ inner).tocoo()
        turned = (labels[twice.row] == labels[twice.col]) & own[twice.row]
        good[labels[twice.row[turned & (sides[twice.row] != -sides[twice.col])]]] = False
        found = np.zeros(graph.count + 1, dtype=bool)
        found[some] = good[labels]
        return found
