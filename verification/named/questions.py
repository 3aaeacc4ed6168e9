"""Questions on a scene, one function each: cycles, their branches, their proofs, trapping regions, Morse graphs.

`table` is a scene, a table, a map of `numeric` or the name of a table; `lam`, `law` and the numbers of the shape are
keywords. Numbers are exact, as text or fractions: `"1/10"`, `"0.1"`. Floats are refused: they differ from their
decimals.

>>> from symbolic import Scene, tables
>>> egg = Scene(tables.egg(3), alpha="2/25", lam="1/2")
>>> triangle = find_cycles(egg, period=3).stable[0]
>>> branch = follow(triangle, lam=("0.37", "1"))
>>> certify(branch.folds[0], digits=20).value
'0.378121252590090235753'
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

from numeric.pinball.states import ComparedByValues
from symbolic.tables.definition import exact, like
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene, as_scene
from verification.arithmetic.iteration import silent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from verification.cycles.branch import Branch, Event
    from verification.cycles.cells import CycleType
    from verification.cycles.chords import Chords
    from verification.cycles.search import Found, Searched
    from verification.maps.one_sided import OneSided
    from verification.named.locate import Located
    from verification.proofs.global_dynamics.images import PinballImages
    from verification.proofs.global_dynamics.regions import Region
    from verification.proofs.periodic.cycle_in_box import UniqueCycle
    from verification.rigorous.graph import MorseGraph

SHOWN = 12  # rows of a table in a notebook
Tick = Callable[[str], None]


@dataclass(frozen=True)
class PeriodicOrbit:
    """A cycle of minimal period in a scene: its bounces, in radians, and its multipliers, the larger one first.

    If a bounce lies on a join at which the curvature jumps, the multipliers use the component that begins
    there, and `one_sided` has what the derivatives on all sides imply, in float64.
    """

    scene: Scene
    components: tuple[int, ...]
    theta: tuple[float, ...]
    phi: tuple[float, ...]
    multipliers: tuple[complex, complex]
    one_sided: "OneSided | None" = None

    @property
    def period(self) -> int:
        """The number of bounces."""
        return len(self.theta)

    @property
    def stability(self) -> "CycleType":
        """`STABLE` or `UNSTABLE`; for an elastic law `ELLIPTIC`, `HYPERBOLIC` or `PARABOLIC`.

        Where the curvature jumps at a bounce, `UNDECIDED` unless all one-sided derivatives together decide.
        """
        from verification.cycles.cells import CycleType

        if self.one_sided:
            return CycleType(self.one_sided.stability)
        return CycleType.of(self.multipliers, self.scene.law.elastic(self.scene.lam))

    @property
    def stable(self) -> bool:
        """True if both multipliers lie inside the unit circle, in float64; always False where areas are preserved."""
        return self.stability.value == "stable"

    def plot(self, axes: "Axes | None" = None) -> "Figure":
        """A Matplotlib figure of the cycle in the table and in phase space; on given `axes` only in the table."""
        from numeric import PinballMap

        orbit = PinballMap(self.scene).orbit(self.theta[0], self.phi[0], self.period, self.components[0])
        made: Figure = orbit.plot(axes)
        return made

    def __repr__(self) -> str:
        mu = ", ".join(short(m, 5) for m in self.multipliers)
        kind = self.stability.value
        side = "one-sided " if self.one_sided else ""
        return f"PeriodicOrbit(period {self.period}, {kind}, {side}multipliers {mu}, theta[0] = {self.theta[0]:.6g})"


def short(multiplier: complex, digits: int) -> str:
    """A multiplier as text, without the imaginary part where that is 0."""
    return f"{multiplier.real if multiplier.imag == 0 else multiplier:.{digits}g}"


class PeriodicOrbits(Sequence[PeriodicOrbit]):
    """A sequence of different cycles, sorted by period; `.stable`, `.unstable` and `.of(period)` select some."""

    def __init__(self, orbits: Iterable[PeriodicOrbit], searched: "Searched | None" = None) -> None:
        self.orbits = tuple(orbits)
        self.searched = searched

    @overload
    def __getitem__(self, index: int) -> PeriodicOrbit: ...
    @overload
    def __getitem__(self, index: slice) -> "PeriodicOrbits": ...
    def __getitem__(self, index: int | slice) -> "PeriodicOrbit | PeriodicOrbits":
        return PeriodicOrbits(self.orbits[index]) if isinstance(index, slice) else self.orbits[index]

    def __len__(self) -> int:
        return len(self.orbits)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PeriodicOrbits) and self.orbits == other.orbits

    def __hash__(self) -> int:
        return hash(self.orbits)

    def __iter__(self) -> Iterator[PeriodicOrbit]:
        return iter(self.orbits)

    @property
    def stable(self) -> "PeriodicOrbits":
        """The cycles whose multipliers both lie inside the unit circle."""
        return PeriodicOrbits(orbit for orbit in self.orbits if orbit.stable)

    @property
    def unstable(self) -> "PeriodicOrbits":
        """The cycles that are not stable."""
        return PeriodicOrbits(orbit for orbit in self.orbits if not orbit.stable)

    def of(self, period: int) -> "PeriodicOrbits":
        """The cycles of one minimal period."""
        return PeriodicOrbits(orbit for orbit in self.orbits if orbit.period == period)

    def __repr__(self) -> str:
        return f"PeriodicOrbits({len(self)}: {len(self.stable)} stable)"

    def _repr_html_(self) -> str:
        from numeric.pinball.states import html_table

        rows = [
            (o.period, o.stability.value, *(short(mu, 6) for mu in o.multipliers), f"{o.theta[0]:.9f}")
            for o in self.orbits[:SHOWN]
        ]
        more = f"<p>and {len(self) - SHOWN} more</p>" if len(self) > SHOWN else ""
        return html_table(("period", "stability", "multiplier", "second multiplier", "first bounce"), rows) + more


def find_cycles(
    table: Any,
    *,
    period: int | None = None,
    up_to: int | None = None,
    seed: int = 1,
    tick: Tick | None = None,
    lam: Any = None,
    law: Law | str | None = None,
    **shape: Any,
) -> PeriodicOrbits:
    """The cycles of one minimal period, or of all periods up to `up_to`, found by a search in float64.

    A search does not prove that it found all cycles; `pinball cycles --prove` does, for small periods.

    >>> find_cycles("ellipse", a="3/2", lam="1/2", period=2)
    PeriodicOrbits(2: 1 stable)
    """
    from verification.cycles.search import all_cycles

    scene = as_scene(table, lam=lam, law=law, **shape)
    if (period is None) == (up_to is None):
        raise ValueError("find_cycles: give one of period=N and up_to=N")
    longest = period if period is not None else up_to
    if isinstance(longest, bool) or not isinstance(longest, int) or longest < 2:
        raise ValueError(f"find_cycles: {longest!r} is no period; accepted: integers from 2")
    from sympy import S

    found = all_cycles(scene.table, S(scene.lam), longest, seed, tick or silent, scene.law)
    made = (_orbit(scene, cycle) for cycle in found.catalogue.cycles if period in (None, cycle.period))
    return PeriodicOrbits(made, found)


def _orbit(scene: Scene, cycle: "Found") -> PeriodicOrbit:
    one, two = sorted(cycle.spectrum.multipliers, key=lambda mu: -abs(mu))
    return PeriodicOrbit(scene, cycle.components, cycle.theta, cycle.phi, (complex(one), complex(two)), cycle.one_sided)


@dataclass(frozen=True, eq=False)
class FollowedOrbit(ComparedByValues):
    """A branch of cycles in one parameter, with its events; properties such as `.folds` and `.flips` select some."""

    orbit: PeriodicOrbit
    parameter: str
    branch: "Branch" = field(repr=False)

    @cached_property
    def events(self) -> "tuple[BranchEvent, ...]":
        """All events, in their order along the branch."""
        return tuple(BranchEvent(self.orbit, self.parameter, event) for event in self.branch.events)

    @property
    def folds(self) -> "tuple[BranchEvent, ...]":
        """The saddle-node bifurcations, where the branch turns."""
        return self._of("fold")

    @property
    def flips(self) -> "tuple[BranchEvent, ...]":
        """The period doublings."""
        return self._of("period doubling")

    @property
    def pitchforks(self) -> "tuple[BranchEvent, ...]":
        """The pitchforks, where a symmetric cycle loses its symmetry."""
        return self._of("pitchfork")

    @property
    def border_collisions(self) -> "tuple[BranchEvent, ...]":
        """The border collisions, where a bounce meets a join of the boundary."""
        return self._of("border collision")

    def plot(self, axes: "Axes | None" = None) -> "Figure":
        """A Matplotlib figure of the bounces along the branch, dashed where unstable, with its events.

        It is new, or that of the given `axes`; `branch.plot().savefig("branch.png")` writes it.
        """
        from numeric.pinball.states import plotted

        made: Figure = plotted("dynamics.plotted", (self.branch,), None, axes=axes)
        return made

    def _of(self, kind: str) -> "tuple[BranchEvent, ...]":
        return tuple(event for event in self.events if event.kind == kind)

    def __repr__(self) -> str:
        met = [*self.branch.values, *(event.value for event in self.events)]  # a fold lies beyond all points
        ends = f"{min(met):.6g} to {max(met):.6g}"
        events = ", ".join(f"{event.kind} at {event.value:.9g}" for event in self.events) or "no event"
        return f"FollowedOrbit(period {self.orbit.period}, {self.parameter} from {ends}: {events})"


@dataclass(frozen=True, eq=False, repr=False)
class BranchEvent(ComparedByValues):
    """An event on a branch, at a parameter value in float64; `certify` gives more digits and a proof."""

    orbit: PeriodicOrbit
    parameter: str
    event: "Event" = field(repr=False)

    @property
    def kind(self) -> str:
        """The name of the bifurcation: `fold`, `period doubling`, `pitchfork`, `border collision` and so on."""
        return self.event.kind.value

    @property
    def value(self) -> float:
        """The value of the parameter."""
        return self.event.value

    @property
    def collision(self) -> str:
        """The fate of the cycle at a border collision on a smooth join: persistence or nonsmooth fold; else ''."""
        return self.event.collision.value if self.event.collision else ""

    @property
    def supercritical(self) -> bool | None:
        """True if the bifurcation is supercritical: the new cycle is stable where the old one is not; None if open."""
        return self.event.form.supercritical if self.event.form else None

    def __repr__(self) -> str:
        return f"BranchEvent({self.kind} at {self.parameter} = {self.value:.9g})"


def follow(orbit: PeriodicOrbit, *, points: int = 400, tick: Tick | None = None, **interval: Any) -> FollowedOrbit:
    """The branch of a cycle as one parameter varies: `lam=(low, high)`, or a shape such as `alpha=(low, high)`.

    The ends are exact numbers or text. The branch is followed in both directions from the cycle, through folds, and
    across joins at which the curvature jumps.
    """
    import numpy as np

    from verification.cycles.arc import Steps
    from verification.cycles.branch import branch
    from verification.cycles.crossing import continued

    if not isinstance(orbit, PeriodicOrbit):
        raise ValueError(f"follow: {type(orbit).__name__} given; accepted: a cycle, as in find_cycles(...)[0]")
    if len(interval) != 1:
        raise ValueError(
            f"follow: {', '.join(interval) or 'no parameter'} given; one parameter varies, as in lam=(0, 1)"
        )
    ((parameter, ends),) = interval.items()
    ring, value, fixed = ring_over(orbit, parameter, ends)
    say = (lambda point: tick(f"{parameter} = {point.z[-1]:.4f}")) if tick else None
    steps, within = Steps(most=points), ends_of(parameter, ends)
    found = branch(ring, np.array(orbit.theta), parameter, value, within, fixed, steps, say)
    return FollowedOrbit(orbit, parameter, continued(found, within, steps, say))


def ring_over(orbit: PeriodicOrbit, parameter: str, ends: Any) -> "tuple[Chords, float, dict[str, float] | None]":
    """The chord system of a cycle with `parameter` free, the parameter's value, and the values of fixed parameters."""
    from verification.cycles.chords import Chords

    ends_of(parameter, ends)
    scene = orbit.scene
    law, own = law_over(scene, parameter, ends), dict(scene.law.numbers)
    ring = Chords(scene.table, orbit.components, law=law)
    if parameter == "lam":
        return ring, float(scene.lam), None
    fixed = {"lam": float(scene.lam)}
    if law.parameters:
        return ring, float(exact(parameter, own[parameter])), fixed
    if parameter not in scene.shape:
        known = ["lam", *scene.shape, *own]
        accepted = f"{', '.join(known)}{like(parameter, known)}"
        raise ValueError(f"follow: {parameter} is no parameter that varies in {scene}; accepted: {accepted}")
    return replace(ring, table=scene.over(parameter, *ends)), float(scene.shape[parameter]), fixed


