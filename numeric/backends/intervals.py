"""Two number systems that run a program on more than one point: whole intervals, and both ends of a chord at once.

`Intervals` encloses the values of a program over intervals of its inputs, in arrays, every operation rounded outwards:
what it says of a boundary is proved for every point of it. `Secants` carries the values at two points and the
difference of the two divided by a small number, exactly where they almost agree: nothing is subtracted that cancels.
"""

from collections.abc import Callable
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from numeric.backends.protocol import Backend, M, N, Pair

Array = NDArray[np.float64]
OUTWARDS = 2.0**-48  # relative error of an elementary function, five times over


class Interval:
    """Arrays of lower and upper bounds; infinite ones say nothing."""

    def __init__(self, low: Array, high: Array) -> None:
        known = np.isfinite(low) & np.isfinite(high)
        self.low, self.high = np.where(known, low, -np.inf), np.where(known, high, np.inf)

    @staticmethod
    def around(*values: Array, share: float = 2.0**-52) -> "Interval":
        """The hull of rounded values, each off by a relative error of at most `share`."""
        low, high = np.min(values, axis=0), np.max(values, axis=0)  # nan where one is
        tiny = 2.0**-1000
        return Interval(low - share * np.abs(low) - tiny, high + share * np.abs(high) + tiny)

    def __add__(self, other: "Interval") -> "Interval":
        return Interval.around(self.low + other.low, self.high + other.high)

    def __sub__(self, other: "Interval") -> "Interval":
        return self + -other

    def __mul__(self, other: "Interval") -> "Interval":
        ends = (self.low, self.high), (other.low, other.high)
        return Interval.around(*(x * y for x in ends[0] for y in ends[1]))

    def __truediv__(self, other: "Interval") -> "Interval":
        nought = (other.low <= 0) & (other.high >= 0)
        low, high = (np.where(nought, np.nan, 1 / x) for x in (other.low, other.high))
        return self * Interval.around(low, high)

    def __neg__(self) -> "Interval":
        return Interval(-self.high, -self.low)

    def squared(self) -> "Interval":
        """The square, which is not negative."""
        least = np.where((self.low <= 0) & (self.high >= 0), 0.0, np.minimum(np.abs(self.low), np.abs(self.high)))
        return Interval.around(least * least, np.maximum(np.abs(self.low), np.abs(self.high)) ** 2)


class Intervals:
    """Programs on intervals."""

    def q(self, p: int, n: int) -> Interval:
        """The rational `p/n`."""
        return Interval.around(np.array(p / n))

    @property
    def pi(self) -> Interval:
        """Pi."""
        return Interval.around(np.array(np.pi))

    def rising(self, function: Callable[[Array], Array], x: Interval) -> Interval:
        """A function that never falls."""
        return Interval.around(function(x.low), function(x.high), share=OUTWARDS)

    def sqrt(self, x: Interval) -> Interval:
        """The square root."""
        return self.rising(np.sqrt, x)

    def exp(self, x: Interval) -> Interval:
        """The exponential."""
        return self.rising(elementary.exp, x)

    def log(self, x: Interval) -> Interval:
        """The natural logarithm."""
        near_one = Interval.around(elementary.log(x.low), elementary.log(x.high), share=OUTWARDS)
        return Interval(near_one.low - OUTWARDS, near_one.high + OUTWARDS)

    def atan(self, x: Interval) -> Interval:
        """The arc tangent."""
        return self.rising(elementary.arctan, x)

    def sinh(self, x: Interval) -> Interval:
        """The hyperbolic sine."""
        return self.rising(elementary.sinh, x)

    def tanh(self, x: Interval) -> Interval:
        """The hyperbolic tangent."""
        return self.rising(elementary.tanh, x)

    def cosh(self, x: Interval) -> Interval:
        """The hyperbolic cosine."""
        grown = self.exp(x)
        return (grown + self.q(1, 1) / grown) * self.q(1, 2)

    def root(self, x: Interval, n: int) -> Interval:
        """The positive `n`-th root."""
        return self.rising(lambda value: elementary.root(value, n), x)

    def cos(self, x: Interval) -> Interval:
        """The cosine: its slope is between -1 and 1."""
        middle, half = 0.5 * (x.low + x.high), 0.5 * (x.high - x.low) + OUTWARDS * (1 + np.abs(x.low))
        value = np.cos(middle)
        return Interval.around(np.maximum(value - half, -1.0), np.minimum(value + half, 1.0))

    def sin(self, x: Interval) -> Interval:
        """The sine."""
        return self.cos(x - self.pi * self.q(1, 2))


def whole_turn(cells: int) -> tuple[Interval, Interval]:
    """Cosine and sine on equal cells that cover the turn."""
    edges = np.linspace(-np.pi, np.pi, cells + 1)
    angle = Interval.around(edges[:-1], edges[1:], share=OUTWARDS)
    return Intervals().cos(angle), Intervals().sin(angle)


class Secant(Generic[N, M]):
    """The values `first` and `last` at the ends of a chord, and `slope = (last - first)/step` for a known `step`.

    >>> from numeric.backends.scalars import ArrayBackend
    >>> x = Secant(ArrayBackend(), 3.0, 5.0, 1.0)
    >>> (x * x).slope
    8.0
    """

    def __init__(self, ops: Backend[N, M], first: N, last: N, slope: N) -> None:
        self.ops, self.first, self.last, self.slope = ops, first, last, slope

    def __add__(self, other: "Secant[N, M]") -> "Secant[N, M]":
        return Secant(self.ops, self.first + other.first, self.last + other.last, self.slope + other.slope)

    def __sub__(self, other: "Secant[N, M]") -> "Secant[N, M]":
        return Secant(self.ops, self.first - other.first, self.last - other.last, self.slope - other.slope)

    def __mul__(self, other: "Secant[N, M]") -> "Secant[N, M]":
        slope = self.slope * other.last + self.first * other.slope
        return Secant(self.ops, self.first * other.first, self.last * other.last, slope)

    def __truediv__(self, other: "Secant[N, M]") -> "Secant[N, M]":
        first, last = self.first / other.first, self.last / other.last
        return Secant(self.ops, first, last, (self.slope - first * other.slope) / other.last)

    def __neg__(self) -> "Secant[N, M]":
        return Secant(self.ops, -self.first, -self.last, -self.slope)


