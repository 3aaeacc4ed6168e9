"""Canaries: each judge is driven to each of its verdicts."""

from sympy import Interval, S, log, pi, sqrt, symbols

from symbolic.signs import Finding, Outcome, positive
from symbolic.symbols import alpha, lam
from verification.claims.claim import Claim, Judgement, Verdict
from verification.claims.judges import (
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
    zero,
)

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
