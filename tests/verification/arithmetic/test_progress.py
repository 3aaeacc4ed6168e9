"""Progress: shares of the work add up, a listener receives them, and output to a pipe shows none."""

import pytest

from verification.app.cli import Output
from verification.arithmetic.iteration import heard, telling


def test_a_listener_hears_sums_and_no_crumbs():
    told: list[tuple[str, float]] = []
    with heard(lambda about, share: told.append((about, share))):
        tick = telling("boxes")
        for _ in range(10_000):
            tick(1e-4)

    assert {about for about, _ in told} == {"boxes"}
    assert len(told) <= 1000
    assert told[-1][1] == pytest.approx(1, abs=2e-3)


def test_the_listener_is_forgotten_at_the_end_whatever_happens():
    told: list[float] = []
    with pytest.raises(ZeroDivisionError), heard(lambda about, share: told.append(share)):
        raise ZeroDivisionError
    telling("boxes")(0.5)

    assert told == []


def test_a_pipe_shows_no_bar_and_the_proof_goes_on(capfd):
    with Output().progress("Judging", 1) as step:
        telling("boxes")(0.5)
        step("done")

    assert capfd.readouterr().err == ""
