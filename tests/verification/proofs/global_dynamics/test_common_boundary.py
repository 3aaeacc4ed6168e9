"""Two basins next to one stable manifold, and the discs that a contraction takes into themselves."""

from dataclasses import replace
from fractions import Fraction
from math import pi, tau

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.paper.egg.basins import MIDDLE, beyond_the_crisis
from verification.proofs.global_dynamics.common_boundary import CHECKS, attracts, disc, entered_around
from verification.proofs.manifolds.saddle import Orbit

FOUND = beyond_the_crisis()


def test_the_stable_manifold_of_the_triangle_bounds_both_basins_beyond_the_crisis():
    assert FOUND.proved
    assert all(entered_around(FOUND, k, *point) for k, point in enumerate(MIDDLE))


def failing(**changes):
    """The checks that are not proved of a changed statement."""
    return {name for name, held in replace(FOUND, **changes).checks.items() if held is not True}


def test_the_orbits_go_to_the_one_triangle_and_not_to_the_other():
    assert failing(sinks=FOUND.sinks[::-1], turn=FOUND.turn[::-1]) == {"first", "second"}
    assert failing(starts=FOUND.starts[::-1]) == {"first", "second"}
    assert not any(entered_around(FOUND, 1 - k, *point) for k, point in enumerate(MIDDLE))


def test_one_cycle_twice_is_no_pair_of_cycles():
    twice = {"sinks": (FOUND.sinks[0],) * 2, "turn": (FOUND.turn[0],) * 2}
    assert failing(**twice, starts=(0.9, 0.9)) == {"apart"}


@pytest.mark.parametrize(
    "change",
    [
        {"radius": 0.04},  # the derivative is no contraction over so wide a disc
        {"radius": 1e-9},  # the centre is no closer to the cycle than that
        {"turn": (Fraction(2, 3), Fraction(1, 3))},  # each triangle goes the other way round
    ],
)
def test_a_disc_that_is_not_taken_into_itself_proves_nothing(change):
    assert "discs" in failing(**change)


def test_below_the_crisis_the_branch_goes_to_no_triangle():
    below = Orbit("triangle of the vertices", (-0.207952,), FOUND.saddle.closure)
    sink = 1.22591248, 0.39269908
    changed = replace(FOUND, lam=Fraction(3, 5), saddle=below, sinks=(sink, (-sink[0], -sink[1])))
    assert {name for name, held in changed.checks.items() if held is not True} == {"first", "second"}


def test_points_of_a_disc_approach_one_another():
    (one, _), map = FOUND.discs, PinballMap("egg", lam=0.7, alpha="0.08")
    angle = np.linspace(-pi, pi, 50, endpoint=False)
    edge = np.array(one.inverse) @ (one.radius * np.stack([np.cos(angle), np.sin(angle)]))
    next = map.step(one.centre[0] + edge[0], one.centre[1] + edge[1])
    back = np.remainder(next.theta - one.centre[0] - tau / 3 + pi, tau) - pi
    inside = np.linalg.solve(np.array(one.inverse), np.stack([back, next.phi - one.centre[1]]))
    assert np.all(np.hypot(*inside) < one.radius)


def test_a_saddle_is_no_disc():
    assert not attracts(FOUND.map, disc(FOUND.map, (-0.14235898, 0.43119899), 1e-3), tau / 3)


def test_every_check_may_fail_and_nothing_is_refuted():
    assert set(FOUND.checks) == set(CHECKS)
    with pytest.raises(ValueError, match="accepted: one smooth closed curve"):
        replace(FOUND, scene=Scene("cuspless"))
    with pytest.raises(ValueError, match="no symmetry of the table"):
        replace(FOUND, turn=(Fraction(1, 4), Fraction(2, 3)))
    with pytest.raises(ValueError, match="lam is in"):
        replace(FOUND, lam=Fraction(1))
