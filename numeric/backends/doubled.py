"""Numbers with twice the digits: each is the unevaluated sum of two doubles, computed by error-free transformations.

A sum, a product, a quotient or a root has an error of a few units of `2**-104` of its operands.

**The elementary functions have ten bits more than doubles, not twice as many.** This is enough for flights, and it is
cheap: the first terms of a Taylor series about the nearest multiple of `log(2)` or `pi/2` are sums of two doubles, and
the further terms, less than `2**-11` of the whole, are a double. An inverse function takes one step of Newton's method
from the nearest double: a logarithm by an exponential, an arc tangent by sine and cosine, roots by powers. The error of
an exponential or a hyperbolic function is at most `UNIT` times the modulus of the value. For a logarithm, an arc
tangent, a sine or a cosine the bound is larger by `2**-104` times the modulus of the argument; angles may be as large
as `2**30`. tests/numeric/backends/test_doubled.py compares all of them with 50 digits.
"""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, Generic

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, M, N, Pair, modulus

ROOTS = {f"root{n}": n for n in range(3, 13)}
WORDS = {"+": 1, "-": 1, "*": 1, "/": 1, "neg": 1, "q": 1, "pi": 1, "sqrt": 1} | ROOTS  # what each costs, in sums
OTHERS = {"exp": 8, "sinh": 11, "cosh": 10, "tanh": 11, "log": 10, "sin": 13, "cos": 13, "atan": 16}
UNIT = 2.0**-63
LOG_2, HALF_PI = (plane.LOG_2, plane.LOG_2_LOW), (plane.HALF_PI, plane.HALF_PI_LOW)
EXP = tuple(1 / math.factorial(n) for n in range(5, 17))  # of the terms of exp(r) from r**5 on, |r| < log(2)/2
SIN = tuple((-1) ** n / math.factorial(2 * n + 1) for n in range(3, 11))  # of sin(r) from r**7 on, |r| < pi/4
COS = tuple((-1) ** n / math.factorial(2 * n) for n in range(3, 11))  # of cos(r) from r**6 on


LONG = 200  # sums of programs that run with more digits: more would take seconds to compile


def affordable(*programs: Sequence[tuple[str, *tuple[int, ...]]]) -> bool:
    """Are the programs, given by their lines, short enough to compile in seconds: at most `LONG` additions?"""
    return sum((WORDS | OTHERS)[word] for lines in programs for word, *_ in lines) <= LONG


class Double(Generic[N, M]):
    """The number `high + low`, where `|low|` is at most half a unit in the last place of `high`.

    >>> from numeric.backends.scalars import ArrayBackend
    >>> third = Doubles(ArrayBackend()).q(1, 3)
    >>> (third + third + third - Doubles(ArrayBackend()).q(1, 1)).high
    0.0
    """

    def __init__(self, ops: Backend[N, M], high: N, low: N) -> None:
        self.ops, self.high, self.low = ops, high, low

    def __add__(self, other: "Double[N, M]") -> "Double[N, M]":
        total, rest = sum_and_error(self.high, other.high)
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


Two = tuple[Double[N, M], Double[N, M]]


def sum_and_error(x: N, y: N) -> Pair[N]:
    """The rounded sum `x + y` and its exact rounding error, for numbers of any sizes."""
    total = x + y
    back = total - x
    return total, (x - (total - back)) + (y - back)


def _ordered(ops: Backend[N, M], high: N, low: N) -> Double[N, M]:
    """The sum of two doubles, as a `Double`; `high` must be the larger one in modulus."""
    total = high + low
    return Double(ops, total, low - (total - high))


class Sum(Generic[N, M]):
    """Accumulates numbers and products of modulus up to about `size`, a power of two, with an error of about
    `2**-85*size`.

    The leading parts are added to a large number, which rounds them to multiples of `2**-36*size`, so that these sums
    are exact; the remainders are added up in doubles. So a product takes four operations.
    """

    def __init__(self, ops: Backend[N, M], size: float) -> None:
        self.ops, self.base = ops, ops.number(1.5 * 2.0**16 * size)
        self.total, self.low = self.base, ops.number(0.0)

    def add(self, x: Double[N, M]) -> None:
        """Adds a number."""
        total = self.total + x.high
        self.low = self.low + (x.high - (total - self.total)) + x.low
        self.total = total

    def add_product(self, x: N, y: N) -> None:
        """Adds a product."""
        if self.ops.same(y, self.ops.number(0.0)):
            return
        total = self.ops.fma(x, y, self.total)
        self.low = self.low + self.ops.fma(x, y, self.total - total)
        self.total = total

    def value(self) -> Double[N, M]:
        """The sum so far."""
        return Double(self.ops, self.total - self.base, self.low)


