"""Finite Fourier sums by their coefficients: multiplied as sequences of fractions, where SymPy would multiply out.

`(1 + cos(theta))**64` has 129 coefficients and millions of terms on SymPy's way to them.
"""

from fractions import Fraction
from functools import lru_cache

from sympy import Add, Expr, I, Mul, Pow, Rational, S, Symbol, cos, sin

from symbolic.tables.table import theta

Pair = tuple[Fraction, Fraction]  # real and imaginary part
Waves = dict[int, Pair]  # of exp(i*k*theta), by k; none of them 0
PRODUCTS = 150_000  # of two coefficients, in one formula: about a second
ZERO = Fraction(0)
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
        found = _read(expression, [PRODUCTS])
    except _TooLongError:  # treated as any other formula, that is not multiplied out
        return None
    return None if found is None else dict(sorted(found.items()))


def _read(e: Expr, left: list[int]) -> Waves | None:
    """The coefficients, operand by operand; `left` holds how many products may still be made."""
    if isinstance(e, Rational):
        return {0: (Fraction(e.p, e.q), ZERO)} if e.p else {}
    if e is I:
        return {0: (ZERO, Fraction(1))}
    if isinstance(e, cos | sin):
        multiple = e.args[0] / theta
        if not multiple.is_Integer:
            return None
        k, half = int(multiple), Fraction(1, 2)
        return {-k: (half, ZERO), k: (half, ZERO)} if isinstance(e, cos) else {-k: (ZERO, half), k: (ZERO, -half)}
    if isinstance(e, Pow):
        base = _read(e.base, left) if e.exp.is_Integer and e.exp.is_positive else None
        return None if base is None else _power(base, int(e.exp), left)
    if not isinstance(e, Add | Mul):
        return None
    parts = []
    for operand in e.args:
        part = _read(operand, left)
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
        u, v = total.get(k, (ZERO, ZERO))
        total[k] = u + x, v + y
    return {k: c for k, c in total.items() if c[0] or c[1]}


def _product(f: Waves, g: Waves, left: list[int]) -> Waves:
    left[0] -= len(f) * len(g)
    if left[0] < 0:
        raise _TooLongError
    total: Waves = {}
    for k, (a, b) in f.items():
        for n, (x, y) in g.items():
            u, v = total.get(k + n, (ZERO, ZERO))
            real, imaginary = a * x, b * x
            if y:
                real, imaginary = real - b * y, imaginary + a * y
            total[k + n] = u + real, v + imaginary
    return {k: c for k, c in total.items() if c[0] or c[1]}


def _power(f: Waves, n: int, left: list[int]) -> Waves:
    found: Waves = {0: (Fraction(1), ZERO)}
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


def alone(expression: Expr, x: Symbol = theta) -> bool:
    """Has the expression no letter but `x`?"""
    return bool(S(expression).free_symbols <= {x})
