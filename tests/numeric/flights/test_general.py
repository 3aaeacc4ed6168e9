"""Any table: the general path, on its own tables and against the special ones."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from sympy import Rational, cos, pi, sin, sqrt

from numeric import PinballMap
from numeric.flights.general import General
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from symbolic.tables.table import theta
from verification.maps import strategies
from verification.maps.exact import ExactMap, errors

WAVY = tables.polar(1 + cos(5 * theta) / 10, name="wavy")
MILD = tables.polar(1 + cos(5 * theta) / 40, name="mild")
ROUNDED = tables.parametric(cos(theta) * (1 + sin(theta) ** 2 / 9), sin(theta), name="rounded")
ROOTED = tables.polar(sqrt(1 + cos(theta) / 3), name="rooted")
STADIUM = tables.piecewise(
    tables.arc("right", 1 + cos(theta), sin(theta), -pi / 2, pi / 2),
    tables.arc("top", -theta, 1, -1, 1),
    tables.arc("left", -1 - cos(theta), -sin(theta), -pi / 2, pi / 2),
    tables.arc("bottom", theta, -1, -1, 1),
    name="stadium",
)
LENS = tables.piecewise(  # two parabolas, which have no closed form of their own
    tables.arc("lower", theta, (theta**2 - 1) / 2, -1, 1),
    tables.arc("upper", -theta, (1 - theta**2) / 2, -1, 1),
    name="lens",
)


def generally(map, table=None):
    """The same map, made to go the general way; of a table that is none of the paper's, given."""
    family = General(map.states.boundary)
    kernels = map.engine.kernels
    shape = dict(zip(map.engine.names, map.exact_shape, strict=True))
    other = PinballMap(table or map.ir.table, lam=map.lam, kernels=kernels, **shape)
    other.family = other.states.family = family
    other.engine = type(other.engine)(family, other.engine.identity + family.identity, other.engine.names, kernels)
    return other


