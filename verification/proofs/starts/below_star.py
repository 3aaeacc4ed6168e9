"""Below `lambda*` what leaves the upper join at a small angle comes to the horizontal orbit: the cuspless table.

Every start at the upper join with an exit angle of at most `ANGLE`, and every `0 <= lam < lambda*`. Paper: section 5.2.

*Up to `NEXT`*, in boxes. From the cells that hold these starts no walk leads to cells where orbits return but to those
about the horizontal orbit; and what stays in these converges to it, by contraction (`fates`), or since those on the
wall lie in a core (`core`), to which each walk comes, as none stays on the arc.

*From `NEXT` to `lambda*`*. Half the return next to the corner orbit (`verification.proofs.corner.half_return`) is a map
`(U, V) -> (U1, V1)`: from the arc at `-theta1 + U` to `V` beyond the upper corner, on the arc where `V < 0` and on the
wall where `V > 0`, and mirrored. It has a fixed point at 0 for `lam = lambda*`, and continuous derivatives on either
side of `V = 0`. So with `e = lambda* - lam` it is `a*U + b*V + c*e`, with `a`, `b`, `c` from the hull of derivatives
along the straight way to 0, which stays on one side. Call a state *inner* when `U >= -K*(abs(V) + e)`,
`abs(U) <= U_END` and `V_LOW <= V <= V_HIGH`. The hulls show (`inner`):

- the image of an inner state has `0 <= U1 <= U_END`, `0 < V1 <= FAR` and `U1 <= LEAN*V1 + THICK`;
- from `U >= 0`, `V >= 0` it has `V1 >= q*V + c*e` with `q > 1` and `c > 0`. So `V` grows by a factor, and at least by a
  positive number, at each half return, and comes to lie between `V_HIGH` and `FAR`.

All states with such `V` and `-THICK <= U <= LEAN*V + THICK` are in a core of the horizontal orbit, or a gate of it
(`core`, `exits`).

A start at the join next comes to the arc, at `theta1 - U`, say, and then `V1 = r*U + c*e`. For `abs(U) <= BESIDE` the
state `(U, V1)` is inner or one of those (`starts`): if `U < -K*e` then `V1 < 0` and `K*(abs(V1) + e) >= abs(U)`, since
`abs(V1) >= r*abs(U) - c*e`, `K*r > c` and `K*r > 1`. The other starts are carried along as parallelograms until all
are in the core or a gate (`carried`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import arb, fmpq
from numpy.typing import NDArray

from symbolic import Scene
from verification.arithmetic.balls import cuts, joined, working
from verification.proofs.corner.corner import (
    ARC,
    BITS,
    WALL,
    Bounce,
    Quantity,
    after_corner,
    angle,
    beyond,
    constant,
    corner_parameters,
    enclosed,
    parameter,
)
from verification.proofs.corner.half_return import followed
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.fates import Cluster, Fate
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.core import Core, attracts
from verification.proofs.starts.parallelograms import Parallelograms
from verification.proofs.starts.parallelograms import carried as moved

ANGLE, NEXT = 0.04, Fraction("0.0688")
TOP = Fraction("0.0713")  # above lambda*
K, U_END, V_LOW, V_HIGH = 2.0, 0.045, -0.03, 0.0285
LEAN, THICK, FAR, BESIDE = 0.8, 0.004, 0.1, 0.016
SIDES = 1e-2, 2e-3, 5e-4  # of the boxes of U, V and e over which derivatives are enclosed
MOST_BOUNCES, SLICES = 60, 64
MIDDLE = 0.9  # in the arc's parameter: cells nearer to its middle are not about the vertical orbit, at pi/3
CHECKS = ("boxes", "core", "inner", "exits", "starts", "carried")
Hull = list[list[arb]]
Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def unreturning(fate: Fate, core: Core | None) -> bool:
    """Do all walks from the upper join, at angles up to `ANGLE`, end about the horizontal orbit, and orbits on it?

    They converge there since boxes contract, or since those on the wall lie in a core.
    """
    if fate.parts is None or (core is None and fate.checks["sinks"] is not True):
        return False
    graph, cells = fate.graph, fate.graph.cells
    boxes = graph.grid.boxes(cells)
    edge = float(fate.map.charts[ARC].x[1])
    first = (
        graph.leaf & (cells.chart == ARC) & (boxes.x[1] >= edge - 1e-9) & (boxes.y[1] >= -ANGLE) & (boxes.y[0] <= ANGLE)
    )
    reached = graph.reached(np.append(first, False)) & graph.recurrent
    if reached[-1] or not reached.any():
        return False
    on = reached[:-1]
    arc, wall = on & (cells.chart == ARC), on & (cells.chart != ARC)
    if core is None:
        return _within(boxes.chosen(on), fate.parts)
    near = np.all(np.abs(np.concatenate([side[arc] for side in boxes.x])) < MIDDLE)
    stays = graph.edges[:-1, :-1][arc][:, arc].nnz > 0
    held = core.holds(Parallelograms.about(boxes.chosen(wall))).all()
    return bool(near and not stays and held and all(attracts(fate.map, core).values()))


def _within(boxes: Boxes, parts: Sequence[Cluster]) -> bool:
    """Does each box lie in a rectangle of a sink, and meet none of another part?"""
    held, clear = np.zeros(boxes.chart.size, dtype=bool), np.ones(boxes.chart.size, dtype=bool)
    for part in parts:
        for chart, left, right, low, high in zip(part.boxes.chart, *part.boxes.x, *part.boxes.y, strict=True):
            same = boxes.chart == chart
            if part.sink:
                inside = (left <= boxes.x[0]) & (boxes.x[1] <= right) & (low <= boxes.y[0]) & (boxes.y[1] <= high)
                held |= same & inside
            else:
                apart = (boxes.x[1] < left) | (right < boxes.x[0]) | (boxes.y[1] < low) | (high < boxes.y[0])
                clear &= ~same | apart
    return bool(np.all(held & clear))


@dataclass(frozen=True)
class BelowStar:
    """The statement; `fates` are graphs whose ranges join from 0 to `NEXT`, each with a core or None."""

    fates: tuple[tuple[Fate, Core | None], ...]
    core: Core

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        found: dict[str, bool | None] = dict.fromkeys(CHECKS)
        ends = [end for fate, _ in self.fates for end in fate.lam]
        gapless = [Fraction(0), *ends, NEXT]
        joins = all(a == b for a, b in zip(gapless[::2], gapless[1::2], strict=True))
        found["boxes"] = (joins and all(unreturning(*one) for one in self.fates)) or None
        images = PinballImages(Scene("cuspless"), (NEXT, TOP))
        found["core"] = all(attracts(images, self.core).values()) or None
        with working(BITS):
            theta1, star = enclosed()
            depth = star - arb(fmpq(NEXT.numerator, NEXT.denominator))
            if not star < arb(fmpq(TOP.numerator, TOP.denominator)):
                return found
            try:
                found["inner"] = inner(hulls(depth), depth) or None
                found["starts"] = begins(first_hull(depth), depth) or None
                found["exits"] = self._exits() or None
                angles = [_leaving(theta1 + sign * BESIDE) for sign in (1, -1)]
            except ArithmeticError:
                return found
        slices = np.linspace(-ANGLE, ANGLE, SLICES + 1)
        beside = ~((slices[:-1] >= float(angles[0].upper())) & (slices[1:] <= float(angles[1].lower())))
        found["carried"] = self._carried(images, slices[:-1][beside], slices[1:][beside]) or None
        return found

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())

    def _exits(self) -> bool:
        """Are all states with `V_HIGH <= V <= FAR` and `-THICK <= U <= LEAN*V + THICK` in the core or a gate?"""
        theta1, _ = enclosed()
        lam = arb(fmpq(NEXT.numerator, NEXT.denominator)).union(arb(fmpq(TOP.numerator, TOP.denominator)))
        cells = []
        for v in cuts(V_HIGH, FAR, SIDES[1]):
            for u in cuts(-THICK, LEAN * float(v.upper()) + THICK, SIDES[0]):
                at = corner_parameters()[WALL] + v
                phi = -lam * angle(Bounce(WALL, constant(at, ())), Bounce(ARC, constant(-theta1 + u, ())))[0]
                cells.append([float(end) for x in (at, phi) for end in (x.lower(), x.upper())])
        left, right, low, high = np.array(cells).T
        tiny = 1e-15  # more than the rounding of an end
        boxes = Boxes(np.full(left.size, WALL), (left - tiny, right + tiny), (low - tiny, high + tiny))
        return bool(self.core.enters(Parallelograms.about(boxes)).all())

    def _carried(self, map: PinballImages, low: Array, high: Array) -> bool:
        """Do all orbits that leave the upper join at angles between these come to the core or a gate?"""
        end = map.charts[ARC].x[1]
        tiny, count = np.full(low.size, 1e-14), np.full(low.size, ARC)
        sets = Parallelograms.about(Boxes(count, (end - tiny, end + tiny), (low, high)))
        for _ in range(MOST_BOUNCES):
            sets = sets[~self.core.enters(sets)]
            if not sets.chart.size:
                return True
            _, sets = moved(map, sets)
            if not sets.known.all():
                return False
        return False


def _leaving(theta: arb) -> arb:
    """The exit angle at the upper join of the chord to a point of the arc."""
    here, there = corner_parameters()[ARC], theta
    return angle(Bounce(ARC, constant(here, ())), Bounce(ARC, constant(there, ())))[0]


def _end(depth: arb) -> float:
    """A double above it: rounded to the nearest one, contractions next to `NEXT` might be left out."""
    return float(depth.upper()) * (1 + 2.0**-40)


def hulls(depth: arb) -> dict[int, Hull]:
    """The derivatives of `(U1, V1)` by `U`, `V` and `-e` over all inner states, on either side of `V = 0`."""
    found = {}
    for component, ends in ((ARC, (V_LOW, 0.0)), (WALL, (0.0, V_HIGH))):
        boxes = [
            image
            for e in cuts(-_end(depth), 0.0, SIDES[2])
            for u in cuts(-U_END, U_END, SIDES[0])
            for v in cuts(*ends, SIDES[1])
            for image in followed(component, u, v, e)
        ]
        found[component] = [[joined([image[k].slopes[i] for image in boxes]) for i in (0, 1, 2)] for k in (0, 1)]
    return found


def inner(hull: dict[int, Hull], depth: arb) -> bool:
    """The inequalities of the module's docstring for the images of inner states; `abs(V)` is the second variable."""
    steps = []
    for component, sign in ((ARC, -1), (WALL, 1)):
        (a, b, c), (f, g, h) = hull[component]
        b, g, c, h = sign * b, sign * g, -c, -h  # by abs(V) and by e
        steps += [
            *(x > 0 for x in (a, b, c, f, g, h)),
            b > K * a and c > K * a,  # U1 >= 0, where U is negative too
            g > K * f and h > K * f,  # V1 > 0
            a * U_END + b * max(-V_LOW, V_HIGH) + c * depth < U_END,
            f * U_END + g * max(-V_LOW, V_HIGH) + h * depth < FAR,
            b < LEAN * (g - K * f) and c < LEAN * (h - K * f) and a * U_END < THICK,
        ]
    return all(bool(step) for step in steps) and bool(hull[WALL][1][1] > 1)


