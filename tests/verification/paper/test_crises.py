"""The crises by sampling: below, no orbit leaves; above, more and more do; a finer search stays within the error."""

import math

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from verification.named.crises import KINDS, crisis, extent, narrowed, power, scaling, spread, stay, widenings
from verification.named.locate import egg_crisis
from verification.paper.claims.claim import Verdict
from verification.paper.egg.crises import distance, sides
from verification.paper.report.report import catalogue, judge
from verification.proofs.manifolds.known import SHAPE, contact


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "below", "above"), [("merging", 0.443, 0.4445), ("boundary", 0.655, 0.666)])
def test_balls_stay_below_a_crisis_and_leave_sooner_the_farther_above(kind, below, above):
    left, (_, high) = KINDS[kind]

    assert math.isinf(stay(left, "0.08", below, 10**6))
    assert stay(left, "0.08", high, 10**7) < math.inf
    assert stay(left, "0.08", above, 10**7) < math.inf


@pytest.mark.slow
def test_a_finer_search_stays_within_the_error_of_a_coarser_one():
    coarse, fine = (crisis("merging", "0.08", tolerance, 10**7) for tolerance in (2e-4, 2e-5))

    assert abs(coarse.lam - fine.lam) <= coarse.error
    assert fine.error < coarse.error


def test_the_error_reaches_up_to_where_ten_balls_left():
    assert spread([(0.5, 10.0), (0.45, 1e9)], 0.44, 0.45, 10**7) == pytest.approx(0.055)


def test_a_shape_without_the_crisis_is_one_sentence():
    with pytest.raises(ValueError, match=r"known at 0\.08"):
        crisis("boundary", "0.03", budget=10**6)


@pytest.mark.slow
def test_the_mean_stay_falls_like_a_power_of_the_distance():
    """Merging crisis: the saddle's multipliers give the exponent 0.85; the fit over 61 distances is 0.92 +- 0.11."""
    found = scaling("merging", "0.08", contact("merging", SHAPE).parameter, np.geomspace(1e-4, 3e-3, 12), 10**6)

    assert 0.3 < found.exponent < 1.6
    assert found.error > 0
    assert len(found.points) == 12


def test_a_power_needs_enough_points():
    with pytest.raises(ValueError, match="accepted: 6 or more"):
        power(((0.1, 1.0), (0.2, 2.0)))


def asymmetry(lam, balls=24):
    """The least absolute time average of an odd function, over all balls."""
    rng = np.random.default_rng(2)
    start = rng.uniform(-0.05, 0.05, (2, balls))
    map = PinballMap("egg", lam=lam, alpha="0.08")
    ball = map.exponents(start[0], start[1], 200, 4000)
    chaotic = ball.nu_plus > 0
    orbit = map.orbit(ball.theta[chaotic], ball.phi[chaotic], 4000)
    return float(np.min(np.abs(np.mean(np.sin(3 * orbit.theta[::2]), axis=0))))


def test_balls_see_the_symmetry_restored_where_the_tangency_is():
    """By sampling alone: below the tangency each orbit keeps to one mirror image, and above it visits both."""
    at = contact("symmetry-restoring", SHAPE).parameter

    assert asymmetry(at - 2e-4) > 0.05
    assert asymmetry(at + 2e-4) < 0.03


def bands_apart(lam):
    """For each chaotic ball the largest difference of mean exit angles four bounces apart, modulo eight bounces."""
    rng = np.random.default_rng(0)
    start = rng.uniform(-0.05, 0.05, (2, 24))
    map = PinballMap("egg", lam=lam, alpha="0.08")
    ball = map.exponents(start[0], start[1], 200, 4000)
    phi = map.orbit(ball.theta[ball.nu_plus > 0], ball.phi[ball.nu_plus > 0], 8000).phi
    means = np.array([phi[k::8].mean(axis=0) for k in range(8)])
    return np.max(np.abs(means[:4] - means[4:]), axis=0)


def test_balls_see_eight_bands_become_four_where_the_tangency_is():
    at = contact("band-merging", SHAPE).parameter

    assert np.min(bands_apart(at - 3e-4)) > 0.008
    assert np.median(bands_apart(at + 3e-4)) < 0.004


