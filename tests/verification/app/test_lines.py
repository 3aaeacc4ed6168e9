"""The printed output of commands fits 80 columns, with events before tables."""

import re

import pytest

from verification.app.cli import main
from verification.app.lines import of_bounces

EGG = ("egg", "--alpha", "0.08")
PRINTED = {
    "one component": ("orbit", *EGG, "--lam", "1/2", "--start", "0.3,0.2"),
    "four components": ("orbit", "stadium", "--lam", "9/10", "--start", "0.5,-0.2"),
    "fifty digits": ("orbit", *EGG, "--lam", "1/2", "--start", "0.3,0.2", "--arithmetic", "arb", "--bounces", "3"),
    "a join": ("orbit", "square", "--lam", "1/2", "--start", "1/2,atan(1/2)"),
    "a branch": ("follow", *EGG, "--cycle", "triangle", "--lam", "0.37:1"),
    "cycles": ("cycles", *EGG, "--lam", "1/2", "--period", "3"),
}


@pytest.mark.parametrize("command", PRINTED.values(), ids=PRINTED)
def test_a_table_fits_eighty_columns(command, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    main(list(command))
    lines = capsys.readouterr().out.splitlines()
    numbers = [line for line in lines if re.match(r" *(bounce|-?\d)", line)]
    assert len(numbers) >= 4
    assert max(map(len, numbers)) <= 80


SENTENCES = {
    "a search": ("cycles", *EGG, "--lam", "1/2", "--period", "2"),
    "exponents": ("lyapunov", "cuspless", "--lam", "0.8", "--bounces", "100", "--orbits", "20"),
    "attractors": ("attractor", *EGG, "--lam", "0.6", "--orbits", "20", "--certify"),
    "sets": ("morse", "circle", "--lam", "1/2", "--columns", "16", "--rows", "8"),
    "a checklist": ("locate", "lambda-star", "--digits", "50"),
    "figures": ("figure", "--list"),
    "an error": ("locate", "nothing"),
}


@pytest.mark.slow
@pytest.mark.parametrize("command", SENTENCES.values(), ids=SENTENCES)
def test_sentences_break_at_words_on_a_terminal_and_stand_on_one_line_in_a_file(command, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    status = main(list(command))
    whole = capsys.readouterr()
    monkeypatch.setenv("FORCE_COLOR", "1")  # Rich then writes as to a terminal
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    assert main(list(command)) == status
    broken = capsys.readouterr()

    one, two = (said.out + (said.err if status == 2 else "") for said in (whole, broken))
    seconds = re.compile(r"\d+(\.\d+)? s\b")
    assert max(map(len, two.splitlines())) <= 80
    assert seconds.sub("", two).split() == seconds.sub("", one).split()
    assert len(two.splitlines()) > len(one.splitlines()) or command[0] == "attractor"


def test_a_wide_terminal_has_all_digits_and_the_status_of_each_bounce(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    main(list(PRINTED["one component"]))
    assert re.search(r"^1 +egg +-2\.88977808883885\d* .* regular$", capsys.readouterr().out, re.MULTILINE)


def test_a_status_that_differs_stays_beside_its_bounce():
    rows = [{"component": "wall", "theta": 1 / 3, "status": status} for status in ("regular", "corner")]
    head, *_, last = of_bounces(rows, ("component", "theta", "status"), 30)
    assert head.startswith("component wall, throughout")
    assert last == "1       0.333333  corner"


def test_the_events_of_a_branch_are_said_before_its_table(capsys):
    main(list(PRINTED["a branch"]))
    said = capsys.readouterr().out
    assert -1 < said.index("fold at lam = 0.3781212525") < said.index("multipliers")
