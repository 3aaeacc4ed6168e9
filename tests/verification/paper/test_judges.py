"""Canaries: each judge is driven to each of its verdicts."""

import numpy as np
import pytest
from sympy import Interval, Rational, S, log, oo, pi, sqrt, symbols

from numeric import PinballMap
from symbolic.expressions.signs import Finding, Outcome, positive
from symbolic.tables.table import alpha, lam
from verification.paper.claims.claim import Claim, Judgement, Verdict
from verification.paper.claims.judges import (
    answer,
    by,
    counterexample,
    digits,
    equal,
    greater,
    identity,
    implied,
    on_range,
    rounded,
    witnesses,
    zero,
)
from verification.paper.judges import appendix as on_appendix
from verification.paper.judges import cardioid as on_cardioid
from verification.paper.judges import ellipse_stability as on_ellipse_stability
from verification.paper.judges import hyperbolicity as on_hyperbolicity
from verification.paper.judges import map as on_map
from verification.paper.report.report import catalogue

PROVED = Finding(Outcome.PROVED, "yes")
REFUTED = Finding(Outcome.REFUTED, "no")
UNKNOWN = Finding(Outcome.UNKNOWN, "perhaps")


def claim(printed: str, over: tuple[tuple[str, str], ...] = ()) -> Claim:
    return Claim("canary.one", "0", "a sentence", "identity", printed, over)


def test_an_identity_is_confirmed_corrected_refuted_or_open():
    square = lam**2 + 2 * lam + 1

    assert identity(claim("(lam + 1)^2"), square).verdict is Verdict.CONFIRMED
    assert identity(claim("(lam + 1)^3"), square, ("^3", "^2"), "exponent").verdict is Verdict.CORRECTED
    assert identity(claim("(lam + 2)^3"), square, ("^3", "^2"), "exponent").verdict is Verdict.REFUTED
    assert identity(claim("(lam + 1)^3"), square).verdict is Verdict.REFUTED


def test_an_identity_stays_open_when_neither_reduction_nor_balls_decide():
    assert equal(log(6), log(2) + log(3), {}).outcome is Outcome.UNKNOWN
    assert Judgement(UNKNOWN, "").verdict is Verdict.OPEN


def test_a_correction_needs_both_halves():
    assert Judgement(REFUTED, "", PROVED, "x").verdict is Verdict.CORRECTED
    assert Judgement(REFUTED, "", UNKNOWN, "x").verdict is Verdict.REFUTED
    assert Judgement(UNKNOWN, "", PROVED, "x").verdict is Verdict.OPEN
    assert Judgement(UNKNOWN, "", evidence="sampled").verdict is Verdict.SUPPORTED


def test_digits_are_confirmed_corrected_or_refuted():
    assert digits(claim("1.414"), sqrt(S(2))).verdict is Verdict.CONFIRMED
    assert digits(claim("1.42"), sqrt(S(2)), ("1.42", "1.41")).verdict is Verdict.CORRECTED
    assert digits(claim("1.42"), sqrt(S(2)), ("1.42", "1.40")).verdict is Verdict.REFUTED


def test_rounding_on_a_tie_is_left_undecided():
    assert rounded("0.1", S(3) / 20).outcome is Outcome.UNKNOWN


def test_a_range_is_judged_with_its_ends():
    def inverse_is_large(box):
        return positive(1 - lam, box)

    closed, half_open = claim("x", (("lam", "[0, 1]"),)), claim("x", (("lam", "[0, 1)"),))

    assert on_range(half_open, inverse_is_large, "").verdict is Verdict.CONFIRMED
    assert on_range(closed, inverse_is_large, "").verdict is Verdict.REFUTED
    assert on_range(closed, inverse_is_large, "", {lam: Interval.Ropen(0, 1)}, "open end").verdict is Verdict.CORRECTED


