"""Judges of claims on which attractors exist. Paper: sections 1, 2, 5, 6, 7.

A certified attracting cycle refutes "only" and "all", and proves "is found". Only samples show that nothing else
attracts: if each of `n` random starts reaches a known attractor, fewer than a fraction `3/n` of all starts reach
another one, with 95 per cent confidence.
"""

from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from flint import acb, arb
from sympy import Expr, Rational, Symbol, lambdify, limit, oo, pi

from numeric import PinballMap
from numeric.dynamics.attractors import Attractor, Kind, find
from numeric.dynamics.exponents import jump, slopes
from symbolic import tables
from symbolic.cycles.cycle import cuspless_horizontal, is_double_normal
from symbolic.cycles.defocusing import expands
from symbolic.cycles.polygons import near_flat
from symbolic.cycles.splitting import splits
from symbolic.expressions.signs import Outcome, SignFinding
from symbolic.motion.flight import flight
from symbolic.tables.scene import Scene
from symbolic.tables.table import alpha as letter
from symbolic.tables.table import lam, phi
from verification.arithmetic.balls import fraction_ball, working
from verification.named.attractors import certificate
from verification.named.curves import invariant_circle
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, equal, greater, judges, sampled, shown
from verification.paper.judges.ellipse import settles, two_cycles
from verification.proofs.global_dynamics.fates import AlmostEveryOrbit
from verification.proofs.global_dynamics.returns import every_return
from verification.proofs.manifolds.enclosed import attracting, complex_balls
from verification.proofs.manifolds.known import TRIANGLE, boundary, table, touching
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.starts.below_star import HORIZONTAL

SEED, STARTS, FEW, BITS, STEPS = 1, 200, 40, 160, 200
SHAPE = "0.08"
SEEN = ("0.43", "0.66", "0.7", "0.99")
JOIN = 3**0.5 / 4


@cache
def found(name: str, contraction: str, starts: int = STARTS, **shape: Any) -> tuple[Attractor, ...]:
    """The attractors that random starts reach, and their images under the symmetries of the table."""
    return find(PinballMap(name, lam=contraction, **shape), starts, SEED, bounces=1000, images=True)


def egg(contraction: str, starts: int = STARTS, alpha: str = SHAPE) -> tuple[Attractor, ...]:
    """The attractors of the egg that random starts reach."""
    return found("egg", contraction, starts, alpha=alpha)


def unsettled(attractors: Iterable[Attractor], starts: int = STARTS) -> int:
    """The number of starts that reached none of the attractors."""
    return starts - sum(a.share.count for a in attractors if a.share)


def chaotic(attractors: Iterable[Attractor]) -> list[Attractor]:
    """The chaotic attractors among the given ones."""
    return [a for a in attractors if a.kind is Kind.CHAOTIC]


def cycles(attractors: Iterable[Attractor], period: int = 0) -> list[Attractor]:
    """The cycles among the given attractors, only those of the given period unless it is 0."""
    return [a for a in attractors if a.kind is Kind.CYCLE and period in (0, a.period)]


@cache
def proved_at(contraction: str, period: int, starts: int = STARTS) -> SignFinding:
    """The finding that all sampled cycles of a period of the egg, and their images, are proved to attract."""
    table, some = tables.egg(3).at(alpha=SHAPE), cycles(egg(contraction, starts), period)
    proofs = [certificate(table, Rational(contraction), a.points) for a in some]
    good = bool(proofs) and all(proof.proved for proof in proofs)
    said = f"{len(some)} attracting cycles of period {period} are proved at lam = {contraction}"
    return SignFinding(Outcome.PROVED if good else Outcome.UNKNOWN, said)


@cache
def strange(alpha: str, kind: str = "boundary") -> tuple[SignFinding, arb]:
    """The finding that the egg has strange attractors near a tangency, and the contraction of the tangency.

    Tangencies are known at the shape `SHAPE`; but `bands` at 1/10 instead, and `boundary` at more shapes too.
    """
    found = boundary(Rational(alpha)) if kind == "boundary" else touching(kind)
    held = found.proved and found.strange.proved
    said = (
        f"in every neighbourhood of lam = {found.value.str(9, radius=False)}, at alpha = {alpha}, strange attractors "
        f"exist for a set of contractions of positive measure: manifolds of the dissipative "
        f"{found.contact.unstable.name} touch there, quadratically, and the theorem of Mora and Viana applies"
    )
    return answer(held or None, said), found.value


