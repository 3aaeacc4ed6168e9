"""A chaotic exponent, proved: every bound of the proof holds where it is sampled, and a wrong one ends the proof."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

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
from verification.proofs.slap_map.candidate import Judge, Pieces, Residual, candidate
from verification.proofs.slap_map.exponent import gap, judged, symmetric
from verification.proofs.slap_map.transfer import Branches, Inverted, Variation, inverted, spread, ulam, variation

HALF = np.pi / 2
DIGITS = 8
BITS = bits_of(DIGITS, 64) + 2 * DIGITS
GRID = np.concatenate([np.linspace(0, HALF, 40_001)[:-1], HALF - np.geomspace(1e-5, 1e-14, 50)])


@cache
def kernels():
    """Where a particle leaves, below the cusp and above it; made once, and not where nobody asks."""
    return tuple(load(branch(form), ARRAYS) for form in (False, True))


def below(x):
    return kernels()[0](x)


def above(x):
    return kernels()[1](x)


def transferred(f, x):
    """The transfer operator in floats, from the formula."""
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
    """The mean of log T0' and its standard error over independent orbits, from the float64 map."""
    map = PinballMap("cardioid", lam=0)
    starts = interior_starts(map, orbits, seed=seed)
    growth = Growth(map, starts.theta, starts.phi, starts.component)
    growth.skip(200)
    growth.advance(16)
    before = growth.stretch
    growth.advance(bounces)
    each = (growth.stretch - before) / bounces
    return each.mean(), each.std(ddof=1) / np.sqrt(orbits)


def test_the_exponent_is_proved_and_a_long_run_agrees():
    mean, error = measured(2_000, 5_000, seed=3)

    assert proof().certified
    assert set(proof().checks) == {"variation", "inverse", "gap", "mass", "precise"}
    assert proof().value.rad() < 1e-6
    assert abs(mean - float(proof().value)) < 4 * error < 1e-3


def test_more_digits_give_a_ball_within():
    with working(BITS):
        finer = judged(candidate(chaotic_exponent.DIGITS), chaotic_exponent.DIGITS, cells())

        assert finer.certified
        assert proof().value.contains(finer.value)
        assert finer.value.rad() < 1e-13


def test_ulams_matrix_by_itself_gives_the_same_exponent_to_its_own_accuracy():
    count = 1024
    matrix, mass = ulam(count), np.full(count, 1 / count)
    for _ in range(200):
        mass = matrix @ mass
    total = 0.0
    for form, low, high in ((below, -HALF, 0.0), (above, 0.0, HALF / 2)):
        step = (high - low) / 400_000
        launch, rate = form(low + step * (np.arange(400_000) + 0.5))
        total += step * np.sum(-np.log(rate) * rate * mass[(launch / HALF * count).astype(int)] * count / HALF)

    assert abs(total - float(proof().value)) < 3e-5


@settings(max_examples=4, deadline=None)
@given(st.integers(0, 24), st.integers(0, 5), st.floats(-3e-3, 3e-3))
def test_a_bad_candidate_costs_precision_and_never_truth(piece, power, off):
    polynomials = [list(p) for p in near().polynomials]
    polynomials[piece % len(polynomials)][power] += arb(off)
    spoiled = judged(Pieces(near().ends, polynomials), DIGITS, cells())

    with working(BITS):
        assert spoiled.value.contains(proof().value)
    assert spoiled.value.rad() > 0.9 * proof().value.rad()


def test_the_gap_and_the_distance_follow_from_the_inequalities_by_hand():
    known, found, inverse = variation(), proof(), cells()
    with working(BITS):
        pieces = near().grounded()
        judge = Judge(pieces, DIGITS, BITS)
        residual = judge.residual()
        apart = judge.mean() / pieces.integral() - found.value
    adds, loss, K = float(known.adds), 1 - float(known.shrinks), inverse.bound
    cell = HALF / inverse.cells
    norm, change = float(residual.norm), float(residual.variation)
    matrix, right = [[1.0, -(K + 1) * cell / 2], [-adds / loss, 1.0]], [K * norm, change / loss]
    _, distance = np.linalg.solve(matrix, right)  # of the norm and of the variation

    assert found.gap == pytest.approx(1 - adds * (K + 1) * cell / 2 / loss, rel=1e-9)
    assert float(found.distance) == pytest.approx(distance, rel=1e-6)
    assert float(apart.rad()) >= float(found.distance) * 1.5 * HALF / np.e


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


def test_the_density_of_the_whole_boundary_is_its_own_mirror_image_if_the_constants_are_right():
    odd = inverted(chaotic_exponent.MIRRORED, sign=-1)

    assert symmetric(odd, variation()) is True
    assert symmetric(odd, replace(variation(), adds=2 * variation().adds)) is None
    assert symmetric(odd, replace(variation(), proved=False)) is None
    assert symmetric(inverted(64, np.eye(64), sign=-1), variation()) is None
    assert symmetric(cells(), variation()) is None  # an inverse for vectors of sum 0 alone


def test_densities_that_the_mirror_image_negates_fade_under_the_map_of_the_float64_kernels():
    map, rng = PinballMap("cardioid", lam=0), np.random.default_rng(5)
    theta = rng.uniform(0, np.pi, 200_000)  # all in the upper half
    halves = []
    for _ in range(60):
        theta = map.step(theta, np.zeros_like(theta)).theta
        halves.append(np.mean(theta > 0))

    assert abs(halves[0] - 0.5) > 0.05
    assert abs(halves[-1] - 0.5) < 5 * 0.5 / np.sqrt(theta.size)


