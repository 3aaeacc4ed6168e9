"""The arithmetics in which generated formulas are evaluated: float64, arrays, mpmath numbers and balls.

`load(kernel, arithmetic)` gives a formula's functions and constants their meaning. Precision is an argument: mpmath
comes in as a context object, balls with their number of bits. Ball operations between formulas round at the global
`flint.ctx`, so whoever computes with balls does it inside `working(bits)`, which puts the old precision back.

Also here: the enclosure of an exact expression, decimals with a radius, and intervals cut into touching balls.
"""

import copyreg
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from threading import RLock
from typing import Any, Generic, TypeVar

import mpmath
from flint import acb, arb, arb_mat, ctx, fmpq
from sympy import (
    Abs,
    Add,
    CRootOf,
    Expr,
    I,
    Integer,
    Mul,
    Pow,
    Rational,
    Symbol,
    acos,
    asin,
    pi,
    tan,
)

from symbolic.expressions import text as vocabulary
from symbolic.tables.definition import exact


def ball_of(*parts: Any) -> arb:
    """The ball of a midpoint and a radius, each `(mantissa, exponent)`, or of a text if the ball is not finite."""
    return arb(*parts)


def _parts(ball: arb) -> tuple[Callable[..., arb], tuple[Any, ...]]:
    """Function and the arguments by which pickle restores a ball bit for bit; python-flint's balls do not pickle."""
    if not ball.is_finite():
        return ball_of, (str(ball),)
    return ball_of, tuple(tuple(map(int, half.man_exp())) for half in (ball.mid(), ball.rad()))


copyreg.pickle(arb, _parts)
FUNCTIONS = tuple(vocabulary.FUNCTIONS.values())
_ONE_PRECISION = RLock()
T = TypeVar("T")


@dataclass(frozen=True)
class BallWords(Generic[T]):
    """An arithmetic over numbers of type `T`: the constants and functions that the generated formulas may call."""

    pi: T
    q: Callable[[int, int], T]
    root: Callable[[Any, int], T]
    sqrt: Callable[[Any], T]
    sin: Callable[[Any], T]
    cos: Callable[[Any], T]
    exp: Callable[[Any], T]
    log: Callable[[Any], T]
    atan: Callable[[Any], T]
    sinh: Callable[[Any], T]
    cosh: Callable[[Any], T]
    tanh: Callable[[Any], T]


Arithmetic = BallWords[Any]
FLOAT64: BallWords[float] = BallWords(
    pi=math.pi,
    q=lambda p, n: p / n,
    root=lambda x, n: math.pow(x, 1 / n),
    **{word: getattr(math, word) for word in FUNCTIONS},
)
ARRAYS: Arithmetic  # arrays of NumPy, which is loaded when they are asked for


def __getattr__(name: str) -> Any:
    if name != "ARRAYS":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import numpy as np

    from numeric.backends import elementary

    named = {word: "arctan" if word == "atan" else word for word in FUNCTIONS}
    words = {word: getattr(elementary, named[word], None) or getattr(np, word) for word in FUNCTIONS}
    words["root"] = elementary.root
    return globals().setdefault(name, replace(FLOAT64, **words))


def multiprecision(context: Any) -> Arithmetic:
    """Arithmetic of an mpmath context, at the precision that this context has when it is used.

    >>> import mpmath
    >>> fifty = mpmath.MPContext()
    >>> fifty.dps = 50
    >>> multiprecision(fifty).q(1, 3)
    mpf('0.33333333333333333333333333333333333333333333333333311')
    """
    return BallWords(
        pi=context.pi,
        q=lambda p, n: context.mpf(p) / n,
        root=context.root,
        **{word: getattr(context, word) for word in FUNCTIONS},
    )


def balls(bits: int) -> BallWords[arb]:
    """Arithmetic of balls, which contain the true value; constants are enclosed with `bits` bits.

    >>> third = balls(128).q(1, 3)
    >>> with working(128):
    ...     print((3 * third).contains(1), third.is_exact())
    True False
    """

    @cache
    def rational(p: int, n: int) -> arb:  # a kernel has few, and needs them at every call
        with working(bits):
            return arb(fmpq(p, n))

    with working(bits):
        pi = arb.pi()
    words = {word: _of_ball(word) for word in FUNCTIONS}
    return BallWords(pi=pi, q=rational, root=lambda x, n: arb(x).root(n), **words)


