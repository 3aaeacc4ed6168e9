"""Tables of straight sides and arcs of conics: every piece in closed form, first hit.

A piece is `O + p*A + q*B`: an arc of an ellipse for `(p, q)` on the unit circle, a straight side for `q = -1` and
`B = 0`; `d = p*B - q*A` is a tangent of both. A line along `v` through `z0` meets a piece where `p*a + q*b = m`, with

    a = v x A,    b = v x B,    m = v x (z0 - O),

and of the two points of an ellipse a particle from inside arrives at the one where `v x d = sqrt(a*a + b*b - m*m)` is
positive, whichever way the arc bends. On the arc from which it leaves, the root is known from the departure, so that no
digits cancel.

The line meets a side if the side's ends lie on different sides of the line. Two pieces that share a corner use the same
number for it, so no flight passes between them. Round a convex curve this sign changes from minus to plus only once. So
the piece is found first, by bisection if there are many, and then one equation is solved.

**Corners and tangencies are told from landings beside them by the flight's own error.** Let `S` be the sum of the
moduli of the numbers from which the two ends of a flight are added up. Rounding moves the line sideways by at most
`UNSURE*S = 8*2**-52*S`: in units of `2**-53`, a computed point is off by 5 times its part of `S`, a corner by 2 times,
and a direction and a product each by 3 times the length, which is at most `S`. So a flight that passes a corner no
farther aside ends there, as a `JOIN`, on whichever side the line seems to land, and also where it would fly past a
corner that bends into the table. A flight that comes as near to a tangent of a dispersing arc is `GRAZING`, whether it
seems to touch the arc or not. A flight that ends on the arc from which it started is known far better when it is short:
its departure is off by `UNSURE*S` along the arc, and the line moves sideways by `UNSURE` times its length.

State: the piece, `p`, `q`, and the direction `v`.
"""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

from numeric.backends import functions as plane
from numeric.backends.doubled import affordable
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.corners import (
    CIRCLE,
    ELLIPSE,
    FOCAL,
    LINE,
    MANY,
    Coordinates,
    PieceNumbers,
    Ray,
    chosen,
    chosen_mask,
    convex,
    from_focus,
    halved,
    inwards,
    loops,
    passing,
    piece_of,
    span,
)
from numeric.flights.family import FAR, SLAP, Boundary, Landing, Status, grazing, reflected
from numeric.flights.general import OVERLAP, UNSURE, refuse_long
from numeric.lowering.program import LawIR

OWN = 2.0**-40  # beyond the end of its own arc, on which a particle lands: a sine, far above rounding


