"""Tables given by a radius: the march skips no zero, and lands as exactly as on the paper's own tables."""

import itertools

import mpmath
import numpy as np
import pytest
from one_bounce import bounce, bounce_errors, landing_errors

from numeric import PinballMap, Status
from numeric.backends.intervals import Interval, Intervals, Secant, Secants
from numeric.backends.scalars import ArrayBackend, ScalarBackend
from symbolic import tables

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
    """A map on arrays, with a contraction."""
    table = tables.polar(RADII[request.param], name=request.param)
    return lambda lam=0.9: PinballMap(table, lam=lam, kernels=False)


def anywhere(count, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-np.pi, np.pi, count), np.arcsin(rng.uniform(-1, 1, count))


def bulges(map, count, seed):
    """Starts whose rays miss or cut a dispersing arc at an angle of 1e-6 to 1e-1; empty without such an arc."""
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


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["anywhere", "bulges"])
def test_the_ray_is_inside_the_table_until_it_lands(polar, kind):
    map = polar()
    theta, phi = anywhere(400, 1) if kind == "anywhere" else bulges(map, 200, 2)
    if not theta.size:
        return
    own, found, code = bounce(map, np.zeros(theta.size, dtype=np.int64), theta, phi)
    (x0, y0), (x1, y1) = (map.family.point(ArrayBackend(), *fields[:2]) for fields in (own, found))
    t = (x1 - x0) * own[2] + (y1 - y0) * own[3]
    part = np.linspace(0.001, 0.999, 200)[:, None]
    x, y = x0 + part * t * own[2], y0 + part * t * own[3]
    away = np.hypot(x, y)
    radius = map.family.radius(ArrayBackend(), x / away, y / away)[0]

    assert not code.any()
    assert np.all(t > 0)
    assert np.max(away - radius) < 64 * EPS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "lam", "kernels"),
    [*itertools.product(["limacon", "star", "peanut", "words"], [0, 0.95], [False]), ("peanut", 0.95, True)],
)
def test_landings_with_large_condition_numbers_are_right_to_the_last_bits(name, lam, kernels):
    """The worst conditioned of 400 landings; a residual in doubles would miss by half a condition number."""
    map = PinballMap(tables.polar(RADII[name]), lam=lam, kernels=kernels)
    theta, phi = anywhere(400, 8)
    phi = phi if lam else 0 * phi
    matrix = 1 + np.abs(map.derivative(theta, phi))[:, 0].sum(axis=-1)
    worst = np.argsort(matrix)[-2:]
    lands, position, direction, _ = landing_errors(map, np.zeros(2, dtype=np.int64), theta[worst], phi[worst])

    assert lands.all()
    assert np.max(position) <= 1
    assert np.max(direction) <= 8


def test_rays_that_touch_a_bulge_take_the_first_of_three_hits():
    map = PinballMap(tables.polar(RADII["star"]), lam=0.9, kernels=False)
    theta, phi = bulges(map, 3, 4)
    matrix = np.abs(map.derivative(theta, phi))
    position, direction = bounce_errors(map, np.zeros(theta.size, dtype=np.int64), theta, phi)

    assert np.all(position <= 8 * (1 + matrix[:, 0].sum(axis=-1)))
    assert np.all(direction <= 8 * (1 + matrix[:, 1].sum(axis=-1)))


def test_a_flight_along_an_almost_straight_wall_ends():
    """Next to the limacon's inflection, 1.4e-12 from the tangent; a single bound for the whole wall takes 1e5 steps."""
    map = PinballMap(tables.polar(RADII["limacon"]), lam="0.95", kernels=False)
    step = map.step(2.84273043, -(np.pi / 2 - 1.37645451e-12))

    assert step.status is Status.REGULAR
    assert step.theta == pytest.approx(2.8415437, abs=1e-6)


def test_bounds_of_the_boundary_hold_everywhere(polar):
    family = polar().family
    theta = np.linspace(-np.pi, np.pi, 100_001)
    c, s = np.cos(theta), np.sin(theta)
    r, r1, r2 = family.bent(ArrayBackend(), c, s)
    w = (r * r + 2 * r1 * r1 - r * r2) / r**3

    assert np.max(w) <= family.bounds.highest <= 1.3 * np.max(w)
    assert np.max(np.abs(w)) <= family.bounds.largest
    assert np.max(np.abs(np.gradient(w, theta))) <= family.bounds.slope * (1 + 1e-6)


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
