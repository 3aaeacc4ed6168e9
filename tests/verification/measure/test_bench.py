"""`pinball bench`: every arithmetic has a row, its error is measured, and the diagram spans them all."""

import json
import sys
from decimal import Decimal
from types import ModuleType

import numpy as np
import pytest
from rich.console import Console

from numeric import PinballMap
from numeric.sweeps.run import on_threads
from symbolic import tables
from verification.app.cli import main
from verification.app.commands.bench import show_ratios, show_tables
from verification.measure.extremes.by_hand import outline
from verification.measure.extremes.orbits import cases, own_cases
from verification.measure.work import bench as baselines
from verification.measure.work import calls, scaling
from verification.measure.work.bench import LAWS, Row, frontier, multiprecision_rows
from verification.measure.work.calls import Call
from verification.measure.work.row import HEIGHT, WIDTH, diagram, magnitude

NO = ("--no-baselines", "--no-calls")


@pytest.fixture(scope="module")
def document(tmp_path_factory):
    """What `pinball bench` writes for one table."""
    path = tmp_path_factory.mktemp("bench") / "bench.json"
    question = [
        "--scene",
        "circle",
        "--digits",
        "20",
        "--digits",
        "1000",
        "--runs",
        "1",
        "--no-baselines",
        "--no-calls",
    ]
    assert main(["bench", *question, "--json", str(path)]) == 0
    return json.loads(path.read_text())


def test_bench_has_rows_for_every_arithmetic_and_kernel(document):
    names = {"scene", "arithmetic", "kernel", "error", "error_unit", "seconds_per_bounce", "runs"}

    assert all(set(row) == names for row in document["rows"])
    assert {row["arithmetic"] for row in document["rows"]} == {"float64", "mpmath", "arb"}
    kernels = {row["kernel"] for row in document["rows"]}
    assert {"llvm", "llvm, exponents", "llvm, 2 threads", "numpy", "llvm, lam = 0", "llvm, lam = 1"} <= kernels
    assert {"processor", "python", "numpy", "python-flint", "mpmath"} <= set(document["machine"])


def test_an_error_that_no_float_holds_is_a_decimal_string(document):
    errors = {row["kernel"]: row["error"] for row in document["rows"] if row["arithmetic"] == "arb"}

    assert isinstance(errors["20 digits"], float)
    assert isinstance(errors["1000 digits"], str)
    assert Decimal("1e-990") < Decimal(errors["1000 digits"]) < Decimal("1e-980")  # of 2**-52


def test_the_hard_cases_of_the_table_are_within_the_bounds(document):
    cases = document["accuracy"]

    assert {case["case"] for case in cases} >= {"random", "grazing to 1e-12", "lam = 0", "lam = 1e-300", "lam = 1"}
    assert all(case["position"] <= 4 and case["direction"] <= 8 for case in cases)


QUICK = (
    "bench",
    "--scene",
    "circle",
    "--digits",
    "20",
    "--runs",
    "1",
    "--no-baselines",
    "--no-accuracy",
    "--no-calls",
    "--json",
)


def test_bench_says_what_moved_since_another_run(tmp_path, capsys):
    before, after = tmp_path / "before.json", tmp_path / "after.json"
    assert main([*QUICK, str(before)]) == 0
    told = json.loads(before.read_text())
    for row in told["rows"]:
        if row["kernel"] == "numpy":
            row["error"] = float(row["error"]) / 1e6
        row["seconds_per_bounce"] *= 1e6 if row["kernel"] == "llvm, exponents" else 1
    told["rows"][-1]["kernel"] = "by hand"
    before.write_text(json.dumps(told))

    assert main([*QUICK, str(after), "--compare", str(before)]) == 1
    moved = json.loads(after.read_text())["moved"]
    shown = capsys.readouterr().out
    assert {"circle: arb by hand  is gone", "circle: arb 20 digits  is new"} <= set(moved)
    assert any(line.startswith("circle: float64 numpy  is off by") for line in moved)
    assert any(line.startswith("circle: float64 llvm, exponents  is") and "quicker" in line for line in moved)
    assert all(line in " ".join(shown.split()) for line in (" ".join(line.split()) for line in moved))


def test_a_file_that_is_no_run_is_refused(tmp_path, capsys):
    (tmp_path / "no.json").write_text('{"rows": [{"scene": "circle"}]}')

    assert main(["bench", "--compare", str(tmp_path / "no.json")]) == 2
    assert main(["bench", "--compare", str(tmp_path / "none.json")]) == 2
    assert capsys.readouterr().err.count("accepted: a file of pinball bench --json") == 2


@pytest.mark.parametrize("name", ["ellipse", "egg"])
def test_errors_of_many_digits_are_measured(name):
    """A number below 10 rounded to `n` digits is off by `10**-n/2` to `5 * 10**-n` where rounding is all there is."""
    for row in multiprecision_rows(name, (20, 400)):
        digits = int(row.kernel.split()[0])
        error = magnitude(row.error)

        assert -digits - 1.5 < error < -digits + 0.8


