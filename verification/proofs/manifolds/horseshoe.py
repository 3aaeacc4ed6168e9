"""Horseshoes: from a transversal homoclinic point, sets that cover one another, and a lower bound of the entropy.

A point of the plane is two neighbouring bounces, the one before and the one here. An h-set is a parallelogram with an
expanded and a contracted side. One h-set covers another when its image crosses that from one end of the expanded
direction to the other and keeps off its contracted ends. Around every closed walk of coverings there is then a
periodic point, and along every walk an orbit [ZgliczynskiGidea2004].

The h-sets here are one for each bounce of a saddle's cycle, and one for each bounce of a homoclinic orbit from where it
leaves the first of these to where it is back in it. So two loops begin and end at one h-set, and may follow each other
in any order. The h-sets with which they begin have no common point, so different orders are different orbits, and
the entropy is at least the `h` with `exp(-h*p) + exp(-h*n) = 1`, for loops of `p` and `n` bounces. Cone conditions
make all these orbits hyperbolic, and each the only one with its order of loops.

With the symmetries of the table a loop ends at an image of the first h-set. A symmetry commutes with the map, and the
entropy modulo finitely many of them is that of the map.

The h-sets come from float64. That they cover is proved in balls, for a ball of parameters, by the mean-value theorem:
the next bounce is the zero of the rule, enclosed by an interval Newton step.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from flint import arb

from verification.arithmetic.balls import FLOAT64, balls, working
from verification.proofs.manifolds.grow import carried, gaps
from verification.proofs.manifolds.plane_map import PlaneMap
from verification.proofs.manifolds.proof import smooth
from verification.proofs.manifolds.saddle import Local, Orbit, Saddle, local, saddle
from verification.proofs.manifolds.tangency import Contact, Gap, rounds
from verification.proofs.manifolds.touching import flight

BITS = 100
NEWTON, SMALL = 6, 1e-11
EARLY, LATE = 16, 6  # rounds that are added near the saddle, where the orbit leaves it and comes back
SHORTEST = 4  # homoclinic orbits that are tried
TRIED = 400
BENT = 0.3  # square of the expanded side of the first h-set over the contracted one, at most
ADVICE = "accepted: a saddle whose manifolds cross, and a small radius"
CHECKS = ("admissible", "covering", "disjoint", "cones")
Vector = tuple[float, float]
Matrix = tuple[arb, arb, arb, arb]


@dataclass(frozen=True)
class HSet:
    """`centre + x*expanded + y*contracted`, `-1 <= x, y <= 1`; a point is the bounce before and the one here."""

    centre: Vector
    expanded: Vector
    contracted: Vector


@dataclass(frozen=True)
class Edge:
    """A covering to be proved: of h-set `target` turned `turns[0]`, `turns[1]` parts and, `sign = -1`, mirrored."""

    source: int
    target: int
    sign: int = 1
    turns: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Horseshoe:
    """H-sets of a saddle of `period` bounces (first) and of a homoclinic orbit, for parameters `middle +- radius`."""

    map: PlaneMap
    middle: float
    radius: float
    period: int
    sets: tuple[HSet, ...]
    edges: tuple[Edge, ...]

    @property
    def loops(self) -> tuple[int, int]:
        """The bounces of the two loops."""
        return self.period, len(self.sets) - self.period + 1

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        with working(BITS):
            map, parameter = self.map.over(balls(BITS)), arb(self.middle, self.radius)
            found = []
            for edge in self.edges:
                found.append(self._covering(map, parameter, edge))
                if not found[-1][0]:
                    break  # nothing follows from the rest
            round = next(edge for edge in self.edges if edge.source == 0 and edge.target == 1 % self.period)
            apart = _apart(self.sets[round.target], round, self.sets[self.period], map)
        covering = self._two_loops and all(covers for covers, _ in found)
        return {
            "admissible": smooth(self.map),
            "covering": covering or None,
            "disjoint": apart or None,
            "cones": (covering and all(cones for _, cones in found)) or None,
        }

    @property
    def proved(self) -> bool:
        """Is there a horseshoe, for each of the parameters?"""
        return all(value is True for value in self.checks.values())

    @property
    def entropy(self) -> float:
        """A lower bound for the topological entropy of the map, per bounce; 0 where nothing is proved.

        >>> from sympy import Rational
        >>> from verification.proofs.manifolds.plane_map import Henon
        >>> horseshoe(Orbit("fixed point", (0.63,)), Henon(Rational(3, 10)), 1.4, 1e-6).entropy > 0.1
        True
        """
        return _entropy(self.loops) if self.proved else 0.0

    @property
    def _two_loops(self) -> bool:
        """Do the edges make the two loops, and nothing else?"""
        p, n = self.period, len(self.sets)
        wanted = [(i, (i + 1) % p) for i in range(p)] + [(0, p)] + [(i, i + 1) for i in range(p, n - 1)] + [(n - 1, 0)]
        return sorted((edge.source, edge.target) for edge in self.edges) == sorted(wanted)

    def _covering(self, map: PlaneMap, parameter: arb, edge: Edge) -> tuple[bool, bool]:
        """Is one covering proved, and is its cone condition?"""
        found = _image(map, parameter, self.sets[edge.source], self.middle)
        if found is None:
            return False, False
        start, slopes = found
        target = self.sets[edge.target]
        inverse, centre = _frame(target, edge, map)
        off = _times(inverse, start[0] - centre[0], start[1] - centre[1])
        source = self.sets[edge.source]
        sides = [_moved(slopes, arb(v[0]), arb(v[1])) for v in (source.expanded, source.contracted)]
        (a, c), (b, d) = (_times(inverse, *side) for side in sides)
        return _crosses(off, (a, b, c, d)), _expands((a, b, c, d))


def _image(
    map: PlaneMap, parameter: arb, source: HSet, middle: float
) -> tuple[tuple[arb, arb], tuple[arb, arb]] | None:
    """The image of the centre, and how the next bounce depends on the two, over all of the h-set; None: not proved."""
    before, here = source.centre
    radii = [abs(u) + abs(s) for u, s in zip(source.expanded, source.contracted, strict=True)]
    guess = float(map.over(FLOAT64).following(before, here, middle))
    centre = [arb(before), arb(here), arb(guess)]
    moves = [arb(0, r) for r in radii]
    value = map.rule(centre, parameter)
    wide = _roughly(value, map.slopes(centre, parameter), radii)
    s = map.slopes([centre[0] + moves[0], centre[1] + moves[1], centre[2] + wide], parameter)
    if s[2].contains(0):
        return None
    step = -(value + s[0] * moves[0] + s[1] * moves[1]) / s[2]
    if not abs(step) < wide.abs_upper():
        return None
    return (centre[1], centre[2] - value / s[2]), (-s[0] / s[2], -s[1] / s[2])


def _roughly(value: arb, slopes: tuple[arb, arb, arb], radii: Sequence[float]) -> arb:
    """How far the next bounce may be from a guess, not proved: twice what the slopes at the centre of an h-set say."""
    moved = abs(value / slopes[2]) + abs(slopes[0] / slopes[2]) * radii[0] + abs(slopes[1] / slopes[2]) * radii[1]
    return arb(0, (2 * moved + arb(2) ** -80).abs_upper())


def _moved(slopes: tuple[arb, arb], before: arb, here: arb) -> tuple[arb, arb]:
    return here, slopes[0] * before + slopes[1] * here


def _frame(target: HSet, edge: Edge, map: PlaneMap) -> tuple[Matrix, tuple[arb, arb]]:
    """The matrix that gives coordinates in an h-set after a symmetry, and its centre."""
    (a, c), (b, d) = target.expanded, target.contracted
    sides = [edge.sign * arb(x) for x in (a, b, c, d)]
    unit = 2 * map.words.pi / map.turn if map.turn else arb(0)
    centre = tuple(edge.sign * arb(x) + k * unit for x, k in zip(target.centre, edge.turns, strict=True))
    det = sides[0] * sides[3] - sides[1] * sides[2]
    return (sides[3] / det, -sides[1] / det, -sides[2] / det, sides[0] / det), (centre[0], centre[1])


def _times(m: Matrix, x: arb, y: arb) -> tuple[arb, arb]:
    return m[0] * x + m[1] * y, m[2] * x + m[3] * y


def _crosses(off: tuple[arb, arb], m: Matrix) -> bool:
    """Do the ends of the expanded side leave on different sides, and does nothing reach the contracted ends?"""
    a, b, c, d = m
    slack = 1 + abs(b) + abs(off[0])
    return bool(abs(a) > slack and abs(off[1]) + abs(c) + abs(d) < 1)


def _expands(m: Matrix) -> bool:
    """Does `x**2 - y**2` grow between any two points: is `D'QD - Q` positive definite for each `D` in the matrix?"""
    a, b, c, d = m
    first, mixed, last = a * a - c * c - 1, a * b - c * d, b * b - d * d + 1
    return bool(first > 0 and first * last - mixed * mixed > 0)


def _apart(first: HSet, edge: Edge, other: HSet, map: PlaneMap) -> bool:
    """Have an h-set after a symmetry and another no common point? The latter lies beyond an end of the expanded side.

    Both are so small that on angles, too, they do not meet a turn further.
    """
    inverse, centre = _frame(first, edge, map)
    between = [arb(x) - y for x, y in zip(other.centre, centre, strict=True)]
    reach = sum((abs(_times(inverse, arb(v[0]), arb(v[1]))[0]) for v in (other.expanded, other.contracted)), arb(1))
    spread = [sum(abs(v[i]) for h in (first, other) for v in (h.expanded, h.contracted)) for i in (0, 1)]
    small = all(abs(x) + y < 6 for x, y in zip(between, spread, strict=True))
    return bool(abs(_times(inverse, *between)[0]) > reach) and (small or not map.turn)


def _entropy(loops: Sequence[int]) -> float:
    """A number below the `h` with `sum(exp(-h*n)) = 1`.

    >>> round(_entropy((1, 1)), 9) == round(math.log(2), 9)
    True
    """
    low, high = 0.0, math.log(2) + 1e-9
    with working(BITS):
        while high - low > 1e-12:
            middle = (low + high) / 2
            enough = sum(((-arb(middle) * n).exp() for n in loops), arb(0)) >= 1
            low, high = (middle, high) if enough else (low, middle)
    return low


def horseshoe(orbit: Orbit, map: PlaneMap, parameter: float, radius: float, passes: int = 6) -> Horseshoe:
    """A horseshoe of a saddle at `parameter +- radius` with the shortest of the homoclinic orbits that serve.

    `passes` bounds the rounds for which the unstable manifold is followed. `ValueError` where none is proved.
    """
    contacts = []
    for contact in crossings(orbit, map, parameter, passes)[:SHORTEST]:
        with suppress(ValueError, ArithmeticError):
            contacts.append(polished(contact, map))
    tried = [
        (contact.bounces + (early + late) * len(orbit.start), k, early, late, contact)
        for k, contact in enumerate(contacts)
        for early in range(EARLY)
        for late in range(LATE)
    ]
    for _, _, early, late, contact in sorted(tried, key=lambda row: row[:4])[:TRIED]:
        try:
            found = built(contact, map, early, late, radius)
        except (ValueError, ArithmeticError):
            continue
        if found.proved:
            return found
    raise ValueError(f"horseshoe: none of the {orbit.name} was found at {parameter} +- {radius}; {ADVICE}")


def crossings(orbit: Orbit, map: PlaneMap, parameter: float, passes: int) -> list[Contact]:
    """Homoclinic points along both branches of the unstable manifold, those of the shortest orbits first.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> len(crossings(Orbit("fixed point", (0.63,)), Henon(Rational(3, 10)), 0.5, 3))
    0
    """
    at = saddle(orbit, map.over(FLOAT64), parameter)
    out, into = local(at, True), local(at, False)
    found: list[tuple[int, Contact]] = []
    for z, count, here, following in carried(out, map, parameter, passes * len(orbit.start)):
        if count % len(orbit.start):
            continue
        sign = orbit.closure.turn ** (count // len(orbit.start))
        gap, end = gaps(into, sign * here, sign * following)
        for i in np.nonzero(gap[:-1] * gap[1:] < 0)[0]:
            share = gap[i] / (gap[i] - gap[i + 1])
            places = [float(x[i] + share * (x[i + 1] - x[i])) for x in (z, end)]
            found.append(
                (count, Contact(orbit, orbit, count, sign, places[0] * out.unit, places[1] * into.unit, parameter))
            )
    return [contact for _, contact in sorted(found, key=lambda pair: pair[0])]


def polished(contact: Contact, map: PlaneMap) -> Contact:
    """The same homoclinic orbit, with the gap brought to 0."""
    gap = Gap(contact, map.over(FLOAT64), contact.parameter, 28, 1e-16)
    z = gap.start
    for _ in range(NEWTON):
        apart, end = gap.at(z)
        z -= apart.c[0] / apart.c[1]
    if not abs(apart.c[0] / apart.c[1]) < SMALL * abs(z):
        raise ValueError("horseshoe: the gap has no simple zero here")
    ends = float(z) * gap.scales[0], float(end.c[0]) * gap.scales[1]
    return Contact(contact.unstable, contact.stable, contact.bounces, contact.sign, *ends, contact.parameter)


def built(contact: Contact, map: PlaneMap, earlier: int, later: int, radius: float) -> Horseshoe:
    """The h-sets and edges along a homoclinic orbit, with so many more rounds near the saddle at either end."""
    floats = map.over(FLOAT64)
    at = saddle(contact.unstable, floats, contact.parameter)
    out, into = local(at, True, 28), local(at, False, 28)
    early = rounds(contact.z / out.unit, float(out.factor)) + earlier
    late = rounds(contact.end / into.unit, 1 / float(into.factor)) + later
    if not (contact.z / float(out.factor) ** early) ** 2 < BENT * abs(contact.end * float(into.factor) ** late):
        raise ValueError("horseshoe: the unstable manifold bends too much over the first h-set")
    flown = flight(contact, floats, out, into, early, late)
    p = len(at.points)
    points = [x.c[0] for x in flown.bounces[: len(flown.bounces) - 1]]  # ends where the first h-set is
    pairs = list(pairwise(points))
    u, s = (_sides(made, at) for made in (out, into))
    edge = _symmetry(at, pairs[-1], floats)
    first = abs(flown.z), abs(float(flown.w.c[0]))
    wide = first[0] * abs(at.unstable) ** (0.5 / p), 1.5 * first[1]
    ring = at.around()
    cycle = [
        HSet(
            (ring[j], ring[j + 1]),
            _scaled(u[j], wide[0] * abs(at.unstable) ** (-j / p)),
            _scaled(s[j], wide[1] * abs(at.stable) ** (-j / p)),
        )
        for j in range(p)
    ]
    chain = _chain(pairs, at, (u, s), edge.sign, wide, first)
    closure = at.orbit.closure
    parts = closure.shift[0] * map.turn // closure.shift[1] if map.turn else 0
    edges = [Edge(j, j + 1) for j in range(p - 1)] + [Edge(p - 1, 0, closure.turn, (parts, parts)), Edge(0, p)]
    edges += [Edge(j, j + 1) for j in range(p, p + len(chain) - 1)]
    last = Edge(p + len(chain) - 1, 0, edge.sign, edge.turns)
    return Horseshoe(map, contact.parameter, radius, p, (*cycle, *chain), (*edges, last))


def _sides(made: Local, at: Saddle) -> list[Vector]:
    """The eigenvector at each pair of bounces of the cycle, in the scale of the series."""
    first = [c[1] / made.unit for c in made.coefficients]
    before = at.orbit.closure.turn * first[-1] / made.factor
    return list(zip([before, *first], first, strict=False))


def _scaled(v: Vector, by: float) -> Vector:
    return v[0] * by, v[1] * by


def _symmetry(at: Saddle, end: Vector, map: PlaneMap) -> Edge:
    """The symmetry that takes the cycle's first pair next to the last pair of the homoclinic orbit."""
    x = at.around()[:2]
    if not map.turn:
        return Edge(0, 0)
    unit = 2 * math.pi / map.turn
    tried = []
    for sign in (1, -1):
        turns = [round((y - sign * c) / unit) for y, c in zip(end, x, strict=True)]
        off = max(abs(y - sign * c - k * unit) for y, c, k in zip(end, x, turns, strict=True))
        if (turns[0] - turns[1]) % map.turn == 0:
            tried.append((off, Edge(0, 0, sign, (turns[0], turns[1]))))
    if not tried:
        raise ValueError("horseshoe: the orbit does not end near an image of the saddle")
    return min(tried, key=lambda pair: pair[0])[1]


