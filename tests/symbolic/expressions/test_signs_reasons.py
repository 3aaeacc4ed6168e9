"""What a verdict on a sign says, how often a box is halved for it, and where a witness is looked for."""

import pytest
from sympy import Interval, Rational, S, Symbol, oo, sqrt

from symbolic.expressions.signs import Outcome, bernstein, nonnegative, positive

x, y, z = Symbol("x", real=True), Symbol("y", real=True), Symbol("z", real=True)
UNIT, ABOVE = Interval(0, 1), Interval.Lopen(0, 1)
LINE, RAY, BACK = Interval(-oo, oo), Interval(0, oo), Interval(-oo, 0)
TINY = Rational(1, 10**6)


@pytest.mark.parametrize(
    ("p", "interval", "said"),
    [
        (x**2 + 1, UNIT, "x**2 + 1 has no root for x in [0, 1]"),
        (x**2 + 1, LINE, "x**2 + 1 has no root for x in (-oo, oo)"),
        (x**3 + 1, Interval.open(-1, oo), "x**3 + 1 has no root for x in (-1, oo)"),
        (1 - x**3, Interval.open(-oo, 1), "1 - x**3 has no root for x in (-oo, 1)"),
        (x * (1 - x), Interval.open(0, 1), "-x**2 + x has no root for x in (0, 1)"),
    ],
)
def test_sturm_proves_where_there_is_no_root_in_the_range(p, interval, said):
    finding = positive(p, {x: interval})

    assert finding.outcome is Outcome.PROVED
    assert finding.reason == f"Sturm: {said}"


@pytest.mark.parametrize(
    ("p", "interval", "roots"),
    [
        ((16 * x - 1) * (16 * x - 3) ** 2 * (16 * x - 1), UNIT, 2),
        ((3 * x - 1) ** 2, UNIT, 1),
        ((3 * x - 1) ** 2 * (3 * x + 1) ** 2 * (x**2 + 1), LINE, 2),
        ((3 * x - 1) ** 2 * (3 * x + 1) ** 2 * (x - 9) ** 2, Interval.open(0, 9), 1),
        ((3 * x - 1) ** 2 * (3 * x + 1) ** 2 * x**2, Interval.open(0, 9), 1),
    ],
)
def test_sturm_refutes_by_the_number_of_roots_between_the_samples(p, interval, roots):
    finding = positive(p, {x: interval})

    assert finding.outcome is Outcome.REFUTED
    assert f"has {roots} root(s) for x in " in finding.reason


@pytest.mark.parametrize(
    ("interval", "samples"),
    [
        (UNIT, [0, Rational(1, 8), Rational(1, 2), Rational(7, 8), 1]),
        (Interval(-2, 6), [-2, -1, 2, 5, 6]),
        (RAY, [0, Rational(1, 8), 1, 8]),
        (Interval(3, oo), [3, Rational(25, 8), 4, 11]),
        (BACK, [0, -Rational(1, 8), -1, -8]),
        (Interval(-oo, 5), [5, Rational(39, 8), 4, -3]),
        (LINE, [-Rational(1, 8), -1, -8]),
    ],
)
def test_a_witness_is_looked_for_at_the_ends_and_at_three_points_inside(interval, samples):
    for sample in samples:
        dip = (x - sample) ** 2 - TINY  # negative within a thousandth of the sample

        assert positive(dip, {x: interval}).reason.startswith(f"at x = {sample} the value is -")


def test_a_witness_names_every_letter_or_none():
    assert positive(y - x, {x: UNIT, y: UNIT}).reason == "at x = 0, y = 0 the value is 0"
    assert positive(S(-3), {}).reason == "the value is -3"
    assert positive(S(3), {}).reason == "3 > 0"
    assert positive(S.Zero, {}).outcome is Outcome.REFUTED


