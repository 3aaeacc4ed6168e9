"""All cycles of a slap map up to a period, enclosed: the cuspless cardioid has none of period 4.

The slap map is one-dimensional, so subdivision settles it: a piece of the boundary is followed in
balls. A piece that does not meet its image holds no periodic point; where `(T0**n)' - 1` keeps its
sign it holds at most one; and pieces that touch are joined where that sign is the same, so that what is
left are as many periodic points as are known already. Where it changes from one piece to the next, as it
may at a kink of the map, each piece can hold one.
Paper: section 5.4 (`the graph of the 4th iterate confirms that there are no period-4 orbits`).
"""

from dataclasses import dataclass

from flint import arb

from verification.arithmetic.progress import Tick, silent
from verification.arithmetic.words import working
from verification.proofs.corner.flights import ARC, BITS, WALL, Flights, Piece

SMALLEST = 2.0**-30


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
