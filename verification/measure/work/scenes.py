"""Error against run time for a user's scene: one bounce, its derivative, an orbit, a cycle, a fold, an exponent.

>>> from verification import work_precision
>>> found = work_precision("ellipse", "step", a="3/2", lam="1/2", digits=20, runs=1)
>>> sorted({row.arithmetic for row in found.rows})
['arb', 'float64', 'mpmath']
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb
from sympy import S

from numeric import PinballMap, phase_starts
from numeric.dynamics.attractors import Attractor, Kind, find
from numeric.dynamics.statistics import Estimate
from numeric.pinball.sampling import ALIGNED, Growth
from numeric.pinball.states import html_table, many, plotted
from symbolic.tables.law import Law
from symbolic.tables.scene import Scene, as_scene
from verification.arithmetic.balls import bits_of, working
from verification.arithmetic.iteration import silent
from verification.cycles.chords import Chords
from verification.cycles.problem import Problem
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.maps.exact import Bounce, ExactMap
from verification.maps.laws import symbolic_derivative
from verification.measure.work.cycles import cycle_question, here_alone, textbook_cycle, whole
from verification.measure.work.exponents import grown, read_off
from verification.measure.work.question import Answer, Claimed, Method, Question, Say, measured
from verification.measure.work.row import HEAD, MethodResult, facts, plain, table
from verification.measure.work.sought import DIGITS, Sought, last, scripted, to_digits
from verification.named.locate import proof_near
from verification.named.questions import PeriodicOrbit, find_cycles, follow

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTICLES, BOUNCES = 4, 10  # particles of a question on bounces, bounces of an orbit
COUNTS = (4, 64, 4096)  # particles in a call of the kernels: the first few repeated
MARGIN = 12  # digits that the flights lose at first in balls
WIDER = 6  # doublings of MARGIN until an orbit is known well enough, at most
PERIODS = (2, 3, 4)  # periods at which a cycle is searched for
BEGINNINGS = ("own", "19/20", "7/10", "1/2", "3/10")  # contractions at which cycles with a fold are searched for
ORBITS, COUNTED, LONG = 64, (1_000, 30_000, 300_000), 3_000_000  # of an exponent, and bounces in all
Start = tuple[float, float, int]  # parameter and exit angle, doubles taken exactly, and the component
Entries = Callable[
    [Any, list[tuple[Bounce, Bounce]], int], list[Any]
]  # the entries of a derivative along flights, to so many digits


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


# ---- bounces


def steps(scene: Scene, seed: int) -> Question:
    """Benchmark: one bounce of a few particles."""
    return of_flights(scene, seed, "step", "One bounce", 1)


def orbits(scene: Scene, seed: int) -> Question:
    """Benchmark: ten bounces of a few particles."""
    return of_flights(scene, seed, "orbit", f"An orbit of {BOUNCES} bounces", BOUNCES)


def of_flights(scene: Scene, seed: int, name: str, title: str, bounces: int) -> Question:
    """Benchmark: parameter and exit angle of a few particles after some bounces."""
    map = PinballMap(scene)
    starts = tuple(known_starts(scene, map, seed, bounces))

    def landed(own: PinballMap, theta: Any, phi: Any, component: Any) -> list[float]:
        end = own.orbit(theta, phi, bounces, component)
        return [float(x) for i in range(len(starts)) for x in (end.theta[-1, i], end.phi[-1, i])]

    def entries(_: Any, flights: list[tuple[Bounce, Bounce]], digits: int) -> list[Any]:
        return [x for _, end in flights for x in (end.theta, end.phi)]

    return Question(
        f"{name}-{scene.name}",
        f"{title}, {scene.name}",
        f"parameter and exit angle of {len(starts)} particles after {many(bounces, 'bounce')}: {scene}",
        "radians",
        lambda digits: enclosed(scene, map, starts, bounces, digits, entries),
        (*in_every_arithmetic(scene, map, starts, bounces, landed, entries), *scripted(scene, starts, bounces)),
    )


def jacobians(scene: Scene, seed: int) -> Question:
    """Benchmark: the derivative of one bounce of a few particles."""
    map = PinballMap(scene)
    starts = tuple(known_starts(scene, map, seed, 1))

    def turned(own: PinballMap, theta: Any, phi: Any, component: Any) -> list[float]:
        return [float(x) for x in own.derivative(theta, phi, component)[: len(starts)].ravel()]

    def entries(own: Any, flights: list[tuple[Bounce, Bounce]], digits: int) -> list[Any]:
        return [x for start, end in flights for x in symbolic_derivative(own, start, end, digits + MARGIN)]

    return Question(
        f"jacobian-{scene.name}",
        f"The derivative of one bounce, {scene.name}",
        f"d(s1, phi1)/d(s0, phi0) of {len(starts)} particles: {scene}",
        "of an entry",
        lambda digits: enclosed(scene, map, starts, 1, digits, entries),
        tuple(in_every_arithmetic(scene, map, starts, 1, turned, entries)),
    )


def known_starts(scene: Scene, map: PinballMap, seed: int, bounces: int) -> Iterator[Start]:
    """The first few random particles for which every bounce is proved in balls."""
    drawn, found = phase_starts(map, 16 * PARTICLES, seed), 0
    own = EnclosedMap(map, scene.lam, 64 + 32 * bounces)
    for component, theta, phi in zip(drawn.component, drawn.theta, drawn.phi, strict=True):
        start = (round(float(theta), 3), round(float(phi), 3), int(component))
        try:
            flights(own, [start], bounces)
        except ValueError:
            continue
        yield start
        found += 1
        if found == PARTICLES:
            return
    raise ValueError(f"work: fewer than {PARTICLES} of {16 * PARTICLES} particles have proved bounces in {scene}")


def flights(own: ExactMap | EnclosedMap, starts: Sequence[Start], bounces: int) -> list[tuple[Bounce, Bounce]]:
    """The last of `bounces` flights of each particle under the map `own`: the bounces where it leaves and lands."""
    found = []
    for start in starts:
        before = after = own.start(*start)
        for _ in range(bounces):
            before, landed = after, own.bounce(after)
            if isinstance(landed, Refusal):
                raise ValueError(landed.value)
            if landed.code:
                raise ValueError("the particle stops before its last bounce")
            after = landed
        found.append((before, after))
    return found


def enclosed(
    scene: Scene, map: PinballMap, starts: Sequence[Start], bounces: int, digits: int, entries: Entries
) -> list[arb]:
    """Balls that hold the answer, of radius below `10**-digits`; each landing is proved to be the first hit."""
    more = MARGIN
    for _ in range(WIDER):
        bits = bits_of(digits + more, 64)
        own = EnclosedMap(map, scene.lam, bits)
        try:
            landed = flights(own, starts, bounces)
        except ValueError as why:
            refused = str(why)
        else:
            with working(bits):
                answer: list[arb] = entries(own, landed, digits + more)
                if all(x.rad() < arb(10) ** -digits for x in answer):
                    return answer
            refused = Refusal.WIDE.value
        more *= 2
    raise ValueError(f"{scene.name}: {refused}")


def in_every_arithmetic(
    scene: Scene,
    map: PinballMap,
    starts: Sequence[Start],
    bounces: int,
    call: Callable[..., list[float]],
    entries: Entries,
) -> Iterator[Method]:
    """Methods in every arithmetic: the compiled kernel, NumPy, mpmath and balls."""

    def ran(own: PinballMap, count: int) -> list[float]:
        theta, phi, component = np.tile(np.array(starts), (count // len(starts), 1)).T
        return call(own, theta, phi, component.astype(np.int64))

    for name, kernels in (("compiled kernel", True), ("NumPy", False)):
        own = map if kernels else PinballMap(scene, kernels=False)
        yield Method(name, "float64", "particles", COUNTS, partial(ran, own))

    def in_mpmath(digits: int) -> list[Any]:
        exact = ExactMap(map, digits, scene.lam)
        return entries(exact, flights(exact, starts, bounces), digits)

    def proved(digits: int) -> list[arb]:
        return enclosed(scene, map, starts, bounces, digits, entries)

    yield Method("mpmath", "mpmath", "digits", DIGITS, in_mpmath, per=len(starts))
    yield Method("arb, certified", "arb", "digits", DIGITS, proved, to_digits, len(starts), proved=True)


# ---- cycles


def of_cycle(scene: Scene, seed: int) -> Question:
    """Benchmark: the bounces of a cycle of a small period; an attracting cycle if one is found."""
    orbit = some_cycle(scene, seed)
    name, title = f"cycle-{scene.name}", f"A cycle of period {orbit.period}, {scene.name}"
    what = f"a cycle of period {orbit.period}: {scene}"
    return cycle_question(name, title, what, *problem_of(scene, orbit), usual(scene, orbit), here=True)


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
                    return _fold(scene, period, ring, (*map(float, folds[0].event.x), folds[0].value))
    raise ValueError(f"work: no fold of a cycle of period {PERIODS[1]} or {PERIODS[-1]} is met in {scene}")


def _fold(scene: Scene, period: int, ring: Chords, start: tuple[float, ...]) -> Question:
    from verification.cycles.recurrence import BifurcationKind

    problem = Problem(ring.table, ring.components, BifurcationKind.FOLD, "lam", law=ring.law)
    near = tuple(round(x, 6) for x in start)

    def certified(digits: int) -> list[arb]:
        return [whole(proof_near(problem, list(near), digits)).value]

    return Question(
        f"fold-{scene.name}",
        f"A fold of period {period}, {scene.name}",
        f"a contraction at which cycles of period {period} are born: {scene}",
        "in lam",
        certified,
        tuple(here_alone(Sought(problem, near, last).methods(certified))),
    )


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
    parts, period = tuple(int(i) for i in component), attractor.period
    problem = Problem(scene.table, parts, lam=S(scene.lam), law=scene.law)
    start = tuple(round(float(x), 6) for x in theta)

    read, certified = read_off(problem, start)

    def run(bounces: int) -> list[float]:
        return [float(map.exponents(theta[0], phi[0], bounces, component=component[0]).nu_plus)]

    own = Method("compiled kernel", "float64", "bounces", COUNTED, run)
    name = f"the larger Lyapunov exponent of an attracting cycle of period {period}: {scene}"
    return Question(
        f"exponent-{scene.name}",
        f"The exponent of a cycle, {scene.name}",
        name,
        "per bounce",
        certified,
        (own, *here_alone(Sought(problem, start, read).methods(certified))),
    )


def _of_chaos(scene: Scene, map: PinballMap, attractor: Attractor) -> Question:
    def run(bounces: int, own: PinballMap = map) -> Claimed:
        found = on(own, attractor, bounces)
        return Claimed([found.mean], found.reach)

    @cache
    def long() -> list[arb]:
        found = on(map, attractor, LONG)
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


def on(map: PinballMap, attractor: Attractor, bounces: int) -> Estimate:
    """The larger exponent over several orbits on an attractor, with its standard error from batch means."""
    points = attractor.points.only(np.linspace(0, attractor.points.size - 1, ORBITS).astype(int))
    growth = Growth(map, points.theta, points.phi, points.component)
    growth.settle(ALIGNED)
    return grown(growth, max(bounces // ORBITS, 8))


QUESTIONS: dict[str, Callable[[Scene, int], Question]] = {
    "step": steps,
    "jacobian": jacobians,
    "orbit": orbits,
    "cycle": of_cycle,
    "fold": of_fold,
    "exponent": of_exponent,
}
