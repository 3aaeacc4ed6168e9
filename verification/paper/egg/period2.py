"""Judges of claims on the egg's slap map and period-2 orbits for ranges of parameters. Paper: sections 6.1 to 6.3.

A double normal of length `L` has the *stability number* `P = (1 + L*kappa)*(1 + L*kappa')`, from the curvatures at its
ends. The *tilt* of the egg's diameters is `W = sqrt(1 - P)`.
"""

from functools import cache
from typing import TYPE_CHECKING

from sympy import (
    Expr,
    Interval,
    Rational,
    S,
    simplify,
    sqrt,
)

from symbolic.cycles.cycle import (
    c,
    egg_diameter,
    egg_parallel,
    is_double_normal,
    monodromy,
    parallel_shape,
    trace_and_determinant,
)
from symbolic.cycles.thresholds import alpha_hat, alpha_tilde, complex_up_to, stability_number, tilt, trace_of
from symbolic.expressions.signs import SignFinding, conjunction, nonnegative, positive
from symbolic.motion.collision import slap_derivative
from symbolic.tables.table import alpha, lam
from verification.arithmetic.iteration import telling
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import (
    answer,
    by,
    counterexample,
    digits,
    equal,
    identity,
    judges,
    on_range,
    shown,
    zero,
)

if TYPE_CHECKING:
    from verification.rigorous.exclusion import Search

SHAPES = Interval(0, Rational(1, 10))
ROUND = Interval.Lopen(0, Rational(1, 10))  # without the circle
FULL = Interval(-1, 1)  # the range of cos(3*theta)


def at(numeral: str) -> Rational:
    """The exact rational number that a decimal stands for."""
    return Rational(numeral)


@cache
def squared_tilt() -> Expr:
    """The square `W**2 = 1 - P` of the tilt `W`, with the stability number `P` of the diameters."""
    return tilt() ** 2


def P_at(shape: Expr) -> Expr:
    """The stability number of the diameters at one shape."""
    return stability_number(egg_diameter()).subs(alpha, shape)


def diameter() -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy matrix of the diameters."""
    return trace_and_determinant(egg_diameter())


@judges("egg.elastic_period2_elliptic")
def elliptic_diameters(claim: Claim) -> Judgement:
    """The diameters are elliptic, since the stability number `P` has `0 < P < 1`."""
    numbers = [P_at(at(value)) for value in ("0.02", "0.05")]
    return Judgement(
        by("0 < P < 1 at both shapes", *(f for P in numbers for f in (positive(P, {}), positive(1 - P, {})))),
        f"P = {numbers}",
    )


@judges("egg.elastic_period2_unstable")
def unstable_diameters(claim: Claim) -> Judgement:
    """The diameters are unstable at `lam = 1`, since the stability number `P` is negative."""
    P = P_at(at("0.08"))
    return Judgement(by("P < 0, so trace = 4*P - 2 < -2 at lam = 1", positive(-P, {})), f"P = {P}")


def slap_slope(at_vertex: bool) -> Expr:
    """The derivative `T0'` of the slap map at an end of a diameter."""
    cycle = egg_diameter()
    start = cycle.frames[0 if at_vertex else 1]
    return slap_derivative(K0=start.curvature, t=cycle.length(0), cos_eta1=S.One)


@cache
def crossings() -> "Search":
    """The proof that the slap map's slope `T0'` has at most one zero between a flat point and a vertex."""
    from verification.proofs.slap_map.exponent import one_zero  # loaded here: few of these claims need balls

    return one_zero(tick=telling("shapes and cosines"))


@judges("egg.slap_critical_points")
def critical_points(claim: Claim) -> Judgement:
    """The slap map's slope is positive at the vertices; it has zeros only if it is not positive at the flat points."""
    shape, birth = {alpha: at("0.08")}, sqrt(82) - 9
    cover = crossings()
    return Judgement(
        counterexample(
            "at alpha = 0.08 T0' < 0 at the three flat points and > 0 at the three vertices between them",
            positive(-slap_slope(False).subs(shape), {}),
            positive(slap_slope(True).subs(shape), {}),
            at=shape,
        ),
        "none for alpha < sqrt(82) - 9 = 0.05538..., three at it (the flat points), six for every larger alpha up to "
        "1/10, one on each side of each flat point",
        by(
            "between a flat point and a vertex T0' has one zero if it is negative at the flat points, none if positive",
            answer(
                cover.proved,
                f"T0' vanishes at most once between them, growing, for every alpha in [0, 1/10] ({cover.boxes} boxes)",
            ),
            positive(slap_slope(True), {alpha: SHAPES}),
            positive(-slap_slope(False).diff(alpha), {alpha: SHAPES}),
            zero(
                "at the flat points T0' falls with alpha and is 0 at sqrt(82) - 9", slap_slope(False).subs(alpha, birth)
            ),
        ),
        "Six critical points arise, one on each side of each flat point; three only at the critical value itself.",
    )


@judges("egg.slap_fold")
def slap_fold(claim: Claim) -> Judgement:
    """The slap map is not one-to-one, since its slope `T0'` changes sign."""
    shape = {alpha: at("0.08")}
    return Judgement(
        by(
            "T0' changes sign, so T0 is not one to one near a critical point",
            positive(-slap_slope(False).subs(shape), {}),
            positive(slap_slope(True).subs(shape), {}),
        ),
        "T0 takes some values at several points for alpha > sqrt(82) - 9",
    )


