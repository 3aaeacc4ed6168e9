"""Arrays of balls in float64 with proved rounding, and functions of them as machine code.

A ball with midpoint `m` and radius `r` holds every real number within `r` of `m`. Two facts about float64 are used: the
sum, difference, product, quotient and square root are the doubles nearest to the true ones, and adding two doubles
never gets the sign wrong. So an operation on midpoints errs by at most `ROUNDING` times its result, and by `TINY` where
the result underflows; the few roundings in the radius itself are covered by `GROWTH`. Sine, cosine and exponential are
our own polynomials, since nobody proves a bound for those of a library: `UNIT_ERROR` and `EXPONENTIAL_ERROR` bound
reduction, Taylor remainder and rounding together (docs/global.md has the count). A radius of infinity or nan means that
nothing is known; every comparison is True only where it is certain, and False for nan.
"""

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from numeric.backends.scalars import ArrayBackend
from numeric.kernels.traced import Traced

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
ROUNDING = 2.0**-52  # twice the largest relative error of one operation
GROWTH = 1.0 + 2.0**-48  # covers sixteen roundings of a radius
TINY = 1e-300
GUESS = ArrayBackend()
UNIT_ERROR = 2.0**-49  # error of sine and cosine at a double below LARGEST
LARGEST = 64.0
HALF_PI = tuple(map(float.fromhex, ("0x1.921fb54400000p+0", "0x1.0b4611a600000p-34", "0x1.3198a2e037073p-69")))
SINE = [(-1.0) ** k / float(np.prod(np.arange(1.0, 2 * k + 2))) for k in range(10)]
LN2 = tuple(map(float.fromhex, ("0x1.62e42fee00000p-1", "0x1.a39ef35793c76p-33")))
EXPONENTIAL = [1.0 / float(np.prod(np.arange(1.0, k + 1))) for k in range(15)]
EXPONENTIAL_ERROR = 2.0**-48  # relative error of the exponential at a double below LARGEST
COSINE = [(-1.0) ** k / float(np.prod(np.arange(1.0, 2 * k + 1))) for k in range(11)]


class BallArray:
    """Balls with midpoints `m` and radii `r`: arrays or floats that broadcast against each other.

    >>> x = BallArray(np.array([1.0, 3.0]), 0.5)
    >>> (x * x).lower() <= 0.25, (x * x).upper() >= 2.25
    (array([ True, False]), array([ True,  True]))
    """

    __slots__ = ("m", "r")
    __array_ufunc__ = None  # NumPy leaves arithmetic with a ball to the ball

    def __init__(self, m: Any, r: Any = 0.0) -> None:
        self.m, self.r = m, r

    def __neg__(self) -> "BallArray":
        return BallArray(-self.m, self.r)

    def __add__(self, other: Any) -> "BallArray":
        other = ball(other)
        m = self.m + other.m
        return BallArray(m, (self.r + other.r + ROUNDING * np.abs(m)) * GROWTH)

    def __sub__(self, other: Any) -> "BallArray":
        other = ball(other)
        m = self.m - other.m
        return BallArray(m, (self.r + other.r + ROUNDING * np.abs(m)) * GROWTH)

    def __mul__(self, other: Any) -> "BallArray":
        other = ball(other)
        m, a = self.m * other.m, np.abs(self.m)
        r = a * other.r + self.r * (np.abs(other.m) + other.r) + ROUNDING * np.abs(m) + TINY
        return BallArray(m, r * GROWTH)

    def __truediv__(self, other: Any) -> "BallArray":
        other = ball(other)
        with np.errstate(all="ignore"):
            m = self.m / other.m
            gap = np.abs(other.m) - other.r
            size = np.abs(m)
            r = ((self.r + (size + TINY) * other.r) / gap + ROUNDING * size + TINY) * GROWTH
        return BallArray(m, np.where(gap > 0, r, np.inf))

    def __radd__(self, other: Any) -> "BallArray":
        return self.__add__(other)

    def __rsub__(self, other: Any) -> "BallArray":
        return (-self).__add__(other)

    def __rmul__(self, other: Any) -> "BallArray":
        return self.__mul__(other)

    def __rtruediv__(self, other: Any) -> "BallArray":
        return BallArray(other).__truediv__(self)

    def __getitem__(self, index: Any) -> "BallArray":
        m, r = self.m, self.r
        if np.shape(m) != np.shape(r):
            m, r = np.broadcast_arrays(m, r)
        return BallArray(m[index], r[index])

    def upper(self) -> Array:
        """Upper bounds of the balls, as doubles."""
        m = self.m + self.r
        found: Array = m + (np.abs(m) * ROUNDING + TINY)
        return found

    def lower(self) -> Array:
        """Lower bounds of the balls, as doubles."""
        m = self.m - self.r
        found: Array = m - (np.abs(m) * ROUNDING + TINY)
        return found

    def positive(self) -> Mask:
        """True where every number of a ball is positive; False where that is not known."""
        known: Mask = self.m - self.r > 0  # not where the radius is infinite or nan
        return known

    def negative(self) -> Mask:
        """True where every number of a ball is negative; False where that is not known."""
        known: Mask = self.m + self.r < 0
        return known

    def magnitude(self) -> Array:
        """Upper bounds of the absolute values of the numbers in each ball, as doubles."""
        found: Array = (np.abs(self.m) + self.r) * GROWTH
        return found