@pytest.mark.parametrize("own", [False, True])
def test_every_labelled_case_has_balls_inside(own):
    found = list(own_cases("limacon", 5) if own else cases(5))

    assert len({case.label for case in found}) == len(found)
    for case in found:
        low, high = np.array(case.map.states.ends)[case.component].T
        assert np.all((low <= case.theta) & (case.theta <= high))
        assert np.all(np.abs(case.phi) < np.pi / 2)


def test_tables_that_are_not_the_papers_are_told_as_multiples_of_the_egg_of_the_same_run(capsys):
    ways = [("egg", "llvm", 2), ("egg", "llvm, exponents", 4), ("star", "llvm", 5), ("star", "llvm, exponents", 8)]
    show_ratios(Console(), [Row(scene, "float64", kernel, None, seconds, 1) for scene, kernel, seconds in ways])

    assert capsys.readouterr().out.splitlines()[-1].split() == ["star", "2.50", "2.00", "-"]


@pytest.fixture(scope="module")
def scalar():
    """The loops that numba compiles, as plain Python: they are read in the same way, and need no numba."""
    with pytest.MonkeyPatch.context() as patch:
        plain = ModuleType("numba")
        plain.njit = lambda function: function
        patch.setitem(sys.modules, "numba", plain)
        return baselines.module("scalar_numba")


SMALL = {  # of the same pieces as tables that take longer to make
    "heptagon": lambda: PinballMap(tables.regular(7), lam="19/20"),
    "oval": lambda: PinballMap(outline(6, 0.03, "oval"), lam="19/20"),
    "dented": lambda: PinballMap(outline(9, 0.2, "dented"), lam="19/20"),
}
ALIKE = ("square", "triangle", "stadium", "sinai", "egg_polynomial", "egg_sine", *SMALL)


@pytest.mark.parametrize("name", ALIKE)
def test_a_scalar_loop_lands_where_the_map_lands(name, scalar):
    map = SMALL[name]() if name in SMALL else calls.compared(name, "19/20")
    rng, component = np.random.default_rng(4), np.arange(20) % len(map.states.ends)  # every piece is left
    theta, phi = rng.uniform(*np.array(map.states.ends)[component].T), rng.uniform(-1.4, 1.4, 20)
    pieces, places, angles = baselines.scalar_way(scalar, name, map)(theta, phi, component, 3)

    for i, ball in enumerate(zip(component, theta, phi, strict=True)):
        where, at, out = int(ball[0]), float(ball[1]), float(ball[2])
        for _ in range(3):
            landing = map.step(at, out, where)
            where, at, out = int(landing.component), float(landing.theta), float(landing.phi)
            assert landing.code == 0
        assert where == pieces[i]
        assert abs(np.sin((at - places[i]) / 2)) < 5e-10
        assert abs(out - angles[i]) < 1e-9


def test_tables_are_told_as_multiples_with_their_bars_and_what_is_over_one_fails(capsys):
    times = {"egg": 20, "square": 10, "stadium": 21, "regular100": 50, "discs36": 80}
    rows = [Row(name, "float64", calls.KERNEL, None, seconds, 1) for name, seconds in times.items()]
    loops = [Row(name, "float64", baselines.SCALAR, None, 400, 1) for name in times]

    assert not show_tables(Console(width=120), [*rows, *loops])
    shown = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines() if " of the " in line}
    assert shown["square"][1:6] == ["0.50", "0.6", "of", "the", "egg"]
    assert shown["stadium"][1:4] == ["1.05", "1", "*"]
    assert shown["regular100"][1:6] == ["5.00", "6", "of", "the", "square"]
    assert shown["discs36"][1:3] == ["8.00", "-"]
    assert [line[-1] for line in shown.values()] == ["20.0", "40.0", "19.0", "8.0", "5.0"]

    assert show_tables(Console(width=120), [row for row in rows if row.scene != "stadium"])
    said = capsys.readouterr().out
    assert "it needs numba" in said
    assert all(line.split()[-1] == "-" for line in said.splitlines() if " of the " in line)


def test_tables_are_measured_without_numba_and_every_one_that_has_a_bar_can_be_compared(monkeypatch):
    monkeypatch.setattr(calls, "module", lambda name: None)
    rows = list(calls.table_rows(1, names=("circle",)))

    assert [(row.scene, row.kernel) for row in rows] == [("circle", calls.KERNEL)]
    assert rows[0].seconds_per_bounce > 0
    assert {against for against, _ in calls.BARS.values()} <= {*calls.BARS}


def row(error, seconds, lam=LAWS["pinball"]):
    return Row("table", "float64", "kernel", None if error is None else Decimal(error), seconds, 1, lam)


def test_the_front_is_what_nothing_beats_in_the_same_task():
    rows = [row("1", 1.0), row("2", 2.0), row("1e-1000", 3.0), row("1e-999", 4.0), row(None, 0.1), row("0", 0.1, 0)]

    assert frontier(rows) == {0, 2}


