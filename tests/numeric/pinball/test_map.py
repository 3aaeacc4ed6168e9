"""The answers of a map: fields, shapes and starts, by the definition of the map and of its exponents."""

import numpy as np
import pytest
from sympy import Rational, cos, pi, sin

from numeric import PinballMap, Status
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
LAWS = [0, 0.3, 1]


@pytest.mark.parametrize("lam", LAWS)
def test_an_orbit_tells_every_angle_and_place_of_its_bounces(table, lam, bounced):
    map = table.map(lam, kernels=False)
    where, at, phi = table.starts(map, 30, seed=4, steepest=0.95)
    orbit = map.orbit(at, phi, 3, where)

    assert np.all(np.isnan(orbit.eta[0]))
    assert np.array_equal([orbit.component[0], orbit.theta[0], orbit.phi[0]], [where, at, phi])
    for i in range(3):
        steps = bounced(map.at(lam or 1e-320), orbit.component[i], orbit.theta[i], orbit.phi[i])
        graze = np.cos(steps.eta)
        assert np.array_equal(orbit.component[i + 1], steps.where)
        assert np.max(np.abs(orbit.theta[i + 1] - steps.theta) * graze) <= 1e-12
        assert np.max(np.abs(orbit.eta[i + 1] - steps.eta) * graze) <= 1e-12
        assert np.max(np.abs(orbit.phi[i + 1] + lam * orbit.eta[i + 1])) <= 16 * EPS
        (x, y), *_ = table.boundary(orbit.component[i + 1], orbit.theta[i + 1], map.shape)
        assert np.max(np.hypot(orbit.x[i + 1] - x, orbit.y[i + 1] - y)) <= 4 * EPS
    assert not orbit.code.any()
    if lam == 0:
        assert not orbit.phi[1:].any()


def test_answers_have_the_shape_of_the_starts():
    map = PinballMap("cuspless", lam=0.4, kernels=False)
    at, phi = np.linspace(-1, 1, 3)[:, None], np.array([[0.1, 0.2]])
    orbit, step, wanted = map.orbit(at, phi, 4), map.step(at, phi), map.exponents(at, phi, 5)

    assert {field.shape for field in orbit} == {(5, 3, 2)}
    assert {field.shape for field in step} == {(3, 2)}
    assert {field.shape for field in wanted} == {(3, 2)}
    assert map.derivative(at, phi).shape == (3, 2, 2, 2)
    assert (map.step(0.1).theta.shape, map.derivative(0.1, 0.0).shape) == ((), (2, 2))
    assert {field.shape for field in map.exponents(0.1, 0.2, 5)} == {()}
    assert map.exponents(0.1, 0.2, 5, component=[0, 0]).nu_plus.shape == (2,)


@pytest.mark.parametrize("lam", LAWS)
def test_derivatives_of_many_particles_are_those_of_each(table, lam):
    map = table.map(lam, kernels=False)
    where, at, phi = (x.reshape(2, 2) for x in table.starts(map, 4, seed=6, steepest=0.9))
    together = map.derivative(at, phi, where)

    for i in np.ndindex(2, 2):
        assert np.array_equal(together[i], map.derivative(at[i], phi[i], where[i]))


def by_products(map, where, at, phi, bounces, transient):
    """Both exponents by products of derivative matrices along an orbit, from the generic vector (0.8, 0.6)."""
    orbit = map.orbit(at, phi, bounces + transient, where)
    vector, sums, volume = np.array([0.8, 0.6]), 0.0, 0.0
    for i in range(transient, transient + bounces):
        matrix = map.derivative(orbit.theta[i], orbit.phi[i], orbit.component[i])
        vector = matrix @ vector
        sums += np.log(np.linalg.norm(vector))
        vector = vector / np.linalg.norm(vector)
        volume += np.log(abs(np.linalg.det(matrix)))
    return sums / bounces, (volume - sums) / bounces


