"""Theorems on the corner orbit, on equal multipliers of the egg, and on the branch born at the cuspless flip.

The branch consists of the unstable orbits of period 4 that leave the cuspless cardioid's horizontal orbit at its period
doubling `lambda_c`. It is proved up to the doubling, where a box around the orbits would hold the horizontal orbit too;
so the equations are desingularised. Half an orbit is `(w, v)`, the positions on wall and arc, and the other half is its
mirror image, so the two collision rules `G = f + lam*b` are odd in `(w, v)`. With `w = e`, `v = e*m` the equations `H =
G/e = 0` for `(m, lam)` are regular at `e = 0`: there the horizontal orbit has the multiplier -1. By the mean value
theorem

    H     in  DG(hull) * (1, m)            H_m  =  G_v
    H_lam in  Db(hull) * (1, m)            H_e/e  in  (1/3) * D3G(hull)[(1, m), (1, m), (1, m)]

with the hull of 0 and `(e, e*m)`; the last because the second derivatives of odd functions are odd. So one interval
Newton step proves an orbit for every `e` in `[0, MOST]`; its least period is 4, since `w` and `-w` differ for `e > 0`.
When the ball of `d lam/d(e^2)` excludes 0, its sign says on which side of `lambda_c` the orbit exists. Then no
multiplier is 1 along the branch, because `det [G_w, G_v] = -(d lam/de)*e*det [H_lam, H_m]`: if the orbit is a saddle at
one end, it is a saddle everywhere. Paper: section 5.1.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

from flint import arb, arb_mat
from sympy import Expr

from symbolic.cycles.thresholds import alpha_hat, lambda_c
from symbolic.tables import cuspless, egg
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import balls, real_ball, working
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import trace_and_determinant
from verification.cycles.chords import Chords, chord_angles
from verification.cycles.critical import Small, corner, corner_angle, focus
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import MIRROR
from verification.maps.first_hit import convex, inside
from verification.proofs.corner.border_collision import homoclinic
from verification.proofs.corner.corner import NEAR, Corner, at_corner
from verification.proofs.periodic.cycle_in_box import Box, SolutionInBox, check_unknowns
from verification.proofs.periodic.interval_newton import ZeroStatus, compared, dense
from verification.rigorous.theorem import Verdict, hypothesis


@dataclass(frozen=True, repr=False)
class CornerOrbit(SolutionInBox):
    """Exactly one orbit with `theta1` and `lam` in the box runs through both corners; at this `lam` chaos begins.

    `theta1` is the bounce after the upper corner. `free` names the value of the theorem: `lam`, or `phi`, the exit
    angle at the upper corner.

    >>> with working(80):
    ...     near = (arb("0.25452687132067834252").mid(), arb("0.0712172452489159804").mid())
    >>> CornerOrbit(near, arb(2) ** -40, 80, 10, "lam").proved
    True
    """

    free: str

    def __post_init__(self) -> None:
        if self.free not in ("lam", "phi"):
            raise ValueError(f"certificate: free = {self.free!r} is unknown; accepted: lam, phi")

    @property
    def system(self) -> Small:
        """The two equations of the corner orbit."""
        return corner()

    @property
    def value(self) -> arb:
        """The value that the theorem states, the contraction or the exit angle at the upper corner, as a ball."""
        theta1, lam = self.enclosure.zero
        with working(self.bits):
            value: arb = lam if self.free == "lam" else corner_angle(balls(self.bits), theta1)
            return value

    @property
    def apart(self) -> bool:
        """True if `theta1` is proved to differ from the corners and from its mirror image."""
        return self.found and bool(self.enclosure.zero[0] > 0 and self.enclosure.zero[0] < 2)

    @cached_property
    def sides(self) -> Corner | None:
        """The one-sided derivatives at the corners; None unless the bounces are proved distinct."""
        with working(self.bits):
            return at_corner(balls(self.bits), *self.enclosure.zero) if self.apart else None

    @hypothesis
    def admissible(self) -> Verdict:
        """The table is convex, so every chord ends at the first point of the boundary that it meets."""
        return self.apart and convex(cuspless)

    @hypothesis
    def minimal_period(self) -> bool:
        """The bounces are distinct."""
        return self.apart

    @hypothesis(refutable=True)
    def s4_minimum_at_a_kink(self) -> Verdict:
        """The arc length `s_4` of the fourth bounce has a minimum, with a kink, at the exit angle `phi-star`."""
        return self.sides.minimum_at_kink if self.sides else None

    @hypothesis(refutable=True)
    def s4_dips_below(self) -> Verdict:
        """The minimum of `s_4`, the arc length of the fourth bounce, falls as the contraction grows."""
        fall = -self.sides.descent if self.sides else arb("nan")
        return True if fall > 0 else False if fall < 0 else None

    @hypothesis(refutable=True)
    def unstable(self) -> Verdict:
        """Nearby orbits leave along an eigenvector with a multiplier above 1."""
        return self.sides.unstable if self.sides else None

    @hypothesis
    def precise(self) -> bool:
        """The radius of the value is small enough for the digits stated."""
        return self.found and self.within_digits()

    @property
    def notes(self) -> dict[str, str]:
        """Further facts about the orbit, as text for a reader."""
        sides = self.sides
        if sides is None:
            return {}
        with working(self.bits):
            notes = {
                "equations": "the collision rules at the upper corner and at theta1, for theta1 and lam; the mirror "
                "image of theta1 is the third bounce",
                "slopes_of_s4": f"{sides.slope_arc.str(8)} towards the arc, {sides.slope_wall.str(8)} towards the wall",
                "half_return_traces": f"{sides.arc.trace.str(8)} on the arc, {sides.wall.trace.str(8)} on the wall",
                "half_return_determinant": sides.wall.determinant.str(8),
                "robust_chaos_phi": homoclinic(sides.wall, sides.arc).str(8),
            }
        if sides.robust:
            notes["kind"] = (
                "border collision: the piecewise linear half return meets every hypothesis of robust chaos above "
                "lambda-star, where it has two saddles (orbits of period 4) and an attractor without a stable cycle, "
                "and none of them below; what the map itself does just above is proved by a trapping polygon"
            )
        return notes

    @property
    def name(self) -> str:
        """The name `lambda-star` or `phi-star` if the box is near the paper's values, else a description."""
        near = all(abs(x - mid) < 0.001 for x, mid in zip(self.centre, NEAR, strict=True))
        return {"lam": "lambda-star", "phi": "phi-star"}[self.free] if near else "an orbit through both corners"

    @property
    def subject(self) -> dict[str, Any]:
        """The entries of a document that say which orbit the theorem is about."""
        scene = {"table": "cuspless"}
        return {"kind": "corner", "scene": scene, "free": self.free, "components": [0, 0], "mirror": True}

    @classmethod
    def about(cls, given: Mapping[str, Any], lam: Expr | None, box: Box) -> Self:
        """The theorem that a document states, with a box of `theta1` and `lam`."""
        check_unknowns(box, 2)
        found = cls(*box, given["free"])
        _check_subject(found, given)
        return found


