"""Tables of sides and arcs: closed forms agree with the exact map, and with a trial of every piece."""

from functools import cache

import numpy as np
import pytest
from one_bounce import landing_errors
from sympy import Rational, cos, pi, sin

from numeric import PinballMap, phase_starts
from numeric.flights.pieces import Pieces
from symbolic import tables
from symbolic.tables.gallery import GALLERY
from symbolic.tables.table import theta
from verification.measure.extremes.by_hand import comet

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


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_bounce_is_right_to_the_last_bits(name):
    map = mapped(name)
    starts = phase_starts(map, 24, seed=11)
    _, position, direction, straight = landing_errors(map, starts.component, starts.theta, 0.95 * starts.phi)
    size = max(1.0, np.max(np.abs(map.states.point(starts.component, starts.theta))))

    assert isinstance(map.family, Pieces)
    assert np.max(position * straight) <= 4 * size
    assert np.max(direction * straight) <= 8 * size


@pytest.mark.slow
@pytest.mark.parametrize("name", ["stadium", "sinai", "mushroom", "diamond", "reuleaux"])
@pytest.mark.parametrize("gap", [1e-4, 1e-9])
def test_a_particle_that_leaves_along_the_boundary_is_as_exact_as_its_flight_allows(name, gap):
    map = mapped(name)
    starts = phase_starts(map, 10, seed=12)
    phi = np.where(np.arange(10) % 2 == 0, 1, -1) * (np.pi / 2 - gap)
    going, position, _, straight = landing_errors(map, starts.component, starts.theta, phi)

    assert np.any(going)
    assert np.max(position * straight) <= 8


@pytest.mark.slow
def test_an_arc_about_a_focus_is_as_exact_as_its_condition_allows_at_its_far_end_too():
    """The far end is 2000 times as far from the focus as the near end, so a difference of radii loses digits."""
    map = PinballMap(comet(), lam=0.9, kernels=False)
    far = 10.0 ** np.array([-6.0, -3.2, -3, -2.7, -2, -1])
    where, at = np.repeat([0, 1], 6), np.concatenate([np.pi + far * [1, -1, 1, -1, 1, -1], np.linspace(-0.9, 0.9, 6)])
    phi = np.tile([0.5, 0.96, -1, -0.4, 0.1, 1.4], 2)
    matrix = np.abs(map.derivative(at, phi, where))
    going, position, direction, _ = landing_errors(map, where, at, phi)

    assert isinstance(map.family, Pieces)
    assert np.all(going)
    assert np.all(position <= 8 * (1 + matrix[:, 0].sum(axis=-1)))
    assert np.all(direction <= 8 * (1 + matrix[:, 1].sum(axis=-1)))
    assert np.max(position) <= 4


def tried_by_hand(map, where, at, phi):
    """Length and piece of each first hit, from a loop over all pieces in extended precision."""
    real = np.longdouble
    frame = map.family.frame(where, at)
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
    frame = map.family.frame(where, at)
    corners = np.array([piece.start for piece in map.family.pieces(map.states.ops, map.shape)])
    aim = corners[rng.integers(0, len(corners), count)]
    aimed = frame.angle(map.states.ops, aim[:, 0] - frame.x, aim[:, 1] - frame.y)
    aimed = aimed + rng.choice([-1, 1], count) * 10.0 ** rng.uniform(-13, -3, count)
    phi = np.where((kind == 3) & (np.abs(aimed) < 1.57), aimed, phi)
    step = map.step(at, phi, where)
    length, piece = tried_by_hand(map, where, at, phi)
    x, y = map.family.cartesian(step.component, step.theta)
    found = np.hypot(x - frame.x, y - frame.y)
    known = (step.code == 0) & np.isfinite(length.astype(float)) & (found > 1e-6)
    size = float(np.max(np.abs(corners))) + 1
    wrong = known & (np.abs(found - length) * np.cos(step.eta) > 1e-8 * size)

    assert np.mean(known) > 0.5
    assert not np.any(wrong), (where[wrong][:3], at[wrong][:3], phi[wrong][:3], piece[wrong][:3])
    assert np.mean(step.code != 0) < 0.05


@pytest.mark.slow
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