@judges("map.two_attractor_types")
def two_types(claim: Claim) -> Judgement:
    """The claim is refuted in the egg: a strange attractor near a tangency has no dominated splitting.

    The attractor lies in a disc where areas shrink. It is the closure of an unstable manifold and has a dense orbit;
    `docs/global.md` proves that such a set has no dominated splitting. In the other tables the claim is true.
    """
    chaos, where = strange(SHAPE)
    tangency = f"lambda = {where.str(6, radius=False)}"
    return Judgement(
        counterexample(
            f"the egg has, for some contractions as near to {tangency}... as one likes, attractors that are neither "
            "cycles nor have dominated splitting",
            chaos,
            at={letter: Rational(SHAPE), lam: Rational(where.str(9, radius=False))},
        ),
        "in the circle and the ellipses every orbit tends to a cycle, for 0 < lam < 1; in both cardioids every "
        "invariant set of orbits off the cusp and the joins has dominated splitting, for 0 <= lam < 1; the egg has "
        "strange attractors, for a set of contractions of positive measure next to the tangency of a saddle's "
        "manifolds, and these have none: each is the closure of an unstable manifold that folds in a disc in which "
        "areas shrink",
        by("the circle, the ellipses, both cardioids", settles(), two_cycles(), splits()),
        "There is a third type: in every neighbourhood of a homoclinic tangency, as at "
        f"alpha = {SHAPE}, {tangency}, the egg has strange attractors without dominated splitting, for a set of lambda "
        "of positive measure. Of the chaotic attractors that are seen in the egg this decides nothing.",
    )


@cache
def rotating() -> tuple[SignFinding, dict[Symbol, Expr]]:
    """The finding that closed curves of the egg with irrational rotation attract, and the parameters of their birth."""
    found = invariant_circle()
    shape, contraction = (x.str(15, radius=False) for x in found.enclosure.zero[-2:])
    holds = found.certified and found.attracting and found.side > 0 and found.problem.irrational
    finding = by(
        f"the egg at alpha = {shape}..., for some contractions above lam = {contraction}..., as near to it as one "
        "likes: an attracting curve, diffeomorphic to a circle, surrounds each point of a cycle of period 17, and the "
        "17th iterate of the map on it is conjugate to an irrational rotation",
        answer(
            holds or None,
            "a torus bifurcation: a cycle of period 17 with the multipliers exp(+-i*omega), 2*cos(omega) = 1/2, so "
            "that omega/(2*pi) is irrational; their size grows with lam at the rate "
            f"{found.growth.str(6, radius=False)}, the Lyapunov coefficient is {found.lyapunov.str(6, radius=False)}",
        ),
    )
    return finding, {letter: Rational(shape), lam: Rational(contraction)}


@judges("map.no_irrational_rotation")
def no_rotation(claim: Claim) -> Judgement:
    """In samples no start reaches an invariant circle; where such circles exist, and where not, is proved."""
    circles, _ = rotating()
    excluded = by(
        "the circle, the ellipses, both cardioids", settles(), two_cycles(), expands(), splits(), every_return()
    )
    return sampled(
        "not in what random starts reach. In the egg there are some, which attract, proved; none for lam < 1 in "
        "the circle and the ellipses (lam > 0), where "
        "every orbit tends to a cycle; none that attracts in the cardioid, and in the cuspless one for lam >= 1/10, "
        "where every orbit off the cusp and the joins stretches exponentially, as none does along or near a smooth "
        "curve with such a rotation; at lam = 1 the lines of the circle are such curves (theta -> theta + pi - 2*phi)",
        f"sampled: of {STARTS} random starts in the egg at lam = {', '.join(SEEN)} each ends on a cycle or on a "
        "chaotic "
        f"set. Answered, proved: {circles.reason}; none elsewhere: {excluded.reason}",
        bool(circles) and bool(excluded) and all(a.kind in (Kind.CYCLE, Kind.CHAOTIC) for x in SEEN for a in egg(x)),
    )


@judges("map.whispering_gallery")
def whispering_gallery(claim: Claim) -> Judgement:
    """A counterexample: in the circle the angle grows by `lam > 1` at each bounce until it exceeds pi/2 and stops."""
    more, n = Symbol("more", positive=True), Symbol("n", positive=True)
    exit = flight()[1]
    rule = equal(exit, lam * phi, {})
    away = greater(Rational(3, 2) * Rational(3, 2), pi / 2)
    return Judgement(
        counterexample(
            "circle, lam = 3/2, phi = 3/2: the first exit angle, 9/4, leaves the table",
            rule,
            away,
            at={lam: Rational(3, 2)},
        ),
        "in the circle |phi| grows by the factor lam until the rule gives an exit angle above pi/2, which leaves the "
        "table: every orbit but the diameters ends after finitely many bounces",
        by(
            "in the circle, for every lam > 1 and phi != 0",
            rule,
            answer(limit((1 + more) ** n, n, oo) == oo, "lam^n*|phi| is unbounded for lam > 1"),
        ),
        "In the circle, for lambda > 1, no orbit converges to grazing: off the diameters the exit angle exceeds "
        "pi/2 after finitely many bounces, where the map is no longer defined. The last angle before lies above "
        "pi/(2*lambda), so near pi/2 only for lambda near 1. Nothing is shown of other tables.",
    )


