"""The crises of the egg as homoclinic tangencies, computed from folds of long cycles, with their starts.

A cycle that shadows a homoclinic tangency stays some rounds near the saddle, leaves along the unstable manifold and
returns along the stable one. Such cycles appear in a fold, at a parameter that approaches the tangency like
`unstable**-rounds`. The fold is a problem of the chord system, which can be solved to any number of digits and proved;
for a long cycle its parameter approximates that of the tangency.

The mean time that a particle stays near an attractor just above a homoclinic crisis follows from the multipliers of the
saddle. [GrebogiOttRomeirasYorke1987] derive the power law in the limit. The same argument works at a finite distance.
At the distance `e` above the crisis, the unstable manifold reaches beyond the stable one by `e`, over a length
`sqrt(e)`, and particles that land there leave. Its preimage after `n` rounds near the saddle is as high as the
attractor, `e*stable**-n = 1`, and at the distance `unstable**-n` from the stable manifold. So a particle must first
come as near as that to the stable manifold, and then hit the fraction `sqrt(e)` of this neighbourhood:

    leaves(e) = sqrt(e) * leaves(unstable**-n),    n = floor(ln(e)/ln(stable)),

and `leaves(e) = sqrt(e)` when `n = 0`. For large `n`, not rounded, this is the power law with the exponent `ln|stable|
/ (2*ln|stable*unstable|)`. With `n` rounded, `ln(leaves)` has slope 1/2 against `ln(e)`, with a step for each further
passage, which explains the measured oscillation about the power law. The unit of distance is the only fitted number.

Starts are given at `alpha = 0.08`. Two crises undo a period doubling and a symmetry breaking, when the unstable
manifold of the cycle that had bifurcated touches the stable manifold of the same cycle: eight chaotic bands near one
end of a diameter become four at the cycle of period 4, and two mirror images become one attractor at the symmetric
cycle of period 4.

Boundary crisis: the saddle is the triangle near the vertices, born at the fold of period 3. Its stable manifold bounds
the basin of the attracting triangle; its unstable manifold runs to the chaotic attractor, forms its outermost fold, and
touches the stable manifold. Merging crisis: the saddle is a cycle of period 8, which equals its mirror image after 4
bounces. It is the cycle of the fractal basin boundary that is accessible from the attractor near a diameter. Other
shapes follow by continuation.

A crisis is computed to many digits by two methods that share only the chord equation. The value comes from the fold of
a long cycle that shadows the tangency, and its error from a cycle with four more rounds. The tangency of the manifolds
themselves (`tangency`) must agree.
"""

import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from sympy import Expr, Rational

from numeric.backends import elementary
from symbolic.tables import egg
from symbolic.tables.law import PAPERS_LAW, Law
from verification.arithmetic.balls import FLOAT64
from verification.arithmetic.iteration import telling
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.cycles.recurrence import Array, BifurcationKind, Closure
from verification.proofs.manifolds.certificate import Tangency
from verification.proofs.manifolds.plane_map import Pinball, pinball
from verification.proofs.manifolds.proof import LEAST_DIGITS, objection, sharpened
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact, Gap, Touch, tangency
from verification.proofs.manifolds.touching import passage


@dataclass(frozen=True)
class Shadow:
    """A cycle near a homoclinic tangency: the problem of its fold, and a starting point for Newton's method."""

    problem: Problem
    start: list[float]


def shadow(contact: Contact, map: Pinball, parameter: float, rounds: int) -> Shadow:
    """The fold problem of a cycle with about `rounds` or more rounds near the saddle; `ValueError` if heteroclinic."""
    if contact.unstable != contact.stable:
        raise ValueError("shadow: the tangency is heteroclinic; a cycle shadows homoclinic ones only")
    floats = map.over(FLOAT64)
    gap = Gap(contact, floats, parameter, 28, 1e-16)
    for more in range(6):
        points, bent, image = period(gap, rounds + more)
        sign, turns = image
        if sign == -1 or turns % map.turn == 0:
            return closed(points, bent, image, map, parameter)
    return closed(*period(gap, rounds), map, parameter)  # it is rotated at each passage, and closes after several


