"""Boxes by the hundred thousand, in float64 with proved rounding, and maps that send each to boxes that hold its image.

A ball with midpoint `m` and radius `r` holds every real number within `r` of `m`. Two facts are used of float64: the
sum, difference, product, quotient and square root are the doubles nearest to the true ones, and adding two doubles
never gets the sign wrong. So an operation on midpoints errs by at most `ROUNDING` times its result, and by `TINY`
where that underflows; the few roundings in the radius itself are covered by `GROWTH`. Sine, cosine and exponential
are our own polynomials, since nobody proves a bound for those of a library: `UNIT_ERROR` and `EXPONENTIAL_ERROR` bound
reduction, Taylor remainder and rounding together (docs/global.md has the count). A radius of infinity, or nan, says
that nothing is known; every question here asks for what is certain, so that nan answers no.

A map is named by its charts, rectangles with two coordinates each; one of the plane is given by a formula in balls
and that of its derivative, and takes a box by the mean-value theorem.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
ROUNDING = 2.0**-52  # twice the largest relative error of one operation
GROWTH = 1.0 + 2.0**-48  # covers sixteen roundings of a radius
TINY = 1e-300
UNIT_ERROR = 2.0**-49  # of sine and cosine at a double below LARGEST
LARGEST = 64.0
HALF_PI = tuple(map(float.fromhex, ("0x1.921fb54400000p+0", "0x1.0b4611a600000p-34", "0x1.3198a2e037073p-69")))
SINE = [(-1.0) ** k / float(np.prod(np.arange(1.0, 2 * k + 2))) for k in range(10)]
LN2 = tuple(map(float.fromhex, ("0x1.62e42fee00000p-1", "0x1.a39ef35793c76p-33")))
EXPONENTIAL = [1.0 / float(np.prod(np.arange(1.0, k + 1))) for k in range(15)]
EXPONENTIAL_ERROR = 2.0**-48  # of the exponential at a double below LARGEST, relative
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
        m, r = self.m, self.r
        if np.shape(m) != np.shape(r):
            m, r = np.broadcast_arrays(m, r)
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


def common_part(x: BallArray, y: BallArray) -> BallArray:
    """What two enclosures of one number have in common; one where the other knows nothing."""
    low = np.fmax(np.where(np.isfinite(x.r), x.lower(), -np.inf), np.where(np.isfinite(y.r), y.lower(), -np.inf))
    high = np.fmin(np.where(np.isfinite(x.r), x.upper(), np.inf), np.where(np.isfinite(y.r), y.upper(), np.inf))
    with np.errstate(invalid="ignore"):
        return hull(low, high)


def spread(value: Any, like: Array) -> BallArray:
    """A ball array of the shape of another; programs give one ball for a coordinate that is constant."""
    value = value if isinstance(value, BallArray) else BallArray(value)
    m, r = np.broadcast_arrays(value.m, value.r, like)[:2]
    return BallArray(m, r)


class ArrayOps:
    """What a program of `numeric.lowering` needs of ball arrays: constants, roots and the functions of a formula.

    Of a library's logarithm or root only a guess is used, which the exponential or a power then judges.
    """

    @staticmethod
    @cache
    def q(p: int, n: int) -> BallArray:
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
        return self.turned(x)[1]

    def cos(self, x: BallArray) -> BallArray:
        """The cosine."""
        return self.turned(x)[0]

    def turned(self, x: BallArray) -> tuple[BallArray, BallArray]:
        """Both, at the cost of one."""
        return turned(x)

    def exp(self, x: BallArray) -> BallArray:
        """The exponential: of the midpoint, by powers of 2 and Taylor's sum, times `exp(r) <= 1 + r + r**2`."""
        m, r = np.broadcast_arrays(np.asarray(x.m, dtype=float), x.r)
        with np.errstate(all="ignore"):
            k = np.rint(m / LN2[0])
            value = np.ldexp(_horner(EXPONENTIAL, m - k * LN2[0] - k * LN2[1]), np.nan_to_num(k).astype(int))
            radius = value * (r * (1 + r) + EXPONENTIAL_ERROR * (1 + r) ** 2) * GROWTH
        return BallArray(value, np.where((np.abs(m) < LARGEST) & (r <= 1), radius, np.inf))

    def log(self, x: BallArray) -> BallArray:
        """The logarithm: a guess `w`, and `y - 1` with `y = x*exp(-w)`, within `(y - 1)**2` while that is small."""
        with np.errstate(all="ignore"):
            w = elementary.log(np.asarray(x.m, dtype=float))
            gap = x * self.exp(BallArray(-w)) - 1
            size = gap.magnitude()
        return BallArray(w + 0 * size, np.where(size <= 0.5, size**2 * GROWTH, np.inf)) + gap

    def atan(self, x: BallArray) -> BallArray:
        """The angle of the vector `(1, x)`."""
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
        """The absolute value, which moves by no more than its argument."""
        return BallArray(np.abs(x.m), x.r)

    def root(self, x: BallArray, n: int) -> BallArray:
        """A guess `w`, times `(1 + d)**(1/n)` with `1 + d = x/w**n`, within `d**2` of `1 + d/n` while `d` is small."""
        with np.errstate(all="ignore"):
            w = power = BallArray(elementary.root(x.m, n))
            for _ in range(n - 1):
                power = power * w
            d = x / power - 1
            size = d.magnitude()  # where it is not small the radius is infinite, and of the product infinite or nan
            return w * (1 + d / n + BallArray(0.0, np.where(size <= 0.5, size**2 * GROWTH, np.inf)))


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
        quarter = k - 4 * np.floor(k / 4)  # exact
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
    w = elementary.arctan2(s.m, c.m)
    cw, sw = turned(BallArray(w))
    across, along = s * cw - c * sw, c * cw + s * sw
    x = across / along
    size = x.magnitude()
    angle = BallArray(w, size**3 / 3 * GROWTH) + x
    return BallArray(angle.m, np.where(along.positive(), angle.r, np.inf))


