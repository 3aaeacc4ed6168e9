"""A proved chaotic exponent: each bound of the proof holds at samples, and a wrong bound is refused."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from flint import arb
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from numeric import PinballMap
from numeric.pinball.sampling import Growth, interior_starts
from symbolic.cycles.cardioid_slap import branch
from symbolic.expressions.text import load
from verification.arithmetic.balls import ARRAYS, bits_of, working
from verification.arithmetic.series import expanded
from verification.proofs.slap_map import exponent as chaotic_exponent
from verification.proofs.slap_map.candidate import Judge, PiecewisePolynomial, candidate
from verification.proofs.slap_map.exponent import judged, symmetric
from verification.proofs.slap_map.transfer import GRAIN, Branches, inverted, largest, spread, ulam, variation

HALF = np.pi / 2
DIGITS = 8
BITS = bits_of(DIGITS, 64) + 2 * DIGITS
GRID = np.concatenate([np.linspace(0, HALF, 40_001)[:-1], HALF - np.geomspace(1e-5, 1e-14, 50)])


@cache
def kernels():
    """The launching points below and above the cusp as functions on arrays, loaded once."""
    return tuple(load(branch(form), ARRAYS) for form in (False, True))


def below(x):
    return kernels()[0](x)


def above(x):
    return kernels()[1](x)


def transferred(f, x):
    """The transfer operator of a function `f` at `x`, in floats, from its formula."""
    launch, rate = below(-x)
    first = rate * f(launch)
    inside = np.minimum(x, HALF / 2 - 1e-15)
    launch, rate = above(inside)
    return first + np.where(x < HALF / 2, rate * f(launch), 0)


@cache
def proof():
    return judged(near(), DIGITS, cells())


@cache
def cells():
    return inverted(chaotic_exponent.CELLS)


@cache
def small():
    return ulam(64), inverted(64).bound


@cache
def mirrored():
    return ulam(64, sign=-1), inverted(64, sign=-1).bound


@cache
def near():
    return candidate(DIGITS)


def in_floats(pieces):
    ends = np.array([float(end) for end in pieces.ends])
    coefficients = [[float(c) for c in polynomial] for polynomial in pieces.polynomials]

    def value(y):
        k = np.clip(np.searchsorted(ends, y, side="right") - 1, 0, len(coefficients) - 1)
        z = (2 * y - ends[k] - ends[k + 1]) / (ends[k + 1] - ends[k])
        total = np.zeros_like(y)
        for piece, polynomial in enumerate(coefficients):
            here = k == piece
            total[here] = np.polynomial.polynomial.polyval(z[here], polynomial)
        return total

    return value


def measured(orbits, bounces, seed):
    """The mean of log T0' over independent float64 orbits, and its standard error."""
    map = PinballMap("cardioid", lam=0)
    starts = interior_starts(map, orbits, seed=seed)
    growth = Growth(map, starts.theta, starts.phi, starts.component)
    growth.skip(200)
    growth.advance(16)
    before = growth.stretch
    growth.advance(bounces)
    each = (growth.stretch - before) / bounces
    return each.mean(), each.std(ddof=1) / np.sqrt(orbits)


@pytest.mark.slow
def test_the_exponent_is_proved_and_a_long_run_agrees():
    mean, error = measured(2_000, 5_000, seed=3)

    assert proof().certified
    assert set(proof().checks) == {"variation", "inverse", "gap", "mass", "precise"}
    assert proof().value.rad() < 1e-6
    assert abs(mean - float(proof().value)) < 4 * error < 1e-3


@pytest.mark.slow
def test_more_digits_give_a_ball_within():
    with working(BITS):
        finer = judged(candidate(chaotic_exponent.DIGITS), chaotic_exponent.DIGITS, cells())

        assert finer.certified
        assert proof().value.contains(finer.value)
        assert finer.value.rad() < 1e-13


@pytest.mark.slow
@settings(max_examples=4, deadline=None)
@given(st.integers(0, 24), st.integers(0, 5), st.floats(-3e-3, 3e-3))
def test_a_bad_candidate_costs_precision_and_never_truth(piece, power, off):
    polynomials = [list(p) for p in near().polynomials]
    polynomials[piece % len(polynomials)][power] += arb(off)
    spoiled = judged(PiecewisePolynomial(near().ends, polynomials), DIGITS, cells())

    with working(BITS):
        assert spoiled.value.contains(proof().value)
    assert spoiled.value.rad() > 0.9 * proof().value.rad()


@pytest.mark.parametrize(
    ("wrong", "items"),
    [
        ({"adds": 3}, {"gap", "precise"}),
        ({"shrinks": arb("0.95")}, {"gap", "precise"}),
        ({"proved": False}, {"variation", "precise"}),
    ],
)
def test_a_wrong_inequality_ends_the_proof(wrong, items):
    known = variation()
    if "adds" in wrong:  # so many times what is right
        wrong = {"adds": wrong["adds"] * known.adds}
    found = judged(near(), DIGITS, cells(), replace(known, **wrong))

    assert {name for name, value in found.checks.items() if value is None} == items
    assert not found.certified


def test_too_few_cells_or_a_bad_inverse_end_the_proof():
    few = judged(near(), DIGITS, inverted(512))
    bad = inverted(64, np.eye(64))

    assert few.checks["inverse"] is True
    assert few.checks["gap"] is None
    assert bad.bound is None
    assert judged(near(), DIGITS, bad).checks["inverse"] is None


