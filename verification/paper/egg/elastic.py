"""Judges of claims on the egg with elastic collisions: cycles, islands and chaos. Paper: sections 6.1 and 6.5."""

from functools import cache

import numpy as np
from flint import arb
from sympy import Expr, Interval, Rational, S, Symbol, cancel, cos, divisors, pi, simplify

from numeric import PinballMap
from numeric.dynamics.phase_points import phase_points
from numeric.pinball.sampling import phase_starts
from numeric.sweeps.sweep import measured
from symbolic.cycles.cycle import c, egg_diameter, egg_parallel, parallel_shape
from symbolic.cycles.normal_forms import egg_diameter as diameter_twist
from symbolic.cycles.polygons import elastic_trace
from symbolic.cycles.resonance import flat_triangle
from symbolic.cycles.thresholds import stability_number
from symbolic.expressions.signs import Outcome, SignFinding, positive
from symbolic.motion.chords import convexity
from symbolic.motion.flight import flight
from symbolic.tables import egg
from symbolic.tables.table import alpha, lam, phi
from verification.named.attractors import certificate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, greater, judges, sampled, shown, zero
from verification.paper.egg.period2 import ROUND, at
from verification.proofs.periodic.bifurcation import Twist, twist

END = Rational(1, 10)
SMALL = Interval.Lopen(0, Rational(39, 1000))
TWISTED = 1 + 46 * alpha**2 + 625 * alpha**4 - 24 * alpha**6
ISOSCELES = (3.14159265, -1.441326, 1.441326)  # bounces of an elliptic period 3 of the egg with alpha = 1/10
BITS, SEED = 120, 1
TRIED = ("0.005", "0.01", "0.02", "0.05", "0.08", "0.1")


@judges("egg.period2_islands")
def period2_islands(claim: Claim) -> Judgement:
    """For small alpha, islands surround the diameter, since its twist coefficient, known exactly, is not 0."""
    _, trace, turn = diameter_twist()
    return Judgement(
        by(
            "for 0 < alpha <= 0.039 the diameter is elliptic, its multiplier is no root of unity of order 1, 2 or 4 "
            "(order 3 does no harm: the map near it is odd), and its twist, 23328*alpha^2*(1 + 46*alpha^2 + "
            "625*alpha^4 - 24*alpha^6)/(1 - alpha^2)^6 up to a positive factor, is not 0; so by Moser's twist theorem "
            "invariant curves surround it",
            zero("", cancel(turn - 23328 * alpha**2 * TWISTED / (1 - alpha**2) ** 6)),
            positive(cancel(trace), {alpha: SMALL}),
            positive(cancel(2 - trace), {alpha: SMALL}),
            positive(cancel(turn), {alpha: Interval.Lopen(0, END)}),
        ),
        "islands for every alpha in (0, 0.039], and up to alpha_tilde(1) = 0.0554 except perhaps where the trace is 0",
    )


@cache
def isosceles() -> tuple[bool, Twist]:
    """The elliptic isosceles triangle at `alpha = 1/10`: True if it is proved, and its twist coefficient."""
    table = egg(3).at(alpha=END)
    proof = certificate(table, S.One, phase_points(list(ISOSCELES), 0.0), 20)
    return proof.is_cycle, twist(table, (0, 0, 0), proof.theta, BITS)


@judges("egg.no_full_chaos")
def no_full_chaos(claim: Claim) -> Judgement:
    """Caustics exist near the boundary if its curvature is nowhere 0; an island exists at `alpha = 1/10`."""
    proved, turn = isosceles()
    island = SignFinding(
        Outcome.PROVED if proved and turn.islands else Outcome.UNKNOWN,
        f"at alpha = 1/10 a period-3 orbit has trace {_short(turn.trace)} and twist {_short(turn.twist)}",
    )
    bent = convexity(egg(3), {alpha: Interval.Ropen(0, END)}, strictly=True)
    return Judgement(
        by(
            "for 0 <= alpha < 1/10 the boundary is analytic and its curvature nowhere 0, so invariant curves fill a "
            "part of phase space, of positive measure, near |phi| = pi/2 [Lazutkin1973]; at alpha = 1/10 a triangle, "
            "isosceles and not equilateral, is elliptic with a twist that is not 0, and invariant curves surround it "
            "[Moser1962]",
            bent,
            island,
        ),
        "for no alpha in [0, 1/10] is the elastic map ergodic: caustics below 1/10, an island at 1/10",
    )


