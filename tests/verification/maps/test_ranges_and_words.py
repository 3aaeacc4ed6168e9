"""What first hits rest on: shapes in their ranges, sums of cosines, words that are no shorter ones again."""

from itertools import product

import pytest
from flint import arb
from sympy import Interval, Rational, S, Symbol, Union, cos, exp, oo, pi, sin, sqrt

from symbolic.tables import egg, square
from symbolic.tables.table import theta
from verification.maps import first_hit
from verification.maps.first_hit import inside

B = Symbol("b", real=True)
HALVES = Interval(Rational(1, 4), Rational(3, 4))


@pytest.mark.parametrize(
    ("range", "held", "off"),
    [
        (HALVES, ["0.25", "0.5", "0.75", "0.5 +/- 0.2"], ["0.2", "0.8", "0.3 +/- 0.1", "0.7 +/- 0.1", "nan"]),
        (Interval(-oo, Rational(3, 4)), ["-1e9", "0.75"], ["0.8", "0.7 +/- 0.1"]),
        (Interval(Rational(1, 4), oo), ["0.25", "1e9"], ["0.2", "0.3 +/- 0.1"]),
        (Interval(-oo, oo), ["0", "1e9"], []),
        (Interval(0, pi), [], ["1", "4"]),  # an end that is no rational is not compared with
        (Interval(-pi, 0), [], ["-1", "1"]),
        (Interval(-oo, pi), [], ["1"]),
        (Interval(-pi, oo), [], ["1"]),
    ],
)
def test_a_shape_is_within_a_range_where_all_its_ball_is_between_the_ends(range, held, off):
    for texts, answer in ((held, True), (off, False)):
        for text in texts:
            assert first_hit._within(arb(text), range) is answer
            for k in (0, 1):  # and of several shapes each one
                shape = [arb(0.5), arb(0.5)]
                shape[k] = arb(text)
                ranges = [HALVES, HALVES]
                ranges[k] = range
                assert first_hit._all_within(tuple(shape), ranges) is answer
    assert first_hit._all_within((), [range])
    assert not first_hit._all_within((arb(0.5),), [Union(HALVES, Interval(2, 3))])


UP_TO_1, UP_TO_2 = Interval(0, 1), Interval(0, 2)


@pytest.mark.parametrize(
    ("bend", "ranges", "proved"),
    [
        (1 + cos(theta), {}, True),
        (1 - cos(theta), {}, True),
        (1 + Rational(3, 2) * cos(theta), {}, False),
        (1 - Rational(3, 2) * cos(theta), {}, False),
        (Rational(1, 2) + cos(theta), {}, False),
        (1 + cos(2 * theta), {}, True),
        (2 + cos(2 * theta) + cos(4 * theta), {}, True),  # 1 + c + 2*c**2, with the cosine c of twice the angle
        (1 + cos(2 * theta) + cos(4 * theta), {}, False),
        (Rational(9, 8) + cos(2 * theta) + cos(4 * theta), {}, True),
        (Rational(9, 8) + cos(theta) + cos(4 * theta), {}, False),
        (S(2), {}, False),  # without a cosine it is not asked
        (S(-2), {}, False),
        (S.Zero, {}, False),
        (cos(theta), {}, False),
        (2 + sin(theta), {}, False),  # its coefficients are not those of cosines
        (2 + cos(theta) + sin(theta), {}, False),
        (2 + sqrt(2) * cos(theta), {}, False),
        (3 + sqrt(2) * cos(theta) + cos(2 * theta), {}, False),
        (exp(theta), {}, False),
        (1 + B * cos(theta), {B: UP_TO_1}, True),
        (1 + B * cos(theta), {B: UP_TO_2}, False),
        (1 + cos(theta), {B: UP_TO_2}, True),
        (1 + B * cos(theta), {B: Union(Interval(0, Rational(1, 4)), Interval(Rational(1, 2), 1))}, False),
    ],
    ids=str,
)
def test_a_sum_of_cosines_is_nonnegative_as_a_polynomial_in_one_of_them(bend, ranges, proved):
    """Where that decides: it is not asked of sines, of other coefficients, or over ranges that are no intervals."""
    assert first_hit._exactly_nonnegative(bend, ranges) is proved


def test_a_ball_over_a_range_reaches_from_end_to_end_and_everywhere_where_an_end_is_not_rational():
    found = first_hit._over(Interval(Rational(1, 3), Rational(1, 2)))
    assert found.contains(arb("0.3333334"))
    assert found.contains(arb(0.5))
    assert found.rad() < 0.084
    for range in (Interval(0, pi), Interval(-pi, 1), Interval(0, oo), Interval(-oo, 1), Interval(sqrt(2), 2)):
        assert first_hit._over(range).contains(arb("1e99"))
        assert first_hit._over(range).contains(arb("-1e99"))


def test_a_law_is_the_same_a_turn_further_on_where_nothing_else_is_said():
    assert inside(egg(3).at(alpha="0.08"), (0,), [arb(4)]) is True


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6])
def test_a_cycle_is_minimal_where_its_word_is_no_shorter_one_again(n):
    """Of bounces on two sides of a square, at the middle of each: by all words."""
    table = square()
    for word in product((0, 1), repeat=n):
        again = any(word == word[:k] * (n // k) for k in range(1, n) if n % k == 0)
        assert first_hit.minimal(table, word, [arb(0.5)] * n) is (None if again else True)
