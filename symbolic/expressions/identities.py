"""Normal forms in which an expression that vanishes is 0.

An expression built from rational operations, square roots, and sines and cosines of multiples of a few angles is a
rational function on an algebraic variety: `sin**2 + cos**2 = 1`, `r**2 = x` for each root. Without roots a ring of
polynomials decides whether it is 0. With them, reducing its numerator modulo these relations to 0 proves the identity,
and a failed reduction refutes nothing.
"""

from functools import cache, reduce
from typing import Any

from sympy import (
    QQ,
    Add,
    Dummy,
    Expr,
    Mul,
    Poly,
    Pow,
    Rational,
    S,
    Symbol,
    cos,
    expand,
    expand_trig,
    gcd_list,
    preorder_traversal,
    sin,
    sqrt,
    symbols,
    tan,
    together,
)
from sympy.polys.fields import field
from sympy.polys.polyerrors import PolynomialError
from sympy.polys.rings import PolyElement, ring

Element = tuple[Any, Any]  # the pair (p, q) for `p + q*r`


def is_zero_in_ring(expression: Expr) -> bool | None:
    """Is a rational function of symbols, sines, cosines and square roots 0? None if this is not decided.

    Let `g` be the common divisor of the multiples of a symbol `x` in the angles. Then sine and cosine of `g*x` are
    generators of a ring, as are the symbols. Their only relation is `s**2 + c**2 = 1`, so that without roots both
    answers are proved. Each root, and `I`, is a further generator with a known square. As roots may satisfy further
    relations, a result that is not 0 then decides nothing.

    >>> x, y = symbols("x y")
    >>> is_zero_in_ring(sin(x + 2 * y) ** 2 + cos(2 * y + x) ** 2 - 1), is_zero_in_ring(tan(x) - sin(x))
    (True, False)
    >>> from sympy import sqrt
    >>> is_zero_in_ring((x - 1) / (sqrt(x) + 1) - sqrt(x) + 1), is_zero_in_ring(sqrt(x) * sqrt(y) - sqrt(x * y))
    (True, None)
    """
    angles = {f.args[0] for f in expression.atoms(sin, cos, tan)}
    words = (Add, Mul, Pow, Rational, Symbol, sin, cos, tan)
    roots: dict[Expr, Expr] = {}  # generators by their radicands
    for node in preorder_traversal(expression):
        if node is S.ImaginaryUnit or _is_root(node):
            roots.setdefault(S.NegativeOne if node is S.ImaginaryUnit else node.base, Dummy("root"))
        elif not isinstance(node, words) or (node.func is Pow and not node.exp.is_Integer):
            return None
    parts = {angle: expand(angle).as_coefficients_dict() for angle in angles}
    if not all(x.is_Symbol and q.is_Rational for part in parts.values() for x, q in part.items()):
        return None
    shares = {x: gcd_list([part[x] for part in parts.values() if x in part]) for part in parts.values() for x in part}
    circle = {x: symbols(f"cos_{x} sin_{x}", cls=Dummy) for x in shares}
    letters = sorted(expression.free_symbols, key=str)
    names = [*letters, *(each for pair in circle.values() for each in pair), *roots.values()]
    if not names:
        return None
    own = ring(names, QQ)[0]
    generator = dict(zip(names, own.gens, strict=True))
    squares = [(own.gens.index(generator[s]), own.one - generator[c] ** 2) for c, s in circle.values()]

    def reduced(p: PolyElement) -> PolyElement:
        """`p` reduced until it is at most linear in each root and each sine."""
        for place, square in squares:
            found: dict[int, dict[tuple[int, ...], Any]] = {}
            for powers, coefficient in p.terms():
                rest = (*powers[:place], powers[place] % 2, *powers[place + 1 :])
                found.setdefault(powers[place] // 2, {})[rest] = coefficient
            if found.keys() - {0}:
                p = sum((own.from_dict(part) * square**k for k, part in found.items()), own.zero)
        return p

    def turned(angle: Expr) -> tuple[PolyElement, PolyElement]:
        """Cosine and sine of an angle, by the addition theorem."""
        c, s = own.one, own.zero
        for x, q in parts[angle].items():
            c1, s1 = (generator[each] for each in circle[x])
            s1 = s1 if q > 0 else -s1
            for _ in range(abs(q / shares[x])):
                c, s = reduced(c * c1 - s * s1), reduced(c * s1 + s * c1)
        return c, s

    trigonometric = {angle: turned(angle) for angle in angles}

    @cache
    def quotient(node: Expr) -> tuple[PolyElement, PolyElement]:
        if node.is_Rational:
            return own(QQ(node.p, node.q)), own.one
        if node.is_Symbol:
            return generator[node], own.one
        if isinstance(node, (sin, cos, tan)):
            c, s = trigonometric[node.args[0]]
            return {sin: (s, own.one), cos: (c, own.one), tan: (s, c)}[node.func]
        if node is S.ImaginaryUnit:
            return generator[roots[S.NegativeOne]], own.one
        if isinstance(node, Pow):
            top, bottom = quotient(node.base) if node.exp.is_Integer else (generator[roots[node.base]], own.one)
            power = int(node.exp.p)
            top, bottom = (top, bottom) if power > 0 else (bottom, top)
            return reduced(top ** abs(power)), reduced(bottom ** abs(power))
        top, bottom = quotient(node.args[0])
        for part in node.args[1:]:
            p, q = quotient(part)
            if isinstance(node, Mul):
                top, bottom = reduced(top * p), reduced(bottom * q)
            else:
                common = bottom.gcd(q)
                left, right = q.quo(common), bottom.quo(common)
                top, bottom = reduced(top * left + p * right), reduced(bottom * left)
            if not bottom:
                raise ZeroDivisionError
        return top, bottom

    try:
        for base in sorted(roots, key=Expr.count_ops):
            top, bottom = quotient(base)
            if not bottom.is_ground:
                return None
            squares.insert(0, (own.gens.index(generator[roots[base]]), top.quo_ground(bottom.LC)))
        zero = not quotient(expression)[0]
    except ZeroDivisionError:
        return None
    return zero or (None if roots else False)


def over_one_root(expression: Expr) -> Expr | None:
    """A rational function of symbols and one square root `r` as `p + q*r`, in lowest terms; None for other expressions.

    The field of rational functions is extended by `r`, whose square is known; `1/(p + q*r)` is the conjugate divided by
    the norm.

    >>> from sympy import sqrt
    >>> x = symbols("x")
    >>> over_one_root((x**2 - 2) / (x - sqrt(2))), over_one_root(1 / (1 + sqrt(1 - x**2)))
    (x + sqrt(2), -sqrt(1 - x**2)/x**2 + x**(-2))
    """
    bases = {power.base for power in expression.atoms(Pow) if _is_root(power)}
    if len(bases) != 1:
        return None
    (base,) = bases
    letters = sorted(expression.free_symbols, key=str)
    numbers = field(letters or [Dummy("x")], QQ)[0]
    generator = dict(zip(letters, numbers.gens, strict=False))
    zero, one = numbers(0), numbers(1)

    def product(left: Element, right: Element) -> Element:
        (p, q), (u, v) = left, right
        return (p * u + q * v * square, p * v + q * u) if q or v else (p * u, zero)

    def power(element: Element, exponent: int) -> Element:
        p, q = element
        if exponent < 0:
            norm = p**2 - q**2 * square
            element = p / norm, -q / norm
        return reduce(product, [element] * abs(exponent), (one, zero))

    def read(node: Expr) -> Element:
        if node.is_Rational:
            return numbers(QQ(node.p, node.q)), zero
        if node.is_Symbol:
            return generator[node], zero
        if isinstance(node, Add):
            parts = [read(part) for part in node.args]
            return sum((p for p, _ in parts), zero), sum((q for _, q in parts), zero)
        if isinstance(node, Mul):
            return reduce(product, map(read, node.args))
        if isinstance(node, Pow) and node.exp.is_Integer:
            return power(read(node.base), int(node.exp))
        if isinstance(node, Pow) and node.base == base:
            return product((zero, one), power((square, zero), int(node.exp - S.Half)))
        raise PolynomialError

    square = zero
    try:
        square = read(base)[0]
        rational, irrational = read(expression)
    except (PolynomialError, ZeroDivisionError):
        return None
    return S(rational.as_expr()) + S(irrational.as_expr()) * sqrt(base)


def reduced_numerator(expression: Expr) -> Expr:
    """The numerator of `expression`, expanded, with powers of its sines and square roots reduced by their squares.

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
    """A half-integer power, with powers of sines in its base reduced and its rational factor taken out."""
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
