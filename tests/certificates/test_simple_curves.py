"""Boundaries whose curves meet themselves: the independent checker refuses them."""

import copy
from fractions import Fraction

import pytest
from committed import document

MARK = [{"name": "m", "component": 0, "theta": "pi"}]
SQUARE = [("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta")]


def curve(x, y):
    return {"parametric": [x, y]}


def pieces(*places):
    return {"component": [{"x": x, "y": y, "from": "0", "to": "1"} for x, y in places]}


def simple(check, scene):
    """Reads a boundary and checks that no curve of it meets itself."""
    return check.read_scene(scene | {"lam": "1/3"}, "", 128)[0]


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
    with pytest.raises((check.Unproved, check.Wrong), match=r"may cross itself|may not be positive"):
        simple(check, CROSSED[name])


def test_a_certificate_is_refused_whose_boundary_has_a_loop_far_from_its_cycle(check):
    """The cycle between the disc and one side is unchanged; the opposite side has a loop."""
    given = document("scatterer")
    looped = copy.deepcopy(given)
    looped["scene"]["component"][2] |= {
        "x": "1/2 - theta - sin(2*pi*theta)/4", "y": "1/2 + (1 - cos(2*pi*theta))/10"
    }  # fmt: skip

    assert check.checked(given).startswith("proved: ")
    with pytest.raises(check.Unproved, match="the boundary may cross itself"):
        check.checked(looped)


@pytest.mark.parametrize(
    ("x", "y", "turns"),
    [("0", "0", 1), ("3/2", "-1/3", 1), ("2", "0", None), ("0", "-1", None), ("5/2", "0", 0), ("-2", "-2", 0),
     ("-2", "-2/3", 0), ("2/3", "5", 0)],
)  # fmt: skip
@pytest.mark.parametrize("sign", [1, -1])
def test_a_curve_runs_round_a_point_once_or_not_at_all(check, x, y, turns, sign):
    """On the boundary nothing is decided; before and behind it on the ray's line the point is outside."""
    table = simple(check, SIMPLE["an ellipse"])
    table.parts[0][1] = check.parse(f"{sign}*sin(theta)")
    outline = check.beside("curves").Outline(table, {}, iter(range(10**4)), [])
    point = [check.I.of(Fraction(z), 96) for z in (x, y)]
    if turns is None:
        with pytest.raises(check.Unproved, match="the boundary may run through"):
            outline.winding(range(1), *point)
    else:
        assert outline.winding(range(1), *point) == turns * sign


@pytest.mark.parametrize(
    ("discs", "answer"),
    [
        ([], ""),
        ([("1/2", "1/2")], ""),
        ([("3/10", "1/2"), ("7/10 + 11/100", "1/2")], "two curves"),
        ([("3/10", "1/2"), ("9/10", "1/2")], "two curves"),  # through a side
        ([("3/4", "1/2")], "two curves"),  # touches a side
        ([("3", "1/2")], "does not lie inside"),
    ],
)
def test_holes_lie_inside_by_themselves(check, discs, answer):
    scene = pieces(*SQUARE)
    for x, y in discs:
        row = {"x": f"{x} + cos(theta)/4", "y": f"{y} - sin(theta)/4", "from": "-pi", "to": "pi"}
        scene["component"].append(row)
    if answer:
        with pytest.raises(check.Unproved, match=answer):
            simple(check, scene)
    else:
        simple(check, scene)


def test_an_island_in_a_hole_is_no_hole(check):
    """Two clockwise curves, one around the other, and an outer one around both."""
    rings = [("3", ""), ("2", "-"), ("1", "-")]
    scene = {
        "component": [
            {"x": f"{r}*cos(theta)", "y": f"{turn}{r}*sin(theta)", "from": "-pi", "to": "pi"} for r, turn in rings
        ]
    }
    with pytest.raises(check.Unproved, match="does not lie inside"):
        simple(check, scene)


def test_two_cusps_at_the_origin_are_one_point(check):
    """A radius that vanishes at two marked points gives two lobes, which meet there."""
    marks = [{"name": name, "component": 0, "theta": at} for name, at in (("a", "0"), ("b", "pi"))]
    with pytest.raises(check.Wrong, match="more than one point"):
        simple(check, {"polar": "sin(theta)**2", "undefined": marks})
