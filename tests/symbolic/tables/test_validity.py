"""Bad input is refused in one clear sentence; a table of one's own works."""

from decimal import Decimal
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Dummy, Float, I, Interval, Rational, S, Symbol, cos, exp, nan, pi, simplify, sin, sqrt, tan

from symbolic.expressions.signs import Outcome
from symbolic.tables import arc, cardioid, circle, cuspless, egg, ellipse, named, parametric, piecewise, polar
from symbolic.tables.curves import chord_of_length_zero
from symbolic.tables.geometry import boundary_coefficients, perimeter
from symbolic.tables.table import Component, Shape, Table, a, theta
from symbolic.tables.validity import enclosed_area, radius_sign, validated

b = Symbol("b")


def limacon(swing):
    return (1 + swing * cos(theta)) * cos(theta), (1 + swing * cos(theta)) * sin(theta)


def stadium(sense: int = 1, gap: int = 0) -> Table:
    return piecewise(
        arc("bottom", theta, -sense, -1, 1),
        arc("right", 1 + gap + cos(theta), sense * sin(theta), -pi / 2, pi / 2),
        arc("top", -theta, sense, -1, 1),
        arc("left", cos(theta) - 1, sense * sin(theta), pi / 2, 3 * pi / 2),
        name="stadium",
    )


def bow_tie() -> Table:
    sides = [(theta, theta), (S.One, -theta), (-theta, theta), (-S.One, -theta)]
    return piecewise(*(arc(f"side {i}", x, y, -1, 1) for i, (x, y) in enumerate(sides)))


BAD = {
    "a float in a formula": (lambda: polar(1 + 0.08 * cos(3 * theta)), "contains a rounded float"),
    "a float alone": (lambda: polar(1.5), "contains a rounded float"),
    "an unknown symbol": (lambda: polar(1 + b * cos(theta)), "unknown symbol b in .*; it may use: theta$"),
    "another letter for the parameter": (lambda: polar(1 + cos(Symbol("t")) / 9), "unknown symbol t in"),
    "an open spiral": (lambda: polar(5 + theta), r"ends at \(-5 - pi, 0\) and polar starts at \(-5 \+ pi, 0\)$"),
    "a half circle": (lambda: piecewise(arc("half", cos(theta), sin(theta), 0, pi)), "half ends at .* half starts at"),
    "a gap between components": (lambda: stadium(gap=1), "not closed: bottom ends at .* right starts at"),
    "a figure eight": (lambda: parametric(sin(theta), sin(2 * theta)), "area 0; it crosses itself"),
    "a bow tie": (bow_tie, "area 0; it crosses itself"),
    "a wall there and back": (lambda: parametric(cos(theta), 0), "runs back along itself"),
    "an uneven eight": (lambda: parametric(cos(theta), sin(2 * theta) + sin(theta) / 2), "meets itself, or stops"),
    "a limacon": (lambda: polar(1 + 2 * cos(theta)), "is not positive for every theta"),
    "a limacon by coordinates": (lambda: parametric(*limacon(2)), "itself, or stops, near theta = -12[01] and 12[01]"),
    "a limacon with a cusp": (lambda: polar(1 + 2 * cos(theta), undefined=cardioid.undefined), "crosses itself, near"),
    "a cusp not named": (lambda: polar(1 + cos(theta)), "or its cusp named"),
    "a point": (lambda: polar(0), "is not positive"),
    "a circle run twice": (lambda: parametric(cos(2 * theta), sin(2 * theta)), "meets itself"),
    "a clockwise circle": (lambda: parametric(cos(theta), -sin(theta)), "runs clockwise; exchange theta for -theta"),
    "a clockwise stadium": (lambda: stadium(-1), "runs clockwise"),
    "a clockwise cusp": (
        lambda: parametric(*(p.subs(theta, -theta) for p in limacon(1)), undefined=cardioid.undefined),
        "runs clockwise",
    ),
    "a clockwise family": (
        lambda: parametric(a * cos(theta), -sin(theta), shapes=ellipse.shapes), "runs clockwise",
    ),
    "a clockwise wiggle": (lambda: parametric(cos(theta), -sin(theta) - sin(9 * theta) / 99), "clockwise"),
    "a pole": (lambda: polar(1 / cos(theta)), "has a pole"),
    "a complex radius": (lambda: polar(1 + I * cos(theta) / 9), "no finite real expression"),
    "no number": (lambda: polar(nan), "no finite real expression"),
    "an infinite radius": (lambda: polar(S.Infinity), "no finite real expression"),
    "a radius of minus infinity": (lambda: polar(S.NegativeInfinity), "no finite real expression"),
    "a radius of no direction": (lambda: polar(S.ComplexInfinity), "no finite real expression"),
    "no component": (piecewise, "needs at least one component"),
    "an arc run backwards": (lambda: piecewise(arc("loop", cos(theta), sin(theta), pi, -pi)), "larger number"),
    "an end that moves": (lambda: piecewise(arc("loop", cos(theta), sin(theta), 0, theta)), "larger number"),
    "a shape too small": (lambda: ellipse.at(a="0.5"), r"a = 1/2 makes .*; a must lie in \[1, oo\)$"),
    "a negative shape": (lambda: egg(3).at(alpha=-1), r"alpha must lie in \[0, 1/10\]$"),
    "a float shape": (lambda: ellipse.at(a=1.5), r"a = 1.5 is a rounded float; write it exactly"),
    "a SymPy float shape": (lambda: ellipse.at(a=Float("1.5")), "is a rounded float"),
    "a decimal shape": (lambda: ellipse.at(a=Decimal("1.5")), "is a rounded float"),
    "a complex shape": (lambda: ellipse.at(a=2 + I), "must lie in"),
    "an infinite shape": (lambda: ellipse.at(a=S.Infinity), "must lie in"),
    "a shape divided by zero": (lambda: ellipse.at(a="1/0"), "is no exact number"),
    "a shape in words": (lambda: ellipse.at(a="two"), "a = 'two' is no exact number such as 2/25 or 0.08"),
    "a truth value": (lambda: ellipse.at(a=True), "is no exact number"),
    "nothing": (lambda: ellipse.at(a=None), "is no exact number"),
    "a shape along the boundary": (lambda: ellipse.at(a=2 + cos(theta)), "changes along the boundary"),
    "a wrong shape name": (lambda: ellipse.at(b=2), "ellipse: no shape parameter b; it has: a$"),
    "a shape of a table without": (lambda: cardioid.at(a=2), "cardioid: no shape parameter a; it has: none$"),
    "an egg of one point": (lambda: egg(1), "egg: K = 1 is no number of points"),
    "a wrong component": (lambda: cuspless.component("roof"), "cuspless: no component roof; it has: arc, wall$"),
    "a wrong table": (lambda: named("square"), "no table is called square"),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD)
