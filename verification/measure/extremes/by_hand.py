"""First hits on tables of sides and arcs, found by trying every piece in 80-bit arithmetic, for tests of the kernels.

No code is shared with the kernels. Particles start with exactly the doubles that a kernel gets, and the table's numbers
have 64 bits. The first hit is the nearest intersection ahead on any piece; on the arc from which a particle starts, it
is the second intersection of the line with the ellipse. Also computed is how closely each line passes a corner or a
tangent, relative to the numbers that are summed for the ends of its flight.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from sympy import Rational, cos, pi, sin

from numeric import PinballMap
from numeric.flights.corners import CIRCLE, ELLIPSE, FOCAL, LINE, PieceNumbers, piece_of
from numeric.flights.pieces import Pieces
from numeric.pinball.sampling import phase_starts
from symbolic import tables
from symbolic.tables.table import Table, theta
from verification.measure.extremes.kernels import Wide, bounced

WIDE = np.longdouble
START = WIDE(2.0**-58)  # share of the table: a hit on another piece nearer than this is rounding
NEARBY = WIDE(2.0**-40)  # the same: so far behind the start, corners and tangents still count
ROUGHLY = 2.0**-30  # the same: a line that passes a piece at more cannot meet it
SKEW = WIDE(2.0**-20)  # the same: so far beyond the landing, a tangent still counts


def spikes(count: int) -> Table:
    """A star of straight sides with rational corners, every second one nearer to the origin; not convex."""
    corners = []
    for i in range(count):
        part, far = 2 * np.pi * i / count, 0.6 if i % 2 else 1.0
        corners.append(tuple(Rational(round(far * f(part) * 10**6), 10**6) for f in (np.cos, np.sin)))
    ring = enumerate(pairwise([*corners, corners[0]]))
    sides = [tables.arc(f"side{i}", x + theta * (X - x), y + theta * (Y - y), 0, 1) for i, ((x, y), (X, Y)) in ring]
    return tables.Table(f"spikes{count}", tuple(sides))  # a star about the origin, so that nothing need be proved of it


def comet() -> Table:
    """A table of two pieces: an arc of an ellipse of eccentricity 0.999 around its far tip, and the arc's chord."""
    rho = 1 / (1 + Rational(999, 1000) * cos(theta))
    arc = tables.arc("arc", rho * cos(theta), rho * sin(theta), pi / 2, 3 * pi / 2)
    return tables.piecewise(arc, tables.arc("chord", 0, theta, -1, 1), name="comet")


def discs(count: int) -> Table:
    """The unit square with `count` rows and columns of discs in it."""
    step = Rational(1, count)
    holes = [
        tables.disc(f"disc{i}.{j}", (step * (i + Rational(1, 2)), step * (j + Rational(1, 2))), step / 4)
        for i in range(count)
        for j in range(count)
    ]
    return tables.Table(f"discs{count * count}", (*tables.square().components, *holes))


def outline(points: int, depth: float, name: str) -> Table:
    """A closed cubic spline through points of an ellipse with three dents; convex if `depth` is small."""
    angle = 2 * np.pi * np.arange(points) / points
    r = 1 + depth * np.cos(3 * angle)
    given = zip(1.5 * r * np.cos(angle), r * np.sin(angle), strict=True)
    return tables.from_points([(f"{x:.6f}", f"{y:.6f}") for x, y in given], name)


class Hit(NamedTuple):
    """The first hits of many particles."""

    length: Any
    piece: Any
    x: Any
    y: Any
    aside: Any  # how closely the line passes a corner or a tangent, before or at the hit, in units of 2**-52 of `size`
    straight: Any  # cosine of the incidence angle
    size: Any  # sum of the moduli of the numbers from which the two ends are added up


def pieces(family: Pieces, shape: Any) -> list[PieceNumbers[Any]]:
    """The constants of every piece of a table in 80 bits, computed from its program."""
    ops: Any = Wide()
    wide = [WIDE(float(x)) for x in shape]
    return [
        centred(piece_of(kind, [WIDE(x) for x in program(ops, *wide)]))
        for kind, program in zip(family.kinds, family.programs, strict=True)
    ]


def centred(piece: PieceNumbers[Any]) -> PieceNumbers[Any]:
    """The same piece; an arc described from a focus is described from the centre of its ellipse instead."""
    if piece.kind != FOCAL:
        return piece
    e = WIDE(1) - piece.radius
    return piece._replace(kind=ELLIPSE, origin=(-e * piece.A[0], -e * piece.A[1]))


