"""Canaries: the judges of exponents, driven to other verdicts by claims that are printed otherwise."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from flint import acb, arb
from sympy import Rational

from symbolic.cycles.defocusing import away, least_stretch
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import lam
from verification.arithmetic.balls import working
from verification.cycles.recurrence import delayed
from verification.paper.claims.claim import Verdict
from verification.paper.claims.judges import answer
from verification.paper.judges import attractors as on_attractors
from verification.paper.judges import cardioid_attractor as on_defocusing
from verification.paper.judges import exponents as on_exponents
from verification.paper.judges import located as on_contraction
from verification.paper.judges.exponents import Spectrum, spectrum, uneven, visited
from verification.paper.report.report import catalogue
from verification.proofs.manifolds.enclosed import attracting, complex_balls
from verification.proofs.manifolds.known import SHARPER, TRIANGLE, table
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.periodic.torus import Rotating
from verification.proofs.slap_map.exponent import slap_exponent

CLAIMS = {claim.id: claim for claim in catalogue()}


def verdict(judge, name, **changes):
    return judge(replace(CLAIMS[name], **changes)).verdict


def test_a_wrong_exponent_of_a_cycle_is_refuted():
    assert verdict(on_exponents.period3, "egg.exponent_period3") is Verdict.CONFIRMED
    assert verdict(on_exponents.period3, "egg.exponent_period3", printed="-0.4") is Verdict.REFUTED
    assert verdict(on_exponents.period32, "egg.exponent_period32", printed="-0.02") is Verdict.REFUTED


def test_chaos_is_proved_at_contractions_that_round_to_the_printed_one_and_at_no_others(monkeypatch):
    assert verdict(on_exponents.chaos_by, "egg.chaos_by") is Verdict.CONFIRMED
    assert verdict(on_exponents.chaos_by, "egg.chaos_by", printed="0.3935") is Verdict.OPEN
    assert verdict(on_exponents.chaos_by, "egg.chaos_by", printed="0.3938") is Verdict.OPEN
    chaos, value = on_exponents.strange("0.08", "band-merging-16")
    monkeypatch.setattr(on_exponents, "strange", lambda *_: (answer(None, chaos.reason), value))
    assert verdict(on_exponents.chaos_by, "egg.chaos_by") is Verdict.OPEN


def test_an_exponent_with_the_other_sign_is_not_supported(monkeypatch):
    found = spectrum("cardioid", on_contraction.TENTHS)
    upside = Spectrum(found.lams, -found.plus, -found.minus)
    monkeypatch.setattr(on_contraction, "spectrum", lambda *_: upside)

    assert verdict(on_contraction.sum_negative, "cardioid.lyapunov_sum_negative") is Verdict.OPEN


ON_THE_CONE = {
    "cardioid.lyapunov_exist": (on_defocusing.existence, Verdict.SUPPORTED),
    "cardioid.lyapunov_signs": (on_defocusing.signs, Verdict.CONFIRMED),
    "cardioid.exponents_bounded_away": (on_defocusing.bounded_away, Verdict.SUPPORTED),
    "cardioid.nonuniformly_hyperbolic": (on_defocusing.nonuniformly_hyperbolic, Verdict.CONFIRMED),
    "cardioid.chaotic_attractor": (on_defocusing.chaotic_attractor, Verdict.CONFIRMED),
    "cardioid.attractor_near_cusp": (on_defocusing.near_cusp, Verdict.CONFIRMED),
}


@pytest.mark.parametrize("name", ON_THE_CONE)
def test_a_cone_that_is_not_proved_confirms_and_supports_nothing(name, monkeypatch):
    judge, before = ON_THE_CONE[name]
    monkeypatch.setattr(on_defocusing, "slap_proof", quick_proof)
    assert verdict(judge, name) is before

    monkeypatch.setattr(on_defocusing, "expands", lambda: Finding(Outcome.UNKNOWN, "a step is missing"))
    assert verdict(judge, name) is Verdict.OPEN


@cache
def quick_proof():
    """The natural measure of the slap map, to few digits."""
    return slap_exponent(6)


def test_every_orbit_of_the_cardioid_stretches_as_much_as_is_proved_and_keeps_off_the_cusp_every_second_bounce():
    """On 200 orbits in float64, of which none may fall below: `|ds_n|` from the derivative matrices."""
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


def test_a_natural_measure_that_is_not_proved_leaves_its_claims_open(monkeypatch):
    monkeypatch.setattr(on_defocusing, "slap_proof", quick_proof)
    assert verdict(on_defocusing.slap_ergodic, "cardioid.slap_ergodic") is Verdict.CONFIRMED

    unproved = replace(quick_proof(), checks={**quick_proof().checks, "symmetric": None})
    monkeypatch.setattr(on_defocusing, "slap_proof", lambda: unproved)
    assert verdict(on_defocusing.slap_ergodic, "cardioid.slap_ergodic") is Verdict.OPEN
    assert verdict(on_defocusing.transitive, "cardioid.transitive") is Verdict.OPEN
    assert verdict(on_defocusing.chaotic_attractor, "cardioid.chaotic_attractor") is Verdict.OPEN


@pytest.mark.parametrize("step", ["two_cycles", "settles", "strange"])
def test_the_egg_is_the_only_smooth_table_with_chaos_by_proofs_on_both_sides(step, monkeypatch):
    assert verdict(on_attractors.only_smooth, "egg.only_smooth_chaos") is Verdict.CONFIRMED
    missing = Finding(Outcome.UNKNOWN, "a step is missing")
    monkeypatch.setattr(on_attractors, step, lambda *_: (missing, arb(0)) if step == "strange" else missing)

    assert verdict(on_attractors.only_smooth, "egg.only_smooth_chaos") is Verdict.OPEN


@pytest.mark.parametrize("step", ["two_cycles", "settles", "expands", "splits", "every_return"])
def test_that_there_is_no_rotation_elsewhere_rests_on_each_proof(step, monkeypatch):
    assert verdict(on_attractors.no_rotation, "map.no_irrational_rotation") is Verdict.CORRECTED
    monkeypatch.setattr(on_attractors, step, lambda: Finding(Outcome.UNKNOWN, "a step is missing"))

    assert verdict(on_attractors.no_rotation, "map.no_irrational_rotation") is Verdict.REFUTED


@pytest.mark.parametrize("step", ["two_cycles", "settles", "splits", "strange"])
def test_a_third_type_of_attractor_rests_on_a_strange_one_and_the_other_tables_on_their_proofs(step, monkeypatch):
    assert verdict(on_attractors.two_types, "map.two_attractor_types") is Verdict.CORRECTED
    missing = Finding(Outcome.UNKNOWN, "a step is missing")
    monkeypatch.setattr(on_attractors, step, lambda *_: (missing, arb(0.66)) if step == "strange" else missing)

    left = Verdict.OPEN if step == "strange" else Verdict.REFUTED
    assert verdict(on_attractors.two_types, "map.two_attractor_types") is left


@pytest.mark.parametrize(
    "other",
    [
        {"lyapunov": arb(1)},
        {"lyapunov": arb(0, 1)},
        {"growth": arb(-1)},
        {"checks": {"exists": None}},
        {"problem": Rotating(delayed(1), ("r", "trace"))},
    ],
    ids=["repelling", "unknown", "on the other side", "not proved", "any trace"],
)
def test_a_circle_that_is_not_proved_to_attract_and_to_turn_irrationally_refutes_nothing(other, monkeypatch):
    real = on_attractors.invariant_circle()
    assert on_attractors.rotating.__wrapped__().outcome is Outcome.REFUTED
    monkeypatch.setattr(on_attractors, "invariant_circle", lambda: replace(real, **other))
    missing = on_attractors.rotating.__wrapped__()
    assert missing.outcome is Outcome.UNKNOWN
    monkeypatch.setattr(on_attractors, "rotating", lambda: missing)

    assert verdict(on_attractors.no_rotation, "map.no_irrational_rotation") is Verdict.OPEN


def test_the_exponent_of_a_cycle_that_is_not_proved_neither_confirms_nor_refutes(monkeypatch):
    monkeypatch.setattr(on_exponents, "proved", lambda proof: False)

    assert verdict(on_exponents.period3, "egg.exponent_period3") is Verdict.OPEN
    assert verdict(on_exponents.weak_dissipation_attracts, "egg.weak_dissipation_attracts") is Verdict.OPEN


def test_an_attracting_cycle_without_a_contracting_norm_corrects_nothing(monkeypatch):
    assert verdict(on_exponents.chaotic_sign, "appendix.chaotic_sign") is Verdict.CORRECTED
    monkeypatch.setattr(on_exponents, "contracting_norm", lambda: Finding(Outcome.UNKNOWN, "not positive"))

    assert verdict(on_exponents.chaotic_sign, "appendix.chaotic_sign") is Verdict.REFUTED


def test_balls_for_one_number_agree_disagree_or_are_too_wide():
    assert on_exponents.agree(arb("0.5"), arb("0.5")).outcome is Outcome.PROVED
    assert on_exponents.agree(arb("0.5"), arb("0.6")).outcome is Outcome.REFUTED
    assert on_exponents.agree(arb("0.5", 1), arb("0.6")).outcome is Outcome.UNKNOWN


def test_an_expanding_cycle_that_is_not_proved_refutes_nothing(monkeypatch):
    monkeypatch.setattr(on_contraction, "expanding_cycle", lambda: (False, on_contraction.arb(2)))

    assert verdict(on_contraction.contraction_implies, "cardioid.contraction_implies") is Verdict.OPEN


def test_the_certified_cycle_has_the_determinant_that_its_angles_give():
    """A second method: the sum rule on float64 angles."""
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


def test_the_triangle_of_the_vertices_is_not_said_to_attract():
    map, here = table(Rational("0.095")).over(complex_balls(160)), acb(arb("0.5175349092", 1e-9))
    with working(160):
        assert attracting(Orbit("near the flat points", (1.2383336,), TRIANGLE.closure), map, here) is True
        assert attracting(SHARPER, map, here) is None
        assert attracting(SHARPER, map, acb(arb("0.51", 0.1))) is None  # balls that hold no proof


def test_at_the_end_of_the_convex_shapes_strange_attractors_lie_beside_triangles_over_a_range():
    """Sets of contractions of positive measure next to two of them are no range: that is supported, not proved."""
    proof, (one, other) = on_attractors.both_near_tenth()

    assert proof
    assert 0.2956 < one < 0.2957
    assert 0.4717 < other < 0.4718
    assert verdict(on_attractors.near_tenth, "egg.coexistence_near_tenth") is Verdict.SUPPORTED


def test_no_triangle_attracts_from_below_its_fold_on():
    """It is born at 0.28264, from a fold: a range that begins before has a part that is never proved."""
    low, high, after = (Fraction(k, 1000) for k in (282, 300, 284))
    assert on_attractors.triangles_attract(low, high).outcome is Outcome.UNKNOWN
    assert on_attractors.triangles_attract(after, high).outcome is Outcome.PROVED


@pytest.mark.parametrize(
    ("ends", "chaos", "attracts"),
    [
        (("0.3", "0.47"), Outcome.PROVED, None),  # no triangle is proved to attract
        (("0.3", "0.47"), Outcome.UNKNOWN, True),
        (("0.29", "0.47"), Outcome.PROVED, True),  # next to a contraction outside of the range
        (("0.3", "0.48"), Outcome.PROVED, True),
        (("0.3", "0.3"), Outcome.PROVED, True),  # one contraction is no range
    ],
)
def test_coexistence_over_a_range_needs_chaos_next_to_two_contractions_in_it(monkeypatch, ends, chaos, attracts):
    judge, name = on_attractors.near_tenth, "egg.coexistence_near_tenth"
    caches = on_attractors.both_near_tenth, on_attractors.triangles_attract
    values = {"bands": arb(ends[0]), "boundary": arb(ends[1])}
    monkeypatch.setattr(on_attractors, "strange", lambda alpha, kind="boundary": (Finding(chaos, ""), values[kind]))
    monkeypatch.setattr(on_attractors, "attracting", lambda *_: attracts)
    monkeypatch.setattr(on_attractors, "STEPS", 3)
    for cached in caches:
        cached.cache_clear()
    assert verdict(judge, name) is Verdict.OPEN
    for cached in caches:
        cached.cache_clear()


@pytest.mark.parametrize("name", ["period2_attracts", "compact_near_zero"])
def test_boxes_too_large_to_prove_anything_leave_the_claims_near_zero_open(name, monkeypatch):
    judge, coarse = getattr(on_attractors, name), replace(on_attractors.near_zero(), grid=(64, 8))
    assert verdict(judge, f"cuspless.{name}") is Verdict.CONFIRMED

    monkeypatch.setattr(on_attractors, "near_zero", lambda: coarse)
    assert verdict(judge, f"cuspless.{name}") is Verdict.OPEN
