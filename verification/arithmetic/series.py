"""Truncated Taylor series over any kind of number, and their remainders in balls.

A `Jet` carries a few coefficients through the generated functions; a `TaylorModel` encloses the truncation error too.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import reduce
from operator import add, mul, neg, sub
from typing import Any

from flint import acb, acb_series, arb, arb_series, ctx

from verification.arithmetic.balls import FUNCTIONS, Arithmetic, BallWords


class Jet:
    """The polynomial `c[0] + c[1]*e + ... + c[n]*e**n`; higher powers of `e` are dropped."""

    __slots__ = ("c", "turned")

    def __init__(self, *c: Any) -> None:
        self.c = c
        self.turned: tuple[Any, int, Jet, Jet] | None = None  # arithmetic, bits, sine and cosine, once computed

    def __add__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            return Jet(*map(add, self.c, other.c))
        return Jet(self.c[0] + other, *self.c[1:])

    __radd__ = __add__

    def __neg__(self) -> "Jet":
        return Jet(*map(neg, self.c))

    def __sub__(self, other: Any) -> "Jet":
        if isinstance(other, Jet):
            return Jet(*map(sub, self.c, other.c))
        return Jet(self.c[0] - other, *self.c[1:])

    def __rsub__(self, other: Any) -> "Jet":
        return Jet(other - self.c[0], *map(neg, self.c[1:]))

    def __mul__(self, other: Any) -> "Jet":
        if not isinstance(other, Jet):
            return Jet(*[a * other for a in self.c])
        a, b = self.c, other.c
        if len(a) == 2:
            return Jet(a[0] * b[0], a[0] * b[1] + a[1] * b[0])
        if len(a) == 3:
            return Jet(a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0])
        return Jet(*[reduce(add, map(mul, a, b[k::-1])) for k in range(len(a))])

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Jet":
        """The quotient, order by order.

        >>> (Jet(6, 5, 1) / Jet(2, 1, 0)).c
        (3.0, 1.0, 0.0)
        """
        if not isinstance(other, Jet):
            return Jet(*[a / other for a in self.c])
        found: list[Any] = []
        for k, a in enumerate(self.c):
            for j, c in enumerate(found):
                a = a - c * other.c[k - j]
            found.append(a / other.c[0])
        return Jet(*found)

    def __rtruediv__(self, other: Any) -> "Jet":
        return Jet(other, *([0] * (len(self.c) - 1))) / self


def jets(base: Arithmetic) -> Arithmetic:
    """Arithmetic of jets over the numbers of `base`: the constants and functions that generated formulas call.

    >>> from verification.arithmetic.balls import FLOAT64
    >>> jets(FLOAT64).atan(Jet(0.0, 1.0, 0.0, 0.0)).c[3] * 3
    -1.0
    """

    def sine_and_cosine(x: Jet) -> tuple[Jet, Jet]:
        bits = getattr(x.c[0], "context", ctx).prec  # of a number of mpmath, or of balls
        if x.turned is None or x.turned[0] is not base or x.turned[1] != bits:
            s, c = [base.sin(x.c[0])], [base.cos(x.c[0])]
            slope = [j * d for j, d in enumerate(x.c[1:], 1)]
            for k in range(1, len(x.c)):
                s, c = [*s, reduce(add, map(mul, slope, c[::-1])) / k], [*c, -reduce(add, map(mul, slope, s[::-1])) / k]
            x.turned = base, bits, Jet(*s), Jet(*c)
        return x.turned[2:]

    def integrated(word: str, slope: Callable[[Jet], Jet]) -> Callable[[Any], Any]:
        def function(x: Any) -> Any:
            if not isinstance(x, Jet):
                return getattr(base, word)(x)
            derivative = slope(x) * Jet(*((k + 1) * a for k, a in enumerate(x.c[1:])), 0)
            return Jet(getattr(base, word)(x.c[0]), *(d / (k + 1) for k, d in enumerate(derivative.c[:-1])))

        return function

    def square_root(x: Any) -> Any:
        if not isinstance(x, Jet):
            return base.sqrt(x)
        found = [base.sqrt(x.c[0])]
        for k in range(1, len(x.c)):
            inner = _sum(found[j] * found[k - j] for j in range(1, k))
            found.append((x.c[k] - inner) / (2 * found[0]))
        return Jet(*found)

    def exponential(x: Any) -> Any:
        if not isinstance(x, Jet):
            return base.exp(x)
        found = [base.exp(x.c[0])]
        for k in range(1, len(x.c)):
            found.append(_sum(j * x.c[j] * found[k - j] for j in range(1, k + 1)) / k)
        return Jet(*found)

    log = integrated("log", lambda x: 1 / x)
    return BallWords(
        pi=base.pi,
        q=base.q,
        root=lambda x, n: exponential(log(x) / n) if isinstance(x, Jet) else base.root(x, n),
        sqrt=square_root,
        sin=lambda x: sine_and_cosine(x)[0] if isinstance(x, Jet) else base.sin(x),
        cos=lambda x: sine_and_cosine(x)[1] if isinstance(x, Jet) else base.cos(x),
        exp=exponential,
        log=log,
        atan=integrated("atan", lambda x: 1 / (x * x + 1)),
        **hyperbolic(exponential),
    )


def hyperbolic(exp: Callable[[Any], Any]) -> dict[str, Callable[[Any], Any]]:
    """Hyperbolic sine, cosine and tangent, from an exponential function."""

    def sinh(x: Any) -> Any:
        return (exp(x) - exp(-x)) / 2

    def cosh(x: Any) -> Any:
        return (exp(x) + exp(-x)) / 2

    return {"sinh": sinh, "cosh": cosh, "tanh": lambda x: sinh(x) / cosh(x)}


def _sum(terms: Any) -> Any:
    return reduce(add, terms, 0)


Function = Callable[[arb_series], arb_series]


@contextmanager
def taylor(order: int) -> Iterator[None]:
    """Context in which FLINT's series have `order` coefficients; the old number is restored afterwards."""
    before = ctx.cap
    ctx.cap = order
    try:
        yield
    finally:
        ctx.cap = before


