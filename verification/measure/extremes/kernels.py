"""Kernels tested on extreme cases (one bounce on LLVM, NumPy, 80-bit floats and mpmath), and tests of long products.

The step of `numeric/flights` on 80-bit arrays has 64 bits of mantissa, 11 more than the doubles that it judges.

Functions made for 53 bits are replaced: sines and arctangents are the C library's, and a zero is refined by Newton's
method until its correction is below the unit or stops shrinking. Splitting for exact products, and the outcomes that
stop a particle, are kept. All four kernels run the same step; `TEXTBOOK` is the plain quadratic formula, kept to show
that large errors are detected.

Products of many derivative matrices, and the exponents they give, are tested for underflow, overflow and errors of sums
of logarithms. The result is the growth rate per bounce. Its condition number is the largest effect of rounding every
bounce of the orbit at random (found with roundings a million times too strong), plus one for the result's own rounding.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, cast

import mpmath
import numpy as np
from sympy import N, Rational

from numeric import PinballMap
from numeric.backends import functions as roots
from numeric.backends.scalars import ArrayBackend, ScalarBackend
from numeric.flights.family import Family, Status
from numeric.flights.harmonic import Ellipse
from numeric.kernels.machine import KernelSpec
from numeric.pinball.sampling import GENERIC, Growth
from numeric.pinball.states import STATUSES
from symbolic.cycles.cycle import minor_axis, trace_and_determinant
from symbolic.expressions.text import kernel, load
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, a, cos_eta1, cos_phi0, lam, t
from verification.arithmetic.balls import ARRAYS, Arithmetic, multiprecision
from verification.measure.extremes.near import DOUBLE, WRONG, Errors, Finding, StabilityVerdict

WIDE = 2.0**-63  # the unit of rounding
PI = np.longdouble("3.14159265358979323846264338327950288")
PI_LOW = np.longdouble("-5.01655761266833202355732708033075701e-20")  # what PI lacks, to its own last bit
SHARPER = 8  # Newton steps at most, from 53 bits on
Slope = Callable[[Any], tuple[Any, Any]]


class Wide(ArrayBackend):
    """Arithmetic of 80-bit NumPy arrays; masks are boolean arrays."""

    splitter = 2.0**32 + 1  # halves a mantissa of 64 bits

    def q(self, p: int, n: int) -> Any:
        """The 80-bit number nearest to `p/n`."""
        return np.longdouble(p) / np.longdouble(n)

    def number(self, x: float) -> Any:
        """An 80-bit number."""
        return np.longdouble(x)

    @property
    def pi(self) -> Any:
        """The 80-bit number nearest to pi."""
        return PI

    @property
    def pi_low(self) -> Any:
        """Pi minus the 80-bit number nearest to it."""
        return PI_LOW

    def angle(self, y: Any, x: Any) -> Any:
        """The angle `atan2(y, x)`."""
        return np.arctan2(y, x)

    def turn(self, x: Any, quarters: int = 2) -> tuple[Any, Any]:
        """Cosine and sine of `x`, in radians; `quarters`, a bound of `abs(x)` in quarter turns, is not used."""
        return np.cos(x), np.sin(x)

    # the library's functions, of 64 bits: those of `ArrayBackend` are for doubles
    atan2, exp, log, atan = (staticmethod(cast(Any, f)) for f in (np.arctan2, np.exp, np.log, np.arctan))
    sinh, cosh, tanh = (staticmethod(cast(Any, f)) for f in (np.sinh, np.cosh, np.tanh))
    root = staticmethod(cast(Any, lambda x, n: x ** (np.longdouble(1) / n)))

    def zero(
        self,
        function: Slope,
        x: Any,
        low: Any,
        high: Any,
        scale: Any,
        newton: int,
        wanted: Any = None,
        accepts: Callable[[Any], Any] | None = None,
    ) -> Any:
        """A zero found by `bracketed_zero`, then refined to the last bits."""
        found = roots.bracketed_zero(self, function, x, low, high, scale, newton, wanted, accepts)
        return sharpened(function, found, scale, wanted)


def sharpened(function: Slope, x: Any, scale: Any, wanted: Any = None) -> Any:
    """A zero known to 53 bits, refined by Newton's method in each lane until the correction is below the unit or grows.

    >>> root = sharpened(lambda x: (x * x - 2, 2 * x), np.array([np.longdouble(2.0**0.5)]), np.longdouble(1))
    >>> bool(abs(root[0] - np.sqrt(np.longdouble(2))) <= 2 * np.finfo(np.longdouble).eps)
    True
    """
    before = 0 * x + np.inf
    going = np.isfinite(x) if wanted is None else np.isfinite(x) & wanted
    for _ in range(SHARPER):
        value, slope = function(x)
        step = value / slope
        size = abs(step)
        going = going & (size < before / 2)  # a step that shrinks no more is rounding; nan is not taken either
        if not np.any(going):
            break
        x, before = np.where(going, x - step, x), np.where(going, size, before)
        going = going & (size > WIDE * np.maximum(abs(x), scale))
    return x


def made_unit(family: Family, state: list[Any]) -> list[Any]:
    """An 80-bit state, with pairs of numbers scaled to length one; as doubles they have this length to 53 bits only.

    >>> from numeric import PinballMap
    >>> u, v = made_unit(PinballMap("cardioid").family, [np.array([np.longdouble(x)]) for x in (0.6, 0.8)])
    >>> bool(abs(u * u + v * v - 1)[0] <= 2.0**-63)
    True
    """
    made = list(state)
    for i in family.pairs:
        if i + 1 < len(state):
            x, y = state[i : i + 2]
            size = np.hypot(x, y)
            if i == 1:  # on a wall this is a height and no pair
                size = np.where(state[0] > 0.5, 1, size)
            made[i], made[i + 1] = x / size, y / size
    return made


GOES_ON = Status.REGULAR.name


@dataclass(frozen=True)
class TestedKernel:
    """A way to compute a bounce: its name in tables, and its unit of rounding."""

    name: str
    unit: float = DOUBLE

    def runs(self, map: PinballMap) -> bool:
        """True if this kernel is available for the table."""
        if self is TEXTBOOK:
            return isinstance(map.family, Ellipse) and map.law != "slap"
        return self is not LONGDOUBLE or np.finfo(np.longdouble).nmant >= 63

    def bounce(self, map: PinballMap, state: list[Any], exact: Sequence[Any] = ()) -> tuple[list[Any], str]:
        """The fields after one bounce, and the outcome (such as a stop) that the kernel reports.

        `exact` is the exact shape if it is not a double; the 80-bit kernel rounds it to 80 bits.
        """
        if self in (LLVM, NUMPY):
            return _compiled(map, state, self is LLVM)
        if self is TEXTBOOK:
            return textbook(map, [float(x) for x in state]), GOES_ON
        lam = float(map.lam.flat[0])
        if self is LONGDOUBLE:
            own = made_unit(map.family, [np.array([np.longdouble(x)]) for x in state])
            letters = (exact or map.exact_shape) if map.shape else ()  # none after scaling
            shape = [np.longdouble(str(N(x, 25))) for x in letters]
            with np.errstate(all="ignore"):
                fields, code = map.family.bounce(Wide(), map.law, shape, np.array([np.longdouble(lam)]), own)
            return [field[0] for field in fields], _status(code)
        context = mpmath.MPContext()
        context.prec = 53
        mpf = context.mpf
        own, shape = [mpf(float(x)) for x in state], [mpf(x) for x in map.shape]
        try:
            fields, code = map.family.bounce(ScalarBackend(context), map.law, shape, mpf(lam), own)
        except ZeroDivisionError:
            return own, "division by zero"
        return fields, _status(code)


LLVM = TestedKernel("llvm")
NUMPY = TestedKernel("numpy")
LONGDOUBLE = TestedKernel("longdouble", WIDE)
MPMATH = TestedKernel("mpmath, 16 digits")
TEXTBOOK = TestedKernel("textbook discriminant")
KERNELS = LLVM, NUMPY, LONGDOUBLE, MPMATH


def textbook(map: PinballMap, state: list[float]) -> list[Any]:
    """One bounce in the ellipse by the plain quadratic formula: no known zero is divided out."""
    a, lam = float(map.exact_shape[0]), float(map.lam.flat[0])
    ux, uy, vx, vy = state
    x, y = a * ux, uy
    p, q, r = vx * vx / a / a + vy * vy, x * vx / a / a + y * vy, x * x / a / a + y * y - 1
    t = (-q + math.sqrt(max(q * q - p * r, 0.0))) / p
    x, y = x + t * vx, y + t * vy
    theta = math.atan2(y, x / a)
    tangent = math.atan2(math.cos(theta), -a * math.sin(theta))
    eta = math.remainder(tangent - math.atan2(vy, vx) - math.pi / 2, math.tau)
    exit = tangent + math.pi / 2 + lam * eta
    return [math.cos(theta), math.sin(theta), math.cos(exit), math.sin(exit)]


def bounced(map: PinballMap, starts: tuple[Any, Any, Any]) -> tuple[list[Any], list[Any], Any]:
    """The kernel's fields before and after one bounce of `starts` (component, parameter, exit angle); and the codes."""
    component, theta, phi = starts
    own = [np.asarray(row) for row in map.states.enter(component, theta, phi, map.law)]
    lam = np.full(theta.size, float(map.lam))
    result = map.engine.run(KernelSpec(map.law, record=True), own, lam, map.shape, 1)
    assert result.record is not None
    return own, list(result.record[0]), result.rows.get("code", np.zeros(theta.size))


