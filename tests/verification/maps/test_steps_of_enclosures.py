"""The map in balls, step by step: starts, landings that are refused, which guess is taken, lengths and digits."""

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import acb, arb
from sympy import Rational

from numeric import PinballMap
from symbolic.tables.law import Law
from verification.arithmetic.balls import working
from verification.maps import enclosed
from verification.maps.enclosed import EnclosedMap, Refusal, _text, _turns, in_balls, number
from verification.maps.exact import Bounce

BITS = 120


def place(component, theta, v=(None, None), code=0):
    return Bounce(component, theta, None, v, None, None, code=code)


@pytest.fixture(scope="module")
def ellipse():
    return EnclosedMap(PinballMap("ellipse", a=2, lam="1/2"), Fraction(1, 2), BITS)


@pytest.fixture(scope="module")
def cuspless():
    return EnclosedMap(PinballMap("cuspless", lam="1/2"), Fraction(1, 2), BITS)


@pytest.mark.parametrize(("theta", "phi"), [(0.0, 0.0), (1.0, 0.3), (2.5, -1.2), (-2.0, 0.9)])
def test_a_start_flies_off_at_its_angle_from_the_inward_normal_towards_the_tangent(ellipse, theta, phi):
    """On an ellipse with half axes 2 and 1, whose tangent and normal are written by hand."""
    found = ellipse.start(theta, phi)
    dx, dy = -2 * math.sin(theta), math.cos(theta)
    size = math.hypot(dx, dy)
    tangent, normal = (dx / size, dy / size), (-dy / size, dx / size)
    wanted = [math.sin(phi) * t + math.cos(phi) * n for t, n in zip(tangent, normal, strict=True)]
    assert [float(v) for v in found.v] == pytest.approx(wanted, abs=1e-15)
    assert (float(found.x), float(found.y)) == pytest.approx((2 * math.cos(theta), math.sin(theta)), abs=1e-15)
    assert (found.component, found.theta, found.phi) == (0, theta, phi)
    assert max(x.rad() for x in (*found.v, found.x, found.y)) < 1e-34


def test_a_start_of_a_set_holds_all_its_flights(ellipse):
    wide = ellipse.start(arb(1, 0.01), arb(0.3, 0.02))
    for theta, phi in ((0.99, 0.28), (1.01, 0.32), (0.99, 0.32), (1, 0.3)):
        one = ellipse.start(theta, phi)
        for held, value in zip((*wide.v, wide.x, wide.y), (*one.v, one.x, one.y), strict=True):
            assert held.overlaps(value)
    assert all(x.rad() < 0.06 for x in (*wide.v, wide.x, wide.y))


@pytest.mark.parametrize("phi", [0.0, 0.4, -1.1, 1.4])
@pytest.mark.parametrize("theta", [0.3, 2.0, -2.9])
def test_a_landing_obeys_the_map_of_doubles_and_contracts_its_angle(ellipse, theta, phi):
    """Near any guess that is not too far; the exit angle is half the incidence angle, to the other side."""
    here, map = ellipse.start(theta, phi), ellipse.map
    step = map.step(theta, phi)
    with working(BITS):
        for off in (0.0, 1e-3, -1e-3):
            found = ellipse._landed(here, place(0, arb(float(step.theta) + off)))
            assert abs(float(found.theta) - step.theta) < 1e-13
            assert abs(float(found.phi) - step.phi) < 1e-13
            assert abs(float(found.eta) + 2 * step.phi) < 1e-13
            assert (float(found.x), float(found.y)) == pytest.approx((float(step.x), float(step.y)), abs=1e-13)
            assert found.theta.rad() < 1e-33
            assert (found.phi + found.eta / 2).contains(0)
            again = ellipse.start(found.theta, found.phi)
            assert all(a.overlaps(b) for a, b in zip(again.v, found.v, strict=True))


def test_no_landing_is_told_behind_a_start_at_it_or_beyond_the_end_of_a_part(cuspless, ellipse):
    here = ellipse.start(0.3, 0.2)
    with working(BITS):
        assert ellipse._landed(here, place(0, arb(0.3))) is None  # where it starts
    start = cuspless.start(0.5, 0.1)
    step = cuspless.map.step(0.5, 0.1)
    other = 1 - int(step.component)
    with working(BITS):
        assert cuspless._landed(start, place(int(step.component), arb(float(step.theta)))) is not None
        assert cuspless._landed(start, place(other, arb(0.1))) is None  # its line meets the other part beyond its ends