SERIES = {arb: arb_series, acb: acb_series}  # FLINT's series with these balls for coefficients
CUT = ("sqrt", "log", "atan")  # functions that are not analytic everywhere


def in_series(base: Arithmetic, made: Any) -> Arithmetic:
    """Arithmetic of FLINT's series over the balls of `base`: the results of `jets`, in less time.

    Where `sqrt`, `log` or `atan` of the first coefficient is not finite, no coefficient of the result is.
    """

    def word(name: str) -> Callable[[Any], Any]:
        own, single = getattr(made, name), getattr(base, name)

        def function(x: Any) -> Any:
            if not isinstance(x, made):
                return single(x)
            if name in CUT and not (first := single(x[0])).is_finite():
                return made([first] * x.prec)
            return own(x)

        return function

    words: dict[str, Any] = {name: word(name) for name in FUNCTIONS if hasattr(made, name)}

    def root(x: Any, n: int) -> Any:
        return words["exp"](words["log"](x) / n) if isinstance(x, made) else base.root(x, n)

    words |= hyperbolic(words["exp"]) | {"root": root}
    return replace(base, **words)


def along(near: Sequence[Jet], function: Callable[[list[Any]], Sequence[Any]]) -> list[Jet]:
    """The Taylor coefficients, as jets, of a function of FLINT's series along the curve `near`."""
    count = len(near[0].c)
    with taylor(count):
        made = SERIES[type(near[0].c[0])]
        return [Jet(*coefficients(found, count)) for found in function([made([*jet.c]) for jet in near])]


def coefficients(series: Any, count: int) -> list[Any]:
    """The first `count` coefficients of a series; nan where not known, as after division by a series that is 0 at 0.

    >>> with taylor(3):
    ...     coefficients(arb_series([0, 1, 2]) / arb_series([0, 1]), 3)
    [1.00000000000000, 2.00000000000000, nan]
    """
    return [series[k] if k < series.prec else arb("nan") for k in range(count)]


@dataclass(frozen=True)
class TaylorModel:
    """Taylor model of a function of `t` on `low < 0 < high`: coefficients at 0, the last one enclosed for all `t`."""

    low: arb
    high: arb
    terms: tuple[arb, ...]

    def size(self) -> arb:
        """An upper bound of the absolute value of the function."""
        return self._upper(self.terms)

    def slope(self) -> arb:
        """An upper bound of the absolute value of the function's derivative."""
        return self._upper([k * c for k, c in enumerate(self.terms)][1:])

    def integral(self) -> arb:
        """The integral from `low` to `high`, enclosed."""
        *known, last = self.terms
        count = len(self.terms)
        found = sum((c * (self.high ** (k + 1) - self.low ** (k + 1)) / (k + 1) for k, c in enumerate(known)), arb(0))
        return found + last * (self.high**count + abs(self.low) ** count) / count * arb(0, 1)

    def _upper(self, terms: "tuple[arb, ...] | list[arb]") -> arb:
        farthest = self.high.max(-self.low)
        return arb(sum((abs(c) * farthest**k for k, c in enumerate(terms)), arb(0)).abs_upper())


def expanded(function: Function, low: arb, high: arb, order: int) -> TaylorModel:
    """Taylor model of a function with `order` coefficients between two exact numbers, about their midpoint.

    >>> found = expanded(arb_series.exp, arb(0), arb(1), 12)
    >>> (found.integral() - (arb(1).exp() - 1)).contains(0), found.integral().rad() < 1e-9
    (True, True)
    >>> found.size() >= arb(1).exp() and found.slope() >= arb(1).exp()
    True
    """
    middle = ((low + high) / 2).mid()
    with taylor(order):
        terms, whole = (coefficients(function(arb_series([at, 1])), order) for at in (middle, low.union(high)))
    return TaylorModel(low - middle, high - middle, (*terms[:-1], whole[-1]))