def closed(points: list[float], bent: int, image: tuple[int, int], map: Pinball, parameter: float) -> Shadow:
    """The fold problem of a cycle made of `points` and their images under a rotation or reflection."""
    sign, turns = image
    unit = 2 * math.pi / map.turn
    if sign == -1:  # a reflection: rotated so that its axis is theta = 0
        points, shift = [x + turns * unit for x in points], 0
    else:
        shift = turns % map.turn
    after = [sign * x + shift * unit for x in points[: bent + 1]]
    closure = Closure(sign, (shift, map.turn) if shift else (0, 1))
    problem = Problem(map.table, (0,) * len(points), BifurcationKind.FOLD, "lam", closure=closure, law=map.law)
    return Shadow(problem, [*points[bent + 1 :], *after, parameter])


def period(gap: Gap, rounds: int) -> tuple[list[float], int, tuple[int, int]]:
    """One period of the cycle, the index of its most sensitive bounce, and the symmetry by which it continues."""
    z, _, end = gap.extremum()
    early = rounds // 2
    points, flight, image = passage(gap, z, end.c[0], early, rounds - early)
    bent = early * len(gap.out.coefficients) + max(range(gap.bounces), key=lambda i: abs(flight[i].c[1]))
    return [float(x) for x in points], bent, image


TRIED = 1500


def log_stay(distance: float, stable: float, unstable: float) -> float:
    """The logarithm of the mean time near the attractor, up to a constant; `distance` is in fitted units, at most 1.

    >>> round(log_stay(math.exp(-1.0), 0.2, 3.0), 3), log_stay(1.0, 0.2, 3.0)
    (0.5, 0.0)
    """
    depth = math.log(1 / distance)
    rounds = math.floor(depth / -math.log(abs(stable)))
    passed = depth / 2
    return passed + log_stay(abs(unstable) ** -rounds, stable, unstable) if rounds else passed


def exponent(distances: Array, unit: float, stable: float, unstable: float) -> float:
    """The slope of a straight line fitted to `log_stay` against the logarithms of the given distances."""
    logs = [log_stay(float(d) / unit, stable, unstable) for d in distances]
    return -float(np.polyfit(elementary.log(distances), logs, 1)[0])


def unit(points: Sequence[tuple[float, float]], stable: float, unstable: float) -> tuple[float, float]:
    """The unit of distance by least squares, and the root mean square of the residuals of `ln(stay)`.

    `points` are pairs of distance and mean stay. The steps lie at `unit*stable**n`; the unit is sought between the
    largest distance and 1.
    """
    distances, logs = np.array(points)[:, 0], elementary.log(np.array(points)[:, 1])
    tried = elementary.exp(np.linspace(float(elementary.log(distances.max())), 0.0, TRIED))
    left = []
    for one in tried:
        off = logs - np.array([log_stay(float(d) / one, stable, unstable) for d in distances])
        left.append(float(np.std(off)))
    best = int(np.argmin(left))
    return float(tried[best]), left[best]


SHAPE = Rational(2, 25)
STEP = Rational(1, 500)  # the largest step of the shape in continuation
LEAST = Rational(1, 10_000)
SHARE, LEAST_SHARE = Rational(1, 4), Rational(1, 1000)  # steps towards another law in continuation
ENTRIES = tomllib.loads(Path(__file__).with_name("contacts.toml").read_text(encoding="utf-8"))


def homoclinic(name: str) -> Contact:
    """The contact of this name in `contacts.toml`."""
    entry = ENTRIES[name]
    sign, p, q = entry["closure"]
    orbit = SaddleCycle(entry["saddle"], tuple(entry["start"]), Closure(sign, (p, q)))
    return Contact(orbit, orbit, **{"sign": 1, **entry["contact"]})


CONTACTS = {name: homoclinic(name) for name, entry in ENTRIES.items() if "alpha" not in entry}
# The least contraction and the most bounces of a search by `earlier` that found no contact before these.
SEARCHED: dict[str, tuple[str, int]] = {
    name: tuple(entry["searched"]) for name, entry in ENTRIES.items() if "searched" in entry
}
CONTACTS["band-merging-4"] = CONTACTS["band-merging"]  # the name in the scheme of periods 8 and 16
SEARCHED["band-merging-4"] = SEARCHED["band-merging"]
TRIANGLE = CONTACTS["boundary"].unstable


