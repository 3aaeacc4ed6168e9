"""Proofs of sign: proved signs are true, refutations have a witness, and the ends of ranges count."""

import re
from itertools import product

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import FiniteSet, Interval, Poly, Rational, S, Symbol, expand, nan, oo, sin, sqrt

from symbolic.expressions.signs import Outcome, SignFinding, bernstein, conjunction, nonnegative, positive

x, y = Symbol("x", real=True), Symbol("y", real=True)
SMALL = st.integers(-4, 4)
ENDS = st.fractions(-2, 2, max_denominator=4)


@st.composite
def intervals(draw) -> Interval:
    low, high = sorted(draw(st.lists(ENDS, min_size=2, max_size=2, unique=True)))
    low, high = (Rational(end.numerator, end.denominator) for end in (low, high))
    low, high = draw(st.sampled_from([(low, high), (low, high), (low, high), (low, oo), (-oo, high)]))
    return Interval(low, high, draw(st.booleans()), draw(st.booleans()))


@st.composite
def polynomials(draw):
    powers = [(i, j) for i in range(4) for j in range(3) if i + j <= 3]
    return sum((draw(SMALL) * x**i * y**j for i, j in powers), S(draw(st.integers(0, 12))))


def points(interval: Interval, count: int = 9) -> list:
    low = interval.start if interval.start.is_finite else interval.end - 20
    high = interval.end if interval.end.is_finite else interval.start + 20
    inside = [low + (high - low) * Rational(k, count + 1) for k in range(count + 2)]
    return [value for value in inside if value in interval]


def witness(reason: str) -> tuple[dict, S]:
    """The point and the value that a refutation names."""
    names = {"x": x, "y": y}
    at = {names[name]: Rational(value) for name, value in re.findall(r"(\w) = (-?[\d/]+)", reason)}
    return at, Rational(re.search(r"the value is (-?[\d/]+)$", reason)[1])


def check(p, box) -> Outcome:
    """The outcome for `p > 0`, once it agrees with exact samples, witnesses and root counts."""
    finding = positive(p, box, depth=4)
    used = [symbol for symbol in (x, y) if symbol in p.free_symbols]
    samples = [p.subs(dict(zip(used, at, strict=True))) for at in product(*(points(box[symbol]) for symbol in used))]
    if finding:
        assert all(value > 0 for value in samples)
        assert len(used) != 1 or not any(root in box[used[0]] for root in Poly(p, used[0]).real_roots())
    elif finding.outcome is Outcome.REFUTED and "the value is" in finding.reason:
        at, value = witness(finding.reason)
        assert p.subs(at) == value <= 0
        assert all(at[symbol] in box[symbol] for symbol in used)
    elif finding.outcome is Outcome.REFUTED:
        assert any(root in box[used[0]] for root in Poly(p, used[0]).real_roots())
    return finding.outcome


@pytest.mark.slow
@settings(max_examples=30)
@given(polynomials(), intervals(), intervals())
@example(-(x**2) - 1, Interval(-oo, oo), Interval(0, 1))  # was proved positive: no sample lay on the line
@example(x, Interval.open(-oo, -1), Interval(0, 1))
@example(x - y, Interval(0, 1), Interval(0, 1))
def test_no_verdict_on_a_polynomial_in_two_variables_is_false(p, over_x, over_y):
    check(expand(p), {x: over_x, y: over_y})


@pytest.mark.slow
@settings(max_examples=80)
@given(st.lists(SMALL, min_size=1, max_size=6), intervals())
@example([0, 0, 1], Interval.open(0, 1))
@example([0, 1], Interval.Ropen(-1, 0))
@example([1, -6, 9], Interval(0, 1))  # touches zero between the samples
@example([-1, 16], Interval.open(0, 1))  # negative before the first sample
def test_one_variable_is_always_decided_and_never_wrongly(coefficients, over_x):
    p = sum((c * x**k for k, c in enumerate(coefficients)), S.Zero)

    assert check(p, {x: over_x}) is not Outcome.UNKNOWN


@pytest.mark.slow
@settings(max_examples=20)
@given(polynomials(), polynomials(), intervals(), intervals())
@example(S.One, x, Interval(0, 1), Interval(0, 1))
def test_a_proved_quotient_is_positive_and_has_no_pole(top, bottom, over_x, over_y):
    if expand(bottom) == 0:
        return
    box = {x: over_x, y: over_y}
    if positive(top / bottom, box, depth=3):
        for at in product(points(over_x), points(over_y)):
            here = dict(zip((x, y), at, strict=True))
            assert (bottom * top).subs(here) > 0


