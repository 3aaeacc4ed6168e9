"""A cycle followed in the contraction for as long as it attracts: what happens at both ends, and its doublings.

Steps are accepted only onto a cycle of the same period with the same symmetries, so a branch is neither left
through a period doubling nor through a loss of symmetry. At an end the event is solved for on the chord
system and proved there (`verification.named.locate.certify`).

The cascade of doublings that follows is proved flip by flip. It may start from any attracting cycle that random
particles reach, such as those of higher period to which section 6.6 ascribes isolated chaotic regions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache
from itertools import islice

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.attractors import moved
from numeric.dynamics.phase_points import PhasePoints, embedded, phase_points
from numeric.dynamics.recognition import Cycle, polished
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.space import followed
from symbolic.tables import egg
from symbolic.tables.geometry import Symmetry
from symbolic.tables.table import Table
from verification.arithmetic.balls import decimal
from verification.cycles.cascade import FEIGENBAUM, doublings
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.cycles.recurrence import IDENTITY, MIRROR, BifurcationKind, Closure
from verification.named.locate import certify

STEP, LEAST = 1.2e-2, 1e-9
FAR = 0.03  # that a bounce may move in one step
MEET = 0.02  # of the two halves, or of an image, near the end of a branch


class Event(Enum):
    """Why a branch of attracting cycles begins or ends."""

    FOLD = "a saddle and the cycle are born together"
    FLIP = "it doubles its period"
    HALVED = "it is born by the period doubling of a cycle of half its period"
    PITCHFORK = "it is exchanged with cycles of more or less symmetry"
    EDGE = "the range of the contraction ends"
    UNKNOWN = "not recognised"


@dataclass(frozen=True, eq=False)
class End:
    """Where a branch ends, in decimals; `proved` when balls enclose it. `path` are the cycles on the way there."""

    lam: float
    event: Event
    value: str
    proved: bool
    cycle: Cycle
    path: tuple[tuple[float, PhasePoints], ...] = ()


@dataclass(frozen=True, eq=False)
class Branch:
    """Attracting cycles from `low` to `high`; `copies` of them are images of each other."""

    period: int
    symmetry: str
    copies: int
    low: End
    high: End

    def nearest(self, lam: float) -> PhasePoints:
        """The cycle on the way whose contraction is nearest."""
        return min((*self.low.path, *self.high.path), key=lambda place: abs(place[0] - lam))[1]


def alike(map: PinballMap, left: PhasePoints, right: PhasePoints) -> float:
    """How far the farthest point of the first lies from the second, in `(x, y, sin(phi))`."""
    a, b = embedded(map, left), embedded(map, right)
    return float(np.max(np.min(np.linalg.norm(a[:, None] - b, axis=2), axis=1)))


def own(map: PinballMap, cycle: PhasePoints, group: Sequence[Symmetry], within: float = 1e-6) -> list[Symmetry]:
    """The symmetries that keep a cycle."""
    return [symmetry for symmetry in group if alike(map, moved(symmetry, cycle), cycle) < within]


def ends(
    map: PinballMap, table: Table, group: Sequence[Symmetry], cycle: Cycle, lam: float, digits: int = 12
) -> tuple[End, End]:
    """Both ends of the branch through a cycle at `lam`.

    >>> from symbolic.tables.geometry import group
    >>> from symbolic.tables import cuspless
    >>> map = PinballMap("cuspless", lam=0.05)
    >>> axis = polished(map, phase_points([0.0, 0.0], 0.0, [0, 1]))
    >>> low, high = ends(map, cuspless, group(cuspless), axis, 0.05)
    >>> low.event.name, high.event.name, high.value, high.proved
    ('EDGE', 'FLIP', '0.09340033543136', True)
    """
    low, high = (_end(map, table, group, cycle, lam, way, digits) for way in (-1, 1))
    return low, high


def _end(
    map: PinballMap, table: Table, group: Sequence[Symmetry], cycle: Cycle, lam: float, way: int, digits: int
) -> End:
    kept = len(own(map, cycle.points, group))
    here, step, before = cycle, STEP, None
    edge = 0.0 if way < 0 else 1.0 - 1e-6  # at 1 nothing attracts
    path = [(lam, here.points)]
    while abs(lam - edge) > LEAST and step > LEAST:
        target = edge if abs(edge - lam) < step else lam + way * step
        guess = here.points if before is None else _ahead(here.points, before[0], (target - lam) / (lam - before[1]))
        there = map.at(target)
        new = polished(there, guess)
        good = new is not None and new.period == cycle.period and abs(new.multipliers[0]) < 1
        if good and new is not None:
            new = Cycle(_in_step(map, new.points, here.points), new.multipliers, new.volume)
            far = np.max(np.linalg.norm(embedded(map, new.points) - embedded(map, here.points), axis=1))
            good = far < FAR and len(own(there, new.points, group)) == kept
        if good and new is not None:
            before, here, lam, step = (here.points, lam), new, target, min(1.6 * step, STEP)
            path.append((lam, here.points))
        else:
            step /= 3
    if abs(lam - edge) <= LEAST:
        return End(float(round(edge)), Event.EDGE, str(round(edge)), False, here, tuple(path))
    return replace(_named(map, table, group, here, lam, digits), path=tuple(path))


def _ahead(here: PhasePoints, before: PhasePoints, share: float) -> PhasePoints:
    """The bounces extrapolated."""
    theta = here.theta + share * (np.remainder(here.theta - before.theta + np.pi, 2 * np.pi) - np.pi)
    return phase_points(theta, np.clip(here.phi + share * (here.phi - before.phi), -1.57, 1.57), here.component)


def _in_step(map: PinballMap, new: PhasePoints, old: PhasePoints) -> PhasePoints:
    """The same cycle begun where the old one is."""
    first = embedded(map, old.only(slice(0, 1)))
    nearest = int(np.argmin(np.linalg.norm(embedded(map, new) - first, axis=1)))
    return new.turned(nearest)


def _named(map: PinballMap, table: Table, group: Sequence[Symmetry], cycle: Cycle, lam: float, digits: int) -> End:
    """The end with its event, from the multiplier that is near 1 or -1 and from what the cycle comes near."""
    mu, points, n = cycle.multipliers[0], cycle.points, cycle.period
    event, kind, closure, use = Event.UNKNOWN, BifurcationKind.FOLD, IDENTITY, points
    if abs(mu.imag) < 0.05 and mu.real < -0.8:
        event, kind = Event.FLIP, BifurcationKind.FLIP
    elif abs(mu.imag) < 0.05 and mu.real > 0.8:
        half = points.turned(n // 2)
        if n % 2 == 0 and np.max(np.linalg.norm(embedded(map, half) - embedded(map, points), axis=1)) < MEET:
            event, kind, use = Event.HALVED, BifurcationKind.FLIP, points.only(slice(0, n // 2))
        elif len(own(map, points, group, MEET)) > len(own(map, points, group)):
            event, kind = Event.PITCHFORK, BifurcationKind.FLIP
        else:
            event = Event.FOLD
        if event is Event.FOLD and len(own(map, points, group)) > 1 and n % 2 == 0:
            event = _broken(map, table, group, cycle, lam)
            kind = BifurcationKind.FLIP if event is Event.PITCHFORK else kind
    if event is Event.PITCHFORK:
        found = _mirrored(map, group, points)
        if found is None:
            return End(lam, event, f"{lam:.9f}", False, cycle)
        use, closure = found, MIRROR
    if event is Event.UNKNOWN:
        return End(lam, event, f"{lam:.9f}", False, cycle)
    return _solved(table, event, kind, use, closure, lam, digits, cycle)


def _broken(map: PinballMap, table: Table, group: Sequence[Symmetry], cycle: Cycle, lam: float) -> Event:
    """A fold, or the symmetric side of a pitchfork: then half the cycle flips here."""
    half = _mirrored(map, group, cycle.points)
    if half is not None:
        problem = Problem(table, tuple(int(i) for i in half.component), BifurcationKind.FLIP, "lam", closure=MIRROR)
        try:
            if abs(floats(problem, [*half.theta, lam])[-1] - lam) < 1e-5:
                return Event.PITCHFORK
        except (ValueError, ZeroDivisionError):
            pass
    return Event.FOLD


def _mirrored(map: PinballMap, group: Sequence[Symmetry], points: PhasePoints) -> PhasePoints | None:
    """The first half of an image of the cycle that `theta -> -theta` nearly takes to its second half."""
    n = points.size
    mirror = next((s for s in group if s.sign < 0 and s.angle == 0), None)
    if mirror is None or n % 2:
        return None
    for symmetry in group:
        image = moved(symmetry, points)
        reflected = moved(mirror, image).turned(n // 2)
        if np.max(np.linalg.norm(embedded(map, reflected) - embedded(map, image), axis=1)) < MEET:
            return image.only(slice(0, n // 2))
    return None


def _solved(
    table: Table,
    event: Event,
    kind: BifurcationKind,
    use: PhasePoints,
    closure: Closure,
    lam: float,
    digits: int,
    cycle: Cycle,
) -> End:
    problem = Problem(table, tuple(int(i) for i in use.component), kind, "lam", closure=closure)
    try:
        start = floats(problem, [*use.theta, lam])
        if abs(start[-1] - lam) > 1e-4:
            raise ValueError("another event")
        proof = certify(problem, start, digits)
    except (ValueError, ZeroDivisionError):
        return End(lam, event, f"{lam:.9f}", False, cycle)
    return End(start[-1], event, decimal(proof.value, digits + 1)[0], proof.certified, cycle)


DIGITS, PARTICLES, SEED = 15, 400, 1
STAGES = (1000, 4000, 35_000)  # bounces after each of which it is seen whether a particle is on the cycle


@dataclass(frozen=True)
class Cascade:
    """The periods that double and the contractions at which they do; `proved` when each is a supercritical flip."""

    periods: tuple[int, ...]
    lams: tuple[float, ...]
    proved: bool

    @property
    def ratios(self) -> list[float]:
        """Of successive distances; they tend to Feigenbaum's 4.669."""
        gaps = np.diff(self.lams)
        return [float(ratio) for ratio in gaps[:-1] / gaps[1:]]

    @property
    def limit(self) -> float:
        """Where the cascade accumulates if further distances shrink by Feigenbaum's number: an estimate."""
        return self.lams[-1] + (self.lams[-1] - self.lams[-2]) / (FEIGENBAUM - 1)


