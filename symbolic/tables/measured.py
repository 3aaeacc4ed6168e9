"""Tables from data: a closed spline through points, or a finite Fourier sum near them, with exact coefficients.

The fit is the exact definition of the table: its coefficients are rational, and what is computed or proved holds for
it. Its distance from the body that was measured is estimated by an error bar, which is in `Table.fit`.

Points may be in either order round the body. From each point to the next the parameter of the fit grows by their
distance, rounded to 64ths of the mean distance (`by="chord"`), or by one (`by="index"`).
"""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from math import isqrt
from typing import Any

from sympy import Add, Expr, I, S, cos, pi, re, sin
from sympy import im as imaginary

from symbolic.tables.definition import PLAIN
from symbolic.tables.gallery import parametric
from symbolic.tables.polynomial import Bezier, Vector, as_component, separate, signed_area
from symbolic.tables.table import Component, Fit, Table, exact_number, theta

BITS = 64  # in a control point, relative to the size of the boundary
GUARD = 128  # bits of a fixed-point number on the way to a Fourier sum
SHARES = 64  # units of the parameter in the mean distance between points
SWEEPS = 2 * BITS  # each halves the error of the slopes
BETWEEN = 8  # straight sides that replace a piece where its distance from a point is measured
MOST = 4000  # largest number of points
THIRD = Fraction(1, 3)
ROUNDING = Fraction(1, 2**44)  # of the extent: what two floats for one point may differ by


def from_points(
    points: Iterable[Sequence[Any]],
    name: str = "measured",
    *,
    smoothness: int | None = None,
    degree: int | None = None,
    by: str = "chord",
    uncertainty: Any = 0,
) -> Table:
    """The table whose boundary is fitted to measured points, given in order round the body.

    It is a closed spline through the points, cubic in `theta`, with `smoothness` continuous derivatives (0 for straight
    sides, 1 for the slopes of parabolas through three points, 2 if left out); or, with a `degree`, the finite Fourier
    sum of least squares. `by`, described in the module, gives the parameter. Coordinates are exact numbers, or text in
    which a decimal is the decimal it shows; a float is the rational number it is. A last point that repeats the first
    is left out. `uncertainty` is how far each point may be from the body, and is kept in `Table.fit`. `ValueError` for
    bad input, or a boundary that crosses itself.

    >>> oval = from_points([(2, 0), (0, "1.5"), (-2, 0), (0, "-1.5")])
    >>> [len(oval.components), oval.fit.residual < S.One / 10**15]
    [4, True]
    >>> from_points([(2, 0), (0, 1), (-2, 0), (0, -1)], degree=1, by="index").components[0].at(S.Zero)
    (2, 0)
    """
    given = unclosed(read(name, points))
    least = 3 if degree is None else 2 * _whole(name, "degree", degree, 1, 64) + 1
    if not least <= len(given) <= MOST:
        raise ValueError(f"{name}: {len(given)} points are given; accepted: from {least} to {MOST}")
    for i, point in enumerate(given):
        if point == given[i - 1]:
            raise ValueError(f"{name}: points {i or len(given)} and {i + 1} are the same; leave one of them out")
    if degree is not None and smoothness is not None:
        raise ValueError(f"{name}: smoothness = {smoothness} and degree = {degree} are given; give only one")
    if by not in ("chord", "index"):
        raise ValueError(f"{name}: by = {by!r} is no parameter of a fit; accepted: 'chord', 'index'")
    margin = _exact(f"{name}: uncertainty", uncertainty)
    if margin < 0:
        raise ValueError(f"{name}: uncertainty = {uncertainty} is no distance; accepted: numbers from 0")
    order = 2 if smoothness is None else _whole(name, "smoothness", smoothness, 0, 2)
    ordered = given if _area(given) > 0 else [given[0], *reversed(given[1:])]
    steps = [1] * len(given) if by == "index" else _steps(ordered)
    if degree is None:
        components, residual, missed = _pieces(name, tuple(ordered), tuple(steps), order)
        table = Table(name, components)
    else:
        x, y, residual = fourier(ordered, steps, degree)
        missed = None
        if len(ordered) // 2 > 2 * degree:
            half = fourier(ordered[::2], _paired(steps), degree)
            missed = _rounded_up(_gap(half[:2], ordered, steps))
        table = parametric(_sum(x), _sum(y), name)
    said = tuple((S(x), S(y)) for x, y in given)
    between = None if missed is None else S(missed)
    fit = Fit(said, None if degree is not None else order, degree, by, S(margin), S(residual), between)
    return Table(table.name, table.components, fit=fit)


