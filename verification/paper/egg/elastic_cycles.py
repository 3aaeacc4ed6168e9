"""Claims on the cycles of the egg with elastic collisions: which are elliptic, and why period 3. Paper: section 6.1."""

from sympy import Expr, Interval, Rational, Symbol, cancel, cos, divisors, pi, simplify

from symbolic.cycles.cycle import c, egg_diameter, egg_parallel, parallel_shape
from symbolic.cycles.polygons import elastic_trace
from symbolic.cycles.resonance import flat_triangle
from symbolic.cycles.thresholds import stability_number
from symbolic.expressions.signs import Finding, positive
from symbolic.tables.table import alpha
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, greater, judges, shown, zero
from verification.paper.egg.egg import ROUND, at
from verification.paper.egg.elastic import chaotic_shares
from verification.paper.shared.samples import sampled

PANELS = ("0.02", "0.05", "0.08")
ELLIPTIC = Rational(11, 200)  # below alpha-tilde(1) = 0.05538..., where the diameters become hyperbolic


def elliptic(shape: str) -> Finding:
    """The triangle at the flat points: the trace over the period lies strictly between -2 and 2."""
    single = flat_triangle()[0].subs(alpha, at(shape))
    return positive(4 - (single**3 - 3 * single) ** 2, {})


@judges("egg.alternating_points")
def alternating(claim: Claim) -> Judgement:
    """Elliptic and hyperbolic points in turn, at angles read off from the cycles."""
    P, low = cancel(stability_number(egg_diameter())), {alpha: Interval.Lopen(0, ELLIPTIC)}
    between = {c: Interval.Ropen(Rational(-2, 9), 0)}
    return Judgement(
        by(
            "on the line sin(phi) = 1/2 the flat points (60, 180, 300 degrees) are elliptic at the three shapes "
            "printed and the vertices (0, 120, 240) hyperbolic; on phi = 0 the ends of the diameters (multiples of 60 "
            "degrees) are elliptic up to alpha = 0.055, 0 < P < 1, and the six points between them hyperbolic, P > 1: "
            "they are +-theta, turned by 120 degrees, with cos(theta) in (-2/9, 0), so theta in (90, 103) degrees",
            *(elliptic(shape) for shape in PANELS),
            positive(elastic_trace(False) - 2, {alpha: ROUND}),
            positive(P, low),
            positive(1 - P, low),
            positive(stability_number(egg_parallel()) - 1, between),
            positive(-parallel_shape().diff(c), between),
            positive(parallel_shape().subs(c, Rational(-2, 9)) - Rational(1, 10), {}),
            greater(Rational(-2, 9), cos(103 * pi / 180)),
        ),
        "period 3: elliptic at the flat points and hyperbolic at the vertices; period 2: 12 points in turn for "
        "0 < alpha < alpha-tilde(1) = 0.0554, all of them hyperbolic above it, as the caption says of (c)",
    )


@judges("egg.period3_bias")
def bias(claim: Claim) -> Judgement:
    """To first order in alpha the length of a polygon depends on its place for three bounces alone."""
    delta, c0, c1, z, n = (Symbol(name, real=True) for name in ("delta", "c0", "c1", "z", "n"))
    square = (1 + alpha * c0) ** 2 + (1 + alpha * c1) ** 2 - 2 * (1 + alpha * c0) * (1 + alpha * c1) * cos(delta)
    slope = square.diff(alpha).subs(alpha, 0) - (c0 + c1) * square.subs(alpha, 0)
    total = (1 - z**n) / (1 - z)  # of 1 + z + ... + z**(n - 1)
    trace, _, _ = flat_triangle()
    P = stability_number(egg_diameter())
    return Judgement(
        by(
            "for small alpha the length of a chord of the circle grows by half of its length times cos(3*theta) at "
            "either end; over a polygon p/q the sum of exp(3*i*theta_k) is that of the powers of z = exp(6*pi*i*p/q), "
            "with z^q = 1: 0 unless z = 1, so unless q divides 3*p, and q and p have no common factor: at first order "
            "in alpha the circles of period 3 break up into elliptic and hyperbolic points and no others",
            zero("", slope.expand()),
            zero("the sum of n powers of z != 1, by induction on n", total.subs(n, 0), powers(total, z, n)),
            shown("of the numbers above 1 only 3 divides 3", divisors(3)[1:] == [3]),
            greater((2 - trace).diff(alpha).subs(alpha, 0), Rational(0)),
            zero("", (1 - P).diff(alpha).subs(alpha, 0)),
        ),
        "the triangles leave trace 2 at first order in alpha, 2 - trace of one flight = 36*alpha/(1 - alpha), the "
        "diameters at second order, 1 - P = (18*alpha/(1 - alpha^2))^2",
    )


def powers(total: Expr, z: Symbol, n: Symbol) -> Expr:
    """How far a formula for `1 + z + ... + z**(n-1)` is off gaining `z**n` from `n` to `n + 1`."""
    return simplify(total.subs(n, n + 1) - total - z**n)


@judges("egg.period3_islands")
def period3_islands(claim: Claim) -> Judgement:
    """The twist of one flight of the triangle, exact in alpha."""
    trace, twist, drift = flat_triangle()
    told, findings = [], [zero("the map preserves area", drift)]
    for shape in PANELS:
        A, turn = (value.subs(alpha, at(shape)) for value in (trace, twist))
        findings += [positive(4 - A**2, {}), shown("no root of unity up to order 4", A not in (-1, 0))]
        findings.append(positive(turn, {}))
        told.append(f"{float(turn):.3f} at {shape}")
    return Judgement(
        by(
            "one flight of the triangle, turned back by 120 degrees, has an elliptic fixed point whose multiplier is "
            "no root of unity of order 1 to 4 and whose twist is not 0, so invariant curves surround it [Moser1962]",
            *findings,
        ),
        f"islands at all three shapes; twist (in units of its own) {', '.join(told)}. For every alpha in (0, 1/10) but "
        "two the triangle is stable: unstable at 1/13, and undecided at 0.07679860... where the twist is 0",
    )


@judges("egg.chaotic_sea_panels", "egg.transition_to_chaos")
def sea(claim: Claim) -> Judgement:
    """The share of random orbits with a positive exponent grows from panel to panel."""
    shares = chaotic_shares(PANELS)
    first, second, third = (share for _, share in shares)
    said = ", ".join(f"{share:.1%} at alpha = {shape}" for shape, share in shares)
    return sampled(
        "chaotic orbits are most of phase space at 0.05 and 0.08, and confined to layers at 0.02",
        f"of 300 random orbits of 8000 bounces these have an exponent above its error: {said} (+- 3% in each)",
        first < 0.25 and 0.5 < second < third < 0.98,
    )