def law_over(scene: Scene, parameter: str, ends: Sequence[Any]) -> Law:
    """The scene's law, proved to be a law over the interval `ends`; a parameter of the law itself becomes free."""
    law, lam = scene.law, (scene.lam, scene.lam)
    low, high = ends
    interval = exact(parameter, low), exact(parameter, high)
    if law.uniform or parameter in scene.shape:
        if law.measured:
            _over_shape(scene, parameter, interval)
        return law
    free = Law(law.formula, tuple(pair for pair in law.numbers if pair[0] != parameter))
    own = {parameter: interval} if free.parameters else {}
    free.check(interval if parameter == "lam" else lam, *free.places(scene.table), **own)
    return free


def _over_shape(scene: Scene, parameter: str, interval: tuple[Any, Any]) -> None:
    """Proves that a law in arc length, which changes with the shape, is a law for all shapes in an interval."""
    table = scene.over(parameter, *interval)
    for index, part in enumerate(table.components):
        if part.start.free_symbols | part.end.free_symbols:
            raise ValueError(f"law = {scene.law}: where the {part.name} ends depends on {parameter}; write it in theta")
        law = scene.law.on(table, index)
        law.check((scene.lam, scene.lam), (part.start, part.end), None, **dict.fromkeys(law.parameters, interval))


