"""Inputs of the judges, by second methods: orbits of the map and cycles in float64; and false claims that fail."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from numeric import PinballMap
from symbolic import Scene
from symbolic.cycles.defocusing import away, least_stretch
from symbolic.cycles.splitting import least_rate
from symbolic.expressions.signs import Outcome
from symbolic.tables.table import alpha as shape_letter
from symbolic.tables.table import lam
from verification.paper.claims.claim import Verdict
from verification.paper.egg import barriers as on_barriers
from verification.paper.egg import expanding, merging
from verification.paper.egg import nearly_round as on_round
from verification.paper.egg.barriers import barrier
from verification.paper.egg.egg import side_cascade
from verification.paper.judges import attractors as on_attractors
from verification.paper.judges import exponents as on_exponents
from verification.paper.judges import located as on_contraction
from verification.paper.judges.exponents import uneven, visited
from verification.paper.judges.hyperbolicity import bounced, ends_of_period
from verification.paper.report.report import catalogue
from verification.proofs.global_dynamics.images import PinballImages
from verification.rigorous.absorbing import kept_apart

CLAIMS = {claim.id: claim for claim in catalogue()}


def test_the_cycle_of_ten_bounces_beyond_the_crisis_has_three_images_since_it_is_a_mirror_image_of_itself():
    """By the kernel: a turn gives another cycle, and the mirror image is among the three turned ones."""
    map = PinballMap("egg", lam=on_barriers.WINDOW, alpha=on_barriers.SHAPE)
    orbit = map.orbit(*on_barriers.STAYS, 1000 + on_barriers.LONG)
    theta, phi = orbit.theta[-on_barriers.LONG :].ravel(), orbit.phi[-on_barriers.LONG :].ravel()
    place = np.exp(1j * theta)

    def gap(sign: int, turns: int) -> float:
        image = np.exp(1j * (sign * theta[0] + turns * 2 * np.pi / 3))
        return float(np.min(np.abs(image - place) + np.abs(sign * phi[0] - phi)))

    assert [gap(1, k) < 1e-9 for k in range(3)] == [True, False, False]
    assert sum(gap(-1, k) < 1e-9 for k in range(3)) == 1
    assert "six" not in on_barriers.beyond(CLAIMS["egg.after_crisis"]).derived


def test_cones_that_are_too_wide_and_a_width_that_is_not_the_eggs_prove_nothing():
    assert not on_round.invariant_curve((1 - on_round.MOST) / 2)
    assert not on_round.double_normals(8 * shape_letter**2)


@pytest.mark.parametrize("turn", [0.3, 1.7])
def test_in_a_nearly_round_egg_every_orbit_comes_to_a_double_normal(turn):
    """By the kernel, at `alpha = 0.02`, `lam = 1/2`: in the end the chords are normal at both ends."""
    rng = np.random.default_rng(1)
    theta, phi = turn + rng.uniform(-1, 1, 50), rng.uniform(-1.5, 1.5, 50)
    end = PinballMap("egg", lam="1/2", alpha="0.02").exponents(theta, phi, 10, 20_000)

    assert np.max(np.abs(end.phi)) < 1e-12
    assert np.max(np.abs(np.sin(3 * end.theta))) < 1e-6  # the symmetric diameters


def test_the_loose_map_is_the_map_when_it_is_solved_to_the_end():
    map = PinballMap("egg", lam="0.4", alpha="0.08")
    orbit = map.orbit(np.array([0.3, -2.0]), np.array([0.2, -0.4]), 3)
    theta, phi = orbit.theta[0], orbit.phi[0]

    for k in (1, 2, 3):
        theta, phi = bounced(theta, phi, np.array([0.4]), 0.08, 1e-13)
        assert np.allclose(theta, orbit.theta[k], atol=1e-11)
        assert np.allclose(phi, orbit.phi[k], atol=1e-11)


def test_an_orbit_that_is_back_after_its_period_ends_nothing_and_one_that_is_not_ends_it():
    """The egg's triangle attracts from the fold at 0.378 on; below the fold there is no cycle of period 3."""
    lams = np.array([0.37, 0.45, 0.5])
    (ends,) = ends_of_period(3, lams, 0.08, [1e-12], (1.1, 0.3), 500, 1e-6)

    assert list(ends) == [0.37]
    (others,) = ends_of_period(2, lams, 0.08, [1e-12], (1.1, 0.3), 500, 1e-6)
    assert list(others) != list(ends)