@pytest.mark.parametrize("transient", [0, 3])
@pytest.mark.parametrize("bounces", [1, 9])
def test_exponents_are_the_growth_of_one_vector_and_of_the_area(table, bounces, transient):
    map = table.map(0.6, kernels=False)
    where, at, phi = table.starts(map, 3, seed=2, steepest=0.8)
    found = map.exponents(at, phi, bounces, transient, where)
    orbit = map.orbit(at, phi, bounces + transient, where)
    for i in range(3):
        pair = sorted(by_products(map, where[i], at[i], phi[i], bounces, transient))
        assert [found.nu_minus[i], found.nu_plus[i]] == pytest.approx(pair, abs=1e-9)

    assert found.bounces.tolist() == [bounces] * 3
    assert np.allclose(found.theta, orbit.theta[-1], rtol=0, atol=1e-9)
    assert np.allclose(found.phi, orbit.phi[-1], rtol=0, atol=1e-9)
    assert np.array_equal(found.component, orbit.component[-1])


def test_at_slap_the_larger_exponent_is_that_of_the_slope(table):
    map = table.map(0, kernels=False)
    where, at, _ = table.starts(map, 3, seed=2)
    found = map.exponents(at, 0.0, 5, component=where)
    orbit = map.orbit(at, 0.0, 5, where)
    slopes = [map.slap(orbit.theta[i], 1, orbit.component[i]).slope for i in range(5)]

    assert np.allclose(found.nu_plus, np.mean(np.log(np.abs(slopes)), axis=0), rtol=0, atol=1e-12)
    assert np.all(found.nu_minus == -np.inf)


def test_a_slap_orbit_is_that_of_lam_0_whatever_lam_is(table):
    map = table.map(0.6, kernels=False)
    where, at, _ = table.starts(map, 4, seed=2)
    slap, orbit = map.slap(at, 3, where), map.at(lam=0).orbit(at, 0.0, 3, where)

    assert np.array_equal(slap.theta, orbit.theta)
    assert np.array_equal(slap.component, orbit.component)
    assert slap.theta.shape == (4, 4)
    assert np.array_equal(slap.slope, map.at(lam=0).derivative(at, 0.0, where)[..., 0, 0])
    assert float(map.lam) == 0.6


def test_a_ball_that_does_not_start_along_the_normal_is_no_ball_of_the_slap_map(table):
    """Its first flight is another, and then it goes as the slap map does."""
    map = table.map(0, kernels=False)
    where, at, phi = table.starts(map, 5, seed=3, steepest=0.8)
    orbit, after = map.orbit(at, phi, 2, where), map.at(lam=0.5).step(at, phi, where)

    assert np.allclose(orbit.theta[1], after.theta, rtol=0, atol=8 * EPS)
    assert not orbit.phi[1:].any()
    assert np.allclose(map.derivative(at, phi, where)[..., 1, :], 0)


def test_laws_and_lams():
    assert [PinballMap("circle", lam=lam).law for lam in (0, 1, "1/2", [0.0, 1.0], [1.0, 1.0], [0.0, 0.0])] == [
        "slap", "elastic", "pinball", "pinball", "elastic", "slap",
    ]  # fmt: skip
    assert PinballMap("circle").law == "elastic"
    map = PinballMap("circle", lam=[[0.5, 0.25]], kernels=False)
    assert map.step([[0.0, 0.0]], 0.8).phi.tolist() == [[0.4, 0.2]]


def test_a_ball_that_stopped_repeats_its_last_state_with_its_outcome():
    map = PinballMap("cardioid", lam=0.9, kernels=False)
    first = map.step(0.3, 0.4)
    aimed = 2 * float(map.step(0.3, 0.4).phi)  # from here the next exit points at the cusp
    orbit = map.orbit([0.3, aimed, 0.0], [0.4, aimed / 2, 0.1], 3)

    assert orbit.code.tolist() == [[0, 0, 0], [0, 2, 0], [0, 2, 0], [0, 2, 0]]
    assert orbit.theta[:, 1].tolist() == [aimed] * 4
    assert orbit.phi[:, 1].tolist() == [aimed / 2] * 4
    assert np.isnan(orbit.eta).tolist() == [[True] * 3, *[[False, True, False]] * 3]
    assert orbit.theta[1, 0] == first.theta
    assert orbit.status[1, 1] == Status.CUSP


