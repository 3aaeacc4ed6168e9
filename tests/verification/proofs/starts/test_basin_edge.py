"""The edge of a basin above a barrier, and refused statements."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from symbolic import Scene
from verification.cycles.recurrence import Closure
from verification.paper.egg.nearly_round import edge
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.manifolds.known import TRIANGLE
from verification.proofs.starts.basin_edge import BasinEdge

FOUND = edge()


def placed(alpha: str, lam: str, sink: tuple[float, float], saddle: float) -> BasinEdge:
    """The edge at other parameters and places of the two cycles."""
    barrier = Barrier(Scene("egg", alpha=alpha), (Fraction(lam), Fraction(lam)))
    return BasinEdge(barrier, sink, replace(TRIANGLE, start=(saddle,)), 0.012)


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


def test_a_cycle_below_the_barrier_has_no_edge_above_it():
    """Orbits that converge to the cycle come below the barrier, so a staircase above the disc alone is no barrier."""
    over = replace(FOUND.barrier)
    middles = np.mean(over.grid.boxes(over.grid.whole()).x, axis=0)[: over.columns]
    off = middles - FOUND.sink[0]
    beside = np.abs(off - FOUND.turn * np.rint(off / FOUND.turn)) < 2 * FOUND.disc.rectangle[0]
    over.__dict__["heights"] = np.where(beside, FOUND.sink[1] + 2 * FOUND.disc.rectangle[1], FOUND.barrier.heights)
    assert {*replace(FOUND, barrier=over).open} == {"disc"}


def test_beyond_the_crisis_boundaries_are_not_said_to_be_smooth():
    """No barrier separates the middle from the triangle: the one found is not below the saddle."""
    assert "alone" in placed("0.08", "0.67", (-0.9096821, 0.4201331), -0.1605810).open


def test_a_cycle_that_is_left_out_is_seen():
    """With the disc elsewhere, the attracting triangle remains among the orbits that stay above the barrier."""
    wrong = replace(FOUND)
    wrong.__dict__["disc"] = replace(FOUND.disc, centre=(FOUND.disc.centre[0] + 0.5, FOUND.disc.centre[1]))
    assert "alone" in wrong.open


@pytest.mark.parametrize(
    ("closure", "by"),
    [(Closure(1, (1, 1)), 1), (Closure(-1, (1, 3)), 1), (Closure(1, (1, 2)), 1), (Closure(1, (1, 3)), 2)],
)
def test_a_saddle_that_is_not_one_bounce_and_a_part_of_a_turn_is_refused(closure, by):
    with pytest.raises(ValueError, match="must be a fixed point of the map"):
        replace(FOUND, saddle=replace(FOUND.saddle, closure=closure, start=FOUND.saddle.start * by))


def test_edges_found_by_bisection_lead_to_the_saddle():
    """Between a start that converges to the triangle and one that does not, a third passes next to the saddle."""
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
