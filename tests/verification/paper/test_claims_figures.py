"""The judges of captions, driven to each verdict that they can reach."""

from types import SimpleNamespace

import pytest

from symbolic.cycles.polygons import required_tilt
from verification.paper.claims.claim import Verdict
from verification.paper.egg import egg as on_figures
from verification.paper.egg.egg import side_cascade
from verification.paper.report.report import verify


def verdict(name: str) -> Verdict:
    (result,) = verify(name)
    return result.verdict


def test_the_triangle_turns_anti_clockwise():
    assert verdict("egg.period3_direction") is Verdict.CONFIRMED


def test_the_turn_would_not_be_confirmed_if_the_needed_tilt_fell_with_lambda(monkeypatch):
    monkeypatch.setattr(on_figures, "required_tilt", lambda: -required_tilt())

    assert verdict("egg.period3_direction") is not Verdict.CONFIRMED


@pytest.mark.parametrize(("bounces", "wanted"), [(700.0, Verdict.SUPPORTED), (9.0, Verdict.OPEN)])
def test_a_long_stay_is_supported_and_a_short_one_is_not(monkeypatch, bounces, wanted):
    monkeypatch.setattr(on_figures, "stay", lambda *_: bounces)

    assert verdict("egg.stays_long") is wanted


def test_the_side_cascades_are_certified_and_lie_below_the_first():
    """The cascade of the paper accumulates at 0.39352; a cascade's gaps shrink by Feigenbaum's ratio, 4.669."""
    for period, born in ((12, 0.3731216), (8, 0.3798749)):
        first, second = side_cascade(period)

        assert first.certified
        assert second.certified
        assert first.supercritical
        assert second.supercritical
        assert float(first.value.mid()) == pytest.approx(born, abs=1e-7)
        assert 0 < float((second.value - first.value).mid()) < 1e-3


@pytest.mark.parametrize(
    ("shares", "wanted"), [((0.1, 0.0), Verdict.SUPPORTED), ((0.0, 0.0), Verdict.OPEN), ((0.1, 0.1), Verdict.OPEN)]
)
def test_noise_is_supported_when_chaos_comes_and_goes(monkeypatch, shares, wanted):
    monkeypatch.setattr(on_figures, "chaotic_share", lambda lam: shares[lam in ("0.3765", "0.3835")])

    assert verdict("egg.noise") is wanted


def test_noise_is_open_when_a_rung_is_not_certified(monkeypatch):
    uncertain = SimpleNamespace(certified=False, supercritical=True, value=side_cascade(8)[0].value)
    monkeypatch.setattr(on_figures, "chaotic_share", lambda lam: 0.1 * (lam in ("0.375", "0.382")))
    monkeypatch.setattr(on_figures, "side_cascade", lambda _: (uncertain,))

    assert verdict("egg.noise") is Verdict.OPEN
