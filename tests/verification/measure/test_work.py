"""Work-precision diagrams: the front is a front, promises are kept, what is broken shows, choices follow the table."""

import json
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from numeric import PinballMap
from verification.app.cli import main
from verification.maps.exact import ExactMap
from verification.measure.work.bench import module
from verification.measure.work.choice import (
    QUESTIONS,
    Entry,
    cheapest,
    crossovers,
    digits_lost,
    entries,
    for_orbit,
    moved,
    question,
    table,
)
from verification.measure.work.exponents import proved
from verification.measure.work.figure import drawn, height, image
from verification.measure.work.question import Claimed, Method, Question, available, distance, measured, sampled
from verification.measure.work.row import Row, front, plain, timed
from verification.measure.work.sought import WITHOUT

QUICK = ("step-egg", "step-cardioid", "jacobian", "cycle-2", "cycle-3", "lambda-star", "fold-3", "slap-infimum")
MORE = ("exponent-cycle", "arclength", "arclength-inverse")
DIGITS = 30
USUAL = {  # what the usual ways get to, at least, in float64
    "step-egg": 1e-14,
    "step-cardioid": 1e-13,
    "jacobian": 1e-5,
    "cycle-2": 1e-14,
    "cycle-3": 1e-14,
    "lambda-star": 1e-14,
    "slap-infimum": 1e-10,
    "arclength": 1e-9,
    "arclength-inverse": 1e-9,
}


def finest(name, textbook):
    """A question with its methods at their finest setting of at most 30 digits, in this process.

    A difference is finest neither at its largest step nor at its smallest, and keeps all.
    """
    asked = question(name)
    methods = [m for m in asked.methods if m.textbook is textbook and not m.elsewhere]
    return replace(
        asked, methods=tuple(m if m.unit == "h" else replace(m, settings=m.within(DIGITS)[-1:]) for m in methods)
    )


def asked_for_a_third(*methods):
    """A question whose answer is 1/3."""
    return Question("third", "A third", "1/3", "of it", lambda digits: [arb(1) / 3], methods)


points = st.tuples(st.integers(1, 6), st.integers(1, 6))


@given(st.lists(points, min_size=1, max_size=12))
def test_nothing_beats_a_row_of_the_front_and_something_beats_every_other(pairs):
    rows = [timed("q", str(i), [float(t)], error=Decimal(e)) for i, (t, e) in enumerate(pairs)]
    best = front(rows)

    def no_worse(one, other):
        return one.seconds <= other.seconds and one.error <= other.error

    for row in rows:
        better = [o for o in rows if no_worse(o, row) and (o.seconds, o.error) != (row.seconds, row.error)]
        assert not (row in best and better)
        assert row in best or any(no_worse(o, row) for o in best)


@pytest.mark.parametrize("name", QUICK + MORE)
def test_every_way_of_this_package_keeps_its_promise_at_its_finest_setting(name):
    rows = measured(finest(name, textbook=False), runs=1, most_digits=DIGITS)

    assert len(rows) >= 3
    assert [f"{row.method} {row.setting}: {row.error}" for row in rows if row.promise and not row.kept] == []


@pytest.mark.parametrize("name", USUAL)
def test_the_usual_ways_agree_with_the_reference_as_far_as_doubles_let_them(name):
    rows = measured(finest(name, textbook=True), runs=1, most_digits=DIGITS)

    best = {row.method: row for row in sorted(rows, key=lambda row: -row.error)}
    assert best
    assert [f"{row.method} {row.setting}: {row.error}" for row in best.values() if not row.error < USUAL[name]] == []


def test_the_exponent_of_chaos_is_proved_to_more_digits_than_a_million_bounces_give():
    asked = question("exponent-chaos")
    settings = {"compiled kernel, error bar": (1_000_000,), "arb, certified": (4,)}
    ways = tuple(replace(m, settings=settings[m.name]) for m in asked.methods if m.name in settings)
    bar, proof = measured(replace(asked, methods=ways, reference=lambda digits: [proved(10)]), runs=1, most_digits=16)

    assert asked.certified
    assert bar.error < 2 * bar.promise
    assert bar.promise < Decimal("1e-3")
    assert proof.kept is True
    assert proof.proved


def test_single_shooting_loses_the_long_unstable_cycle_and_the_chord_system_does_not():
    asked = question("cycle-64")
    kept = [m for m in asked.methods if m.name in ("float64, Newton", "single shooting")]
    rows = measured(replace(asked, methods=tuple(kept)), runs=1, most_digits=16)
    ours, *shot = rows

    assert ours.error < Decimal("1e-13")
    assert all(row.kept is False for row in shot[1:])