def _compiled(map: PinballMap, state: list[Any], kernels: bool) -> tuple[list[Any], str]:
    """Fields and outcome after one bounce, computed by LLVM kernels or on NumPy arrays."""
    engine = map.engine._replace(kernels=kernels)
    own = [np.array([float(x)]) for x in state]
    result = engine.run(KernelSpec(map.law, record=True), own, np.full(1, float(map.lam)), map.shape, 1)
    assert result.record is not None
    return [field[0] for field in result.record[0]], _status(result.rows.get("code"))


def _status(code: Any) -> str:
    return GOES_ON if code is None else STATUSES[int(np.max(np.asarray(code, dtype=float)))].name


DIGITS, ROUGH, DRAWS, SEED = 100, 1e-7, 8, 7
ENTRIES = [K0, K1, t, cos_phi0, cos_eta1]
LOGARITHMS = "PinballMap.exponents, which carries one vector and sums powers of two"
NAIVE = "textbook product"
BEYOND = "the product or its determinant leaves the range of floats"
CANCELLED = "the determinant of the product is the rounding of its entries: they are of rank one to all digits"


@dataclass(frozen=True)
class Product:
    """A test case: an orbit whose derivative matrices are multiplied."""

    name: str
    scene: str
    lam: float
    start: tuple[float, float]
    bounces: int
    alpha: str = ""


