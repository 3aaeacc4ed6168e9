"""`pinball orbit`, `lyapunov`, `slap` and `bench` behave as the contract says."""

import math

import mpmath
import pytest
from asking import answer

from verification.app.cli import main

EGG = ("egg", "--alpha", "0.08", "--lam", "0.9")


def test_an_orbit_starts_at_its_start(capsys):
    status, document, _ = answer(capsys, "orbit", *EGG, "--start", "0.5,-1/5", "--bounces", "3")
    first = document["bounces"][0]

    assert status == 0
    assert len(document["bounces"]) == 4
    assert list(first) == ["component", "theta", "s", "x", "y", "eta", "phi", "status"]
    assert (first["component"], first["theta"], first["eta"], first["phi"], first["status"]) == (
        "egg", 0.5, None, -0.2, "regular",
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene",
    [EGG, ("circle", "--lam", "1"), ("cardioid", "--lam", "1/3"), ("cuspless", "--lam", "0.9")],
    ids=lambda scene: scene[0],
)
def test_float64_mpmath_and_arb_tell_the_same_story(capsys, scene):
    question = ("orbit", *scene, "--start", "0.5,-1/5", "--bounces", "4", "--digits", "25")
    plain, multi, balls = (
        answer(capsys, *question, "--arithmetic", name)[1]["bounces"] for name in ("float64", "mpmath", "arb")
    )
    for one, two, three in zip(plain, multi, balls, strict=True):
        for key in ("theta", "s", "x", "y", "phi"):
            assert isinstance(two[key], str)
            assert float(two[key]) == pytest.approx(one[key], abs=1e-13)
            assert float(three[key]) == pytest.approx(float(two[key]), abs=1e-15)
            digits = [text.replace("-", "").replace(".", "").lstrip("0")[:22] for text in (two[key], three[key])]
            assert abs(int(digits[0].ljust(22, "0")) - int(digits[1].ljust(22, "0"))) <= 1


def test_an_irrational_shape_is_exact_to_every_digit(capsys):
    _, document, _ = answer(
        capsys, "orbit", "ellipse", "--a", "sqrt(2)", "--lam", "1/3", "--start", "pi/3,1/7",
        "--bounces", "1", "--arithmetic", "arb", "--digits", "30",
    )  # fmt: skip

    assert document["bounces"][0]["x"].startswith("0.70710678118654752440084436210")


def test_a_formula_makes_a_table(capsys):
    question = ("orbit", "--polar", "1 + cos(5*theta)/40", "--lam", "1/2", "--start", "1,0.5", "--bounces", "2")
    status, document, _ = answer(capsys, *question)

    assert status == 0
    assert document["bounces"][1]["component"] == "polar"


def test_auto_takes_float64_as_long_as_the_orbit_leaves_enough_of_it_and_says_why(capsys):
    question = ("orbit", "cardioid", "--lam", "0.9", "--start", "0.5,-1/5", "--arithmetic", "auto", "--digits", "10")
    (_, short, _), (status, long, _) = (answer(capsys, *question, "--bounces", n) for n in ("3", "100"))
    _, asked, _ = answer(capsys, *question[:-3], "arb", "--digits", "10", "--bounces", "100")

    assert (short["arithmetic"], long["arithmetic"], status) == ("float64", "arb", 0)
    assert long["bounces"] == asked["bounces"]
    assert "digits lost in 100 bounces: " in long["why"]


def test_a_tolerance_is_a_number_of_digits(capsys):
    question = ("orbit", *EGG, "--start", "0.5,-1/5", "--bounces", "3", "--arithmetic", "auto")
    (_, by_error, _), (_, by_digits, _) = (
        answer(capsys, *question, *more) for more in (("--tolerance", "1e-40"), ("--digits", "40"))
    )

    assert by_error == by_digits
    assert by_error["arithmetic"] == "arb"


WAISTED = ("--polar", "1 + cos(2*theta)/2", "--lam", "9/10")  # the line that touches both sides of a waist


