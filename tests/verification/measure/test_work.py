"""Work-precision diagrams: the Pareto front, kept promises, visible faults, and choices that follow the table."""

import json
import math
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise

import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from numeric import PinballMap
from verification.app.cli import main
from verification.maps.exact import ExactMap
from verification.measure.work.bench import module
from verification.measure.work.choice import QUESTIONS, cheapest, crossovers, digits_lost, entries, question, table
from verification.measure.work.exponents import proved
from verification.measure.work.question import Method, Question, measured
from verification.measure.work.row import front, plain, timed

QUICK = ("step-egg", "step-cardioid", "jacobian", "cycle-2", "cycle-3", "lambda-star", "fold-3", "slap-infimum")
MORE = ("exponent-cycle", "arclength", "arclength-inverse")
DIGITS = 30


def finest(name, textbook):
    """A question with its methods, each at its finest setting of at most 30 digits.

    A difference quotient has its least error at some middle step, so it keeps all settings.
    """
    asked = question(name)
    methods = [m for m in asked.methods if m.textbook is textbook]
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


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK + MORE)
def test_every_way_of_this_package_keeps_its_promise_at_its_finest_setting(name):
    rows = measured(finest(name, textbook=False), runs=1, most_digits=DIGITS)

    assert len(rows) >= 3
    assert [f"{row.method} {row.setting}: {row.error}" for row in rows if row.promise and not row.kept] == []


@pytest.mark.slow
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


@pytest.mark.slow
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


def test_the_page_says_what_the_committed_rows_say():
    benchmark = module("work_precision")
    document = json.loads(benchmark.DATA.read_text())

    assert benchmark.PAGE.read_text() == benchmark.page(document)
    assert set(document["questions"]) == set(QUESTIONS)
    assert all((benchmark.FIGURES / f"work-{name}.svg").stat().st_size < 150_000 for name in QUESTIONS)


def test_pinball_work_writes_rows_table_and_diagram(tmp_path, capsys):
    target = tmp_path / "diagram.svg"
    arguments = ["work", "cycle-2", "--most-digits", "16", "--runs", "1", "--json", str(tmp_path / "rows.json")]
    status = main([*arguments, "--out", str(target)])
    printed = capsys.readouterr().out
    document = json.loads((tmp_path / "rows.json").read_text())

    assert status == 0
    assert "single shooting" in printed
    assert f"\nvalue {math.pi / 3:.14f}" in printed
    assert target.read_bytes().startswith(b"<?xml")
    assert document["questions"][0]["name"] == "cycle-2"
    assert {row["method"] for row in document["rows"]} >= {"float64, Newton", "arb, certified"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["fold-4"], "QUESTION = fold-4 is none that is measured; accepted: step-egg"),
        (["--out", "x.png"], "--plot x.png needs one QUESTION, as a diagram shows one; accepted: step-egg, "),
        (["fold-3", "--out", "x.txt"], "accepted: .png, .pdf, .svg"),
        (["fold-3", "--most-digits", "5"], "16<=x<=1000"),
    ],
)
def test_bad_input_is_refused_before_anything_is_measured(arguments, said, capsys):
    assert main(["work", *arguments]) == 2
    assert said in capsys.readouterr().err