def mpmath_arithmetic(digits: int) -> tuple[Arithmetic, Callable[..., Any]]:
    """Arithmetic of mpmath numbers of `digits` digits, and `run(function, arguments, shape)` that evaluates with it."""
    context = mpmath.MPContext()
    context.dps = digits

    def run(function: Callable[..., Any], arguments: Sequence[Any], shape: Sequence[int] | None) -> Any:
        values = function(*(context.mpmathify(x) for x in arguments))
        return values[0] if shape is None else context.matrix(_rows(values, shape))

    return multiprecision(context), run


def ball_arithmetic(digits: int) -> tuple[BallWords[arb], Callable[..., Any]]:
    """Arithmetic of balls of `digits` digits, and its function `run`; a decimal text is read as an exact number."""
    bits = bits_of(digits, 10)

    def run(function: Callable[..., Any], arguments: Sequence[Any], shape: Sequence[int] | None) -> Any:
        with working(bits):
            values = function(*map(_as_given, arguments))
            return values[0] if shape is None else arb_mat(_rows(values, shape))

    return balls(bits), run


def fraction_ball(x: Fraction) -> arb:
    """A ball that holds a fraction, at the precision in use."""
    return arb(fmpq(x.numerator, x.denominator))


def _as_given(x: Any) -> arb:
    """A number as a ball: a float stands for its exact value, a text for the decimal number that it shows."""
    if isinstance(x, str):
        found = exact("argument", x)
        return _as_given(found) if isinstance(found, Fraction) else real_ball(found)
    return fraction_ball(x) if isinstance(x, Fraction) else arb(x)


def _rows(values: Sequence[Any], shape: Sequence[int]) -> list[list[Any]]:
    rows, columns = shape
    return [list(values[i * columns : (i + 1) * columns]) for i in range(rows)]


@contextmanager
def working(bits: int) -> Iterator[None]:
    """Context in which ball arithmetic rounds to `bits` bits; the old precision is restored afterwards.

    The precision of `flint` is one for the whole process, so other threads wait until this one leaves the context.
    Proofs that run at the same time need a process each.

    >>> before = ctx.prec
    >>> with working(333):
    ...     print(ctx.prec)
    333
    >>> ctx.prec == before
    True
    """
    with _ONE_PRECISION, ctx.workprec(bits):
        yield


def bits_of(digits: int, guard: int = 0) -> int:
    """The number of bits that hold `digits` decimal digits, plus `guard`.

    >>> bits_of(50), bits_of(50, 30)
    (167, 197)
    """
    return math.ceil(digits * math.log2(10)) + guard


def _of_ball(word: str) -> Callable[[Any], arb]:
    method = getattr(arb, word)

    def function(x: Any) -> arb:
        made: arb = method(x) if type(x) is arb else method(arb(x))
        return made

    return function


BALL_FUNCTIONS: Mapping[Any, Callable[[acb], acb]] = {
    function: getattr(acb, name) for function, name in vocabulary.FUNCTIONS.items()
} | {
    tan: acb.tan,
    acos: acb.acos,
    asin: acb.asin,
    Abs: lambda z: acb(abs(z)),
}


def enclose(expression: Expr, values: Mapping[Symbol, Expr] | None = None, digits: int = 30) -> acb:
    """A ball that contains `expression` at the exact `values`, computed with about `digits` digits.

    >>> from sympy import sqrt
    >>> (enclose(sqrt(Integer(2))) ** 2 - 2).contains(0)
    True
    """
    with working(bits_of(digits, 20)):
        return _ball(expression.subs(values or {}))


def real_ball(number: Expr | Callable[[int], arb], digits: int = 30) -> arb:
    """A ball that holds a real number, given as an exact expression or as a function from digits to balls.

    >>> real_ball(Integer(2)) == 2
    True
    """
    return enclose(number, digits=digits).real if isinstance(number, Expr) else number(digits)