def test_a_landing_on_a_part_is_between_its_ends(cuspless):
    """Rays from a point inside to places of the wall's line: up to its ends, and beyond."""
    low, high = (float(end) for end in cuspless.ends[1])
    middle, half = (low + high) / 2, (high - low) / 2
    for share, lands in ((0.0, True), (0.98, True), (-0.98, True), (1.02, False), (-1.02, False)):
        at = arb(middle + share * half)
        with working(BITS):
            x, y = cuspless.curve(1, at)[:2]
            here = cuspless.start(0.0, 0.0)
            size = ((x - here.x) ** 2 + (y - here.y) ** 2).sqrt()
            v = (x - here.x) / size, (y - here.y) / size
            made = Bounce(0, here.theta, here.phi, v, here.x, here.y)
            assert (cuspless._landed(made, place(1, at)) is not None) is lands
            back = Bounce(0, here.theta, here.phi, (-v[0], -v[1]), here.x, here.y)
            assert cuspless._landed(back, place(1, at)) is None


def test_a_start_that_is_not_known_well_enough_has_no_landing(ellipse):
    step = ellipse.map.step(0.3, 0.2)
    guess = place(0, arb(float(step.theta)))
    with working(BITS):
        assert ellipse._landed(ellipse.start(arb(0.3, 1e-6), arb(0.2, 1e-6)), guess) is not None
        assert ellipse._landed(ellipse.start(arb(0.3, 3), arb(0.2, 1)), guess) is None
    assert ellipse.bounce(ellipse.start(arb(0.3, 3), arb(0.2, 1))) is Refusal.WIDE


GUESSES = {  # codes, or whether a landing is enclosed and proved free; and what comes back
    (): Refusal.WIDE,
    ("lost",): Refusal.WIDE,
    ("free",): 0,
    ("lost", "free"): 1,
    ("hidden",): Refusal.UNPROVED,
    ("hidden", "lost"): Refusal.UNPROVED,
    ("lost", "hidden"): Refusal.UNPROVED,
    ("hidden", "free"): 1,
    ("free", "hidden"): 0,
    ("named", "free"): 0,
    ("lost", "named"): 1,
}


@pytest.mark.parametrize("kinds", GUESSES, ids=str)
def test_a_bounce_is_the_first_guess_that_is_proved_or_a_named_outcome(monkeypatch, ellipse, kinds):
    asked = []
    guesses = [place(0, arb(k), code=3 if kind == "named" else 0) for k, kind in enumerate(kinds)]
    landings = [None if kind == "lost" else place(0, arb(10 + k)) for k, kind in enumerate(kinds)]
    at = lambda theta: int(float(theta))  # noqa: E731
    monkeypatch.setattr(ellipse, "_guesses", lambda here: iter(guesses))
    monkeypatch.setattr(ellipse, "_landed", lambda here, guess: landings[at(guess.theta)])

    def free(boundary, start, end):
        asked.append((start, end))
        return kinds[at(end[1]) - 10] == "free"

    monkeypatch.setattr(enclosed, "free", free)
    here = place(0, arb(7))
    found, wanted = ellipse.bounce(here), GUESSES[kinds]
    if isinstance(wanted, Refusal):
        assert found is wanted
    else:
        assert found is (guesses if kinds[wanted] == "named" else landings)[wanted]
    assert all(start == (0, arb(7)) for start, _ in asked)


@pytest.mark.parametrize(("end", "given"), [(Refusal.WIDE, 2), (Refusal.UNPROVED, 2), ("named", 2), (None, 4)])
def test_an_orbit_ends_before_the_first_bounce_that_is_not_proved(monkeypatch, ellipse, end, given):
    bounces = [place(0, arb(k)) for k in range(6)]
    if end is not None:
        bounces[3] = place(0, arb(3), code=2) if end == "named" else end
    monkeypatch.setattr(ellipse, "bounce", lambda here: bounces[int(float(here.theta)) + 1])
    assert [float(b.theta) for b in ellipse.orbit(bounces[0], 4)] == [1, 2, 3, 4][:given]


