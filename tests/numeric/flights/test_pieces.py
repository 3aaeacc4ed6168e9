"""Tables of straight sides and arcs: closed forms against the exact map, and against every piece tried by hand."""

from functools import cache

import numpy as np
import pytest
from sympy import Rational, cos, pi, sin

from numeric import PinballMap, phase_starts
from numeric.flights import pieces
from numeric.flights.general import General
from numeric.flights.pieces import CIRCLE, Pieces
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from symbolic.tables.gallery import GALLERY
from symbolic.tables.law import Law
from symbolic.tables.table import theta
from verification.maps.exact import ExactMap, errors
from verification.measure.extremes.by_hand import comet

EPS = 2.0**-52
CORNER = tables.polygon((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), name="corner")  # not convex
LENS = tables.piecewise(  # an arc of an ellipse, one of a circle, a side, and a dent that is a dispersing arc
    tables.arc("top", 2 * cos(theta), sin(theta), 0, pi),
    tables.arc("left", theta, 0, -2, -1),
    tables.arc("dent", -cos(theta), sin(theta) / 2, 0, pi),
    tables.arc("right", theta, 0, 1, 2),
    name="lens",
)
UNEQUAL = tables.polygon(  # sides of very different length
    (0, 0), (Rational(1, 10**6), 0), (10**6, Rational(1, 10**6)), (10**6, 1), (0, 1), name="unequal"
)
OWN = {table.name: table for table in (CORNER, LENS, UNEQUAL)}
NAMES = [*GALLERY, *OWN]


@cache
def mapped(name, lam=0.9):
    return PinballMap(OWN[name] if name in OWN else GALLERY[name](), lam=lam)


def error_of_a_bounce(map, where, at, phi):
    own = map.states.enter(where, at, phi, map.law)
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(at.size, 0.9), map.shape, 1)
    going = result.rows["code"] == 0
    before, after = [row[going] for row in own], [row[going] for row in result.record[0]]
    position, direction = errors(map, ExactMap(map, 30), before, after)
    eta = map.step(at[going], phi[going], where[going]).eta
    return going, position, direction, np.cos(eta)


@pytest.mark.parametrize("name", NAMES)
def test_a_bounce_is_right_to_the_last_bits(name):
    map = mapped(name)
    starts = phase_starts(map, 24, seed=11)
    _, position, direction, straight = error_of_a_bounce(map, starts.component, starts.theta, 0.95 * starts.phi)
    size = max(1.0, np.max(np.abs(map.states.point(starts.component, starts.theta))))

    assert isinstance(map.family, Pieces)
    assert np.max(position * straight) <= 4 * size
    assert np.max(direction * straight) <= 8 * size


@pytest.mark.parametrize("name", ["stadium", "sinai", "mushroom", "diamond", "reuleaux"])
@pytest.mark.parametrize("gap", [1e-4, 1e-9])
def test_a_particle_that_leaves_along_the_boundary_is_as_exact_as_its_flight_allows(name, gap):
    map = mapped(name)
    starts = phase_starts(map, 10, seed=12)
    phi = np.where(np.arange(10) % 2 == 0, 1, -1) * (np.pi / 2 - gap)
    going, position, _, straight = error_of_a_bounce(map, starts.component, starts.theta, phi)

    assert np.any(going)
    assert np.max(position * straight) <= 8


def test_an_arc_about_a_focus_is_as_exact_as_its_condition_allows_at_its_far_end_too():
    """The far end is 2000 times as far from the focus as the near one: a difference of the radius loses digits."""
    map = PinballMap(comet(), lam=0.9, kernels=False)
    far = 10.0 ** np.array([-6.0, -3.2, -3, -2.7, -2, -1])
    where, at = np.repeat([0, 1], 6), np.concatenate([np.pi + far * [1, -1, 1, -1, 1, -1], np.linspace(-0.9, 0.9, 6)])
    phi = np.tile([0.5, 0.96, -1, -0.4, 0.1, 1.4], 2)
    matrix = np.abs(map.derivative(at, phi, where))
    going, position, direction, _ = error_of_a_bounce(map, where, at, phi)

    assert isinstance(map.family, Pieces)
    assert np.all(going)
    assert np.all(position <= 8 * (1 + matrix[:, 0].sum(axis=-1)))
    assert np.all(direction <= 8 * (1 + matrix[:, 1].sum(axis=-1)))
    assert np.max(position) <= 4


