"""Proofs that an expression vanishes identically, and of the sign of a polynomial over a box of parameters.

`symbolic.expressions.identities` reduces an expression to 0; a failed reduction refutes nothing.

Signs are decided in exact arithmetic. In one variable Sturm's theorem counts the roots. In several, map the open box to
the positive orthant by `x = (low + high*u)/(1 + u)`; if no coefficient in `u` is negative the polynomial is positive in
the box (the Bernstein criterion), else the box is halved. Faces that belong to the box are proved in the same way, with
one variable fewer, so that open and closed ends are distinguished.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from math import comb, prod
from typing import Any

from sympy import (
    QQ,
    ZZ,
    Expr,
    Interval,
    Poly,
    Rational,
    S,
    Symbol,
    expand,
    factor_list,
    minimal_polynomial,
    oo,
    simplify,
    together,
)
from sympy.polys.polyerrors import CoercionFailed, DomainError

from symbolic.expressions.identities import is_zero_in_ring, reduced_numerator


def vanishes(expression: Expr) -> bool:
    """True when `expression` is proved to be 0 wherever it is defined; False when it is not proved.

    >>> from sympy import Rational, cos, sqrt
    >>> from symbolic.tables.table import theta
    >>> vanishes(4 * cos(theta) ** 3 - 3 * cos(theta) - cos(3 * theta))
    True
    >>> vanishes(sqrt(5 + 2 * sqrt(6)) - sqrt(2) - sqrt(3))
    True
    >>> vanishes(cos(theta) - 1)
    False
    """
    expression = S(expression)
    decided = is_zero_in_ring(expression)
    if decided is not None:
        return decided
    if expression.is_zero:
        return True
    numerator = reduced_numerator(expression)
    if numerator == 0:
        return True
    if not numerator.free_symbols and numerator.is_algebraic:
        return bool(minimal_polynomial(numerator, Symbol("x")) == Symbol("x"))
    return False


def defect(expression: Expr) -> Expr:
    """0 if the expression is proved to vanish; otherwise the expression, simplified.

    >>> from sympy import cos, sin
    >>> from symbolic.tables.table import theta
    >>> defect(sin(theta) ** 2 + cos(theta) ** 2 - 1), defect(theta + theta)
    (0, 2*theta)
    """
    return S.Zero if vanishes(expression) else simplify(expression)


Box = Mapping[Symbol, Interval]


class Outcome(Enum):
    """The three answers a proof can give."""

    PROVED = "proved"
    REFUTED = "refuted by a witness"
    UNKNOWN = "nothing proved"


@dataclass(frozen=True)
class SignFinding:
    """An outcome with its reason in one sentence; a refutation has the values of the parameters in `at`."""

    outcome: Outcome
    reason: str
    at: tuple[tuple[Symbol, Expr], ...] = ()

    def __bool__(self) -> bool:
        return self.outcome is Outcome.PROVED


def conjunction(*findings: SignFinding) -> SignFinding:
    """The finding that all `findings` hold: refuted if one is refuted, proved if all are proved."""
    for wanted in (Outcome.REFUTED, Outcome.UNKNOWN):
        for finding in findings:
            if finding.outcome is wanted:
                return finding
    return SignFinding(Outcome.PROVED, "; ".join(dict.fromkeys(f.reason for f in findings)))


def all_vanish(steps: Mapping[str, Iterable[Expr]]) -> SignFinding:
    """Do all expressions of every named step vanish? The reason names the steps, or those that are not reduced to 0.

    >>> x = Symbol("x")
    >>> all_vanish({"a square": [(x + 1) ** 2 - x**2 - 2 * x - 1]}).reason, all_vanish({"a guess": [x]}).reason
    ('a square', 'not reduced to 0: a guess')
    """
    failed = [name for name, defects in steps.items() if not all(map(vanishes, defects))]
    if failed:
        return SignFinding(Outcome.UNKNOWN, f"not reduced to 0: {', '.join(failed)}")
    return SignFinding(Outcome.PROVED, "; ".join(steps))


def positive(expression: Expr, box: Box, depth: int = 12) -> SignFinding:
    """Is the rational function `expression` > 0 everywhere in `box`? (Its poles must lie outside `box`.)

    >>> x, y = Symbol("x"), Symbol("y")
    >>> positive(1 - x * y, {x: Interval.Ropen(0, 1), y: Interval(0, 1)}).outcome.name
    'PROVED'
    >>> positive(x - y, {x: Interval(0, 1), y: Interval(0, 1)}).reason
    'at x = 0, y = 0 the value is 0'
    """
    numerator, denominator = together(expression).as_numer_denom()
    if denominator.free_symbols:
        sign = positive(denominator, box, depth)
        if sign.outcome is not Outcome.PROVED:
            sign = positive(-denominator, box, depth)
            if sign.outcome is not Outcome.PROVED:
                return SignFinding(Outcome.UNKNOWN, f"the sign of the denominator {denominator} is open")
            numerator = -numerator
    elif denominator.is_negative:
        numerator = -numerator
    missing = sorted(str(x) for x in numerator.free_symbols - set(box))
    if missing:
        raise ValueError(f"positive: no range given for {', '.join(missing)}")
    for x in sorted(numerator.free_symbols, key=str):
        if not isinstance(box[x], Interval):
            raise ValueError(f"positive: the range of {x} is {box[x]}; it must be an interval of more than one point")
    finding = _positive(expand(numerator), dict(box), depth)
    if finding is not None:
        return finding if finding else placed(finding, box)
    return SignFinding(Outcome.UNKNOWN, f"no certificate for {expression} > 0 within {depth} halvings")


def nonnegative(expression: Expr, box: Box, depth: int = 12) -> SignFinding:
    """Is `expression >= 0` in `box`? It is proved in the interior, and follows on the closure by continuity.

    >>> x = Symbol("x")
    >>> nonnegative(x * (1 - x) ** 2, {x: Interval(0, 2)}).outcome.name
    'PROVED'
    """
    kept = S.One
    if expression.is_nonnegative:
        return SignFinding(Outcome.PROVED, f"{expression} >= 0")
    constant, factors = _factors(expression)
    for factor, power in factors:
        kept *= factor ** (power % 2)
    inside = {x: r.interior for x, r in box.items()}
    finding = positive(constant * kept, inside, depth)
    if finding.outcome is Outcome.REFUTED and len(kept.free_symbols) > 1:  # a zero at one point refutes nothing here
        used = {x: inside[x] for x in sorted(kept.free_symbols, key=str)}
        negative = _witness(constant * kept, used, strictly=True)
        if negative is None:
            return SignFinding(Outcome.UNKNOWN, f"no certificate for {expression} >= 0 within {depth} halvings")
        return negative
    return finding


def placed(finding: SignFinding, box: Box) -> SignFinding:
    """A refutation whose witness is completed by values of all parameters of the box; other findings are unchanged.

    >>> x, y = Symbol("x"), Symbol("y")
    >>> positive(x, {x: Interval(-1, 1), y: Interval(3, 4)}).at
    ((x, -1), (y, 3))
    """
    rest = {x: _samples(r)[0] for x, r in box.items() if isinstance(r, Interval)}
    point = rest | dict(finding.at)
    return replace(finding, at=tuple(sorted(point.items(), key=str)))


def _factors(expression: Expr) -> tuple[Expr, list[tuple[Expr, int]]]:
    numerator, denominator = together(expression).as_numer_denom()
    constant, factors = factor_list(numerator * denominator)
    return constant, list(factors)


def _positive(p: Expr, box: dict[Symbol, Interval], depth: int) -> SignFinding | None:
    used = sorted(p.free_symbols, key=str)
    box = {x: box[x] for x in used}
    witness = _witness(p, box)
    if witness is not None:
        return witness
    if not used:
        return SignFinding(Outcome.PROVED, f"{p} > 0") if p.is_positive else None
    if not p.is_polynomial(*used):
        return None
    if len(used) == 1:
        counted = _sturm(p, used[0], box[used[0]])
        if counted is not None:
            return counted
    interior = _orthant(p, box)
    if interior is None and depth > 0:
        return _halved(p, box, depth)
    if interior is None:
        return None
    faces = [_face(p, x, end, box, depth) for x in used for end in _ends(box[x])]
    if any(face is None for face in faces):
        return None
    return conjunction(interior, *(face for face in faces if face is not None))


def _face(p: Expr, x: Symbol, end: Expr, box: dict[Symbol, Interval], depth: int) -> SignFinding | None:
    """The finding for the face `x = end` of the box; a refutation's witness is completed by this value of `x`."""
    face = _positive(expand(p.subs(x, end)), box, depth)
    return face if face is None or face else replace(face, at=(*face.at, (x, end)))


