"""Proofs that an expression vanishes identically.

An expression built from rational operations, square roots, and sines and cosines of multiples of
a few angles is a rational function on an algebraic variety: `sin**2 + cos**2 = 1`, `r**2 = x` for
each root. Reducing its numerator modulo these relations to 0 proves the identity. A failed
reduction refutes nothing.
"""

from sympy import Expr, Poly, Pow, S, Symbol, cos, expand, expand_trig, minimal_polynomial, sin, tan, together
from sympy.polys.polyerrors import PolynomialError


def vanishes(expression: Expr) -> bool:
    """True when `expression` is proved to be 0 wherever it is defined; False when it is not proved.

    >>> from sympy import Rational, sqrt
    >>> from symbolic.tables.symbols import theta
    >>> vanishes(4 * cos(theta) ** 3 - 3 * cos(theta) - cos(3 * theta))
    True
    >>> vanishes(sqrt(5 + 2 * sqrt(6)) - sqrt(2) - sqrt(3))
    True
    >>> vanishes(cos(theta) - 1)
    False
    """
    expression = S(expression)
    if expression.is_zero:
        return True
    numerator = reduced_numerator(expression)
    if numerator == 0:
        return True
    if not numerator.free_symbols and numerator.is_algebraic:
        return bool(minimal_polynomial(numerator, Symbol("x")) == Symbol("x"))
    return False


def reduced_numerator(expression: Expr) -> Expr:
    """The numerator of `expression` in lowest powers of its sines and square roots.

    >>> from sympy import sqrt
    >>> reduced_numerator(1 / sqrt(2) - sqrt(2) / 2)
    0
    """
    expression = expand_trig(expand(expression.replace(tan, lambda x: sin(x) / cos(x))))
    expression = expression.replace(_is_root, _standard_root)
    numerator = expand(together(expression).as_numer_denom()[0])
    numerator = _without_squared_sines(numerator)
    roots = {p for p in numerator.atoms(Pow) if _is_root(p)}
    bases = sorted({p.base for p in roots}, key=lambda base: (-base.count_ops(), str(base)))
    for base in bases:
        root = Symbol("root", nonnegative=True)
        named = numerator.xreplace({p: root ** (2 * p.exp) for p in roots if p.base == base})
        named = expand(together(named).as_numer_denom()[0])
        numerator = expand(_remainder(named, root, base).subs(root, base**S.Half))
        numerator = expand(together(numerator).as_numer_denom()[0])
    return _without_squared_sines(numerator)


def _is_root(expression: Expr) -> bool:
    return isinstance(expression, Pow) and expression.exp.is_Rational and expression.exp.q == 2


def _standard_root(power: Expr) -> Expr:
    """A half-integer power with its base reduced and freed of rational factors."""
    content, base = _without_squared_sines(power.base).as_content_primitive()
    return content**power.exp * base**power.exp


def _without_squared_sines(expression: Expr) -> Expr:
    expression = expand(expression)
    for angle in sorted({f.args[0] for f in expression.atoms(sin)}, key=str):
        expression = _remainder(expression, sin(angle), 1 - cos(angle) ** 2)
    return expression


def _remainder(expression: Expr, generator: Expr, square: Expr) -> Expr:
    """`expression` with `generator**2` replaced by `square` until it is at most linear in it."""
    try:
        terms = Poly(expression, generator).all_coeffs()[::-1]
    except PolynomialError:
        return expression
    even = sum((c * square ** (k // 2) for k, c in enumerate(terms) if k % 2 == 0), S.Zero)
    odd = sum((c * square ** (k // 2) for k, c in enumerate(terms) if k % 2 == 1), S.Zero)
    return expand(even + odd * generator)