SINGLE, GROWS = CLAIMS["egg.single_expands"], CLAIMS["egg.attractor_expands"]


def test_what_attracts_is_not_single_in_a_window_and_what_is_kept_expands():
    assert expanding.single_expands(SINGLE).verdict is Verdict.CORRECTED
    assert expanding.attractor_expands(GROWS).verdict is Verdict.SUPPORTED
    reach = expanding.reach()
    for at in reach:  # a second method: what orbits from `phi = 0` come to in 3000 bounces
        map = PinballMap("egg", lam=at, alpha="0.08")
        seen = np.max(np.abs(map.orbit(np.linspace(-3, 3, 400), np.zeros(400), 3000).phi))
        assert seen < np.max(barrier(at).heights)
        assert reach[at] < np.max(barrier(at).heights)


def test_the_side_cascades_are_certified_and_lie_below_the_first():
    """The paper's cascade accumulates at 0.39352, and gaps of a cascade shrink by Feigenbaum's ratio, 4.669."""
    for period, born in ((12, 0.3731216), (8, 0.3798749)):
        first, second = side_cascade(period)

        assert first.proved
        assert second.proved
        assert first.supercritical
        assert second.supercritical
        assert float(first.value.mid()) == pytest.approx(born, abs=1e-7)
        assert 0 < float((second.value - first.value).mid()) < 1e-3


COARSE = (3072, 1024, 2)


@pytest.mark.parametrize(("lam", "held"), [("0.44345", True), ("0.442", False)])
def test_an_orbit_goes_over_above_the_crisis_and_does_not_from_the_same_start_below(lam, held):
    """The start is within 0.02 of the diameter; a start farther away proves nothing."""
    assert merging.goes_over(lam, merging.START) is held
    assert not merging.goes_over(lam, (0.03, 0.0))


@pytest.mark.parametrize(
    ("lam", "grid", "held"),
    [
        (("0.428", "0.429"), COARSE, True),
        (("0.428", "0.429"), (192, 64, 1), False),  # boxes that meet those of another diameter
        (("0.428", "0.429"), (3071, 1024, 2), False),  # a turn by a third is no whole number of columns
        (("0.45", "0.45"), (6144, 4096, 2), False),  # beyond the crisis
        (("0.43", "0.45"), COARSE, False),  # a range with the crisis in it
    ],
)
def test_regions_are_kept_apart_below_the_crisis_and_with_boxes_that_are_small_enough(lam, grid, held):
    """The last of these statements is false, and is not proved."""
    assert bool(merging.region(lam, grid)) is held


def test_a_region_that_is_kept_apart_holds_its_start_and_stays_near_both_ends():
    """Some cells lie next to each end, at 0 and at half a turn, and none is more than 0.6 radians away."""
    map = PinballImages(Scene("egg", alpha="0.08"), (Fraction(43, 100), Fraction(43, 100)))
    angles = kept_apart(map, COARSE, merging.about())
    assert angles is not None
    away = np.abs(np.arcsin(np.sin(angles)))
    assert [np.min(away[np.cos(angles) * side > 0]) < 0.01 for side in (1, -1)] == [True, True]
    assert np.max(away) < 0.6
    assert kept_apart(map, COARSE, None) is None


def test_every_orbit_of_the_cardioid_stretches_as_much_as_is_proved_and_keeps_off_the_cusp_every_second_bounce():
    """`|ds_n|` along 200 float64 orbits, from derivative matrices, against the proved lower bound."""
    from numeric import PinballMap
    from numeric.pinball.sampling import phase_starts

    for share in (Rational(0), Rational(1, 2), Rational(9, 10)):
        map = PinballMap("cardioid", lam=str(share))
        start = phase_starts(map, 200, 3)
        orbit = map.orbit(start.theta, 0 * start.phi if share == 0 else start.phi, 40)
        vector = np.stack([np.ones(200), np.zeros(200)])
        corner = np.cos(orbit.theta / 2)
        assert np.all(np.maximum(corner[1:-1], corner[2:]) >= float(away().subs(lam, share)))
        for n in range(1, 21):
            step = map.derivative(orbit.theta[n - 1], orbit.phi[n - 1])
            vector = np.einsum("...ij,j...->i...", step, vector)
            if n >= 2:
                assert np.all(np.abs(vector[0]) >= float(least_stretch(n).subs(lam, share).n()))


