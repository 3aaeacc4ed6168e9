"""Judges of claims on the circle and the ellipse: orbits, limits and slap maps. Paper: sections 3.1, 3.2 and 3.4.

A double normal of length `L` has the *stability number* `P = (1 + L*kappa)*(1 + L*kappa')`, from the curvatures at its
ends.
"""

from sympy import (
    Expr,
    Interval,
    Matrix,
    Rational,
    S,
    Symbol,
    cos,
    expand,
    limit,
    oo,
    pi,
    powsimp,
    simplify,
    sin,
    symbols,
)

from symbolic.cycles.cycle import is_double_normal, major_axis, minor_axis, saddle, trace_and_determinant
from symbolic.cycles.thresholds import stability_number, stable_while_nonnegative
from symbolic.expressions.signs import Box, SignFinding, conjunction, nonnegative, positive
from symbolic.motion.collision import derivative_matrix, exit_angle, gradient, joachimsthal_defect
from symbolic.motion.flight import flight, iterate, limit_position
from symbolic.tables import ellipse
from symbolic.tables.geometry import centre_of_curvature, curvature, velocity
from symbolic.tables.table import a, eta, lam, phi, s, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, equal, identity, judges, on_range, zero

n = Symbol("n", integer=True, nonnegative=True)
more = Symbol("more", positive=True)  # 1/lam - 1


def explicit_map() -> SignFinding:
    """The finding that in the circle the chord from arc length `s` at the angle `phi` ends at `s + pi - 2*phi`."""
    landing, _ = flight(s, phi)
    ray = (2 * cos(phi) * cos(s + pi - phi), 2 * cos(phi) * sin(s + pi - phi))
    gap = (cos(s) + ray[0] - cos(landing), sin(s) + ray[1] - sin(landing))
    return zero("the landing point is q0 + 2*cos(phi)*v", *gap)


def settles() -> SignFinding:
    """The finding that every orbit of the circle converges to a diameter, by a closed form of its bounces."""
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
    """Arc length and angle of a particle in the circle after `bounces` bounces, in closed form."""
    return s + pi * bounces - 2 * phi * (1 - lam**bounces) / (1 - lam), lam**bounces * phi


@judges("circle.elastic_angles", "circle.elastic_integrable")
def elastic(claim: Claim) -> Judgement:
    """In the circle with elastic collisions `phi` is constant, since `phi1 = lam*phi`."""
    return Judgement(
        by("phi is conserved at lam = 1", explicit_map(), zero("", flight()[1].subs(lam, 1) - phi)),
        "T_1(s, phi) = (s + pi - 2*phi, phi)",
    )


@judges("circle.exit_angle")
def exit_angle_of_circle(claim: Claim) -> Judgement:
    """Judges the printed exit angle in the circle, where a chord makes equal angles at both ends: `eta1 = -phi0`."""
    return identity(claim, exit_angle().subs(eta, -phi))


@judges("circle.nearer_diameter")
def nearer(claim: Claim) -> Judgement:
    """The angle from the diameter is multiplied by `lam` at each bounce."""
    shrinks = positive(1 - lam, {lam: Interval.Ropen(0, 1)})
    return Judgement(by("|phi1| = lam*|phi| < |phi| for phi != 0", explicit_map(), shrinks), "|phi1| = lam*|phi|")


@judges("circle.converges", "circle.limit_set")
def converges(claim: Claim) -> Judgement:
    """Every orbit in the circle converges to the printed limit, as the explicit map shows."""
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
    """Every orbit of the circle that starts with `phi = 0` has period 2."""
    twice = Matrix(iterate(2)).subs(phi, 0)
    return Judgement(
        by("T^2(s, 0) = (s + 2*pi, 0)", explicit_map(), zero("", twice[0] - s - 2 * pi, twice[1])),
        "T^2(s, 0) = (s, 0) (mod 2*pi)",
    )


@judges("circle.dominated_splitting")
def splitting(claim: Claim) -> Judgement:
    """Judges the splitting of the circle's derivative on `phi = 0`, where the derivative is a constant matrix."""
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
    """Judges the printed slap map of the circle, which is the explicit map at `phi = 0`."""
    return identity(claim, flight()[0].subs(phi, 0))


@judges("ellipse.parametrisation")
def parametrisation(claim: Claim) -> Judgement:
    """Judges the printed parametrisation of the ellipse."""
    return identity(claim, Matrix(ellipse.components[0].point))


