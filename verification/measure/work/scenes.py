"""Error against run time for a user's scene: one bounce, its derivative, an orbit, a cycle, a fold, an exponent.

>>> from verification import work_precision
>>> found = work_precision("ellipse", "step", a="3/2", lam="1/2", digits=20, runs=1)
>>> sorted({row.arithmetic for row in found.rows})
['arb', 'float64', 'mpmath']
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb
from sympy import S

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind, find
from numeric.pinball.states import html_table, many, plotted
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene, as_scene
from verification.arithmetic.iteration import silent
from verification.cycles.chords import Chords
from verification.cycles.problem import Problem
from verification.cycles.recurrence import BifurcationKind
from verification.measure.work.cycles import cycle_question, fold_question, textbook_cycle
from verification.measure.work.exponents import ORBITS, estimated, of_cycle_exponent
from verification.measure.work.flights import BOUNCES, of_bounces, of_derivative
from verification.measure.work.question import Answer, Claimed, Method, Question, Say, measured
from verification.measure.work.row import HEAD, MethodResult, facts, plain, table
from verification.named.questions import PeriodicOrbit, find_cycles, follow

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PERIODS = (2, 3, 4)  # periods at which a cycle is searched for
BEGINNINGS = ("own", "19/20", "7/10", "1/2", "3/10")  # contractions at which cycles with a fold are searched for
COUNTED, LONG = (1_000, 30_000, 300_000), 3_000_000  # bounces in all for an exponent


@dataclass(frozen=True, repr=False)
class WorkPrecision:
    """The rows of a question: each is a method with its error and its seconds; `.plot()` draws their diagram."""

    question: Question = field(compare=False)
    rows: tuple[MethodResult, ...]
    machine: dict[str, str]

    def plot(self, axes: "Axes | None" = None) -> "Figure":
        """The figure of error against seconds, one line for each method, on the given axes or new ones."""
        asked = self.question
        results = asked.title, asked.unit, self.rows, self.machine
        made: Figure = plotted("verification.measure.work.figure.drawn", *results, axes=axes)
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled without the functions of the question, which are made where it is asked."""
        return type(self), (replace(self.question, reference=not_kept, methods=()), self.rows, self.machine)

    def __str__(self) -> str:
        return f"{self.question.title}: error {self.question.unit}\n{plain(self.rows)}"

    def __repr__(self) -> str:
        ways = len({row.method for row in self.rows})
        return f"WorkPrecision({self.question.title}: {many(len(self.rows), 'row')} of {many(ways, 'way')})"

    def _repr_html_(self) -> str:
        return f"<p>{escape(self.question.title)}</p>{html_table(HEAD, table(self.rows))}"


def not_kept(digits: int) -> Answer:
    """Raises `ValueError`: takes the place of a question's reference, which is not pickled."""
    raise ValueError("a question that was pickled has no reference; ask it again with work_precision")


def work_precision(
    table: Any,
    question: str,
    *,
    runs: int = 3,
    digits: int = 100,
    seed: int = 1,
    lam: Any = None,
    law: Law | str | None = None,
    say: Say = silent,
    **shape: Any,
) -> WorkPrecision:
    """Error against run time for a question on a given scene, in float64, mpmath and balls of up to `digits` digits.

    `question` is `step` or `jacobian` (one bounce of a few particles, or its derivative), `orbit` (ten bounces),
    `cycle` (the bounces of a cycle), `fold` (a contraction at which cycles are born) or `exponent` (the larger exponent
    of the attractor that most orbits reach). Errors are distances from a proved ball, or for chaos from a long run.
    Each row is the median of `runs` runs. `table` is a scene, a table, a map or a name; numbers are exact, as for
    `Scene`.
    """
    if question not in QUESTIONS:
        raise ValueError(f"work_precision: question = {question!r}; accepted: {', '.join(QUESTIONS)}")
    for name, value, least in (("runs", runs, 1), ("digits", digits, 16)):
        if value < least:
            raise ValueError(f"work_precision: {name} = {value!r}; accepted: whole numbers from {least}")
    asked = QUESTIONS[question](as_scene(table, lam=lam, law=law, **shape), seed)
    return WorkPrecision(asked, tuple(measured(asked, runs, digits, say)), facts())


# ---- cycles


def of_cycle(scene: Scene, seed: int) -> Question:
    """Benchmark: the bounces of a cycle of a small period; an attracting cycle if one is found."""
    orbit = some_cycle(scene, seed)
    name, title = f"cycle-{scene.name}", f"A cycle of period {orbit.period}, {scene.name}"
    what = f"a cycle of period {orbit.period}: {scene}"
    return cycle_question(name, title, what, *problem_of(scene, orbit), usual(scene, orbit))


def usual(scene: Scene, orbit: PeriodicOrbit) -> list[Method]:
    """Textbook methods for a cycle on one closed curve: single shooting and, if the cycle attracts, iterating."""
    if len(scene.table.components) > 1:
        return []
    return textbook_cycle(PinballMap(scene), (orbit.theta[0], orbit.phi[0]), orbit.period, orbit.stable)