@pytest.mark.parametrize("turns", [-2, -1, 1, 3])
@pytest.mark.parametrize("name", ["circle", "egg"])
def test_a_parameter_beyond_the_ends_of_a_closed_curve_is_wound_back(name, turns):
    map = PinballMap(name, kernels=False, **({"alpha": "0.05"} if name == "egg" else {}))
    wound, plain = (map.orbit(0.3 + 2 * np.pi * k, 0.2, 1) for k in (turns, 0))

    assert abs(wound.theta[0] - 0.3) <= 16 * EPS * abs(turns)
    assert abs(wound.x[1] - plain.x[1]) <= 64 * EPS


@pytest.mark.parametrize("at", [2.1, -2.1, 7.0])
def test_a_parameter_beyond_an_open_component_is_refused(at):
    map = PinballMap("cuspless", kernels=False)
    with pytest.raises(ValueError, match=rf"theta = {at} is not on the arc; there theta lies in \[-2\.09"):
        map.step([0.0, at], 0.0)
    with pytest.raises(ValueError, match=r"theta = 0\.5 is not on the wall"):
        map.step([0.5, 0.0], 0.0, [1, 0])
    low, high = map.states.ends[0]
    assert map.step([low, high], [-0.3, 0.3]).theta.shape == (2,)


@pytest.mark.parametrize("phi", [np.pi / 2, -np.pi / 2, 3.0])
def test_an_exit_along_the_boundary_or_out_of_the_table_is_refused(phi):
    with pytest.raises(ValueError, match="does not point into the table"):
        PinballMap("circle", kernels=False).step([0.0, 1.0], [0.0, phi])


@pytest.mark.parametrize(("gap", "refused"), [(0.0, True), (1e-16, True), (1e-13, False)])
def test_the_cusp_is_a_point(gap, refused):
    map = PinballMap("cardioid", kernels=False)
    at = np.pi - gap
    if refused:
        with pytest.raises(ValueError, match=r"theta = 3.14.* is the cusp"):
            map.step([0.0, at], 0.0)
    else:
        assert map.step([0.0, at], 0.5).theta.shape == (2,)
    assert PinballMap("circle", kernels=False).step(np.pi, 0.1).code == 0


def test_particles_and_contractions_must_fit():
    with pytest.raises(ValueError, match=r"lam has shape \(2,\) and the particles \(2, 2\)"):
        PinballMap("circle", lam=[0.5, 0.6], kernels=False).step(np.zeros((2, 2)))
    assert PinballMap("circle", lam=[0.5], kernels=False).step(np.zeros((2, 2)), 0.4).phi.tolist() == [[0.2, 0.2]] * 2


def test_shapes_are_taken_exactly_and_by_name():
    map = PinballMap("ellipse", a=0.1 + 1)
    assert (map.exact_shape[0], map.shape) == (Rational(11, 10), [1.1])
    with pytest.raises(ValueError, match="circle: no shape parameter a; it has: none"):
        PinballMap("circle", a=2)
    with pytest.raises(ValueError, match=r"ellipse: the shape parameter a needs a value, as in PinballMap\(..., a="):
        PinballMap("ellipse")


@pytest.mark.parametrize(
    ("table", "path"),
    [
        ("circle", "closed"),
        ("ellipse", "closed"),
        ("cardioid", "cubic"),
        ("cuspless", "the cardioid's"),
        ("egg", "chord"),
    ],
)
def test_paths_of_the_papers_tables(table, path):
    shape = {"ellipse": {"a": 2}, "egg": {"alpha": "1/10"}}.get(table, {})

    assert PinballMap(table, **shape).path.startswith(path)


@pytest.mark.parametrize(("share", "path"), [("1/26", "chord"), ("1/25", "safe march"), ("1/10", "safe march")])
def test_a_dented_fourier_sum_has_its_first_hit_searched(share, path):
    """A five-cornered egg is convex up to 1/26."""
    made = tables.polar(1 + Rational(share) * cos(5 * theta), name="five")

    assert PinballMap(made).path.startswith(path)


