"""Quotients of intervals, and products and derivatives of jets, against exact fractions."""

from fractions import Fraction
from itertools import product

import pytest

SMALL = [(a, b) for a in range(-3, 4) for b in range(a, 4)]  # ends of intervals in units of an eighth


def span(x):
    """The ends of an interval as fractions."""
    return Fraction(x.lo, 1 << x.p), Fraction(x.hi, 1 << x.p)


def holds(x, low, high=None, units=0):
    """True if an interval contains a range of values, with at most so many units in the last place beyond it."""
    low, high = Fraction(low), Fraction(low if high is None else high)
    return (
        low - Fraction(units, 1 << x.p) <= span(x)[0] <= low <= high <= span(x)[1] <= high + Fraction(units, 1 << x.p)
    )


def test_quotients_hold_all_values_and_little_more_and_none_is_by_what_may_be_0(check):
    for (a, b), (c, d) in product(SMALL, SMALL):
        x, y = (check.I(low << 27, high << 27, 30) for low, high in ((a, b), (c, d)))
        if c <= 0 <= d:
            with pytest.raises(check.Unproved, match="a divisor may be 0"):
                _ = x / y
            continue
        ends = [Fraction(s, t) for s in (a, b) for t in (c, d)]
        assert holds(x / y, min(ends), max(ends), 4)
        assert holds(1 / y, Fraction(8, d), Fraction(8, c), 1)
        assert holds(x / Fraction(3, 7), Fraction(a * 7, 24), Fraction(b * 7, 24), 3)


def made(check, p, degree, seed):
    """A jet of small numbers of every kind, exactly, including 0; and their values."""
    exact, c = [], []
    for k in range(len(check.algebra(degree)[0])):
        low = Fraction((seed * 7 + k * 5) % 11 - 5, 4)
        high = low + Fraction((seed + k) % 3, 4)
        sort = (seed + k) % 5
        c.append([check.I.of(low, p).hull(check.I.of(high, p)), 0, low, int(low), check.I.of(low, p)][sort])
        exact.append([(low, high), (0, 0), (low, low), (int(low),) * 2, (low, low)][sort])
    return check.Jet(c, degree), exact


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_products_and_sums_of_jets_have_the_coefficients_of_polynomials(check, degree):
    """Ranges of sums of products of the coefficients, exact for quarters and their products."""
    p = 12
    for s, t in product(range(5), range(5)):
        (x, a), (y, b) = made(check, p, degree, s), made(check, p, degree, t)
        found = [check.I.of(c, p) for c in (x * y).c]
        for k, pairs in enumerate(check.algebra(degree)[2]):
            low = sum(min(u * v for u in a[i] for v in b[j]) for i, j in pairs)
            high = sum(max(u * v for u in a[i] for v in b[j]) for i, j in pairs)
            assert span(found[k]) == (low, high)
        for z, c in (
            (x + y, [(u[0] + v[0], u[1] + v[1]) for u, v in zip(a, b, strict=True)]),
            (-x, [(-v, -u) for u, v in a]),
        ):
            assert [span(check.I.of(w, p)) for w in z.c] == c
            assert z.degree == degree
        by = Fraction(3, 2)
        assert [span(check.I.of(w, p)) for w in (x * by).c] == [(u * by, v * by) for u, v in a]
        assert [span(check.I.of(w, p)) for w in (x + by).c] == [(a[0][0] + by, a[0][1] + by), *a[1:]]


def test_the_derivative_of_a_jet_is_that_of_its_polynomial(check):
    for degree, letter in product((1, 2, 3), range(3)):
        powers, at, _ = check.algebra(degree)
        numbers = [Fraction(k * k + 1, 3) for k in range(len(powers))]
        found = check.Jet(numbers, degree).diff(letter)
        assert found.degree == degree - 1
        for e, c in zip(check.algebra(degree - 1)[0], found.c, strict=True):
            raised = tuple(n + (k == letter) for k, n in enumerate(e))
            assert c == numbers[at[raised]] * raised[letter]
