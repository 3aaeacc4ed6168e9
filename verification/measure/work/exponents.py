"""Benchmarks on single numbers: proved Lyapunov exponents of a cycle and a chaotic attractor; arc length of the egg.

The inverse of arc length, the parameter at a given arc length, is a benchmark too.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cache
from typing import Any

import mpmath
import numpy as np
from flint import acb, arb, ctx
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.estimator import Count
from numeric.dynamics.statistics import Estimate, estimate
from numeric.pinball.sampling import ALIGNED, Growth, interior_starts
from symbolic import tables
from symbolic.expressions.text import Kernel, kernel, load
from symbolic.tables.geometry import speed
from symbolic.tables.table import theta
from verification.arithmetic.balls import FLOAT64, Arithmetic, balls, bits_of, multiprecision, working
from verification.arithmetic.iteration import Vector
from verification.cycles.chain import trace_and_determinant
from verification.cycles.problem import Linearised, Problem
from verification.measure.work.bench import module
from verification.measure.work.cycles import EGG, HALF, first_exit, triangle_start, whole
from verification.measure.work.question import Claimed, Method, Question, textbook
from verification.measure.work.sought import DIGITS, Sought, to_digits
from verification.named.attractors import exponents as enclosed_exponents
from verification.named.locate import proof_near
from verification.proofs.manifolds.enclosed import complex_balls
from verification.proofs.slap_map.exponent import slap_exponent

FEW, MANY = (30, 300, 3_000), (100, 10_000, 1_000_000)
ORBITS = 64
EARLY = 1_000  # bounces before the count
SHARP = 20  # digits of the density for the proved exponent of chaos
PROOFS = (4, 8, 12, 16)


def of_a_cycle() -> Question:
    """Benchmark: the larger exponent of the egg's attracting triangle."""
    start = triangle_start()
    problem = Problem(EGG, (0, 0, 0), lam=HALF)
    map = PinballMap("egg", lam="1/2", alpha="2/25")
    particle = start[0], first_exit(problem, start)
    return of_cycle_exponent(
        "exponent-cycle",
        "The exponent of an attracting cycle, egg",
        "the larger Lyapunov exponent of the attracting triangle of the egg, alpha = 2/25, lam = 1/2",
        problem,
        start,
        lambda bounces: map.exponents(*particle, bounces),
        MANY,
        textbook_exponents(map, particle),
    )


def of_cycle_exponent(
    name: str,
    title: str,
    answers: str,
    problem: Problem,
    start: tuple[float, ...],
    count: Callable[[int], Any],
    counts: tuple[int, ...],
    usual: Sequence[Method] = (),
) -> Question:
    """Benchmark on the larger exponent of a cycle: counted by the kernel, from the cycle's equations, and proved.

    `count` gives the exponents over a number of bounces.
    """
    read, certified = read_off(problem, start)
    own = Method("compiled kernel", "float64", "bounces", counts, lambda bounces: [float(count(bounces).nu_plus)])
    methods = (own, *Sought(problem, start, read).methods(certified), *usual)
    return Question(name, title, answers, "per bounce", certified, methods)


def read_off(
    problem: Problem, start: tuple[float, ...]
) -> tuple[Callable[[Arithmetic, Vector], list[Any]], Callable[[int], list[arb]]]:
    """Two functions that give the larger exponent of a cycle: from a solution of its equations, and as proved balls."""

    def read(arithmetic: Arithmetic, z: Vector) -> list[Any]:
        trace, determinant = trace_and_determinant(Linearised(problem, arithmetic, z).terms.rows)
        return [larger(arithmetic, trace, determinant, problem.period)]

    def certified(digits: int) -> list[arb]:
        proof = whole(proof_near(problem, list(start), digits + 5))
        bits = bits_of(digits, 64)
        with working(bits):
            pair = trace_and_determinant(Linearised(problem, balls(bits), proof.enclosure.zero).terms.rows)
            return [enclosed_exponents(*pair, problem.period)[0]]

    return read, certified


def larger(arithmetic: Arithmetic, trace: Any, determinant: Any, period: int) -> Any:
    """The larger exponent per bounce of a cycle, in any arithmetic."""
    gap = trace * trace - 4 * determinant
    if gap < 0:
        return arithmetic.log(abs(determinant)) / (2 * period)
    return arithmetic.log((abs(trace) + arithmetic.sqrt(gap)) / 2) / period


