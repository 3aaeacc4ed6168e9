"""The edge of a basin above a barrier: one stable manifold, a smooth curve.

On one smooth closed convex curve, let a barrier be given: what comes below it stays below. Above it one cycle attracts
a disc, and there is a saddle; a round of either is one bounce and a turn of the table by `1/turns`. What is proved:

- all orbits that enter the disc, which lies above the barrier, converge to the cycle (`disc`); the saddle exists
  (`saddle`);
- in a rectangle about the saddle the difference of two points, in the coordinates of its two directions, either grows,
  or has the larger part along the contracted direction, and shrinks (`hyperbolic`);
- of the cells that cover what lies above the barrier and outside the disc, up to turns, those that meet a smaller
  rectangle about the saddle are one vertex of the graph of images, and lie in the first rectangle. No other vertex
  lies on a closed walk, and no closed walk of more than one step leads through this one (`alone`).

Let `S` be the starts whose orbits neither come below the barrier nor enter the disc. Such an orbit walks from cell to
cell for ever, so from some bounce on it is in the cells about the saddle; and what leaves these never returns. There
its difference to the saddle does not grow, hence shrinks: it converges to the saddle. And what converges to the saddle
is in `S`. So *`S` is the stable manifold of the saddle*, and it is closed, since the other starts are two open sets
that do not meet, the cycle being above the barrier: the basin, and what comes below the barrier.

*It is an embedded curve, as smooth as the map.* Let the orbit of `x` in `S` be in the interior of the cells about the
saddle from bounce `n` on. Points of `S` near `x` are there at bounce `n` too, and stay: they would never come back, and
not be in `S`. So near `x` the set `S` is the inverse image, by a diffeomorphism, of the local stable manifold.

*The basin's boundary is a union of whole components of `S`.* It lies in `S`. A short arc of `S` has two sides, each of
which lies in one of the two open sets: so all of it belongs to the boundary, or none. Nothing is said of what is below
the barrier. All of this is for `lam > 0` and each contraction of a range; it consists of strict inequalities, and holds
at all shapes and contractions near those where it is proved.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import acb, arb, fmpq
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from verification.arithmetic.arrays import BallArray
from verification.arithmetic.balls import balls, working
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.common_boundary import Disc, attracts, disc
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.graph import BLOCK, Indices, Mask, ranges, sparse, walked
from verification.proofs.manifolds.enclosed import TooWideError, complex_balls, enclosed_saddle
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Orbit

Array = NDArray[np.float64]
BITS = 128
COLUMNS, ROWS = 64, 32  # cells at first, of one turn's share and of the angles above 0
HALVINGS = 10
PARTS = 2  # each way, into which cells are cut before they are mapped
NEAR, WITHIN = 4e-4, 1e-3  # half of the sides of the rectangles about the saddle, in radians
CUT = 4  # parts each way of the larger one, over each of which the derivative is enclosed
PAD = 1e-6  # of a cell: more than the rounding of an index
SLOP = 1e-14  # radians: more than the rounding of an end
SLACK = 1e-9  # more than some dozen roundings of doubles, relatively
CHECKS = ("barrier", "disc", "saddle", "hyperbolic", "alone")


@dataclass(frozen=True)
class BasinEdge:
    """That the basin of a cycle above a barrier ends at the stable manifold of a saddle.

    `sink` is a phase point `(theta, phi)` of the cycle, attracting a disc of `radius`; a bounce turns it, and the
    `saddle`, by `1/turns` of a turn.
    """

    barrier: Barrier
    sink: tuple[float, float]
    saddle: Orbit
    radius: float

    def __post_init__(self) -> None:
        closure, turns = self.saddle.closure, self.barrier.turns
        if turns < 2 or closure.turn != 1 or closure.shift != (1, turns) or len(self.saddle.start) != 1:
            raise ValueError(f"edge: a round of the {self.saddle.name} is not one bounce and a turn of the table")

    @property
    def turn(self) -> float:
        """By which a bounce turns either cycle, in radians."""
        return 2 * np.pi / self.barrier.turns

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        found: dict[str, bool | None] = dict.fromkeys(CHECKS)
        found["barrier"] = self.barrier.heights is not None or None
        found["disc"] = (attracts(self.barrier.map, self.disc, self.turn) and self._disc_above()) or None
        if self.place is None or found["barrier"] is None:
            return found
        found["saddle"] = True
        found["hyperbolic"] = self._hyperbolic() or None
        found["alone"] = bool(np.all(self.barrier.above(self._about(NEAR))) and self._alone()) or None
        return found

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())

    @cached_property
    def disc(self) -> Disc:
        """About the sink."""
        return disc(self.barrier.map, self.sink, self.radius)

    @cached_property
    def place(self) -> tuple[float, float] | None:
        """The saddle's phase point, to much less than `NEAR`, for all contractions; None where it is not proved."""
        with working(BITS):
            low, high = (arb(fmpq(x.numerator, x.denominator)) for x in self.barrier.lam)
            map = Pinball(self.barrier.map.map.table, turn=self.barrier.turns)
            try:
                here = enclosed_saddle(self.saddle, map.over(complex_balls(BITS)), acb(low.union(high))).points[0].real
            except (TooWideError, ArithmeticError):
                return None
            after = here + 2 * arb.pi() / self.barrier.turns
            phi = map.over(balls(BITS)).angle(here, after)[0]
            close = here.rad() < NEAR / 4 and phi.rad() < NEAR / 4
            return (float(here.mid()), float(phi.mid())) if close else None

    def _disc_above(self) -> bool:
        """Does the disc lie above the barrier? Else its basin is among what comes below."""
        sides = zip(self.disc.centre, self.disc.rectangle, strict=True)
        about = Boxes(np.array([0]), *((np.array([c - half]), np.array([c + half])) for c, half in sides))
        return bool(np.all(self.barrier.above(about)))

    def _about(self, half: float) -> Boxes:
        assert self.place is not None
        return Boxes(np.array([0]), *((np.array([c - half]), np.array([c + half])) for c in self.place))

    def _hyperbolic(self) -> bool:
        """Over the larger rectangle: `|u'| > |u|` where `|u| >= |v|`, which stays so; `|v'| < |v|` where not."""
        parts, _ = self._about(WITHIN).parts(CUT, CUT)
        ((piece, slopes),) = self.barrier.map.derivatives(parts)
        if not np.array_equal(piece.on, np.arange(CUT * CUT)):
            return False
        entries = matrix(slopes)
        middle = np.array([[float(np.mean(x.m)) for x in row] for row in entries])
        values, vectors = np.linalg.eig(middle)
        if np.any(np.iscomplex(values)):  # their type is complex in any case since NumPy 2.5
            return False
        (a, b), (c, d) = vectors.real[:, np.argsort(-np.abs(values))]
        det = BallArray(a) * d - BallArray(b) * c
        back = (BallArray(d) / det, BallArray(-b) / det), (BallArray(-c) / det, BallArray(a) / det)
        along = [[row[0] * u + row[1] * v for u, v in ((a, c), (b, d))] for row in entries]
        (uu, uv), (vu, vv) = ([row[0] * along[0][j] + row[1] * along[1][j] for j in (0, 1)] for row in back)
        one_sign = bool(np.all(uu.positive()) or np.all(uu.negative()))  # means along segments do not cancel
        grown = np.min(np.abs(uu.m) - uu.r - uv.magnitude())
        shrunk = np.max(vu.magnitude() + vv.magnitude())
        far = np.max(entries[0][0].magnitude() + entries[0][1].magnitude()) * 2 * WITHIN
        return bool(one_sign and grown > 1 + SLACK and shrunk < 1 - SLACK and far < self.turn / 2)

    def _alone(self) -> bool:
        """Is the vertex of the cells about the saddle the only one on closed walks, and these are of one step?"""
        columns, rows = COLUMNS, ROWS
        column, row = (index.ravel() for index in np.indices((columns, rows)))
        for _ in range(HALVINGS):
            boxes = self._boxes(column, row, columns, rows)
            kept = ~(self.barrier.below(boxes) | self._absorbed(boxes))
            if np.any(self._meets(boxes) & ~kept):
                return False  # the saddle may lie below the barrier
            column, row, boxes = column[kept], row[kept], boxes.chosen(kept)
            edges = self._edges(column, row, boxes, columns, rows)
            if edges is None:
                return False
            near = self._meets(boxes)
            names = np.where(near, 0, np.cumsum(~near)).astype(np.int32)  # the cells about the saddle are one vertex
            graph = walked(sparse(names[edges[0]], names[edges[1]], int(names.max(initial=0)) + 1))
            label = connected_components(graph, directed=True, connection="strong")[1]
            recurrent = ((np.bincount(label)[label] > 1) | (graph.diagonal() > 0))[names]
            inner = self._inside(boxes.chosen(near))
            if not np.any(recurrent & ~near) and inner:
                return True
            cut = recurrent | near
            column, row = column[cut], row[cut]
            column = np.concatenate([2 * column + i for i in (0, 1, 0, 1)])
            row = np.concatenate([2 * row + j for j in (0, 0, 1, 1)])
            columns, rows = 2 * columns, 2 * rows
        return False

    def _boxes(self, column: Indices, row: Indices, columns: int, rows: int) -> Boxes:
        """The cells, rounded outwards; columns cover `-turn/2` to `turn/2`, rows 0 to the steepest exit."""
        wide, tall = self.turn / columns, self.barrier.map.top / rows
        left, bottom = np.asarray(column * wide - self.turn / 2, dtype=float), np.asarray(row * tall, dtype=float)
        x, y = (left - SLOP, left + (wide + SLOP)), (bottom - SLOP, bottom + (tall + SLOP))
        return Boxes(np.zeros_like(column), x, y)

    def _edges(
        self, column: Indices, row: Indices, boxes: Boxes, columns: int, rows: int
    ) -> tuple[NDArray[np.int32], NDArray[np.int32]] | None:
        """From each cell to those that its image meets, borders included; None where a landing is not proved."""
        wide, tall = self.turn / columns, self.barrier.map.top / rows
        keys = column * rows + row
        order = np.argsort(keys)
        keys, sources, targets = keys[order], [], []
        parts, owner = boxes.parts(PARTS, PARTS)
        for start in range(0, owner.size, BLOCK):
            block = np.arange(start, min(start + BLOCK, owner.size))
            found = self.barrier.map.images(parts.chosen(block))
            if found.lost.size:
                return None
            left, right = _cells(found.boxes.x, -self.turn / 2, wide)
            low, high = _cells(found.boxes.y, 0.0, tall)
            low, high = np.maximum(low, 0), np.minimum(high, rows - 1)
            across, up = np.minimum(right - left + 1, columns), np.maximum(high - low + 1, 0)
            each = np.repeat(np.arange(left.size), across)
            first = ranges(left, left + across) % columns * rows + low[each]
            met = ranges(first, first + up[each])
            at = np.minimum(np.searchsorted(keys, met), keys.size - 1)
            on = keys[at] == met
            sources.append(owner[block][found.source[np.repeat(each, up[each])[on]]])
            targets.append(order[at[on]])
        return np.concatenate(sources).astype(np.int32), np.concatenate(targets).astype(np.int32)

    def _absorbed(self, boxes: Boxes) -> Mask:
        """Which cells lie in the disc, or a turned copy? It is convex: their corners do."""
        (a, b), (c, d) = self.disc.inverse
        det, held = a * d - b * c, np.ones(boxes.chart.size, dtype=bool)
        for theta in boxes.x:
            for phi in boxes.y:
                x, y = self._beside(theta, self.disc.centre[0]), phi - self.disc.centre[1]
                held &= np.hypot((d * x - b * y) / det, (a * y - c * x) / det) < self.radius * (1 - SLACK)
        return held

    def _meets(self, boxes: Boxes) -> Mask:
        """Which cells meet the smaller rectangle about the saddle, or a turned copy?"""
        assert self.place is not None
        middles = [(low + high) / 2 for low, high in (boxes.x, boxes.y)]
        halves = [(high - low) / 2 for low, high in (boxes.x, boxes.y)]
        off = self._beside(middles[0], self.place[0]), middles[1] - self.place[1]
        return np.asarray((np.abs(off[0]) <= NEAR + halves[0]) & (np.abs(off[1]) <= NEAR + halves[1]))

    def _inside(self, boxes: Boxes) -> bool:
        """Do cells lie within the larger one?"""
        assert self.place is not None
        x = [np.abs(self._beside(end, self.place[0])) for end in boxes.x]
        y = [np.abs(end - self.place[1]) for end in boxes.y]
        return bool(boxes.chart.size and np.all(np.concatenate([*x, *y]) < WITHIN * (1 - SLACK)))

    def _beside(self, theta: Array, centre: float) -> Array:
        """How far angles are from one, up to turns of the table."""
        off = theta - centre
        return np.asarray(off - self.turn * np.rint(off / self.turn))


def _cells(ends: tuple[Array, Array], start: float, size: float) -> tuple[Indices, Indices]:
    """The first and the last of the cells that an interval meets, borders included."""
    first, last = (
        np.floor((end - start) / size + pad).astype(np.int64) for end, pad in zip(ends, (-PAD, PAD), strict=True)
    )
    return first, last
