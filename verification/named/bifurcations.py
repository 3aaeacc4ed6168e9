"""Bifurcations over a parameter interval, of all attracting families or, with proofs, of cycles of one period."""

from dataclasses import replace
from fractions import Fraction
from typing import Any, overload

from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene, as_scene
from verification.arithmetic.iteration import silent
from verification.cycles.branch import Branch
from verification.named.families import Continuation
from verification.named.locate import Located
from verification.named.questions import BranchEvent, PeriodicOrbit, Tick, certify, ends_of, find_cycles, follow

KINDS = {"saddle-node": "fold", "doubling": "period doubling", "symmetry-breaking": "pitchfork"}  # for any scene
SEARCHES = 12  # values of the parameter at which cycles are looked for
FEW_SEARCHES = 3  # contractions at which manifolds are looked at, too, which takes longer
ALIKE = 6  # decimals to which two events have one value, and two cycles the same multipliers


@overload
def bifurcations(table: Any, *, tick: Tick | None = None, **interval: Any) -> Continuation:
    """Every family of cycles that attracts random starts, with its events."""


@overload
def bifurcations(
    table: Any,
    kind: str,
    *,
    period: int,
    digits: int = 30,
    searches: int | None = None,
    tick: Tick | None = None,
    **interval: Any,
) -> tuple[Located, ...]:
    """The events of one kind on cycles of one period, each with its proof."""


def bifurcations(
    table: Any,
    kind: str | None = None,
    *,
    period: int | None = None,
    digits: int = 30,
    searches: int | None = None,
    values: int | None = None,
    starts: int = 200,
    seed: int = 1,
    tick: Tick | None = None,
    **interval: Any,
) -> Continuation | tuple[Located, ...]:
    """Every family of cycles that attracts random starts as a parameter varies, with its events; or events of one kind.

    The interval is given as for `follow`. `starts` random starts at each of some `values` of the parameter find the
    families, which are followed from birth to death: `.families`, `.events`, `.check()`, `.document(digits)`. A family
    is missed if it attracts fewer than a hundredth of the starts at each value, or exists only between two values;
    within chaos, where windows are narrow, the values lie eight times closer.

    With a `kind` (`saddle-node`, `doubling` or `symmetry-breaking`), the result is the events of cycles of one
    `period`, with proofs: events of the families, and of cycles, attracting or not, that a search finds at `searches`
    values. Each value returned is proved, but for pitchforks at which no mirror symmetry is lost, which are told in
    float64; that there are no others is not proved.

    >>> found = bifurcations("ellipse", a="3/2", lam=("1/10", "1"), values=10, starts=20)
    >>> [(one["period"], one["symmetry"]) for one in found.document()["branches"]]
    [(2, 'D2')]
    """
    if len(interval) < 1:
        raise ValueError("bifurcations: no parameter given; one parameter varies, as in lam=(0, 1)")
    varied = {name: ends for name, ends in interval.items() if isinstance(ends, tuple | list)} or interval
    if kind is not None and kind not in KINDS:
        raise ValueError(f"bifurcations: {kind} is no kind of event; accepted: {', '.join(KINDS)}")
    if len(varied) != 1:
        as_scene(table, **{name: (varied.get(name) or (own,))[0] for name, own in interval.items()})  # refuses others
        raise ValueError(f"bifurcations: {', '.join(varied) or 'no parameter'} given; one parameter varies")
    ((parameter, ends),) = varied.items()
    scene = as_scene(table, **{name: own for name, own in interval.items() if name != parameter})
    ends_of(parameter, ends)
    scene = scene if parameter == "lam" else scene.spanning(parameter, *ends)
    found = Continuation(scene, parameter, tuple(ends), starts, seed, tick=tick or silent)
    if kind is None:
        return found.run(values)
    if period is None:
        raise ValueError(f"bifurcations: a {kind} is that of cycles of one period; give period=N")
    if searches is None:
        found = replace(found, only=period).run(values)
    branches = [(found.cycle(family), family.branch) for family in found.families if family.period == period]
    branches += _searched(scene, period, searches or SEARCHES, parameter, ends, found.tick)
    met = dict[float, BranchEvent]()
    for orbit, branch in branches:
        events = (BranchEvent(orbit, parameter, event) for event in branch.events)
        met |= {round(event.value, ALIKE): event for event in events if event.kind == KINDS[kind]}
    proved = []
    for _, event in sorted(met.items()):
        proved.append(certify(event, digits=digits))
        found.tick(f"{parameter} = {event.value:.6g}")
    return tuple(proved)


def _searched(
    scene: Scene, period: int, searches: int, parameter: str, ends: Any, say: Tick
) -> list[tuple[PeriodicOrbit, Branch]]:
    """Cycles found at `searches` values, which are denser near the ends of the interval, and their branches."""
    low, high = (exact(parameter, end) for end in ends)
    found: list[tuple[PeriodicOrbit, Branch]] = []
    for i in range(searches):
        share = Fraction(2 * i + 1, 2 * searches)
        value: dict[str, Any] = {parameter: low + (high - low) * share**2 * (3 - 2 * share)}
        orbits = find_cycles(scene, period=period, **value)
        say(f"{parameter} = {float(value[parameter]):.4g}")
        for orbit in {same_multipliers(orbit): orbit for orbit in orbits}.values():
            try:
                found.append((orbit, follow(orbit, **{parameter: ends}).branch))
            except ValueError:
                continue  # at a bifurcation to within rounding: its neighbours lead there too
    return found


def same_multipliers(orbit: PeriodicOrbit) -> tuple[complex, ...]:
    """The multipliers, rounded so that cycles which are symmetric images of each other have equal ones."""
    return tuple(complex(round(mu.real, ALIKE), round(abs(mu.imag), ALIKE)) for mu in orbit.multipliers)