def some_cycle(scene: Scene, seed: int) -> PeriodicOrbit:
    """A cycle of the smallest period in `PERIODS` that has one, preferably attracting."""
    for period in PERIODS:
        found = [orbit for orbit in find_cycles(scene, period=period, seed=seed) if not orbit.one_sided]
        if found:
            return min(found, key=lambda orbit: not orbit.stable)
    raise ValueError(f"work: no cycle of period {PERIODS[0]} to {PERIODS[-1]} is found in {scene}")


def problem_of(scene: Scene, orbit: PeriodicOrbit) -> tuple[Problem, tuple[float, ...]]:
    """The equations of a cycle, and its bounces to six decimals as a start for Newton's method."""
    problem = Problem(scene.table, orbit.components, lam=S(scene.lam), law=scene.law)
    return problem, tuple(round(theta, 6) for theta in orbit.theta)


def of_fold(scene: Scene, seed: int) -> Question:
    """Benchmark: a contraction at which two cycles are born, the first fold met when cycles are followed in `lam`."""
    for beginning in BEGINNINGS:
        here = scene if beginning == "own" else scene.at(lam=beginning)
        if not 0 < here.lam < 1:
            continue
        for period in PERIODS[1:]:
            for orbit in find_cycles(here, period=period, seed=seed).stable[:2]:
                folds = follow(orbit, lam=("0", "1")).folds
                if folds and isinstance(ring := folds[0].event.ring, Chords):
                    start = tuple(round(float(x), 6) for x in (*folds[0].event.x, folds[0].value))
                    return fold_question(
                        f"fold-{scene.name}",
                        f"A fold of period {period}, {scene.name}",
                        f"a contraction at which cycles of period {period} are born: {scene}",
                        Problem(ring.table, ring.components, BifurcationKind.FOLD, "lam", law=ring.law),
                        start,
                    )
    raise ValueError(f"work: no fold of a cycle of period {PERIODS[1]} or {PERIODS[-1]} is met in {scene}")


# ---- exponents


def of_exponent(scene: Scene, seed: int) -> Question:
    """Benchmark: the larger exponent of the attractor that most orbits reach; if chaotic, against a long run."""
    map = PinballMap(scene)
    attractor = find(map, ORBITS, seed)[0]
    if attractor.kind is Kind.CYCLE:
        return _of_cycles_exponent(scene, map, attractor)
    if attractor.kind is Kind.CHAOTIC:
        return _of_chaos(scene, map, attractor)
    raise ValueError(f"work: most orbits end on {attractor.kind.value} in {scene}; accepted: a cycle, or chaos")


def _of_cycles_exponent(scene: Scene, map: PinballMap, attractor: Attractor) -> Question:
    component, theta, phi = attractor.points
    problem = Problem(scene.table, tuple(int(i) for i in component), lam=S(scene.lam), law=scene.law)
    return of_cycle_exponent(
        f"exponent-{scene.name}",
        f"The exponent of a cycle, {scene.name}",
        f"the larger Lyapunov exponent of an attracting cycle of period {attractor.period}: {scene}",
        problem,
        tuple(round(float(x), 6) for x in theta),
        lambda bounces: map.exponents(theta[0], phi[0], bounces, component=component[0]),
        COUNTED,
    )


def _of_chaos(scene: Scene, map: PinballMap, attractor: Attractor) -> Question:
    on = attractor.points.only(np.linspace(0, attractor.points.size - 1, ORBITS).astype(int))
    points = on.theta, on.phi, on.component

    def run(bounces: int, own: PinballMap = map) -> Claimed:
        found = estimated(own, points, bounces)
        return Claimed([found.mean], found.reach)

    @cache
    def long() -> list[arb]:
        found = estimated(map, points, LONG)
        return [arb(found.mean, found.reach)]

    plainly = PinballMap(scene, kernels=False)
    return Question(
        f"exponent-{scene.name}",
        f"The exponent of chaos, {scene.name}",
        f"the larger Lyapunov exponent of the attractor that most orbits reach: {scene}",
        "per bounce",
        lambda digits: long(),
        (
            Method("compiled kernel, error bar", "float64", "bounces", COUNTED, run),
            Method("NumPy, error bar", "float64", "bounces", COUNTED[:2], lambda bounces: run(bounces, plainly)),
        ),
        certified=False,
        most_digits=16,
    )


QUESTIONS: dict[str, Callable[[Scene, int], Question]] = {
    "step": lambda scene, seed: of_bounces(scene, seed, "step", "One bounce", 1),
    "jacobian": of_derivative,
    "orbit": lambda scene, seed: of_bounces(scene, seed, "orbit", f"An orbit of {BOUNCES} bounces", BOUNCES),
    "cycle": of_cycle,
    "fold": of_fold,
    "exponent": of_exponent,
}