@pytest.mark.parametrize(
    ("p", "box", "needed"),
    [
        (1 + x + y, {x: UNIT, y: UNIT}, 0),
        ((2 * x - 1) ** 2 + y, {x: UNIT, y: ABOVE}, 1),
        ((4 * x - 1) ** 2 + y, {x: UNIT, y: ABOVE}, 3),  # x, then y, which is longer, then x
        ((x - 1) ** 2 + y, {x: RAY, y: ABOVE}, 1),
        ((x - 4) ** 2 + y, {x: Interval(3, oo), y: ABOVE}, 1),
        ((x + 1) ** 2 + y, {x: BACK, y: ABOVE}, 1),
        (x**2 + y, {x: LINE, y: ABOVE}, 1),
        ((2 * x - 1) ** 2 + y, {x: UNIT, y: Interval.open(0, oo)}, 2),  # the half-line first
        ((x - 1) ** 2 + y**2 + z, {x: RAY, y: LINE, z: ABOVE}, 2),  # the line before the half-line
    ],
)
def test_a_box_is_halved_as_often_as_a_hand_calculation_says(p, box, needed):
    """Longest side first, the first letter of equals; infinite ones before, at 1 from their end, lines at 0."""
    assert positive(p, box, depth=needed).outcome is Outcome.PROVED
    assert positive(p, box, depth=needed).reason.startswith("Bernstein, by halving" if needed else "Bernstein: ")
    if needed:
        below = positive(p, box, depth=needed - 1)
        assert below.outcome is Outcome.UNKNOWN
        assert below.reason == f"no certificate for {p} > 0 within {needed - 1} halvings"


def test_halving_ends_where_nothing_can_be_proved():
    """Zero on a line on which no sample lies."""
    p = (3 * x - 3 * y - 1) ** 2

    assert positive(p, {x: UNIT, y: UNIT}, depth=3).outcome is Outcome.UNKNOWN
    assert nonnegative(p, {x: UNIT, y: UNIT}, depth=3).outcome is Outcome.PROVED


def test_a_proof_on_a_closed_box_names_its_faces():
    reason = positive(1 + x + y, {x: UNIT, y: Interval.Ropen(0, 1)}).reason

    assert reason.startswith("Bernstein: x + y + 1 > 0 for x in [0, 1], y in [0, 1)")
    assert "Sturm: y + 1 has no root for y in [0, 1)" in reason
    assert "Sturm: y + 2 has no root for y in [0, 1)" in reason
    assert "Sturm: x + 1 has no root for x in [0, 1]" in reason
    assert "x + 2" not in reason  # y = 1 is no face of the box


def test_irrational_coefficients_and_denominators_are_judged():
    assert positive(1 / (1 - sqrt(2)), {}).outcome is Outcome.REFUTED
    assert positive(x / (1 - sqrt(2)) + 3, {x: UNIT}).outcome is Outcome.PROVED
    assert positive(x / (1 - sqrt(2)) + 2, {x: UNIT}).outcome is Outcome.REFUTED
    assert positive(sqrt(2) - x, {x: UNIT}).outcome is Outcome.PROVED


def test_an_open_denominator_is_named():
    reason = positive(1 / (x - Rational(1, 3)), {x: UNIT}).reason

    assert reason == "the sign of the denominator 3*x - 1 is open"


def test_a_nonnegative_expression_needs_no_box():
    assert nonnegative(x**2, {}).reason == "x**2 >= 0"
    assert nonnegative(S.Zero, {x: UNIT}).outcome is Outcome.PROVED
    assert nonnegative(x**3 * (x - 2), {x: Interval(2, 3)}).outcome is Outcome.PROVED
    assert nonnegative(x**3 * (x - 2), {x: Interval(1, 3)}).outcome is Outcome.REFUTED


def test_a_change_of_sign_between_the_samples_refutes_nonnegative_in_one_letter():
    finding = nonnegative((16 * x - 3) * (4 * x - 1), {x: UNIT})  # negative from 3/16 to 1/4

    assert finding.outcome is Outcome.REFUTED
    assert "has 2 root(s)" in finding.reason


def test_bernstein_coefficients_are_those_of_a_hand_calculation():
    """`x -> u/(1 + u)` on the unit interval, `u` and `-u` on half-lines; each row a power of the next letter."""
    assert bernstein(x**2 - 3 * x + 3, {x: UNIT}) == [3, 3, 1]
    assert bernstein(x**2 - 3 * x + 3, {x: Interval(1, 3)}) == [1, 0, 3]  # 1, 6 - 6 = 0, 3
    assert bernstein(x**2 - 3 * x + 3, {x: RAY}) == [3, -3, 1]
    assert bernstein(x**2 - 3 * x + 3, {x: Interval(2, oo)}) == [1, 1, 1]
    assert bernstein(x**2 - 3 * x + 3, {x: BACK}) == [3, 3, 1]
    assert bernstein(x**2 - 3 * x + 3, {x: Interval(-oo, 1)}) == [1, 1, 1]
    assert bernstein(x, {x: Interval(-1, 0)}) == [-1, 0]  # vanishes at an end of the closed interval
    assert bernstein(1 + 2 * x * y, {x: UNIT, y: RAY}) == [1, 0, 1, 2]  # 1 + u + 2*u*v, no v
