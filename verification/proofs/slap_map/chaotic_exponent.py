"""The Lyapunov exponent of a chaotic attractor, proved: the cardioid at `lam = 0`, where the map is its slap map.

Notation and `Var(L f) <= shrinks*Var f + adds*||f||` are those of `slap_map.transfer`, for functions on
`[0, pi/2]` of bounded variation that end in 0; norms are in `L1`.

**There is one invariant density.** The means of `L^n f`, for any such density `f`, are bounded in variation, so by
Helly's theorem some of them converge, to a density `h = L h`; it ends in 0, because the rate is 0 at the cusp. Let
`e` be another fixed point up to `r`: `e = L e + r`, with integral 0. Average over `N` cells: `P e = Q P e + PL(e - P e)
+ P r`, and `||f - P f|| <= (c/2)*Var f` with cells of length `c = pi/(2*N)`. With `K` of `slap_map.transfer`,

    ||e|| <= (c/2)*(K + 1)*Var e + K*||r||,     Var e <= (adds*||e|| + Var r)/(1 - shrinks),

so that `Var e <= (adds*K*||r|| + Var r)/((1 - shrinks)*gap)` where

    gap = 1 - adds*(c/2)*(K + 1)/(1 - shrinks)  must be positive.

For the difference of two invariant densities `r = 0`, and they are the same. Then the means of `L^n f` converge to
`h` for these `f`, and, `L` being a contraction of `L1`, for every density: the invariant measure that is absolutely
continuous is unique, and a set of starts that is invariant has measure 0 or carries `h`. With Birkhoff's theorem,
time averages are those of `h` for almost every start: `h` is the natural measure.

**On the whole boundary** a density is half a mirror-symmetric one, which is the above, and half one that the mirror
image negates. The operator acts on these with its first summand negated, since such a flight changes halves; the
inequality for variations is the same, and so is the argument, with a `K` for all vectors: a fixed one is 0. So the
slap map itself has one invariant density, and it is its own mirror image.

**The density is near `f`.** For any `f` with integral 1, here polynomials, `e = h - f` has `r = L f - f`, which
`verification.proofs.slap_map.candidate` bounds.

**The exponent.** `T0'(s)` and the slope `F'` in half angles differ by the factor `cos(theta/2)` at either end of a
flight, whose logarithm is integrable; so the exponent of almost every start is the integral of `log F'` times `h`.
That of `f` is enclosed, `abs(e) <= Var e`, and the integral of `log F' = -log(rate)` over all launches is that of
`-rate*log(rate) <= 1/e` over all landings, at most `3*pi/(4*e)`. The other exponent is minus infinity: every particle
leaves along the normal.

Assumed: that python-flint's balls, doubles and the machine do what they say. Not proved: that the measure mixes,
and anything for `lam > 0`. Not in the paper.
"""

from dataclasses import dataclass, replace

from flint import arb

from verification.arithmetic.balls import bits_of, working
from verification.proofs.periodic.bifurcation import Checks
from verification.proofs.slap_map.candidate import Judge, Pieces, candidate
from verification.proofs.slap_map.transfer import Inverted, Variation, inverted, variation

CELLS = 2048
MIRRORED = 1024  # cells for densities that the mirror image negates
DIGITS = 14


@dataclass(frozen=True)
class ChaoticProof:
    """What was proved of the exponent; `value` is a ball that contains it if it is `certified`, else anything.

    `distance` bounds the variation, and so the largest value, of the density less the candidate.
    """

    value: arb
    checks: Checks
    gap: float
    inverse: float | None
    distance: arb

    @property
    def certified(self) -> bool:
        """True when every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())


def slap_exponent(digits: int = DIGITS, cells: int = CELLS) -> ChaoticProof:
    """The exponent per bounce of the cardioid at `lam = 0`, with a density of about `digits` digits.

    >>> proof = slap_exponent(6)
    >>> proof.certified, bool(abs(proof.value - arb("0.36834079947576")) < 1e-4)
    (True, True)
    """
    proof = judged(candidate(digits), digits, inverted(cells))
    return replace(proof, checks=proof.checks | {"symmetric": symmetric(inverted(MIRRORED, sign=-1), variation())})


def symmetric(inverse: Inverted, known: Variation) -> bool | None:
    """Is every invariant density of the slap map on the whole boundary its own mirror image?"""
    if not known.proved or inverse.sign != -1 or inverse.bound is None:
        return None
    with working(64):
        return bool(gap(inverse, known) > 0) or None


def gap(inverse: Inverted, known: Variation) -> arb:
    """What must be positive, in the ambient precision."""
    return 1 - known.adds * arb.pi() / (4 * inverse.cells) * (arb(inverse.bound or 0) + 1) / (1 - known.shrinks)


def judged(near: Pieces, digits: int, inverse: Inverted, known: Variation | None = None) -> ChaoticProof:
    """The proof from any candidate for the density: a bad one makes it imprecise, and never wrong.

    The items: the inequality for variations holds; the averaged operator is inverted; the gap is positive, so that
    the natural measure exists and is unique; the candidate has a positive mass; two digits were lost at most.
    """
    known = known or variation()
    bits = bits_of(digits, 64) + 2 * digits
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
