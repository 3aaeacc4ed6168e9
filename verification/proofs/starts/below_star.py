"""Below `lambda*` orbits from the upper join of the cuspless table converge to the horizontal orbit, at small angles.

This is proved for all exit angles up to `ANGLE` in modulus and every `0 <= lam < lambda*`. Paper: section 5.2.

*Up to `NEXT`*, by a graph of boxes. From the cells of these starts, walks to recurrent cells lead only to those around
the horizontal orbit. Orbits that stay in these converge to it, by contraction (`fates`), or because the cells on the
wall lie in an attracting tube (`core`); every walk reaches these cells, as none stays on the arc.

*From `NEXT` to `lambda*`*. The half return near the corner orbit (`verification.proofs.corner.half_return`) is a map
`(U, V) -> (U1, V1)`. A state `(U, V)` is a flight from the arc at `-theta1 + U` to the distance `V` beyond the upper
corner, on the arc where `V < 0` and on the wall where `V > 0`. The map has a fixed point at 0 for `lam = lambda*`, and
continuous derivatives on either side of `V = 0`. So with `e = lambda* - lam`, `U1` is `a*U + b*V + c*e`, with `a`, `b`,
`c` from the hull of derivatives along the segment to 0, which stays on one side; `V1` likewise, with other derivatives.
Names in capitals are constants of this module. Call a state *inner* when `U >= -K*(abs(V) + e)`, `abs(U) <= U_END` and
`V_LOW <= V <= V_HIGH`. The hulls prove (`inner`):

- the image of an inner state has `0 <= U1 <= U_END`, `0 < V1 <= FAR` and `U1 <= LEAN*V1 + THICK`;
- if `U >= 0` and `V >= 0` then `V1 >= q*V + c*e` with some numbers `q > 1` and `c > 0`. So `V` grows by at least a
  factor and a positive number at each half return, until it lies between `V_HIGH` and `FAR`;
- no orbit has all its states within `abs(U) <= U_END` and `V_LOW <= V <= V_HIGH`. If none of the states were inner,
  then `U < -K*e` in each and `U1 >= a*U` with `a < 1`, so that `U` would tend to 0, which is a contradiction; and after
  an inner state `V` grows beyond `V_HIGH`. So no orbit stays in boxes next to the corner orbit, and *almost every orbit
  converges to the horizontal one* when the other recurrent boxes are sinks and saddles (`fates`).

All states with `V_HIGH <= V <= FAR` and `-THICK <= U <= LEAN*V + THICK`, called *exits*, are in the tube around the
horizontal orbit, or an entry tube (`core`, `exits`).

An orbit that starts at the join lands on the arc, at `theta1 - U`, and then `V1 = r*U + c*e` with derivatives `r > 0`
and `c > 0`, enclosed in the same way. For `abs(U) <= BESIDE` the state `(U, V1)` is inner or an exit (`starts`): if
`U < -K*e` then `V1 < 0` and `K*(abs(V1) + e) >= abs(U)`, since `abs(V1) >= r*abs(U) - c*e`, `K*r > c` and `K*r > 1`.
The other starts are covered by parallelograms, whose images are followed until all are in the tube or an entry tube
(`carried`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import arb

from symbolic import Scene
from verification.arithmetic.arrays import Mask
from verification.arithmetic.balls import cuts, fraction_ball, joined, working
from verification.proofs.corner.corner import (
    ARC,
    BITS,
    WALL,
    BoundaryPoint,
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
from verification.proofs.global_dynamics.fates import AlmostEveryOrbit, Cluster
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.core import AbsorbingTube, attracts
from verification.proofs.starts.parallelograms import Parallelograms
from verification.proofs.starts.parallelograms import push_forward as moved
from verification.rigorous.boxes import Boxes
from verification.rigorous.graph import Cells
from verification.rigorous.theorem import Theorem, hypothesis

ANGLE, NEXT = 0.04, Fraction("0.0688")
TOP = Fraction("0.0713")  # above lambda*
HORIZONTAL = ((0, 0.0, 0.0), (1, 0.0, 0.0))  # component, theta, phi: of the arc's rightmost point and the wall's middle
K, U_END, V_LOW, V_HIGH = 2.0, 0.045, -0.03, 0.0285
LEAN, THICK, FAR, BESIDE = 0.8, 0.004, 0.1, 0.016
SIDES = 1e-2, 2e-3, 5e-4  # sides of the boxes of U, V and e over which derivatives are enclosed
MOST_BOUNCES, SLICES = 60, 64
MIDDLE = 0.9  # in the arc's parameter: cells closer to its middle are away from the vertical orbit, at pi/3
Hull = list[list[arb]]


def join_orbits_end_on_axis(one: AlmostEveryOrbit, tube: AbsorbingTube | None) -> bool:
    """True if all orbits from the upper join, at angles up to `ANGLE`, are proved to end on the horizontal orbit.

    All walks end around that orbit; orbits there converge since boxes contract, or since those on the wall lie in
    `tube`.
    """
    if one.parts is None or (tube is None and one.sinks is not True):
        return False
    graph, cells = one.graph, one.graph.cells
    boxes = graph.grid.boxes(cells)
    edge = float(one.map.charts[ARC].x[1])
    first = (
        graph.leaf & (cells.chart == ARC) & (boxes.x[1] >= edge - 1e-9) & (boxes.y[1] >= -ANGLE) & (boxes.y[0] <= ANGLE)
    )
    reached = graph.reached(np.append(first, False)) & graph.recurrent
    if reached[-1] or not reached.any():
        return False
    on = reached[:-1]
    arc, wall = on & (cells.chart == ARC), on & (cells.chart != ARC)
    if tube is None:
        return _within(boxes.chosen(on), one.parts)
    near = np.all(np.abs(np.concatenate([side[arc] for side in boxes.x])) < MIDDLE)
    stays = graph.edges[:-1, :-1][arc][:, arc].nnz > 0
    held = tube.holds(Parallelograms.about(boxes.chosen(wall))).all()
    return bool(near and not stays and held and all(attracts(one.map, tube).values()))


def _within(boxes: Boxes, parts: Sequence[Cluster]) -> bool:
    """True if each box lies in a rectangle of a sink and meets no rectangle of another component."""
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
class ConvergenceBelowLambdaStar(Theorem):
    """For `lam < lambda*` orbits from the upper join at angles up to `ANGLE` converge to the horizontal orbit.

    `ranges` has theorems for consecutive ranges of contractions from 0 to `NEXT`, each with a tube or None; `tube` is
    for the contractions from `NEXT` to `lambda*`.
    """

    ranges: tuple[tuple[AlmostEveryOrbit, AbsorbingTube | None], ...]
    tube: AbsorbingTube

    @cached_property
    def map(self) -> PinballImages:
        """The enclosing map on boxes, for all contractions from `NEXT` to `TOP`."""
        return PinballImages(Scene("cuspless"), (NEXT, TOP))

    @cached_property
    def depth(self) -> arb:
        """The difference `lambda* - NEXT`, as a ball."""
        with working(BITS):
            above: arb = enclosed()[1] - fraction_ball(NEXT)
        return above

    @hypothesis
    def boxes(self) -> bool:
        """The ranges cover 0 to `NEXT`; in each, walks from the upper join end around the horizontal orbit."""
        gapless = [Fraction(0), *(end for one, _ in self.ranges for end in one.lam), NEXT]
        joins = all(a == b for a, b in zip(gapless[::2], gapless[1::2], strict=True))
        return joins and all(join_orbits_end_on_axis(*one) for one in self.ranges)

    @hypothesis
    def core(self) -> bool:
        """For `lam` from `NEXT` to `TOP > lambda*`, orbits in the tube converge to the horizontal orbit."""
        return bool(self.depth < fraction_ball(TOP - NEXT)) and all(attracts(self.map, self.tube).values())

    @hypothesis
    def inner(self) -> bool:
        """Images of inner states are inner states or exits, and `V` grows."""
        with working(BITS):
            return inner(hulls(self.depth), self.depth)

    @hypothesis
    def exits(self) -> bool:
        """States with `V_HIGH <= V <= FAR`, `-THICK <= U <= LEAN*V + THICK` are in the tube or an entry tube."""
        with working(BITS):
            theta1, _ = enclosed()
            lam = fraction_ball(NEXT).union(fraction_ball(TOP))
            cells = []
            for v in cuts(V_HIGH, FAR, SIDES[1]):
                for u in cuts(-THICK, LEAN * float(v.upper()) + THICK, SIDES[0]):
                    at = corner_parameters()[WALL] + v
                    phi = (
                        -lam
                        * angle(BoundaryPoint(WALL, constant(at, ())), BoundaryPoint(ARC, constant(-theta1 + u, ())))[0]
                    )
                    cells.append([float(end) for x in (at, phi) for end in (x.lower(), x.upper())])
        left, right, low, high = np.array(cells).T
        tiny = 1e-15  # above the rounding of an end
        boxes = Boxes(np.full(left.size, WALL), (left - tiny, right + tiny), (low - tiny, high + tiny))
        return bool(self.tube.enters(Parallelograms.about(boxes)).all())

    @hypothesis
    def starts(self) -> bool:
        """Orbits that go from the join to the arc within `BESIDE` of `theta1` are next in an inner state or an exit."""
        with working(BITS):
            return begins(first_hull(self.depth), self.depth)

    @hypothesis
    def carried(self) -> bool:
        """Orbits from the join that land farther than `BESIDE` from `theta1` reach the tube or an entry tube."""
        with working(BITS):
            first, last = (_leaving(enclosed()[0] + sign * BESIDE) for sign in (1, -1))
        slices = np.linspace(-ANGLE, ANGLE, SLICES + 1)
        beside = ~((slices[:-1] >= float(first.upper())) & (slices[1:] <= float(last.lower())))
        low, high, end = slices[:-1][beside], slices[1:][beside], self.map.charts[ARC].x[1]
        tiny, count = np.full(low.size, 1e-14), np.full(low.size, ARC)
        sets = Parallelograms.about(Boxes(count, (end - tiny, end + tiny), (low, high)))
        for _ in range(MOST_BOUNCES):
            sets = sets[~self.tube.enters(sets)]
            if not sets.chart.size:
                return True
            _, sets = moved(self.map, sets)
            if not sets.known.all():
                return False
        return False


@dataclass(frozen=True)
class AlmostEveryOrbitBesideLambdaStar(AlmostEveryOrbit):
    """Almost every orbit converges to one of the cycles, for each contraction of a range that lies below `lambda*`."""

    @cached_property
    def depth(self) -> arb:
        """The difference between `lambda*` and the lower end of the range, as a ball."""
        with working(BITS):
            above: arb = enclosed()[1] - fraction_ball(self.lam[0])
        return above

    @cached_property
    def beside(self) -> Mask:
        """Vertices of components whose leaves lie next to the corner orbit, and whose edges follow its cyclic order."""
        graph, found = self.graph, np.zeros_like(self.graph.recurrent)
        chosen = np.flatnonzero(graph.recurrent[:-1] & graph.leaf)
        boxes = graph.grid.boxes(Cells(*(field[chosen] for field in graph.cells)))
        theta1, (arc, wall) = float(enclosed()[0].mid()), (float(end.mid()) for end in corner_parameters())
        middle, half = (boxes.x[0] + boxes.x[1]) / 2, (boxes.x[1] - boxes.x[0]) / 2 * (1 + 1e-9) + 1e-12
        place = np.zeros(chosen.size, dtype=np.int64)  # in the orbit's order: left, upper corner, right, lower corner
        for turn, sign in ((1, 1), (3, -1)):
            on_arc = (boxes.chart == ARC) & (sign * middle - half >= arc + V_LOW)
            on_wall = (boxes.chart == WALL) & (sign * middle + half <= wall + V_HIGH)
            place[on_arc | on_wall] = turn
            place[(boxes.chart == ARC) & (np.abs(middle - sign * theta1) + half <= U_END)] = turn + 1
        inner = graph.edges[:-1, :-1][chosen][:, chosen].tocoo()
        names = graph.components[chosen]
        within = names[inner.row] == names[inner.col]
        astray = within & (place[inner.col] != place[inner.row] % 4 + 1)
        off = np.isin(names, [*names[place == 0], *names[inner.row[astray]]])
        found[chosen[~off]] = True
        return found & ~np.isin(graph.components, graph.components[np.append(~graph.leaf, True)])

    @cached_property
    def staying(self) -> Mask:
        """The vertices on closed walks that are not next to the corner orbit."""
        return self.graph.recurrent & ~self.beside

    @hypothesis
    def leaving(self) -> bool:
        """No orbit stays next to the corner orbit."""
        if not self.beside.any():
            return True
        with working(BITS):
            return bool(self.depth > 0) and inner(hulls(self.depth), self.depth)


@dataclass(frozen=True)
class AlmostEveryOrbitBelowLambdaStar(Theorem):
    """Almost every orbit converges to the horizontal one, for `0 < lam < lambda*`; proved for consecutive ranges."""

    ranges: tuple[AlmostEveryOrbit, ...]

    @hypothesis
    def joined(self) -> bool:
        """The ranges cover 0 to a contraction above `lambda*`."""
        ends = [Fraction(0), *(end for one in self.ranges for end in one.lam)]
        gapless = all(a == b for a, b in zip(ends[::2], ends[1::2], strict=False))
        return gapless and bool(enclosed()[1] < fraction_ball(ends[-1]))

    @hypothesis
    def each(self) -> bool:
        """For `lam` in each of the ranges, almost every orbit of the cuspless table converges to the horizontal one."""
        return all(one.scene == Scene("cuspless") and one.cycles == (HORIZONTAL,) and one.proved for one in self.ranges)


def _leaving(theta: arb) -> arb:
    """The exit angle, at the upper join, of the chord from there to the point `theta` of the arc."""
    here, there = corner_parameters()[ARC], theta
    return angle(BoundaryPoint(ARC, constant(here, ())), BoundaryPoint(ARC, constant(there, ())))[0]


def _end(depth: arb) -> float:
    """A double above `depth`, since rounding to nearest could omit contractions next to `NEXT`."""
    return float(depth.upper()) * (1 + 2.0**-40)


def hulls(depth: arb) -> dict[int, Hull]:
    """The derivatives of the half return `(U1, V1)` by `U`, `V` and `-e` over inner states, on each side of `V = 0`."""
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
    """True if the module docstring's inequalities for inner states hold; they use derivatives by `abs(V)`."""
    steps = []
    for component, sign in ((ARC, -1), (WALL, 1)):
        (a, b, c), (f, g, h) = hull[component]
        b, g, c, h = sign * b, sign * g, -c, -h  # derivatives by abs(V) and e
        steps += [
            *(x > 0 for x in (a, b, c, f, g, h)),
            b > K * a and c > K * a,  # U1 >= 0, also for negative U
            g > K * f and h > K * f,  # V1 > 0
            a * U_END + b * max(-V_LOW, V_HIGH) + c * depth < U_END,
            f * U_END + g * max(-V_LOW, V_HIGH) + h * depth < FAR,
            b < LEAN * (g - K * f) and c < LEAN * (h - K * f) and a * U_END < THICK,
        ]
    return all(bool(step) for step in steps) and bool(hull[WALL][1][1] > 1)