@pytest.mark.parametrize(
    ("law", "wanted"),
    [
        ("-lam*eta", lambda eta, theta: -0.5 * eta),
        ("-lam*eta*(1 - eta**2/8)", lambda eta, theta: -0.5 * eta * (1 - eta**2 / 8)),
        ("-lam*eta + cos(theta)/20", lambda eta, theta: -0.5 * eta + math.cos(theta) / 20),
        ("-lam*eta + sin(s)/30", lambda eta, theta: -0.5 * eta + math.sin(theta) / 30),
    ],
)
def test_the_exit_angle_is_that_of_the_law_at_the_angle_and_the_place(law, wanted):
    """On the unit circle, where the arc length is the parameter."""
    made = EnclosedMap(PinballMap("circle", lam="1/2", law=Law(law)), Fraction(1, 2), BITS)
    for eta, theta in ((0.7, 1.0), (-1.1, 2.5)):
        with working(BITS):
            found = made._exit(arb(eta), 0, arb(theta))
        assert float(found) == pytest.approx(wanted(eta, theta), rel=1e-14)
        assert found.rad() < 1e-30


def test_the_length_up_to_a_set_of_places_holds_that_of_each_and_is_as_wide_as_the_curve_is_fast(ellipse):
    """By the trapezoidal rule on an ellipse, which has no closed form; along a circle by its parameter."""
    speed = lambda t: np.hypot(2 * np.sin(t), np.cos(t))  # noqa: E731
    wide = ellipse.length(0, arb(1, 0.01), 25)
    for end in (0.99, 1.0, 1.01):
        at = np.linspace(0, end, 20001)
        true = np.trapezoid(speed(at), at)
        assert wide.overlaps(arb(true, 1e-8))
        assert float(ellipse.length(0, arb(end), 25)) == pytest.approx(true, rel=1e-8)
    assert float(wide.rad()) == pytest.approx(0.01 * speed(1.0), rel=0.05)
    with working(BITS):
        assert ellipse.length(0, arb(1), 25).rad() < 1e-25
        assert ellipse.length(0, arb(1)).rad() < 1e-30  # of all its bits
        backward = ellipse.length(0, arb(-1), 25)
        assert (backward + ellipse.length(0, arb(1), 25)).contains(0)


def test_a_length_is_integrated_to_the_digits_that_are_asked_for_or_that_its_bits_hold(monkeypatch, ellipse, cuspless):
    """And only along a boundary of one part that has no closed form."""
    asked = []
    monkeypatch.setattr(enclosed, "_integrated", lambda *given: asked.append(given) or arb(0.5))
    circle = EnclosedMap(PinballMap("circle"), 1, BITS)
    assert circle.length(0, arb(2)).overlaps(arb(2))
    assert not asked
    assert ellipse.length(0, arb(1), 25) == ellipse.length(0, arb(1)) == 0.5
    assert [given[1:4] for given in asked] == [(0, 0, 1)] * 2
    (few, all_) = (given[4] for given in asked)
    assert few == 25
    assert BITS - 4 < all_ * math.log2(10) <= BITS
    monkeypatch.setattr(enclosed, "closed_length", lambda *_: None)
    assert cuspless.length(1, arb(0.1)) is None
    assert len(asked) == 2


@pytest.mark.parametrize("table", ["circle", "cuspless"])
@pytest.mark.parametrize(("theta", "turns"), [(0.5, 0), (3.1, 0), (-3.1, 0), (3.2, 1), (-3.2, -1), (9.5, 2), (-16, -3)])
def test_a_start_on_a_closed_curve_is_moved_by_whole_turns_and_elsewhere_by_none(table, theta, turns):
    assert _turns(PinballMap(table), (theta, 0, 0)) == (turns if table == "circle" else 0)


def test_a_start_at_the_end_of_the_range_is_moved_by_none():
    map = PinballMap("circle")
    low, high = map.states.ends[0]
    assert _turns(map, (low, 0, 0)) == _turns(map, (high, 0, 0)) == 0