def test_an_argument_is_as_strong_as_its_weakest_finding():
    assert by("so", PROVED, PROVED).outcome is Outcome.PROVED
    assert by("so", PROVED, UNKNOWN).outcome is Outcome.UNKNOWN
    assert by("so", UNKNOWN, REFUTED).outcome is Outcome.REFUTED


def test_a_counterexample_refutes_only_when_it_is_proved():
    assert counterexample("here", PROVED).outcome is Outcome.REFUTED
    assert counterexample("here", UNKNOWN).outcome is Outcome.UNKNOWN
    assert counterexample("here", REFUTED).outcome is Outcome.UNKNOWN


def test_a_comparison_of_balls_has_three_answers():
    assert greater(pi, S(3)).outcome is Outcome.PROVED
    assert greater(S(3), pi).outcome is Outcome.REFUTED
    assert greater(log(6), log(2) + log(3)).outcome is Outcome.UNKNOWN


def test_zero_is_not_proved_of_what_is_not_zero():
    assert zero("", lam - lam).outcome is Outcome.PROVED
    assert zero("", lam).outcome is Outcome.REFUTED


def test_a_step_of_logic_is_proved_or_refuted_by_an_assignment():
    place, angle = symbols("place angle")

    assert implied("", ~place >> ~(place & angle)).outcome is Outcome.PROVED
    assert implied("", place >> (place & angle)).outcome is Outcome.REFUTED


def test_a_proof_that_fails_refutes_nothing():
    assert [answer(holds, "").outcome for holds in (True, False, None)] == [
        Outcome.PROVED,
        Outcome.UNKNOWN,
        Outcome.UNKNOWN,
    ]


def test_a_refutation_names_its_witness_and_a_proof_none():
    box = (("lam", "[0, 1]"), ("alpha", "1/10"))
    wrong = identity(claim("lam + 1/2", box), lam)

    assert wrong.witness(claim("", box)).keys() == {lam, alpha}
    assert identity(claim("lam", box), lam).witness(claim("", box)) == {}
    assert on_range(claim("", box), lambda b: positive(lam, b), "").witness(claim("", box))[lam] == 0
    assert Judgement(counterexample("", PROVED, at={lam: S.One}), "").witness(claim("")) == {lam: 1}


COMPUTED = {
    "cardioid.lyapunov_sum_area": (on_cardioid.exponent_sum, on_cardioid, Verdict.CONFIRMED),
    "appendix.exponents_growth": (on_appendix.growth, on_appendix, Verdict.CONFIRMED),
    "appendix.exponents_sum": (on_appendix.exponents_sum, on_appendix, Verdict.CORRECTED),
}


@pytest.mark.parametrize("name", COMPUTED)
def test_growth_rates_that_do_not_add_up_prove_nothing(name, monkeypatch):
    judge, module, before = COMPUTED[name]
    (one,) = [claim for claim in catalogue() if claim.id == name]
    assert judge(one).verdict is before

    monkeypatch.setattr(module, "growth_defects", lambda: [lam])
    assert judge(one).verdict is Verdict.REFUTED


def test_a_second_pair_of_fixed_points_leaves_the_vertical_orbit_open(monkeypatch):
    (one,) = [claim for claim in catalogue() if claim.id == "cardioid.vertical_orbit"]
    assert on_cardioid.vertical_orbit(one).verdict is Verdict.CONFIRMED

    monkeypatch.setattr(on_cardioid, "fixed_points", lambda: [(-S.One / 5, -S.One / 5)] * 2)
    assert on_cardioid.vertical_orbit(one).verdict is Verdict.OPEN


def test_an_infimum_that_is_not_proved_to_be_the_least_confirms_nothing(monkeypatch):
    (one,) = [claim for claim in catalogue() if claim.id == "cardioid.slap_expanding"]
    monkeypatch.setattr(on_cardioid, "infimum_attained", lambda: UNKNOWN)

    assert on_cardioid.expanding(one).verdict is Verdict.OPEN


