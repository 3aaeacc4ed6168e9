"""Where a closed curve crosses itself: proved absent for finite Fourier sums, looked for on a polygon otherwise."""

from fractions import Fraction
from math import atan2, fsum, tau

from sympy import Dummy, Expr, I, Interval, Rational, S, Symbol, acos, atan, chebyshevu, expand, pi, sign

from symbolic.proofs.signs import bernstein
from symbolic.tables.table import Table

CORNERS = 96  # of the polygon, over all components
Corner = tuple[Fraction, Fraction]


def chord_of_length_zero(c: dict[int, Expr], scale: Expr = S.One) -> str | None:
    """A sentence on where `sum c_k exp(i*k*theta)` meets itself or stops; None when it is proved simple.

    The chord between `m + B` and `m - B` is `2*i*sin(B)` times `sum sgn(k) c_k U_(|k|-1)(cos B)
    exp(i*k*m)`. A simple regular curve has no zero of that sum for `-1 <= cos B <= 1`; boxes of
    `(tan(m/2), cos B)` are excluded by the sign of its real or its imaginary part. `scale` is theta in this angle.

    >>> chord_of_length_zero({-2: -S(1) / 2, -1: S(1) / 2, 1: S(1) / 2, 2: S(1) / 2})
    'the boundary meets itself, or stops, near theta = -89 and 90 degrees'
    """
    T, C = Dummy("T", real=True), Dummy("C", real=True)
    n = max(abs(k) for k in c)
    total = S.Zero
    for k, value in c.items():
        if k:
            wave = (1 + sign(k) * I * T) ** (2 * abs(k)) * (1 + T**2) ** (n - abs(k))
            total += sign(k) * value * chebyshevu(abs(k) - 1, C) * wave
    parts = [expand(part) for part in expand(total).as_real_imag()]
    box = _unexcluded([p for p in parts if p != 0], {T: Interval(-1, 1), C: Interval(-1, 1)}, 14)
    if box is None:
        return None
    m = 2 * atan((box[T].start + box[T].end) / 2)
    half = acos((box[C].start + box[C].end) / 2)
    ends = sorted((scale * angle * 180 / pi).round() for angle in (m - half, m + half))
    return f"the boundary meets itself, or stops, near theta = {ends[0]} and {ends[1]} degrees"


def _unexcluded(parts: list[Expr], box: dict[Symbol, Interval], depth: int) -> dict[Symbol, Interval] | None:
    """A box of the last generation in which no part keeps its sign; None when every box is excluded."""
    for part in parts:
        signs = {c.is_positive if c.is_nonzero else None for c in bernstein(part, box)}
        if len(signs) == 1 and None not in signs:
            return None
    if depth == 0:
        return box
    x = max(box, key=lambda y: box[y].measure)
    middle = (box[x].start + box[x].end) / 2
    for half in (Interval(box[x].start, middle), Interval(middle, box[x].end)):
        found = _unexcluded(parts, {**box, x: half}, depth - 1)
        if found is not None:
            return found
    return None


def polygon_crossing(table: Table) -> str | None:
    """A sentence on where the polygon inscribed in the boundary crosses itself; None when it does not.

    >>> from symbolic.tables import cuspless
    >>> polygon_crossing(cuspless) is None
    True
    """
    corners, names = _corners(table)
    n = len(corners)
    for i in range(n):
        for j in range(i + 2, n if i else n - 1):
            if _cross(corners[i], corners[i + 1 - n], corners[j], corners[j + 1 - n]):
                return f"the boundary crosses itself, near {names[i]} and {names[j]}"
    turns = _turns(corners)
    return None if turns == 1 else f"the boundary turns round {turns} times before it closes, and should once"


def _corners(table: Table) -> tuple[list[Corner], list[str]]:
    count = CORNERS // len(table.components)  # off the ends, where curves of a symmetric table like to meet
    corners, names = [], []
    for component in table.components:
        for k in range(count):
            value = component.start + (component.end - component.start) * Rational(3 * k + 1, 3 * count)
            x, y = (Rational(coordinate.evalf(20)) for coordinate in component.at(value))
            corners.append((Fraction(x.p, x.q), Fraction(y.p, y.q)))
            names.append(f"{component.name} at theta = {value}")
    return corners, names


def _turns(corners: list[Corner]) -> int:
    """How often the polygon's direction turns round, either way: once where it is simple (Hopf)."""
    total = fsum(
        atan2(_side(a, b, c), (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]))
        for a, b, c in zip(corners[-2:] + corners[:-2], corners[-1:] + corners[:-1], corners, strict=True)
    )
    return round(abs(total) / tau)


def _cross(a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    """Do the open segments `ab` and `cd` cross?"""
    return _side(a, b, c) * _side(a, b, d) < 0 and _side(c, d, a) * _side(c, d, b) < 0


def _side(a: Corner, b: Corner, c: Corner) -> Fraction:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