@dataclass(frozen=True, repr=False)
class EqualMultipliers(SolutionInBox):
    """The egg has exactly one 2-cycle with two equal multipliers and with its bounces and `alpha` in the box."""

    lam: Expr

    @property
    def system(self) -> Small:
        """The three equations for the two bounces and `alpha`."""
        return focus(self.lam)

    @property
    def apart(self) -> bool:
        """True if the two bounces are proved distinct."""
        with working(self.bits):
            one, other, _ = self.enclosure.zero
            return self.found and not ((one - other) / 2).sin().contains(0)

    @hypothesis
    def admissible(self) -> Verdict:
        """The table is convex, so every chord ends at the first point of the boundary that it meets."""
        with working(self.bits):
            return self.apart and convex(egg(3), (self.value,))

    @hypothesis
    def minimal_period(self) -> bool:
        """The bounces are distinct."""
        return self.apart

    @hypothesis
    def precise(self) -> bool:
        """The radius of the value is small enough for the digits stated."""
        return self.found and self.within_digits()

    @property
    def name(self) -> str:
        """The name `alpha-hat` if the box holds the closed form of `alpha-hat`, else a description."""
        return "alpha-hat" if self.in_box(alpha_hat().subs(letter, self.lam)) else "equal multipliers"

    @property
    def subject(self) -> dict[str, Any]:
        """The entries of a document that say which cycle the theorem is about."""
        scene = {"table": "egg", "lam": str(self.lam)}
        return {"kind": "focus", "scene": scene, "free": "alpha", "components": [0, 0], "mirror": False}

    @classmethod
    def about(cls, given: Mapping[str, Any], lam: Expr | None, box: Box) -> Self:
        """The theorem that a document states, at this `lam`."""
        check_unknowns(box, 3)
        if lam is None:
            raise KeyError("lam")
        found = cls(*box, lam)
        _check_subject(found, given)
        return found


def _check_subject(theorem: SolutionInBox, given: Mapping[str, Any]) -> None:
    said = theorem.subject
    if said != {key: given[key] for key in said}:
        raise ValueError(f"certificate: scene, components or mirror is not that of a {said['kind']}")


BITS = 96
PARTS = (1, 0)  # the wall, then the arc
MOST = 0.04  # the largest `e`
RADII = (0.05, 0.01)  # of the box of `m` and `lam`


@dataclass(frozen=True)
class DoubledBranch:
    """The branch of one orbit for every `e` of `(0, MOST]`: bounces at `w = e` on the wall, `v = e*m` on the arc.

    `m`, `lam` and `bend`, the derivative `d lam/d(e^2)`, are balls over the whole branch; `end` is `lam` at `e = MOST`.
    `unstable` is True if every orbit is proved to have one multiplier above 1 and one below.
    """

    m: arb
    lam: arb
    bend: arb
    end: arb
    unstable: bool | None


