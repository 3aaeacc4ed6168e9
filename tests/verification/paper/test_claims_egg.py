"""The judges of the egg's attractors and of named values, driven to each verdict that they can reach."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import alpha as shape_letter
from verification.named.locate import locate
from verification.paper.claims.claim import Verdict
from verification.paper.egg import barriers as on_barriers
from verification.paper.egg import basins as on_basins
from verification.paper.egg import elastic as on_elastic
from verification.paper.egg import nearly_round as on_round
from verification.paper.egg import period2 as on_egg_period2
from verification.paper.egg import period3 as on_egg_period3
from verification.paper.egg import stability as judged
from verification.paper.judges import attractors as on_attractors
from verification.paper.judges import ellipse as on_circle
from verification.paper.judges import located as on_located
from verification.paper.report.report import catalogue
from verification.proofs.slap_map import exponent as slap_critical
from verification.proofs.slap_map.exponent import PeriodicPoints, one_zero

CLAIMS = {claim.id: claim for claim in catalogue()}
UNKNOWN = Finding(Outcome.UNKNOWN, "no proof")
PROVED = Finding(Outcome.PROVED, "a proof")


def test_a_flip_is_called_subcritical_by_its_normal_form_and_not_by_the_words_beside_it(monkeypatch):
    claim = CLAIMS["cuspless.unstable_period4"]
    flip = locate("lambda-c", 10)
    assert on_located.unstable_period4(claim).verdict is Verdict.CONFIRMED

    silent = replace(flip, notes={})
    monkeypatch.setattr(on_located, "located", lambda *_, **__: silent)
    assert on_located.unstable_period4(claim).verdict is Verdict.CONFIRMED

    fold = locate("saddle-node", 10, alpha=Rational(2, 25)).proof  # it has no such sign
    wordy = replace(flip, notes={"kind": "subcritical: an unstable cycle is born"}, proof=fold)
    monkeypatch.setattr(on_located, "located", lambda *_, **__: wordy)
    assert on_located.unstable_period4(claim).verdict is Verdict.OPEN


def test_period_8_has_doubled_at_panel_b_and_would_not_have_a_little_below(monkeypatch):
    claim = CLAIMS["egg.figure_attractors"]
    monkeypatch.setattr(judged, "attracting_4", lambda: PROVED)
    found = judged.figure_attractors(claim)
    assert found.verdict is Verdict.CORRECTED
    assert "period 16 attracts at lam = 39/100" in found.mended.reason

    eight, sixteen = judged.cycles_at(Rational(38, 100))
    assert not eight
    assert not sixteen

    monkeypatch.setattr(judged, "cycles_at", lambda _: (PROVED, UNKNOWN))
    assert judged.figure_attractors(claim).verdict is Verdict.REFUTED
    monkeypatch.setattr(judged, "cycles_at", lambda _: (UNKNOWN, PROVED))
    assert judged.figure_attractors(claim).verdict is Verdict.OPEN


def test_a_cascade_with_a_rung_that_bears_no_stable_cycle_is_not_supported(monkeypatch):
    found = judged.accumulation(Rational(2, 25), 6)
    monkeypatch.setattr(judged, "accumulation", lambda *_: found)
    judgement = judged.cascade_limit(CLAIMS["egg.cascade"])
    assert judgement.verdict is Verdict.SUPPORTED
    assert "+-" in judgement.derived

    monkeypatch.setattr(judged, "accumulation", lambda *_: replace(found, supercritical=False))
    assert judged.cascade_limit(CLAIMS["egg.cascade"]).verdict is Verdict.OPEN


def test_beyond_the_crisis_a_third_attractor_corrects_it_and_without_one_it_stays_open(monkeypatch):
    claim = CLAIMS["egg.after_crisis"]
    assert on_barriers.beyond(claim).verdict is Verdict.CORRECTED

    monkeypatch.setattr(on_barriers, "bounces", lambda *_: None)
    on_barriers.window.cache_clear()
    assert on_barriers.beyond(claim).verdict is Verdict.OPEN
    on_barriers.window.cache_clear()


def test_the_basins_are_parted_by_a_barrier_and_what_is_said_of_a_chaotic_attractor_between_is_sampled(monkeypatch):
    """A barrier says neither that one chaotic attractor takes all that lies below it, nor that it ends with it."""
    judges = {
        on_barriers.above_below: ("egg.basins_above_below", Verdict.CONFIRMED),
        on_barriers.separate: ("egg.basins_separate", Verdict.SUPPORTED),
        on_barriers.crisis_below: ("egg.crisis_below", Verdict.SUPPORTED),
    }
    for judge, (name, verdict) in judges.items():
        assert judge(CLAIMS[name]).verdict is verdict

    monkeypatch.setattr(on_barriers, "divided", lambda: Finding(Outcome.UNKNOWN, ""))
    for judge, (name, _) in judges.items():
        assert judge(CLAIMS[name]).verdict is Verdict.OPEN


def test_the_cycle_of_ten_bounces_beyond_the_crisis_has_three_images_since_it_is_a_mirror_image_of_itself():
    """By the kernel: turned it is another cycle, and its mirror image is one of the three."""
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


def test_localised_and_delocalised_chaos_are_told_apart(monkeypatch):
    claim = CLAIMS["egg.figure_chaos"]
    assert on_attractors.figure_chaos(claim).verdict is Verdict.SUPPORTED

    seen = on_attractors.egg("0.45")
    monkeypatch.setattr(on_attractors, "egg", lambda *_: seen)
    assert on_attractors.figure_chaos(claim).verdict is Verdict.OPEN


@pytest.mark.parametrize(("share", "wanted"), [(0.5, Verdict.SUPPORTED), (0.0, Verdict.OPEN), (1.0, Verdict.OPEN)])
def test_a_mixed_phase_space_needs_orbits_that_are_chaotic_and_orbits_that_are_not(monkeypatch, share, wanted):
    monkeypatch.setattr(on_elastic, "chaotic_shares", lambda _: [("0.05", share)])

    assert on_elastic.elastic_mixed(CLAIMS["egg.elastic_mixed"]).verdict is wanted


def test_a_wrong_closed_form_of_the_circles_orbit_fails_its_induction(monkeypatch):
    assert on_circle.converges(CLAIMS["circle.converges"]).verdict is Verdict.CONFIRMED

    right = on_circle.after
    monkeypatch.setattr(on_circle, "after", lambda n: (right(n)[0] + n * on_circle.phi, right(n)[1]))
    assert on_circle.converges(CLAIMS["circle.converges"]).verdict is not Verdict.CONFIRMED


@pytest.mark.parametrize(("count", "wanted"), [(4, Verdict.CONFIRMED), (5, Verdict.OPEN)])
def test_no_period_4_needs_as_many_stretches_as_the_two_orbits_of_period_2_have_ends(monkeypatch, count, wanted):
    monkeypatch.setattr(on_basins, "points_of_period_4", lambda: PeriodicPoints([(0, 0.0, 1.0)] * count, 9))

    assert on_basins.slap_no_period4(CLAIMS["cuspless.slap_no_period4"]).verdict is wanted


def test_six_critical_points_need_the_proof_that_the_slope_vanishes_once(monkeypatch):
    claim = CLAIMS["egg.slap_critical_points"]
    assert on_egg_period2.critical_points(claim).verdict is Verdict.CORRECTED

    monkeypatch.setattr(on_egg_period2, "crossings", lambda: one_zero(budget=10))
    assert on_egg_period2.critical_points(claim).verdict is Verdict.REFUTED


def test_a_centre_of_curvature_that_crossed_the_other_way_would_not_pass(monkeypatch):
    assert one_zero().proved

    wrong = -slap_critical.centre_beyond_boundary()
    monkeypatch.setattr(slap_critical, "centre_beyond_boundary", lambda: wrong)
    assert one_zero(budget=2000).proved is None


def test_the_side_of_the_fold_is_not_proved_of_a_margin_with_the_wrong_sign(monkeypatch):
    assert all(on_egg_period3.side_of_fold())

    wrong = -on_egg_period3.fold_margin()
    monkeypatch.setattr(on_egg_period3, "fold_margin", lambda: wrong)
    assert not all(on_egg_period3.side_of_fold.__wrapped__())


def test_a_triangle_that_is_not_elliptic_at_lambda_one_is_not_said_to_attract_below_it(monkeypatch):
    claim = CLAIMS["egg.period3_attracting"]
    assert on_egg_period3.attracting(claim).verdict is Verdict.CONFIRMED

    at_vertices = on_egg_period3.elastic_trace(False)
    monkeypatch.setattr(on_egg_period3, "elastic_trace", lambda _: at_vertices)
    assert on_egg_period3.attracting(claim).verdict is not Verdict.CONFIRMED


def test_the_vertices_that_an_attractor_comes_near_are_counted_modulo_a_turn():
    points = SimpleNamespace(theta=np.array([2 * np.pi / 3, -4 * np.pi / 3 + 0.1, np.pi / 3]))

    assert on_attractors.vertices(SimpleNamespace(points=points)) == {1}


def test_nearly_round_eggs_are_proved_and_one_bound_for_every_contraction_is_not(monkeypatch):
    """The proof's `alpha0` goes to 0 as `lam` goes to 1, and is no number."""
    claim = CLAIMS["egg.periodic_only_near_zero"]
    assert on_round.settles()
    assert on_round.periodic_only(claim).verdict is Verdict.SUPPORTED

    monkeypatch.setattr(on_round, "settles", lambda: Finding(Outcome.UNKNOWN, ""))
    assert on_round.periodic_only(claim).verdict is Verdict.OPEN


