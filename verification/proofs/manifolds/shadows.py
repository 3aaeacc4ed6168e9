"""Cycles that shadow a homoclinic tangency: their folds converge to it, which locates it without any manifold.

A cycle that leaves a saddle along its unstable manifold and comes back along the stable one stays
some rounds near the saddle in between. Each such family folds once, at a letter that approaches the
tangency like `unstable**-rounds`. A fold is a problem of the chord system, solved with as many digits
as wanted, and provable; a long cycle gives the tangency itself.

The saddle also says how long a particle stays near an attractor just above a homoclinic crisis, with one term for
each passage of the saddle. [GrebogiOttRomeirasYorke1987] find the power that holds in the limit. Their argument, kept
at a finite distance: the unstable manifold reaches beyond the stable one by `e`, the distance above the crisis, over
a length `sqrt(e)`, and what lands there leaves. Followed back for `n` rounds along the saddle that region has become
as high as the attractor is, `e*stable**-n = 1`, and as near to the stable manifold as `unstable**-n`. So a particle
must first have come that near, where the manifolds touch, and then have hit a part `sqrt(e)` of it:

    leaves(e) = sqrt(e) * leaves(unstable**-n),    n = floor(ln(e)/ln(stable)),

and `leaves(e) = sqrt(e)` when no round fits in. Were `n` no whole number, and large, this would be the power law
`ln|stable| / (2*ln|stable*unstable|)`. As it is, the slope of the logarithms is 1/2 and every further passage is a
step: the wave that measured stays show about a power. Which distance counts as one is all that is left to fit.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic.balls import FLOAT64
from verification.cycles.recurrence.problem import Problem
from verification.cycles.recurrence.recurrence import BifurcationKind, Closure
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import horner
from verification.proofs.manifolds.tangency import Contact, Gap


@dataclass(frozen=True)
class Shadow:
    """A cycle near a homoclinic tangency: the problem of its fold, and a start for Newton's method."""

    problem: Problem
    start: list[float]


def shadow(contact: Contact, map: Pinball, letter: float, rounds: int) -> Shadow:
    """The cycle that spends about `rounds` rounds of the saddle near it, a few more where symmetry asks for it."""
    if contact.unstable != contact.stable:
        raise ValueError("shadow: the tangency is heteroclinic; a cycle shadows homoclinic ones only")
    floats = map.over(FLOAT64)
    gap = Gap(contact, floats, letter, 28, 1e-16)
    for more in range(6):
        points, bent, image = period(gap, rounds + more)
        sign, turns = image
        if sign == -1 or turns % map.turn == 0:
            return closed(points, bent, image, map, letter)
    return closed(*period(gap, rounds), map, letter)  # it turns at each passage, and closes after several


def closed(points: list[float], bent: int, image: tuple[int, int], map: Pinball, letter: float) -> Shadow:
    """The problem of the fold of a cycle that repeats after its points, turned or as its mirror image."""
    sign, turns = image
    unit = 2 * math.pi / map.turn
    if sign == -1:  # a mirror: turned so that its axis is theta = 0
        points, shift = [x + turns * unit for x in points], 0
    else:
        shift = turns % map.turn
    after = [sign * x + shift * unit for x in points[: bent + 1]]
    closure = Closure(sign, (shift, map.turn) if shift else (0, 1))
    problem = Problem(map.table, (0,) * len(points), BifurcationKind.FOLD, "lam", closure=closure)
    return Shadow(problem, [*points[bent + 1 :], *after, letter])


def period(gap: Gap, rounds: int) -> tuple[list[float], int, tuple[int, int]]:
    """One period of the cycle, the bounce that moves most with it, and the symmetry that continues it."""
    turn, orbit = gap.map.turn, gap.out.saddle.orbit
    unit = 2 * gap.map.words["pi"] / turn
    p, q = orbit.closure.shift
    once = orbit.closure.turn, p * turn // q
    z, _, end = gap.extremum()
    points: list[float] = []
    image = 1, 0

    def extend(round: list[Any]) -> None:
        points.extend(float(image[0] * x + image[1] * unit) for x in round)

    for k in range(rounds // 2, 0, -1):
        extend([horner(c, z / gap.out.factor**k) for c in gap.out.coefficients])
        image = composed(image, once)
    flight = gap.orbit(z)
    bent = len(points) + max(range(gap.bounces), key=lambda i: abs(flight[i].c[1]))
    extend([jet.c[0] for jet in flight[: gap.bounces]])
    target = gap.into.points(end.c[0])[0]
    image = composed(image, (gap.sign, round((flight[-2].c[0] - gap.sign * target) / unit)))
    for k in range(rounds - rounds // 2):
        extend([horner(c, end.c[0] * gap.into.factor**k) for c in gap.into.coefficients])
        image = composed(image, once)
    return points, bent, image


def composed(first: tuple[int, int], second: tuple[int, int]) -> tuple[int, int]:
    """The symmetry `x -> sign*x + turns` after another.

    >>> composed((-1, 2), (-1, 5))
    (1, -3)
    """
    return first[0] * second[0], first[0] * second[1] + first[1]


TRIED = 1500
Array = NDArray[np.float64]


def log_stay(distance: float, stable: float, unstable: float) -> float:
    """`-ln(leaves)` up to a constant; `distance` in units of the one that counts as one, at most 1.

    >>> round(log_stay(math.exp(-1.0), 0.2, 3.0), 3), log_stay(1.0, 0.2, 3.0)
    (0.5, 0.0)
    """
    depth = math.log(1 / distance)
    rounds = math.floor(depth / -math.log(abs(stable)))
    passed = depth / 2
    return passed + log_stay(abs(unstable) ** -rounds, stable, unstable) if rounds else passed


def exponent(distances: Array, unit: float, stable: float, unstable: float) -> float:
    """The power that a straight line through the logarithms at these distances would show."""
    logs = [log_stay(float(d) / unit, stable, unstable) for d in distances]
    return -float(np.polyfit(np.log(distances), logs, 1)[0])


def unit(points: Sequence[tuple[float, float]], stable: float, unstable: float) -> tuple[float, float]:
    """The distance that counts as one, by least squares, and the root mean square of what is left of `ln(stay)`.

    The steps lie at `unit*stable**n`; units are sought from the largest distance up to 1, all that a contraction has.
    """
    distances, logs = np.array(points)[:, 0], np.log(np.array(points)[:, 1])
    tried = np.geomspace(distances.max(), 1, TRIED)
    left = []
    for one in tried:
        off = logs - np.array([log_stay(float(d) / one, stable, unstable) for d in distances])
        left.append(float(np.std(off)))
    best = int(np.argmin(left))
    return float(tried[best]), left[best]
