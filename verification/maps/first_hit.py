"""Proofs that a solution of the chord system is a cycle of the billiard: flights meet nothing, the period is minimal.

In a convex table the chord between two boundary points meets the boundary nowhere else, unless both lie on the same
straight part; so there it is enough that consecutive bounces are different points and that a finite collision rule
shows the chord is not tangent.

In other tables each chord is proved to meet nothing on its way. On a chord from `p` in direction `d` a boundary point
`q` lies on the line when the cross product `d x (q - p)` is 0. The boundary is covered by balls. Each is off the line,
or on the line but not between the ends of the chord, or next to an end, where `d x q'` keeps its sign so that the line
is crossed only once, at the end itself.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from itertools import pairwise
from math import gcd
from typing import Any

from flint import arb
from sympy import QQ, ZZ, Expr, Interval, Matrix, Poly, S, chebyshevt, pi, simplify

from symbolic.expressions.signs import nonnegative
from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import ends_kernel
from symbolic.tables.curves import is_periodic
from symbolic.tables.geometry import coefficients, turning, velocity
from symbolic.tables.joins import JoinKind, contacts, following
from symbolic.tables.polynomial import derived, rational_coefficients, value_of
from symbolic.tables.table import Component, Table, theta
from symbolic.tables.validity import radius_over
from verification.arithmetic.balls import balls, working
from verification.maps.joins import ROUGH, over_joins

BITS = 64
PIECES = 2**12  # boxes that a proof of convexity may use up


def convex(table: Table, shape: tuple[arb, ...] = ()) -> bool | None:
    """True when the table is proved convex: components and joins bend inwards or are straight, and the tangent turns
    once.

    `shape` encloses the free shape parameters; without it the proof is for all values in their ranges. None if nothing
    is proved.

    >>> from symbolic.tables import cardioid, cuspless, egg
    >>> convex(cuspless), convex(egg(3).at(alpha="0.08")), convex(cardioid)
    (True, True, None)
    >>> convex(egg(3).at(alpha="0.1")), convex(egg(3))
    (True, True)
    """
    return _of_one_shape(table) if not shape else _convex(table, shape)


@cache
def _of_one_shape(table: Table) -> bool | None:
    return _convex(table, ())


def _convex(table: Table, shape: tuple[arb, ...]) -> bool | None:
    if table.undefined:
        return None
    parts = all(_bends_inwards(table, index, shape) for index in range(len(table.components)))
    return True if parts and _joined(table) and _once(table, shape) else None


def _once(table: Table, shape: tuple[arb, ...]) -> bool:
    """Is a boundary that bends inwards proved to turn once? (A curve with two turns bends inwards too, but meets
    itself.)

    The proof is a positive polar radius, or the total angle in balls. A curve with curvature everywhere has velocity
    everywhere, so its number of turns cannot change with the shape parameters: a proof for one value is enough.
    """
    if not table.shapes:
        return _turns(table, ()) is True
    if shape and _turns(table, shape) is True:
        return True
    with suppress(ValueError):  # a radius that is not positive somewhere
        if len(table.components) == 1 and radius_over(table):
            return True
    bent = all(turning(component).is_positive for component in table.components)
    return bent and _turns(table, tuple(_some(p.range) for p in table.shapes)) is True


def _some(range: Interval) -> arb:
    """A number inside a range."""
    low, high = range.start, range.end
    inside = (low + high) / 2 if high.is_finite and low.is_finite else low + 1 if low.is_finite else high - 1
    return _exact(Fraction(str(inside))) if inside.is_Rational else arb(float(inside))


def _bends_inwards(table: Table, index: int, shape: tuple[arb, ...]) -> bool:
    bend = turning(table.components[index])
    ranges = {p.symbol: p.range for p in table.shapes}
    if bend.is_nonnegative or (_all_within(shape, ranges.values()) and _exactly_nonnegative(bend, ranges)):
        return True
    if not shape:
        shape = tuple(_over(r) for r in ranges.values())
    function = load(kernel("turning", [theta, *(p.symbol for p in table.shapes)], {"bend": bend}), balls(BITS))
    with working(BITS):
        start, end = _ends(table, shape, BITS)[index]
        queue, spent = [(Fraction(0), Fraction(1))], 0
        while queue:
            low, high = queue.pop()
            spent += 1
            middle = (low + high) / 2
            share = arb(_exact(middle), _exact((high - low) / 2))
            if not function(start + (end - start) * share, *shape)[0] > 0:
                if spent > PIECES:
                    return False
                queue += [(low, middle), (middle, high)]
    return True


def _all_within(shape: tuple[arb, ...], ranges: Iterable[Interval]) -> bool:
    """Do the enclosed shape parameters lie in their ranges, so that a proof for the ranges applies to them?"""
    return not shape or all(isinstance(r, Interval) and _within(x, r) for x, r in zip(shape, ranges, strict=True))


def _within(x: arb, range: Interval) -> bool:
    low, high = (_exact(Fraction(str(end))) if end.is_Rational else None for end in (range.start, range.end))
    above = range.start.is_infinite or (low is not None and x >= low)
    return bool(above and (range.end.is_infinite or (high is not None and x <= high)))


def _exactly_nonnegative(bend: Expr, ranges: Mapping[Expr, Interval]) -> bool:
    """True when `bend`, a sum of cosines of multiples of `theta`, is proved nonnegative as a polynomial in a cosine.

    The coefficients may be polynomials in shape parameters with the given `ranges`.
    """
    waves, c = coefficients(bend) or {}, theta  # `c` stands for the cosine
    step = gcd(*waves)  # 0 where there is none
    if not (step and all(isinstance(r, Interval) for r in ranges.values())):
        return False
    if not all(map(_rational, waves.values())):  # so those of k and -k, which are conjugate, are equal
        return False
    polynomial = sum((w * (2 if k else 1) * chebyshevt(k // step, c) for k, w in waves.items() if k >= 0), S.Zero)
    used = {p: r for p, r in ranges.items() if p in polynomial.free_symbols}
    return bool(nonnegative(polynomial, {c: Interval(-1, 1)} | used))


def _rational(w: Expr) -> bool:
    """Is `w` a polynomial with rational coefficients?"""
    symbols = sorted(w.free_symbols, key=str)
    return bool(w.is_Rational or (symbols and w.is_polynomial(*symbols) and Poly(w, *symbols).domain in (ZZ, QQ)))


def _over(range: Interval) -> arb:
    """A ball that holds a range; infinite if the range is, or if its ends are not rational."""
    if not (range.start.is_Rational and range.end.is_Rational):
        return arb("0 +/- inf")
    return _exact(Fraction(str(range.start))).union(_exact(Fraction(str(range.end))))


@cache
def _joined(table: Table) -> bool:
    """Do all joins bend inwards, and by less than a right angle?"""
    return all(across.is_nonnegative and along.is_positive for across, along in tangents(table))


@cache
def _turned(table: Table) -> bool:
    """Do all joins bend inwards, and by less than half a turn?"""
    return all(across.is_positive or (across.is_zero and along.is_positive) for across, along in tangents(table))


def tangents(table: Table) -> Iterator[tuple[Expr, Expr]]:
    """Cross and dot product of the tangents at each join; none for a closed curve of period 2*pi."""
    if len(table.components) == 1 and _whole(table.components[0]):
        return
    for before, after in pairwise((*table.components, table.components[0])):
        exact = S(before.end).is_Rational and S(after.start).is_Rational
        if exact and (rows := rational_coefficients(before)) and (others := rational_coefficients(after)):
            (vx, vy), (wx, wy) = (
                [S(value_of(derived(row), Fraction(str(end)))) for row in each]
                for each, end in ((rows, before.end), (others, after.start))
            )
            yield vx * wy - vy * wx, vx * wx + vy * wy
            continue
        p, q = velocity(before).subs(theta, before.end), velocity(after).subs(theta, after.start)
        yield simplify(Matrix([p.T, q.T]).det()), simplify(p.dot(q))


@cache
def closes_smoothly(table: Table) -> bool:
    """Does the table have a single component, whose formulas have period 2*pi?

    >>> from symbolic.tables import cuspless, egg
    >>> closes_smoothly(egg(3)), closes_smoothly(cuspless)
    (True, False)
    """
    part = table.components[0]
    turned = all(x.subs(theta, theta + 2 * pi) == x for x in part.point)
    return len(table.components) == 1 and bool(part.end - part.start == 2 * pi) and turned


def inside(
    table: Table,
    components: tuple[int, ...],
    zero: list[arb],
    shape: tuple[arb, ...] = (),
    turns: bool = True,
    rough: bool = False,
    over: bool = True,
) -> bool | None:
    """True when each bounce is proved inside its component, or on a closed curve of period 2*pi; False if one is proved
    outside.

    `turns` says that the law, too, has period 2*pi, and `over` that it is the same on both sides of a join. Then a
    parameter beyond its component's end is admitted if one analytic curve runs through the join; with `rough` also if
    only the tangents agree, for equations that go on along the next component (`OverJoins`). With a single component
    nothing is refuted: modulo whole turns the parameter may be inside.
    """
    ends = _ends(table, shape, BITS)
    for index, value in zip(components, zero, strict=False):
        if turns and _whole(table.components[index]):
            continue
        start, end = ends[index]
        if not (value > start and value < end):
            if turns and over and _runs_on(table, index, value, shape, rough):
                continue
            return False if len(table.components) > 1 and (value < start or value > end) else None
    return True


def _runs_on(table: Table, index: int, value: arb, shape: tuple[arb, ...], rough: bool) -> bool:
    """Is a parameter within its component, or on the next one where the equations go on over the join?

    The excess beyond the end must be shorter than the straight line between the ends of that next component.
    """
    if len(table.components) == 1:
        return False
    ends, after, agree = _ends(table, shape, BITS), following(table), contacts(table)
    (start, end), before = ends[index], after.index(index)
    for side, gap, join, beyond, contact in (
        (1, value - end, end, after[index], agree[index]),
        (0, start - value, start, before, agree[before]),
    ):
        if gap < 0:
            continue
        if rough and contact in ROUGH and (over := over_joins(table, balls(BITS))):
            first, last = ends[beyond]
            if not gap * over.ratio[index][side] < last - first:
                return False
            continue
        _, _, vx, vy = _places(table, index)(value.union(join), *shape)
        p, q = (_places(table, beyond)(at, *shape) for at in ends[beyond])
        straight = (q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2
        if contact is not JoinKind.SMOOTH or not gap * gap * (vx * vx + vy * vy) < straight:
            return False
    return True


def minimal(table: Table, components: tuple[int, ...], zero: list[arb]) -> bool | None:
    """True if the period is proved minimal: for each proper divisor `k`, some bounce differs from that `k` later."""
    n = len(components)
    for shift in (k for k in range(1, n) if n % k == 0):
        if not any(_apart(table, components, zero, i, (i + shift) % n) for i in range(n)):
            return None
    return True


def _apart(table: Table, components: tuple[int, ...], zero: list[arb], i: int, j: int) -> bool:
    if components[i] != components[j]:  # and, but for a shape that moves them, not on their join
        if table.shapes:
            return True
        (x, y, *_), (u, v, *_) = (map(arb, _places(table, components[k])(zero[k])) for k in (i, j))
        return not (x.overlaps(u) and y.overlaps(v))
    gap = zero[i] - zero[j]
    closed = len(table.components) == 1 or _whole(table.components[components[i]])
    return not ((gap / 2).sin() if closed else gap).contains(0)


@cache
def _whole(component: Component) -> bool:
    """Is a component a closed curve of period 2*pi, such as a round hole?"""
    return bool(component.end - component.start == 2 * pi) and all(map(is_periodic, component.point))


def _ends(table: Table, shape: tuple[arb, ...], bits: int) -> list[tuple[arb, arb]]:
    """Start and end of each component's parameter, in balls, at the free shape parameters `shape`."""
    found = [end + arb(0) for end in load(ends_kernel(table), balls(bits))(*shape)]
    return list(zip(found[::2], found[1::2], strict=True))


