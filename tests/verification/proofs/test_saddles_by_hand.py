"""Saddles in complex balls: words where they are analytic, multipliers by hand, and what separates them."""

import cmath

import pytest
from flint import acb, arb
from sympy import Rational

from verification.arithmetic.balls import FUNCTIONS, working
from verification.proofs.manifolds import enclosed as room
from verification.proofs.manifolds.enclosed import (
    TooWideError,
    around_zero,
    complex_balls,
    enclosed_saddle,
    multipliers_of,
    size,
)
from verification.proofs.manifolds.plane_map import Henon
from verification.proofs.manifolds.saddle import Orbit

HENON, FIXED = Henon(Rational(3, 10)), Orbit("fixed point", (0.63,))
POINTS = 0.5 + 0.25j, 0.75 - 0.5j, 2.0 + 0.875j
CUTS = {"atan": (1 + 1j, 1 - 1j, 2j), "sqrt": (1j, -1j, -1 + 0j, 0j), "log": (1j, -1j, -1 + 0j, 0j)}


@pytest.mark.parametrize("word", [word for word in FUNCTIONS if hasattr(cmath, word)])
def test_words_have_the_values_of_complex_numbers(word):
    words = complex_balls(100)
    for z in POINTS:
        assert complex(getattr(words, word)(acb(z.real, z.imag))) == pytest.approx(getattr(cmath, word)(z), abs=1e-12)
    assert complex(getattr(words, word)(0.5)) == pytest.approx(getattr(cmath, word)(0.5), abs=1e-12)


@pytest.mark.parametrize(("word", "z"), [(word, z) for word, some in CUTS.items() for z in some])
def test_nothing_is_known_where_a_cut_may_pass(word, z):
    """Beyond or on lines that keep the cuts out, also where the function itself goes on."""
    words = complex_balls(100)
    assert not getattr(words, word)(acb(z.real, z.imag)).is_finite()
    inside = acb(z.real, 0.875 * z.imag / abs(z.imag)) if word == "atan" else acb(abs(z) + 0.125, z.imag)
    assert getattr(words, word)(inside).is_finite()
    assert not getattr(words, word)(acb(arb(inside.real, 4), arb(inside.imag, 4))).is_finite()


def test_numbers_of_a_kernel_are_enclosed():
    words = complex_balls(100)
    assert (words.q(1, 3) * 3).contains(acb(1))
    assert float(words.q(1, 3).real.rad()) < 1e-29
    assert abs(float(words.pi.real) - cmath.pi) < 1e-15
    assert complex(words.root(acb(8), 3)) == pytest.approx(2)


def test_a_square_about_0_holds_a_disc_and_a_size_is_the_largest():
    ball = around_zero(arb(2, 0.5))
    for corner in (2.5, -2.5, 2.5j, -2.5j):
        assert ball.contains(acb(corner.real, corner.imag) if isinstance(corner, complex) else acb(corner))
    assert not ball.contains(acb(2.6))
    assert not ball.contains(acb(0, 2.6))
    assert 5.5 <= float(size(acb(arb(3, 0.5), arb(4, 0.25)))) < 5.52
    assert float(size(arb(-2, 0.25))) == pytest.approx(2.25, abs=1e-6)
    assert float(size(arb(-2, 0.25)).rad()) == 0


@pytest.mark.parametrize(
    ("stable", "unstable"),
    [(0.5, 2.0), (-0.5, 2.0), (0.5, -2.0), (-0.25, -0.75), (0.125, 0.25), (0.125, -0.25), (3, 5)],
)
def test_multipliers_are_the_roots_of_their_polynomial_the_smaller_first(monkeypatch, stable, unstable):
    monkeypatch.setattr(room, "slopes", lambda *_: None)
    monkeypatch.setattr(room, "trace_and_determinant", lambda *_: (acb(stable + unstable), acb(stable * unstable)))
    with working(100):
        found = multipliers_of(FIXED, HENON, [], acb(1))
    for ball, truth in zip(found, (stable, unstable), strict=True):
        assert ball.contains(acb(truth))
        assert float(size(ball - truth)) < 1e-25


@pytest.mark.parametrize(("trace", "determinant"), [(0, 1), (2, 1), (1, 1), (arb(2.5, 1), 1), (2.5, arb(1, 1))])
def test_multipliers_that_may_be_equal_or_complex_are_refused(monkeypatch, trace, determinant):
    monkeypatch.setattr(room, "slopes", lambda *_: None)
    monkeypatch.setattr(room, "trace_and_determinant", lambda *_: (acb(trace), acb(determinant)))
    with working(100), pytest.raises(TooWideError, match="may be complex") as refused:
        multipliers_of(FIXED, HENON, [], acb(1))
    assert refused.value.item == "saddle"


@pytest.mark.parametrize(
    ("stable", "unstable", "separated"),
    [
        (0.5, 2.0, True),
        (-0.5, -1.125, True),
        (0.875, 1.125, True),
        (1.0, 2.0, False),
        (-1.0, 2.0, False),
        (0.5, 1.0, False),
        (0.5, -1.0, False),
        (1.25, 2.0, False),
        (0.5, 0.75, False),
        (arb(0.5, 0.75), 2.0, False),
        (0.5, arb(2, 1.5), False),
    ],
)
def test_a_saddle_has_one_multiplier_inside_the_unit_circle_and_one_outside(monkeypatch, stable, unstable, separated):
    monkeypatch.setattr(room, "enclosed_cycle", lambda *_: [acb(3)])
    monkeypatch.setattr(room, "multipliers_of", lambda *_: (acb(stable), acb(unstable)))
    if separated:
        found = enclosed_saddle(FIXED, HENON, acb(1))
        assert (found.points, found.stable.real, found.unstable.real) == ((acb(3),), arb(stable), arb(unstable))
        return
    with pytest.raises(TooWideError, match="not separated") as refused:
        enclosed_saddle(FIXED, HENON, acb(1))
    assert refused.value.item == "saddle"