def ends_of(parameter: str, given: Any) -> tuple[float, float]:
    """The two ends of an interval of the parameter as floats; `ValueError` if they do not form an interval."""
    if not isinstance(given, tuple | list) or len(given) != 2:
        raise ValueError(
            f"follow: {parameter} = {given!r} is no interval; give two numbers, as in {parameter}=('0.3', '1')"
        )
    low, high = (float(exact(parameter, end)) for end in given)
    if not low < high or (parameter == "lam" and not 0 <= low < high <= 1):
        within = ", both in [0, 1]" if parameter == "lam" else ""
        raise ValueError(
            f"follow: {parameter} from {given[0]} to {given[1]} is no interval; the first must be the smaller{within}"
        )
    return low, high


def certify(found: "BranchEvent | PeriodicOrbit", *, digits: int = 30) -> "Located":
    """A proof in balls, to `digits` digits, of an event and its parameter, or of a cycle and its first bounce.

    Cycles, folds, period doublings, and pitchforks at which a mirror symmetry is lost have certificates; another
    pitchfork has its value in float64, not certified. The checklist of the result says what holds, and
    `certify(...).save("fold.json")` writes the certificate, for `check` or `pinball check fold.json`.
    `notes["stability"]` is what the one-sided derivatives prove where the curvature jumps at a bounce.

    >>> axis = find_cycles("ellipse", a="3/2", lam="1/2", period=2).stable[0]
    >>> certify(axis, digits=10).certified
    True
    """
    import time

    from flint import arb

    from verification.arithmetic.balls import decimal
    from verification.named.events import proof_of
    from verification.named.locate import MOST_DIGITS, Located

    if digits not in range(1, MOST_DIGITS + 1):
        raise ValueError(f"certify: digits = {digits!r} is out of range; accepted: 1 to {MOST_DIGITS}")
    started, notes = time.perf_counter(), dict[str, str]()
    if isinstance(found, PeriodicOrbit):
        cycle, name, place = _proof_of_cycle(found, digits), f"theta of the first bounce, period {found.period}", 0
        proof, notes = cycle, {"stability": cycle.one_sided.value} if cycle.one_sided else {}
    elif isinstance(found, BranchEvent):
        lam = None if found.parameter == "lam" else found.orbit.scene.lam
        event = proof_of(found.event, digits, found.parameter, lam)
        name, place = f"{found.kind} of period {found.orbit.period} in {found.parameter}", -1
        if event is None and found.kind == "pitchfork":
            notes = {"digits": "of float64; only pitchforks at which a mirror symmetry is lost are proved"}
            seconds, ball = time.perf_counter() - started, arb(found.value, "inf")
            return Located(name, f"{found.value:.9g}", "inf", 9, {"proof": None}, seconds, ball, notes=notes)
        if event is None:
            raise ValueError(f"certify: a {found.kind} has no certificate; accepted: fold, period doubling, pitchfork")
        proof = event
    else:
        raise ValueError(
            f"certify: {type(found).__name__} given; accepted: a cycle, as in find_cycles(...)[0], or an event of a "
            "branch, as in branch.folds[0]"
        )
    ball = proof.enclosure.zero[place]
    value, radius = decimal(ball, digits + 1)
    return Located(name, value, radius, digits, proof.checks, time.perf_counter() - started, ball, proof, notes)


