"""Closed curves of one's own, for `check.py`: each is simple, they lie apart, and a point is inside of them all."""

from fractions import Fraction
from math import hypot

from check import I, Unproved, evaluate, need, pi

NEAR, SHORT = Fraction(1, 2**20), Fraction(1, 2**16)  # of a marked point, where a radius may vanish; of an arc


def apart(table, names, p):
    """Proves that no two closed curves of the boundary have a common point: halved until their boxes lie apart."""
    whole, spent = (Fraction(0), Fraction(1)), 0
    pairs = [(one, other) for k, one in enumerate(table.curves) for other in table.curves[:k]]
    queue = [((k, whole), (other, whole)) for one, more in pairs for k in one for other in more]

    def box(part, ends):
        low, high = table.ends(part, p)
        return table.at(part, low + (high - low) * I.of(ends[0], p).hull(I.of(ends[1], p)), names, p)[:2]

    while queue:
        (part, (a, b)), other = queue.pop()
        spent += 1
        need(spent < 4000, "admissible: two curves of the boundary may meet")
        try:
            done = any(0 not in x - y for x, y in zip(box(part, (a, b)), box(*other), strict=True))
        except Unproved:  # a formula may have no value on a wide piece
            done = False
        queue += [] if done else [(other, (part, half)) for half in ((a, (a + b) / 2), ((a + b) / 2, b))]


def halves(a, b):
    return [(a, (a + b) / 2), ((a + b) / 2, b)]


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
    (low, high), queue, spent = table.ends(0, p), [(Fraction(0), Fraction(1))], 0

    def radius(at):
        return [I.of(z, p) for z in evaluate(table.parts[0][0], names | {"theta": at}, p)]

    while queue:
        (a, b), spent = queue.pop(), spent + 1
        need(spent < 4000, "admissible: the boundary may cross itself, where its radius may not be positive")
        theta = low + (high - low) * I.of(a, p).hull(I.of(b, p))
        gaps = [theta - I.of(at, p) for _, at in table.marks]
        gaps = [gap - pi(p) * 2 * round(gap.real() / 6.283185307179586) for gap in gaps]
        done = any(gap.size().lo <= I.of(NEAR, p).lo for gap in gaps)
        if not done:
            try:
                m, (r, slope) = theta.mid(), radius(theta)
                done = r > 0 or radius(m)[0] + slope * (theta - m) > 0
            except Unproved:  # a formula may have no value on a wide piece
                done = False
        queue += [] if done else halves(a, b)


def embedded(table, curve, names, p):
    """Proves that the pieces of one closed curve meet at their ends alone."""
    whole, spent = (Fraction(0), Fraction(1)), 0
    arcs = [(part, whole) for part in curve]
    queue = [(one, other) for k, one in enumerate(arcs) for other in arcs[k:]]
    known = {}

    def seen(arc):
        """Boxes of an arc's points and velocities; None where a formula has no value on it."""
        if arc not in known:
            (part, (a, b)), found = arc, None
            low, high = table.ends(part, p)
            try:
                theta = low + (high - low) * I.of(a, p).hull(I.of(b, p))
                found = [I.of(z, p) for z in table.at(part, theta, names, p)]
            except Unproved:
                pass
            known[arc] = found
        return known[arc]

    def followed(one, other):
        """Does the other begin where the one ends?"""
        (part, (_, last)), (following, (first, _)) = one, other
        after = curve[(curve.index(part) + 1) % len(curve)]
        return (part == following and last == first) or (last == 1 and first == 0 and following == after)

    def settled(one, other):
        boxes = [seen(one), seen(other)]
        if None in boxes:
            return False
        (x, y, dx, dy), (u, v, du, dv) = boxes
        if 0 not in x - u or 0 not in y - v:
            return True
        if not (one == other or followed(one, other) or followed(other, one)):
            return False
        speeds = [hypot(z.real(), w.real()) or 1 for z, w in ((dx, dy), (du, dv))]
        a, b = (Fraction(z.real() / speeds[0] + w.real() / speeds[1]) for z, w in ((dx, du), (dy, dv)))
        return all(z * a + w * b > 0 for z, w in ((dx, dy), (du, dv)))

    while queue:
        (one, other), spent = queue.pop(), spent + 1
        if settled(one, other):
            continue
        long = min(b - a for _, (a, b) in (one, other)) > SHORT  # two arcs that cross end here at once
        need(long and spent < 20000, "admissible: the boundary may cross itself")
        (first, second), (third, fourth) = ([(part, ends) for ends in halves(*whole)] for part, whole in (one, other))
        pairs = [(first, first), (first, second), (second, second)]
        queue += pairs if one == other else [(k, m) for k in (first, second) for m in (third, fourth)]


def inside(table, x, y, names):
    """Proves that the boundary runs once round a point, counterclockwise; what runs round a hole is taken off.

    It is counted where it crosses a ray from the point: a piece that may meet the ray lies on its side of the point."""
    total, p = 0, (x - y).p if isinstance(x - y, I) else 64  # both may be fractions
    apart(table, names, p)
    simple(table, names, p)

    def place(part, theta):
        qx, qy, *_ = table.at(part, theta, names, p)
        return (qx - x) * 3 + (qy - y), (qy - y) * 3 - (
            qx - x
        )  # along the ray, which no axis or diagonal is, and across

    for part in range(len(table.parts)):
        (low, high), queue, spent = table.ends(part, p), [(Fraction(0), Fraction(1))], 0
        while queue:
            (a, b), spent = queue.pop(), spent + 1
            need(spent < 4000, "admissible: the boundary may run through a chord")
            start, end = (low + (high - low) * I.of(z, p) for z in (a, b))
            try:
                along, across = place(part, start.hull(end))
                signs = [(z > 0) - (z < 0) for z in (place(part, z)[1] for z in (start, end))]
                seen = along > 0 or 0 not in across or (along < 0 and 0 not in signs)
            except Unproved:  # a formula may have no value on a wide piece
                seen = False
            if not seen:
                queue += [(a, (a + b) / 2), ((a + b) / 2, b)]
            elif along < 0:
                total += (signs[0] - signs[1]) // 2
    need(total == 1, "admissible: the boundary does not run once round a chord, counterclockwise")
