"""Jets and series have the coefficients of finite differences, and end at the last known coefficient."""

import pytest
from flint import arb, arb_series

from verification.arithmetic.balls import FUNCTIONS, balls, working
from verification.arithmetic.series import Jet, along, coefficients, in_series, jets, taylor


@pytest.mark.parametrize("word", [*FUNCTIONS, "root"])
def test_series_and_jets_have_the_coefficients_of_differences(word):
    """At `3/4 + e - e**2/2`: the first derivative and half the second, from values with 60 digits."""
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


def test_coefficients_end_where_a_series_is_known_no_farther():
    with taylor(4):
        quotient = arb_series([0, 6, 4, 2]) / arb_series([0, 2])
        assert quotient.prec == 3
        known, lost = coefficients(quotient, 3), coefficients(quotient, 5)
    assert [float(x) for x in known] == [3, 2, 1]
    assert [float(x) for x in lost[:3]] == [3, 2, 1]
    assert not any(x.is_finite() for x in lost[3:])
    assert len(lost) == 5