def test_the_dent_may_be_anywhere():
    turned = tables.parametric(cos(theta), sin(theta) + 2 * sin(2 * theta) / 5, name="turned")

    assert PinballMap(turned).path.startswith("every zero")


def test_boundary_points_are_located_in_arrays():
    map = PinballMap("cuspless", kernels=False)
    x, y = np.array([[2.0, -0.25], [0.0, 0.0]]), np.array([[0.0, 0.2], [1.0, -1.0]])
    component, at = map.locate(x, y)

    assert component.tolist() == [[0, 1], [0, 0]]
    assert np.allclose(at, [[0.0, -0.2], [np.pi / 2, -np.pi / 2]], rtol=0, atol=8 * EPS)
    with pytest.raises(ValueError, match=r"the point \(-0\.25, 0\.5\) is not on the boundary; it is 0\.0\d+ away"):
        map.locate([-0.25, -0.25], [0.1, 0.5])
    with pytest.raises(ValueError, match="x and y are empty"):
        map.locate([], [])


def test_a_point_within_a_billionth_of_the_tables_size_is_on_the_boundary():
    map = PinballMap("ellipse", a=1000, kernels=False)

    assert abs(map.locate(1000 + 9e-7, 0.0)[1]) < 1e-9
    with pytest.raises(ValueError, match=r"is not on the boundary; it is 1\.1e-06 away"):
        map.locate(1000 + 1.1e-6, 0.0)


def test_what_is_not_said_is_along_the_normal_once_and_compiled():
    map = PinballMap("ellipse", lam=0.5, a=2)

    assert map.engine.kernels
    assert map.step(0.3).theta == map.step(0.3, 0.0, 0).theta
    assert map.slap(0.3).theta.shape == (2,)
    assert map.arclength is map.arclength
    assert map.exponents(0.3, 0.2, 5).theta == map.exponents(0.3, 0.2, 5, 0, 0).theta
    with pytest.raises(ValueError, match="transient = -1 is not possible; give a whole number of at least 0"):
        map.exponents(0.3, 0.2, 5, transient=-1)
    with pytest.raises(ValueError, match="bounces = 0 is not possible"):
        map.exponents(0.3, 0.2, 0)


def test_a_ball_that_never_bounced_has_grown_by_nothing():
    found = PinballMap("cardioid", lam=0.5, kernels=False).exponents([0.3, 0.0], [0.1, 0.0], 4)

    assert found.nu_plus[1] == 0
    assert found.nu_minus[1] == np.log(0.5)
    assert np.isfinite(found.nu_plus[0])


def test_of_several_mistakes_the_first_is_named():
    cardioid, cuspless = (PinballMap(name, kernels=False) for name in ("cardioid", "cuspless"))

    with pytest.raises(ValueError, match=r"phi = 1\.6 does not"):
        cardioid.step(0.0, [0.0, 1.6, 1.7])
    with pytest.raises(ValueError, match=r"theta = -3\.14"):
        cardioid.step([0.0, -np.pi, np.pi], 0.0)
    with pytest.raises(ValueError, match=r"theta = 2\.5 is not on the arc"):
        cuspless.step([0.0, 2.5, 2.6], 0.0)
    with pytest.raises(ValueError, match="theta and phi are empty; give at least one particle"):
        cardioid.step([], [])


@pytest.mark.parametrize(("low", "high", "turn"), [(-3, 3, pi / 3), (-1, 2 * pi - 1, 1)])
def test_a_parameter_is_wound_back_only_where_a_turn_is_two_pi(low, high, turn):
    """The circle, once with a parameter from -3 to 3, and once from -1 to one turn more."""
    made = tables.piecewise(tables.arc("round", cos(turn * theta), sin(turn * theta), low, high), name="round")
    map = PinballMap(made, lam=0.5, kernels=False)
    if turn == 1:
        assert float(map.step(-2.0, 0.3).x) == pytest.approx(float(PinballMap("circle").step(-2.0, 0.3).x), abs=1e-14)
    else:
        with pytest.raises(ValueError, match=r"theta = 3\.1 is not on the round"):
            map.step(3.1, 0.3)