@judges("ellipse.shape_range")
def shape_range(claim: Claim) -> Judgement:
    """Shapes `a >= 1` suffice, by scaling with the shorter half axis and exchanging the axes if necessary."""
    p, q = symbols("p q", positive=True)
    x, y = p * cos(theta) / q, q * sin(theta) / q
    scaled = Matrix(ellipse.components[0].point).subs(a, p / q)
    return Judgement(
        by("half axes p >= q, divided by q, give a = p/q >= 1", equal(Matrix([x, y]), scaled, {})),
        "half axes p >= q are a = p/q and 1 in another unit of length",
    )


@judges("ellipse.elastic_integrable")
def integrable(claim: Claim) -> Judgement:
    """The elastic ellipse is integrable: Joachimsthal's product is preserved by flight and reflection."""
    return Judgement(
        by("g(q)*cos(phi) is conserved at lam = 1", zero("", joachimsthal_defect())), "J = |(x/a^2, y)|*cos(phi)"
    )


@judges("ellipse.two_period2")
def two_period2(claim: Claim) -> Judgement:
    """The ellipse has two orbits of period 2, its double normals."""
    return Judgement(axes_alone(claim.box), "the chords of the two axes, and no other")


def axes_alone(box: Box) -> SignFinding:
    """The finding that a chord with parameters `m + B` and `m - B` that is normal at both ends lies on an axis."""
    m, B = symbols("m B", real=True)
    x, y = ellipse.components[0].point
    chord = Matrix([x, y]).subs(theta, m + B) - Matrix([x, y]).subs(theta, m - B)
    tangents = [velocity(ellipse.components[0]).subs(theta, m + sign * B) for sign in (1, -1)]
    total = chord.dot(tangents[0]) + chord.dot(tangents[1])
    difference = chord.dot(tangents[0]) - chord.dot(tangents[1])
    diameter = 4 * sin(B) * cos(B) * (a**2 * sin(m) ** 2 + cos(m) ** 2)
    axes = 4 * sin(B) ** 2 * (a**2 - 1) * sin(m) * cos(m)
    return by(
        "normal at both ends means sin(B)*cos(B)*(a^2 sin(m)^2 + cos(m)^2) = 0 and "
        "sin(B)^2*(a^2 - 1)*sin(m)*cos(m) = 0, so cos(B) = 0 and m is a multiple of pi/2",
        zero("", total - diameter, difference - axes),
        positive(a**2 - 1, box),
    )


@judges("ellipse.minor_axis_stable")
def minor_axis_stable(claim: Claim) -> Judgement:
    """The minor axis is stable over the whole range, by Jury's criterion."""
    P = stability_number(minor_axis())
    return on_range(claim, lambda box: stable_while_nonnegative(P, box), "|mu| < 1")


@judges("ellipse.major_axis_invariant")
def major_axis_invariant(claim: Claim) -> Judgement:
    """The major axis is an orbit, since it is normal to the boundary at both ends."""
    return Judgement(
        answer(is_double_normal(major_axis()), "the major axis is normal to the boundary at both ends"),
        "phi = 0 forever",
    )


def lyapunov() -> list[SignFinding]:
    """The findings that `J = g*cos(phi)` never decreases, and is larger on the minor axis than on the major one.

    `g` is the modulus of the gradient of `(x/a)**2 + y**2`, up to a factor.
    """
    ends = [gradient(*ellipse.components[0].at(angle)).norm() for angle in (S.Zero, pi / 2)]
    return [
        zero("J survives the flight (Joachimsthal)", joachimsthal_defect()),
        positive(1 - lam, {lam: Interval.Ropen(0, 1)}),
        positive(ends[1] - ends[0], BEYOND),
        axes_alone(BEYOND),
    ]


LIMIT = (
    "J = g(q)*cos(phi) grows at every bounce with eta != 0, because cos(lam*eta) > cos(eta); so a limit point has "
    "phi = 0 forever and lies on a double normal, of which there are two"
)


@judges("ellipse.limit_set")
def limit_set(claim: Claim) -> Judgement:
    """The limit set consists of the two double normals, by a Lyapunov function."""
    return Judgement(two_cycles(claim.box), "the stable minor and the unstable major axis, for every a > 1")


def two_cycles(box: Box | None = None) -> SignFinding:
    """The finding that for `a > 1` and `0 < lam < 1` every orbit converges to the stable or the unstable axis."""
    open_box = {**BEYOND, **(box or {lam: Interval.open(0, 1)})}
    return by(
        LIMIT,
        *lyapunov(),
        stable_while_nonnegative(stability_number(minor_axis()), open_box),
        saddle(*major(), open_box),
    )