def test_balls_for_one_number_agree_disagree_or_are_too_wide():
    assert on_exponents.agree(arb("0.5"), arb("0.5")).outcome is Outcome.PROVED
    assert on_exponents.agree(arb("0.5"), arb("0.6")).outcome is Outcome.REFUTED
    assert on_exponents.agree(arb("0.5", 1), arb("0.6")).outcome is Outcome.UNKNOWN


def test_the_certified_cycle_has_the_determinant_that_its_angles_give():
    """Against the sum rule on float64 angles."""
    from numeric import PinballMap
    from numeric.dynamics.phase_points import phase_points
    from numeric.dynamics.recognition import polished

    map = PinballMap("cardioid", lam="0.9")
    phi = [-0.484, 0.051, -1.126, -1.151, -1.098, -1.034, -0.962, -0.877, -0.759]
    cycle = polished(map, phase_points(on_contraction.NINE, phi))
    eta = np.abs(cycle.points.phi) / 0.9
    _, determinant = on_contraction.expanding_cycle()

    assert np.prod(0.9 * np.cos(0.9 * eta) / np.cos(eta)) == pytest.approx(float(determinant.mid()), rel=1e-9)


def test_elastic_orbits_fill_phase_space_evenly_and_damped_ones_do_not():
    counts = visited("cardioid", (0.5, 1.0), 8, 4000)

    assert uneven(counts[1]) < 0.1 < uneven(counts[0])
    assert counts.sum() == 2 * 8 * 4001


def test_no_triangle_attracts_from_below_its_fold_on():
    """The triangle is born in a fold at 0.28264: a range that starts below it has a part without a proof."""
    low, high, after = (Fraction(k, 1000) for k in (282, 300, 284))
    assert on_attractors.triangles_attract(low, high).outcome is Outcome.UNKNOWN
    assert on_attractors.triangles_attract(after, high).outcome is Outcome.PROVED


def returns(contraction, balls=200, bounces=60):
    """Returns to the arc after one or two bounces: `y` for both edges of the cone, and growth of widths over `D`."""
    map = PinballMap("cuspless", lam=contraction)
    rng = np.random.default_rng(3)
    orbit = map.orbit(rng.uniform(-2, 2, balls), rng.uniform(-0.3, 0.3, balls), bounces)
    edges, growth = [], []
    for i in range(5, bounces - 2):
        here = orbit.component[i] == 0
        c = np.cos(orbit.theta[i] / 2)
        for y in (1.0, 1.0 + contraction):
            vector = np.stack([np.ones(balls), (1 - y) * 3 / (4 * c)], axis=-1)
            wide, at = 3 / (4 * c), np.array(here)
            for k in range(i, i + 2):
                matrix = map.derivative(orbit.theta[k], orbit.phi[k], orbit.component[k])
                vector = np.einsum("nij,nj->ni", matrix, vector)
                landed = at & (orbit.component[k + 1] == 0)
                bend = 3 / (4 * np.cos(orbit.theta[k + 1] / 2))
                edges += list((1 - vector[:, 1] / (vector[:, 0] * bend))[landed])
                growth += list(np.abs(vector[:, 0] * bend / wide)[landed])
                at &= ~landed
    return np.array(edges), np.array(growth)


@pytest.mark.parametrize("contraction", [0.05, 0.3, 0.6, 0.9])
def test_every_return_to_the_arc_maps_the_cone_strictly_into_itself(contraction):
    edges, _ = returns(contraction)

    assert edges.size > 10_000
    assert np.min(edges) > 1
    assert np.max(edges) < 1 + contraction


@pytest.mark.parametrize("contraction", [0.6, 0.75, 0.9])
def test_above_16_27_every_return_widens_the_beams_by_what_is_proved(contraction):
    _, growth = returns(contraction)

    assert np.min(growth) >= float(np.exp(2 * float(least_rate().subs(lam, contraction))))


def test_below_5_27_a_return_may_narrow_them():
    assert np.min(returns(0.15)[1]) < 1
