"""Claims, judgements and the steps that judges share, each by itself: texts, outcomes, borders, and what is missing."""

from dataclasses import replace
from hashlib import sha256
from itertools import product

import pytest
from sympy import (
    ImmutableMatrix,
    Integer,
    Interval,
    Matrix,
    Rational,
    S,
    Symbol,
    atan,
    exp,
    log,
    oo,
    pi,
    sin,
    sqrt,
    symbols,
)

from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import alpha, lam, theta
from verification.paper.claims import judges
from verification.paper.claims.claim import (
    LETTERS,
    Claim,
    Judgement,
    Sentence,
    Verdict,
    _misquoted,
    defects,
    differences,
    digest,
    parse_interval,
    split,
)

FOUND = {outcome: Finding(outcome, outcome.name.lower()) for outcome in Outcome}
PROVED, REFUTED, UNKNOWN = (FOUND[outcome] for outcome in (Outcome.PROVED, Outcome.REFUTED, Outcome.UNKNOWN))


def claim(printed="lam", **more) -> Claim:
    return Claim("canary.one", "0 Canaries", "a sentence", "identity", printed, **more)


def test_claims_are_the_same_whatever_judging_takes_and_spares_and_why_they_are_open():
    one = claim()
    assert one.seconds == 1.0
    assert one == replace(one, seconds=7.0) == replace(one, spares=(("a", 2.0),)) == replace(one, unsettled="because")
    assert one != replace(one, printed="2*lam")
    assert {key: one.names[key] for key in LETTERS} == LETTERS
    assert claim(letters=("w",)).names["w"] == Symbol("w", real=True)
    assert "w" not in one.names


@pytest.mark.parametrize(
    ("printed", "text", "formula"),
    [
        ("2*lam", "2*lam", 2 * lam),
        (["lam", "2"], "[lam, 2]", Matrix([lam, 2])),
        ([["lam", "2"], ["3", "theta"]], "[[lam, 2], [3, theta]]", Matrix([[lam, 2], [3, theta]])),
    ],
)
def test_what_is_printed_is_a_formula_a_list_or_a_table(printed, text, formula):
    assert claim(printed).text == text
    assert claim(printed).formula == formula


def test_a_range_is_kept_for_letters_that_are_known_and_intervals_that_are_some():
    over = (("lam", "[0, 1)"), ("alpha", "2/25"), ("theta", "everywhere"), ("nobody", "[0, 1]"))
    assert claim(over=over).box == {lam: Interval.Ropen(0, 1), alpha: Interval(Rational(2, 25), Rational(2, 25))}


@pytest.mark.parametrize(
    ("text", "interval"),
    [
        ("[0, 1)", Interval.Ropen(0, 1)),
        ("(0, 1]", Interval.Lopen(0, 1)),
        ("[0,12]", Interval(0, 12)),
        ("(10, 21)", Interval.open(10, 21)),
        ("[1, oo)", Interval(1, oo)),
        ("(-1/2, 1/3]", Interval.Lopen(-Rational(1, 2), Rational(1, 3))),
        ("2/25", Interval(Rational(2, 25), Rational(2, 25))),
        ("(1/2)", Interval(Rational(1, 2), Rational(1, 2))),
        *((text, None) for text in ("", "[", "everywhere", "[1, 2, 3]", "[1]", "[0, 1", "0, 1]", "{0, 1}", "[0 1]")),
        *((text, None) for text in ("{0, 1]", "[0, 1}", "{0, 1)", "(0, 1}")),
    ],
)
def test_an_interval_is_read_with_its_brackets(text, interval):
    assert parse_interval(text) == interval


@pytest.mark.parametrize(
    ("printed", "mended", "evidence"), [*product(FOUND.values(), (None, *FOUND.values()), ("", "some"))]
)
def test_a_verdict_is_that_of_what_is_printed_and_then_of_what_is_right(printed, mended, evidence):
    found = Judgement(printed, "", mended, evidence=evidence).verdict
    if printed is PROVED:
        assert found is Verdict.CONFIRMED
    elif printed is REFUTED:
        assert found is (Verdict.CORRECTED if mended is PROVED else Verdict.REFUTED)
    else:
        assert found is (Verdict.SUPPORTED if evidence else Verdict.OPEN)