@judges("ellipse.basin", "ellipse.major_axis_leaves")
def basin(claim: Claim) -> Judgement:
    """A counterexample: the unstable orbit is a saddle, and the points of its stable manifold converge to it."""
    open_box = {**BEYOND, lam: Interval.open(0, 1)}
    is_saddle = saddle(*major(), open_box)
    return Judgement(
        counterexample(
            "0 < mu_- < 1 on the major axis, so a curve of other points converges to it", is_saddle, at={lam: S.Half}
        ),
        "every trajectory off the stable manifold (a curve) of the major axis is attracted by the minor axis",
        by(LIMIT, *lyapunov(), is_saddle),
        "The unstable orbit is a saddle; the points of its stable manifold, not only its own, converge to it.",
    )


@judges("ellipse.curvature")
def curvature_formula(claim: Claim) -> Judgement:
    """Judges the printed curvature, by the parametrisation."""
    return identity(claim, curvature(ellipse.components[0]))


@judges("ellipse.curvature_major")
def curvature_major(claim: Claim) -> Judgement:
    """Judges the printed curvature at an end of the major axis."""
    return identity(claim, major_axis().frames[0].curvature)


@judges("ellipse.curvature_minor")
def curvature_minor(claim: Claim) -> Judgement:
    """Judges the printed curvature at an end of the minor axis."""
    return identity(claim, minor_axis().frames[0].curvature)


@judges("ellipse.major_axis_eigenvalues")
def major_eigenvalues(claim: Claim) -> Judgement:
    """Judges the printed bounds of the eigenvalues: the characteristic polynomial is > 0 at 0 and < 0 at 1."""
    trace, det = major()
    return on_range(
        claim,
        lambda box: saddle(trace, det, box),
        "0 < mu_- < 1 < mu_+ for a > 1 and 0 < lam < 1; mu_- = 0 at lam = 0",
        {lam: Interval.open(0, 1)},
        "At lambda = 0 the smaller eigenvalue is 0: the strict inequality needs 0 < lambda.",
    )


@judges("ellipse.major_axis_unstable")
def major_unstable(claim: Claim) -> Judgement:
    """One multiplier of the major axis exceeds 1, since the characteristic polynomial is negative at 1."""
    trace, det = major()
    return on_range(claim, lambda box: positive(trace - 1 - det, box), "mu_+ > 1")


@judges("ellipse.evolute")
def ellipse_evolute(claim: Claim) -> Judgement:
    """The ellipse's evolute is the astroid `x = (a**2-1)/a*cos**3`, `y = -(a**2-1)*sin**3`."""
    centre = centre_of_curvature(ellipse.components[0])
    astroid = Matrix([(a**2 - 1) / a * cos(theta) ** 3, -(a**2 - 1) * sin(theta) ** 3])
    return Judgement(
        by("the centre of curvature is an astroid stretched by 1/a and 1", equal(centre, astroid, {})),
        str(list(astroid)),
    )


def axis_slope(P: Expr, shape: Expr) -> Expr:
    """The slope `(T0^2)'` on a double normal of the ellipse `a = shape`, which is its stability number `P(a)`."""
    return P.subs(a, shape)


@judges("ellipse.slap_unstable_points")
def slap_unstable(claim: Claim) -> Judgement:
    """The ends of the major axis are unstable under the slap map `T0`: the stability number `(T0^2)'` is above 1."""
    slope = axis_slope(stability_number(major_axis()), Rational(6, 5))
    return Judgement(
        by(f"(T0^2)' = {slope} at both ends of the major axis", positive(slope - 1, {})), f"(T0^2)' = {slope}"
    )


@judges("ellipse.slap_stable_orbits")
def slap_stable(claim: Claim) -> Judgement:
    """The two stable points of the slap map belong to one orbit, along the minor axis."""
    slope = axis_slope(stability_number(minor_axis()), Rational(6, 5))
    stable = positive(1 - slope**2, {})
    return Judgement(
        counterexample(
            "T0 exchanges the two ends of the minor axis: two points of one orbit",
            answer(is_double_normal(minor_axis()), "the minor axis is normal at both ends"),
        ),
        f"one stable period-2 orbit on the minor axis, through two points; (T0^2)' = {slope}",
        by(f"(T0^2)' = {slope}", stable),
        "There are two stable period-2 points but one orbit, which runs along the minor axis.",
    )


@judges("ellipse.slap_not_expanding")
def slap_not_expanding(claim: Claim) -> Judgement:
    """The slap map `T0` is not expanding: the stability number `(T0^2)'` is at most 1 on the minor axis."""
    P = stability_number(minor_axis())
    return Judgement(by("(T0^2)' = ((a^2-2)/a^2)^2 <= 1 on the minor axis", nonnegative(1 - P, claim.box | {})), str(P))


BEYOND = {a: Interval.open(1, oo)}


def minor() -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy matrix on the minor axis."""
    return trace_and_determinant(minor_axis())


def major() -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy matrix on the major axis."""
    return trace_and_determinant(major_axis())
