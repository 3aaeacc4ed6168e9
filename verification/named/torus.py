"""Cycles that expand areas although `lam < 1`, and Neimark-Sacker bifurcations: proved, on the paper's own egg.

The determinant of a cycle is not `lam**p` (`symbolic.cycles.determinant`). Three facts, each in balls:

- `contracting_up_to`: below a contraction no cycle of the egg expands, so none bifurcates that way;
- `expanding_cycle`: a hexagon at `alpha = 0.08`, `lam = 0.95` whose determinant is above 1;
- `double_one`: a cycle of period 17 with the double multiplier 1 at a `lam < 1`. The zero is regular, so
  along `det M = 1` the trace crosses 2 there: on one side the multipliers are complex, of modulus 1.
"""

from dataclasses import dataclass

from flint import arb
from sympy import Expr, Rational, atan

from symbolic.cycles.polygons import largest_tilt
from symbolic.generation.text import kernel, load
from symbolic.tables import egg
from symbolic.tables.symbols import alpha as letter
from verification.arithmetic.balls import exact_balls
from verification.arithmetic.words import balls, working
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.chain import trace_and_determinant
from verification.cycles.recurrence.chords import Chords
from verification.cycles.shooting.critical import critical
from verification.cycles.shooting.newton import refined
from verification.cycles.shooting.problem import Linearised, Problem, Rows
from verification.cycles.shooting.small import Small
from verification.named.locate import certify
from verification.proofs.periodic.interval_newton import Enclosure, contraction

BITS = 128
HEXAGON = (0.0, 1.0472, 2.0944, 3.1416, 4.1888, 5.236)
LONG = (  # period 17, rotation number 4/17; then alpha and lam
    *(0.031731, 1.939716, 3.434869, 4.415375, 6.136337, 1.136034, 2.284457, 4.108431, 5.740919),
    *(0.357381, 2.12005, 4.011587, 5.416771, 0.214657, 2.020715, 3.654544, 4.551936),
    *(0.06873034054513638, 0.9637899748709065),
)


@dataclass(frozen=True)
class Expanding:
    """A cycle, proved to exist, and its determinant as a ball."""

    certified: bool
    determinant: arb


def expanding_cycle(alpha: str = "2/25", lam: str = "19/20") -> Expanding:
    """The hexagon of the egg and its determinant.

    >>> found = expanding_cycle()
    >>> found.certified, bool(found.determinant > 1)
    (True, True)
    """
    problem = Problem(egg(3).at(alpha=alpha), (0,) * 6, lam=Rational(lam))
    proof = certify(problem, list(HEXAGON), 20)
    with working(BITS):
        chain = Linearised(Rows(problem, balls(BITS)), proof.enclosure.zero).plain
        _, determinant = trace_and_determinant(chain.rows)
    return Expanding(proof.certified, determinant)


def resonance(period: int) -> Small:
    """A cycle of the egg with the double multiplier 1: unknowns are its bounces, `alpha` and `lam`."""
    both = BifurcationKind.FOLD, BifurcationKind.TORUS
    return critical(Chords(egg(3), (0,) * period), both, ("alpha", "lam"))


def double_one() -> Enclosure:
    """The resonance of period 17, enclosed; the last two balls are `alpha` and `lam`."""
    system = resonance(17)
    solution = refined(system, list(LONG), 24)
    with working(256):
        radius = (arb(10) ** -22).mid()
    return contraction(system, exact_balls(solution.z), radius, 256)


def contracting_up_to(alpha: Expr, K: int = 3) -> float:
    """A contraction up to which the determinant of every cycle of the egg is below 1, in steps of 1/64.

    With `d` the largest tilt of the normal and `r` the ratio of the largest and the smallest radius, the sine
    rule on the triangle of a chord and the centre gives `|eta| <= d + asin(r*sin(d + |phi|))`. If the largest
    `|eta|` of a cycle, with `|phi| <= lam*|eta|`, could not be between the root of `x*tan(x) = 1` and `pi/2`,
    every factor is below 1.

    >>> contracting_up_to(Rational(2, 25))
    0.328125
    """
    best = 0.0
    with working(BITS):
        tilt, ratio = load(
            kernel("egg", [], {"tilt": atan(largest_tilt(K).subs(letter, alpha)), "ratio": (1 + alpha) / (1 - alpha)}),
            balls(BITS),
        )()
        for step in range(1, 64):
            if not _confined(tilt, ratio, arb(step) / 64):
                return best
            best = step / 64
    return best


def _confined(tilt: arb, ratio: arb, lam: arb, pieces: int = 512) -> bool:
    """Is `d + asin(r*sin(d + lam*E)) < E` for every `E` from the root of `x*tan(x) = 1` to `pi/2`?"""
    low, high = arb("0.8603"), arb.pi() / 2
    for k in range(pieces):
        E = low + (high - low) * arb(2 * k + 1, 1) / (2 * pieces)
        steepest = ratio * (tilt + lam * E).sin()
        if not (tilt + lam * E < arb.pi() / 2 and steepest < 1 and tilt + steepest.asin() < E):
            return False
    return bool(low * low.tan() < 1)
