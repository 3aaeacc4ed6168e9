"""Tables given by their radius: the march jumps over no zero, and lands as exactly as the paper's own tables."""

import itertools

import mpmath
import numpy as np
import pytest
from sympy import Interval as Range
from sympy import Rational, Symbol, cos

from numeric import PinballMap, Status
from numeric.backends.doubled import Doubles
from numeric.backends.intervals import Interval, Intervals, Secant, Secants, whole_turn
from numeric.backends.scalars import ArrayBackend, ScalarBackend
from numeric.flights import polar as polar_flights
from numeric.flights.general import General
from numeric.flights.polar import STEEP, Polar, bounds, rounded_up
from numeric.kernels.machine import KernelSpec
from symbolic import tables
from symbolic.tables.table import Shape, theta
from verification.maps.exact import ExactMap, errors

EPS = 2.0**-52
RADII = {
    "limacon": "1 + 3*cos(theta)/5",
    "star": "1 + cos(5*theta)/4",
    "waves": "1 + cos(40*theta)/2000",
    "peanut": "exp(cos(2*theta)/4)",
    "words": "1 + tanh(cos(3*theta))/5 + atan(sin(theta))/9 + log(2 + sin(theta))/9",
}
WORDS = ("sqrt", "exp", "log", "sin", "cos", "sinh", "cosh", "tanh", "atan")


@pytest.fixture(scope="module", params=list(RADII))
def polar(request):
    """A map of the contraction given, on arrays."""
    table = tables.polar(RADII[request.param], name=request.param)
    return lambda lam=0.9: PinballMap(table, lam=lam, kernels=False)


@pytest.fixture(scope="module", params=["limacon", "peanut"])
def exactly(request):
    """Those that are held against exact landings, which take long."""
    return PinballMap(tables.polar(RADII[request.param]), lam=0.9, kernels=False)


def flown(map, theta, phi):
    """Fields before and after one bounce."""
    own = map.states.enter(np.zeros(theta.size, dtype=np.int64), theta, phi, map.law)
    lam = np.full(theta.size, float(map.lam))
    result = map.engine.run(KernelSpec(map.law, record=True), own, lam, map.shape, 1)
    return own, list(result.record[0]), result.rows["code"]


def anywhere(count, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-np.pi, np.pi, count), np.arcsin(rng.uniform(-1, 1, count))


def bulges(map, count, seed):
    """Starts whose rays miss or cut a dispersing arc by an angle of 1e-6 to 1e-1; none where there is no such arc."""
    rng, grid = np.random.default_rng(seed), np.linspace(-np.pi, np.pi, 4001)
    zero = np.zeros(grid.size, dtype=np.int64)
    bent = grid[map.states.boundary.bending(zero, grid)[1] > 1e-6]
    if not bent.size:
        return bent, bent
    at, zero, side = rng.choice(bent, count), np.zeros(count, dtype=np.int64), rng.choice([-1, 1], count)
    back = map.step(at, side * (np.pi / 2 - 1e-9))
    x0, y0 = map.states.point(zero, at)
    aim = map.states.angle_to_normal(zero, back.theta, x0 - back.x, y0 - back.y)
    aim = aim + rng.choice([-1, 1], count) * 10 ** rng.uniform(-6, -1, count)
    good = np.abs(aim) < np.pi / 2 - 1e-3
    return back.theta[good], aim[good]


@pytest.mark.parametrize("kind", ["anywhere", "bulges"])
def test_the_ray_is_inside_the_table_until_it_lands(polar, kind):
    map = polar()
    theta, phi = anywhere(400, 1) if kind == "anywhere" else bulges(map, 200, 2)
    if not theta.size:
        return
    own, found, code = flown(map, theta, phi)
    (x0, y0), (x1, y1) = (map.family.point(ArrayBackend(), *fields[:2]) for fields in (own, found))
    t = (x1 - x0) * own[2] + (y1 - y0) * own[3]
    part = np.linspace(0.001, 0.999, 200)[:, None]
    x, y = x0 + part * t * own[2], y0 + part * t * own[3]
    away = np.hypot(x, y)
    radius = map.family.radius(ArrayBackend(), x / away, y / away)[0]

    assert not code.any()
    assert np.all(t > 0)
    assert np.max(away - radius) < 64 * EPS


