"""Flights of small boxes of a table: against the kernels at points of the boxes, and not wider than it has to be."""

import numpy as np
import pytest

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import Flights, matrix
from verification.proofs.global_dynamics.images import PinballImages

SHARES = np.linspace(-1, 1, 5)
SCENES = [Scene("ellipse", a="3/2", lam="1/2"), Scene("cuspless", lam="0.3"), Scene("egg", alpha="0.08", lam="1/2")]


@pytest.fixture(params=SCENES, ids=lambda scene: scene.name)
def small(request):
    """Flights of small boxes of a table, and points at a grid of shares of each: starts, exits, and where they land."""
    map, h = PinballImages(request.param), 1e-4
    theta = np.array([-1.3, -0.4, 0.3, 1.1, 1.7])
    phi = np.array([0.3, -0.35, 0.1, 0.25, -0.2])
    boxes = Boxes(np.zeros(5, dtype=int), (theta - h, theta + h), (phi - 2 * h, phi + 2 * h))
    along, up = (x[:, :, None] for x in np.meshgrid(SHARES, SHARES))
    at = np.broadcast_arrays(theta + h * along, phi + 2 * h * up)
    landed = map.map.step(*at, np.zeros(at[0].shape, dtype=int))
    assert np.all(landed.component == landed.component[:1, :1])
    return map, Flights(map, boxes), at, landed


def each(values, k):
    return np.asarray(values)[:, :, k]


def landings(made):
    """The pieces that hold a box, and their arcs."""
    return [(piece, hull(piece.low, piece.high)) for piece in made.pieces(*made.arcs()) if piece.on.size]


def test_landings_and_incidences_of_small_boxes_are_enclosed_and_hardly_more(small, tight):
    map, made, _, landed = small
    seen = set()
    for piece, _ in landings(made):
        _, theta, eta, phi = made.landing(piece)
        assert phi is None
        for row, k in enumerate(piece.on):
            turn = 2 * np.pi * np.rint((theta.m[row] - each(landed.theta, k)[0, 0]) / (2 * np.pi)) * map.closed
            assert tight(theta[row], each(landed.theta, k) + turn, 1.05)
            assert tight(eta[row], each(landed.eta, k), 1.05)
            assert piece.low[row] < np.min(each(landed.theta, k) + turn)
            assert np.max(each(landed.theta, k) + turn) < piece.high[row]
            seen.add(k)
    assert seen == set(range(5))


def test_the_derivative_over_small_boxes_is_enclosed_and_hardly_more(small):
    """By differences of the kernel, at points."""
    map, made, at, _ = small
    h, chart = 1e-5, np.zeros(at[0].shape, dtype=int)
    ends = [[map.map.step(at[0] + i * s * h, at[1] + (1 - i) * s * h, chart) for s in (1, -1)] for i in (1, 0)]
    truth = [[(getattr(a, name) - getattr(b, name)) / (2 * h) for a, b in ends] for name in ("theta", "phi")]
    for piece, arc in landings(made):
        entries = matrix(made.slopes(piece.on, piece.chart, arc))
        for row, k in enumerate(piece.on):
            for i, j in np.ndindex(2, 2):
                ball, some = entries[i][j][row], each(truth[i][j], k)
                assert np.all(np.abs(some - ball.m) <= ball.r + 1e-8)
                assert ball.r < 0.015


def test_the_middles_of_boxes_land_where_a_step_of_newton_says_but_for_rounding(small):
    _, made, _, landed = small
    for piece, arc in landings(made):
        off = made.midpoint(piece.on, piece.chart, arc) - landed.theta[2, 2, piece.on]
        assert np.all(np.abs(np.remainder(off.m + np.pi, 2 * np.pi) - np.pi) <= off.r + 1e-13)
        assert np.all(off.r <= 1e-12)
        aside = made.midpoint(piece.on, piece.chart, hull(piece.low - 1e-3, piece.high))
        assert np.all(aside.r <= 1e-9)  # of an arc whose middle is elsewhere


