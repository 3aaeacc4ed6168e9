"""On odd terminals and full disks a command gives its answer or a sentence of refusal."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
ORBIT = ["orbit", "circle", "--lam", "1/2", "--start", "0,0.1", "--bounces", "1"]


def ran(words, shell="", **variables):
    """Status and output of a command in a shell that redirects it."""
    line = f'exec "$0" -m verification "$@" {shell}'
    own = os.environ | variables
    return subprocess.run(
        ["sh", "-c", line, sys.executable, *words], cwd=ROOT, env=own, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize("width", ["0", "-1", "1", "x", "9" * 30])
def test_the_width_of_a_terminal_that_is_none_hides_nothing(width):
    done = ran(ORBIT, COLUMNS=width)

    assert done.returncode == 0
    assert "bounce" in done.stdout
    assert "1 bounces" in done.stdout


@pytest.mark.parametrize(
    ("shell", "status", "said"),
    [
        ("> /dev/full", 1, "pinball: standard output cannot be written: No space left on device\n"),
        (">&-", 2, "pinball: standard output is closed; accepted: an open one, or > FILE\n"),
    ],
)
@pytest.mark.parametrize("more", [[], ["--json", "-"]])
def test_output_that_goes_nowhere_is_told_in_one_sentence(shell, status, said, more):
    done = ran([*ORBIT, *more], shell)

    assert (done.returncode, done.stderr) == (status, said)


@pytest.mark.slow
def test_a_number_too_large_or_too_small_for_decimals_is_shown_with_a_power_of_ten():
    done = ran(["orbit", "ellipse", "--a", "10**12", "--lam", "1/2", "--start", "pi/4,10**-9", "--bounces", "1"])

    assert "e+11" in done.stdout
    assert "1.00e-09" in done.stdout
    assert "Warning" not in done.stderr


def test_the_commands_of_the_help_stand_in_groups():
    text = ran(["--help"]).stdout
    heads = [line[:-1] for line in text.splitlines() if line.endswith(":") and not line.startswith(" ")]

    assert heads == ["Options", "Orbits", "Attractors", "Bifurcations", "Proofs", "The paper", "Tools"]