def test_bad_input_is_refused_in_one_sentence(what):
    build, sentence = BAD[what]
    with pytest.raises(ValueError, match=sentence) as refusal:
        build()

    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 220


@pytest.mark.parametrize("text", ["__import__('pathlib').Path('{0}').touch()", "open('{0}', 'w')", "theta.__class__"])
def test_text_is_never_executed(text, tmp_path: Path):
    left = tmp_path / "left_behind"
    for build in (lambda t: polar(t), lambda t: parametric(t, t), lambda t: ellipse.at(a=t)):
        with pytest.raises(ValueError, match=r".+"):
            build(text.format(left))

    assert not left.exists()


def test_a_stadium_of_ones_own_has_the_right_perimeter_and_area():
    assert simplify(perimeter(stadium()) - (4 + 2 * pi)) == 0
    assert enclosed_area(stadium()) == 4 + pi


def test_a_family_of_ones_own_keeps_its_range():
    width = Symbol("width", positive=True)
    shape = Shape(width, Interval(1, 3), "is too wide for the box")
    table = parametric(width * cos(theta), 2 * sin(theta), "oval", [shape])

    assert table.at(width=2).components[0].at(S.Zero) == (2, 0)
    with pytest.raises(ValueError, match=r"^oval: width = 4 is too wide for the box; width must lie in \[1, 3\]$"):
        table.at(width=4)


def test_a_plain_letter_theta_becomes_the_boundary_parameter():
    assert polar(1 + cos(3 * Symbol("theta")) / 20) == polar(1 + cos(3 * theta) / 20)


def test_the_paper_s_tables_which_are_written_down_unproved_pass_and_are_not_changed():
    for table in (circle, ellipse, cardioid, cuspless, egg(3)):
        assert validated(table) == table


@settings(max_examples=25)
@given(st.fractions(Rational(-3), Rational(3), max_denominator=20))
@example(Rational(1))
@example(Rational(-1))
@example(Rational(999, 1000))
def test_a_limacon_is_a_table_exactly_when_its_radius_stays_positive(swing):
    swing = Rational(swing.numerator, swing.denominator)
    if abs(swing) < 1:
        assert enclosed_area(polar(1 + swing * cos(theta))) == pi * (1 + swing**2 / 2)
    else:
        with pytest.raises(ValueError, match="not positive"):
            polar(1 + swing * cos(theta))


@settings(max_examples=8)
@given(st.fractions(Rational(-2), Rational(2), max_denominator=8).filter(lambda f: abs(abs(f) - 1) > 0.05))
def test_self_crossings_are_found_by_coordinates_alone(swing):
    swing = Rational(swing.numerator, swing.denominator)
    c = boundary_coefficients(Component("limacon", limacon(swing), -pi, pi))

    assert (chord_of_length_zero(c) is None) == (abs(swing) < 1)


def test_an_area_too_hard_to_integrate_is_not_judged():
    x, y = (coordinate / (2 + cos(theta)) for coordinate in (cos(theta), sin(theta)))

    assert enclosed_area(Table("hard", (Component("hard", (x, y), -pi, pi),))) is None
    assert parametric(x, y).components[0].at(Dummy("p") * 0) == (Rational(1, 3), 0)


