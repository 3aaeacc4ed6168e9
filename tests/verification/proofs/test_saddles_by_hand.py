"""Saddles in complex balls: words where they are analytic, multipliers by hand, and what separates them."""

import cmath
from types import SimpleNamespace

import pytest
from flint import acb, arb
from sympy import Rational

from numeric import PinballMap
from symbolic.tables import egg
from symbolic.tables.law import Law
from verification.arithmetic.balls import FLOAT64, FUNCTIONS, balls, working
from verification.arithmetic.series import Jet
from verification.cycles.recurrence import Closure
from verification.proofs.manifolds import enclosed as room
from verification.proofs.manifolds import tangency
from verification.proofs.manifolds.enclosed import (
    TooWideError,
    around_zero,
    complex_balls,
    enclosed_saddle,
    multipliers_of,
    size,
)
from verification.proofs.manifolds.known import SHAPE, table
from verification.proofs.manifolds.plane_map import Henon, pinball
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Contact, Precision, Scale, pair

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


@pytest.fixture
def square(monkeypatch):
    """A stand-in for series: the coefficients of both bounces are 1 and the square of the parameter, or twice that."""
    asked = []

    def enclosed(saddle, unstable, order, unit, chief):
        (at,) = saddle.points
        asked.append((unstable, order, unit, chief))
        jets = tuple(Jet(acb(1), k * at * at) for k in (1, 2))
        return SimpleNamespace(saddle=saddle, pair=lambda: jets, over=lambda i, radius: acb(i, radius) + 0 * at)

    monkeypatch.setattr(tangency, "enclosed_saddle", lambda orbit, map, at: SimpleNamespace(points=(at,)))
    monkeypatch.setattr(tangency, "enclosed", enclosed)
    monkeypatch.setattr(tangency, "remainder", lambda made, outer: arb(0.0625))
    return asked


SCALE = Scale(True, 0.5, 3, None, more=10)


def test_a_pair_has_the_values_at_a_parameter_and_slopes_that_hold_two_steps_around_it(square):
    """Of `x**2` at 3/4: within Cauchy's bound of the second derivative on the disc, four times the step."""
    precision, orbit = Precision(6), Orbit("of two bounces", (0.1, 0.2))
    with working(precision.bits):
        made = pair(orbit, HENON, arb(0.75), SCALE, precision)
        step, disc = precision.step, precision.disc
        assert square == [(True, precision.order + 10, 0.5, 3)] * 3
        for k, places, slopes in zip((1, 2), made.places, made.slopes, strict=True):
            assert [float(x) for x in places] == [1, k * 0.5625]
            assert slopes[0].contains(0)
            for away in (-2, 0, 2):
                assert slopes[1].contains(2 * k * (arb(0.75) + away * step).mid())
            ball = acb(0.75) + around_zero(disc)
            largest = size(k * ball * ball - k * acb(0.5625))
            wanted = 4 * step * 2 * largest / (disc - 2 * step) ** 2
            assert float(slopes[1].rad()) == pytest.approx(float(wanted), rel=1e-6)
            assert abs(float(slopes[1].mid()) - 1.5 * k) < 1e-5
        assert made.margin.overlaps(disc - 2 * step)
        assert float(made.margin) == pytest.approx(1e-4 - 2e-6)
        assert float(made.error) == 0.0625
        assert len(made.tube) == 4  # one beyond each end
        for i, x in zip((-1, 0, 1, 2), made.tube, strict=True):
            assert (float(x.mid()), float(x.rad())) == pytest.approx((i, 0.0625), rel=1e-6)


def test_steps_beyond_the_disc_of_parameters_prove_nothing(square):
    """On a disc no larger than two steps there is no bound of a derivative two steps away."""
    for digits, large in ((1, False), (2, False), (3, True), (4, True)):
        precision = Precision(digits)
        with working(precision.bits):
            assert bool(precision.disc > 2 * precision.step) is large
            if large:
                assert pair(FIXED, HENON, arb(0.75), SCALE, precision).margin > 0
                continue
            with pytest.raises(TooWideError, match="digits") as refused:
                pair(FIXED, HENON, arb(0.75), SCALE, precision)
            assert refused.value.item == "saddle"


@pytest.mark.parametrize("other", [0, 1])
def test_a_pair_is_of_one_cycle_over_the_disc_and_at_both_parameters(square, monkeypatch, other):
    answers = iter([k != other for k in range(2)])
    monkeypatch.setattr(tangency, "one_cycle", lambda around, here: next(answers))
    precision = Precision(6)
    with working(precision.bits), pytest.raises(TooWideError, match="may be another") as refused:
        pair(FIXED, HENON, arb(0.75), SCALE, precision)
    assert refused.value.item == "saddle"


def test_each_round_of_a_mirrored_cycle_turns_the_sign_of_a_contact():
    mirror, plain = Orbit("mirrored", (0.1,), Closure(-1, (0, 1))), Orbit("plain", (0.1,))
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


@pytest.mark.parametrize(("digits", "step", "disc"), [(3, 3, 2), (5, 5, 3), (6, 6, 4), (20, 20, 12), (24, 24, 15)])
def test_boxes_of_parameters_are_as_wide_as_the_digits_and_lie_in_a_disc_of_three_fifths_of_them(digits, step, disc):
    precision = Precision(digits)
    with working(precision.bits):
        assert float(precision.step) == pytest.approx(10.0**-step)
        assert float(precision.disc) == pytest.approx(10.0**-disc)
        assert float(precision.step.rad()) == float(precision.disc.rad()) == 0


def test_the_rule_of_the_henon_map_and_its_derivatives_are_those_of_its_formula():
    """`1 - a*x**2 + 3/10*x[-1] - x[1]`, up to a factor; drawn are `x' = 1 - a*x**2 + y` and `y' = 3/10*x`."""
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


def test_a_map_has_the_rotations_of_its_table_unless_the_law_knows_the_place():
    five = egg(5).at(alpha="1/40")
    assert pinball(five).turn == 5
    assert pinball(five, Law("-lam*eta + eta**3/99")).turn == 5
    assert pinball(five, Law("-lam*eta + cos(theta)*eta**3/99")).turn == 1


@pytest.mark.parametrize(("theta", "phi"), [(0.25, 0.5), (2.0, -0.75)])
def test_two_places_are_the_phase_point_of_the_particle_that_flies_from_one_to_the_next(theta, phi):
    flown = PinballMap("egg", lam=0.5, alpha="0.08").step(theta, phi)
    here, leaving = pinball(egg(3).at(alpha="0.08")).plane(theta, float(flown.theta))
    assert (here, leaving) == (theta, pytest.approx(phi, abs=1e-12))


def test_the_exit_angle_of_another_law_is_the_laws_own():
    map = pinball(egg(3).at(alpha="0.08"), Law("-lam*eta - eta**3/8"))
    assert map.exit(0.5, 0.25, 1.0) == pytest.approx(-0.140625)  # lam = 1/4 at the place 1
