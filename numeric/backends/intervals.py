"""Number systems that run a program on more than one point: on whole intervals, or on both ends of a chord at once.

`Intervals` encloses the values of a program over intervals of its inputs, as arrays; every operation is rounded
outwards, so that what the bounds show is proved for every point of the intervals. `CentredIntervals` does so for
functions of one variable, with closer bounds from the range of the slope. `Secants` computes the values of a program at
two points, and the difference of the two values divided by a small number. No digits cancel in this difference, even
where the two values almost agree.
"""

from collections.abc import Callable
from functools import reduce
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from numeric.backends.protocol import Backend, M, N, Pair

Array = NDArray[np.float64]
OUTWARDS = 2.0**-48  # relative error of an elementary function, five times over


class Interval:
    """Arrays of lower and upper bounds. An infinite bound is no restriction."""

    def __init__(self, low: Array, high: Array) -> None:
        known = np.isfinite(low) & np.isfinite(high)
        self.low, self.high = np.where(known, low, -np.inf), np.where(known, high, np.inf)

    @staticmethod
    def around(*values: Array, share: float = 2.0**-52) -> "Interval":
        """The hull of rounded values, each of which has a relative error of at most `share`."""
        low, high = reduce(np.minimum, values), reduce(np.maximum, values)  # nan where one is
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
    """The number system of `Interval`: it runs a program on arrays of intervals."""

    def q(self, p: int, n: int) -> Interval:
        """The rational `p/n`."""
        return Interval.around(np.array(p / n))

    @property
    def pi(self) -> Interval:
        """Pi."""
        return Interval.around(np.array(np.pi))

    def rising(self, function: Callable[[Array], Array], x: Interval) -> Interval:
        """Image of an interval under a nondecreasing function."""
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
        """The sine, as the cosine of the angle less `pi/2`."""
        return self.cos(x - self.pi * self.q(1, 2))


class SharpIntervals(Intervals):
    """`Intervals` with the sharp range of a cosine, so that near 0 the bound of `1 - cos(x)` is small.

    >>> cosine = SharpIntervals().cos(Interval(np.array([-1.0, 0.1]), np.array([2.0, 0.2])))
    >>> cosine.low.round(3).tolist(), cosine.high.round(3).tolist()
    ([-0.416, 0.98], [1.0, 0.995])
    """

    def cos(self, x: Interval) -> Interval:
        """The range of the cosine, which falls from each even multiple of pi to the next odd one and rises again."""
        low, high = x.low / np.pi, x.high / np.pi
        slack = OUTWARDS * (1 + np.abs(low) + np.abs(high))
        first, last = np.ceil(low - slack), np.floor(high + slack)  # multiples of pi within
        even, odd = (2 * np.ceil((first - k) / 2) + k <= last for k in (0, 1))
        value = Interval.around(np.cos(x.low), np.cos(x.high), share=OUTWARDS)
        small = np.maximum(np.abs(x.low), np.abs(x.high)) <= 2.0**-4
        sharp = Interval.around(*(self._cosine(np.where(small, end, 0.0)) for end in (x.low, x.high)))
        least, most = np.where(small, sharp.low, value.low), np.where(small, sharp.high, value.high)
        return Interval(np.where(odd, -1.0, least), np.where(even, 1.0, most))

    def _cosine(self, x: Array) -> Array:
        """The cosine near 0 by its series. The total rounding error is no more than that of the last subtraction."""
        square = x * x
        found = np.ones_like(x)
        for n in (56, 30, 12, 2):
            found = 1 - square / n * found
        return found


NOUGHT = Interval(np.array(0.0), np.array(0.0))


class Centred:
    """A function of one variable on cells: its value in the middle, its range, and the range of its slope.

    Each value on a cell is the value in the middle plus the slope times at most half the width. This range has an error
    of the order of the width squared; the error of `Interval` is of the order of the width.
    """

    def __init__(self, half: Array, middle: Interval, whole: Interval, slope: Interval) -> None:
        reach = middle + slope * Interval(-half, half)
        self.half, self.middle, self.slope = half, middle, slope
        self.whole = Interval(np.maximum(whole.low, reach.low), np.minimum(whole.high, reach.high))

    @staticmethod
    def constant(half: Array, value: Interval) -> "Centred":
        """A function with the same value on every cell; `half` has half the width of each cell."""
        found = object.__new__(Centred)
        found.half, found.middle, found.whole, found.slope = half, value, value, NOUGHT
        return found

    def __add__(self, other: "Centred") -> "Centred":
        return Centred(self.half, self.middle + other.middle, self.whole + other.whole, self.slope + other.slope)

    def __sub__(self, other: "Centred") -> "Centred":
        return self + -other

    def __mul__(self, other: "Centred") -> "Centred":
        whole = self.whole.squared() if self is other else self.whole * other.whole
        slope = self.slope * other.whole + self.whole * other.slope
        return Centred(self.half, self.middle * other.middle, whole, slope)

    def __truediv__(self, other: "Centred") -> "Centred":
        whole = self.whole / other.whole
        slope = (self.slope - whole * other.slope) / other.whole
        return Centred(self.half, self.middle / other.middle, whole, slope)

    def __neg__(self) -> "Centred":
        return Centred(self.half, -self.middle, -self.whole, -self.slope)