def of_chaos() -> Question:
    """Benchmark: the exponent of the cardioid at `lam = 0`, whose chaotic attractor has a proved natural measure.

    The radius of the reference is below 1e-18, for any number of digits.
    """
    map, plain = (PinballMap("cardioid", lam=0, kernels=kernels) for kernels in (True, False))
    starts = interior_starts(map, ORBITS, seed=7)
    growth = Growth(map, starts.theta, starts.phi, starts.component)
    growth.skip(EARLY)
    going = growth.code == 0
    points = growth.theta[going], growth.phi[going], growth.component[going]

    def counted(bounces: int) -> Claimed:
        found = estimated(map, points, bounces)
        return Claimed([found.mean], found.reach)

    def plainly(bounces: int) -> list[float]:
        growth, each = Growth(plain, *points), max(bounces // ORBITS, 1)
        growth.advance(ALIGNED)
        before = growth.stretch
        growth.advance(each)
        return [float(np.mean(growth.stretch - before) / each)]

    own = [
        Method("compiled kernel, error bar", "float64", "bounces", (1_000, 30_000, 1_000_000, 10_000_000), counted),
        Method("NumPy", "float64", "bounces", (1_000, 10_000, 100_000), plainly),
        Method("arb, certified", "arb", "digits", PROOFS, lambda d: [proved(d + 2)], to_digits, proved=True),
    ]
    return Question(
        "exponent-chaos",
        "The exponent of a chaotic attractor, cardioid",
        "the Lyapunov exponent of the cardioid at lam = 0, its slap map",
        "per bounce",
        lambda digits: [sharply()],
        (*own, *textbook_exponents(map, (float(points[0][0]), float(points[1][0])))),
        most_digits=16,
    )


def proved(digits: int) -> arb:
    """The exponent of the cardioid at `lam = 0` in a ball of radius below `10**(2 - digits)`."""
    proof = slap_exponent(digits)
    if not proof.certified:
        raise ArithmeticError(f"exponent-chaos: with {digits} digits only {proof.checks} is proved")
    return proof.value


@cache
def sharply() -> arb:
    """The exponent of the cardioid at `lam = 0` to `SHARP` digits, as the reference."""
    return proved(SHARP)


def estimated(map: PinballMap, points: tuple[Any, Any, Any], bounces: int) -> Estimate:
    """The larger exponent over so many bounces in all, from points on an attractor, with its standard error.

    `points` are parameters, exit angles and components, `ORBITS` at most.
    """
    growth = Growth(map, *points)
    growth.settle(ALIGNED)
    count = Count(growth, most=64)
    for _ in count.until(max(bounces // ORBITS, 8)):
        pass
    return estimate(count.up)


def textbook_exponents(map: PinballMap, particle: tuple[float, float]) -> list[Method]:
    """Textbook methods for the exponent: two neighbouring particles; QR of one matrix after the other."""
    book = module("textbook")
    if book is None:
        return []
    pair = textbook("two particles", lambda n: [book.two_particles(map.step, particle, n)], "bounces", FEW)
    by_qr = textbook(
        "QR, bounce by bounce", lambda n: [book.by_qr(map.step, map.derivative, particle, n)], "bounces", FEW
    )
    return [pair, by_qr]


ALPHA = Rational(2, 25)
AT = (-2.5, 1.0)  # parameters and, for the inverse, arc lengths: doubles taken exactly
COUNTS = (2, 64, 4096)
TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
POINTS, GRIDS = "grid points", (100, 5_000, 200_000)
ROUNDING = Decimal("1.4e-14")  # 64 units of 2**-52, as the perimeter is 6.5
GUARD = 15


@cache
def speed_kernel() -> Kernel:
    """The speed `ds/dtheta` as a generated function."""
    (component,) = tables.egg(3).at(alpha=ALPHA).components
    return kernel("speed", [theta], {"speed": speed(component)}, about="ds/dtheta of the egg")


def length(x: Any) -> Any:
    """Arc length from 0 to `x` in the arithmetic of `x`: by SciPy, by mpmath, or enclosed in a ball."""
    if isinstance(x, arb):
        return enclosed_length(x)
    if isinstance(x, mpmath.ctx_mp_python._mpf):
        own = load(speed_kernel(), multiprecision(x.context))
        return x.context.quad(lambda at: own(at)[0], [0, x])
    from scipy.integrate import quad

    own = load(speed_kernel(), FLOAT64)
    return quad(lambda at: own(at)[0], 0.0, float(x), epsabs=1e-13, epsrel=1e-13)[0]


def enclosed_length(x: arb) -> arb:
    """Arc length in balls, by FLINT's integral up to the midpoint of `x`, plus the speed times the radius of `x`."""
    middle = x.mid()
    whole: arb = acb.integral(analytic_speed, acb(0), acb(middle)).real
    rest: arb = (x - middle) * load(speed_kernel(), balls(bits_of(30)))(x)[0]
    return whole + rest


def analytic_speed(z: acb, analytic: bool) -> acb:
    """The speed at a complex ball; with `analytic`, not finite if the square root might not be analytic on the ball."""
    words = replace(complex_balls(ctx.prec), sqrt=lambda w: acb(w).sqrt(analytic=analytic))
    found: acb = load(speed_kernel(), words)(z)[0]
    return found


@dataclass(frozen=True)
class Inverse:
    """The equations for the parameters at given arc lengths."""

    label: str = "egg, the parameter at an arc length"

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Differences between the arc lengths at the parameters `z` and the given arc lengths."""
        return [length(x) - s for x, s in zip(z, AT, strict=True)]

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """Newton's corrections for a residual `r`."""
        own = load(speed_kernel(), arithmetic)
        return [e / own(x)[0] for e, x in zip(r, z, strict=True)]

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's corrections at `z`, computed from the residual there."""
        return self.solved(arithmetic, z, self.value(arithmetic, z))


def certified(digits: int) -> list[arb]:
    """The arc lengths at the benchmark's parameters, enclosed in balls."""
    with working(bits_of(digits, 32)):
        return [enclosed_length(arb(x)) for x in AT]


def lengths() -> Question:
    """Benchmark: the egg's arc length at some parameters."""
    map = PinballMap("egg", alpha="2/25")
    map.arclength.s(np.array(AT))

    def in_mpmath(digits: int) -> list[Any]:
        context = mpmath.MPContext()
        context.dps = digits + GUARD
        return [length(context.mpf(x)) for x in AT]

    own = [
        Method(
            "Fourier series (NumPy)",
            "float64",
            "points",
            COUNTS,
            lambda n: map.arclength.s(np.tile(AT, n // len(AT)))[: len(AT)].tolist(),
            lambda _: ROUNDING,
        ),
        Method("mpmath.quad", "mpmath", "digits", DIGITS[:4], in_mpmath, to_digits, len(AT)),
        Method("arb, certified", "arb", "digits", DIGITS, certified, to_digits, len(AT), proved=True),
    ]
    return Question(
        "arclength",
        "Arc length, egg",
        f"the arc length from theta = 0 to {len(AT)} parameters on the egg, alpha = {ALPHA}",
        "of the length",
        certified,
        (*own, *textbook_lengths(map)),
    )


def parameters() -> Question:
    """Benchmark: the parameters of points at given arc lengths in the egg."""
    map = PinballMap("egg", alpha="2/25")
    start = tuple(round(float(x), 3) for x in map.arclength.theta(np.array(AT)))
    sought = Sought(Inverse(), start, per=len(AT))
    own = Method(
        "Fourier series, Newton (NumPy)",
        "float64",
        "points",
        COUNTS,
        lambda n: map.arclength.theta(np.tile(AT, n // len(AT)))[: len(AT)].tolist(),
        lambda _: ROUNDING,
    )
    kept = [m for m in sought.methods() if m.arithmetic != "longdouble"]  # SciPy and NumPy integrate in doubles
    slow = [replace(m, settings=DIGITS[:4]) if m.arithmetic == "mpmath" else m for m in kept]
    return Question(
        "arclength-inverse",
        "The parameter at an arc length, egg",
        f"theta of the points at {len(AT)} given arc lengths on the egg, alpha = {ALPHA}",
        "radians",
        sought.enclosed,
        (own, *slow, *textbook_parameters(map)),
        most_digits=300,
    )


def _speed(map: PinballMap) -> Any:
    def speed(at: Any) -> Any:
        flat = np.atleast_1d(np.asarray(at, dtype=float))
        found = map.states.speed(np.zeros(flat.shape, dtype=np.int64), flat)
        return found if np.ndim(at) else float(found[0])

    return speed


def textbook_lengths(map: PinballMap) -> list[Method]:
    """Textbook methods for arc length: `scipy.integrate.quad`, and the trapezoidal rule on a grid."""
    book, own, per = module("textbook"), _speed(map), len(AT)
    if book is None:
        return []
    return [
        textbook("quad", lambda x: [book.length_by_quad(own, at, x) for at in AT], "epsabs", TOLERANCES, per),
        textbook("trapezia on a grid", lambda n: [book.length_by_sums(own, at, n) for at in AT], POINTS, GRIDS, per),
    ]


def textbook_parameters(map: PinballMap) -> list[Method]:
    """Textbook methods for the parameter: `brentq` over `quad`, and interpolation of sums of the trapezoidal rule."""
    book, own, per = module("textbook"), _speed(map), len(AT)
    if book is None:
        return []
    return [
        textbook(
            "brentq over quad", lambda x: [book.parameter_by_brentq(own, s, x) for s in AT], "xtol", TOLERANCES, per
        ),
        textbook("interpolated grid", lambda n: [book.parameter_by_sums(own, s, n) for s in AT], POINTS, GRIDS, per),
    ]
