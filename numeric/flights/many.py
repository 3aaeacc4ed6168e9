"""Tables of many sides and arcs that are not convex: the first hit by a grid of cells over the table.

The closed forms and the decisions are those of `numeric.flights.pieces`, but only the pieces in the cells that a flight
comes through are tried. The pieces left out cannot be hit first, so a landing is the same to the last bit as if all
pieces were tried. A short convex curve round the table, such as the walls round many discs, is tested first, because
its piece is found at once.
"""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.corners import (
    CIRCLE,
    ELLIPSE,
    FOCAL,
    LINE,
    MANY,
    PieceNumbers,
    Ray,
    chosen_mask,
    passing,
    span,
)
from numeric.flights.family import FAR, SLAP, Boundary, Landing
from numeric.flights.general import OVERLAP, UNSURE
from numeric.flights.pieces import Pieces

SOME = 32  # pieces, from which on it pays to find the first hit by a grid
PARTS = 64  # boxes round a piece


class Many(Pieces):
    """The flight on many sides and arcs: that of `Pieces`, with a grid that selects the few pieces to be tested."""

    path = "closed form on sides and arcs from a grid, first hit"
    width = 8

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        self.constants = self.numbers()
        self.outer = self.outer if len(self.outer) <= MANY else []
        spans = [span(piece) for piece in self.known]
        most = [max(map(abs, piece.middle)) for piece in self.known]
        self.size = max(float(base + slope * p) for (base, slope), p in zip(spans, most, strict=True))
        from numeric.flights.grid import laid

        inner = [j for j in range(len(self.known)) if j not in self.outer]
        boxes = [boxes_of(piece, ends) for piece, ends in zip(self.known, boundary.ends, strict=True)]
        corners = [
            (*piece.start, *self.known[after].start) for piece, after in zip(self.known, self.following, strict=True)
        ]
        numbers = [(*x.origin, *x.A, *x.B, x.D, x.radius, *x.middle, *x.half) for x in self.known]
        self.rows = [[float(x) for x in (*row, *ends)] for row, ends in zip(numbers, corners, strict=True)]
        lines = [[*self.rows[j][12:], float(j)] for j in inner]
        self.grid = laid(np.concatenate(boxes), [boxes[j] for j in inner], lines, self.size)
        self.inner = {kind: [self.kinds[j] == kind for j in range(len(self.known))] for kind in (LINE, CIRCLE, ELLIPSE)
                      if any(self.kinds[j] == kind for j in inner)}  # fmt: skip

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        many = len(boundary.ir.programs) >= SOME and not boundary.shape
        many = many and not any(name.startswith(FOCAL) for name, _ in boundary.ir.programs)
        return many and super().matches(boundary) and Pieces(boundary).halving is None

    @property
    def identity(self) -> str:
        return repr((super().identity, self.rows, self.grid))

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        if not ops.doubles:
            return super().fly(ops, shape, law, position, exit)
        component, p, q = position
        pieces, v, nought = self.pieces(ops, shape), (exit[0], exit[1]), ops.number(0.0)
        z0, d0 = self.point(ops, pieces, position), self.tangent(ops, shape, position)
        from numeric.flights.grid import met

        flight = Ray(ops, component, z0, v, plane.cross(d0, v), p, q, law == SLAP)
        far = ops.number(FAR) + nought * component
        best = [far, component]
        if self.outer:
            around = pieces[: len(self.outer)]
            t, *_, where = self._round(flight, around, self._sides(flight, [piece.start for piece in around]))
            best = [t, where]
        t, where, *passed = met(
            ops, self.grid, z0, v, [*best, far] if self.passed else best,
            lambda reached, line, best: self._tried(flight, reached, line, best),
        )  # fmt: skip
        best = [p, q, far]
        for kind in (LINE, CIRCLE, ELLIPSE):
            if kind in self.kinds:
                best = self._where(flight, kind, where, best)
        ends = self._sides(flight, self._row(ops, where)[6:])
        return self._landed(flight, shape, pieces, [t, *best, where], [*ends, *passed])

    def _where(self, flight: Ray[N, M], kind: str, where: N, best: list[N]) -> list[N]:
        """`p`, `q` and `v x d` (see `pieces`) of the landing on piece `where` if its kind is `kind`; else `best`."""
        ops, marked = flight.ops, [known == kind for known in self.kinds]
        if all(marked):
            return list(self._met(flight, self._at(ops, kind, where), where)[1:4])
        here = chosen_mask(ops, where, marked)

        def found() -> list[N]:
            new = self._met(flight, self._at(ops, kind, where), where)[1:4]
            return [ops.select(here, x, y) for x, y in zip(new, best, strict=True)]

        return list(ops.when(here, best, found))

    def _sides(self, flight: Ray[N, M], corners: Sequence[Pair[N]]) -> list[N]:
        """On which side of the line each corner lies: positive to the left, negative to the right."""
        return [plane.cross(flight.v, (x - flight.z0[0], y - flight.z0[1])) for x, y in corners]

    def _tried(self, flight: Ray[N, M], reached: M, line: list[N], best: list[N]) -> list[N]:
        """The nearer landing, `best` or one on the piece of this line of the grid; and the nearest corner passed."""
        ops, nought, (x0, y0, x1, y1, j), (t, where, *passed) = flight.ops, flight.ops.number(0.0), line, best
        first, last = self._sides(flight, ((x0, y0), (x1, y1)))
        if passed:
            near = reached & (modulus(first) <= ops.number(4 * UNSURE * self.size))
            passed = ops.when(near, passed, lambda: [self._passed(flight, near, (x0, y0), j, first, passed[0])])
        for kind, marked in self.inner.items():
            if kind == LINE:
                here = reached & (first <= nought) & (nought < last)
            else:
                here = reached & ops.negated((nought < first) & (last <= nought))
            if not all(marked):
                here = here & chosen_mask(ops, j, marked)
            tried = self._side if kind == LINE else self._arc
            t, where = ops.when(here, [t, where], partial(tried, flight, kind, here, j, first, last, t, where))
        return [t, where, *passed]

    def _side(self, flight: Ray[N, M], kind: str, here: M, j: N, first: N, last: N, t: N, where: N) -> list[N]:
        """The nearer of two landings: the known one, and the one on a straight side that the line meets."""
        return self._nearer(flight.ops, here, self._met(flight, self._at(flight.ops, kind, j), j)[0], j, t, where)

    def _arc(self, flight: Ray[N, M], kind: str, here: M, j: N, first: N, last: N, t: N, where: N) -> list[N]:
        """The nearer of two landings: the known one, and the one on an arc that the line may meet."""
        ops, piece, nought = flight.ops, self._at(flight.ops, kind, j), flight.ops.number(0.0)
        new, p, q, _, left = self._met(flight, piece, j)
        own = modulus(flight.component - j) < ops.number(0.25)
        slack = nought
        if any(self.bulges):
            slack = ops.select(chosen_mask(ops, j, self.bulges), -self._slack(flight, [], piece), nought)
        turns = own | (slack < left)
        if not all(closed for closed, marked in zip(self.closed, self.inner[kind], strict=True) if marked):
            smooth = (chosen_mask(ops, j, [not corners[end] for corners in self.corners]) for end in (0, 1))
            ends = [ops.select(there, ops.number(-OVERLAP), nought) for there in smooth]
            beyond = self._beyond(ops, own, ends, plane.cross(piece.middle, (p, q)))
            inside = beyond < self._inside(ops, piece, (p, q), False)
            if any(self.wide):
                inside = inside | (chosen_mask(ops, j, self.wide) & (nought < plane.dot(piece.middle, (p, q))))
            inside = inside | chosen_mask(ops, j, self.closed)
            turns = (turns & inside) | ((first <= nought) & (nought < last))
        return self._nearer(ops, here & turns, new, j, t, where)

    def _nearer(self, ops: Backend[N, M], meets: M, new: N, j: N, t: N, where: N) -> list[N]:
        """The nearer of a new landing and the known one; at equal length the one on the piece with the lower number."""
        meets = meets & (ops.number(0.0) < new) & ((new < t) | ((new == t) & (j < where)))
        return [ops.select(meets, new, t), ops.select(meets, j, where)]

    def _row(self, ops: Backend[N, M], j: N) -> list[Pair[N]]:
        """The numbers of a piece as pairs, looked up in memory."""
        row = ops.look_up_row(self.rows, j)
        return list(zip(row[::2], row[1::2], strict=True))

    def _at(self, ops: Backend[N, M], kind: str, j: N) -> PieceNumbers[N]:
        """The piece with number `j`, which is known to be of this kind."""
        origin, A, B, (D, radius), middle, half, start, _ = self._row(ops, j)
        return PieceNumbers(kind, origin, A, B, start, D, radius, middle, half)

    def _axes(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], component: N) -> list[Pair[N]]:
        return super()._axes(ops, pieces, component) if not ops.doubles else self._row(ops, component)[1:3]

    def _turning(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], component: N) -> N:
        return super()._turning(ops, pieces, component) if not ops.doubles else self._row(ops, component)[3][0]

    def point(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], position: Fields[N]) -> Pair[N]:
        if not ops.doubles:
            return super().point(ops, pieces, position)
        component, p, q = position
        origin, A, B, *_ = self._row(ops, component)
        return p * A[0] + q * B[0] + origin[0], p * A[1] + q * B[1] + origin[1]

    def _passed(self, flight: Ray[N, M], near: M, corner: Pair[N], j: N, side: N, passed: N) -> N:
        """The length to the first corner of a piece if it may be passed and is nearer than `passed`, else `passed`."""
        ops = flight.ops
        marked = near & chosen_mask(ops, j, [k in self.passed for k in range(len(self.known))])
        ahead = plane.dot(flight.v, (corner[0] - flight.z0[0], corner[1] - flight.z0[1]))
        start = self._size(ops, [], flight.component, flight.p)
        return ops.select(marked & passing(flight, corner, side, start, passed), ahead, passed)

    # ---- rounding

    def _farthest(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]]) -> N:
        return ops.number(self.size)

    def _near(self, ops: Backend[N, M], farthest: N, sides: Fields[N]) -> Iterator[M]:
        yield from super()._near(ops, farthest, sides[:2])
        if self.passed:
            yield sides[2] < ops.number(FAR)

    def _passes(
        self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], start: N, t: N, sides: Fields[N]
    ) -> Iterator[M]:
        if self.passed:
            yield sides[2] < t

    def _slack_at(self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], where: N) -> N:
        ops = flight.ops
        found = -ops.number(1.0)
        for kind in (CIRCLE, ELLIPSE):
            marked = [bulges and known == kind for bulges, known in zip(self.bulges, self.kinds, strict=True)]
            if any(marked):
                slack = self._slack(flight, pieces, self._at(ops, kind, where))
                found = ops.select(chosen_mask(ops, where, marked), slack, found)
        return found


def boxes_of(piece: PieceNumbers[float], ends: Pair[float]) -> NDArray[np.float64]:
    """Boxes that cover a piece, each round one part of it: left, right, low, high."""
    low, high = (float(end) for end in ends)
    p = np.linspace(low, high, PARTS + 1)
    found = []
    for i in (0, 1):
        o, a, b = float(piece.origin[i]), float(piece.A[i]), float(piece.B[i])
        x = o + p * a if piece.kind == LINE else o + np.cos(p) * a + np.sin(p) * b
        bulge = 0.0 if piece.kind == LINE else np.hypot(a, b) * ((high - low) / PARTS) ** 2 / 8
        found += [np.minimum(x[1:], x[:-1]) - bulge, np.maximum(x[1:], x[:-1]) + bulge]
    return np.stack(found, axis=-1)