def _ends(interval: Interval) -> list[Expr]:
    return ([] if interval.left_open else [interval.start]) + ([] if interval.right_open else [interval.end])


def _samples(interval: Interval) -> list[Expr]:
    low, high = interval.start, interval.end
    if low is -oo:
        inside = [(S.Zero if high is oo else high) - k for k in (Rational(1, 8), 1, 8)]
    elif high is oo:
        inside = [low + Rational(1, 8), low + 1, low + 8]
    else:
        inside = [low + (high - low) * Rational(k, 8) for k in (1, 4, 7)]
    return _ends(interval) + inside


def _witness(p: Expr, box: dict[Symbol, Interval], strictly: bool = False) -> SignFinding | None:
    """A refutation of `p > 0`, or of `p >= 0` if `strictly`, by one of a few tried points of the box; else None."""
    points: list[dict[Symbol, Expr]] = [{}]
    for x, interval in box.items():
        points = [{**point, x: value} for point in points for value in _samples(interval)]
    value_at = _evaluator(p, tuple(box))
    for point in points:
        value = value_at(point)
        if value.is_negative or (value.is_nonpositive and not strictly):
            where = ", ".join(f"{x} = {v}" for x, v in point.items())
            reason = f"at {where} the value is {value}" if where else f"the value is {value}"
            return SignFinding(Outcome.REFUTED, reason, tuple(point.items()))
    return None


