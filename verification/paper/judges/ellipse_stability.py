"""Judges of claims on the eigenvalues of the ellipse's minor axis. Paper: section 3.3."""

from collections.abc import Callable

from sympy import Expr, Integer, Interval, Matrix, S, Symbol, cancel, diag, eye, limit, oo, sqrt, symbols

from symbolic.cycles.cycle import discriminant, major_axis, minor_axis, monodromy, multipliers, saddle
from symbolic.cycles.thresholds import lambda_minus, lambda_plus, stability_number, stable_while_nonnegative
from symbolic.expressions.signs import Box, SignFinding, conjunction, nonnegative, positive
from symbolic.tables.table import a, lam
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, counterexample, digits, equal, greater, identity, judges, zero
from verification.paper.judges.ellipse import BEYOND, major, minor

SQRT2 = "at a = sqrt(2) the monodromy matrix is -lam times the identity"
w = Symbol("w", positive=True)  # sqrt(a**2 - 1)


def critical_factor() -> Expr:
    """The factor of the paper's P_2 that changes its sign: `a**4*(trace - 2*det**(1/2))` on the minor axis."""
    trace, _ = minor()
    return (a**4 * (trace - 2 * lam)).expand()


def both_sides_of_sqrt2(prove: Callable[[Box], SignFinding], box: Box) -> SignFinding:
    """The finding that a statement holds for all `a > 1` except `sqrt(2)`; the variable is `w = sqrt(a**2 - 1)`."""
    return conjunction(prove({**box, w: Interval.open(0, 1)}), prove({**box, w: Interval.open(1, oo)}))


def in_w(expression: Expr) -> Expr:
    """The expression, which is even in `a`, as a function of `w = sqrt(a**2 - 1)`."""
    return cancel(expression.subs(a, sqrt(1 + w**2)))


@judges("ellipse.monodromy")
def minor_monodromy(claim: Claim) -> Judgement:
    """Judges the printed monodromy matrix, a product of two flights; by symmetry it is the same at both ends."""
    return identity(claim, monodromy(minor_axis()))


@judges("ellipse.mu")
def minor_multipliers(claim: Claim) -> Judgement:
    """Judges the printed multipliers as roots, with the derived P_1 and P_2 inserted."""
    trace, det = minor()
    derived = {Symbol("P1", real=True): a**4 * trace, Symbol("P2", real=True): a**8 * discriminant(trace, det)}
    finding = equal(claim.formula.subs(derived), Matrix(multipliers(trace, det)), claim.box)
    return Judgement(finding, "mu = (trace +- sqrt(trace^2 - 4*det))/2")


@judges("ellipse.P1")
def first_polynomial(claim: Claim) -> Judgement:
    """The printed P_1 is `a**4` times the trace."""
    return identity(claim, (a**4 * minor()[0]).expand())


@judges("ellipse.P2")
def second_polynomial(claim: Claim) -> Judgement:
    """The printed P_2 is `a**8` times the discriminant."""
    return identity(claim, (a**8 * discriminant(*minor())).factor())


@judges("ellipse.complex_near_one")
def complex_near_one(claim: Claim) -> Judgement:
    """The multipliers are complex near `lam = 1`, except at `a = 1`, where one is 1, and at `a = sqrt(2)`."""
    trace, det = minor()
    circle = 1 - trace.subs(a, 1) + det
    near = 4 * det - trace**2
    return Judgement(
        counterexample("at a = 1 one multiplier is 1 for every lam", zero("", circle), at={a: S.One}),
        "complex with |mu| = lam < 1 for lam in (lambda_-(a), 1), for every a > 1 except a = sqrt(2)",
        by(
            "the discriminant is negative at lam = 1, hence near it, and |mu|^2 = det = lam^2",
            both_sides_of_sqrt2(lambda box: positive(in_w(near.subs(lam, 1)), box), {}),
            zero("det = lam^2", det - lam**2),
        ),
        "Two shapes are exceptions to 'any a >= 1': at a = 1 the eigenvalues are 1 and lambda^2, and at "
        "a = sqrt(2) both equal -lambda (a star node, not a focus).",
    )


