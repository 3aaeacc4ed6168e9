"""Jets and series with plain numbers among them, and how long series are."""

import math

import pytest
from flint import acb, acb_series, arb, arb_series, ctx

from verification.arithmetic.balls import FLOAT64, FUNCTIONS, balls, working
from verification.arithmetic.series import Expansion, Jet, along, coefficients, expanded, in_series, jets, taylor
from verification.proofs.manifolds.enclosed import complex_balls


def test_a_number_beside_a_jet_is_one_without_powers():
    one = Jet(6, 4, 2)
    assert (one + 3).c == (3 + one).c == (9, 4, 2)
    assert (one - 3).c == (3, 4, 2)
    assert (3 - one).c == (-3, -4, -2)
    assert (one * 3).c == (3 * one).c == (18, 12, 6)
    assert (one / 2).c == (3, 2, 1)
    assert (-one).c == (-6, -4, -2)
    assert (one + one).c == (12, 8, 4)
    assert (8 / Jet(2, 0, 1)).c == (4, 0, -2)  # 4/(1 + e**2/2)
    assert (6 / Jet(2, 2)).c == (3, -3)
    assert (Jet(5) * Jet(7)).c == (35,)
    assert (Jet(2, 3) * Jet(5, 7)).c == (10, 29)
    assert (Jet(2, 3, 5) * Jet(7, 11, 13)).c == (14, 43, 94)
    assert (Jet(2, 3, 5, 7) * Jet(11, 13, 17, 19)).c == (22, 59, 128, 231)
    assert (Jet(22, 59, 128, 231) / Jet(2, 3, 5, 7)).c == (11, 13, 17, 19)


@pytest.mark.parametrize("word", FUNCTIONS)
def test_a_word_of_a_number_is_that_of_its_own_numbers(word):
    base = balls(64)
    with working(64):
        over, series = jets(base), in_series(base, arb_series)
        at, wanted = arb("0.75"), getattr(base, word)(arb("0.75"))
        for words in (over, series):
            found = getattr(words, word)(at)
            assert isinstance(found, arb)
            assert found.overlaps(wanted)
        assert over.root(at, 3).overlaps(base.root(at, 3))
        assert series.root(at, 3).overlaps(base.root(at, 3))
        assert (over.q(1, 3), series.q(1, 3)) == (base.q(1, 3), base.q(1, 3))
    assert getattr(jets(FLOAT64), word)(0.75) == pytest.approx(getattr(math, word)(0.75), rel=1e-15)


@pytest.mark.parametrize("word", [*FUNCTIONS, "root"])
def test_series_and_jets_have_the_coefficients_of_differences(word):
    """At `3/4 + e - e**2/2`: the first derivative and half the second, from values to 60 digits."""
    base, third = balls(240), 3 if word == "root" else None
    with working(240):
        function = (lambda x: base.root(x, third)) if third else getattr(base, word)
        h, at = arb(10) ** -12, arb("0.75")
        low, middle, high = (function(at + s * h) for s in (-1, 0, 1))
        first, second = (high - low) / (2 * h), (high - 2 * middle + low) / (h * h)
        jet = Jet(at, arb(1), arb("-0.5"))
        made = [jets(base), in_series(base, arb_series)]
        own = getattr(made[0], word)(*[jet, *([third] if third else [])])
        (other,) = along([jet], lambda near: [getattr(made[1], word)(*[near[0], *([third] if third else [])])])
        for found in (own, other):
            assert len(found.c) == 3
            for c, known in zip(found.c, (middle, first, second / 2 - first / 2), strict=True):
                assert abs(c - known) < 1e-20


@pytest.mark.parametrize("fails", [False, True])
def test_series_are_as_long_as_is_said_inside_and_as_before_outside(fails):
    before = ctx.cap
    try:
        with taylor(5):
            assert ctx.cap == 5
            with taylor(2):
                assert len(coefficients(arb_series([1, 1]).exp(), 2)) == 2
                assert arb_series([1, 1]).exp().prec == 2
            assert ctx.cap == 5
            if fails:
                raise ArithmeticError
    except ArithmeticError:
        assert fails
    assert ctx.cap == before


def test_a_function_along_jets_is_one_of_series_of_their_numbers():
    asked = []

    def function(near):
        asked.extend(near)
        return [near[0] * near[1], near[0] + 1]

    real = [Jet(arb(2), arb(3), arb(5)), Jet(arb(7), arb(11), arb(13))]
    product, more = along(real, function)
    assert [float(x) for x in product.c] == [14, 43, 94]
    assert [float(x) for x in more.c] == [3, 3, 5]
    assert all(isinstance(x, arb_series) for x in asked)
    (square,) = along([Jet(acb(0, 1), acb(1))], lambda near: [near[0] * near[0]])
    assert square.c == (acb(-1), acb(0, 2))
    assert isinstance(in_series(complex_balls(64), acb_series).exp(acb(0)), acb)


def test_coefficients_end_where_a_series_is_known_no_farther():
    with taylor(4):
        quotient = arb_series([0, 6, 4, 2]) / arb_series([0, 2])
        assert quotient.prec == 3
        known, lost = coefficients(quotient, 3), coefficients(quotient, 5)
    assert [float(x) for x in known] == [3, 2, 1]
    assert [float(x) for x in lost[:3]] == [3, 2, 1]
    assert not any(x.is_finite() for x in lost[3:])
    assert len(lost) == 5


@pytest.mark.parametrize(("low", "high"), [(-2, 1), (-1, 2)])
@pytest.mark.parametrize("terms", [(3,), (3, -2), (3, -2, 5), (3, -2, 5, -7)])
def test_bounds_of_an_expansion_are_sums_at_the_farther_end_and_its_integral_holds_every_last_term(low, high, terms):
    made = Expansion(arb(low), arb(high), tuple(map(arb, terms)))
    size = sum(abs(c) * 2**k for k, c in enumerate(terms))
    slope = sum(k * abs(c) * 2 ** (k - 1) for k, c in enumerate(terms) if k)
    assert made.size() == size
    assert made.slope() == slope
    count = len(terms)
    known = sum(c * (high ** (k + 1) - low ** (k + 1)) / (k + 1) for k, c in enumerate(terms[:-1]))
    rest = abs(terms[-1]) * (high**count + abs(low) ** count) / count
    found = made.integral()
    assert float(found.mid()) == pytest.approx(known, abs=1e-12)
    assert float(found.rad()) == pytest.approx(rest, rel=1e-8)


def test_an_expansion_is_made_about_the_middle_and_over_the_whole_stretch():
    asked = []

    def cube(x):
        asked.append(x[0])
        return x * x * x

    found = expanded(cube, arb(1), arb(3), 3)
    assert asked[0] == 2
    assert (asked[1].contains(1), asked[1].contains(3), asked[1].rad() < 1.001) == (True, True, True)
    assert (found.low, found.high) == (-1, 1)
    assert [float(x.mid()) for x in found.terms] == pytest.approx([8, 12, 6])  # the last over all of it: 3*x
    assert (found.terms[2].contains(3), found.terms[2].contains(9), found.terms[2].rad() < 3.01) == (True, True, True)
    assert found.terms[0].is_exact()
