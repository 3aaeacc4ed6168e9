"""How many critical points the egg's slap map has, for every shape: none, three or six. Paper: section 6.2.

`T0' = 0` where the centre of curvature `e` lies on the boundary. With `C = cos(3*theta)` let `k` be its
distance from the centre less that of the boundary in its direction: `T0'` has the sign of `-k`. Balls show on
a cover of `-1 <= C <= 1`, `0 <= alpha <= 1/10` that `k` is not 0, or falls as `C` grows. So for each `alpha`
`k` has at most one zero, through which it falls: one where `k > 0` at the flat points (`C = -1`), none where
`k < 0` there. A zero inside stands for six points, one at `C = -1` for the three flat points.
"""

from dataclasses import dataclass

from flint import arb
from sympy import Rational

from symbolic.cycles.egg import COSINE, centre_beyond_boundary, centre_far_inside
from symbolic.generation.text import kernel, load
from symbolic.tables.symbols import alpha
from verification.arithmetic.progress import Tick, silent
from verification.arithmetic.words import balls, working

BITS = 64
SMALLEST = 2.0**-30  # halves of halves must stay exact in floats
Box = tuple[tuple[float, float], tuple[float, float]]  # middle and half width, of C and of alpha
WHOLE: Box = ((0.0, 1.0), (0.0625, 0.0625))  # a little more than the shapes up to 1/10, cut off at them


@dataclass(frozen=True)
class OneZero:
    """`proved`: `k` has at most one zero for each shape, and falls there; None when the budget ended."""

    proved: bool | None
    boxes: int


def one_zero(budget: int = 100_000, tick: Tick = silent) -> OneZero:
    """Does the centre of curvature cross the boundary at most once between a flat point and a vertex?

    >>> one_zero().proved, one_zero(budget=10).proved
    (True, None)
    """
    beyond = centre_beyond_boundary()
    expressions = {"far": centre_far_inside(), "k": beyond, "slope": beyond.diff(COSINE)}
    queue, boxes = [WHOLE], 0
    with working(BITS):
        at = load(kernel("centre", [COSINE, alpha], expressions), balls(BITS))
        most = arb(Rational(1, 10).p) / 10
        while queue:
            (c, wide), (shape, high) = box = queue.pop()
            boxes += 1
            if boxes > budget or max(wide, high) < SMALLEST:
                return OneZero(None, boxes)
            if arb(shape - high) > most:
                continue
            far, k, slope = at(arb(c, wide), arb(shape, high))
            if far > 0 or k > 0 or k < 0 or slope < 0:
                tick(wide * high / (WHOLE[0][1] * WHOLE[1][1]))
                continue
            queue += halves(box)
    return OneZero(True, boxes)


def halves(box: Box) -> list[Box]:
    """The two halves of a box, cut across its longer side; shapes are a tenth as long as cosines."""
    (c, wide), (shape, high) = box
    if wide > 10 * high:
        return [((c + side * wide / 2, wide / 2), (shape, high)) for side in (-1, 1)]
    return [((c, wide), (shape + side * high / 2, high / 2)) for side in (-1, 1)]
