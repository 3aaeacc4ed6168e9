"""Homoclinic tangencies as limits of folds of cycles, and the crises of the egg: which saddle, and where to start.

A cycle that shadows a homoclinic tangency leaves its saddle along its unstable manifold and comes back along the
stable one stays some rounds near the saddle in between. Each such family folds once, at a parameter that approaches
the tangency like `unstable**-rounds`. A fold is a problem of the chord system, solved with as many digits as wanted,
and provable; a long cycle gives the tangency itself.

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

Starts are given at `alpha = 0.08`. Two crises join what period doubling and symmetry breaking had split, each when
the unstable manifold of the cycle that had split touches its own stable one: eight chaotic bands near one end of a
diameter become four at the cycle of period 4, and the two mirror images become one attractor at the symmetric cycle
of period 4 from which they had come.

Boundary crisis: the saddle is the triangle of the vertices, born at the fold of period 3. Its stable
manifold bounds the basin of the attracting triangle; its unstable manifold runs to the chaotic
attractor, whose outermost fold it is, and touches the stable one. Merging crisis: the saddle is a cycle
of period 8 that its mirror image repeats after 4 bounces. It is the cycle of the fractal basin boundary
that can be reached from the attractor near a diameter. Other shapes follow by continuation.

To many digits a crisis is found by two methods that share nothing but the chord. The value comes from the fold of a
long cycle that shadows the tangency: its distance to the tangency falls like `unstable**-rounds`, and a
cycle with four rounds more tells how far the shorter one was. The tangency of the manifolds themselves (`tangency`)
has to agree.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Rational

from numeric.backends import elementary
from symbolic.tables import egg
from symbolic.tables.law import PAPERS_LAW, Law
from verification.arithmetic.balls import FLOAT64
from verification.arithmetic.iteration import telling
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind, Closure
from verification.proofs.manifolds.claim import TangencyClaim, TangencyProof, worked_through
from verification.proofs.manifolds.plane_map import Pinball, pinball
from verification.proofs.manifolds.proof import LEAST_DIGITS, objection, sharpened
from verification.proofs.manifolds.saddle import Orbit, horner
from verification.proofs.manifolds.tangency import Contact, Gap, Touch, tangency
from verification.proofs.manifolds.touching import composed
from verification.proofs.manifolds.windows import WINDOWS, homoclinic


@dataclass(frozen=True)
class Shadow:
    """A cycle near a homoclinic tangency: the problem of its fold, and a start for Newton's method."""

    problem: Problem
    start: list[float]


def shadow(contact: Contact, map: Pinball, parameter: float, rounds: int) -> Shadow:
    """The cycle that spends about `rounds` rounds of the saddle near it, a few more where symmetry asks for it."""
    if contact.unstable != contact.stable:
        raise ValueError("shadow: the tangency is heteroclinic; a cycle shadows homoclinic ones only")
    floats = map.over(FLOAT64)
    gap = Gap(contact, floats, parameter, 28, 1e-16)
    for more in range(6):
        points, bent, image = period(gap, rounds + more)
        sign, turns = image
        if sign == -1 or turns % map.turn == 0:
            return closed(points, bent, image, map, parameter)
    return closed(*period(gap, rounds), map, parameter)  # it turns at each passage, and closes after several


def closed(points: list[float], bent: int, image: tuple[int, int], map: Pinball, parameter: float) -> Shadow:
    """The problem of the fold of a cycle that repeats after its points, turned or as its mirror image."""
    sign, turns = image
    unit = 2 * math.pi / map.turn
    if sign == -1:  # a mirror: turned so that its axis is theta = 0
        points, shift = [x + turns * unit for x in points], 0
    else:
        shift = turns % map.turn
    after = [sign * x + shift * unit for x in points[: bent + 1]]
    closure = Closure(sign, (shift, map.turn) if shift else (0, 1))
    problem = Problem(map.table, (0,) * len(points), BifurcationKind.FOLD, "lam", closure=closure, law=map.law)
    return Shadow(problem, [*points[bent + 1 :], *after, parameter])


def period(gap: Gap, rounds: int) -> tuple[list[float], int, tuple[int, int]]:
    """One period of the cycle, the bounce that moves most with it, and the symmetry that continues it."""
    turn, orbit = gap.map.turn, gap.out.saddle.orbit
    unit = 2 * gap.map.words.pi / turn
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
    return -float(np.polyfit(elementary.log(distances), logs, 1)[0])