def _exact(x: Fraction) -> arb:
    return arb(x.numerator) / x.denominator


BITS_OF_HIT = 96
PIECES_OF_CHORD = 4000  # balls that one chord may use up
SMALLEST = 2.0**-48  # of the boundary; halves of halves must stay exact in floats
Frame = tuple[arb, ...]
Place = Callable[[arb], Frame]


@dataclass(frozen=True)
class BallBoundary:
    """Closed chains of components: for each component a function to point and velocity, and its parameter's ends."""

    places: Sequence[Place]
    ends: Sequence[tuple[arb, arb]]
    after: Callable[[], tuple[int, ...]] = tuple  # the component that begins where each one ends; none for one alone

    @cached_property
    def closed(self) -> tuple[bool, ...]:
        """For each component, whether its two ends coincide: in closed chains, exactly if their balls overlap."""
        if len(self.ends) == 1:
            return (True,)
        found = []
        for place, (low, high) in zip(self.places, self.ends, strict=True):
            first, last = place(low), place(high)
            found.append(bool(first[0].overlaps(last[0]) and first[1].overlaps(last[1])))
        return tuple(found)


def first_hits(table: Table, components: tuple[int, ...], zero: list[arb], shape: tuple[arb, ...] = ()) -> bool | None:
    """True when every chord of the cycle is proved to leave inwards, arrive from inside, and meet nothing in between.

    >>> from symbolic.tables import cardioid
    >>> with working(96):
    ...     third = arb.pi() / 3
    >>> first_hits(cardioid, (0, 0), [third, -third])
    True
    """
    bounces = list(zip(components, zero, strict=False))
    return True if unobstructed(table, bounces + bounces[:1], shape) else None


