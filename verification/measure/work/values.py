"""Two values that are no fold and no flip: `lambda*` of the cuspless cardioid, the least expansion of the slap map."""

from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from typing import Any

import mpmath
from flint import arb, fmpz_poly
from sympy import Symbol, sqrt

from numeric import PinballMap
from symbolic.cycles.cardioid_slap import LAUNCH_Q2, q, slope_squared
from symbolic.generation.text import Kernel, kernel, load
from verification.arithmetic.words import FLOAT64, Arithmetic, balls, bits_of, multiprecision, working
from verification.cycles.recurrence.chain import Vector
from verification.cycles.shooting.small import corner
from verification.measure.speed.baselines import module
from verification.measure.work.question import Method, Question
from verification.measure.work.sought import DIGITS, Sought, last, to_digits
from verification.named.locate import lambda_star

TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
CORNER = 0.254, 0.071
LEAST = -0.417  # the landing point q, about where the expansion is least


def corner_orbit() -> Question:
    """`lambda*`, at which the orbit through both corners exists. Paper: section 5.2."""
    return Question(
        "lambda-star",
        "lambda*, cuspless cardioid",
        "the contraction at which an orbit of period 4 joins both corners of the cuspless cardioid",
        "in lam",
        lambda digits: [lambda_star(digits).ball],
        (*Sought(corner(), CORNER, last).methods(lambda d: [lambda_star(d).ball]), *textbook_corner()),
    )


def textbook_corner() -> list[Method]:
    """brentq for the contraction, around a brentq for the landing; mpmath's findroot in place of both."""
    book = module("textbook")
    if book is None:
        return []

    def nested(xtol: float) -> list[float]:
        return [book.corner_by_brentq(xtol)]

    def secant(digits: int) -> list[Any]:
        return [book.corner_by_findroot(digits)]

    return [
        Method("brentq in brentq", "float64", "xtol", TOLERANCES, nested, lambda x: Decimal(f"{x:.3g}"), textbook=True),
        Method("mpmath.findroot", "mpmath", "digits", DIGITS[:4], secant, to_digits, textbook=True),
    ]


@cache
def criticality() -> tuple[Kernel, Kernel]:
    """The logarithmic slope of the expansion along the branch that changes halves, its derivative; the expansion."""
    x = Symbol("landing", real=True)
    first, second = slope_squared(x), slope_squared(-sqrt(LAUNCH_Q2.subs(q, x)))
    slope = first.diff(x) / first + second.diff(x) / second
    own = kernel("critical", [x], {"slope": slope, "bend": slope.diff(x)}, about="d log|(T0^2)'|^2 / dq")
    return own, kernel("expansion", [x], {"expansion": sqrt(first * second)}, about="|(T0^2)'|")


@dataclass(frozen=True)
class Critical:
    """One equation: the expansion is stationary in the landing point `q`. See `symbolic.cycles.cardioid_slap`."""

    label: str = "cardioid, the least expansion"

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The logarithmic slope."""
        return [load(criticality()[0], arithmetic)(*z)[0]]

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """The correction for a residual."""
        return [r[0] / load(criticality()[0], arithmetic)(*z)[1]]

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's correction."""
        slope, bend = load(criticality()[0], arithmetic)(*z)
        return [slope / bend]


def expansion(arithmetic: Arithmetic, z: Vector) -> Vector:
    """`|(T0^2)'|` at a landing point."""
    return [load(criticality()[1], arithmetic)(z[0])[0]]


def slap_infimum() -> Question:
    """The least `|(T0^2)'|` on the cardioid. Paper: section 4.2, from a plot."""
    sought = Sought(Critical(), (LEAST,), expansion)
    return Question(
        "slap-infimum",
        "The least expansion of the slap map",
        "the infimum of |(T0^2)'| on the cardioid, proved to be where it is stationary",
        "of the slope",
        sought.enclosed,
        (*sought.methods(), *by_polynomial(), *textbook_infimum()),
    )


def by_polynomial() -> list[Method]:
    """The zero of a polynomial of degree 22, isolated by FLINT with a proof."""
    book = module("textbook")
    if book is None:
        return []
    polynomial = fmpz_poly([int(c) for c in reversed(book.CRITICAL)])

    def call(digits: int) -> list[arb]:
        with working(bits_of(digits, 64)):
            roots: Any = polynomial.complex_roots()  # python-flint's own types say otherwise
            zeros = [root.real for root, _ in roots if root.imag == 0]
            (zero,) = (z for z in zeros if abs(z - arb(book.NEAR)) < arb("0.01"))
            return expansion(balls(bits_of(digits, 64)), [zero])

    return [Method("arb, polynomial", "arb", "digits", DIGITS[:4], call, to_digits, proved=True)]


def textbook_infimum() -> list[Method]:
    """A grid, a search, and the roots of the polynomial by NumPy and mpmath."""
    book = module("textbook")
    if book is None:
        return []
    map = PinballMap("cardioid", lam=0)

    def roots(setting: Any) -> list[float]:
        return expansion(FLOAT64, [book.critical_by_roots()])

    def polyroots(digits: int) -> list[Any]:
        context = mpmath.MPContext()
        context.dps = digits
        found = context.polyroots([context.mpf(c) for c in book.CRITICAL], maxsteps=400, extraprec=10 * digits + 200)
        real = [z.real for z in found if abs(z.imag) < context.mpf(10) ** (-digits // 2)]
        near = min(real, key=lambda z: abs(z - book.NEAR))
        return expansion(multiprecision(context), [near])

    def promise(x: float) -> Decimal:
        return Decimal(f"{x:.3g}")

    return [
        Method(
            "grid",
            "float64",
            "grid points",
            (100, 5_000, 200_000),
            lambda n: [book.expansion_on_grid(map.slap, n)],
            textbook=True,
        ),
        Method(
            "minimize_scalar",
            "float64",
            "xtol",
            TOLERANCES,
            lambda x: [book.expansion_by_search(map.slap, x)],
            promise,
            textbook=True,
        ),
        Method("numpy.roots", "float64", "", ("to rounding",), roots, textbook=True),
        Method("mpmath.polyroots", "mpmath", "digits", DIGITS[:3], polyroots, to_digits, textbook=True),
    ]
