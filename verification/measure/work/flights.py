"""Benchmarks on one bounce and its derivative: the flight equation in every arithmetic, and textbook methods."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from typing import Any

import numpy as np
from flint import arb
from sympy import Expr, Rational, sqrt

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec as Run
from numeric.pinball.sampling import phase_starts
from symbolic import tables
from symbolic.expressions.text import Kernel, kernel, load
from symbolic.motion.chords import chord_angle, chord_kernel, theta0, theta1
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.geometry import curvature, speed, velocity
from symbolic.tables.table import Table, theta
from verification.arithmetic.balls import Arithmetic, balls, bits_of, working
from verification.arithmetic.iteration import Vector
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.maps.exact import ExactMap
from verification.measure.work.bench import module
from verification.measure.work.question import Method, Question
from verification.measure.work.sought import DIGITS, Sought, scripted, to_digits

LAM = Fraction(19, 20)
PARTICLES = ((0.3, 0.2), (-2.0, 0.9), (1.25, -1.0), (2.75, 0.5))  # parameter and exit angle, doubles taken exactly
COUNTS = (4, 64, 4096)  # particles in a call of the kernels: the first few repeated
EPS = 2.0**-52
STEP = 8 * EPS  # over the condition number: the error that kernels claim
MATRIX = 64 * EPS
TOLERANCES = (1e-4, 1e-8, 1e-12, 1e-15)
STEPS = (1e-1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
MARGIN = 12  # digits that the flights lose at most in balls


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


def exactly(arithmetic: Arithmetic, x: float) -> Any:
    """The number `x`, without rounding, in any arithmetic."""
    return arithmetic.q(*x.as_integer_ratio())


@cache
def matrix_expressions(table: Table) -> dict[str, Expr]:
    """The derivative `d(s1, phi1)/d(s0, phi0)` in terms of both ends of a flight. Paper: eq. (derivative_of_map)."""
    (component,) = table.components
    ends = []
    for at in (theta0, theta1):
        x, y = component.point
        parts = (x, y, *velocity(component), speed(component), curvature(component))
        ends.append([part.subs(theta, at) for part in parts])
    (x0, y0, vx0, vy0, speed0, K0), (x1, y1, vx1, vy1, speed1, K1) = ends
    dx, dy = x1 - x0, y1 - y0
    t = sqrt(dx**2 + dy**2)
    cosines = (dy * vx0 - dx * vy0) / (t * speed0), (dx * vy1 - dy * vx1) / (t * speed1)
    lam = Rational(LAM.numerator, LAM.denominator)
    matrix = derivative_matrix(K0, K1, t, *cosines, lam)
    return dict(zip(("s_s", "s_phi", "phi_s", "phi_phi"), matrix, strict=True))


@cache
def matrix_kernel(table: Table) -> Kernel:
    """The derivative matrix as a generated function."""
    return kernel("derivative", [theta0, theta1], matrix_expressions(table), about="d(s1, phi1)/d(s0, phi0)")


@cache
def scene(name: str) -> tuple[Table, PinballMap, tuple[float, ...]]:
    """The exact table, its compiled map, and the landings to three decimals, as starts for Newton's method."""
    shape: dict[str, Any] = {"alpha": "2/25"} if name == "egg" else {}
    map = PinballMap(name, lam=LAM, **shape)
    table = tables.named(name).at(**shape)
    landed = map.step(*(np.array(column) for column in zip(*PARTICLES, strict=True)))
    return table, map, tuple(round(float(x), 3) for x in landed.theta)


def steps(name: str) -> Question:
    """Benchmark: parameter and exit angle after one bounce of a few particles."""
    table, map, starts = scene(name)
    sought = Sought(ConvexFlights(table), starts, ConvexFlights(table).landed, len(PARTICLES))
    bound = STEP * (1 + sought.condition())
    own = (
        running(map, bound),
        *kernels(map, stepped, bound),
        *sought.methods(lambda digits: bounced(map, digits)),
        bracketing(map),
    )
    return Question(
        f"step-{name}",
        f"One bounce, {name}",
        f"parameter and exit angle after one bounce of {len(PARTICLES)} particles on the {name}, lam = {LAM}",
        "radians",
        lambda digits: bounced(map, digits),
        (*own, *textbook_steps(map)),
    )


def jacobians() -> Question:
    """Benchmark: the derivative of one bounce on the egg."""
    table, map, starts = scene("egg")
    system = ConvexFlights(table)
    sought = Sought(system, starts, system.turned, len(PARTICLES))

    def certified(digits: int) -> list[arb]:
        landings = bounced(map, digits)[::2]
        with working(bits_of(digits + MARGIN, 64)):
            return system.turned(balls(bits_of(digits + MARGIN, 64)), landings)

    return Question(
        "jacobian",
        "The derivative of one bounce, egg",
        f"d(s1, phi1)/d(s0, phi0) of {len(PARTICLES)} particles on the egg, lam = {LAM}",
        "of an entry",
        certified,
        (*kernels(map, turned, MATRIX), *sought.methods(certified), *textbook_jacobians(map, table)),
    )


