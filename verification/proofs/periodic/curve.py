"""The doubling of the egg's diameters, for every contraction: supercritical all along `alpha-tilde`.

On the curve the multiplier is -1 by a closed form, so only signs are left, and balls decide them on a
cover of `0 <= lam <= 1`. With the vertex first, `turn = -(1 - lam**2)*u0*u1/d0` exactly, where `u`, `d`
are the entries of the chain: its zero at `lam = 1` is divided out. The flip is supercritical when
`bend` and `turn` differ in sign; at `lam = 1` the second multiplier is -1 too and the word has no sense.
"""

from dataclasses import dataclass

from flint import arb

from symbolic.cycles.thresholds import alpha_tilde
from symbolic.generation.text import kernel, load
from symbolic.tables import egg
from symbolic.tables.symbols import lam as letter
from verification.arithmetic.progress import Tick, silent
from verification.arithmetic.words import balls, working
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.shooting.normal_form import normal_form
from verification.cycles.shooting.problem import Linearised, Problem, Rows

BITS = 80
SMALLEST = 2.0**-40  # halves of halves must stay exact in floats


@dataclass(frozen=True)
class Sign:
    """`supercritical` for all contractions, or None when the budget ended; and the balls it took."""

    supercritical: bool | None
    balls: int


def doubling_curve(K: int = 3, budget: int = 4000, tick: Tick = silent) -> Sign:
    """Is the period doubling of the diameters supercritical for every `0 <= lam < 1`?

    >>> doubling_curve().supercritical
    True
    """
    queue, spent = [(0.5, 0.5)], 0
    with working(BITS):
        curve = load(kernel("curve", [letter], {"alpha": alpha_tilde(K)}), balls(BITS))
        while queue:
            middle, half = queue.pop()
            spent += 1
            if spent > budget or half < SMALLEST:
                return Sign(None, spent)
            if _supercritical(K, arb(middle, half), curve(arb(middle, half))[0]):
                tick(2 * half)
            else:
                queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return Sign(True, spent)


def _supercritical(K: int, lam: arb, alpha: arb) -> bool:
    problem = Problem(egg(K), (0, 0), BifurcationKind.FLIP, "alpha", lam)
    try:
        at = Linearised(Rows(problem, balls(BITS)), [arb(0), arb.pi(), alpha])
        bend = normal_form(at, balls(BITS)).bend
    except ZeroDivisionError:
        return False
    chain = at.plain
    return bool(-bend * chain.upper[0] * chain.upper[1] / chain.diagonal[0] < 0)
