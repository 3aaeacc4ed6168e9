"""The proof that a list of cycles of a short period is complete: every other closed chain of chords is excluded.

Around each known cycle Krawczyk's operator proves a neighbourhood without a second one. All other chains are covered by
boxes in the first bounce and the gaps (differences of `theta`) between bounces. A box is excluded if one collision
rule, or one linear combination of the rules, is proved not 0 in it, by enclosure or by the mean value theorem; the
combinations are the rows of the inverse of the derivative at the midpoint, as in Krawczyk's operator. Other boxes are
halved.

On a convex table the chord's angle decreases as its end moves on, so gaps are excluded at which the angle exceeds every
exit angle of the law: `lam*pi/2` for the paper's law, a bound of `|phi|` over all incidence angles and places for
others. A law that depends on `theta` must have the period `2*pi`, and rotated copies of its cycles are not cycles in
general. A law in terms of arc length, if that is an integral, jumps where the parameter closes; in a box that may reach
the jump, the rules on both sides must be excluded by enclosure.

A boundary of several components that join with one tangent has one parameter for all (`BoundaryChart`). For a box that
reaches over a join the hull of values and slopes on both sides is taken: the rules are continuous there, so the mean
value theorem holds with this hull (`verification.maps.one_sided`).
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import product
from math import pi
from typing import Any

import numpy as np
from flint import arb
from sympy import Expr, S

from symbolic.expressions.text import kernel, load
from symbolic.motion.chords import chord_kernel, law_kernel
from symbolic.tables.curves import curves, is_periodic
from symbolic.tables.joins import contacts
from symbolic.tables.law import Law
from symbolic.tables.table import Component, Table
from symbolic.tables.table import theta as letter
from verification.arithmetic.arrays import Array, BallArray, Mask, WideOps, hull, spread
from verification.arithmetic.balls import FLOAT64, real_ball, working
from verification.cycles.problem import Problem
from verification.cycles.search import Catalogue
from verification.cycles.systems import rotations
from verification.maps.first_hit import closes_smoothly, convex
from verification.maps.joins import joins
from verification.maps.measured import Lengths, arc_length
from verification.proofs.periodic.interval_newton import ZeroStatus, krawczyk
from verification.rigorous.exclusion import Cuboids, exclude

WIDE = WideOps()
BITS = 64
SMALLEST = 2.0**-30
CLOSE, ALIKE = 1e-9, 1e-8  # distances, below any radius: a cycle to its digits; a rotated cycle to a known one
CUTS = 2.0**20  # parts of a unit of the common parameter of several components
ANGLES = 512  # pieces of the incidence angles
BINARY = 2.0**44  # midpoints are multiples of 1/BINARY below 256, so that their sums are exact
Tick = Callable[[str], None]
Reflection = Callable[[BallArray, BallArray], list[tuple[BallArray, BallArray, BallArray]]]


@dataclass(frozen=True)
class Completeness:
    """Result: `complete` is True if the `known` cycles are proved to be all of this period, None if undecided."""

    period: int
    complete: bool | None
    boxes: int
    known: int


def proofs(
    catalogue: Catalogue, lam: Expr, highest: int, budget: int, tick: Tick = lambda said: None
) -> Iterator[Completeness]:
    """The completeness results for the periods from 2 up to `highest`, until one of them stays undecided."""
    for n in range(2, highest + 1):
        found = no_others(catalogue, lam, n, budget, tick)
        yield found
        if found.complete is not True:
            return


def no_others(
    catalogue: Catalogue, lam: Expr, n: int, budget: int = 40_000, tick: Tick = lambda said: None
) -> Completeness:
    """The proof that the catalogue is complete for period `n`, on a convex table of one smooth component.

    Chains are taken modulo the table's rotations if the catalogue has all rotated copies of its cycles.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from verification.cycles.search import all_cycles
    >>> found = all_cycles(ellipse.at(a="3/2"), Rational(1, 4), 2).catalogue
    >>> no_others(found, Rational(1, 4), 2).complete
    True
    """
    if n < 1:
        raise ValueError(f"no_others: n = {n}; accepted: 1 or more")
    table, known = catalogue.table, catalogue.count(n)
    law = catalogue.law.on(table)
    if (
        not one_smooth_curve(table, law)
        or convex(table) is not True
        or (law.placed and not (law.measured or is_periodic(law.phi)))
    ):
        return Completeness(n, None, 0, known)
    cover = Cover.of(table, law, lam)
    if cover.gap == 0:
        return Completeness(n, None, 0, known)
    with working(BITS):
        problem = Problem(table, (0,) * n, lam=real_ball(lam), law=law)
        neighbourhoods = uniqueness_boxes(catalogue, problem, cover.chart)
    boxes, turned = 0, 1 if law.placed or cover.chart else rotations(table)
    if turned > 1 and not turned_copies(neighbourhoods, problem, 2 * pi / turned):
        turned = 1
    for turns in range(1, n):

        def empty(chunk: Cuboids, turns: int = turns) -> Mask:
            return cover.empty(chunk, turns, neighbourhoods)

        found = exclude(
            start(turned, n, cover.gap),
            empty,
            budget - boxes,
            SMALLEST,
            lambda tested, before=boxes: tick(f"{before + tested} boxes"),  # type: ignore[misc]
        )
        boxes += found.boxes
        if not found.proved:
            return Completeness(n, None, boxes, known)
    return Completeness(n, True, boxes, known)


def one_smooth_curve(table: Table, law: Law) -> bool:
    """True if the boundary is one closed curve that has a tangent everywhere and no straight component.

    With several components, the law must also be independent of the place. A single one must have the period 2*pi, as
    its chords are taken on its formula beyond its ends.
    """
    joined = (
        len(table.components) > 1 and len(curves(table)) == 1 and not (table.shapes or law.placed or table.undefined)
    )
    bent = all(any(x.diff(letter, 2) != 0 for x in part.point) for part in table.components)
    return closes_smoothly(table) or (joined and bent and all(contact.smooth for contact in contacts(table)))


@dataclass(frozen=True)
class BoundaryChart:
    """A closed curve of several components with one parameter `t` from 0 to `2*pi`, roughly proportional to arc length.

    On each component `theta = start + (t - low)*scale` for `t` from `low` to `high`.
    """

    table: Table
    low: list[BallArray]
    high: list[BallArray]
    start: list[BallArray]
    scale: list[BallArray]

    @classmethod
    def of(cls, table: Table) -> "BoundaryChart":
        """The chart of a table's boundary."""
        ends = [(enclosed(part.start), enclosed(part.end)) for part in table.components]
        shares = np.array([rough_length(part) for part in table.components])
        cuts = np.rint(2 * pi * np.cumsum(shares)[:-1] / np.sum(shares) * CUTS) / CUTS
        low, high = ([BallArray(cut) for cut in cuts] for _ in range(2))
        low, high = [BallArray(0.0), *low], [*high, WIDE.pi * 2]
        scale = [(end - start) / (b - a) for (start, end), a, b in zip(ends, low, high, strict=True)]
        return cls(table, low, high, [start for start, _ in ends], scale)

    @property
    def least(self) -> float:
        """The length of the shortest component in `t`."""
        return float(min(b.m - a.m for a, b in zip(self.low, self.high, strict=True)))

    def of_bounces(self, parts: Sequence[int], theta: Array) -> Array:
        """The values of `t` at bounces, in float64."""
        columns = (np.array([float(ball[part].m) for part in parts]) for ball in (self.low, self.start, self.scale))
        low, start, scale = columns
        return np.asarray(low + (theta - start) / scale)

    def radii(self, parts: Sequence[int], radius: float) -> list[float]:
        """For each bounce a radius in its component's parameter that covers `radius` in `t`, also beyond a join."""
        known, found = joins(self.table), []
        for part in parts:
            beside = [self.scale[known.beyond[part, k]].m / known.ratio[part, k] for k in (0, 1)]
            found.append(float(radius * max(self.scale[part].m, *beside) * (1 + CLOSE)))
        return found

    def places(self, t: BallArray) -> Iterator[tuple[int, Mask, BallArray]]:
        """For each component, a mask of the balls of `t` that meet it, and the balls of its own parameter."""
        turn = WIDE.pi * 2
        t = t - turn * np.floor(t.m / turn.m)
        for shift, part in product((-1, 0, 1), range(len(self.scale))):
            low, high = self.low[part] + turn * shift, self.high[part] + turn * shift
            meets = ~((t - high).positive() | (low - t).positive())
            own = hull(np.maximum(t.lower(), low.lower()), np.minimum(t.upper(), high.upper()))
            yield part, meets, self.start[part] + (own - low) * self.scale[part]

    def angle(self, here: BallArray, there: BallArray) -> list[BallArray]:
        """The angle of a chord and its slopes by both parameters, as hulls over the components the ends may lie on."""
        both = np.broadcast(np.atleast_1d(here.m), here.r, there.m, there.r)
        here, there = (spread(x, np.empty(both.shape)) for x in (here, there))
        low, high = np.full((3, *both.shape), np.inf), np.full((3, *both.shape), -np.inf)
        ends = list(self.places(there))
        for (i, one, u), (j, other, v) in product(self.places(here), ends):
            if not np.any(on := one & other):
                continue
            values = load(chord_kernel(self.table, i, j, 1), WIDE)(u[on], v[on])
            for k, (value, slope) in enumerate(zip(values, (1.0, self.scale[i], self.scale[j]), strict=True)):
                found = spread(value * slope, u[on].m)
                low[k][on], high[k][on] = np.minimum(low[k][on], found.lower()), np.maximum(high[k][on], found.upper())
        wide = (here.r > pi) | (there.r > pi) | ~np.all(low <= high, axis=0)
        return [hull(np.where(wide, -np.inf, a), np.where(wide, np.inf, b)) for a, b in zip(low, high, strict=True)]


