"""Starts for `tangency`: where on an unstable manifold the gap to a stable one is least, near a given letter.

A fundamental domain of the unstable branch, both sides of the saddle, is followed bounce by bounce. Wherever its points
fall into the neighbourhood in which the local stable manifold is a graph, the gap is a function of the
parameter; its local extrema near 0 are candidates, and `tangency` moves the letter until they are 0. What
comes back are tangencies near the letter, the one that ends an attractor among others: which one it is,
sampling has to say.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic import ARRAYS, FLOAT64
from verification.manifolds.recurrence import Recurrence
from verification.manifolds.saddle import Orbit, saddle
from verification.manifolds.series import Local, local
from verification.manifolds.tangency import Contact, Touch, tangency

POINTS = 3000  # of the fundamental domain, on each side
NEWTON = 12
INSIDE = 0.9  # of the range on which the series converges
SMALL = 0.05  # a gap that counts as near
Array = NDArray[np.float64]


def touches(
    orbit: Orbit, map: Recurrence, letter: float, rounds: int, most: int = 4, any_bounce: bool = False
) -> list[Touch]:
    """Homoclinic tangencies near a letter, within some rounds, in the order of their letters; each once.

    `most` candidates with the smallest gaps are tried, those after whole rounds only or after `any_bounce`.

    >>> from sympy import Rational
    >>> from verification.manifolds.recurrence import Henon
    >>> found = touches(Orbit("inner fixed point", (0.63,)), Henon(Rational(3, 10)), 1.3924, 6)
    >>> min(round(abs(touch.letter - 1.39241980792), 9) for touch in found)
    0.0
    """
    found: list[Touch] = []
    for candidate in candidates(orbit, map, letter, rounds, any_bounce)[:most]:
        try:
            touch = tangency(candidate, map, 8)
        except (ValueError, ArithmeticError):
            continue
        if all(abs(touch.letter - other.letter) > 1e-11 for other in found):
            found.append(touch)
    return sorted(found, key=lambda touch: float(touch.letter))


def candidates(orbit: Orbit, map: Recurrence, letter: float, rounds: int, any_bounce: bool = False) -> list[Contact]:
    """Extrema of the gap along both branches of the unstable manifold, the smallest first."""
    at = saddle(orbit, map.over(FLOAT64), letter)
    out, into = local(at, True), local(at, False)
    found: list[tuple[float, Contact]] = []
    grid = np.exp(np.linspace(-math.log(abs(at.unstable)), 0, POINTS))
    for z in (grid, -grid):
        here, following = out.points(z)
        for count in range(1, rounds * len(orbit.start) + 1):
            here, following = following, map.over(ARRAYS).following(here, following, letter)
            whole = (orbit.sign ** (count // len(orbit.start)),) if count % len(orbit.start) == 0 else ()
            for sign in ((1, -1) if map.turn else (1,)) if any_bounce else whole:
                gap, end = gaps(into, sign * here, sign * following)
                for i in turning(gap):
                    place = float(z[i]) * out.unit, float(end[i]) * into.unit
                    least = gap[i] - (gap[i + 1] - gap[i - 1]) ** 2 / 8 / (gap[i - 1] - 2 * gap[i] + gap[i + 1])
                    found.append((abs(float(least)), Contact(orbit, orbit, count, sign, *place, letter)))
    return [contact for _, contact in sorted(found, key=lambda pair: pair[0])]


def gaps(into: Local, here: Array, following: Array) -> tuple[Array, Array]:
    """The gap to a local stable manifold, `nan` where it is no graph, and the parameter on it."""
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
        good = (abs(end) < INSIDE / abs(at.stable)) & (abs(first(end) - here) < 1e-10) & (abs(gap) < SMALL)
    return np.where(good, gap, np.nan), end


def turning(gap: Array) -> Any:
    """Where a gap has a strict local extremum, with both neighbours."""
    rise = np.diff(gap)
    return np.nonzero(rise[:-1] * rise[1:] < 0)[0] + 1
