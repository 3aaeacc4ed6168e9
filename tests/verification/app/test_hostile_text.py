"""Any typed text gives an answer or one sentence of refusal; and JSON output is valid JSON."""

import json
import sys

import pytest

from verification.app.cli import main

DEEP, LONG = "(" * 10_000, "1" * 10**6
ODD = ("", " ", "nan", "inf", "=", "1/0", "\u0661/\u0662", "\u00b2", "\uff11", "\x1b[31m", "-1", "1," * 500, "0:1:0")
LARGE = (DEEP, LONG, "x" * 10**6, "theta" + "+theta" * 20_000, "sin(" * 300 + "theta" + ")" * 300)
EXTREME = ("1e999999999", "1e-400", "2**2**2**2**2**2", "10**10**10", "1e300,0", "sqrt(-1)", "log(0)", "b=1:2..1")
TEXTS = (*ODD, *LARGE, *EXTREME, "cos(theta)**(10**9)")
OPTIONS = ("--lam", "--a", "--start", "--from", "--starts", "--fields", "--component", "--bounces", "--digits",
           "--tolerance", "--out", "--json", "--plot", "--law", "--shape", "--polar", "--K")  # fmt: skip


@pytest.mark.parametrize("option", OPTIONS)
def test_text_that_is_none_of_what_is_accepted_is_refused_in_a_sentence(option, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    given = {"--lam": "1/2", "--a": "3/2", "--start": "0.3,0.2", "--bounces": "2"}
    for text in TEXTS:
        words = {**given, option: text} | ({"--towards": "1,0"} if option == "--from" else {})
        if option in ("--from", "--starts"):
            del words["--start"]
        table = [] if option == "--polar" else ["ellipse"]
        if option == "--polar":
            del words["--a"]
        status = main(["orbit", *table, *(f"{name}={value}" for name, value in words.items())])
        said = capsys.readouterr().err

        assert status in (0, 1, 2), (option, text[:40])
        assert "an unexpected" not in said, (option, text[:40], said)
        assert said.count("\n") == (status == 2), (option, text[:40], said)


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("orbit", "--bounces"), ("orbit", "--digits"), ("orbit", "--K"), ("lyapunov", "--seed"), ("cycles", "--period"),
        ("attractor", "--orbits"), ("basins", "--columns"), ("report", "--period"), ("morse", "--rows"),
        ("verify", "--digits"), ("follow", "--points"),
    ],
)  # fmt: skip
def test_a_whole_number_with_a_million_digits_is_refused_unread(command, option, capsys):
    """Also where Python's own limit is lifted, with which reading the number takes some 20 seconds."""
    before = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)
    try:
        assert main([command, *(["circle"] if command != "verify" else []), option, LONG]) == 2
    finally:
        sys.set_int_max_str_digits(before)
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "has 1000000 digits; accepted: integers from" in said


@pytest.mark.parametrize("a", ["1e20", "1e160", "1e300"])
def test_numbers_that_are_not_finite_are_null_in_json_and_a_table_too_flat_is_refused(a, capsys):
    status = main(["orbit", "ellipse", "--a", a, "--lam", "1/2", "--start", "0.3,0.2", "--bounces", "2", "--json", "-"])

    out = capsys.readouterr().out
    assert (status == 2) == (out == "") == (a != "1e20")
    json.loads(out or "null", parse_constant=pytest.fail)


@pytest.mark.parametrize("option", ["--scene", "--data"])
def test_a_file_that_does_not_end_is_refused(option, capsys):
    assert main(["orbit", option, "/dev/zero", "--lam", "1/2", "--start", "0.3,0.2"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