def rough_length(part: Component) -> float:
    """The approximate length of a component, by a polygon."""
    x, y = part.point
    point = load(kernel("point", [letter], {"x": x, "y": y}), FLOAT64)
    rows = np.array([point(float(at)) for at in np.linspace(float(part.start), float(part.end), 33)])
    return float(np.sum(np.hypot(*np.diff(rows, axis=0).T)))


def start(turn: int, n: int, gap: float) -> Cuboids:
    """One box that holds all chains: the first bounce modulo rotations by `2*pi/turn`, and gaps of at least `gap`."""
    reach, middle = np.ceil(2**10 * pi / turn) / 2**10, 3.125
    half = np.ceil(2**10 * (2 * pi - gap - middle)) / 2**10
    return Cuboids(np.array([[0.0] + [middle] * (n - 1)]), np.array([[reach] + [half] * (n - 1)]))


def reflection(law: Law, contraction: BallArray, table: Table) -> Reflection:
    """A function from balls of `eta` and `theta` to a list of `(phi, -d phi/d eta, d phi/d theta)`.

    The list has one entry; if the law contains arc length, which jumps at one place, it has one for each side of the
    jump.
    """
    if law.uniform:
        return lambda eta, theta: [(-contraction * eta, contraction, BallArray(0.0))]
    made = law_kernel(law, 1, table.components[0] if law.measured else None)
    places = [made.results.index(name) for name in ("phi", "phi_eta", "phi_theta")]
    phi, length = load(made, WIDE), arc_length(table) if law.measured else None

    def reflected(eta: BallArray, theta: BallArray) -> list[tuple[BallArray, BallArray, BallArray]]:
        sides = [[side, measure(length, side)] for side in parted(theta)] if length else [[theta]]
        found = [[spread(phi(eta, contraction, *side)[i], eta.m) for i in places] for side in sides]
        return [(value, -slope, drift) for value, slope, drift in found]

    return reflected


