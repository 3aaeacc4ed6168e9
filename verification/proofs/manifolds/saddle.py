"""Saddles, cycles modulo a symmetry of the table, and the Taylor series of their local invariant manifolds.

After its bounces `x[0] ... x[p-1]` the cycle repeats as its image `x[i+p] = turn*x[i] + shift`: a triangle is one
bounce and a third of a full turn, a chord between two mirror images is one bounce and a reflection. The multipliers are
those of the map followed by the inverse of the symmetry.

The manifolds come from the parameterisation method, with the map acting as `z -> mu*z` on the series. Each bounce of a
saddle has a series `P[i](z)` with `P[i](0) = x[i]` and, after a round, `P[i+p](z) = sign*P[i](mu*z) + shift`. The rule
at three neighbours, as a power series in `z`, has to vanish: order `k` is the linearised rule on displacements with the
factor `mu**k`, singular at `k = 1` only, where it gives the direction. Newton's method on whole series doubles the
orders that hold. With the unstable multiplier as `mu` the result is the unstable manifold, with the stable multiplier
the stable manifold.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from verification.arithmetic.iteration import Stop, Vector, iterated
from verification.arithmetic.series import Jet
from verification.cycles.chain import trace_and_determinant
from verification.cycles.critical import solved
from verification.cycles.recurrence import IDENTITY, Closure
from verification.proofs.manifolds.plane_map import PlaneMap

NEWTON = Stop(small=1e-10, steps=60)
LARGEST_LOG = 640.0  # of the largest power of a multiplier: just below the largest double


@dataclass(frozen=True)
class SaddleCycle:
    """A cycle modulo a symmetry: starting values for its bounces, and the symmetry after which it repeats."""

    name: str
    start: tuple[float, ...]
    closure: Closure = IDENTITY


@dataclass(frozen=True)
class Saddle:
    """A cycle at one value of the parameter; `stable` and `unstable` are its multipliers."""

    orbit: SaddleCycle
    map: PlaneMap
    parameter: Any
    points: tuple[Any, ...]
    stable: Any
    unstable: Any

    def around(self) -> list[Any]:
        """The points of a round, with one more point on either side."""
        return padded(self.orbit, self.map, self.points)


def padded(orbit: SaddleCycle, map: PlaneMap, points: Sequence[Any]) -> list[Any]:
    """The points `x[-1], x[0], ..., x[p]`: a round with one more point on either side."""
    return orbit.closure.padded(points, orbit.closure.angle(map.words))


def slopes(orbit: SaddleCycle, map: PlaneMap, points: Sequence[Any], parameter: Any) -> list[tuple[Any, Any, Any]]:
    """For each bounce, the derivatives of the rule by the point before, the point itself and the point after."""
    ring = padded(orbit, map, points)
    return [map.slopes(ring[i : i + 3], parameter) for i in range(len(points))]


def matrix(orbit: SaddleCycle, rows: Sequence[tuple[Any, Any, Any]], factor: Any = 1) -> list[list[Any]]:
    """The matrix of the linearised rules, for displacements that a round multiplies by `factor` times the symmetry."""
    p = len(rows)
    entries: list[list[Any]] = [[0] * p for _ in range(p)]
    for i, (before, here, after) in enumerate(rows):
        entries[i][i - 1] += before * (1 if i else orbit.closure.turn / factor)
        entries[i][i] += here
        entries[i][(i + 1) % p] += after * (1 if i < p - 1 else orbit.closure.turn * factor)
    return entries


def saddle(orbit: SaddleCycle, map: PlaneMap, parameter: Any) -> Saddle:
    """The saddle near `orbit.start` at a value of the parameter, by Newton's method in the map's kind of number.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> found = saddle(SaddleCycle("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
    >>> print(f"{found.unstable:.6f} {found.stable:.6f}")
    -1.923739 0.155946
    """

    def correction(points: Vector) -> Vector:
        ring = padded(orbit, map, points)
        rule = [map.rule(ring[i : i + 3], parameter) for i in range(len(points))]
        rows = matrix(orbit, slopes(orbit, map, points, parameter))
        return solved([[*row, r] for row, r in zip(rows, rule, strict=True)])

    found = iterated(correction, [parameter * 0 + x for x in orbit.start], NEWTON)
    if not found.settled:
        at = f"at {float(parameter)} from {orbit.start}"
        raise ValueError(f"{map.label}: Newton's method did not find the {orbit.name} {at}")
    stable, unstable = multipliers(orbit, map, found.x, parameter)
    return Saddle(orbit, map, parameter, tuple(found.x), stable, unstable)


def multipliers(orbit: SaddleCycle, map: PlaneMap, points: Sequence[Any], parameter: Any) -> tuple[Any, Any]:
    """The smaller and the larger multiplier in absolute value; `ValueError` if they are complex."""
    trace, determinant = trace_and_determinant(slopes(orbit, map, points, parameter), orbit.closure.turn)
    square = trace * trace - 4 * determinant
    if not square > 0:
        raise ValueError(
            f"{map.label}: the {orbit.name} is no saddle at {float(parameter)}; its multipliers are complex"
        )
    larger = (trace + (1 if trace > 0 else -1) * map.words.sqrt(square)) / 2
    return determinant / larger, larger


Series = list[list[Any]]  # for each bounce the coefficients of 1, z, z**2, ...


@dataclass(frozen=True)
class Local:
    """The series of a local manifold over `-1 <= z <= 1`; `z = 1` is `unit` along the eigenvector, to first order.

    `residual` is the largest value of the rule found on that range.
    """

    saddle: Saddle
    factor: Any
    coefficients: tuple[tuple[Any, ...], ...]
    unit: float
    residual: float = 0.0

    @property
    def order(self) -> int:
        """The highest power of `z` in the series."""
        return len(self.coefficients[0]) - 1

    def points(self, z: Any) -> tuple[Any, Any]:
        """Two successive points of the orbit through `z`, in any kind of number that contains the coefficients."""
        here = horner(self.coefficients[0], z)
        if len(self.coefficients) > 1:
            return here, horner(self.coefficients[1], z)
        closure = self.saddle.orbit.closure
        first = horner(self.coefficients[0], self.factor * z)
        return here, closure.carried(first, closure.angle(self.saddle.map.words), 1)


def local(saddle: Saddle, unstable: bool, order: int = 24, tail: float = 1e-16) -> Local:
    """The local manifold as a series to `order`, scaled so that the last coefficients are about `tail`.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> from verification.proofs.manifolds.saddle import SaddleCycle, saddle
    >>> fixed = saddle(SaddleCycle("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
    >>> local(fixed, unstable=True).residual < 1e-14
    True
    """
    factor = saddle.unstable if unstable else saddle.stable
    if isinstance(factor, float):
        order = min(order, int(LARGEST_LOG / abs(math.log(abs(factor)))))  # powers of the factor must not overflow
    rows = slopes(saddle.orbit, saddle.map, saddle.points, saddle.parameter)
    series: Series = [[x, v] for x, v in zip(saddle.points, direction(saddle, rows, factor), strict=True)]
    while len(series[0]) <= order:
        series = doubled(saddle, factor, series, min(2 * len(series[0]), order + 1))
    unit = reach(series, tail) / float(max(abs(factor), abs(1 / factor)))
    powers = _powers(saddle.parameter * 0 + unit, order + 1)
    made = Local(saddle, factor, tuple(tuple(x * u for x, u in zip(c, powers, strict=True)) for c in series), unit)
    return replace(made, residual=residual(made))


def direction(saddle: Saddle, rows: Sequence[tuple[Any, Any, Any]], factor: Any) -> list[Any]:
    """The eigenvector with largest entry 1, as the null vector of the linearised rules."""
    entries = matrix(saddle.orbit, rows, factor)
    p = len(entries)
    if p == 1:
        return [saddle.points[0] * 0 + 1]
    found = solved([[*row[:-1], -row[-1]] for row in entries[:-1]])
    vector = [*found, saddle.points[0] * 0 + 1]
    largest = max(vector, key=abs)
    return [v / largest for v in vector]


def doubled(saddle: Saddle, factor: Any, series: Series, length: int) -> Series:
    """The series to `length` coefficients by one Newton step, from series with half as many correct coefficients."""
    known, orbit = len(series[0]), saddle.orbit
    powers = _powers(factor, length)
    ring = neighbours(saddle, [[*c, *[0] * (length - known)] for c in series], powers)
    triples = [ring[i : i + 3] for i in range(len(series))]
    linear = [saddle.map.linear_along(triple, saddle.parameter) for triple in triples]
    rules, slopes_of = [value for value, *_ in linear], [[s.c for s in slope] for _, slope, _ in linear]
    found: Series = [[*c] for c in series]
    zero = saddle.points[0] * 0
    steps: Series = [[zero] * known for _ in series]
    for k in range(known, length):
        right = []
        for i, rows in enumerate(slopes_of):
            total = rules[i].c[k]
            for j in range(known, k):
                ends = around(orbit, [s[j] for s in steps], powers[j])
                total = total + sum((row[k - j] * end for row, end in zip(rows, ends[i : i + 3], strict=True)), zero)
            right.append(-total)
        entries = matrix(orbit, [tuple(row[0] for row in rows) for rows in slopes_of], powers[k])
        for c, s, x in zip(found, steps, solved([[*e, r] for e, r in zip(entries, right, strict=True)]), strict=True):
            s.append(x)
            c.append(x)
    return found


def neighbours(saddle: Saddle, series: Series, powers: Sequence[Any]) -> list[Jet]:
    """The series of the bounces as jets, with the series of one more bounce on either side."""
    sign, shift = saddle.orbit.closure.turn, saddle.orbit.closure.angle(saddle.map.words)
    before = [sign * c / m for c, m in zip(series[-1], powers, strict=True)]
    after = [sign * c * m for c, m in zip(series[0], powers, strict=True)]
    before[0], after[0] = before[0] - sign * shift, after[0] + shift
    return [Jet(*c) for c in (before, *series, after)]


def around(orbit: Any, step: Sequence[Any], power: Any) -> list[Any]:
    """The coefficients `step` of the bounces, with one more on either side; a round multiplies them by `power`."""
    return [orbit.closure.turn * step[-1] / power, *step, orbit.closure.turn * step[0] * power]


def reach(series: Series, tail: float) -> float:
    """The length along the eigenvector up to which the last terms stay below about `tail`, and all terms below 1."""
    last = len(series[0]) - 1
    limits = [math.log(tail) if k > last - 2 else 0.0 for k in range(last + 1)]
    logs = [(limits[k] - log_of(c[k])) / k for c in series for k in range(1, last + 1) if c[k] != 0]
    return math.exp(min(logs))


def log_of(x: Any) -> float:
    """The natural logarithm of `abs(x)`, for a float, or for an mpmath number beyond the range of floats."""
    return math.log(abs(x)) if isinstance(x, float) else float(x.context.log(abs(x)))


def residual(made: Local) -> float:
    """The largest value of the rule at a few points of the manifold: the truncation error."""
    saddle, worst = made.saddle, 0.0
    series = [list(c) for c in made.coefficients]
    for share in (-1, -0.75, -0.4, 0.3, 0.7, 1):
        values = []
        for c in neighbours(saddle, series, _powers(made.factor, made.order + 1)):
            values.append(horner(c.c, saddle.parameter * 0 + share))
        for i in range(len(series)):
            worst = max(worst, abs(float(saddle.map.rule(values[i : i + 3], saddle.parameter))))
    return worst


def horner(coefficients: Sequence[Any], z: Any) -> Any:
    """The value of a polynomial."""
    total = z * 0 + coefficients[-1]
    for c in reversed(coefficients[:-1]):
        total = total * z + c
    return total


def _powers(factor: Any, length: int) -> list[Any]:
    found = [factor * 0 + 1]
    while len(found) < length:
        found.append(found[-1] * factor)
    return found
