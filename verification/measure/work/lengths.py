"""Arc length on the egg, and the parameter at a given arc length."""

from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cache
from typing import Any

import mpmath
import numpy as np
from flint import acb, arb
from sympy import Rational

from numeric import PinballMap
from symbolic import tables
from symbolic.generation.text import Kernel, kernel, load
from symbolic.tables.geometry import speed
from symbolic.tables.symbols import theta
from verification.arithmetic.words import FLOAT64, Arithmetic, balls, bits_of, multiprecision, working
from verification.cycles.recurrence.chain import Vector
from verification.measure.speed.baselines import module
from verification.measure.work.question import Method, Question, available
from verification.measure.work.sought import DIGITS, WITHOUT, Sought, to_digits

ALPHA = Rational(2, 25)
AT = (-2.5, 1.0)  # parameters and, for the inverse, arc lengths: doubles taken exactly
COUNTS = (2, 64, 4096)
TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)
GRIDS = (100, 5_000, 200_000)
ROUNDING = Decimal("1.4e-14")  # 64 units of 2**-52, as the perimeter is 6.5
GUARD = 15


@cache
def speed_kernel() -> Kernel:
    """`ds/dtheta` as a generated function."""
    (component,) = tables.egg(3).at(alpha=ALPHA).components
    return kernel("speed", [theta], {"speed": speed(component)}, about="ds/dtheta of the egg")


def length(x: Any) -> Any:
    """Arc length from 0 to `x` in the arithmetic of `x`: by SciPy, by mpmath, or enclosed."""
    if isinstance(x, arb):
        return enclosed_length(x)
    if isinstance(x, mpmath.ctx_mp_python._mpf):
        own = load(speed_kernel(), multiprecision(x.context))
        return x.context.quad(lambda at: own(at)[0], [0, x])
    from scipy.integrate import quad

    own = load(speed_kernel(), FLOAT64)
    return quad(lambda at: own(at)[0], 0.0, float(x), epsabs=1e-13, epsrel=1e-13)[0]


def enclosed_length(x: arb) -> arb:
    """Arc length in balls, by FLINT's integral: for a ball, over its middle, and the speed times the radius."""
    middle = x.mid()
    whole: arb = acb.integral(analytic_speed, acb(0), acb(middle)).real
    rest: arb = (x - middle) * load(speed_kernel(), balls(bits_of(30)))(x)[0]
    return whole + rest


def analytic_speed(z: acb, analytic: bool) -> acb:
    """The speed at a complex ball; not finite where the root might not be analytic, when that is asked."""
    words = {
        "q": lambda p, n: acb(p) / n,
        "sqrt": lambda w: acb(w).sqrt(analytic=analytic),
        "sin": lambda w: w.sin(),
        "cos": lambda w: w.cos(),
    }
    found: acb = load(speed_kernel(), words)(z)[0]
    return found


@dataclass(frozen=True)
class Inverse:
    """The parameters at given arc lengths."""

    label: str = "egg, the parameter at an arc length"

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """How far each length is from what it should be."""
        return [length(x) - s for x, s in zip(z, AT, strict=True)]

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """The corrections for a residual."""
        own = load(speed_kernel(), arithmetic)
        return [e / own(x)[0] for e, x in zip(r, z, strict=True)]

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's corrections."""
        return self.solved(arithmetic, z, self.value(arithmetic, z))


def certified(digits: int) -> list[arb]:
    """The lengths, enclosed."""
    with working(bits_of(digits, 32)):
        return [enclosed_length(arb(x)) for x in AT]


def lengths() -> Question:
    """Arc length at some parameters."""
    map = PinballMap("egg", alpha="2/25")
    map.arclength.s(np.array(AT))

    def in_mpmath(digits: int) -> list[Any]:
        context = mpmath.MPContext()
        context.dps = digits + GUARD
        return [length(context.mpf(x)) for x in AT]

    quad = Method("mpmath.quad", "mpmath", "digits", DIGITS[:4], in_mpmath, to_digits, len(AT))
    own = [
        Method(
            "Fourier series (NumPy)",
            "float64",
            "points",
            COUNTS,
            lambda n: map.arclength.s(np.tile(AT, n // len(AT)))[: len(AT)].tolist(),
            lambda _: ROUNDING,
        ),
        quad,
        Method("arb, certified", "arb", "digits", DIGITS, certified, to_digits, len(AT), proved=True),
    ]
    if available():
        own.insert(2, replace(quad, name=WITHOUT, elsewhere=True))
    return Question(
        "arclength",
        "Arc length, egg",
        f"the arc length from theta = 0 to {len(AT)} parameters on the egg, alpha = {ALPHA}",
        "of the length",
        certified,
        (*own, *textbook_lengths(map)),
    )


def parameters() -> Question:
    """The parameters at some arc lengths."""
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
    slow = [replace(m, ladder=DIGITS[:4]) if m.arithmetic == "mpmath" else m for m in kept]
    return Question(
        "arclength-inverse",
        "The parameter at an arc length, egg",
        f"the parameter at {len(AT)} arc lengths on the egg, alpha = {ALPHA}",
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
    """`scipy.integrate.quad`, and trapezia on a grid."""
    book, own = module("textbook"), _speed(map)
    if book is None:
        return []
    return _pair(
        ("quad", "epsabs", lambda x: [book.length_by_quad(own, at, x) for at in AT]),
        ("trapezia on a grid", lambda n: [book.length_by_sums(own, at, n) for at in AT]),
    )


def textbook_parameters(map: PinballMap) -> list[Method]:
    """brentq over quad, and interpolation in trapezia."""
    book, own = module("textbook"), _speed(map)
    if book is None:
        return []
    return _pair(
        ("brentq over quad", "xtol", lambda x: [book.parameter_by_brentq(own, s, x) for s in AT]),
        ("interpolated grid", lambda n: [book.parameter_by_sums(own, s, n) for s in AT]),
    )


def _pair(by_tolerance: Any, on_grid: Any) -> list[Method]:
    name, unit, call = by_tolerance
    settled = Method(name, "float64", unit, TOLERANCES, call, lambda x: Decimal(f"{x:.3g}"), len(AT), textbook=True)
    name, call = on_grid
    return [settled, Method(name, "float64", "grid points", GRIDS, call, per=len(AT), textbook=True)]
