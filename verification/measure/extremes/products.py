"""Products of many derivative matrices and the exponents they give: underflow, overflow, and sums of logarithms.

The number asked for is the growth a bounce. Its condition number is the largest effect of rounding every bounce of the
orbit at random, found by doing so a million times too strongly, and one for the rounding of the result.
"""

from dataclasses import dataclass
from math import inf
from typing import Any

import mpmath
import numpy as np
from sympy import N, Rational

from numeric import PinballMap
from numeric.pinball.growth import GENERIC, Growth
from symbolic.cycles.cycle import trace_and_determinant
from symbolic.cycles.named import minor_axis
from symbolic.generation.text import kernel, load
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.symbols import K0, K1, a, cos_eta1, cos_phi0, lam, t
from verification.arithmetic.words import ARRAYS, Arithmetic, multiprecision
from verification.measure.extremes.kernels import DOUBLE
from verification.measure.extremes.near import WRONG, Finding, Measured, Stability

DIGITS, ROUGH, DRAWS, SEED = 100, 1e-7, 8, 7
ENTRIES = [K0, K1, t, cos_phi0, cos_eta1]
LOGARITHMS = "PinballMap.exponents, which carries one vector and sums powers of two"
NAIVE = "textbook product"
BEYOND = "the product or its determinant leaves the range of floats"
CANCELLED = "the determinant of the product is the rounding of its entries: they are of rank one to all digits"


@dataclass(frozen=True)
class Product:
    """An orbit whose derivative matrices are multiplied."""

    name: str
    scene: str
    lam: float
    start: tuple[float, float]
    bounces: int
    alpha: str = ""


@dataclass(frozen=True)
class Resting:
    """A cycle with known multipliers, watched for so many bounces: the short axis of the ellipse `a = 3/2`."""

    name: str
    lam: float
    bounces: int


def findings(asked: Product | Resting) -> list[Finding]:
    """The engine's exponent and the textbook's, the logarithm of a product."""
    return _of_product(asked) if isinstance(asked, Product) else _of_rest(asked)


def _of_product(asked: Product) -> list[Finding]:
    shape: dict[str, Any] = {"alpha": asked.alpha} if asked.alpha else {}
    map = PinballMap(asked.scene, lam=asked.lam, **shape)
    growth = Growth(map, 0, *asked.start)
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
    """Both exponents; the second is where the determinant underflows."""
    context = mpmath.MPContext()
    context.dps = DIGITS
    at = {a: Rational(3, 2), lam: Rational(asked.lam)}
    trace, det = (context.mpf(str(N(value.subs(at), DIGITS + 20))) for value in trace_and_determinant(minor_axis()))
    larger = (abs(trace) + context.sqrt(trace * trace - 4 * det)) / 2
    sizes = context.log(det / larger) / 2, context.log(larger) / 2
    map = PinballMap("ellipse", a="3/2", lam=asked.lam)
    growth = Growth(map, 0, np.pi / 2, 0.0)
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
    measured = Measured(error, error / condition, condition) if error < inf else WRONG
    if name != NAIVE or measured.stability is Stability.STABLE:
        return Finding(case, name, measured)
    return Finding(case, name, measured, "", LOGARITHMS, reason=CANCELLED if error < inf else BEYOND)


def naive(matrices: Any) -> float:
    """The logarithm of the length of the product applied to a vector, a bounce, with nothing scaled on the way."""
    vector = np.array(GENERIC)
    with np.errstate(all="ignore"):
        for matrix in matrices:
            vector = matrix @ vector
        return float(np.log(np.hypot(*vector))) / len(matrices)


def growth_of(matrices: Any, context: Any) -> Any:
    """The same in multiprecision, where nothing overflows."""
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
    """The paper's matrix of every bounce of a recorded orbit, whose doubles are taken exactly."""
    from numeric.backends.scalars import Scalars

    ops, of, contraction = Scalars(context), _entries(multiprecision(context)), context.mpf(float(map.lam))
    shape, before = [context.mpf(value) for value in map.shape], None
    for theta, phi, eta in zip(orbit.theta, orbit.phi, orbit.eta, strict=True):
        x, y, bend = _placed(map.blueprint.parts[0].curve(ops, context.mpf(float(theta)), *shape), context.sqrt)
        if before is not None:
            u, v, bent, left = before
            yield of(bent, bend, context.hypot(x - u, y - v), left, context.cos(context.mpf(float(eta))), contraction)
        before = x, y, bend, context.cos(context.mpf(float(phi)))


def _rough_matrices(map: PinballMap, orbit: Any, strength: float, rng: Any = None) -> Any:
    """The same in float64, from an orbit whose numbers are off by so much at random."""
    from numeric.backends.arrays import Arrays

    theta, phi, eta = (field + (strength * rng.choice([-1, 1], field.shape) if rng is not None else 0)
                       for field in (orbit.theta, orbit.phi, orbit.eta))  # fmt: skip
    x, y, bend = _placed(map.blueprint.parts[0].curve(Arrays(), theta, *map.shape), np.sqrt)
    length = np.hypot(np.diff(x), np.diff(y))
    rows = _entries(ARRAYS)(bend[:-1], bend[1:], length, np.cos(phi[:-1]), np.cos(eta[1:]), float(map.lam))
    return np.array(rows).T.reshape(-1, 2, 2)


def _placed(curve: Any, root: Any) -> Any:
    """Point and curvature, negative where the boundary focuses."""
    x, y, dx, dy, ddx, ddy = curve
    square = dx * dx + dy * dy
    return x, y, -(dx * ddy - dy * ddx) / (square * root(square))


def _chain(matrices: Any) -> float:
    """The growth a bounce in float64, scaled at every bounce."""
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
