"""Balls in float64 arrays: midpoint and radius, with a proved bound for the rounding of every operation.

A ball with midpoint `m` and radius `r` holds every real number within `r` of `m`. Two facts are used of float64: the
sum, difference, product, quotient and square root are the doubles nearest to the true ones, and adding two doubles
never gets the sign wrong. So an operation on midpoints errs by at most `ROUNDING` times its result, and by `TINY`
where that underflows; the few roundings in the radius itself are covered by `GROWTH`. Sine and cosine are our own
polynomials, since nobody proves a bound for those of a library: `UNIT_ERROR` bounds reduction, Taylor remainder and
rounding together (docs/global.md has the count). A radius of infinity, or nan, says that nothing is known; every
question here asks for what is certain, so that nan answers no.
"""

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ROUNDING = 2.0**-52  # twice the largest relative error of one operation
GROWTH = 1.0 + 2.0**-48  # covers sixteen roundings of a radius
TINY = 1e-300
UNIT_ERROR = 2.0**-49  # of sine and cosine at a double below LARGEST
LARGEST = 64.0
HALF_PI = tuple(map(float.fromhex, ("0x1.921fb54400000p+0", "0x1.0b4611a600000p-34", "0x1.3198a2e037073p-69")))
SINE = [(-1.0) ** k / float(np.prod(np.arange(1.0, 2 * k + 2))) for k in range(10)]
COSINE = [(-1.0) ** k / float(np.prod(np.arange(1.0, 2 * k + 1))) for k in range(11)]


class BallArray:
    """Balls, one for each entry of two arrays that broadcast against each other.

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
        m, r = np.broadcast_arrays(self.m, self.r)
        return BallArray(m[index], r[index])

    def upper(self) -> Array:
        """Doubles above every number of each ball."""
        m = np.asarray(self.m + self.r)
        return np.asarray(m + (np.abs(m) * ROUNDING + TINY))

    def lower(self) -> Array:
        """Doubles below every number of each ball."""
        m = np.asarray(self.m - self.r)
        return np.asarray(m - (np.abs(m) * ROUNDING + TINY))

    def positive(self) -> NDArray[np.bool_]:
        """Where every number is positive; False says only that this is not known."""
        return np.asarray((self.m - self.r > 0) & (self.r < np.inf))

    def negative(self) -> NDArray[np.bool_]:
        """Where every number is negative; False says only that this is not known."""
        return np.asarray((self.m + self.r < 0) & (self.r < np.inf))

    def magnitude(self) -> Array:
        """Doubles above the absolute value of every number."""
        return np.asarray((np.abs(self.m) + self.r) * GROWTH)


def ball(x: Any) -> BallArray:
    """A ball array as it is; a float, or whole numbers below 2**53, as balls of radius 0."""
    return x if isinstance(x, BallArray) else BallArray(x)


def exactly(number: Fraction) -> BallArray:
    """A rational number, enclosed.

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
    return BallArray(m, (r + ROUNDING * r + TINY) * GROWTH)


class ArrayOps:
    """What a program of `numeric.lowering` needs of ball arrays: constants, roots, sine and cosine."""

    def q(self, p: int, n: int) -> BallArray:
        """`p/n`, enclosed."""
        return exactly(Fraction(p, n))

    @property
    def pi(self) -> BallArray:
        """Pi, enclosed."""
        return BallArray(np.pi, 2.0**-51)

    def sqrt(self, x: BallArray) -> BallArray:
        """The square root; nothing is known where the ball reaches below zero."""
        with np.errstate(all="ignore"):
            m = np.sqrt(x.m)
            r = (x.r / m + ROUNDING * m + TINY) * GROWTH
        return BallArray(m, np.where(x.m - x.r > 0, r, np.inf))

    def sin(self, x: BallArray) -> BallArray:
        """The sine: of the midpoint, and it moves by no more than the radius."""
        return turned(x)[1]

    def cos(self, x: BallArray) -> BallArray:
        """The cosine."""
        return turned(x)[0]


def turned(x: BallArray) -> tuple[BallArray, BallArray]:
    """Cosine and sine.

    >>> c, s = turned(BallArray(np.array([0.0, 1.0])))
    >>> bool((c * c + s * s - 1).magnitude().max() < 1e-14)
    True
    """
    m = np.asarray(x.m, dtype=float)
    with np.errstate(invalid="ignore"):
        k = np.rint(m * (2 / np.pi))
        t = m - k * HALF_PI[0] - k * HALF_PI[1] - k * HALF_PI[2]
        z = t * t
        sine, cosine = t * _horner(SINE, z), _horner(COSINE, z)
        quarter = np.mod(k, 4.0)
    odd, behind, below = quarter % 2 == 1, (quarter == 1) | (quarter == 2), quarter >= 2
    c, s = np.where(odd, sine, cosine), np.where(odd, cosine, sine)
    r = (x.r + UNIT_ERROR) * GROWTH
    r = np.where((np.abs(m) < LARGEST) & (np.abs(t) < 0.8), r, np.inf)
    return BallArray(np.where(behind, -c, c), r), BallArray(np.where(below, -s, s), r)


def direction(c: BallArray, s: BallArray) -> BallArray:
    """The angle of the vectors `(c, s)`, near `arctan2` of the midpoints; nothing is known where one may turn back.

    The guess is any double `w`. Turned by `-w`, the vector has a small angle, the arc tangent of a quotient `x`, which
    lies within `|x|**3/3` of `x`.
    """
    w = np.arctan2(s.m, c.m)
    cw, sw = turned(BallArray(w))
    across, along = s * cw - c * sw, c * cw + s * sw
    x = across / along
    size = x.magnitude()
    angle = BallArray(w, size**3 / 3 * GROWTH) + x
    return BallArray(angle.m, np.where(along.positive(), angle.r, np.inf))


def _horner(coefficients: list[float], z: Array) -> Array:
    value = np.full_like(z, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        value = value * z + coefficient
    return value
