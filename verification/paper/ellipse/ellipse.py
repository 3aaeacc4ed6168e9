"""Claims on the ellipse: its orbits, limit set and slap map. Paper: sections 3.2 and 3.4.

The two axes of the ellipse, as the claims need them.
"""

from sympy import Expr, Interval, Matrix, Rational, S, cos, oo, pi, sin, symbols

from symbolic.cycles.cycle import is_double_normal, major_axis, minor_axis, saddle, trace_and_determinant
from symbolic.cycles.thresholds import stability_number, stable_while_nonnegative
from symbolic.expressions.signs import Box, Finding, nonnegative, positive
from symbolic.motion.collision import gradient, joachimsthal_defect
from symbolic.tables import ellipse
from symbolic.tables.geometry import curvature, evolute, velocity
from symbolic.tables.table import a, lam, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, equal, identity, judges, on_range, zero


@judges("ellipse.parametrisation")
def parametrisation(claim: Claim) -> Judgement:
    """The definition of the table."""
    return identity(claim, Matrix(ellipse.components[0].point))


@judges("ellipse.shape_range")
def shape_range(claim: Claim) -> Judgement:
    """Scale by the shorter half axis and exchange the axes if need be."""
    p, q = symbols("p q", positive=True)
    x, y = p * cos(theta) / q, q * sin(theta) / q
    scaled = Matrix(ellipse.components[0].point).subs(a, p / q)
    return Judgement(
        by("half axes p >= q, divided by q, give a = p/q >= 1", equal(Matrix([x, y]), scaled, {})), "a = p/q"
    )


@judges("ellipse.elastic_integrable")
def integrable(claim: Claim) -> Judgement:
    """Joachimsthal's product survives the flight, and the elastic reflection."""
    return Judgement(
        by("g(q)*cos(phi) is conserved at lam = 1", zero("", joachimsthal_defect())), "J = |(x/a^2, y)|*cos(phi)"
    )


@judges("ellipse.two_period2")
def two_period2(claim: Claim) -> Judgement:
    """There are two double normals."""
    return Judgement(axes_alone(claim.box), "the chords of the two axes, and no other")


def axes_alone(box: Box) -> Finding:
    """A chord with ends at `m + B`, `m - B` that is normal at both lies on an axis."""
    m, B = symbols("m B", real=True)
    x, y = ellipse.components[0].point
    chord = Matrix([x, y]).subs(theta, m + B) - Matrix([x, y]).subs(theta, m - B)
    tangents = [velocity(ellipse.components[0]).subs(theta, m + sign * B) for sign in (1, -1)]
    total = chord.dot(tangents[0]) + chord.dot(tangents[1])
    difference = chord.dot(tangents[0]) - chord.dot(tangents[1])
    diameter = 4 * sin(B) * cos(B) * (a**2 * sin(m) ** 2 + cos(m) ** 2)
    axes = 4 * sin(B) ** 2 * (a**2 - 1) * sin(m) * cos(m)
    gaps = [(total - s1 * diameter, difference - s2 * axes) for s1 in (1, -1) for s2 in (1, -1)]
    factored = next((found for gap in gaps if (found := zero("", *gap))), zero("", *gaps[0]))
    return by(
        "normal at both ends means sin(B)*cos(B)*(a^2 sin(m)^2 + cos(m)^2) = 0 and "
        "sin(B)^2*(a^2 - 1)*sin(m)*cos(m) = 0, so cos(B) = 0 and m is a multiple of pi/2",
        factored,
        positive(a**2 - 1, box),
    )


@judges("ellipse.minor_axis_stable")
def minor_axis_stable(claim: Claim) -> Judgement:
    """Jury's criterion over the whole range."""
    P = stability_number(minor_axis())
    return on_range(claim, lambda box: stable_while_nonnegative(P, box), "|mu| < 1")


