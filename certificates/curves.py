"""Closed curves of one's own, for `check.py`: each is simple, they lie apart, and a point is inside of them all."""

from fractions import Fraction
from functools import cache
from math import hypot

from check import I, Unproved, evaluate, need, pi

NEAR, SHORT = Fraction(1, 2**20), Fraction(1, 2**16)  # of a marked point, where a radius may vanish; of an arc
SKEW = 3  # of a ray, which no axis or diagonal is


def halves(a, b):
    return [(a, (a + b) / 2), ((a + b) / 2, b)]


def covered(settled, most, why):
    """Proves a statement of all of [0, 1], piece by piece: one of which it is not seen is halved."""
    spent, queue = 0, [(Fraction(0), Fraction(1))]
    while queue:
        spent += 1
        need(spent < most, why)
        piece = queue.pop()
        queue += [] if seen(settled, *piece) else halves(*piece)


def seen(settled, *pieces):
    """Whether a statement is proved of pieces; a formula may have no value on a wide one."""
    try:
        return settled(*pieces)
    except Unproved:
        return None


def piece_of(ends, a, b, p):
    """A part of what lies between two ends, which are 0 and 1."""
    low, high = ends
    return low + (high - low) * I.of(a, p).hull(I.of(b, p))


def apart(table, names, p):
    """Proves that no two closed curves of the boundary have a common point: halved until their boxes lie apart."""
    whole, spent = (Fraction(0), Fraction(1)), 0
    pairs = [(one, other) for k, one in enumerate(table.curves) for other in table.curves[:k]]
    queue = [((k, whole), (other, whole)) for one, more in pairs for k in one for other in more]

    def settled(*arcs):
        (x, y, *_), (u, v, *_) = (table.at(k, piece_of(table.ends(k, p), *ends, p), names, p) for k, ends in arcs)
        return 0 not in I.of(x - u, p) or 0 not in I.of(y - v, p)  # both may be fractions

    while queue:
        spent += 1
        need(spent < 4000, "admissible: two curves of the boundary may meet")
        (part, ends), other = arcs = queue.pop()
        queue += [] if seen(settled, *arcs) else [(other, (part, half)) for half in halves(*ends)]


def simple(table, names, p):
    """Proves that no closed curve of the boundary meets itself.

    A curve about the origin with a positive radius does not. Of others two arcs lie apart, or they are one or follow
    each other and all their velocities have a positive component along one vector, so that no point comes twice;
    or they are halved. It fails where the velocity vanishes, as at a cusp: no such table is proved but by a radius."""
    for curve in table.curves:
        if len(table.parts[curve[0]]) == 3:
            beyond(table, names, p)
        else:
            embedded(table, curve, names, p)


def beyond(table, names, p):
    """Proves a radius positive, but nearer to a marked point than `NEAR`."""

    def radius(at):
        return [I.of(z, p) for z in evaluate(table.parts[0][0], names | {"theta": at}, p)]

    def settled(a, b):
        theta = piece_of(table.ends(0, p), a, b, p)
        gaps = [theta - I.of(at, p) for _, at in table.marks]
        gaps = [gap - pi(p) * 2 * round(gap.real() / 6.283185307179586) for gap in gaps]
        if any(gap.size().lo <= I.of(NEAR, p).lo for gap in gaps):
            return True
        return radius(theta.mid())[0].wide(radius(theta)[1] * (theta - theta.mid())) > 0

    covered(settled, 4000, "admissible: the boundary may cross itself, where its radius may not be positive")


def embedded(table, curve, names, p):
    """Proves that the pieces of one closed curve meet at their ends alone."""
    whole, spent = (Fraction(0), Fraction(1)), 0
    arcs = [(part, whole) for part in curve]
    queue = [(one, other) for k, one in enumerate(arcs) for other in arcs[k:]]

    @cache
    def boxes(part, ends):
        """Of an arc's points and velocities."""
        return [I.of(z, p) for z in table.at(part, piece_of(table.ends(part, p), *ends, p), names, p)]

    def followed(one, other):
        """Does the other begin where the one ends?"""
        (part, (_, last)), (following, (first, _)) = one, other
        after = curve[(curve.index(part) + 1) % len(curve)]
        return (part == following and last == first) or (last == 1 and first == 0 and following == after)

    def settled(one, other):
        (x, y, dx, dy), (u, v, du, dv) = boxes(*one), boxes(*other)
        if 0 not in x - u or 0 not in y - v:
            return True
        if not (one == other or followed(one, other) or followed(other, one)):
            return False
        speeds = [hypot(z.real(), w.real()) or 1 for z, w in ((dx, dy), (du, dv))]
        a, b = (Fraction(z.real() / speeds[0] + w.real() / speeds[1]) for z, w in ((dx, du), (dy, dv)))
        return all(z * a + w * b > 0 for z, w in ((dx, dy), (du, dv)))

    while queue:
        spent += 1
        one, other = queue.pop()
        if seen(settled, one, other):
            continue
        _, (a, b) = one  # the other one is as long
        need(b - a > SHORT and spent < 20000, "admissible: the boundary may cross itself")  # two that cross end at once
        (first, second), (third, fourth) = ([(part, ends) for ends in halves(*whole)] for part, whole in (one, other))
        pairs = [(first, first), (first, second), (second, second)]
        queue += pairs if one == other else [(k, m) for k in (first, second) for m in (third, fourth)]


def inside(table, x, y, names):
    """Proves that the boundary runs once round a point, counterclockwise; what runs round a hole is taken off.

    It is counted where it crosses a ray from the point: a piece that may meet the ray lies on its side of the point."""
    total, p = 0, 64
    x, y = I.of(x, p), I.of(y, p)
    apart(table, names, p)
    simple(table, names, p)

    def place(part, theta):
        """To one side, and across the ray."""
        qx, qy, *_ = table.at(part, theta, names, p)
        dx, dy = qx - x, qy - y
        return dx, dy * SKEW - dx

    def sign(z):
        """0 where it is not known."""
        return (z > 0) - (z < 0)

    for part in range(len(table.parts)):

        def settled(a, b, part=part):
            nonlocal total
            along, across = place(part, piece_of(table.ends(part, p), a, b, p))
            if along > 0 or 0 not in across:
                return True
            low, high = (sign(place(part, piece_of(table.ends(part, p), z, z, p))[1]) for z in (a, b))
            if not (along < 0 and low and high):
                return False
            total += (low - high) // 2
            return True

        covered(settled, 4000, "admissible: the boundary may run through a chord")
    need(total == 1, "admissible: the boundary does not run once round a chord, counterclockwise")
