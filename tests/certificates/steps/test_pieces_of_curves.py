"""The second reader looks at all of a boundary: pieces and pairs of arcs leave nothing out, and are seen one by one."""

from fractions import Fraction
from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import by_hand
import pytest

P = 64
number = partial(by_hand.number, p=P)


@pytest.fixture(scope="module")
def curves(check):
    return check.beside("curves")


def ends(x) -> tuple[Fraction, Fraction]:
    return Fraction(x.lo, 1 << x.p), Fraction(x.hi, 1 << x.p)


def test_pieces_that_are_seen_tile_the_whole_and_are_as_large_as_may_be(check, curves):
    """Seen where they are shorter than 1/8 left of 1/4, and shorter than 1/2 right of it."""
    done = []

    def settled(a, b):
        small = b - a < (Fraction(1, 8) if a < Fraction(1, 4) else Fraction(1, 2))
        return small and not done.append((a, b))

    curves.covered(settled, 100, "never")
    wanted = [Fraction(k, 16) for k in (0, 1, 2, 3, 4, 8, 12, 16)]
    assert sorted(done) == [*pairwise(wanted)]


def test_as_many_pieces_are_asked_as_are_allowed_and_then_nothing_is_proved(check, curves):
    asked = []
    with pytest.raises(check.Unproved, match="no end"):
        curves.covered(lambda a, b: asked.append((a, b)), 50, "no end")
    assert len(asked) == 49
    assert asked[:2] == [(0, 1), (Fraction(1, 2), 1)]


def test_what_has_no_value_on_a_wide_piece_is_not_seen_there_and_is_asked_of_its_halves(check, curves):
    asked = []

    def settled(a, b):
        asked.append((a, b))
        if b - a > Fraction(1, 2):
            raise check.Unproved("no value")
        return True

    curves.covered(settled, 100, "never")
    assert sorted(asked) == [(0, Fraction(1, 2)), (0, 1), (Fraction(1, 2), 1)]
    with pytest.raises(check.Wrong):
        curves.covered(lambda *_: check.need(False, "", check.Wrong), 100, "never")


@pytest.mark.parametrize(
    ("a", "b", "wanted"), [("0", "1", (-3, 5)), ("1/4", "1/2", (-1, 1)), ("3/8", "3/8", (0, 0)), ("1", "1", (5, 5))]
)
def test_a_part_of_what_lies_between_two_ends_is_that_share_of_it(check, curves, a, b, wanted):
    both = number(check, -3), number(check, 5)
    assert ends(curves.piece_of(both, Fraction(a), Fraction(b), P)) == wanted


def small(arcs, width) -> bool:
    return all(b - a <= Fraction(width) for _, (a, b) in arcs)


def test_pairs_of_arcs_of_two_curves_leave_no_pair_of_points_out(check, curves, monkeypatch):
    """Of three curves, one of them in two pieces, each piece with those of the other curves."""
    done = []
    monkeypatch.setattr(curves, "seen", lambda _, *arcs: small(arcs, "1/4") and not done.append(arcs))
    curves.apart(SimpleNamespace(curves=[range(2), range(2, 3), range(3, 4)]), {}, P)

    found = {}
    for (one, (a, b)), (other, (c, d)) in done:
        key = (one, other) if one > other else (other, one)
        rectangle = (a, b, c, d) if one > other else (c, d, a, b)
        found.setdefault(key, []).append(rectangle)
    assert found.keys() == {(2, 0), (2, 1), (3, 0), (3, 1), (3, 2)}
    quarters = [Fraction(k, 4) for k in range(4)]
    whole = [(a, a + Fraction(1, 4), c, c + Fraction(1, 4)) for a in quarters for c in quarters]
    assert all(sorted(each) == whole for each in found.values())


def test_curves_that_are_never_seen_apart_are_asked_so_often_and_then_refused(check, curves, monkeypatch):
    asked = []
    monkeypatch.setattr(curves, "seen", lambda _, *arcs: asked.append(arcs))
    with pytest.raises(check.Unproved, match="two curves of the boundary may meet"):
        curves.apart(SimpleNamespace(curves=[range(1), range(1, 2)]), {}, P)
    assert len(asked) == 3999