@judges("ellipse.mu_to_one", "ellipse.elastic_modulus")
def modulus_at_one(claim: Claim) -> Judgement:
    """At `lam = 1` both multipliers lie on the unit circle: the determinant is 1 and `|trace| <= 2`."""
    trace, det = (x.subs(lam, 1) for x in minor())
    circle = nonnegative(4 - trace**2, {a: claim.box[a]})
    return Judgement(
        by("|trace| <= 2 at lam = 1, so both moduli are det^(1/2)", circle, equal(claim.formula, sqrt(det), {})),
        "|mu| = 1",
    )


@judges("ellipse.elastic_elliptic")
def elastic_elliptic(claim: Claim) -> Judgement:
    """The orbit is elliptic at `lam = 1` in the sense of section 6.4; at two shapes the eigenvalues are real."""
    trace, det = (x.subs(lam, 1) for x in minor())
    return Judgement(
        by(
            "at lam = 1 the determinant is 1 and |trace| <= 2, with equality at a = 1 and a = sqrt(2) alone",
            zero("", det - 1, trace.subs(a, 1) - 2, trace.subs(a, sqrt(2)) + 2),
            both_sides_of_sqrt2(lambda box: positive(in_w(4 - trace**2), box), {}),
        ),
        "eigenvalues on the unit circle, as section 6.4 defines elliptic, for every a >= 1; they are real at a = 1 "
        "(both 1) and at a = sqrt(2) (both -1), where stricter definitions say parabolic",
    )


@judges("ellipse.P2_crossing")
def crossing(claim: Claim) -> Judgement:
    """`P_2` has the sign of the discriminant, of which it is a positive multiple."""
    return Judgement(
        by("P_2 = a^8*(trace^2 - 4*det) and a^8 > 0", positive(a**8, {a: claim.box[a]})),
        "real where P_2 > 0, complex where P_2 < 0",
    )


@judges("ellipse.P2_sqrt2")
def touching(claim: Claim) -> Judgement:
    """`P_2` has a zero at `a = sqrt(2)` without a change of sign, by the factor `(a**2 - 2)**2`."""
    P2 = (a**8 * discriminant(*minor())).factor()
    rest = P2 / ((1 + lam) ** 2 * (a**2 - 2) ** 2)
    same_side = {lam: Interval.Lopen(0, 1)}
    return Judgement(
        counterexample(
            "P_2 = (1 + lam)^2*(a^2 - 2)^2*Q keeps the sign of Q at a = sqrt(2)",
            equal(rest, critical_factor(), {}),
            positive(-critical_factor().subs(a, sqrt(2)), same_side),
            at={a: sqrt(2), lam: S.Half},
        ),
        "P_2 touches 0 at a = sqrt(2) without changing sign: Q = -16*lam there",
        by(
            "Q = -16*lam at a = sqrt(2), so Q < 0 on both sides of it for lam > 0; at lam = 0 Q is a square",
            zero("", critical_factor().subs(a, sqrt(2)) + 16 * lam, critical_factor().subs(lam, 0) - (a**2 - 2) ** 2),
        ),
        "At a = sqrt(2) P_2 touches 0 but does not cross it; for lambda > 0 the eigenvalues are complex on both sides, "
        "and at lambda = 0 real on both.",
    )


@judges("ellipse.lambda_plus")
def upper_root(claim: Claim) -> Judgement:
    """Judges the printed `lambda_+`, which is the inverse of `lambda_-`."""
    return identity(claim, lambda_plus())


@judges("ellipse.lambda_minus")
def lower_root(claim: Claim) -> Judgement:
    """The printed `lambda_-` is `((w-1)/(w+1))**2`, a root of the critical factor."""
    judgement = identity(claim, lambda_minus())
    vanishing = zero("P_2 vanishes there", critical_factor().subs(lam, lambda_minus()))
    return Judgement(conjunction(judgement.printed, vanishing), "((w - 1)/(w + 1))^2 with w = sqrt(a^2 - 1)")


@judges("ellipse.lambda_plus_outside")
def upper_outside(claim: Claim) -> Judgement:
    """`lambda_+ > 1` except for the circle, since `(w+1)**2 - (w-1)**2 = 4*w`."""
    above = (w + 1) ** 2 - (w - 1) ** 2
    return Judgement(
        counterexample("at a = 1, lambda_+ = 1", zero("", lambda_plus().subs(a, 1) - 1), at={a: S.One}),
        "lambda_+(a) > 1 for every a > 1, and lambda_+(1) = 1",
        by("lambda_+ > 1 as (w + 1)^2 > (w - 1)^2", positive(above, {w: Interval.open(0, oo)})),
        "At a = 1 lambda_+ = 1 belongs to the region; it is outside for every a > 1.",
    )


