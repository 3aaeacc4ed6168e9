"""`pinball bench`: each arithmetic has a row with a measured error, and changed results are reported."""

import json
from decimal import Decimal

import pytest

from verification.app.cli import main
from verification.measure.work.bench import multiprecision_rows
from verification.measure.work.plain import QUESTIONS, asked_rows
from verification.measure.work.row import magnitude


@pytest.fixture(scope="module")
def document(tmp_path_factory):
    """The JSON document that `pinball bench` writes for one table."""
    path = tmp_path_factory.mktemp("bench") / "bench.json"
    question = "bench --scene circle --digits 20 --digits 1000 --runs 1 --no-baselines --no-calls --json"
    assert main([*question.split(), str(path)]) == 0
    return json.loads(path.read_text())


@pytest.mark.slow
def test_bench_has_rows_for_every_arithmetic_and_kernel(document):
    names = {"scene", "arithmetic", "kernel", "error", "error_unit", "seconds_per_bounce", "runs"}

    assert all(set(row) == names for row in document["rows"])
    assert {row["arithmetic"] for row in document["rows"]} == {"float64", "mpmath", "arb"}
    kernels = {row["kernel"] for row in document["rows"]}
    assert {"llvm", "llvm, exponents", "llvm, 2 threads", "numpy", "llvm, lam = 0", "llvm, lam = 1"} <= kernels
    assert {"processor", "python", "numpy", "python-flint", "mpmath"} <= set(document["machine"])


@pytest.mark.slow
def test_an_error_that_no_float_holds_is_a_decimal_string(document):
    errors = {row["kernel"]: row["error"] for row in document["rows"] if row["arithmetic"] == "arb"}

    assert isinstance(errors["20 digits"], float)
    assert isinstance(errors["1000 digits"], str)
    assert Decimal("1e-990") < Decimal(errors["1000 digits"]) < Decimal("1e-980")  # of 2**-52


def test_the_hard_cases_of_the_table_are_within_the_bounds(document):
    cases = document["accuracy"]

    assert {case["case"] for case in cases} >= {"random", "grazing to 1e-12", "lam = 0", "lam = 1e-300", "lam = 1"}
    assert all(case["position"] <= 4 and case["direction"] <= 8 for case in cases)


QUICK = [
    *["bench", "--scene", "circle", "--digits", "20", "--runs", "1", "--no-baselines", "--no-accuracy", "--no-calls"],
    "--json",
]


@pytest.mark.slow
def test_orbits_have_the_digits_of_the_plain_script():
    rows = list(asked_rows(1, [one for one in QUESTIONS if one.digits == 30]))  # `ValueError` where they differ

    assert [row.against for row in rows] == ["landing(1000, 30)"] * 2


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ellipse", "egg"])
def test_errors_of_many_digits_are_measured(name):
    """A number below 10, rounded to `n` digits, is off by `10**-n/2` to `5 * 10**-n` if nothing else errs."""
    for row in multiprecision_rows(name, (20, 400)):
        digits = int(row.method.split()[0])
        error = magnitude(row.error)

        assert -digits - 1.5 < error < -digits + 0.8
