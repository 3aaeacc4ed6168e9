"""Theorems on slap maps: the Lyapunov exponent of the cardioid at `lam = 0`, critical points, and periodic points.

Notation and `Var(L f) <= shrinks*Var f + adds*||f||` are those of `slap_map.transfer`, for functions on `[0, pi/2]` of
bounded variation with limit 0 at `pi/2`; norms are in `L1`.

**There is one invariant density.** The means of `L^n f`, for any such density `f`, are bounded in variation, so by
Helly's theorem a subsequence converges, to a density `h = L h`; its limit at `pi/2` is 0, because the rate is 0 at the
cusp. Let `e` be a function with `e = L e + r`, with integral 0. Average over `N` cells: `P e = Q P e + PL(e - P e) + P
r`, and `||f - P f|| <= (c/2)*Var f` with cells of length `c = pi/(2*N)`. With `K` of `slap_map.transfer`,

    ||e|| <= (c/2)*(K + 1)*Var e + K*||r||,     Var e <= (adds*||e|| + Var r)/(1 - shrinks),

so that `Var e <= (adds*K*||r|| + Var r)/((1 - shrinks)*gap)` where

    gap = 1 - adds*(c/2)*(K + 1)/(1 - shrinks)  must be positive.

For the difference of two invariant densities `r = 0`, so they are equal. Then the means of `L^n f` converge to `h` for
these `f`, and, `L` being a contraction of `L1`, for every density: the absolutely continuous invariant measure is
unique, and an invariant set of starts has measure 0 or full measure for `h`. By Birkhoff's theorem time averages are
those of `h` for almost every start: `h` is the natural measure.

**On the whole boundary** a density is the sum of an even and an odd function of `theta`. The even part is treated
above. On odd functions the first summand of the operator is negated, since such a flight changes halves; the inequality
for variations and the argument are the same, with a `K` for all vectors, so a fixed function is 0. So the slap map
itself has one invariant density, which is even.

**The density is near `f`.** For any `f` with integral 1, here polynomials, `e = h - f` has `r = L f - f`, which
`verification.proofs.slap_map.candidate` bounds.

**The exponent.** `T0'(s)` and the slope `F'` in half angles differ by the factor `cos(theta/2)` at either end of a
flight, whose logarithm is integrable; so the exponent of almost every start is the integral of `log F'` times `h`. The
integral for `f` is enclosed, `abs(e) <= Var e`, and the integral of `log F' = -log(rate)` over all launches is that of
`-rate*log(rate) <= 1/e` over all landings, at most `3*pi/(4*e)`. The other exponent is minus infinity, since every
particle leaves along the normal.

Assumed: python-flint, float64 arithmetic and the machine are correct. Not proved: mixing, and anything for `lam > 0`.
Not in the paper.

**Critical points.** The egg's slap map `T0` has no critical point, three or six, for every shape (paper: section 6.2).
`T0' = 0` where the centre of curvature lies on the boundary. With `C = cos(3*theta)` let `k` be the distance of the
centre of curvature from the centre of the table, minus that of the boundary point in the same direction; `T0'` has the
sign of `-k`. It is proved in balls that cover `-1 <= C <= 1`, `0 <= alpha <= 1/10` that `k` is not 0, or falls as `C`
grows. So for each `alpha` there is one zero of `k` if `k > 0` at the flat points (`C = -1`), and none if `k < 0` there.
A zero with `-1 < C < 1` stands for six points, one at `C = -1` for the three flat points.

**Periodic points.** The slap map of the cuspless cardioid has no cycle of period 4. This is proved by bisection of the
boundary into intervals whose images are enclosed. An interval that does not meet its image holds no periodic point;
where `(T0**n)' - 1` keeps its sign it holds at most one, and adjacent intervals with the same sign are joined. The
number of intervals that remain is that of the known periodic points. Where the sign changes between adjacent intervals,
as it may at a kink of the map, each can hold one. Paper: section 5.4 (`the graph of the 4th iterate confirms that there
are no period-4 orbits`).
"""

from dataclasses import dataclass, replace

from flint import arb