def test_a_method_that_is_wrong_by_1e_10_is_shown_as_such():
    right = Method("right", "arb", "digits", (30,), lambda d: [arb(1) / 3], lambda d: Decimal("1e-15"))
    wrong = Method("wrong", "arb", "digits", (30,), lambda d: [arb(1) / 3 + arb("1e-10")], lambda d: Decimal("1e-15"))
    rows = measured(asked_for_a_third(right, wrong), runs=1, most_digits=30)

    assert [row.kept for row in rows] == [True, False]
    assert rows[1].error == pytest.approx(Decimal("1e-10"), rel=Decimal("1e-3"))
    assert [line.rstrip().endswith("!") for line in plain(rows).splitlines()] == [False, False, True]
    assert [entry.method for entry in entries(rows)] == ["right"]


def test_an_answer_that_is_no_number_or_fails_is_a_row_that_says_so():
    def failing(setting):
        raise ValueError("lost on the way")

    ways = [
        Method("nan", "float64", "", ("s",), lambda _: [float("nan")]),
        Method("fails", "float64", "", ("s",), failing),
    ]
    rows = measured(asked_for_a_third(*ways), runs=1, most_digits=20)

    assert [(row.error, row.kept, row.failure) for row in rows] == [
        (None, False, "no finite number"),
        (None, False, "lost on the way"),
    ]
    assert front(rows) == ()


def test_a_reference_too_wide_to_tell_leaves_a_promise_undecided():
    wide = replace(
        asked_for_a_third(Method("bar", "float64", "", ("s",), lambda _: Claimed([0.34], 0.008))),
        reference=lambda digits: [arb("0.333", "0.01")],
    )
    (row,) = measured(wide, runs=1, most_digits=16)

    assert row.promise == Decimal("0.008")
    assert row.kept is None


def test_distances_know_errors_below_every_float():
    assert distance(["1"], [1 + arb(10) ** -999], 1000)[1].adjusted() in (-16, -1000, -999)
    (least, most) = distance([np.longdouble(1) / 4], [arb("0.5")], 20)
    assert least == most == Decimal("0.25")


@given(st.decimals(min_value="1e-1100", max_value=10, allow_nan=False), st.floats(1e-9, 10))
def test_rows_survive_json(error, seconds):
    row = timed("q", "m", [seconds, 2 * seconds], error=+error, promise=Decimal("1e-1000"), setting="s", digits=1000)
    back = Row.from_dict(json.loads(json.dumps(row.to_dict(), allow_nan=False)))

    assert back.seconds == row.seconds
    assert back.promise == row.promise
    assert abs(back.error - row.error) <= abs(row.error) * Decimal("1e-15")
    assert replace(back, error=row.error) == row


@pytest.mark.parametrize("name", [name for name in QUESTIONS if name in table()])
@pytest.mark.parametrize("proof", [False, True])
def test_more_digits_never_cost_less_and_are_always_promised(name, proof):
    if proof and not any(entry.proved for entry in table()[name]):
        with pytest.raises(ValueError, match="has a proof"):
            cheapest(name, 10, proof=True)
        return
    most = max(entry.digits for entry in table()[name] if entry.proved or not proof)
    found = [cheapest(name, digits, proof) for digits in range(1, most + 1)]

    assert all(choice.digits >= digits for digits, choice in enumerate(found, start=1))
    assert all(a.seconds <= b.seconds for a, b in pairwise(found))
    assert len({choice.method for choice in found}) >= len(crossovers(name)) - 2 or proof


entry = st.builds(
    Entry, st.sampled_from("abc"), st.just("arb"), st.just("s"), st.integers(1, 50), st.floats(1e-9, 1), st.booleans()
)


@given(st.lists(entry, min_size=1, max_size=8), st.integers(1, 60))
def test_what_is_picked_is_the_quickest_that_promises_enough(known, digits):
    choice = cheapest("q", digits, measured=known)
    enough = [e for e in known if e.digits >= digits]

    if enough:
        assert choice.seconds == min(e.seconds for e in enough)
        assert f"{choice.method} is quicker and ends" not in choice.why
    else:
        assert choice.digits == max(e.digits for e in known)
        assert "table ends" in choice.why


def test_an_orbit_keeps_float64_while_its_digits_last():
    cardioid = PinballMap("cardioid", lam="0.5")
    start = (0.7, 0.3, 0)
    names = [for_orbit(cardioid, start, bounces, 8).arithmetic for bounces in (1, 10, 30, 100)]

    assert names[0] == "float64"
    assert names[-1] == "arb"
    assert names == sorted(names, key=["float64", "arb"].index)
    assert for_orbit(cardioid, start, 1, 8, proof=True).arithmetic == "arb"
    assert digits_lost(cardioid, start, 100) > 100 * 0.4 / np.log(10)  # its exponent is about 0.6
    assert digits_lost(PinballMap("circle", lam="0.5"), start, 100) < 1  # nothing grows but by what the angle adds


def test_a_rounding_error_counts_from_where_it_is_made():
    early = PinballMap("egg", lam="0.5", alpha="0.08")
    lost = [digits_lost(early, (0.7, 0.3, 0), bounces) for bounces in range(1, 40)]

    assert all(a <= b for a, b in pairwise(lost))