def doubled_branch() -> DoubledBranch | None:
    """The proved branch of orbits with `0 < e <= MOST`; None when a step of the proof fails.

    >>> found = doubled_branch()
    >>> found.unstable, bool(found.bend < 0), bool(found.end < 0.0933)
    (True, True, True)
    """
    with working(BITS):
        middle = [slope_at_zero(), arb(real_ball(lambda_c(), 30).mid())]
        box = [arb(x, r) for x, r in zip(middle, RADII, strict=True)]
        whole = arb(MOST / 2, MOST / 2 * (1 + 2.0**-40))
        solved = step(whole, middle, box)
        if solved is None:
            return None
        image, jacobian = solved
        third = [third_order(whole, *image)[i] for i in range(2)]
        turning = jacobian.solve(arb_mat([[-third[0]], [-third[1]]]))[1, 0] / 2
        m, lam = image
        for _ in range(3):
            last = step(arb(MOST), [arb(m.mid()), arb(lam.mid())], [m, lam])
            if last is None:
                return None
            m, lam = last[0]
        trace, determinant = half(arb(MOST), m, lam)
        _, everywhere = half(whole, *image)
        admissible = inside(cuspless, PARTS, [whole, whole * image[0]]) is True and convex(cuspless) is True
        beyond = 1 - trace + determinant < 0 and abs(everywhere) < 1 and not turning.contains(0)
        return DoubledBranch(image[0], image[1], turning, lam, True if admissible and beyond else None)


def slope_at_zero() -> arb:
    """`m = v/w` at `e = 0`: the eigenvector with multiplier -1 at `lambda_c`, from the rule on the wall."""
    a = dense(linearised(arb(0), arb(0), real_ball(lambda_c(), 30)).plain)
    return arb((-a[0, 0] / a[0, 1]).mid())


def linearised(w: arb, v: arb, lam: arb) -> Linearised:
    """The two collision rules at half an orbit `(w, v)`, with their derivatives."""
    return Linearised(Problem(cuspless, PARTS, lam=lam, closure=MIRROR), balls(BITS), [w, v])


def step(e: arb, middle: list[arb], box: list[arb]) -> tuple[list[arb], arb_mat] | None:
    """One Krawczyk step for `(m, lam)` over a ball of `e`, and the derivatives of the equations `H` there; or None."""
    (m, lam), one = middle, arb_mat([[1, 0], [0, 1]])
    try:
        value = divided(e, m, lam)
        slope = derivatives(e, *box)
        near = arb_mat([[x.mid() for x in row] for row in slope.tolist()]).inv()
    except ZeroDivisionError:
        return None
    moved = near * arb_mat([[x] for x in value])
    spread = (one - near * slope) * arb_mat([[x - y] for x, y in zip(box, middle, strict=True)])
    image = [x - moved[i, 0] + spread[i, 0] for i, x in enumerate(middle)]
    return (image, derivatives(e, *image)) if compared(image, box) is ZeroStatus.UNIQUE else None


def hull_from_zero(e: arb, m: arb) -> tuple[arb, arb]:
    """The hull of 0 and `(e, e*m)`, as a pair of balls."""
    top = e.union(arb(0))
    return top, top * m


def divided(e: arb, m: arb, lam: arb) -> list[arb]:
    """The values `H = G/e` of the two equations (module docstring); from the mean value theorem where `e` may be 0."""
    if not e.contains(0):
        return [rule / e for rule in linearised(e, e * m, lam).value]
    a = dense(linearised(*hull_from_zero(e, m), lam).plain)
    return [a[i, 0] + a[i, 1] * m for i in range(2)]


def derivatives(e: arb, m: arb, lam: arb) -> arb_mat:
    """The 2 by 2 matrix with columns `H_m` and `H_lam`."""
    at = dense(linearised(e, e * m, lam).plain)
    w, v = hull_from_zero(e, m)
    angles = chord_angles(cuspless, balls(BITS))
    # the bounce before the wall is at -v, the bounce before the arc at w
    into = [angles(PARTS[i], PARTS[1 - i], 1)(*ends) for i, ends in enumerate(((w, -v), (v, w)))]
    by_lam = [into[0][1] - into[0][2] * m, into[1][1] * m + into[1][2]]
    return arb_mat([[at[i, 1], by_lam[i]] for i in range(2)])


def third_order(e: arb, m: arb, lam: arb) -> list[arb]:
    """`H_e/e` for both equations: twice the third Taylor coefficient of `G` along `(1, m)`, over the hull."""
    w, v = hull_from_zero(e, m)
    zero = arb(0)
    rule = Chords(cuspless, PARTS, MIRROR).over(jets(balls(BITS)))
    ring = MIRROR.padded([Jet(w, arb(1), zero, zero), Jet(v, m, zero, zero)], 0)
    return [2 * rule(i, ring[i : i + 3], {"lam": lam}, 0).value.c[3] for i in range(2)]


def half(e: arb, m: arb, lam: arb) -> tuple[arb, arb]:
    """Trace and determinant of the derivative of half an orbit, composed with the mirror."""
    chain = linearised(e, e * m, lam).plain
    return trace_and_determinant(chain.rows, chain.sign)
