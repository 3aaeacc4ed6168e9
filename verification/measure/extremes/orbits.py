"""Extreme orbits with known truth: very long orbits, and single bounces of numerically hard particles.

A very long orbit is tested by a quantity that is known even after chaos has erased the digits of the start. (1) An
invariant of the elastic ellipse: each bounce adds one rounding, so `n` independent ones amount to `sqrt(n)`, and a
drift would be of order `n`. (2) The elastic circle, where `theta` after `n` bounces is known, up to `2*n` roundings of
`phi`. (3) An attracting cycle, enclosed in balls. (4) Chaotic orbits: two that start as mirror images must stay so to
the last bit, and time averages tend to means over the elastic measure `cos(phi) ds dphi`, up to their standard errors,
because the elastic cardioid is ergodic [Szasz1992] [Markarian1993]. (That its exponents are not 0 was known before
[Wojtkowski1986].)

The hard particles are grazing, near a cusp or a join, near flat points, or in long tables.

`pinball bench` prints the errors of a few particles against 50 digits, `benchmarks/adversarial.py` those of millions
against 80-bit floats. The bounds are 4 units of 2**-52 for the position and 8 for the direction, or 8 condition
numbers. A condition number is a row sum of the absolute derivative matrix, plus one for the rounding of the result.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.phase_points import phase_points
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from verification.cycles.newton import floats, given
from verification.cycles.problem import Problem
from verification.maps.exact import ExactMap, errors
from verification.measure.extremes.kernels import bounced, made_unit
from verification.measure.extremes.near import DOUBLE, WRONG, Errors, Finding
from verification.named.attractors import certificate

Array = NDArray[np.float64]
PARTICLES, SEED, SHORT = 256, 5, 2_560_000
PART = 2**20  # bounces in one call
BLOCK = 1000  # bounces whose states are kept at once for a mean
MEAN = "more particles or longer orbits: a mean is known to its standard error and no better"


@dataclass(frozen=True)
class Long:
    """A test on long orbits: a measure of their error, the number of particles, and the bounces of each."""

    name: str
    measure: Callable[["Long"], list[Finding]]
    particles: int
    bounces: int

    def found(self, what: str, measured: Errors | None, status: str, reason: str = "", instead: str = "") -> Finding:
        """A finding on this test with the engine's kernels; `what` is appended to the test's name."""
        return Finding(f"{self.name}{what}", "llvm", measured, status, instead, reason=reason)


def findings(asked: Long) -> list[Finding]:
    """The findings of a test on long orbits."""
    return asked.measure(asked)


def orbits(collisions: int = SHORT, particles: int = PARTICLES) -> tuple[Long, ...]:
    """All tests on long orbits, each with `collisions` in total, divided among the particles."""
    each = max(1, collisions // particles)
    kinds: tuple[tuple[str, Callable[[Long], list[Finding]]], ...] = (
        ("elastic ellipse a = 3/2", lambda asked: invariant(asked, "3/2")),
        ("elastic ellipse a = 3", lambda asked: invariant(asked, "3")),
        ("elastic circle", turning),
        ("egg at lam = 7/10, where two triangles attract", attracted),
        ("cardioid at lam = 4/5, starts that are mirror images", mirrored),
        ("elastic cardioid", ergodic),
    )
    shown = f"{particles} particles, {each:.0e} bounces each"
    return tuple(Long(f"{name}, {shown}", measure, particles, each) for name, measure in kinds)


def starts(particles: int) -> tuple[Array, Array]:
    """Parameters and exit angles of random particles."""
    rng = np.random.default_rng(SEED)
    return rng.uniform(-np.pi, np.pi, particles), np.arcsin(rng.uniform(-1, 1, particles) * 0.999)


def entered(map: PinballMap, theta: Array, phi: Array) -> list[Array]:
    """Kernel fields of particles that start on the first component."""
    return [np.asarray(row) for row in map.states.enter(np.zeros(theta.size, dtype=np.int64), theta, phi, map.law)]


def advanced(map: PinballMap, rows: list[Array], bounces: int) -> tuple[list[Array], str]:
    """The fields after `bounces`, and an error message if a particle stopped or a number is not finite, else ''."""
    own, said = rows, ""
    for done in range(0, bounces, PART):
        lam = np.full(own[0].size, float(map.lam))
        after = map.engine.run(KernelSpec(map.law), own, lam, map.shape, min(PART, bounces - done), threads=1).rows
        own = [np.ascontiguousarray(after[field]) for field in map.family.fields(map.law)]
        if "code" in after and np.any(after["code"]):
            said = "a particle stopped"
        if not all(np.all(np.isfinite(row)) for row in own):
            said = "not a number"
    return own, said


def root_mean_square(x: Any) -> float:
    """Root mean square of an array, in any kind of number."""
    return float(np.sqrt(np.mean(x * x)))


def invariant(asked: Long, a: str) -> list[Finding]:
    """The drift, along elastic orbits in an ellipse, of the product of the angular momenta about its foci."""
    map = PinballMap("ellipse", lam=1, a=a)
    rows = entered(map, *starts(asked.particles))
    after, said = advanced(map, rows, asked.bounces)
    error = root_mean_square(momenta(map, after) - momenta(map, rows)) / DOUBLE
    condition = float(np.sqrt(asked.bounces)) + 1
    return [asked.found("", WRONG if said else Errors(error, error / condition, condition), said)]


def momenta(map: PinballMap, rows: list[Any]) -> Any:
    """The product of the angular momenta about both foci, in 80 bits, of fields scaled to unit length."""
    ux, uy, vx, vy = made_unit(map.family, [row.astype(np.longdouble) for row in rows])
    a = np.longdouble(float(map.exact_shape[0]))
    momentum = a * ux * vy - uy * vx
    return momentum * momentum - (a * a - 1) * vy * vy


def turning(asked: Long) -> list[Finding]:
    """Error of `theta` after `n` bounces in the elastic circle, where `theta + n*(pi - 2*phi)` is the exact value."""
    map = PinballMap("circle", lam=1)
    rows = entered(map, *starts(asked.particles))
    (theta, phi), said = advanced(map, rows, asked.bounces)
    context = mpmath.MPContext()
    context.dps = 50
    gaps = []
    for start, exit, end in zip(rows[0], rows[1], theta, strict=True):
        gap = (
            context.mpf(float(start))
            + asked.bounces * (context.pi - 2 * context.mpf(float(exit)))
            - context.mpf(float(end))
        )
        gaps.append(float(gap - 2 * context.pi * context.nint(gap / (2 * context.pi))))
    if not np.array_equal(phi, rows[1]):
        said = "phi changed"
    error, condition = root_mean_square(np.array(gaps)) / DOUBLE, 2.0 * asked.bounces + 1
    reason = f"theta adds up 2*n = {2 * asked.bounces:.0e} roundings of phi"
    return [asked.found("", WRONG if said else Errors(error, error / condition, condition), said, reason)]


def attracted(asked: Long) -> list[Finding]:
    """Errors of particles that converge to the attracting triangles of the egg, whose bounces are proved."""
    table, lam = tables.egg(3).at(alpha="2/25"), Rational(7, 10)
    map = PinballMap("egg", alpha="2/25", lam="7/10")
    problem = Problem(table, (0, 0, 0), lam=lam)
    corner = [-0.65 + 2 * np.pi * k / 3 for k in range(3)]
    triangle = floats(problem, corner)
    proof = certificate(table, lam, phase_points(triangle, 0.0))
    if not proof.proved:
        raise ValueError(f"{asked.name}: the triangle is not proved to attract: {dict(proof.checks)}")
    (ux, uy, *_), said = advanced(map, entered(map, *starts(asked.particles)), asked.bounces)
    context = mpmath.MPContext()
    context.dps = 40
    proved = [context.mpf(x.str(35, radius=False)) for x in proof.theta]
    exact = [sign * x for x in proved for sign in (1, -1)]  # the mirror image attracts as well
    gaps = []
    for x, y in zip(ux, uy, strict=True):
        here = context.atan2(context.mpf(float(y)), context.mpf(float(x)))
        away = [here - one - 2 * context.pi * context.nint((here - one) / (2 * context.pi)) for one in exact]
        gaps.append(float(min(away, key=abs)))
    error, condition = float(np.max(np.abs(gaps))) / DOUBLE, given(problem, triangle).condition
    return [asked.found("", WRONG if said else Errors(error, error / condition, condition), said)]


def mirrored(asked: Long) -> list[Finding]:
    """The largest gap between chaotic orbits and the mirror images of the orbits from mirrored starts."""
    map = PinballMap("cardioid", lam="4/5")
    theta, phi = starts(asked.particles // 2)
    both = np.concatenate([theta, -theta]), np.concatenate([phi, -phi])
    (p, q, c, s), said = advanced(map, entered(map, *both), asked.bounces)
    half, gap = theta.size, 0.0
    for row, sign in ((p, 1), (q, -1), (c, 1), (s, -1)):
        gap = max(gap, float(np.max(np.abs(row[:half] - sign * row[half:]))))
    return [asked.found("", WRONG if said else Errors(gap / DOUBLE, gap / DOUBLE, 1.0), said)]


def ergodic(asked: Long) -> list[Finding]:
    """Errors of time averages over chaotic orbits: `cos(phi)` (mean pi/4) and `sin(theta/2)**2` (mean 1/3)."""
    map = PinballMap("cardioid", lam=1)
    rows, said, sums = entered(map, *starts(asked.particles)), "", np.zeros((2, asked.particles))
    for done in range(0, asked.bounces, BLOCK):
        count = min(BLOCK, asked.bounces - done)
        lam = np.ones(asked.particles)
        result = map.engine.run(KernelSpec(map.law, record=True), rows, lam, map.shape, count, threads=1)
        assert result.record is not None
        rows = [np.ascontiguousarray(row) for row in result.record[-1]]
        if np.any(result.rows["code"]) or not np.all(np.isfinite(result.record[-1])):
            said = "a particle stopped"
        sums += result.record[:, 2].sum(axis=0), (result.record[:, 1] ** 2).sum(axis=0)
    made = []
    for what, mean, truth in zip(
        (", mean of cos(phi)", ", mean of sin(theta/2)^2"), sums, (np.pi / 4, 1 / 3), strict=True
    ):
        mean = mean / asked.bounces  # of each particle
        error = abs(float(np.mean(mean)) - truth) / DOUBLE
        doubt = float(np.std(mean, ddof=1) / np.sqrt(asked.particles)) / DOUBLE
        reason = f"{error / doubt:.1f} standard errors of {doubt * DOUBLE:.1e}"
        made.append(asked.found(what, WRONG if said else Errors(error, error / doubt, doubt), said, reason, MEAN))
    return made


SCENES: dict[str, dict[str, Any]] = {
    "circle": {},
    "ellipse": {"a": "3/2"},
    "cardioid": {},
    "cuspless": {},
    "egg": {"alpha": "2/25"},
}
RADII = {  # tables that are not the paper's
    "limacon": "1 + 3*cos(theta)/5",
    "star": "1 + cos(5*theta)/4",
    "peanut": "exp(cos(2*theta)/4)",
    "conic": "1/(2 + cos(theta)/2)",
    "waves": "1 + cos(40*theta)/2000",
}
LONG_RADII = RADII | {  # and ellipses whose far tip is 2000 times as far from the origin as the near one
    "comet": "1/(1 + 999*cos(theta)/1000)",
    "turned comet": "2/(1 - 999*cos(theta - pi/3)/1000)",
}
LAM, OTHERS = "19/20", (0, 1e-300, 1)
LABELLED, DIGITS, SEED_OF_LABELLED = 24, 50, 11


class Case(NamedTuple):
    """A test case: particles of one kind on one table."""

    label: str
    map: PinballMap
    component: NDArray[np.int64]
    theta: Array
    phi: Array


class Accuracy(NamedTuple):
    """Largest errors of one bounce, in units of 2**-52, and the largest ratios of errors to condition numbers."""

    scene: str
    case: str
    particles: int
    position: float
    direction: float
    position_by_condition: float
    direction_by_condition: float


def aimed(label: str, map: PinballMap, theta: Array, phi: Array, component: NDArray[np.int64]) -> Case:
    """A test case of those particles whose exit angle `phi` leads into the table."""
    good = np.abs(phi) < 1.57
    return Case(label, map, component[good], theta[good], phi[good])


def cases(count: int, seed: int = SEED_OF_LABELLED) -> Iterator[Case]:
    """Test cases on the paper's tables, with `count` particles of each kind; a label's first word is the table."""
    rng = np.random.default_rng(seed)
    side = np.where(rng.integers(0, 2, count) == 0, 1, -1)
    tiny = 10.0 ** rng.uniform(-12, -1, count)
    zero = np.zeros(count, dtype=np.int64)
    angle = np.arcsin(rng.uniform(-1, 1, count) * (1 - 1e-12))
    for name, shape in SCENES.items():
        map = PinballMap(name, lam=LAM, **shape)
        low, high = map.states.ends[0]
        theta = low + (high - low) * rng.uniform(1e-9, 1 - 1e-9, count)
        yield Case(f"{name}, random", map, zero, theta, angle)
        yield Case(f"{name}, grazing to 1e-12", map, zero, theta, side * (np.pi / 2 - tiny))
        for lam in OTHERS:
            exit = angle if lam else 0 * angle  # at lam = 0 every exit is along the normal
            yield Case(f"{name}, lam = {lam:g}", PinballMap(name, lam=lam, **shape), zero, theta, exit)
    cardioid = PinballMap("cardioid", lam=LAM)
    yield Case("cardioid, start near the cusp", cardioid, zero, side * (np.pi - tiny), angle)
    theta = rng.uniform(-2.9, 2.9, count)
    yield Case("cardioid, aimed at the cusp", cardioid, zero, theta, theta / 2 + side * tiny)
    yield from _cuspless(rng, side, tiny, angle)
    flat = PinballMap("egg", lam=LAM, alpha="0.1")
    theta = rng.integers(-1, 2, count) * 2 * np.pi / 3 + np.pi / 3 + side * tiny
    around = np.remainder(theta + np.pi, 2 * np.pi) - np.pi
    yield Case("egg, alpha = 0.1, from flat points", flat, zero, around, angle)
    long = PinballMap("ellipse", lam=LAM, a=10000)
    yield Case("ellipse, a = 1e4", long, zero, rng.uniform(-np.pi, np.pi, count), angle)
    yield Case("ellipse, a = 1e4, near the tip", long, zero, side * tiny, angle)


def scene(name: str, lam: Any = LAM) -> PinballMap:
    """The map of a table of this name, with the shape that benchmarks use."""
    if name in SCENES:
        return PinballMap(name, lam=lam, **SCENES[name])
    return PinballMap(tables.polar(LONG_RADII[name], name=name), lam=lam)


def own_cases(name: str, count: int, seed: int = SEED_OF_LABELLED) -> Iterator[Case]:
    """Test cases on a table of `LONG_RADII`, of about `count` particles of every kind."""
    rng, map = np.random.default_rng(seed), scene(name)
    side, zero = rng.choice([-1, 1], count), np.zeros(count, dtype=np.int64)
    tiny = 10.0 ** rng.uniform(-12, -1, count)
    theta, angle = rng.uniform(-np.pi, np.pi, count), np.arcsin(rng.uniform(-1, 1, count) * (1 - 1e-12))
    yield Case(f"{name}, random", map, zero, theta, angle)
    yield Case(f"{name}, grazing to 1e-12", map, zero, theta, side * (np.pi / 2 - tiny))
    for lam in (0, 1):
        yield Case(f"{name}, lam = {lam}", scene(name, lam), zero, theta, angle * lam)
    x, y = map.states.point(zero, theta)
    aim = map.states.angle_to_normal(zero, theta, -x, -y) + side * tiny
    yield aimed(f"{name}, through the centre", map, theta, aim, zero)
    grid = np.linspace(-np.pi, np.pi, 4001)
    bulge = grid[map.states.boundary.bending(np.zeros(grid.size, dtype=np.int64), grid)[1] > 1e-6]
    if bulge.size:  # where the wall disperses, a ray may touch it: back from where a tangent ends
        at = rng.choice(bulge, count)
        back = map.step(at, side * (np.pi / 2 - 1e-9))
        x, y = map.states.point(zero, at)
        aim = map.states.angle_to_normal(zero, back.theta, x - back.x, y - back.y) + side * tiny
        yield aimed(f"{name}, tangent to a bulge", map, back.theta, aim, zero)
    if map.ir.has("focus"):  # of an ellipse about the origin
        x, y, *_ = map.ir.program("focus")(map.states.ops)
        theta = np.arctan2(y, x) + rng.integers(0, 2, count) * np.pi + side * tiny
        theta = np.remainder(theta + np.pi, 2 * np.pi) - np.pi
        for lam in (0, 1):
            yield Case(f"{name}, from a tip, lam = {lam}", scene(name, lam), zero, theta, angle * lam)


def spline_cases(name: str, map: PinballMap, count: int, seed: int = SEED_OF_LABELLED) -> Iterator[Case]:
    """Test cases on a table whose pieces are cubic in `theta` from 0 to 1, of `count` particles of every kind."""
    rng, parts = np.random.default_rng(seed), len(map.ir.parts)
    side, tiny = rng.choice([-1, 1], count), 10.0 ** rng.uniform(-12, -1, count)
    at, theta = rng.integers(0, parts, count), rng.uniform(0, 1, count)
    end = np.where(side > 0, tiny, 1 - tiny)
    angle = np.arcsin(rng.uniform(-1, 1, count) * (1 - 1e-12))
    along = rng.choice([-1, 1], count) * (np.pi / 2 - rng.permutation(tiny))
    yield Case(f"{name}, random", map, at, theta, angle)
    yield Case(f"{name}, grazing to 1e-12", map, at, theta, along)
    yield Case(f"{name}, from the end of a piece", map, at, end, angle)
    yield Case(f"{name}, along the wall from the end of a piece", map, at, end, along)
    x, y = map.states.point(at, theta)
    corner = map.states.point(rng.integers(0, parts, count), np.zeros(count))
    aim = map.states.angle_to_normal(at, theta, corner[0] - x, corner[1] - y) + side * tiny
    yield aimed(f"{name}, aimed at the end of a piece", map, theta, aim, at)
    bent = np.concatenate(
        [map.states.boundary.bending(np.full(101, i), np.linspace(0, 1, 101))[1] for i in range(parts)]
    )
    if not np.any(bent > 1e-3):
        return
    bulge = rng.choice(np.flatnonzero(bent > 1e-3), count)
    where, touched = bulge // 101, np.clip(bulge % 101 / 100 + rng.uniform(-0.005, 0.005, count), 0, 1)
    back = map.step(touched, side * (np.pi / 2 - 1e-9), where)  # back from where a tangent ends
    x, y = map.states.point(where, touched)
    aim = map.states.angle_to_normal(back.component, back.theta, x - back.x, y - back.y) + side * tiny
    aim = np.where(back.code == 0, aim, np.nan)
    yield aimed(f"{name}, tangent to a bulge", map, back.theta, aim, back.component)


def _cuspless(rng: np.random.Generator, side: Any, tiny: Array, angle: Array) -> Iterator[Case]:
    map, count = PinballMap("cuspless", lam=LAM), angle.size
    zero, join = np.zeros(count, dtype=np.int64), 2 * np.pi / 3
    yield Case("cuspless, start near a join", map, zero, side * (join - tiny), angle)
    yield Case("cuspless, from the wall", map, zero + 1, rng.uniform(-0.4329, 0.4329, count), angle)
    along = side * (np.pi / 2 - tiny)
    yield Case("cuspless, along the wall", map, zero + 1, rng.uniform(-0.4329, 0.4329, count), along)
    yield Case("cuspless, from the wall near a join", map, zero + 1, side * (np.sqrt(3) / 4 - tiny), angle)
    theta = rng.uniform(-2, 2, count)
    x, y = map.states.point(zero, theta)
    aim = map.states.angle_to_normal(zero, theta, -0.25 - x, side * np.sqrt(3) / 4 - y)
    aim = aim + np.where(rng.integers(0, 2, count) == 0, 1, -1) * tiny
    yield aimed("cuspless, aimed at a join", map, theta, aim, zero)


def conditions(case: Case) -> tuple[Array, Array]:
    """The condition numbers of position and direction after one bounce."""
    matrix = np.abs(case.map.derivative(case.theta, case.phi, case.component))
    return 1 + matrix[:, 0].sum(axis=-1), 1 + matrix[:, 1].sum(axis=-1)


def accuracy(name: str, particles: int = LABELLED) -> Iterator[Accuracy]:
    """The largest errors of every test case on a table, against the exact map of the rounded state."""
    for case in cases(particles) if name in SCENES else own_cases(name, particles // 3):
        if case.label.split(",")[0] == name:
            own, after, code = bounced(case.map, case[2:])
            going = code == 0
            before, found = [row[going] for row in own], [row[going] for row in after]
            position, direction = errors(case.map, ExactMap(case.map, DIGITS), before, found)
            there, turned = (condition[going] for condition in conditions(case))
            largest = (position, direction, position / there, direction / turned)
            yield Accuracy(
                name, case.label.partition(", ")[2], int(going.sum()), *(float(e.max(initial=0)) for e in largest)
            )
