"""Splines: a boundary of pieces that are polynomials of degree three, with their coefficients in memory.

Consider a line through a point of a convex curve. Along the curve the corners between pieces lie to the right of the
line up to some corner, and to its left from there on. So the piece on which a flight lands is found by bisection, in as
many steps as the number of pieces has binary digits, and one polynomial is solved; on the piece of departure it is
divided by the known root. On other tables every piece has a box along its chord, and the few pieces whose boxes the
flight may meet are tried in that order. If there are many boxes, they form a tree. On a piece the tangent turns one
way, by at most a quarter turn, so the flight function has one zero there if the two ends lie on different sides of the
flight, and two or none otherwise. On the piece of departure both the sides of its ends and a landing are computed after
division by the known zero. State: the component, the parameter `theta`, and the direction `v`.
"""

from collections.abc import Sequence

import numpy as np

from numeric.backends import elementary
from numeric.backends import functions as plane
from numeric.backends.doubled import Double, Doubles
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.corners import halved, inwards, loops
from numeric.flights.family import FAR, Boundary, Landing
from numeric.flights.general import General
from numeric.flights.grid import boxed, grown

FEW = 2  # up to so many pieces the general flight is as fast
BEND = 1e-9  # of the turning, against its largest value: less is rounding
AT_END = 2.0**-46  # a particle this near the end of a component's parameter leaves from its neighbour, too
TINY = 2.0**-500  # a distance from an end that tells its side
SCANNED = 64  # pieces, up to which all their boxes are looked at: beyond, a tree takes less long