def short_of(ops: Backend[N, M], u: Pair[N]) -> N:
    """`(1 - |u|**2)/2` of a unit vector `u` that is rounded; the difference loses no digits by cancellation."""
    found = Sum(ops, 1.0)
    for x in u:
        found.add_product(-x, x)
    square = found.value()
    return ops.number(0.5) * ((ops.number(1.0) + square.high) + square.low)


class Doubles(Generic[N, M]):
    """The number system of `Double`: each number is a pair of numbers of another backend."""

    def __init__(self, ops: Backend[N, M]) -> None:
        self.ops = ops

    def of(self, x: N) -> Double[N, M]:
        """A number of the backend, converted exactly."""
        return Double(self.ops, x, self.ops.number(0.0))

    def known(self, x: Double[Any, Any]) -> Double[N, M]:
        """A constant that was computed on another backend, converted to this one."""
        return Double(self.ops, self.ops.number(float(x.high)), self.ops.number(float(x.low)))

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

    # ---- elementary functions

    def plus(self, p: int, n: int, x: Double[N, M]) -> Double[N, M]:
        """`p/n + x` where `|x| <= |p/n|`."""
        constant = self.q(p, n)
        total = constant.high + x.high
        return _ordered(self.ops, total, (x.high - (total - constant.high)) + (constant.low + x.low))

    def scaled(self, power: N, x: Double[N, M]) -> Double[N, M]:
        """A power of two times a number, exactly."""
        return Double(self.ops, self.ops.product(power, x.high), self.ops.product(power, x.low))

    def times_sign(self, x: Double[N, M], y: N) -> Double[N, M]:
        """`x` with its sign flipped where `y` is negative."""
        return Double(self.ops, self.ops.times_sign(x.high, y), self.ops.times_sign(x.low, y))

    def select(self, mask: M, x: Double[N, M], y: Double[N, M]) -> Double[N, M]:
        """`x` where the mask holds, else `y`."""
        return Double(self.ops, self.ops.select(mask, x.high, y.high), self.ops.select(mask, x.low, y.low))

    def series(self, leading: Sequence[tuple[int, int]], tail: tuple[float, ...], r: Double[N, M]) -> Double[N, M]:
        """The polynomial in `r`, constant first, with rational coefficients `leading`, followed by doubles `tail`."""
        ops = self.ops
        high, low = plane.horner(ops, tail, r.high), ops.number(0.0)
        for p, n in reversed(leading):
            c = self.q(p, n)
            product, error = plane.product_and_error(ops, r.high, high)
            total = c.high + product
            rest = product - (total - c.high)
            high, low = total, rest + (error + (c.low + (r.high * low + r.low * high)))
        return Double(ops, high, low)

    def reduced(self, x: Double[N, M], j: N, c: Pair[float]) -> Double[N, M]:
        """`x - j*c` for a whole number `j` and a constant that is the sum of the two doubles `c`."""
        ops = self.ops
        product, error = plane.product_and_error(ops, -j, ops.number(c[0]))
        total, rest = sum_and_error(x.high, product)
        return Double(ops, *sum_and_error(total, ops.fma(-j, ops.number(c[1]), rest + (x.low + error))))

    def exp_less_one(self, x: Double[N, M]) -> tuple[N, Double[N, M]]:
        """`(2**k, p)` with `exp(x) = 2**k*(1 + p)`, `|p| < 0.42`, for `|x| <= 708`; `p` has relative error `UNIT`."""
        k = self.ops.rounded(x.high * self.ops.number(1 / LOG_2[0]))
        r = self.reduced(x, k, LOG_2)
        return self.ops.two_to(k), r * self.series(((1, 1), (1, 2), (1, 6), (1, 24)), EXP, r)

    def within(self, x: Double[N, M]) -> Double[N, M]:
        """`x`, clamped to the interval in which the exponential neither overflows nor underflows."""
        high = plane.within(self.ops, x.high)
        return Double(self.ops, high, self.ops.select(high == x.high, x.low, self.ops.number(0.0)))

    def exp(self, x: Double[N, M]) -> Double[N, M]:
        """The exponential."""
        scale, p = self.exp_less_one(self.within(x))
        return self.scaled(scale, self.plus(1, 1, p))

    def grown(self, x: Double[N, M]) -> Double[N, M]:
        """`exp(x) - 1` for `0 <= x`, with a relative error of a few `UNIT`."""
        scale, p = self.exp_less_one(self.within(x))
        return self.scaled(scale, p) + (self.of(scale) - self.q(1, 1))

    def sinh(self, x: Double[N, M]) -> Double[N, M]:
        """The hyperbolic sine."""
        more = self.grown(self.times_sign(x, x.high))
        half = self.ops.number(0.5)
        return self.times_sign(self.scaled(half, more + more / (more + self.q(1, 1))), x.high)

    def cosh(self, x: Double[N, M]) -> Double[N, M]:
        """The hyperbolic cosine."""
        grown = self.exp(self.times_sign(x, x.high))
        return self.scaled(self.ops.number(0.5), grown + self.q(1, 1) / grown)

    def tanh(self, x: Double[N, M]) -> Double[N, M]:
        """The hyperbolic tangent."""
        more = self.grown(self.scaled(self.ops.number(2.0), self.times_sign(x, x.high)))
        return self.times_sign(more / (more + self.q(2, 1)), x.high)

    def turn(self, x: Double[N, M]) -> tuple[Double[N, M], Double[N, M]]:
        """`(cos x, sin x)` of angles up to `2**30`."""
        ops, one = self.ops, self.ops.number(1.0)
        j = ops.rounded(x.high * ops.number(plane.TWO_OVER_PI))
        r = self.reduced(x, j, HALF_PI)
        w = r * r
        sine = r * self.series(((1, 1), (-1, 6), (1, 120)), SIN, w)
        cosine = self.series(((1, 1), (-1, 2), (1, 24)), COS, w)
        m = j - ops.number(4.0) * ops.rounded(j * ops.number(0.25))  # quarters of a turn, -2 to 2
        size = modulus(m)
        odd = modulus(size - one) < ops.number(0.5)
        behind = ops.select(ops.number(1.5) < size, -one, one)
        turned = ops.select(odd, m, behind)  # a sign: of the sine, and where `odd` the opposite of the cosine's
        flipped = ops.select(odd, -m, behind)
        along = self.times_sign(self.select(odd, sine, cosine), flipped)
        return along, self.times_sign(self.select(odd, cosine, sine), turned)

    def sin(self, x: Double[N, M]) -> Double[N, M]:
        """The sine, of angles up to `2**30`."""
        return self.turn(x)[1]

    def cos(self, x: Double[N, M]) -> Double[N, M]:
        """The cosine, of angles up to `2**30`."""
        return self.turn(x)[0]

    def log(self, x: Double[N, M]) -> Double[N, M]:
        """The natural logarithm of a positive number: Newton's step on `exp(y) = x`."""
        near = self.ops.log(x.high)
        gap = x * self.exp(self.of(-near)) - self.q(1, 1)
        return _ordered(self.ops, near, gap.high)

    def atan(self, x: Double[N, M]) -> Double[N, M]:
        """The arc tangent: Newton's step on `tan(y) = x`."""
        near = self.ops.atan(x.high)
        c, s = self.turn(self.of(near))
        return _ordered(self.ops, near, (x * c - s).high / (c + x * s).high)

    def root(self, x: Double[N, M], n: int) -> Double[N, M]:
        """The positive `n`-th root of a number of at least `2**-900`: Newton's step on `y**n = x`."""
        near = self.of(self.ops.root(x.high, n))
        power = near
        for _ in range(n - 2):
            power = power * near
        gap = (power * near - x).high / (power.high * self.ops.number(float(n)))
        return _ordered(self.ops, near.high, -gap)

    def unit(self, u: Pair[N]) -> tuple[Double[N, M], Double[N, M]]:
        """The vector `u`, a unit vector up to rounding, normalised with twice the digits."""
        x, y = self.of(u[0]), self.of(u[1])
        short = self.of(self.ops.number(0.5) * (self.q(1, 1) - x * x - y * y).high)
        return x + x * short, y + y * short
