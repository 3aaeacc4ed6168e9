"""The boundary of a user's table, for `check.py`: simple closed curves, disjoint, one of them around the others.

Every statement is proved for all values of a letter with a range, by bisection of the range.
"""

from fractions import Fraction
from functools import cache
from math import hypot

from check import I, Jet, Unproved, Wrong, evaluate, need, value

BITS, LOOKS, PARTS = 96, 30_000, 64  # of numbers; steps; parts of a range
SHORT, CLOSE, SMALL = (Fraction(1, 2**n) for n in (16, 24, 40))  # arcs of one curve, of two, and other pieces
SKEW = 3  # of a ray, which no axis or diagonal is


def halves(a, b):
    return [(a, (a + b) / 2), ((a + b) / 2, b)]


def covered(settled, most, why):
    """Proves a statement for all of [0, 1], by bisection of the pieces for which it is not proved."""
    spent, queue = 0, [(Fraction(0), Fraction(1))]
    while queue:
        spent += 1
        piece = queue.pop()
        need(spent < most and piece[1] - piece[0] > SMALL, why)
        queue += [] if seen(settled, *piece) else halves(*piece)


def seen(settled, *pieces):
    """True if a statement is proved for pieces; a formula may have no value on a wide piece."""
    try:
        return settled(*pieces)
    except Unproved:
        return None


def piece_of(ends, a, b, p):
    """A part of the interval between two ends, which are given as 0 and 1."""
    low, high = ends
    return low + (high - low) * I.of(a, p).hull(I.of(b, p))


def outline(table, span, cusps):
    """Proves that the curves of a boundary are simple and disjoint over the range of a letter, and bound a table.

    Pieces join identically in the letter, so the curves move without meeting themselves or each other; hence their
    orientation, and which is the outer one, is proved at one value only.
    """
    looks, queue, parts = iter(range(LOOKS)), [(Fraction(0), Fraction(1))], 0
    at = lambda a, b: Outline(table, {span: stretch(table.letters[span], a, b)} if span else {}, looks, cusps)  # noqa: E731
    while queue:
        piece, parts = queue.pop(), parts + 1
        try:
            at(*piece).embedded()
        except Unproved:
            if not span or parts > PARTS:
                raise
            queue += halves(*piece)
    at(Fraction(1, 2), Fraction(1, 2)).oriented()


def stretch(range, a, b):
    return piece_of([I(end, end, range.p) for end in (range.lo, range.hi)], a, b, range.p)


