"""Bad input is refused in one clear sentence; a user's own table is accepted."""

from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Float, I, Interval, Rational, S, Symbol, cos, exp, nan, pi, simplify, sin, sqrt, tan

from symbolic.tables import arc, cardioid, circle, cuspless, egg, ellipse, named, parametric, piecewise, polar, polygon
from symbolic.tables.geometry import perimeter
from symbolic.tables.table import Shape, Table, a, theta
from symbolic.tables.validity import enclosed_area, validated

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


POLE = r"has a pole, where .* = 0; a boundary must be finite"
CROSSES = r"meets itself|encloses area 0"


def crossing_family() -> Table:
    shapes = [Shape(b, Interval(0, 5), "crosses")]
    return parametric(cos(theta) + b * cos(2 * theta), sin(theta) + b * sin(2 * theta), shapes=shapes)


FALLING = tuple((10**7 - theta**11 * (2 * pi - theta)) * x for x in (cos(theta), sin(theta)))
BELOW = Shape(Symbol("b", real=True), Interval(-2, -1), "")
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
    "an uneven eight": (lambda: parametric(cos(theta), sin(2 * theta) + sin(theta) / 2), "meets itself, or may"),
    "a limacon": (lambda: polar(1 + 2 * cos(theta)), "is not positive for every theta"),
    "a limacon by coordinates": (lambda: parametric(*limacon(2)), "near .* theta = -2.094.* and .* theta = 2.094"),
    "a limacon with a cusp": (lambda: polar(1 + 2 * cos(theta), undefined=cardioid.undefined), "may do so, near"),
    "a cusp not named": (lambda: polar(1 + cos(theta)), "or its cusp named"),
    "a point": (lambda: polar(0), "polar is the single point .0, 0., of length 0"),
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
    "sides that cross": (lambda: polygon((0, 0), (4, 2), (4, 0), (0, 3)), CROSSES),
    "a high harmonic": (
        lambda: parametric(cos(theta) + cos(12 * theta) / 2, sin(theta) + sin(12 * theta) / 2), CROSSES,
    ),
    "no finite sum, wound twice": (
        lambda: parametric(exp(cos(theta)) * cos(2 * theta), exp(cos(theta)) * sin(2 * theta)), CROSSES,
    ),
    "a family at one of its shapes": (lambda: crossing_family().at(b=2), CROSSES),
    "a pole": (lambda: polar(1 / cos(theta)), "has a pole"),
    "a pole in y alone": (lambda: parametric(cos(theta), 1 / (2 * sin(theta) - 1)), POLE),
    "a pole in x alone": (lambda: parametric(1 / (3 * cos(theta) - 2), sin(theta)), POLE),
    "a pole opposite to theta = 0": (lambda: parametric(cos(theta), sin(theta) / (1 + cos(theta)) ** 2), POLE),
    "a pole of a tangent": (lambda: parametric(cos(theta), tan(theta)), POLE),
    "a complex radius": (lambda: polar(1 + I * cos(theta) / 9), "no finite real expression"),
    "no number": (lambda: polar(nan), "no finite real expression"),
    "an infinite radius": (lambda: polar(S.Infinity), "no finite real expression"),
    "a radius of minus infinity": (lambda: polar(S.NegativeInfinity), "no finite real expression"),
    "a radius of no direction": (lambda: polar(S.ComplexInfinity), "no finite real expression"),
    "no component": (piecewise, "needs at least one component"),
    "an arc run backwards": (lambda: piecewise(arc("loop", cos(theta), sin(theta), pi, -pi)), "larger number"),
    "an end below the start": (lambda: piecewise(arc("s", theta, 0, 0, BELOW.symbol), shapes=[BELOW]), "larger number"),
    "a radius without a period": (lambda: piecewise(arc("c", *FALLING, 0, 2 * pi)), "meets itself"),
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
    "a shape along the boundary": (lambda: ellipse.at(a=2 + cos(theta)), "depends on theta"),
    "a wrong shape name": (lambda: ellipse.at(b=2), "ellipse: no shape parameter b; it has: a$"),
    "a shape of a table without": (lambda: cardioid.at(a=2), "cardioid: no shape parameter a; it has: none$"),
    "an egg of one point": (lambda: egg(1), "egg: K = 1 is no number of points"),
    "a wrong component": (lambda: cuspless.component("roof"), "cuspless: no component roof; it has: arc, wall$"),
    "a wrong table": (lambda: named("square"), "no table is called square"),
}  # fmt: skip


@pytest.mark.slow
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


@pytest.mark.slow
@settings(max_examples=8)
@given(st.fractions(Rational(-2), Rational(2), max_denominator=8).filter(lambda f: abs(abs(f) - 1) > 0.05))
def test_self_crossings_are_found_by_coordinates_alone(swing):
    swing = Rational(swing.numerator, swing.denominator)
    if abs(swing) < 1:
        assert parametric(*limacon(swing)).name == "parametric"
    else:
        with pytest.raises(ValueError, match="meets itself, or may"):
            parametric(*limacon(swing))


ROOTED = [sqrt(1 + cos(theta) / 3) * wave(theta) for wave in (cos, sin)]  # no finite sum


@pytest.mark.slow
@pytest.mark.parametrize("point", [(2 * cos(theta), sin(theta)), (cos(theta), sin(theta)), ROOTED])
@pytest.mark.parametrize("rate", [S.One, S(2), Rational(1, 2), pi])
def test_a_closed_curve_may_run_once_through_any_parameter_and_not_twice(point, rate):
    x, y = (coordinate.subs(theta, rate * theta) for coordinate in point)

    assert piecewise(arc("once", x, y, -pi / rate, pi / rate)).components[0].point == (x, y)
    with pytest.raises(ValueError, match="meets itself, or may"):
        piecewise(arc("twice", x, y, -pi / rate, 3 * pi / rate))