@judges("egg.slap_critical_caption")
def critical_caption(claim: Claim) -> Judgement:
    """The slap map is not one-to-one at the caption's shape."""
    return slap_fold(claim)


@judges("egg.slap_period2_stable")
def slap_stable(claim: Claim) -> Judgement:
    """The period-2 orbit of the slap map is stable, since its stability number `P` has `-1 < P < 1`."""
    P = P_at(at("0.05"))
    return Judgement(by(f"(T0^2)' = P = {P}", positive(1 - P**2, {})), f"P = {P}")


@judges("egg.slap_period2_unstable", "egg.horizontal_period2_unstable")
def slap_unstable(claim: Claim) -> Judgement:
    """The period-2 orbit of the slap map is unstable, since its stability number `P` is below -1."""
    P = P_at(at("0.08"))
    return Judgement(by(f"(T0^2)' = P = {P}", positive(-1 - P, {})), f"P = {P}")


@judges("egg.other_period2")
def other_period2(claim: Claim) -> Judgement:
    """The other period-2 orbits exist for each `alpha` up to 1/10, and their stability number `P` is above 1."""
    family = egg_parallel()
    P = stability_number(family)
    left = {c: Interval.Ropen(Rational(-2, 9), 0)}
    shape = parallel_shape()
    return Judgement(
        by(
            "alpha falls strictly with c = cos(theta) from above 1/10 at c = -2/9 to 0 at c = 0, and P > 1 in between",
            shown("normal at both ends", is_double_normal(family)),
            positive(-shape.diff(c), left),
            positive(shape.subs(c, Rational(-2, 9)) - Rational(1, 10), {}),
            zero("", shape.subs(c, 0)),
            positive(P - 1, left),
        ),
        "three orbits for every alpha in (0, 1/10], with P > 1: unstable for every lam",
    )


@judges("egg.period2_orbits")
def diameters_exist(claim: Claim) -> Judgement:
    """The diameters are orbits, since they are normal to the boundary at both ends."""
    return Judgement(
        shown(
            "the diameters are normal to the boundary at both ends, for every alpha", is_double_normal(egg_diameter())
        ),
        "phi = 0",
    )


@judges("egg.monodromy")
def egg_monodromy(claim: Claim) -> Judgement:
    """Judges the printed monodromy matrix at the vertex, in which one exponent is misprinted."""
    return identity(
        claim,
        monodromy(egg_diameter()),
        (
            "(lam*(lam^2 + alpha^4*lam^2 - 2*alpha^2*lam*(162 + 163*lam)))",
            "(lam^2 + alpha^4*lam^2 - 2*alpha^2*lam*(162 + 163*lam))",
        ),
        "Entry (2, 2) has one factor lambda too many: it reads lambda*(lambda^2 + ...) for lambda^2 + ... . "
        "The matrix belongs to the base point at the vertex.",
    )


@judges("egg.mu_not_one")
def mu_not_one(claim: Claim) -> Judgement:
    """No multiplier is 1, since the characteristic polynomial at 1 is `(1+lam)**2*W**2`, where `W` is the tilt."""
    trace, det = diameter()
    return on_range(
        claim,
        lambda box: positive(1 - trace + det, box),
        "mu != 1 for alpha in (0, 1/10]",
        {alpha: ROUND},
        "At alpha = 0 (the circle) one eigenvalue is 1 for every lambda; the statement needs alpha > 0.",
    )


@judges("egg.alpha_tilde")
def doubling_curve(claim: Claim) -> Judgement:
    """The printed and the derived `alpha-tilde` agree: both are non-negative, with equal squares."""
    return Judgement(
        by(
            "both forms are square roots or quotients of positive numbers, with equal squares",
            equal(claim.formula**2, alpha_tilde() ** 2, claim.box),
        ),
        str(alpha_tilde()),
    )