@judges("egg.elastic_mixed")
def elastic_mixed(claim: Claim) -> Judgement:
    """Measures the fraction of chaotic orbits in the invariant measure, for `alpha > 0` as in the paper."""
    found = chaotic_shares(("0.02", "0.05", "0.08"))
    circle = zero("", flight()[1].subs(lam, 1) - phi)
    said = f"of 300 random orbits each, {', '.join(f'{share:.0%} at alpha = {a}' for a, share in found)} are chaotic"
    return sampled(
        "mixed for alpha in (0, 1/10]: islands or caustics are proved (egg.no_full_chaos), a chaotic sea is sampled; "
        "at alpha = 0 every orbit keeps its phi, and there is neither",
        said,
        bool(circle) and all(0 < share < 1 for _, share in found),
    )


@judges("egg.elastic_chaos")
def elastic_chaos(claim: Claim) -> Judgement:
    """Orbits near the saddle triangle through the vertices have positive exponents, in a stochastic layer."""
    found = [(a, *layer(a)) for a in TRIED]
    said = ", ".join(f"{nu:.4f} +- {error:.0e} at alpha = {a}" for a, nu, error, _ in found)
    return sampled(
        "a stochastic layer around the saddle triangle at every alpha tried, thinner and slower as alpha -> 0",
        f"the largest exponent of 16 orbits of 200000 bounces next to the saddle triangle: {said}; no sampling reaches "
        "every alpha",
        all(chaotic for *_, chaotic in found),
    )


def layer(shape: str) -> tuple[float, float, bool]:
    """The largest exponent next to the triangle through the vertices, its error, and whether it is positive."""
    map = PinballMap("egg", lam=1, alpha=shape)
    near = phase_points(1e-4 * np.linspace(-1, 1, 16), np.pi / 6)
    x, y = map.states.point(near.component, near.theta)
    starts = phase_starts(map, 16, SEED)._replace(component=near.component, theta=near.theta, phi=near.phi, x=x, y=y)
    found = measured(map, starts, 200_000, 0)
    best = int(np.argmax(found.nu_plus))
    return float(found.nu_plus[best]), float(found.nu_plus_error[best]), bool(found.chaotic[best])


def chaotic_shares(shapes: tuple[str, ...]) -> list[tuple[str, float]]:
    """For each shape, the fraction of random orbits in the invariant measure whose exponent is clearly positive."""
    shares = []
    for shape in shapes:
        map = PinballMap("egg", lam=1, alpha=shape)
        shares.append((shape, float(np.mean(measured(map, phase_starts(map, 300, SEED), 8000, 0).chaotic))))
    return shares


def _short(x: arb) -> str:
    return str(x.str(6, radius=False))


PANELS = ("0.02", "0.05", "0.08")
ELLIPTIC = Rational(11, 200)  # below alpha-tilde(1) = 0.05538..., where the diameters become hyperbolic


def elliptic(shape: str) -> SignFinding:
    """The finding that the triangle at the flat points is elliptic: its trace lies strictly between -2 and 2."""
    single = flat_triangle()[0].subs(alpha, at(shape))
    return positive(4 - (single**3 - 3 * single) ** 2, {})


@judges("egg.alternating_points")
def alternating(claim: Claim) -> Judgement:
    """Elliptic and hyperbolic points alternate in phase space, which the polar angles of the cycles show."""
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
    """To first order in alpha, turning a cycle of the circle changes its length only for triangles."""
    delta, c0, c1, z, n = (Symbol(name, real=True) for name in ("delta", "c0", "c1", "z", "n"))
    square = (1 + alpha * c0) ** 2 + (1 + alpha * c1) ** 2 - 2 * (1 + alpha * c0) * (1 + alpha * c1) * cos(delta)
    slope = square.diff(alpha).subs(alpha, 0) - (c0 + c1) * square.subs(alpha, 0)
    total = (1 - z**n) / (1 - z)  # 1 + z + ... + z**(n - 1)
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
    """The residual of `total(n + 1) = total(n) + z**n`, the induction step for `1 + z + ... + z**(n-1)`."""
    return simplify(total.subs(n, n + 1) - total - z**n)


@judges("egg.period3_islands")
def period3_islands(claim: Claim) -> Judgement:
    """At the paper's shapes, islands surround the triangle, since the twist coefficient of one flight is not 0."""
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
    """Samples show that the fraction of random orbits with a positive exponent grows from panel to panel."""
    shares = chaotic_shares(PANELS)
    first, second, third = (share for _, share in shares)
    said = ", ".join(f"{share:.1%} at alpha = {shape}" for shape, share in shares)
    return sampled(
        "chaotic orbits are most of phase space at 0.05 and 0.08, and confined to layers at 0.02",
        f"of 300 random orbits of 8000 bounces these have an exponent above its error: {said} (+- 3% in each)",
        first < 0.25 and 0.5 < second < third < 0.98,
    )
