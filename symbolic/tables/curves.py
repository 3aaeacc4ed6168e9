"""The closed curves of a boundary, and finite Fourier sums by their coefficients.

Sums are multiplied as lists of rational coefficients, because SymPy would multiply out their terms:
`(1 + cos(theta))**64` has 129 coefficients, and SymPy makes millions of terms on its way to them.
"""

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache
from typing import Any

from sympy import (
    QQ,
    Add,
    Dummy,
    Expr,
    I,
    Mul,
    Pow,
    Rational,
    S,
    Symbol,
    cos,
    expand,
    pi,
    sin,
)
from sympy.polys.rings import ring
from sympy.simplify.fu import TR8

from symbolic.expressions.enclosures import Enclosures, UnboundedError
from symbolic.expressions.signs import vanishes
from symbolic.tables.polynomial import fraction, rational_coefficients, value_of
from symbolic.tables.table import Component, Table, theta

Pair = tuple[Fraction, Fraction]  # real and imaginary part
Waves = dict[int, Pair]  # the nonzero coefficients of exp(i*k*theta), by k
PRODUCTS = 150_000  # most products of two coefficients in one formula: about a second
EMPTY: Mapping[Symbol, Any] = {}
LONG = 200  # operations, names and numbers: what is longer is not multiplied out by SymPy


class _TooLongError(Exception):
    """The error that a sum needs more products of coefficients than can be made in about a second."""


@lru_cache(maxsize=256)
def waves(expression: Expr) -> Waves | None:
    """Coefficients of `exp(i*k*theta)` in a trigonometric polynomial with rational numbers, by `k`; None for others.

    The result is None, too, if more than `PRODUCTS` products of coefficients would be needed.

    >>> waves(2 * cos(theta) ** 2)
    {-2: (Fraction(1, 2), Fraction(0, 1)), 0: (Fraction(1, 1), Fraction(0, 1)), 2: (Fraction(1, 2), Fraction(0, 1))}
    >>> waves(1 / (2 + cos(theta))) is None
    True
    """
    try:
        found = _read(expression, [PRODUCTS], Fraction)
    except _TooLongError:  # treated like a formula that is not a trigonometric polynomial
        return None
    return None if found is None else dict(sorted(found.items()))


def trigonometric(expression: Expr) -> Expr:
    """A trigonometric polynomial as a sum of sines and cosines of multiples of `theta`; others are only expanded.

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
    """The sum of `trigonometric` for a real polynomial, with or without symbols in its coefficients; else None."""
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
    """The coefficients of `e`, by recursion over its operands; `left[0]` is the number of products still allowed.

    `number(p, q)` gives `p/q` in the ring of the coefficients; `letters` maps symbols to generators of the ring.
    """
    zero = number(0, 1)
    if isinstance(e, Rational):
        return {0: (number(e.p, e.q), zero)} if e.p else {}
    if e in letters:
        return {0: (letters[e], zero)}
    if e is I:
        return {0: (zero, number(1, 1))}
    if isinstance(e, cos | sin):
        multiple, angle = e.args[0].as_coeff_Mul()
        if angle is not theta or not multiple.is_Integer:
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
    if isinstance(e, Add):
        return _sum(parts)
    found = parts[0]
    for part in parts[1:]:
        found = _product(found, part, left)
    return found


def _sum(parts: list[Waves]) -> Waves:
    total: Waves = {}
    for part in parts:
        for k, (x, y) in part.items():
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
    """A complex coefficient, a pair of fractions, as a SymPy number."""
    return Rational(c[0].numerator, c[0].denominator) + I * Rational(c[1].numerator, c[1].denominator)


def highest(found: Waves) -> int:
    """The largest modulus of `k` among the coefficients; 0 if there are none."""
    return max((abs(k) for k in found), default=0)


def is_periodic(expression: Expr) -> bool:
    """Does `theta` occur only in sines and cosines of its whole multiples, so that the period is `2*pi`?

    >>> is_periodic(cos(cos(3 * theta)) / (2 + sin(theta))), is_periodic(theta), is_periodic(cos(theta / 2))
    (True, False, False)
    """
    if isinstance(expression, cos | sin):
        multiple, angle = expression.args[0].as_coeff_Mul()
        if angle is theta and multiple.is_Integer:
            return True
    return expression is not theta and all(is_periodic(part) for part in expression.args)


@lru_cache(maxsize=4096)
def size(expression: Expr) -> int:
    """The number of operations, names and numbers in an expression, repetitions counted."""
    return 1 + sum(size(part) for part in expression.args)


PLACES = Rational(1, 3), Rational(13, 11)  # values of theta that `varies` compares


def varies(value: Expr) -> bool:
    """True if `value` is proved to differ at two values of `theta`, so that it is not constant; nothing is expanded.

    False proves nothing: other symbols are given the value 1/20, where `value` may be undefined.

    >>> varies(cos(theta)), varies(cos(theta) ** 2 + sin(theta) ** 2)
    (True, False)
    """
    letters = sorted(value.free_symbols - {theta}, key=str)
    try:
        at = Enclosures([value], theta, *letters)
    except UnboundedError:
        return False
    (one,), (other,) = (at(*Enclosures([place, *([Rational(1, 20)] * len(letters))])()) for place in PLACES)
    return one[1] < other[0] or other[1] < one[0]


def alone(expression: Expr, x: Symbol = theta) -> bool:
    """Does the expression contain no symbol but `x`?"""
    return bool(S(expression).free_symbols <= {x})


@lru_cache(maxsize=16)
def curves(table: Table) -> tuple[tuple[Component, ...], ...]:
    """The closed curves of a boundary, each as its components in order: the outer one first, then the holes.

    A curve ends where it returns to its first point; `ValueError` for a chain that does not return.

    >>> from symbolic.tables import cuspless
    >>> [[component.name for component in curve] for curve in curves(cuspless)]
    [['arc', 'wall']]
    """
    only = table.components[0]
    if len(table.components) == 1 and only.end - only.start == 2 * pi and all(map(is_periodic, only.point)):
        return (table.components,)
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
    return tuple(found)


def _meet(before: Component, after: Component) -> bool:
    exact = S(before.end).is_Rational and S(after.start).is_Rational
    if exact and (rows := rational_coefficients(before)) and (others := rational_coefficients(after)):
        last, first = map(fraction, (before.end, after.start))
        return all(value_of(p, last) == value_of(q, first) for p, q in zip(rows, others, strict=True))
    pairs = zip(before.at(before.end), after.at(after.start), strict=True)
    return all(p == q or vanishes(p - q) for p, q in pairs)