def table(alpha: Expr, law: Law = PAPERS_LAW) -> Pinball:
    """The map of the egg with `K = 3`; its rotations are symmetries unless the law depends on the place."""
    return pinball(egg(3).at(alpha=alpha), law)


def contact(kind: str, alpha: Expr, law: Law = PAPERS_LAW) -> Contact:
    """The contact of this name at a shape and under a law, continued from `alpha = 0.08` and the paper's law.

    The laws on the way are `-lam*eta + share*(phi + lam*eta)` with `share` from 0 to 1. `ValueError` if the contact is
    lost on the way.
    """
    if kind not in CONTACTS:
        raise ValueError(f"crisis: {kind!r} is not known; accepted: {', '.join(CONTACTS)}")
    if why := objection(CONTACTS[kind], table(alpha, law), CONTACTS[kind].parameter):
        raise ValueError(f"{kind} crisis: {why}")

    def lost(here: Expr, why: Exception) -> str:
        return (
            f"{kind} crisis: followed from alpha = 0.08 to alpha = {alpha}, the tangency is lost beyond "
            f"alpha = {float(here):.5g} ({why}); accepted: shapes on this side of it"
        )

    def mixed(share: Expr) -> Pinball:
        return table(alpha, Law(f"-lam*eta + ({share})*(lam*eta + {law.phi})"))

    def parted(share: Expr, why: Exception) -> str:
        return (
            f"{kind} crisis: followed to the law {law}, the tangency is lost beyond {float(share):.5g} of the way from "
            f"the paper's ({why}); accepted: laws nearer to -lam*eta"
        )

    there = followed(CONTACTS[kind], (SHAPE, alpha), (STEP, LEAST), table, lost)
    return there if law.uniform else followed(there, (Rational(0), Rational(1)), (SHARE, LEAST_SHARE), mixed, parted)


def followed(
    here: Contact,
    ends: tuple[Expr, Expr],
    steps: tuple[Expr, Expr],
    map: Callable[[Expr], Pinball],
    lost: Callable[[Expr, Exception], str],
) -> Contact:
    """A contact, continued from one end of a family of maps to the other; `steps` are the largest and the smallest
    step.

    `lost` makes the message of the `ValueError` that is raised if even the smallest step fails.
    """
    (place, goal), (step, least) = ends, steps
    whole, last, before = goal - place, step, here
    tick = telling(f"following the tangency to {goal}")
    while place != goal:
        move = max(-step, min(step, goal - place))
        try:
            following = settled(extrapolated(before, here, float(move / last)), map(place + move))
        except (ValueError, ArithmeticError) as why:
            step = step / 2
            if step < least:
                raise ValueError(lost(place, why)) from why
            continue
        place, last, before, here = place + move, move, here, following
        tick(float(move / whole))
    return here


def extrapolated(before: Contact, here: Contact, share: float) -> Contact:
    """The contact `here`, with its starts changed by `share` times the change from `before`."""
    names = ("parameter", "z", "end")
    moved = {name: getattr(here, name) + share * (getattr(here, name) - getattr(before, name)) for name in names}
    return replace(here, **moved)


def settled(guess: Contact, map: Pinball) -> Contact:
    """The contact that Newton's method finds from a guess; its starts are those of the solution."""
    parameter = tangency(guess, map, 8).parameter
    return Gap(guess, map.over(FLOAT64), parameter, 28, 1e-16).contact()


MOST_DIGITS = 500
MANIFOLD_DIGITS = 20  # the most digits that the second method computes
SPARE = 4  # rounds by which the second cycle is longer