def test_the_speed_over_boxes_is_enclosed_and_hardly_more_and_sides_of_some_boxes_are_those_of_all(small, tight):
    map, made, at, _ = small
    place = map.place(np.zeros(at[0].size, dtype=int), BallArray(at[0].ravel()))
    fast = np.hypot(place[2].m, place[3].m).reshape(at[0].shape)
    for k in range(5):
        assert tight(made.speed[k], each(fast, k), 1.05)
    chart, theta, *_ = made.guess()
    ends = chart, theta + 0.3
    every, some = made.sides(ends, np.arange(5)), made.sides(tuple(x[[3, 1]] for x in ends), np.array([3, 1]))
    assert np.array_equal(every.m[[3, 1]], some.m)
    assert np.array_equal(every.r[[3, 1]], some.r)
    assert every.positive().all()


def test_the_boundary_over_an_arc_is_that_of_the_arc_asked_for_whatever_was_asked_before(small):
    _, made, *_ = small
    piece, one = max(landings(made), key=lambda pair: pair[0].on.size)
    other = hull(piece.low - 0.01, piece.high)
    answers = [made.over(piece.on, piece.chart, arc) for arc in (one, one, other, one)]
    assert answers[0][1] is answers[1][1]
    assert np.array_equal(answers[0][1].r, answers[3][1].r)
    assert np.any(answers[2][1].r > answers[0][1].r)


def test_of_a_part_of_an_arc_the_landings_are_the_whole_part_and_no_exit_is_told(small):
    _, made, *_ = small
    for piece, arc in landings(made):
        part = piece._replace(smooth=False)
        told, theta, eta, phi = made.landing(part)
        assert told is part
        assert np.array_equal([theta.m, theta.r], [arc.m, arc.r])
        assert np.array_equal(eta.m, made.over(piece.on, piece.chart, arc)[1].m)
        assert phi is None


def test_how_far_an_arc_lies_along_flights_and_how_fast_it_leaves_them_is_enclosed(small):
    """Of all starts and directions of a box, and the two ends of its arc."""
    map, made, at, _ = small
    for piece, arc in landings(made):
        _, _, along, slope = made.across(piece.on, piece.chart, arc)
        for end in (piece.low, piece.high):
            x, y, dx, dy, *_ = (value.m for value in map.place(piece.chart, BallArray(end)))
            for i, j in np.ndindex(5, 5):
                box = Boxes(np.zeros(5, dtype=int), (at[0][i, j],) * 2, (at[1][i, j],) * 2)
                here = {name: value.m[piece.on] for name, value in Flights(map, box).centre.items()}
                far = here["v"] * (x - here["x"]) + here["w"] * (y - here["y"])
                fast = here["v"] * dy - here["w"] * dx
                assert np.all(np.abs(far - along.m) <= along.r + 1e-12)
                assert np.all(np.abs(fast - slope.m) <= slope.r + 1e-12)
        assert np.all(along.r < 0.02)
        assert np.all(slope.r < 0.02)


def test_exits_under_a_law_of_the_place_move_with_place_and_incidence_together(tight):
    law = "-lam*eta*(1 + cos(3*theta)/4) + sin(theta)/8"
    map, h = PinballImages(Scene("egg", alpha="0.08", lam="1/2", law=law)), 1e-5
    theta, phi, zero = np.array([-1.3, 0.3, 1.7]), np.array([0.3, 0.1, -0.2]), np.zeros(3, dtype=int)
    made = Flights(map, Boxes(zero, (theta - h, theta + h), (phi - 2 * h, phi + 2 * h)))
    exits = [map.map.step(theta + h * i, phi + 2 * h * j, zero).phi for i in SHARES for j in SHARES]
    ((piece, _),) = landings(made)
    exit = made.landing(piece)[3]
    for k in range(3):
        assert tight(exit[k], np.array(exits)[:, k], 1.05)