NEAR_ZERO = Fraction(1, 20)


@cache
def near_zero() -> AlmostEveryOrbit:
    """The theorem on almost every orbit of the cuspless table for `lam <= NEAR_ZERO`."""
    return AlmostEveryOrbit(Scene("cuspless"), (Fraction(0), NEAR_ZERO), (2048, 128), 8, (HORIZONTAL,))


def settles_near_zero() -> SignFinding:
    """The finding that almost every orbit converges to the horizontal orbit for small `lam`."""
    return by(
        f"for 0 < lam <= {NEAR_ZERO} almost every orbit converges to the horizontal one of period 2",
        answer(
            near_zero().proved,
            "every orbit ends in boxes about it, where the map contracts, or about the vertical one, where it "
            "stretches, so that those which stay have no area",
        ),
        shown("the horizontal orbit is normal to the boundary at both ends", is_double_normal(cuspless_horizontal())),
    )


@judges("cuspless.period2_attracts")
def period2_attracts(claim: Claim) -> Judgement:
    """For small contractions almost every start converges to period 2; the exceptions have measure zero."""
    return Judgement(
        settles_near_zero(),
        f"proved for 0 < lam <= {NEAR_ZERO}: all but a set of starts of no area, which holds the stable manifold of "
        "the vertical orbit and what lands on a join",
    )


@judges("cuspless.compact_near_zero")
def compact_near_zero(claim: Claim) -> Judgement:
    """The recurrent boxes lie in four rectangles, away from the joins and from grazing flights."""
    parts, bounds = near_zero().parts, [1.1, 0.1]  # joins: at 2*pi/3 on the arc, at 0.433 on the wall
    ends = [np.maximum(-p.boxes.x[0], p.boxes.x[1]) < np.array(bounds)[p.boxes.chart] for p in parts or ()]
    inside = all(map(np.all, ends)) if ends else None
    return Judgement(
        by(
            f"for 0 <= lam <= {NEAR_ZERO}",
            answer(inside, "boxes with |theta| <= 1.1 on the arc and |y| <= 0.1 on the wall hold all limit sets"),
            settles_near_zero(),
        ),
        f"for 0 <= lam <= {NEAR_ZERO} the limit set of every orbit lies in four rectangles, away from the joins and "
        "from grazing; for lam > 0 the two points of the horizontal orbit attract almost every start",
    )