def unit(points: Sequence[tuple[float, float]], stable: float, unstable: float) -> tuple[float, float]:
    """The distance that counts as one, by least squares, and the root mean square of what is left of `ln(stay)`.

    The steps lie at `unit*stable**n`; units are sought from the largest distance up to 1, all that a contraction has.
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
STEP = Rational(1, 500)  # of the shape, in continuation
LEAST = Rational(1, 10_000)
SHARE, LEAST_SHARE = Rational(1, 4), Rational(1, 1000)  # of another law, mixed with the paper's, in continuation
TRIANGLE = Orbit("triangle of the vertices", (-0.165533,), Closure(1, (1, 3)))
MIRRORED = Orbit("cycle of period 8", (0.87019, 4.339815, 7.910758, 10.599687), Closure(-1, (7, 3)))
SYMMETRIC = Orbit("symmetric cycle of period 4", (-0.645971, 2.02441), Closure(-1, (2, 3)))
FOUR = Orbit("cycle of period 4", (-0.022673, 2.875498, 6.392393, 9.889393), Closure(1, (6, 3)))
CONTACTS = {
    "merging": Contact(MIRRORED, MIRRORED, 14, 1, -0.00396287, -0.00053713, 0.44343525),
    "boundary": Contact(TRIANGLE, TRIANGLE, 5, 1, 0.03431592, -0.02607124, 0.66214427),
    "band-merging": Contact(FOUR, FOUR, 20, 1, -0.01239661, 0.00116269, 0.39768737),
    "symmetry-restoring": Contact(SYMMETRIC, SYMMETRIC, 12, 1, -0.03158573, -0.00186500, 0.41026825),
} | WINDOWS
CONTACTS["band-merging-4"] = CONTACTS["band-merging"]  # as those of periods 8 and 16 are called

FLATTER = Orbit(TRIANGLE.name, (-0.053420925,), TRIANGLE.closure)
SHARPER = Orbit(TRIANGLE.name, (-0.228435096,), TRIANGLE.closure)
SHARPEST = Orbit(TRIANGLE.name, (-0.249454849,), TRIANGLE.closure)
BOUNDARY = {  # the boundary tangency at four shapes, and its contraction there
    SHAPE: (CONTACTS["boundary"], "0.66214427335822441948"),
    Rational(19, 200): (Contact(SHARPER, SHARPER, 5, 1, 0.03705487, -0.01623858, 0.51753491), "0.51753490920795741937"),
    Rational(1, 10): (Contact(SHARPEST, SHARPEST, 5, 1, 0.03883646, -0.01384408, 0.47171580), "0.47171579751413786140"),
    Rational(1, 20): (Contact(FLATTER, FLATTER, 5, 1, 0.04529252, -0.06772806, 0.91652073), "0.91652073292391123465"),
}


def table(alpha: Expr, law: Law = PAPERS_LAW) -> Pinball:
    """The map of the three-pointed egg; its rotations are symmetries unless the law depends on the place."""
    return pinball(egg(3).at(alpha=alpha), law)


def contact(kind: str, alpha: Expr, law: Law = PAPERS_LAW) -> Contact:
    """A contact by its name at a shape, followed there from `alpha = 0.08`, and then to another law than the paper's.

    On the way to a law `phi` it is that of `-lam*eta + share*(phi + lam*eta)`, a law as well.
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
    """A contact followed from one end of a family of maps to the other, in steps between a least and a largest."""
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
    """The starts carried on, `share` times the last change."""
    names = ("parameter", "z", "end")
    moved = {name: getattr(here, name) + share * (getattr(here, name) - getattr(before, name)) for name in names}
    return replace(here, **moved)


def settled(guess: Contact, map: Pinball) -> Contact:
    """The contact found from a guess, with starts taken from it."""
    parameter = tangency(guess, map, 8).parameter
    return Gap(guess, map.over(FLOAT64), parameter, 28, 1e-16).contact()


MOST_DIGITS = 500
MANIFOLD_DIGITS = 20  # asked of the second method at most
SPARE = 4  # rounds by which the second cycle is longer


