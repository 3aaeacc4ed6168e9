"""Checks that a boundary bounds a table: exact, closed, counterclockwise, free of self-crossings, holes within it.

Every check is a proof. For a table with letters (shape parameters without values) it covers their ranges, but does not
exclude self-crossings: these, and whatever the first checks leave open, are excluded when the letters get values.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

from sympy import (
    Abs,
    Dummy,
    Expr,
    Float,
    I,
    Interval,
    Poly,
    Pow,
    Rational,
    S,
    Symbol,
    cos,
    expand,
    factor_list,
    floor,
    integrate,
    nan,
    oo,
    pi,
    sign,
    sin,
    sqrt,
    tan,
    together,
    zoo,
)

from symbolic.expressions.enclosures import ONE, Enclosures, UnboundedError, pole, sign_in, sign_on
from symbolic.expressions.signs import Box, Outcome, conjunction, positive
from symbolic.tables.arcs import MANY, FourierSum
from symbolic.tables.curves import (
    LONG,
    alone,
    curves,
    is_periodic,
    size,
    trigonometric,
    waves,
)
from symbolic.tables.geometry import coefficients, in_half_tangent
from symbolic.tables.polynomial import as_bezier, bound_a_table, signed_area
from symbolic.tables.simplicity import prove_simple
from symbolic.tables.table import Component, Table, lam, theta

HIGHEST_HARMONIC = 8  # of a radius whose sign Sturm's theorem gives
Ranges = Mapping[Symbol, tuple[Expr, Expr]]  # both ends of the range of each letter
TURN = Rational(7, 2)  # beyond pi: what holds from -TURN to TURN holds for every angle


@lru_cache(maxsize=64)
def validated(table: Table) -> Table:
    """`table` after all checks, with the package's symbols for `theta` and shape; `ValueError` if it is no table."""
    return counterclockwise_and_simple(closed_and_finite(table))


def counterclockwise_and_simple(table: Table) -> Table:
    """`table`, checked to be counterclockwise and, if it has no free parameters, simple; otherwise `ValueError`."""
    _counterclockwise(table)
    if not table.shapes:
        simple(table)
    return table


def closed_and_finite(table: Table) -> Table:
    """`table` with the package's symbols, checked to be finite and closed; `ValueError` if it is not."""
    if not table.components:
        raise ValueError(f"{table.name}: a table needs at least one component, and none is given")
    table = replace(table, components=tuple(_own_letters(table, c) for c in table.components))
    for component in table.components:
        _finite(table, component)
    _closed(table)
    return table


def positive_radius(name: str, rho: Expr) -> bool:
    """True when `rho(theta) > 0` is proved; `ValueError` when it is refuted.

    >>> positive_radius("flower", 1 + cos(5 * theta) / 40)
    True
    """
    outcome = radius_sign(rho)
    if outcome is Outcome.REFUTED:
        wanted = "a polar table needs rho > 0, or its cusp named"
        raise ValueError(f"{name}: rho = {rho} is not positive for every theta; {wanted}")
    return outcome is Outcome.PROVED


def radius_sign(rho: Expr) -> Outcome:
    """Is `rho(theta) > 0` for every theta? A polar curve is then simple and counterclockwise.

    Low harmonics are judged by Sturm's theorem, long finite sums by their coefficients, all else by enclosures.
    """
    found = waves(rho)
    if found is not None and len(found) >= MANY:
        return FourierSum(found, 0).sign(-TURN, TURN)
    c = coefficients(rho) or {}
    if c and c.get(0, S.Zero) > sum(abs(value) for k, value in c.items() if k):
        return Outcome.PROVED
    half = in_half_tangent(rho) if max(map(abs, c), default=0) <= HIGHEST_HARMONIC else None
    if half is None:
        if alone(rho) and not rho.is_number:
            try:
                return sign_on(rho, theta, -TURN, TURN).outcome
            except UnboundedError:
                pass
        return Outcome.PROVED if rho.is_positive else Outcome.UNKNOWN
    polynomial, T, at_pi = half
    sides = (positive(polynomial.subs(T, s * T), {T: Interval(0, oo)}) for s in (1, -1))
    return conjunction(positive(at_pi, {}), *sides).outcome


def radius_over(table: Table) -> bool:
    """Is the radius of a polar table proved positive for every value of its free shape parameters?

    If it is refuted, raises `ValueError` with a value of the parameters.
    """
    rho = table.components[0].radius
    if rho is None or not all_angles(table.components[0], rho):
        return False
    ranges = {p.symbol: (p.range.start, p.range.end) for p in table.shapes}
    found = sign_in(rho, {theta: (-TURN, TURN), **ranges})
    if found.outcome is Outcome.REFUTED and not table.undefined:
        at = ((x, value - 2 * pi * floor((value + pi) / (2 * pi)) if x == theta else value) for x, value in found.at)
        where = ", ".join(f"{symbol} = {value.evalf(6)}" for symbol, value in at)
        raise ValueError(f"{table.name}: rho = {rho} is not positive at {where}")
    return found.outcome is Outcome.PROVED


