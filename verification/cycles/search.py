"""The search for all cycles up to a period: orbits that almost close are closed by Newton's method and listed once.

Starts are spread over the phase space; segments of their orbits that come back near where they began are the seeds,
whether near the start, where unstable cycles still show, or on attractors. A round without new cycles is followed by
one with the known cycles deflated. Rounds go on until several in a row bring nothing new and, on a convex table, the
index sums vanish. Each cycle found is listed once, whichever bounce comes first, and its images under the table's
symmetries are added. A search finds cycles and does not prove that it found all;
`verification.proofs.periodic.interval_newton` does.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import islice
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, S
from sympy import pi as half_turn

from numeric import PinballMap
from numeric.backends import elementary
from symbolic.expressions.text import kernel, load
from symbolic.tables.curves import curves
from symbolic.tables.joins import contacts, following
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from symbolic.tables.table import eta as angle
from symbolic.tables.table import lam as contraction
from symbolic.tables.table import theta as place
from verification.arithmetic.balls import FLOAT64, multiprecision
from verification.cycles.cells import Corrector, CycleType, MonodromyDeterminants, radians, spectrum
from verification.cycles.chain import trace_and_determinant
from verification.cycles.chords import Chords
from verification.cycles.newton import refined
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import MIRROR, Array
from verification.cycles.systems import symmetries
from verification.maps.first_hit import closes_smoothly, convex
from verification.maps.joins import joins
from verification.maps.one_sided import Matrix, OneSided, at_one, of_rows, verdict, words

SAME = 1e-7
REPEATS = 1e-6  # largest difference between equal bounces
FAMILY = 1e-7  # a cycle with |det(M - 1)| below this is one of a family, or at a bifurcation
NEAR_TWO = 1e-3  # from 2 of a |trace|: float64 may not decide the type of such an elastic cycle
DIGITS = 30  # in which its trace is then computed
PARABOLIC = 1e-20  # from 2 of that |trace|: so near, the cycle is parabolic


@dataclass(frozen=True)
class Found:
    """A cycle of minimal period, its multipliers, and the number of turns around the boundary (`winding`)."""

    components: tuple[int, ...]
    theta: tuple[float, ...]
    phi: tuple[float, ...]
    spectrum: MonodromyDeterminants
    winding: int
    stability: CycleType
    length: float  # sum over all its chords
    one_sided: OneSided | None = None  # the verdict of all sides, where a bounce lies on a join with a curvature jump
    derivatives: tuple[Matrix, ...] = ()  # there, one for each choice of sides

    @property
    def period(self) -> int:
        """The number of bounces."""
        return len(self.theta)

    def index(self, n: int) -> int | None:
        """Fixed-point index of `T**n` at a bounce: sign of `det(1 - M**(n/period))`; None if one-sided `M` disagree."""
        one, two = self.spectrum.multipliers
        power = n // self.period
        if self.one_sided:
            products = next(islice(words(self.derivatives), power - 1, None), [])
            signs = {int(np.sign(at_one(m))) for m in products}
            return signs.pop() if len(signs) == 1 else None
        if power == 1:
            return int(np.sign(self.spectrum.at_one))
        return int(np.sign(((1 - one**power) * (1 - two**power)).real))


@dataclass
class Catalogue:
    """The cycles found so far at one contraction; those with the multiplier 1 are counted (`degenerate`) but not
    listed.

    For an elastic law, which preserves areas, the trace alone gives the type: parabolic where its modulus is 2 up to
    1e-20, from numbers of thirty digits. Images under a symmetry, and the cycle run backwards, share one trace.
    """

    table: Table
    lam: float
    cycles: list[Found] = field(default_factory=list)
    marks: dict[int, list[Array]] = field(default_factory=dict)
    degenerate: int = 0
    law: Law = PAPERS_LAW
    elastic: bool = False

    @property
    def scale(self) -> float:
        """Radians per unit of the boundary's parameter, where cycles are compared."""
        return radians(self.table)

    def add(
        self, components: tuple[int, ...], x: Array, phi: Array, known: MonodromyDeterminants | None = None
    ) -> bool:
        """Adds a cycle; False if it is listed already, repeats a listed one, or has the multiplier 1.

        `known` are the multipliers of a cycle of which this one is an image.
        """
        n = int(_least_periods(components, self.scale * x[None], phi[None])[0])
        components, x, phi = components[:n], x[:n], phi[:n]
        mark = _marks(components, self.scale * x, phi)
        if self._known(n, mark[None])[0]:
            return False
        several = joins(self.table).sides(components, x) if len(self.table.components) > 1 else [(components, x)]
        spectra = [self._spectrum(*side) for side in several] if known is None else [known]
        if any(abs(one.at_one) < FAMILY for one in spectra):
            self.degenerate += 1
            return False
        if self.elastic and known is None:
            spectra = [self._of_determinant_one(*side, one.trace) for side, one in zip(several, spectra, strict=True)]
        self.marks.setdefault(n, []).append(mark)
        stability, sides = CycleType.of(spectra[0].multipliers, self.elastic), None
        derivatives: tuple[Matrix, ...] = ()
        if len(several) > 1:
            derivatives = tuple(self._derivative(components, *side) for side in several)
            kinds = {CycleType.of(one.multipliers, self.elastic) for one in spectra}
            sides = OneSided.OPEN if self.elastic else verdict(derivatives)
            stability = stability if self.elastic and len(kinds) == 1 else CycleType(sides.stability)
        at = tuple(map(float, _wrapped(self.table, x))), tuple(map(float, phi))
        turns, size = _winding(self.table, components, x), length(self.table, components, x)
        self.cycles.append(Found(components, *at, spectra[0], turns, stability, size, sides, derivatives))
        return True

    def unknown(self, components: tuple[int, ...], x: Array, phi: Array) -> NDArray[np.bool_]:
        """For each row of bounces, whether its cycle is not in the catalogue."""
        at = self.scale * x
        periods, new = _least_periods(components, at, phi), np.ones(len(x), dtype=bool)
        for n in np.unique(periods).tolist():
            own = periods == n
            new[own] = np.logical_not(self._known(n, _marks(components[:n], at[own, :n], phi[own, :n])))
        return new

    def _known(self, n: int, marks: Array) -> NDArray[np.bool_]:
        """For each row of marks, whether the catalogue has a cycle of minimal period `n` with these marks."""
        if not (filed := self.marks.get(n)):
            return np.zeros(len(marks), dtype=bool)
        found: NDArray[np.bool_] = np.any(np.max(np.abs(marks[:, None] - np.array(filed)), axis=2) < SAME * n, axis=1)
        return found

    def _spectrum(self, components: tuple[int, ...], x: Array) -> MonodromyDeterminants:
        ring = Chords(self.table, components, law=self.law)
        return spectrum(ring.terms(x, {"lam": self.lam}, 1), ring.closure)

    def _derivative(self, components: tuple[int, ...], parts: tuple[int, ...], x: Array) -> Matrix:
        """Derivative of the return map for a cycle on joins, if its bounces are assigned to the components `parts`."""
        terms = Chords(self.table, parts, law=self.law).terms(x, {"lam": self.lam}, 1)
        return of_rows(terms.listed().rows, joins(self.table).slopes(components, parts))

    def _of_determinant_one(self, components: tuple[int, ...], x: Array, trace: float) -> MonodromyDeterminants:
        """The spectrum of an elastic cycle from its trace, which is computed to thirty digits near 2 or -2."""
        if abs(abs(trace) - 2) < NEAR_TWO:
            problem = Problem(self.table, components, lam=S.One)  # whatever the formula of an elastic law
            solution = refined(problem, list(map(float, x)), DIGITS)
            arithmetic = multiprecision(type(solution.z[0]).context)
            exact, _ = trace_and_determinant(Linearised(problem, arithmetic, solution.z).terms.rows)
            gaps = [0.0 if abs(gap) < PARABOLIC else float(gap) for gap in (2 - exact, 2 + exact)]
            return MonodromyDeterminants(gaps[0], gaps[1], 1.0)
        return MonodromyDeterminants(2 - trace, 2 + trace, 1.0)

    def resolution(self, n: int) -> str:
        """A sentence on the cycles that the search cannot tell apart at a period.

        Two cycles of opposite index that are born at a fold leave every index sum as it is, so vanishing sums do not
        exclude that such a pair was missed.
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
        """The cycles that close after `n` bounces: a row of parameters for each cycle and choice of first bounce."""
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
            sums[turns] = sums.get(turns, 0) + cycle.period * (cycle.index(n) or 0)
        return sums


def _wrapped(table: Table, x: Array) -> Array:
    """Parameters; those of a single component less the whole turns by which they are outside of its range."""
    low, turn = float(table.components[0].start), 2 * pi / radians(table)
    return np.asarray(low + np.mod(x - low, turn)) if len(table.components) == 1 else x


def _least_periods(components: tuple[int, ...], x: Array, phi: Array) -> NDArray[np.int64]:
    """The minimal period of each row of bounces at the angles `x`."""
    n = len(components)
    periods = np.full(len(x), n)
    for m in (m for m in range(n - 1, 0, -1) if n % m == 0 and components == components[m:] + components[:m]):
        away = np.abs(np.sin((np.roll(x, -m, axis=1) - x) / 2)) + np.abs(np.roll(phi, -m, axis=1) - phi)
        periods[np.max(away, axis=1) < REPEATS] = m
    return periods


def _marks(components: tuple[int, ...], x: Array, phi: Array) -> Array:
    """Numbers that tell cycles apart and do not depend on the first bounce; one cycle, or a row of angles `x` each."""
    parts, forth = np.array(components), np.roll(x, -1, axis=-1)
    terms = [np.cos(m * x + 0.4) + np.sin(0.7 + m * parts) for m in (1, 2, 3, 4, 5, 7)]  # symmetric cycles cancel all
    terms += [np.sin(m * phi + 0.3) for m in (1, 2)]  # sums but those of their own order
    terms += [np.sin(forth - x), np.cos(x - 0.3) * np.sin(phi), np.cos(x) * np.cos(2 * forth)]
    return np.stack([np.sum(term, axis=-1) for term in terms], axis=-1)


def length(table: Table, components: Sequence[int], x: Array) -> float:
    """The length of the closed polygon through the bounces.

    >>> from symbolic.tables import ellipse
    >>> length(ellipse.at(a=2), (0, 0), np.array([0.0, pi]))
    8.0
    """
    points = np.array([_point(table, part)(float(at)) for part, at in zip(components, x, strict=True)])
    return float(np.sum(np.hypot(*(np.roll(points, -1, axis=0) - points).T)))


@cache
def _point(table: Table, part: int) -> Callable[..., Any]:
    x, y = table.components[part].point
    return load(kernel("point", [place], {"x": x, "y": y}), FLOAT64)


def _winding(table: Table, components: Sequence[int], x: Array) -> int:
    """Turns around the boundary in one period; a chord counts as the arc to its right. 0 if the table has holes."""
    if len(curves(table)) > 1:
        return 0
    parts = [table.components[i] for i in components]
    start, end = np.array([(float(part.start), float(part.end)) for part in parts]).T
    turns = (np.asarray(components) + (x - start) / (end - start)) / len(table.components)
    return round(float(np.sum(np.mod(np.roll(turns, -1) - turns, 1))))


PARTICLES = 4000  # starts of a round
NEAR = 1.2  # radians between a bounce and its return, at most, for a seed
SEEDS = 1200  # at most, for one period and round
DEFLATED = 200  # known rows beyond which deflation costs more than further rounds
QUIET = 3  # rounds without new cycles before the search ends
ROUNDS = 40
Tick = Callable[[str], None]
Orbits = tuple[NDArray[np.int64], Array, Array]


@dataclass(frozen=True)
class Searched:
    """Catalogue, the rounds of search, and for each period whether the index sums vanish (None if they need not)."""

    catalogue: Catalogue
    longest: int
    rounds: int
    balanced: dict[int, bool | None]


def all_cycles(
    table: Table, lam: Expr, longest: int, seed: int = 1, tick: Tick = lambda said: None, law: Law = PAPERS_LAW
) -> Searched:
    """The catalogue of cycles of periods 2 to `longest`, found by search.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> found = all_cycles(ellipse.at(a="3/2"), Rational(1, 2), 4)
    >>> sorted((cycle.period, cycle.spectrum.stable) for cycle in found.catalogue.cycles)
    [(2, False), (2, True)]
    """
    map = PinballMap(table, lam=float(lam), law=law)
    corrector = Corrector(table, float(lam), law)
    catalogue = Catalogue(table, float(lam), law=law, elastic=law.elastic(lam))
    continuous = all(contact.smooth for contact in contacts(table))
    whole = continuous and convex(table) is True and (lam != 1 if law.uniform else _inside(law, lam))
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
    known = {n: sums and all(cycle.index(n) is not None for cycle in catalogue.of(n)) for n in quiet}
    balanced = {n: _even(catalogue, n) if known[n] else None for n in quiet}
    return Searched(catalogue, longest, rounds, balanced)


def _even(catalogue: Catalogue, n: int) -> bool:
    """Do the index sums vanish, and are there at least two double normals, as every smooth convex curve has?"""
    normals = catalogue.count(2) if n % 2 == 0 and catalogue.law.uniform else 2
    return normals >= 2 and not any(catalogue.index_sums(n).values())


def _inside(law: Law, lam: Expr) -> bool:
    """Is the law the same along the whole boundary, and its exit angle below pi/2 even at grazing incidence?

    Then the closed annulus of phase points is mapped into its own interior, as by a contraction below 1.
    """
    ends = [law.phi.subs({contraction: lam, angle: end * half_turn / 2}) for end in (-1, 1)]
    return not law.placed and all(abs(float(end)) < pi / 2 - SAME for end in ends)


def _orbits(map: PinballMap, rng: np.random.Generator, bounces: int) -> Orbits:
    """Components, parameters and exit angles of random orbits that do not stop, with bounces along the first axis."""
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
    """Adds cycles found from orbit segments of `n` bounces, away from known ones if `deflated`; returns how many."""
    parts, theta, phi = orbits
    starts = theta.shape[0] - n
    gap = np.abs(np.sin(catalogue.scale * (theta[n:] - theta[:starts]) / 2)) * 2
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
    for itinerary in [tuple(row) for row in np.unique(visited, axis=0).tolist()]:
        own = np.all(visited == np.array(itinerary), axis=1)
        for components, closed in _placed(corrector, itinerary, corrector.closed(itinerary, seeds[own], known)):
            x, out = _isolated(catalogue, corrector, components, *_admitted(map, components, closed, corrector))
            while np.any(new := catalogue.unknown(components, x, out)):
                first, met = int(np.argmax(new)), catalogue.degenerate
                _file(catalogue, components, x[first], out[first])
                marks = _marks(components, catalogue.scale * x[first:], out[first:])
                x, out = x[first + 1 :], out[first + 1 :]
                if catalogue.degenerate > met:  # and so are its copies
                    other = np.max(np.abs(marks[1:] - marks[0]), axis=1) >= SAME * n
                    catalogue.degenerate += int(np.sum(~other))
                    x, out = x[other], out[other]
    return len(catalogue.cycles) - before


def _isolated(
    catalogue: Catalogue, corrector: Corrector, components: tuple[int, ...], x: Array, out: Array
) -> tuple[Array, Array]:
    """The rows whose cycles do not have the multiplier 1; the catalogue counts those that do."""
    periods = _least_periods(components, catalogue.scale * x, out)
    family = np.zeros(len(x), dtype=bool)
    for n in np.unique(periods).tolist():
        own = periods == n
        family[own] = corrector.at_one(components[:n], x[own, :n]) < FAMILY
    catalogue.degenerate += int(np.sum(family))
    return x[~family], out[~family]


def _placed(corrector: Corrector, itinerary: tuple[int, ...], rows: Array) -> Iterator[tuple[tuple[int, ...], Array]]:
    """Rows grouped by the components on which their bounces lie; Newton's method may have moved bounces over joins."""
    if closes_smoothly(corrector.table) or corrector.law.placed or not len(rows):
        yield itinerary, rows
        return
    parts, x = joins(corrector.table).canonical(np.array(itinerary), rows)
    for components in sorted({*map(tuple, parts.tolist())}):
        yield components, x[np.all(parts == np.array(components), axis=1)]


