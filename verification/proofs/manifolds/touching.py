"""A tangency as a zero of one system of equations: an orbit between the manifolds, and a tangent vector along it.

The unknowns are the parameter `z` where the orbit leaves the unstable manifold, its bounces `y[0] ... y[n+1]`, and the
parameter `w` where it arrives on the stable one. With the series `P` and `Q` of the manifolds,

    y[0] = P[-1](z),  y[1] = P[0](z),  rule(y[k-1], y[k], y[k+1]) = 0,  sign*y[n] = Q[0](w),  sign*y[n+1] = Q[1](w)

up to rotations of the table. At a fixed parameter of the map the zeros are the points where the manifolds meet. A
vector with entry 1 at `z` solves the linearised equations exactly where the tangents agree. Both sets of equations
together, with the map's parameter as the last unknown, are as many equations as unknowns. Like the chord system of a
cycle the system has one equation for each bounce, so balls do not grow along the orbit. Newton's method starts at a
float64 orbit from the series near the saddles and the map in between.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mpmath
from flint import arb, arb_mat

from verification.arithmetic.balls import FLOAT64, balls, multiprecision
from verification.arithmetic.linear import approximated, solved
from verification.arithmetic.series import Jet
from verification.cycles.chain import dot
from verification.maps.first_hit import unobstructed
from verification.proofs.manifolds.enclosed import TooWideError
from verification.proofs.manifolds.plane_map import Pinball, PlaneMap
from verification.proofs.manifolds.saddle import Local, direction, horner, saddle, slopes
from verification.proofs.manifolds.tangency import Coefficients, Contact, Gap, Near, Precision, rounds, scale, smaller


@dataclass(frozen=True)
class Flight:
    """An orbit in float64, from bounce -1 on the unstable manifold to bounce 1 on the stable manifold, as jets in `z`.

    `z` and `w` are the parameters of its ends on the manifolds, as displacements along the eigenvectors; `w` is a jet
    in `z`.
    """

    bounces: list[Jet]
    z: float
    w: Jet


def flight(contact: Contact, map: PlaneMap, out: Local, into: Local, early: int, late: int) -> Flight:
    """The orbit from `early` rounds before the start of the contact to `late` rounds after its end.

    `out` and `into` are the series of the unstable and the stable manifold; the ends must lie in their domains.

    >>> from verification.arithmetic.balls import FLOAT64
    >>> from verification.proofs.manifolds.known import CONTACTS, SHAPE, table
    >>> from verification.proofs.manifolds.saddle import saddle
    >>> from verification.proofs.manifolds.saddle import local
    >>> triangle, map = CONTACTS["boundary"], table(SHAPE).over(FLOAT64)
    >>> out, into = (local(saddle(triangle.unstable, map, triangle.parameter), side) for side in (True, False))
    >>> len(flight(triangle, map, out, into, 2, 3).bounces)
    13
    """
    p, q = len(contact.unstable.start), len(contact.stable.start)
    before, after = (
        rounds(contact.z / out.unit, float(out.factor)),
        rounds(contact.end / into.unit, 1 / float(into.factor)),
    )
    z, w0 = contact.z / float(out.factor) ** early, contact.end * float(into.factor) ** after
    found = [bounce(out, j, Jet(z, 1.0)) for j in range(-1, (early - before) * p + 2)]
    for _ in range(contact.bounces + before * p + after * q):
        found.append(map.lifted.following(found[-2], found[-1], contact.parameter))
    end, rate = bounce(into, 0, Jet(w0, 1.0)).c
    sign = contact.mirrored(early, after)
    w = Jet(w0, sign * found[-2].c[1] / rate)
    turn = found[-2].c[0] - sign * end
    if map.turn:
        unit = 2 * map.words.pi / map.turn
        turn = round(turn / unit) * unit
    for j in range(2, (late - after) * q + 2):
        found.append(sign * bounce(into, j, w) + turn)
    return Flight(found, z, w * float(into.factor) ** (late - after))


def bounce(local: Local, j: int, z: Jet) -> Jet:
    """Bounce `j`, for any integer `j`, of the orbit through a displacement `z` along the eigenvector."""
    closure, (rounds, place) = local.saddle.orbit.closure, divmod(j, len(local.coefficients))
    x: Jet = horner(local.coefficients[place], z * (float(local.factor) ** rounds / local.unit))
    moved: Jet = closure.carried(x, closure.angle(local.saddle.map.words), rounds)
    return moved


LARGEST = 0.4  # the largest parameters at the start; the remainder's derivatives are bounded up to 1/2
MOST_BOUNCES = 2000
Vector = list[arb]


@dataclass(frozen=True)
class OrbitPoint:
    """Values of the unknowns: `orbit` is the list `z, y[0], ..., y[n+1], w`, and `along` is the tangent vector."""

    orbit: Vector
    along: Vector
    parameter: arb

    @property
    def unknowns(self) -> Vector:
        """The unknowns in one list, without the entry of `along` that is always 1."""
        return [*self.orbit, *self.along[1:], self.parameter]

    @staticmethod
    def of(unknowns: Vector) -> "OrbitPoint":
        """The point whose unknowns are given in one list."""
        m = len(unknowns) // 2
        return OrbitPoint(unknowns[:m], [arb(1), *unknowns[m:-1]], unknowns[-1])


@dataclass(frozen=True)
class Linear:
    """The equations and their derivatives at a point, or over a box.

    `values` are the residuals of the equations for the orbit, `along` those of the equations for the tangent vector.
    `rows` are the derivatives of the orbit's equations by the orbit, which are also those of the vector's equations by
    the vector; `bent` are the derivatives of the vector's equations by the orbit.
    """

    values: Vector
    along: Vector
    rows: list[Vector]
    bent: list[Vector]
    by_parameter: Vector
    bent_by_parameter: Vector
    halves: bool = False

    def matrix(self) -> arb_mat:
        """The derivative matrix of the whole system, by the unknowns in the order of `OrbitPoint`."""
        zero = [arb(0)] * (len(self.values) - 1)
        upper = [[*row, *zero, g] for row, g in zip(self.rows, self.by_parameter, strict=True)]
        lower = zip(self.bent, self.rows, self.bent_by_parameter, strict=True)
        return arb_mat(upper + [[*bent, *row[1:], h] for bent, row, h in lower])

    def step(self, values: Vector, algorithm: Literal["approx", "precond"]) -> Vector:
        """The Newton correction of the unknowns, for residuals `values` of the system.

        The derivative of the orbit's equations by the orbit is singular at a tangency; it is regular after its first
        column is replaced by the derivative by the parameter. With `halves` two systems of half the size are solved
        with approximate inverses in floats, which is faster and less sharp.
        """
        if not self.halves:
            try:
                whole = self.matrix().solve(arb_mat([[x] for x in values]), algorithm=algorithm)
            except ZeroDivisionError as why:
                raise TooWideError("exists", "the linearised system may be singular") from why
            return [whole[i, 0] for i in range(len(values))]
        n = len(self.rows)
        given = [[*row[1:], g] for row, g in zip(self.rows, self.by_parameter, strict=True)]
        right = [[value, row[0]] for row, value in zip(self.rows, values[:n], strict=True)]
        try:
            solve = solved if algorithm == "precond" else approximated
            fixed, free = zip(*solve(given, right), strict=True)  # with first unknown 0, and null vector
            lower = [[*bent[1:], h] for bent, h in zip(self.bent, self.bent_by_parameter, strict=True)]
            column = [bent[0] - dot(row, free) for bent, row in zip(self.bent, lower, strict=True)]
            left = [[value - dot(row, fixed)] for row, value in zip(lower, values[n:], strict=True)]
            again = [[*row[1:], c] for row, c in zip(self.rows, column, strict=True)]
            last = [x for (x,) in solve(again, left)]
        except ZeroDivisionError as why:
            raise TooWideError("exists", "the linearised system may be singular") from why
        *rest, first = last
        *orbit, parameter = (x - first * y for x, y in zip(fixed, free, strict=True))
        return [first, *orbit, *rest, parameter]


def generic(linear: Linear, along: Vector) -> tuple[arb, arb]:
    """The derivatives `g_zz` and `g_parameter` of the gap at the tangency."""
    columns = [list(column) for column in zip(*(row[1:] for row in linear.rows[:-1]), strict=True)]
    right = [[-x] for x in linear.rows[-1][1:]]
    if linear.halves:
        left = [x for (x,) in solved(columns, right)]
    else:
        found = arb_mat(columns).solve(arb_mat(right), algorithm="precond")
        left = [found[i, 0] for i in range(found.nrows())]
    left.append(arb(1))
    bend = dot(left, [dot(row, along) for row in linear.bent])
    return bend, dot(left, linear.by_parameter)


class Touching:
    """The system of equations of a contact near one parameter, with both manifolds enclosed."""

    def __init__(self, contact: Contact, map: PlaneMap, parameter: arb, precision: Precision) -> None:
        self.contact, self.halves = contact, False
        self.map, self.parameter = map.over(balls(precision.bits)), parameter
        self.pairs: list[Coefficients] = []
        for orbit, unstable in ((contact.unstable, True), (contact.stable, False)):
            found = scale(orbit, map, float(parameter), unstable, precision.outer)
            self.pairs.append(smaller(orbit, map, parameter, found, precision))
        out, into = (made.scale for made in self.pairs)
        early = rounds(contact.z / min(LARGEST * out.unit, out.rough.unit), float(out.rough.factor))
        late = rounds(contact.end / min(LARGEST * into.unit, into.rough.unit), 1 / float(into.rough.factor))
        late = max(late, 1)  # the orbit must end on the series, with its full turns
        self.bounces = 1 + contact.bounces + early * len(contact.unstable.start) + late * len(contact.stable.start)
        if self.bounces > MOST_BOUNCES:
            raise TooWideError("exists", f"an orbit of {self.bounces} bounces is too long")
        self.sign = contact.mirrored(early, late)
        self.turns, self.start = self._from(flight(contact, map.over(FLOAT64), out.rough, into.rough, early, late))

    def _from(self, flight: Flight) -> tuple[int, OrbitPoint]:
        """The rotation between the end of an orbit and the stable manifold, and a start for Newton's method."""
        map, units = self.map, [made.scale.unit for made in self.pairs]
        apart = self.sign * flight.bounces[-2] - bounce(self.pairs[1].scale.rough, 0, flight.w)
        turns = round(apart.c[0] * map.turn / (2 * math.pi))
        along = [1.0, *(units[0] * x.c[1] for x in flight.bounces), units[0] / units[1] * flight.w.c[1]]
        orbit = [flight.z / units[0], *(x.c[0] for x in flight.bounces), flight.w.c[0] / units[1]]
        return turns, OrbitPoint([arb(x) for x in orbit], [arb(x) for x in along], self.parameter)

    def linear(self, at: OrbitPoint) -> Linear:
        """The equations and their derivatives, at a point with the middle parameter or over a box around it."""
        out, into = ([made.at(i, z, at.parameter - self.parameter) for i in (0, 1)] for made, z in self._ends(at))
        m = len(at.orbit)
        made = Linear([], [], [], [], [], [], self.halves)
        for i, near in enumerate(out):
            _ended(made, at, 1 + i, 0, 1, arb(0), near)
        for k in range(1, self.bounces + 1):
            self._bounced(made, at, k)
        unit = 2 * self.map.words.pi / self.map.turn if self.map.turn else arb(0)
        for i, near in enumerate(into):
            _ended(made, at, m - 3 + i, m - 1, self.sign, self.turns * unit, near)
        return made

    def clear(self, at: OrbitPoint) -> bool:
        """True if all chords of the orbit, and of orbits near both saddles, are proved to miss the boundary between."""
        turn, runs = 2 * self.map.words.pi, [at.orbit[1:-1], *(made.tube for made in self.pairs)]
        placed = [[(0, x - turn * round(float(x.mid()) / (2 * math.pi))) for x in run] for run in runs]
        return isinstance(self.map, Pinball) and all(unobstructed(self.map.table, run) for run in placed)

    def _ends(self, at: OrbitPoint) -> list[tuple[Coefficients, arb]]:
        return [(self.pairs[0], at.orbit[0]), (self.pairs[1], at.orbit[-1])]

    def _bounced(self, made: Linear, at: OrbitPoint, k: int) -> None:
        """Adds the rule at `y[k]` to the equations."""
        near = [Jet(at.orbit[j], at.along[j]) for j in range(k, k + 3)]
        value, slopes, moving = self.map.linear_along(near, at.parameter)
        m = len(at.orbit)
        rows = ([arb(0)] * k + [s.c[order] for s in slopes] + [arb(0)] * (m - k - 3) for order in (0, 1))
        _add(made, value.c, list(rows), moving.c)