class Outline:
    """The curves of a boundary for some values of a letter."""

    def __init__(self, table, letter, looks, cusps):
        self.table, self.names, self.looks, self.cusps = table, table.letters | letter, looks, cusps
        self.radial = len(table.parts[0]) == 3  # only a whole boundary is told by a radius
        self.ends = [[I.of(evaluate(end, self.names, BITS)[0], BITS) for end in part[-2:]] for part in table.parts]
        for k, (low, high) in enumerate(self.ends, 1):
            why = f"scene: piece {k} does not run forward, from less to more"
            need((high - low).hi > 0, why, Wrong)
            need((high - low).lo > 0, why)
        self.box = cache(self.box)

    def look(self, why):
        need(next(self.looks, None) is not None, why)

    def box(self, part, a, b):
        """Enclosures of the points and velocities of an arc."""
        theta = piece_of(self.ends[part], a, b, BITS)
        return [I.of(z, BITS) for z in self.table.at(part, theta, self.names, BITS)]

    def embedded(self):
        """Proves that no curve meets itself or another."""
        if self.radial:
            self.positive()
            return
        for curve in self.table.curves:
            self.simple(curve)
        self.apart()

    def positive(self):
        """Proves a radius positive, so that the curve is simple and runs counterclockwise around the origin.

        At one marked point it may be 0 with its slope; it is positive around that point if its second derivative is.
        """
        node, why = self.table.parts[0][0], "scene: the radius may not be positive"

        def radius(at):
            return [I.of(value(z), BITS) for z in evaluate(node, self.names | {"theta": at}, BITS)]

        def settled(a, b):
            self.look(why)
            theta = piece_of(self.ends[0], a, b, BITS)
            for place in self.cusps:
                there = theta.hull(I.of(place, BITS))
                slope = evaluate(node, self.names | {"theta": Jet.of(there, 1, 0)}, BITS)[1]
                if there.width() < 2 << BITS and isinstance(slope, Jet) and slope.gradient(BITS)[0] > 0:
                    return True
            (middle, _), (whole, slope) = radius(theta.mid()), radius(theta)
            need(whole.hi > 0 and middle.hi > 0, why, Wrong)
            return whole > 0 or middle.wide(slope * (theta - theta.mid())) > 0

        covered(settled, LOOKS, why)

    def apart(self):
        """Proves that two curves have no common point, by bisection until their boxes are disjoint."""
        whole, curves = (Fraction(0), Fraction(1)), self.table.curves
        pairs = [(one, other) for k, one in enumerate(curves) for other in curves[:k]]
        queue = [((k, *whole), (other, *whole)) for one, more in pairs for k in one for other in more]

        def settled(one, other):
            (x, y, *_), (u, v, *_) = self.box(*one), self.box(*other)
            return 0 not in x - u or 0 not in y - v

        while queue:
            (part, *ends), other = arcs = queue.pop()
            if not seen(settled, *arcs):
                self.look("scene: two curves of the boundary may meet")
                need(ends[1] - ends[0] > CLOSE, "scene: two curves of the boundary may meet")
                queue += [(other, (part, *half)) for half in halves(*ends)]

    def simple(self, curve):
        """Proves that the pieces of one closed curve meet only at their ends.

        Two arcs are disjoint; or they are equal or adjacent and all their velocities have a positive component along
        one vector, so that no point occurs twice; or they are halved. It fails where the velocity vanishes.
        """
        arcs = [(part, Fraction(0), Fraction(1)) for part in curve]
        queue = [(one, other) for k, one in enumerate(arcs) for other in arcs[k:]]

        def followed(one, other):
            """True if the other piece begins where this one ends."""
            (part, _, last), (following, first, _) = one, other
            after = curve[(curve.index(part) + 1) % len(curve)]
            return (part == following and last == first) or (last == 1 and first == 0 and following == after)

        def settled(one, other):
            (x, y, dx, dy), (u, v, du, dv) = self.box(*one), self.box(*other)
            if 0 not in x - u or 0 not in y - v:
                return True
            if not (one == other or followed(one, other) or followed(other, one)):
                return False
            speeds = [hypot(z.real(), w.real()) or 1 for z, w in ((dx, dy), (du, dv))]
            a, b = (Fraction(z.real() / speeds[0] + w.real() / speeds[1]) for z, w in ((dx, du), (dy, dv)))
            return all(z * a + w * b > 0 for z, w in ((dx, dy), (du, dv)))

        while queue:
            one, other = queue.pop()
            if seen(settled, one, other):
                continue
            self.look("scene: the boundary may cross itself")
            need(one[2] - one[1] > SHORT, "scene: the boundary may cross itself")  # the other one is as long
            first, second = ([(part, *ends) for ends in halves(a, b)] for part, a, b in (one, other))
            pairs = [(first[0], first[0]), first, (first[1], first[1])]
            queue += pairs if one == other else [(k, m) for k in first for m in second]

    def oriented(self):
        """Proves that one curve runs counterclockwise around all others, which run clockwise around no other."""
        if self.radial:
            return
        curves = self.table.curves
        outer = [k for k, curve in enumerate(curves) if self.area(curve) > 0]
        need(len(outer) == 1, "scene: not just one curve of the boundary runs counterclockwise, round the table")
        for k, hole in enumerate(curves):
            x, y, *_ = self.box(hole[0], Fraction(0), Fraction(0))
            for m, curve in enumerate(curves):
                if k not in (m, *outer):
                    fit = self.winding(curve, x, y) == int(m in outer)
                    need(fit, "scene: a hole of the boundary does not lie inside, by itself")

    def area(self, curve):
        """Twice the signed area inside a curve, relative to its first point, with as many pieces as needed."""
        why = "scene: which way the boundary runs is not seen"

        def settled(n):
            total, (x0, y0, *_) = I.of(0, BITS), self.box(curve[0], Fraction(0), Fraction(0))
            for part, k in ((part, k) for part in curve for k in range(n)):
                self.look(why)
                (x, y, dx, dy), (low, high) = self.box(part, Fraction(k, n), Fraction(k + 1, n)), self.ends[part]
                total = total + ((x - x0) * dy - (y - y0) * dx) * (high - low) * Fraction(1, n)
            return None if 0 in total else total

        found = next(filter(None, (seen(settled, 2**k) for k in range(2, 12))), None)
        need(found, why)
        return found

    def winding(self, curve, x, y):
        """The winding number of a curve around a point: signed crossings of a ray from the point.

        The ray runs down and to the left; a piece that may meet it lies to the left, with its ends beside the ray's
        line.
        """
        total = 0

        def place(part, a, b):
            """The coordinates of a point along and across the ray."""
            qx, qy, *_ = self.box(part, a, b)
            dx, dy = qx - x, qy - y
            return dx, dy, dy * SKEW - dx

        def sign(z):
            """The sign, 0 where it is not known."""
            return (z > 0) - (z < 0)

        def settled(part, a, b):
            nonlocal total
            along, aside, across = place(part, a, b)
            if along > 0 or aside > 0 or 0 not in across:
                return True
            self.look("scene: the boundary may run through a point of a hole")
            low, high = (sign(place(part, z, z)[2]) for z in (a, b))
            if not (along < 0 and low and high):
                return False
            total += (low - high) // 2
            return True

        for part in curve:
            covered(lambda a, b, part=part: settled(part, a, b), LOOKS, "scene: the boundary may run through a hole")
        return total