def test_the_parameter_of_an_arc_about_a_focus_is_its_polar_angle_and_derivatives_are_by_it():
    """Of one that is turned, with a law that depends on the place: the general flight knows no other parameter."""
    rho = 2 / (1 - Rational(3, 5) * cos(theta - pi / 3))
    arc = tables.arc("arc", rho * cos(theta), rho * sin(theta), -pi / 6, 5 * pi / 6)
    ends = [[x.subs(theta, end) for x in arc.point] for end in (5 * pi / 6, -pi / 6)]
    side = tables.arc("side", *(p + theta * (q - p) for p, q in zip(*ends, strict=True)), 0, 1)
    table, where, at = tables.piecewise(arc, side, name="turned"), np.array([0, 0, 1]), np.array([1.0, 2.2, 0.3])
    for law in (Law(), Law("-eta/2 + sin(theta)*cos(eta)/8")):
        one, other = (PinballMap(table, lam="0.9", law=law, kernels=False) for _ in range(2))
        general = General(other.states.boundary)
        general.formula, other.family, other.states.family = other.family.formula, general, general
        other.engine = type(other.engine)(general, "", other.engine.names, False)
        phi = np.array([0.2, -0.7, 0.5])
        a, b = (map.exponents(at, phi, 4, component=where) for map in (one, other))

        assert np.allclose(one.step(at, phi, where).theta, other.step(at, phi, where).theta, rtol=0, atol=1e-13)
        assert np.allclose(one.derivative(at, phi, where), other.derivative(at, phi, where), rtol=1e-9, atol=1e-12)
        assert np.allclose(a.nu_plus, b.nu_plus, rtol=0, atol=1e-9)
        assert np.allclose(a.nu_minus, b.nu_minus, rtol=0, atol=1e-9)


def tried_by_hand(map, where, at, phi):
    """Length and piece of every first hit: all pieces, one after the other, in extended precision."""
    real = np.longdouble
    frame = map.states.frame(where, at)
    v = [np.asarray(x, dtype=real) for x in frame.direction(map.states.ops, phi)]
    z = [np.asarray(x, dtype=real) for x in (frame.x, frame.y)]
    best, piece = np.full(at.size, np.inf, dtype=real), np.full(at.size, -1)
    for j, known in enumerate(map.family.pieces(map.states.ops, map.shape)):
        own = where == j
        w = [x - real(o) for x, o in zip(z, known.origin, strict=True)]
        a, b, m = (v[0] * real(y) - v[1] * real(x) for x, y in (known.A, known.B, (0, 0)))
        m = v[0] * w[1] - v[1] * w[0]
        with np.errstate(all="ignore"):
            if known.kind == "line":
                p, q = m / a, -1
                inside = (p >= real(known.middle[0])) & (p <= real(known.middle[1])) & (a > 0) & ~own
            else:
                square = a * a + b * b
                left = square - m * m
                root = np.sqrt(np.maximum(left, 0))
                p, q = (m * a + root * b) / square, (m * b - root * a) / square
                c, s = known.middle[0] * p + known.middle[1] * q, known.middle[0] * q - known.middle[1] * p
                half = np.arctan2(real(known.half[0]), real(known.half[1]))
                half = np.pi * real(2) if map.family.closed[j] else half
                inside = (left > 0) & (np.abs(np.arctan2(s, c)) <= half) & ~(own & (known.D < 0))
            x, y = (p * real(known.A[i]) + q * real(known.B[i]) - w[i] for i in (0, 1))
            t = v[0] * x + v[1] * y
            nearer = inside & (t > 1e-9) & (t < best)
        best, piece = np.where(nearer, t, best), np.where(nearer, j, piece)
    return best, piece


