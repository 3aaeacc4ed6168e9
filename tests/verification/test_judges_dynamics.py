"""Canaries: the judges of exponents, driven to other verdicts by claims that are printed otherwise."""

from dataclasses import replace

import numpy as np
import pytest

from symbolic.signs import Finding, Outcome
from verification.claims import catalogue, on_contraction, on_defocusing, on_exponents
from verification.claims.claim import Verdict
from verification.claims.spectra import Spectrum, spectrum, uneven, visited

CLAIMS = {claim.id: claim for claim in catalogue()}


def verdict(judge, name, **changes):
    return judge(replace(CLAIMS[name], **changes)).verdict


def test_a_wrong_exponent_of_a_cycle_is_refuted():
    assert verdict(on_exponents.period3, "egg.exponent_period3") is Verdict.CONFIRMED
    assert verdict(on_exponents.period3, "egg.exponent_period3", printed="-0.4") is Verdict.REFUTED
    assert verdict(on_exponents.period32, "egg.exponent_period32", printed="-0.02") is Verdict.REFUTED


def test_chaos_is_not_found_where_the_cascade_has_not_ended():
    assert verdict(on_exponents.chaos_by, "egg.chaos_by") is Verdict.SUPPORTED
    assert verdict(on_exponents.chaos_by, "egg.chaos_by", printed="0.39") is Verdict.OPEN


def test_an_exponent_with_the_other_sign_is_not_supported(monkeypatch):
    found = spectrum("cardioid", on_contraction.TENTHS)
    upside = Spectrum(found.lams, -found.plus, -found.minus)
    monkeypatch.setattr(on_contraction, "spectrum", lambda *_: upside)

    assert verdict(on_contraction.sum_negative, "cardioid.lyapunov_sum_negative") is Verdict.OPEN


def test_a_cone_that_is_not_proved_confirms_nothing(monkeypatch):
    assert verdict(on_defocusing.signs, "cardioid.lyapunov_signs") is Verdict.CONFIRMED
    monkeypatch.setattr(on_defocusing, "expands", lambda: Finding(Outcome.UNKNOWN, "a step is missing"))

    assert verdict(on_defocusing.signs, "cardioid.lyapunov_signs") is Verdict.OPEN
    assert verdict(on_defocusing.chaotic, "cardioid.chaotic_attractor") is Verdict.OPEN
    assert verdict(on_defocusing.near_cusp, "cardioid.attractor_near_cusp") is Verdict.OPEN


def test_an_expanding_cycle_that_is_not_proved_refutes_nothing(monkeypatch):
    monkeypatch.setattr(on_contraction, "expanding_cycle", lambda: (False, on_contraction.arb(2)))

    assert verdict(on_contraction.contraction_implies, "cardioid.contraction_implies") is Verdict.OPEN


def test_the_certified_cycle_has_the_determinant_that_its_angles_give():
    """A second method: the sum rule on float64 angles."""
    from numeric import PinballMap
    from verification.dynamics.cycles import polished
    from verification.dynamics.places import places

    map = PinballMap("cardioid", lam="0.9")
    phi = [-0.484, 0.051, -1.126, -1.151, -1.098, -1.034, -0.962, -0.877, -0.759]
    cycle = polished(map, places(0, on_contraction.NINE, phi))
    eta = np.abs(cycle.points.phi) / 0.9
    _, determinant = on_contraction.expanding_cycle()

    assert np.prod(0.9 * np.cos(0.9 * eta) / np.cos(eta)) == pytest.approx(float(determinant.mid()), rel=1e-9)


def test_elastic_orbits_fill_phase_space_evenly_and_damped_ones_do_not():
    counts = visited("cardioid", (0.5, 1.0), 8, 4000)

    assert uneven(counts[1]) < 0.1 < uneven(counts[0])
    assert counts.sum() == 2 * 8 * 4001
