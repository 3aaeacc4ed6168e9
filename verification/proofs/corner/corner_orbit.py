"""Certificates of what is no fold and no flip: the corner orbit, where multipliers turn complex, and a doubled branch.

The branch is that of the unstable orbits of period 4 which leave the cuspless cardioid's horizontal orbit at its
doubling, and it is proved up to the doubling itself. Near `lambda_c` they come as near to the horizontal orbit as
wanted, and no box around them leaves it out; so the doubling is blown up. Half an orbit is `(w, v)`, on the wall and
on the arc, and the other half its mirror image, so the two collision rules `G = f + lam*b` are odd in `(w, v)`. With
`w = e`, `v = e*m` the equations `H = G/e = 0` for `(m, lam)` are regular at `e = 0`: there the horizontal orbit has
the multiplier -1. By the mean value theorem

    H     in  DG(hull) * (1, m)            H_m  =  G_v
    H_lam in  Db(hull) * (1, m)            H_e/e  in  (1/3) * D3G(hull)[(1, m), (1, m), (1, m)]

with the hull of 0 and `(e, e*m)`; the last because second derivatives of odd functions are odd. So one interval
Newton step proves an orbit for every `e` of `[0, MOST]`, of least period 4 where `w` and `-w` differ; and `d
lam/d(e^2)`, when its ball excludes 0, says on which side of `lambda_c` it is. Then no multiplier is 1 on the way,
because `det [G_w, G_v] = -(d lam/de)*e*det [H_lam, H_m]`, and what is a saddle at one end is one all along. Paper:
section 5.1.
"""

from dataclasses import dataclass, field

from flint import arb, arb_mat
from sympy import Expr

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables import cuspless, egg
from verification.arithmetic.balls import balls, real_ball, working
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import trace_and_determinant
from verification.cycles.chords import Chords, chord_angles
from verification.cycles.critical import Small, corner, corner_angle, focus
from verification.cycles.problem import Linearised, Problem
from verification.cycles.recurrence import MIRROR
from verification.maps.first_hit import convex, inside
from verification.proofs.corner.border_collision import homoclinic
from verification.proofs.corner.corner import at_corner
from verification.proofs.periodic.bifurcation import Checks
from verification.proofs.periodic.interval_newton import Enclosure, Status, compared, dense, interval_newton


@dataclass(frozen=True)
class CornerClaim:
    """A box for the solution of a small system: `lam`, `phi` of the corner orbit, or `alpha` of the focus."""

    value: str
    centre: tuple[arb, ...]
    radius: arb
    bits: int
    digits: int
    lam: Expr | None = None

    def __post_init__(self) -> None:
        if self.value not in ("lam", "phi", "alpha") or (self.value == "alpha") != (self.lam is not None):
            raise ValueError(f"certificate: value = {self.value!r} with lam = {self.lam} is unknown")

    @property
    def system(self) -> Small:
        """The equations."""
        return corner() if self.lam is None else focus(self.lam)