class Spline(General):
    """The flight on tables whose pieces are cubic in the parameter. Paper: section 2."""

    name, slow = "spline", False
    width = 16

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        programs = [program for _, program in boundary.ir.programs]
        self.rows = [[float(x) for x in program(boundary.ops, *boundary.numbers)] for program in programs]
        exact = [
            program(Doubles(boundary.ops), *map(Doubles(boundary.ops).of, boundary.numbers)) for program in programs
        ]
        self.lows = [
            [float(x.high - y + x.low) for x, y in zip(*row, strict=True)] for row in zip(exact, self.rows, strict=True)
        ]
        self.refines = True
        self.closed = False
        before = {after: j for j, after in enumerate(boundary.following)}
        self.neighbours = [  # the middle of a component; those that go on smoothly from its ends, and their ends there
            [
                0.5 * (low + high),
                *((-1.0, 0.0) if first else (float(before[j]), self.ends[before[j]][1])),
                *((-1.0, 0.0) if last else (float(after), self.ends[after][0])),
            ]
            for j, ((low, high), (first, last), after) in enumerate(
                zip(self.ends, boundary.corners, boundary.following, strict=True)
            )
        ]
        self.convex = convex(boundary)
        self.boxes = [] if self.convex else boxed(boundary, self.pieces, self.rows)
        self.tree = [] if self.convex else grown(boundary, self.pieces)
        self.few = len(self.boxes) <= SCANNED
        how = (
            "the piece by halving"
            if self.convex
            else f"pieces {'in the order' if self.few else 'from a tree'} of boxes"
        )
        self.path = f"{how}, the zero of a cubic on it" if self.convex else f"{how}, every zero on them, first hit"
        if not self.convex:
            self.width = 8

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        names = [name.split()[0] for name, _ in boundary.ir.programs]
        return len(names) > FEW and not boundary.shape and all(name == "cubic" for name in names)

    @property
    def identity(self) -> str:
        return repr((self.rows, self.convex, self.tree, self.boxes))

    def _row(self, ops: Backend[N, M], which: N) -> list[N]:
        """The eight coefficients of a component."""
        if ops.doubles:
            return ops.look_up_row(self.rows, which)
        columns = zip(*self.programmed(ops), strict=True)
        return [ops.look_up(list(column), which) for column in columns]

    def programmed(self, ops: Backend[N, M]) -> list[list[N]]:
        """The coefficients of every component in the arithmetic of `ops`; in floats they are constants."""
        exact = not ops.doubles
        if not exact:
            return [[ops.number(x) for x in row] for row in self.rows]
        return [program(ops) for _, program in self.boundary.ir.programs]

    def curve(self, ops: Backend[N, M], shape: Fields[N], component: N, theta: N) -> list[N]:
        return evaluated(ops, self._row(ops, component), theta)

    def doubled(self, words: Doubles[N, M], shape: Fields[N], component: N, theta: N) -> list[Double[N, M]]:
        rows = (words.ops.look_up_row(table, component) for table in (self.rows, self.lows))
        row = [Double(words.ops, high, low) for high, low in zip(*rows, strict=True)]
        u, values = words.of(theta), []
        for a, b, c, d in (row[:4], row[4:]):
            two, three = c + c, d + d + d
            values.append((((d * u + c) * u + b) * u + a, (three * u + two) * u + b))
        return [value for pair in zip(*values, strict=True) for value in pair]

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        component, theta = position
        row = self._row(ops, component)
        x0, y0, *_ = evaluated(ops, row, theta)
        v = exit[0], exit[1]
        flight = (component, theta), row, (x0, y0), v
        if self.convex:
            best = self._across(ops, *flight)
        elif self.few and ops.doubles:
            best = self._first(ops, *flight)
        else:
            best = self._nearest(ops, *flight)
        return self._landed(ops, shape, law, best, v, (component, theta, x0, y0))

    def _across(self, ops: Backend[N, M], start: Pair[N], own: list[N], z0: Pair[N], v: Pair[N]) -> list[N]:
        """Length, component and parameter of the only landing on a convex curve."""
        component, theta = start
        count, nought, one = len(self.rows), ops.number(0.0), ops.number(1.0)
        table = self.programmed(ops)
        corners = [[row[0] for row in table], [row[4] for row in table]]  # theta starts at 0

        def side(at: N) -> N:
            x, y = (ops.look_up(values, at) for values in corners)
            return plane.cross(v, (x - z0[0], y - z0[1]))

        _, _, low, below, above = halved(ops, component, count, side)
        divided = [
            plane.cross(v, (own[1] + (own[2] + own[3] * theta) * theta, own[5] + (own[6] + own[7] * theta) * theta)),
            plane.cross(v, (own[2] + own[3] * theta, own[6] + own[7] * theta)),
            plane.cross(v, (own[3], own[7])),
            nought,
        ]
        ahead = nought <= (divided[2] + divided[1]) + divided[0]  # where the known zero is divided out, no end is near
        behind = (nought < divided[0]) & ops.negated(ahead)
        here = ahead | behind
        where = ops.select(here, component, low)
        other = self._row(ops, where)
        p = [plane.cross(v, (other[i], other[i + 4])) for i in range(4)]
        p[0] = plane.cross(v, (other[0] - z0[0], other[4] - z0[1]))
        sign = ops.select(behind, -one, one)
        p = [ops.select(here, sign * x, y) for x, y in zip(divided, p, strict=True)]
        bottom, top = ops.select(ahead, theta, nought), ops.select(behind, theta, one + nought * theta)
        guess = ops.select(here, ops.number(0.5) * (bottom + top), below / (below - above))
        at = ops.polynomial_zero(p, guess, bottom, top, one, (0, 3))
        x, y, *_ = evaluated(ops, other, at)
        far = ops.number(FAR) + nought * theta
        *back, _ = self._back(ops, start, v, [far, component, theta])
        lands = (back[0] < far) & ops.negated(here)
        t = plane.dot(v, (x - z0[0], y - z0[1]))
        best = ops.select(nought < t, t, far), where, at  # none behind its departure
        return [ops.select(lands, x, y) for x, y in zip(back, best, strict=True)]

    def _first(self, ops: Backend[N, M], start: Pair[N], own: list[N], z0: Pair[N], v: Pair[N]) -> list[N]:
        """The nearest landing, from the pieces whose box the flight may meet, tried from the nearest box on."""
        far, (component, theta) = ops.number(FAR), start
        each = ops.number(0.0) * theta
        best, sides = self._own(ops, start, own, v, [far + each, component + each, theta])
        *best, other = self._back(ops, start, v, best)

        def tried(state: list[N]) -> list[N]:
            floor, *best = state
            one, two, third = self._ahead(ops, component, z0, v, floor)
            best = self._met(ops, one, component, other, sides, z0, v, best)
            closer = -two[0] < best[0]
            best = ops.when(closer, best, lambda: self._met(ops, two, component, other, sides, z0, v, best))
            return [third, *best]

        return list(ops.repeat(lambda at: -at[0] < at[1], tried, [far + each, *best], len(self.boxes)))[1:]

    def _at_end(self, ops: Backend[N, M], component: N, theta: N) -> M:
        """Does a particle leave from an end of its component, up to rounding?"""
        low, high = self._ends_of(ops, component)
        least = ops.number(AT_END)
        at_end: M = (theta - low <= least) | (high - theta <= least)
        return at_end

    def _ends_of(self, ops: Backend[N, M], component: N) -> Pair[N]:
        """The ends of a component's parameter; constants if all components have the same ends."""
        if len(set(self.ends)) == 1:
            return ops.number(self.ends[0][0]), ops.number(self.ends[0][1])
        low, high = (ops.look_up([ops.number(ends[i]) for ends in self.ends], component) for i in (0, 1))
        return low, high

    def _neighbour(self, ops: Backend[N, M], component: N, theta: N) -> Pair[N]:
        """The component that joins smoothly at the end where a particle is, and its parameter there; -1 for none."""
        columns = [[ops.number(row[i]) for row in self.neighbours] for i in range(5)]
        middle, before, end, after, begin = (ops.look_up(column, component) for column in columns)
        first = theta < middle
        return ops.select(first, before, after), ops.select(first, end, begin)

    def _back(self, ops: Backend[N, M], start: Pair[N], v: Pair[N], best: list[N]) -> list[N]:
        """The nearer landing, `best` or one on the neighbour of the end where a particle starts; and the neighbour."""
        none, at_end = ops.number(-1.0) + ops.number(0.0) * start[0], self._at_end(ops, *start)

        def found() -> list[N]:
            other, place = self._neighbour(ops, *start)
            landed, _ = self._own(ops, (other, place), self._row(ops, other), v, best)
            leaves = at_end & (ops.number(-0.5) < other)
            return [ops.select(leaves, x, y) for x, y in zip([*landed, other], [*best, none], strict=True)]

        return list(ops.when(at_end, [*best, none], found))

    def _own(
        self, ops: Backend[N, M], start: Pair[N], own: list[N], v: Pair[N], best: list[N]
    ) -> tuple[list[N], Pair[N]]:
        """The nearer landing, `best` or one on the piece of departure; and on which sides of the flight its ends lie.

        The zero of the flight function at the start is divided out.
        """
        component, theta = start
        low, high = self._ends_of(ops, component)
        _, _, dx, dy, ax, ay = evaluated(ops, own, theta)
        half, nought = ops.number(0.5), ops.number(0.0)
        terms = (dx, dy), (half * ax, half * ay), (own[3], own[7])
        q, along = [plane.cross(v, term) for term in terms], [plane.dot(v, term) for term in terms]
        low, high = low - theta, high - theta
        first, last = ((q[2] * end + q[1]) * end + q[0] for end in (low, high))
        middle = half * (low + high) * q[1] + (low * high * q[2] + q[0])
        lowest, highest = least(ops, first, least(ops, middle, last)), most(ops, first, most(ops, middle, last))

        def solved() -> list[N]:
            w = half * q[1]
            root = ops.sqrt(ops.maximum(plane.exact_cross(ops, (w, q[0]), (q[2], w)), nought))
            w = -(w + ops.times_sign(root, w))
            real = nought < root
            change, turn = ops.negated(nought < first * last), -half * q[1] / q[2]
            both = (
                ops.negated(change) & (nought < first * q[2]) & (low < turn) & (turn < high)
            )  # zeros between the ends
            roots = [w / q[2], q[0] / w]
            gaps = [most(ops, low - x, x - high) for x in roots]
            found = best
            for x, gap, other in zip(roots, gaps, gaps[::-1], strict=True):
                inside = (gap <= nought) | both | (change & (gap < other) & (nought < other))
                x = least(ops, most(ops, x, low), high)
                t = ((along[2] * x + along[1]) * x + along[0]) * x
                nearer = real & inside & (nought < t) & (t < found[0])
                found = [
                    ops.select(nearer, new, old) for new, old in zip([t, component, theta + x], found, strict=True)
                ]
            return found

        best = ops.when((lowest <= nought) & (nought <= highest), best, solved)
        return best, (least(ops, low, ops.number(-TINY)) * first, most(ops, high, ops.number(TINY)) * last)

    def _ahead(self, ops: Backend[N, M], component: N, z0: Pair[N], v: Pair[N], floor: N) -> tuple[list[N], list[N], N]:
        """The two nearest pieces with keys up to `floor` whose boxes the flight may meet; and the key of the third one.

        A piece is given by its key, minus a lower bound of the length at which the flight meets it, and its number.
        Each choice has its own mask: to combine masks takes longer than to choose.
        """
        nought, never = ops.number(0.0), ops.number(-FAR)
        aside, begin = plane.cross(z0, v), plane.dot(v, z0)
        one, two, third = [never, nought], [never, nought], never
        for j, box in enumerate(self.boxes):
            x, y, dx, dy, ratio = (ops.number(value) for value in box.frame)
            across, along = modulus(v[0] * dy - v[1] * dx), modulus(v[0] * dx + v[1] * dy)
            wide, long = ratio * along + across, ratio * across + along
            away = begin - (v[0] * x + v[1] * y)
            beside = modulus(v[0] * y + (aside - v[1] * x)) - wide
            key = ops.select(most(ops, beside, away - long) <= nought, away + long, never)
            key = ops.select(component == ops.number(float(box.component)), never, key)
            key = ops.select(floor < key, never, key)
            number, first, second = ops.number(float(j)), one[0] < key, two[0] < key
            third = most(ops, third, least(ops, two[0], key))
            two = [
                most(ops, two[0], least(ops, one[0], key)),
                ops.select(first, one[1], ops.select(second, number, two[1])),
            ]
            one = [most(ops, one[0], key), ops.select(first, number, one[1])]
        return one, two, third

    def _side(self, ops: Backend[N, M], corner: Fields[N], component: N, ends: Pair[N], v: Pair[N], aside: N) -> N:
        """How far a corner lies to the left of the flight; for the piece of departure, the better value in `ends`."""
        x, y, before, after = corner
        side = v[0] * y + (aside - v[1] * x)
        return ops.select(component == before, ends[1], ops.select(component == after, ends[0], side))

    def _met(
        self,
        ops: Backend[N, M],
        piece: list[N],
        component: N,
        neighbour: N,
        ends: Pair[N],
        z0: Pair[N],
        v: Pair[N],
        best: list[N],
    ) -> list[N]:
        """The nearest landing: `best` or one on a piece other than the piece of departure and `neighbour`."""
        key, number = piece
        nought, one, half = (ops.number(x) for x in (0.0, 1.0, 0.5))
        row = ops.look_up_row([box.numbers for box in self.boxes], number)
        (where, low, high), corners, row = row[8:11], (row[12:16], row[16:20]), row[:8]
        aside = plane.cross(z0, v)
        s0, s1 = (self._side(ops, corner, component, ends, v, aside) for corner in corners)
        reached = (-key < best[0]) & (half < modulus(where - neighbour))
        folded = ops.negated((s0 < nought) & (nought <= s1) | (s1 < nought) & (nought <= s0))
        p = [plane.cross(v, (row[i], row[i + 4])) for i in range(4)]
        p[0] = plane.cross(v, (row[0] - z0[0], row[4] - z0[1]))
        third = (high - low) * ops.number(1 / 3)

        def value(u: N) -> N:
            return ((p[3] * u + p[2]) * u + p[1]) * u + p[0]

        def slope(u: N) -> N:
            return (ops.number(3.0) * p[3] * u + ops.number(2.0) * p[2]) * u + p[1]

        first, last = value(low), value(high)
        slopes = slope(low), slope(high)
        inner = [ops.select(s0 < nought, -x, x) for x in (first + third * slopes[0], last - third * slopes[1])]
        rise = last - first
        turned = [ops.select(s0 < nought, x, -x) < nought for x in slopes]  # where it runs away from its zero at first
        guess, none = low - (high - low) * first / rise, nought * low
        guess = ops.select(turned[0], high, ops.select(turned[1], low, guess))
        begin = [rise, low, high, guess, none, none, ops.select(folded, nought, one + none)]

        def parted() -> list[N]:
            """The part of a piece that the flight meets first, and the parameter of the flight function's extremum."""
            root = ops.sqrt(ops.maximum(p[2] * p[2] - ops.number(3.0) * p[3] * p[1], nought))
            w = -(p[2] + ops.times_sign(root, p[2]))
            near, other = p[1] / w, w / (ops.number(3.0) * p[3])
            m = ops.select((low <= near) & (near <= high), near, other)
            m = least(ops, most(ops, m, low), high)
            x, y, dx, dy, ax, ay = evaluated(ops, row, m)
            at_m, bend = value(m), plane.cross(v, (ax, ay))
            t, forward = plane.dot(v, (x - z0[0], y - z0[1])), nought < plane.dot(v, (dx, dy))
            onward = nought < t
            left = (forward & onward) | ops.negated(forward | onward)
            reach = ops.sqrt(ops.maximum(-(at_m + at_m) / bend, nought))
            back = ops.select(onward, ops.select(left, one, -one), nought)
            found = [
                ops.select(left, at_m - first, last - at_m),
                ops.select(left, low, m),
                ops.select(left, m, high),
                ops.select(left, most(ops, m - reach, low), least(ops, m + reach, high)),
                back,
                m,
                ops.select(ops.select(s0 < nought, -at_m, at_m) < nought, one, nought),
            ]
            return [ops.select(folded, x, y) for x, y in zip(found, begin, strict=True)]

        rise, bottom, top, guess, back, m, meets = ops.when(
            reached & folded & (least(ops, *inner) <= nought), begin, parted
        )
        meets = reached & (half < meets)

        def arrival(rise: N, bottom: N, top: N, guess: N, meets: M, best: list[N]) -> tuple[N, list[N]]:
            sign = ops.times_sign(one, rise)
            at = ops.polynomial_zero([sign * x for x in p], guess, bottom, top, one, (0, 3), meets)
            x, y, *_ = evaluated(ops, row, at)
            t = plane.dot(v, (x - z0[0], y - z0[1]))
            nearer = meets & (nought < t) & (t < best[0])
            return t, [ops.select(nearer, new, old) for new, old in zip([t, where, at], best, strict=True)]

        t, best = arrival(rise, bottom, top, guess, meets, best)
        behind = meets & (t <= nought) & (half < modulus(back))

        def other() -> list[N]:
            """The landing on the second part of a piece, where the zero on the first lies behind the departure."""
            left = back < nought
            ends = ops.select(left, low, m), ops.select(left, m, high)
            return list(arrival(-rise, *ends, half * (ends[0] + ends[1]), behind, best)[1])

        return list(ops.when(behind, best, other))

    def _nearest(self, ops: Backend[N, M], start: Pair[N], own: list[N], z0: Pair[N], v: Pair[N]) -> list[N]:
        """The nearest landing, by a walk down the tree of boxes that leaves out boxes beyond the best landing so far.

        With numbers of more digits than doubles, all pieces are searched as on any table. This uses none of the boxes,
        and can serve to test them.
        """
        component, theta = start
        one, half, nought, far = (ops.number(x) for x in (1.0, 0.5, 0.0, FAR))
        exact, each = not ops.doubles, nought * theta
        size, end = (modulus(v[0]), modulus(v[1])), ops.number(float(len(self.tree)))
        best, sides = [far + each, component + each, theta], (nought, nought)
        if not exact:
            best, sides = self._own(ops, start, own, v, best)
            *best, other = self._back(ops, start, v, best)

        def walked(state: list[N]) -> list[N]:
            """The next node of the tree, until a piece is reached or the tree ends."""
            node, _, best = state
            x, y, wide, high, skip, piece, *_ = ops.look_up_row(self.tree, node)
            c = x - z0[0], y - z0[1]
            reach, away = size[0] * wide + size[1] * high, plane.dot(v, c)
            beside = modulus(plane.cross(v, c)) <= size[1] * wide + size[0] * high
            meets = beside & (nought < away + reach) & (away - reach < best)
            return [ops.select(meets, node + one, skip), ops.select(meets, piece, -one), best]

        def tried(state: list[N]) -> list[N]:
            node, *best = state
            node, piece, _ = ops.repeat(
                lambda at: (at[1] < -half) & (at[0] < end - half),
                walked,
                [node, each - one, best[0]],
                len(self.tree) + 1,
            )
            reached = -half < piece
            index, low, high, _ = ops.look_up_row([box.numbers[8:12] for box in self.boxes], ops.maximum(piece, nought))
            if not exact:
                elsewhere = reached & (half * half < modulus(index - component))
                named = [ops.select(elsewhere, far, -far), piece]
                return [node, *self._met(ops, named, component, other, sides, z0, v, best)]
            row = self._row(ops, index)
            hit = self._hits(
                ops, lambda at: evaluated(ops, row, at), (index, low, high, high - low), start, z0, v, best
            )
            return [node, *(ops.select(reached, new, old) for new, old in zip(hit, best, strict=True))]

        return list(ops.repeat(lambda at: at[0] < end - half, tried, [each, *best], len(self.tree) + 1))[1:]


