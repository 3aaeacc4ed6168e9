"""Steps of flights, each by itself: against formulas in floats at points of a box, and arcs cut by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from sympy import Matrix, Rational, Symbol, cos, exp, sin, sqrt

from symbolic.tables.table import theta
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics import flights
from verification.proofs.global_dynamics.flights import (
    Flights,
    Slopes,
    aside,
    between,
    closer,
    constant_bends,
    departing,
    flown,
    incidence,
    matrix,
    moved,
    newton,
    norm,
    times,
    turn_rate,
)

ASIDE = np.linspace(-0.25, 1, 6)  # the place a box is known from is not its middle


def oval(t):
    """Point, velocity and acceleration of an ellipse with the axes 6 and 4."""
    c, s = np.cos(t), np.sin(t)
    return [3 * c, 2 * s, -3 * s, 2 * c, -3 * c, -2 * s]


def leaving(t, phi):
    """Point, direction, cosine of the exit angle, speed and bend: `phi` is counted from the inner normal forward."""
    x, y, dx, dy, ddx, ddy = oval(t)
    fast = np.hypot(dx, dy)
    way = (dx + 1j * dy) / fast * 1j * np.exp(-1j * phi)
    return x, y, way.real, way.imag, np.cos(phi) + 0 * fast, fast, (dx * ddy - dy * ddx) / fast**2


def over(values):
    """A ball about sampled values of a quantity that has its ends among them."""
    low, high = np.min(values), np.max(values)
    return BallArray(np.array([(low + high) / 2]), np.array([(high - low) / 2 + 1e-13]))


def exact(*values):
    return [BallArray(np.array([float(x)])) for x in values]


RANDOM = np.random.default_rng(11)
STARTS = [(float(t), float(p)) for t, p in RANDOM.uniform((-3, -0.9), (3, 0.9), (6, 2))]


@pytest.mark.parametrize(("t", "phi"), STARTS)
def test_a_particle_departs_at_its_angle_from_the_inner_normal(t, phi):
    found = departing(*exact(*oval(t)), *exact(phi))
    bend = np.angle(complex(*oval(t + 1e-6)[2:4]) / complex(*oval(t - 1e-6)[2:4])) / 2e-6
    assert [float(x.m[0]) for x in found] == pytest.approx([*leaving(t, phi)[2:6], bend], abs=1e-8)
    assert max(float(x.r[0]) for x in found) < 1e-13
    place = exact(*oval(t))
    assert float(turn_rate(place).m[0]) == pytest.approx(bend, abs=1e-8)
    assert float(norm(flights.OPS, place[2:4]).m[0]) == pytest.approx(leaving(t, phi)[5], abs=1e-13)


def test_the_angle_between_two_tangents_is_counted_from_the_first_one_turned_round():
    for a, b, c, d in RANDOM.uniform(-1, 1, (20, 4)):
        (found,) = between(*exact(a, b, c, d))
        assert abs(float(found.m[0]) - np.angle(-complex(c, d) / complex(a, b))) <= float(found.r[0]) + 1e-13
        assert float(found.r[0]) < 1e-11


@pytest.mark.parametrize(("t", "phi"), STARTS)
def test_on_which_side_of_all_flights_of_a_box_a_point_lies_is_enclosed_and_hardly_more(tight, t, phi):
    wide, high = 1e-3, 2e-3
    theta, exits = np.meshgrid(t + wide * ASIDE, phi + high * ASIDE)
    box = leaving(theta, exits)
    centre, reach = leaving(t, phi)[:4], [over(r * ASIDE) for r in (wide, high)]
    for x, y in (oval(t + 2)[:2], oval(t - 2.5)[:2], (0.3, -5.0)):
        (found,) = aside(*exact(x, y), *exact(*centre), *map(over, box), *reach)
        assert tight(found, box[2] * (y - box[1]) - box[3] * (x - box[0]))


def test_landing_and_incidence_move_with_both_coordinates_by_the_chain_rule():
    middle, phi, turn, by_theta, by_phi, here, there, wide, high = RANDOM.uniform(0.5, 2, 9)
    found = moved(*exact(middle, phi, turn, by_theta, by_phi, here, there, wide, high))
    step = by_theta * wide + by_phi * high
    wanted = middle + step, phi + high + turn + there * step - here * wide, there * by_theta - here, there * by_phi + 1
    assert [float(x.m[0]) for x in found] == pytest.approx(wanted, abs=1e-13)


@pytest.mark.parametrize(("t", "phi"), STARTS)
def test_length_speed_and_incidence_over_boxes_and_arcs_are_enclosed_and_hardly_more(tight, t, phi):
    wide, high, beyond, t1 = 1e-3, 2e-3, 1.5e-3, t + 2.2
    start, arc, exits = np.meshgrid(t + wide * ASIDE, t1 + beyond * ASIDE, phi + high * ASIDE)
    whole, there = oval(start), oval(arc)
    tangent = lambda x: np.unwrap(np.angle(x[2] + 1j * x[3]), axis=1)  # noqa: E731
    turned = lambda x, y: np.angle(-(y[2] + 1j * y[3]) / (x[2] + 1j * x[3]))  # noqa: E731
    rate = lambda x: (x[2] * x[5] - x[3] * x[4]) / (x[2] ** 2 + x[3] ** 2)  # noqa: E731
    assert np.all(np.abs(np.diff(tangent(there), axis=1)) < 0.1)
    reach = [over(r * ASIDE) for r in (wide, high)]
    rates = over(rate(whole)), over(rate(there)), *exact(phi, turned(oval(t), oval(t1)))
    arc_and_middle = over(t1 + beyond * ASIDE), *exact(t1)
    known = *map(over, there), *map(over, whole[:4]), *exact(*oval(t)[:4]), *exact(*oval(t1)[:4]), *arc_and_middle
    eta = exits + turned(whole, there)
    # what is known before is wider by far, and then exact: the common part is told
    for rough in (BallArray(np.zeros(1), np.array([np.inf])), over(eta[:, :, :1])):
        length, fast, angle = flown(*known, *reach, *rates, rough)
        assert tight(length, np.hypot(there[0] - whole[0], there[1] - whole[1]), 1.2)
        assert tight(fast, np.hypot(there[2], there[3]), 1.2)
        if np.isinf(rough.r[0]) and abs(float(np.mean(eta))) < 4:
            assert tight(angle, eta, 1.2)
    assert tight(angle, eta[:, :, :1], 1.2) or abs(float(np.mean(eta))) >= 4


@pytest.mark.parametrize(("guess", "known"), [(0.125, True), (0.625, True), (0.1249, False), (0.6251, False)])
def test_a_step_of_newton_is_told_for_guesses_up_to_the_ends_of_the_arc(guess, known):
    """A wall up from `(1, 0)` to `(1/2, 1)`, from the origin, by a line that rises by a half."""
    arc = BallArray(np.array([0.375]), np.array([0.25]))
    (found,) = newton(*exact(guess), arc, *exact(0, 0, 2, 1, 1 - guess / 2, guess, -0.5, 1))
    assert bool(np.isfinite(found.r[0])) is known
    assert float(found.m[0]) == pytest.approx(0.4, abs=1e-14)


@pytest.mark.parametrize(("middle", "radius", "known"), [(4, 0.69, True), (-4, 0.71, False), (0, 4.69, True)])
def test_angles_of_incidence_are_kept_below_three_quarters_of_a_turn(middle, radius, known):
    found = incidence(BallArray(np.array([float(middle)]), np.array([radius])))
    assert bool(np.isfinite(found.r[0])) is known
    assert found.m[0] == middle


def test_a_derivative_is_made_of_its_slopes_and_matrices_are_multiplied_as_matrices():
    s = Slopes(*exact(*RANDOM.uniform(0.5, 2, 6)))
    by_theta, by_phi, here, there, law, drift = (float(x.m[0]) for x in s)
    eta = np.array([there * by_theta - here, there * by_phi + 1])
    wanted = np.array([[by_theta, by_phi], drift * np.array([by_theta, by_phi]) - law * eta])
    numbers = lambda rows: np.array([[float(x.m[0]) for x in row] for row in rows])  # noqa: E731
    assert np.allclose(numbers(matrix(s)), wanted, atol=1e-13)
    other = RANDOM.uniform(-2, 2, (2, 2))
    assert np.allclose(numbers(times(matrix(s), [exact(*row) for row in other])), wanted @ other, atol=1e-13)
    assert np.allclose(numbers(times([exact(*row) for row in other], matrix(s))), other @ wanted, atol=1e-13)


def test_a_bend_is_the_constant_where_there_is_one_and_otherwise_as_it_was_enclosed(monkeypatch):
    rough, map = BallArray(np.array([7.0, 8.0, 9.0]), np.full(3, 0.5)), SimpleNamespace(map=SimpleNamespace(table=None))
    monkeypatch.setattr(flights, "constant_bends", lambda _: (Rational(1, 3), None))
    found = closer(lambda: rough, map, np.array([0, 1, 0]))
    assert list(found.m) == [1 / 3, 8, 1 / 3]
    assert found.r[1] == 0.5
    assert np.all((found.r[[0, 2]] > 0) & (found.r[[0, 2]] < 1e-15))
    held = closer(lambda: None, map, np.array([0, 0]))  # nothing rough is asked for
    assert list(held.m) == [1 / 3, 1 / 3]


B = Symbol("b", positive=True)


@pytest.mark.parametrize(
    ("point", "bend"),
    [
        ((2 * cos(theta), 2 * sin(theta)), 1),
        ((5 + cos(3 * theta / 2), sin(3 * theta / 2)), Rational(3, 2)),
        ((sin(theta), cos(theta)), -1),
        ((theta, B * theta), 0),
        ((exp(theta) * cos(theta), exp(theta) * sin(theta)), 1),  # along a spiral
        ((B * exp(theta) * cos(2 * theta), B * exp(theta) * sin(2 * theta)), 2),
        ((cos(sqrt(2) * theta), sin(sqrt(2) * theta)), None),  # the constant is no rational number
        ((cos(B * theta), sin(B * theta)), None),
        ((theta, theta**2), None),
        ((2 * cos(theta), sin(theta)), None),
        ((theta**2, theta**3), None),
    ],
)
def test_a_tangent_that_turns_evenly_is_found_to_do_so(point, bend):
    straight = SimpleNamespace(point=Matrix([theta, 2 * theta]))
    table = SimpleNamespace(components=[straight, SimpleNamespace(point=Matrix(point)), straight])
    assert constant_bends.__wrapped__(table) == (0, bend, 0)


THREE = np.array([[0.0, 10.0, 20.0], [1.0, 12.0, 23.0]])  # ends of three sides in a row, and again the first


def sides(fast=(1.0, 2.0, 4.0)):
    """In the place of flights: three straight sides, each run along at a speed of its own."""
    made, speeds = object.__new__(Flights), np.array(fast)
    still = lambda chart: BallArray(0 * speeds[chart])  # noqa: E731
    place = lambda chart, at: [at, at, BallArray(speeds[chart]), *(still(chart) for _ in range(3))]  # noqa: E731
    made.map = SimpleNamespace(closed=False, ends=[None] * 3, inner=THREE, outer=THREE, place=place)
    return made


@pytest.mark.parametrize(
    ("chart", "theta", "by", "wanted"),
    [
        (0, 0.5, 0.25, (0, 0.75)),
        (0, 0.5, 0.5, (0, 1.0)),  # up to the end itself
        (0, 0.5, -0.5, (0, 0.0)),
        (0, 0.5, 1.5, (1, 10.5)),  # beyond by 1, at half the speed there
        (1, 11.0, -1.25, (0, 0.5)),  # beyond by 0.25, at twice the speed
        (2, 22.0, 1.125, (0, 0.5)),  # over the last join
        (0, 0.5, -1.5, (2, 22.75)),
        (1, 11.5, 40.0, (2, 23.0)),  # no further than the next side
        (1, 10.5, -9.0, (0, 0.0)),
    ],
)
def test_a_point_that_is_moved_past_a_join_goes_on_by_the_same_length(chart, theta, by, wanted):
    on, at = sides()._moved(np.array([0, chart, 0]), np.array([0.5, theta, 0.5]), np.array([0.0, by, 0.0]))
    assert list(zip(on.tolist(), at.tolist(), strict=True)) == [(0, 0.5), wanted, (0, 0.5)]
    closed = sides()
    closed.map.closed = True
    assert closed._moved(np.array([0]), np.array([3.0]), np.array([2.0]))[1] == 5.0


NAN = float("nan")


@pytest.mark.parametrize(
    ("low", "high", "wanted"),
    [
        ((0, 0.25), (0, 0.5), [(0, 0.25, 0.5, True)]),
        ((0, 0.25), (1, 11.0), [(0, 0.25, 1.0, False), (1, 10.0, 11.0, False)]),
        ((2, 21.0), (1, 11.0), [(2, 21.0, 23.0, False), (0, 0.0, 1.0, False), (1, 10.0, 11.0, False)]),
        ((1, 11.5), (1, 11.0), [(1, 11.5, 12.0, False), (2, 20.0, 23.0, False), (0, 0.0, 1.0, False),
                                (1, 10.0, 11.0, False)]),
        ((0, 0.5), (0, 0.5), [(0, 0.5, 1.0, False), (1, 10.0, 12.0, False), (2, 20.0, 23.0, False),
                              (0, 0.0, 0.5, False)]),
        ((1, NAN), (2, 21.0), [(1, NAN, 12.0, False), (2, 20.0, 21.0, False)]),
    ],
)  # fmt: skip
def test_arcs_of_landings_are_cut_at_the_joins_they_pass_and_nowhere_else(low, high, wanted):
    """A middle box among others on one side."""
    made = sides()
    made.chart = np.zeros(3, dtype=int)
    lows = np.array([2, low[0], 2]), np.array([20.5, low[1], 20.5])
    highs = np.array([2, high[0], 2]), np.array([21.5, high[1], 21.5])
    found = {0: [], 1: [], 2: []}
    for on, chart, bottom, top, smooth in made.pieces(lows, highs):
        for k, *row in zip(on.tolist(), chart.tolist(), bottom.tolist(), top.tolist(), strict=True):
            found[k].append((*row, smooth))
    assert found[0] == found[2] == [(2, 20.5, 21.5, True)]
    assert np.array_equal(np.array(found[1]), np.array(wanted), equal_nan=True)
    made.map.closed = True
    (piece,) = made.pieces(lows, highs)
    assert piece.on.tolist() == [0, 1, 2]
    assert piece.smooth
    assert piece.low is lows[1]
    assert piece.high is highs[1]


class Guessed(Flights):
    """Four flights that land about 2, within so much, or of which on one side or both nothing is ever proved."""

    def __init__(self, closed):
        self.chart = np.array([0, 1, 2, 3])
        self.map = SimpleNamespace(closed=closed)
        self.boxes = SimpleNamespace(x=(np.array([4.0, 5.0, 6.0, 7.0]), np.array([4.5, 5.5, 6.5, 7.5])))

    def guess(self):
        return self.chart + 4, np.full(4, 2.0), np.full(4, 0.25), np.full(4, 0.5)

    def _moved(self, chart, theta, by):
        return chart + 10, theta + by

    def sides(self, end, on):
        off = end[1] - 2.0
        far = np.array([[0.3, 9.0, 0.3, 9.0], [0.6, 0.6, 9.0, 9.0]])[(off > 0).astype(int), on]
        return BallArray(np.where(np.abs(off) > far, np.sign(off), 0.0), 0 * off)


@pytest.mark.parametrize("closed", [True, False])
def test_an_arc_ends_where_a_trial_is_proved_or_with_joins_at_the_start_of_the_box(closed):
    (low_on, low), (high_on, high) = Guessed(closed).arcs()
    below, above = 2 - 0.25 * 1.4, 2 + 0.5 * 1.4
    assert low == pytest.approx([below, NAN if closed else 5.0, below, NAN], nan_ok=True)
    assert high == pytest.approx([above, above, NAN if closed else 6.5, NAN], nan_ok=True)
    assert [low_on[0], low_on[2], high_on[0], high_on[1]] == [14, 16, 14, 15]
    if not closed:
        assert (low_on[1], high_on[2]) == (1, 2)