@pytest.mark.slow
@settings(max_examples=25)
@given(polynomials(), intervals(), intervals())
@example(x**2 - x * y + y**2, Interval(-1, 1), Interval(-1, 1))  # zero at one inner point: was refuted
@example((x - y) ** 2, Interval(0, 1), Interval(0, 1))
def test_no_verdict_on_nonnegative_is_false(p, over_x, over_y):
    p, box = expand(p), {x: over_x, y: over_y}
    finding = nonnegative(p, box, depth=3)
    values = [p.subs(dict(zip((x, y), at, strict=True))) for at in product(points(over_x), points(over_y))]
    if finding:
        assert all(value >= 0 for value in values)
    if finding.outcome is Outcome.REFUTED and "the value is" in finding.reason:
        at, value = witness(finding.reason)
        assert value < 0 or len(p.free_symbols) < 2
        assert all(place in box[symbol] for symbol, place in at.items())


@pytest.mark.parametrize("end", [S.Zero, Rational(1, 3), sqrt(2)])
def test_an_end_counts_exactly_when_it_belongs_to_the_range(end):
    for p, opened, closed in (
        (x - end, Interval.Lopen(end, 3), Interval(end, 3)),
        (end - x, Interval.Ropen(-1, end), Interval(-1, end)),
        (x - end, Interval.open(end, oo), Interval(end, oo)),
        (end - x, Interval.open(-oo, end), Interval(-oo, end)),
    ):
        assert positive(p, {x: opened}).outcome is Outcome.PROVED
        assert positive(p, {x: closed}).outcome is Outcome.REFUTED
        assert nonnegative(p, {x: closed}).outcome is Outcome.PROVED


def test_a_corner_counts_exactly_when_it_belongs_to_the_box():
    closed, opened = Interval(0, 1), Interval.Ropen(0, 1)

    assert positive(1 - x * y, {x: opened, y: closed}).outcome is Outcome.PROVED
    assert positive(1 - x * y, {x: closed, y: opened}).outcome is Outcome.PROVED
    assert positive(1 - x * y, {x: closed, y: closed}).outcome is Outcome.REFUTED


@pytest.mark.parametrize("gap", [Rational(1, 10**3), Rational(1, 10**30)])
def test_a_polynomial_that_almost_touches_zero_is_still_decided(gap):
    box = {x: Interval(0, 1)}

    assert positive((2 * x - 1) ** 2 + gap, box).outcome is Outcome.PROVED
    assert positive((2 * x - 1) ** 2 - gap, box).outcome is Outcome.REFUTED


@pytest.mark.parametrize("expression", [nan, S.ComplexInfinity, sin(x) + 2, sqrt(x) + 1])
def test_what_is_no_polynomial_is_left_open(expression):
    assert positive(expression, {x: Interval(0, 1)}).outcome is Outcome.UNKNOWN


def test_a_negative_denominator_turns_the_sign():
    box = {x: Interval(0, 1)}

    assert positive(1 / (x - 2), box).outcome is Outcome.REFUTED
    assert positive(x / (x - 2) + 2, box).outcome is Outcome.PROVED
    assert positive(-1 / (x - 2), box).outcome is Outcome.PROVED


def test_a_pole_in_the_range_leaves_the_question_open():
    assert positive(1 / x, {x: Interval(0, 1)}).outcome is Outcome.UNKNOWN
    assert positive(1 / x, {x: Interval.Lopen(0, 1)}).outcome is Outcome.PROVED


def test_a_letter_without_a_range_is_refused():
    with pytest.raises(ValueError, match=r"^positive: no range given for y$"):
        positive(x + y, {x: Interval(0, 1)})


@pytest.mark.parametrize("no_range", [FiniteSet(1), Interval(2, 1)])
def test_a_range_of_at_most_one_point_is_refused(no_range):
    with pytest.raises(ValueError, match="it must be an interval of more than one point"):
        positive(x, {x: no_range})


@settings(max_examples=30)
@given(polynomials(), intervals(), intervals())
def test_bernstein_coefficients_of_one_sign_fix_the_sign(p, over_x, over_y):
    p, box = expand(p), {x: over_x, y: over_y}
    coefficients = bernstein(p, box) if p.free_symbols else []
    if coefficients and all(c > 0 for c in coefficients):
        assert all(
            p.subs(dict(zip((x, y), at, strict=True))) > 0 for at in product(points(over_x, 5), points(over_y, 5))
        )


def test_a_conjunction_is_as_weak_as_its_weakest_part():
    proved, refuted, unknown = (SignFinding(outcome, outcome.name) for outcome in Outcome)

    assert conjunction(proved, proved).outcome is Outcome.PROVED
    assert conjunction(proved, unknown).outcome is Outcome.UNKNOWN
    assert conjunction(unknown, refuted, proved).outcome is Outcome.REFUTED
    assert [bool(finding) for finding in (proved, refuted, unknown)] == [True, False, False]