@pytest.mark.parametrize("digits", [3, 6])
def test_a_text_has_the_digits_that_are_known_and_no_text_is_given_of_what_is_wider(digits):
    unit = 10.0**-digits
    with working(200):
        assert _text(arb(0.5, unit * 0.9), digits) == "0.5"[: 2 + digits] or float(_text(arb(0.5), digits)) == 0.5
        assert _text(arb(0.5, unit * 1.01), digits) == ""
        assert _text(arb(2, unit * 1.9), digits) != ""
        assert _text(arb(2, unit * 2.1), digits) == ""
        assert _text(arb(-2, unit * 2.1), digits) == ""
        assert _text(arb(0, unit * 0.5), digits) == "0"
        assert _text(arb(0, unit * 1.1), digits) == ""
        assert float(_text(arb(1) / 3, digits)) == pytest.approx(1 / 3, abs=unit)
        assert len(_text(arb(1) / 3, digits)) == digits + 2
        assert float(_text(arb(1) / 3 * 1000, digits)) == pytest.approx(1000 / 3, abs=1000 * unit)


def test_numbers_become_balls_and_an_expression_has_the_bits_that_are_asked_for():
    assert number(Rational(1, 3), 50).rad() > number(Rational(1, 3), 200).rad() > 0
    assert number(Rational(1, 3), 200).rad() < 1e-59
    assert number(True) == 1
    assert number(0.5) == 0.5
    assert number(Fraction(3, 4)) == 0.75


@pytest.mark.parametrize("end", ["", "wide", "unproved", "named"])
def test_what_is_told_of_an_orbit_ends_with_the_name_of_its_outcome(monkeypatch, end):
    """The second bounce is not given; a start that is not known well enough is tried with twice the bits."""
    tries = []

    def bounce(self, here):
        tries.append(self.bits)
        done = len(tries) > 1 and here.eta is not None
        if done and end == "wide" and self.bits == tries[0]:
            return Refusal.WIDE
        if done and end == "unproved":
            return Refusal.UNPROVED
        if done and end == "named":
            return SimpleNamespace(code=3)
        return Bounce(0, here.theta + arb(0.25), here.phi, here.v, here.x, here.y, arb(0.125))

    monkeypatch.setattr(EnclosedMap, "bounce", bounce)
    told = []
    found = in_balls(PinballMap("circle"), Rational(1, 2), (Rational(1, 2), Rational(1, 4), 0), 3, 10, told.append)
    ended = end in ("unproved", "named")
    assert [entry["status"] for entry in found[:2]] == ["regular"] * 2
    assert len(found) == (3 if ended else 4)
    assert found[0]["eta"] is None
    assert [float(entry["theta"]) for entry in found[:2]] == [0.5, 0.75]
    assert [float(found[1][word]) for word in ("s", "eta", "phi")] == [0.75, 0.125, 0.25]
    assert found[0]["component"] == "circle"
    if ended:
        assert found[2] == found[1] | {"eta": None, "status": found[2]["status"]}
        assert found[2]["status"] == ("unproved" if end == "unproved" else enclosed.STATUSES[3].name.lower())
    else:
        assert float(found[3]["theta"]) == 1.25
    assert set(tries) == ({tries[0], 2 * tries[0]} if end == "wide" else {tries[0]})
    assert told == (["1", "1", "2", "3"] if end == "wide" else ["1"] if ended else ["1", "2", "3"])


@pytest.fixture
def flat(monkeypatch, ellipse):
    """The landing on a wall `y = 0` for `0 < x < 1` near a place, within a reach; the other part is elsewhere."""

    def landed(x, y, v, near, reach):
        monkeypatch.setattr(ellipse, "curve", lambda part, at: [at, arb(0), arb(1), arb(0), arb(0), arb(0)])
        monkeypatch.setattr(ellipse, "ends", [(arb(0), arb(1)), (arb(5), arb(6))])
        monkeypatch.setattr(ellipse, "_polished", lambda flight, near: near)
        monkeypatch.setattr(ellipse, "_reach", lambda step, middle: arb(reach))
        with working(BITS):
            return ellipse._landed(Bounce(0, arb(0), arb(0), tuple(map(arb, v)), arb(x), arb(y)), place(0, arb(near)))

    return landed