def test_random_landings_are_the_exact_ones(exactly):
    map = exactly
    theta, phi = anywhere(5, 3)
    own, found, _ = flown(map, theta, phi)
    matrix = np.abs(map.derivative(theta, phi))
    position, direction = errors(map, ExactMap(map, 30), own, found)

    assert np.all(position <= np.maximum(4, 2 * (1 + matrix[:, 0].sum(axis=-1))))
    assert np.all(direction <= np.maximum(8, 4 * (1 + matrix[:, 1].sum(axis=-1))))


@pytest.mark.parametrize(
    ("name", "lam", "kernels"),
    [*itertools.product(["limacon", "star", "peanut", "words"], [0, 0.95], [False]), ("peanut", 0.95, True)],
)
def test_landings_with_large_condition_numbers_are_right_to_the_last_bits(name, lam, kernels):
    """The worst of four hundred: without a residual with more digits they are off by half a condition number."""
    map = PinballMap(tables.polar(RADII[name]), lam=lam, kernels=kernels)
    theta, phi = anywhere(400, 8)
    phi = phi if lam else 0 * phi
    matrix = 1 + np.abs(map.derivative(theta, phi))[:, 0].sum(axis=-1)
    worst = np.argsort(matrix)[-2:]
    own, found, code = flown(map, theta[worst], phi[worst])
    position, direction = errors(map, ExactMap(map, 30), own, found)

    assert not code.any()
    assert np.max(position) <= 1
    assert np.max(direction) <= 8


def test_a_short_flight_stays_with_the_divided_equation_where_words_have_ten_bits_more(monkeypatch):
    """Else it is off by those ten bits over its length: 2**-63/1e-9 in place of a condition number."""
    map, theta = PinballMap(tables.polar(RADII["peanut"]), lam=0.9, kernels=False), np.array([-2.8, -0.9, 0.3, 1.6])
    phi = np.full(4, np.pi / 2 - 1e-9)

    def largest():
        own, found, _ = flown(map, theta, phi)
        return errors(map, ExactMap(map, 30), own, found)[0].max()

    assert largest() <= 40
    monkeypatch.setattr(polar_flights, "SHORT", 0.0)
    assert largest() >= 1000


def test_programs_run_with_twice_the_digits():
    mp = mpmath.MPContext()
    mp.dps = 50
    program = PinballMap(tables.polar("sqrt(3 + pi*cos(5*theta)/7)/(2 - sin(theta)/3)"), lam=0, kernels=False).ir
    program = program.program("radius").only(0, 1)
    doubles, angle = Doubles(ArrayBackend()), np.linspace(-3, 3, 7)
    c, s = doubles.unit((np.cos(angle), np.sin(angle)))
    for i, x in enumerate(angle):
        known = mp.matrix([mp.mpf(np.cos(x)), mp.mpf(np.sin(x))])
        known = known / mp.norm(known)
        truth = program(ScalarBackend(mp), *known)
        for value, exact in zip(program(doubles, c, s), truth, strict=True):
            assert abs(mp.mpf(value.high[i]) + mp.mpf(value.low[i]) - exact) <= mp.mpf(2) ** -97


def test_flights_along_the_wall_are_as_exact_as_their_condition_allows(exactly):
    map, theta = exactly, np.array([-2.9, -1.2, 0.4, 2.7])
    phi = np.array([1, -1, 1, -1]) * (np.pi / 2 - np.array([1e-12, 1e-2, 1e-8, 1e-5]))
    own, found, code = flown(map, theta, phi)
    matrix = np.abs(map.derivative(theta, phi))
    position, direction = errors(map, ExactMap(map, 30), own, found)

    assert not code.any()
    assert np.all(position <= 4 * (1 + matrix[:, 0].sum(axis=-1)))
    assert np.all(direction <= 8 * (1 + matrix[:, 1].sum(axis=-1)))