def placed(known: list[PieceNumbers[Any]], family: Pieces, own: list[Any]) -> tuple[Any, Any, Any]:
    """The points, unit directions and sizes of the particles that have the kernel fields `own`.

    The size of a point is the sum of the moduli of the numbers that are added up to it.
    """
    at, p, q = own[0].astype(int), own[1].astype(WIDE), own[2].astype(WIDE)
    line = np.array([kind == LINE for kind in family.kinds])[at]
    length = np.where(line, 1, np.hypot(p, q))
    p, q = p / length, q / length
    origin, A, B = (np.array([[*piece[i]] for piece in known])[at].T for i in (1, 2, 3))
    z = p * A + q * B + origin
    d = p * B - q * A
    v = np.array([own[3], own[4]]).astype(WIDE) if len(own) > 3 else np.array([-d[1], d[0]])
    size = np.sum(abs(origin) + abs(p * A) + abs(q * B), axis=0)
    return z, v / np.hypot(*v), size


def hits(map: PinballMap, fields: list[Any]) -> Hit:
    """The first hit of every particle."""
    family = map.family
    assert isinstance(family, Pieces)
    known = pieces(family, map.shape)
    z, v, size = placed(known, family, fields)
    at, p0, q0 = fields[0].astype(int), fields[1].astype(WIDE), fields[2].astype(WIDE)
    table = max(float(np.max(np.abs([*piece.origin, *piece.start]))) for piece in known) + 1e-300
    count = z.shape[1]
    best, where = np.full(count, np.inf, dtype=WIDE), np.full(count, -1)
    straight, weight = np.zeros(count, dtype=WIDE), np.zeros(count, dtype=WIDE)
    near: list[tuple[Any, ...]] = []  # particles, distance ahead, distance aside, size
    roughly = z.astype(float), v.astype(float)
    with np.errstate(all="ignore"):
        for j, piece in enumerate(known):
            some = np.flatnonzero(_may_meet(piece, known[family.following[j]].start, *roughly, table))
            near += [(some, *one) for one in _near(family, known, j, z[:, some], v[:, some], size[some])]
            own = at[some] == j
            depart = abs(_cross(v[:, some], [p0[some] * piece.B[i] - q0[some] * piece.A[i] for i in (0, 1)]))
            for t, p, q, cosine, inside in _met(piece, family.closed[j], z[:, some], v[:, some], own, depart):
                there = sum(abs(piece.origin[i]) + abs(p * piece.A[i]) + abs(q * piece.B[i]) for i in (0, 1))
                nearer = inside & (t > np.where(own, 0, START * table)) & (t < best[some]) & (cosine > 0)
                nearer = nearer & ~(own & (piece.kind == LINE))
                these = some[nearer]
                best[these], where[these] = t[nearer], j
                straight[these], weight[these] = cosine[nearer], there[nearer]
        aside = np.full(count, np.inf, dtype=WIDE)
        beyond = (NEARBY / np.minimum(straight, 1) + SKEW) * table
        for some, ahead, miss, both in near:
            on_the_way = (ahead > -NEARBY * table) & (ahead < (best + beyond)[some])
            least = np.where(on_the_way, miss / both / WIDE(2.0**-52), np.inf)
            aside[some] = np.where(on_the_way, np.minimum(aside[some], least), aside[some])
    with np.errstate(invalid="ignore"):
        x, y = (z[i] + best * v[i] for i in (0, 1))
    return Hit(best, where, x, y, aside.astype(float), straight.astype(float), (size + weight).astype(float))


def _may_meet(piece: PieceNumbers[Any], start: Any, z: Any, v: Any, table: float) -> Any:
    """True for lines that meet a piece or come close to it (`ROUGHLY` times the table's size); computed in doubles."""
    least = ROUGHLY * table
    if piece.kind == LINE:  # both ends on one side
        one, two = (_cross(v, [float(end[i]) - z[i] for i in (0, 1)]) for end in (piece.start, start))
        return ~((np.minimum(one, two) > least) | (np.maximum(one, two) < -least))
    a, b, m = (
        _cross(v, w)
        for w in (*np.array([piece.A, piece.B], dtype=float), [z[i] - float(piece.origin[i]) for i in (0, 1)])
    )
    return ~(abs(m) > np.hypot(a, b) + least)