@pytest.mark.parametrize(
    ("x", "y", "v", "near", "reach", "lands"),
    [
        (0.5, -1, (0, 1), 0.25, 0.5, True),
        (0.5, -1, (0, 1), 0.25, 0.2499, False),  # beyond where it is looked for
        (0.5, -1, (0, 1), 0.75, 0.2499, False),
        (0.5, 1, (0, 1), 0.25, 0.5, False),  # behind
        (0.5, 0, (0, 1), 0.25, 0.5, False),  # where it starts
        (1, -1, (0, 1), 0.75, 0.5, False),  # at the end of the part
        (0, -1, (0, 1), 0.25, 0.5, False),
        (1.5, -1, (0, 1), 1.25, 0.5, False),
        (0.25, -1, (0.25, 1), 0.25, 0.5, True),
        (0.25, 1, (-0.25, -1), 0.25, 0.5, False),
        (0.25, -1, (1, 0), 0.25, 0.5, False),  # along the wall: its slope is 0
    ],
)
def test_a_landing_on_a_straight_wall_lies_ahead_inside_of_it_and_of_where_it_is_looked_for(
    flat, x, y, v, near, reach, lands
):
    found = flat(x, y, v, near, reach)
    assert (found is not None) is lands
    if lands:
        assert (found.theta, found.x, found.y) == (0.5, 0.5, 0)


def test_a_length_is_integrated_only_where_no_cut_passes_through():
    """Of root, logarithm and arc tangent: a ball across the cut has no value, one beside it that of the function."""
    words, across = enclosed._Complex(), acb(arb(-2), arb(0, 1))
    assert not words.sqrt(across).is_finite()
    assert not words.log(across).is_finite()
    assert not words.root(across, 3).is_finite()
    for high in (1.5, 0.99, -1.5):
        assert words.atan(acb(arb(0, 0.1), arb(high))).is_finite() is (abs(high) < 1)
    beside = acb(2, arb(0.5))
    assert words.sqrt(beside).overlaps(beside.sqrt())
    assert words.log(beside).overlaps(beside.log())
    assert (words.root(beside, 3) ** 3).overlaps(beside)
    assert words.atan(beside).overlaps(beside.atan())
    assert not words.atan(acb(0.5, 1)).is_finite()
    assert words.q(1, 4) == 0.25
    assert words.pi.overlaps(acb.pi())


@pytest.mark.parametrize("table", ["cuspless", "stadium"])
def test_a_boundary_of_parts_has_no_length_but_by_its_closed_form(table):
    made = EnclosedMap(PinballMap(table), 1, BITS)
    assert len(made.parts) > 1
    with working(BITS):
        found = made.length(1, arb(0.1), 20)
    closed = enclosed.closed_length(made.map, made.ops, made.shape, 1, arb(0.1))
    assert (found is None) is (closed is None)


@pytest.mark.parametrize("off", [1e-6, -1e-6])
def test_a_landing_is_enclosed_about_a_guess_that_nobody_sharpened(monkeypatch, ellipse, off):
    """The interval Newton step alone leads from the guess to the landing."""
    here = ellipse.start(0.3, 0.2)
    with working(BITS):
        true = ellipse._landed(here, place(0, arb(float(ellipse.map.step(0.3, 0.2).theta))))
        monkeypatch.setattr(ellipse, "_polished", lambda flight, near: (near + off).mid())
        found = ellipse._landed(here, place(0, true.theta.mid()))
    assert found.theta.contains(true.theta)
    assert found.theta.rad() < 1e-10


@pytest.mark.parametrize(("reach", "lands"), [(1e-5, True), (1e-7, False), (math.inf, False), (math.nan, False)])
def test_no_landing_is_told_where_the_interval_newton_step_does_not_close(monkeypatch, ellipse, reach, lands):
    """About a guess that is off by a millionth, looked for within more than that, or less."""
    here = ellipse.start(0.3, 0.2)
    monkeypatch.setattr(ellipse, "_polished", lambda flight, near: (near + 1e-6).mid())
    monkeypatch.setattr(ellipse, "_reach", lambda step, middle: arb(reach))
    with working(BITS):
        found = ellipse._landed(here, place(0, arb(float(ellipse.map.step(0.3, 0.2).theta))))
    assert (found is not None) is lands