@judges("egg.mu_at_alpha_tilde")
def mu_at_alpha_tilde(claim: Claim) -> Judgement:
    """At `alpha-tilde` the stability number is `-((1-lam)/(1+lam))**2`, so the multipliers are -1 and `-lam**2`."""
    trace, det = diameter()
    both = zero("", trace - trace_of(1 - squared_tilt()), det - lam**2, 1 + trace_of(S.Zero) + lam**2 - (1 - lam) ** 2)
    return Judgement(
        by(
            "1 + trace + det = (1+lam)^2*P + (1-lam)^2 = 0 at alpha-tilde; the other is -lam^2",
            both,
            on_the_curve(),
            equal(claim.formula, -S.One, {}),
        ),
        "-1",
    )


def on_the_curve() -> SignFinding:
    """The finding that the tilt `W` grows with alpha, and `W**2 = 2*(1+lam**2)/(1+lam)**2` at `alpha-tilde`."""
    level = 2 * (1 + lam**2) / (1 + lam) ** 2
    return conjunction(
        zero("", squared_tilt().subs(alpha, alpha_tilde()) - level), positive(tilt().diff(alpha), {alpha: SHAPES})
    )


@judges("egg.period2_unstable_above")
def unstable_above(claim: Claim) -> Judgement:
    """The diameters are unstable above `alpha-tilde`, since the stability number `P` falls with alpha."""
    return Judgement(
        by("1 + trace + det = (1+lam)^2*P + (1-lam)^2 vanishes at alpha-tilde and falls with alpha", on_the_curve()),
        "mu_- < -1 for alpha > alpha-tilde(lam)",
    )


@judges("egg.alpha_tilde_0")
def alpha_tilde_0(claim: Claim) -> Judgement:
    """Judges the printed digits of `alpha-tilde` at `lam = 0`."""
    return digits(claim, alpha_tilde().subs(lam, 0))


@judges("egg.alpha_tilde_1")
def alpha_tilde_1(claim: Claim) -> Judgement:
    """Judges the printed digits of `alpha-tilde` at `lam = 1`."""
    return digits(claim, alpha_tilde().subs(lam, 1))


@judges("egg.period2_always_unstable")
def always_unstable(claim: Claim) -> Judgement:
    """The diameters are unstable for all `lam` above `alpha-tilde(0)`, since `alpha-tilde` falls with `lam`."""
    level = 2 * (1 + lam**2) / (1 + lam) ** 2
    return Judgement(
        by(
            "alpha-tilde falls with lam, so it is largest at lam = 0",
            on_the_curve(),
            nonnegative(-simplify(level.diff(lam)), {lam: Interval(0, 1)}),
        ),
        "alpha-tilde(lam) <= alpha-tilde(0)",
    )


@judges("egg.period2_stable_below")
def stable_below(claim: Claim) -> Judgement:
    """The printed strict inequalities fail at the ends `alpha = 0` and `lam = 1` of their ranges."""
    trace, det = diameter()
    return Judgement(
        counterexample(
            "at alpha = 0 one eigenvalue is 1, and at lam = 1 the product of the eigenvalues is 1",
            zero("", (1 - trace + det).subs(alpha, 0), det.subs(lam, 1) - 1),
            at={alpha: S.Zero, lam: S.Zero},
        ),
        "|mu| < 1 for 0 < alpha < alpha-tilde(lam) and 0 <= lam < 1",
        by(
            "-((1-lam)/(1+lam))^2 < P < 1 there",
            on_the_curve(),
            positive(squared_tilt(), {alpha: ROUND}),
            positive(1 - det, {lam: Interval.Ropen(0, 1)}),
        ),
        "The moduli are below one only for alpha > 0 and lambda < 1: at alpha = 0 one eigenvalue is "
        "1, at lambda = 1 both have modulus 1.",
    )


@judges("egg.alpha_hat")
def focus_curve(claim: Claim) -> Judgement:
    """The printed `alpha-hat` equals the derived one, whose form does not become 0/0 at `lam = 1`."""
    return identity(claim, alpha_hat())


@judges("egg.complex_region")
def complex_region(claim: Claim) -> Judgement:
    """The multipliers are complex between the curves, where the stability number has `0 < P < 4*lam/(1+lam)**2`."""
    low = tilt().subs(alpha, alpha_hat()) - (1 - lam) / (1 + lam)
    high = tilt().subs(alpha, complex_up_to()) - 1
    trace, _ = diameter()
    P = 1 - squared_tilt()
    return Judgement(
        by(
            "P = 4*lam/(1+lam)^2 at alpha-hat and P = 0 at alpha-tilde(1), and P falls with alpha",
            zero("", low, high, trace - trace_of(P), complex_up_to() - alpha_tilde().subs(lam, 1)),
            positive(tilt().diff(alpha), {alpha: SHAPES}),
        ),
        "complex exactly for alpha-hat(lam) < alpha < alpha-tilde(1)",
    )
