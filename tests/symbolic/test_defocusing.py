"""The cone of beams in the cardioid: identities exactly, and the bounds where they are sharp."""

from itertools import pairwise

from sympy import Rational, S, cos, nsimplify, pi, simplify, sin, sqrt, tan

from symbolic.defocusing import (
    C,
    beam_defects,
    chord_defects,
    cone_defects,
    delta,
    ends,
    excess,
    expands,
    gain,
    half,
    least_exponent,
    radius_defect,
    square_defects,
    turning_defect,
    x,
)
from symbolic.symbols import lam
from symbolic.zero import vanishes


def test_every_step_of_the_proof_is_an_identity():
    for defects in (
        beam_defects(),
        cone_defects(),
        chord_defects(),
        [radius_defect(), turning_defect()],
        square_defects(),
    ):
        assert all(vanishes(defect) for defect in defects)
    assert expands()


def test_a_chord_is_as_long_as_both_halves_of_the_osculating_chords_only_where_it_vanishes():
    assert excess().subs({x: 1, C: 1}) == 0
    assert excess().subs({x: 1, C: Rational(99, 100)}) > 0
    assert excess().subs({x: Rational(9, 10), C: 1}) > 0


def test_the_vertical_chord_has_the_length_and_the_slope_that_are_known():
    """From theta = -pi/3 to pi/3: length 3*sqrt(3)/2, slope -5/4 of the slap map, as `t*K + 1`."""
    c0, c1 = (simplify(c.subs({half: -pi / 6, delta: pi / 3})) for c in ends())
    radius = 4 * sqrt(3) / 2 / 3
    length = 2 * sin(pi / 3) * sqrt(c0**2 + c1**2 + 2 * c0 * c1 * cos(pi / 3))

    assert (c0, c1) == (sqrt(3) / 2, sqrt(3) / 2)
    assert simplify(length - 3 * sqrt(3) / 2) == 0
    assert simplify(gain().subs({x: 1, C: S.Half}) - (length - radius) / radius) == 0
    assert simplify((length - radius) / radius) == Rational(5, 4)


def test_the_least_exponent_is_positive_below_1_and_falls_to_0():
    values = [least_exponent().subs(lam, Rational(k, 10)).n() for k in range(10)]

    assert all(one > other > 0 for one, other in pairwise(values))
    assert least_exponent().subs(lam, 1) == 0
    assert nsimplify(tan(pi / 8) ** 2) == 3 - 2 * sqrt(2)