@pytest.mark.parametrize("name", NAMES)
def test_no_landing_is_on_a_wrong_piece(name):
    """Random starts, starts near corners and tangents, and rays that pass corners by a few roundings."""
    map = mapped(name)
    count = 20_000
    rng = np.random.default_rng(13)
    starts = phase_starts(map, count, seed=13)
    where, at, phi = starts.component, starts.theta.copy(), starts.phi.copy()
    ends = np.array(map.states.ends)[where]
    kind = np.arange(count) % 4
    near = 10.0 ** rng.uniform(-6, -2, count)
    at = np.where(kind == 1, np.where(rng.random(count) < 0.5, ends[:, 0] + near, ends[:, 1] - near), at)
    at = np.clip(at, ends[:, 0], ends[:, 1])
    phi = np.where(kind == 2, np.copysign(np.pi / 2 - 10.0 ** rng.uniform(-5, -1, count), phi), phi)
    frame = map.states.frame(where, at)
    corners = np.array([piece.start for piece in map.family.pieces(map.states.ops, map.shape)])
    aim = corners[rng.integers(0, len(corners), count)]
    aimed = frame.angle(map.states.ops, aim[:, 0] - frame.x, aim[:, 1] - frame.y)
    aimed = aimed + rng.choice([-1, 1], count) * 10.0 ** rng.uniform(-13, -3, count)
    phi = np.where((kind == 3) & (np.abs(aimed) < 1.57), aimed, phi)
    step = map.step(at, phi, where)
    length, piece = tried_by_hand(map, where, at, phi)
    found = np.hypot(step.x - frame.x, step.y - frame.y)
    known = (step.code == 0) & np.isfinite(length.astype(float)) & (found > 1e-6)
    size = float(np.max(np.abs(corners))) + 1
    wrong = known & (np.abs(found - length) * np.cos(step.eta) > 1e-8 * size)

    assert np.mean(known) > 0.5
    assert not np.any(wrong), (where[wrong][:3], at[wrong][:3], phi[wrong][:3], piece[wrong][:3])
    assert np.mean(step.code != 0) < 0.05


@pytest.mark.parametrize("name", ["square", "stadium", "mushroom", "sinai", "diamond"])
@pytest.mark.parametrize("kernels", [True, False])
def test_a_particle_aimed_at_a_corner_stops_there_by_name_or_lands_beside_it(name, kernels):
    map = PinballMap(GALLERY[name](), lam=0.9, kernels=kernels)
    corners = np.array([piece.start for piece in map.family.pieces(map.states.ops, map.shape)])
    starts = phase_starts(map, 200, seed=14)
    frame = map.states.frame(starts.component, starts.theta)
    for x, y in corners:
        phi = frame.angle(map.states.ops, x - frame.x, y - frame.y)
        ahead = np.abs(phi) < 1.5
        for shift in (-4, -1, 0, 1, 4):
            step = map.step(starts.theta[ahead], phi[ahead] + shift * EPS, starts.component[ahead])
            fine = (step.code != 0) | (np.hypot(step.x - x, step.y - y) < 1e-12)
            for side in (-1e-12, 0, 1e-12):  # past a corner that bends outwards both ways are right
                _, piece = tried_by_hand(map, starts.component[ahead], starts.theta[ahead], phi[ahead] + side)
                fine = fine | (step.component == piece)

            assert np.all(fine)


def test_where_a_corner_is_met_exactly_the_outcome_is_a_join():
    assert PinballMap(tables.square(), lam=1).step(0.5, np.arctan(0.5)).status.name == "JOIN"


def test_a_tangent_of_an_inner_disc_passes_it_or_grazes_it():
    map = mapped("sinai")
    phi = np.arcsin(0.25 / np.hypot(0.5, 0.25)) - np.arctan2(0.25, 0.5)  # from (1/4, -1/2) past the disc
    for shift in np.concatenate([[0.0], np.geomspace(1e-15, 1e-6, 10), -np.geomspace(1e-15, 1e-6, 10)]):
        step = map.step(0.75, phi + shift)
        met = step.status.name == "GRAZING" or step.component == 4

        assert met or step.y > 0.4 or abs(step.x) > 0.4


def test_a_square_keeps_a_particle_between_opposite_sides_for_ever():
    orbit = PinballMap(tables.square(), lam="1/2").orbit(0.25, 0.0, 4)

    assert orbit.component.tolist() == [0, 2, 0, 2, 0]
    assert orbit.theta.tolist() == [0.25, 0.75, 0.25, 0.75, 0.25]