def measure(length: Lengths, theta: BallArray) -> BallArray:
    """The arc lengths at balls of parameters."""
    with working(BITS):
        found = [length.of(arb(m, r)) for m, r in np.broadcast(np.atleast_1d(theta.m), theta.r)]
        return ball_array(found)


def ball_array(found: Sequence[arb]) -> BallArray:
    """An array of float64 balls that hold the given balls."""
    m = np.array([float(x.mid()) for x in found])
    far = [float((x - arb(at)).abs_upper()) for x, at in zip(found, m, strict=True)]
    return BallArray(m, np.nextafter(np.array(far), np.inf))


def one_sided(theta: BallArray) -> Mask:
    """A mask of the balls proved to lie in `(-pi, pi)`, where arc length does not jump."""
    found: Mask = (theta + WIDE.pi).positive() & (WIDE.pi - theta).positive()
    return found


def parted(theta: BallArray) -> list[BallArray]:
    """Balls of parameters with midpoints reduced to `[-pi, pi]`; and a copy, in which those that may pass an end are
    shifted by a full turn.

    >>> [x.m.round(2).tolist() for x in parted(BallArray(np.array([0.0, 3.0, 3.1, 6.3]), 0.1))]
    [[0.0, 3.0, 3.1, 0.02], [0.0, 3.0, -3.18, 0.02]]
    """
    turn = WIDE.pi * 2
    theta = theta - turn * np.rint(theta.m / turn.m)
    inside, beyond = one_sided(theta), theta - turn * np.sign(theta.m)
    return [theta, BallArray(np.where(inside, theta.m, beyond.m), np.where(inside, theta.r, beyond.r))]