def _ended(made: Linear, at: OrbitPoint, here: int, end: int, sign: int, shift: arb, near: Near) -> None:
    """Adds the equation `sign*orbit[here] - shift = near(orbit[end])`."""
    row, bent, share = [arb(0)] * len(at.orbit), [arb(0)] * len(at.orbit), at.along[end]
    row[here], row[end], bent[end] = arb(sign), -near.first, -near.second * share
    values = sign * at.orbit[here] - shift - near.place, sign * at.along[here] - near.first * share
    _add(made, values, [row, bent], (-near.by_parameter, -near.mixed * share))


def _add(made: Linear, values: Sequence[arb], rows: list[Vector], by_parameter: Sequence[arb]) -> None:
    """Adds one equation for the orbit, and its linearisation as an equation for the tangent vector."""
    for column, x in zip((made.values, made.along), values, strict=True):
        column.append(x)
    for matrix, row in zip((made.rows, made.bent), rows, strict=True):
        matrix.append(row)
    for column, x in zip((made.by_parameter, made.bent_by_parameter), by_parameter, strict=True):
        column.append(x)


MIDDLE = 20  # extra digits with which a chain is computed
LEAST = 0.125  # the least curvature
LOST = 4  # bits that a checker loses with each bounce
SLACK = 4  # the factor from a value at one place near a saddle to a bound of the local manifold
Image = tuple[int, int]  # the symmetry `x -> sign*x + turns*unit`