def _near(
    family: Pieces, known: list[PieceNumbers[Any]], j: int, z: Any, v: Any, size: Any
) -> Iterator[tuple[Any, Any, Any]]:
    """Yields, for the start of piece `j` and its tangent if any: distance along the line, across it, and a size.

    The size is the sum of the moduli that are added up to the particle (`size`) and to the corner or tangent point.
    """
    piece = known[j]
    if not family.closed[j]:
        corner = [piece.start[i] - z[i] for i in (0, 1)]
        both = max(_added_up(one, piece.start) for one in (piece, known[family.following.index(j)]))
        yield v[0] * corner[0] + v[1] * corner[1], abs(_cross(v, corner)), size + both
    if piece.kind != LINE and piece.D < 0:
        yield _tangent(piece, family.closed[j], z, v, size)


def _added_up(piece: PieceNumbers[Any], point: Any) -> Any:
    """The sum of the moduli of the numbers that are added up to a point of a piece (origin plus vector)."""
    return sum(abs(piece.origin[i]) + abs(point[i] - piece.origin[i]) for i in (0, 1))


def _cross(v: Any, w: Any) -> Any:
    return v[0] * w[1] - v[1] * w[0]


def _met(piece: PieceNumbers[Any], closed: bool, z: Any, v: Any, own: Any, depart: Any) -> list[tuple[Any, ...]]:
    """Intersections with a curve at `origin + p*A + q*B`: length, `p`, `q`, cos(incidence), True if on the piece."""
    w = [z[i] - piece.origin[i] for i in (0, 1)]
    a, b, m = _cross(v, piece.A), _cross(v, piece.B), _cross(v, w)
    if piece.kind == LINE:
        p = m / a
        q = WIDE(-1) + 0 * p
        t = _cross(piece.A, w) / a
        return [(t, p, q, a / np.hypot(*piece.A), (p >= piece.middle[0]) & (p <= piece.middle[1]))]
    square = a * a + b * b
    root = np.sqrt(square - m * m)
    found = []
    for s in (np.where(own, depart, root), np.where(own, np.nan, -root)):
        p, q = (m * a + s * b) / square, (m * b - s * a) / square
        t = sum(v[i] * (p * piece.A[i] + q * piece.B[i] - w[i]) for i in (0, 1))
        speed = np.hypot(*(p * piece.B[i] - q * piece.A[i] for i in (0, 1)))
        found.append((t, p, q, s / speed, _within(piece, closed, p, q)))
    return found


def _within(piece: PieceNumbers[Any], closed: bool, p: Any, q: Any) -> Any:
    """True if the point `(p, q)` of the full ellipse is on the arc."""
    if closed:
        return np.isfinite(p)
    c = piece.middle[0] * p + piece.middle[1] * q
    s = piece.middle[0] * q - piece.middle[1] * p
    return np.abs(np.arctan2(s, c)) <= np.arctan2(piece.half[0], piece.half[1])


def _tangent(piece: PieceNumbers[Any], closed: bool, z: Any, v: Any, size: Any) -> tuple[Any, Any, Any]:
    """Where the tangent parallel to a line touches a piece: distance along the line, across it, and a size.

    The distance across is inf if the point of contact is not on the piece; the size is that of `_near`.
    """
    w = [z[i] - piece.origin[i] for i in (0, 1)]
    a, b, m = _cross(v, piece.A), _cross(v, piece.B), _cross(v, w)
    root = np.hypot(a, b)
    p, q = np.sign(m) * a / root, np.sign(m) * b / root
    ahead = sum(v[i] * (p * piece.A[i] + q * piece.B[i] - w[i]) for i in (0, 1))
    there = sum(abs(piece.origin[i]) + abs(piece.A[i]) + abs(piece.B[i]) for i in (0, 1))
    miss = abs(root - abs(m))
    return ahead, np.where(_within(piece, closed, p, q), miss, np.inf), size + there


Starts = tuple[Any, Any, Any]  # component, parameter, exit angle
STRAIGHT = 1.5707  # exit angles beyond are left out


