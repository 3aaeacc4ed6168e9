"""Taylor's series in balls on a stretch: bounds of a function, of its derivative, and its integral.

The coefficients at the middle are those of a series of balls; the last one is taken over the whole stretch, so that
by Lagrange's remainder the polynomial with these coefficients is the function there, and its derivative the
derivative.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from flint import arb, arb_series, ctx

from verification.arithmetic import FUNCTIONS, Arithmetic, balls

Function = Callable[[arb_series], arb_series]


@contextmanager
def taylor(order: int) -> Iterator[None]:
    """Series have `order` coefficients inside, and outside as many as before."""
    before = ctx.cap
    ctx.cap = order
    try:
        yield
    finally:
        ctx.cap = before


def series(bits: int) -> Arithmetic:
    """The words of a kernel for power series with balls for coefficients."""
    return {**balls(bits), **{word: getattr(arb_series, word) for word in FUNCTIONS}}


@dataclass(frozen=True)
class Expansion:
    """A function of `t` between `low < 0` and `high > 0`: the coefficients, the last of them over the whole stretch."""

    low: arb
    high: arb
    terms: tuple[arb, ...]

    def size(self) -> arb:
        """An upper bound of its absolute value."""
        return self._upper(self.terms)

    def slope(self) -> arb:
        """An upper bound of the absolute value of its derivative."""
        return self._upper([k * c for k, c in enumerate(self.terms)][1:])

    def integral(self) -> arb:
        """The integral over the stretch."""
        *known, last = self.terms
        count = len(self.terms)
        found = sum((c * (self.high ** (k + 1) - self.low ** (k + 1)) / (k + 1) for k, c in enumerate(known)), arb(0))
        return found + last * (self.high**count + abs(self.low) ** count) / count * arb(0, 1)

    def _upper(self, terms: "tuple[arb, ...] | list[arb]") -> arb:
        farthest = self.high.max(-self.low)
        return arb(sum((abs(c) * farthest**k for k, c in enumerate(terms)), arb(0)).abs_upper())


def expanded(function: Function, low: arb, high: arb, order: int) -> Expansion:
    """The expansion of a function between two exact points.

    >>> found = expanded(arb_series.exp, arb(0), arb(1), 12)
    >>> (found.integral() - (arb(1).exp() - 1)).contains(0), found.integral().rad() < 1e-9
    (True, True)
    >>> found.size() >= arb(1).exp() and found.slope() >= arb(1).exp()
    True
    """
    middle = ((low + high) / 2).mid()
    with taylor(order):
        known = list(function(arb_series([middle, 1])))
        over = list(function(arb_series([low.union(high), 1])))
    terms, whole = ([*made, *[arb(0)] * order][:order] for made in (known, over))
    return Expansion(low - middle, high - middle, (*terms[:-1], whole[-1]))
