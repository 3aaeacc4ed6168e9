"""Is a solution of the chord system a cycle of the billiard? It must be admissible, and of minimal period.

In a convex table the chord between two boundary points meets the boundary nowhere else, unless both
lie on the same straight part; so there it is enough that consecutive bounces are different points
and that a finite collision rule shows the chord is not tangent.

In other tables each chord is proved to meet nothing on its way. Along a chord from `p` in direction `d` a boundary
point `q` lies on the line when `d x (q - p) = 0`. The boundary is covered by balls: off the line, or on it but not
between the ends, or next to an end, where `d x q'` keeps its sign so that the line is crossed there once, at the end
itself.
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
from symbolic.tables.table import Component, Table, theta
from symbolic.tables.validity import radius_over
from verification.arithmetic.balls import balls, working

BITS = 64
PIECES = 2**12  # boxes that a proof of convexity may use up


def convex(table: Table, shape: tuple[arb, ...] = ()) -> bool | None:
    """True when all parts bend inwards or are straight, the joins bend in, and the whole turns once: proved.

    `shape` encloses the free shape parameters; without it every value of their ranges is meant. None: nothing proved.

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
    """Does a boundary that bends inwards turn once? A curve of two turns bends inwards as well, and meets itself.

    It does where its radius is positive, and where the angle in balls says so. A curve that bends everywhere stops
    nowhere, so its turns cannot change with its shape parameters: one value of them is asked.
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
    """Do enclosed shape parameters lie in their ranges? What is proved over these is else nothing of them."""
    return not shape or all(isinstance(r, Interval) and _within(x, r) for x, r in zip(shape, ranges, strict=True))


def _within(x: arb, range: Interval) -> bool:
    low, high = (_exact(Fraction(str(end))) if end.is_Rational else None for end in (range.start, range.end))
    above = range.start.is_infinite or (low is not None and x >= low)
    return bool(above and (range.end.is_infinite or (high is not None and x <= high)))


def _exactly_nonnegative(bend: Expr, ranges: Mapping[Expr, Interval]) -> bool:
    """True when a sum of cosines of multiples of `theta` is proved nonnegative, as a polynomial in one of them.

    Its coefficients may be polynomials in shape parameters, which have `ranges`.
    """
    waves, c = coefficients(bend) or {}, theta  # which then stands for the cosine
    step = gcd(*waves)  # 0 where there is none
    if not (step and all(isinstance(r, Interval) for r in ranges.values())):
        return False
    if not all(map(_rational, waves.values())):  # so those of k and -k, which are conjugate, are equal
        return False
    polynomial = sum((w * (2 if k else 1) * chebyshevt(k // step, c) for k, w in waves.items() if k >= 0), S.Zero)
    used = {p: r for p, r in ranges.items() if p in polynomial.free_symbols}
    return bool(nonnegative(polynomial, {c: Interval(-1, 1)} | used))


def _rational(w: Expr) -> bool:
    """Is it a polynomial with rational coefficients?"""
    symbols = sorted(w.free_symbols, key=str)
    return bool(w.is_Rational or (symbols and w.is_polynomial(*symbols) and Poly(w, *symbols).domain in (ZZ, QQ)))


def _over(range: Interval) -> arb:
    """A ball over a range; without end where the range has none, or where its ends are no rationals."""
    if not (range.start.is_Rational and range.end.is_Rational):
        return arb("0 +/- inf")
    return _exact(Fraction(str(range.start))).union(_exact(Fraction(str(range.end))))


@cache
def _joined(table: Table) -> bool:
    """Do the joins bend in, by less than a right angle?"""
    return all(across.is_nonnegative and along.is_positive for across, along in tangents(table))


@cache
def _turned(table: Table) -> bool:
    """Do the joins bend in, by less than half a turn?"""
    return all(across.is_positive or (across.is_zero and along.is_positive) for across, along in tangents(table))


def tangents(table: Table) -> Iterator[tuple[Expr, Expr]]:
    """Vector and scalar product of the tangents at each join; a curve that a whole turn does not change has none."""
    if len(table.components) == 1 and _whole(table.components[0]):
        return
    for before, after in pairwise((*table.components, table.components[0])):
        p, q = velocity(before).subs(theta, before.end), velocity(after).subs(theta, after.start)
        yield simplify(Matrix([p.T, q.T]).det()), simplify(p.dot(q))


@cache
def closes_smoothly(table: Table) -> bool:
    """Is the curve of a table of one component the same formula after a whole turn? False for more components.

    >>> from symbolic.tables import cuspless, egg
    >>> closes_smoothly(egg(3)), closes_smoothly(cuspless)
    (True, False)
    """
    part = table.components[0]
    turned = all(x.subs(theta, theta + 2 * pi) == x for x in part.point)
    return len(table.components) == 1 and bool(part.end - part.start == 2 * pi) and turned


def inside(
    table: Table, components: tuple[int, ...], zero: list[arb], shape: tuple[arb, ...] = (), turns: bool = True
) -> bool | None:
    """True when every bounce is proved to lie in the interior of its component, or on one that a whole turn repeats.

    `turns` says that the law, too, is the same a whole turn further on. Beyond its ends any other formula runs on along
    a curve that is no boundary. Where there is one component nothing is refuted there: a turn less may bring it back.
    """
    ends = _ends(table, shape, BITS)
    for index, value in zip(components, zero, strict=False):
        if turns and _whole(table.components[index]):
            continue
        start, end = ends[index]
        if not (value > start and value < end):
            return False if len(table.components) > 1 and (value < start or value > end) else None
    return True


def minimal(table: Table, components: tuple[int, ...], zero: list[arb]) -> bool | None:
    """True when no shorter cycle is run through several times: some bounce differs from its image."""
    n = len(components)
    for shift in (k for k in range(1, n) if n % k == 0):
        if not any(_apart(table, components, zero, i, (i + shift) % n) for i in range(n)):
            return None
    return True


def _apart(table: Table, components: tuple[int, ...], zero: list[arb], i: int, j: int) -> bool:
    if components[i] != components[j]:
        return True
    gap = zero[i] - zero[j]
    closed = len(table.components) == 1 or _whole(table.components[components[i]])
    return not ((gap / 2).sin() if closed else gap).contains(0)


@cache
def _whole(component: Component) -> bool:
    """Is a component a closed curve that runs through a whole turn of its parameter, as a round hole does?"""
    return bool(component.end - component.start == 2 * pi) and all(map(is_periodic, component.point))


def _ends(table: Table, shape: tuple[arb, ...], bits: int) -> list[tuple[arb, arb]]:
    """Where the parameter of each component starts and ends, in balls, from the free shape parameters."""
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
class Boundary:
    """Closed chains of components: point and velocity at a parameter of each, and the ends of its parameter."""

    places: Sequence[Place]
    ends: Sequence[tuple[arb, arb]]

    @cached_property
    def closed(self) -> tuple[bool, ...]:
        """Which components end where they begin. The boundary is made of closed chains, so nothing else can be near."""
        if len(self.ends) == 1:
            return (True,)
        found = []
        for place, (low, high) in zip(self.places, self.ends, strict=True):
            first, last = place(low), place(high)
            found.append(bool(first[0].overlaps(last[0]) and first[1].overlaps(last[1])))
        return tuple(found)


def first_hits(table: Table, components: tuple[int, ...], zero: list[arb], shape: tuple[arb, ...] = ()) -> bool | None:
    """True when every chord of the cycle leaves inwards, arrives from inside, and meets nothing between.

    >>> from symbolic.tables import cardioid
    >>> with working(96):
    ...     third = arb.pi() / 3
    >>> first_hits(cardioid, (0, 0), [third, -third])
    True
    """
    bounces = list(zip(components, zero, strict=False))
    return True if unobstructed(table, bounces + bounces[:1], shape) else None


def unobstructed(table: Table, bounces: Sequence[tuple[int, arb]], shape: tuple[arb, ...] = ()) -> bool:
    """The same of the flights between successive bounces, which need not close."""
    with working(BITS_OF_HIT):
        boundary = _boundary(table, shape)
        return all(free(boundary, start, end) for start, end in pairwise(bounces))


def _boundary(table: Table, shape: tuple[arb, ...]) -> Boundary:
    def placed(index: int) -> Place:
        program = _places(table, index)
        return lambda at: program(at, *shape)

    return Boundary([placed(i) for i in range(len(table.components))], _ends(table, shape, BITS_OF_HIT))


@cache
def _places(table: Table, index: int) -> Any:
    """The point and the velocity at a parameter of a component, in balls."""
    component = table.components[index]
    (x, y), (vx, vy) = component.point, velocity(component)
    letters = [theta, *(p.symbol for p in table.shapes)]
    return load(kernel("place", letters, {"x": x, "y": y, "vx": vx, "vy": vy}), balls(BITS_OF_HIT))


def turns_once(table: Table) -> bool | None:
    """True when a boundary without free shape parameters is proved to bend inwards and to turn once.

    The tangent of such a closed curve, corners included, turns through a whole number of turns; with one turn the curve
    is simple and bounds a convex set (Fenchel's theorem). The angle is summed in balls, over arcs on which no tangent
    is as far as a right angle from the first. None: nothing proved.

    >>> from symbolic.tables import cardioid, cuspless, square
    >>> turns_once(cuspless), turns_once(square()), turns_once(cardioid)
    (True, True, None)
    """
    inwards = not (table.shapes or table.undefined) and _turned(table)
    bends = inwards and all(_bends_inwards(table, index, ()) for index in range(len(table.components)))
    return _turns(table, ()) if bends else None


def _turns(table: Table, shape: tuple[arb, ...]) -> bool | None:
    """True when the tangent, corners included, is proved to turn once, summed over arcs; None: nothing proved."""
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
    """Vector and scalar product of two velocities."""
    return arb(p[2] * q[3] - p[3] * q[2]), arb(p[2] * q[2] + p[3] * q[3])


def _angle(p: Frame, q: Frame) -> arb:
    """From one velocity to another, to the left where it is a right angle or more."""
    across, along = _products(p, q)
    if along > 0:
        return (across / along).atan()
    return arb.pi() / 2 - (along / across).atan() if across > 0 else arb("nan")


def free(boundary: Boundary, start: tuple[int, arb], end: tuple[int, arb]) -> bool:
    """Does the chord leave inwards, arrive from inside, and meet nothing between? False when that is not proved.

    Call it inside `working`. `start` and `end` are a component and a ball of its parameter.
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
            if not _passes(boundary.places[index], piece, near, p, d):
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True


def _between(boundary: Boundary, index: int, at: arb, piece: arb) -> list[arb]:
    """Parameters that lead from a bounce to a piece: through the seam of a closed boundary where that is shorter."""
    low, high = boundary.ends[index]
    gap = piece.mid() - at.mid()
    if not boundary.closed[index] or abs(gap) < (high - low) / 2:
        return [piece.union(at)]
    return [piece.union(low), at.union(high)] if gap < 0 else [piece.union(high), at.union(low)]


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