def test_the_digits_of_float64_that_are_left_are_right():
    cardioid, start = PinballMap("cardioid", lam="0.5"), (0.7, 0.3, 0)
    exact = ExactMap(cardioid, 30, Fraction(1, 2))
    truth = exact.orbit(exact.start(*start), 20)
    found = cardioid.orbit(*start[:2], 20)
    off = [
        abs(float(bounce.theta - exact.context.mpf(float(theta))))
        for bounce, theta in zip(truth, found.theta, strict=True)
    ]

    assert max(off) > 1e-13  # digits are lost
    assert all(error < 10 ** (digits_lost(cardioid, start, n) - 14) for n, error in enumerate(off) if n)


def test_a_slower_machine_is_no_change_and_a_slower_method_or_question_is():
    def run(name, *seconds):
        return [timed(name, letter, [t, t], error=Decimal("1e-9")) for letter, t in zip("abc", seconds, strict=False)]

    rows = run("q", 1.0, 3.0, 5.0) + run("r", 1.0, 1.0, 1.0) + run("s", 2.0, 2.0, 2.0)
    slow = run("q", 7.0, 21.0, 35.0) + run("r", 7.0, 7.0, 7.0) + run("s", 14.0, 14.0, 14.0)
    worse = run("q", 7.0, 42.0, 35.0) + slow[3:]
    whole = run("q", 14.0, 42.0, 70.0) + slow[3:]
    wrong = [replace(slow[0], error=Decimal("1e-6")), *slow[1:]]

    assert moved(rows, slow) == []
    assert moved(rows, worse) == ["q: b  is 2 times slower: 42 s"]
    assert moved(rows, whole) == ["q: as a whole it is 2 times slower"]
    assert moved(rows, wrong) == ["q: a  is off by 1e-6, it was 1e-9"]
    assert moved(rows, slow[:2] + slow[3:]) == ["q: c  is gone"]


def test_without_gmpy2_mpmath_finds_the_same_digits_in_another_process():
    ways = [m for m in question("step-cardioid").methods if m.name == WITHOUT]
    if not available():
        assert ways == []  # mpmath is without it anyway
        return
    (way,) = ways
    ((answer, seconds, failure),) = sampled("step-cardioid", WITHOUT, [40], 1)

    assert failure == ""
    assert seconds[0] > 0
    assert distance(answer, way.call(45), 40)[1] < Decimal("1e-40")


def test_a_diagram_has_a_line_for_each_method_and_errors_in_order():
    rows = [
        timed("q", name, [t], error=Decimal(e), setting=e, promise=Decimal("1e-18"))
        for name, t, e in (("a", 1e-6, "1e-16"), ("b", 1e-3, "1e-30"), ("b", 1e-2, "1e-1000"))
    ]
    figure, again = (drawn("Title", "radians", rows, {"machine": "here"}) for _ in range(2))
    (axes,) = figure.axes
    labels = [text.get_text() for text in axes.get_legend().get_texts()]

    assert labels == ["a", "b", "Pareto front"]
    assert height(-1000.0, True) < height(-30.0, True) < height(-1.0, True)
    assert image(figure) == image(again)


def test_the_page_says_what_the_committed_rows_say():
    benchmark = module("work_precision")
    document = json.loads(benchmark.DATA.read_text())

    assert benchmark.PAGE.read_text() == benchmark.page(document)
    assert set(document["questions"]) == set(QUESTIONS)
    assert all((benchmark.FIGURES / f"work-{name}.svg").stat().st_size < 150_000 for name in QUESTIONS)


def test_pinball_work_writes_rows_table_and_diagram(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("verification.measure.work.sought.available", lambda: False)
    target = tmp_path / "diagram.svg"
    arguments = ["work", "cycle-2", "--most-digits", "16", "--runs", "1", "--json", str(tmp_path / "rows.json")]
    status = main([*arguments, "--out", str(target)])
    printed = capsys.readouterr().out
    document = json.loads((tmp_path / "rows.json").read_text())

    assert status == 0
    assert "single shooting" in printed
    assert target.read_bytes().startswith(b"<?xml")
    assert document["questions"][0]["name"] == "cycle-2"
    assert {row["method"] for row in document["rows"]} >= {"float64, Newton", "arb, certified"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["fold-4"], "QUESTION = fold-4 is none that is measured; accepted: step-egg"),
        (["--out", "x.png"], "--out x.png needs one QUESTION"),
        (["fold-3", "--out", "x.txt"], "accepted: .png, .pdf, .svg"),
        (["fold-3", "--most-digits", "5"], "16<=x<=1000"),
    ],
)
def test_bad_input_is_refused_before_anything_is_measured(arguments, said, capsys):
    assert main(["work", *arguments]) == 2
    assert said in capsys.readouterr().err
