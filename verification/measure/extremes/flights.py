"""The extreme flights as data: a scene, its contraction, and the starts.

A start is `(component, theta, phi)`. On a table with joins, `theta` may be an `Ulps` (a number of units in the last
place inside the end of a component), and `phi` an `Aim` (towards a join, up to a number of ulps).

Errors and condition number of one bounce are measured against a proved enclosure with a hundred digits. Its data and
its result are `(theta, psi)`, the parameter and the direction of flight in the plane; `phi` would count the curvature
twice, as it turns with the boundary. A shape that is not a double counts as rounded data too.
"""

from copy import copy
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf, pi
from typing import Any

import mpmath
import numpy as np
from sympy import sqrt

from numeric import PinballMap, Status
from verification.arithmetic.balls import as_ball, bits_of
from verification.maps.enclosed import EnclosedMap, Refusal
from verification.maps.exact import Bounce, ExactMap, exact_bounce
from verification.measure.extremes.kernels import GOES_ON, KERNELS, TEXTBOOK, TestedKernel
from verification.measure.extremes.near import DOUBLE, WRONG, Errors, Finding, StabilityVerdict

JOIN = 2 * pi / 3
HALF_HEIGHT = 3**0.5 / 4
LAMBDA_STAR = "0.0712172452489159804115973829"  # paper, section 5.2; digits by `pinball locate lambda-star`
PHI_STAR = -0.0289794737869139600  # the exit angle at the upper join, by `pinball locate phi-star`
THETA_STAR = 0.2545268713206783425  # the orbit's bounce on the arc, by `verification.cycles.critical.corner`


@dataclass(frozen=True)
class Ulps:
    """A parameter `count` ulps inside the upper (`side = 1`) or lower (`side = -1`) end of its component."""

    count: int
    side: int = 1


@dataclass(frozen=True)
class Aim:
    """The exit angle towards the join on one side, changed by `count` ulps."""

    count: int
    side: int = 1


Start = tuple[int, Any, Any]


@dataclass(frozen=True)
class KernelCase:
    """A test case: one bounce by every kernel from each start; `shape` is exact, even if it is not a double."""

    name: str
    group: str
    scene: str
    starts: tuple[Start, ...]
    lam: Any = "19/20"
    shape: tuple[tuple[str, Any], ...] = ()

    @property
    def shapes(self) -> dict[str, Any]:
        """The shape parameters as keywords."""
        return dict(self.shape)


TABLES: dict[str, tuple[tuple[str, Any], ...]] = {
    "circle": (),
    "ellipse": (("a", Fraction(3, 2)),),
    "cardioid": (),
    "cuspless": (),
    "egg": (("alpha", Fraction(2, 25)),),
}
USUAL: tuple[Start, ...] = ((0, 0.3, 0.2), (0, -1.1, 0.9), (0, 1.9, -1.3))
ALONG: tuple[Start, ...] = ((0, 0.3, 0.0), (0, -1.1, 0.0), (0, 1.9, 0.0))
TIP: tuple[Start, ...] = ((0, 1e-3, 0.2), (0, 1e-8, -0.4), (0, -1e-12, 1.2))


def _grazing(scene: str) -> KernelCase:
    gaps = (1e-3, 1e-6, 1e-9, 1e-12, 1e-15)
    starts = tuple((0, (0.4, -1.7)[i % 2], (1, -1)[i % 2] * (pi / 2 - gap)) for i, gap in enumerate(gaps))
    return KernelCase(f"{scene}: exits grazing to 1e-3 ... 1e-15", "Grazing exits", scene, starts, shape=TABLES[scene])


def _cusp() -> tuple[KernelCase, ...]:
    gaps = (1e-2, 1e-5, 1e-8, 1e-11, 1e-14)
    near = tuple((0, (1, -1)[i % 2] * (pi - gap), (0.7, -1.2)[i % 2]) for i, gap in enumerate(gaps))
    aimed = tuple((0, theta, theta / 2 + miss) for theta in (1.0, -2.2) for miss in (1e-3, 1e-6, -1e-9, 1e-12))
    hit = ((0, 1.0, 0.5), (0, -2.0, -1.0))
    return (
        KernelCase("start 1e-2 ... 1e-14 from the cusp", "The cusp of the cardioid", "cardioid", near),
        KernelCase("aimed past the cusp by 1e-3 ... 1e-12", "The cusp of the cardioid", "cardioid", aimed),
        KernelCase("aimed at the cusp", "The cusp of the cardioid", "cardioid", hit),
    )


