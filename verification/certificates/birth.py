"""A chaotic attractor for every contraction from `lambda-star` on: a trapping region whose directions expand.

For `lambda-star < lam <= lambda-star + e` a convex polygon around the corner orbit, of a size
proportional to `lam - lambda-star`, is thrown into its own interior by half the return (`half_return`),
and there is a cone of directions that this map keeps and stretches by a factor above 1. So in the
region no cycle is stable, and every orbit in it has a positive exponent. It is a proof about the map
itself, in steps of `e`; that the attractor in the region is one piece is not proved.
Paper: section 5.2. The two ideas are those of [GlendinningSimpson2021] for the piecewise linear map.
"""

import math
from dataclasses import dataclass

from verification.arithmetic import working
from verification.certificates.corner import enclosed
from verification.certificates.half_return import limit, pieces
from verification.certificates.polygon import Expansion, Pieces, Polygon, expansion, grown, trapped
from verification.certificates.trail import BITS
from verification.progress import Tick, silent

START = -0.5, -1.7  # near the lowest point of the attractor, in units of e
ROOM = 0.03  # what a polygon has to spare, in units of e
FIRST, LONGEST, SHORTEST = 1e-3, 2e-3, 1e-5  # steps of e
TRIES = 4


@dataclass(frozen=True)
class Step:
    """What is proved for `e[0] < lam - lambda-star <= e[1]`."""

    e: tuple[float, float]
    region: Polygon
    expansion: Expansion


@dataclass(frozen=True)
class Birth:
    """`reached`: how far from `lambda-star` the proof came; `proved`: as far as it was asked to."""

    proved: bool | None
    reached: float
    steps: tuple[Step, ...]

    @property
    def exponent(self) -> tuple[float, float]:
        """Bounds of the largest exponent per bounce of every orbit in the region, over all steps."""
        least = min(float(step.expansion.least.lower()) for step in self.steps)
        most = max(float(step.expansion.most.upper()) for step in self.steps)
        return math.log(least) / 2, math.log(most) / 2


def birth(last: float, budget: int = 200, tick: Tick = silent) -> Birth:
    """The proof for `lambda-star < lam <= last`; `proved` is None when the budget of steps ends first.

    >>> birth(0.0725).proved, birth(0.0725, budget=1).proved
    (True, None)
    """
    steps: list[Step] = []
    with working(BITS):
        star = enclosed()[1]
        end = float((last - star).upper()) * (1 + 2.0**-40)
        near, reached, length = limit(), 0.0, FIRST
        for _ in range(budget):
            e = reached, min(reached + length, end)
            found = step(near, e)
            if found is None:
                length /= 2
                if length < SHORTEST:
                    break
                continue
            near, made = found
            steps.append(made)
            tick((e[1] - reached) / end)
            reached, length = e[1], min(length * 1.3, LONGEST)
            if reached >= end:
                return Birth(True, reached, tuple(steps))
    return Birth(None, reached, tuple(steps))


def step(near: Pieces, e: tuple[float, float]) -> tuple[Pieces, Step] | None:
    """The family for a stretch of `e` and what it proves; `near` is one that resembles it, for a first region."""
    region = grown(near, START, ROOM)
    for _ in range(TRIES):
        if region is None:
            return None
        try:
            family = pieces(region, e)
        except ArithmeticError:
            return None
        cone = expansion(family)
        if cone is None or not cone.least > 1:
            return None
        if trapped(family, region):
            return family, Step(e, region, cone)
        region = grown(family, START, ROOM)
    return None
