"""Canaries: the judges of the paper's summaries, driven to other verdicts by other facts."""

from dataclasses import replace

import pytest
from flint import arb

from symbolic.expressions.signs import Finding, Outcome
from verification.paper.claims.claim import Verdict
from verification.paper.egg import conclusions as on_conclusions
from verification.paper.report.report import catalogue
from verification.proofs.periodic.bifurcation import Sign

CLAIMS = {claim.id: claim for claim in catalogue()}
UNKNOWN = Finding(Outcome.UNKNOWN, "perhaps")


def verdict(judge, name: str) -> Verdict:
    return judge(CLAIMS[name]).verdict


def test_a_mixture_is_supported_and_open_without_the_cone_of_the_cardioid(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_conclusions.mixture, "map.mixture") is Verdict.SUPPORTED
    monkeypatch.setattr(on_conclusions, "expands", lambda: UNKNOWN)

    assert verdict(on_conclusions.mixture, "map.mixture") is Verdict.OPEN


@pytest.mark.parametrize("ground", ["attracted", "two_rates"])
def test_weak_dissipation_leads_to_chaos_by_the_cones_of_both_tables(monkeypatch: pytest.MonkeyPatch, ground: str):
    assert verdict(on_conclusions.weak_chaos, "map.weak_chaos") is Verdict.CONFIRMED
    monkeypatch.setattr(on_conclusions, ground, lambda: UNKNOWN)

    assert verdict(on_conclusions.weak_chaos, "map.weak_chaos") is Verdict.OPEN


def test_the_sudden_creation_is_proved_by_the_trapping_region(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_conclusions.sudden_creation, "map.sudden_creation") is Verdict.CONFIRMED
    monkeypatch.setattr(on_conclusions, "chaos", lambda: UNKNOWN)

    assert verdict(on_conclusions.sudden_creation, "map.sudden_creation") is Verdict.OPEN


@pytest.mark.parametrize("other", [(arb("nan"), arb("nan")), (arb(9), arb(-1)), (arb(0), arb(0, 3)), (arb(0), arb(2))])
def test_kinks_follow_only_from_a_cycle_on_the_arc_within_each_trapping_region(monkeypatch: pytest.MonkeyPatch, other):
    assert verdict(on_conclusions.kink_structure, "map.kink_structure") is Verdict.CONFIRMED
    found = on_conclusions.born()
    steps = *found.steps[:-1], replace(found.steps[-1], cycle=other)
    monkeypatch.setattr(on_conclusions, "born", lambda: replace(found, steps=steps))

    assert verdict(on_conclusions.kink_structure, "map.kink_structure") is Verdict.OPEN


def test_cascades_start_from_several_periods_when_each_doubling_is_proved(monkeypatch: pytest.MonkeyPatch):
    judge, name = on_conclusions.different_periods, "map.cascades_of_different_periods"
    found = on_conclusions.doublings()
    assert verdict(judge, name) is Verdict.SUPPORTED
    monkeypatch.setattr(on_conclusions, "doublings", lambda: [replace(found[0], proved=False), *found[1:]])

    assert verdict(judge, name) is Verdict.OPEN


def test_a_collapse_needs_an_attractor_before_and_none_after(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_conclusions.collapse, "map.collapse_in_crises") is Verdict.SUPPORTED
    real = on_conclusions.egg
    monkeypatch.setattr(on_conclusions, "egg", lambda lam: real("0.65"))

    assert verdict(on_conclusions.collapse, "map.collapse_in_crises") is Verdict.OPEN


def test_uniform_contraction_excludes_no_invariant_circles_if_one_is_proved(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_conclusions.uniform_contraction, "map.uniform_contraction") is Verdict.REFUTED
    monkeypatch.setattr(on_conclusions, "rotating", lambda: UNKNOWN)

    assert verdict(on_conclusions.uniform_contraction, "map.uniform_contraction") is Verdict.OPEN


def test_elliptic_orbits_are_shown_when_each_attracting_one_has_an_elliptic_neighbour(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_conclusions.weak_shows_elliptic, "map.weak_shows_elliptic") is Verdict.CONFIRMED
    monkeypatch.setattr(on_conclusions, "elastic", lambda cycle: False)

    assert verdict(on_conclusions.weak_shows_elliptic, "map.weak_shows_elliptic") is Verdict.OPEN


def test_the_portrait_is_the_same_for_odd_K_alone(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_conclusions.other_K, "map.other_K") is Verdict.CORRECTED
    monkeypatch.setattr(on_conclusions, "doubling_curve", lambda K: Sign(None, 0))

    assert verdict(on_conclusions.other_K, "map.other_K") is Verdict.REFUTED
