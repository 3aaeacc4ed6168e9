"""The normal form of the elastic egg's triangle at the flat points, exact in alpha: stability beyond linear terms.

Followed by a rotation back through a third of a turn, one flight of the triangle is an area-preserving map of the plane
to itself, with the multipliers `mu = A + T` and `A - T`, where `A` is half the trace and `T**2 = A**2 - 1`. Its normal
form is computed over the rational functions of alpha, extended by `T`, without approximation. As area is preserved,
half of every coefficient must vanish, which is a check. Paper: section 6.4 ("elliptic for any alpha").
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

from sympy import QQ, Expr, Symbol
from sympy.polys.fields import field

from symbolic.cycles.normal_forms import CUBIC, QUARTIC, Map, Series, bounce, chord, composed, plus, put
from symbolic.tables.table import alpha

SHAPE = Symbol("alpha")


@dataclass(frozen=True)
class QuadraticNumber:
    """The number `a + b*T` with `T**2 = square`; `T` is imaginary where the triangle is elliptic."""

    a: Any
    b: Any
    square: Any

    def _of(self, other: Any) -> "QuadraticNumber":
        return other if isinstance(other, QuadraticNumber) else QuadraticNumber(other, 0 * self.square, self.square)

    def __add__(self, other: Any) -> "QuadraticNumber":
        y = self._of(other)
        return QuadraticNumber(self.a + y.a, self.b + y.b, self.square)

    def __sub__(self, other: Any) -> "QuadraticNumber":
        return self + self._of(other) * -1

    def __mul__(self, other: Any) -> "QuadraticNumber":
        y = self._of(other)
        return QuadraticNumber(self.a * y.a + self.b * y.b * self.square, self.a * y.b + self.b * y.a, self.square)

    def __truediv__(self, other: Any) -> "QuadraticNumber":
        y = self._of(other)
        norm = y.a * y.a - y.b * y.b * self.square
        return self * QuadraticNumber(y.a / norm, -y.b / norm, self.square)

    __radd__, __rmul__ = __add__, __mul__

    def __bool__(self) -> bool:
        return bool(self.a != 0 or self.b != 0)

    @property
    def conjugate(self) -> "QuadraticNumber":
        """`a - b*T`."""
        return QuadraticNumber(self.a, -self.b, self.square)


@dataclass(frozen=True)
class Resonances:
    """One flight of the triangle: entry `B` (upper right) and trace of its matrix, and coefficients of its normal form.

    Up to third order the map is `z -> mu*z*(1 + twist*T/B*|z|**2)`, with `third*conj(z)**2` in addition where
    `mu**3 = 1` and with `fourth*conj(z)**3` where `mu**4 = 1`. `drift` is the part of the cubic coefficient that area
    preservation makes 0.
    """

    B: Any
    trace: Any
    twist: Any
    drift: Any
    third: QuadraticNumber
    fourth: QuadraticNumber

    @property
    def square(self) -> Any:
        """The square of the module's `T`: `trace**2/4 - 1`."""
        return self.third.square


@cache
def flat_triangle() -> tuple[Expr, Expr, Expr]:
    """Trace, twist and drift of one flight along the triangle at the flat points, as functions of alpha.

    >>> trace, twist, drift = flat_triangle()
    >>> trace.equals((2 - 38 * alpha) / (1 - alpha)), drift
    (True, 0)
    """
    numbers, a = field("alpha", QQ)
    found = resonances(numbers, a)
    exact = [value.as_expr().subs(SHAPE, alpha).factor() for value in (found.trace, found.twist, found.drift)]
    return exact[0], exact[1], exact[2]


@cache
def at_shape(shape: Any) -> Resonances:
    """The normal form at one rational `alpha`, with the coefficients of third and fourth roots of unity.

    >>> from sympy import Rational
    >>> at_shape(Rational(1, 13)).trace
    -1
    """
    return resonances(QQ, QQ(shape.p, shape.q))