def test_a_table_whose_boundary_does_not_close_is_no_circle_for_the_slap_map(monkeypatch):
    from symbolic import tables

    (one,) = [claim for claim in catalogue() if claim.id == "map.slap_circle_map"]
    assert {table.name for table in on_map.ALL} == {"circle", "ellipse", "cardioid", "cuspless", "egg"}
    assert on_map.slap_circle_map(one).verdict is Verdict.CONFIRMED

    gone = type(tables.cuspless)("half", tables.cuspless.components[:1])
    monkeypatch.setattr(on_map, "ALL", (tables.circle, gone))
    assert on_map.slap_circle_map(one).verdict is Verdict.REFUTED


def test_an_evolute_is_claimed_of_curved_components_alone(monkeypatch):
    (one,) = [claim for claim in catalogue() if claim.id == "map.slap_evolute"]
    assert on_map.slap_evolute(one).verdict is Verdict.CONFIRMED

    monkeypatch.setattr(on_map, "curved", lambda: [UNKNOWN])
    assert on_map.slap_evolute(one).verdict is Verdict.OPEN


def test_eigenlines_go_to_eigenlines_along_a_cycle():
    assert all(zero("", defect) for defect in on_ellipse_stability.eigenline_defects())


def test_witnesses_are_rational_points_inside_the_ranges_and_no_two_alike():
    x, y, z, free = symbols("x y z t")
    box = {x: Interval(3, 5), y: Interval.open(-2, -1), z: Interval(1, oo)}
    points = witnesses([z, x, y, free], box)

    for letter in (x, y, z, free):
        values = [point[letter] for point in points]
        assert len(set(values)) == len(points) > 1
        assert all(isinstance(value, Rational) for value in values)
        assert all(value in box.get(letter, Interval.open(0, 1)).interior for value in values)
    assert all(len(set(point.values())) == 4 for point in points)


def test_the_map_whose_newton_iteration_may_stop_early_is_the_map_when_it_does_not():
    map, rng = PinballMap("egg", alpha="0.08", lam="0.4"), np.random.default_rng(1)
    theta, phi = rng.uniform(-np.pi, np.pi, 50), rng.uniform(-0.6, 0.6, 50)
    landed = map.step(theta, phi)
    for tolerance, close in ((1e-12, 1e-9), (0.3, 0.3)):
        there, exit = on_hyperbolicity.bounced(theta, phi, np.full(50, 0.4), 0.08, tolerance)
        off = np.abs(np.remainder(there - landed.theta + np.pi, 2 * np.pi) - np.pi)
        assert np.max(off) < close
        assert np.max(np.abs(exit - landed.phi)) < close
    assert np.max(off) > 1e-6  # it did stop early


def test_an_orbit_that_is_back_after_its_period_ends_nothing_and_one_that_is_not_ends_it():
    """The egg's triangle attracts from the fold at 0.378 on; below it nothing has the period 3."""
    lams = np.array([0.37, 0.45, 0.5])
    (ends,) = on_hyperbolicity.ends_of_period(3, lams, 0.08, [1e-12], (1.1, 0.3), 500, 1e-6)

    assert list(ends) == [0.37]
    (others,) = on_hyperbolicity.ends_of_period(2, lams, 0.08, [1e-12], (1.1, 0.3), 500, 1e-6)
    assert list(others) != list(ends)


def test_each_row_of_particles_ends_with_its_own_tolerance():
    theta, phi, lams = np.linspace(0.1, 1.0, 4), np.full(4, 0.2), np.linspace(0.3, 0.6, 4)
    stops = np.array([[0.3], [0.03], [1e-12]])
    rows = on_hyperbolicity.bounced(np.tile(theta, (3, 1)), np.tile(phi, (3, 1)), lams, 0.08, stops)
    for row, (stop,) in enumerate(stops):
        alone = on_hyperbolicity.bounced(theta, phi, lams, 0.08, stop)
        assert [part[row].tolist() for part in rows] == [part.tolist() for part in alone]
    assert rows[0][0].tolist() != rows[0][2].tolist()
