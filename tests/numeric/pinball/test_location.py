"""Points of the boundary are found again on every component, at their ends, and nowhere else."""

import numpy as np
import pytest
from sympy import cos, pi, sin

from numeric import PinballMap
from numeric.pinball.coordinates import located
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
LENS = tables.piecewise(
    tables.arc("lower", 2 * cos(theta), sin(theta) / 3, pi, 2 * pi),
    tables.arc("upper", 2 * cos(theta), sin(theta), 0, pi),
    name="lens",
)


@pytest.fixture(params=["ellipse", "lens", "cuspless", "egg"])
def states(request):
    """The coordinates of a table."""
    shape = {"ellipse": {"a": 7}, "egg": {"alpha": "0.1"}}.get(request.param, {})
    return PinballMap(LENS if request.param == "lens" else request.param, **shape).states


def test_points_between_the_grid_are_found_to_the_last_bits(states):
    for component, (low, high) in enumerate(states.ends):
        at = low + (high - low) * (np.arange(1, 60).reshape(1, 59) / 60.0 + 1e-4)
        where, found = located(states, *states.point(np.full(at.shape, component), at))

        assert np.array_equal(where, np.full(at.shape, component))
        assert np.max(np.abs(found - at) * np.minimum(1, states.speed(where, at))) <= 16 * EPS * max(
            1, abs(low), abs(high)
        )


def test_ends_are_on_their_components(states):
    for component, (low, high) in enumerate(states.ends):
        x, y = states.point(np.full(2, component), np.array([low, high]))
        where, found = located(states, x, y)
        px, py = states.point(where, found)

        assert np.max(np.hypot(px - x, py - y)) <= 8 * EPS * 7
        for index, at in zip(where, found, strict=True):
            first, last = states.ends[index]
            assert first <= at <= last


@pytest.mark.parametrize("off", [1e-12, -1e-12, 1e-9, -1e-9])
def test_a_point_next_to_the_boundary_belongs_to_its_foot(off):
    """By Gauss and Newton; a point off by more than a billionth of the table's size is refused."""
    states = PinballMap("ellipse", a=7).states
    at = np.linspace(-3, 3, 13)
    where = np.zeros(13, dtype=int)
    (x, y), (tx, ty) = states.point(where, at), states.tangent(where, at)
    _, found = located(states, x - off * ty, y + off * tx)

    assert np.max(np.abs(found - at) * states.speed(where, at)) <= 16 * EPS * 7
    for much in (8e-9, -8e-9):
        with pytest.raises(ValueError, match=r"is not on the boundary; it is 8e-09 away from it"):
            located(states, x - much * ty, y + much * tx)


def test_the_nearest_component_is_taken_and_the_farthest_point_named():
    states = PinballMap(LENS).states
    where, _ = located(states, np.array([0.0, 0.0]), np.array([1.0, -1 / 3]))

    assert where.tolist() == [1, 0]
    with pytest.raises(ValueError, match=r"the point \(0\.0, 0\.5\) is not on the boundary; it is 0\.5 away"):
        located(states, np.array([0.0, 0.0]), np.array([1.0, 0.5]))
    with pytest.raises(ValueError, match="x and y are empty; give at least one point"):
        located(states, np.empty(0), np.empty(0))


def test_off_is_measured_by_the_size_of_the_table():
    small = PinballMap(tables.parametric(cos(theta) / 1000, sin(theta) / 900, name="small")).states

    assert abs(located(small, np.array(1e-3 + 5e-13), np.array(0.0))[1]) < 1e-8
    with pytest.raises(ValueError, match=r"it is 1e-10 away"):
        located(small, np.array(1e-3 + 1e-10), np.array(0.0))


def test_of_several_points_off_the_boundary_the_first_is_named():
    with pytest.raises(ValueError, match=r"the point \(0\.5, 0\.25\) is not on the boundary; it is 0\.441 away"):
        located(PinballMap("circle").states, np.array([1.0, 0.5, 2.0]), np.array([0.0, 0.25, 0.0]))