@dataclass(frozen=True)
class Resting:
    """A test case: a cycle with known multipliers (the short axis of the ellipse `a = 3/2`), iterated for `bounces`."""

    name: str
    lam: float
    bounces: int


def findings(asked: Product | Resting) -> list[Finding]:
    """Errors of the exponents, by the engine and by a plain product of matrices, for one test case."""
    return _of_product(asked) if isinstance(asked, Product) else _of_rest(asked)


def _of_product(asked: Product) -> list[Finding]:
    shape: dict[str, Any] = {"alpha": asked.alpha} if asked.alpha else {}
    map = PinballMap(asked.scene, lam=asked.lam, **shape)
    growth = Growth(map, *asked.start)
    growth.advance(asked.bounces)
    engine = float(growth.stretch[0]) / asked.bounces
    orbit = map.orbit(*asked.start, asked.bounces)
    context = mpmath.MPContext()
    context.dps = DIGITS
    truth = growth_of(_matrices(map, orbit, context), context)
    arrays = _rough_matrices(map, orbit, 0.0)
    plain = _chain(arrays)
    rng = np.random.default_rng(SEED)
    changes = [_chain(_rough_matrices(map, orbit, ROUGH, rng)) - plain for _ in range(DRAWS)]
    condition = 1 + float(np.max(np.abs(changes))) / ROUGH
    return [
        _finding(asked.name, "engine", engine, truth, condition),
        _finding(asked.name, NAIVE, naive(arrays), truth, condition),
    ]


def _of_rest(asked: Resting) -> list[Finding]:
    """Errors of both exponents of a cycle; for the smaller one, the determinant of the plain product underflows."""
    context = mpmath.MPContext()
    context.dps = DIGITS
    at = {a: Rational(3, 2), lam: Rational(asked.lam)}
    trace, det = (context.mpf(str(N(value.subs(at), DIGITS + 20))) for value in trace_and_determinant(minor_axis()))
    larger = (abs(trace) + context.sqrt(trace * trace - 4 * det)) / 2
    sizes = context.log(det / larger) / 2, context.log(larger) / 2
    map = PinballMap("ellipse", a="3/2", lam=asked.lam)
    growth = Growth(map, np.pi / 2, 0.0)
    growth.advance(100)
    early = growth.stretch[0], growth.volume[0]
    growth.advance(asked.bounces)
    plus, volume = (
        (now[0] - then) / asked.bounces for now, then in zip((growth.stretch, growth.volume), early, strict=True)
    )
    minus = volume + np.log(asked.lam) - plus
    matrix = map.derivative(np.pi / 2, 0.0)
    product = np.linalg.matrix_power(matrix, asked.bounces)
    with np.errstate(divide="ignore", invalid="ignore"):
        smaller = float(np.log(abs(np.linalg.det(product)))) / asked.bounces - float(plus)
    made = []
    for name, truth, engine in (("nu_plus", sizes[1], plus), ("nu_minus", sizes[0], minus)):
        condition = 1 + float(abs(truth))
        made.append(_finding(f"{asked.name}, {name}", "engine", float(engine), truth, condition))
    made.append(_finding(f"{asked.name}, nu_minus", NAIVE, smaller, sizes[0], 1 + float(abs(sizes[0]))))
    return made