def _horner(coefficients: list[float], z: Array) -> Array:
    value = coefficients[-1] * z + coefficients[-2]
    for coefficient in reversed(coefficients[:-2]):
        value *= z
        value += coefficient
    return value


class Boxes(NamedTuple):
    """Boxes in the charts of a phase space: the chart, and the ends of both coordinates, one entry for each box."""

    chart: Indices
    x: tuple[Array, Array]
    y: tuple[Array, Array]

    def chosen(self, which: Indices | NDArray[np.bool_] | slice) -> "Boxes":
        """Some of the boxes, by their numbers, by which they are, or a stretch of them."""
        return Boxes(self.chart[which], *((low[which], high[which]) for low, high in (self.x, self.y)))

    def parts(self, across: int, up: int) -> tuple["Boxes", Indices]:
        """The boxes cut into equal parts, and for each part the index of its box."""
        source = np.repeat(np.arange(self.chart.size), across * up)
        sides = [np.tile(np.repeat(np.arange(across), up), self.chart.size), np.tile(np.arange(up), source.size // up)]
        ends = []
        for (low, high), step, count in zip((self.x, self.y), sides, (across, up), strict=True):
            low, high = low[source], high[source]
            size = np.abs(low) + np.abs(high)
            cut = [low + (high - low) * ((step + end) / count) for end in (0, 1)]
            ends.append((np.maximum(cut[0] - 1e-15 * size, low), np.minimum(cut[1] + 1e-15 * size, high)))
        return Boxes(self.chart[source], *ends), source

    def mirrored(self) -> "Boxes":
        """The boxes of `(-theta, -phi)`."""
        return Boxes(self.chart, *((-high, -low) for low, high in (self.x, self.y)))


class Images(NamedTuple):
    """Rectangles: the box each belongs to, and where it lies; `lost` are boxes of which nothing is proved."""

    source: Indices
    boxes: Boxes
    lost: Indices


class Chart(NamedTuple):
    """A rectangle of phase space, closed; with `period` its first coordinate runs around once."""

    name: str
    x: tuple[float, float]
    y: tuple[float, float]
    period: bool = False
    kept: bool = False  # does the map keep to the charts? Then what juts out of one is rounding


class BoxMap(Protocol):
    """A map of a phase space in charts, with outer images."""

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts."""

    @property
    def label(self) -> str:
        """The map and its parameters, in words."""

    def images(self, boxes: Boxes) -> Images:
        """Rectangles that hold the image of each box, a part outside all charts included."""


@dataclass(frozen=True)
class PlaneImages:
    """A map of a rectangle of the plane, given by its formula in balls and by that of its derivative matrix.

    >>> half = PlaneImages("halving", Chart("plane", (-1, 1), (-1, 1)), lambda x, y: (x / 2, y / 2),
    ...     lambda x, y: ((0.5, 0), (0, 0.5)))
    >>> box = Boxes(np.array([0]), (np.array([0.5]), np.array([1.0])), (np.array([0.0]), np.array([0.5])))
    >>> [round(float(end[0]), 9) for end in half.images(box).boxes.x]
    [0.25, 0.5]
    """

    label: str
    chart: Chart
    formula: Any
    derivative: Any

    @property
    def charts(self) -> tuple[Chart, ...]:
        return (self.chart,)

    def images(self, boxes: Boxes) -> Images:
        centre, reach, whole = centred(boxes)
        (a, b), (c, d) = self.derivative(*whole)
        values = self.formula(*centre)
        x, y = (value + p * reach[0] + q * reach[1] for value, (p, q) in zip(values, ((a, b), (c, d)), strict=True))
        everything = np.arange(boxes.chart.size)
        return collected([(everything, boxes.chart, x.lower(), x.upper(), y.lower(), y.upper())], everything)


def centred(boxes: Boxes) -> tuple[list[BallArray], list[BallArray], list[BallArray]]:
    """Midpoints, what the boxes hold beside them, and the boxes, for both coordinates."""
    whole = [hull(*boxes.x), hull(*boxes.y)]
    return [BallArray(b.m) for b in whole], [BallArray(0.0 * b.m, b.r) for b in whole], whole


Row = tuple[Indices, Indices, Array, Array, Array, Array]


def collected(rows: list[Row], asked: Indices) -> Images:
    """Images from rows of `source, chart, x low, x high, y low, y high`; a box with an end not finite is lost."""
    source, chart, *ends = (np.concatenate(column) for column in zip(*rows, strict=True))
    good = np.logical_and.reduce([np.isfinite(end) for end in ends])
    bad = np.union1d(source[~good], np.setdiff1d(asked, source))
    keep = ~np.isin(source, bad)
    a, b, c, d = (end[keep] for end in ends)
    return Images(source[keep], Boxes(chart[keep], (a, b), (c, d)), bad.astype(np.int64))