@pytest.mark.parametrize(
    ("table", "path"),
    [
        (WAVY, "safe march"),
        (MILD, "chord polynomial"),
        (ROUNDED, "chord"),
        (ROOTED, "safe march"),
        (STADIUM, "closed form on every side and arc"),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_a_map_says_which_path_it_took(table, path):
    assert PinballMap(table, lam=1).path.startswith(path)


def test_the_general_way_agrees_with_the_special_ones(table):
    map = table.map(0.8)
    other = generally(map)
    where, theta0, phi = table.starts(map, 300, seed=21, steepest=0.99)
    one, two = map.step(theta0, phi, where), other.step(theta0, phi, where)

    assert np.array_equal(one.component, two.component)
    assert np.max(np.hypot(one.x - two.x, one.y - two.y) * np.cos(phi)) <= 64 * 2.0**-52
    assert np.max(np.abs(one.phi - two.phi) * np.cos(phi)) <= 64 * 2.0**-52


@pytest.mark.parametrize("table", [WAVY, ROOTED, STADIUM, ROUNDED, MILD], ids=lambda table: table.name)
def test_flights_on_any_table_are_the_exact_ones(table):
    map = PinballMap(table, lam=0.9)
    rng = np.random.default_rng(4)
    where = rng.integers(0, len(map.states.ends), 10)
    ends = np.array(map.states.ends)[where]
    start, phi = ends[:, 0] + np.ptp(ends, axis=1) * rng.uniform(0.05, 0.95, 10), rng.uniform(-1.2, 1.2, 10)
    own = map.states.enter(where, start, phi, map.law)
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(10, 0.9), map.shape, 1)
    position, direction = errors(map, ExactMap(map, 30), own, list(result.record[0]))

    assert max(position) <= 64
    assert max(direction) <= 64


def test_the_first_hit_is_taken_where_a_ray_meets_the_boundary_three_times():
    map = PinballMap(WAVY, lam=1)
    orbit = map.orbit(np.linspace(-3, 3, 200), np.linspace(-1.5, 1.5, 200), 20)
    middles = 0.5 * (orbit.x[1:] + orbit.x[:-1]), 0.5 * (orbit.y[1:] + orbit.y[:-1])
    at = np.arctan2(middles[1], middles[0])

    assert np.all(orbit.code == 0)
    assert np.all(np.hypot(*middles) <= 1 + np.cos(5 * at) / 10 + 1e-12)


def test_a_scaled_and_rotated_ellipse_needs_no_root_finding():
    tilted = tables.parametric(
        3 * cos(theta) + sin(theta) / 2 + 1, cos(theta) / 3 + 2 * sin(theta) - Rational(1, 2), name="tilted"
    )
    map = PinballMap(tilted, lam=1)
    step = map.step(np.linspace(-3, 3, 50), np.linspace(-1.4, 1.4, 50))
    error = np.abs(step.x - 3 * np.cos(step.theta) - np.sin(step.theta) / 2 - 1)

    assert map.path == "closed form in unit numbers"
    assert np.max(error) <= 8 * 2.0**-52


@settings(max_examples=30)
@given(strategies.particles(tables=[MILD, "ellipse", "egg"], lams=strategies.contractions(0.1, 1.0), steepest=1.4))
def test_an_angle_never_grows_at_a_reflection(ball):
    step = ball.map.step(ball.theta, ball.phi, ball.component)

    assert abs(step.phi) <= abs(step.eta) + 4 * 2.0**-52
    assert step.phi == pytest.approx(-ball.lam * float(step.eta), abs=8 * 2.0**-52)


@pytest.mark.parametrize("turns", [1, -3, 1000])
def test_parameters_beyond_a_turn_are_reduced(turns):
    shifted = tables.piecewise(
        tables.arc(
            "right", 1 + cos(theta), sin(theta), (2 * turns - Rational(1, 2)) * pi, (2 * turns + Rational(1, 2)) * pi
        ),
        *STADIUM.components[1:],
        name="shifted stadium",
    )
    start, phi = np.linspace(-0.9, 0.9, 50), np.linspace(1.2, -1.2, 50)
    one, other = (PinballMap(table, lam=0.9).step(start, phi, 2) for table in (STADIUM, shifted))
    right = one.component == 0
    turned = np.where(right, 2 * turns * np.pi, 0)
    rounding = 16 * 2.0**-52 * (1 + np.abs(turned)) / np.cos(one.eta)

    assert np.any(right)
    assert np.array_equal(one.component, other.component)
    assert np.all(np.abs(one.theta + turned - other.theta) <= rounding)
    assert np.all(np.hypot(one.x - other.x, one.y - other.y) <= rounding)


def test_parameters_of_a_million_are_refused():
    low, high = (pi * (2 * 10**6 + Rational(k, 2)) for k in (-1, 1))
    far = tables.piecewise(
        tables.arc("right", 1 + cos(theta), sin(theta), low, high), *STADIUM.components[1:], name="far"
    )

    with pytest.raises(ValueError, match="far: the parameter of right runs to"):
        PinballMap(far, lam=1)


@pytest.mark.parametrize(("end", "fine"), [(2**20, True), (2**20 + 1, False), (50, True)])
def test_a_parameter_may_run_to_a_million_and_no_further(end, fine):
    for sign in (1, -1):
        shift = sign * (end - 1)
        bottom = tables.arc("bottom", theta - shift, -1, shift - 1, shift + 1)
        table = tables.piecewise(*STADIUM.components[:3], bottom, name="far")
        if fine:
            assert PinballMap(table).states.ends[3] == (shift - 1, shift + 1)
        else:
            with pytest.raises(ValueError, match="the parameter of bottom runs to"):
                PinballMap(table)


def test_a_word_outside_the_vocabulary_is_an_error():
    from sympy import erf

    with pytest.raises(ValueError, match="beyond the kernels' words"):
        PinballMap(tables.polar(1 + erf(cos(theta)) / 20, name="bell"), lam=1)


def test_landings_on_the_cut_between_two_pieces_are_found():
    map = generally(PinballMap("ellipse", lam=1, a=2))
    step = map.step([0.0, np.pi, -np.pi, np.pi / 2], 0.0)

    assert [status.name for status in step.status] == ["REGULAR"] * 4
    assert np.allclose(step.x, [-2, 2, 2, 0], rtol=0, atol=1e-15)
    assert ExactMap(map, 30).bounce(ExactMap(map, 30).start(0, 0)).code == 0


WAISTED = tables.polar(1 + cos(2 * theta) / 2, name="waisted")
SKEWED = tables.polar(1 + cos(2 * theta) / 2 + sin(3 * theta) / 5, name="skewed")
INSIDE = {
    "wavy": lambda x, y: 1 + np.cos(5 * np.arctan2(y, x)) / 10 - np.hypot(x, y),
    "waisted": lambda x, y: 1 + np.cos(2 * np.arctan2(y, x)) / 2 - np.hypot(x, y),
    "rooted": lambda x, y: np.sqrt(1 + np.cos(np.arctan2(y, x)) / 3) - np.hypot(x, y),
    "stadium": lambda x, y: 1 - np.hypot(np.maximum(abs(x) - 1, 0), y),
}


def particles(map, count, seed=6, steepest=1.4):
    """Random particles on all components."""
    rng = np.random.default_rng(seed)
    where = rng.integers(0, len(map.states.ends), count)
    ends = np.array(map.states.ends)[where]
    at = ends[:, 0] + np.ptp(ends, axis=1) * rng.uniform(0.002, 0.998, count)
    return where, at, rng.uniform(-steepest, steepest, count)


@pytest.mark.parametrize("table", [WAVY, WAISTED, ROOTED, STADIUM], ids=lambda table: table.name)
def test_flights_are_straight_inside_and_reflected_by_the_law(table):
    map = PinballMap(table, lam=0.6, kernels=False)
    where, at, phi = particles(map, 150)
    step, (x, y) = map.step(at, phi, where), map.states.point(where, at)
    vx, vy = map.states.direction(where, at, phi)
    dx, dy = step.x - x, step.y - y
    tx, ty = map.states.tangent(step.component, step.theta)
    eta = -np.arctan2(vx * tx + vy * ty, vx * ty - vy * tx)
    share = np.linspace(0.01, 0.99, 99)[:, None]

    assert not step.code.any()
    assert np.max(np.abs(dx * vy - dy * vx)) <= 64 * 2.0**-52
    assert np.min(dx * vx + dy * vy) > 0
    assert np.min(INSIDE[table.name](x + share * dx, y + share * dy)) > 0
    assert np.max(np.abs(INSIDE[table.name](step.x, step.y))) <= 64 * 2.0**-52
    assert np.max(np.abs(step.phi + 0.6 * eta) * np.cos(eta)) <= 1e-13


@pytest.mark.parametrize("lam", [0, 0.6])
@pytest.mark.parametrize("table", [WAVY, STADIUM], ids=lambda table: table.name)
def test_the_derivative_is_the_papers_matrix_on_any_table(table, lam):
    map = PinballMap(table, lam=lam, kernels=False)
    where, at, phi = particles(map, 40, steepest=1.0)
    phi = phi * (lam > 0)
    step, (x, y) = map.at(lam=1).step(at, phi, where), map.states.point(where, at)
    k0, k1 = map.states.curvature(where, at), map.states.curvature(step.component, step.theta)
    t, c0, c1 = np.hypot(step.x - x, step.y - y), np.cos(phi), np.cos(step.eta)
    a = t * k0 + c0
    formula = (
        -np.moveaxis(np.array([[a, t], [lam * (k1 * a + k0 * c1), lam * (k1 * t + c1)]]), -1, 0) / c1[:, None, None]
    )
    size = np.max(np.abs(formula), axis=(1, 2))[:, None, None] ** 2 + 1

    assert np.max(np.abs(map.derivative(at, phi, where) - formula) / size) <= 1e-12


@pytest.mark.parametrize("table", [WAVY, WAISTED, SKEWED, STADIUM, ROOTED], ids=lambda table: table.name)
def test_pieces_cover_the_boundary_and_turn_one_way_by_a_quarter_at_most(table):
    map = PinballMap(table, kernels=False)
    for component, (low, high) in enumerate(map.states.ends):
        pieces = [(a, b) for index, a, b in General(map.states.boundary).pieces if index == component]
        assert pieces[0][0] == low
        assert high <= pieces[-1][1] <= high + 2.0**-46
        assert all(one[1] == two[0] for one, two in pairwise(pieces))
        assert len(pieces) <= 16  # ten inflections, and six quarters beside them
        for a, b in pieces:
            at = np.linspace(a, b, 41)[1:-1]
            _, _, dx, dy, ax, ay = map.states.boundary.curve(np.full(39, component), at)
            turning, angle = dx * ay - dy * ax, np.unwrap(np.arctan2(dy, dx))
            assert np.all(turning > -1e-12) or np.all(turning < 1e-12)
            assert np.ptp(angle) <= np.pi / 2 + 1e-2


@pytest.mark.parametrize("table", [WAVY, WAISTED, SKEWED, STADIUM, ROOTED], ids=lambda table: table.name)
def test_a_piece_ends_at_an_inflection_or_where_it_has_turned_by_a_quarter(table):
    """So there are as few as can be: at an inflection the turning changes sign within two roundings."""
    map = PinballMap(table, kernels=False)

    def turning(component, at):
        _, _, dx, dy, ax, ay = map.states.boundary.curve(np.full(at.size, component), at)
        return dx * ay - dy * ax

    for (component, a, b), (following, *_) in pairwise(General(map.states.boundary).pieces):
        if component != following:
            continue
        _, _, dx, dy, _, _ = map.states.boundary.curve(np.full(401, component), np.linspace(a, b, 401))
        turned = abs(np.ptp(np.unwrap(np.arctan2(dy, dx))))
        low, high = map.states.ends[component]
        step = 2 * (high - low) / 4096 * np.max(np.abs(turning(component, np.linspace(a, b, 401)) / (dx**2 + dy**2)))
        before, after = turning(component, b + np.array([-4, 4]) * np.spacing(b))

        assert before * after <= 0 or np.pi / 2 - step <= turned <= np.pi / 2 + 1e-5


@pytest.mark.parametrize("where", [0, 1, 2, 3])
def test_on_any_table_a_landing_within_rounding_of_a_join_is_one(where):
    """From the middle of each side of the stadium to each of its joins, and past them by 1e-9 on either side."""
    map = PinballMap(STADIUM, lam=0.5, kernels=False)
    (x, y) = (float(a[0]) for a in map.states.point(np.array([where]), np.array([0.1])))
    for jx, jy in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        if abs(jy - y) < 0.5 and where in (1, 3):
            continue  # along the side
        aim = np.arctan2(jy - y, jx - x)
        phi = float(map.states.angle_to_normal(np.array([where]), np.array([0.1]), np.cos(aim), np.sin(aim))[0])
        near = phi + np.arange(-9, 10) * 2.0**-53
        found = map.step(np.full(2, 0.1), phi + np.array([1e-9, -1e-9]), where)

        assert 1 in map.step(np.full(19, 0.1), near, where).code
        assert found.code.tolist() == [0, 0]
        assert found.component[0] != found.component[1]


def test_slap_maps_of_any_table_leave_along_the_unit_normal():
    map = PinballMap(WAVY, lam=0, kernels=False)
    _, at, _ = particles(map, 30)
    own = map.states.enter(np.zeros(30, dtype=int), at, 0 * at, "slap")
    nx, ny = map.family.slapped(map.states.ops, map.shape, own)
    tx, ty = map.states.tangent(np.zeros(30, dtype=int), at)

    assert np.max(np.abs([nx + ty, ny - tx])) <= 4 * 2.0**-52


@pytest.mark.parametrize(("table", "status"), [(WAVY, "LOST"), (LENS, "JOIN")], ids=["closed", "pieces"])
def test_a_particle_that_lands_nowhere_is_lost_or_slipped_through_a_join(table, status):
    map = generally(PinballMap(table, lam=0.5, kernels=False), table)
    map.family.pieces = []

    assert [found.name for found in map.step([0.1, 0.2], 0.3).status] == [status] * 2
