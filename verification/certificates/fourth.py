"""Where the fourth collision falls, for every angle and every contraction of a range. Paper: section 5.2.

A ball leaves the upper corner of the cuspless cardioid at an angle near 0. The paper's plot shows
that up to `lambda-star` the fourth collision lies beyond the corner, on the wall (`s_4 > s*`). Boxes of
angle and contraction are followed in balls until every one has landed strictly inside the wall.
"""

from dataclasses import dataclass

from flint import arb

from verification.arithmetic import working
from verification.certificates.flights import ARC, BITS, WALL, Flights, Piece
from verification.progress import Tick, silent

ROUNDING = 2.0**-50  # neighbouring boxes overlap
SMALLEST = 2.0**-40


@dataclass(frozen=True)
class Fourth:
    """True when every box landed inside the wall, None when the budget ended; and the boxes it took."""

    on_wall: bool | None
    boxes: int


def fourth_on_wall(
    angle: float,
    lowest: float,
    highest: float,
    budget: int = 50_000,
    or_lower: bool = False,
    tick: Tick = silent,
) -> Fourth:
    """Does the fourth collision lie on the wall for all `|phi| <= angle`, `lowest <= lam <= highest`?

    `or_lower` accepts the lower half of the arc as well: `s_4 > s*` is all that is asked then.

    >>> fourth_on_wall(0.01, 0.0, 0.03).on_wall
    True
    """
    queue, boxes = [(0.0, angle, (lowest + highest) / 2, (highest - lowest) / 2)], 0
    area = angle * (highest - lowest) / 2 or 1.0
    with working(BITS):
        while queue:
            phi, wide, lam, half = queue.pop()
            boxes += 1
            if boxes > budget or max(wide, half) < SMALLEST:
                return Fourth(None, boxes)
            if _lands_inside(arb(phi, wide + ROUNDING), arb(lam, half + ROUNDING), or_lower):
                tick(wide * half / area)
                continue
            if wide > half:
                queue += [(phi - wide / 2, wide / 2, lam, half), (phi + wide / 2, wide / 2, lam, half)]
            else:
                queue += [(phi, wide, lam - half / 2, half / 2), (phi, wide, lam + half / 2, half / 2)]
    return Fourth(True, boxes)


def _lands_inside(phi: arb, lam: arb, or_lower: bool) -> bool:
    flights = Flights(lam)
    images = flights.iterated([Piece(ARC, flights.ends[ARC], arb(1), phi)], 4)
    if images is None:
        return False
    edge = flights.ends[WALL]
    if or_lower:
        return all(bool(p.theta > -edge) if p.component == WALL else bool(p.theta < 0) for p in images)
    return all(p.component == WALL and bool(abs(p.theta) < edge) for p in images)