def ball(x: Any) -> BallArray:
    """The number as a ball array; floats, and integers below 2**53 in absolute value, become balls of radius 0."""
    return x if isinstance(x, BallArray) else BallArray(x)


def exactly(number: Fraction) -> BallArray:
    """A ball that holds a rational number.

    >>> float(exactly(Fraction(1, 2)).r), bool(exactly(Fraction(1, 3)).r > 0)
    (0.0, True)
    """
    m = number.numerator / number.denominator
    return BallArray(m, 0.0 if Fraction(m) == number else abs(m) * ROUNDING)


def hull(low: Any, high: Any) -> BallArray:
    """Balls that hold all numbers between two arrays of doubles.

    >>> bool(hull(0.1, 0.3).lower() <= 0.1), bool(hull(0.1, 0.3).upper() >= 0.3)
    (True, True)
    """
    m = low + (high - low) / 2
    r = np.maximum(high - m, m - low)
    return BallArray(m, (r + TINY) * GROWTH)


def common_part(x: BallArray, y: BallArray) -> BallArray:
    """Balls that hold the intersection of two enclosures of a number; one of infinite or nan radius is ignored."""
    low = np.fmax(np.where(np.isfinite(x.r), x.lower(), -np.inf), np.where(np.isfinite(y.r), y.lower(), -np.inf))
    high = np.fmin(np.where(np.isfinite(x.r), x.upper(), np.inf), np.where(np.isfinite(y.r), y.upper(), np.inf))
    with np.errstate(invalid="ignore"):
        return hull(low, high)


def spread(value: Any, like: Array) -> BallArray:
    """The ball array `value` broadcast to the shape of `like`, as a formula returns a single ball for a constant."""
    value = value if isinstance(value, BallArray) else BallArray(value)
    m, r = np.broadcast_arrays(value.m, value.r, like)[:2]
    return BallArray(m, r)


class Compiled:
    """A function from ball arrays to ball arrays, compiled to a single loop of machine code.

    >>> (square,) = Compiled(lambda x: [x * x])(BallArray(np.array([1.0, 3.0]), 0.5))
    >>> bool((square.m == [1, 9]).all()), bool((square.upper() >= [2.25, 12.25]).all())
    (True, True)
    """

    def __init__(self, function: Callable[..., Sequence[BallArray]]) -> None:
        self.traced = Traced(lambda *rows: unpaired(function(*paired(rows))))

    def __call__(self, *balls: BallArray) -> list[BallArray]:
        return paired(self.traced(*unpaired(balls)))


def unpaired(balls: Iterable[BallArray]) -> list[Any]:
    """The list `[m, r, m, r, ...]` of midpoints and radii of the balls."""
    return [half for each in balls for half in (each.m, each.r)]