@pytest.mark.parametrize(
    ("one", "other", "met"),
    [
        (("theta", "0"), ("theta", "1/100"), False),
        (("theta", "0"), ("theta + 101/100", "0"), False),
        (("theta", "theta"), ("theta + 1/100", "theta - 1/100"), False),
        (("theta", "theta"), ("1 - theta", "theta"), True),
        (("theta", "theta"), ("theta + 1", "1"), True),  # at one end of both
        (("theta", "0"), ("0", "-theta"), True),
        (("theta + 1", "0"), ("-1 - theta", "0"), False),  # not where a point's opposite is
        (("theta + 1", "1"), ("-1 - theta", "-1"), False),
        (("theta", "1 + theta/2"), ("theta", "theta/2"), False),  # a whole step beside
        (("1 + theta/2", "theta"), ("theta/2", "theta"), False),
        (("1/(1/2 - theta + theta)", "theta"), ("theta", "theta"), False),  # without a value on wide pieces
    ],
)
def test_two_curves_lie_apart_where_no_points_are_common(check, curves, one, other, met):
    """Of straight pieces, theta from 2 to 3 on the first one and from 0 to 1 on the other, shifted back."""
    part = lambda formulas, low, high: [check.parse(text) for text in (*formulas, low, high)]  # noqa: E731
    table = check.Table([], {}, None, P)
    shifted = [text.replace("theta", "(theta - 2)") for text in one]
    table.parts, table.curves = [part(shifted, "2", "3"), part(other, "0", "1")], [range(1), range(1, 2)]
    if met:
        with pytest.raises(check.Unproved, match="two curves of the boundary may meet"):
            curves.apart(table, {}, P)
    else:
        curves.apart(table, {}, P)


def test_pairs_of_arcs_of_one_curve_leave_no_pair_of_points_out(check, curves, monkeypatch):
    """Of a curve of two pieces: each arc with itself, and with each other one once."""
    done = []
    monkeypatch.setattr(curves, "seen", lambda _, *arcs: small(arcs, "1/4") and not done.append(arcs))
    curves.embedded(SimpleNamespace(), range(2, 4), {}, P)

    arcs = [(part, (Fraction(k, 4), Fraction(k + 1, 4))) for part in (2, 3) for k in range(4)]
    wanted = [(arc, other) for k, arc in enumerate(arcs) for other in arcs[k:]]
    assert sorted(tuple(sorted(pair)) for pair in done) == wanted


@pytest.mark.parametrize("width", ["1/65536", "1/32768"])
def test_two_arcs_that_are_not_told_apart_are_refused_when_one_of_them_is_short(check, curves, monkeypatch, width):
    shortest = []
    monkeypatch.setattr(curves, "seen", lambda _, *arcs: small(arcs, width) or shortest.append(arcs))
    with pytest.raises(check.Unproved, match="the boundary may cross itself"):
        curves.embedded(SimpleNamespace(), range(1), {}, P)
    least = min(b - a for arcs in shortest for _, (a, b) in arcs)
    assert least == (Fraction(1, 32768) if width == "1/65536" else Fraction(1, 16384))
    assert len(shortest) < 20000


def test_an_arc_that_is_never_settled_is_halved_down_to_the_shortest_and_then_refused(check, curves, monkeypatch):
    asked = []
    monkeypatch.setattr(curves, "seen", lambda _, *arcs: asked.append(arcs))
    with pytest.raises(check.Unproved, match="the boundary may cross itself"):
        curves.embedded(SimpleNamespace(), range(1), {}, P)
    assert [{b - a for _, (a, b) in arcs} for arcs in asked] == [{Fraction(1, 2**k)} for k in range(17)]


def radius(check, curves, text, marks=(), low="-pi", high="pi"):
    """Asks of a radius whether it is positive but near the marks."""
    table = check.Table([], {}, None, P)
    table.parts = [[check.parse(part) for part in (text, low, high)]]
    table.marks = [(0, check.I.of(Fraction(mark), 100)) for mark in marks]
    with pytest.MonkeyPatch.context() as patch:
        real = curves.covered
        patch.setattr(curves, "covered", lambda settled, _, why: real(settled, 300, why))
        curves.beyond(table, {}, P)


