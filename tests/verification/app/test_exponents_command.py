"""`pinball lyapunov`: the contract's keys, error bars and their origin, and each way in which the command ends."""

import pytest
from asking import answer

from verification.app.cli import main

CARDIOID = ("lyapunov", "cardioid", "--lam", "0.5", "--bounces", "200", "--orbits", "20", "--seed", "1")


def test_the_document_says_what_was_found_and_how(capsys):
    status, document, _ = answer(capsys, *CARDIOID)
    group = document["groups"][0]

    assert status == 0
    contract = {"nu_plus", "nu_minus", "nu_plus_stderr", "nu_minus_stderr", "orbits", "bounces", "groups"}
    assert contract <= set(document)
    assert (document["orbits"], document["bounces"], document["seed"]) == (20, 200, 1)
    assert document["start_law"] == "interior"
    assert document["nu_plus"] == group["nu_plus"] > 0 > group["nu_minus"]
    assert document["sum"] == pytest.approx(document["nu_plus"] + document["nu_minus"], abs=1e-12)
    assert document["sum_rule"]["difference"] < 1e-10
    assert {"trace", "batches", "batch_bounces", "trusted", "autocorrelation_time", "naive_stderr"} <= set(group)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_document_and_another_law_other_starts(capsys):
    first, again = (answer(capsys, *CARDIOID)[1] for _ in range(2))
    other = answer(capsys, *CARDIOID, "--start-law", "phase")[1]

    assert first == again
    assert other["nu_plus"] != first["nu_plus"]
    assert abs(other["nu_plus"] - first["nu_plus"]) < 5 * (other["nu_plus_stderr"] + first["nu_plus_stderr"])


def test_the_slap_map_has_one_exponent(capsys):
    scene = ("lyapunov", "ellipse", "--a", "2", "--lam", "0")
    question = (*scene, "--bounces", "100", "--orbits", "5", "--seed", "1", "--certified")
    status, document, _ = answer(capsys, *question)
    group = document["groups"][0]

    assert status == 0
    assert document["nu_minus"] is None
    assert group["nu_minus"] is None
    assert group["certified"]["nu_plus"].startswith("-0.69314718055994530941723212145")
    assert group["certified"]["nu_minus"] is None


@pytest.mark.slow
def test_the_chaotic_slap_map_of_the_cardioid_has_a_proved_exponent_and_the_sampled_one_agrees(capsys):
    scene = ("lyapunov", "cardioid", "--lam", "0", "--certified")
    question = (*scene, "--bounces", "2000", "--orbits", "50", "--seed", "1")
    status, document, _ = answer(capsys, *question)
    (group,) = document["groups"]
    proved = group["certified"]

    assert status == main(question) == 0
    assert set(proved["checks"].values()) == {True}
    assert float(proved["radius"]) < 1e-13
    assert proved["nu_minus"] is None
    assert abs(group["nu_plus"] - float(proved["nu_plus"])) < 4 * group["nu_plus_stderr"]
    assert f"proved: {proved['nu_plus']}, -oo" in capsys.readouterr().out


@pytest.mark.slow
def test_symmetric_attractors_are_one_result_and_different_ones_none(capsys):
    egg = ("lyapunov", "egg", "--alpha", "0.08", "--bounces", "300", "--orbits", "30", "--seed", "1")
    images = answer(capsys, *egg, "--lam", "0.7")[1]
    different = answer(capsys, *egg, "--lam", "0.45")[1]

    assert [group["family"] for group in images["groups"]] == [0, 0]
    assert images["nu_plus"] is not None
    assert {group["family"] for group in different["groups"]} == {0, 1}
    assert different["nu_plus"] is None


def test_a_budget_that_is_spent_is_said(capsys):
    question = (*CARDIOID, "--until-error", "1e-9", "--budget", "5000")
    status, document, _ = answer(capsys, *question)

    assert status == main(question) == 1
    assert document["reached"] is False
    assert "was not reached within the budget" in capsys.readouterr().out


@pytest.mark.slow
def test_an_error_that_is_reached_is_done(capsys):
    status, document, _ = answer(capsys, *CARDIOID, "--until-error", "0.005")

    assert (status, document["reached"]) == (0, True)
    assert max(document["nu_plus_stderr"], document["nu_minus_stderr"]) <= 0.005


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (("--until-error", "0"), "--until-error = 0.0 is no error"),
        (("--orbits", "1"), "--orbits is given 2 times; accepted: once"),
        (("--start-law", "nowhere"), "'nowhere' is not one of"),
    ],
)
def test_bad_input_is_one_sentence(capsys, wrong, words):
    status, document, told = answer(capsys, *CARDIOID, *wrong)

    assert (status, document) == (2, None)
    assert words in told
    assert told.count("\n") == 1
