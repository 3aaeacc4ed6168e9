"""The extreme flights, as data: a scene, its contraction, and the starts.

A start is `(component, theta, phi)`. On a table with joins the parameter may be an `Ulps`: so many
units in the last place inside the end of a component; and the angle an `Aim`: at a join, and then so many ulps off.
"""

from dataclasses import dataclass
from fractions import Fraction
from math import pi
from typing import Any

from sympy import sqrt

JOIN = 2 * pi / 3
HALF_HEIGHT = 3**0.5 / 4
LAMBDA_STAR = "0.0712172452489159804115973829"  # paper, section 5.2; digits by `pinball locate lambda-star`
PHI_STAR = -0.0289794737869139600  # the exit angle at the upper join, by `pinball locate phi-star`
THETA_STAR = 0.2545268713206783425  # the orbit's bounce on the arc, by `verification.cycles.shooting.small.corner`


@dataclass(frozen=True)
class Ulps:
    """A parameter this many ulps inside the upper (`side = 1`) or lower (-1) end of its component."""

    count: int
    side: int = 1


@dataclass(frozen=True)
class Aim:
    """The exit angle to the wall's end on one side, and then so many ulps of the angle up, or (negative) down."""

    count: int
    side: int = 1


Start = tuple[int, Any, Any]


@dataclass(frozen=True)
class Case:
    """One bounce asked of every kernel, for each start; `exact` is the shape, where no double is it."""

    name: str
    group: str
    scene: str
    starts: tuple[Start, ...]
    lam: Any = "19/20"
    shape: tuple[tuple[str, Any], ...] = ()

    @property
    def shapes(self) -> dict[str, Any]:
        """The shape as keywords."""
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


def _grazing(scene: str) -> Case:
    gaps = (1e-3, 1e-6, 1e-9, 1e-12, 1e-15)
    starts = tuple((0, (0.4, -1.7)[i % 2], (1, -1)[i % 2] * (pi / 2 - gap)) for i, gap in enumerate(gaps))
    return Case(f"{scene}: exits grazing to 1e-3 ... 1e-15", "Grazing exits", scene, starts, shape=TABLES[scene])


def _cusp() -> tuple[Case, ...]:
    gaps = (1e-2, 1e-5, 1e-8, 1e-11, 1e-14)
    near = tuple((0, (1, -1)[i % 2] * (pi - gap), (0.7, -1.2)[i % 2]) for i, gap in enumerate(gaps))
    aimed = tuple((0, theta, theta / 2 + miss) for theta in (1.0, -2.2) for miss in (1e-3, 1e-6, -1e-9, 1e-12))
    hit = ((0, 1.0, 0.5), (0, -2.0, -1.0))
    return (
        Case("start 1e-2 ... 1e-14 from the cusp", "The cusp of the cardioid", "cardioid", near),
        Case("aimed past the cusp by 1e-3 ... 1e-12", "The cusp of the cardioid", "cardioid", aimed),
        Case("aimed at the cusp", "The cusp of the cardioid", "cardioid", hit),
    )


def _ellipses() -> tuple[Case, ...]:
    group = "Axis of the ellipse"
    return tuple(
        Case(f"a = {label}{where}", group, "ellipse", starts, shape=(("a", a),))
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


def _eggs() -> tuple[Case, ...]:
    group, flat = "Bulge of the egg", pi / 3
    gaps = (0.0, 1e-12, 1e-6)
    leaving = tuple((0, flat + gap, phi) for gap in gaps for phi in (0.3, -1.5, pi / 2 - 1e-6))
    return tuple(
        Case(f"alpha = {label}", group, "egg", starts, shape=(("alpha", alpha),))
        for label, alpha, starts in (
            ("0", Fraction(0), USUAL),
            ("1e-300", Fraction(1, 10**300), USUAL),
            ("1e-16", Fraction(1, 10**16), USUAL),
            ("1/10, where the curvature is 0 at three points", Fraction(1, 10), USUAL),
            ("1/10, from the flat points, grazing too", Fraction(1, 10), leaving),
        )
    )


def _contractions() -> tuple[Case, ...]:
    return tuple(
        Case(f"{scene}, lam = {lam}", "Ends of the contraction", scene, ALONG if lam == 0 else USUAL, lam, shape)
        for scene, shape in TABLES.items()
        for lam in (0, 1e-300, 1e-8, 1 - 1e-12, 1)
    )


def _joins() -> tuple[Case, ...]:
    group, made = "Joins of the cuspless table", []
    for count in (0, 1, 2, 1000):
        sides = (1, -1)
        arc = tuple((0, Ulps(count, side), side * phi) for side in sides for phi in (0.4, -0.9))
        wall = tuple((1, Ulps(count, side), side * phi) for side in sides for phi in (0.4, -0.9))
        made.append(Case(f"start on the arc, {count} ulp from a join", group, "cuspless", arc))
        made.append(Case(f"start on the wall, {count} ulp from a join", group, "cuspless", wall))
    for count in (0, 1, -1, 2, -2, 1000, -1000):
        aimed = tuple((0, theta, Aim(count, side)) for side in (1, -1) for theta in (0.5, -1.3))
        made.append(Case(f"aimed at a join, the angle {count:+d} ulp", group, "cuspless", aimed))
    return tuple(made)


def _corner_orbit() -> tuple[Case, ...]:
    """The orbit of period 4 through both joins: its flights from a join, from next to it, to it, and to next to it."""
    group, made = "The orbit through both joins, at lambda*", []
    for count in (0, 1, 2, 1000):
        arc = tuple((0, Ulps(count, side), side * PHI_STAR) for side in (1, -1))
        wall = tuple((1, Ulps(count, -side), side * PHI_STAR) for side in (1, -1))
        made.append(Case(f"from the join, {count} ulp on the side of the arc", group, "cuspless", arc, LAMBDA_STAR))
        made.append(Case(f"from the join, {count} ulp on the side of the wall", group, "cuspless", wall, LAMBDA_STAR))
    for count in (0, 1, -1, 2, -2, 1000, -1000):
        to = tuple((0, side * THETA_STAR, Aim(-side * count, -side)) for side in (1, -1))
        made.append(Case(f"to the join, the angle {count:+d} ulp", group, "cuspless", to, LAMBDA_STAR))
    return tuple(made)


CASES: tuple[Case, ...] = (
    *(_grazing(scene) for scene in TABLES),
    *_cusp(),
    *_ellipses(),
    *_eggs(),
    *_contractions(),
    *_joins(),
    *_corner_orbit(),
)