@judges("cuspless.attractors_nonsmooth")
def nonsmooth(claim: Claim) -> Judgement:
    """The attractor's slope jumps at the joins, by `lam` times the jump of the curvature, but not at `s = 0`."""
    said = []
    for contraction in ("0.5", "0.8"):
        map = PinballMap("cuspless", lam=contraction)
        jumps = [jump(*slopes(map, STARTS // 2, SEED), place) for place in (-JOIN, 0.0, JOIN)]
        said.append(f"at lam = {contraction}: {', '.join(f'{x:+.3f}' for x in jumps)}")
    return Judgement(
        SignFinding(
            Outcome.UNKNOWN,
            "the slope dphi/ds of the attractor jumps by lam times the jump of the curvature (from the derivative "
            "matrix), that is by 3*lam/2 at the joins and by 0 at s = 0; measured at -sqrt(3)/4, 0, sqrt(3)/4: "
            f"{'; '.join(said)}. So it has corners at the joins, and none is seen at s = 0",
        ),
        "a curve of the attractor that crosses s = +-sqrt(3)/4 has a corner there, where the slope dphi/ds jumps by "
        "3*lam/2; at s = 0 none is seen. That there are such curves for every lam, and that the attractor expands, is "
        "not proved",
    )


@judges("egg.higher_period_attractors")
def higher_periods(claim: Claim) -> Judgement:
    """Attractors of higher period exist: cycles of period 21 attract near `lam = 1`."""
    return Judgement(
        by("at alpha = 0.08", proved_at("0.99", 21)),
        "found at lam = 0.99: period 21; at 0.999 also periods 24, 30, 51; at 0.82 to 0.88 periods 12 and 24",
    )


TENTH, RANGE = "0.1", (Fraction(295, 1000), Fraction(472, 1000))  # a shape, and a range of lam where triangles attract
BETWEEN = ("0.4", "0.45")  # contractions of this range, where both are sampled


@cache
def triangles_attract(low: Fraction, high: Fraction) -> SignFinding:
    """The finding that a cycle of period 3 attracts at `alpha = 1/10` for every contraction in a range."""
    bounce, parts, tried = lambdify(lam, near_flat().subs(letter, Rational(TENTH)), "cmath"), [(low, high)], 0
    with working(BITS):
        map = table(Rational(TENTH)).over(complex_balls(BITS))
        while parts and tried < STEPS:
            (a, b), tried = parts.pop(), tried + 1
            middle = (a + b) / 2
            orbit = SaddleCycle("triangle", (complex(bounce(float(middle))).real,), TRIANGLE.closure)
            if not attracting(orbit, map, acb(fraction_ball(a).union(fraction_ball(b)))):
                parts += [(middle, b), (a, middle)]
    return answer(not parts, f"a triangle of period 3 attracts at every lam from {float(low)} to {float(high)}")


@cache
def both_near_tenth() -> tuple[SignFinding, list[arb]]:
    """The finding that strange attractors exist near two contractions at which the triangles of period 3 attract."""
    low, high = RANGE
    (first, one), (last, other) = strange(TENTH, "bands"), strange(TENTH)
    inside = fraction_ball(low) < one < other < fraction_ball(high)
    chaos = by("strange attractors next to two of them", first, last, answer(inside or None, "both within the range"))
    return by(f"at alpha = {TENTH} both, over a range", triangles_attract(low, high), chaos), [one, other]


@judges("egg.coexistence_near_tenth")
def near_tenth(claim: Claim) -> Judgement:
    """Triangles attract over a range of contractions, near both ends of which strange attractors exist.

    Both facts persist for all nearby shapes, since zeros are regular and inequalities are strict over a closed range.
    Sets of positive measure near two contractions do not fill a range; chaos in between is only sampled.
    """
    (proof, values), each = both_near_tenth(), {x: egg(x, FEW, TENTH) for x in BETWEEN}
    low, high = map(float, RANGE)
    here, lams = " and ".join(value.str(7, radius=False) for value in values), ", ".join(BETWEEN)
    return sampled(
        "for every alpha close enough to 1/10 there is a range of lam over all of which triangles of period 3 attract, "
        f"from {low} to {high} at alpha = 1/10, and near both of its ends, in every neighbourhood of {here} there, are "
        f"sets of lam of positive measure with strange attractors: proved; in between, sampled at {lams}",
        f"{proof.reason}. Sampled: at alpha = 1/10, lam = {lams}, some of {FEW} random starts stay on a chaotic set "
        "and others go to cycles of period 3",
        bool(proof) and all(chaotic(some) and cycles(some, 3) for some in each.values()),
    )


@judges("egg.figure_chaos")
def figure_chaos(claim: Claim) -> Judgement:
    """Samples for panels (c) and (d): three chaotic attractors at one vertex each; one that visits all vertices."""
    local, wide = chaotic(egg("0.43")), chaotic(egg("0.45"))
    good = [len(vertices(a)) for a in local] == [1, 1, 1] and [len(vertices(a)) for a in wide] == [3]
    rates = [f"{max((a.nu_plus for a in some), default=np.nan):.2f}" for some in (local, wide)]
    said = (
        f"{STARTS} random starts find three chaotic attractors at 0.43, each at one vertex, nu_+ = {rates[0]}, and "
        f"one at 0.45 that visits all three, nu_+ = {rates[1]}"
    )
    return sampled("three localised chaotic attractors at 0.43, a single delocalised one at 0.45", said, good)


def vertices(attractor: Attractor) -> set[int]:
    """The indices `k` of the vertices `2*pi*k/3` to which points of an attractor come within 0.3 radians.

    >>> from types import SimpleNamespace
    >>> sorted(vertices(SimpleNamespace(points=SimpleNamespace(theta=np.array([0.1, 3.1, -2.0])))))
    [0, 2]
    """
    turns = attractor.points.theta / (2 * np.pi / 3)
    nearest = np.round(turns)
    return {int(k) % 3 for k in nearest[np.abs(turns - nearest) < 0.3 / (2 * np.pi / 3)]}


@judges("egg.only_smooth_chaos")
def only_smooth(claim: Claim) -> Judgement:
    """In circle and ellipses only cycles of period 2 attract; the egg has strange attractors. Both are proved."""
    others = by(
        "for 0 < lam < 1 every orbit of an ellipse converges to one of two cycles, and every orbit of the circle to a "
        "diameter, since |phi| falls by the factor lam",
        two_cycles(),
        settles(),
    )
    return Judgement(
        by(
            "the circle and the ellipses have no chaotic attractor; the cardioid has a cusp and the cuspless one jumps "
            "of curvature; the egg has strange attractors",
            others,
            strange(SHAPE)[0],
        ),
        "no chaotic attractor in the circle nor in any ellipse, for 0 < lam < 1; strange attractors in the egg at "
        f"alpha = {SHAPE}, for a set of lam of positive measure",
    )