def unobstructed(table: Table, bounces: Sequence[tuple[int, arb]], shape: tuple[arb, ...] = ()) -> bool:
    """True when the flights between successive bounces, which need not close up, are proved free as in `first_hits`."""
    with working(BITS_OF_HIT):
        boundary = _boundary(table, shape)
        return all(free(boundary, start, end) for start, end in pairwise(bounces))


def _boundary(table: Table, shape: tuple[arb, ...]) -> BallBoundary:
    def placed(index: int) -> Place:
        program = _places(table, index)
        return lambda at: tuple(x + arb(0) for x in program(at, *shape))  # whole numbers as balls, too

    places = [placed(i) for i in range(len(table.components))]
    return BallBoundary(places, _ends(table, shape, BITS_OF_HIT), lambda: following(table))


@cache
def _places(table: Table, index: int) -> Any:
    """A function from the parameter of a component to its point and velocity, in balls."""
    component = table.components[index]
    (x, y), (vx, vy) = component.point, velocity(component)
    letters = [theta, *(p.symbol for p in table.shapes)]
    return load(kernel("place", letters, {"x": x, "y": y, "vx": vx, "vy": vy}), balls(BITS_OF_HIT))


def turns_once(table: Table) -> bool | None:
    """True when a boundary without free shape parameters is proved to bend inwards and to turn once.

    The tangent of such a closed curve, corners included, turns through a whole number of turns; with one turn the curve
    is simple and bounds a convex set (Fenchel's theorem). The angle is summed in balls, over arcs on which all tangents
    are within a right angle of the first one. None if nothing is proved.

    >>> from symbolic.tables import cardioid, cuspless, square
    >>> turns_once(cuspless), turns_once(square()), turns_once(cardioid)
    (True, True, None)
    """
    inwards = not (table.shapes or table.undefined) and _turned(table)
    bends = inwards and all(_bends_inwards(table, index, ()) for index in range(len(table.components)))
    return _turns(table, ()) if bends else None