@pytest.mark.slow
def test_a_scan_of_extents_finds_the_one_widening_and_the_tangency_lies_where_it_is():
    """Two independent methods: the farthest points of orbits, and manifolds that touch."""
    at = contact("interior-crisis-1", SHAPE).parameter
    (step,) = widenings("0.08", np.arange(0.4265, 0.4301, 5e-4))
    low, high = narrowed("0.08", step, 2e-6)

    assert low.lam - 2e-6 < at < high.lam  # just above the crisis the orbits may miss the new part
    before, after = (extent(PinballMap("egg", lam=lam, alpha="0.08")) for lam in (at - 1e-5, at + 1e-5))
    assert after.angle > 1.02 * before.angle
    assert after.near > 1.2 * before.near
    assert after.far > 1.13 * before.far
    assert after.area > 1.5 * before.area


@pytest.mark.slow
def test_a_scan_of_extents_takes_no_window_and_no_steady_growth_for_a_widening():
    """At 0.405 and 0.42 lie windows, with the old extent after them; at 0.438 one length grows fast but steadily."""
    assert widenings("0.08", np.arange(0.4035, 0.4071, 5e-4)) == []
    assert widenings("0.08", np.arange(0.4185, 0.4226, 5e-4)) == []
    assert widenings("0.08", np.arange(0.4370, 0.4391, 5e-4)) == []


@pytest.mark.slow
@pytest.mark.parametrize(("n", "low"), [(2, 0.6275), (3, 0.6520)])
def test_a_scan_of_extents_finds_the_widenings_in_angle_alone_not_far_above_their_tangencies(n, low):
    """Just above a tangency 200,000 bounces may miss the new part, so the scan finds it a little later."""
    (step,) = widenings("0.08", np.arange(low, low + 0.0031, 5e-4))

    assert 0 < step[1].lam - contact(f"interior-crisis-{n}", SHAPE).parameter < 5e-4


@pytest.mark.slow
@pytest.mark.parametrize("n", [1, 2, 3])
def test_the_largest_exit_angle_grows_at_once_across_an_interior_crisis_and_steadily_before_it(n):
    at = contact(f"interior-crisis-{n}", SHAPE).parameter
    lams = (at - 7e-4, at - 1e-4, at + 5e-4)
    first, below, above = (extent(PinballMap("egg", lam=lam, alpha="0.08")).angle for lam in lams)

    assert below < 1.01 * first
    assert above > 1.01 * below


@pytest.mark.slow
def test_the_attractor_nears_the_boundary_of_the_period_3_basins_and_only_one_side_goes_there():
    assert distance(0.64) > 5 * distance(0.66) > 0
    assert sides(0.66) == (1.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "saddle", "letter"),
    [
        ("interior-crisis-1", "saddle of period 12", "0.42841918986809247876"),
        ("interior-crisis-2", "cycle of 4 bounces and a turn", "0.62896277067297284149"),
        ("boundary", "triangle", "0.66214427335822441948"),
        ("merging", "cycle of period 8", "0.44343524608185121825"),
    ],
)
def test_a_located_crisis_names_its_mechanism_and_what_is_not_proved(kind, saddle, letter):
    found = egg_crisis(kind, 8, SHAPE)

    assert found.checks.pop("is_the_crisis") is None
    assert found.checks == dict.fromkeys(
        ("shadowing_fold", "two_methods_agree", "tangency", "quadratic", "transversal", "strange_attractors"), True
    )
    assert saddle in found.notes["mechanism"]
    assert found.ball.overlaps(arb(letter))  # the tangency to twenty digits


@pytest.mark.slow
def test_a_cycle_that_closes_with_a_turn_has_no_certificate_and_the_tangency_is_proved_all_the_same():
    found = egg_crisis("interior-crisis-3", 8, SHAPE)

    assert {name for name, value in found.checks.items() if value is None} == {"shadowing_fold", "is_the_crisis"}
    assert found.ball.overlaps(arb("0.65345597578810961117"))  # by a fold to 22 digits
    assert found.proof.proved


@pytest.mark.slow
def test_the_boundary_crisis_is_judged_by_tangency_and_by_balls():
    (claim,) = (claim for claim in catalogue() if claim.id == "egg.boundary_crisis")
    result = judge(claim)

    assert result.verdict is Verdict.SUPPORTED
    assert "homoclinic tangency" in result.method