def composed(first: Image, second: Image) -> Image:
    """The composition of two symmetries: `second` is applied before `first`.

    >>> composed((-1, 2), (-1, 5))
    (1, -3)
    """
    return first[0] * second[0], first[0] * second[1] + first[1]


def repeating(local: Local) -> Image:
    """The symmetry by which the bounces of a saddle repeat after one round."""
    closure = local.saddle.orbit.closure
    p, q = closure.shift
    return closure.turn, p * local.saddle.map.turn // q


def passage(gap: Gap, z: Any, end: Any, before: int, after: int) -> tuple[list[Any], list[Jet], Image]:
    """The bounces of an orbit from saddle to saddle, its flight in between as jets, and the symmetry at its end.

    It leaves the unstable manifold at `z` after `before` rounds there, and makes `after` rounds on the stable manifold
    from `end` on.
    """
    out, into, unit = gap.out, gap.into, 2 * gap.map.words.pi / gap.map.turn
    image, found = (1, 0), list[Any]()

    def extend(points: Sequence[Any]) -> None:
        found.extend(image[0] * x + image[1] * unit for x in points)

    for k in range(before, 0, -1):
        extend([horner(c, z / out.factor**k) for c in out.coefficients])
        image = composed(image, repeating(out))
    flight = gap.orbit(z)
    extend([jet.c[0] for jet in flight[: gap.bounces]])
    apart = flight[-2].c[0] - gap.sign * into.points(end)[0]
    image = composed(image, (gap.sign, round(float(apart / unit))))
    for k in range(after):
        extend([horner(c, end * into.factor**k) for c in into.coefficients])
        image = composed(image, repeating(into))
    return found, flight, image


