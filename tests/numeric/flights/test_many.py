"""Tables of many pieces: the grid leaves out no piece that could be hit first."""

from fractions import Fraction
from functools import cache

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from numeric import PinballMap
from numeric.backends.scalars import ArrayBackend
from numeric.flights.corners import inwards
from numeric.flights.family import Boundary
from numeric.flights.many import Many
from numeric.flights.pieces import Pieces
from numeric.lowering.program import Builder, ComponentProgram, TableIR
from symbolic import tables
from verification.measure.extremes.by_hand import hard, judged

OPS = ArrayBackend()


def boundary(pieces):
    """A boundary of sides `(x, y, X, Y)` and arcs `(x, y, a, b, low, high)` of ellipses with axes along x and y."""
    parts, programs = [], []
    for j, piece in enumerate(pieces):
        x, y, a, b, *ends = map(Fraction, piece)
        at = Builder("theta")
        (theta,) = at.nodes
        if ends:
            low, high = ends
            c, s = (at.node(word, theta.number()) for word in ("cos", "sin"))
            curve = at.program(x + c * a, y + s * b, s * -a, c * b, c * -a, s * -b)
            angles = [float(low), float((low + high) / 2), float((high - low) / 2)]
            marks = [f(z) for z, f in zip(np.repeat(angles, 2), (np.cos, np.sin) * 3, strict=True)]
            kind = "circle" if abs(a) == abs(b) else "ellipse"
            numbers = [x, y, a, 0, 0, b, x + a * Fraction(marks[0]), y + b * Fraction(marks[1]), a * b, abs(a)]
            numbers += [Fraction(float(marks[i])) for i in (2, 3, 5, 4)]
        else:
            low, high, kind, u, v = Fraction(0), Fraction(1), "line", a - x, b - y
            curve = at.program(x + theta * u, y + theta * v, at.exact(u), at.exact(v), at.exact(0), at.exact(0))
            numbers = [x, y, u, v, 0, 0, x, y, 0, 1, 0, 1, 0, 1]
        parts.append(ComponentProgram(f"piece{j}", Builder().program(low, high), curve))
        programs.append((f"{kind} {j}", Builder().program(*map(Fraction, numbers))))
    sides = sum(len(piece) == 4 for piece in pieces)
    joins = [((j + 1) % sides, "CORNER", 0) for j in range(sides)] + [
        (j, "SMOOTH", 0) for j in range(sides, len(pieces))
    ]
    return Boundary(TableIR("made", "", (), tuple(parts), tuple(programs), (0, Builder().program(0)), tuple(joins)), [])


def jagged(seed, sides, holes, unequal):
    """A polygon that is not star-shaped about the origin, with discs and ellipses in its middle."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 1, sides)) * unequal + (1 - unequal) * np.arange(sides) / sides
    radius = np.exp(rng.uniform(-0.7, 0, sides))
    corners = [(float(r * np.cos(t)), float(r * np.sin(t))) for r, t in zip(radius, 2 * np.pi * angle, strict=True)]
    pieces = [(*corner, *corners[(i + 1) % sides]) for i, corner in enumerate(corners)]
    for k in range(holes):
        x, y = -0.3 + 0.15 * (k % 5), -0.3 + 0.15 * (k // 5)
        a = float(0.07 * rng.uniform(0.01, 1))
        pieces.append((x, y, a, -a if k % 3 else -a / 2, -np.pi, np.pi))
    return boundary(pieces)


def rays(family, count, seed):
    """Random rays, rays along the boundary, rays that pass corners by a few roundings, and near-tangents of holes."""
    rng, known = np.random.default_rng(seed), family.known
    where = rng.integers(0, len(known), count)
    low, high = np.array(family.boundary.ends)[where].T
    at = low + (high - low) * rng.uniform(0.001, 0.999, count)
    phi = np.arcsin(rng.uniform(-1, 1, count))
    frame = family.frame(where, at)
    kind = np.arange(count) % 4
    goal = rng.integers(0, len(known), count)
    aim = np.array([piece.start for piece in known])[goal]
    centre = np.array([piece.origin for piece in known])[goal]
    u, v = (np.where(kind == 3, centre[:, i], aim[:, i]) - (frame.x, frame.y)[i] for i in (0, 1))
    radius = np.array([piece.radius for piece in known], dtype=float)[goal]
    beside = np.where(kind == 3, np.arcsin(np.minimum(radius / np.hypot(u, v), 1)), 0)
    past = rng.choice([-1, 1], count) * (beside + 10 ** rng.uniform(-17, -2, count))
    aimed = np.arctan2(u * frame.tx + v * frame.ty, v * frame.tx - u * frame.ty) + past
    phi = np.where((kind >= 2) & (np.abs(aimed) < 1.57), aimed, phi)
    phi = np.where(kind == 1, np.copysign(np.pi / 2 - 10 ** rng.uniform(-9, -1, count), phi), phi)
    return [*family.enter(OPS, where.astype(float), at), *frame.direction(OPS, phi)]


def landed(family, state):
    with np.errstate(all="ignore"):
        landing = family.fly(OPS, [], "pinball", state[:3], state[3:])
    return {"code": landing.code, "across": landing.across, "along": landing.along, **landing.numbers} | dict(
        zip(family.position, landing.position, strict=True)
    )


@settings(max_examples=5, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(32, 60), st.sampled_from([0, 5, 25]), st.sampled_from([0, 0.9, 1]))
@example(3, 32, 25, 1)
def test_a_landing_is_to_the_last_bit_that_of_the_walk_through_all_pieces(seed, sides, holes, unequal):
    table = jagged(seed, sides, holes, unequal)
    some, every = Many(table), Pieces(table)
    state = rays(some, 600, seed)
    one, other = landed(some, state), landed(every, state)
    going = other["code"] == 0
    assert np.mean(going) > 0.7
    assert np.array_equal(one["code"], other["code"])
    for name in ("component", "p", "q", "t", "across", "along", "D"):
        assert np.array_equal(*(np.broadcast_to(found[name], going.shape)[going] for found in (one, other))), name


@cache
def comb():
    teeth = [corner for i in range(20) for corner in ((i, 0), (i + Fraction(1, 2), 1))]
    return tables.Table("comb", tuple(tables.polygon(*map(exact, [*teeth, (20, 0), (20, 2), (0, 2)])).components))


def exact(corner):
    return tuple(str(x) for x in corner)


def test_no_landing_between_the_teeth_of_a_comb_is_on_a_wrong_side():
    map = PinballMap(comb(), lam=0.9)
    assert isinstance(map.family, Many)
    assert len(map.family.passed) == sum(not inwards(map.family.boundary, j) for j in range(43)) > 15
    for label, starts in hard(map, 2000, 1).items():
        assert not np.any(judged(map, starts).wrong), label