def _evaluator(p: Expr, used: tuple[Symbol, ...]) -> Callable[[dict[Symbol, Expr]], Expr]:
    """A function that evaluates `p` at a point: from its terms in rational arithmetic, or else by substitution."""

    def substituted(point: dict[Symbol, Expr]) -> Expr:
        return p.subs(point)

    poly = Poly(p, *used) if used and p.is_polynomial(*used) else None
    if poly is None or poly.domain not in (ZZ, QQ):
        return substituted
    terms = [(powers, QQ.from_sympy(c)) for powers, c in poly.terms()]

    def value(point: dict[Symbol, Expr]) -> Expr:
        if not all(x.is_Rational for x in point.values()):
            return substituted(point)
        at = [QQ.from_sympy(point[x]) for x in used]
        return QQ.to_sympy(sum((c * prod(map(pow, at, powers)) for powers, c in terms), QQ.zero))

    return value


def _sturm(p: Expr, x: Symbol, interval: Interval) -> SignFinding | None:
    """Is the polynomial positive, by Sturm's theorem? None if this fails, as for irrational ends or coefficients."""
    poly = Poly(p, x).sqf_part()
    try:
        roots = poly.count_roots(interval.start, interval.end)
    except (CoercionFailed, DomainError):
        return None
    for end, is_open in ((interval.start, interval.left_open), (interval.end, interval.right_open)):
        if is_open and end.is_finite and poly.eval(end) == 0:
            roots -= 1
    where = f"{x} in {interval_text(interval)}"
    if roots == 0 and not p.subs(x, _samples(interval)[-1]).is_positive:  # one sample fixes the sign
        return None
    if roots == 0:
        return SignFinding(Outcome.PROVED, f"Sturm: {poly.as_expr()} has no root for {where}")
    try:
        root = next(r for r in poly.real_roots() if r in interval)
    except NotImplementedError:  # for coefficients such as pi
        return None
    return SignFinding(Outcome.REFUTED, f"Sturm: {poly.as_expr()} has {roots} root(s) for {where}", ((x, root),))