def _proof_of_cycle(orbit: PeriodicOrbit, digits: int) -> "UniqueCycle":
    """The proof of a cycle; `ValueError` if a bounce lies on a join and the law depends on the position."""
    from sympy import S

    from verification.cycles.problem import Problem
    from verification.named.locate import proof_near

    scene = orbit.scene
    if orbit.one_sided and scene.law.placed:
        raise ValueError(
            f"certify: a bounce lies on a join, and {scene.law} may jump there; accepted: laws in eta alone"
        )
    problem = Problem(scene.table, orbit.components, lam=S(scene.lam), law=scene.law)
    proof = proof_near(problem, list(orbit.theta), digits)
    if any(abs(float(x.mid()) - at) > 1e-3 for x, at in zip(proof.enclosure.zero, orbit.theta, strict=False)):
        raise ValueError(f"certify: {orbit!r} is no cycle: Newton's method leads to another one, far from it")
    return proof


def morse_graph(
    table: Any,
    *,
    lam: Any = None,
    columns: int = 256,
    rows: int = 128,
    coarsest: int = 4,
    law: Law | str | None = None,
    **shape: Any,
) -> "MorseGraph":
    """The Morse sets of the map and their order, proved for a contraction, or for all of `lam=(low, high)` at once.

    `lam` may be left out where `table` is a scene or a map, which have their own.

    The strip |phi| <= lam*pi/2, where every particle is after one bounce, is covered by `columns` times `rows` cells,
    at first in blocks of `coarsest`. From some bounce on, every orbit that meets no join is in one of the sets. Convex
    tables only.

    >>> len(morse_graph("ellipse", a="3/2", lam="1/2", columns=64, rows=32).attracting)
    1
    """
    return _graph(table, lam, columns, rows, coarsest, law, shape)[1]


