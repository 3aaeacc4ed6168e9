"""The limit of almost every orbit: each Morse set holds one attracting cycle, or else only saddles.

A *cluster* is a rectangle around boxes that lie close together; the graph of clusters has an edge where some of their
boxes have one. From some bounce on an orbit stays in one Morse set, hence in one strongly connected component of the
graph of clusters. The derivative is enclosed over each cluster, whose landings must lie on one component of the table
and less than a turn apart. The mean of the derivatives along the segment between two points of a cluster maps the
difference of the points to the difference of their images. So two orbits that visit the same clusters are compared as
if the map were linear.

*Sink*: each cluster has one successor, and there is a vector `v > 0` of two entries for each cluster, with `|M|*v <=
q*v'` and `q < 1` for the absolute values of the derivative's entries over the cluster of `v`, where `v'` is the vector
of its successor. Then two orbits that visit the same clusters approach each other like `q**n`. If a cycle visits each
cluster once in a round, every orbit that stays in the clusters converges to it.

*Saddle*: each cluster has a cone of slopes `dphi/dtheta` that the derivative maps into the cones of its successors, and
`|dtheta|` grows by a factor of at least `growth > 0` along its vectors. Take two points on a segment with a slope of
the cone that visit the same clusters for `n` bounces. Their distance grows by the product of the factors and stays
within the width of a cluster. So the points of the segment that stay for `n` bounces have a total length of at most the
width times the sum of the products of `1/growth` over all walks of `n` clusters. If these sums tend to 0, the points
that stay for ever have measure 0 on each segment of such a slope, hence in the plane (Fubini).

For `lam > 0` the map is a diffeomorphism wherever it is smooth: its determinant is not 0. (The slope of a law other
than the paper's is enclosed over all incidence angles and places; it must keep its sign.) So the points that reach such
a set, or a join, after some number of bounces have measure 0 too. Therefore *almost every orbit converges to the cycles
of the sinks*, when every Morse set is a sink or a saddle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import binary_dilation, label
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from numeric.backends import elementary
from verification.arithmetic.arrays import Array, BallArray, Indices, Mask, hull
from verification.proofs.global_dynamics.flights import Slopes, matrix
from verification.proofs.global_dynamics.images import PinballImages, RangeTheorem, invertible
from verification.proofs.global_dynamics.regions import Derivatives, factors, grown_cones, least_mean, push_slopes
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import Cells, Grid, Transitions, refined, sparse
from verification.rigorous.norms import shrinkage
from verification.rigorous.theorem import hypothesis

Point = tuple[int, float, float]  # component, theta, phi
ROUNDS = 400  # the most rounds in which boxes around a cycle grow
SLACK = 1e-9  # relative; more than the rounding of a dozen operations
CUT = 48, 4  # a rectangle is cut into so many parts along theta and phi to enclose the derivative
WIDENED = 1.02  # by which a box that grows is widened, so that fewer rounds are needed
NEAR = 3  # boxes are widened by so many cells, and those that touch then form one cluster
TURN = 6.28  # below a whole turn
CLOSE, LEAST = 1e-6, 1e-10  # the largest distance of given points from a cycle; half the width of the first boxes
WALKS = 64  # the length of walks over which stretches are summed


@dataclass(frozen=True)
class Cluster:
    """A strongly connected component of clusters: its rectangles, whether it is a `sink`, and proved bounds.

    In a sink a bounce multiplies distances by at most `factor < 1`, in some norm, so that it holds at most one cycle.
    In a saddle the points that stay for `WALKS` bounces make up at most the share `factor`, and vectors in the cones
    grow by `exp(growth)` or more per bounce in the mean of `WALKS`, so that each cycle is unstable where `growth > 0`.
    A bound is None if it is not proved.
    """

    boxes: Boxes
    sink: bool
    factor: float | None
    growth: float | None = None


def clusters(
    map: PinballImages, graph: Transitions, near: int = NEAR, among: Mask | None = None
) -> list[Cluster] | None:
    """The components of clusters in which orbits may return, with bounds for each; None if not proved.

    With a mask `among` only its vertices, and the orbits that stay in them, are considered. Boxes at most `2*near`
    cells apart form one cluster. None is returned if the image of a box is not enclosed, or if a cluster may land on
    both sides of a join.
    """
    recurrent = graph.recurrent if among is None else among
    if graph.recurrent[-1] and np.any(graph.edges.indices[: graph.edges.indptr[-2]] == graph.count):
        return None  # some box is lost
    cells = graph.chosen(recurrent)
    if not cells.chart.size:
        return []  # no orbit returns
    if not graph.complete(recurrent):
        return None  # an orbit may use edges of a refined block
    names = _named(graph, cells, near)
    chosen = recurrent[:-1] & graph.leaf
    inner = graph.edges[:-1, :-1][chosen][:, chosen].tocoo()
    count = int(names.max()) + 1
    walks = sparse(names[inner.row], names[inner.col], count)
    boxes = _rectangles(graph, cells, names, count)
    pieces, source = boxes.parts(*CUT)
    wide = np.max(boxes.x[1] - boxes.x[0])
    found = map.derivatives(pieces)
    if not found or not found[0][0].smooth or any(piece.on.size for piece, _ in found[1:]):
        return None
    (piece, slopes), parts = found[0], []
    together = piece.chart[:: CUT[0] * CUT[1]]
    if not np.array_equal(piece.on, np.arange(source.size)) or np.any(piece.chart != together[source]):
        return None  # a segment may land on both sides of a join
    if map.closed and np.any(_reach(piece.high, source, count) + _reach(-piece.low, source, count) + wide >= TURN):
        return None  # two points of a cluster may land in one cluster after different turns
    labels = connected_components(walks, directed=True, connection="strong")[1]
    for name in np.unique(labels):
        own = np.flatnonzero(labels == name)
        inside = walks[own][:, own].tocsr()
        if inside.nnz == 0:
            continue  # orbits pass it at most once
        on = np.isin(source, own)
        some = Slopes(*(BallArray(*(np.broadcast_to(x, source.shape)[on] for x in (s.m, s.r))) for s in slopes))
        where = np.searchsorted(own, source[on])
        held = boxes.chosen(own)
        single = bool(np.all(np.diff(inside.indptr) == 1))
        shrinks = _contraction(some, where, inside) if single else np.inf
        if shrinks < 1:
            parts.append(Cluster(held, True, shrinks))
        else:
            landed = Derivatives(where, piece.chart[on], some)
            parts.append(Cluster(held, False, *_staying(landed, inside, held.chart)))
    return parts


def _named(graph: Transitions, cells: Cells, near: int) -> Indices:
    """The index of the cluster to which each box belongs."""
    member = graph.grid.to_array(cells, np.ones(cells.chart.size, dtype=bool)).astype(bool)
    labels, count = np.zeros(member.shape, dtype=np.int64), 0
    for chart, mask in enumerate(member):
        wide = binary_dilation(mask, np.ones((3, 3)), near) if near else mask
        found, more = label(wide, np.ones((3, 3)))
        labels[chart] = np.where(found > 0, found + count, 0)
        count += more
    names = labels[cells.chart, cells.column, cells.row] - 1
    return np.unique(names, return_inverse=True)[1].astype(np.int64)


def _rectangles(graph: Transitions, cells: Cells, names: Indices, count: int) -> Boxes:
    """The smallest rectangle that holds the boxes of each cluster."""
    own = graph.grid.boxes(cells)
    chart = np.zeros(count, dtype=np.int64)
    chart[names] = own.chart
    sides = []
    for low, high in (own.x, own.y):
        bottom, top = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(bottom, names, low)
        np.maximum.at(top, names, high)
        sides.append((bottom, top))
    return Boxes(chart, *sides)


def _reach(ends: Array, source: Indices, count: int) -> Array:
    """The largest of the `ends` for each cluster; `source` is the cluster of each entry."""
    found = np.full(count, -np.inf)
    np.maximum.at(found, source, ends)
    return found


def _contraction(s: Slopes, where: Indices, walks: csr_matrix) -> float:
    """An upper bound of the contraction factor along all walks of a sink; `where` is the cluster of each entry."""
    size = np.zeros((4, walks.shape[0]))
    for entry, x in zip(size, (x for row in matrix(s) for x in row), strict=True):
        np.maximum.at(entry, where, np.where(np.isfinite(x.r), x.magnitude(), np.inf))
    return shrinkage(size.reshape(2, 2, -1), walks.indices)


def _staying(found: Derivatives, walks: csr_matrix, chart: Indices) -> tuple[float | None, float | None]:
    """The largest sum of inverse stretches over walks of `WALKS` clusters, and the least mean of log stretches."""
    cones, entered = grown_cones(found, walks, chart)
    with np.errstate(all="ignore"):
        sign = np.sign(push_slopes(found.slopes, hull(*cones)[found.source])[0].m)
    if entered is None or np.any(sign != sign[np.searchsorted(found.source, found.source)]):
        return None, None  # the stretch may vanish on average along a segment
    least, _ = factors(found, cones, chart.size)
    inverse = elementary.exp(-least)[np.repeat(np.arange(chart.size), np.diff(walks.indptr))] * (1 + SLACK)
    weights = csr_matrix((inverse, walks.indices, walks.indptr), shape=walks.shape)
    sums = np.ones(chart.size)
    for _ in range(WALKS):
        sums = weights @ sums * (1 + SLACK)
    return float(sums.max()), least_mean(least, walks, WALKS) - SLACK


@dataclass(frozen=True)
class RecurrentClusters(RangeTheorem):
    """A theorem about the clusters in which orbits return.

    The clusters come from a grid of `columns` by `rows` cells that starts with blocks of `coarsest` cells.
    """

    grid: tuple[int, int]
    coarsest: int

    @cached_property
    def graph(self) -> Transitions:
        """The transition graph, refined where orbits may return."""
        return refined(self.map, Grid(self.map.charts, *self.grid), self.coarsest)

    @cached_property
    def parts(self) -> list[Cluster] | None:
        """The components of clusters, for the whole range of contractions at once; None if they are not proved."""
        return clusters(self.map, self.graph)

    @property
    def saddle_parts(self) -> list[Cluster]:
        """The components of clusters that are not sinks; `ArithmeticError` if the components are not proved."""
        if self.parts is None:
            raise ArithmeticError("the components of the clusters are not proved to hold all orbits that return")
        return [part for part in self.parts if not part.sink]


@dataclass(frozen=True)
class FewAttractingCycles(RecurrentClusters):
    """All cycles but at most `count` are unstable, for each contraction of a range; each sink holds at most one.

    >>> from fractions import Fraction
    >>> from symbolic import Scene
    >>> low = FewAttractingCycles(Scene("cuspless"), (Fraction(0), Fraction(1, 100)), (1024, 16), 4, 1)
    >>> low.proved
    True
    """

    count: int

    @hypothesis
    def returning(self) -> bool:
        """Clusters hold all orbits that return, and each cluster lands on one side of each join."""
        return self.parts is not None

    @hypothesis
    def sinks(self) -> bool:
        """At most `count` of the components of clusters are sinks."""
        return self.parts is not None and sum(part.sink for part in self.parts) <= self.count

    @hypothesis
    def repelling(self) -> bool:
        """In the components that are not sinks, vectors of a cone grow."""
        return all((part.growth or 0) > 0 for part in self.saddle_parts)


@dataclass(frozen=True)
class AlmostEveryOrbit(RecurrentClusters):
    """Almost every orbit of a scene converges to one of the given cycles, for each `lam > 0` of a range.

    Each of the `cycles` is given by its phase points `(component, theta, phi)`. Boxes at most `2*near` cells apart form
    one cluster.

    >>> from fractions import Fraction
    >>> from symbolic import Scene
    >>> horizontal = ((0, 0.0, 0.0), (1, 0.0, 0.0))
    >>> low = AlmostEveryOrbit(Scene("cuspless"), (Fraction(0), Fraction(1, 100)), (1024, 16), 4, (horizontal,))
    >>> low.proved
    True
    """

    cycles: tuple[tuple[Point, ...], ...]
    near: int = NEAR

    @cached_property
    def staying(self) -> Mask:
        """The vertices of the graph in which orbits may stay: all that lie on closed walks."""
        return self.graph.recurrent

    @cached_property
    def parts(self) -> list[Cluster] | None:
        """The components of clusters; None if they are not proved or if the map may not be invertible."""
        return clusters(self.map, self.graph, self.near, self.staying) if invertible(self.map) else None

    @hypothesis
    def returning(self) -> bool:
        """Clusters hold all orbits that return, and the map is a diffeomorphism where it is smooth."""
        return self.parts is not None

    @hypothesis(name="cycles")
    def cycles_exist(self) -> bool:
        """There is a cycle within 1e-6 of the given points of each cycle, at each contraction of the range."""
        return all(exists(self.map, cycle) for cycle in self.cycles)

    @hypothesis
    def sinks(self) -> bool:
        """Each sink holds one of the cycles, and each cycle is in a sink."""
        found = [holding(self.parts or (), cycle) for cycle in self.cycles]
        count = sum(part.sink for part in self.parts or ())
        return self.parts is not None and count == len(found) == len({*map(id, found)}) and None not in found

    @hypothesis
    def saddles(self) -> bool:
        """In the components that are not sinks, the points that stay for ever have measure 0."""
        return all(part.factor is not None and part.factor < 1 for part in self.saddle_parts)


def exists(map: PinballImages, points: Sequence[Point]) -> bool:
    """True if a cycle is proved within `CLOSE` of the points, at each contraction of the map's range.

    A box around each point is mapped into the next box, so by Brouwer's theorem the first box holds a periodic point.
    """
    chart = np.array([each[0] for each in points], dtype=np.int64)
    middle = np.array([each[1:] for each in points], dtype=float).T
    size = np.full(middle.shape, LEAST)
    for _ in range(ROUNDS):
        low, high = middle - size, middle + size
        found = map.images(Boxes(chart, (low[0], high[0]), (low[1], high[1])))
        if found.lost.size or not np.array_equal(found.source, np.arange(chart.size)):
            return False
        if not np.array_equal(found.boxes.chart, np.roll(chart, -1)):
            return False
        gap = np.array([found.boxes.x, found.boxes.y]) - np.roll(middle, -1, axis=1)[:, None]  # coordinate, end, box
        if map.closed:
            gap[0] -= 2 * np.pi * np.round(gap[0, 0] / (2 * np.pi))
        reach = np.roll(np.max(np.abs(gap), axis=1), 1, axis=1)
        if np.all(reach + LEAST / 100 < size):  # above the rounding of the differences
            return bool(np.all(size < CLOSE))
        size = reach * WIDENED + LEAST
        if not np.all(size < CLOSE):
            return False
    return False


def holding(parts: Sequence[Cluster], points: Sequence[Point]) -> Cluster | None:
    """The sink in which every cluster holds exactly one of the points in its interior; or None.

    Points are `(component, theta, phi)`. No cluster of another component may hold a point, even on its border:
    rectangles may overlap, and the boxes around the cycle could belong to that other component.
    """
    for part in parts:
        if not part.sink:
            continue
        inside = _held(part, points, np.less)
        others = [_held(other, points, np.less_equal) for other in parts if other is not part]
        one = inside.shape[1] == len(points) and np.all(inside.sum(0) == 1) and np.all(inside.sum(1) == 1)
        if one and np.array_equal(inside, _held(part, points, np.less_equal)) and not any(map(np.any, others)):
            return part
    return None


def _held(part: Cluster, points: Sequence[Point], below: np.ufunc) -> Mask:
    """A matrix that says which cluster (column) holds which point (row); `below` is `np.less` or `np.less_equal`."""
    (left, right), (bottom, top) = part.boxes.x, part.boxes.y
    rows = [
        (part.boxes.chart == chart) & below(left, x) & below(x, right) & below(bottom, y) & below(y, top)
        for chart, x, y in points
    ]
    return np.array(rows)