@dataclass(frozen=True)
class CornerProof:
    """What was proved of such a claim."""

    claim: CornerClaim
    checks: Checks
    enclosure: Enclosure
    value: arb
    notes: dict[str, str] = field(default_factory=dict)

    @property
    def certified(self) -> bool:
        """True when every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())


def corner_proved(claim: CornerClaim) -> CornerProof:
    """The checklist of a special claim, worked through.

    >>> with working(80):
    ...     near = (arb("0.25452687132067834252").mid(), arb("0.0712172452489159804").mid())
    >>> corner_proved(CornerClaim("lam", near, arb(2) ** -40, 80, 10)).certified
    True
    """
    found = interval_newton(claim.system, list(claim.centre), claim.radius, claim.bits)
    unique = found.status is Status.UNIQUE
    said = False if found.status is Status.EMPTY else unique or None
    checks: Checks = {"exists": said, "unique": said}
    with working(claim.bits):
        if claim.value == "alpha":
            value, notes = found.zero[-1], dict[str, str]()
            apart = unique and not ((found.zero[0] - found.zero[1]) / 2).sin().contains(0)
            checks["admissible"] = (apart and convex(egg(3), (value,))) or None
            checks["minimal_period"] = apart or None
        else:
            value, notes = _corner(claim, found, checks)
        checks["precise"] = (unique and bool(value.rad() < arb(10) ** -claim.digits)) or None
    return CornerProof(claim, checks, found, value, notes)


def _corner(claim: CornerClaim, found: Enclosure, checks: Checks) -> tuple[arb, dict[str, str]]:
    theta1, lam = found.zero
    words = balls(claim.bits)
    apart = found.status is Status.UNIQUE and bool(theta1 > 0 and theta1 < 2)  # off corners and mirror image
    checks["admissible"] = (apart and convex(cuspless)) or None
    checks["minimal_period"] = apart or None
    value = lam if claim.value == "lam" else corner_angle(words, theta1)
    if not apart:
        return value, {}
    sides = at_corner(words, theta1, lam)
    checks["s4_minimum_at_a_kink"] = sides.minimum_at_kink
    checks["s4_dips_below"] = True if sides.descent < 0 else False if sides.descent > 0 else None
    checks["unstable"] = sides.unstable
    notes = {
        "equations": "the collision rules at the upper corner and at theta1, for theta1 and lam; the mirror image "
        "of theta1 is the third bounce",
        "slopes_of_s4": f"{sides.slope_arc.str(8)} towards the arc, {sides.slope_wall.str(8)} towards the wall",
        "half_return_traces": f"{sides.arc.trace.str(8)} on the arc, {sides.wall.trace.str(8)} on the wall",
        "half_return_determinant": sides.wall.determinant.str(8),
        "robust_chaos_phi": homoclinic(sides.wall, sides.arc).str(8),
    }
    if sides.robust:
        notes["kind"] = (
            "border collision: the piecewise linear half return meets every hypothesis of robust chaos above "
            "lambda-star, where it has two saddles (orbits of period 4) and an attractor without a stable cycle, and "
            "none of them below; what the map itself does just above is proved by a trapping polygon"
        )
    return value, notes


BITS = 96
PARTS = (1, 0)  # the wall, then the arc
MOST = 0.04  # the largest `e`
RADII = (0.05, 0.01)  # of the box of `m` and `lam`


@dataclass(frozen=True)
class DoubledBranch:
    """For every `e` of `(0, MOST]` one orbit: the balls of `m` and `lam`, of `d lam/d(e^2)`, and `lam` at the end.

    `unstable` when one multiplier of each of them exceeds 1 and the other is less.
    """

    m: arb
    lam: arb
    bend: arb
    end: arb
    unstable: bool | None


def doubled_branch() -> DoubledBranch | None:
    """The orbits with `0 < e <= MOST`, proved; None when a step of the proof fails.

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
    """`m = v/w` of the direction that the doubling keeps, from the wall's rule at `lambda_c`."""
    a = dense(linearised(arb(0), arb(0), real_ball(lambda_c(), 30)).plain)
    return arb((-a[0, 0] / a[0, 1]).mid())


def linearised(w: arb, v: arb, lam: arb) -> Linearised:
    """The two collision rules at half an orbit, with their derivatives."""
    return Linearised(Problem(cuspless, PARTS, lam=lam, closure=MIRROR), balls(BITS), [w, v])


def step(e: arb, middle: list[arb], box: list[arb]) -> tuple[list[arb], arb_mat] | None:
    """One step of Krawczyk's operator for `(m, lam)`, over a ball of `e`, and the derivatives of `H` on its image."""
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
    return (image, derivatives(e, *image)) if compared(image, box) is Status.UNIQUE else None


def hull_from_zero(e: arb, m: arb) -> tuple[arb, arb]:
    """Balls around 0 and `(e, e*m)`."""
    top = e.union(arb(0))
    return top, top * m


def divided(e: arb, m: arb, lam: arb) -> list[arb]:
    """`H = G/e`; by the mean value theorem where `e` may be 0."""
    if not e.contains(0):
        return [rule / e for rule in linearised(e, e * m, lam).value]
    a = dense(linearised(*hull_from_zero(e, m), lam).plain)
    return [a[i, 0] + a[i, 1] * m for i in range(2)]


def derivatives(e: arb, m: arb, lam: arb) -> arb_mat:
    """The columns `H_m` and `H_lam`."""
    at = dense(linearised(e, e * m, lam).plain)
    w, v = hull_from_zero(e, m)
    angles = chord_angles(cuspless, balls(BITS))
    # of the rule at the wall the bounce before is -v, of the rule on the arc it is w
    into = [angles(PARTS[i], PARTS[1 - i], 1)(*ends) for i, ends in enumerate(((w, -v), (v, w)))]
    by_lam = [into[0][1] - into[0][2] * m, into[1][1] * m + into[1][2]]
    return arb_mat([[at[i, 1], by_lam[i]] for i in range(2)])


def third_order(e: arb, m: arb, lam: arb) -> list[arb]:
    """`H_e/e`: twice the third Taylor coefficient of `G` along `(1, m)`, over the hull."""
    w, v = hull_from_zero(e, m)
    zero = arb(0)
    rule = Chords(cuspless, PARTS, MIRROR).over(jets(balls(BITS)))
    ring = MIRROR.padded([Jet(w, arb(1), zero, zero), Jet(v, m, zero, zero)], 0)
    return [2 * rule(i, ring[i : i + 3], {"lam": lam}, 0).value.c[3] for i in range(2)]


def half(e: arb, m: arb, lam: arb) -> tuple[arb, arb]:
    """Trace and determinant of half an orbit, followed by the mirror."""
    chain = linearised(e, e * m, lam).plain
    return trace_and_determinant(chain.rows, chain.sign)
