"""Benchmark: one system of equations, solved in every arithmetic.

Newton's method on the same generated formulas in float64, in NumPy's long doubles, in mpmath with digits that double at
each step, in the midpoints of balls, and in balls with a proof. All start from the same few decimals. Two such problems
are defined here: `lambda*` of the cuspless cardioid, and the least expansion of the cardioid's slap map.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cache, partial
from typing import Any

import numpy as np
from flint import arb
from sympy import Symbol, sqrt

from numeric import PinballMap
from symbolic.cycles.cardioid_slap import LAUNCH_Q2, q, slope_squared
from symbolic.expressions.text import Kernel, kernel, load
from symbolic.tables.definition import POINTS
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import (
    ARRAYS,
    FLOAT64,
    FUNCTIONS,
    Arithmetic,
    balls,
    bits_of,
    multiprecision,
    working,
)
from verification.arithmetic.iteration import Stop, Vector, iterated
from verification.cycles.critical import corner
from verification.cycles.newton import (
    ATTEMPTS,
    GUARD,
    System,
    enough_digits,
    floats,
    levels,
    norm_of_inverse,
    refined,
    settled,
)
from verification.measure.work.bench import module
from verification.measure.work.plain import egg_orbit
from verification.measure.work.question import Method, Question, power, textbook
from verification.named.locate import lambda_star
from verification.proofs.periodic.interval_newton import ZeroStatus, interval_newton

Read = Callable[[Arithmetic, list[Any]], list[Any]]
DIGITS = (16, 30, 100, 300, 1000)
LONG_PI = np.longdouble("3.14159265358979323846264338327950288")
LONG: Arithmetic = replace(
    ARRAYS,
    pi=LONG_PI,
    q=lambda p, n: np.longdouble(p) / np.longdouble(n),
    root=lambda x, n: x ** (np.longdouble(1) / n),
    **{word: getattr(np, {"atan": "arctan"}.get(word, word)) for word in FUNCTIONS},  # not `ARRAYS`' for doubles
)
ROUNDINGS = 16  # units in the last place: error of a residual and of the values read off


def unknowns(arithmetic: Arithmetic, z: list[Any]) -> list[Any]:
    """The whole solution `z` of a system, for a question about all unknowns."""
    return z


def last(arithmetic: Arithmetic, z: list[Any]) -> list[Any]:
    """The last unknown of the solution `z`, which is the free parameter of the system."""
    return z[-1:]


@dataclass(frozen=True)
class Sought:
    """The values that `read` takes from the solution of `system` near `start`: `per` answers from one solution."""

    system: System
    start: tuple[float, ...]
    read: Read = unknowns
    per: int = 1

    def methods(self, certified: Callable[[int], list[arb]] | None = None) -> tuple[Method, ...]:
        """Methods in every arithmetic; `certified(digits)` gives the proof, by default that of the system's zero."""
        proof = certified or self.enclosed
        return (
            Method("float64, Newton", "float64", "", ("to rounding",), self.in_floats, self.rounding, self.per),
            Method("long double", "longdouble", "", (_width(),), self.in_long, self.long_rounding, self.per),
            Method("mpmath", "mpmath", "digits", DIGITS, self.in_mpmath, to_digits, self.per),
            Method("arb, no proof", "arb", "digits", DIGITS, self.in_arb, to_digits, self.per),
            Method("arb, certified", "arb", "digits", DIGITS, proof, to_digits, self.per, proved=True),
        )

    def in_floats(self, setting: Any = None) -> list[float]:
        """The values by Newton's method in float64, iterated until the corrections stop shrinking."""
        return self.read(FLOAT64, floats(self.system, self.start))

    def in_long(self, setting: Any = None) -> list[Any]:
        """The values by Newton's method in NumPy's long doubles."""
        found = settled(self.system, LONG, [np.longdouble(x) for x in self.start])
        if not found.settled:
            raise ValueError(f"{self.system.label}: Newton's method in {_width()} did not settle")
        return self.read(LONG, found.x)

    def in_mpmath(self, digits: int) -> list[Any]:
        """The values by Newton's method in mpmath, from the float64 root."""
        solution = refined(self.system, self.start, digits)
        context = type(solution.z[0]).context
        return self.read(multiprecision(context), solution.z)

    def in_arb(self, digits: int) -> list[arb]:
        """The values by Newton's method on the midpoints of balls, without a proof."""
        z = self.middle(digits + GUARD)
        with working(bits_of(digits + GUARD)):
            return [x.mid() for x in self.read(balls(bits_of(digits + GUARD)), z)]

    def middle(self, digits: int) -> list[arb]:
        """An approximate solution in arb's floating-point numbers; Newton's method doubles the digits at each step."""
        z = [arb(x) for x in floats(self.system, self.start)]
        for level in levels(digits):
            bits = bits_of(level, 8)
            with working(bits):
                stop = Stop(enough=arb(10) ** -int(enough_digits(level, digits)), steps=ATTEMPTS)
                z = iterated(partial(self.system.newton, balls(bits)), z, stop, kept=arb.mid).x
        return z

    def enclosed(self, digits: int) -> list[arb]:
        """Balls that hold the values at the unique zero near the start, proved by the interval Newton operator."""
        bits = bits_of(digits, 64 + 8 * len(self.start).bit_length())
        with working(bits):
            radius = (arb(10) ** -(digits + 5)).mid()
        found = interval_newton(self.system, self.middle(digits + 8), radius, bits)
        if found.status is not ZeroStatus.UNIQUE:
            raise ValueError(f"{self.system.label}: {found.status.value}")
        with working(bits):
            return self.read(balls(bits), found.zero)

    def condition(self) -> float:
        """The condition number: the largest change of the solution for a residual of size one."""
        return norm_of_inverse(self.system, FLOAT64, floats(self.system, self.start))

    def rounding(self, setting: Any = None) -> Decimal:
        """The error that float64 claims: the condition number times a few roundings."""
        return Decimal(f"{ROUNDINGS * 2.0**-52 * (1 + self.condition()):.3g}")

    def long_rounding(self, setting: Any = None) -> Decimal:
        """The error that a long double claims."""
        return Decimal(f"{ROUNDINGS * float(np.finfo(np.longdouble).eps) * (1 + self.condition()):.3g}")