def test_rays_that_touch_a_bulge_take_the_first_of_three_hits():
    map = PinballMap(tables.polar(RADII["star"]), lam=0.9, kernels=False)
    theta, phi = bulges(map, 3, 4)
    own, found, _ = flown(map, theta, phi)
    matrix = np.abs(map.derivative(theta, phi))
    position, direction = errors(map, ExactMap(map, 30), own, found)

    assert np.all(position <= 8 * (1 + matrix[:, 0].sum(axis=-1)))
    assert np.all(direction <= 8 * (1 + matrix[:, 1].sum(axis=-1)))


def test_a_flight_along_an_almost_straight_wall_ends():
    """Next to the limacon's inflection, 1.4e-12 from the tangent: one bound for all of the wall makes 1e5 steps."""
    map = PinballMap(tables.polar(RADII["limacon"]), lam="0.95", kernels=False)
    step = map.step(2.84273043, -(np.pi / 2 - 1.37645451e-12))

    assert step.status is Status.REGULAR
    assert step.theta == pytest.approx(2.8415437, abs=1e-6)


def test_a_conic_about_the_origin_is_met_in_one_step():
    """`w` is constant there, so that the bound of the march is the boundary itself: `1/r = 2 + cos(theta)/2`."""
    map = PinballMap(tables.polar("1/(2 + cos(theta)/2)"), lam=1, kernels=False)
    map.family = map.states.family = Polar(map.states.boundary)  # it has a closed form, which is taken otherwise
    map.engine = type(map.engine)(map.family, "", map.engine.names, False)
    low, high = (1 / (2 + sign / 2) for sign in (1, -1))
    a, c = (low + high) / 2, (high - low) / 2
    theta, phi = anywhere(200, 6)
    step = map.step(theta, phi)
    x, y = step.x + c, step.y

    assert map.family.bounds.highest == rounded_up(2 + 1e-6)
    assert np.max(np.abs((x / a) ** 2 + y**2 / (a**2 - c**2) - 1)) < 16 * EPS
    foci = (np.hypot(x - s * c, y) for s in (1, -1))
    assert np.max(np.abs(sum(foci) - 2 * a)) < 8 * EPS


@pytest.mark.parametrize("name", ["star", "peanut"])
def test_derivatives_and_exponents_are_those_of_the_general_flight(name):
    map = PinballMap(tables.polar(RADII[name]), lam="0.9", kernels=False)
    general = PinballMap(tables.polar(RADII[name]), lam="0.9", kernels=False)
    general.family = general.states.family = General(map.states.boundary)
    general.engine = type(general.engine)(general.family, "", general.engine.names, False)
    theta, phi = np.array([0.3, -2.0, 1.1]), np.array([0.2, -0.5, 0.9])
    one, other = (each.exponents(theta, phi, 4) for each in (map, general))

    assert np.allclose(map.derivative(theta, phi), general.derivative(theta, phi), rtol=1e-12, atol=0)
    assert np.allclose(one.nu_plus, other.nu_plus, rtol=0, atol=1e-11)
    assert np.allclose(one.nu_minus, other.nu_minus, rtol=0, atol=1e-11)


def test_a_letter_of_the_radius_is_a_parameter_of_the_kernel_and_near_values_share_one():
    b = Symbol("b", real=True)
    table = tables.polar(1 + b * cos(theta), "dented", [Shape(b, Range(0, Rational(3, 4)), "makes the radius small")])
    maps = [PinballMap(table, lam="0.9", kernels=False, b=value) for value in ("0.6", "0.601", "0.7")]
    fixed = PinballMap(tables.polar(RADII["limacon"]), lam="0.9", kernels=False)
    start = np.array([0.3, 2.0]), np.array([0.2, -0.5])

    assert {map.family.name for map in maps} == {"polar"}
    assert maps[0].family.identity == maps[1].family.identity != maps[2].family.identity
    assert np.max(np.abs(maps[0].step(*start).theta - fixed.step(*start).theta)) < 4 * EPS


def test_slap_flights_stop_at_a_bulge_too():
    map = PinballMap(tables.polar(RADII["star"]), lam=0, kernels=False)
    orbit = map.orbit(np.linspace(-3, 3, 50), 0.0, 20)

    assert not np.any(orbit.code[-1] == Status.LOST.code)
    assert np.all(np.isfinite(orbit.theta[0]))


