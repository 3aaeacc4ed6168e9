"""Claims on the circular table. Paper: section 3.1."""

from sympy import Expr, Interval, Matrix, S, Symbol, cos, expand, limit, oo, pi, powsimp, simplify, sin

from symbolic.expressions.signs import Finding, conjunction, positive
from symbolic.motion.collision import derivative_matrix, exit_angle
from symbolic.motion.flight import flight, iterate, limit_position
from symbolic.tables.table import eta, lam, phi, s
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, identity, judges, zero

n = Symbol("n", integer=True, nonnegative=True)
more = Symbol("more", positive=True)  # 1/lam - 1


def explicit_map() -> Finding:
    """The chord from arc length `s` at exit angle `phi` ends at `s + pi - 2*phi`, on the circle and along the ray."""
    landing, _ = flight(s, phi)
    ray = (2 * cos(phi) * cos(s + pi - phi), 2 * cos(phi) * sin(s + pi - phi))
    gap = (cos(s) + ray[0] - cos(landing), sin(s) + ray[1] - sin(landing))
    return zero("the landing point is q0 + 2*cos(phi)*v", *gap)


def settles() -> Finding:
    """By induction: the closed form of the state after `n` bounces, and how far an even bounce is off its limit."""
    position, angle = after(n)
    even, small = after(2 * n)
    return conjunction(
        zero("the closed form holds at n = 0", after(S.Zero)[0] - s, after(S.Zero)[1] - phi),
        zero(
            "and one bounce takes it from n to n + 1: phi_n = lam^n*phi",
            expand(simplify(flight(position, angle)[0] - after(n + 1)[0])),
            powsimp(flight(position, angle)[1] - after(n + 1)[1]),
        ),
        zero(
            "s_2n - 2*pi*n - limit = 2*phi_2n/(1 - lam)",
            simplify(even - 2 * pi * n - limit_position() - 2 * small / (1 - lam)),
        ),
        zero("lam^n tends to 0 for 0 <= lam < 1", limit((1 / (1 + more)) ** n, n, oo)),
    )


def after(bounces: Expr) -> tuple[Expr, Expr]:
    """The state after `bounces` bounces: `s + pi*n - 2*phi*(1 + lam + ... + lam**(n-1))` and `lam**n*phi`."""
    return s + pi * bounces - 2 * phi * (1 - lam**bounces) / (1 - lam), lam**bounces * phi


@judges("circle.elastic_angles", "circle.elastic_integrable")
def elastic(claim: Claim) -> Judgement:
    """`phi1 = lam*phi`."""
    return Judgement(
        by("phi is conserved at lam = 1", explicit_map(), zero("", flight()[1].subs(lam, 1) - phi)),
        "T_1(s, phi) = (s + pi - 2*phi, phi)",
    )


@judges("circle.exit_angle")
def exit_angle_of_circle(claim: Claim) -> Judgement:
    """A chord meets the circle at equal angles, `eta1 = -phi0`."""
    return identity(claim, exit_angle().subs(eta, -phi))


@judges("circle.nearer_diameter")
def nearer(claim: Claim) -> Judgement:
    """The angle from the diameter shrinks by `lam`."""
    shrinks = positive(1 - lam, {lam: Interval.Ropen(0, 1)})
    return Judgement(by("|phi1| = lam*|phi| < |phi| for phi != 0", explicit_map(), shrinks), "|phi1| = lam*|phi|")


@judges("circle.converges", "circle.limit_set")
def converges(claim: Claim) -> Judgement:
    """The map is explicit, so its limit is."""
    return Judgement(
        by(
            "phi_n tends to 0 and s_2n to s - 2*phi/(1 - lam); a state with phi = 0 has period 2",
            explicit_map(),
            settles(),
        ),
        f"s_2n -> {limit_position()} (mod 2*pi), phi_n -> 0",
    )


@judges("circle.every_diameter", "circle.slap_period2")
def diameters(claim: Claim) -> Judgement:
    """Every state with `phi = 0` has period 2."""
    twice = Matrix(iterate(2)).subs(phi, 0)
    return Judgement(
        by("T^2(s, 0) = (s + 2*pi, 0)", explicit_map(), zero("", twice[0] - s - 2 * pi, twice[1])),
        "T^2(s, 0) = (s, 0) (mod 2*pi)",
    )


@judges("circle.dominated_splitting")
def splitting(claim: Claim) -> Judgement:
    """The derivative on `phi = 0` is one constant matrix."""
    matrix = derivative_matrix(K0=-1, K1=-1, t=2, cos_phi0=1, cos_eta1=1)
    along, across = Matrix([1, 0]), Matrix([2, 1 - lam])
    return Judgement(
        by(
            "DT is constant on the limit set, with eigenvalues 1 > lam and constant eigenvectors: "
            "dominated with nu = lam",
            zero("", *(matrix * along - along), *(matrix * across - lam * across)),
            positive(1 - lam, {lam: Interval.open(0, 1)}),
        ),
        "eigenvalues 1 and lam, eigenvectors (1, 0) and (2, 1 - lam)",
    )


@judges("circle.slap")
def slap(claim: Claim) -> Judgement:
    """The explicit map at `phi = 0`."""
    return identity(claim, flight()[0].subs(phi, 0))