def _own_letters(table: Table, component: Component) -> Component:
    allowed = {theta.name: theta} | {p.symbol.name: p.symbol for p in table.shapes}
    allowed |= {str(s): s for p in table.shapes for s in p.range.free_symbols}
    renamed = {}
    for expression in (*component.point, component.start, component.end):
        if expression.has(Float):
            raise ValueError(f"{table.name}: {expression} contains a rounded float; write 2/25 or '0.08', not 0.08")
        if expression.has(I, nan, oo, -oo, zoo):
            raise ValueError(f"{table.name}: {expression} is no finite real expression")
        for symbol in sorted(expression.free_symbols, key=str):
            if symbol.name not in allowed:
                accepted = ", ".join(sorted(allowed))
                raise ValueError(f"{table.name}: unknown symbol {symbol} in {expression}; it may use: {accepted}")
            if symbol != allowed[symbol.name]:
                renamed[symbol] = allowed[symbol.name]
    if not renamed:
        return component
    x, y = (coordinate.xreplace(renamed) for coordinate in component.point)
    return replace(
        component, point=(x, y), start=component.start.xreplace(renamed), end=component.end.xreplace(renamed)
    )


def _finite(table: Table, component: Component) -> None:
    start, end = component.start, component.end
    box = {p.symbol: p.range for p in table.shapes}
    if start.has(theta) or end.has(theta) or not ((end - start).is_positive or is_positive(end - start, box)):
        raise ValueError(
            f"{table.name}: {component.name} runs from theta = {start} to {end}; the end must be a larger number"
        )
    if not any(coordinate.has(theta) for coordinate in component.point):
        x, y = component.point
        raise ValueError(f"{table.name}: {component.name} is the single point ({x}, {y}), of length 0; leave it out")
    for coordinate in component.point:
        if coordinate.is_polynomial(theta) or waves(coordinate) is not None:
            continue
        if size(coordinate) > LONG:
            low, high = (Rational(str(end.evalf(20))) if end.is_number else None for end in (start, component.end))
            divisor = pole(coordinate, theta, low, high) if low is not None and high is not None else None
            if divisor is not None:
                raise ValueError(f"{table.name}: {component.name} has a pole, where {divisor} = 0; it must be finite")
            continue
        below = together(coordinate.replace(tan, lambda x: sin(x) / cos(x))).as_numer_denom()[1]
        half = in_half_tangent(below) if below.has(theta) else None
        if half is None:
            continue
        polynomial, T, at_pi = half
        roots = Poly(polynomial, T).count_roots() if not table.shapes else 0
        if roots or at_pi.is_zero:
            raise ValueError(f"{table.name}: {coordinate} has a pole, where {below} = 0; a boundary must be finite")


def _closed(table: Table) -> None:
    curves(table)


def _counterclockwise(table: Table) -> None:
    outer, *holes = curves(table)
    area = enclosed_area(replace(table, components=outer))
    ranges = {p.symbol: p.range for p in table.shapes}
    for hole in holes:
        inside = enclosed_area(replace(table, components=hole))
        if inside is not None and not inside.free_symbols and not inside.is_negative:
            raise ValueError(f"{table.name}: the hole that begins with {hole[0].name} must run clockwise")
    if area is None or any(r.free_symbols for r in ranges.values()):
        return
    if area.is_zero:
        raise ValueError(f"{table.name}: the boundary encloses area 0; it crosses itself or runs back along itself")
    if area.is_negative or (ranges and positive(area, ranges).outcome is Outcome.REFUTED):
        raise ValueError(f"{table.name}: the boundary runs clockwise; exchange theta for -theta")


def enclosed_area(table: Table) -> Expr | None:
    """The area by Green's formula, negative for a clockwise boundary; None when it is too hard to integrate.

    >>> from symbolic.tables import cardioid, cuspless
    >>> enclosed_area(cardioid), enclosed_area(cuspless)
    (3*pi/2, 15*sqrt(3)/16 + pi)
    """
    total = S.Zero
    for component in table.components:
        x, y = component.point
        piece = as_bezier(component)
        if piece is not None:
            part = signed_area([piece])
            total += S(part)
            continue
        found = waves(x + I * y)
        if found is not None and component.end - component.start == 2 * pi:
            swept = sum(k * (u * u + v * v) for k, (u, v) in found.items())
            total += pi * S(swept)
            continue
        powers = [p for p in x.atoms(Pow) | y.atoms(Pow) if p.has(theta)]
        if size(x) + size(y) > LONG or not all(p.exp.is_Integer and p.exp > 0 for p in powers):
            return None  # SymPy would expand quotients and roots for minutes, and integrate none of them
        swept = expand(x * y.diff(theta) - y * x.diff(theta))
        harmonics = None if swept.is_polynomial(theta) else coefficients(swept)
        if harmonics is not None and component.end - component.start == 2 * pi:
            total += pi * harmonics.get(0, S.Zero)  # the others integrate to 0
            continue
        if harmonics is None and not swept.is_polynomial(theta):
            return None
        total += integrate(trigonometric(swept), (theta, component.start, component.end)) / 2
    return expand(total)


