"""Progress: shares add up, a listener hears them, and a terminal shows them."""

import time

import pytest

from verification.app import cli as output
from verification.app.cli import Output
from verification.arithmetic.iteration import heard, silent, telling


def test_nobody_listening_is_no_error():
    telling("boxes")(0.5)
    silent(0.5)


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


def seen(capfd, wanted):
    """What is shown until `wanted` is, or until a minute of waiting is over."""
    shown = ""
    for _ in range(6000):
        shown += capfd.readouterr().err
        if wanted in shown:
            break
        time.sleep(0.01)
    return shown


def test_a_terminal_shows_how_far_a_long_step_has_come(monkeypatch, capfd):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setattr(output, "PATIENCE", 0.0)
    with Output().progress("Judging", 2) as step:
        tick = telling("triangles excluded")
        shown = seen(capfd, "Judging")  # the bar starts in a thread of its own
        tick(0.43)
        shown += seen(capfd, "43%")
        step("egg.slap_no_period3")
    shown += capfd.readouterr().err

    assert "Judging: triangles excluded, 43%" in shown
    assert "Judging egg.slap_no_period3" in shown


def test_a_pipe_shows_no_bar_and_the_proof_goes_on(capfd):
    with Output().progress("Judging", 1) as step:
        telling("boxes")(0.5)
        step("done")

    assert capfd.readouterr().err == ""