def _orthant(p: Expr, box: dict[Symbol, Interval]) -> SignFinding | None:
    lines = any(r.start is -oo and r.end is oo for r in box.values())
    if not lines and all(c.is_nonnegative for c in bernstein(p, box)):
        where = ", ".join(f"{x} in {interval_text(r)}" for x, r in box.items())
        return SignFinding(Outcome.PROVED, f"Bernstein: {p} > 0 for {where}")
    return None


def bernstein(p: Expr, box: Box) -> list[Expr]:
    """The coefficients of the polynomial `p` in variables that map the positive orthant to the open `box`.

    If none is negative, `p` is positive in the open box. If all have one sign and none is 0, `p` has that sign on the
    closed box.

    >>> x = Symbol("x")
    >>> bernstein(x**2 - 3 * x + 3, {x: Interval(0, 1)})
    [3, 3, 1]
    """
    poly = Poly(p, *box)
    ends = [end for interval in box.values() for end in (interval.start, interval.end) if end.is_finite]
    rational = poly.domain in (ZZ, QQ) and all(end.is_Rational for end in ends)
    number = QQ.from_sympy if rational else S
    terms = {powers: number(c) for powers, c in poly.as_dict().items()}
    for i, interval in enumerate(box.values()):
        degree = max(powers[i] for powers in terms)
        low, high = (number(end) if end.is_finite else None for end in (interval.start, interval.end))
        images = [_image(low, high, number(S.One), k, degree) for k in range(degree + 1)]
        mapped: dict[tuple[int, ...], Any] = {}
        for powers, coefficient in terms.items():
            for k, c in enumerate(images[powers[i]]):
                key = (*powers[:i], k, *powers[i + 1 :])
                mapped[key] = mapped.get(key, 0) + coefficient * c
        terms = mapped
    found = (terms[powers] for powers in sorted(terms))
    return [QQ.to_sympy(c) if rational else expand(c) for c in found]


def _image(low: Any, high: Any, one: Any, power: int, degree: int) -> list[Any]:
    """Coefficients in `u`, constant first, of `x**power * (1 + u)**degree` with `x` mapped to the orthant.

    `x = (low + high*u)/(1 + u)`; where an end is infinite (None), `x = low + u` or `x = high - u`, without `(1 + u)`.
    """
    rest = 0 if low is None or high is None else degree - power
    constant, slope = (high, -one) if low is None else (low, one if high is None else high)
    found = [0 * one] * (power + rest + 1)
    for k in range(power + 1):
        term = comb(power, k) * constant ** (power - k) * slope**k
        for j in range(rest + 1):
            found[k + j] += comb(rest, j) * term
    return found


def _size(interval: Interval) -> tuple[bool, bool, Expr]:
    """Sort key of an interval: greatest for a line, then for half-lines, then for long intervals."""
    infinite = interval.measure is oo
    return interval.start is -oo and interval.end is oo, infinite, S.Zero if infinite else interval.measure


def _middle(interval: Interval) -> Expr:
    low, high = interval.start, interval.end
    if low is -oo:
        return S.Zero if high is oo else high - 1
    return low + 1 if high is oo else (low + high) / 2


def _halved(p: Expr, box: dict[Symbol, Interval], depth: int) -> SignFinding | None:
    x = max(box, key=lambda y: _size(box[y]))
    middle = _middle(box[x])
    low, high = box[x].start, box[x].end
    halves = Interval(low, middle, box[x].left_open), Interval(middle, high, right_open=box[x].right_open)
    findings = []
    for half in halves:
        finding = _positive(p, {**box, x: half}, depth - 1)
        if finding is None or finding.outcome is Outcome.REFUTED:
            return finding
        findings.append(finding)
    where = ", ".join(f"{y} in {interval_text(r)}" for y, r in box.items())
    return SignFinding(Outcome.PROVED, f"Bernstein, by halving: {p} > 0 for {where}")


def interval_text(interval: Interval) -> str:
    """A real interval in mathematical notation.

    >>> interval_text(Interval(0, Rational(1, 10)))
    '[0, 1/10]'
    """
    left = "(" if interval.left_open or not interval.start.is_finite else "["
    right = ")" if interval.right_open or not interval.end.is_finite else "]"
    return f"{left}{interval.start}, {interval.end}{right}"