def exact_number(x: Any, bits: int) -> list[str]:
    """The multiple `m*2**e` of `2**-bits` nearest to an mpmath number, as `[m, e]` in decimal text."""
    m = int(x.context.nint(x.context.ldexp(x, bits)))
    zeros = min(bits, (m & -m).bit_length() - 1) if m else bits
    return [str(m >> zeros), str(zeros - bits)]


@dataclass(frozen=True)
class SaddleFrame:
    """The bounces of a saddle in the order of the flight, its exit angle at the first bounce, and two slopes there.

    `along` is the derivative of the exit angle by the boundary parameter on the manifold of the flight, `across` that
    of the boundary parameter by the exit angle on the other manifold. A round of these bounces multiplies distances
    on the manifold by `stretch`.
    """

    saddle: list[Any]
    angle: Any
    along: Any
    across: Any
    stretch: Any


class ContactChain:
    """A contact as a chain of bounces, for a checker that has no power series; docs/certificate_format.md defines the
    entries.

    The orbit begins and ends so near to the saddles that the manifolds are close to parabolas there. Nothing is proved
    here: the checker proves it.
    """

    def __init__(self, contact: Contact, map: Pinball, value: str, digits: int) -> None:
        context = mpmath.MPContext()
        context.dps = digits + MIDDLE
        self.map, self.digits, self.near = map.over(multiprecision(context)), digits, 10.0 ** -(digits / 2 + 2)
        self.bits = math.ceil(-2 * math.log2(self.near)) + 40
        self.lam, self.unit = context.mpf(value), 2 * context.pi / map.turn
        self.gap = Gap(contact, self.map, self.lam, 12 + digits, 10.0 ** -(digits + 12))
        self.z, _, end = self.gap.extremum()
        self.end = end.c[0]

    def entries(self) -> dict[str, Any]:
        """The entries of a document that describe the contact."""
        bounces, meets, arrived = self._orbit()
        sides, centre = {}, []
        for name, image, chain in (("unstable", (1, 0), bounces), ("stable", arrived, bounces[::-1])):
            sides[name], place = self._side(name == "stable", image, chain)
            centre.append(exact_number(place, self.bits))
        bits = self.bits + LOST * len(bounces)
        said = {"bits": bits, "digits": self.digits, "centre": [*centre, exact_number(self.lam, self.bits)]}
        radius = ["1", str(-math.ceil(self.digits * math.log2(10)))]
        orbit = [exact_number(self._whole(x), MIDDLE * 2) for x in bounces]
        return said | {"radius": radius} | sides | {"orbit": orbit, "meets": meets}

    def _whole(self, x: Any) -> Any:
        """An angle, reduced modulo full turns."""
        turns = x / (2 * self.map.words.pi)
        return 2 * self.map.words.pi * (turns - turns.context.nint(turns))

    def _orbit(self) -> tuple[list[Any], int, Image]:
        """Bounces from saddle to saddle, the index of a bounce far from both, and the symmetry at the second saddle."""
        out, into = self.gap.out, self.gap.into
        early = rounds(float(self.z) * out.unit / self.near, float(out.factor))
        late = rounds(float(self.end) * into.unit / self.near, 1 / float(into.factor))
        found, _, image = passage(self.gap, self.z, self.end, early, late)
        found.append(image[0] * horner(into.coefficients[0], self.end * into.factor**late) + image[1] * self.unit)
        return found, early * len(out.coefficients) + self.gap.bounces // 2, image

    def _frame(self, side: Local, lam: Any, image: Image, back: bool) -> SaddleFrame:
        """Frame of a saddle; with `back` time is reversed, so that the stable direction is the one that stretches."""
        made = saddle(side.saddle.orbit, self.map, lam)
        rows, points, here, count = slopes(made.orbit, self.map, made.points, lam), list[Any](), image, 0
        while not count or here[0] != image[0] or (here[1] - image[1]) % self.map.turn:
            points += [here[0] * x + here[1] * self.unit for x in made.points]
            here, count = composed(here, repeating(side)), count + 1
        angle, by_here, by_there = self.map.angle(points[0], points[-1 if back else 1])[:3]
        tilts = []
        for factor in (made.unstable, made.stable):
            vector, sign = direction(made, rows, factor), repeating(side)[0]
            moves = [(sign * factor) ** k * v for k in range(count) for v in vector]
            there = moves[-1] / (sign * factor) ** count if back else moves[1]
            tilts.append(by_here + by_there * there / moves[0])
        along, other = tilts[::-1] if back else tilts
        stretch = 1 / made.stable**count if back else made.unstable**count
        order = [points[0], *points[:0:-1]] if back else points
        return SaddleFrame([self._whole(x) for x in order], angle, along, 1 / other, stretch)

    def _side(self, back: bool, image: Image, chain: Sequence[Any]) -> tuple[dict[str, Any], Any]:
        """The entries of one manifold, and the coordinate on it at which the orbit along `chain` begins."""
        side, step = self.gap.into if back else self.gap.out, self.lam.context.mpf(10) ** -(self.digits // 2)
        frame, after, before = (self._frame(side, self.lam + move, image, back) for move in (0, step, -step))
        a, b = self._whole(chain[0] - frame.saddle[0]), self.map.angle(chain[0], chain[1])[0] - frame.angle
        whole = 1 - frame.along * frame.across
        x, y = (a - b * frame.across) / whole, (b - a * frame.along) / whole
        bend, turn = abs(y / x**2), abs((after.along - before.along) / (2 * step * whole))
        bend, turn, reach = SLACK * max(bend, LEAST), SLACK * max(turn, LEAST), abs(x) * 9 / 8
        said = {
            "bounces": frame.saddle,
            "frame": (frame.saddle[0], frame.angle, frame.along, frame.across),
            "drift": ((after.saddle[0] - before.saddle[0]) / (2 * step), (after.angle - before.angle) / (2 * step)),
            "range": (reach, reach / abs(frame.stretch) * 17 / 16),
            "bounds": (2 * bend * reach**2, 2 * bend * reach, turn * reach, bend, turn),
        }
        exact = {name: [exact_number(self.lam * 0 + number, self.bits) for number in said[name]] for name in said}
        return exact, x