def test_a_witness_has_a_value_for_each_letter_of_what_fails_and_none_of_what_does_not():
    printed = claim(over=(("lam", "[0, 1]"), ("alpha", "2/25")))
    at = Finding(Outcome.REFUTED, "", ((lam, S.Half),))
    assert Judgement(at, "").witness(printed) == {lam: S.Half, alpha: Rational(2, 25)}
    assert Judgement(at, "", PROVED).witness(printed) == {lam: S.Half, alpha: Rational(2, 25)}
    assert Judgement(Finding(Outcome.REFUTED, ""), "").witness(printed) == {alpha: Rational(2, 25)}
    assert Judgement(PROVED, "").witness(printed) == Judgement(UNKNOWN, "").witness(printed) == {}


def test_a_digest_has_twelve_digits():
    assert digest("a  b") == sha256(b"a b").hexdigest()[:12]


def test_sections_are_counted_anew_in_each_and_appendices_have_letters():
    paper = r"\title{T} Not this. \begin{abstract}Zero.\end{abstract}"
    for heading in ("section", "subsection", "subsection", "section", "subsection"):
        paper += rf"\{heading}{{H}} One."
    paper += r"\ack Thanks. \appendix \section{H} One. \section{H} One. \subsection{H} One. \subsection{H} One."
    paper += r"\section*{References} Not this."
    wanted = ["Abstract", "1", "1.1", "1.2", "2", "2.1", "Acknowledgements", "A", "B", "B.1", "B.2"]
    assert [section for section, _ in split(paper)] == wanted
    assert [text for _, text in split(paper)] == [
        {"Abstract": "Zero.", "Acknowledgements": "Thanks."}.get(section, "One.") for section in wanted
    ]


PAPER = r"\begin{abstract}Circles are round.\end{abstract}\section{A} Ovals are not. Squares have corners."
TEXTS = [("Abstract", "Circles are round."), ("1", "Ovals are not."), ("1", "Squares have corners.")]


def listed(**changes) -> list[Sentence]:
    """The sentences of the paper, the second quoted by a claim; `n1=...` changes the one numbered 1."""
    made = [Sentence(section, text[:6], digest(text), prose="why") for section, text in TEXTS]
    made[1] = Sentence("1", "Ovals", digest("Ovals are not."), claims=("one",))
    for name, change in changes.items():
        made[int(name[1:])] = replace(made[int(name[1:])], **change)
    return made


ONE = Claim("one", "1 A", "are not", "x", "0")


@pytest.mark.parametrize(
    ("sentences", "claims", "wanted"),
    [
        (listed(), [ONE], []),
        (listed(), [ONE, replace(ONE, id="two")], ["two stands under no sentence"]),
        (listed(n0={"prose": ""}), [ONE], ["Abstract: 'Circle' needs one of claims, repeats, prose, not 0"]),
        (listed(n2={"repeats": ("one",)}), [ONE], ["1: 'Square' needs one of claims, repeats, prose, not 2"]),
        (listed(n2={"repeats": ("no",), "prose": ""}), [ONE], ["1: 'Square' names no, which is no claim"]),
        (listed(n2={"claims": ("no",), "prose": ""}), [ONE], ["1: 'Square' names no, which is no claim"]),
        (listed(), [replace(ONE, section="2 A")], ["1: 'Ovals' lists one, which quotes another section"]),
        (listed(), [replace(ONE, section="1.1 A")], ["1: 'Ovals' lists one, which quotes another section"]),
        (listed(n2={"repeats": ("one",), "prose": ""}), [ONE], []),
    ],
)
def test_each_defect_of_a_list_is_said_and_no_other(sentences, claims, wanted):
    assert defects(sentences, claims) == wanted