class Secants(Generic[N, M]):
    """Programs on both ends of a chord whose differences are divided by `step`; words by their addition theorems."""

    def __init__(self, ops: Backend[N, M], step: N) -> None:
        self.ops, self.step = ops, step

    def constant(self, x: N) -> Secant[N, M]:
        """The same at both ends."""
        return Secant(self.ops, x, x, self.ops.number(0.0))

    def q(self, p: int, n: int) -> Secant[N, M]:
        """The rational `p/n`."""
        return self.constant(self.ops.q(p, n))

    @property
    def pi(self) -> Secant[N, M]:
        """Pi."""
        return self.constant(self.ops.pi)

    def _ratio(self, value: N, x: N) -> N:
        """`value/x` for a function that is 0 at 0 with slope 1 there."""
        flat = x == self.ops.number(0.0)
        one = self.ops.number(1.0)
        return self.ops.select(flat, one, value / self.ops.select(flat, one, x))

    def _half(self, x: Secant[N, M]) -> Pair[N]:
        """Mean of both ends, and half their difference."""
        half = self.ops.number(0.5)
        return half * (x.first + x.last), half * self.step * x.slope

    def sqrt(self, x: Secant[N, M]) -> Secant[N, M]:
        """The square root."""
        first, last = self.ops.sqrt(x.first), self.ops.sqrt(x.last)
        return Secant(self.ops, first, last, x.slope / (first + last))

    def root(self, x: Secant[N, M], n: int) -> Secant[N, M]:
        """The `n`-th root: the difference of `n`-th powers has `n` terms over that of their bases."""
        first, last = self.ops.root(x.first, n), self.ops.root(x.last, n)
        total, power = self.ops.number(1.0), self.ops.number(1.0)
        for _ in range(n - 1):
            power = power * first
            total = total * last + power
        return Secant(self.ops, first, last, x.slope / total)

    def exp(self, x: Secant[N, M]) -> Secant[N, M]:
        """The exponential."""
        middle, half = self._half(x)
        slope = self.ops.exp(middle) * self._ratio(self.ops.sinh(half), half) * x.slope
        return Secant(self.ops, self.ops.exp(x.first), self.ops.exp(x.last), slope)

    def sinh(self, x: Secant[N, M]) -> Secant[N, M]:
        """The hyperbolic sine."""
        middle, half = self._half(x)
        slope = self.ops.cosh(middle) * self._ratio(self.ops.sinh(half), half) * x.slope
        return Secant(self.ops, self.ops.sinh(x.first), self.ops.sinh(x.last), slope)

    def cosh(self, x: Secant[N, M]) -> Secant[N, M]:
        """The hyperbolic cosine."""
        middle, half = self._half(x)
        slope = self.ops.sinh(middle) * self._ratio(self.ops.sinh(half), half) * x.slope
        return Secant(self.ops, self.ops.cosh(x.first), self.ops.cosh(x.last), slope)

    def tanh(self, x: Secant[N, M]) -> Secant[N, M]:
        """The hyperbolic tangent: `tanh b - tanh a = tanh(b - a)*(1 - tanh a*tanh b)`."""
        first, last = self.ops.tanh(x.first), self.ops.tanh(x.last)
        gap = self.step * x.slope
        factor = self.ops.number(1.0) - first * last
        return Secant(self.ops, first, last, self._ratio(self.ops.tanh(gap), gap) * factor * x.slope)

    def sin(self, x: Secant[N, M]) -> Secant[N, M]:
        """The sine."""
        middle, half = self._half(x)
        slope = self.ops.cos(middle) * self._ratio(self.ops.sin(half), half) * x.slope
        return Secant(self.ops, self.ops.sin(x.first), self.ops.sin(x.last), slope)

    def cos(self, x: Secant[N, M]) -> Secant[N, M]:
        """The cosine."""
        middle, half = self._half(x)
        slope = -(self.ops.sin(middle) * self._ratio(self.ops.sin(half), half) * x.slope)
        return Secant(self.ops, self.ops.cos(x.first), self.ops.cos(x.last), slope)

    def log(self, x: Secant[N, M]) -> Secant[N, M]:
        """The logarithm: `h/tanh h`, which hardly feels the rounding of `h`, half the difference of both."""
        first, last = self.ops.log(x.first), self.ops.log(x.last)
        half = self.ops.number(0.5) * (last - first)
        mean = (x.first + x.last) * self._ratio(self.ops.tanh(half), half)
        return Secant(self.ops, first, last, self.ops.number(2.0) * x.slope / mean)

    def atan(self, x: Secant[N, M]) -> Secant[N, M]:
        """The arc tangent: `atan b - atan a = atan((b - a)/(1 + a*b))` where the divisor is positive."""
        ops, one = self.ops, self.ops.number(1.0)
        first, last, gap = ops.atan(x.first), ops.atan(x.last), self.step * x.slope
        divisor = one + x.first * x.last
        near = ops.number(0.5) < divisor
        safe = ops.select(near, divisor, one)
        z = gap / safe
        far = (last - first) / ops.select(near, one, gap)
        return Secant(ops, first, last, ops.select(near, self._ratio(ops.atan(z), z) / safe, far) * x.slope)