def test_an_inverse_that_is_off_by_a_millionth_is_noticed_and_still_gives_a_bound():
    matrix = ulam(64).toarray()
    inverse = np.linalg.inv(np.eye(64) - matrix + 1 / 64)
    exact, off = inverted(64, inverse), inverted(64, inverse * (1 + 1e-6))

    assert exact.defect < 1e-8 < 0.9e-6 < off.defect < 3e-5
    assert exact.bound <= off.bound < 1.0001 * exact.bound


@settings(max_examples=30)
@given(st.lists(st.floats(-1, 1), min_size=64, max_size=64))
@example([1.0, -1.0] + [0.0] * 62)
def test_the_bounds_of_the_inverse_hold_for_vectors_of_sum_0_and_for_odd_ones(numbers):
    vector = np.array(numbers) - np.mean(numbers)
    matrix, bound = small()
    moved = vector - matrix @ vector

    assert np.abs(vector).sum() <= bound * np.abs(moved).sum() + 1e-9

    odd, bound = mirrored()
    moved = np.array(numbers) - odd @ np.array(numbers)

    assert np.abs(numbers).sum() <= bound * np.abs(moved).sum() + 1e-9


def test_the_bound_of_the_inverse_is_at_most_twice_too_large():
    inverse = np.linalg.inv(np.eye(64) - ulam(64).toarray() + 1 / 64)
    largest = max(np.abs(inverse[:, i] - inverse[:, j]).sum() / 2 for i in range(64) for j in range(i))

    assert largest <= inverted(64).bound < 2 * largest
    assert spread(np.ones((3, 3))) == 0


def test_ulams_matrix_carries_what_the_branches_carry():
    count = 32
    points = (np.arange(400_000) + 0.5) / 400_000 * HALF / count + 5 * HALF / count  # of cell 5
    landed = np.array([abs(float(x)) for x in _landed(points[::400])])
    shares = np.histogram(landed, bins=count, range=(0, HALF))[0] / landed.size

    assert np.abs(ulam(count).toarray()[:, 5] - shares).max() < 2e-3


def _landed(launches):
    grid = np.linspace(-HALF, HALF / 2, 200_001)
    values = np.where(grid < -0.1, below(grid)[0], above(np.maximum(grid, -1.0))[0])
    return np.interp(launches, values, grid)


coefficients = st.lists(st.floats(-1, 1), min_size=1, max_size=12)


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
        rough = Pieces(near().ends, polynomials).grounded()
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
        Judge(Pieces(near().ends[:-1], near().polynomials[:-1]), DIGITS, BITS).residual()


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


KNOWN, INVERSE = Variation(arb("0.75"), arb(2), True), Inverted(1000, 9.0, 0.0, 1)


@pytest.mark.parametrize(
    ("known", "inverse", "mass", "spread_of", "open_items"),
    [
        (KNOWN, INVERSE, 2, 1e-9, set()),
        (replace(KNOWN, proved=False), INVERSE, 2, 1e-9, {"variation", "precise"}),
        (KNOWN, replace(INVERSE, sign=-1), 2, 1e-9, {"inverse", "precise"}),
        (KNOWN, replace(INVERSE, bound=None), 2, 1e-9, {"inverse", "gap", "precise"}),
        (KNOWN, replace(INVERSE, cells=60), 2, 1e-9, {"gap", "precise"}),  # 1 - 2*pi/240*10/0.25 is negative
        (KNOWN, replace(INVERSE, cells=64), 2, 1e-9, set()),
        (KNOWN, INVERSE, -2, 1e-9, {"mass", "precise"}),
        (KNOWN, INVERSE, 2, 0.02, {"precise"}),
    ],
)  # fmt: skip
def test_each_item_of_the_exponents_checklist_is_asked_and_the_ball_is_that_of_the_inequalities(
    monkeypatch, known, inverse, mass, spread_of, open_items
):
    residual = Residual(arb(spread_of), arb(spread_of) / 2)
    judge = SimpleNamespace(residual=lambda: residual, mean=lambda: arb("0.75"))
    monkeypatch.setattr(chaotic_exponent, "Judge", lambda *_: judge)
    near = SimpleNamespace(grounded=lambda: SimpleNamespace(integral=lambda: arb(mass)))
    found = judged(near, 4, inverse, known)

    assert {item for item, value in found.checks.items() if value is not True} == open_items
    assert set(found.checks) == {"variation", "inverse", "gap", "mass", "precise"}
    assert False not in found.checks.values()  # what is not proved is open
    assert found.certified is (not open_items)
    bound = inverse.bound or 0
    room = 1 - 2 * np.pi / (4 * inverse.cells) * (bound + 1) / 0.25
    distance = (2 * bound * spread_of + spread_of / 2) / (0.25 * room * mass)
    assert float(gap(inverse, known)) == pytest.approx(room)
    assert found.gap == pytest.approx(room)
    assert abs(float(found.distance)) == pytest.approx(abs(distance), rel=1e-6)
    assert float(found.value.mid()) == pytest.approx(0.75 / mass)
    assert float(found.value.rad()) == pytest.approx(abs(distance) * 3 * np.pi / (4 * np.e), rel=1e-6)


def test_densities_are_their_own_mirror_images_only_by_an_inverse_for_odd_ones_with_room():
    odd = replace(INVERSE, sign=-1)
    assert symmetric(odd, KNOWN) is True
    for inverse, known in ((INVERSE, KNOWN), (replace(odd, bound=None), KNOWN), (odd, replace(KNOWN, proved=False))):
        assert symmetric(inverse, known) is None
    assert symmetric(replace(odd, cells=60), KNOWN) is None
