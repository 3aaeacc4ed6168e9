"""Benchmarks on a few bounces and on the derivative of one, on any scene in every arithmetic; and textbook methods.

The benchmarks on the paper's egg and cardioid also solve the flight equation by Newton's method in every arithmetic.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cache, cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec as Run
from numeric.pinball.sampling import phase_starts
from numeric.pinball.states import many
from symbolic.cycles.derivations import derivative_matrix
from symbolic.expressions.text import Kernel, kernel, load
from symbolic.motion.chords import chord_angle, chord_kernel, theta0, theta1
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table
from verification.arithmetic.balls import Arithmetic, bits_of, working
from verification.arithmetic.iteration import Vector
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.maps.exact import Bounce, ExactMap
from verification.maps.laws import symbolic_derivative
from verification.measure.work.bench import module
from verification.measure.work.question import Method, Question, textbook
from verification.measure.work.sought import DIGITS, Sought, scripted, to_digits

LAM = Fraction(19, 20)
SCENES = {"egg": Scene("egg", alpha="2/25", lam=LAM), "cardioid": Scene("cardioid", lam=LAM)}
PARTICLES = ((0.3, 0.2, 0), (-2.0, 0.9, 0), (1.25, -1.0, 0), (2.75, 0.5, 0))
DRAWN, BOUNCES = 4, 10  # random particles of a question on bounces, bounces of an orbit
COUNTS = (4, 64, 4096)  # particles in a call of the kernels: the first few repeated
EPS = 2.0**-52
STEP = 8 * EPS  # over the condition number: the error that kernels claim
MATRIX = 64 * EPS
STEPS = (1e-1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
MARGIN = 12  # digits that the flights lose at first in balls
WIDER = 6  # doublings of MARGIN until an orbit is known well enough, at most
Start = tuple[float, float, int]  # parameter and exit angle, doubles taken exactly, and the component


class Read(NamedTuple):
    """What a question asks of flights: a function of arrays for the kernels, and one of bounces in other arithmetics.

    `kernels(map, theta, phi, component, bounces)` has the answers of all particles. `flights(own, bounces, digits)`
    has them from the pairs of bounces where a particle leaves and lands, in the numbers of the map `own`.
    """

    kernels: Callable[..., Any]
    flights: Callable[[Any, list[tuple[Bounce, Bounce]], int], list[Any]]


def _landings(map: PinballMap, theta: Any, phi: Any, component: Any, bounces: int) -> Any:
    end = map.orbit(theta, phi, bounces, component) if bounces > 1 else map.step(theta, phi, component)
    return np.stack([np.atleast_2d(end.theta)[-1], np.atleast_2d(end.phi)[-1]], axis=1)


LANDINGS = Read(_landings, lambda own, flights, digits: [x for _, end in flights for x in (end.theta, end.phi)])
MATRICES = Read(
    lambda map, theta, phi, component, bounces: map.derivative(theta, phi, component),
    lambda own, flights, digits: [
        x for start, end in flights for x in symbolic_derivative(own, start, end, digits + MARGIN)
    ],
)


@dataclass(frozen=True)
class Flights:
    """A question on the last of `bounces` flights of some particles in a scene."""

    scene: Scene
    starts: tuple[Start, ...]
    read: Read = LANDINGS
    bounces: int = 1

    @cached_property
    def map(self) -> PinballMap:
        """The map of the scene."""
        return PinballMap(self.scene)

    def enclosed(self, digits: int) -> list[arb]:
        """Balls that hold the answer, of radius below `10**-digits`; each landing is proved to be the first hit."""
        more = MARGIN
        for _ in range(WIDER):
            bits = bits_of(digits + more, 64)
            own = EnclosedMap(self.map, self.scene.lam, bits)
            try:
                landed = last_flights(own, self.starts, self.bounces)
            except ValueError as why:
                refused = str(why)
            else:
                with working(bits):
                    answer: list[arb] = self.read.flights(own, landed, digits + more)
                    if all(x.rad() < arb(10) ** -digits for x in answer):
                        return answer
                refused = Refusal.WIDE.value
            more *= 2
        raise ValueError(f"{self.scene.name}: {refused}")

    def in_mpmath(self, digits: int) -> list[Any]:
        """The answer by the map's definition in mpmath: brackets all zeros of the flight function, takes the first."""
        exact = ExactMap(self.map, digits, self.scene.lam)
        return self.read.flights(exact, last_flights(exact, self.starts, self.bounces), digits)

    def by_kernel(self, map: PinballMap, count: int) -> list[float]:
        """The answer for the first few of `count` particles, all of which are computed."""
        theta, phi, component = np.tile(np.array(self.starts), (count // len(self.starts), 1)).T
        found = self.read.kernels(map, theta, phi, component.astype(np.int64), self.bounces)
        return [float(x) for x in found[: len(self.starts)].ravel()]

    def kernels(self, bound: float | None = None) -> Iterator[Method]:
        """The compiled kernel and the same step on NumPy arrays, as methods; `bound` is the error that they claim."""
        promise = None if bound is None else Decimal(f"{bound:.3g}")
        for name, own in (("compiled kernel", self.map), ("NumPy", PinballMap(self.scene, kernels=False))):
            yield Method(name, "float64", "particles", COUNTS, partial(self.by_kernel, own), lambda _: promise)

    def methods(self) -> Iterator[Method]:
        """Methods in every arithmetic: the compiled kernel, NumPy, mpmath and balls."""
        per = len(self.starts)
        yield from self.kernels()
        yield Method("mpmath", "mpmath", "digits", DIGITS, self.in_mpmath, per=per)
        yield Method("arb, certified", "arb", "digits", DIGITS, self.enclosed, to_digits, per, proved=True)


def last_flights(own: ExactMap | EnclosedMap, starts: tuple[Start, ...], bounces: int) -> list[tuple[Bounce, Bounce]]:
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


def known_starts(scene: Scene, seed: int, bounces: int) -> Iterator[Start]:
    """The first few random particles for which every bounce is proved in balls."""
    map = PinballMap(scene)
    drawn, found = phase_starts(map, 16 * DRAWN, seed), 0
    own = EnclosedMap(map, scene.lam, 64 + 32 * bounces)
    for component, theta, phi in zip(drawn.component, drawn.theta, drawn.phi, strict=True):
        start = (round(float(theta), 3), round(float(phi), 3), int(component))
        try:
            last_flights(own, (start,), bounces)
        except ValueError:
            continue
        yield start
        found += 1
        if found == DRAWN:
            return
    raise ValueError(f"work: fewer than {DRAWN} of {16 * DRAWN} particles have proved bounces in {scene}")


def of_bounces(scene: Scene, seed: int, name: str, title: str, bounces: int) -> Question:
    """Benchmark: parameter and exit angle of a few particles after some bounces, in any scene."""
    asked = Flights(scene, tuple(known_starts(scene, seed, bounces)), LANDINGS, bounces)
    return Question(
        f"{name}-{scene.name}",
        f"{title}, {scene.name}",
        f"parameter and exit angle of {DRAWN} particles after {many(bounces, 'bounce')}: {scene}",
        "radians",
        asked.enclosed,
        (*asked.methods(), *scripted(scene, asked.starts, bounces)),
    )


def of_derivative(scene: Scene, seed: int) -> Question:
    """Benchmark: the derivative of one bounce of a few particles, in any scene."""
    asked = Flights(scene, tuple(known_starts(scene, seed, 1)), MATRICES)
    return Question(
        f"jacobian-{scene.name}",
        f"The derivative of one bounce, {scene.name}",
        f"d(s1, phi1)/d(s0, phi0) of {DRAWN} particles: {scene}",
        "of an entry",
        asked.enclosed,
        tuple(asked.methods()),
    )


@dataclass(frozen=True)
class ConvexFlights:
    """Equations for the landings of `PARTICLES` on a convex table: each chord has the given exit angle."""

    table: Table

    @property
    def label(self) -> str:
        """The name of the equations in messages."""
        return f"{self.table.name}, flights"

    def angles(self, arithmetic: Arithmetic, z: Vector) -> list[tuple[Any, ...]]:
        """The exit angles of the chords that end at the parameters `z`, with derivatives."""
        chord = load(chord_kernel(self.table, 0, 0, 1), arithmetic)
        return [chord(exactly(arithmetic, particle[0]), x) for particle, x in zip(PARTICLES, z, strict=True)]

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The exit angles of the chords that end at `z`, minus the given exit angles."""
        found = self.angles(arithmetic, z)
        return [a[0] - exactly(arithmetic, particle[1]) for a, particle in zip(found, PARTICLES, strict=True)]

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """Newton's corrections for a residual `r`; the particles are independent."""
        return [x / a[2] for x, a in zip(r, self.angles(arithmetic, z), strict=True)]

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's corrections at `z`."""
        found = self.angles(arithmetic, z)
        return [(a[0] - exactly(arithmetic, particle[1])) / a[2] for a, particle in zip(found, PARTICLES, strict=True)]

    def landed(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Parameter and next exit angle of each particle that lands at `z`."""
        chord = load(chord_kernel(self.table, 0, 0, 0), arithmetic)
        lam = arithmetic.q(LAM.numerator, LAM.denominator)
        back = [-lam * chord(x, exactly(arithmetic, particle[0]))[0] for particle, x in zip(PARTICLES, z, strict=True)]
        return [value for pair in zip(z, back, strict=True) for value in pair]

    def turned(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The four entries of each particle's derivative matrix, for landings at `z`."""
        matrix = load(matrix_kernel(self.table), arithmetic)
        rows = [matrix(exactly(arithmetic, particle[0]), x) for particle, x in zip(PARTICLES, z, strict=True)]
        return [entry for row in rows for entry in row]

    def landings(self, map: PinballMap) -> tuple[float, ...]:
        """The landings to three decimals, as starts for Newton's method."""
        landed = map.step(*np.array(PARTICLES)[:, :2].T)
        return tuple(round(float(x), 3) for x in landed.theta)


def exactly(arithmetic: Arithmetic, x: float) -> Any:
    """The number `x`, without rounding, in any arithmetic."""
    return arithmetic.q(*x.as_integer_ratio())


@cache
def matrix_kernel(table: Table) -> Kernel:
    """The derivative matrix `d(s1, phi1)/d(s0, phi0)` by both ends of a flight. Paper: eq. (derivative_of_map)."""
    entries = dict(zip(("s_s", "s_phi", "phi_s", "phi_phi"), derivative_matrix(table, lam=str(LAM)), strict=True))
    return kernel("derivative", [theta0, theta1], entries, about="d(s1, phi1)/d(s0, phi0)")


def steps(name: str) -> Question:
    """Benchmark: parameter and exit angle after one bounce of a few particles, on the egg or the cardioid."""
    asked = Flights(SCENES[name], PARTICLES)
    system, per = ConvexFlights(asked.scene.table), len(PARTICLES)
    sought = Sought(system, system.landings(asked.map), system.landed, per)
    bound = STEP * (1 + sought.condition())
    return Question(
        f"step-{name}",
        f"One bounce, {name}",
        f"parameter and exit angle after one bounce of {per} particles on the {name}, lam = {LAM}",
        "radians",
        asked.enclosed,
        (
            running(asked, bound),
            *asked.kernels(bound),
            *sought.methods(asked.enclosed),
            Method("mpmath, every zero", "mpmath", "digits", DIGITS[:3], asked.in_mpmath, to_digits, per),
            *textbook_steps(asked),
        ),
    )


def jacobians() -> Question:
    """Benchmark: the derivative of one bounce on the egg."""
    asked = Flights(SCENES["egg"], PARTICLES, MATRICES)
    system = ConvexFlights(asked.scene.table)
    sought = Sought(system, system.landings(asked.map), system.turned, len(PARTICLES))
    return Question(
        "jacobian",
        "The derivative of one bounce, egg",
        f"d(s1, phi1)/d(s0, phi0) of {len(PARTICLES)} particles on the egg, lam = {LAM}",
        "of an entry",
        asked.enclosed,
        (*asked.kernels(MATRIX), *sought.methods(asked.enclosed), *textbook_jacobians(asked)),
    )


def running(asked: Flights, bound: float) -> Method:
    """The compiled kernel as a method, timed in a long run of many particles, which makes its overhead negligible."""
    map, count, bounces = asked.map, COUNTS[-1], 256
    starts = phase_starts(map, count, seed=1)
    own = map.states.enter(starts.component, starts.theta, starts.phi, map.law)
    lam = np.full(count, float(LAM))

    def call(setting: Any) -> list[float]:
        map.engine.run(Run(map.law), own, lam, map.shape, bounces, threads=1)
        return asked.by_kernel(map, len(asked.starts))

    promise = Decimal(f"{bound:.3g}")
    label = (f"{count} particles, {bounces} bounces",)
    return Method("compiled kernel, in a run", "float64", "", label, call, lambda _: promise, count * bounces)


def textbook_steps(asked: Flights) -> list[Method]:
    """Textbook methods for a bounce: `numpy.roots` on the cardioid; Newton's method and a plain script on the egg."""
    book = module("textbook")
    if book is None:
        return []
    lam, shape, per = float(LAM), asked.map.shape, len(PARTICLES)

    def followed(way: Callable[..., Any]) -> list[float]:
        return [x for at, phi, _ in PARTICLES for x in way(at, phi, lam, *shape)]

    if asked.scene.name == "cardioid":
        return [textbook("numpy.roots", lambda _: followed(book.cardioid_by_roots), per=per)]
    newton = textbook("Newton-Raphson on the ray", lambda _: followed(book.egg_on_the_ray), per=per)
    return [newton, *scripted(asked.scene, PARTICLES, 1)]


def textbook_jacobians(asked: Flights) -> list[Method]:
    """Textbook methods for the derivative: finite differences of the step, and the formula through `sympy.lambdify`."""
    book = module("textbook")
    if book is None:
        return []
    table, map, per = asked.scene.table, asked.map, len(PARTICLES)
    angle = chord_angle(table, order=0).whole("angle")
    lambdified = book.Lambdified([theta0, theta1], angle, list(derivative_matrix(table, lam=str(LAM))))

    def each(way: Callable[..., Any]) -> list[float]:
        return [float(x) for *particle, _ in PARTICLES for x in way(*particle)]

    def differences(other: float, h: float) -> list[float]:
        return each(lambda *particle: book.differences(map.step, map.states.speed, particle, h, other * h))

    return [
        textbook("forward differences", partial(differences, 0.0), "h", STEPS, per),
        textbook("central differences", partial(differences, -1.0), "h", STEPS, per),
        textbook("lambdify", lambda _: each(lambdified), per=per),
    ]
