"""Small steps of the second reader, each by itself: terms of series, sides of a wall, cones, chords asked about."""

import json
from fractions import Fraction
from itertools import pairwise
from math import atan2, cos, pi, sin
from pathlib import Path
from types import SimpleNamespace

import mpmath
import pytest
from scipy.optimize import brentq

FOLDER = Path(__file__).parents[2] / "certificates"
TURN = Fraction(1, 3)


@pytest.mark.parametrize(
    ("name", "function"),
    [("sin", mpmath.sin), ("cos", mpmath.cos), ("atan", mpmath.atan), ("inverse", lambda x: 1 / x)],
)
@pytest.mark.parametrize("at", [Fraction(1, 3), Fraction(-2), Fraction(7, 5)])
def test_the_series_of_a_function_has_its_taylor_coefficients_to_the_third_order(check, name, function, at):
    """By mpmath, to 30 digits, in each of the three letters."""
    context = mpmath.MPContext()
    context.dps = 40
    wanted = mpmath.taylor(function, mpmath.mpf(at.numerator) / at.denominator, 3)
    for letter in range(3):
        found = check.function(name, check.Jet.of(check.I.of(at, 130), 3, letter), 130)
        for order in range(4):
            index = check.algebra(3)[1][tuple(order * (k == letter) for k in range(3))]
            assert check.I.of(found.c[index], 130).real() == pytest.approx(float(wanted[order]), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("low", "high"), [("-1/8", "1/4"), ("-1/4", "1/8"), ("0", "1/4"), ("0", "0")])
def test_the_square_of_what_may_be_0_may_be_0_and_is_not_below(check, low, high):
    wide = check.I.of(Fraction(low), 64).hull(check.I.of(Fraction(high), 64))
    found = check.beside("formulas").square(wide)
    assert 0 in found
    assert found.lo == 0
    assert found.hi >= max(abs(wide.lo), abs(wide.hi)) ** 2 >> 64


def test_a_chord_arrives_from_inside_or_the_landing_is_none(check):
    """In a peanut, along the line `y = 1/2`: out of the right lobe, into the left one, and out of it."""
    height = lambda theta: sin(theta) * (1 + 0.6 * cos(2 * theta)) - 0.5  # noqa: E731
    outer, waist = brentq(height, 0, 0.7), brentq(height, 0.7, pi / 2)
    table, lam, _ = check.read_scene({"polar": "1 + 3/5*cos(2*theta)", "lam": "1/3"}, "", 100)
    _, _, dx, dy = (check.value(z).real() for z in table.at(0, check.I.of(Fraction(outer), 100), table.letters, 100))
    start = [check.Jet.of(check.I.of(Fraction(z), 100), 0) for z in (outer, atan2(-dx, dy))]

    def landed(at: float) -> float:
        near = check.I.of(Fraction(at), 100).wide(check.I.of(Fraction(1, 1000), 100))
        return check.value(table.flight(0, (0, near), start, table.letters | {"lam": lam})[0]).real()

    for out in (waist, pi - outer):
        assert landed(out) == pytest.approx(out, abs=1e-9)
    with pytest.raises(check.Unproved, match="may not arrive from inside"):
        landed(pi - waist)


@pytest.mark.parametrize(
    ("entries", "fails"),
    [
        ((3, 0, 0, "1/2"), ""),
        (("1/2", 0, 0, "-1/2"), "cone"),  # nothing grows, and the cone would be kept
        ((3, 0, 1, "1/2"), "cone"),  # what grows leaves the cone
        ((3, 0, 0, 2), "closer"),
        (("11/10", 50, 0, "1/2"), "cone"),  # what grows may shrink within the cone
    ],
)
def test_a_branch_is_one_curve_where_a_cone_is_kept_in_which_all_grows_and_curves_come_closer(
    check, monkeypatch, entries, fails
):
    """Of a map that is linear in the coordinates of the branch, along the axes."""
    crisis, p = check.beside("crisis"), 100
    a, b, c, d = (check.I.of(Fraction(x), p) for x in entries)
    one = lambda x: check.I.of(x, p)  # noqa: E731
    # directions (1, 0) and (1, 1): a state is (x + y, y)
    matrix = (a + c, b + d - a - c), (c, d - c)
    monkeypatch.setattr(crisis, "derivative", lambda *_: (*matrix, None))
    made = crisis.Branch.__new__(crisis.Branch)
    made.table, made.turn, made.lam = SimpleNamespace(p=p), TURN, one(1)
    made.along, made.across, made.theta, made.psi = one(0), one(1), one(0), one(0)
    made.reach, made.slope = Fraction(1, 16), Fraction(1, 64)
    if fails:
        with pytest.raises(check.Unproved, match=fails):
            made.proved()
    else:
        assert made.proved() >= 3
        assert made.proved() < Fraction(301, 100)


