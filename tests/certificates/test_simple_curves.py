"""A closed curve that meets itself bounds no table: the second reader asks, and canaries are refused."""

import copy
import json
from fractions import Fraction
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "certificates"
MARK = [{"name": "m", "component": 0, "theta": "pi"}]
SQUARE = [("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta")]


def curve(x, y):
    return {"parametric": [x, y]}


def pieces(*places):
    return {"component": [{"x": x, "y": y, "from": "0", "to": "1"} for x, y in places]}


def simple(check, scene):
    """Asks of the boundary that no curve of it meets itself."""
    table = check.read_scene(scene | {"lam": "1/3"}, "", 128)[0]
    check.beside("curves").simple(table, table.letters, 64)


SIMPLE = {
    "an ellipse": curve("2*cos(theta)", "sin(theta)"),
    "an egg": curve("(1 + 2*cos(3*theta)/25)*cos(theta)", "(1 + 2*cos(3*theta)/25)*sin(theta)"),
    "a bean, which is no star about the origin": curve("cos(theta)", "sin(theta)/2 + 9*cos(theta)**2/10"),
    "a limacon without a loop": curve("(1 + 9*cos(theta)/10)*cos(theta)", "(1 + 9*cos(theta)/10)*sin(theta)"),
    "a loop that has just opened": curve("(1 + 99*cos(theta)/100)*cos(theta)", "(1 + 99*cos(theta)/100)*sin(theta)"),
    "an ellipse whose formulas have no value on wide arcs": curve(
        "cos(theta)/(1 + cos(theta)/2 + sin(theta)/2)", "sin(theta)/(1 + cos(theta)/2 + sin(theta)/2)"
    ),
    "a square": pieces(*SQUARE),
    "a square with a sharp corner": pieces(
        ("theta", "1 - theta"), ("1 - theta/100", "theta"), ("99*(1 - theta)/100", "1")
    ),
    "a cardioid whose cusp is marked": {"polar": "1 + cos(theta)", "undefined": MARK},
}  # fmt: skip
CROSSED = {
    "a figure eight": curve("sin(theta)", "sin(2*theta)/2"),
    "a limacon with a loop": curve("(1 + 2*cos(theta))*cos(theta)", "(1 + 2*cos(theta))*sin(theta)"),
    "a limacon with a loop, as a radius": {"polar": "1 + 2*cos(theta)", "undefined": MARK},
    "a loop of a fiftieth": curve("(1 + 51*cos(theta)/50)*cos(theta)", "(1 + 51*cos(theta)/50)*sin(theta)"),
    "a circle run through twice": curve("cos(2*theta)", "sin(2*theta)"),
    "a curve that touches itself": curve("cos(theta)", "sin(theta)*cos(theta)**2"),
    "an ellipse of no width": curve("cos(theta)", "0*sin(theta)"),
    "a square with a loop at one side": pieces(
        *SQUARE[:2], ("1 - theta - sin(2*pi*theta)/4", "1 + (1 - cos(2*pi*theta))/10"), SQUARE[3]
    ),
    "two sides that cross": pieces(("theta", "0"), ("1 - theta", "theta"), ("theta", "1"), ("1 - theta", "1 - theta")),
    "a side that comes back on itself": pieces(("theta", "0"), ("1 - theta", "0")),
}


@pytest.mark.parametrize("name", SIMPLE)
def test_a_curve_that_does_not_meet_itself_is_proved_not_to(check, name):
    simple(check, SIMPLE[name])


@pytest.mark.parametrize("name", CROSSED)
def test_a_curve_that_meets_itself_is_not_proved(check, name):
    with pytest.raises(check.Unproved, match="the boundary may cross itself"):
        simple(check, CROSSED[name])


def test_a_certificate_is_refused_whose_boundary_has_a_loop_far_from_its_cycle(check):
    """Between the disc and one side the cycle stays what it is; the opposite side has got a loop."""
    given = json.loads((FOLDER / "scatterer.json").read_text())
    looped = copy.deepcopy(given)
    looped["scene"]["component"][2] |= {
        "x": "1/2 - theta - sin(2*pi*theta)/4", "y": "1/2 + (1 - cos(2*pi*theta))/10"
    }  # fmt: skip

    assert check.checked(given).startswith("proved: ")
    with pytest.raises(check.Unproved, match="the boundary may cross itself"):
        check.checked(looped)


@pytest.mark.parametrize(
    ("x", "y", "answer"),
    [
        ("0", "0", None),
        ("3/2", "-1/3", None),
        ("2", "0", "the boundary may run through a chord"),
        ("0", "-1", "the boundary may run through a chord"),
        ("5/2", "0", "does not run once round a chord"),
        ("-2", "-2", "does not run once round a chord"),
        ("-2", "-2/3", "does not run once round a chord"),
    ],
)
def test_a_point_is_proved_to_be_inside_of_an_ellipse_or_not(check, x, y, answer):
    """On the boundary nothing is decided; before and behind it on the line that is looked along, it is outside."""
    table = check.read_scene(SIMPLE["an ellipse"] | {"lam": "1/3"}, "", 128)[0]
    inside = lambda: check.beside("curves").inside(table, *(check.I.of(Fraction(z), 64) for z in (x, y)), table.letters)  # noqa: E731
    if answer is None:
        inside()
    else:
        with pytest.raises(check.Unproved, match=answer):
            inside()


@pytest.mark.parametrize("clockwise", [False, True])
def test_a_crossing_behind_a_point_is_counted_only_where_it_is_not_at_the_end_of_an_arc(check, clockwise):
    """Behind (3/2, -1/2) the line meets the ellipse at (0, -1), where an arc ends. Half a crossing counted as none
    makes one round of two: two ovals, one round the other, both counterclockwise, bound no table."""
    turn = "-" if clockwise else ""
    oval = {"x": "2*cos(theta)", "y": f"{turn}sin(theta)", "from": "-pi", "to": "pi"}
    outer = oval | {"x": "9*cos(theta)", "y": "9*sin(theta)"}
    table = check.read_scene({"component": [outer, oval], "lam": "1/3"}, "", 128)[0]
    point = [check.I.of(Fraction(z), 64) for z in ("3/2", "-1/2")]

    with pytest.raises(check.Unproved, match="the boundary may run through a chord"):
        check.beside("curves").inside(table, *point, table.letters)
