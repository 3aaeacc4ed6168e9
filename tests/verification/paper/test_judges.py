"""The steps that judges share: each is brought to each of its outcomes."""

from itertools import product

import pytest
from sympy import ImmutableMatrix, Interval, Matrix, Rational, S, log, oo, pi, sin, symbols

from symbolic.expressions.signs import Outcome, SignFinding, positive
from symbolic.tables.table import alpha, lam
from verification.paper.claims.claim import Claim, Judgement, Verdict, parse_interval
from verification.paper.claims.judges import (
    answer,
    by,
    counterexample,
    equal,
    identity,
    implied,
    on_range,
    rounded,
    witnesses,
    zero,
)
from verification.paper.judges import ellipse_stability as on_ellipse_stability

PROVED = SignFinding(Outcome.PROVED, "yes")
REFUTED = SignFinding(Outcome.REFUTED, "no")
UNKNOWN = SignFinding(Outcome.UNKNOWN, "perhaps")
FOUND = PROVED, REFUTED, UNKNOWN


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


@pytest.mark.parametrize(("printed", "mended", "evidence"), [*product(FOUND, (None, *FOUND), ("", "some"))])
def test_a_verdict_is_that_of_what_is_printed_and_then_of_what_is_right(printed, mended, evidence):
    found = Judgement(printed, "", mended, evidence=evidence).verdict
    if printed is PROVED:
        assert found is Verdict.CONFIRMED
    elif printed is REFUTED:
        assert found is (Verdict.CORRECTED if mended is PROVED else Verdict.REFUTED)
    else:
        assert found is (Verdict.SUPPORTED if evidence else Verdict.OPEN)


@pytest.mark.parametrize(
    ("text", "interval"),
    [
        ("[0, 1)", Interval.Ropen(0, 1)),
        ("(0, 1]", Interval.Lopen(0, 1)),
        ("[1, oo)", Interval(1, oo)),
        ("2/25", Interval(Rational(2, 25), Rational(2, 25))),
        *((text, None) for text in ("", "[", "everywhere", "[1, 2, 3]", "[0, 1", "0, 1]", "[0 1]", "{0, 1]")),
    ],
)
def test_an_interval_is_read_with_its_brackets(text, interval):
    assert parse_interval(text) == interval


AT_POLE = 1 / (9 * lam - 2)  # at the first witness


@pytest.mark.parametrize("gap", [AT_POLE, log(lam - Rational(2, 9)), sin(AT_POLE), abs(AT_POLE) + lam], ids=str)
def test_where_a_formula_has_a_pole_another_witness_tells(gap):
    found = equal(gap, S.Zero, {})
    assert (found.outcome, found.at) == (Outcome.REFUTED, ((lam, Rational(3, 10)),))
    assert equal(gap * (lam + 1), gap * lam + gap, {}).outcome is Outcome.PROVED


def test_matrices_are_equal_entry_by_entry_and_of_one_shape():
    left, same = Matrix([[lam, 1], [0, lam**2]]), ImmutableMatrix([[lam, 1], [0, lam * lam]])
    assert equal(left, same, {}).outcome is equal(same, left, {}).outcome is Outcome.PROVED
    assert equal(left, Matrix([[lam, 1], [3, lam**2]]), {}).reason.startswith("entry (2, 1)")
    assert equal(left, Matrix([[lam, 1]]), {}).reason == "the shapes (2, 2) and (1, 2) differ"


@pytest.mark.parametrize(
    ("decimal", "value", "outcome"),
    [
        ("1.4", Rational(1449, 1000), Outcome.PROVED),
        ("1.4", Rational(1451, 1000), Outcome.REFUTED),
        ("1.4", Rational(1349, 1000), Outcome.REFUTED),
        ("-1.4", -Rational(1449, 1000), Outcome.PROVED),
        ("-1.4", Rational(7, 5), Outcome.REFUTED),
        ("3.14159", pi, Outcome.PROVED),
        ("3.14160", pi, Outcome.REFUTED),
        ("1", Rational(3, 2), Outcome.UNKNOWN),  # a tie, without any rounding
        ("2", Rational(3, 2), Outcome.UNKNOWN),
    ],
)
def test_a_decimal_shows_a_number_to_half_of_its_last_place(decimal, value, outcome):
    assert rounded(decimal, value).outcome is outcome