def bounced(map: PinballMap, digits: int) -> list[arb]:
    """Parameters and exit angles of the landings in balls, each proved to be the first hit."""
    enclosed = EnclosedMap(map, LAM, bits_of(digits + MARGIN, 64))
    found: list[arb] = []
    for at, phi in PARTICLES:
        landed = enclosed.bounce(enclosed.start(Fraction(at), Fraction(phi)))
        if isinstance(landed, Refusal):
            raise ValueError(f"bounce: {landed.value}")
        found += [landed.theta, landed.phi]
    return found


def bracketing(map: PinballMap) -> Method:
    """The method of the map's definition in mpmath: brackets all zeros of the flight function and takes the first."""

    def call(digits: int) -> list[Any]:
        exact = ExactMap(map, digits, LAM)
        landed = [exact.bounce(exact.start(*particle)) for particle in PARTICLES]
        return [value for each in landed for value in (each.theta, each.phi)]

    return Method("mpmath, every zero", "mpmath", "digits", DIGITS[:3], call, to_digits, len(PARTICLES))


def kernels(map: PinballMap, call: Callable[[PinballMap, Any, Any], list[float]], bound: float) -> list[Method]:
    """The compiled kernel and the same step on NumPy arrays, as methods, for a few to thousands of particles."""
    shape: dict[str, Any] = dict(zip((entry.name for entry in map.ir.shape), map.exact_shape, strict=True))
    plain = PinballMap(map.ir.table, lam=LAM, kernels=False, **shape)
    promise = Decimal(f"{bound:.3g}")

    def ran(own: PinballMap, count: int) -> list[float]:
        theta, phi = np.tile(np.array(PARTICLES), (count // len(PARTICLES), 1)).T
        return call(own, theta, phi)

    return [
        Method(name, "float64", "particles", COUNTS, partial(ran, own), lambda n: promise)
        for name, own in (("compiled kernel", map), ("NumPy", plain))
    ]


def running(map: PinballMap, bound: float) -> Method:
    """The compiled kernel as a method, timed in a long run of many particles, which makes its overhead negligible."""
    count, bounces = COUNTS[-1], 256
    starts = phase_starts(map, count, seed=1)
    own = map.states.enter(starts.component, starts.theta, starts.phi, map.law)
    lam = np.full(count, float(LAM))

    def call(setting: Any) -> list[float]:
        map.engine.run(Run(map.law), own, lam, map.shape, bounces, threads=1)
        return stepped(map, *np.array(PARTICLES).T)

    promise = Decimal(f"{bound:.3g}")
    label = (f"{count} particles, {bounces} bounces",)
    return Method("compiled kernel, in a run", "float64", "", label, call, lambda _: promise, count * bounces)


def stepped(map: PinballMap, theta: Any, phi: Any) -> list[float]:
    """Parameter and exit angle of the first few particles after one step, which is made for all particles."""
    landed = map.step(theta, phi)
    return [float(x) for pair in zip(landed.theta[: len(PARTICLES)], landed.phi, strict=False) for x in pair]


def turned(map: PinballMap, theta: Any, phi: Any) -> list[float]:
    """The derivative matrices of one bounce of the first few particles."""
    return [float(x) for x in map.derivative(theta, phi)[: len(PARTICLES)].ravel()]


def textbook_steps(map: PinballMap) -> list[Method]:
    """Textbook methods for a bounce: `numpy.roots` on the cardioid, `brentq` on the egg."""
    book, ways = module("textbook"), module("paper_ways")
    if book is None or ways is None:
        return []
    lam, shape, name = float(LAM), map.shape, map.ir.table

    def followed(way: Callable[..., Any], *more: Any) -> list[float]:
        landed = [way(0, at, phi, lam, *shape, *more)[1:] for at, phi in PARTICLES]
        return [x for pair in landed for x in pair]

    paper = Method(
        {"cardioid": "numpy.roots", "egg": "Newton-Raphson on the ray"}[name],
        "float64",
        "",
        ("to rounding",),
        lambda _: followed(getattr(ways, name)),
        per=len(PARTICLES),
        textbook=True,
    )
    if name != "egg":
        return [paper]
    brent = replace(
        paper, name="brentq", unit="xtol", settings=TOLERANCES, call=lambda x: followed(book.egg_by_brentq, x)
    )
    return [paper, replace(brent, promise=lambda x: Decimal(f"{x:.3g}")), *scripted(map.scene, PARTICLES, 1)]


def textbook_jacobians(map: PinballMap, table: Table) -> list[Method]:
    """Textbook methods for the derivative: finite differences of the step, and the formula through `sympy.lambdify`."""
    book = module("textbook")
    if book is None:
        return []
    angle = chord_angle(table, order=0).whole("angle")
    lambdified = book.Lambdified([theta0, theta1], angle, list(matrix_expressions(table).values()))

    def differences(way: Any, h: float) -> list[float]:
        return [float(x) for particle in PARTICLES for x in way(map.step, map.states.speed, particle, h)]

    made = [
        Method(
            f"{kind} differences",
            "float64",
            "h",
            STEPS,
            partial(differences, way),
            per=len(PARTICLES),
            textbook=True,
        )
        for kind, way in (("forward", book.forward), ("central", book.central))
    ]
    formula = Method(
        "lambdify",
        "float64",
        "",
        ("to rounding",),
        lambda _: [float(x) for particle in PARTICLES for x in lambdified(*particle)],
        per=len(PARTICLES),
        textbook=True,
    )
    return [*made, formula]