@pytest.mark.parametrize(
    ("text", "marks", "proved"),
    [
        ("1 + 9*cos(theta)/10", (), True),
        ("1 + cos(theta - 1/2)", (), False),
        ("1 - cos(theta - 1/2)", ("1/2",), True),
        ("1 - cos(theta - 1/2)", ("1/2", "3"), True),
        ("1 - cos(theta - 1/2)", ("3",), False),
        ("1 - cos(theta + 3)", ("3.283185307179586476925286766559",), True),  # the same place, a turn on
        ("1 - cos(theta - 1/2)", ("-5.783185307179586476925286766559",), True),
        ("1 - cos(theta - 1/2)", ("13.066370614359172953850573533118",), True),
        ("1 - cos(theta - 1/2)", ("3.641592653589793238462643383279",), False),  # half a turn on
        ("1 - cos(theta - 1/2)", ("25.632741228718345907701147066236",), True),  # four turns on
        ("(theta - 1/2)**2 - 2**(-46)", ("1/2",), True),  # negative nearer than 2**-23
        ("(theta - 1/2)**2 - 2**(-38)", ("1/2",), False),  # and within 2**-19
        ("3 - theta + 2*theta - theta - 3 + 10**(-6)", (), True),  # small, by its slope
        ("1/(theta - 1/3)**2", ("1/3",), True),
        ("1/(theta - 1/3)", ("1/3",), False),
    ],
)
def test_a_radius_is_proved_positive_but_nearer_than_2_to_the_minus_20_to_a_mark(check, curves, text, marks, proved):
    if proved:
        radius(check, curves, text, marks)
    else:
        with pytest.raises(check.Unproved, match="where its radius may not be positive"):
            radius(check, curves, text, marks)


def test_a_piece_that_reaches_as_far_from_a_mark_as_is_near_needs_no_more(check, curves):
    """From 0, the mark, to 1: the radius `theta - 2**-21` is 0 where the halves of the last piece meet."""
    radius(check, curves, "theta - 2**(-21)", ("0",), "0", "1")
    with pytest.raises(check.Unproved):
        radius(check, curves, "theta - 2**(-20)", ("0",), "0", "1")


def crossed(check, curves, *places):
    """Asks of straight or bent pieces, theta from 0 to 1, whether their closed curve is simple."""
    table = check.Table([], {}, None, P)
    table.parts = [[check.parse(text) for text in (*place, "0", "1")] for place in places]
    curves.embedded(table, range(len(places)), {}, P)


TRIANGLE = [("100*theta", "0"), ("100 - theta/2", "7*theta/8"), ("199/2*(1 - theta)", "7/8*(1 - theta)")]
SIMPLE = {
    "sides of very different speeds": [("theta", "0"), ("1 - 50*theta*(1 + theta)/100", "87*(theta + theta**2)/200"),
                                       ("(1 - theta)/2 - 0*theta", "87*(1 - theta)/100")],
    "speeds of a hundred to one at a blunt corner": TRIANGLE,
    "a bent side": [("theta", "0"), ("1 - theta", "(theta + theta**2)/18"), ("0", "(1 - theta)/9")],
}  # fmt: skip
CROSSED = {
    "a side that crosses the one after the next at a sharp angle": [
        ("theta", "0"), ("1", "-theta"), ("1 - theta/2", "-1 + 2*theta"), ("(1 - theta)/2", "1 - theta")
    ],
    "a first side that crosses the last but one": [
        ("theta", "theta/9"), ("1 - theta", "1/9 + theta"), ("2*theta", "10/9 - 2*theta"),
        ("2 - 2*theta", "-8/9 + 8*theta/9"),
    ],
    "a loop within one side, its velocities to one side": [
        ("theta + sin(2*pi*theta)*4/5", "theta*(1 - theta)"), ("1 - theta", "-theta*(1 - theta)")
    ],
    "a vertex that is met a second time": [("theta", "0"), ("1 - theta", "theta"), ("0", "1 - theta"),
                                           ("theta*(1 - theta)", "-theta*(1 - theta)")],
    "a side that turns back and is crossed early by the one after it": [
        ("15*theta - 14*theta**2", "-theta**4"), ("1 + 4*theta", "4*theta - 1"), ("5 - 5*theta", "3 - 3*theta")
    ],
    "a side that is crossed late by the one before it": [
        ("5*theta", "3*theta"), ("5 - 4*theta", "3 - 4*theta"),
        ("15*(1 - theta) - 14*(1 - theta)**2", "-(1 - theta)**4"),
    ],
    "a side that comes back across the one before it": [
        ("3*theta", "0"), ("3 - 4*theta", "2*theta**2 - theta"), ("theta - 1", "1 - theta")
    ],
    "a side across which the one after it began": [
        ("-theta", "theta"), ("4*theta - 1", "2*(1 - theta)**2 - 1 + theta"), ("3 - 3*theta", "0")
    ],
    "a second side that bends back across the first one": [
        ("4*theta", "0"), ("4 - 4*theta", "theta/2 - theta**2"), ("0", "-1/2 + theta/2")
    ],
    "a side that turns back, and the next one crosses where it began": [
        ("4*theta - 4*theta**2", "-theta**2"), ("16*theta", "16*theta - 1"), ("16 - 16*theta", "15 - 15*theta")
    ],
    "a side that crosses where the next one ends, which turns back": [
        ("16*theta", "15*theta"), ("16 - 16*theta", "15 - 16*theta"), ("4*theta - 4*theta**2", "-(1 - theta)**2")
    ],
    "no movement": [("0*theta", "0"), ("0*theta", "0")],
}  # fmt: skip