@judges("ellipse.lambda_minus_range")
def lower_range(claim: Claim) -> Judgement:
    """`lambda_-` lies in [0, 1], as it is a square that is at most 1."""
    inside = nonnegative((w + 1) ** 2 - (w - 1) ** 2, {w: Interval(0, oo)})
    return Judgement(by("lambda_- = ((w-1)/(w+1))^2 is a square and at most 1", inside), "0 <= lambda_- <= 1")


@judges("ellipse.lambda_minus_sqrt2")
def lower_limit_at_sqrt2(claim: Claim) -> Judgement:
    """Judges the printed limit of `lambda_-` at `sqrt(2)`, where it is continuous."""
    reached = lambda_minus().subs(a, sqrt(2))
    return Judgement(by("lambda_- is continuous at a = sqrt(2)", equal(claim.formula, reached, {})), str(reached))


@judges("ellipse.lambda_minus_oo")
def lower_limit_at_infinity(claim: Claim) -> Judgement:
    """Judges the printed limit of `lambda_-`, a rational function of `w` with equal leading coefficients."""
    reached = limit(((w - 1) / (w + 1)) ** 2, w, oo)
    return Judgement(by("the limit of ((w-1)/(w+1))^2 as w -> oo", equal(claim.formula, reached, {})), str(reached))


@judges("ellipse.stable_node")
def stable_node(claim: Claim) -> Judgement:
    """The orbit is a stable node below `lambda_-`: the critical factor has the roots `lambda_-` and `lambda_+`."""
    trace, det = minor()
    roots = (a**2 - 2) ** 2 * (lam - lambda_minus()) * (lam - lambda_plus())
    inside = stable_while_nonnegative(stability_number(minor_axis()), {**BEYOND, lam: Interval.Ropen(0, 1)})
    return Judgement(
        counterexample(
            "at a = 1 one multiplier is 1 for every lam", zero("", (1 - trace + det).subs(a, 1)), at={a: S.One}
        ),
        "a stable node for a > 1 and lam < lambda_-(a)",
        by("P_2 > 0 below both roots, and |mu| < 1 for every a > 1", equal(critical_factor(), roots, {}), inside),
        "At a = 1 the orbit is not a node: one eigenvalue is 1 for every lambda (a line of diameters).",
    )


@judges("ellipse.complex_above")
def complex_above(claim: Claim) -> Judgement:
    """The multipliers are complex between the roots, except where the other factor of `P_2` vanishes."""
    trace, det = minor()
    roots = (a**2 - 2) ** 2 * (lam - lambda_minus()) * (lam - lambda_plus())
    share = Symbol("share", positive=True)  # lam = lambda_- + share*(1 - lambda_-)
    low = ((w - 1) / (w + 1)) ** 2
    inside = in_w(4 * det - trace**2).subs(lam, low + share * (1 - low)).together()
    return Judgement(
        counterexample(SQRT2, zero("", discriminant(trace, det).subs(a, sqrt(2))), at={a: sqrt(2)}),
        "complex for lambda_-(a) < lam <= 1, a > 1, a != sqrt(2)",
        by(
            "P_2 < 0 between its roots",
            equal(critical_factor(), roots, {}),
            both_sides_of_sqrt2(lambda box: positive(inside, box), {share: Interval.Lopen(0, 1)}),
        ),
        "At a = sqrt(2) both eigenvalues are real and equal to -lambda for every lambda.",
    )


@judges("ellipse.splitting_nonreal")
def splitting_nonreal(claim: Claim) -> Judgement:
    """Without real eigenvalues there is no splitting, since an invariant line has a real eigenvalue."""
    mu, v, m12, m22 = symbols("mu v m12 m22", real=True)
    kept = Matrix([[mu - m12 * v, m12], [(mu - m22) * v, m22]])  # every matrix that maps (1, v) to mu*(1, v)
    return Judgement(
        by(
            "an invariant line is spanned by an eigenvector, and its eigenvalue is real",
            zero("", *(kept * Matrix([1, v]) - mu * Matrix([1, v]))),
            zero("", (kept - mu * eye(2)).det()),
        ),
        "no real eigenvalue, no invariant line",
    )