def _finding(case: str, name: str, found: float, truth: Any, condition: float) -> Finding:
    error = float(abs(found - truth)) / DOUBLE if np.isfinite(found) else inf
    measured = Errors(error, error / condition, condition) if error < inf else WRONG
    if name != NAIVE or measured.stability is StabilityVerdict.STABLE:
        return Finding(case, name, measured)
    return Finding(case, name, measured, "", LOGARITHMS, reason=CANCELLED if error < inf else BEYOND)


def naive(matrices: Any) -> float:
    """The growth rate per bounce of a vector under the product of the matrices, without rescaling."""
    vector = np.array(GENERIC)
    with np.errstate(all="ignore"):
        for matrix in matrices:
            vector = matrix @ vector
        return float(np.log(np.hypot(*vector))) / len(matrices)


def growth_of(matrices: Any, context: Any) -> Any:
    """The growth rate per bounce of a vector under the matrices, in multiprecision, where nothing overflows."""
    x, y = (context.mpf(component) for component in GENERIC)
    count = 0
    for p, q, r, s in matrices:
        x, y, count = p * x + q * y, r * x + s * y, count + 1
    return context.log(context.hypot(x, y)) / count


def _entries(arithmetic: Arithmetic) -> Any:
    names = ("ss", "sp", "ps", "pp")
    written = kernel("derivative", [*ENTRIES, lam], dict(zip(names, derivative_matrix(), strict=True)))
    return load(written, arithmetic)


def _matrices(map: PinballMap, orbit: Any, context: Any) -> Any:
    """The paper's matrix of every bounce of a recorded orbit, whose doubles are taken as exact."""
    from numeric.backends.scalars import ScalarBackend

    ops, of, contraction = ScalarBackend(context), _entries(multiprecision(context)), context.mpf(float(map.lam))
    shape, before = [context.mpf(value) for value in map.shape], None
    for theta, phi, eta in zip(orbit.theta, orbit.phi, orbit.eta, strict=True):
        x, y, bend = _placed(map.ir.parts[0].curve(ops, context.mpf(float(theta)), *shape), context.sqrt)
        if before is not None:
            u, v, bent, left = before
            yield of(bent, bend, context.hypot(x - u, y - v), left, context.cos(context.mpf(float(eta))), contraction)
        before = x, y, bend, context.cos(context.mpf(float(phi)))


def _rough_matrices(map: PinballMap, orbit: Any, strength: float, rng: Any = None) -> Any:
    """The paper's matrix of every bounce in float64, of an orbit that is perturbed at random by `strength`."""
    from numeric.backends.scalars import ArrayBackend

    theta, phi, eta = (field + (strength * rng.choice([-1, 1], field.shape) if rng is not None else 0)
                       for field in (orbit.theta, orbit.phi, orbit.eta))  # fmt: skip
    x, y, bend = _placed(map.ir.parts[0].curve(ArrayBackend(), theta, *map.shape), np.sqrt)
    length = np.hypot(np.diff(x), np.diff(y))
    rows = _entries(ARRAYS)(bend[:-1], bend[1:], length, np.cos(phi[:-1]), np.cos(eta[1:]), float(map.lam))
    return np.array(rows).T.reshape(-1, 2, 2)


def _placed(curve: Any, root: Any) -> Any:
    """Point and curvature from a curve's derivatives; the curvature is negative where the boundary focuses."""
    x, y, dx, dy, ddx, ddy = curve
    square = dx * dx + dy * dy
    return x, y, -(dx * ddy - dy * ddx) / (square * root(square))


def _chain(matrices: Any) -> float:
    """The growth rate per bounce in float64 of a vector that is scaled to length 1 at every bounce."""
    vector, total = np.array(GENERIC), 0.0
    for matrix in matrices:
        vector = matrix @ vector
        size = np.hypot(*vector)
        vector, total = vector / size, total + np.log(size)
    return float(total) / len(matrices)


PRODUCTS = (
    Product("product of 1e3 matrices, cardioid", "cardioid", 0.8, (0.4, 0.3), 1_000),
    Product("product of 1e3 matrices, cardioid at lam = 1e-2", "cardioid", 0.01, (0.4, 0.3), 1_000),
    Product("product of 1e3 matrices, egg at lam = 1e-2", "egg", 0.01, (0.4, 0.3), 1_000, "2/25"),
    Resting("lam = 1e-3, 1e4 bounces: det = 1e-30000", 1e-3, 10_000),
    Resting("lam = 1e-300, 100 bounces: det = 1e-30000", 1e-300, 100),
)
LONGER = (Product("product of 1e4 matrices, cardioid", "cardioid", 0.8, (0.4, 0.3), 10_000),)
