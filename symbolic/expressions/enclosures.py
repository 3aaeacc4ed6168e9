"""Signs of expressions over an interval or a box, proved in integer arithmetic.

This serves where Sturm's theorem or Bernstein coefficients are too slow or do not apply. A number is enclosed by two
integers, its bounds times `2**BITS`, and every operation rounds outwards. An interval is halved until the sign is known
everywhere, a point refutes it, or the allowed operations are spent. Time grows with the distinct subexpressions.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import product
from math import isqrt

from sympy import (
    Abs,
    Add,
    Expr,
    Mul,
    Pow,
    Rational,
    S,
    Symbol,
    atan,
    cos,
    cosh,
    exp,
    log,
    pi,
    sign,
    sin,
    sinh,
    tan,
    tanh,
)

from symbolic.expressions.signs import Outcome, SignFinding

BITS = 96
ONE = 1 << BITS
GUARD = 64  # further bits of pi and log(2), which are multiplied by whole numbers
LARGEST = 1 << 12  # largest modulus of an argument of exp
WORK = 150_000  # operations on intervals: about a second
Bounds = tuple[int, int]


class UnboundedError(Exception):
    """An operation has no finite bounds: a pole, a root of a possibly negative number, or an unknown function."""


def sign_on(expression: Expr, x: Symbol, low: Rational, high: Rational, work: int = WORK) -> SignFinding:
    """Is `expression` > 0 for all `x` with `low <= x <= high`? At most `work` operations are used.

    >>> x = Symbol("x")
    >>> sign_on(2 + cos(cos(x)) / (3 + sin(x)), x, S(-4), S(4)).outcome.name
    'PROVED'
    >>> sign_on(cos(x) - Rational(1, 2), x, S(-4), S(4)).reason
    'at x = -4 the value is negative or 0'
    """
    return sign_in(expression, {x: (low, high)}, work)


def sign_in(expression: Expr, box: Mapping[Symbol, tuple[Rational, Rational]], work: int = WORK) -> SignFinding:
    """Is `expression` > 0 in the whole box? The widest side is halved until each part is proved or a point refutes it.

    >>> x, y = Symbol("x"), Symbol("y")
    >>> sign_in(2 - cos(x) * y, {x: (S(-4), S(4)), y: (S(-1), S(1))}).outcome.name
    'PROVED'
    """
    names = tuple(box)
    steps = _steps(expression, *names)
    boxes, spent = deque([tuple((_ceil(low) - 1, _ceil(high)) for low, high in box.values())]), 0
    for corner in product(*box.values()):
        if _value(steps, *map(_rational, corner))[1] <= 0:
            return _refuted(names, corner)
    while boxes:
        spent += 2 * len(steps)
        here = boxes.pop() if len(names) == 1 else boxes.popleft()  # in several variables, larger boxes first
        widest = max(range(len(here)), key=lambda i: here[i][1] - here[i][0])
        if spent > work or here[widest][1] - here[widest][0] < 1 << BITS // 2:
            return SignFinding(Outcome.UNKNOWN, f"no sign was proved with {work} operations on intervals")
        if _value(steps, *here)[0] > 0:
            continue
        middles = [(lower + upper) // 2 for lower, upper in here]
        if _value(steps, *((middle, middle) for middle in middles))[1] <= 0:
            return _refuted(names, [Rational(middle, ONE) for middle in middles])
        (lower, upper), middle = here[widest], middles[widest]
        boxes += [(*here[:widest], half, *here[widest + 1 :]) for half in ((lower, middle), (middle, upper))]
    ranges = ", ".join(f"{x} from {low} to {high}" for x, (low, high) in box.items())
    return SignFinding(Outcome.PROVED, f"enclosures: positive for {ranges}")


def _refuted(names: Sequence[Symbol], point: Sequence[Rational]) -> SignFinding:
    at = tuple(zip(names, point, strict=True))
    where = ", ".join(f"{x} = {value}" for x, value in at)
    return SignFinding(Outcome.REFUTED, f"at {where} the value is negative or 0", at)


def pole(expression: Expr, x: Symbol, low: Rational, high: Rational) -> Expr | None:
    """A divisor in `expression` that is proved to have a zero between `low` and `high`; None if none is found.

    None proves nothing: a divisor may touch 0 without a change of sign.

    >>> x = Symbol("x")
    >>> pole(3 + 1 / (cos(x) - Rational(1, 2)), x, S(0), S(2))
    cos(x) - 1/2
    """
    expression = expression.replace(tan, lambda inside: sin(inside) / cos(inside))
    for power in sorted(expression.atoms(Pow), key=str):
        if power.exp.is_negative and power.base.free_symbols == {x}:
            try:
                signs = {sign_on(sign * power.base, x, low, high).outcome for sign in (1, -1)}
            except UnboundedError:
                continue
            if signs == {Outcome.REFUTED}:
                return power.base
    return None


PARTS = 256  # parts of an interval over which a root is integrated


def root_integral(square: Expr, x: Symbol, low: Expr, high: Expr) -> Rational:
    """An upper bound of the integral of `sqrt(square)` from `low` to `high`, by its enclosures on short intervals.

    >>> x = Symbol("x")
    >>> S(2) < root_integral(1 - cos(x) ** 2, x, S(0), pi) < Rational(81, 40)
    True
    """
    share = Symbol("share")
    steps, total = _steps(square.subs(x, low + (high - low) * share), share), 0
    for k in range(PARTS):
        upper = _value(steps, (k * ONE // PARTS, -(-(k + 1) * ONE // PARTS)))[1]
        if upper >= EVERYTHING[1]:
            raise UnboundedError(f"{square} is not proved to be bounded")
        total += isqrt(max(upper, 0) << BITS) + 1
    length = _value(_steps(high - low))[1]
    return Rational(total * length, PARTS * ONE * ONE)


EVERYTHING: Bounds = (-(1 << 4096), 1 << 4096)
Step = tuple[Callable[..., Bounds], tuple[int, ...]]


class Enclosures:
    """A function that takes bounds of variables, and returns bounds of several expressions in these variables.

    Bounds are pairs of integers, in units of `2**-BITS`; `work` is the number of operations in one call.

    >>> x = Symbol("x")
    >>> low, high = Enclosures((x**2, 1 / x), x)((ONE, 2 * ONE))[0]
    >>> low == ONE, high == 4 * ONE
    (True, True)
    """

    def __init__(self, expressions: Sequence[Expr], *names: Symbol) -> None:
        self._count = len(expressions)
        self._steps = _steps(expressions, *names)
        self.work = len(self._steps)

    def __call__(self, *here: Bounds) -> tuple[Bounds, ...]:
        """The bounds of the expressions; `EVERYTHING` for all of them if an operation has no finite bounds."""
        return _values(self._steps, self._count, *here)


def _steps(expressions: Expr | Sequence[Expr], *names: Symbol) -> list[Step]:
    """The steps of an evaluation: first the variables, then each distinct subexpression after its operands."""
    wanted = [expressions] if isinstance(expressions, Expr) else expressions
    at: dict[Expr, int] = {x: i for i, x in enumerate(names)}
    steps: list[Step] = [(lambda: (0, 0), ()) for _ in names]

    def place(e: Expr) -> int:
        if e not in at:
            operands, function = _reading(e)
            numbers = tuple(place(operand) for operand in operands)
            steps.append((function, numbers))
            at[e] = len(steps) - 1
        return at[e]

    places = [place(expression) for expression in wanted]
    steps += [(lambda value: value, (at_end,)) for at_end in places]
    return steps


def _reading(e: Expr) -> tuple[tuple[Expr, ...], Callable[..., Bounds]]:
    """The operands of a subexpression, and the operation on their bounds; `UnboundedError` for an unknown function."""
    if isinstance(e, Rational):
        bounds = _rational(e)
        return (), lambda: bounds
    if e is pi or e is S.Exp1:
        known = _shifted(_pi()) if e is pi else _exp((ONE, ONE))
        return (), lambda: known
    if isinstance(e, Add):
        return e.args, lambda *values: (sum(v[0] for v in values), sum(v[1] for v in values))
    if isinstance(e, Mul):
        return e.args, _product
    if isinstance(e, Pow) and isinstance(e.exp, Rational):
        p, q = e.exp.p, e.exp.q
        return (e.base,), lambda value: _power(value, p, q)
    if e.func in FUNCTIONS:
        return e.args, FUNCTIONS[e.func]
    raise UnboundedError(f"no bounds are known for the function {e.func.__name__}")


def _value(steps: list[Step], *here: Bounds) -> Bounds:
    """The bounds of one expression over `here`; `EVERYTHING` if an operation has no finite bounds."""
    return _values(steps, 1, *here)[0]


def _values(steps: list[Step], count: int, *here: Bounds) -> tuple[Bounds, ...]:
    known = list(here)
    try:
        for function, operands in steps[len(here) :]:
            known.append(function(*[known[i] for i in operands]))
    except UnboundedError:
        return (EVERYTHING,) * count
    return tuple(known[-count:])


# ---- operations, rounded outwards


def _ceil(value: Rational) -> int:
    return -int((-value.p << BITS) // value.q)


def _rational(value: Rational) -> Bounds:
    return (value.p << BITS) // value.q, _ceil(value)


def _shifted(value: Bounds, bits: int = GUARD) -> Bounds:
    return value[0] >> bits, -(-value[1] >> bits)


def _times(a: Bounds, b: Bounds) -> Bounds:
    corners = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return _shifted((min(corners), max(corners)), BITS)


def _product(first: Bounds, *others: Bounds) -> Bounds:
    for other in others:
        first = _times(first, other)
    return first


def _inverse(a: Bounds) -> Bounds:
    if a[0] <= 0 <= a[1]:
        raise UnboundedError("a divisor may be 0")
    return ONE * ONE // a[1], -(-ONE * ONE // a[0])


def _power(a: Bounds, p: int, q: int) -> Bounds:
    """Bounds of `a**(p/q)`: by a power of a square root for `q = 2`, else by the exponential of a logarithm."""
    if q == 2:
        if a[0] < 0:
            raise UnboundedError("the number under a root may be negative")
        a = isqrt(a[0] << BITS), isqrt(a[1] << BITS) + 1
    elif q != 1:
        low, high = _log(a)
        a = _exp((low // q, -(-high // q)))
    n = abs(p)
    found, even = (ONE, ONE), n % 2 == 0
    if even and a[0] < 0:  # the range of an even power, and not the product of two ranges
        a = (0, max(-a[0], a[1])) if a[1] > 0 else (-a[1], -a[0])
    while n:
        found = _times(found, a) if n % 2 else found
        a, n = _times(a, a), n // 2
    return _inverse(found) if p < 0 else found


def _abs(a: Bounds) -> Bounds:
    if a[0] >= 0:
        return a
    return (-a[1], -a[0]) if a[1] <= 0 else (0, max(-a[0], a[1]))


def _turn(a: Bounds, quarters: int) -> Bounds:
    """Bounds of `cos(x - quarters*pi/2)` for `x` in `a`: from the middle of `a` by Taylor's formula to second order."""
    middle, radius = (a[0] + a[1]) // 2, (a[1] - a[0]) // 2 + 1
    if radius > 2 * ONE:
        return -ONE, ONE
    half_pi = _pi()[0] // 2, _pi()[1] // 2 + 1
    turns, _ = divmod((middle << GUARD) + half_pi[0] // 2, half_pi[0])
    rest = (middle << GUARD) - turns * half_pi[0] >> GUARD  # of modulus below 0.8, wrong by at most turns/2**GUARD + 2
    wrong = (2 * abs(turns) >> GUARD) + 3
    cosine, sine = _series(rest, 0), _series(rest, 1)
    quarter = (turns - quarters) % 4
    value = (cosine, -sine, -cosine, sine)[quarter]
    slope = abs((sine, cosine)[quarter % 2]) + wrong + TERMS
    reach = (slope * radius >> BITS) + (radius * radius >> BITS + 1) + 3 + wrong + TERMS
    return max(-ONE, value - reach), min(ONE, value + reach)


TERMS = 40  # of Taylor's series, each rounded once; the next, of (0.8)**81/81!, is below 2**-BITS


def _series(x: int, first: int) -> int:
    """The Taylor sum of the cosine (`first` = 0) or sine (`first` = 1) of `|x| < 0.8`, with an error below `TERMS`."""
    square = x * x >> BITS
    total = term = x if first else ONE
    for k in range(first + 2, 2 * TERMS, 2):
        term = -(term * square >> BITS) // (k * (k - 1))
        if not term:
            break
        total += term
    return total


def _exp(a: Bounds) -> Bounds:
    """Bounds of `exp(x)`, from the ends of `a`: `2**k` times Taylor's sum for the remainder, with positive terms."""
    if a[1] > LARGEST * ONE:
        raise UnboundedError("the argument of an exponential may be too large")

    def at(x: int, upwards: bool) -> int:
        if x < -LARGEST * ONE:
            return int(upwards)
        low, high = _log2()
        k = (x << GUARD) // low
        rest = ((x << GUARD) - k * (low if upwards == (k >= 0) else high) >> GUARD) + upwards
        total = term = ONE
        for n in range(1, TERMS):
            term = term * rest // (n << BITS)
            total += term
        total += 2 * TERMS if upwards else -2 * TERMS
        return max(0, total << k if k >= 0 else (-(-total >> -k) if upwards else total >> -k))

    return at(a[0], False), at(a[1], True)


def _log(a: Bounds) -> Bounds:
    if a[0] <= 0:
        raise UnboundedError("the argument of a logarithm may be 0 or negative")

    def at(x: int, upwards: bool) -> int:
        k = x.bit_length() - BITS
        m = x >> k if k >= 0 else x << -k  # from 1/2 to 1, in units of 2**-BITS
        s = ((m - ONE) << BITS) // (m + ONE)  # log(m) = 2*artanh(s), |s| <= 1/3
        square, total, power = s * s >> BITS, 0, s
        for n in range(1, 3 * TERMS, 2):
            total += power // n
            power = power * square >> BITS
        low, high = _log2()
        part = k * (high if upwards == (k >= 0) else low) >> GUARD
        return 2 * total + part + (8 * TERMS if upwards else -8 * TERMS)

    return at(a[0], False), at(a[1], True)


def _atan(a: Bounds) -> Bounds:
    """Bounds of `atan(x)`, from the ends of `a`: three halvings of the angle give `8*atan(y)` with a Taylor sum."""

    def at(x: int) -> int:
        for _ in range(3):
            x = (x << BITS) // (ONE + isqrt(ONE * ONE + x * x))
        square, total, power = x * x >> BITS, 0, x
        for n in range(1, 2 * TERMS, 2):
            total += power // n if (n // 2) % 2 == 0 else -(power // n)
            power = power * square >> BITS
        return 8 * total

    reach = 64 * TERMS
    return at(a[0]) - reach, at(a[1]) + reach


def _hyperbolic(a: Bounds, sign: int) -> Bounds:
    """Bounds of `(exp(x) + sign*exp(-x))/2`, `sinh` or `cosh`, from the ends of a range where it is monotone."""

    def at(x: int) -> Bounds:
        up, down = _exp((x, x)), _exp((-x, -x))
        return (up[0] + sign * down[sign < 0]) // 2, -(-(up[1] + sign * down[sign > 0]) // 2)

    if sign > 0:
        a = _abs(a)
    return at(a[0])[0], at(a[1])[1]


def _tanh(a: Bounds) -> Bounds:
    """Bounds of `tanh(x) = 1 - 2/(exp(2*x) + 1)`, from the ends of `a`; for `x < 0` from those of `-x`."""

    def at(x: int) -> Bounds:
        small = _exp((-2 * abs(x), -2 * abs(x)))
        low, high = _inverse((small[0] + ONE, small[1] + ONE))
        found = 2 * low - ONE, 2 * high - ONE
        return found if x >= 0 else (-found[1], -found[0])

    return at(a[0])[0], at(a[1])[1]


def _quotient(a: Bounds, b: Bounds) -> Bounds:
    return _times(a, _inverse(b))


FUNCTIONS: dict[type[Expr], Callable[[Bounds], Bounds]] = {
    cos: lambda x: _turn(x, 0),
    sin: lambda x: _turn(x, 1),
    tan: lambda x: _quotient(_turn(x, 1), _turn(x, 0)),
    exp: _exp,
    log: _log,
    atan: _atan,
    Abs: _abs,
    sign: lambda x: (ONE if x[0] > 0 else -ONE, -ONE if x[1] < 0 else ONE),
    sinh: lambda x: _hyperbolic(x, -1),
    cosh: lambda x: _hyperbolic(x, 1),
    tanh: _tanh,
}


@cache
def _pi() -> Bounds:
    """Bounds of pi times `2**(BITS + GUARD)`, by Machin's formula."""
    one, total = 1 << BITS + GUARD + 32, 0
    for factor, inverse in ((16, 5), (-4, 239)):
        power, n = one // inverse, 1
        while power:
            total += factor * (power // n if n % 4 == 1 else -(power // n))
            power, n = power // inverse**2, n + 2
    total >>= 32
    return total - 1, total + 2


@cache
def _log2() -> Bounds:
    """Bounds of `log(2) = 2*artanh(1/3)` times `2**(BITS + GUARD)`."""
    power, total, n = (1 << BITS + GUARD + 32) // 3, 0, 1
    while power:
        total += 2 * (power // n)
        power, n = power // 9, n + 2
    total >>= 32
    return total - 1, total + 2
