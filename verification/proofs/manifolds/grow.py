"""Invariant manifolds in float64, grown from their local series to a given length, and candidates for tangencies.

The parameter `z` of the series extends to the whole branch: a point far out is the image of a point near the saddle
after some rounds of the map (or its preimage, on a stable manifold). So points can be inserted where neighbours are too
far apart or the curve turns too much, without interpolation.

Tangencies are sought near extrema of the gap between an unstable and a stable manifold. A fundamental domain of the
unstable branch, on both sides of the saddle, is followed bounce by bounce. Where its points fall into the neighbourhood
in which the local stable manifold is a graph, the gap is a function of `z`; its local extrema near 0 are candidates,
and `tangency` varies the map's parameter until they are 0.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from numeric.backends import elementary
from verification.arithmetic.balls import ARRAYS, FLOAT64
from verification.cycles.recurrence import Array
from verification.proofs.manifolds.plane_map import PlaneMap
from verification.proofs.manifolds.saddle import Local, SaddleCycle, local, saddle
from verification.proofs.manifolds.tangency import Contact, Touch, tangency

FIRST = 24  # points of a round before any is added
PASSES = 14  # the most passes that insert points
SETTLED = 3.0  # a short round beyond this `ln(abs(z))` means a sink


@dataclass(frozen=True)
class ManifoldCurve:
    """Points along a branch, from the saddle outwards, and their parameters `ln(abs(z))`.

    `here` and `following` are neighbouring bounces, `x` and `y` coordinates in the plane of the map.
    """

    here: Array
    following: Array
    logarithm: Array
    x: Array
    y: Array

    @property
    def length(self) -> float:
        """The arc length of the polygon through the points, in the plane of the map."""
        return float(np.sum(np.hypot(np.diff(self.x), np.diff(self.y))))


def branch(local: Local, side: int, length: float, spacing: float = 0.02, turning: float = 0.2) -> ManifoldCurve:
    """One branch of a manifold, `side` 1 or -1, until it is `length` long.

    The branch ends sooner where it leaves the domain of the map, or where a round adds less than ten times `spacing` (a
    sink).

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> from verification.proofs.manifolds.saddle import SaddleCycle, saddle
    >>> from verification.proofs.manifolds.saddle import local
    >>> fixed = saddle(SaddleCycle("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
    >>> 5 < branch(local(fixed, unstable=True), 1, 5).length < 5.1
    True
    """
    if side not in (1, -1) or not length > 0:
        raise ValueError(f"manifold: side = {side}, length = {length}; accepted: side 1 or -1, a positive length")
    step = abs(math.log(abs(float(local.factor))))
    low, done, pieces = -step, 0.0, []
    while done < length:
        piece = _piece(local, side, low, low + step, spacing, turning)
        pieces.append(piece)
        whole = np.isfinite(piece.x)
        if not whole.all() or (low > SETTLED and piece.length < 10 * spacing):
            break
        done += piece.length
        low += step
    fields = [np.concatenate([getattr(p, name) for p in pieces]) for name in ManifoldCurve.__dataclass_fields__]
    good = np.cumsum(~np.isfinite(fields[3])) == 0
    path = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fields[3]), np.diff(fields[4])))])
    good &= np.concatenate([[True], path[:-1] <= length])
    return ManifoldCurve(*(field[good] for field in fields))


def _piece(local: Local, side: int, low: float, high: float, spacing: float, turning: float) -> ManifoldCurve:
    """The points of a branch with `low <= ln(abs(z)) < high`."""
    made = _points(local, side, np.linspace(low, high, FIRST))
    for _ in range(PASSES):
        dx, dy = np.diff(made.x), np.diff(made.y)
        far = np.hypot(dx, dy) > spacing
        turn = np.abs(np.remainder(np.diff(elementary.arctan2(dy, dx)) + np.pi, 2 * np.pi) - np.pi) > turning
        small = np.hypot(dx, dy) < spacing / 1000
        bent = np.concatenate([turn, [False]]) | np.concatenate([[False], turn])
        where = np.nonzero(far | (bent & ~small))[0]
        if not where.size:
            break
        more = _points(local, side, (made.logarithm[where] + made.logarithm[where + 1]) / 2)
        order = np.argsort(np.concatenate([made.logarithm, more.logarithm]), kind="stable")
        joined = (
            np.concatenate([getattr(made, name), getattr(more, name)])[order]
            for name in ManifoldCurve.__dataclass_fields__
        )
        made = ManifoldCurve(*joined)
    return ManifoldCurve(*(getattr(made, name)[:-1] for name in ManifoldCurve.__dataclass_fields__))


def _points(local: Local, side: int, logarithm: Array) -> ManifoldCurve:
    """The points at `z = side*exp(logarithm)`, computed together for each number of rounds."""
    rounds = np.maximum(0, np.ceil(logarithm / abs(math.log(abs(float(local.factor)))))).astype(int)
    here, following = np.full(logarithm.size, np.nan), np.full(logarithm.size, np.nan)
    for count in np.unique(rounds):
        those = rounds == count
        here[those], following[those] = far(local, side * elementary.exp(logarithm[those]), int(count))
    x, y = local.saddle.map.over(ARRAYS).plane(here, following)
    return ManifoldCurve(here, following, logarithm, np.asarray(x), np.asarray(y))


def far(local: Local, z: Array, rounds: int) -> tuple[Any, Any]:
    """Points of the manifold with parameters `z`, as images of points that are `rounds` rounds nearer to the saddle."""
    map, orbit, parameter = local.saddle.map.over(ARRAYS), local.saddle.orbit, float(local.saddle.parameter)
    outwards = abs(float(local.factor)) > 1
    factor = float(local.factor) if outwards else 1 / float(local.factor)
    here, following = local.points(z / factor**rounds)
    closure = orbit.closure
    shift = closure.angle(map.words)
    for _ in range(rounds):
        if not outwards:
            here, following = (closure.carried(x, shift, 1) for x in (here, following))
        for _ in orbit.start:
            if outwards:
                here, following = following, map.following(here, following, parameter)
            else:
                here, following = map.previous(here, following, parameter), here
        if outwards:
            here, following = (closure.carried(x, shift, -1) for x in (here, following))
        if map.turn:  # a reflection reverses the order of neighbours
            following = here + np.remainder(following - here, 2 * np.pi)
    return here, following


POINTS = 3000  # points of the fundamental domain, on each side
NEWTON = 12
INSIDE = 0.9  # the used part of the range on which the series converges
SMALL = 0.05  # the largest gap of a candidate


def touches(
    orbit: SaddleCycle, map: PlaneMap, parameter: float, rounds: int, most: int = 4, any_bounce: bool = False
) -> list[Touch]:
    """The homoclinic tangencies found near a parameter, within `rounds` rounds, in the order of their parameters.

    The `most` candidates with the smallest gaps are tried. Gaps are examined after whole rounds, or after every bounce
    if `any_bounce`.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> found = touches(SaddleCycle("inner fixed point", (0.63,)), Henon(Rational(3, 10)), 1.3924, 6)
    >>> min(round(abs(touch.parameter - 1.39241980792), 9) for touch in found)
    0.0
    """
    found: list[Touch] = []
    for candidate in candidates(orbit, map, parameter, rounds, any_bounce)[:most]:
        try:
            touch = tangency(candidate, map, 8)
        except (ValueError, ArithmeticError):
            continue
        if all(abs(touch.parameter - other.parameter) > 1e-11 for other in found):
            found.append(touch)
    return sorted(found, key=lambda touch: float(touch.parameter))


def candidates(
    orbit: SaddleCycle, map: PlaneMap, parameter: float, rounds: int, any_bounce: bool = False
) -> list[Contact]:
    """Candidate contacts at extrema of the gap along both branches of the unstable manifold, smallest gap first."""
    at = saddle(orbit, map.over(FLOAT64), parameter)
    out, into = local(at, True), local(at, False)
    found: list[tuple[float, Contact]] = []
    for z, count, here, following in carried(out, map, parameter, rounds * len(orbit.start)):
        whole = (orbit.closure.turn ** (count // len(orbit.start)),) if count % len(orbit.start) == 0 else ()
        for sign in ((1, -1) if map.turn else (1,)) if any_bounce else whole:
            gap, end = gaps(into, sign * here, sign * following)
            for i in turning(gap):
                place = float(z[i]) * out.unit, float(end[i]) * into.unit
                least = gap[i] - (gap[i + 1] - gap[i - 1]) ** 2 / 8 / (gap[i - 1] - 2 * gap[i] + gap[i + 1])
                found.append((abs(float(least)), Contact(orbit, orbit, count, sign, *place, parameter)))
    return [contact for _, contact in sorted(found, key=lambda pair: pair[0])]


def carried(out: Local, map: PlaneMap, parameter: float, bounces: int) -> Iterator[tuple[Array, int, Array, Array]]:
    """The images of a fundamental domain of each branch of an unstable manifold, bounce by bounce.

    It yields the parameters on the manifold, the number of bounces made, and the points with their next bounces.
    """
    grid = elementary.exp(np.linspace(-math.log(abs(out.saddle.unstable)), 0, POINTS))
    for z in (grid, -grid):
        here, following = out.points(z)
        for count in range(1, bounces + 1):
            here, following = following, map.over(ARRAYS).following(here, following, parameter)
            yield z, count, here, following


def gaps(into: Local, here: Array, following: Array, small: float = SMALL) -> tuple[Array, Array]:
    """The gap to a local stable manifold, NaN if undefined or not below `small`; and the parameter on the manifold."""
    at, ring = into.saddle, into.saddle.around()
    if at.map.turn:
        unit = 2 * np.pi / at.map.turn
        turns = np.round((here - ring[1]) / unit)
        here, following = here - turns * unit, following - turns * unit
        following = following - 2 * np.pi * np.round((following - ring[2]) / (2 * np.pi))
    first = np.polynomial.Polynomial(np.array(into.coefficients[0]))
    slope = first.deriv()
    with np.errstate(all="ignore"):
        end = np.clip((here - first.coef[0]) / first.coef[1], -1 / abs(at.stable), 1 / abs(at.stable))
        for _ in range(NEWTON):
            end = end - (first(end) - here) / slope(end)
        gap = following - into.points(end)[1]
        good = (abs(end) < INSIDE / abs(at.stable)) & (abs(first(end) - here) < 1e-10) & (abs(gap) < small)
    return np.where(good, gap, np.nan), end


def turning(gap: Array) -> Any:
    """The indices of the strict local extrema of a sampled gap."""
    rise = np.diff(gap)
    return np.nonzero(rise[:-1] * rise[1:] < 0)[0] + 1