@pytest.mark.parametrize(
    ("sentences", "wanted"),
    [
        (listed(), []),
        (listed()[:-1], ["not listed: 'Squares have corners.'"]),
        ([*listed(), listed()[0]], ["no sentence 'Circle'"]),
        (listed(n0={"section": "1"}), ["Abstract: 'Circles are round.' is not the sentence listed, 'Circle'"]),
        (listed(n0={"digest": "0" * 12}), ["Abstract: 'Circles are round.' is not the sentence listed, 'Circle'"]),
        (listed(n0={"opens": "Discs"}), ["Abstract: 'Circles are round.' is not the sentence listed, 'Discs'"]),
        (listed(n1={"claims": (), "prose": "why"}), ["one: 'are not' is not in the sentences that it is listed under"]),
    ],
)
def test_each_difference_from_the_paper_is_said_and_no_other(sentences, wanted):
    assert differences(PAPER, sentences, [ONE]) == wanted


@pytest.mark.parametrize(
    ("quote", "wanted"),
    [
        ("Circles are round. Ovals are not. S", ""),
        ("C ... Ovals ... S", ""),
        ("Circles are round. Ovals are not.", "one quotes nothing of 'Squares have corners.'"),
        ("Ovals are not. Squares", "one quotes nothing of 'Circles are round.'"),
        ("Circles are round. ... corners.", "one quotes nothing of 'Ovals are not.'"),
        (". Ovals are not. S", ""),
        ("Ovals ... Circles", "one: 'Circles' is not in the sentences that it is listed under"),
    ],
)
def test_a_quote_holds_a_piece_of_each_of_its_sentences_if_only_a_letter(quote, wanted):
    texts = [text for _, text in TEXTS]
    under = [Sentence("1", text[:4], "", claims=("one",)) for text in texts]
    assert _misquoted(replace(ONE, quote=quote), texts, under) == wanted


def test_a_misprint_is_mended_in_each_text_where_it_stands_once():
    mended = lambda printed: judges.mended(claim(printed), "2", "3").printed  # noqa: E731
    assert mended("2*lam") == "3*lam"
    assert mended("2*lam + 2") == "2*lam + 2"
    assert mended("lam") == "lam"
    assert mended(["2", "22", "lam"]) == ["3", "22", "lam"]
    assert mended([["2", "1"], ["2*2", "lam"]]) == [["3", "1"], ["2*2", "lam"]]


def test_an_identity_says_what_is_derived_and_judges_what_is_mended():
    plain = judges.identity(claim("2*lam"), 2 * lam)
    assert (plain.derived, plain.mended, plain.erratum) == ("2*lam", None, "")
    wrong = judges.identity(claim(["2*lam", "1"]), Matrix([3 * lam, 1]), ("2", "3"), "misprint")
    assert (wrong.derived, wrong.erratum, wrong.verdict) == ("[[3*lam], [1]]", "misprint", Verdict.CORRECTED)
    assert wrong.printed.reason == "entry (1, 1): at lam = 2/9 the two differ by -0.222222"


@pytest.mark.parametrize("kind", [Matrix, ImmutableMatrix])
def test_matrices_are_equal_entry_by_entry_and_of_one_shape(kind):
    left, other = Matrix([[lam, 1], [0, lam**2]]), kind([[lam, 1], [0, lam * lam]])
    assert judges.equal(left, other, {}).outcome is judges.equal(other, left, {}).outcome is Outcome.PROVED
    off = judges.equal(left, kind([[lam, 1], [3, lam * lam]]), {})
    assert (off.outcome, off.reason.partition(":")[0]) == (Outcome.REFUTED, "entry (2, 1)")
    off = judges.equal(kind([[lam, 5], [0, lam * lam]]), left, {})
    assert (off.outcome, off.reason) == (Outcome.REFUTED, "entry (1, 2): at this number the two differ by 4.00000")
    shapes = judges.equal(left, kind([[lam, 1]]), {})
    assert (shapes.outcome, shapes.reason) == (Outcome.REFUTED, "the shapes (2, 2) and (1, 2) differ")