def scripted(scene: Scene, starts: Sequence[Sequence[Any]], bounces: int) -> list[Method]:
    """A plain mpmath script for the last bounces, as a method, in the egg with the paper's law; otherwise empty."""
    if scene.name != "egg" or scene.K != POINTS or not scene.law.uniform:
        return []
    alpha, lam = str(scene.shape["alpha"]), str(scene.lam)

    def call(digits: int) -> list[Any]:
        return [x for start in starts for x in egg_orbit(start[:2], bounces, digits, alpha, lam)[-1]]

    return [Method("plain script", "mpmath", "digits", DIGITS, call, per=len(starts), textbook=True)]


def to_digits(digits: int) -> Decimal:
    """The error `10**-digits`, which a method with so many digits claims."""
    return power(-digits)


def _width() -> str:
    return f"{np.finfo(np.longdouble).nmant + 1} bits"


TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
CORNER = 0.254, 0.071
LEAST = -0.417  # approximate landing point q where the expansion is least


def corner_orbit() -> Question:
    """Benchmark: `lambda*`, at which the orbit through both corners exists. Paper: section 5.2."""
    return Question(
        "lambda-star",
        "lambda*, cuspless cardioid",
        "the contraction at which an orbit of period 4 joins both corners of the cuspless cardioid",
        "in lam",
        lambda digits: [lambda_star(digits).ball],
        (*Sought(corner(), CORNER, last).methods(lambda d: [lambda_star(d).ball]), *textbook_corner()),
    )


def textbook_corner() -> list[Method]:
    """Textbook methods for `lambda*`: nested `brentq` (contraction outside, landing inside); mpmath's `findroot`."""
    book = module("textbook")
    if book is None:
        return []
    return [
        textbook("brentq in brentq", lambda xtol: [book.corner_by_brentq(xtol)], "xtol", TOLERANCES),
        textbook("mpmath.findroot", lambda digits: [book.corner_by_findroot(digits)], "digits", DIGITS[:4]),
    ]


@cache
def criticality() -> tuple[Kernel, Kernel]:
    """Two kernels of the slap map `T0`: the logarithmic slope of `|(T0^2)'|` and its derivative; `|(T0^2)'|` itself."""
    x = Symbol("landing", real=True)
    first, second = slope_squared(x), slope_squared(-sqrt(LAUNCH_Q2.subs(q, x)))
    slope = first.diff(x) / first + second.diff(x) / second
    own = kernel("critical", [x], {"slope": slope, "bend": slope.diff(x)}, about="d log|(T0^2)'|^2 / dq")
    return own, kernel("expansion", [x], {"expansion": sqrt(first * second)}, about="|(T0^2)'|")


@dataclass(frozen=True)
class StationaryExpansion:
    """The equation that `|(T0^2)'|` of the slap map is stationary. See `symbolic.cycles.cardioid_slap`."""

    label: str = "cardioid, the least expansion"

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The logarithmic slope of the expansion."""
        return [load(criticality()[0], arithmetic)(*z)[0]]

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """Newton's correction for a residual `r`."""
        return [r[0] / load(criticality()[0], arithmetic)(*z)[1]]

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's correction at `z`."""
        slope, bend = load(criticality()[0], arithmetic)(*z)
        return [slope / bend]


def expansion(arithmetic: Arithmetic, z: Vector) -> Vector:
    """The expansion `|(T0^2)'|` of the slap map's second iterate at a landing point."""
    return [load(criticality()[1], arithmetic)(z[0])[0]]


def slap_infimum() -> Question:
    """Benchmark: the least slope `|(T0^2)'|` of the cardioid's slap map `T0`. Paper: section 4.2, from a plot."""
    sought = Sought(StationaryExpansion(), (LEAST,), expansion)
    return Question(
        "slap-infimum",
        "The least expansion of the slap map",
        "the infimum of |(T0^2)'| on the cardioid, proved to be where it is stationary",
        "of the slope",
        sought.enclosed,
        (*sought.methods(), *textbook_infimum()),
    )


def textbook_infimum() -> list[Method]:
    """Textbook methods for the least slope: a grid of launching points, and a search from what a plot shows."""
    book = module("textbook")
    if book is None:
        return []
    slap = PinballMap("cardioid", lam=0).slap
    return [
        textbook("grid", lambda n: [book.expansion_on_grid(slap, n)], "grid points", (100, 5_000, 200_000)),
        textbook("minimize_scalar", lambda xtol: [book.expansion_by_search(slap, xtol)], "xtol", TOLERANCES),
    ]