def _ellipses() -> tuple[KernelCase, ...]:
    group = "Axis of the ellipse"
    return tuple(
        KernelCase(f"a = {label}{where}", group, "ellipse", starts, shape=(("a", a),))
        for label, a, where, starts in (
            ("1", Fraction(1), "", USUAL),
            ("1 + 2^-52", 1 + Fraction(1, 2**52), "", USUAL),
            ("1 + 1e-8", 1 + Fraction(1, 10**8), "", USUAL),
            ("sqrt(2), exactly", sqrt(2), "", USUAL),
            ("1e4", Fraction(10**4), "", USUAL),
            ("1e4", Fraction(10**4), ", from the tip", TIP),
            ("1e8", Fraction(10**8), "", USUAL),
            ("1e8", Fraction(10**8), ", from the tip", TIP),
        )
    )


def _eggs() -> tuple[KernelCase, ...]:
    group, flat = "Bulge of the egg", pi / 3
    gaps = (0.0, 1e-12, 1e-6)
    leaving = tuple((0, flat + gap, phi) for gap in gaps for phi in (0.3, -1.5, pi / 2 - 1e-6))
    return tuple(
        KernelCase(f"alpha = {label}", group, "egg", starts, shape=(("alpha", alpha),))
        for label, alpha, starts in (
            ("0", Fraction(0), USUAL),
            ("1e-300", Fraction(1, 10**300), USUAL),
            ("1e-16", Fraction(1, 10**16), USUAL),
            ("1/10, where the curvature is 0 at three points", Fraction(1, 10), USUAL),
            ("1/10, from the flat points, grazing too", Fraction(1, 10), leaving),
        )
    )


def _contractions() -> tuple[KernelCase, ...]:
    return tuple(
        KernelCase(f"{scene}, lam = {lam}", "Ends of the contraction", scene, ALONG if lam == 0 else USUAL, lam, shape)
        for scene, shape in TABLES.items()
        for lam in (0, 1e-300, 1e-8, 1 - 1e-12, 1)
    )


def _joins() -> tuple[KernelCase, ...]:
    group, made = "Joins of the cuspless table", []
    for count in (0, 1, 2, 1000):
        sides = (1, -1)
        arc = tuple((0, Ulps(count, side), side * phi) for side in sides for phi in (0.4, -0.9))
        wall = tuple((1, Ulps(count, side), side * phi) for side in sides for phi in (0.4, -0.9))
        made.append(KernelCase(f"start on the arc, {count} ulp from a join", group, "cuspless", arc))
        made.append(KernelCase(f"start on the wall, {count} ulp from a join", group, "cuspless", wall))
    for count in (0, 1, -1, 2, -2, 1000, -1000):
        aimed = tuple((0, theta, Aim(count, side)) for side in (1, -1) for theta in (0.5, -1.3))
        made.append(KernelCase(f"aimed at a join, the angle {count:+d} ulp", group, "cuspless", aimed))
    return tuple(made)


def _corner_orbit() -> tuple[KernelCase, ...]:
    """The test cases on the orbit of period 4 through both joins: flights from or to a join, or close to one."""
    group, made = "The orbit through both joins, at lambda*", []
    for count in (0, 1, 2, 1000):
        arc = tuple((0, Ulps(count, side), side * PHI_STAR) for side in (1, -1))
        wall = tuple((1, Ulps(count, -side), side * PHI_STAR) for side in (1, -1))
        made.append(
            KernelCase(f"from the join, {count} ulp on the side of the arc", group, "cuspless", arc, LAMBDA_STAR)
        )
        made.append(
            KernelCase(f"from the join, {count} ulp on the side of the wall", group, "cuspless", wall, LAMBDA_STAR)
        )
    for count in (0, 1, -1, 2, -2, 1000, -1000):
        to = tuple((0, side * THETA_STAR, Aim(-side * count, -side)) for side in (1, -1))
        made.append(KernelCase(f"to the join, the angle {count:+d} ulp", group, "cuspless", to, LAMBDA_STAR))
    return tuple(made)


