"""Orbits written by kernels: exact to rounding, bits independent of how they are requested, complete after a stop."""

import mpmath
import numpy as np
import pytest
from sympy import Rational, cos, sin

from numeric import PinballMap
from numeric.backends.scalars import ScalarBackend
from numeric.kernels.engine import STRETCH
from numeric.kernels.machine import TOLD
from numeric.pinball.orbits import FIELDS, OrbitRun
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
CONTEXT = mpmath.MPContext()
CONTEXT.dps = 40
LAWS = [0, 0.7, 1]


def same(one, other):
    return all(np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f") for a, b in zip(one, other, strict=True))


def started(table, lam, count=40):
    where, at, phi = table.starts(map := table.map(lam), count, seed=5, steepest=0.98)
    return map, (at, phi * (lam != 0)), where


@pytest.mark.slow
@pytest.mark.parametrize("lam", LAWS)
def test_what_a_kernel_tells_of_its_state_is_exact_to_rounding(table, lam):
    """Each output against the same state in 40 digits; the stored direction is itself rounded."""
    map, (at, phi), where = started(table, lam)
    course = OrbitRun(map, at, phi, where, TOLD, keep=True)
    told, rows = course.advance(1), course.kernels[0].rows
    ops = ScalarBackend(CONTEXT)
    shape = [CONTEXT.mpf(x) for x in map.shape]
    for i in np.flatnonzero(course.code == 0):
        state = [CONTEXT.mpf(float(rows[name][i])) for name in map.family.fields(map.law)]
        position, leaving = state[: len(map.family.position)], state[len(map.family.position) :]
        frame, place = map.family.framed(ops, shape, position), map.family.place(ops, position)
        exit = map.family.exit(ops, frame, leaving) if lam else 0

        assert max(abs(told[n][0, i] - x) for n, x in (("component", place[0]), ("theta", place[1]))) <= 3 * EPS
        assert max(abs(told[n][0, i] - x) for n, x in (("x", frame.x), ("y", frame.y))) <= 3 * EPS
        assert abs(told["phi"][0, i] - exit) <= 6 * EPS
        if lam:
            assert abs(told["eta"][0, i] + exit / lam) <= 6 / lam * EPS


def lengths(map):
    """Arc length from `theta = 0` on the first component, to 40 digits."""
    shape = [CONTEXT.mpf(x.numerator) / x.denominator for x in map.exact_shape]
    if map.ir.table in ("circle", "cardioid", "cuspless"):
        return lambda theta: theta if map.ir.table == "circle" else 4 * CONTEXT.sin(theta / 2)
    if map.ir.table == "ellipse":
        return lambda theta: CONTEXT.ellipe(theta, 1 - shape[0] ** 2)
    ops, part, count = ScalarBackend(CONTEXT), map.ir.parts[0], 256
    turn = [CONTEXT.expjpi(CONTEXT.mpf(2 * j) / count) for j in range(count)]
    speed = [CONTEXT.hypot(*part.curve(ops, 2 * CONTEXT.pi * j / count, *shape)[2:4]) for j in range(count)]
    waves = {k: sum(v / turn[j * k % count] for j, v in enumerate(speed)) / count for k in range(100)}

    def length(theta):
        rest = sum(2 * (waves[k] * (CONTEXT.expj(k * theta) - 1) / (k * 1j)).real for k in range(1, 100))
        return waves[0].real * theta + rest

    return length


CONIC = tables.polar(1 / (2 + cos(theta) / 2), name="conic")
TILTED = tables.polar(1 + cos(theta) / 5 + sin(2 * theta) / 40, name="tilted")


@pytest.mark.slow
@pytest.mark.parametrize(
    "map",
    [
        PinballMap("circle", lam=0.9),
        *(PinballMap("ellipse", lam=0.9, a=a) for a in ("1.01", "1.5", "2.7", "3.5")),
        PinballMap("ellipse", lam=0.9, a=9),  # has too many waves
        PinballMap("cardioid", lam=0.9),
        PinballMap("cuspless", lam=0.9),
        *(PinballMap("egg", lam=0.9, alpha=alpha) for alpha in ("0", "0.08", "0.1")),
        PinballMap("egg", lam=0.9, K=5, alpha="0.03"),
        PinballMap(TILTED, lam=0.9),
        PinballMap(CONIC, lam=0.9),
    ],
    ids=lambda map: f"{map.ir.table}{map.shape}",
)
def test_arc_length_that_kernels_tell_is_off_by_a_rounding_of_the_perimeter(map):
    told = map.orbit(np.linspace(-2, 2, 8), 0.4, 3, fields=("component", "theta", "s"))
    exact, begin = lengths(map), map.arclength.offsets[0]
    here = told["component"] == 0
    for at, s in zip(told["theta"][here], told["s"][here], strict=True):
        assert abs(CONTEXT.mpf(s) - begin - exact(CONTEXT.mpf(at))) <= EPS * map.arclength.perimeter
    wall = ~here
    assert np.allclose(told["s"][wall], (map.arclength.offsets[-1] + told["theta"])[wall], rtol=0, atol=EPS)


@pytest.mark.slow
@pytest.mark.parametrize("lam", LAWS)
def test_kernels_and_arrays_tell_the_same_bounce(table, lam):
    map, start, where = started(table, lam)
    arrays = PinballMap(table.name, lam=lam, kernels=False, **table.shape)
    for name, one, other in zip(TOLD, map.step(*start, where), arrays.step(*start, where), strict=False):
        assert np.allclose(one, other, rtol=0, atol=1e-12, equal_nan=True), name


@pytest.mark.slow
def test_the_bits_do_not_depend_on_how_an_orbit_is_asked_for(table):
    map, (at, phi), where = started(table, 0.7)
    whole = map.orbit(at, phi, 12, where)
    few = map.orbit(at, phi, 12, where, fields=("phi", "s", "eta", "code"), every=4)
    alone = map.orbit(at[3], phi[3], 12, int(where[3]))
    pieces = [*map.orbit_pieces(at, phi, 12, where, fields=Orbit, piece=5 * at.size)]

    assert same(map.step(at, phi, where), (rows[1] for rows in whole))
    assert same((few["phi"], few["eta"], few["code"]), (whole.phi[::4], whole.eta[::4], whole.code[::4]))
    assert same((few["s"],), (map.orbit(at, phi, 12, where, fields=("s",))["s"][::4],))
    assert same(alone, (rows[:, 3] for rows in whole))
    assert [len(piece["theta"]) for piece in pieces] == [6, 5, 2]
    assert same((np.concatenate([piece[name] for piece in pieces]) for name in Orbit), whole)
    assert same(map.orbit(at, phi, 12, where, threads=3), whole)


@pytest.mark.parametrize("name", ["egg", "cuspless"])  # told as doubles throughout, and with components
def test_an_orbit_of_several_stretches_of_whole_blocks_has_the_bits_of_its_particles(name):
    map = PinballMap(name, lam=0.9, **({"alpha": 0.08} if name == "egg" else {}))
    at, bounces = np.linspace(-1, 1, 512), 2 * STRETCH // 512 + 3
    whole = map.orbit(at, 0.3, bounces)

    for i in (0, 3, 510, 511):
        assert same(map.orbit(at[i], 0.3, bounces), (rows[:, i] for rows in whole))


@pytest.mark.slow
def test_one_particle_by_itself_is_told_with_the_bits_that_it_has_among_others(table):
    map, (at, phi), where = started(table, 0.7)
    steps, slopes = map.step(at, phi, where), map.derivative(at, phi, where)
    for i in range(6):
        alone = float(at[i]), float(phi[i]), int(where[i])
        step = map.step(*alone)

        assert all(isinstance(value, np.generic) for value in step)
        assert same(step, (rows[i] for rows in steps))
        assert np.array_equal(map.derivative(*alone), slopes[i])


Orbit = ("component", "theta", "phi", "eta", "x", "y", "code")


@pytest.mark.slow
@pytest.mark.parametrize(
    "map",
    [
        PinballMap("egg", lam=0.6, kernels=False, alpha=0.08),
        PinballMap("circle", lam=0, kernels=False),
        PinballMap(tables.polar(1 + Rational(3, 5) * cos(theta), name="limacon"), lam=0.6),
    ],
)
def test_orbits_that_are_translated_and_those_of_other_tables_come_in_pieces_too(map):
    at, phi = np.linspace(-1, 1, 6).reshape(2, 3), 0.3 * (map.law != "slap")
    whole = map.orbit(at, phi, 10)
    pieces = [*map.orbit_pieces(at, phi, 10, fields=Orbit, piece=24, every=2)]

    assert whole.theta.shape == (11, 2, 3)
    assert same((np.concatenate([piece[name] for piece in pieces]) for name in Orbit), (rows[::2] for rows in whole))


@pytest.mark.parametrize("kernels", [True, False])
def test_a_ball_that_stops_repeats_its_last_bounce_however_it_is_told(kernels):
    """Three starts in the middle of the cardioid reach the cusp at once, after one bounce, and never."""
    map = PinballMap("cardioid", lam=1, kernels=kernels)
    cusp = np.array([0.5, 2.0])
    before = map.step(cusp, -cusp / 2)  # a ball flown backwards from where it aims at the cusp
    at, phi = np.array([0.5, before.theta[1], 0.7]), np.array([0.25, -before.phi[1], 0.1])
    whole = map.orbit(at, phi, 9)
    stopped = whole.code[-1] != 0

    assert stopped[0]
    assert not stopped[2]
    for particle in np.flatnonzero(stopped):
        first = int(np.argmax(whole.code[:, particle] != 0))
        assert np.all(np.isnan(whole.eta[first:, particle]))
        for rows in (whole.theta, whole.phi, whole.x, whole.y):
            assert np.all(rows[first:, particle] == rows[first - 1, particle])
    pieces = [*map.orbit_pieces(at, phi, 9, fields=Orbit, piece=6)]
    assert same((np.concatenate([piece[name] for piece in pieces]) for name in Orbit), whole)
    thinned = map.orbit(at, phi, 9, fields=Orbit, every=3)
    assert same((thinned[name] for name in Orbit), (rows[::3] for rows in whole))


def test_float32_is_the_rounding_of_what_is_told():
    map = PinballMap("cuspless", lam=0.8)
    whole, single = (map.orbit([0.1, 0.2], 0.3, 20, fields=FIELDS, dtype=kind) for kind in ("float64", "float32"))
    for name in FIELDS:
        kind = np.int64 if name in ("component", "code") else np.float32
        assert single[name].dtype == kind
        assert np.array_equal(single[name], whole[name].astype(kind), equal_nan=kind == np.float32)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"fields": ("theta", "z")}, "no field is called 'z'; an orbit has: component, theta"),
        ({"fields": ("theta",), "dtype": np.int32}, "dtype = int32 is not possible; give float64 or float32"),
        ({"fields": ("theta",), "every": 0}, "every = 0 is not possible; give a whole number of at least 1"),
    ],
)
def test_what_cannot_be_told_is_refused(given, reason):
    with pytest.raises(ValueError, match=reason):
        PinballMap("circle", lam=0.5).orbit(0.1, 0.2, 5, **given)