class Pieces(Coordinates):
    """Several curves, each of several pieces, so that a table may have corners, smooth joins and holes."""

    name, path = "pieces", "closed form on every side and arc, first hit"
    pairs = (3,)
    position = ("component", "p", "q")
    direction = ("vx", "vy")

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        refuse_long(boundary)
        ir = boundary.ir
        names = [name.split() for name, _ in ir.programs]
        self.kinds = [kind for kind, _ in names]
        self.programs = [program for _, program in ir.programs]
        self.halving: list[list[float]] | None = None
        self.constants: list[list[float]] | None = None  # numbers that are looked up
        known = [piece_of(*named) for named in zip(self.kinds, self.numbers(), strict=True)]
        self.known = known
        self.following = boundary.following
        self.closed = [after == j for j, after in enumerate(self.following)]
        self.wide = [kind != LINE and bool(piece.half[1] < 0) for kind, piece in zip(self.kinds, known, strict=True)]
        self.bulges = [kind != LINE and bool(piece.D < 0) for kind, piece in zip(self.kinds, known, strict=True)]
        first = loops(self.following)[0]
        self.outer = first if convex(boundary, known, first) else []
        self.passed = sorted(after for j, after in enumerate(self.following) if not inwards(boundary, j))
        self.corners = boundary.corners
        self.extent = 2.0 ** math.frexp(max(abs(x) for row in self.numbers() for x in row[:6]))[1]
        self.refines = not boundary.shape or affordable(*(program.lines for program in self.programs))
        if len(self.outer) == len(known) > MANY and not boundary.shape:
            self.halving = self.constants = self.numbers()

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        names = [name.split() for name, _ in boundary.ir.programs]
        return bool(names) and all(name[0] in (LINE, CIRCLE, ELLIPSE, FOCAL) for name in names)

    @property
    def identity(self) -> str:
        told = self.kinds, self.following, self.closed, self.wide, self.outer, self.bulges, self.passed, self.halving
        return repr((*told, self.extent))

    def numbers(self) -> list[list[float]]:
        """The numbers of every piece."""
        ops, shape = self.boundary.ops, self.boundary.numbers
        return [[float(x) for x in program(ops, *shape)] for program in self.programs]

    def pieces(self, ops: Backend[N, M], shape: Fields[N]) -> list[PieceNumbers[N]]:
        """All pieces in the arithmetic of `ops`."""
        found = []
        for j, (kind, program) in enumerate(zip(self.kinds, self.programs, strict=True)):
            if self.constants and ops.doubles:
                x = [ops.number(value) for value in self.constants[j]]
            else:
                x = program(ops, *shape)
            found.append(piece_of(kind, x))
        return found

    @cached_property
    def arcs(self) -> list[int]:
        """The pieces that are not straight sides."""
        return [i for i, kind in enumerate(self.kinds) if kind != LINE]

    def arc(self, ops: Backend[N, M], position: Fields[N], component: N, theta: N, law: LawIR) -> N:
        slope, begin = self._pair(
            ops, component, [(slope, begin) for slope, begin in (length(ops) for length in law.lengths)]
        )
        return slope * theta + begin

    # ---- a bounce

    def point(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], position: Fields[N]) -> Pair[N]:
        """The Cartesian point."""
        component, p, q = position
        origin, A, B = self._axes_at(ops, pieces, component)
        if FOCAL in self.kinds:
            arc = chosen_mask(ops, component, [kind == FOCAL for kind in self.kinds])
            p = ops.select(arc, from_focus(ops, self._gap_of(ops, component, pieces), (p, q)), p)
        return p * A[0] + q * B[0] + origin[0], p * A[1] + q * B[1] + origin[1]

    def _axes_at(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], component: N) -> list[Pair[N]]:
        """The vectors `O`, `A` and `B` of the particle's piece."""
        columns = [x.origin for x in pieces], [x.A for x in pieces], [x.B for x in pieces]
        return [self._pair(ops, component, column) for column in columns]

    def _gap_of(self, ops: Backend[N, M], component: N, pieces: list[PieceNumbers[N]]) -> N:
        """One minus the eccentricity of an arc about a focus; 1 for other pieces, whose `origin` is the centre."""
        return chosen(ops, component, [x.radius if x.kind == FOCAL else ops.number(1.0) for x in pieces])

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        component, p, q = position
        pieces, v, nought = self.pieces(ops, shape), (exit[0], exit[1]), ops.number(0.0)
        z0 = self.point(ops, pieces, position)
        d0 = self.tangent(ops, shape, position)
        flight = Ray(ops, component, z0, v, plane.cross(d0, v), p, q, law == SLAP)
        corners = [piece.start for piece in pieces]
        best: list[N] | None = None
        if self.halving:

            def side(at: N) -> N:
                x, y = (ops.look_up([corner[i] for corner in corners], at) for i in (0, 1))
                return plane.cross(v, (x - z0[0], y - z0[1]))

            first, last, where, below, above = halved(ops, component, len(pieces), side)
            ahead, behind = self._ends_of_own(flight, pieces, corners, first, last)
            where = ops.select((ahead < nought) & (nought <= behind), where, component)
            best = [*self._met(flight, self._gathered(ops, where, pieces), where)[:4], where]
            return self._landed(flight, shape, pieces, best, [first, last, below, above])
        sides = [plane.cross(v, (corner[0] - z0[0], corner[1] - z0[1])) for corner in corners]
        if self.outer:
            best = self._round(flight, pieces, sides)
        for j, piece in enumerate(pieces):
            if j in self.outer:
                continue
            here = ops.number(float(j))
            t, p, q, along, left = self._met(flight, piece, here)
            crosses = (sides[j] <= nought) & (nought < sides[self.following[j]])
            if piece.kind != LINE:
                own = modulus(component - here) < ops.number(0.25)
                turns = own | ((nought if not self.bulges[j] else -self._slack(flight, pieces, piece)) < left)
                if not self.closed[j]:
                    ends = [ops.number(0.0 if corner else -OVERLAP) for corner in self.corners[j]]
                    beyond = self._beyond(ops, own, ends, plane.cross(piece.middle, (p, q)))
                    turns = turns & (beyond < self._inside(ops, piece, (p, q), self.wide[j]))
                same = ops.negated((nought < sides[j]) & (sides[self.following[j]] <= nought))
                crosses = crosses | (same & turns)
            meets = crosses & (nought < t)
            if best is None:
                best = [ops.select(meets, t, ops.number(FAR)), p, q, along, here + nought * component]
            else:
                nearer = meets & (t < best[0])
                new = t, p, q, along, here
                best = [x if x is y else ops.select(nearer, x, y) for x, y in zip(new, best, strict=True)]
        assert best is not None
        return self._landed(flight, shape, pieces, best, sides)

    def _ends_of_own(
        self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], corners: list[Pair[N]], first: N, last: N
    ) -> Pair[N]:
        """On which sides of a flight the ends of its own piece lie, as in `_sides_of_own`; corners are looked up."""
        ops, smooth = flight.ops, [not start for start, _ in self.corners]
        if not any(smooth):
            return first, last
        slack = ops.number(UNSURE) * self._size(ops, pieces, flight.component, flight.p)

        def ordered() -> list[N]:
            found, next = [], flight.component + ops.number(1.0)
            next = ops.select(next < ops.number(len(pieces) - 0.5), next, ops.number(0.0))
            for at, side, order in ((next, first, -1.0), (flight.component, last, 1.0)):
                x, y = (modulus(ops.look_up([c[i] for c in corners], at) - flight.z0[i]) for i in (0, 1))
                there = (ops.maximum(x, y) <= slack) & chosen_mask(ops, at, smooth)
                found.append(ops.select(there, ops.number(order), side))
            return found

        ahead, behind = ops.when((modulus(first) <= slack) | (modulus(last) <= slack), [first, last], ordered)
        return ahead, behind

    def _round(self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], sides: Fields[N]) -> list[N]:
        """The landing of a flight on the outer curve, which is convex.

        If no piece has its ends on different sides of the line, the line crosses one arc twice: the arc of departure,
        or for a flight from another curve any arc.
        """
        ops, where = flight.ops, flight.component
        nought, sides = ops.number(0.0), self._sides_of_own(flight, pieces, sides)
        for j in self.outer:
            other = ops.number(0.25) < modulus(flight.component - ops.number(float(j)))
            meets = other & (sides[j] <= nought) & (nought < sides[self.following[j]])
            where = ops.select(meets, ops.number(float(j)), where)
        arcs = [j for j in self.outer if self.kinds[j] != LINE]
        if arcs and len(self.outer) < len(self.known):
            untold = ops.number(len(self.outer) - 0.5) < where
            where = ops.when(untold, [where], lambda: [ops.select(untold, self._twice(flight, pieces, arcs), where)])[0]
        return [*self._met(flight, self._gathered(ops, where, pieces), where)[:4], where]

    def _sides_of_own(self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], sides: Fields[N]) -> list[N]:
        """On which side of the line each corner of the convex curve lies.

        At a smooth join from which a particle starts, rounding is overruled: the first end of its piece is taken to lie
        to the left of the line, the last end to the right.
        """
        ops, found, smooth = flight.ops, list(sides), [j for j in self.outer if not self.corners[j][0]]
        if not smooth or len(self.outer) == 1:
            return found
        slack = ops.number(UNSURE) * self._size(ops, pieces, flight.component, flight.p)
        near: M | None = None
        for j in smooth:
            close = modulus(sides[j]) <= slack
            near = close if near is None else near | close
        assert near is not None

        def ordered() -> list[N]:
            changed = list(sides)
            for j in smooth:
                x, y = (modulus(pieces[j].start[i] - flight.z0[i]) for i in (0, 1))
                there = ops.maximum(x, y) <= slack
                for at, side in ((j, 1.0), (self.following.index(j), -1.0)):
                    own = there & (modulus(flight.component - ops.number(float(at))) < ops.number(0.25))
                    changed[j] = ops.select(own, ops.number(side), changed[j])
            return changed

        return list(ops.when(near, found, ordered))

    def _twice(self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], arcs: list[int]) -> N:
        """The arc among `arcs` that a line crosses twice, if all corners of a convex curve lie on one side of it."""
        ops, nought = flight.ops, flight.ops.number(0.0)
        where, most = nought * flight.component + ops.number(float(arcs[0])), nought
        for j in arcs if len(arcs) > 1 else []:
            here = ops.number(float(j))
            _, p, q, _, left = self._met(flight, pieces[j], here)
            inside = ops.select(nought < left, self._inside(ops, pieces[j], (p, q), self.wide[j]), -ops.number(1.0))
            where, most = ops.select(most < inside, here, where), ops.maximum(most, inside)
        return where

    def _beyond(self, ops: Backend[N, M], own: M, ends: Sequence[N], side: N) -> N:
        """The tolerance for a landing beyond the end of an arc: small at a smooth join, larger on the arc of departure.

        So no flight passes between two arcs. By rounding, the end from which a particle left may lie on the wrong side
        of its flight; then the particle seems to come back to the arc that it has left.
        """
        return ops.select(own, ops.number(-OWN), ops.select(side <= ops.number(0.0), *ends))

    def _spans(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]]) -> list[Pair[N]]:
        """The pair `(base, slope)` that `span` gives, for every piece; constants if there are no parameters."""
        if self.boundary.shape:
            return [span(piece) for piece in pieces]
        return [(ops.number(float(x)), ops.number(float(y))) for x, y in map(span, self.known)]

    def _size(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], component: N, p: N) -> N:
        """The sum of the moduli of the numbers that a point of a piece is added up from, or a bound of this sum."""
        base, slope = self._pair(ops, component, self._spans(ops, pieces))
        return base + slope * modulus(p)

    def _farthest(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]]) -> N:
        """A bound, for all points of the table, of the sum that `_size` gives."""
        largest = ops.number(0.0)
        for (base, slope), (low, high) in zip(
            self._spans(ops, pieces), (piece.middle for piece in pieces), strict=True
        ):
            largest = ops.maximum(largest, base + slope * ops.maximum(modulus(low), modulus(high)))
        return largest

    def _slack(self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], piece: PieceNumbers[N]) -> N:
        """The bound of `(v x d)**2`, for an arc's tangent `d`, below which rounding hides whether the line meets the
        arc.
        """
        ops, radius = flight.ops, piece.radius
        if piece.kind != CIRCLE:
            a, b = plane.cross(flight.v, piece.A), plane.cross(flight.v, piece.B)
            radius = ops.sqrt(a * a + b * b)
        size = self._size(ops, pieces, flight.component, flight.p) + span(piece)[0]
        return ops.number(2 * UNSURE) * radius * size

    def _gathered(self, ops: Backend[N, M], where: N, pieces: list[PieceNumbers[N]]) -> PieceNumbers[N]:
        """The piece of every particle. Its kind is that of the pieces of the outer curve, or empty if those differ."""
        several = len({self.kinds[j] for j in self.outer}) > 1
        origin, A, B = self._axes_at(ops, pieces, where)
        D, radius = self._turning(ops, pieces, where), chosen(ops, where, [piece.radius for piece in pieces])
        kind = "" if several else self.kinds[self.outer[0]]
        radius = self._gap_of(ops, where, pieces) if FOCAL in self.kinds else radius
        return PieceNumbers(kind, origin, A, B, origin, D, radius, origin, origin)

    def _met(self, flight: Ray[N, M], piece: PieceNumbers[N], where: N) -> tuple[N, N, N, N, N]:
        """Length, `p`, `q` and `v x d` of a landing on the piece, and a number that is positive if there is one."""
        ops, v = flight.ops, flight.v
        w = flight.z0[0] - piece.origin[0], flight.z0[1] - piece.origin[1]
        a, b, m = plane.cross(v, piece.A), plane.cross(v, piece.B), plane.cross(v, w)
        one = ops.number(1.0)
        if piece.kind == LINE:
            inverse = one / a
            return plane.cross(piece.A, w) * inverse, m * inverse, ops.number(-1.0), a, one
        kinds = {kind for kind in self.kinds if kind != LINE} if not piece.kind else {piece.kind}
        nought, own = ops.number(0.0), modulus(flight.component - where) < ops.number(0.25)
        if kinds == {CIRCLE}:
            square = piece.radius * piece.radius
            left = (piece.radius - m) * (piece.radius + m)
        elif FOCAL in kinds:  # from the focus: `m` is larger by `e*a`
            square, gap = a * a + b * b, piece.radius
            e = one - gap
            left = a * a * (gap * (one + e)) + b * b - m * (m + (e + e) * a)
            m = ops.select(own, flight.p * a + flight.q * b, m + e * a)
        else:
            square = a * a + b * b
            left = plane.dot((a, b), (a, b)) - m * m
        s = ops.select(own, flight.rate, ops.sqrt(ops.maximum(left, nought)))
        line = None
        if not piece.kind:
            line = chosen_mask(ops, where, [kind == LINE for kind in self.kinds])
            square = ops.select(line, one, square)
        inverse = one / square
        p, q = plane.unit(ops, ((m * a + s * b) * inverse, (m * b - s * a) * inverse))
        along, far = s, from_focus(ops, piece.radius, (p, q)) if FOCAL in kinds else p
        if line is not None:
            far = ops.select(line, m / a, far)
            p, q = ops.select(line, m / a, p), ops.select(line, ops.number(-1.0), q)
            along = ops.select(line, a, s)
        x, y = far * piece.A[0] + q * piece.B[0] - w[0], far * piece.A[1] + q * piece.B[1] - w[1]
        chord = (s + s) * piece.D * inverse
        t = ops.select(own, chord, v[0] * x + v[1] * y)
        return t, p, q, along, left

    def _inside(self, ops: Backend[N, M], piece: PieceNumbers[N], u: Pair[N], wide: bool) -> N:
        """The sine of the angle from the nearer end of an arc to its point with coordinates `u`; negative outside."""
        c, s = plane.dot(piece.middle, u), modulus(plane.cross(piece.middle, u))
        gap = piece.half[0] * c - piece.half[1] * s
        return ops.select(ops.number(0.0) < c, ops.number(1.0), gap) if wide else gap

    def _landed(
        self, flight: Ray[N, M], shape: Fields[N], pieces: list[PieceNumbers[N]], best: Fields[N], sides: Fields[N]
    ) -> Landing[N]:
        ops, v, (t, p, q, along, where) = flight.ops, flight.v, best
        nought = ops.number(0.0)
        A, B = self._axes(ops, pieces, where)
        d = p * B[0] - q * A[0], p * B[1] - q * A[1]
        nowhere = grazing(ops, plane.dot(d, v), along) | ops.negated(nought < t)
        code = ops.select(nowhere, ops.number(float(Status.GRAZING.code)), nought)
        farthest = self._farthest(ops, pieces)
        near: M | None = None
        if any(self.bulges):
            near = ops.negated(ops.number(4 * UNSURE) * farthest * farthest < along * along)
        for by in self._near(ops, farthest, sides):
            near = by if near is None else near | by
        assert near is not None
        doubt = ops.when(near, [nought + nought * t], lambda: [self._doubt(flight, pieces, best, d, sides)])[0]
        code = ops.select(ops.number(0.5) < doubt, doubt, code)
        if not self.outer:  # what passes between two pieces is at a join
            missed = Status.JOIN if any(map(any, self.corners)) else Status.LOST
            code = ops.select(t < ops.number(FAR), code, ops.number(float(missed.code)))
        D = self._turning(ops, pieces, where)
        if self.refines and ops.doubles:
            p, q, *new = self.refined(flight, shape, best, d)
            d = new[0], new[1]
            along = plane.cross(v, d)
        across = plane.dot(d, v)
        return Landing([where, p, q], across, along, code, {"v": v, "d": d}, {"t": t, "D": D})

    def _doubt(
        self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], best: Fields[N], d: Pair[N], sides: Fields[N]
    ) -> N:
        """The code of `JOIN` or `GRAZING` where rounding hides on which side of a corner or tangent the line passes."""
        ops, (t, p, q, along, where) = flight.ops, best
        nought, one = ops.number(0.0), ops.number(1.0)
        speed, start = plane.dot(d, d), self._size(ops, pieces, flight.component, flight.p)
        size = start + self._size(ops, pieces, where, p)
        # how far aside the corner lies, against how far aside the line may; squares, lest there be a root
        gap = self._gap(ops, pieces, where, (p, q))
        aside, doubt = gap * along, size * size
        aside = aside * aside
        if self.arcs:
            own = modulus(flight.component - where) < ops.number(0.25)
            doubt = ops.select(own, t * t * speed + along * along * doubt, doubt)
            aside = aside * ops.select(own, speed, one)
        sure = (nought < gap) & (ops.number(UNSURE * UNSURE) * doubt < aside) | (ops.number(0.5 * FAR) < gap)
        for passes in self._passes(flight, pieces, start, t, sides):
            sure = sure & ops.negated(passes)
        code = nought
        if any(self.bulges):
            touches = (along * along <= self._slack_at(flight, pieces, where)) & ops.negated(own)
            code = ops.select(touches, ops.number(float(Status.GRAZING.code)), nought)
        if len(self.arcs) < len(self.kinds):  # a straight side does not come back to itself
            line = chosen_mask(ops, where, [kind == LINE for kind in self.kinds])
            back = line & (modulus(flight.component - where) < ops.number(0.25))
            code = ops.select(back, ops.number(float(Status.GRAZING.code)), code)
        return ops.select(sure, code, ops.number(float(Status.JOIN.code)))

    def _near(self, ops: Backend[N, M], farthest: N, sides: Fields[N]) -> Iterator[M]:
        """For each corner: does the line pass so near that rounding may hide on which side?"""
        for side in sides:
            yield ops.negated(ops.number(8 * UNSURE) * farthest < modulus(side))

    def _passes(
        self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], start: N, t: N, sides: Fields[N]
    ) -> Iterator[M]:
        """For each corner that a flight may pass: does rounding hide on which side the flight passes it?"""
        for j in self.passed:
            yield passing(flight, pieces[j].start, sides[j], start, t)

    def _slack_at(self, flight: Ray[N, M], pieces: list[PieceNumbers[N]], where: N) -> N:
        """The bound `_slack` for the piece on which a flight ends, if it is dispersing; otherwise a negative number."""
        none, known = -flight.ops.number(1.0), zip(pieces, self.bulges, strict=True)
        slack = [self._slack(flight, pieces, piece) if bulges else none for piece, bulges in known]
        return chosen(flight.ops, where, slack)

    def _gap(self, ops: Backend[N, M], pieces: list[PieceNumbers[N]], where: N, u: Pair[N]) -> N:
        """The distance, in the parameter, of a landing from the nearer end of its piece; negative beyond the end.

        A smooth join is not an end.
        """
        far, gaps = ops.number(FAR), []
        if len(self.arcs) < len(self.kinds):
            ends = [
                (low if first else -far, high if last else far)
                for (low, high), (first, last) in zip((x.middle for x in pieces), self.corners, strict=True)
            ]
            low, high = self._pair(ops, where, ends)
            gaps.append(-ops.maximum(low - u[0], u[0] - high))
        if self.arcs:
            M, half = (
                self._pair(ops, where, pairs) for pairs in ([x.middle for x in pieces], [x.half for x in pieces])
            )
            gap = self._inside(ops, pieces[0]._replace(middle=M, half=half), u, False)
            if any(self.wide):
                ahead = chosen_mask(ops, where, self.wide) & (ops.number(0.0) < plane.dot(M, u))
                gap = ops.select(ahead, far, gap)
            nought, side = ops.number(0.0), plane.cross(M, u)
            for end, ahead in ((0, side <= nought), (1, nought <= side)):  # the nearer end, if it is no corner
                smooth = [not corners[end] for corners in self.corners]
                if any(smooth):
                    gap = ops.select(chosen_mask(ops, where, smooth) & ahead, far, gap)
            gaps.append(gap)
        return (
            gaps[0] if len(gaps) == 1 else ops.select(chosen_mask(ops, where, [k == LINE for k in self.kinds]), *gaps)
        )

    def leave(self, ops: Backend[N, M], shape: Fields[N], law: str, lam: N, landing: Landing[N]) -> list[N]:
        return reflected(self, ops, law, lam, landing)

    def normal_exit(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N]) -> list[N]:
        dx, dy = self.tangent(ops, shape, position)
        return list(plane.normalised(ops, (-dy, dx)))

    def exit_normal_speed(self, ops: Backend[N, M], shape: Fields[N], position: Fields[N], exit: Fields[N]) -> N:
        return plane.cross(self.tangent(ops, shape, position), (exit[0], exit[1]))

    def leaving_rate(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N], leaving: Fields[N]) -> N:
        d = landing.vectors["d"]
        return plane.cross(d, (leaving[0], leaving[1])) if leaving else ops.sqrt(plane.dot(d, d))

    def length(
        self, ops: Backend[N, M], shape: Fields[N], n0: N, start: Fields[N], end: Fields[N], landing: Landing[N]
    ) -> N:
        return landing.numbers["t"]

    def scaled_curvature(self, ops: Backend[N, M], shape: Fields[N], landing: Landing[N]) -> Pair[N]:
        d = landing.vectors["d"]
        return -landing.numbers["D"], plane.dot(d, d)
