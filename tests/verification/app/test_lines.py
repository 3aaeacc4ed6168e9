"""What commands print fits 80 columns, and says events before tables."""

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
