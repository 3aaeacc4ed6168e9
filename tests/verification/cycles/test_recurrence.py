"""How a ring of rules closes, bifurcation conditions on multipliers, and the systems that solve for them."""

from fractions import Fraction
from math import prod

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from sympy import Matrix, N, Rational, eye

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables import cuspless
from verification.arithmetic.balls import FLOAT64
from verification.cycles.chain import trace_and_determinant
from verification.cycles.chords import Chords
from verification.cycles.critical import critical
from verification.cycles.newton import floats, refined
from verification.cycles.recurrence import IDENTITY, MIRROR, BifurcationKind, Closure, delayed, henon

FOLD, FLIP, TORUS = BifurcationKind.FOLD, BifurcationKind.FLIP, BifurcationKind.TORUS
small = st.fractions(-3, 3, max_denominator=5)
nonzero = small.filter(bool)
closures = st.builds(Closure, st.sampled_from([1, -1]), st.tuples(st.integers(-4, 4), st.integers(1, 5)))
turns = st.fractions(-2, 2, max_denominator=6)  # in place of 2*pi*p/q, so that nothing rounds
rings = st.lists(st.tuples(nonzero, small, nonzero), min_size=1, max_size=5)


@given(closures, turns, small, st.integers(0, 4))
def test_carrying_ahead_and_back_again_changes_nothing(closure, angle, x, rounds):
    assert closure.carried(closure.carried(x, angle, rounds), angle, -rounds) == x
    assert closure.carried(closure.carried(x, angle, 1), angle, rounds) == closure.carried(x, angle, rounds + 1)


@given(closures, turns, st.lists(small, min_size=1, max_size=4))
def test_a_ring_is_padded_with_its_own_bounces_carried_one_round(closure, angle, x):
    before, *own, after = closure.padded(x, angle)

    assert own == x
    assert (before, after) == (closure.carried(x[-1], angle, -1), closure.carried(x[0], angle, 1))


@given(closures, small)
def test_run_through_twice_a_ring_closes_by_its_symmetry_applied_twice(closure, x):
    def turn(one):
        return Fraction(*one.shift)

    once, twice = closure, closure.twice()

    assert twice.carried(x, turn(twice), 1) == once.carried(x, turn(once), 2)


@pytest.mark.parametrize("closure", [IDENTITY, MIRROR, Closure(1, (2, 3))])
def test_the_shift_is_the_same_angle_in_every_arithmetic(closure):
    assert closure.angle(FLOAT64) == pytest.approx(closure.radians, abs=1e-15)


def monodromy(rows, turn):
    """The matrix of one round, the product of the matrices that solve each rule for its last unknown."""
    whole = eye(2)
    for before, here, after in rows:
        whole = Matrix([[0, 1], [-Rational(before / after), -Rational(here / after)]]) * whole
    return turn * whole


@pytest.mark.slow
@given(rings, st.sampled_from([1, -1]))
def test_trace_and_determinant_are_those_of_the_product_of_the_linearised_maps(rows, turn):
    matrix = monodromy(rows, turn)

    assert trace_and_determinant(rows, turn) == (
        Fraction(*matrix.trace().as_numer_denom()),
        Fraction(*matrix.det().as_numer_denom()),
    )


@pytest.mark.slow
@given(rings, st.sampled_from([1, -1]), st.sampled_from([FOLD, FLIP, BifurcationKind.PITCHFORK]))
def test_a_ring_that_folds_or_flips_is_one_with_the_critical_multiplier(rows, turn, kind):
    """`det(M - mu)` is affine in each diagonal entry, so that entry can be chosen to give the multiplier."""

    def closed(here):
        return [*rows[:-1], (rows[-1][0], here, rows[-1][2])]

    def characteristic(here):
        return (monodromy(closed(here), turn) - kind.multiplier * eye(2)).det()

    at, slope = characteristic(Fraction(0)), characteristic(Fraction(1)) - characteristic(Fraction(0))
    assume(slope != 0)
    here = Fraction(*(-at / slope).as_numer_denom())
    try:
        values = [kind.bordering(closed(h), turn) for h in (here, here + 1)]
    except ZeroDivisionError:
        assume(False)  # a pivot of the elimination vanishes

    assert values[0] == 0
    assert values[1] != 0