def test_fifty_digits_read_the_same_text():
    map = PinballMap(tables.polar(RADII["peanut"]), lam="0.5", kernels=False)
    exact = ExactMap(map, 40)
    start = exact.start(0.3, 0.4)
    mp = exact.context
    state = [*map.family.enter(exact.ops, mp.mpf(0), start.theta), *start.v]
    fields, code = map.family.bounce(exact.ops, map.law, exact.shape, exact.lam, state)
    truth = exact.bounce(start)

    assert not code
    assert abs(map.family.place(exact.ops, fields[:2])[1] - truth.theta) < mp.mpf(10) ** -40


def test_bounds_of_the_boundary_hold_everywhere(polar):
    family = polar().family
    theta = np.linspace(-np.pi, np.pi, 100_001)
    c, s = np.cos(theta), np.sin(theta)
    r, r1, r2 = family.bent(ArrayBackend(), c, s)
    w = (r * r + 2 * r1 * r1 - r * r2) / r**3

    assert np.max(w) <= family.bounds.highest <= 1.3 * np.max(w)
    assert np.max(np.abs(w)) <= family.bounds.largest
    assert np.max(np.abs(np.gradient(w, theta))) <= family.bounds.slope * (1 + 1e-6)


def test_a_radius_too_steep_to_march_along_has_every_piece_searched():
    boundary = PinballMap(tables.polar("1 + 9*cos(16*theta)/10"), lam=1).states.boundary

    assert not np.isfinite(bounds(boundary).highest)
    assert not Polar.matches(boundary)
    assert STEEP > 1


@pytest.mark.parametrize("word", [*WORDS, "root"])
@pytest.mark.parametrize("gap", [0.0, 2.0**-44, 2.0**-17, 0.3125, -0.375])
def test_a_secant_is_the_difference_divided_by_the_step(word, gap):
    mp, fine = mpmath.MPContext(), mpmath.MPContext()
    mp.dps, fine.dps = 60, 120
    args = (3,) if word == "root" else ()
    for ops, number, bound in ((ScalarBackend(mp), mp.mpf, mp.mpf(10) ** -50), (ArrayBackend(), np.float64, 8 * EPS)):
        first, step = number(0.75), number(gap) / 2
        x = Secant(ops, first, first + 2 * step, number(2.0))
        with np.errstate(all="ignore"):
            slope = fine.mpf(getattr(Secants(ops, step), word)(x, *args).slope)
        function = fine.cbrt if word == "root" else getattr(fine, word)
        a, b = fine.mpf(x.first), fine.mpf(x.last)
        truth = 2 * ((function(b) - function(a)) / (b - a) if a != b else fine.diff(function, a))

        assert abs(slope / truth - 1) <= bound


@pytest.mark.parametrize("word", [*WORDS, "root"])
def test_intervals_hold_every_value(word):
    rng = np.random.default_rng(7)
    low = rng.uniform(0.1, 3, 500)
    high = low + 10 ** rng.uniform(-12, 0.3, 500)
    args = (3,) if word == "root" else ()
    found = getattr(Intervals(), word)(Interval(low, high), *args)
    reference = {"root": np.cbrt, "atan": np.arctan}.get(word, getattr(np, word, None))
    for part in np.linspace(0, 1, 11):
        value = reference(low + part * (high - low))
        assert np.all((found.low <= value) & (value <= found.high))


def test_a_quotient_by_an_interval_about_0_says_nothing():
    x = Interval(np.array([1.0]), np.array([2.0])) / Interval(np.array([-1.0]), np.array([1.0]))

    assert (x.low[0], x.high[0]) == (-np.inf, np.inf)


def test_the_cells_cover_the_turn():
    c, s = whole_turn(64)
    theta = np.linspace(-np.pi, np.pi, 10_001)
    cell = np.minimum(((theta + np.pi) * 64 / (2 * np.pi)).astype(int), 63)

    assert np.all((c.low[cell] <= np.cos(theta)) & (np.cos(theta) <= c.high[cell]))
    assert np.all((s.low[cell] <= np.sin(theta)) & (np.sin(theta) <= s.high[cell]))