@dataclass(frozen=True)
class KnownCrisis:
    """A crisis: its `parameter` from the fold of a long `cycle`, with an error estimate, and the tangency `touch`.

    `apart` is the difference between the parameters of the fold and of the tangency.
    """

    kind: str
    parameter: Any
    error: Any
    touch: Touch
    apart: float
    cycle: Shadow

    @property
    def period(self) -> int:
        """The number of bounces after which the cycle repeats, or repeats as its mirror image."""
        return self.cycle.problem.period

    @property
    def agrees(self) -> bool:
        """True if `apart` is at most `error` plus ten times the tangency's error."""
        return self.apart <= 10 * self.touch.error + float(self.error)

    @property
    def exponent(self) -> float:
        """The exponent of the mean transient time above a homoclinic crisis [GrebogiOttRomeirasYorke1987]."""
        return homoclinic_exponent(self.touch.multipliers[0], self.touch.multipliers[1])


def homoclinic_exponent(stable: float, unstable: float) -> float:
    """The limit exponent at a homoclinic crisis, `ln|stable| / (2*ln|stable*unstable|)`, from a saddle's multipliers.

    >>> homoclinic_exponent(1 / 16, 4)
    1.0
    """
    return math.log(abs(stable)) / (2 * math.log(abs(stable * unstable)))


def crisis(kind: str, alpha: Expr, digits: int, law: Law = PAPERS_LAW) -> KnownCrisis:
    """The `merging` or the `boundary` crisis of the egg with `K = 3`, to `digits` digits, without a proof.

    >>> from sympy import Rational
    >>> mpmath.nstr(crisis("boundary", Rational(2, 25), 10).parameter, 10)
    '0.6621442734'
    """
    if digits > MOST_DIGITS:
        raise ValueError(f"{kind} crisis: digits = {digits} is out of range; accepted: up to {MOST_DIGITS}")
    map = table(alpha, law)
    where = contact(kind, alpha, law)
    touch = tangency(where, map, min(digits, MANIFOLD_DIGITS))
    unstable = abs(touch.multipliers[1])
    rounds = math.ceil((digits + 2) * math.log(10) / math.log(unstable))
    found = []
    for more in (0, SPARE):
        cycle = shadow(where, map, float(touch.parameter), rounds + more)
        found.append(refined(cycle.problem, cycle.start, digits + 5).z[-1])
    context = mpmath.MPContext()
    context.dps = digits + 10
    short, parameter = found
    error = abs(context.mpf(parameter) - context.mpf(short)) + context.mpf(10) ** -(digits + 2)
    return KnownCrisis(
        kind, context.mpf(parameter), error, touch, float(abs(context.mpf(touch.parameter) - parameter)), cycle
    )


def proof(found: KnownCrisis, alpha: Expr, digits: int, law: Law = PAPERS_LAW) -> Tangency:
    """The theorem that the manifolds have a tangency within `10**-digits` of the value found.

    The theorem concerns the contact of the manifolds, not the end of the attractor.
    """
    digits, map, touch = max(LEAST_DIGITS, digits), table(alpha, law), found.touch
    try:
        value = sharpened(touch.contact, map, str(touch.parameter), digits)
    except (ValueError, ArithmeticError):  # then the theorem fails too, and its checks say at which step
        value = str(touch.parameter)
    return Tangency(touch.contact, map.table, value, digits, law)


def touching(name: str) -> Tangency:
    """The theorem on a contact that has the entry `proved` in `contacts.toml`, at its shape.

    >>> touching("window-merging-9").strange.proved
    True
    """
    entry = ENTRIES[name]
    return Tangency(homoclinic(name), egg(3).at(alpha=entry.get("alpha", SHAPE)), *entry["proved"])


def boundary(alpha: Expr) -> Tangency:
    """The theorem on the boundary tangency at a shape for which `contacts.toml` has it.

    >>> boundary(Rational(1, 20)).strange.proved
    True
    """
    return touching("boundary" if alpha == SHAPE else f"boundary-{alpha}")


def earliest() -> Tangency:
    """Theorem on the tangency named `earliest`: of those proved in the cascade, the one at the smallest contraction."""
    return touching("earliest")


def decimals(found: KnownCrisis) -> tuple[str, str]:
    """The value of a crisis with all its digits, and its error, as decimals."""
    return str(found.parameter), mpmath.nstr(found.error, 3)
