"""Canaries: the judges of the egg's cascade and of its attractor's growth, driven to each of their verdicts."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.expressions.signs import Finding, Outcome
from verification.paper.claims.claim import Verdict
from verification.paper.egg import cascade as on_egg_cascade
from verification.paper.egg import crises as on_egg_growth
from verification.paper.egg.crises import Extent
from verification.paper.judges.hyperbolicity import bounced
from verification.paper.report.report import catalogue

CLAIMS = {claim.id: claim for claim in catalogue()}
UNKNOWN = Finding(Outcome.UNKNOWN, "perhaps")


def verdict(judge, name: str) -> Verdict:
    return judge(CLAIMS[name]).verdict


def test_the_loose_map_is_the_map_when_it_is_solved_to_the_end():
    map = PinballMap("egg", lam="0.4", alpha="0.08")
    orbit = map.orbit(np.array([0.3, -2.0]), np.array([0.2, -0.4]), 3)
    theta, phi = orbit.theta[0], orbit.phi[0]

    for k in (1, 2, 3):
        theta, phi = bounced(theta, phi, np.array([0.4]), 0.08, 1e-13)
        assert np.allclose(theta, orbit.theta[k], atol=1e-11)
        assert np.allclose(phi, orbit.phi[k], atol=1e-11)


def test_the_period_4_of_small_contractions_loses_its_mirror_before_anything_doubles():
    found = on_egg_cascade.period4_doubles(CLAIMS["egg.period4_doubles"])

    assert found.verdict is Verdict.CORRECTED
    assert "0.287785" in found.erratum
    assert verdict(on_egg_cascade.negative_exponents, "egg.negative_exponents") is Verdict.CORRECTED


def test_without_a_proof_of_the_branch_between_the_two_events_nothing_is_put_right(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(on_egg_cascade, "attracting_without_mirror", lambda: UNKNOWN)

    assert verdict(on_egg_cascade.period4_doubles, "egg.period4_doubles") is Verdict.REFUTED


def test_without_a_certified_loss_of_symmetry_the_sentence_stays_open(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(on_egg_cascade, "certified", lambda *_, **__: UNKNOWN)

    assert verdict(on_egg_cascade.period4_doubles, "egg.period4_doubles") is Verdict.OPEN
    assert verdict(on_egg_cascade.negative_exponents, "egg.negative_exponents") is Verdict.OPEN


def test_period_4_alone_is_proved_and_without_the_cover_supported_or_open(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(on_egg_cascade, "SMALL", ("0.2",))
    assert verdict(on_egg_cascade.only_period4, "egg.only_period4") is Verdict.CONFIRMED

    monkeypatch.setattr(on_egg_cascade, "cycles_for_small_lam", lambda: UNKNOWN)
    assert verdict(on_egg_cascade.only_period4, "egg.only_period4") is Verdict.SUPPORTED
    monkeypatch.setattr(on_egg_cascade, "SMALL", ("0.4",))

    assert verdict(on_egg_cascade.only_period4, "egg.only_period4") is Verdict.OPEN


def test_chaos_that_does_not_spread_supports_no_tongue(monkeypatch: pytest.MonkeyPatch):
    judges = ((on_egg_cascade.destabilises, "egg.alpha_destabilises"), (on_egg_cascade.tongue, "egg.tongue"))
    assert all(verdict(*pair) is Verdict.SUPPORTED for pair in judges)
    monkeypatch.setattr(on_egg_cascade, "chaotic_lams", lambda: {shape: [0.5] for shape in on_egg_cascade.TONGUE})

    assert all(verdict(*pair) is Verdict.OPEN for pair in judges)


def test_small_basins_are_missed_with_a_probability_that_is_computed():
    assert verdict(on_egg_cascade.small_basins, "egg.small_basins") is Verdict.CONFIRMED


def test_a_cascade_that_is_not_certified_is_no_example(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_egg_cascade.representative, "egg.representative") is Verdict.SUPPORTED
    real = on_egg_cascade.located
    monkeypatch.setattr(
        on_egg_cascade, "located", lambda *a, **k: SimpleNamespace(certified=False, ball=real(*a, **k).ball)
    )

    assert verdict(on_egg_cascade.representative, "egg.representative") is Verdict.OPEN


def test_the_printed_lambda_3_is_what_a_loose_tolerance_gives():
    judge = on_egg_cascade.tolerance_sensitive

    assert verdict(judge, "egg.tolerance_sensitive") is Verdict.SUPPORTED
    assert round(on_egg_cascade.seen_ends()[0.03], 3) == 0.372


def test_a_value_that_no_tolerance_moves_is_not_sensitive(monkeypatch: pytest.MonkeyPatch):
    same = dict.fromkeys(on_egg_cascade.STOPS, 0.37115)
    monkeypatch.setattr(on_egg_cascade, "seen_ends", lambda: same)

    assert verdict(on_egg_cascade.tolerance_sensitive, "egg.tolerance_sensitive") is Verdict.OPEN


def test_strips_are_supported_by_chaos_at_shapes_side_by_side(monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_egg_cascade.isolated_resolution, "egg.isolated_resolution") is Verdict.SUPPORTED
    real = on_egg_cascade.cascade
    monkeypatch.setattr(on_egg_cascade, "cascade", lambda *a: replace(real(*a), proved=False))

    assert verdict(on_egg_cascade.isolated_resolution, "egg.isolated_resolution") is Verdict.OPEN


GROWING = {
    "egg.both_grow": on_egg_growth.both_grow,
}


@pytest.mark.parametrize("name", GROWING)
def test_what_grows_is_supported_and_open_when_it_shrinks(name: str, monkeypatch: pytest.MonkeyPatch):
    assert verdict(GROWING[name], name) is Verdict.SUPPORTED
    monkeypatch.setattr(on_egg_growth, "extent", lambda lam: Extent(1 - float(lam), 0.1))

    assert verdict(GROWING[name], name) is Verdict.OPEN


def test_basins_that_do_not_grow_leave_the_sentence_open(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(on_egg_growth, "period_3", lambda lam: 0.4)

    assert verdict(on_egg_growth.both_grow, "egg.both_grow") is Verdict.OPEN


def test_transients_resemble_the_attractor_and_decay():
    assert verdict(on_egg_growth.transient, "egg.transient") is Verdict.SUPPORTED


@pytest.mark.parametrize("name", ["egg.just_two", "egg.region_taken_over"])
def test_two_orbits_are_left_at_07_and_not_at_083(name: str, monkeypatch: pytest.MonkeyPatch):
    """The contraction of the figure that both sentences speak of."""
    assert verdict(on_egg_growth.just_two, name) is Verdict.SUPPORTED
    monkeypatch.setattr(on_egg_growth, "LEFT", "0.83")

    assert verdict(on_egg_growth.just_two, name) is Verdict.OPEN
