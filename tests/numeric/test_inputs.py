"""Bad input: one sentence that names the argument, the value and what would be accepted."""

import numpy as np
import pytest
from sympy import S, cos, pi, sin

from numeric import PinballMap
from symbolic.symbols import theta
from symbolic.table import Component, Table


@pytest.mark.parametrize(
    ("lam", "words"),
    [
        (1.5, "lam = 1.5 is no contraction; lam must lie in"),
        (-1e-9, "lam must lie in"),
        (float("nan"), "lam contains nan"),
        ([], "lam is empty"),
        ("steep", "lam = 'steep' is no number"),
        (1j, "lam has dtype complex128"),
    ],
)
def test_a_contraction_that_is_none(lam, words):
    with pytest.raises(ValueError, match=words):
        PinballMap("circle", lam=lam)


@pytest.mark.parametrize(
    ("theta", "phi", "words"),
    [
        (np.nan, 0.0, "theta contains nan; every value must be finite"),
        (0.0, np.inf, "phi contains inf"),
        (0.0, 1.6, r"phi = 1.6 does not point into the table; \|phi\| must be below pi/2"),
        ([], [], "theta and phi are empty"),
        ("north", 0.0, "theta has dtype"),
        (1j, 0.0, "theta has dtype complex128; give real numbers"),
        (np.array(1.0, dtype=np.longdouble), 0.0, "theta has dtype"),
        ([[0.1], [0.2, 0.3]], 0.0, "inhomogeneous"),
    ],
)
def test_a_start_that_is_none(theta, phi, words):
    with pytest.raises(ValueError, match=words):
        PinballMap("circle", lam=0.5).step(theta, phi)


@pytest.mark.parametrize(
    ("name", "shape", "words"),
    [
        ("egg", {}, "egg: the shape parameter alpha needs a value"),
        ("egg", {"alpha": 0.2}, r"egg: alpha = 1/5 makes the table non-convex; alpha must lie in \[0, 1/10\]"),
        ("egg", {"alpha": "soft"}, "egg: alpha = 'soft' is no number"),
        ("egg", {"alpha": float("nan")}, "egg: alpha = nan is no number"),
        ("ellipse", {"a": "1/2"}, r"ellipse: a = 1/2 makes the y axis the longer one; a must lie in \[1, oo\)"),
        ("ellipse", {"b": 2}, "ellipse: no shape parameter b; it has: a"),
        ("square", {}, "no table is called 'square'"),
    ],
)
def test_a_table_that_is_none(name, shape, words):
    with pytest.raises(ValueError, match=words):
        PinballMap(name, lam=0.5, **shape)


def test_places_and_counts_that_are_none():
    map = PinballMap("cuspless", lam=0.5)

    with pytest.raises(ValueError, match=r"theta = 3\.0 is not on the arc"):
        map.step(3.0, 0.0)
    with pytest.raises(ValueError, match="component 2 does not exist; the table has 0 to 1: arc, wall"):
        map.step(0.0, 0.0, 2)
    with pytest.raises(ValueError, match="no component is called 'roof'"):
        map.step(0.0, 0.0, "roof")
    with pytest.raises(ValueError, match="bounces = 0 is not possible; give a whole number of at least 1"):
        map.orbit(0.0, 0.0, 0)
    with pytest.raises(ValueError, match="give one lam for each ball, or one"):
        PinballMap("circle", lam=[0.5, 0.6]).step(np.zeros(3), 0.1)


def test_a_parameter_on_a_closed_curve_may_wind():
    map = PinballMap("egg", lam=0.5, alpha="0.08")

    assert map.step(7.0, 0.3).x == pytest.approx(map.step(7.0 - 2 * np.pi, 0.3).x, abs=1e-14)


def test_integers_and_single_precision_are_numbers():
    map = PinballMap("circle", lam=1)

    assert map.step(1, 0).theta == map.step(1.0, 0.0).theta
    assert map.step(np.float32(0.5), 0.0).theta == map.step(0.5, 0.0).theta


def test_no_ball_starts_at_the_cusp():
    with pytest.raises(ValueError, match="is the cusp, where no normal and so no exit is defined"):
        PinballMap("cardioid", lam=0.5).step(np.pi, 0.3)


def test_components_that_do_not_close():
    half, lid = (cos(theta), sin(theta)), (theta, S.Zero)
    components = Component("half", half, S.Zero, pi), Component("lid", lid, -S.One, S.Half)

    with pytest.raises(ValueError, match="open: the boundary is not closed: lid ends at "):
        PinballMap(Table("open", components), lam=0.5)