@dataclass(frozen=True)
class Crisis:
    """`parameter +- error` and how it was found; `apart` is how far the two methods are from each other."""

    kind: str
    parameter: Any
    error: Any
    touch: Touch
    apart: float
    cycle: Shadow

    @property
    def period(self) -> int:
        """Bounces of the cycle before it repeats, or repeats as its mirror image."""
        return self.cycle.problem.period

    @property
    def agrees(self) -> bool:
        """Do the two methods agree within their errors?"""
        return self.apart <= 10 * self.touch.error + float(self.error)

    @property
    def exponent(self) -> float:
        """Of the mean transient above a homoclinic crisis [GrebogiOttRomeirasYorke1987]."""
        return homoclinic_exponent(self.touch.multipliers[0], self.touch.multipliers[1])


def homoclinic_exponent(stable: float, unstable: float) -> float:
    """`ln|stable| / (2*ln|stable*unstable|)`, reached in the limit; at a finite distance see `local_exponent`.

    >>> homoclinic_exponent(1 / 16, 4)
    1.0
    """
    return math.log(abs(stable)) / (2 * math.log(abs(stable * unstable)))


def heteroclinic_exponent(stable: float, unstable: float) -> float:
    """`1/2 + ln|unstable|/|ln|stable||`, of the saddle inside the attractor.

    >>> heteroclinic_exponent(1 / 16, 4)
    1.0
    """
    return 0.5 + math.log(abs(unstable)) / abs(math.log(abs(stable)))


def crisis(kind: str, alpha: Expr, digits: int, law: Law = PAPERS_LAW) -> Crisis:
    """The `merging` or the `boundary` crisis of the three-pointed egg to `digits` digits, not proved.

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
    return Crisis(
        kind, context.mpf(parameter), error, touch, float(abs(context.mpf(touch.parameter) - parameter)), cycle
    )


def proof(found: Crisis, alpha: Expr, digits: int, law: Law = PAPERS_LAW) -> TangencyProof:
    """The proof in balls of a tangency near the value, within `10**-digits` or less.

    It proves the contact of the manifolds, and not that the attractor ends there.
    """
    digits, map, touch = max(LEAST_DIGITS, digits), table(alpha, law), found.touch
    try:
        value = sharpened(touch.contact, map, str(touch.parameter), digits)
    except (ValueError, ArithmeticError):  # then no proof succeeds either; which step fails the checks tell
        value = str(touch.parameter)
    return worked_through(TangencyClaim(touch.contact, map.table, value, digits, law))


def boundary(alpha: Expr) -> TangencyProof:
    """The proof of the boundary tangency at one of the shapes of `BOUNDARY`, within 1e-12 of its contraction.

    >>> all(boundary(Rational(1, 20)).strange.values())
    True
    """
    return worked_through(TangencyClaim(BOUNDARY[alpha][0], egg(3).at(alpha=alpha), BOUNDARY[alpha][1], 12))


PROVED = {  # contractions of contacts at alpha = 0.08, and to how many digits the proof's balls serve best
    "band-merging": ("0.39768736899279139077682306799053", 20),
    "band-merging-16": ("0.393711849308008935479606", 20),
    "interior-crisis-1": ("0.428419190754595226515935", 12),
    "merging": ("0.4434352460818512182485087598866334", 12),
    "window-merging-9": ("0.504527312767549985147168", 12),
}


def touching(kind: str) -> TangencyProof:
    """The proof of one of these at `alpha = 0.08`.

    >>> all(touching("window-merging-9").strange.values())
    True
    """
    return worked_through(TangencyClaim(CONTACTS[kind], egg(3).at(alpha=SHAPE), *PROVED[kind]))


BANDS = homoclinic(  # followed from 0.08, where it is `window-merging-9`, to the end of the convex shapes
    Orbit("cycle of period 9", (-2.8419283836, -0.2524353493, 2.2503788186), Closure(1, (4, 3))),
    12, 1, 0.0103226344, 0.0605500556, 0.29564321252129,
)  # fmt: skip


def bands() -> TangencyProof:
    """The proof of this one at `alpha = 1/10`."""
    return worked_through(
        TangencyClaim(BANDS, egg(3).at(alpha=Rational(1, 10)), "0.295643212521289641615402176260", 12)
    )


def decimals(found: Crisis) -> tuple[str, str]:
    """The value and its error as decimals, all digits of both."""
    return str(found.parameter), mpmath.nstr(found.error, 3)