@lru_cache(maxsize=64)
def simple(table: Table) -> bool:
    """True if the boundary is proved to bound a table, False if it has free parameters; `ValueError` for no proof."""
    if any(c.free_symbols - {theta} for component in table.components for c in component.point):
        return False
    _prove(table, {})
    return True


def prove_table(table: Table, ranges: Ranges | None = None) -> None:
    """Proves that a boundary bounds a table for all parameters in `ranges`; `ValueError`, with the place, if that
    fails.

    It is proved that the boundary is closed identically in the parameters, simple and counterclockwise, and that its
    holes are clockwise, lie in it, and meet neither it nor one another. `ranges` has both ends of the range of every
    parameter, by default those of the table's shape parameters. The proof is by a positive radius, or by disjoint boxes
    round pieces that are polynomials of degree three; for all other boundaries it is that of
    `symbolic.tables.simplicity`.

    >>> from symbolic.tables import ellipse, stadium
    >>> from symbolic.tables.table import a
    >>> prove_table(stadium()), prove_table(ellipse, {a: (1, 3)})
    (None, None)
    """
    within = {p.symbol: (p.range.start, p.range.end) for p in table.shapes} if ranges is None else ranges
    ends = {letter: (S(low), S(high)) for letter, (low, high) in within.items()}
    for letter, (low, high) in ends.items():
        if not (low.is_finite and high.is_finite and (high - low).is_nonnegative):
            raise ValueError(f"{table.name}: {letter} from {low} to {high} is no range; give two finite numbers")
    _prove_over(table, tuple(ends.items()))


@lru_cache(maxsize=64)
def _prove_over(table: Table, ends: tuple[tuple[Symbol, tuple[Expr, Expr]], ...]) -> None:
    _prove(closed_and_finite(table), dict(ends))


def _prove(table: Table, ends: Ranges) -> None:
    """Proves what `prove_table` does for a finite, closed boundary; `ends` are the ranges of its parameters."""
    whole = table.components[0]
    if len(table.components) == 1 and not table.undefined and whole.end - whole.start == 2 * pi:
        x, y = whole.point
        if _is_polar(x, y) and all_angles(whole, rho := _radius(x, y)) and _positive_radius(rho, ends):
            return
    rings = [[as_bezier(component) for component in ring] for ring in curves(table)]
    known = [[piece for piece in ring if piece is not None] for ring in rings]
    if rings != known or not bound_a_table(known):
        prove_simple(table, ends)


def all_angles(component: Component, rho: Expr) -> bool:
    """Does what holds for the radius from `-TURN` to `TURN` hold on the whole component?"""
    return is_periodic(rho) or bool(component.start >= -TURN and component.end <= TURN)


def _positive_radius(rho: Expr, ranges: Ranges) -> bool:
    if not ranges:
        return radius_sign(rho) is Outcome.PROVED
    bounds = {x: [each for end in Enclosures(ends)() for each in end] for x, ends in ranges.items()}
    try:
        within = {x: (Rational(min(ends), ONE), Rational(max(ends), ONE)) for x, ends in bounds.items()}
        return bool(sign_in(rho, {theta: (-TURN, TURN), **within}))
    except UnboundedError:
        return False


def _is_polar(x: Expr, y: Expr) -> bool:
    """Is `theta` the polar angle of the point `(x, y)`?"""
    across = y * cos(theta) - x * sin(theta)
    found = waves(across)
    if found is not None or size(across) > LONG:
        return found == {}
    return bool(trigonometric(across) == 0)


def _radius(x: Expr, y: Expr) -> Expr:
    radius = x * cos(theta) + y * sin(theta)
    return radius if waves(radius) is not None or size(radius) > LONG else trigonometric(radius)


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
        share = sqrt(abs(constant))
        outside, constant = (outside * share**way, sign(constant)) if share.is_Rational else (outside, constant)
        inside *= constant**way
        for factor, power in factors:
            inside *= factor ** (way * (power % 2))
            outside *= modulus(factor, box) ** (way * (power // 2))
    return outside * sqrt(inside)


def modulus(expression: Expr, box: Box) -> Expr:
    """`|expression|` of a polynomial, resolved when its sign inside the box is proved; at the ends it may vanish.

    >>> x = Symbol("x", real=True)
    >>> modulus(x, {x: Interval(0, 1)}), modulus(x, {x: Interval(-1, 1)})
    (x, Abs(x))
    """
    box = {letter: r if r.start == r.end else Interval.open(r.start, r.end) for letter, r in box.items()}
    if is_positive(expression, box):
        return expression
    return -expression if is_positive(-expression, box) else Abs(expression)


def is_positive(expression: Expr, box: Box) -> bool:
    """True if `expression > 0` is proved on the box; the ends of intervals may depend on an integer `K >= 1`."""
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