@judges("ellipse.major_axis_invariant")
def major_axis_invariant(claim: Claim) -> Judgement:
    """The chord is normal at both ends."""
    return Judgement(
        answer(is_double_normal(major_axis()), "the major axis is normal to the boundary at both ends"),
        "phi = 0 forever",
    )


def lyapunov() -> list[Finding]:
    """`J = g*cos(phi)` never decreases, and is larger on the minor axis than on the major."""
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
    """A Lyapunov function, and the two double normals."""
    return Judgement(two_cycles(claim.box), "the stable minor and the unstable major axis, for every a > 1")


def two_cycles(box: Box | None = None) -> Finding:
    """Is every limit point of an orbit, for `a > 1` and `0 < lam < 1`, on the stable or the unstable axis?"""
    open_box = {**BEYOND, **(box or {lam: Interval.open(0, 1)})}
    return by(
        LIMIT,
        *lyapunov(),
        stable_while_nonnegative(stability_number(minor_axis()), open_box),
        saddle(*major(), open_box),
    )


@judges("ellipse.basin", "ellipse.major_axis_leaves")
def basin(claim: Claim) -> Judgement:
    """The unstable orbit is a saddle: it has a stable manifold."""
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
    """Derived from the parametrisation."""
    return identity(claim, curvature(ellipse.components[0]))


@judges("ellipse.curvature_major")
def curvature_major(claim: Claim) -> Judgement:
    """At the tip."""
    return identity(claim, major_axis().frames[0].curvature)


@judges("ellipse.curvature_minor")
def curvature_minor(claim: Claim) -> Judgement:
    """At the flank."""
    return identity(claim, minor_axis().frames[0].curvature)


@judges("ellipse.major_axis_eigenvalues")
def major_eigenvalues(claim: Claim) -> Judgement:
    """The characteristic polynomial is positive at 0 and negative at 1."""
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
    """The characteristic polynomial is negative at 1, so one multiplier exceeds 1."""
    trace, det = major()
    return on_range(claim, lambda box: positive(trace - 1 - det, box), "mu_+ > 1")


@judges("ellipse.evolute")
def ellipse_evolute(claim: Claim) -> Judgement:
    """`x = (a**2-1)/a*cos**3`, `y = -(a**2-1)*sin**3`."""
    centre = evolute(ellipse.components[0])
    astroid = Matrix([(a**2 - 1) / a * cos(theta) ** 3, -(a**2 - 1) * sin(theta) ** 3])
    return Judgement(
        by("the centre of curvature is an astroid stretched by 1/a and 1", equal(centre, astroid, {})),
        str(list(astroid)),
    )


def axis_slope(P: Expr, shape: Expr) -> Expr:
    """`(T0^2)'` on a double normal: the stability number."""
    return P.subs(a, shape)


@judges("ellipse.slap_unstable_points")
def slap_unstable(claim: Claim) -> Judgement:
    """`(T0^2)' = P` on a double normal."""
    slope = axis_slope(stability_number(major_axis()), Rational(6, 5))
    return Judgement(
        by(f"(T0^2)' = {slope} at both ends of the major axis", positive(slope - 1, {})), f"(T0^2)' = {slope}"
    )


@judges("ellipse.slap_stable_orbits")
def slap_stable(claim: Claim) -> Judgement:
    """Two points, one orbit."""
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
    """`(T0^2)' = P <= 1` at the flanks."""
    P = stability_number(minor_axis())
    return Judgement(by("(T0^2)' = ((a^2-2)/a^2)^2 <= 1 on the minor axis", nonnegative(1 - P, claim.box | {})), str(P))


BEYOND = {a: Interval.open(1, oo)}


def minor() -> tuple[Expr, Expr]:
    """Trace and determinant on the minor axis."""
    return trace_and_determinant(minor_axis())


def major() -> tuple[Expr, Expr]:
    """Trace and determinant on the major axis."""
    return trace_and_determinant(major_axis())