def test_smooth_boundaries_of_basins_rest_on_the_figure_and_on_nearly_round_eggs(monkeypatch):
    claim, edge = CLAIMS["map.smooth_basin_boundaries"], on_round.edge()
    assert on_round.smooth_boundaries(claim).verdict is Verdict.CONFIRMED

    monkeypatch.setattr(on_round, "edge", lambda: replace(edge, radius=0.03))
    assert on_round.smooth_boundaries(claim).verdict is Verdict.OPEN

    monkeypatch.setattr(on_round, "edge", lambda: edge)
    monkeypatch.setattr(on_round, "settles", lambda: Finding(Outcome.UNKNOWN, ""))
    assert on_round.smooth_boundaries(claim).verdict is Verdict.OPEN


def test_strips_of_both_basins_next_to_a_stable_manifold_are_what_intermingled_says(monkeypatch):
    claim = CLAIMS["cuspless.basins_intermingled"]
    assert on_basins.cuspless_intermingled(claim).verdict is Verdict.CONFIRMED

    turned = replace(on_basins.alternating(), starts=on_basins.alternating().starts[::-1])
    monkeypatch.setattr(on_basins, "alternating", lambda: turned)
    assert on_basins.cuspless_intermingled(claim).verdict is Verdict.OPEN


def test_cones_that_are_too_wide_and_a_width_that_is_not_the_eggs_prove_nothing():
    assert not on_round.invariant_curve((1 - on_round.MOST) / 2)
    assert not on_round.double_normals(8 * shape_letter**2)


@pytest.mark.parametrize("turn", [0.3, 1.7])
def test_in_a_nearly_round_egg_every_orbit_comes_to_a_double_normal(turn):
    """By the kernel, at `alpha = 0.02`, `lam = 1/2`: the chords that are left are normal at both ends."""
    rng = np.random.default_rng(1)
    theta, phi = turn + rng.uniform(-1, 1, 50), rng.uniform(-1.5, 1.5, 50)
    end = PinballMap("egg", lam="1/2", alpha="0.02").exponents(theta, phi, 10, 20_000)

    assert np.max(np.abs(end.phi)) < 1e-12
    assert np.max(np.abs(np.sin(3 * end.theta))) < 1e-6  # the symmetric diameters
