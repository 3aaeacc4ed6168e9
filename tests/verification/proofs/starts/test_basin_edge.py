"""The edge of a basin above a barrier, and what is refused."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic import Scene
from verification.arithmetic.arrays import BallArray
from verification.paper.egg.nearly_round import edge
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.common_boundary import Disc
from verification.proofs.global_dynamics.flights import Slopes
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.starts import basin_edge
from verification.proofs.starts.basin_edge import BasinEdge

FOUND = edge()


def placed(alpha: str, lam: str, sink: tuple[float, float], saddle: float) -> BasinEdge:
    """The edge at other parameters."""
    barrier = Barrier(Scene("egg", alpha=alpha), (Fraction(lam), Fraction(lam)))
    return BasinEdge(barrier, sink, replace(TRIANGLE, start=(saddle,)), 0.012)


def failing(found: BasinEdge) -> set[str]:
    """The checks that are not proved."""
    return {name for name, held in found.checks.items() if held is not True}


@pytest.mark.parametrize(
    ("alpha", "lam", "sink", "saddle"),
    [
        ("0.08", "0.45", (-0.7391158, 0.3249923), -0.3527392),
        ("0.08", "0.6", (-2.9628777, 0.3926991), -0.2079523),
        ("0.05", "0.8", (-0.9207699, 0.4654211), -0.1393690),
        ("0.1", "0.45", (-2.9194720, 0.3249923), -0.2667781),
    ],
)
def test_basins_end_at_the_stable_manifold_of_a_saddle(alpha, lam, sink, saddle):
    assert FOUND.proved
    assert placed(alpha, lam, sink, saddle).proved


@pytest.mark.parametrize(
    ("changes", "items"),
    [
        ({"radius": 0.03}, {"disc"}),  # the derivative is no contraction over so wide a disc
        ({"sink": (-0.9, 0.4)}, {"disc", "alone"}),  # the triangle lies beside it
        ({"saddle": replace(TRIANGLE, start=(1.19,))}, {"saddle", "hyperbolic", "alone"}),  # that triangle attracts
    ],
)
def test_each_step_fails_alone(changes, items):
    assert failing(replace(FOUND, **changes)) == items


def test_a_cycle_below_the_barrier_has_no_edge_above_it():
    """What converges to it comes below the barrier: a staircase that goes over the disc alone is no barrier for it."""
    over = replace(FOUND.barrier)
    middles = np.mean(over.grid.boxes(over.grid.whole()).x, axis=0)[: over.columns]
    off = middles - FOUND.sink[0]
    beside = np.abs(off - FOUND.turn * np.rint(off / FOUND.turn)) < 2 * FOUND.disc.rectangle[0]
    over.__dict__["heights"] = np.where(beside, FOUND.sink[1] + 2 * FOUND.disc.rectangle[1], FOUND.barrier.heights)
    assert failing(replace(FOUND, barrier=over)) == {"disc"}


def test_beyond_the_crisis_boundaries_are_not_said_to_be_smooth():
    """No barrier keeps the middle from the triangle: what is found is no barrier below the saddle."""
    assert "alone" in failing(placed("0.08", "0.67", (-0.9096821, 0.4201331), -0.1605810))


@pytest.mark.parametrize(
    ("name", "value"),
    [("HALVINGS", 7), ("NEAR", 5e-3), ("WITHIN", 4.1e-4)],  # coarse cells; sets about the saddle too large; too small
)
def test_without_cells_fine_enough_nothing_is_proved(monkeypatch, name, value):
    monkeypatch.setattr(basin_edge, name, value)
    assert "alone" in failing(replace(FOUND))


def test_images_of_random_points_lie_in_cells_to_which_edges_lead():
    """Of 40 points of each cell, borders included; what lands below the first row is below the barrier."""
    columns, rows = 96, 48
    column, row = (index.ravel() for index in np.indices((columns, rows)))
    edges = FOUND._edges(column, row, FOUND._boxes(column, row, columns, rows), columns, rows)
    drawn = np.random.default_rng(7).beta(0.3, 0.3, (2, 40, column.size))
    wide, tall = FOUND.turn / columns, FOUND.barrier.map.top / rows
    theta, phi = (column + drawn[0]) * wide - FOUND.turn / 2, (row + drawn[1]) * tall
    step = PinballMap("egg", lam="0.66", alpha="0.08").step(theta.ravel(), phi.ravel())
    at = np.floor((step.theta + FOUND.turn / 2) / wide).astype(int) % columns, np.floor(step.phi / tall).astype(int)
    above = at[1] >= 0
    source = np.broadcast_to(np.arange(column.size), theta.shape).ravel()
    led = set(zip(*(ends.tolist() for ends in edges), strict=True))
    assert np.mean(above) > 0.2
    assert set(zip(source[above].tolist(), (at[0] * rows + at[1])[above].tolist(), strict=True)) <= led
    assert np.unique(edges[1]).size < columns * rows  # and not to all


@pytest.mark.parametrize(
    ("middle", "radius", "held"),
    [
        ((2, 0, 0, 0.5), (0, 0, 0, 0), True),
        ((2, 0, 0, 0.5), (0.1, 0.8, 0.4, 0.05), True),
        ((2, 0, 0, 0.5), (0, 1.1, 0, 0), False),  # the expanded part may grow by 0.9 alone
        ((2, 0, 0, 0.5), (0, 0, 0.6, 0), False),  # the other may grow by 1.1
        ((2, 0, 0, 0.5), (0, 0, 0, 0.6), False),
        ((0.9, 0, 0, 0.5), (0, 0, 0, 0), False),
        ((2, 0, 0, 1.2), (0, 0, 0, 0), False),
        ((430, 0, 0, 0.5), (0, 0, 0, 0), True),  # by 0.86, which is less than half a turn
        ((600, 600, 0, 0.5), (0, 0, 0, 0), False),  # half a turn of the table along a diagonal
        ((1100, 0, 0, 0.5), (0, 0, 0, 0), False),  # half a turn of the table, and points may be near another copy
    ],
)
@pytest.mark.parametrize("turned_back", [False, True])
def test_differences_grow_or_shrink_where_the_derivative_says_so(middle, radius, held, turned_back):
    """Of matrices `[[a, b], [c, d]]` within radii; nothing is proved where some of them turn the expanded part back."""
    (a, b, c, d), (p, q, r, t) = middle, radius
    along = np.full(16, a) * np.where(turned_back & (np.arange(16) % 4 == 0), -1, 1)
    still = BallArray(np.zeros(16), np.zeros(16))
    law = BallArray(np.full(16, -d), np.full(16, t))
    bend = BallArray(np.full(16, c), np.full(16, r)) / law.m
    slopes = Slopes(BallArray(along, np.full(16, p)), BallArray(np.full(16, b), np.full(16, q)), bend, still, law)
    piece = SimpleNamespace(on=np.arange(16))
    some = SimpleNamespace(map=SimpleNamespace(derivatives=lambda _: ((piece, slopes),)))
    stub = SimpleNamespace(barrier=some, turn=FOUND.turn, _about=FOUND._about)
    assert BasinEdge._hyperbolic(stub) is (held and not turned_back)
    piece.on = np.arange(15)  # of one part nothing is known
    assert not BasinEdge._hyperbolic(stub)


def test_a_cell_is_in_the_disc_where_its_corners_are():
    """In the coordinates of discs of all shapes, and up to turns of the table."""
    rng, seen = np.random.default_rng(5), []
    for _ in range(60):
        inverse, centre = rng.uniform(-2, 2, (2, 2)), rng.uniform(-0.5, 0.5, 2)
        low = centre[:, None] + rng.uniform(-0.3, 0.3, (2, 40))
        high, turns = low + rng.uniform(0, 0.2, (2, 40)), rng.integers(-2, 3, 40) * FOUND.turn
        corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])]) - centre[:, None]
        sizes = np.max(
            np.hypot(*np.linalg.solve(inverse, np.moveaxis(corners, 1, 0).reshape(2, -1))).reshape(4, 40), axis=0
        )
        edge = BasinEdge(FOUND.barrier, FOUND.sink, FOUND.saddle, 0.2)
        edge.__dict__["disc"] = Disc(tuple(centre), tuple(map(tuple, inverse)), 0.2)
        boxes = Boxes(np.zeros(40, dtype=int), (low[0] + turns, high[0] + turns), (low[1], high[1]))
        told = np.abs(sizes / 0.2 - 1) > 1e-6
        assert np.array_equal(edge._absorbed(boxes)[told], sizes[told] < 0.2)
        seen += list(sizes < 0.2)
    assert 30 < sum(seen) < len(seen) - 30


def test_a_cycle_that_is_left_out_is_seen():
    """With a disc elsewhere the attracting triangle itself is what stays."""
    wrong = replace(FOUND)
    wrong.__dict__["disc"] = replace(FOUND.disc, centre=(FOUND.disc.centre[0] + 0.5, FOUND.disc.centre[1]))
    assert not wrong._alone()


def test_a_cell_that_leads_to_itself_alone_is_seen(monkeypatch):
    """All cells lead to the first, as to a fixed point: it is about the saddle, or an orbit stays elsewhere."""
    stays = replace(FOUND)
    away = FOUND.place[0] - FOUND.turn / 2 + 1e-5, FOUND.place[1]
    for place, alone in ((FOUND.place, True), (away, False)):

        def edges(self, column, row, boxes, columns, rows, place=place):
            x, y = self._beside(np.mean(boxes.x, axis=0), place[0]), np.mean(boxes.y, axis=0) - place[1]
            return np.arange(column.size, dtype=np.int32), np.full(column.size, np.argmin(x**2 + y**2), dtype=np.int32)

        monkeypatch.setattr(BasinEdge, "_edges", edges)
        assert stays._alone() is alone


def test_edges_found_by_bisection_lead_to_the_saddle():
    """Between a start that goes to the triangle and one that does not lies a start that comes next to the saddle."""
    map = PinballMap("egg", lam="0.66", alpha="0.08")
    theta, steps = np.random.default_rng(3).uniform(-np.pi, np.pi, 40), np.linspace(0, 1.03, 60)

    def taken(theta, phi):
        end = map.orbit(theta, phi, 400)
        return (end.phi[-1] > 0.3) & (np.abs(end.phi[-1] - end.phi[-2]) < 1e-6)

    fates = taken(*(x.ravel() for x in np.meshgrid(theta, steps, indexing="ij"))).reshape(40, 60)
    assert not np.any(fates[:, 0])
    which, step = np.nonzero(fates[:, 1:] & ~fates[:, :-1])
    assert which.size > 40
    theta, low, high = theta[which], steps[step], steps[step + 1]
    for _ in range(60):
        middle = (low + high) / 2
        goes = taken(theta, middle)
        low, high = np.where(goes, low, middle), np.where(goes, middle, high)
    orbit = map.orbit(theta, low, 60)
    turn, (x, y) = 2 * np.pi / 3, FOUND.place
    off = orbit.theta - x - turn * np.round((orbit.theta - x) / turn)
    assert np.all(np.min(np.hypot(off, orbit.phi - y), axis=0) < 1e-4)
