"""Critical points of the egg's slap map, and all cycles of a slap map up to a period, in balls.

The egg's slap map has no critical point, three or six, for every shape (paper: section 6.2). `T0' = 0` where the
centre of curvature `e` lies on the boundary. With `C = cos(3*theta)` let `k` be its distance from the centre less
that of the boundary in its direction: `T0'` has the sign of `-k`. Balls show on a cover of `-1 <= C <= 1`, `0 <=
alpha <= 1/10` that `k` is not 0, or falls as `C` grows. So for each `alpha` `k` has at most one zero, through which
it falls: one where `k > 0` at the flat points (`C = -1`), none where `k < 0` there. A zero inside stands for six
points, one at `C = -1` for the three flat points.

The slap map of the cuspless cardioid has no cycle of period 4. A slap map is one-dimensional, so subdivision settles
it: a piece of the boundary is followed in balls. A piece that does not meet its image holds no periodic point; where
`(T0**n)' - 1` keeps its sign it holds at most one; and pieces that touch are joined where that sign is the same, so
that what is left are as many periodic points as are known already. Where it changes from one piece to the next, as it
may at a kink of the map, each piece can hold one. Paper: section 5.4 (`the graph of the 4th iterate confirms that
there are no period-4 orbits`).
"""

from dataclasses import dataclass

from flint import arb
from sympy import Rational

from symbolic.cycles.polygons import COSINE, centre_beyond_boundary, centre_far_inside
from symbolic.expressions.text import kernel, load
from symbolic.tables.table import alpha
from verification.arithmetic.balls import balls, working
from verification.arithmetic.progress import Tick, silent
from verification.proofs.corner.corner import ARC, WALL
from verification.proofs.corner.mean_value import BITS
from verification.proofs.corner.return_map import Flights, Piece

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


@dataclass(frozen=True)
class PeriodicPoints:
    """Stretches that hold at most one solution of `T0**n(x) = x` each, and all of them; None when open."""

    stretches: list[tuple[int, float, float]] | None
    boxes: int


def periodic_points(n: int, budget: int = 200_000, tick: Tick = silent) -> PeriodicPoints:
    """Where `T0**n(x) = x` on the cuspless cardioid, in stretches of the arc and of the wall.

    >>> [(c, round(a, 2), round(b, 2)) for c, a, b in periodic_points(2).stretches or []]
    [(0, -1.12, -0.99), (0, -0.02, 0.02), (0, 0.99, 1.12), (1, -0.01, 0.01)]
    """
    with working(BITS):
        slap = Flights()
        found: list[tuple[int, float, float, int]] = []
        queue = [(ARC, *_halves(slap.ends[ARC])), (WALL, *_halves(slap.ends[WALL]))]
        boxes = 0
        while queue:
            component, middle, half = queue.pop()
            boxes += 1
            if boxes > budget or half < SMALLEST:
                return PeriodicPoints(None, boxes)
            box = arb(middle, half)
            images = slap.iterated([Piece(component, box, arb(1), arb(0))], n)
            apart = images is not None and not any(p.component == component and p.theta.overlaps(box) for p in images)
            sign = _sign(images[0].slope - 1) if images is not None and len(images) == 1 and half < 1e-2 else 0
            if sign and not apart:
                found.append((component, middle - half, middle + half, sign))
            if apart or sign:
                tick(half / sum(_halves(end)[1] for end in slap.ends.values()))
                continue
            queue += [(component, middle - half / 2, half / 2), (component, middle + half / 2, half / 2)]
        return PeriodicPoints(_joined(sorted(found)), boxes)


def _halves(end: arb) -> tuple[float, float]:
    return 0.0, float(end.upper()) * (1 + 2.0**-40)


def _sign(x: arb) -> int:
    """1 or -1 when it is proved, else 0."""
    return 0 if not x.is_finite() else 1 if x > 0 else -1 if x < 0 else 0


def _joined(stretches: list[tuple[int, float, float, int]]) -> list[tuple[int, float, float]]:
    """Touching stretches as one, where `(T0**n)' - 1` has one sign on both."""
    made: list[tuple[int, float, float, int]] = []
    for component, low, high, sign in stretches:
        if made and (made[-1][0], made[-1][3]) == (component, sign) and low <= made[-1][2] + 1e-12:
            made[-1] = component, made[-1][1], max(high, made[-1][2]), sign
        else:
            made.append((component, low, high, sign))
    return [(component, low, high) for component, low, high, _ in made]
