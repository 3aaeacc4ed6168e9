"""The cardioid's slap map on half the table, its transfer operator, and what the operator does to variation.

The mirror image carries orbits to orbits, so the slap map acts on the half angle `y = abs(theta)/2` in
`[0, pi/2]`; call that map `F`. A ball that lands at the half angle `b`, `-pi/2 < b < pi/4`, left at `g(b)`, which
grows from 0 to `pi/2`, with `rate = g'`: one over the slope of `F`. So `F(g(b)) = abs(b)`, and densities go to

    (L f)(x) = rate(-x)*f(g(-x)) + rate(x)*f(g(x)),       the second summand for x < pi/4 only.

Let `f` have bounded variation and end in 0 at `pi/2`. Then so does `L f`: the rate is 0 at the cusp, and the
second summand ends at `x = pi/4` with `f(pi/2) = 0`, so that nothing jumps. Its variation is at most

    integral of rate*d|f(g)|  +  integral of abs(rate')*abs(f(g)).

With `symbolic.cycles.cardioid_slap`: off the cusp `abs(rate') < STEEP*rate`, which adds `STEEP*||f||_1`. Near it,
for launches
below `y0`, the rate grows from 0 to `eta < SHRINKS/2`, which adds at most `eta*sup|f|`, and there
`sup|f| <= Var f + (1/y0)*integral of |f|`. Launches near `y0` are so multiplied by `2*eta < SHRINKS`, others by
`SHRINKS`, and altogether (the inequality of [LasotaYorke1973], norms in `L1`)

    Var(L f) <= SHRINKS*Var f + B*||f||,      B = max(STEEP, eta/y0).
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import arb, arb_series
from sympy import S

from symbolic.cycles.cardioid_slap import (
    CUSP,
    RATE,
    SHRINKS,
    STEEP,
    branch,
    derived,
    expands,
    forward_once,
    gentle_elsewhere,
    lands_first,
    near_launch,
    parametrised,
    q,
    quiet_near_the_cusp,
)
from symbolic.generation.text import load
from verification.arithmetic.balls import real_ball
from verification.arithmetic.series import series
from verification.arithmetic.words import FLOAT64, balls, working

TURN = -0.1  # the landing where the form of the launching point changes


@dataclass(frozen=True)
class Variation:
    """`Var(L f) <= shrinks*Var f + adds*||f||`, and whether every fact that it needs is proved."""

    shrinks: arb
    adds: arb
    proved: bool


@cache
def variation() -> Variation:
    """The inequality with its constants, from the exact proofs.

    >>> found = variation()
    >>> found.proved, found.shrinks.str(3, radius=False), found.adds.str(3, radius=False)
    (True, '0.835', '6.76')
    """
    facts = (
        parametrised,
        forward_once,
        lands_first,
        derived,
        expands,
        quiet_near_the_cusp,
        gentle_elsewhere,
    )
    proved = all(bool(fact()) for fact in facts)
    with working(64):
        near = real_ball(RATE.subs(q, CUSP)) / real_ball(near_launch())
        steep = real_ball(S(STEEP))
        return Variation(real_ball(S(SHRINKS)), steep.max(near), proved)


class Branches:
    """`g` and `rate` of balls and of series, at a stated precision.

    >>> at = Branches(64)
    >>> launch, rate = at(arb(0))
    >>> print(launch.str(5, radius=False), rate.str(5, radius=False))
    0.95532 0.83333
    """

    def __init__(self, bits: int) -> None:
        self.of_balls = [load(branch(above), balls(bits)) for above in (False, True)]
        self.of_series = [load(branch(above), series(bits)) for above in (False, True)]

    def __call__(self, landing: Any) -> tuple[Any, Any]:
        """The launching half angle and the rate of a landing half angle."""
        if isinstance(landing, arb_series):
            found = self.of_series[not landing[0] < TURN](landing)
        else:
            found = self.of_balls[not landing < TURN](landing)
        return found[0], found[1]

    def landing(self, launch: arb, bits: int) -> arb:
        """About where a ball lands that left at an exact half angle: Newton's method, not enclosed."""
        point = arb(landed(float(launch)))
        for _ in range(2 + bits.bit_length()):
            found, rate = self(point)
            point = (point - ((found - launch) / rate)).mid()
        return point


def landed(launch: float) -> float:
    """The same in floats, by halving.

    >>> round(abs(landed(0.9553166181245093)), 9)  # atan(sqrt(2)) lands on the axis
    0.0
    """
    below, above = -1.5707963267948966, 0.7853981633974483
    forms = [load(branch(above), FLOAT64) for above in (False, True)]
    for _ in range(60):
        middle = (below + above) / 2
        found = forms[middle >= TURN](middle)[0]
        below, above = (below, middle) if found > launch else (middle, above)
    return (below + above) / 2
