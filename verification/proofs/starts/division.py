"""Almost every orbit goes to one of two: a cycle of two bounces, or a trapping region in which no orbit is stable.

Boxes show where orbits may return. Those within the core of the cycle, or that a bounce takes there, are settled: the
core is proved to converge to it. So are those of the trapping region. Between them lie unstable cycles, and rings in
which boxes are too coarse to see orbits drift. What stays in the rest for ever has no area:

- *Saddles* are clusters of boxes, as in `fates`.
- A *ring* is the set `low <= |theta| <= high`, `|phi - slope*theta -+ offset| <= width` on the core's component, with
  the sign of `theta`: two convex parts, mirror images. Over it the derivative `D` of two bounces takes vectors whose
  slopes `dphi/dtheta` are within `cone` of `slope` to such vectors, with `|dtheta|` larger by `growth > 1` at least.
  Two points on a line of that slope that stay in the parts, the same at each round, part by this factor; the segment
  between them lies in the part, which is convex. So a line holds no more than two such points for each sequence of
  parts. A box of the ring is one of its right or its left part, and the round from either leads to one part only:
  there is one sequence, and what stays meets each line in one point. It has no area (Fubini).

For `lam > 0` the map is a diffeomorphism wherever it is smooth, so what comes to a set of no area, or to a join, has
none. All this is proved for every contraction of a range. Paper: section 5.2.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.fates import NEAR, clusters
from verification.proofs.global_dynamics.graph import Grid, Mask, MorseGraph, morse_graph, refined, walked
from verification.proofs.global_dynamics.images import PinballImages, invertible
from verification.proofs.global_dynamics.regions import expansion
from verification.proofs.starts.core import NEARLY, Core, attracts, derivative
from verification.proofs.starts.parallelograms import Parallelograms, carried

CHECKS = ("core", "region", "unstable", "ring", "saddles")
LONG = 200  # bounces of the walks whose least mean bounds the exponent
PARTS = 1500  # of a part of the ring, along theta


@dataclass(frozen=True)
class Ring:
    """Two convex parts of a component on either side of the cycle, as in the module's docstring."""

    low: float
    high: float
    slope: float
    offset: float
    width: float
    cone: float
    growth: float

    def __post_init__(self) -> None:
        if not (0 <= self.low < self.high and self.width > 0 and self.cone > 0):
            raise ValueError(f"{self}: accepted: 0 <= low < high, width > 0 and cone > 0")

    def part(self, chart: int, side: int) -> Boxes:
        """Boxes that cover one part."""
        edges = np.linspace(self.low, self.high, PARTS + 1)
        middle = self.slope * edges + self.offset
        low = np.minimum(middle[:-1], middle[1:]) - self.width
        high = np.maximum(middle[:-1], middle[1:]) + self.width
        x = (edges[:-1], edges[1:]) if side > 0 else (-edges[1:], -edges[:-1])
        y = (low, high) if side > 0 else (-high, -low)
        slack = 1e-12  # more than the rounding of an edge
        wide = [(a - slack, b + slack) for a, b in (x, y)]
        return Boxes(np.full(PARTS, chart), *wide)

    def sides(self, boxes: Boxes, chart: int) -> NDArray[np.int64]:
        """In which part each box lies: 1, -1, or 0 for neither."""
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
        """Does the derivative of two bounces keep the cone and stretch its vectors, over both parts?"""
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
class Division:
    """Almost every orbit converges to the cycle of `core`, or ends in a trapping region, for each `lam` of a range.

    The cycle has two bounces and is its own mirror image; the grid has `columns` by `rows` cells, in blocks of
    `coarsest` where orbits do not return. `rate` is a bound for the exponent of every orbit in the region.
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    grid: tuple[int, int]
    coarsest: int
    core: Core
    ring: Ring
    rate: float

    @cached_property
    def map(self) -> PinballImages:
        """The map, over all of the range at once; `ValueError` unless the table is convex."""
        return PinballImages(self.scene, self.lam)

    @cached_property
    def graph(self) -> MorseGraph:
        """Boxes of all of phase space."""
        return morse_graph(refined(self.map, Grid(self.map.charts, *self.grid), self.coarsest))

    @cached_property
    def settled(self) -> Mask:
        """The leaves where orbits may return that lie within the core or its gates, or that a bounce takes there."""
        graph = self.graph.transitions
        some = np.flatnonzero(graph.recurrent[:-1] & graph.leaf)
        boxes = graph.grid.boxes(graph.cells).chosen(some)
        sets = Parallelograms.about(boxes)
        source, images = carried(self.map, sets)
        home = np.bincount(source, minlength=some.size) > 0
        home[source[~self.core.enters(images)]] = False
        found = np.zeros(graph.count + 1, dtype=bool)
        found[some] = home | self.core.enters(sets)
        return found

    @cached_property
    def region(self) -> Mask | None:
        """The leaves reached from the attracting Morse sets beside the core; None where they are no trapping region."""
        graph = self.graph.transitions
        beside = [i for i in self.graph.attracting if not np.all(self.settled[self.graph.sets[i]])]
        if not beside:
            return None
        found = np.logical_or.reduce([self.graph.trapping(i) for i in beside])
        boxes = graph.grid.boxes(graph.chosen(found))
        at_cycle = [(low <= 0) & (high >= 0) for low, high in (boxes.x, boxes.y)]
        return None if found[-1] or np.any(at_cycle[0] & at_cycle[1]) else found

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        found: dict[str, bool | None] = dict.fromkeys(CHECKS)
        if not (invertible(self.map) and self.lam[0] > 0):
            return found
        found["core"] = all(attracts(self.map, self.core).values()) or None
        if self.region is None:
            return found
        found["region"] = True
        graph, returning = self.graph.transitions, self.graph.transitions.recurrent
        low = expansion(self.map, graph, self.region & returning, LONG, 1).low
        found["unstable"] = low >= self.rate > 0 or None
        rest = returning & ~self.region & ~self.settled
        around = self._around(rest)
        found["ring"] = self.ring.stretches(self.map, self.core.chart) or None
        others = clusters(self.map, graph, NEAR, rest & ~around)
        few = others is not None and all(not p.sink and p.factor is not None and p.factor < 1 for p in others)
        found["saddles"] = few or None
        return found

    def _around(self, rest: Mask) -> Mask:
        """The leaves of the rest whose orbits, while they stay, are at every other bounce in the ring.

        They are strongly connected parts of the rest in which each walk goes from one component to the other, with
        all boxes on the core's component in a part of the ring. A box leads, in two steps, to one part only.
        """
        graph = self.graph.transitions
        some = np.flatnonzero(rest[:-1])
        inner = walked(graph.edges[:-1, :-1][some][:, some].tocsr())
        count, labels = connected_components(inner, directed=True, connection="strong")
        boxes = graph.grid.boxes(graph.cells).chosen(some)
        sides, own = self.ring.sides(boxes, self.core.chart), boxes.chart == self.core.chart
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

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())
