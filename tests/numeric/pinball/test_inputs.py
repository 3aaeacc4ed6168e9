"""Bad input gives one sentence that names the argument, its value and the values that would be accepted."""

import numpy as np
import pytest
from sympy import Interval, S, Symbol, cos, sin

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import Component, Shape, Table, theta


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
        ([0.1, 0.2], [0.1, 0.2, 0.3], r"theta has shape \(2,\), phi \(3,\) and component"),
        ([[0.1], [0.2, 0.3]], 0.0, "inhomogeneous"),
        (np.ma.masked_greater([0.1, 0.2, 0.3], 0.15), 0.0, "theta is a masked array with 2 missing entries"),
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
        ("hexagon", {}, "no table is called 'hexagon'; accepted: circle, ellipse, .*, diamond"),
        ("stadium", {"length": 2}, "stadium: length is none of its lengths; it has: straight, radius"),
        ("stadium", {"radius": -1}, "stadium: radius = -1 is no length; accepted: positive numbers"),
        ("stadium", {"radius": "wide"}, "stadium: radius"),
        ("stadium", {"radius": float("nan")}, "stadium: radius"),
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
    with pytest.raises(ValueError, match="give one lam for each particle, or one"):
        PinballMap("circle", lam=[0.5, 0.6]).step(np.zeros(3), 0.1)


def test_integers_are_numbers():
    map = PinballMap("circle", lam=1)

    assert map.step(1, 0).theta == map.step(1.0, 0.0).theta


def test_no_ball_starts_at_the_cusp():
    with pytest.raises(ValueError, match="is the cusp, where no normal and so no exit is defined"):
        PinballMap("cardioid", lam=0.5).step(np.pi, 0.3)


@pytest.mark.parametrize("kind", [np.float32, np.float16])
def test_short_floats_are_the_numbers_that_they_are(kind):
    ellipse = PinballMap("ellipse", a=2, lam=0.5)
    start = np.array([0.1, 0.7, -2.3], dtype=kind)
    assert np.array_equal(ellipse.orbit(start, 0.3, 5).theta, ellipse.orbit(start.astype(float), 0.3, 5).theta)


def test_a_masked_array_that_misses_nothing():
    ellipse = PinballMap("ellipse", a=2, lam=0.5)
    assert (
        ellipse.step(np.ma.masked_greater([0.1, 0.2], 5), 0.3).theta.tolist()
        == ellipse.step([0.1, 0.2], 0.3).theta.tolist()
    )


def test_a_parameter_beyond_an_end_by_its_rounding_is_that_end():
    square = PinballMap("square", lam=0.5)
    assert square.step(-1e-18, 0.1, 0).x == square.step(0.0, 0.1, 0).x
    with pytest.raises(ValueError, match="is not on the side1"):
        square.step(-1e-9, 0.1, 0)


def test_what_is_written_down_as_a_table_is_proved_to_be_one():
    ends = [(0, 0), (2, 0), (0, 2), (2, 2)]
    sides = [
        Component(
            f"side{i}", tuple(p + (q - p) * theta for p, q in zip(ends[i - 1], ends[i], strict=True)), S.Zero, S.One
        )
        for i in range(4)
    ]
    with pytest.raises(ValueError, match="crossing: the boundary encloses area"):
        PinballMap(Table("crossing", tuple(sides)), lam=0.5)


def test_a_table_is_proved_to_be_one_with_the_numbers_of_its_shape():
    b = Symbol("b", real=True)
    point = (1 + b * cos(theta)) * cos(theta), (1 + b * cos(theta)) * sin(theta)
    loop = tables.parametric(*point, "loop", [Shape(b, Interval(0, 2), "is too far")])
    assert PinballMap(loop, lam=0.5, b="1/2").step(0.1, 0.2).x < 0
    with pytest.raises(ValueError, match="loop is not proved to be a table"):
        PinballMap(loop, lam=0.5, b="3/2")