def polygon(*corners: tuple[int, int]) -> Table:
    ring = [*corners, corners[0]]
    sides = [(p, q) for p, q in pairwise(ring)]
    return piecewise(
        *(arc(f"{p} to {q}", p[0] + (q[0] - p[0]) * theta, p[1] + (q[1] - p[1]) * theta, 0, 1) for p, q in sides)
    )


CROSSED = {
    "sides of unequal triangles": lambda: polygon((0, 0), (4, 2), (4, 0), (0, 3)),
    "a high harmonic": lambda: parametric(cos(theta) + cos(12 * theta) / 2, sin(theta) + sin(12 * theta) / 2),
    "no finite sum, wound twice": lambda: parametric(
        exp(cos(theta)) * cos(2 * theta), exp(cos(theta)) * sin(2 * theta)
    ),
    "a family at one of its shapes": lambda: parametric(
        cos(theta) + b * cos(2 * theta), sin(theta) + b * sin(2 * theta), shapes=[Shape(b, Interval(0, 5), "crosses")]
    ).at(b=2),
}


@pytest.mark.parametrize("made", CROSSED.values(), ids=CROSSED.keys())
def test_a_crossing_is_found_where_no_proof_reaches(made):
    with pytest.raises(ValueError, match=r"crosses itself|meets itself|encloses area 0"):
        made()


def test_a_polygon_that_does_not_cross_is_a_table():
    assert perimeter(polygon((0, 0), (4, 0), (4, 3), (0, 3))) == 14


@pytest.mark.parametrize(
    "direction",
    [(1, 0), (4, 3), (3, 4), (0, 1), (-3, 4), (-1, 0), (-3, -4), (0, -1), (3, -4), (4, -3)],
    ids=str,
)
def test_the_least_radius_decides_in_whatever_direction_it_lies(direction):
    size = Rational(1, 5) if all(direction) else S.One
    dip = (1 - size * (direction[0] * cos(theta) + direction[1] * sin(theta))) ** 2

    assert radius_sign(dip + Rational(1, 50)) is Outcome.PROVED
    assert radius_sign(dip) is Outcome.REFUTED
    assert radius_sign(dip - Rational(1, 50)) is Outcome.REFUTED


def test_a_sum_along_the_ray_is_no_radius_where_the_point_is_off_the_ray():
    x, y = cos(theta) + 2 * sin(theta) ** 2, sin(theta) - 2 * sin(theta) * cos(theta)

    assert simplify(x * cos(theta) + y * sin(theta)) == 1  # yet theta = pi/3 and -pi/3 are one point
    with pytest.raises(ValueError, match="meets itself"):
        parametric(x, y)


POLES = {
    "in y alone": (cos(theta), 1 / (2 * sin(theta) - 1)),
    "in x alone": (1 / (3 * cos(theta) - 2), sin(theta)),
    "opposite to theta = 0": (cos(theta), sin(theta) / (1 + cos(theta)) ** 2),
    "of a tangent": (cos(theta), tan(theta)),
}


@pytest.mark.parametrize("point", POLES.values(), ids=POLES.keys())
def test_a_pole_is_found_in_either_coordinate_and_wherever_it_lies(point):
    with pytest.raises(ValueError, match=r"has a pole, where .* = 0; a boundary must be finite"):
        parametric(*point)


def test_a_denominator_without_a_zero_is_no_pole_for_one_table_nor_for_a_family():
    x, y = cos(theta) / (2 + cos(theta)), sin(theta) / (2 + cos(theta))

    assert parametric(x, y).components[0].point == (x, y)
    assert parametric(a * x, y, shapes=ellipse.shapes).at(a=2).components[0].point == (2 * x, y)


def test_the_refusal_of_an_open_boundary_says_where_it_ends_and_where_it_should():
    where = r"bend ends at \(2, 6\) and bend starts at \(1, 3\)$"
    with pytest.raises(ValueError, match=where):
        piecewise(arc("bend", theta, theta**2 + 2, 1, 2))


ROOTED = [sqrt(1 + cos(theta) / 3) * wave(theta) for wave in (cos, sin)]  # no finite sum


@pytest.mark.parametrize("point", [(2 * cos(theta), sin(theta)), (cos(theta), sin(theta)), ROOTED])
@pytest.mark.parametrize("rate", [S.One, S(2), Rational(1, 2), pi])
def test_a_closed_curve_may_run_once_through_any_parameter_and_not_twice(point, rate):
    x, y = (coordinate.subs(theta, rate * theta) for coordinate in point)

    assert piecewise(arc("once", x, y, -pi / rate, pi / rate)).components[0].point == (x, y)
    with pytest.raises(ValueError, match=r"meets itself, or stops|turns round 2 times"):
        piecewise(arc("twice", x, y, -pi / rate, 3 * pi / rate))
