"""Questions on a scene, each one call: which cycles, what becomes of one, and the proof of what happens to it.

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

from symbolic.tables.definition import exact
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene

if TYPE_CHECKING:
    from verification.cycles.branch import Branch, Event
    from verification.cycles.search import Found, Searched
    from verification.named.locate import Located

SHOWN = 12  # rows of a table in a notebook
Tick = Callable[[str], None]


@dataclass(frozen=True)
class PeriodicOrbit:
    """A cycle of minimal period in a scene: its bounces, in radians, and its multipliers, the larger one first."""

    scene: Scene
    components: tuple[int, ...]
    theta: tuple[float, ...]
    phi: tuple[float, ...]
    multipliers: tuple[complex, complex]

    @property
    def period(self) -> int:
        """The number of bounces."""
        return len(self.theta)

    @property
    def stable(self) -> bool:
        """True when both multipliers lie inside the unit circle, in float64."""
        return max(map(abs, self.multipliers)) < 1

    def __repr__(self) -> str:
        mu = ", ".join(f"{m.real:.5g}" if m.imag == 0 else f"{m:.5g}" for m in self.multipliers)
        kind = "stable" if self.stable else "unstable"
        return f"PeriodicOrbit(period {self.period}, {kind}, multipliers {mu}, theta[0] = {self.theta[0]:.6g})"


class PeriodicOrbits(Sequence[PeriodicOrbit]):
    """Cycles, each once, by period; `.stable`, `.unstable` and `.of(period)` choose among them."""

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

    def __iter__(self) -> Iterator[PeriodicOrbit]:
        return iter(self.orbits)

    @property
    def stable(self) -> "PeriodicOrbits":
        """Those whose multipliers both lie inside the unit circle."""
        return PeriodicOrbits(orbit for orbit in self.orbits if orbit.stable)

    @property
    def unstable(self) -> "PeriodicOrbits":
        """The others."""
        return PeriodicOrbits(orbit for orbit in self.orbits if not orbit.stable)

    def of(self, period: int) -> "PeriodicOrbits":
        """Those of one minimal period."""
        return PeriodicOrbits(orbit for orbit in self.orbits if orbit.period == period)

    def __repr__(self) -> str:
        return f"PeriodicOrbits({len(self)}: {len(self.stable)} stable)"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{o.period}</td><td>{'yes' if o.stable else 'no'}</td><td>{o.multipliers[0]:.6g}</td>"
            f"<td>{o.multipliers[1]:.6g}</td><td>{o.theta[0]:.9f}</td></tr>"
            for o in self.orbits[:SHOWN]
        )
        more = f"<p>and {len(self) - SHOWN} more</p>" if len(self) > SHOWN else ""
        head = "<tr><th>period</th><th>stable</th><th colspan=2>multipliers</th><th>first bounce</th></tr>"
        return f"<table>{head}{rows}</table>{more}"


def find_cycles(
    scene: Scene, *, period: int | None = None, up_to: int | None = None, seed: int = 1, tick: Tick | None = None
) -> PeriodicOrbits:
    """The cycles of a scene of one minimal period, or of all periods `up_to` one, found by search in float64.

    A search does not prove that it found all; `pinball cycles --prove` does, for small periods.

    >>> ellipse = Scene("ellipse", a="3/2", lam="1/2")
    >>> find_cycles(ellipse, period=2)
    PeriodicOrbits(2: 1 stable)
    """
    from verification.cycles.search import all_cycles

    if (period is None) == (up_to is None):
        raise ValueError("find_cycles: give one of period=N and up_to=N")
    longest = period if period is not None else up_to
    if isinstance(longest, bool) or not isinstance(longest, int) or longest < 2:
        raise ValueError(f"find_cycles: {longest!r} is no period; accepted: integers from 2")
    from sympy import S

    found = all_cycles(scene.table, S(scene.lam), longest, seed, tick or (lambda said: None), scene.law)
    made = (_orbit(scene, cycle) for cycle in found.catalogue.cycles if period in (None, cycle.period))
    return PeriodicOrbits(made, found)


def _orbit(scene: Scene, cycle: "Found") -> PeriodicOrbit:
    one, two = sorted(cycle.spectrum.multipliers, key=lambda mu: -abs(mu))
    return PeriodicOrbit(scene, cycle.components, cycle.theta, cycle.phi, (complex(one), complex(two)))


@dataclass(frozen=True)
class FollowedOrbit:
    """A branch of cycles in one parameter, with what happens on it; `.folds`, `.flips` and their like choose."""

    orbit: PeriodicOrbit
    parameter: str
    branch: "Branch" = field(repr=False)

    @cached_property
    def events(self) -> "tuple[BranchEvent, ...]":
        """All events, in the order of the branch."""
        return tuple(BranchEvent(self.orbit, self.parameter, event) for event in self.branch.events)

    @property
    def folds(self) -> "tuple[BranchEvent, ...]":
        """Where the branch turns: saddle-node bifurcations."""
        return self._of("fold")

    @property
    def flips(self) -> "tuple[BranchEvent, ...]":
        """Period doublings."""
        return self._of("period doubling")

    @property
    def pitchforks(self) -> "tuple[BranchEvent, ...]":
        """Where a symmetric cycle loses its symmetry."""
        return self._of("pitchfork")

    @property
    def border_collisions(self) -> "tuple[BranchEvent, ...]":
        """Where a bounce meets a join of the boundary."""
        return self._of("border collision")

    def _of(self, kind: str) -> "tuple[BranchEvent, ...]":
        return tuple(event for event in self.events if event.kind == kind)

    def __repr__(self) -> str:
        ends = f"{min(self.branch.values):.6g} to {max(self.branch.values):.6g}"
        events = ", ".join(f"{event.kind} at {event.value:.9g}" for event in self.events) or "no event"
        return f"FollowedOrbit(period {self.orbit.period}, {self.parameter} from {ends}: {events})"


@dataclass(frozen=True)
class BranchEvent:
    """What happens on a branch, at which value of its parameter, in float64; `certify` gives digits and a proof."""

    orbit: PeriodicOrbit
    parameter: str
    event: "Event" = field(repr=False)

    @property
    def kind(self) -> str:
        """`fold`, `period doubling`, `pitchfork`, `branch point`, `border collision`, `Neimark-Sacker` or so."""
        return self.event.kind.value

    @property
    def value(self) -> float:
        """The parameter there."""
        return self.event.value

    @property
    def supercritical(self) -> bool | None:
        """True when the cycle that is born is stable where the old one is not; None where that is no question."""
        return self.event.form.supercritical if self.event.form else None


def follow(orbit: PeriodicOrbit, *, points: int = 400, tick: Tick | None = None, **interval: Any) -> FollowedOrbit:
    """What becomes of a cycle as one parameter changes: `lam=(low, high)`, or a shape such as `alpha=(low, high)`.

    The ends are exact numbers or text. The branch is followed both ways from the cycle, through folds.
    """
    import numpy as np

    from verification.cycles.arc import Steps
    from verification.cycles.branch import branch
    from verification.cycles.chords import Chords

    if len(interval) != 1:
        raise ValueError(
            f"follow: {', '.join(interval) or 'no parameter'} given; one parameter varies, as in lam=(0, 1)"
        )
    ((parameter, ends),) = interval.items()
    low, high = _ends(parameter, ends)
    scene = orbit.scene
    law, own = law_over(scene, parameter, ends), dict(scene.law.numbers)
    ring, fixed = Chords(scene.table, orbit.components, law=law), None
    value = float(scene.lam)
    if law.parameters:
        value, fixed = float(exact(parameter, own[parameter])), {"lam": float(scene.lam)}
    elif parameter != "lam":
        if parameter not in scene.shape:
            accepted = ", ".join(["lam", *scene.shape, *own])
            raise ValueError(f"follow: {parameter} is no parameter that varies in {scene}; accepted: {accepted}")
        ring = replace(ring, table=scene.over(parameter, *ends))
        value, fixed = float(scene.shape[parameter]), {"lam": float(scene.lam)}
    say = (lambda point: tick(f"{parameter} = {point.z[-1]:.4f}")) if tick else None
    return FollowedOrbit(
        orbit,
        parameter,
        branch(ring, np.array(orbit.theta), parameter, value, (low, high), fixed, Steps(most=points), say),
    )


def law_over(scene: Scene, parameter: str, ends: Sequence[Any]) -> Law:
    """The scene's law, with `parameter` left free where it is the law's own; proved to be a law over the interval."""
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
    """Proves a law that speaks of arc length, which changes with the shape, over an interval of a shape parameter."""
    table = scene.over(parameter, *interval)
    for index, part in enumerate(table.components):
        if part.start.free_symbols | part.end.free_symbols:
            raise ValueError(f"law = {scene.law}: where the {part.name} ends depends on {parameter}; write it in theta")
        law = scene.law.on(table, index)
        law.check((scene.lam, scene.lam), (part.start, part.end), None, **dict.fromkeys(law.parameters, interval))


def _ends(parameter: str, given: Any) -> tuple[float, float]:
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


def certify(event: BranchEvent, *, digits: int = 30) -> "Located":
    """The value of the parameter at an event to so many digits, with a proof in balls; its checklist says what holds.

    Folds, period doublings and pitchforks have certificates.
    """
    import time

    from verification.arithmetic.balls import decimal
    from verification.named.events import proof_of
    from verification.named.locate import Located

    if not isinstance(event, BranchEvent):
        raise TypeError(f"certify: {type(event).__name__} given; it takes an event of a branch, as in branch.folds[0]")
    started = time.perf_counter()
    lam = None if event.parameter == "lam" else event.orbit.scene.lam
    proof = proof_of(event.event, digits, event.parameter, lam)
    if proof is None:
        raise ValueError(f"certify: a {event.kind} has no certificate; accepted: fold, period doubling, pitchfork")
    value, radius = decimal(proof.value, digits + 1)
    name = f"{event.kind} of period {event.orbit.period} in {event.parameter}"
    return Located(name, value, radius, digits, proof.checks, time.perf_counter() - started, proof.value, proof)


KINDS = {"saddle-node": "fold", "doubling": "period doubling", "symmetry-breaking": "pitchfork"}  # of any scene
SEARCHES = 3  # values of the parameter at which cycles are looked for
ALIKE = 6  # decimals to which two events have one value, and two cycles the same multipliers


def bifurcations(
    scene: Scene,
    kind: str,
    *,
    period: int,
    digits: int = 30,
    searches: int = SEARCHES,
    tick: Tick | None = None,
    **interval: Any,
) -> "tuple[Located, ...]":
    """Where cycles of one period fold, double their period or lose a symmetry, as one parameter varies; with proofs.

    `kind` is `saddle-node`, `doubling` or `symmetry-breaking`; the interval is given as for `follow`. Cycles are looked
    for at some values of the parameter and followed through all of the interval. So each value that comes back is
    proved to be one, and that there are no others is not: a branch may lie between the values of the searches.
    """
    if kind not in KINDS:
        raise ValueError(f"locate: {kind} is not asked of a scene; accepted: {', '.join(KINDS)}")
    if len(interval) != 1:
        raise ValueError(f"locate: {', '.join(interval) or 'no parameter'} given; one parameter varies")
    ((parameter, ends),) = interval.items()
    _ends(parameter, ends)
    low, high = (exact(parameter, end) for end in ends)
    say, met = tick or (lambda said: None), dict[float, BranchEvent]()
    for i in range(searches):
        value: dict[str, Any] = {parameter: low + (high - low) * Fraction(2 * i + 1, 2 * searches)}
        orbits = find_cycles(scene.at(**value), period=period)
        say(f"{parameter} = {float(value[parameter]):.4g}")
        for orbit in {same_multipliers(orbit): orbit for orbit in orbits}.values():
            try:
                followed = follow(orbit, **interval)
            except ValueError:
                continue  # at a bifurcation to within rounding: its neighbours lead there too
            met |= {round(event.value, ALIKE): event for event in followed.events if event.kind == KINDS[kind]}
    found = []
    for _, event in sorted(met.items()):
        found.append(certify(event, digits=digits))
        say(f"{parameter} = {event.value:.6g}")
    return tuple(found)


def same_multipliers(orbit: PeriodicOrbit) -> tuple[complex, ...]:
    """The multipliers, which images under a symmetry share."""
    return tuple(complex(round(mu.real, ALIKE), round(abs(mu.imag), ALIKE)) for mu in orbit.multipliers)
