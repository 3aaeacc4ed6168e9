"""Certificates of what is no fold and no flip: the corner orbit, and where multipliers turn complex."""

from dataclasses import dataclass, field

from flint import arb
from sympy import Expr

from symbolic.tables import cuspless
from verification.arithmetic.words import balls, working
from verification.cycles.shooting.small import Small, corner, corner_angle, focus
from verification.maps.admissible import convex
from verification.proofs.corner.border_collision import homoclinic
from verification.proofs.corner.corner import at_corner
from verification.proofs.periodic.bifurcation import Checks
from verification.proofs.periodic.interval_newton import Enclosure, Status, contraction


@dataclass(frozen=True)
class SpecialClaim:
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
class SpecialProof:
    """What was proved of a special claim."""

    claim: SpecialClaim
    checks: Checks
    enclosure: Enclosure
    value: arb
    notes: dict[str, str] = field(default_factory=dict)

    @property
    def certified(self) -> bool:
        """True when every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())


def specially_proved(claim: SpecialClaim) -> SpecialProof:
    """The checklist of a special claim, worked through.

    >>> with working(80):
    ...     near = (arb("0.25452687132067834252").mid(), arb("0.0712172452489159804").mid())
    >>> specially_proved(SpecialClaim("lam", near, arb(2) ** -40, 80, 10)).certified
    True
    """
    found = contraction(claim.system, list(claim.centre), claim.radius, claim.bits)
    unique = found.status is Status.UNIQUE
    said = False if found.status is Status.EMPTY else unique or None
    checks: Checks = {"exists": said, "unique": said}
    with working(claim.bits):
        if claim.value == "alpha":
            value, notes = found.zero[-1], dict[str, str]()
        else:
            value, notes = _corner(claim, found, checks)
        checks["precise"] = (unique and bool(value.rad() < arb(10) ** -claim.digits)) or None
    return SpecialProof(claim, checks, found, value, notes)


def _corner(claim: SpecialClaim, found: Enclosure, checks: Checks) -> tuple[arb, dict[str, str]]:
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
