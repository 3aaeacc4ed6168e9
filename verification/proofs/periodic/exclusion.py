"""No cycle of period 3 in a set of contractions, by exclusion of every triangle. Paper: section 6.4.

For a period-3 cycle of a convex table the collision rule `phi_i = -lam*eta_i` and the interior
angles `phi_i - eta_i`, which add up to `pi`, give (counterclockwise, the mirror image being the same)

    0 <= phi_i,    sum phi_i = lam*pi/(1 + lam),    phi_i*eta_j = phi_j*eta_i.

So `phi_i <= lam*pi/(1 + lam)`, and since `phi` falls as the landing point moves on, two bounces are at
least a gap apart, which is found first. Triangles with their gaps at least that are covered by boxes;
a box is excluded when one of the equations, by enclosure or by the mean value theorem around its
centre, cannot hold in it, and halved otherwise.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from flint import arb
from sympy import Expr

from symbolic.generation.text import kernel, load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import egg
from verification.arithmetic.progress import Tick, silent
from verification.arithmetic.words import balls, working
from verification.cycles.recurrence.chain import Vector
from verification.maps.admissible import convex

BITS = 64
SMALLEST = 2.0**-36  # ends of boxes must stay exact in floats
Box = tuple[tuple[float, float], ...]  # midpoint and half width of: first bounce, first gap, second gap


@dataclass(frozen=True)
class Exclusion:
    """`excluded`: every box was; None when the budget ended first. `share` is the volume excluded."""

    excluded: bool | None
    boxes: int
    share: float
    smallest: float


def no_triangles(alpha: Expr, most: Expr, K: int = 3, budget: int = 10**6, tick: Tick = silent) -> Exclusion:
    """Has the K-pointed egg no period-3 cycle for any `0 <= lam <= most`?

    >>> from sympy import Rational
    >>> no_triangles(Rational(2, 25), Rational(1, 4)).excluded
    True
    """
    table = egg(K).at(alpha=alpha)
    if convex(table) is not True:
        return Exclusion(None, 0, 0.0, 0.0)
    with working(BITS):
        arithmetic = balls(BITS)
        angle = load(chord_kernel(table, 0, 0, 1), arithmetic)
        ratio = load(kernel("most", [], {"most": most}), arithmetic)()[0] + arb(0)
        largest = ratio * arb.pi() / (1 + ratio)
        gap = _gap(angle, largest)
        turn = math.ceil(201.07 / K) / 64  # a little over pi/K, and like all ends of boxes exact in binary
        reach = 201.25 / 64 - gap
        start: Box = ((turn, turn), (gap + reach, reach), (gap + reach, reach))
        return _subdivided(partial(_impossible, angle, largest, ratio, gap), start, budget, tick)


def _gap(angle: Any, largest: arb) -> float:
    """A gap between parameters at and below which every exit angle exceeds `largest`."""
    gap, pieces = 1.5, 400
    while gap > 0:
        step = 2 * arb.pi() / pieces
        starts = [arb(2 * k + 1, 1) * step / 2 for k in range(pieces)]
        if all(angle(x, x + arb(gap))[0] > largest for x in starts):
            return gap
        gap -= 1 / 16
    return 0.0


def _subdivided(impossible: Callable[[Box], bool], start: Box, budget: int, tick: Tick) -> Exclusion:
    queue, boxes, done, smallest = [start], 0, 0.0, 1.0
    while queue and boxes < budget:
        box = queue.pop()
        boxes += 1
        share = _volume(box) / _volume(start)
        if impossible(box):
            done += share
            tick(share)
            continue
        smallest = min(smallest, *(half for _, half in box))
        widest = max(range(3), key=lambda i: box[i][1])
        middle, half = box[widest]
        if half < SMALLEST:
            return Exclusion(None, boxes, done, smallest)
        for side in (-half / 2, half / 2):
            queue.append(tuple((middle + side, half / 2) if i == widest else x for i, x in enumerate(box)))
    return Exclusion(None if queue else True, boxes, done, smallest)


def _volume(box: Box) -> float:
    return box[0][1] * box[1][1] * box[2][1]


def _impossible(angle: Any, largest: arb, ratio: arb, gap: float, box: Box) -> bool:
    """True when it is proved that no triangle of the box obeys the equations."""
    (first, _), (one, _), (two, _) = box
    wide = [arb(m, r) for m, r in box]
    rest = 2 * arb.pi() - wide[1] - wide[2]
    if rest < gap or wide[1] < wide[2] or wide[1] < rest:  # the first gap may be taken for the largest
        return True
    theta = [wide[0], wide[0] + wide[1], wide[0] + wide[1] + wide[2]]
    ends = [(0, 1), (1, 2), (2, 0)]
    forth = [angle(theta[i], theta[j]) for i, j in ends]
    if any(f[0] < 0 or f[0] > largest for f in forth) or forth[0][0] + forth[1][0] + forth[2][0] > largest:
        return True
    back = [angle(theta[j], theta[i]) for i, j in ends]  # back[i] is the incidence at the end of flight i
    phi, eta = [f[0] for f in forth], [back[2][0], back[0][0], back[1][0]]
    if not all(x.is_finite() for x in (*phi, *eta)):
        return False
    if any(not (p + ratio * e * _UNIT).contains(0) for p, e in zip(phi, eta, strict=True)):
        return True
    dphi = [_slope(f, i, j) for f, (i, j) in zip(forth, ends, strict=True)]
    deta = [_slope(b, j, i) for b, (i, j) in zip(back, ends, strict=True)]
    deta = [deta[2], deta[0], deta[1]]
    middle = [arb(first), arb(first) + one, arb(first) + one + two]
    phi_m = [angle(middle[i], middle[j])[0] for i, j in ends]
    eta_m = [angle(middle[i], middle[i - 1])[0] for i in range(3)]
    offset = [x - m for x, m in zip(wide, (arb(first), arb(one), arb(two)), strict=True)]
    total = [dphi[0][k] + dphi[1][k] + dphi[2][k] for k in range(3)]
    if phi_m[0] + phi_m[1] + phi_m[2] + _dot(_by_gaps(total), offset) > largest:
        return True
    for i, j in ends:
        value = phi_m[i] * eta_m[j] - phi_m[j] * eta_m[i]
        slope = [
            dphi[i][k] * eta[j] + phi[i] * deta[j][k] - dphi[j][k] * eta[i] - phi[j] * deta[i][k] for k in range(3)
        ]
        if not (value + _dot(_by_gaps(slope), offset)).contains(0):
            return True
    return False


_UNIT = arb("0.5", "0.5")  # lam/most


def _slope(values: Any, here: int, there: int) -> Vector:
    found: Vector = [0, 0, 0]
    found[here], found[there] = values[1], values[2]
    return found


def _by_gaps(slope: Vector) -> Vector:
    """Derivatives by the three parameters as derivatives by the first one and the two gaps."""
    return [slope[0] + slope[1] + slope[2], slope[1] + slope[2], slope[2]]


def _dot(x: Vector, y: Vector) -> arb:
    total: arb = x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
    return total