def test_each_chord_of_both_ways_to_a_contact_is_asked_whether_it_is_free(check, monkeypatch):
    """Where each begins and ends is known from the file: the bounces of its saddles, and of its orbit."""
    given, asked = json.loads((FOLDER / "boundary-crisis.json").read_text()), []
    real = check.Table.free
    number = lambda pair: float(check.exact(pair))  # noqa: E731

    def free(self, start, end, names, p=64):
        asked.append(tuple(check.value(x[0][1]).real() for x in (start, end)))

    monkeypatch.setattr(check.Table, "free", free)
    assert real is not free
    check.checked(given)
    orbit, meets = [number(pair) for pair in given["orbit"]], given["meets"]
    ways = [orbit[: meets + 1], orbit[: meets - 1 : -1]]
    ways += [[number(pair) for pair in given[key]["bounces"]] for key in ("unstable", "stable")]
    wanted = [pair for way in ways for pair in pairwise(way)]
    for start, end in wanted:
        assert any(abs(start - a) < 1e-3 and abs(end - b) < 1e-3 for a, b in asked), (start, end)
    assert all(a != b for a, b in asked)


def test_the_tip_of_a_piece_is_its_point_at_that_end(check):
    """By a radius and by a pair of formulas."""
    boundaries, p = check.beside("boundaries"), 100
    for formulas, wanted in (
        (["1 + theta"], (3 * cos(2), 3 * sin(2))),
        (["theta**2", "1 - theta"], (4, -1)),
    ):
        part = [check.parse(text) for text in (*formulas, "1/2", "2")]
        found = boundaries.tip(part, part[-1], {}, p)
        assert [check.I.of(x, p).real() for x in found] == pytest.approx(wanted, abs=1e-12)


def test_a_modulus_of_a_constant_that_may_be_0_has_no_slope_by_the_place(check):
    near = check.I.of(0, 64).wide(check.I.of(Fraction(1, 8), 64))
    value, slope = check.beside("formulas").called("abs", near, 0, 64)
    assert (value.lo, value.hi, slope) == (0, near.hi, 0)


@pytest.mark.parametrize("empty", [{}, None])
def test_of_a_product_with_what_is_not_known_nothing_is_known(check, empty):
    times = check.beside("boundaries").times
    assert not times({"": 2}, empty)
    assert not times(empty, {"": 2})
    assert times({"x": 3, "": 1}, {"": 2}) == {"x": 6, "": 2}


@pytest.mark.parametrize("at", ["-3", "-23/10", "-8/5", "-1/2", "1/3", "2", "14/5"])
def test_a_radius_that_vanishes_anywhere_on_its_round_is_refused(check, at):
    """On a short piece about one place, wherever that is."""
    boundaries = check.beside("boundaries")
    for depth, positive in (("6/5", False), ("21/20", False), ("9/10", True)):
        table = SimpleNamespace(letters={}, parts=[[check.parse(f"1 - {depth}*cos(theta - ({at}))")]])
        if positive:
            boundaries.positive(table)
        else:
            with pytest.raises(check.Wrong, match="radius may not be positive"):
                boundaries.positive(table)


@pytest.mark.parametrize(("low", "high"), [("1/10", "9/10"), ("9/10", "6/5"), ("-1", "-9/10"), ("-1/10", "1")])
def test_cells_that_a_rectangle_meets_are_cells_of_the_strip(check, low, high):
    """Of eight columns and four rows, the angle from -1 to 1; no particle leaves the strip."""
    p = 64
    made = SimpleNamespace(columns=8, rows=4, p=p, top=check.I.of(1, p))
    theta, phi = (
        check.I.of(Fraction(a), p).hull(check.I.of(Fraction(b), p)) for a, b in (("1/5", "3/10"), (low, high))
    )
    found = check.beside("region").Inside.met(made, theta, phi)
    wanted = [r for r in range(4) if Fraction(r, 2) - 1 <= Fraction(high) and Fraction(r + 1, 2) - 1 >= Fraction(low)]
    assert found == [(4, r) for r in wanted]