def paired(rows: Sequence[Any]) -> list[BallArray]:
    """The balls whose midpoints and radii are `[m, r, m, r, ...]`."""
    return [BallArray(m, r) for m, r in zip(rows[::2], rows[1::2], strict=True)]


class ArrayOps:
    """Operations on ball arrays that a program of `numeric.lowering` calls: constants, roots and elementary functions.

    A library's logarithm or root serves only as a guess, which the exponential or a power then checks.
    """

    @staticmethod
    @cache
    def q(p: int, n: int) -> BallArray:
        """A ball that holds `p/n`."""
        return exactly(Fraction(p, n))

    @property
    def pi(self) -> BallArray:
        """A ball that holds pi."""
        return BallArray(np.pi, 2.0**-51)

    def sqrt(self, x: BallArray) -> BallArray:
        """The square root; the radius is infinite where the ball is not known to be positive."""
        with np.errstate(all="ignore"):
            m = np.sqrt(x.m)
            r = (x.r / m + ROUNDING * m) * GROWTH
        return BallArray(m, np.where(x.m - x.r > 0, r, np.inf))

    def sin(self, x: BallArray) -> BallArray:
        """The midpoint's sine; its error bound plus the radius of `x` is the radius, as the slope is at most 1."""
        return self.turned(x)[1]

    def cos(self, x: BallArray) -> BallArray:
        """The cosine, enclosed like the sine."""
        return self.turned(x)[0]

    def turned(self, x: BallArray) -> tuple[BallArray, BallArray]:
        """Cosine and sine, at the cost of computing one of the two."""
        return turned(x)

    def exp(self, x: BallArray) -> BallArray:
        """The exponential of the midpoint, by powers of 2 and a Taylor sum; the radius by `exp(r) <= 1 + r + r**2`."""
        m, r = np.broadcast_arrays(np.asarray(x.m, dtype=float), x.r)
        with np.errstate(all="ignore"):
            k = np.rint(m / LN2[0])
            value = np.ldexp(_horner(EXPONENTIAL, m - k * LN2[0] - k * LN2[1]), np.nan_to_num(k).astype(int))
            radius = value * (r * (1 + r) + EXPONENTIAL_ERROR * (1 + r) ** 2) * GROWTH
        return BallArray(value, np.where((np.abs(m) < LARGEST) & (r <= 1), radius, np.inf))

    def log(self, x: BallArray) -> BallArray:
        """The logarithm as `w + (y - 1)`, where `w` is a guess and `y = x*exp(-w)`.

        The error is at most `(y - 1)**2` where `abs(y - 1) <= 1/2`; elsewhere the radius is infinite.
        """
        with np.errstate(all="ignore"):
            w = elementary.log(np.asarray(x.m, dtype=float))
            gap = x * self.exp(BallArray(-w)) - 1
            size = gap.magnitude()
        return BallArray(w + 0 * size, np.where(size <= 0.5, size**2 * GROWTH, np.inf)) + gap

    def atan(self, x: BallArray) -> BallArray:
        """The arc tangent, computed as the angle of the vector `(1, x)`."""
        return direction(BallArray(np.ones_like(x.m)), x)

    def sinh(self, x: BallArray) -> BallArray:
        """The hyperbolic sine."""
        up = self.exp(x)
        return (up - 1 / up) / 2

    def cosh(self, x: BallArray) -> BallArray:
        """The hyperbolic cosine."""
        up = self.exp(x)
        return (up + 1 / up) / 2

    def tanh(self, x: BallArray) -> BallArray:
        """The hyperbolic tangent."""
        return 1 - 2 / (self.exp(x * 2) + 1)

    def Abs(self, x: BallArray) -> BallArray:
        """The absolute value of the midpoint, with the ball's radius."""
        return BallArray(np.abs(x.m), x.r)

    def root(self, x: BallArray, n: int) -> BallArray:
        """The root as `w*(1 + d/n)`, where `w` is a guess and `1 + d = x/w**n`.

        The number `1 + d/n` errs by at most `d**2` where `abs(d) <= 1/2`; elsewhere the radius is infinite.
        """
        with np.errstate(all="ignore"):
            w = power = BallArray(elementary.root(x.m, n))
            for _ in range(n - 1):
                power = power * w
            d = x / power - 1
            size = d.magnitude()  # where it is not small the radius is infinite, and of the product infinite or nan
            return w * (1 + d / n + BallArray(0.0, np.where(size <= 0.5, size**2 * GROWTH, np.inf)))