@pytest.mark.slow
def test_balls_prove_first_hits_where_the_table_is_not_convex(capsys):
    question = ("orbit", *WAISTED, "--start", "1,1/2", "--bounces", "6", "--digits", "20")
    (status, proved, _), (_, plain, _) = (
        answer(capsys, *question, "--arithmetic", name) for name in ("arb", "float64")
    )

    assert status == 0
    for one, two in zip(proved["bounces"], plain["bounces"], strict=True):
        assert float(one["theta"]) == pytest.approx(two["theta"], abs=1e-12)


def test_what_cannot_be_proved_is_not_given(capsys):
    """The line `y = 1/2` touches the bay of `r = 1 + cos(2*theta)/2` at `(0, 1/2)`; the start is 1e-24 off it."""
    with mpmath.workdps(60):
        s = (mpmath.sqrt(3) - 1) / 2  # the sine of the place with y = 1/2
        theta = mpmath.asin(s)
        r, dr = 1 + mpmath.cos(2 * theta) / 2, -mpmath.sin(2 * theta)
        along, across = r * s - dr * mpmath.cos(theta), r * mpmath.cos(theta) + dr * s  # of (-1, 0)
        phi = mpmath.nstr(mpmath.atan2(along, across) + mpmath.mpf(10) ** -24, 50)
    start = f"atan((sqrt(3)-1)/sqrt(2*sqrt(3))),{phi}"
    table = ("--polar", "1+cos(2*theta)/2", "--lam", "0.9")
    question = ("orbit", *table, "--start", start, "--bounces", "3", "--arithmetic", "arb", "--digits", "15")
    status, document, _ = answer(capsys, *question)

    assert status == main(question) == 1
    assert [bounce["status"] for bounce in document["bounces"]] == ["regular", "unproved"]
    assert document["bounces"][1]["theta"] == document["bounces"][0]["theta"]
    assert "no proof that its flight meets nothing before it lands" in capsys.readouterr().out


@pytest.mark.parametrize("arithmetic", ["float64", "mpmath", "arb"])
def test_a_flight_into_the_cusp_is_no_bounce(capsys, arithmetic):
    """From the point `theta` of the cardioid, the exit angle `theta/2` aims at the cusp."""
    question = ("orbit", "cardioid", "--lam", "0.9", "--start", "1,1/2", "--bounces", "2")
    status, document, _ = answer(capsys, *question, "--arithmetic", arithmetic)

    assert status == 1
    assert [bounce["status"] for bounce in document["bounces"]] == ["regular", "cusp"]


@pytest.mark.slow
@pytest.mark.parametrize("arithmetic", ["float64", "mpmath", "arb"])
def test_a_start_may_lie_whole_turns_away(capsys, arithmetic):
    question = ("orbit", *EGG, "--start", "7,0.3", "--bounces", "1", "--arithmetic", arithmetic)
    _, document, _ = answer(capsys, *question)

    assert float(document["bounces"][0]["theta"]) == pytest.approx(7 - 2 * math.pi)
    assert float(document["bounces"][1]["x"]) == pytest.approx(-0.8625824708767529)  # by either of the others


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((*EGG, "--start", "0.5", "--bounces", "2"), "--start '0.5' is no pair; give THETA,PHI"),
        ((*EGG, "--start", "0.5,2", "--bounces", "2"), "phi = 2.0 does not point into the table"),
        ((*EGG, "--start", "0.5,0", "--bounces", "2", "--component", "roof"), "accepted: egg"),
        (("egg", "--alpha", "0.2", "--lam", "1", "--start", "0,0", "--bounces", "2"), "alpha must lie in"),
    ],
)
def test_bad_input_is_one_sentence(capsys, arguments, words):
    status, document, told = answer(capsys, "orbit", *arguments)

    assert (status, document) == (2, None)
    assert words in told
    assert told.count("\n") == 1


def test_the_slap_map_of_the_circle_is_half_a_turn(capsys):
    _, document, _ = answer(capsys, "slap", "circle", "--points", "8", "--iterates", "2")
    for point in document["points"]:
        once, twice = (image["theta"] for image in point["images"])
        assert abs(once - point["theta"]) == pytest.approx(3.141592653589793, abs=1e-15)
        assert twice == pytest.approx(point["theta"], abs=2e-15)
        assert point["slope"] == pytest.approx(1)
