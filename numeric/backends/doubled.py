"""Programs with twice the digits: every number is the unevaluated sum of two doubles, by error-free transformations.

A sum or a product is off by a few units of `2**-104` of the numbers that go into it. Only the words in `WORDS` have
twice the digits.
"""

from fractions import Fraction
from typing import Generic

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, M, N, Pair

WORDS = {"+", "-", "*", "/", "neg", "q", "pi", "sqrt"}


class Double(Generic[N, M]):
    """`high + low` with `|low|` at most half a unit of `high`.

    >>> from numeric.backends.scalars import ArrayBackend
    >>> third = Doubles(ArrayBackend()).q(1, 3)
    >>> (third + third + third - Doubles(ArrayBackend()).q(1, 1)).high
    0.0
    """

    def __init__(self, ops: Backend[N, M], high: N, low: N) -> None:
        self.ops, self.high, self.low = ops, high, low

    def __add__(self, other: "Double[N, M]") -> "Double[N, M]":
        total, rest = _sum_and_error(self.high, other.high)
        return _ordered(self.ops, total, rest + (self.low + other.low))

    def __sub__(self, other: "Double[N, M]") -> "Double[N, M]":
        return self + -other

    def __mul__(self, other: "Double[N, M]") -> "Double[N, M]":
        product, rest = plane.product_and_error(self.ops, self.high, other.high)
        return _ordered(self.ops, product, rest + (self.high * other.low + self.low * other.high))

    def __truediv__(self, other: "Double[N, M]") -> "Double[N, M]":
        first = self.high / other.high
        rest = self - other * Double(self.ops, first, self.ops.number(0.0))
        return _ordered(self.ops, first, rest.high / other.high)

    def __neg__(self) -> "Double[N, M]":
        return Double(self.ops, -self.high, -self.low)


def _sum_and_error(x: N, y: N) -> Pair[N]:
    """`x + y` rounded, and the rounding error, exactly, whichever is larger."""
    total = x + y
    back = total - x
    return total, (x - (total - back)) + (y - back)


def _ordered(ops: Backend[N, M], high: N, low: N) -> Double[N, M]:
    """The sum of two doubles of which the first is the larger."""
    total = high + low
    return Double(ops, total, low - (total - high))


class Doubles(Generic[N, M]):
    """The number system of `Double`, over some backend."""

    def __init__(self, ops: Backend[N, M]) -> None:
        self.ops = ops

    def of(self, x: N) -> Double[N, M]:
        """A number of the backend, exactly."""
        return Double(self.ops, x, self.ops.number(0.0))

    def q(self, p: int, n: int) -> Double[N, M]:
        """The rational `p/n`."""
        high = p / n
        return Double(self.ops, self.ops.number(high), self.ops.number(float(Fraction(p, n) - Fraction(high))))

    @property
    def pi(self) -> Double[N, M]:
        """Pi."""
        return Double(self.ops, self.ops.pi, self.ops.pi_low)

    def sqrt(self, x: Double[N, M]) -> Double[N, M]:
        """The square root of a positive number."""
        root = self.of(self.ops.sqrt(x.high))
        return _ordered(self.ops, root.high, (x - root * root).high / (root.high + root.high))

    def unit(self, u: Pair[N]) -> tuple[Double[N, M], Double[N, M]]:
        """The unit vector along one whose length is one up to rounding."""
        x, y = self.of(u[0]), self.of(u[1])
        short = self.of(self.ops.number(0.5) * (self.q(1, 1) - x * x - y * y).high)
        return x + x * short, y + y * short
