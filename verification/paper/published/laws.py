"""Judges of claims on general reflection laws: areas, stability of double normals, rotations in the circle.

Each statement is derived for an arbitrary law `F(eta)`, and verified for an example that is proved to be a law.
"""

from sympy import Expr, Function, Matrix, Rational, Symbol, cos, diff, pi, sin

from symbolic import tables
from symbolic.expressions.signs import SignFinding
from symbolic.motion.collision import area_factor, derivative_matrix
from symbolic.tables.geometry import curvature
from symbolic.tables.law import Law
from symbolic.tables.table import eta, lam, phi, s, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, equal, greater, judges, zero

F = Function("F", real=True)  # an arbitrary law: phi = F(eta)
RATIONAL, IRRATIONAL = pi / 6, Rational(1)  # angles p, for rotations by pi - 2*p
CONTRACTING = "-lam*sin(eta)"


def law(formula: str) -> SignFinding:
    """The finding that a formula is a law for every contraction from 0 to 1."""
    return Law(formula).proof()


@judges("law.non_hamiltonian")
def non_hamiltonian(claim: Claim) -> Judgement:
    """The factor by which a law `phi = F(eta)` changes areas is minus the derivative of `sin(F)` by `sin(eta)`."""
    along = diff(sin(F(eta)), eta) / diff(sin(eta), eta)
    example = Law(CONTRACTING).phi
    return Judgement(
        by(
            "a law that keeps areas everywhere has sin(phi) = c - sin(eta) or c + sin(eta) on -pi/2 < eta < pi/2, by "
            "continuity with one sign; as |sin(phi)| < 1 there, c = 0: it is phi = -eta or phi = eta. Under any other "
            "the factor differs from 1 at some angle, and so near it; under -lam*sin(eta) it is below 1 everywhere",
            zero("g = -d sin(F)/d sin(eta)", area_factor(F(eta)) + along),
            zero("g of -lam*sin(eta)", area_factor(example) - lam * cos(lam * sin(eta))),
            law(CONTRACTING),
        ),
        "g = -F'(eta)*cos(F(eta))/cos(eta) for any law F; |g| = 1 for phi = -eta and phi = eta alone",
    )


def double_normal(sigma: Expr) -> Matrix:
    """The monodromy matrix of the short axis of the ellipse, for a law with the slope `-sigma` at the normal."""
    ellipse = tables.ellipse.components[0]
    bend, length = curvature(ellipse).subs(theta, pi / 2), 2
    return derivative_matrix(K0=bend, K1=bend, t=length, cos_phi0=1, cos_eta1=1, lam=sigma) ** 2


@judges("law.stability")
def stability(claim: Claim) -> Judgement:
    """An elliptic double normal attracts under some laws close to the elastic law, and repels under others."""
    a, sigma = tables.ellipse.shapes[0].symbol, Symbol("sigma", positive=True)
    matrix = double_normal(sigma).subs(a, Rational(3, 2))
    trace, determinant = matrix.trace().expand(), matrix.det().expand()
    gap = (4 * determinant - trace**2).subs(sigma, 1)
    return Judgement(
        by(
            "a double normal is an orbit of period 2 of every law with F(0) = 0, and its multipliers depend on the law "
            "through sigma = -F'(0) alone; their product is sigma**2, and where they are complex at sigma = 1, as are "
            "those of the short axis of the ellipse a = 3/2, they stay so near by: on the unit circle for sigma = 1 "
            "alone, within it for sigma < 1, beyond it for sigma > 1",
            equal(determinant, sigma**2, {}),
            greater(gap, Rational(0)),
            law("-eta + lam*sin(2*eta)/9"),
            zero("sigma = 1 - 2*lam/9", Law("-eta + lam*sin(2*eta)/9").slope.subs(eta, 0) - 1 + 2 * lam / 9),
        ),
        "elliptic cycles at a double normal attract for -F'(0) < 1 and repel for -F'(0) > 1, however near to 1",
    )


def landing(formula: Expr) -> tuple[SignFinding, Expr]:
    """The finding on a flight in the unit circle (it turns by `pi - 2*phi`, `eta1 = -phi`), and the next exit angle."""
    direction, length = s + pi - phi, 2 * cos(phi)
    start, end = (Matrix([cos(angle), sin(angle)]) for angle in (s, s + pi - 2 * phi))
    flown = start + length * Matrix([cos(direction), sin(direction)]) - end
    incidence = (s + pi - 2 * phi + pi / 2) - direction - pi / 2
    return zero("circle: s1 = s + pi - 2*phi, eta1 = -phi", *flown, incidence + phi), formula.subs(eta, -phi)


@judges("law.rotation")
def rotation(claim: Claim) -> Judgement:
    """In the circle, if `F(-p) = p` and `|F'(-p)| < 1`, the line `phi = p` attracts; on it the map is a rotation."""
    p, mu, sigma = Symbol("p", real=True), Symbol("mu"), Symbol("sigma", real=True)
    circle = {"K0": -1, "K1": -1, "t": 2 * cos(phi), "cos_phi0": cos(phi), "cos_eta1": cos(phi)}
    spectrum = derivative_matrix(**circle, lam=sigma).charpoly(mu).as_expr()
    formula = Law("(1 - lam)*p - lam*eta").phi
    flown, exit = landing(formula)
    held = [law(f"(1 - lam)*({angle}) - lam*eta") for angle in (RATIONAL, IRRATIONAL)]
    return Judgement(
        by(
            "under (1 - lam)*p - lam*eta with 0 < lam < 1 all orbits of the circle tend to phi = p, and those with a "
            "past for ever lie on it: phi - p is multiplied by lam at each bounce. That line is the limit set; there "
            "the map turns s by pi - 2*p, the derivative has the same two eigenvectors everywhere, and their factors 1 "
            "and sigma = lam are a dominated splitting. A third of a turn for p = pi/6; 1/2 - 1/pi of one "
            "for p = 1, irrational as pi is",
            flown,
            zero("phi1 - p = lam*(phi - p)", exit - p - lam * (phi - p)),
            zero("eigenvalues 1 and sigma", spectrum - (mu - 1) * (mu - sigma)),
            zero("pi - 2*p is a third of a turn", pi - 2 * RATIONAL - 2 * pi / 3),
            greater(pi / 2, IRRATIONAL),
            *held,
        ),
        "for any law with F(-p) = p and |F'(-p)| < 1 the line phi = p of the circle attracts, and the map turns it by "
        "pi - 2*p: with uniform contraction p = 0 is the only such angle",
    )