def test_two_formulas_are_one_or_differ_at_a_witness_or_neither_is_known():
    assert judges.equal((lam + 1) ** 2, lam**2 + 2 * lam + 1, {}) == Finding(Outcome.PROVED, "exact reduction to 0")
    assert judges.equal(lam + 1, lam, {}).outcome is Outcome.REFUTED
    assert judges.equal(lam, -lam, {}).outcome is Outcome.REFUTED
    assert judges.equal(pi, S(3), {}).reason == "at this number the two differ by 0.141593"
    found = judges.equal(lam, 2 * lam, {lam: Interval(2, 11)})
    assert (found.reason, dict(found.at)) == ("at lam = 4 the two differ by -4.00000", {lam: S(4)})
    assert judges.equal(log(6), log(2) + log(3), {}).outcome is Outcome.UNKNOWN
    gap = (lam - Rational(3, 10)) * (lam - Rational(2, 9))  # 0 at two witnesses: the third tells them apart
    assert judges.equal(gap, S.Zero, {}).at == ((lam, Rational(4, 11)),)


AT_POLE = 1 / (9 * lam - 2)  # at the first witness


@pytest.mark.parametrize(
    "gap",
    [AT_POLE, log(lam - Rational(2, 9)), sin(AT_POLE), atan(AT_POLE), exp(AT_POLE), abs(AT_POLE) + lam],
    ids=str,
)
def test_where_a_formula_has_a_pole_another_witness_tells(gap):
    """A pole by itself tells nothing: of formulas that are one it says nothing else, and of others the next witness."""
    found = judges.equal(gap, S.Zero, {})
    assert (found.outcome, found.at) == (Outcome.REFUTED, ((lam, Rational(3, 10)),))
    assert judges.equal(gap * (lam + 1), gap * lam + gap, {}).outcome is Outcome.PROVED


def test_of_formulas_with_a_pole_at_each_witness_nothing_is_told_unless_they_are_one():
    poles = AT_POLE / ((10 * lam - 3) * (11 * lam - 4))
    assert judges.equal(poles, 2 * poles, {}).outcome is Outcome.UNKNOWN
    assert judges.equal(poles * (lam + 1), poles * lam + poles, {}).outcome is Outcome.PROVED


def test_witnesses_are_these_shares_of_ranges():
    x, y = symbols("x y")
    assert judges.witnesses([x], {}) == [{x: Rational(2, 9)}, {x: Rational(3, 10)}, {x: Rational(4, 11)}]
    second = [{y: 5 + Rational(k + 3, k + 11) * 3} for k in range(3)]
    first = [{x: 1 + Rational(k + 2, k + 9) * 2} for k in range(3)]
    found = judges.witnesses([y, x], {x: Interval(1, 3), y: Interval(5, oo)})
    assert found == [a | b for a, b in zip(first, second, strict=True)]


@pytest.mark.parametrize(
    ("decimal", "value", "outcome"),
    [
        ("1.4", Rational(1449, 1000), Outcome.PROVED),
        ("1.4", Rational(1351, 1000), Outcome.PROVED),
        ("1.4", Rational(1451, 1000), Outcome.REFUTED),
        ("1.4", Rational(1349, 1000), Outcome.REFUTED),
        ("-1.4", -Rational(1449, 1000), Outcome.PROVED),
        ("-1.4", Rational(7, 5), Outcome.REFUTED),
        ("3", pi, Outcome.PROVED),
        ("3.14159", pi, Outcome.PROVED),
        ("3.14160", pi, Outcome.REFUTED),
        ("1", Rational(3, 2), Outcome.UNKNOWN),  # a tie, without any rounding
        ("2", Rational(3, 2), Outcome.UNKNOWN),
        ("40", S(41), Outcome.REFUTED),
    ],
)
def test_a_decimal_shows_a_number_to_half_of_its_last_place(decimal, value, outcome):
    assert judges.rounded(decimal, value).outcome is outcome