def _admitted(map: PinballMap, itinerary: tuple[int, ...], closed: Array, corrector: Corrector) -> tuple[Array, Array]:
    """The rows for which the map carries each bounce to the next, so that they are cycles; and their exit angles."""
    if not len(closed):
        return closed, closed
    out = corrector.exits(itinerary, closed)
    ends = np.array(map.states.ends)[list(itinerary)]
    one, half = len(map.states.ends) == 1, radians(corrector.table) / 2
    x = _wrapped(corrector.table, closed)
    fine = np.all(np.abs(out) < pi / 2 - 1e-9, axis=1) & np.all((x >= ends[:, 0]) & (x <= ends[:, 1]), axis=1)
    apart = np.abs(np.sin((np.roll(x, -1, axis=1) - x) * half))
    fine &= np.all((apart > 1e-7) | (np.array(itinerary) != np.roll(itinerary, -1)), axis=1)
    for part, sharp in no_tangent(corrector.table):
        gap = x[:, np.array(itinerary) == part] - sharp
        fine &= np.all(np.abs(2 * np.sin(gap * half) if one else gap) > SAME, axis=1)
    x, out = x[fine], out[fine]
    if not len(x):
        return x, out
    landed, after = map.step(x, out, np.broadcast_to(np.array(itinerary), x.shape)), np.roll(x, -1, axis=1)
    known = joins(corrector.table)
    where, theta = known.canonical(landed.component, landed.theta) if not one else (landed.component, landed.theta)
    hits = (np.abs(np.sin((theta - after) * half)) < 1e-6) & (where == np.roll(itinerary, -1))
    if convex(corrector.table) is True:  # where all chords are free
        hits |= np.array([known.on_smooth(p, at) for p, at in zip(np.roll(itinerary, -1), after.T, strict=True)]).T
    if corrector.law.placed:  # which may be another one where a bounce was moved to
        hits &= np.abs(landed.phi - np.roll(out, -1, axis=1)) < 1e-6
    right = np.all(hits, axis=1)
    return x[right], out[right]