class WideOps(ArrayOps):
    """The operations of `ArrayOps` with sharper bounds for wide balls, at twice the cost.

    >>> bool(WideOps().cos(BallArray(0.0, 0.1)).r < 0.006), bool(WideOps().atan(BallArray(3.0, 1.0)).r < 0.12)
    (True, True)
    """

    def turned(self, x: BallArray) -> tuple[BallArray, BallArray]:
        """Cosine and sine of balls, by Taylor's theorem: `|cos(m + e) - cos(m)| <= |sin(m)|*|e| + e**2/2`."""
        c, s = turned(BallArray(x.m))
        moved = (np.minimum(x.r, other.magnitude() * x.r + x.r * x.r / 2) * GROWTH for other in (s, c))
        return tuple(BallArray(at.m, (at.r + by) * GROWTH) for at, by in zip((c, s), moved, strict=True))  # type: ignore[return-value]

    def atan(self, x: BallArray) -> BallArray:
        """The arc tangent: as the function increases, the ends of a ball give the ends of its image."""
        low, high = (direction(BallArray(np.ones_like(x.m)), BallArray(end)) for end in (x.lower(), x.upper()))
        return hull(low.lower(), high.upper())


def turned(x: BallArray) -> tuple[BallArray, BallArray]:
    """Cosine and sine of balls whose midpoints are below `LARGEST`; the radius is infinite elsewhere.

    >>> c, s = turned(BallArray(np.array([0.0, 1.0])))
    >>> bool((c * c + s * s - 1).magnitude().max() < 1e-14)
    True
    """
    m = x.m
    with np.errstate(invalid="ignore"):
        k = np.rint(m * (2 / np.pi))
        t = m - k * HALF_PI[0] - k * HALF_PI[1] - k * HALF_PI[2]
        z = t * t
        sine, cosine = t * _horner(SINE, z), _horner(COSINE, z)
        quarter = k - 4 * np.floor(k / 4)  # exact
    odd, behind, below = (quarter == 1) | (quarter == 3), (quarter == 1) | (quarter == 2), quarter >= 2
    c, s = np.where(odd, sine, cosine), np.where(odd, cosine, sine)
    r = (x.r + UNIT_ERROR) * GROWTH
    r = np.where((np.abs(m) < LARGEST) & (np.abs(t) < 0.8), r, np.inf)
    return BallArray(np.where(behind, -c, c), r), BallArray(np.where(below, -s, s), r)


def direction(c: BallArray, s: BallArray) -> BallArray:
    """Angle of the vectors `(c, s)`, near `arctan2` of the midpoints; infinite radius where a right angle is possible.

    The guess is any double `w`. Turned by `-w`, the vector has a small angle, the arc tangent of a quotient `x`, which
    lies within `|x|**3/3` of `x`.
    """
    with np.errstate(all="ignore"):
        w = np.where((s.m == 0) & (c.m == 0), 0.0, GUESS.atan2(s.m, c.m))
    cw, sw = turned(BallArray(w))
    across, along = s * cw - c * sw, c * cw + s * sw
    x = across / along
    size = x.magnitude()
    angle = BallArray(w, size * size * size / 3 * GROWTH) + x
    return BallArray(angle.m, np.where(along.positive(), angle.r, np.inf))


def _horner(coefficients: list[float], z: Array) -> Array:
    value = coefficients[-1] * z + coefficients[-2]
    for coefficient in reversed(coefficients[:-2]):
        value *= z
        value += coefficient
    return value