@lru_cache(maxsize=8)
def _pieces(
    name: str, points: tuple[Vector, ...], steps: tuple[int, ...], order: int
) -> tuple[tuple[Component, ...], Fraction, Fraction | None]:
    """The pieces of a spline, its distance from its points, and an estimate of its error between points."""
    pieces = spline(points, steps, order)
    residual = _rounded_up(max(_distance2(piece[0], point) for piece, point in zip(pieces, points, strict=True)))
    missed = _missed(points, steps, order)
    area = signed_area(pieces)
    if area <= 0:
        how = "runs clockwise; turn it round" if area else "encloses area 0"
        raise ValueError(f"{name}: the boundary {how}")
    separate(name, [pieces])
    return tuple(as_component(f"piece{i}", piece) for i, piece in enumerate(pieces, 1)), residual, missed


def from_fourier(coefficients: Mapping[int, Any], name: str = "fourier") -> Table:
    """The table bounded by `x + i*y = sum c_k exp(i*k*theta)`; a coefficient is a number or a pair `(x, y)`.

    >>> from_fourier({1: 1, -2: "1/10"}).components[0].point
    (cos(theta) + cos(2*theta)/10, sin(theta) - sin(2*theta)/10)
    """
    x, y = list[Expr](), list[Expr]()
    for k, given in sorted(coefficients.items()):
        k = _whole(name, "harmonic", k, -1000, 1000)
        a, b = _complex(f"{name}: coefficient {k}", given)
        x += [a * cos(k * theta), -b * sin(k * theta)]
        y += [b * cos(k * theta), a * sin(k * theta)]
    return parametric(Add(*x), Add(*y), name)


# ---- splines


def spline(points: Sequence[Vector], steps: Sequence[int], smoothness: int) -> list[Bezier]:
    """The closed spline through the points with `smoothness` continuous derivatives, as cubic Bezier curves.

    `steps` are the lengths of the pieces in the parameter. With `smoothness` 2, control points are rounded to about
    `2**-BITS` of the size. The spline may miss the given points by this distance, but its curvature is exactly
    continuous.
    """
    n = len(points)
    if smoothness == 0:
        return [(p, _mix(p, q, THIRD), _mix(p, q, 2 * THIRD), q) for p, q in _ring(points)]
    unit = _unit(points)
    grid = [(round(x / unit), round(y / unit)) for x, y in points] if smoothness == 2 else None
    slopes = [_slopes([p[axis] for p in points], steps) for axis in (0, 1)]
    if grid is not None:
        slopes = [_smooth_slopes([p[axis] for p in grid], steps) for axis in (0, 1)]
    ends = grid if grid is not None else points
    legs: list[tuple[Vector, Vector]] = []
    for i in range(n):
        p, q = ends[i], ends[(i + 1) % n]
        third = steps[i] * THIRD
        here, there = ((slopes[0][j], slopes[1][j]) for j in (i, (i + 1) % n))
        legs.append(
            ((p[0] + third * here[0], p[1] + third * here[1]), (q[0] - third * there[0], q[1] - third * there[1]))
        )
    if grid is None:
        return [(p, *leg, q) for (p, q), leg in zip(_ring(points), legs, strict=True)]
    corners: list[Vector] = []  # de Boor points, rounded: the curvature is continuous whatever they are
    for i, ((a, b), (c, d)) in enumerate(legs):
        ratio = Fraction(steps[i - 1], steps[i])
        corners.append((round(a + ratio * (a - c)) * unit, round(b + ratio * (b - d)) * unit))
    inner: list[tuple[Vector, Vector]] = []
    for i in range(n):
        h, k = steps[i - 1], steps[i]
        total = h + k + steps[(i + 1) % n]
        first, last = corners[i], corners[(i + 1) % n]
        inner.append((_mix(first, last, Fraction(h, total)), _mix(first, last, Fraction(h + k, total))))
    knots = [_mix(inner[i - 1][1], inner[i][0], Fraction(steps[i - 1], steps[i - 1] + steps[i])) for i in range(n)]
    return [(knots[i], *inner[i], knots[(i + 1) % n]) for i in range(n)]