def _turns(table: Table, shape: tuple[arb, ...]) -> bool | None:
    """True when the tangent, corners included, is proved to turn exactly once; False if refuted, None if undecided."""
    with working(BITS_OF_HIT):
        boundary, total, spent = _boundary(table, shape), arb(0), 0
        last = boundary.places[-1](boundary.ends[-1][1])
        for place, (low, high) in zip(boundary.places, boundary.ends, strict=True):
            total += _angle(last, place(low))
            queue = [(0.5, 0.5)]
            while queue:
                middle, half = queue.pop()
                first, last = (place(low + (high - low) * end) for end in (middle - half, middle + half))
                if _products(first, place(low + (high - low) * arb(middle, half)))[1] > 0:
                    total += _angle(first, last)
                    continue
                spent += 1
                if spent > PIECES:
                    return None
                queue += [(middle + half / 2, half / 2), (middle - half / 2, half / 2)]
        return True if (total / (2 * arb.pi())).unique_fmpz() == 1 else None


def _products(p: Frame, q: Frame) -> Frame:
    """Cross and dot product of two velocities."""
    return arb(p[2] * q[3] - p[3] * q[2]), arb(p[2] * q[2] + p[3] * q[3])


def _angle(p: Frame, q: Frame) -> arb:
    """The angle from one velocity to another, between -pi/2 and pi; nan if it cannot be enclosed."""
    across, along = _products(p, q)
    if along > 0:
        return (across / along).atan()
    return arb.pi() / 2 - (along / across).atan() if across > 0 else arb("nan")


