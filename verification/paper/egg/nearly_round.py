"""Judges of claims on nearly round eggs: for `lam <= most < 1` every orbit converges to a diameter. Sections 6.5, 7.

This holds for `0 < alpha <= alpha0(most)`, where the bound `alpha0` is not computed.

*An invariant curve.* The circle's map `(theta + pi - 2*phi, lam*phi)` has the derivative `[[1, -2], [0, lam]]`. Let
`lam <= most < 1` and `K = (1 - most)/4`. The derivative maps slopes `abs(dphi/dtheta) <= K` to smaller ones and
multiplies `dtheta` by `1 - 2*K > 0` or more; so graphs over the circle with slopes up to `K` are mapped to such graphs.
The vertical distance `d` of a point from such a graph becomes at most `(lam + 2*K)*d`, which is less than `d`. These
are strict inequalities on a compact set, `0 <= lam <= most` and `abs(phi) <= most*pi/2`, on which the egg's map and its
derivative depend continuously on `alpha`, as the boundary is analytic, convex, and met at an angle. So they hold for `0
<= alpha <= alpha0(most)`, and there the egg has an invariant graph, to which every orbit converges, and on which the
map is a homeomorphism of degree 1.

*The dynamics on it.* For `lam < 1` an orbit of period 2 is a double normal of the boundary, since the angles at both
ends of its chord are `lam` times themselves, hence 0. Double normals are the critical points of the width, which is `2
+ 9*alpha^2*sin(3*psi)^2` up to `alpha^4`: for small `alpha > 0` there are twelve directions, six chords, none
degenerate. Their twelve end points are all fixed points of the square of the circle homeomorphism. Between neighbours
all points move the same way, towards a minimum of the width, and every orbit converges to a double normal.

*Basins.* With `P = (L/R - 1)*(L/R' - 1) = 1 + L*(L - R - R')/(R*R')` the width's second derivative is `R + R' - L`, the
trace is `(1 + lam)^2*P - 2*lam` and the determinant `lam^2`: three diameters attract (`P < 1`), three are saddles (`P >
1`). For `lam > 0` the map is a diffeomorphism onto its image, so the starts that converge to no attracting diameter
form the stable manifolds of three saddles: analytic curves that separate the three basins.
"""

from dataclasses import replace
from functools import cache

from sympy import Expr, Interval, Matrix, Symbol, cos, expand_trig, factorial, pi, simplify, sin

from symbolic.expressions.signs import SignFinding, positive
from symbolic.motion.flight import flight
from symbolic.tables import egg
from symbolic.tables.table import alpha, lam, phi, s, theta
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, judges, sampled, zero
from verification.paper.egg.barriers import AT, barrier
from verification.paper.egg.stability import periods_at
from verification.paper.judges.attractors import SHAPE
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.starts.basin_edge import BasinEdge

MOST, PSI, SHIFT = Symbol("most"), Symbol("psi", real=True), Symbol("shift", real=True)
SHAPES, LAMS = ("0.01", "0.02"), ("0.2", "0.4", "0.6", "0.8", "0.9")  # where periods are sampled


def invariant_curve(cone: Expr = (1 - MOST) / 4) -> SignFinding:
    """The finding that the circle's map satisfies the strict inequalities for every `most` in `[0, 1)`."""
    range, slope = {MOST: Interval.Ropen(0, 1)}, Symbol("slope")
    derivative = Matrix(flight()).jacobian([s, phi])
    carried = derivative * Matrix([1, slope])
    return by(
        "for small alpha and lam <= most there is an invariant graph, to which every orbit converges",
        zero("the circle's derivative is [[1, -2], [0, lam]]", *(derivative - Matrix([[1, -2], [0, lam]]))),
        zero("a slope m becomes lam*m/(1 - 2*m)", carried[0] - 1 + 2 * slope, carried[1] - lam * slope),
        positive(cone, range),
        positive(1 - 2 * cone, range),
        positive(cone * (1 - 2 * cone) - MOST * cone, range),
        positive(1 - MOST - 2 * cone, range),
    )


