"""Claims on the egg with elastic collisions: islands and chaos at `lam = 1`. Paper: sections 6.1 and 6.5."""

from functools import cache

import numpy as np
from flint import arb
from sympy import Interval, Rational, S, cancel

from numeric import PinballMap
from numeric.dynamics.phase_points import phase_points
from numeric.pinball.sampling import phase_starts
from numeric.sweeps.sweep import measured
from symbolic.cycles.normal_forms import egg_diameter
from symbolic.expressions.signs import Finding, Outcome, positive
from symbolic.motion.chords import convexity
from symbolic.motion.flight import flight
from symbolic.tables import egg
from symbolic.tables.table import alpha, lam, phi
from verification.named.attractors import certificate
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import by, judges, zero
from verification.paper.shared.samples import sampled
from verification.proofs.periodic.bifurcation import Twist, twist

END = Rational(1, 10)
SMALL = Interval.Lopen(0, Rational(39, 1000))
TWISTED = 1 + 46 * alpha**2 + 625 * alpha**4 - 24 * alpha**6
ISOSCELES = (3.14159265, -1.441326, 1.441326)  # bounces of an elliptic period 3 of the egg with alpha = 1/10
BITS, SEED = 120, 1
TRIED = ("0.005", "0.01", "0.02", "0.05", "0.08", "0.1")


@judges("egg.period2_islands")
def period2_islands(claim: Claim) -> Judgement:
    """The twist of the diameter, exact in alpha."""
    _, trace, turn = egg_diameter()
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
    """The elliptic isosceles triangle of the egg with `alpha = 1/10`, enclosed, and its twist."""
    table = egg(3).at(alpha=END)
    proof = certificate(table, S.One, phase_points(0, list(ISOSCELES), 0.0), 20)
    needed = ("exists", "unique", "admissible", "minimal_period")
    return all(proof.checks[name] is True for name in needed), twist(table, (0, 0, 0), proof.theta, BITS)


@judges("egg.no_full_chaos")
def no_full_chaos(claim: Claim) -> Judgement:
    """Caustics near the boundary while the curvature is not 0, and an island where it is."""
    proved, turn = isosceles()
    island = Finding(
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
    """Random orbits in the measure that the map keeps. `alpha = 0` is the paper's own exception, one sentence later."""
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
    """Exponents near the saddle triangle through the vertices, where the first stochastic layer lies."""
    found = [(a, *layer(a)) for a in TRIED]
    said = ", ".join(f"{nu:.4f} +- {error:.0e} at alpha = {a}" for a, nu, error, _ in found)
    return sampled(
        "a stochastic layer around the saddle triangle at every alpha tried, thinner and slower as alpha -> 0",
        f"the largest exponent of 16 orbits of 200000 bounces next to the saddle triangle: {said}; no sampling reaches "
        "every alpha",
        all(chaotic for *_, chaotic in found),
    )


def layer(shape: str) -> tuple[float, float, bool]:
    """The largest exponent of orbits that start next to the triangle through the vertices, its error, and its sign."""
    map = PinballMap("egg", lam=1, alpha=shape)
    near = phase_points(0, 1e-4 * np.linspace(-1, 1, 16), np.pi / 6)
    x, y = map.states.point(near.component, near.theta)
    starts = phase_starts(map, 16, SEED)._replace(component=near.component, theta=near.theta, phi=near.phi, x=x, y=y)
    found = measured(map, starts, 200_000, 0)
    best = int(np.argmax(found.nu_plus))
    return float(found.nu_plus[best]), float(found.nu_plus_error[best]), bool(found.chaotic[best])


def chaotic_shares(shapes: tuple[str, ...]) -> list[tuple[str, float]]:
    """The share of random orbits whose exponent is surely positive, in the measure that the map keeps."""
    shares = []
    for shape in shapes:
        map = PinballMap("egg", lam=1, alpha=shape)
        shares.append((shape, float(np.mean(measured(map, phase_starts(map, 300, SEED), 8000, 0).chaotic))))
    return shares


def _short(x: arb) -> str:
    return str(x.str(6, radius=False))