class CentredIntervals:
    """The number system of `Centred`: it runs a program on cells of its variable.

    >>> cells = CentredIntervals(np.array([0.0, 1.0]), np.array([0.5, 1.5]))
    >>> wave = cells.cos(cells.variable)
    >>> wave.whole.low.round(2).tolist(), (wave.slope.high < 0).tolist()
    ([0.88, 0.07], [False, True])
    """

    def __init__(self, low: Array, high: Array) -> None:
        self.half, self.ops, middle = 0.5 * (high - low), SharpIntervals(), 0.5 * (low + high)
        self.half = self.half + OUTWARDS * np.abs(middle)  # the middle is rounded
        one = Interval(np.ones_like(low), np.ones_like(low))
        self.variable = Centred(self.half, Interval(middle, middle), Interval(low, high), one)

    def constant(self, x: Interval) -> Centred:
        """A value that is the same on every cell."""
        return Centred.constant(self.half, x)

    def q(self, p: int, n: int) -> Centred:
        """The rational `p/n`."""
        return self.constant(self.ops.q(p, n))

    @property
    def pi(self) -> Centred:
        """Pi."""
        return self.constant(self.ops.pi)

    def _word(self, word: Callable[[Interval], Interval], x: Centred, slope: Callable[[Interval], Interval]) -> Centred:
        """`word(x)` by the chain rule; `slope` gives the derivative of `word` as a function of its value."""
        whole = word(x.whole)
        return Centred(self.half, word(x.middle), whole, slope(whole) * x.slope)

    def sqrt(self, x: Centred) -> Centred:
        """The square root."""
        return self._word(self.ops.sqrt, x, lambda value: self.ops.q(1, 2) / value)

    def root(self, x: Centred, n: int) -> Centred:
        """The positive `n`-th root."""
        return self._word(lambda v: self.ops.root(v, n), x, lambda value: self.ops.q(1, n) * value / x.whole)

    def exp(self, x: Centred) -> Centred:
        """The exponential."""
        return self._word(self.ops.exp, x, lambda value: value)

    def log(self, x: Centred) -> Centred:
        """The natural logarithm."""
        return self._word(self.ops.log, x, lambda _: self.ops.q(1, 1) / x.whole)

    def atan(self, x: Centred) -> Centred:
        """The arc tangent."""
        return self._word(self.ops.atan, x, lambda _: self.ops.q(1, 1) / (self.ops.q(1, 1) + x.whole.squared()))

    def sinh(self, x: Centred) -> Centred:
        """The hyperbolic sine."""
        return self._word(self.ops.sinh, x, lambda _: self.ops.cosh(x.whole))

    def cosh(self, x: Centred) -> Centred:
        """The hyperbolic cosine."""
        return self._word(self.ops.cosh, x, lambda _: self.ops.sinh(x.whole))

    def tanh(self, x: Centred) -> Centred:
        """The hyperbolic tangent."""
        return self._word(self.ops.tanh, x, lambda value: self.ops.q(1, 1) - value.squared())

    def sin(self, x: Centred) -> Centred:
        """The sine."""
        return self._word(self.ops.sin, x, lambda _: self.ops.cos(x.whole))

    def cos(self, x: Centred) -> Centred:
        """The cosine."""
        return self._word(self.ops.cos, x, lambda _: -self.ops.sin(x.whole))


def unit_vectors(low: Array, high: Array) -> tuple[Interval, Interval]:
    """Cosine and sine on the cells from `low` to `high`."""
    angle = Interval.around(low, high, share=OUTWARDS)
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
    """The number system of `Secant`: runs a program on both ends of a chord, with differences divided by `step`."""

    def __init__(self, ops: Backend[N, M], step: N) -> None:
        self.ops, self.step = ops, step

    def constant(self, x: N) -> Secant[N, M]:
        """A value that is the same at both ends."""
        return Secant(self.ops, x, x, self.ops.number(0.0))

    def q(self, p: int, n: int) -> Secant[N, M]:
        """The rational `p/n`."""
        return self.constant(self.ops.q(p, n))

    @property
    def pi(self) -> Secant[N, M]:
        """Pi."""
        return self.constant(self.ops.pi)

    def _ratio(self, value: N, x: N) -> N:
        """`value/x`, or 1 where `x` is 0: the limit for a function with value 0 and slope 1 at 0."""
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
        """The `n`-th root, by `b - a = (b**n - a**n)/(sum of b**i*a**(n - 1 - i))`."""
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
        """The logarithm; the slope is divided by the logarithmic mean `(a + b)/2*tanh(h)/h` with `h = log(b/a)/2`."""
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