@pytest.mark.slow
@given(rings, st.sampled_from([1, -1]))
def test_a_torus_is_born_where_the_determinant_is_one(rows, turn):
    expected = prod((before / after for before, _, after in rows), start=Fraction(1)) - 1

    assert TORUS.bordering(rows, turn) == BifurcationKind.NEUTRAL_SADDLE.bordering(rows, turn) == expected


@pytest.mark.parametrize("kind", [BifurcationKind.BRANCH_POINT, BifurcationKind.BORDER_COLLISION])
def test_what_is_no_zero_of_one_equation_is_refused_by_its_name(kind):
    assert kind.solved is None
    with pytest.raises(ValueError, match=kind.value):
        kind.bordering([(1, 2, 3)], 1)


@settings(max_examples=10, deadline=None)
@given(st.fractions(-Fraction(1, 2), Fraction(1, 2), max_denominator=8))
def test_the_fixed_points_of_henons_map_fold_and_flip_where_they_are_known_to(b):
    """`x = 1 - a*x**2 + b*x` has a double zero at `a = -(1-b)**2/4`, and multiplier -1 at `a = 3*(1-b)**2/4`."""
    fixed, share = {"b": Rational(b.numerator, b.denominator)}, float(1 - b) ** 2 / 4
    fold = floats(critical(henon(1), [FOLD], ["a"], fixed), [2 / float(1 - b), -share - 0.01])
    flip = floats(critical(henon(1), [FLIP], ["a"], fixed), [0.6 / float(1 - b), 3 * share + 0.01])

    assert fold[-1] == pytest.approx(-share, abs=1e-12)
    assert flip[-1] == pytest.approx(3 * share, abs=1e-12)


@pytest.mark.parametrize(("kind", "expected"), [(FOLD, (1, -1, -1)), (FLIP, (Rational(1, 3), 3, -1))])
def test_two_conditions_at_once_are_solved_for_at_a_resonance(kind, expected):
    """Henon's map keeps areas at `b = -1`, where its fold ends in the 1:1 and its flip in the 1:2 resonance."""
    start = [float(x) + 0.02 for x in expected]
    found = refined(critical(henon(1), [kind, TORUS], ["a", "b"]), start, 30)

    assert all(
        abs(x - type(x).context.mpf(e.p) / e.q) < 1e-28 for x, e in zip(found.z, map(Rational, expected), strict=True)
    )


def test_a_billiards_flip_is_where_the_closed_form_puts_it():
    """The horizontal cycle of the cuspless cardioid doubles at `lambda_c` (paper, section 5.1)."""
    found = refined(critical(Chords(cuspless, (1, 0)), [FLIP], ["lam"]), [0.01, -0.01, 0.09], 30)

    assert abs(found.z[-1] - type(found.z[-1]).context.mpf(str(N(lambda_c(), 35)))) < 1e-29


def test_the_delayed_logistic_map_bears_its_torus_where_no_fold_is():
    (x, r) = floats(critical(delayed(1), [TORUS], ["r"]), [0.4, 1.9])
    rows = delayed(1).over(FLOAT64)(0, (x, x, x), {"r": r})

    assert (x, r) == pytest.approx((0.5, 2.0), abs=1e-12)
    assert abs(FOLD.bordering([rows.slope], 1)) > 0.1 < abs(FLIP.bordering([rows.slope], 1))


def test_as_many_parameters_are_free_as_there_are_conditions():
    with pytest.raises(ValueError, match="2 conditions, 1 free"):
        critical(henon(1), [FOLD, TORUS], ["a"])