def hard(map: PinballMap, count: int, seed: int) -> dict[str, Starts]:
    """Particles whose next flight is hard to compute, by kind; about `count` of each kind that the table has."""
    rng, family = np.random.default_rng(seed), map.family
    assert isinstance(family, Pieces)
    known = family.known
    starts = phase_starts(map, count, seed=seed)
    where, at = starts.component, starts.theta
    frame = map.family.frame(where, at)
    side = rng.choice([-1, 1], count)
    ulps = rng.integers(0, 40, count) * 2.0**-53  # a few roundings of an angle
    off = side * np.where(rng.random(count) < 0.5, ulps, 10 ** rng.uniform(-15, -3, count))
    goals = np.array([piece.start for j, piece in enumerate(known) if not family.closed[j]])
    goal = goals[rng.integers(0, len(goals), count)]
    found = {
        "anywhere": (where, at, starts.phi),
        "grazing": (where, at, side * (np.pi / 2 - 10 ** rng.uniform(-12, -1, count))),
        "at corners": _aim(map, starts, np.arctan2(goal[:, 1] - frame.y, goal[:, 0] - frame.x), off),
        "along sides": _along(map, starts, off),
    }
    bulges = [known[j] for j in range(len(known)) if family.bulges[j] and known[j].kind == CIRCLE]
    if bulges:
        x, y, radius = np.array([[*piece.origin, float(piece.radius)] for piece in bulges])[
            rng.integers(0, len(bulges), count)
        ].T
        x, y = x - frame.x, y - frame.y
        with np.errstate(invalid="ignore"):
            away = np.arctan2(y, x) + rng.choice([-1, 1], count) * np.arcsin(radius / np.hypot(x, y))
        found["at tangents"] = _aim(map, starts, away, off)
    return found


def _aim(map: PinballMap, starts: Any, away: Any, off: Any) -> Starts:
    """The particles at `starts` that can fly at the angle `away + off` to the x axis, with their exit angles."""
    frame = map.family.frame(starts.component, starts.theta)
    phi = frame.angle(map.states.ops, np.cos(away), np.sin(away)) + off
    good = np.abs(phi) < STRAIGHT  # false also where there is no such direction
    return starts.component[good], starts.theta[good], phi[good]


def _along(map: PinballMap, starts: Any, off: Any) -> Starts:
    """Particles that fly from one end of a piece, or near it, to the other end: along a side or the chord of an arc."""
    where = starts.component
    ends = np.array(map.states.ends)[where]
    at = np.where(off > 0, ends[:, 0], ends[:, 1])
    at = at + (ends.sum(axis=1) / 2 - at) * np.abs(off)
    here, there = (map.family.frame(where, theta) for theta in (at, ends.sum(axis=1) - at))
    away = np.arctan2(there.y - here.y, there.x - here.x)
    phi = here.angle(map.states.ops, np.cos(away), np.sin(away))
    phi = np.clip(phi + off[::-1], -np.pi / 2 + 1e-14, np.pi / 2 - 1e-14)
    return where, at, phi


class BounceErrors(NamedTuple):
    """One bounce of many particles: which stopped, which landed on a wrong piece, and the errors across the line."""

    stopped: Any
    wrong: Any
    error: Any  # in units of 2**-52 of `size`; 0 where a particle stopped
    reason: Any  # for those that stopped: distance of the line from a corner or a tangent, same units


def judged(map: PinballMap, starts: Starts) -> BounceErrors:
    """The errors of a kernel's bounce, compared with the first hits that are found by trying every piece."""
    own, after, code = bounced(map, starts)
    truth = hits(map, own)
    assert isinstance(map.family, Pieces)
    there = [*after[:3], 0 * after[0], 1 + 0 * after[0]]
    landed, _, _ = placed(pieces(map.family, map.shape), map.family, there)
    stopped = code != 0
    wrong = ~stopped & ~_one_place(map.family, after[0].astype(int), truth.piece)
    with np.errstate(invalid="ignore"):
        aside = np.hypot(landed[0] - truth.x, landed[1] - truth.y).astype(float) * truth.straight / truth.size
    return BounceErrors(stopped, wrong, np.where(stopped, 0, aside / 2.0**-52), np.where(stopped, truth.aside, 0))


def _one_place(family: Pieces, one: Any, other: Any) -> Any:
    """True if two pieces are the same or smooth neighbours, so that a hit near their join may be on either."""
    smooth = np.array([not end for _, end in family.corners])
    after = np.array(family.following)
    return (one == other) | (smooth[one] & (after[one] == other)) | (smooth[other] & (after[other] == one))


class CubicHit(NamedTuple):
    """First hits on a boundary of cubics; `sure` is false if rounding leaves the hit in doubt."""

    x: Any
    y: Any
    straight: Any  # cosine of the incidence angle
    sure: Any