from symbolic.cycles.polygons import COSINE, centre_beyond_boundary, centre_far_inside
from symbolic.expressions.text import kernel, load
from symbolic.tables.table import alpha
from verification.arithmetic.balls import Box, balls, between, bisected, working
from verification.arithmetic.iteration import Tick, silent
from verification.proofs.corner.corner import ARC, BITS, WALL
from verification.proofs.corner.return_map import CusplessMap, Departures
from verification.proofs.periodic.bifurcation import Checks
from verification.proofs.slap_map.candidate import Judge, PiecewisePolynomial, candidate, precision
from verification.proofs.slap_map.transfer import Inverted, Variation, inverted, variation
from verification.rigorous.exclusion import Search, bisect

CELLS = 2048
MIRRORED = 1024  # cells for odd functions
DIGITS = 14


@dataclass(frozen=True)
class ChaoticProof:
    """The proved exponent: `value` is a ball that contains the exponent if `certified`, and else means nothing.

    `distance` is a bound of the variation, and so of the maximum, of the density minus its approximation.
    """

    value: arb
    checks: Checks
    gap: float
    inverse: float | None
    distance: arb

    @property
    def certified(self) -> bool:
        """True if every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())


def slap_exponent(digits: int = DIGITS) -> ChaoticProof:
    """The exponent per bounce of the cardioid at `lam = 0`, from a density of about `digits` digits.

    >>> proof = slap_exponent(6)
    >>> proof.certified, bool(abs(proof.value - arb("0.36834079947576")) < 1e-4)
    (True, True)
    """
    proof = judged(candidate(digits), digits, inverted(CELLS))
    return replace(proof, checks=proof.checks | {"symmetric": symmetric(inverted(MIRRORED, sign=-1), variation())})


def symmetric(inverse: Inverted, known: Variation) -> bool | None:
    """True if every invariant density of the slap map on the whole boundary is proved to be even; else None."""
    if not known.proved or inverse.sign != -1 or inverse.bound is None:
        return None
    with working(64):
        return bool(gap(inverse, known) > 0) or None


def gap(inverse: Inverted, known: Variation) -> arb:
    """The number `gap` of the module docstring, which must be positive, in the ambient precision."""
    return 1 - known.adds * arb.pi() / (4 * inverse.cells) * (arb(inverse.bound or 0) + 1) / (1 - known.shrinks)


def judged(near: PiecewisePolynomial, digits: int, inverse: Inverted, known: Variation | None = None) -> ChaoticProof:
    """The exponent from any approximation of the density: a bad one makes it imprecise, but never wrong.

    The items of the checklist are: the inequality for variations holds; the averaged operator is inverted; the gap is
    positive, so that the natural measure exists and is unique; the approximation has a positive mass; at most two
    digits were lost.
    """
    known = known or variation()
    bits = precision(digits)
    with working(bits):
        near = near.grounded()
        judge = Judge(near, digits, bits)
        mass = near.integral()
        residual = judge.residual()
        loss = 1 - known.shrinks
        size = arb(inverse.bound or 0)
        room = gap(inverse, known)
        distance = (known.adds * size * residual.norm + residual.variation) / (loss * room * mass)
        error = distance * 3 * arb.pi() / (4 * arb(1).exp())
        value = judge.mean() / mass + error * arb(0, 1)
        checks: Checks = {
            "variation": known.proved or None,
            "inverse": (inverse.sign == 1 and inverse.bound is not None) or None,
            "gap": (inverse.bound is not None and bool(room > 0)) or None,
            "mass": bool(mass > 0) or None,
        }
        checks["precise"] = (all(checks.values()) and bool(value.rad() < arb(10) ** (2 - digits))) or None
        return ChaoticProof(value, checks, float(room.lower()), inverse.bound, arb(distance.abs_upper()))


SMALLEST = 2.0**-30  # above it halves are exact in floats
WHOLE: Box = ((0.0, 1.0), (0.0625, 0.0625))  # C and alpha; boxes of shapes above 1/10 are skipped


def one_zero(budget: int = 100_000, tick: Tick = silent) -> Search:
    """The proof that the centre of curvature crosses the boundary at most once between a flat point and a vertex.

    >>> one_zero().proved, one_zero(budget=10).proved
    (True, None)
    """
    beyond = centre_beyond_boundary()
    expressions = {"far": centre_far_inside(), "k": beyond, "slope": beyond.diff(COSINE)}
    with working(BITS):
        at = load(kernel("centre", [COSINE, alpha], expressions), balls(BITS))
        most = arb(1) / 10

        def crossed_once(box: Box) -> bool:
            (c, wide), (shape, high) = box
            if arb(shape - high) > most:
                return True
            far, k, slope = at(arb(c, wide), arb(shape, high))
            return bool(far > 0 or k > 0 or k < 0 or slope < 0)

        return bisect(WHOLE, crossed_once, budget, SMALLEST, tick, halves)


def halves(box: Box) -> list[Box]:
    """The two halves of a box, cut across its longer side, with `alpha` scaled by 10."""
    (_, wide), (_, high) = box
    return bisected(box, 0 if wide > 10 * high else 1)


@dataclass(frozen=True)
class PeriodicPoints:
    """Intervals that hold the solutions of `T0**n(x) = x`, at most one each, or None; `T0` is the slap map."""

    stretches: list[tuple[int, float, float]] | None
    boxes: int


def periodic_points(n: int, budget: int = 200_000, tick: Tick = silent) -> PeriodicPoints:
    """Intervals of the arc and the wall that hold the solutions of `T0**n(x) = x` on the cuspless cardioid.

    Each is `(component, low, high)`. Since `T0` is odd in `theta`, solutions are sought on the upper half only.

    >>> [(c, round(a, 2), round(b, 2)) for c, a, b in periodic_points(2).stretches or []]
    [(0, -1.07, -1.02), (0, -0.02, 0.02), (0, 1.02, 1.07), (1, -0.01, 0.01)]
    """
    with working(BITS):
        slap = CusplessMap()
        found: list[tuple[int, float, float, int]] = []
        ends = {component: _end(slap.ends[component]) for component in (ARC, WALL)}
        queue = [(part, 0.0 if slap.odd else -end, end) for part, end in ends.items()]
        whole, boxes = sum(high - low for _, low, high in queue), 0
        while queue:
            component, low, high = queue.pop()
            boxes += 1
            if boxes > budget or high - low < 2 * SMALLEST:
                return PeriodicPoints(None, boxes)
            box = between(low, high)
            images = slap.iterated([Departures(component, box, arb(1), arb(0))], n)
            apart = images is not None and not any(p.component == component and p.theta.overlaps(box) for p in images)
            sign = _sign(images[0].slope - 1) if images is not None and len(images) == 1 and high - low < 2e-2 else 0
            if sign and not apart:
                found.append((component, low, high, sign))
            if apart or sign:
                tick((high - low) / whole)
                continue
            middle = (low + high) / 2  # rounded alike for both halves, so that no gap is left
            queue += [(component, low, middle), (component, middle, high)]
        found += [(part, -high, -low, sign) for part, low, high, sign in found if slap.odd]
        return PeriodicPoints(_joined(sorted(found)), boxes)


def _end(end: arb) -> float:
    return float(end.upper()) * (1 + 2.0**-40)


def _sign(x: arb) -> int:
    """The sign 1 or -1 if it is proved, else 0."""
    return 0 if not x.is_finite() else 1 if x > 0 else -1 if x < 0 else 0


def _joined(stretches: list[tuple[int, float, float, int]]) -> list[tuple[int, float, float]]:
    """The intervals, with adjacent ones joined where the slope of `T0**n` minus 1 has the same sign on both."""
    made: list[tuple[int, float, float, int]] = []
    for component, low, high, sign in stretches:
        if made and (made[-1][0], made[-1][3]) == (component, sign) and low <= made[-1][2]:
            made[-1] = component, made[-1][1], max(high, made[-1][2]), sign
        else:
            made.append((component, low, high, sign))
    return [(component, low, high) for component, low, high, _ in made]