def steepest(law: Law, reflected: Reflection) -> float:
    """A bound of `|phi|` over all incidence angles and all places of a closed curve."""
    turns = 64 if law.placed else 1
    eta, theta = (x.ravel() for x in np.meshgrid(*(2.0 * np.arange(n) + 1 - n for n in (ANGLES, turns))))
    angles = BallArray(eta, 1.0) / ANGLES * WIDE.pi / 2
    places = BallArray(theta, 1.0) / turns * WIDE.pi
    largest = max(float(np.max(exits.magnitude())) for exits, _, _ in reflected(angles, places))
    return largest if largest < np.inf else float(np.nextafter(pi / 2, 2))


def stays_below(law: Law, lam: Any, table: Table) -> bool:
    """True if `|phi|` is proved to stay below `pi/2` by a margin."""
    return steepest(law, reflection(law, enclosed(S(lam)), table)) < pi / 2


def enclosed(lam: Expr) -> BallArray:
    """A float64 ball that holds an exact number."""
    with working(BITS):
        found = ball_array([real_ball(lam)])
    return BallArray(found.m[0], found.r[0])


def least_gap(angle: Any, largest: float) -> float:
    """A gap up to which every chord, in either direction, has an angle greater than `largest`; 0 if none is found."""
    pieces, gap = 256, 1.5
    starts = BallArray(2.0 * np.arange(pieces) + 1, 1.0) * WIDE.pi / pieces
    while gap > 0:
        ahead, back = (angle(starts, starts + side)[0] for side in (gap, -gap))
        if np.all((ahead - largest).positive() & (back + largest).negative()):
            return gap
        gap -= 1 / 16
    return 0.0