CASES: tuple[KernelCase, ...] = (
    *(_grazing(scene) for scene in TABLES),
    *_cusp(),
    *_ellipses(),
    *_eggs(),
    *_contractions(),
    *_joins(),
    *_corner_orbit(),
)


DIGITS = 100
CANCELS = "-q + sqrt(q*q - p*r) cancels where the flight is short"
SMALLER = mpmath.mpf(10) ** -35  # step of the difference quotients: 30 digits are lost, 35 are left


class Truth:
    """The exact map of a case's table: in balls, and in mpmath numbers where an enclosure fails."""

    def __init__(self, case: KernelCase) -> None:
        self.map = PinballMap(case.scene, lam=case.lam, **case.shapes)
        self.lam = Fraction(float(self.map.lam.flat[0]))
        exact = copy(self.map)
        self.shape = exact.exact_shape = list(case.shapes.values())
        self.exact = ExactMap(exact, DIGITS, self.lam)
        self.mp = self.exact.context
        self.balls = EnclosedMap(exact, self.lam, bits_of(DIGITS + 20))
        shown = self.map.shape or exact.exact_shape  # of a table in a unit of its own numbers are exact
        self.rounded = [value != Fraction(near) for value, near in zip(exact.exact_shape, shown, strict=True)]
        self.nearby = self._nearby(exact) if any(self.rounded) else None

    def starts(self, case: KernelCase) -> list[list[Any]]:
        """The kernels' fields for every start."""
        states = self.map.states
        made = []
        for component, theta, phi in case.starts:
            low, high = states.ends[component]
            if isinstance(theta, Ulps):
                theta = _ulps(high if theta.side > 0 else low, -theta.side * theta.count)
            place = np.array([component]), np.array([float(theta)])
            if isinstance(phi, Aim):
                x, y = states.point(*place)
                towards = states.angle_to_normal(*place, -0.25 - x, phi.side * HALF_HEIGHT - y)
                phi = _ulps(float(towards[0]), phi.count)
            rows = states.enter(*place, np.array([float(phi)]), self.map.law)
            made.append([row[0] for row in rows])
        return made

    def bounce(self, here: Bounce, balls: EnclosedMap | None = None) -> Bounce:
        """The landing, proved to be the first hit; if that fails, by the map in mpmath with a hundred digits."""
        balls = balls or self.balls
        found = balls.bounce(balls.start(as_ball(here.theta), as_ball(here.phi), here.component))
        if isinstance(found, Refusal):
            return self.exact.bounce(here)
        if found.code == Status.JOIN.code:  # a landing, though on either of two parts
            return replace(self.exact.bounce(here), code=0)
        if found.code:
            return found
        middle = self.exact.middle
        return self.exact.start(middle(found.theta), middle(found.phi), found.component)

    def derivative(self, here: Bounce, landed: Bounce) -> Any:
        """The derivative of the landing's `(theta, psi)` by the start's, and by log(shape) if the shape is rounded."""
        mp, exact = self.mp, self.exact
        columns = []
        if self.map.law == "slap":
            shifted = [exact.start(here.theta + SMALLER, 0, here.component)]
        else:
            c, s = mp.cos(SMALLER), mp.sin(SMALLER)
            vx, vy = here.v
            turned = exact.along(here.theta, (c * vx - s * vy, s * vx + c * vy), here.component)
            shifted = [exact.along(here.theta + SMALLER, here.v, here.component), turned]
        for one in shifted:
            columns.append([x / SMALLER for x in self.gap(self.bounce(one), landed)])
        if self.nearby is not None:
            columns.append([x / SMALLER for x in self.gap(self.bounce(here, self.nearby), landed)])
        return mp.matrix(columns).T

    def gap(self, one: Bounce, other: Bounce) -> list[Any]:
        """`one - other` in `(theta, psi)`, or `theta` alone for the slap map; a distance if the components differ."""
        mp = self.mp
        theta = one.theta - other.theta
        if one.component != other.component:
            theta = mp.hypot(one.x - other.x, one.y - other.y)
        if len(self.map.ir.parts) == 1:
            theta -= 2 * mp.pi * mp.nint(theta / (2 * mp.pi))
        if self.map.law == "slap":
            return [theta]
        (x, y), (u, v) = one.v, other.v
        return [theta, mp.atan2(y * u - x * v, x * u + y * v)]

    def _nearby(self, exact: PinballMap) -> EnclosedMap:
        other = copy(exact)
        step = Fraction(1, 10**35)
        other.exact_shape = [value * (1 + step) for value in exact.exact_shape]
        return EnclosedMap(other, self.lam, bits_of(DIGITS + 20))