def cubic_hits(map: PinballMap, fields: list[Any]) -> CubicHit:
    """First hits of particles: every zero of the cubics of each piece, bisected to the last of 80 bits.

    The known zero is divided out of the cubic from which a particle leaves. `sure` is false where a line passes an end
    of a piece or a tangent by less than `2**-44` of the table, before the hit or at it.
    """
    ops: Any = Wide()
    rows = [[WIDE(x) for x in program(ops)] for _, program in map.ir.programs]
    table = max(abs(float(x)) for row in rows for x in (row[0], row[4])) + 1e-300
    at, theta = fields[0].astype(int), fields[1].astype(WIDE)
    own = np.array(rows)[at].T
    z = [((r[3] * theta + r[2]) * theta + r[1]) * theta + r[0] for r in (own[:4], own[4:])]
    v = np.array(fields[2:4]).astype(WIDE)
    v = v / np.hypot(*v)
    count, nought = theta.size, 0 * theta
    best, straight, doubt = nought + np.inf, nought.copy(), nought + np.inf
    for j, row in enumerate(rows):
        leaves = at == j
        plain = [np.array([row[i] + nought, row[i + 4] + nought]) for i in range(4)]
        plain[0] = plain[0] - z
        second, first = plain[2] + 3 * theta * plain[3], plain[1] + (2 * plain[2] + 3 * theta * plain[3]) * theta
        moved = [first, second, plain[3], 0 * plain[3]]  # in the distance from `theta`, with the known zero divided out
        terms = [np.where(leaves, a, b) for a, b in zip(moved, plain, strict=True)]
        low, high = np.where(leaves, -theta, 0), np.where(leaves, 1 - theta, 1)
        p = [_cross(v, term) for term in terms]
        root = np.sqrt(np.maximum(p[2] ** 2 - 3 * p[3] * p[1], 0))
        w = -(p[2] + np.where(p[2] < 0, -root, root))
        with np.errstate(all="ignore"):
            turns = [np.where(leaves, -p[1] / (2 * p[2]), w / (3 * p[3])), np.where(leaves, np.nan, p[1] / w)]
        cuts = np.sort([low, high, *(np.clip(np.nan_to_num(turn), low, high) for turn in turns)], axis=0)
        for k, cut in enumerate(cuts):  # ends and tangents that the line all but touches
            ahead = _length(v, terms, cut, leaves)
            miss = abs(_value(p, cut) * np.where(leaves, cut, 1))
            close = (miss < 2.0**-44 * table) & (
                (ahead > 2.0**-44 * table) | (~leaves & (abs(ahead) < 2.0**-44 * table))
            )
            doubt = np.where(close & (k >= 0), np.minimum(doubt, ahead), doubt)
        for a, b in pairwise(cuts):
            f, g = _value(p, a), _value(p, b)
            here = np.flatnonzero((f < 0) != (g < 0))
            if here.size:
                q, a, b, up = [x[here] for x in p], a[here], b[here], (f < 0)[here]
                for _ in range(66):
                    middle = (a + b) / 2
                    left = (_value(q, middle) < 0) == up
                    a, b = np.where(left, middle, a), np.where(left, b, middle)
                some = [term[:, here] for term in terms]
                t = _length(v[:, here], some, b, leaves[here])
                nearer = (t > 0) & (t < best[here])
                u = b + np.where(leaves[here], theta[here], 0)
                d = np.array([row[1] + (2 * row[2] + 3 * row[3] * u) * u, row[5] + (2 * row[6] + 3 * row[7] * u) * u])
                straight[here] = np.where(nearer, abs(_cross(v[:, here], d)) / np.hypot(*d), straight[here])
                best[here] = np.where(nearer, t, best[here])
    x, y = (z[i] + best * v[i] for i in (0, 1))
    assert x.size == count
    return CubicHit(x, y, straight.astype(float), np.isfinite(best) & ~(doubt < best + 2.0**-40 * table))


def _value(p: list[Any], x: Any) -> Any:
    return ((p[3] * x + p[2]) * x + p[1]) * x + p[0]


def _length(v: Any, terms: list[Any], x: Any, leaves: Any) -> Any:
    """Distance along the line to a point of a cubic; if `leaves`, the known zero has been divided out of `terms`."""
    along = _value([v[0] * term[0] + v[1] * term[1] for term in terms], x)
    return np.where(leaves, along * x, along)