@pytest.mark.parametrize("name", SIMPLE)
def test_pieces_of_which_neighbours_alone_have_a_common_point_are_a_simple_curve(check, curves, name):
    crossed(check, curves, *SIMPLE[name])


@pytest.mark.parametrize("name", CROSSED)
def test_pieces_that_meet_elsewhere_are_none(check, curves, name):
    with pytest.raises(check.Unproved, match="the boundary may cross itself"):
        crossed(check, curves, *CROSSED[name])


def round_of(check, scene):
    return check.read_scene(scene | {"lam": "1/3"}, "", 128)[0]


OVAL = {"parametric": ["3 + 2*cos(theta)", "1 + sin(theta)"]}


@pytest.mark.parametrize(
    ("x", "y", "proved"),
    [
        ("3", "1", True), ("49/10", "1", True), ("11/10", "1", True), ("3", "19/10", True), ("3", "1/10", True),
        ("51/10", "1", False), ("9/10", "1", False), ("3", "21/10", False), ("3", "-1/10", False), ("0", "0", False),
        ("1", "-1", False), ("-3", "-1", False), ("4", "17/10", True), ("2", "1/3", True), ("4", "2/5", True),
        ("24/5", "8/5", False), ("2", "2", False),
    ],
)  # fmt: skip
def test_a_point_is_inside_where_the_boundary_runs_round_it_once(check, curves, x, y, proved):
    """By (x - 3)**2/4 + (y - 1)**2 < 1; of fractions as of intervals."""
    table = round_of(check, OVAL)
    assert proved == ((Fraction(x) - 3) ** 2 / 4 + (Fraction(y) - 1) ** 2 < 1)
    for point in ([Fraction(x), Fraction(y)], [number(check, x), number(check, y)]):
        if proved:
            curves.inside(table, *point, table.letters)
        else:
            with pytest.raises(check.Unproved, match="does not run once round a chord"):
                curves.inside(table, *point, table.letters)


def test_of_two_curves_round_a_point_one_has_to_be_a_hole(check, curves):
    """A hole elsewhere counts nothing, one round the point is taken off; counterclockwise it is counted once more."""
    outer = {"x": "5*cos(theta)", "y": "5*sin(theta)", "from": "-pi", "to": "pi"}
    hole = {"x": "3 + cos(theta)", "y": "-sin(theta)", "from": "-pi", "to": "pi"}
    for second, point, proved in (
        (hole, (0, 0), True),
        (hole, (3, 0), False),
        (hole | {"x": "-3 + cos(theta)"}, (0, -1), True),
        (hole | {"y": "sin(theta)"}, (3, 0), False),
    ):
        table = round_of(check, {"component": [outer, second]})
        if proved:
            curves.inside(table, *map(Fraction, point), table.letters)
        else:
            with pytest.raises(check.Unproved, match="does not run once round a chord"):
                curves.inside(table, *map(Fraction, point), table.letters)


@pytest.mark.parametrize(
    ("piece", "counted"),
    [
        (("0*theta - 3", "-1 - theta"), False),  # from the ray on
        (("0*theta - 3", "-theta"), False),  # as far as the ray
        (("0*theta - 3", "-3/2 - theta"), True),  # beside it
        (("0*theta + 3", "2*theta"), True),  # across what lies opposite
    ],
)  # fmt: skip
def test_a_piece_that_begins_or_ends_on_the_ray_is_not_counted(check, curves, monkeypatch, piece, counted):
    """Beside a circle round 0, from which the ray runs through (-3, -1)."""
    table = check.Table([], {}, None, 128)
    formulas = ("5*cos(theta)", "5*sin(theta)", "-pi", "pi"), (*piece, "0", "1")
    table.parts, table.curves = [[check.parse(text) for text in part] for part in formulas], []
    real = curves.covered
    monkeypatch.setattr(curves, "covered", lambda settled, _, why: real(settled, 100, why))
    if counted:
        curves.inside(table, Fraction(0), Fraction(0), {})
    else:
        with pytest.raises(check.Unproved, match="the boundary may run through a chord"):
            curves.inside(table, Fraction(0), Fraction(0), {})
