"""Where almost every orbit ends: Morse sets that hold one attracting cycle, and those that hold saddles only.

Boxes that lie together are held by one rectangle, a *cluster*; between clusters walks lead as between their boxes. An
orbit is in one Morse set from some bounce on, so it stays in clusters from then on, and in one strongly connected
component of their graph. Over a whole cluster, whose landings lie on one component of the table and less than a turn
apart, the derivative is enclosed. The difference of two points of a cluster is taken to that of their images by a mean
of derivatives along the segment between them, which lies in the cluster; so two orbits that visit the same clusters
are compared as if the map were linear.

*Sink*: each cluster has one successor, and there are vectors `v > 0` of two entries, one to a cluster, with
`|M|*v <= q*v'` and `q < 1` for the absolute values of the derivative's entries over the cluster of `v`, where `v'` is
that of its successor. Then two orbits that visit the same clusters approach each other like `q**n`. If a cycle visits
all clusters, once in a round, every orbit that stays converges to it.

*Saddle*: each cluster has a cone of slopes `dphi/dtheta`, that the derivative takes into the cones of its successors,
and vectors in it grow by `growth > 0` at least, in `|dtheta|`. Two points on one horizontal segment, which visit the
same clusters for `n` bounces, part by the product of the factors, and stay within the width of a cluster. So what
stays for `n` bounces, of the segment, is no longer than the width times the sum of the products of `1/growth` over all
walks of `n` clusters. If these sums tend to 0, the points that stay for ever have measure 0 on each horizontal segment,
hence in the plane (Fubini).

For `lam > 0` the map is a diffeomorphism wherever it is smooth: its determinant is not 0. (Of a law other than the
paper's its slope is enclosed over all incidence angles and places; it must keep its sign.) So what comes to such a set,
or to a join, after some number of bounces has measure 0 too. Therefore *almost every orbit converges to the cycles of
the sinks*, when every Morse set is part of one or the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import Slopes, matrix
from verification.proofs.global_dynamics.graph import Cells, Grid, Mask, Transitions, refined
from verification.proofs.global_dynamics.images import PinballImages, invertible
from verification.proofs.global_dynamics.regions import carried

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Point = tuple[int, float, float]  # component, theta, phi
ROUNDS = 400  # of power iterations, and of cones that grow
SLACK = 1e-9  # more than a dozen roundings of doubles, relatively
CUT = 48, 4  # parts of a rectangle along theta and along phi, over each of which the derivative is enclosed
WIDENED = 1.02  # a cone that has grown, so that the next rounds find it large enough
NEAR = 3  # cells by which boxes are widened before those that touch count as one cluster
TURN = 6.28  # below a whole turn
WALKS = 64  # bounces over which walks of clusters are summed


@dataclass(frozen=True)
class Cluster:
    """What is proved of one strongly connected component of clusters: rectangles, and the map's factor there.

    A sink contracts by `factor` a bounce at least; of a saddle the points that stay `WALKS` bounces have at most the
    share `factor`. None where neither is proved.
    """

    boxes: Boxes
    sink: bool
    factor: float | None


def clusters(
    map: PinballImages, graph: Transitions, near: int = NEAR, among: Mask | None = None
) -> list[Cluster] | None:
    """The components of clusters that hold every box where orbits may return, each with what is proved of it.

    Where some vertices `among` them are given, these alone: no orbit stays in them that they do not hold. Boxes at most
    `2*near` cells apart are held by one cluster. None where a box is lost, or where a cluster may land
    on both sides of a join.
    """
    recurrent = graph.recurrent if among is None else among
    if graph.recurrent[-1] and np.any(graph.edges.indices[: graph.edges.indptr[-2]] == graph.count):
        return None  # some box is lost, and orbits may do anything
    cells = graph.chosen(recurrent)
    if not cells.chart.size:
        return []  # no orbit stays for ever
    if not graph.complete(recurrent):
        return None  # orbits may walk where these edges do not show it
    names = _named(graph, cells, near)
    chosen = recurrent[:-1] & graph.leaf
    inner = graph.edges[:-1, :-1][chosen][:, chosen].tocoo()
    count = int(names.max()) + 1
    walks = csr_matrix((np.ones(inner.nnz, dtype=bool), (names[inner.row], names[inner.col])), shape=(count, count))
    walks.sum_duplicates()
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
            continue  # passed once
        on = np.isin(source, own)
        some = Slopes(*(BallArray(*(np.broadcast_to(x, source.shape)[on] for x in (s.m, s.r))) for s in slopes))
        where = np.searchsorted(own, source[on])
        held = boxes.chosen(own)
        single = bool(np.all(np.diff(inside.indptr) == 1))
        shrinks = _contraction(some, where, inside) if single else np.inf
        if shrinks < 1:
            parts.append(Cluster(held, True, shrinks))
        else:
            parts.append(Cluster(held, False, _staying(some, where, inside)))
    return parts


def _named(graph: Transitions, cells: Cells, near: int) -> Indices:
    """The number of the cluster of each box."""
    member = graph.grid.painted(cells, np.ones(cells.chart.size, dtype=bool)).astype(bool)
    labels, count = np.zeros(member.shape, dtype=np.int64), 0
    for chart, mask in enumerate(member):
        wide = binary_dilation(mask, np.ones((3, 3)), near) if near else mask
        found, more = label(wide, np.ones((3, 3)))
        labels[chart] = np.where(found > 0, found + count, 0)
        count += more
    names = labels[cells.chart, cells.column, cells.row] - 1
    return np.unique(names, return_inverse=True)[1].astype(np.int64)


def _rectangles(graph: Transitions, cells: Cells, names: Indices, count: int) -> Boxes:
    """The least rectangle about each cluster."""
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
    """The greatest entry of each cluster."""
    found = np.full(count, -np.inf)
    np.maximum.at(found, source, ends)
    return found


def _contraction(s: Slopes, where: Indices, walks: csr_matrix) -> float:
    """The least `q` found with `|M|*v <= q*v'` along all walks; `where` is the cluster of each entry."""
    (a, b), (c, d) = matrix(s)
    size = np.zeros((4, walks.shape[0]))
    for entry, x in zip(size, (a, b, c, d), strict=True):
        np.maximum.at(entry, where, np.where(np.isfinite(x.r), x.magnitude(), np.inf))
    if not np.all(np.isfinite(size)):
        return np.inf
    size = size.reshape(2, 2, -1) * (1 + SLACK) + 1e-300
    vectors = _vectors(size, walks.indices)
    moved = np.einsum("ijk,jk->ik", size, vectors)
    return float(np.max(moved / vectors[:, walks.indices])) * (1 + SLACK)


def _vectors(size: Array, target: Indices) -> Array:
    """Positive vectors of clusters that their matrices, by power iterations, nearly keep: whichever they are."""
    vectors = np.ones((2, size.shape[2]))
    for _ in range(ROUNDS):
        image = np.zeros_like(vectors)
        moved = np.einsum("ijk,jk->ik", size, vectors)
        np.maximum.at(image.T, target, moved.T)
        vectors = vectors + image
        vectors /= vectors.max()
    return vectors


def _staying(s: Slopes, where: Indices, walks: csr_matrix) -> float | None:
    """The greatest sum of the inverse growths over walks of `WALKS` clusters; None where no cones are found."""
    count = walks.shape[0]
    source = np.repeat(np.arange(count), np.diff(walks.indptr))
    cones = np.zeros(count), np.zeros(count)
    for _ in range(ROUNDS):
        slope = hull(cones[0][where], cones[1][where])
        with np.errstate(all="ignore"):
            stretch, image = carried(s, slope)
        sign = np.sign(stretch.m)
        one = sign == sign[np.searchsorted(where, where)]
        if not np.all(one & (np.abs(stretch.m) > stretch.r) & np.isfinite(stretch.r) & np.isfinite(image.r)):
            return None
        least, ends = np.full(count, np.inf), (np.full(count, np.inf), np.full(count, -np.inf))
        np.minimum.at(least, where, (np.abs(stretch.m) - stretch.r) * (1 - SLACK))
        np.minimum.at(ends[0], where, image.lower())
        np.maximum.at(ends[1], where, image.upper())
        low, high = cones[0].copy(), cones[1].copy()
        np.minimum.at(low, walks.indices, ends[0][source])
        np.maximum.at(high, walks.indices, ends[1][source])
        if np.array_equal(low, cones[0]) and np.array_equal(high, cones[1]):
            weights = csr_matrix((1 / least[source], walks.indices, walks.indptr), shape=walks.shape)
            sums = np.ones(count)
            for _ in range(WALKS):
                sums = weights @ sums * (1 + SLACK)
            return float(sums.max())
        more = (high - low) * (WIDENED - 1)
        cones = low - more * (low < cones[0]), high + more * (high > cones[1])
    return None


@dataclass(frozen=True)
class Fate:
    """The statement that almost every orbit of a scene converges to one of some cycles, for `0 < lam` in a range.

    `cycles` are phase points `(component, theta, phi)`, bounce by bounce, which are known to be cycles throughout the
    range. The grid has `columns` by `rows` cells, in blocks of `coarsest` where orbits do not return.

    >>> horizontal = ((0, 0.0, 0.0), (1, 0.0, 0.0))
    >>> low = Fate(Scene("cuspless"), (Fraction(0), Fraction(1, 100)), (1024, 16), 4, (horizontal,))
    >>> set(low.checks.values())
    {True}
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    grid: tuple[int, int]
    coarsest: int
    cycles: tuple[tuple[Point, ...], ...]

    @cached_property
    def map(self) -> PinballImages:
        """The map, over all of the range at once; `ValueError` unless the table is convex."""
        return PinballImages(self.scene, self.lam)

    @cached_property
    def graph(self) -> Transitions:
        """The graph of boxes, finest where orbits may return."""
        return refined(self.map, Grid(self.map.charts, *self.grid), self.coarsest)

    @cached_property
    def parts(self) -> list[Cluster] | None:
        """The components of clusters, over all of the range at once."""
        return clusters(self.map, self.graph) if invertible(self.map) else None

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item: `returning`, that boxes hold all that returns; None where nothing is."""
        checks: dict[str, bool | None] = dict.fromkeys(("returning", "sinks", "saddles"))
        if self.parts is None:
            return checks
        sinks, others = ([part for part in self.parts if part.sink is wanted] for wanted in (True, False))
        found = [holding(self.parts, cycle) for cycle in self.cycles]
        each = len(sinks) == len(found) == len({id(part) for part in found}) and None not in found
        few = all(part.factor is not None and part.factor < 1 for part in others)
        return {"returning": True, "sinks": True if each else None, "saddles": True if few else None}

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())


def holding(parts: Sequence[Cluster], points: Sequence[Point]) -> Cluster | None:
    """The sink of whose clusters each holds exactly one of the points, `(component, theta, phi)`, in its interior.

    No cluster of another part may hold a point, even on its border: rectangles may overlap, and the boxes of the cycle
    be those of the other part.
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


def _held(part: Cluster, points: Sequence[Point], below: np.ufunc) -> NDArray[np.bool_]:
    """Which cluster, in columns, holds which point, in rows."""
    (left, right), (bottom, top) = part.boxes.x, part.boxes.y
    rows = [
        (part.boxes.chart == chart) & below(left, x) & below(x, right) & below(bottom, y) & below(y, top)
        for chart, x, y in points
    ]
    return np.array(rows)