def first_hull(depth: arb) -> list[arb]:
    """The derivatives of `V1` by `U` and `-e` for what leaves the upper join for the arc at `theta1 - U`."""
    theta1, star = enclosed()
    found = []
    for e in cuts(-_end(depth), 0.0, SIDES[2]):
        for u in cuts(-BESIDE, BESIDE, SIDES[1]):
            spread = u - arb(u.mid()), e - arb(e.mid())
            at, lam = parameter(arb(u.mid()), 0, spread), parameter(star + e.mid(), 1, spread)
            middle = Quantity(theta1 - at.centre, tuple(-s for s in at.slopes), theta1 - at.whole)
            join = Bounce(ARC, constant(corner_parameters()[ARC], spread))
            landings = after_corner(join, Bounce(ARC, middle), False, lam, spread)
            found += [beyond(landing, False).slopes for landing in landings]
    return [joined([slopes[i] for slopes in found]) for i in (0, 1)]


def begins(hull: list[arb], depth: arb) -> bool:
    """Is each `(U, V1)` an inner state, or one of the exits, for `abs(U) <= BESIDE`?"""
    r, c = hull[0], -hull[1]
    steps = [
        r > 0 and c > 0,
        K * r > c and K * r > 1,
        r * BESIDE < -V_LOW and BESIDE < U_END,
        r * BESIDE + c * depth < FAR,
        r * LEAN > 1 and c * depth < V_HIGH,  # where V1 > V_HIGH: 0 < U < LEAN*V1
    ]
    return all(bool(step) for step in steps)