def test_the_density_is_its_own_mirror_image():
    odd = inverted(chaotic_exponent.MIRRORED, sign=-1)

    assert symmetric(odd, variation()) is True
    assert symmetric(odd, replace(variation(), adds=2 * variation().adds)) is None
    assert symmetric(odd, replace(variation(), proved=False)) is None
    assert symmetric(inverted(64, np.eye(64), sign=-1), variation()) is None
    assert symmetric(cells(), variation()) is None  # an inverse for vectors of sum 0 alone


@settings(max_examples=30)
@given(st.lists(st.floats(-1, 1), min_size=64, max_size=64))
@example([1.0, -1.0] + [0.0] * 62)
def test_the_bounds_of_the_inverse_hold(numbers):
    vector = np.array(numbers) - np.mean(numbers)
    matrix, bound = small()
    moved = vector - matrix @ vector

    assert np.abs(vector).sum() <= bound * np.abs(moved).sum() + 1e-9

    odd, bound = mirrored()
    moved = np.array(numbers) - odd @ np.array(numbers)

    assert np.abs(numbers).sum() <= bound * np.abs(moved).sum() + 1e-9


coefficients = st.lists(st.floats(-1, 1), min_size=1, max_size=12)


@pytest.mark.slow
@settings(max_examples=40)
@given(coefficients)
@example([0.0] * 11 + [1.0])
def test_no_function_sampled_breaks_the_inequality_of_variations(numbers):
    known = variation()

    def f(y):
        return sum(c * np.cos((2 * k + 1) * y) for k, c in enumerate(numbers))

    changed, own = np.abs(np.diff(transferred(f, GRID))).sum(), np.abs(np.diff(f(GRID))).sum()
    size = np.trapezoid(np.abs(f(GRID)), GRID)

    assert changed <= float(known.shrinks) * own + float(known.adds) * size + 1e-9


def test_the_bounds_of_a_residual_hold_and_are_not_ten_times_too_large():
    polynomials = [list(p) for p in near().polynomials]
    polynomials[3][2] += arb(1e-3)
    polynomials[-2][1] += arb(2e-3)
    with working(BITS):
        rough = PiecewisePolynomial(near().ends, polynomials).grounded()
        bounds = Judge(rough, DIGITS, BITS).residual()
    f = in_floats(rough)
    values = transferred(f, GRID) - f(GRID)
    size, change = np.trapezoid(np.abs(values), GRID), np.abs(np.diff(values)).sum()

    assert size <= float(bounds.norm) < 10 * size
    assert change <= float(bounds.variation) < 10 * change


def test_the_mean_of_the_logarithm_is_that_of_a_quadrature():
    f = in_floats(near())

    def integrand(x):
        launch, rate = below(-x)
        return float(-np.log(rate) * rate * f(np.atleast_1d(launch))[0])

    def other(x):
        launch, rate = above(x)
        return float(-np.log(rate) * rate * f(np.atleast_1d(launch))[0])

    with working(BITS):
        mean = Judge(near(), DIGITS, BITS).mean()
    truth = quad(integrand, 0, HALF, limit=400, epsabs=1e-11)[0] + quad(other, 0, HALF / 2, limit=400, epsabs=1e-11)[0]

    assert abs(float(mean) - truth) < 1e-8
    assert mean.rad() < 1e-6


def test_pieces_that_do_not_reach_the_cusp_are_refused():
    with working(BITS), pytest.raises(ValueError, match="they must reach from 0 to beyond pi/2"):
        Judge(PiecewisePolynomial(near().ends[:-1], near().polynomials[:-1]), DIGITS, BITS).residual()


@given(st.floats(-2, 2), st.floats(1e-3, 0.5), st.floats(0, 1))
def test_an_expansion_holds_the_function_its_slope_and_its_integral(start, length, part):
    low, high = arb(start), arb(start) + arb(length)
    with working(128):
        high = high.mid()
        found = expanded(lambda x: x.sin() * x.exp(), low, high, 20)
        at = low + (high - low) * arb(part)
        anti = [x.exp() * (x.sin() - x.cos()) / 2 for x in (low, high)]

        assert abs(at.sin() * at.exp()) <= found.size()
        assert abs((at.sin() + at.cos()) * at.exp()) <= found.slope()
        assert found.integral().overlaps(anti[1] - anti[0])
        assert found.integral().rad() < 1e-15


def test_the_branches_are_the_slap_map_of_the_float64_kernels():
    map = PinballMap("cardioid", lam=0)
    at = Branches(64)
    for launch in (0.05, 0.3, 0.7, 1.2, 1.5):
        landed = map.step(2 * launch, 0.0)
        half = float(landed.theta) / 2
        with working(64):
            found, rate = at(arb(half))
        slope = abs(float(map.derivative(2 * launch, 0.0)[0, 0])) * np.cos(launch) / np.cos(half)

        assert abs(float(found) - launch) < 1e-13
        assert abs(1 / float(rate) - slope) < 1e-9 * slope


@pytest.mark.parametrize("sign", [1, -1])
def test_rounding_counts_in_the_defect_of_an_inverse(sign):
    """Launching points are off by at most one grain, which moves twice that mass in each entry of a column."""
    cells = 64
    found, matrix = inverted(cells, sign=sign), ulam(cells, sign)
    identity = np.eye(cells)
    inverse = np.linalg.inv(identity - matrix.toarray() + (1 / cells if sign == 1 else 0))
    size = (spread if sign == 1 else largest)(inverse)
    own = inverted(cells, inverse, sign)

    assert own.defect > 2 * 1.5 * cells / GRAIN * size * 0.99
    assert own.defect > (spread if sign == 1 else largest)(identity - inverse @ (identity - matrix.toarray()))
    assert own.bound >= size / (1 - own.defect)
    assert found.bound == pytest.approx(own.bound, rel=1e-3)