class ReferenceState:
    """A start as the kernels hold it, with its true landing and the derivative of the landing, computed once."""

    def __init__(self, truth: Truth, state: list[Any]) -> None:
        self.truth, self.state = truth, state
        self.here = here = exact_bounce(truth.map, truth.exact, state)
        self.landed = truth.bounce(here)
        if self.landed.code:
            return
        mp, matrix = truth.mp, truth.derivative(here, self.landed)
        self.spread = matrix * matrix.T + mp.eye(matrix.rows)  # effect of one unit in data and result
        self.condition = mp.sqrt(max(mp.eigsy(self.spread, eigvals_only=True)))

    def why(self, status: str) -> tuple[float, str]:
        """How far the true flight is from the outcome (join or grazing) that a kernel reported; the same in words."""
        mp, landed, (vx, vy) = self.truth.mp, self.landed, self.here.v
        if status == Status.JOIN.name:
            x, height = -mp.mpf(1) / 4 - self.here.x, mp.sqrt(3) / 4
            miss = float(min(abs(vx * (y - self.here.y) - vy * x) for y in (height, -height)) / DOUBLE)
            return miss, f"the true flight passes the join {miss:.2g} units off"
        if status == Status.GRAZING.name and landed.eta is not None:
            cosine = float(mp.cos(landed.eta))
            return cosine, f"the true cos(eta) is {cosine:.2g}, the border 2^-50"
        return (0.0, "the truth stops there too") if landed.code else (1.0, "the truth goes on")

    def measured(self, fields: list[Any], unit: float) -> Errors:
        """The errors of a kernel's fields, and the condition number."""
        truth, mp = self.truth, self.truth.mp
        if self.landed.code or not all(np.isfinite(float(field)) for field in fields):
            return WRONG
        found = exact_bounce(truth.map, truth.exact, fields)
        gap = mp.matrix(truth.gap(found, self.landed))
        backward = mp.sqrt((gap.T * mp.lu_solve(self.spread, gap))[0])
        return Errors(*(float(x) for x in (mp.norm(gap) / unit, backward / unit, self.condition)))


def findings(case: KernelCase, starts: int | None = None) -> list[Finding]:
    """The findings on a case: for each kernel, that on its worst start."""
    truth = Truth(case)
    asked = [ReferenceState(truth, state) for state in truth.starts(case)[:starts]]
    return [_finding(case, truth, kernel, asked) for kernel in (*KERNELS, TEXTBOOK) if kernel.runs(truth.map)]


def _finding(case: KernelCase, truth: Truth, kernel: TestedKernel, asked: list[ReferenceState]) -> Finding:
    worst: Errors | None = None
    stopped: dict[str, list[tuple[float, str]]] = {}
    for one in asked:
        fields, status = kernel.bounce(truth.map, one.state, truth.shape)
        if status != GOES_ON:
            stopped.setdefault(status, []).append(one.why(status))
            continue
        found = one.measured(fields, kernel.unit)
        worst = found if worst is None or found.backward > worst.backward else worst
    said = [max(stopped[status])[1] for status in sorted(stopped)]
    if worst is not None and worst.stability is StabilityVerdict.UNSTABLE:
        said.append(CANCELS if kernel is TEXTBOOK else "the backward error")
    return Finding(case.name, kernel.name, worst, ", ".join(sorted(stopped)), reason="; ".join(said))


def _ulps(end: float, count: int) -> float:
    """The double `count` ulps above `end`, below it for negative `count`."""
    for _ in range(abs(count)):
        end = float(np.nextafter(end, inf if count > 0 else -inf))
    return end
