"""The ranges of the letters, and square roots resolved by a proof of sign on them."""

from sympy import Abs, Dummy, Expr, Interval, S, Symbol, factor_list, oo, sqrt, together

from symbolic.proofs.signs import Box, positive
from symbolic.tables.symbols import lam
from symbolic.tables.table import Table

UNIT = Interval(0, 1)


def parameter_box(table: Table) -> dict[Symbol, Interval]:
    """The closed range of every free shape parameter and of the contraction.

    >>> from symbolic.tables import ellipse
    >>> parameter_box(ellipse)
    {a: Interval(1, oo), lam: Interval(0, 1)}
    """
    return {shape.symbol: shape.range for shape in table.shapes} | {lam: UNIT}


def root(square: Expr, box: Box) -> Expr:
    """`sqrt(square)`, with every squared factor taken out by its proved sign on the box.

    >>> x = Symbol("x", real=True)
    >>> root(x**2 - 2 * x + 1, {x: Interval(2, 3)}), root(x**3 + x, {x: Interval(2, 3)})
    (x - 1, sqrt(x)*sqrt(x**2 + 1))
    """
    numerator, denominator = together(square).as_numer_denom()
    outside, inside = S.One, S.One
    for part, way in ((numerator, 1), (denominator, -1)):
        constant, factors = factor_list(part)
        inside *= constant**way
        for factor, power in factors:
            inside *= factor ** (way * (power % 2))
            outside *= modulus(factor, box) ** (way * (power // 2))
    return outside * sqrt(inside)


def modulus(expression: Expr, box: Box) -> Expr:
    """`|expression|`, resolved when its sign on the box is proved."""
    if is_positive(expression, box):
        return expression
    return -expression if is_positive(-expression, box) else Abs(expression)


def is_positive(expression: Expr, box: Box) -> bool:
    """True when `expression > 0` is proved on the box, whose ends may depend on an integer `K >= 1`."""
    reach: dict[Symbol, Interval] = {}
    for symbol, interval in box.items():
        if interval.end.free_symbols:
            share = Dummy("share", nonnegative=True)
            expression = expression.subs(symbol, share * interval.end)
            reach |= {share: UNIT} | {K: Interval(1, oo) for K in interval.end.free_symbols}
        else:
            reach[symbol] = interval
    if not expression.free_symbols <= set(reach):
        return False
    return bool(positive(S(expression), reach))