def evaluated(ops: Backend[N, M], row: Sequence[N], u: N) -> list[N]:
    """Point, velocity and acceleration of a cubic."""
    two, three, six = (ops.number(x) for x in (2.0, 3.0, 6.0))
    values = []
    for a, b, c, d in (row[:4], row[4:]):
        values.append((((d * u + c) * u + b) * u + a, (three * d * u + two * c) * u + b, six * d * u + two * c))
    return [value for pair in zip(*values, strict=True) for value in pair]


def least(ops: Backend[N, M], x: N, y: N) -> N:
    """The smaller of two numbers."""
    return ops.select(x < y, x, y)


def most(ops: Backend[N, M], x: N, y: N) -> N:
    """The larger of two numbers."""
    return ops.select(y < x, x, y)


def convex(boundary: Boundary) -> bool:
    """Is the boundary one closed curve of pieces on [0, 1] that turns always to the left, and once round?"""
    if any((low, high) != (0.0, 1.0) for low, high in boundary.ends) or len(loops(boundary.following)) > 1:
        return False
    if not all(inwards(boundary, i) for i in range(len(boundary.ends))):
        return False
    theta = np.linspace(0.0, 1.0, 129)
    rows = [boundary.curve(np.full(theta.shape, i), theta) for i in range(len(boundary.ends))]
    total = 0.0
    for row, after in zip(rows, [*rows[1:], rows[0]], strict=True):
        turning = row[2] * row[5] - row[3] * row[4]
        if np.min(turning) < -BEND * np.max(np.abs(turning)):
            return False
        angle = np.unwrap(elementary.arctan2(row[3], row[2]))
        u, v = (row[2, -1], row[3, -1]), (after[2, 0], after[3, 0])
        corner = elementary.arctan2(plane.cross(u, v), plane.dot(u, v))
        total += float(angle[-1] - angle[0] + corner)
    return abs(total - 2 * np.pi) < 1e-6
