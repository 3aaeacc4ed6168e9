"""Closed curves of tables of one's own, for `check.py`: that they lie apart, and that a point is inside of them all."""

from fractions import Fraction

from check import I, Unproved, need


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


def inside(table, x, y, names):
    """Proves that the boundary runs once round a point, counterclockwise; what runs round a hole is taken off.

    It is counted where it crosses a ray from the point: a piece that may meet the ray lies on its side of the point."""
    total, p = 0, (x - y).p if isinstance(x - y, I) else 64  # both may be fractions
    apart(table, names, p)

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
