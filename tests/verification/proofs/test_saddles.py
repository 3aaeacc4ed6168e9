"""Saddles in complex balls: words where they are analytic, signs of contacts, and the rules of maps."""

import cmath

import pytest
from flint import acb, arb
from sympy import Rational

from symbolic.tables import egg
from symbolic.tables.law import Law
from verification.arithmetic.balls import FLOAT64, FUNCTIONS, balls, working
from verification.arithmetic.series import Jet
from verification.cycles.recurrence import Closure
from verification.proofs.manifolds.enclosed import TooWideError, complex_balls, enclosed_saddle
from verification.proofs.manifolds.known import SHAPE, table
from verification.proofs.manifolds.plane_map import Henon, pinball
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact

HENON, FIXED = Henon(Rational(3, 10)), SaddleCycle("fixed point", (0.63,))
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
    """Balls on or beyond the lines that keep cuts out have no value, even where the function continues."""
    words = complex_balls(100)
    assert not getattr(words, word)(acb(z.real, z.imag)).is_finite()
    inside = acb(z.real, 0.875 * z.imag / abs(z.imag)) if word == "atan" else acb(abs(z) + 0.125, z.imag)
    assert getattr(words, word)(inside).is_finite()
    assert not getattr(words, word)(acb(arb(inside.real, 4), arb(inside.imag, 4))).is_finite()


def test_each_round_of_a_mirrored_cycle_turns_the_sign_of_a_contact():
    mirror, plain = SaddleCycle("mirrored", (0.1,), Closure(-1, (0, 1))), SaddleCycle("plain", (0.1,))
    for sign in (1, -1):
        for early in range(3):
            for late in range(3):
                for first, second, turns in (
                    (mirror, plain, early),
                    (plain, mirror, late),
                    (mirror, mirror, early + late),
                ):
                    found = Contact(first, second, 3, sign, 0.1, 0.1, 1.0).mirrored(early, late)
                    assert found == sign * (-1) ** turns
                    assert type(found) is int
    assert Contact(mirror, mirror, 3, 1, 0.1, 0.1, 1.0).kind == "homoclinic"
    assert Contact(mirror, plain, 3, 1, 0.1, 0.1, 1.0).kind == "heteroclinic"


def test_the_rule_of_the_henon_map_is_its_formula():
    """`1 - a*x**2 + 3/10*x[-1] - x[1]`, up to a factor, from `x' = 1 - a*x**2 + y` and `y' = 3/10*x`."""
    map, near, a = Henon(Rational(3, 10)).over(FLOAT64), (0.5, 0.25, 1.0), 1.5
    value = map.rule(near, a)
    truth, slopes, by = 1 - a * 0.0625 + 0.15 - 1.0, (0.3, -2 * a * 0.25, -1.0), -0.0625
    factor = value / truth
    assert map.slopes(near, a) == pytest.approx([factor * x for x in slopes])
    again, others, moving = map.linear(near, a)
    assert (again, *others, moving) == pytest.approx([value, *(factor * x for x in (*slopes, by))])
    assert map.turn == 0
    assert map.plane(0.5, 0.25) == pytest.approx((0.25, 0.15))
    assert map.rule((0.5, 0.25, 1 - a * 0.0625 + 0.15), a) == pytest.approx(0)


@pytest.mark.parametrize("map", [HENON, table(SHAPE)], ids=["henon", "egg"])
def test_the_rule_along_series_is_the_same_in_balls_and_in_float64(map):
    jets = [(0.2, 0.5, 0.25), (2.3, -0.25, 0.125), (4.2, 0.125, 1.0)]
    floats, words = map.over(FLOAT64), map.over(balls(100))
    near = [Jet(*c) for c in jets], [Jet(*(arb(x) for x in c)) for c in jets]
    with working(100):
        value, others, moving = floats.linear_along(near[0], 0.75)
        known, slopes, by = words.linear_along(near[1], arb(0.75))
        for one, other in zip((value, *others, moving), (known, *slopes, by), strict=True):
            assert [float(x) for x in other.c] == pytest.approx(list(one.c), abs=1e-12)
        along = floats.rule_along(near[0], 0.75), words.rule_along(near[1], arb(0.75))
        assert [float(x) for x in along[1].c] == pytest.approx(list(along[0].c), abs=1e-12)
        assert list(along[0].c) == pytest.approx(list(value.c), abs=1e-12)
        step = 1e-6
        there = [floats.rule([c[0] + sign * step * c[1] for c in jets], 0.75) for sign in (1, -1)]
        assert (there[0] - there[1]) / (2 * step) == pytest.approx(value.c[1], rel=1e-6)


def test_a_law_of_the_place_leaves_no_rotations():
    five = egg(5).at(alpha="1/40")
    assert pinball(five).turn == 5
    assert pinball(five, Law("-lam*eta + eta**3/99")).turn == 5
    assert pinball(five, Law("-lam*eta + cos(theta)*eta**3/99")).turn == 1


@pytest.mark.parametrize(
    ("b", "start", "said"),
    [
        (Rational(2), -0.91608, "inside the unit circle"),  # multipliers near 1.5 and -1.3
        (Rational(3, 10), 1.21699, "inside the unit circle"),  # near 0.4 and -0.7
        (Rational(-9, 10), 0.51249, "may be complex"),
    ],
)
def test_a_fixed_point_that_is_no_saddle_is_refused(b, start, said):
    """In Henon's map with `a = 1/10`, with areas that grow, shrink, and shrink a little about a centre."""
    with working(100), pytest.raises(TooWideError, match=said):
        enclosed_saddle(SaddleCycle("fixed point", (start,)), Henon(b), acb(arb(1) / 10))