@cache
def cascade(alpha: Rational, lam: Rational, period: int, step: float, count: int = 3) -> Cascade:
    """The first doublings of an attracting cycle of some period that exists at `lam`, followed in steps.

    >>> found = cascade(Rational(2, 25), Rational(3, 10), 4, 0.005, count=1)  # the paper's lambda_3, section 6.6
    >>> found.periods, round(found.lams[0], 6), found.proved
    ((4,), 0.371236, True)
    """
    found = doublings(egg(3).at(alpha=alpha), reached(alpha, lam, period), float(lam), step)
    members = list(islice(found, count))
    proofs = [certify(member.problem, member.start, DIGITS, in_balls=True) for member in members]
    proved = all(proof.certified and proof.supercritical is True for proof in proofs)
    return Cascade(tuple(m.problem.period for m in members), tuple(m.lam for m in members), proved)


def reached(alpha: Rational, lam: Rational, period: int) -> list[float]:
    """The bounces of a cycle of this period on which a random particle ends; `ValueError` when none does."""
    map = PinballMap("egg", lam=str(lam), alpha=str(alpha))
    starts = interior_starts(map, PARTICLES, SEED)
    for bounces in STAGES:
        found = followed(map, starts, (bounces,))
        on = np.flatnonzero(found.period == period)
        if on.size:
            first = found.starts.only(on[:1])
            return [float(x) for x in map.orbit(first.theta, first.phi, period - 1, first.component).theta[:, 0]]
        starts = found.starts
    raise ValueError(
        f"egg: none of {PARTICLES} particles at alpha = {alpha}, lam = {lam} ends on a cycle of period {period}"
    )