def free(boundary: BallBoundary, start: tuple[int, arb], end: tuple[int, arb]) -> bool:
    """Does the chord leave inwards, arrive from inside, and meet nothing in between? False when that is not proved.

    Must be called inside `working`. `start` and `end` are pairs of a component and a ball of its parameter.
    """
    first, last = (boundary.places[component](at) for component, at in (start, end))
    p, d = first[:2], (last[0] - first[0], last[1] - first[1])
    if not (first[2] * d[1] - first[3] * d[0] > 0 and last[3] * d[0] - last[2] * d[1] > 0):
        return False  # the inward normal is (-vy, vx)
    spent = 0
    for index, (low, high) in enumerate(boundary.ends):
        bounces = [at for component, at in (start, end) if component == index]
        queue = [(0.5, 0.5)]
        while queue:
            middle, half = queue.pop()
            spent += 1
            if spent > PIECES_OF_CHORD or half < SMALLEST:
                return False
            piece = low + (high - low) * arb(middle, half)
            near = [_between(boundary, index, at, piece) for at in bounces]
            passes = _passes(boundary.places[index], piece, near, p, d)
            if not passes and not any(_over_join(boundary, index, piece, bounce, d) for bounce in (start, end)):
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True


def _between(boundary: BallBoundary, index: int, at: arb, piece: arb) -> list[arb]:
    """Balls of the parameters between a bounce and a piece of boundary, the shorter way round on a closed curve."""
    low, high = boundary.ends[index]
    gap = piece.mid() - at.mid()
    if not boundary.closed[index] or abs(gap) < (high - low) / 2:
        return [piece.union(at)]
    return [piece.union(low), at.union(high)] if gap < 0 else [piece.union(high), at.union(low)]


def _over_join(boundary: BallBoundary, index: int, piece: arb, bounce: tuple[int, arb], d: Any) -> bool:
    """Is the line met only at the bounce itself, on the stretch from the bounce over its nearer join to this piece?"""
    (own, at), after = bounce, boundary.after()
    (first, last), (low, high) = boundary.ends[own], boundary.ends[index]
    if not after or own == index:
        return False
    if at.mid() > (first + last).mid() / 2:
        if after[own] != index:
            return False
        here, there = piece.union(low), at.union(last)
    elif after[index] == own:
        here, there = piece.union(high), at.union(first)
    else:
        return False
    frames = boundary.places[index](here), boundary.places[own](there)
    slopes = [d[0] * vy - d[1] * vx for _, _, vx, vy in frames]
    return all(slope > 0 for slope in slopes) or all(slope < 0 for slope in slopes)


def _passes(place: Place, piece: arb, near: list[list[arb]], p: Any, d: Any) -> bool:
    x, y, vx, vy = place(piece)
    wx, wy = x - p[0], y - p[1]
    if not (d[0] * wy - d[1] * wx).contains(0):
        return True
    along = d[0] * wx + d[1] * wy
    if along < 0 or along > d[0] * d[0] + d[1] * d[1]:
        return True
    for ways in near:
        slopes = [d[0] * vy - d[1] * vx for _, _, vx, vy in map(place, ways)]
        if all(slope > 0 for slope in slopes) or all(slope < 0 for slope in slopes):
            return True
    middle = piece.mid()
    x, y, *_ = place(middle)  # sharper where a chord is short or runs along the boundary
    centred = d[0] * (y - p[1]) - d[1] * (x - p[0]) + (d[0] * vy - d[1] * vx) * (piece - middle)
    return not centred.contains(0)
