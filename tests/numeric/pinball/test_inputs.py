"""Bad input: one sentence that names the argument, the value and what would be accepted."""

import re
from fractions import Fraction

import numpy as np
import pytest
from sympy import Rational, S, cos, pi, sin, sqrt

from numeric import PinballMap
from numeric.pinball.states import angles, components, contraction, counted, real, shape_value
from symbolic.tables.table import Component, Table, theta


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


def test_numbers_of_any_real_kind_become_doubles():
    for given in (1, np.int8(1), np.uint64(1), np.float32(1), np.float64(1), S.One, Fraction(1)):
        assert (real("x", given).dtype, float(real("x", given))) == (np.float64, 1.0)
    assert real("x", [[1, 2], [3, 4]]).tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert real("x", [Fraction(1, 4), S.Half]).tolist() == [0.25, 0.5]
    assert angles("phi", [0.5]).tolist() == [0.5]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([1.0, np.nan, np.inf], "x contains nan; every value must be finite"),
        ([1.0, -np.inf], "x contains -inf"),
        (True, "x has dtype bool"),
        ("1", "x has dtype <U1; give real numbers that fit float64"),
        (np.ones(2, dtype=np.longdouble), "x has dtype float128"),
        (object, "is not a number or an array of numbers"),
        ([1, S.ImaginaryUnit], "is not a number or an array of numbers"),
        ([[1], [1, 2]], "x is no array of numbers: "),
    ],
)
def test_what_is_no_number_is_named(given, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        real("x", given)


def test_components_are_indices_or_one_name():
    names = ["arc", "wall"]

    assert (components("wall", names).tolist(), components([[0, 1]], names).tolist()) == (1, [[0, 1]])
    assert components(np.uint8(1), names).dtype == np.int64
    assert components(np.empty(0, dtype=int), names).size == 0
    for given, wrong in (([0, -1, 5], "component -1 does"), ([1, 2, -1], "component 2 does")):
        with pytest.raises(ValueError, match=wrong + " not exist; the table has 0 to 1: arc, wall"):
            components(given, names)
    with pytest.raises(ValueError, match="no component is called 'roof'; the table has: arc, wall"):
        components("roof", names)
    for given in (0.0, True):
        with pytest.raises(ValueError, match=r"component has dtype .*; give indices from 0 to 1"):
            components(given, names)


def test_a_contraction_lies_between_0_and_1_both_included():
    assert [float(contraction(given)) for given in (0, 1, "1/4", "0.5", Fraction(1, 8), 1e-300)] == [
        0, 1, 0.25, 0.5, 0.125, 1e-300,
    ]  # fmt: skip
    assert contraction([0.0, 1.0]).tolist() == [0.0, 1.0]
    for given, named in (
        ([0.5, -1e-9, 2.0], "lam = -1e-09 is"),
        ([1.0, 1.1], "lam = 1.1 is"),
        ("9/8", "lam = 1.125 is"),
    ):
        with pytest.raises(ValueError, match=re.escape(named)):
            contraction(given)
    for given in ("1/0", "fast"):
        with pytest.raises(ValueError, match=f"lam = '{given}' is no number such as 9/10 or 0.9".replace(".", r"\.")):
            contraction(given)


def test_shapes_are_the_numbers_that_they_show():
    for given in (0.08, "0.08", "2/25", Fraction(2, 25), Rational(2, 25), np.float64(0.08)):
        assert shape_value("a", given) == Fraction(2, 25)
        assert isinstance(shape_value("a", given), Fraction)
    assert (shape_value("a", 3), shape_value("a", Rational(3)), shape_value("a", np.int64(3))) == (3, 3, 3.0)
    assert shape_value("a", sqrt(2)) == 2**0.5
    for given in (True, "soft", "1/0", float("nan"), float("inf"), None, 1j, pi * S.ImaginaryUnit):
        with pytest.raises(ValueError, match=r"a = .* is no number"):
            shape_value("a", given)


def test_counts_are_whole_and_large_enough():
    assert (counted("n", 1), counted("n", np.int64(3)), counted("n", 0, least=0), counted("n", 7, 7)) == (1, 3, 0, 7)
    assert type(counted("n", np.int64(3))) is int
    for given, least in ((0, 1), (True, 1), (1.0, 1), ("1", 1), (6, 7), (-1, 0)):
        with pytest.raises(
            ValueError, match=rf"n = {given!r} is not possible; give a whole number of at least {least}"
        ):
            counted("n", given, least)