def trapping_region(
    table: Any,
    *,
    lam: Any = None,
    columns: int = 256,
    rows: int = 128,
    coarsest: int = 4,
    law: Law | str | None = None,
    **shape: Any,
) -> "Region":
    """The smallest trapping region that is proved on a grid: a union of cells that the map sends into its interior.

    `lam`, `columns` and `rows` are as for `morse_graph`. `ValueError` if only the whole strip is proved.

    >>> trapping_region("ellipse", a="3/2", lam="1/2", columns=64, rows=32).checks["images_inside"]
    True
    """
    from verification.proofs.global_dynamics.regions import region

    map, graph = _graph(table, lam, columns, rows, coarsest, law, shape)
    found = [one for one in (region(map, graph, index) for index in graph.attracting) if one is not None]
    least = min(found, key=lambda one: int((one.cells.size.astype(int) ** 2).sum()), default=None)
    if least is None or least.cells.chart.size >= int(graph.transitions.leaf.sum()):
        raise ValueError(
            f"trapping_region: none smaller than the whole strip is proved on {columns} by {rows} cells; "
            "give more columns and rows, or another lam"
        )
    return least


def _graph(
    table: Any, lam: Any, columns: int, rows: int, coarsest: int, law: Law | str | None, shape: dict[str, Any]
) -> "tuple[PinballImages, MorseGraph]":
    """The map for one contraction or a range of them, and its Morse graph on a grid."""
    from verification.proofs.global_dynamics.images import PinballImages
    from verification.rigorous.graph import Grid, morse_graph, refined

    lam = as_scene(table, law=law, **shape).lam if lam is None else lam
    ends = [exact("lam", end) for end in (lam if isinstance(lam, tuple | list) else (lam, lam))]
    if len(ends) != 2 or not all(isinstance(end, Fraction) for end in ends):
        raise ValueError(f"lam = {lam!r} is no range of contractions; accepted: one rational number, or two")
    low, high = (Fraction(str(end)) for end in ends)
    map = PinballImages(as_scene(table, lam=low, law=law, **shape), (low, high))
    return map, morse_graph(refined(map, Grid(map.charts, columns, rows), coarsest))
