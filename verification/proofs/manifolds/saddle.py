"""Saddles, cycles modulo a symmetry of the table, and the Taylor series of their local invariant manifolds.

After its bounces `x[0] ... x[p-1]` the cycle repeats as its image `x[i+p] = turn*x[i] + shift`: a
triangle is one bounce and a turn by a third, a chord between two mirror images one bounce and a mirror.
The multipliers are those of the map followed by that symmetry undone.

The manifolds come from the parameterisation method, with the map acting as `z -> mu*z` on the series. Each bounce of
a saddle has a series `P[i](z)` with `P[i](0) = x[i]` and, around the end, `P[i+p](z) = sign*P[i](mu*z) + shift`. The
rule at three neighbours, as a power series in `z`, has to vanish: order `k` is the linearised rule on displacements
with the factor `mu**k`, singular at `k = 1` only, where it gives the direction. Newton's method on whole series
doubles the orders that hold. With `mu` the unstable multiplier this is the unstable manifold, with the stable one the
stable.
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


@dataclass(frozen=True)
class Orbit:
    """What identifies a cycle: starting values for its bounces, and how it repeats."""

    name: str
    start: tuple[float, ...]
    closure: Closure = IDENTITY


@dataclass(frozen=True)
class Saddle:
    """A cycle at one value of the parameter; `stable` and `unstable` are its multipliers."""

    orbit: Orbit
    map: PlaneMap
    parameter: Any
    points: tuple[Any, ...]
    stable: Any
    unstable: Any

    def around(self) -> list[Any]:
        """The points with a neighbour more on either side."""
        return padded(self.orbit, self.map, self.points)


def padded(orbit: Orbit, map: PlaneMap, points: Sequence[Any]) -> list[Any]:
    """`x[-1], x[0], ..., x[p]`."""
    return orbit.closure.padded(points, orbit.closure.angle(map.words))


def slopes(orbit: Orbit, map: PlaneMap, points: Sequence[Any], parameter: Any) -> list[tuple[Any, Any, Any]]:
    """The derivatives of the rule at each point by the neighbour before, itself and the one after."""
    ring = padded(orbit, map, points)
    return [map.slopes(ring[i : i + 3], parameter) for i in range(len(points))]


def matrix(orbit: Orbit, rows: Sequence[tuple[Any, Any, Any]], factor: Any = 1) -> list[list[Any]]:
    """The linearised rules on displacements that come back as `factor` times their image."""
    p = len(rows)
    entries: list[list[Any]] = [[0] * p for _ in range(p)]
    for i, (before, here, after) in enumerate(rows):
        entries[i][i - 1] += before * (1 if i else orbit.closure.turn / factor)
        entries[i][i] += here
        entries[i][(i + 1) % p] += after * (1 if i < p - 1 else orbit.closure.turn * factor)
    return entries


def saddle(orbit: Orbit, map: PlaneMap, parameter: Any) -> Saddle:
    """The cycle near its starting values, by Newton's method in the numbers of the map.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> found = saddle(Orbit("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
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


def multipliers(orbit: Orbit, map: PlaneMap, points: Sequence[Any], parameter: Any) -> tuple[Any, Any]:
    """The smaller and the larger multiplier in absolute value, of a cycle with real ones."""
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
    """The local manifold over `-1 <= z <= 1`, where `z = 1` is `unit` along the eigenvector in the linear order.

    `residual` is the largest rule found there.
    """

    saddle: Saddle
    factor: Any
    coefficients: tuple[tuple[Any, ...], ...]
    unit: float
    residual: float = 0.0

    @property
    def order(self) -> int:
        """The highest power of `z`."""
        return len(self.coefficients[0]) - 1

    def points(self, z: Any) -> tuple[Any, Any]:
        """Two neighbours of the orbit through `z`, in any kind of number that contains the coefficients."""
        here = horner(self.coefficients[0], z)
        if len(self.coefficients) > 1:
            return here, horner(self.coefficients[1], z)
        closure = self.saddle.orbit.closure
        first = horner(self.coefficients[0], self.factor * z)
        return here, closure.carried(first, closure.angle(self.saddle.map.words), 1)


def local(saddle: Saddle, unstable: bool, order: int = 24, tail: float = 1e-16) -> Local:
    """The manifold to `order`, scaled so that its last coefficient is about `tail`.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> from verification.proofs.manifolds.saddle import Orbit, saddle
    >>> fixed = saddle(Orbit("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
    >>> local(fixed, unstable=True).residual < 1e-14
    True
    """
    factor = saddle.unstable if unstable else saddle.stable
    rows = slopes(saddle.orbit, saddle.map, saddle.points, saddle.parameter)
    series: Series = [[x, v] for x, v in zip(saddle.points, direction(saddle, rows, factor), strict=True)]
    while len(series[0]) <= order:
        series = doubled(saddle, factor, series, min(2 * len(series[0]), order + 1))
    unit = reach(series, tail) / float(max(abs(factor), abs(1 / factor)))
    powers = _powers(saddle.parameter * 0 + unit, order + 1)
    made = Local(saddle, factor, tuple(tuple(x * u for x, u in zip(c, powers, strict=True)) for c in series), unit)
    return replace(made, residual=residual(made))


def direction(saddle: Saddle, rows: Sequence[tuple[Any, Any, Any]], factor: Any) -> list[Any]:
    """The eigenvector, with the largest entry 1: the null vector of the linearised rules."""
    entries = matrix(saddle.orbit, rows, factor)
    p = len(entries)
    if p == 1:
        return [saddle.points[0] * 0 + 1]
    found = solved([[*row[:-1], -row[-1]] for row in entries[:-1]])
    vector = [*found, saddle.points[0] * 0 + 1]
    largest = max(vector, key=abs)
    return [v / largest for v in vector]


def doubled(saddle: Saddle, factor: Any, series: Series, length: int) -> Series:
    """One Newton step: `length` coefficients from series that hold to half as many."""
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
    """The series of the bounces with one more on either side, as jets."""
    sign, shift = saddle.orbit.closure.turn, saddle.orbit.closure.angle(saddle.map.words)
    before = [sign * c / m for c, m in zip(series[-1], powers, strict=True)]
    after = [sign * c * m for c, m in zip(series[0], powers, strict=True)]
    before[0], after[0] = before[0] - sign * shift, after[0] + shift
    return [Jet(*c) for c in (before, *series, after)]


def around(orbit: Any, step: Sequence[Any], power: Any) -> list[Any]:
    """One coefficient at each bounce, with one more on either side."""
    return [orbit.closure.turn * step[-1] / power, *step, orbit.closure.turn * step[0] * power]


def reach(series: Series, tail: float) -> float:
    """How far along the eigenvector the last terms stay below about `tail`, and no term exceeds 1."""
    last = len(series[0]) - 1
    limits = [math.log(tail) if k > last - 2 else 0.0 for k in range(last + 1)]
    logs = [(limits[k] - log_of(c[k])) / k for c in series for k in range(1, last + 1) if c[k] != 0]
    return math.exp(min(logs))


def log_of(x: Any) -> float:
    """`log(abs(x))` of a number that may leave the range of floats."""
    return math.log(abs(x)) if isinstance(x, float) else float(x.context.log(abs(x)))


def residual(made: Local) -> float:
    """The largest rule at a few parameters across the domain: what the truncation leaves."""
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