def test_a_diagram_spans_a_thousand_digits_and_marks_the_front():
    lines = diagram([(1e-9, Decimal("1.5")), (1e-3, Decimal("1e-85")), (1e-2, Decimal("1e-985"))], {2}).splitlines()
    letters = {
        letter: (i, line.index(letter)) for i, line in enumerate(lines[:HEIGHT]) for letter in "abC" if letter in line
    }

    assert letters["a"][0] == 0
    assert letters["C"] == (HEIGHT - 1, lines[0].index("|") + WIDTH)
    assert 0 < letters["b"][0] < HEIGHT - 1
    assert lines[HEIGHT - 1].strip().startswith("1e-1001")


def test_a_diagram_of_like_errors_is_plain():
    lines = diagram([(1e-9, Decimal(1)), (2e-9, Decimal(10))]).splitlines()

    assert lines[0].strip().startswith("2e-15")
    assert lines[HEIGHT - 1].strip().startswith("2e-16")


def test_an_installed_package_looks_for_no_benchmarks_beside_it(tmp_path, monkeypatch):
    (tmp_path / "benchmarks").mkdir()
    (tmp_path / "benchmarks" / "textbook.py").write_text("raise SystemExit('not ours')")
    monkeypatch.setattr(baselines, "ROOT", tmp_path)
    monkeypatch.setattr(baselines, "FOLDER", tmp_path / "benchmarks")

    assert baselines.module("textbook") is None


def test_bench_says_where_its_baselines_are(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(baselines, "ROOT", tmp_path)
    asked = ["bench", "--scene", "circle", "--digits", "20", "--runs", "1"]
    assert main([*asked, "--no-accuracy", "--no-calls"]) == 0

    assert baselines.MISSING in " ".join(capsys.readouterr().out.split())


def test_a_call_over_its_bar_is_marked_and_is_a_failure(monkeypatch, capsys, tmp_path):
    inside = {"scene": "circle", "against": "the kernel", "reference": 1e-9, "bar": 2.0}
    given = [Call(call="quick", seconds=1.5e-9, **inside), Call(call="slow", seconds=3e-9, **inside)]
    for rows, status in ((given, 1), (given[:1], 0)):
        monkeypatch.setattr(calls, "call_rows", lambda name, runs, rows=rows: rows)
        path = tmp_path / f"{status}.json"
        assert main([*(word for word in QUICK if word != "--no-calls"), str(path)]) == status
        shown = {line.split()[1]: "*" in line for line in capsys.readouterr().out.splitlines() if "the kernel" in line}

        assert shown == {row.call: row.call == "slow" for row in rows}
        assert [row["ratio"] for row in json.loads(path.read_text())["calls"]] == [row.ratio for row in rows]


def test_a_ball_at_rest_is_compared_with_the_same_ball_on_its_way():
    row = calls.at_rest("circle", 1, sizes=(32, 10, 100))

    assert (row.call, row.bar) == ("exponents, 100 bounces", 1.1)
    assert 0 < row.ratio < 100


def test_balls_come_to_rest_on_tables_of_every_kind(monkeypatch):
    monkeypatch.setattr(calls, "FEW_AT_REST", (8, 10, 20))
    rows = [*calls.call_rows("conic", 1), *calls.pieces_at_rest(1)]

    assert [row.scene for row in rows] == ["conic", "square", "regular6", "discs36"]
    assert {row.call for row in rows} == {"exponents, 20 bounces"}


def watched_by(worker, *tasks):
    """Results of a worker: when each task began and ended, how long it had waited by then, and what it spent."""
    for began, ended, before, waited, spent in tasks:
        yield (0,), {"notes": np.array([worker, began, ended, before, waited, spent], dtype=float)}


def test_a_worker_loses_what_it_stands_still_and_not_what_it_waits_for_a_core():
    """Of two seconds a task; one stands still for one, the other waits for three; first tasks do not count."""
    first = watched_by(1, (0, 9, 0, 0, 2), (9, 11, 0, 0, 2), (12, 14, 0, 0, 2))
    second = watched_by(2, (0, 2, 0, 0, 2), (2, 7, 0, 3, 2))
    found = scaling.busy(iter([*first, *second]))

    assert found == scaling.Busy(seconds=(14 - 9) + (7 - 2 - 3), spent=6.0, tasks=3)


def test_watched_tasks_say_what_they_find_and_who_found_it():
    sweep = scaling.watched(8)
    results = dict(on_threads(sweep, sweep.indices(), 2))
    found, plain = results[0, 0], sweep.task.task(sweep.part((0, 0)))

    assert len(results) == scaling.TASKS
    assert set(found) == {*plain, "notes"}
    assert all(np.array_equal(found[name], plain[name]) for name in plain)
    assert found["notes"].flat[1] <= found["notes"].flat[2]


@pytest.mark.parametrize("python", [False, True])
def test_tasks_that_wait_go_the_whole_way_of_a_sweep_into_a_store(python):
    """By threads and by processes: each task takes what it waits at least, and its arrays fit the store."""
    assert scaling.by_waiting(scaling.waiting(2, python, seconds=0.05), 2) >= 0.05
