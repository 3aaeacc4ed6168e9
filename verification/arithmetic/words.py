"""What the words of the generated kernels mean, for each kind of number.

`load(kernel, arithmetic)` binds them. Precision is an argument: mpmath comes in as a context object,
balls with their number of bits. Ball operations between kernels round at the global `flint.ctx`, so
whoever computes with balls does it inside `working(bits)`, which puts the old precision back.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

Arithmetic = Mapping[str, Any]
FUNCTIONS = ("sqrt", "sin", "cos", "atan", "exp", "log")

FLOAT64: dict[str, Any] = {word: getattr(math, word) for word in FUNCTIONS} | {"q": lambda p, n: p / n, "pi": math.pi}
ARRAYS: Arithmetic = FLOAT64 | {word: getattr(np, {"atan": "arctan"}.get(word, word)) for word in FUNCTIONS}


def multiprecision(context: Any) -> Arithmetic:
    """Numbers of an mpmath context, at the precision that this context has when they are used.

    >>> import mpmath
    >>> fifty = mpmath.MPContext()
    >>> fifty.dps = 50
    >>> multiprecision(fifty)["q"](1, 3)
    mpf('0.33333333333333333333333333333333333333333333333333311')
    """
    return {word: getattr(context, word) for word in FUNCTIONS} | {
        "q": lambda p, n: context.mpf(p) / n,
        "pi": context.pi,
    }


def balls(bits: int) -> Arithmetic:
    """Balls that contain the true value; constants are enclosed with `bits` bits.

    >>> third = balls(128)["q"](1, 3)
    >>> with working(128):
    ...     print((3 * third).contains(1), third.is_exact())
    True False
    """

    def rational(p: int, n: int) -> arb:
        with ctx.workprec(bits):
            return arb(fmpq(p, n))

    with ctx.workprec(bits):
        pi = arb.pi()
    return {word: _of_ball(word) for word in FUNCTIONS} | {"q": rational, "pi": pi}


@contextmanager
def working(bits: int) -> Iterator[None]:
    """Ball arithmetic rounds to `bits` bits inside, and as before outside, whatever happens.

    >>> before = ctx.prec
    >>> with working(333):
    ...     print(ctx.prec)
    333
    >>> ctx.prec == before
    True
    """
    with ctx.workprec(bits):
        yield


def bits_of(digits: int, guard: int = 0) -> int:
    """The bits that hold `digits` decimal digits, and `guard` more.

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