def first_hull(depth: arb) -> list[arb]:
    """The derivatives of `V1` by `U` and `-e` for orbits from the upper join that land on the arc at `theta1 - U`."""
    theta1, star = enclosed()
    found = []
    for e in cuts(-_end(depth), 0.0, SIDES[2]):
        for u in cuts(-BESIDE, BESIDE, SIDES[1]):
            spread = u - arb(u.mid()), e - arb(e.mid())
            at, lam = parameter(arb(u.mid()), 0, spread), parameter(star + e.mid(), 1, spread)
            middle = Quantity(theta1 - at.centre, tuple(-s for s in at.slopes), theta1 - at.whole)
            join = BoundaryPoint(ARC, constant(corner_parameters()[ARC], spread))
            landings = after_corner(join, BoundaryPoint(ARC, middle), False, lam, spread)
            found += [beyond(landing, False).slopes for landing in landings]
    return [joined([slopes[i] for slopes in found]) for i in (0, 1)]


def begins(hull: list[arb], depth: arb) -> bool:
    """True if each state `(U, V1)` with `abs(U) <= BESIDE` is proved to be an inner state or an exit."""
    r, c = hull[0], -hull[1]
    steps = [
        r > 0 and c > 0,
        K * r > c and K * r > 1,
        r * BESIDE < -V_LOW and BESIDE < U_END,
        r * BESIDE + c * depth < FAR,
        r * LEAN > 1 and c * depth < V_HIGH,  # where V1 > V_HIGH: 0 < U < LEAN*V1
    ]
    return all(bool(step) for step in steps)