@cache
def no_tangent(table: Table) -> tuple[tuple[int, float], ...]:
    """Components and parameters of cusps and corners, where the chord rule may vanish without a bounce.

    >>> from symbolic.tables import cardioid
    >>> no_tangent(cardioid)
    ((0, 3.141592653589793), (0, 3.141592653589793), (0, -3.141592653589793))
    """
    found = [(mark.component, mark.theta) for mark in table.undefined]
    parts = table.components
    for i, (after, contact) in enumerate(zip(following(table), contacts(table), strict=True)):
        if not contact.smooth:
            found += [(i, parts[i].end), (after, parts[after].start)]
    return tuple((part, float(at)) for part, at in found)


def _file(catalogue: Catalogue, itinerary: tuple[int, ...], x: Array, out: Array) -> None:
    """Adds a cycle and its images under the table's symmetries; for an elastic law, also each run backwards."""
    if not catalogue.add(itinerary, x, out):
        return
    known = catalogue.cycles[-1].spectrum
    images = [(x, out)]
    for g in symmetries(catalogue.table, catalogue.law):
        if len(catalogue.table.components) == 1 or g == MIRROR:
            images.append((g.carried(x, g.radians, 1), g.turn * out))
    for image, exits in images:
        catalogue.add(itinerary, image, exits, known)
        if catalogue.elastic:
            catalogue.add(itinerary[::-1], image[::-1], -exits[::-1], known)