def uniqueness_boxes(
    catalogue: Catalogue, problem: Problem, chart: BoundaryChart | None = None
) -> list[tuple[Array, float]]:
    """Centres and radii of boxes that hold exactly one cycle each, one box for each choice of first bounce."""
    n, found = problem.period, []
    for cycle in catalogue.of(n):
        own, parts = np.tile(cycle.theta, n // cycle.period), cycle.components * (n // cycle.period)
        theta = np.unwrap(chart.of_bounces(parts, own) if chart else own)
        problem = replace(problem, components=parts)
        centre, radius = [arb(float(x)) for x in (own if chart else theta)], min(0.2, chart.least / 2 if chart else 1)
        while radius > 1e-7:
            smooth = not problem.law.measured or np.all(one_sided(parted(BallArray(theta, radius))[0]))
            radii = chart.radii(parts, radius) if chart else [radius] * n
            if smooth and krawczyk(problem, centre, radii, BITS).status is ZeroStatus.UNIQUE:
                found += [(np.roll(theta, -k), radius) for k in range(cycle.period)]
                break
            radius /= 1.5
    return found


def turned_copies(known: Sequence[tuple[Array, float]], problem: Problem, angle: float) -> bool:
    """True if each known cycle, rotated by an angle, is proved to be a known cycle.

    A cycle lies within `CLOSE` of its digits, and the rotated digits within `ALIKE` of those of another cycle, hence in
    the box of that cycle.
    """
    places = np.array([theta for theta, _ in known]).reshape(-1, problem.period)
    for theta in places:
        away = np.abs((places - theta - angle + pi) % (2 * pi) - pi)
        if not np.any(np.all(away < ALIKE, axis=1)):
            return False
        centre = [arb(float(x)) for x in theta]
        if krawczyk(problem, centre, [CLOSE] * problem.period, BITS).status is not ZeroStatus.UNIQUE:
            return False
    return True


@dataclass(frozen=True)
class Cover:
    """The functions and bounds that exclude boxes of chains: chord angle, law, and least gap between bounces."""

    angle: Any
    reflected: Reflection
    gap: float
    law: Law
    chart: BoundaryChart | None = None  # of a boundary of several components

    @classmethod
    def of(cls, table: Table, law: Law, lam: Expr) -> "Cover":
        """The cover for a table, a law and a contraction."""
        chart, contraction = BoundaryChart.of(table) if len(table.components) > 1 else None, enclosed(lam)
        angle = chart.angle if chart else load(chord_kernel(table, 0, 0, 1), WIDE)
        reflected = reflection(law, contraction, table)
        largest = (contraction * WIDE.pi / 2).upper() if law.uniform else steepest(law, reflected)
        with np.errstate(all="ignore"):
            return cls(angle, reflected, least_gap(angle, float(largest)), law, chart)

    def empty(self, boxes: Cuboids, turns: int, known: Sequence[tuple[Array, float]] = ()) -> Mask:
        """A mask of boxes in a box of `known`, or without a cycle of `turns` turns whose first gap is the largest."""
        n = boxes.middle.shape[1]
        wide = [BallArray(boxes.middle[:, k], boxes.half[:, k]) for k in range(n)]
        last = 2 * turns * WIDE.pi - total(wide[1:])
        gone = (last - self.gap).negative() | (last - 2 * WIDE.pi + self.gap).positive()
        for gap in (*wide[2:], last):
            gone |= (gap - wide[1]).positive()  # the first gap may be assumed the largest
        middle = np.cumsum(boxes.middle, axis=1)
        exact = np.all(np.abs(middle) < 256, axis=1) & np.all(boxes.middle * BINARY % 1 == 0, axis=1)
        reach = np.cumsum(boxes.half, axis=1) * (1 + 2.0**-40)
        for centre, radius in known:
            gone |= exact & np.all(np.abs((middle - centre + pi) % (2 * pi) - pi) + reach < radius - 1e-9, axis=1)
        at = np.flatnonzero(exact & ~gone)
        with np.errstate(all="ignore"):
            gone[at] = self._impossible(boxes[at], middle[at], reach[at])
        return gone

    def _impossible(self, boxes: Cuboids, middle: Array, reach: Array) -> Mask:
        """A mask of the boxes where one of the rules or of their linear combinations is proved not 0."""
        n, size = boxes.middle.shape[1], boxes.size
        places = middle.T.ravel()  # of all bounces in one array, so that each function is called once
        centre, theta = BallArray(places), BallArray(places, reach.T.ravel())

        def shifted(x: BallArray, by: int) -> BallArray:
            return BallArray(*(np.roll(np.broadcast_to(part, places.shape), -by * size) for part in (x.m, x.r)))

        def at_bounces(x: BallArray) -> list[BallArray]:
            whole = spread(x, places)
            return [whole[k * size : (k + 1) * size] for k in range(n)]

        out, into = self.angle(theta, shifted(theta, 1)), self.angle(theta, shifted(theta, -1))
        sides = self.reflected(into[0], theta)
        refuted = np.all([apart(out[0] - exits) for exits, _, _ in sides], axis=0)
        gone: Mask = np.any(refuted.reshape(n, size), axis=0)
        smooth: Mask = np.ones(size, dtype=bool)
        if len(sides) > 1:
            smooth = np.all(one_sided(parted(theta)[0]).reshape(n, size), axis=0)
        _, sigma, drift = sides[0]
        back = self.angle(centre, shifted(centre, -1))[0]
        values = at_bounces(self.angle(centre, shifted(centre, 1))[0] - self.reflected(back, centre)[0][0])
        slopes = (at_bounces(x) for x in (sigma * into[2], out[1] + sigma * into[1] - drift, out[2]))
        rules = []  # values at the midpoint, and derivatives by the first bounce and the gaps
        for i, (value, *near) in enumerate(zip(values, *slopes, strict=True)):
            slope = [BallArray(np.zeros(size))] * n
            for j, s in zip((i - 1, i, i + 1), near, strict=True):
                slope[j % n] = slope[j % n] + s
            rules.append([value, *(total(slope[k:]) for k in range(n))])
        for weights in inverses([rule[1:] for rule in rules]):
            rules.append(
                [
                    total(BallArray(w) * x for w, x in zip(weights, column, strict=True))
                    for column in zip(*rules[:n], strict=True)
                ]
            )
        for value, *slope in rules:
            gone |= smooth & apart(
                total([value, *(s * BallArray(0.0, h) for s, h in zip(slope, boxes.half.T, strict=True))])
            )
        return gone


def total(terms: Iterable[BallArray]) -> BallArray:
    """The sum of the terms."""
    return reduce(BallArray.__add__, terms)


def apart(x: BallArray) -> Mask:
    """A mask of the balls that do not contain 0."""
    return x.positive() | x.negative()


def inverses(slopes: list[list[BallArray]]) -> Array:
    """The approximate inverses, by rows, of the midpoints of matrices of balls; 0 for a singular matrix."""
    matrix = np.array([[s.m for s in row] for row in slopes]).transpose(2, 0, 1)
    good = np.all(np.isfinite(matrix), axis=(1, 2))
    good[good] = np.linalg.det(matrix[good]) != 0
    found = np.zeros_like(matrix)
    found[good] = np.linalg.inv(matrix[good])
    return found.transpose(1, 2, 0)
