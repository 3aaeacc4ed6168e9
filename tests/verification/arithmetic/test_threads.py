"""Threads that ask for different numbers of digits each get their own number."""

from concurrent.futures import ThreadPoolExecutor

import mpmath
import pytest
from flint import ctx
from sympy import Rational

from verification.named.locate import locate

ASKED = [("lambda-c", digits) for digits in (20, 120, 45, 300, 30, 90)] + [
    ("lambda-star", digits) for digits in (25, 120, 60)
]


def value(asked):
    name, digits = asked
    found = locate(name, digits)
    assert found.certified
    return found.value


def test_each_thread_has_the_digits_that_it_asked_for():
    before = ctx.prec, mpmath.mp.prec
    alone = [value(asked) for asked in ASKED]

    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(value, ASKED * 2))

    assert together == alone * 2
    assert all(len(text) >= digits for text, (_, digits) in zip(alone, ASKED, strict=True))
    assert (ctx.prec, mpmath.mp.prec) == before


@pytest.mark.slow
def test_closed_forms_keep_their_digits_in_threads():
    """alpha-tilde at four contractions, 20 to 400 digits."""
    asked = [(Rational(1, k), digits) for k in (2, 3, 5, 7) for digits in (20, 400)]

    def shape(one):
        lam, digits = one
        return locate("alpha-tilde", digits, lam=lam).value

    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(shape, asked))

    assert together == [shape(one) for one in asked]