def _slopes(values: Sequence[Fraction], steps: Sequence[int]) -> list[Fraction]:
    """The slope, at each point, of the parabola through it and its two neighbours."""
    n, found = len(values), []
    for i in range(n):
        h, k = steps[i - 1], steps[i]
        behind, ahead = (values[i] - values[i - 1]) / h, (values[(i + 1) % n] - values[i]) / k
        found.append((k * behind + h * ahead) / (h + k))
    return found


def _smooth_slopes(values: Sequence[int], steps: Sequence[int]) -> list[Fraction]:
    """The slopes that make the second derivative continuous, in lattice units, by sweeps that halve the error."""
    n = len(values)
    sides = []
    for i in range(n):
        h, k = steps[i - 1], steps[i]
        behind, ahead = (values[i] - values[i - 1]) * k * k, (values[(i + 1) % n] - values[i]) * h * h
        sides.append((3 * (behind + ahead) << BITS) // (h * k))
    slopes = [0] * n
    for _ in range(SWEEPS):
        for i in range(n):
            h, k = steps[i - 1], steps[i]
            slopes[i] = (sides[i] - k * slopes[i - 1] - h * slopes[(i + 1) % n]) // (2 * (h + k))
    return [Fraction(slope, 1 << BITS) for slope in slopes]


def _missed(points: Sequence[Vector], steps: Sequence[int], smoothness: int) -> Fraction | None:
    """The distance of a spline through every second point from the others, rounded up; None for fewer than 6 points."""
    if len(points) < 6:
        return None
    even = points[::2] if len(points) % 2 == 0 else points[:-1:2]
    used = steps if len(points) % 2 == 0 else [*steps[:-2], steps[-2] + steps[-1]]
    pieces = spline(even, _paired(used), smoothness)
    worst = Fraction(0)
    for i, piece in enumerate(pieces):
        places = [_on(piece, Fraction(j, BETWEEN)) for j in range(BETWEEN + 1)]
        worst = max(worst, min(_from_side(points[2 * i + 1], p, q) for p, q in pairwise(places)))
    return _rounded_up(worst)


def _from_side(point: Vector, p: Vector, q: Vector) -> Fraction:
    """The square of the distance of a point from a straight side."""
    x, y = q[0] - p[0], q[1] - p[1]
    square = x * x + y * y
    share = (x * (point[0] - p[0]) + y * (point[1] - p[1])) / square if square else Fraction(0)
    return _distance2(_mix(p, q, max(Fraction(0), min(Fraction(1), share))), point)


def _paired(steps: Sequence[int]) -> list[int]:
    return [sum(steps[i : i + 2]) for i in range(0, len(steps), 2)]


def _on(piece: Bezier, u: Fraction) -> Vector:
    points = list(piece)
    while len(points) > 1:
        points = [_mix(p, q, u) for p, q in pairwise(points)]
    return points[0]


# ---- Fourier sums


def fourier(
    points: Sequence[Vector], steps: Sequence[int], degree: int
) -> tuple[list[Fraction], list[Fraction], Fraction]:
    """Least-squares coefficients of `1, cos(theta), sin(theta), ...` for `x` and for `y`, and the largest residual."""
    one, unit = 1 << GUARD, _unit(points)
    rows = _waves(steps, degree)
    size = 2 * degree + 1
    matrix = [[sum(row[i] * row[j] for row in rows) // one for j in range(size)] for i in range(size)]
    values = [[round(p[axis] / unit) for p in points] for axis in (0, 1)]
    right = [[sum(row[i] * v for row, v in zip(rows, column, strict=True)) for i in range(size)] for column in values]
    found = [[Fraction(v) * unit for v in column] for column in _solved(matrix, right)]
    worst = Fraction(0)
    for row, point in zip(rows, points, strict=True):
        worst = max(worst, _distance2((_at(found[0], row), _at(found[1], row)), point))
    return found[0], found[1], _rounded_up(worst) + unit


def _waves(steps: Sequence[int], degree: int) -> list[list[int]]:
    """`1, cos(theta), sin(theta), ...` at the parameters of the points, in units of `2**-GUARD`."""
    one, total, reached = 1 << GUARD, sum(steps), 0
    rows: list[list[int]] = []
    turn = int((2 * pi * one).evalf(GUARD // 3 + 8))
    for step in steps:
        x, term, parts, k = turn * reached // total, one, [0, 0], 0
        while term:
            parts[k % 2] += -term if k % 4 > 1 else term
            k += 1
            term = term * x // (one * k)
        c, s = parts
        row, (u, v) = [one], (one, 0)
        for _ in range(degree):
            u, v = (u * c - v * s) // one, (u * s + v * c) // one
            row += [u, v]
        rows.append(row)
        reached += step
    return rows


def _solved(matrix: list[list[int]], right: list[list[int]]) -> list[list[int]]:
    """The solutions for each right-hand side, as nearest integers; matrix and sides are in units of `2**-GUARD`."""
    n, one = len(matrix), 1 << GUARD
    rows = [[*row, *(column[i] for column in right)] for i, row in enumerate(matrix)]
    for i in range(n):
        for j in range(i + 1, n):
            ratio = rows[j][i] * one // rows[i][i]
            rows[j] = [y - ratio * x // one for x, y in zip(rows[i], rows[j], strict=True)]
    found = []
    for at in range(n, n + len(right)):
        solution = [0] * n
        for i in reversed(range(n)):
            rest = rows[i][at] * one - sum(rows[i][j] * solution[j] for j in range(i + 1, n))
            solution[i] = rest // rows[i][i]
        found.append([round(Fraction(x, one)) for x in solution])
    return found


def _gap(sums: Sequence[Sequence[Fraction]], points: Sequence[Vector], steps: Sequence[int]) -> Fraction:
    """The square of the largest distance between every second point and the point of a Fourier sum at its parameter."""
    rows = _waves(steps, (len(sums[0]) - 1) // 2)
    worst = Fraction(0)
    for row, point in list(zip(rows, points, strict=True))[1::2]:
        worst = max(worst, _distance2((_at(sums[0], row), _at(sums[1], row)), point))
    return worst


def _at(coefficients: Sequence[Fraction], waves: Sequence[int]) -> Fraction:
    return sum((c * w for c, w in zip(coefficients, waves, strict=True)), Fraction(0)) / (1 << GUARD)


def _sum(coefficients: Sequence[Fraction]) -> Expr:
    total = S.Zero
    for i, c in enumerate(coefficients):
        wave = cos((i + 1) // 2 * theta) if i % 2 or not i else sin(i // 2 * theta)
        total += S(c) * wave
    return total


# ---- numbers


def _exact(label: str, given: Any) -> Fraction:
    """A number as a fraction; a float is the rational number it is."""
    if getattr(given, "mask", False):
        raise ValueError(f"{label} is masked; leave the point out")
    try:
        if hasattr(given, "as_integer_ratio") and not isinstance(given, Expr | bool):  # NumPy's floats as well
            return Fraction(*given.as_integer_ratio())
        if isinstance(given, str) and PLAIN.fullmatch(given):
            return Fraction(given)
        value = exact_number(label, given)
        return Fraction(int(value.p), int(value.q))
    except (ValueError, OverflowError, AttributeError, ZeroDivisionError):
        raise ValueError(f"{label} = {given!r} is no rational number such as 2/25 or 0.08") from None


def unclosed(points: list[Vector]) -> list[Vector]:
    """The points without the last one, if it repeats the first up to the rounding of floats."""
    if len(points) < 2:
        return points
    size = max(max(abs(x - x0), abs(y - y0)) for x, y in points for x0, y0 in points[:1])
    gap = max(abs(p - q) for p, q in zip(points[0], points[-1], strict=True))
    return points[:-1] if gap <= ROUNDING * max(size, *(abs(c) / 256 for c in points[0])) and size else points


def read(label: str, points: Iterable[Sequence[Any]]) -> list[Vector]:
    """Points as pairs of fractions; `ValueError` for anything but pairs of numbers."""
    found = []
    for i, point in enumerate(points, 1):
        if isinstance(point, str) or not hasattr(point, "__len__") or len(point) != 2:
            raise ValueError(f"{label}: point {i} is {point!r}; accepted: two numbers, x and y")
        found.append((_exact(f"{label}: x of point {i}", point[0]), _exact(f"{label}: y of point {i}", point[1])))
    return found


def _complex(label: str, given: Any) -> tuple[Expr, Expr]:
    if isinstance(given, tuple | list):
        a, b = (exact_number(label, part) for part in given)
        return a, b
    if isinstance(given, complex):
        raise ValueError(f"{label} = {given} is a rounded number; give a pair of exact ones, as in (0, '1/10')")
    value = exact_number(label, given)
    return (value, S.Zero) if value.is_real or not value.has(I) else (re(value), imaginary(value))


def _whole(name: str, label: str, given: Any, low: int, high: int) -> int:
    if isinstance(given, bool) or not isinstance(given, int) or not low <= given <= high:
        raise ValueError(f"{name}: {label} = {given!r} is out of range; accepted: integers from {low} to {high}")
    return given


def _unit(points: Sequence[Vector]) -> Fraction:
    """A unit for coordinates: a power of two, about `2**-BITS` of the largest of them."""
    size = max(abs(c) for point in points for c in point) or Fraction(1)
    exponent = size.numerator.bit_length() - size.denominator.bit_length() - BITS
    return Fraction(2) ** exponent


def _steps(points: Sequence[Vector]) -> list[int]:
    lengths = [_root(_distance2(p, q)) for p, q in _ring(points)]
    mean = sum(lengths) / len(lengths)
    return [max(1, round(SHARES * length / mean)) for length in lengths]


def _root(square: Fraction) -> Fraction:
    """The square root from below, with a relative error of at most `2**-BITS`."""
    shift = max(0, 2 * BITS - square.numerator.bit_length() + square.denominator.bit_length())
    shift += shift % 2
    return Fraction(isqrt((square.numerator << shift) // square.denominator), 1 << shift // 2)


def _rounded_up(square: Fraction) -> Fraction:
    """An upper bound of the square root, a fraction with few digits that is larger by a 2000th at most."""
    if not square:
        return Fraction(0)
    root = _root(square)
    unit = Fraction(2) ** (root.numerator.bit_length() - root.denominator.bit_length() - 12)
    return (root // unit + 1) * unit


def _distance2(p: Vector, q: Vector) -> Fraction:
    return (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2


def _area(points: Sequence[Vector]) -> Fraction:
    return sum((p[0] * q[1] - p[1] * q[0] for p, q in _ring(points)), Fraction(0))


def _ring(points: Sequence[Vector]) -> list[tuple[Vector, Vector]]:
    return list(zip(points, [*points[1:], points[0]], strict=True))


def _mix(p: Vector, q: Vector, share: Fraction) -> Vector:
    return p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
