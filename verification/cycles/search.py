"""The search for all cycles up to a period: orbits that almost close are closed by Newton's method and listed once.

Starts are spread over the phase space; segments of their orbits that come back near where they began are the seeds,
those next to the start (where unstable cycles still show) as much as those on attractors. A round without news is
followed by one with the known cycles deflated. Rounds go on until several in a row bring nothing new and, on a convex
table, the index sums vanish. Each cycle found is listed once, whatever bounce it is begun with, and its images under
the table's symmetries are added. A search finds cycles and does not prove that it found all;
`verification.proofs.periodic.interval_newton` does.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray
from sympy import Expr
from sympy import pi as half_turn

from numeric import PinballMap
from numeric.backends import elementary
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from symbolic.tables.table import eta as angle
from symbolic.tables.table import lam as contraction
from verification.cycles.cells import Array, Corrector, Spectrum, spectrum
from verification.cycles.chords import Chords
from verification.cycles.recurrence import MIRROR
from verification.cycles.systems import symmetries
from verification.maps.first_hit import convex

SAME = 1e-7
FAMILY = 1e-7  # of det(M - 1): a cycle so near the multiplier 1 is one of a family, or bifurcates


@dataclass(frozen=True)
class Found:
    """A cycle of minimal period, its multipliers, and how often it runs around the boundary in one period."""

    components: tuple[int, ...]
    theta: tuple[float, ...]
    phi: tuple[float, ...]
    spectrum: Spectrum
    winding: int

    @property
    def period(self) -> int:
        """Bounces."""
        return len(self.theta)

    def index(self, n: int) -> int:
        """The fixed-point index of `T**n` at a bounce: the sign of `det(1 - M**(n/period))`."""
        one, two = self.spectrum.multipliers
        power = n // self.period
        if power == 1:
            return int(np.sign(self.spectrum.at_one))
        return int(np.sign(((1 - one**power) * (1 - two**power)).real))


@dataclass
class Catalogue:
    """The cycles found so far at one contraction; `degenerate` counts those with the multiplier 1, not filed."""

    table: Table
    lam: float
    cycles: list[Found] = field(default_factory=list)
    marks: dict[int, list[Array]] = field(default_factory=dict)
    degenerate: int = 0
    law: Law = PAPERS_LAW

    def add(self, components: tuple[int, ...], x: Array, phi: Array) -> bool:
        """Files a cycle; False when it was there already, or only repeats a shorter one that was."""
        components, x, phi = _minimal(components, x, phi)
        n = len(x)
        mark = _mark(components, x, phi)
        if any(np.max(np.abs(mark - known)) < SAME * n for known in self.marks.get(n, [])):
            return False
        ring = Chords(self.table, components, law=self.law)
        found = spectrum(ring.terms(x, {"lam": self.lam}, 1), ring.closure)
        if abs(found.at_one) < FAMILY:
            self.degenerate += 1
            return False
        self.marks.setdefault(n, []).append(mark)
        theta = np.mod(x + pi, 2 * pi) - pi if len(self.table.components) == 1 else x
        self.cycles.append(
            Found(components, tuple(map(float, theta)), tuple(map(float, phi)), found, _winding(self.table, x))
        )
        return True

    def resolution(self, n: int) -> str:
        """What the search cannot tell apart at a period, in a sentence.

        Two cycles of opposite index that are born at a fold leave every index sum as it is, so that sums vanish is
        no sign that such a pair was not missed.
        """
        return (
            f"cycles of period {n} nearer than about {SAME * n:.0e} radians count as one, and a cycle with "
            f"|det(M - 1)| < {FAMILY:.0e} as none: a pair so near its fold is "
            "missed, and the index sums vanish without it"
        )

    def of(self, n: int) -> Iterator[Found]:
        """The cycles whose bounces are fixed points of `T**n`."""
        return (cycle for cycle in self.cycles if n % cycle.period == 0)

    def rows(self, n: int) -> Array:
        """The cycles that close after `n` bounces, a row of parameters for each bounce they can be begun with."""
        rows = [np.roll(np.tile(c.theta, n // c.period), -k) for c in self.of(n) for k in range(c.period)]
        return np.array(rows).reshape(len(rows), n)

    def count(self, n: int) -> int:
        """The number of cycles of minimal period `n`."""
        return sum(1 for cycle in self.cycles if cycle.period == n)

    def index_sums(self, n: int) -> dict[int, int]:
        """The sum of the indices of the fixed points of `T**n`, for each number of turns around the boundary.

        On a smooth convex table `T` maps the closed annulus of phase points into itself, with degree 1, so
        by Lefschetz every sum is 0: saddles and the other cycles come in equal numbers in each class.
        """
        sums: dict[int, int] = {}
        for cycle in self.of(n):
            turns = cycle.winding * (n // cycle.period)
            sums[turns] = sums.get(turns, 0) + cycle.period * cycle.index(n)
        return sums


def _minimal(components: tuple[int, ...], x: Array, phi: Array) -> tuple[tuple[int, ...], Array, Array]:
    n = len(x)
    for m in (m for m in range(1, n) if n % m == 0):
        same = components == components[m:] + components[:m]
        away = np.abs(np.sin((np.roll(x, -m) - x) / 2)) + np.abs(np.roll(phi, -m) - phi)
        if same and np.max(away) < 1e-6:
            return components[:m], x[:m], phi[:m]
    return components, x, phi


def _mark(components: tuple[int, ...], x: Array, phi: Array) -> Array:
    """Numbers that do not depend on where the cycle is begun, and tell cycles apart."""
    parts, forth = np.array(components), np.roll(x, -1)
    of_place = [np.sum(np.cos(m * x + 0.4) + np.sin(0.7 + m * parts)) for m in (1, 2, 3, 4, 5, 7)]  # symmetric cycles
    of_angle = [np.sum(np.sin(m * phi + 0.3)) for m in (1, 2)]  # cancel all sums but those of their own order
    of_order = [np.sum(np.sin(forth - x)), np.sum(np.cos(x - 0.3) * np.sin(phi)), np.sum(np.cos(x) * np.cos(2 * forth))]
    return np.array([*of_place, *of_angle, *of_order])


def _winding(table: Table, x: Array) -> int:
    """Turns around the boundary in one period, each chord counted by the boundary to its right."""
    if len(table.components) > 1:
        return 0
    return round(float(np.sum(np.mod(np.roll(x, -1) - x, 2 * pi))) / (2 * pi))


PARTICLES = 4000  # starts of a round
NEAR = 1.2  # radians between a bounce and its return, at most, for a seed
SEEDS = 1200  # of one period and round
DEFLATED = 200  # known rows beyond which deflation costs more than further rounds
QUIET = 3  # rounds without news before the search rests
ROUNDS = 40
Tick = Callable[[str], None]
Orbits = tuple[NDArray[np.int64], Array, Array]


@dataclass(frozen=True)
class Searched:
    """The catalogue, the rounds it took, and whether the index sums vanish (None: no such law here)."""

    catalogue: Catalogue
    longest: int
    rounds: int
    balanced: dict[int, bool | None]


def all_cycles(
    table: Table, lam: Expr, longest: int, seed: int = 1, tick: Tick = lambda said: None, law: Law = PAPERS_LAW
) -> Searched:
    """The cycles of periods 2 to `longest`.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> found = all_cycles(ellipse.at(a="3/2"), Rational(1, 2), 4)
    >>> sorted((cycle.period, cycle.spectrum.stable) for cycle in found.catalogue.cycles)
    [(2, False), (2, True)]
    """
    map = PinballMap(table, lam=float(lam), law=law)
    corrector = Corrector(table, float(lam), law)
    catalogue = Catalogue(table, float(lam), law=law)
    whole = convex(table) is True and (lam != 1 if law.uniform else _inside(law, lam))
    quiet = dict.fromkeys(range(2, longest + 1), 0)
    rng = np.random.default_rng(seed)
    rounds = 0
    while rounds < ROUNDS and any(
        quiet[n] < QUIET or (whole and rounds < ROUNDS // 2 and any(catalogue.index_sums(n).values())) for n in quiet
    ):
        parts, theta, phi = _orbits(map, rng, 2 * longest)
        for n in quiet:
            if quiet[n] >= QUIET and not (whole and any(catalogue.index_sums(n).values())):
                continue
            news = _harvest(map, corrector, catalogue, rng, (parts, theta, phi), n, deflated=quiet[n] > 0)
            quiet[n] = 0 if news else quiet[n] + 1
        rounds += 1
        tick(f"{len(catalogue.cycles)} cycles")
    catalogue.cycles.sort(key=lambda cycle: (cycle.period, cycle.winding, cycle.theta))
    sums = whole and not catalogue.degenerate
    balanced = {n: (not any(catalogue.index_sums(n).values())) if sums else None for n in quiet}
    return Searched(catalogue, longest, rounds, balanced)


def _inside(law: Law, lam: Expr) -> bool:
    """Does the law lead away from the wall also where the incidence is grazing, the same everywhere?

    Then the closed annulus of phase points is mapped into its own interior, as by a contraction below 1.
    """
    ends = [law.phi.subs({contraction: lam, angle: end * half_turn / 2}) for end in (-1, 1)]
    return not law.placed and all(abs(float(end)) < pi / 2 - SAME for end in ends)


def _orbits(map: PinballMap, rng: np.random.Generator, bounces: int) -> Orbits:
    """Components, parameters and exit angles; bounces along the first axis, particles that stopped left out."""
    ends = np.array(map.states.ends)
    parts = rng.integers(0, len(ends), PARTICLES)
    theta = ends[parts, 0] + (ends[parts, 1] - ends[parts, 0]) * rng.uniform(0, 1, PARTICLES)
    phi = elementary.arcsin(rng.uniform(-0.999, 0.999, PARTICLES))
    orbit = map.orbit(theta, phi, bounces, parts)
    alive = np.all(orbit.code == 0, axis=0)
    return orbit.component[1:, alive], orbit.theta[1:, alive], orbit.phi[1:, alive]


def _harvest(
    map: PinballMap,
    corrector: Corrector,
    catalogue: Catalogue,
    rng: np.random.Generator,
    orbits: Orbits,
    n: int,
    deflated: bool,
) -> int:
    """The number of new cycles that segments of `n` bounces lead to; `deflated`, away from those already known."""
    parts, theta, phi = orbits
    starts = theta.shape[0] - n
    gap = np.abs(np.sin((theta[n:] - theta[:starts]) / 2)) * 2
    gap = gap + np.abs(phi[n:] - phi[:starts]) + 10.0 * (parts[n:] != parts[:starts])
    begin, particle = np.nonzero(gap < NEAR)
    if len(begin) > SEEDS:
        chosen = rng.choice(len(begin), SEEDS, replace=False)
        begin, particle = begin[chosen], particle[chosen]
    rows = begin[:, None] + np.arange(n)
    seeds, visited = theta[rows, particle[:, None]], parts[rows, particle[:, None]]
    before = len(catalogue.cycles)
    known = catalogue.rows(n) if deflated and len(catalogue.table.components) == 1 else None
    if known is not None and len(known) > DEFLATED:
        known = None
    for itinerary in sorted({tuple(int(c) for c in row) for row in visited}):
        own = np.all(visited == np.array(itinerary), axis=1)
        closed = corrector.closed(itinerary, seeds[own], known)
        for x, out in _admitted(map, itinerary, closed, corrector):
            _file(catalogue, itinerary, x, out)
    return len(catalogue.cycles) - before


def _admitted(
    map: PinballMap, itinerary: tuple[int, ...], closed: Array, corrector: Corrector
) -> list[tuple[Array, Array]]:
    """The rows whose chords the ball really takes: the map itself carries each bounce to the next."""
    if not len(closed):
        return []
    out = corrector.exits(itinerary, closed)
    ends = np.array(map.states.ends)[list(itinerary)]
    one = len(map.states.ends) == 1
    x = np.mod(closed + pi, 2 * pi) - pi if one else closed
    fine = np.all(np.abs(out) < pi / 2 - 1e-9, axis=1) & np.all((x >= ends[:, 0]) & (x <= ends[:, 1]), axis=1)
    apart = np.abs(np.sin((np.roll(x, -1, axis=1) - x) / 2))
    fine &= np.all((apart > 1e-7) | (np.array(itinerary) != np.roll(itinerary, -1)), axis=1)
    x, out = x[fine], out[fine]
    if not len(x):
        return []
    landed = map.step(x, out, np.broadcast_to(np.array(itinerary), x.shape))
    gap = np.abs(np.sin((landed.theta - np.roll(x, -1, axis=1)) / 2))
    right = np.all((gap < 1e-6) & (landed.component == np.roll(itinerary, -1)), axis=1)
    return list(zip(x[right], out[right], strict=True))


def _file(catalogue: Catalogue, itinerary: tuple[int, ...], x: Array, out: Array) -> None:
    """A cycle and its images under the symmetries of the table."""
    if not catalogue.add(itinerary, x, out):
        return
    for g in symmetries(catalogue.table, catalogue.law):
        if len(catalogue.table.components) == 1 or g == MIRROR:
            catalogue.add(itinerary, g.carried(x, g.radians, 1), g.turn * out)
