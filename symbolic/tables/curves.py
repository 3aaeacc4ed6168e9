"""The closed curves of a boundary, where they cross, and finite Fourier sums by their coefficients.

Sums are multiplied as sequences of fractions, where SymPy would multiply out: `(1 + cos(theta))**64` has 129
coefficients and millions of terms on SymPy's way to them.

Crossings are excluded for finite Fourier sums, else sought on polygons.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from math import atan2, fsum, tau
from typing import Any

from sympy import (
    QQ,
    Add,
    Dummy,
    Expr,
    I,
    Interval,
    Mul,
    Pow,
    Rational,
    S,
    Symbol,
    acos,
    atan,
    chebyshevu,
    cos,
    expand,
    pi,
    sign,
    sin,
)
from sympy.polys.rings import ring
from sympy.simplify.fu import TR8

from symbolic.expressions.signs import bernstein, vanishes
from symbolic.tables.table import Component, Table, theta

Pair = tuple[Fraction, Fraction]  # real and imaginary part
Waves = dict[int, Pair]  # of exp(i*k*theta), by k; none of them 0
PRODUCTS = 150_000  # of two coefficients, in one formula: about a second
EMPTY: Mapping[Symbol, Any] = {}
DIGITS = 30  # by which two values are told apart
LONG = 200  # operations, names and numbers: what is longer is not multiplied out by SymPy


class _TooLongError(Exception):
    """More products of coefficients than can be made in about a second."""


@lru_cache(maxsize=256)
def waves(expression: Expr) -> Waves | None:
    """The coefficients of a trigonometric polynomial with rational numbers; None for whatever else it may be.

    None as well where more than `PRODUCTS` products would be needed.

    >>> waves(2 * cos(theta) ** 2)
    {-2: (Fraction(1, 2), Fraction(0, 1)), 0: (Fraction(1, 1), Fraction(0, 1)), 2: (Fraction(1, 2), Fraction(0, 1))}
    >>> waves(1 / (2 + cos(theta))) is None
    True
    """
    try:
        found = _read(expression, [PRODUCTS], Fraction)
    except _TooLongError:  # treated as any other formula, that is not multiplied out
        return None
    return None if found is None else dict(sorted(found.items()))


def trigonometric(expression: Expr) -> Expr:
    """A trigonometric polynomial as a sum of sines and cosines of multiples; others merely expanded.

    >>> trigonometric(sin(theta) ** 2 + 3 * cos(theta) ** 2)
    cos(2*theta) + 2
    """
    found = _summed(S(expression))
    while found is None:
        last, expression = expression, expand(TR8(expand(expression)))
        found = expression if expression == last else None
    return found


@lru_cache(maxsize=256)
def _summed(expression: Expr) -> Expr | None:
    """A real trigonometric polynomial, letters in its coefficients, as sines and cosines of multiples; or None."""
    letters = sorted(expression.free_symbols - {theta}, key=str)
    own = ring(letters or [Dummy("x")], QQ)[0]
    try:
        found = _read(expression, [PRODUCTS], lambda p, q: own(QQ(p, q)), dict(zip(letters, own.gens, strict=False)))
    except _TooLongError:
        return None
    if found is None:
        return None
    terms = []
    for k in {abs(k) for k in found}:
        (u, v), (x, y) = found.get(k, (own.zero, own.zero)), found.get(-k, (own.zero, own.zero))
        if u != x or v != -y:  # not real
            return None
        for factor, wave in ((u, cos(k * theta)), (-v, sin(k * theta))):
            terms += [term * wave * (2 if k else 1) for term in Add.make_args(factor.as_expr())]
    return Add(*terms)


def _read(
    e: Expr, left: list[int], number: Callable[[int, int], Any], letters: Mapping[Symbol, Any] = EMPTY
) -> dict[int, tuple[Any, Any]] | None:
    """The coefficients, operand by operand; `left` holds how many products may still be made.

    `number(p, q)` is a fraction in the ring of the coefficients, which `letters` belong to.
    """
    zero = number(0, 1)
    if isinstance(e, Rational):
        return {0: (number(e.p, e.q), zero)} if e.p else {}
    if e in letters:
        return {0: (letters[e], zero)}
    if e is I:
        return {0: (zero, number(1, 1))}
    if isinstance(e, cos | sin):
        multiple = e.args[0] / theta
        if not multiple.is_Integer:
            return None
        k, half = int(multiple), number(1, 2)
        return {-k: (half, zero), k: (half, zero)} if isinstance(e, cos) else {-k: (zero, half), k: (zero, -half)}
    if isinstance(e, Pow):
        base = _read(e.base, left, number, letters) if e.exp.is_Integer and e.exp.is_positive else None
        return None if base is None else _power(base, int(e.exp), left, {0: (number(1, 1), zero)})
    if not isinstance(e, Add | Mul):
        return None
    parts = []
    for operand in e.args:
        part = _read(operand, left, number, letters)
        if part is None:
            return None
        parts.append(part)
    found = parts[0]
    for part in parts[1:]:
        found = _sum(found, part) if isinstance(e, Add) else _product(found, part, left)
    return found


def _sum(f: Waves, g: Waves) -> Waves:
    total = dict(f)
    for k, (x, y) in g.items():
        u, v = total.get(k, (0, 0))
        total[k] = u + x, v + y
    return {k: c for k, c in total.items() if c[0] or c[1]}


def _product(f: Waves, g: Waves, left: list[int]) -> Waves:
    left[0] -= len(f) * len(g)
    if left[0] < 0:
        raise _TooLongError
    total: Waves = {}
    for k, (a, b) in f.items():
        for n, (x, y) in g.items():
            u, v = total.get(k + n, (0, 0))
            real, imaginary = a * x, b * x
            if y:
                real, imaginary = real - b * y, imaginary + a * y
            total[k + n] = u + real, v + imaginary
    return {k: c for k, c in total.items() if c[0] or c[1]}


def _power(f: Waves, n: int, left: list[int], one: Waves) -> Waves:
    found = one
    while n:
        found = _product(found, f, left) if n % 2 else found
        n //= 2
        f = _product(f, f, left) if n else f
    return found


def exactly(c: Pair) -> Expr:
    """A coefficient as SymPy writes it."""
    return Rational(c[0].numerator, c[0].denominator) + I * Rational(c[1].numerator, c[1].denominator)


def highest(found: Waves) -> int:
    """The highest harmonic."""
    return max((abs(k) for k in found), default=0)


def is_periodic(expression: Expr) -> bool:
    """Does `theta` stand only within sines and cosines of whole multiples, so that a whole turn changes nothing?

    >>> is_periodic(cos(cos(3 * theta)) / (2 + sin(theta))), is_periodic(theta), is_periodic(cos(theta / 2))
    (True, False, False)
    """
    if isinstance(expression, cos | sin) and (expression.args[0] / theta).is_Integer:
        return True
    return expression is not theta and all(is_periodic(part) for part in expression.args)


@lru_cache(maxsize=4096)
def size(expression: Expr) -> int:
    """How many operations, names and numbers an expression has, a repeated one each time."""
    return 1 + sum(size(part) for part in expression.args)


PLACES = Rational(1, 3), Rational(13, 11)  # of a parameter, where a value is looked at


def varies(value: Expr) -> bool:
    """Is a value seen to differ at two parameters? Then it is no constant; asked before anything is multiplied out.

    False says nothing: letters are given the value 1/20, at which there may be no such value.

    >>> varies(cos(theta)), varies(cos(theta) ** 2 + sin(theta) ** 2)
    (True, False)
    """
    given = dict.fromkeys(value.free_symbols, Rational(1, 20))
    one, other = (value.subs(given | {theta: place}).evalf(DIGITS) for place in PLACES)
    if not (one.is_Float and other.is_Float):
        return False
    return bool(abs(one - other) > (abs(one) + abs(other)) / 10 ** (DIGITS // 2))


def alone(expression: Expr, x: Symbol = theta) -> bool:
    """Has the expression no letter but `x`?"""
    return bool(S(expression).free_symbols <= {x})


CORNERS = 96  # of the polygon, over all components
FINE = 2**80  # of the lattice on which its corners lie
Corner = tuple[int, int]


def curves(table: Table) -> list[tuple[Component, ...]]:
    """The closed curves of a boundary, each as its components in order: the outer one first, then the holes.

    A curve is complete where it comes back to its first point; a chain that does not is refused.

    >>> from symbolic.tables import cuspless
    >>> [[component.name for component in curve] for curve in curves(cuspless)]
    [['arc', 'wall']]
    """
    only = table.components[0]
    if len(table.components) == 1 and only.end - only.start == 2 * pi and all(map(is_periodic, only.point)):
        return [table.components]
    found, curve = [], list[Component]()
    for index, before in enumerate(table.components):
        curve.append(before)
        last = index + 1 == len(table.components)
        after = curve[0] if last else table.components[index + 1]
        if not last and _meet(before, after):
            continue
        if not _meet(before, curve[0]):
            leaves, arrives = before.at(before.end), after.at(after.start)
            raise ValueError(
                f"{table.name}: the boundary is not closed: {before.name} ends at "
                f"({leaves[0]}, {leaves[1]}) and {after.name} starts at ({arrives[0]}, {arrives[1]})"
            )
        found.append(tuple(curve))
        curve = []
    return found


def _meet(before: Component, after: Component) -> bool:
    pairs = zip(before.at(before.end), after.at(after.start), strict=True)
    return all(p == q or vanishes(p - q) for p, q in pairs)


def chord_of_length_zero(c: dict[int, Expr], scale: Expr = S.One) -> str | None:
    """A sentence on where `sum c_k exp(i*k*theta)` meets itself or stops; None when it is proved simple.

    The chord between `m + B` and `m - B` is `2*i*sin(B)` times `sum sgn(k) c_k U_(|k|-1)(cos B)
    exp(i*k*m)`. A simple regular curve has no zero of that sum for `-1 <= cos B <= 1`; boxes of
    `(tan(m/2), cos B)` are excluded by the sign of its real or its imaginary part. `scale` is theta in this angle.

    >>> chord_of_length_zero({-2: -S(1) / 2, -1: S(1) / 2, 1: S(1) / 2, 2: S(1) / 2})
    'the boundary meets itself, or stops, near theta = -91 and 90 degrees'
    """
    T, C = Dummy("T", real=True), Dummy("C", real=True)
    n = max(abs(k) for k in c)
    total = S.Zero
    for k, value in c.items():
        if k:
            wave = (1 + sign(k) * I * T) ** (2 * abs(k)) * (1 + T**2) ** (n - abs(k))
            total += sign(k) * value * chebyshevu(abs(k) - 1, C) * wave
    parts = [expand(part) for part in expand(total).as_real_imag()]
    box = _unexcluded([p for p in parts if p != 0], {T: Interval(-1, 1), C: Interval(-1, 1)}, 14)
    if box is None:
        return None
    m = 2 * atan((box[T].start + box[T].end) / 2)
    half = acos((box[C].start + box[C].end) / 2)
    ends = sorted((scale * angle * 180 / pi).round() for angle in (m - half, m + half))
    return f"the boundary meets itself, or stops, near theta = {ends[0]} and {ends[1]} degrees"


def _unexcluded(parts: list[Expr], box: dict[Symbol, Interval], depth: int) -> dict[Symbol, Interval] | None:
    """A box of the last generation in which no part keeps its sign; None when every box is excluded."""
    for part in parts:
        signs = {c.is_positive if c.is_nonzero else None for c in bernstein(part, box)}
        if len(signs) == 1 and None not in signs:
            return None
    if depth == 0:
        return box
    x = max(box, key=lambda y: box[y].measure)
    middle = (box[x].start + box[x].end) / 2
    for half in (Interval(box[x].start, middle), Interval(middle, box[x].end)):
        found = _unexcluded(parts, {**box, x: half}, depth - 1)
        if found is not None:
            return found
    return None


def polygon_crossing(table: Table) -> str | None:
    """A sentence on where the polygon inscribed in the boundary crosses itself; None when it does not.

    >>> from symbolic.tables import cuspless
    >>> polygon_crossing(cuspless) is None
    True
    """
    polygons = [_corners(replace(table, components=curve), len(table.components)) for curve in curves(table)]
    sides = [
        (polygon[k], polygon[k + 1 - len(polygon)], names[k])
        for polygon, names in polygons
        for k in range(len(polygon))
    ]
    for i, (a, b, here) in enumerate(sides):
        for c, d, there in sides[i + 1 :]:
            if b != c and d != a and _cross(a, b, c, d):
                return f"the boundary crosses itself, near {here} and {there}"
    for polygon, _ in polygons:
        if (turns := _turns(polygon)) != 1:
            return f"the boundary turns round {turns} times before it closes, and should once"
    (outer, _), *holes = polygons
    for polygon, names in holes:
        around = [other for other, _ in holes if other is not polygon and _surrounds(other, polygon[0])]
        if around or not _surrounds(outer, polygon[0]):
            return f"the hole near {names[0]} does not lie in the table"
    return None


def _surrounds(polygon: list[Corner], point: Corner) -> bool:
    """Does the point lie inside the polygon? A ray to the right crosses it an odd number of times."""
    inside = False
    for a, b in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
        if (a[1] > point[1]) != (b[1] > point[1]):
            inside ^= (_side(a, b, point) > 0) == (b[1] > a[1])
    return inside


def _corners(table: Table, parts: int) -> tuple[list[Corner], list[str]]:
    count = max(2, CORNERS // parts)  # off the ends, where curves of a symmetric table like to meet
    corners, names = [], []
    for component in table.components:
        for k in range(count):
            value = component.start + (component.end - component.start) * Rational(3 * k + 1, 3 * count)
            x, y = (Rational(_evaluated(coordinate, value)) for coordinate in component.point)
            corners.append((x.p * FINE // x.q, y.p * FINE // y.q))
            names.append(f"{component.name} at theta = {value}")
    return corners, names


def _evaluated(coordinate: Expr, value: Expr) -> Expr:
    """A coordinate with 20 digits, without exact values of its sines, for which SymPy takes long."""
    return coordinate.evalf(20, subs={theta: value})


def _turns(corners: list[Corner]) -> int:
    """How often the polygon's direction turns round, either way: once where it is simple (Hopf)."""
    total = fsum(
        atan2(_side(a, b, c), (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]))
        for a, b, c in zip(corners[-2:] + corners[:-2], corners[-1:] + corners[:-1], corners, strict=True)
    )
    return round(abs(total) / tau)


def _cross(a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    """Do the open segments `ab` and `cd` cross?"""
    return _side(a, b, c) * _side(a, b, d) < 0 and _side(c, d, a) * _side(c, d, b) < 0


def _side(a: Corner, b: Corner, c: Corner) -> int:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