def test_one_exponent_of_a_polygon_is_the_logarithm_of_lam():
    found = PinballMap(tables.triangle(), lam=0.3).exponents(0.37, 0.1, 400)

    assert float(found.nu_minus) == pytest.approx(np.log(0.3), abs=5e-3)


@pytest.mark.parametrize("name", ["stadium", "sinai", "mushroom", "semi_ellipse", "lens"])
def test_the_derivative_is_that_of_the_map(name):
    map = mapped(name, 0.7)
    starts = phase_starts(map, 40, seed=15)
    at, phi, where, h = starts.theta, 0.8 * starts.phi, starts.component, 1e-6
    slope = map.derivative(at, phi, where)
    ahead, behind, here = (map.step(at, phi + shift, where) for shift in (h, -h, 0))
    same = (ahead.component == behind.component) & (here.code == 0)
    speed = map.states.speed(here.component, here.theta)
    tolerance = 1e-4 * (1 + np.abs(slope[:, 0, 1]) + np.abs(slope[:, 1, 1])) / np.cos(here.eta) ** 2

    assert np.mean(same) > 0.8
    assert np.all((np.abs((ahead.theta - behind.theta) / (2 * h) * speed - slope[:, 0, 1]) <= tolerance)[same])
    assert np.all((np.abs((ahead.phi - behind.phi) / (2 * h) - slope[:, 1, 1]) <= tolerance)[same])


def test_at_no_contraction_the_exponents_of_stadium_and_sinai_cancel():
    for name in ("stadium", "sinai"):
        found = mapped(name, 1).exponents(np.full(64, 0.3), np.linspace(0.1, 0.6, 64), 2000)

        assert np.max(np.abs(found.nu_plus + found.nu_minus)[found.code == 0]) < 0.02
        assert np.mean(found.nu_plus) > 0.3


def test_a_circle_off_its_centre_and_a_tilted_ellipse_are_arcs_like_any_other():
    assert [kind for kind in mapped("stadium").family.kinds if kind == CIRCLE] == ["circle"] * 2
    assert mapped("lens").family.kinds == ["ellipse", "line", "ellipse", "line"]
    assert mapped("stadium").family.outer == [0, 1, 2, 3]
    assert mapped("sinai").family.outer == [0, 1, 2, 3]
    assert mapped("mushroom").family.outer == []


@cache
def of_many(name):
    if name == "sides":
        return tables.regular(100)
    cuts = [2 * pi * Rational(k, 26) for k in range(27)]
    arcs = [tables.arc(f"arc{k}", 2 * cos(theta), sin(theta), *cuts[k : k + 2]) for k in range(26)]
    return tables.Table("cut ellipse", tuple(arcs))


@pytest.mark.parametrize("name", ["sides", "arcs"])
def test_one_of_many_pieces_is_found_by_halving_as_by_trying_each(name, monkeypatch):
    fast = PinballMap(of_many(name), lam=0.9)
    monkeypatch.setattr(pieces, "MANY", 1000)
    slow = PinballMap(of_many(name), lam=0.9, kernels=False)
    assert fast.family.halving is not None
    assert slow.family.halving is None
    rng = np.random.default_rng(3)
    where = rng.integers(0, len(fast.ir.parts), 3000)
    low, high = np.array(fast.states.ends)[where].T
    at, phi = low + (high - low) * rng.random(3000), rng.uniform(-1.57, 1.57, 3000)
    x, y, dx, dy = fast.family.boundary.curve(where, at)[:4]
    corners = np.array([[float(number) for number in part.at(part.start)] for part in of_many(name).components])
    there = corners[(where + rng.integers(3, len(corners) - 3, 3000)) % len(corners)]
    u, v = there[:, 0] - x, there[:, 1] - y
    past = rng.choice([-1, 1], 3000) * 10 ** rng.uniform(-9, -2, 3000)  # flights that pass a corner so near
    phi[::2] = (np.arctan2(u * dx + v * dy, v * dx - u * dy) + past)[::2]
    a, b = fast.step(at, phi, where), slow.step(at, phi, where)
    both = (a.code == 0) & (b.code == 0)
    assert np.mean(both) > 0.99
    assert np.array_equal(a.component[both], b.component[both])
    assert np.max(np.hypot(a.x - b.x, a.y - b.y)[both] * np.cos(a.eta[both])) < 16 * EPS
