"""Orbits in balls as they are told: where a start is moved to, which digits are known, how an orbit ends."""

import math
import random
from dataclasses import replace
from decimal import Decimal
from types import SimpleNamespace

import pytest
from flint import acb, arb
from sympy import Rational

from numeric import PinballMap
from verification.arithmetic.balls import working
from verification.maps import enclosed
from verification.maps.enclosed import EnclosedMap, Refusal, _text, _turns, in_balls, number


@pytest.mark.parametrize(("theta", "turns"), [(0, 0), (2 * math.pi, 0), (-0.1, -1), (6.4, 1), (9.5, 1), (12.5, 1)])
def test_turns_are_counted_from_the_middle_of_the_range(theta, turns):
    from_0 = SimpleNamespace(states=SimpleNamespace(ends=[(0.0, 2 * math.pi)]))
    assert _turns(from_0, (theta, 0, 0)) == turns


@pytest.mark.parametrize("digits", [2, 5, 12])
def test_the_last_digit_of_a_text_is_off_by_one_at_most_and_few_known_ones_are_left_out(digits):
    """Of numbers of all sizes and balls of all widths: the text is within one of its last digits of all the ball."""
    chance, short = random.Random(digits), 0
    for _ in range(300):
        middle = chance.choice((-1, 1)) * 10 ** chance.uniform(-2, 4)
        size = max(1.0, abs(middle))
        radius = size * 10 ** chance.uniform(-digits - 3, -digits)
        with working(200):
            text = _text(arb(middle, radius), digits)
        known = math.log10(abs(middle) / radius)
        if not text or text == "0":
            assert known < 2.1 or (text and abs(middle) < 10**-digits)
            continue
        number, shown = Decimal(text), len(Decimal(text).as_tuple().digits)
        unit = float(Decimal(10) ** number.as_tuple().exponent)
        assert abs(float(number) - middle) + radius <= unit * 1.0000001
        assert shown <= digits
        assert shown >= min(digits, known - 2.1)
        short += shown < digits
    assert short > 20


def test_digits_end_below_a_number_that_is_smaller_than_all_of_them():
    with working(200):
        assert _text(arb(0.0009), 3) == _text(arb(-0.0009), 3) == "0"
        assert _text(arb(0.0011), 3) == "0.00110"
        assert _text(arb(0.01, 0.0001), 3) == "0.01"  # of one digit that is known


@pytest.mark.parametrize("bits", [50, 64, 100, 333])
def test_an_expression_is_enclosed_to_the_digits_that_hold_so_many_bits(monkeypatch, bits):
    asked = []
    monkeypatch.setattr(enclosed, "enclose", lambda x, digits: asked.append(digits) or acb(1))
    assert number(Rational(1, 3), bits) == 1
    assert bits < asked[0] * math.log2(10) < bits + 8


@pytest.mark.parametrize("first", [True, False])
def test_what_follows_an_outcome_at_any_bounce_is_the_place_before_it(monkeypatch, first):
    """At the first bounce, or at the third."""
    given = iter([] if first else [0.25, 0.5])

    def bounce(self, here):
        theta = next(given, None)
        return Refusal.UNPROVED if theta is None else replace(here, theta=arb(theta), eta=arb(0.125))

    monkeypatch.setattr(EnclosedMap, "bounce", bounce)
    found = in_balls(PinballMap("circle"), 1, (Rational(1, 8), 0, 0), 3, 10, lambda done: None)
    assert [float(entry["theta"]) for entry in found] == ([0.125] * 2 if first else [0.125, 0.25, 0.5, 0.5])
    assert found[-1] == found[-2] | {"eta": None, "status": "unproved"}


@pytest.mark.parametrize(("start", "turns"), [(10, 2), (-4, -1), (3, 0)])
def test_an_orbit_begins_where_whole_turns_lead_a_start(start, turns):
    (found,) = in_balls(PinballMap("circle"), 1, (Rational(start), 0, 0), 0, 12, lambda done: None)
    assert float(found["theta"]) == pytest.approx(start - 2 * math.pi * turns, abs=1e-11)


def test_an_orbit_that_is_too_wide_for_its_digits_is_tried_with_twice_the_bits(monkeypatch):
    tries = []

    def bounce(self, here):
        tries.append(self.bits)
        return replace(here, theta=arb(0.5, 0.5 if len(tries) < 3 else 1e-20), eta=arb(0.125))

    monkeypatch.setattr(EnclosedMap, "bounce", bounce)
    found = in_balls(PinballMap("circle"), 1, (Rational(1, 8), 0, 0), 1, 10, lambda done: None)
    assert float(found[1]["theta"]) == 0.5
    assert tries == [tries[0], 2 * tries[0], 4 * tries[0]]