def eigenline_defects() -> list[Expr]:
    """Expressions whose vanishing shows that `A*v` is an eigenvector of `A*B` if `v = (1, 0)` is one of `B*A`."""
    a11, a12, a21, a22, b12, b22, mu = symbols("a11 a12 a21 a22 b12 b22 mu", real=True)
    A = Matrix([[a11, a12], [a21, a22]])
    B = Matrix([[mu, b12], [0, b22]]) * A.inv()  # every B with B*A*(1, 0) = mu*(1, 0)
    v = Matrix([1, 0])
    return [(A * B * (A * v) - mu * A * v)[i].together().factor() for i in range(2)]


@judges("ellipse.splitting_hyperbolic")
def splitting_hyperbolic(claim: Claim) -> Judgement:
    """A counterexample: the minor axis at `lam = lambda_-(a)`, with equal multipliers and one eigenvector."""
    at_threshold = monodromy(minor_axis()).subs(a, 3).subs(lam, lambda_minus().subs(a, 3))
    trace, det = at_threshold.trace(), at_threshold.det()
    open_box = {**BEYOND, lam: Interval.open(0, 1)}
    return Judgement(
        counterexample(
            "at a = 3, lam = lambda_-(3) the multipliers are real, equal and inside the unit circle, "
            "and the matrix is not diagonal: there is one invariant direction, not two",
            zero("", trace**2 - 4 * det),
            greater(S.One, det),
            greater(at_threshold[0, 1] ** 2, S.Zero),
            at={a: S(3), lam: lambda_minus().subs(a, 3)},
        ),
        "finitely many hyperbolic cycles with real multipliers of different modulus have dominated splitting",
        by(
            "the eigenlines of the larger and of the smaller modulus are continuous on a finite set, a flight takes "
            "them to those at the next point with the same multipliers, and these dominate by their ratio",
            zero("", *eigenline_defects()),
            saddle(*major(), open_box),
        ),
        "The real eigenvalues must also differ in modulus; a node with equal eigenvalues has no dominated splitting.",
    )


@judges("ellipse.dominated_splitting")
def dominated_splitting(claim: Claim) -> Judgement:
    """The multipliers are real and distinct below `lambda_-`, have a Jordan block at it, and are complex above."""
    corner = monodromy(minor_axis())[0, 1]
    off = both_sides_of_sqrt2(lambda box: positive(in_w(corner**2), box), {lam: Interval(0, 1)})
    roots = (a**2 - 2) ** 2 * (lam - lambda_minus()) * (lam - lambda_plus())
    return Judgement(
        counterexample(
            "at lam = lambda_-(a) the multipliers coincide in a Jordan block: only one direction is invariant",
            zero("", critical_factor().subs(lam, lambda_minus())),
            off,
            at={a: S(3), lam: lambda_minus().subs(a, 3)},
        ),
        "dominated splitting for lam in (0, lambda_-(a)), none for lam in [lambda_-(a), 1); at a = sqrt(2) for no lam",
        by(
            "real distinct multipliers below, one Jordan block at, complex ones above lambda_-",
            equal(critical_factor(), roots, {}),
            off,
        ),
        "The interval is open at lambda_a: (0, lambda_a), not (0, lambda_a]. At lambda_a = lambda_-(a) the two "
        "eigendirections coincide.",
    )


@judges("ellipse.lambda_minus_5")
def lower_root_at_5(claim: Claim) -> Judgement:
    """Judges the printed digits of `lambda_-(5)`, by the closed form."""
    return digits(claim, lambda_minus().subs(a, Integer(5)))


@judges("ellipse.major_by_inversion")
def major_by_inversion(claim: Claim) -> Judgement:
    """The major axis is the minor axis of the ellipse with `1/a`, after a rotation and a scaling by `a`."""
    enlarged = diag(a, 1) * monodromy(minor_axis()).subs(a, 1 / a) * diag(1 / a, 1)
    return Judgement(
        by("an identity, with arc length in units of a", zero("", *(enlarged - monodromy(major_axis())))),
        "D T^2 on the major axis is that on the minor axis with 1/a for a, in units of length of a",
    )
