"""A Lyapunov exponent, against collisions: of an attracting cycle, and of a chaotic attractor; both are proved."""

from functools import cache
from typing import Any

import numpy as np
from flint import arb

from numeric import PinballMap
from numeric.dynamics.exponents import ALIGNED, Count
from numeric.dynamics.statistics import Estimate, estimate
from numeric.pinball.growth import Growth
from numeric.pinball.sampling import interior_starts
from verification.arithmetic.words import Arithmetic, balls, bits_of, working
from verification.cycles.recurrence.chain import Vector, trace_and_determinant
from verification.cycles.shooting.problem import Linearised, Problem, Rows
from verification.measure.speed.baselines import module
from verification.measure.work.cycles import EGG, HALF, first_exit, triangle_start, whole
from verification.measure.work.question import Claimed, Method, Question
from verification.measure.work.sought import Sought, to_digits
from verification.named.attractors import exponents as enclosed_exponents
from verification.named.locate import certify
from verification.proofs.slap_map.chaotic_exponent import slap_exponent

FEW, MANY = (30, 300, 3_000), (100, 10_000, 1_000_000)
ORBITS = 64
EARLY = 1_000  # bounces before anything is counted
SHARP = 20  # digits of the density behind the proved exponent of chaos
PROOFS = (4, 8, 12, 16)


def of_a_cycle() -> Question:
    """The larger exponent of the egg's attracting triangle."""
    start = triangle_start()
    problem = Problem(EGG, (0, 0, 0), lam=HALF)
    map = PinballMap("egg", lam="1/2", alpha="2/25")
    ball = start[0], first_exit(problem, start)

    def read(arithmetic: Arithmetic, z: Vector) -> list[Any]:
        trace, determinant = trace_and_determinant(Linearised(Rows(problem, arithmetic), z).plain.rows)
        return [larger(arithmetic, trace, determinant, 3)]

    def certified(digits: int) -> list[arb]:
        proof = whole(certify(problem, list(start), digits + 5))
        bits = bits_of(digits, 64)
        with working(bits):
            pair = trace_and_determinant(Linearised(Rows(problem, balls(bits)), proof.enclosure.zero).plain.rows)
            return [enclosed_exponents(*pair, 3)[0]]

    def counted(bounces: int) -> list[float]:
        return [float(map.exponents(*ball, bounces).nu_plus)]

    own = Method("compiled kernel", "float64", "bounces", MANY, counted)
    return Question(
        "exponent-cycle",
        "The exponent of an attracting cycle, egg",
        "the larger Lyapunov exponent of the attracting triangle of the egg, alpha = 2/25, lam = 1/2",
        "per bounce",
        certified,
        (own, *Sought(problem, start, read).methods(certified), *textbook(map, ball)),
    )


def larger(arithmetic: Arithmetic, trace: Any, determinant: Any, period: int) -> Any:
    """The larger exponent per bounce of a cycle, in any arithmetic."""
    gap = trace * trace - 4 * determinant
    if gap < 0:
        return arithmetic["log"](abs(determinant)) / (2 * period)
    return arithmetic["log"]((abs(trace) + arithmetic["sqrt"](gap)) / 2) / period


def of_chaos() -> Question:
    """The exponent of the cardioid at `lam = 0`, whose chaotic attractor has a proved natural measure.

    The radius of the reference is below 1e-18, however many digits are asked for.
    """
    map = PinballMap("cardioid", lam=0)

    def counted(bounces: int) -> Claimed:
        found = run(map, ORBITS, max(bounces // ORBITS, 8))
        return Claimed([found.mean], found.interval)

    def plainly(bounces: int) -> list[float]:
        growth = Growth(numpy_map(map), *fixed_starts(map, ORBITS))
        growth.advance(ALIGNED)
        before = growth.stretch
        growth.advance(max(bounces // ORBITS, 1))
        return [float(np.mean(growth.stretch - before) / max(bounces // ORBITS, 1))]

    start = fixed_starts(map, 1)
    ball = float(start[1][0]), float(start[2][0])
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
        (*own, *textbook(map, ball)),
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
    """The same, as sharp as the reference is."""
    return proved(SHARP)


def numpy_map(map: PinballMap) -> PinballMap:
    """The same map on NumPy arrays."""
    return PinballMap(map.blueprint.table, lam=float(map.lam), kernels=False)


def run(map: PinballMap, orbits: int, bounces: int) -> Estimate:
    """The exponent over some orbits, with the error of batch means."""
    growth = Growth(map, *fixed_starts(map, orbits))
    growth.advance(ALIGNED)
    count = Count(growth, most=64)
    for _ in count.until(bounces):
        pass
    return estimate(count.up)


@cache
def _arrived(name: str, lam: float, orbits: int) -> tuple[Any, Any, Any]:
    map = PinballMap(name, lam=lam)
    starts = interior_starts(map, orbits, seed=7)
    growth = Growth(map, starts.component, starts.theta, starts.phi)
    growth.skip(EARLY)
    going = growth.code == 0
    return growth.component[going], growth.theta[going], growth.phi[going]


def fixed_starts(map: PinballMap, orbits: int) -> tuple[Any, Any, Any]:
    """Balls on the attractor: component, parameter, exit angle."""
    return _arrived(map.blueprint.table, float(map.lam), orbits)


def textbook(map: PinballMap, ball: tuple[float, float]) -> list[Method]:
    """Two neighbouring balls, and QR of one matrix after the other."""
    book = module("textbook")
    if book is None:
        return []
    return [
        Method("two balls", "float64", "bounces", FEW, lambda n: [book.two_balls(map.step, ball, n)], textbook=True),
        Method(
            "QR, bounce by bounce",
            "float64",
            "bounces",
            FEW,
            lambda n: [book.by_qr(map.step, map.derivative, ball, n)],
            textbook=True,
        ),
    ]
