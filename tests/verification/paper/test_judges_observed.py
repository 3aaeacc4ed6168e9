"""Canaries: the judges of what simulations of the cardioids show, and of domains, driven to other verdicts."""

from dataclasses import replace

import numpy as np
import pytest
from sympy import S

from symbolic.expressions.signs import Finding, Outcome
from verification.paper.claims.claim import Verdict
from verification.paper.judges import cardioid_attractor as on_observed
from verification.paper.judges import cuspless as on_domains
from verification.paper.judges import cuspless_chaos as on_chaos
from verification.paper.judges import ellipse as on_ellipse
from verification.paper.judges import ellipse_stability as on_ellipse_stability
from verification.paper.judges.exponents import Spectrum
from verification.paper.report.report import catalogue

CLAIMS = {claim.id: claim for claim in catalogue()}
UNPROVED = Finding(Outcome.UNKNOWN, "not proved")


def verdict(judge, name):
    return judge(CLAIMS[name]).verdict


def test_a_period_4_orbit_could_be_stable_because_the_coefficient_changes_sign(monkeypatch):
    assert verdict(on_observed.stable_if_flatter, "cuspless.stable_if_flatter") is Verdict.CONFIRMED

    monkeypatch.setattr(on_observed, "coefficient", lambda: (S.One, S.One))
    assert verdict(on_observed.stable_if_flatter, "cuspless.stable_if_flatter") is not Verdict.CONFIRMED


def test_what_leaves_the_join_below_lambda_star_converges_by_all_of_the_proof(monkeypatch):
    assert verdict(on_chaos.below_star, "cuspless.below_star_converges") is Verdict.CONFIRMED

    gap = replace(on_chaos.below(), fates=on_chaos.below().fates[::2])
    monkeypatch.setattr(on_chaos, "below", lambda: gap)
    assert verdict(on_chaos.below_star, "cuspless.below_star_converges") is Verdict.OPEN


@pytest.mark.parametrize("half", ["settles_near_zero", "chaos"])
def test_chaos_for_larger_contractions_only_takes_both_proofs(monkeypatch, half):
    assert verdict(on_observed.nontrivial_larger, "cuspless.nontrivial_larger") is Verdict.CONFIRMED

    monkeypatch.setattr(on_observed, half, lambda: Finding(Outcome.UNKNOWN, ""))
    assert verdict(on_observed.nontrivial_larger, "cuspless.nontrivial_larger") is Verdict.OPEN


def test_a_part_of_the_boundary_that_shrinks_is_no_support(monkeypatch):
    counts = on_observed.coverage("cuspless")
    assert verdict(on_observed.visits_more, "cuspless.visits_more_boundary") is Verdict.SUPPORTED

    monkeypatch.setattr(on_observed, "coverage", lambda _: counts[::-1])
    assert verdict(on_observed.visits_more, "cuspless.visits_more_boundary") is Verdict.OPEN


def test_exponents_that_scatter_are_no_support(monkeypatch):
    assert verdict(on_observed.error_bars, "cardioid.error_bars") is Verdict.SUPPORTED

    noise = np.random.default_rng(0).normal(size=(11, 100))
    wild = Spectrum(np.linspace(0, 1, 11), noise, noise - 1)
    monkeypatch.setattr(on_observed, "spectrum", lambda *_: wild)
    assert verdict(on_observed.error_bars, "cardioid.error_bars") is Verdict.OPEN


def test_the_number_of_attractors_hangs_on_the_certificate(monkeypatch):
    class Failed:
        certified = False

    monkeypatch.setattr(on_observed, "slap_proof", Failed)
    assert verdict(on_observed.finitely_many, "cardioid.finitely_many_attractors") is Verdict.OPEN


def test_domains_are_compact_where_the_tangent_is_continuous(monkeypatch):
    assert verdict(on_domains.noncompact, "map.noncompact_domain") is Verdict.CONFIRMED
    assert verdict(on_domains.cuspless_noncompact, "cuspless.noncompact") is Verdict.CORRECTED

    monkeypatch.setattr(on_domains, "joined_smoothly", lambda: UNPROVED)
    assert verdict(on_domains.cuspless_noncompact, "cuspless.noncompact") is Verdict.OPEN


def test_a_trajectory_that_misses_the_cusp_leaves_the_domain_whole(monkeypatch):
    monkeypatch.setattr(on_domains, "pi", S.Half)

    assert verdict(on_domains.noncompact, "map.noncompact_domain") is not Verdict.CONFIRMED


def test_the_major_axis_is_the_minor_axis_of_the_inverted_ellipse(monkeypatch):
    assert verdict(on_ellipse_stability.major_by_inversion, "ellipse.major_by_inversion") is Verdict.CONFIRMED

    monkeypatch.setattr(on_ellipse_stability, "minor_axis", on_ellipse_stability.major_axis)
    assert verdict(on_ellipse_stability.major_by_inversion, "ellipse.major_by_inversion") is not Verdict.CONFIRMED


def test_an_axis_that_repels_is_no_stable_orbit_of_the_slap_map(monkeypatch):
    """At a = 6/5 the slope is below 1 in size; were it not, the sentence that is put in place would not be proved."""
    proved = verdict(on_ellipse.slap_stable, "ellipse.slap_stable_orbits")

    monkeypatch.setattr(on_ellipse, "axis_slope", lambda *_: S(3) / 2)
    assert proved is Verdict.CORRECTED
    assert verdict(on_ellipse.slap_stable, "ellipse.slap_stable_orbits") is not proved