def _chain(
    pairs: Sequence[Vector],
    at: Saddle,
    sides: tuple[list[Vector], list[Vector]],
    sign: int,
    wide: Vector,
    first: Vector,
) -> list[HSet]:
    """The h-sets of the homoclinic orbit: sides along both manifolds, growth beyond need shared out evenly."""
    (u, s), map, p, m = sides, at.map, len(at.points), len(pairs) - 1
    slopes = [map.slopes([*pairs[k], pairs[k + 1][1]], at.parameter) for k in range(m)]
    out, into = [u[0]], [_scaled(s[0], sign)]
    for r in slopes:
        out.append((out[-1][1], -(r[0] * out[-1][0] + r[1] * out[-1][1]) / r[2]))
    for r in reversed(slopes):
        into.append((-(r[1] * into[-1][0] + r[2] * into[-1][1]) / r[0], into[-1][0]))
    into.reverse()
    grown = abs(_parts(out[m], _scaled(u[0], sign), _scaled(s[0], sign))[0])
    begun = (s[0][1], -(slopes[0][0] * s[0][0] + slopes[0][1] * s[0][1]) / slopes[0][2])
    shrunk = abs(_parts(begun, out[1], into[1])[1])
    step = abs(at.unstable) ** (1 / p)
    a = 0.4 * min(wide[0] - first[0], first[0] - wide[0] / step)
    q = (a * grown / wide[0]) ** (1 / m)
    b = wide[1] * shrunk
    r = ((wide[1] - first[1]) / 2 / b) ** (1 / m)
    if not (q > 1 and r > 1):
        raise ValueError("horseshoe: too few rounds near the saddle")
    return [
        HSet(pairs[k], _scaled(out[k], a * q ** (1 - k) / q**0.5), _scaled(into[k], b * r ** (k - 0.5)))
        for k in range(1, m)
    ]


def _parts(v: Vector, first: Vector, second: Vector) -> Vector:
    """The components of a vector along two others."""
    det = first[0] * second[1] - first[1] * second[0]
    return (v[0] * second[1] - v[1] * second[0]) / det, (first[0] * v[1] - first[1] * v[0]) / det