def test_what_a_decimal_should_show_is_said_with_six_digits_more():
    assert judges.rounded("3.14", pi).reason == "the true value 3.1415927... rounds to 3.14"
    assert judges.rounded("3.15", pi).reason == "the true value 3.1415927... does not round to 3.15"
    assert judges.rounded("1", Rational(3, 2)).reason == "the enclosure does not decide the rounding"
    plain = judges.digits(claim("3.14"), pi)
    assert (plain.derived, plain.value, plain.mended, plain.verdict) == ("pi", pi, None, Verdict.CONFIRMED)
    balls = lambda places: judges.real_ball(sqrt(Integer(2)), places)  # noqa: E731
    mended = judges.digits(claim("1.42"), balls, ("1.42", "1.41"))
    assert (mended.derived, mended.erratum) == ("1.41421356237310...", "1.42 should read 1.41")
    assert mended.verdict is Verdict.CORRECTED


def test_a_statement_over_a_range_is_asked_of_what_is_printed_and_of_where_it_holds():
    asked = []
    over = claim(over=(("lam", "[0, 1]"), ("alpha", "2/25")))
    prove = lambda box: asked.append(dict(box)) or PROVED  # noqa: E731
    assert judges.on_range(over, prove, "derived").mended is None
    found = judges.on_range(over, prove, "derived", {lam: Interval.Ropen(0, 1)}, "open")
    assert (found.derived, found.erratum, found.mended) == ("derived", "open", PROVED)
    assert asked == [over.box, over.box, {**over.box, lam: Interval.Ropen(0, 1)}]


def test_an_argument_is_said_where_it_is_proved_and_a_counterexample_always():
    assert judges.by("so", PROVED).reason == "so [proved]"
    assert judges.by("so", UNKNOWN).reason == "unknown"
    found = judges.counterexample("here", PROVED, at={lam: S.Half})
    assert (found.outcome, found.reason, found.at) == (Outcome.REFUTED, "here [proved]", ((lam, S.Half),))
    assert judges.counterexample("here", UNKNOWN).outcome is Outcome.UNKNOWN
    assert judges.counterexample("here", PROVED).at == ()
    assert judges.zero("so", lam - lam) == Finding(Outcome.PROVED, "so")
    assert judges.zero("", lam - lam).reason == "exact reduction to 0"
    assert judges.zero("so", lam).reason == "at lam = 2/9 the two differ by 0.222222"


@pytest.mark.parametrize(
    ("left", "right", "outcome"),
    [
        (Rational(3, 2), S.One, Outcome.PROVED),
        (S.One, S.One, Outcome.REFUTED),
        (S.One, Rational(3, 2), Outcome.REFUTED),
        (-S(5), -S(3), Outcome.REFUTED),
        (-S(3), -S(5), Outcome.PROVED),
        (log(6), log(2) + log(3), Outcome.UNKNOWN),
    ],
)
def test_one_number_is_greater_than_another_or_is_not(left, right, outcome):
    assert judges.greater(left, right).outcome is outcome


def test_decisions_answers_and_samples_are_findings():
    wanted = {True: Outcome.PROVED, False: Outcome.REFUTED, None: Outcome.UNKNOWN}
    assert {holds: judges.shown("", holds).outcome for holds in wanted} == wanted
    assert [judges.answer(holds, "").outcome for holds in (True, False, None)] == [
        *(Outcome.PROVED, Outcome.UNKNOWN, Outcome.UNKNOWN)
    ]
    agrees, differs = judges.sampled("so", "seen", True), judges.sampled("so", "seen", False)
    assert (agrees.verdict, differs.verdict) == (Verdict.SUPPORTED, Verdict.OPEN)
    assert (agrees.evidence, differs.evidence) == ("seen", "")
    assert agrees.printed.reason == differs.printed.reason == "seen"


def test_a_step_of_logic_is_said_or_where_it_fails():
    p, q = symbols("p q")
    assert judges.implied("so", (p & q) >> p) == Finding(Outcome.PROVED, "so")
    found = judges.implied("so", p >> q)
    assert (found.outcome, found.reason) == (Outcome.REFUTED, "it fails where p is True, q is False")


def test_a_formula_is_told_on_one_line():
    assert judges.text_of(Matrix([[1, lam]])) == "[[1, lam]]"
    assert judges.text_of(2 * lam) == "2*lam"