def as_ball(x: Any) -> arb:
    """A number of mpmath as an exact ball, bit for bit.

    >>> import mpmath
    >>> as_ball(mpmath.mpf(1) / 3).is_exact()
    True
    """
    sign, mantissa, exponent, _ = x._mpf_
    return arb((-int(mantissa) if sign else int(mantissa), int(exponent)))


def exact_balls(numbers: Iterable[Any]) -> list[arb]:
    """Numbers of mpmath, each as an exact ball."""
    return [as_ball(x) for x in numbers]


def _ball(e: Expr) -> acb:
    if isinstance(e, Rational):
        return acb(arb(_fraction(e)))
    if e == pi:
        return acb(arb.pi())
    if e == I:
        return acb(0, 1)
    if isinstance(e, CRootOf):
        error = Rational(1, 2**ctx.prec)
        return acb(arb(_fraction(e.eval_rational(dx=error)), _fraction(error)))
    if isinstance(e, Add):
        return sum((_ball(term) for term in e.args), acb(0))
    if isinstance(e, Mul):
        product = acb(1)
        for factor in e.args:
            product *= _ball(factor)
        return product
    if isinstance(e, Pow):
        base, power = e.args
        if isinstance(power, Integer):
            return _ball(base) ** int(power)
        if isinstance(power, Rational) and power.q == 2:
            return _ball(base).sqrt() ** int(power.p)
        return (_ball(power) * _ball(base).log()).exp()
    if type(e) in BALL_FUNCTIONS:
        return BALL_FUNCTIONS[type(e)](_ball(e.args[0]))
    raise ValueError(f"no enclosure is known for {type(e).__name__} in {e}")


def _fraction(e: Rational) -> fmpq:
    return fmpq(int(e.p), int(e.q))


def decimal(value: arb, digits: int) -> tuple[str, str]:
    """`(midpoint, radius)` as decimal strings; the true value lies within the radius of the midpoint.

    >>> decimal(arb(1) / 3, 5)
    ('0.33333', '3.5e-6')
    """
    with working(bits_of(digits, 64)):
        known = digits if value.is_exact() else max(int(0.302 * value.rel_accuracy_bits()) + 2, 1)
        shown = value.mid().str(min(digits, known), radius=False)
        gap = abs(value - arb(shown))
        bound = (arb(gap.abs_upper()) * arb("1.05")).str(2, radius=False)
    return shown, bound


def between(low: float, high: float) -> arb:
    """A ball that holds all numbers between two floats.

    >>> ball = between(0.1, 0.3)
    >>> ball.contains(arb(0.1)), ball.contains(arb(0.3)), ball.contains(arb(0.31))
    (True, True, False)
    """
    return arb(low).union(arb(high))


Box = tuple[tuple[float, float], ...]  # midpoint and half width of each unknown


def bisected(box: Box, side: int | None = None) -> list[Box]:
    """The two halves of a box, cut across its longest side or across the one of index `side`.

    >>> bisected(((0.0, 1.0), (3.0, 2.0)))
    [((0.0, 1.0), (2.0, 1.0)), ((0.0, 1.0), (4.0, 1.0))]
    """
    across = max(range(len(box)), key=lambda i: box[i][1]) if side is None else side
    (middle, half), rest = box[across], box[across + 1 :]
    return [(*box[:across], (end, half / 2), *rest) for end in (middle - half / 2, middle + half / 2)]


def cuts(low: float, high: float, longest: float) -> list[arb]:
    """The interval from `low` to `high` as touching balls, each not much longer than `longest`.

    >>> len(cuts(0.0, 1.0, 0.3))
    4
    """
    parts = max(1, math.ceil((high - low) / longest))
    ends = [low + (high - low) * i / parts for i in range(parts)] + [high]
    return [between(a, b) for a, b in pairwise(ends)]


def halves(x: arb) -> list[arb]:
    """Two touching balls that together hold the ball `x`."""
    low, middle, high = x.lower(), arb(x.mid()), x.upper()
    return [low.union(middle), middle.union(high)]


def joined(values: Iterable[arb]) -> arb:
    """A ball that holds all the given balls, of which there must be at least one.

    >>> joined([arb(1), arb(3)]).contains(arb(2))
    True
    """
    whole, *others = values
    for value in others:
        whole = whole.union(value)
    return whole