def resonances(numbers: Any, a: Any) -> Resonances:
    """The normal form of one flight, over the field `numbers`, which contains the shape `a`."""
    x, p = bounce(chord_between_flats(numbers, a))
    A, B = x[1, 0], x[0, 1]
    if p[0, 1] != A:
        raise ArithmeticError("the two ends of the flight differ, though a mirror exchanges them")
    square = A * A - 1
    one, T = QuadraticNumber(numbers(1), numbers(0), square), QuadraticNumber(numbers(0), numbers(1), square)
    half = one / 2
    # z = x + (B/T)*p turns by mu = A + T; its conjugate is w, and x = (z + w)/2, p = T*(z - w)/(2*B)
    here = {(1, 0): half, (0, 1): half}, {(1, 0): T * half / B, (0, 1): T * half / B * -1}
    moved = composed([here, (_lifted(x, one), _lifted(p, one))])
    z = plus(moved[0], {at: c * B / T for at, c in moved[1].items()})
    mu = one * A + T
    third = z.get((0, 2), one * 0)
    flat = straightened((z, mirrored(z)), mu)
    cubic = flat[0].get((2, 1), one * 0) * mu.conjugate
    return Resonances(B, 2 * A, cubic.b * B, cubic.a, third, flat[0].get((0, 3), one * 0))


def chord_between_flats(numbers: Any, a: Any) -> Series:
    """Terms of degree 2 to 4 of the length, over `sqrt(3)`, of a chord between points near two flat points.

    The ends lie `sqrt(3)*x` and `sqrt(3)*y` radians from neighbouring flat points, with `x` and `y` the variables of
    the series. Polar angles are counted from the bisector of the flat points, which lie at 60 degrees on either side.
    Their sine is `sqrt(3)*along` and their cosine `across`, with `along` and `across` rational series.
    """
    radius = [(numbers(1) if k == 0 else numbers(0)) - a * c for k, c in enumerate(_cosines(numbers, 3))]
    cos_d, sin_d = _cosines(numbers, 1), _sines(numbers)
    ends = []
    for side in (-1, 1):
        along = [side * c / 2 + s / 2 for c, s in zip(cos_d, sin_d, strict=True)]
        across = [c / 2 - side * 3 * s / 2 for c, s in zip(cos_d, sin_d, strict=True)]
        ends.append([_product(radius, along), _product(radius, across)])
    # |z1 - z0|**2 = 3*(along**2 + across**2/3), and on the triangle itself the chord lies along the first coordinate
    start, end = ends
    return chord(start, end, lambda _: end[0][0] - start[0][0], (numbers(1), numbers(1) / 3))


def _cosines(numbers: Any, K: int) -> list[Any]:
    """Taylor coefficients of `cos(K*sqrt(3)*x)`."""
    square = numbers(3 * K * K)
    return [numbers(1), numbers(0), -square / 2, numbers(0), square * square / 24]


def _sines(numbers: Any) -> list[Any]:
    """Taylor coefficients of `sin(sqrt(3)*x)/sqrt(3)`."""
    return [numbers(0), numbers(1), numbers(0), numbers(-1) / 2, numbers(0)]


def _product(f: list[Any], g: list[Any]) -> list[Any]:
    return [sum((f[i] * g[k - i] for i in range(k + 1)), 0 * f[0]) for k in range(QUARTIC + 1)]


def _lifted(f: Series, one: QuadraticNumber) -> Series:
    return {at: one * c for at, c in f.items()}


def mirrored(f: Series) -> Series:
    """The conjugate series: `conj(f(z, w))` for `w = conj(z)`."""
    return {(j, i): c.conjugate for (i, j), c in f.items()}


def straightened(map: Map, mu: QuadraticNumber) -> Map:
    """The map in coordinates in which all quadratic terms that can be removed vanish.

    A term `z**i*w**j` cannot be removed if `mu**i*conj(mu)**j = mu`; among quadratic terms this is `w**2` if
    `mu**3 = 1`.
    """
    h: Series = {}
    for (i, j), c in map[0].items():
        if i + j == 2:
            gap = mu - _power(mu, i - j)
            if gap:
                h[i, j] = c / gap
    one = mu * 0 + 1
    z, w = {(1, 0): one}, {(0, 1): one}
    change = plus(z, h, -1), plus(w, mirrored(h), -1)
    back: Map = z, w
    for _ in range(CUBIC):  # the inverse: v = u + h(v), one order at a time
        back = plus(z, put(h, *back)), plus(w, put(mirrored(h), *back))
    return composed([change, map, back])


def _power(mu: QuadraticNumber, n: int) -> QuadraticNumber:
    found = mu * 0 + 1
    for _ in range(abs(n)):
        found = found * (mu if n > 0 else mu.conjugate)
    return found