def double_normals(sixth: Expr = 9 * alpha**2) -> SignFinding:
    """The finding on the egg's double normals, from its width in the direction `psi` to second order in `alpha`.

    The width is even in `alpha`. The farthest boundary point in that direction is at the angle `psi + shift`; an error
    of `alpha^2` in `shift` changes the width by `alpha^4`, since the width is stationary in `shift`.
    """
    x, y = egg(3).components[0].point
    radius = simplify(x * cos(theta) + y * sin(theta))
    reach = radius.subs(theta, PSI + SHIFT) * cos(SHIFT)
    farthest = -3 * alpha * sin(3 * PSI)
    support = _terms(reach.subs(SHIFT, farthest), 2)
    width = support + support.subs(PSI, PSI + pi)
    L, R, other = (Symbol(name, positive=True) for name in ("L", "R", "R1"))
    return by(
        "for small alpha > 0 there are six double normals, in turn minima and maxima of the width, none degenerate",
        zero("the farthest point", simplify(_terms(reach.diff(SHIFT).subs(SHIFT, farthest), 1))),
        zero("the width", simplify(expand_trig(width - 2 - sixth * sin(3 * PSI) ** 2))),
        zero("even in alpha", expand_trig(radius.subs(alpha, -alpha) - radius.subs(theta, theta + pi))),
        zero("P", (L / R - 1) * (L / other - 1) - 1 - L * (L - R - other) / (R * other)),
    )


def _terms(expression: Expr, order: int) -> Expr:
    """The Taylor polynomial in `alpha` of the expression, to the given order."""
    return sum(expression.diff(alpha, k).subs(alpha, 0) * alpha**k / factorial(k) for k in range(order + 1))


@cache
def settles() -> SignFinding:
    """The finding that every orbit of a nearly round egg converges to a double normal."""
    return by(
        "for every most < 1 there is an alpha0 > 0 such that for 0 < alpha <= alpha0 and 0 <= lam <= most every orbit "
        "converges to one of six orbits of period 2",
        invariant_curve(),
        double_normals(),
    )


@judges("egg.periodic_only_near_zero")
def periodic_only(claim: Claim) -> Judgement:
    """Orbits converge to cycles for `lam` up to a bound below 1 and small `alpha`; one `alpha` for all is open."""
    found = {(a, x): periods_at(a, x, 60) for a in SHAPES for x in LAMS}
    seen = sorted({period for periods in found.values() for period in periods})
    return sampled(
        "proved for lam up to any bound below 1 and all small alpha > 0: every orbit converges to a diameter, of which "
        "three attract. How small depends on the bound: at alpha = 0.05 there are strange attractors next to "
        "lam = 0.9165, and the tangency beside them is located down to alpha = 0.03, at 0.9905; so for one bound on "
        "alpha and every lam < 1 it is open, and false if the bound is 0.05 or more",
        f"proved: {settles().reason}; sampled: 60 particles each at alpha = {', '.join(SHAPES)} and lam = "
        f"{', '.join(LAMS)} end on cycles, of period {', '.join(str(p or '> 256') for p in seen)}",
        bool(settles()) and 0 not in seen,
    )


@cache
def edge() -> BasinEdge:
    """The theorem on the boundary of the upper triangle's basin, at the contraction of the paper's figure."""
    saddle = replace(TRIANGLE, start=(-0.166903,))
    return BasinEdge(barrier(), (-0.90420792, 0.41635565), saddle, 0.012)


@judges("map.smooth_basin_boundaries")
def smooth_boundaries(claim: Claim) -> Judgement:
    """The basins have smooth boundaries near the contraction of the paper's figure, and in nearly round eggs."""
    return Judgement(
        by(
            "stable manifolds of saddles bound the basins: in the figure of the crisis and in nearly round eggs",
            answer(
                edge().proved and edge().barrier.mirrored,
                f"at alpha = {SHAPE}, lam = {AT} a start that neither comes below a barrier nor converges to the "
                "upper attracting triangle is on the stable manifold of the triangle of the vertices, closed and an "
                "embedded analytic curve; likewise below, in the mirror image",
            ),
            settles(),
        ),
        f"in the figure of the crisis, alpha = {SHAPE} and lam = {AT}, each attracting triangle's basin is bounded by "
        "stable manifolds of a triangle of saddles, embedded analytic curves, and so it is at all parameters near "
        "these; in nearly round eggs, for 0 < lam <= most < 1 and 0 < alpha <= alpha0(most), three basins are divided "
        "by the stable manifolds of three saddles of period 2. Not everywhere: beyond the crisis boundaries of "
        "dimension near 2 are measured",
    )
