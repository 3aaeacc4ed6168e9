"""Starts inside the table, by arc length and from files; flight lengths, times, and orbits as CSV."""

import csv
from math import pi, sqrt

import pytest
from asking import answer, refusal

CIRCLE = ["orbit", "circle", "--lam", "1"]
SQUARE = ["orbit", "square", "--lam", "1"]  # the unit square


def test_a_start_inside_of_the_circle_meets_the_wall_where_the_line_does(capsys):
    """From (1/2, 0) upwards to (1/2, sqrt(3)/2), then chords of length sqrt(3), since angles are kept."""
    fields = "x,y,eta,flight,time"
    status, found, _ = answer(
        capsys, *CIRCLE, "--from", "1/2,0", "--towards", "0,2", "--bounces", "3", "--fields", fields
    )
    start, *bounces = found["bounces"]

    assert status == 0
    assert start == {"x": 0.5, "y": 0.0, "eta": None, "flight": None, "time": 0.0}
    assert bounces[0]["y"] == pytest.approx(sqrt(3) / 2, abs=1e-15)
    assert [each["flight"] for each in bounces] == pytest.approx([sqrt(3) / 2, sqrt(3), sqrt(3)], abs=1e-14)
    assert [each["time"] for each in bounces] == pytest.approx([sqrt(3) * k / 2 for k in (1, 3, 5)], abs=1e-14)
    assert abs(bounces[0]["eta"]) == pytest.approx(pi / 6, abs=1e-15)


def test_a_line_through_the_seam_or_a_corner_behind_the_point_is_as_good_as_any(capsys):
    """A line through the circle's centre from the seam of its parameter, and one from a triangle's corner."""
    status, found, _ = answer(capsys, *CIRCLE, "--from", "0,0", "--towards", "1,0", "--bounces", "2", "--fields", "x,y")
    assert status == 0
    assert [each["x"] for each in found["bounces"]] == pytest.approx([0, 1, -1], abs=1e-14)

    middle = ["--from", "1/2,sqrt(3)/6", "--towards", "3,sqrt(3)", "--bounces", "1"]
    status, found, _ = answer(capsys, "orbit", "triangle", "--lam", "1", *middle, "--fields", "x,y")
    assert status == 0
    assert found["bounces"][1] == pytest.approx({"x": 3 / 4, "y": sqrt(3) / 4}, abs=1e-14)


def test_an_angle_is_a_direction(capsys):
    same = [answer(capsys, *CIRCLE, "--from", "0.1,0.2", "--towards", way)[1] for way in ("0,1", "pi/2")]

    for one, other in zip(*(document["bounces"] for document in same), strict=True):
        assert one["x"] == pytest.approx(other["x"], abs=1e-12)


def test_a_hole_is_met_before_the_wall_behind_it(capsys):
    """The unit square about the origin, with a disc of radius 1/4 in the middle."""
    words = ["--from=-0.4,0.1", "--towards", "1,0", "--bounces", "1", "--fields", "component,x"]
    _, found, _ = answer(capsys, "orbit", "sinai", "--lam", "1", *words)

    assert found["bounces"][1] == {"component": "disc", "x": pytest.approx(-sqrt(1 / 16 - 0.01), abs=1e-14)}


def test_an_arc_length_is_a_start(capsys):
    """On the unit circle arc length equals the parameter, and whole turns change nothing."""
    for s in ("1", "1 + 2*pi"):
        _, found, _ = answer(capsys, *CIRCLE, "--start", f"s={s},0.2", "--bounces", "1")
        assert found["bounces"][0]["theta"] == pytest.approx(1, abs=1e-14)
        assert found["bounces"][0]["phi"] == 0.2


@pytest.mark.parametrize(
    ("header", "row"), [("theta,phi", "0.5,0.25"), ("s,phi", "0.5,0.25"), ("theta,phi,component", "0.5,0.25,circle")]
)
def test_particles_of_a_file_fly_as_each_does_alone(tmp_path, capsys, header, row):
    (tmp_path / "starts.csv").write_text(f"# two of them\n{header}\n{row}\n{row.replace('0.25', '-0.75')}\n")
    status, found, _ = answer(capsys, *CIRCLE, "--starts", str(tmp_path / "starts.csv"), "--bounces", "4")

    assert status == 0
    for particle, phi in zip(found["particles"], ("0.25", "-0.75"), strict=True):
        _, alone, _ = answer(capsys, *CIRCLE, "--start", f"0.5,{phi}", "--bounces", "4")
        assert [each["x"] for each in particle["bounces"]] == pytest.approx([each["x"] for each in alone["bounces"]])


def test_an_orbit_as_csv_has_the_numbers_of_the_json(tmp_path, capsys):
    (tmp_path / "starts.csv").write_text("x,y,dx,dy\n0.5,0.1,1,0.3\n0.2,0.5,0.1,1\n")
    words = [*SQUARE, "--starts", str(tmp_path / "starts.csv"), "--bounces", "5", "--fields", "x,y,phi,flight,time"]
    _, found, _ = answer(capsys, *words, "--out", str(tmp_path / "orbit.csv"))
    rows = list(csv.DictReader((tmp_path / "orbit.csv").open()))

    assert list(rows[0]) == ["bounce", "particle", "x", "y", "phi", "flight", "time", "code"]
    assert len(rows) == 12
    bounces = [each for particle in found["particles"] for each in particle["bounces"]]
    for row, bounce in zip(rows, bounces, strict=True):
        for name, value in bounce.items():
            assert row[name] == ("nan" if value is None else repr(value))


@pytest.mark.parametrize("arithmetic", ["mpmath", "arb"])
def test_flights_and_times_have_the_digits_of_the_arithmetic(capsys, arithmetic):
    """Chords of the unit circle at 60 degrees to the wall: sqrt(3), to 30 digits."""
    words = ["--start", "0,pi/6", "--bounces", "3", "--arithmetic", arithmetic, "--digits", "30"]
    _, found, _ = answer(capsys, *CIRCLE, *words, "--fields", "flight,time")
    digits = "1.73205080756887729352744634"

    assert [each["flight"] is None or each["flight"].startswith(digits) for each in found["bounces"]] == [True] * 4
    assert found["bounces"][3]["time"].startswith("5.19615242270663188058233902")


def test_keys_are_those_of_the_contract_where_nothing_else_is_asked(capsys):
    for arithmetic in ("float64", "mpmath", "arb"):
        words = ["--start", "0.3,0.2", "--bounces", "2", "--arithmetic", arithmetic]
        _, found, _ = answer(capsys, "orbit", "egg", "--alpha", "0.08", "--lam", "1/2", *words)
        assert list(found["bounces"][1]) == ["component", "theta", "s", "x", "y", "eta", "phi", "status"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "one start is needed, none given"),
        (["--start", "0,0", "--from", "0,0", "--towards", "1,0"], "one start is needed, --start and --from given"),
        (["--from", "0,0"], "give both"),
        (["--from", "2,0", "--towards", "1,0"], "is not inside of the table"),
        (["--from", "1,0", "--towards", "1,0"], "lies on the wall"),
        (["--from", "0,0", "--towards", "0,0"], "is no direction"),
        (["--from", "0", "--towards", "1,0"], "is no pair of numbers"),
        (["--start", "s=1", "--component", "circle"], "leave --component out"),
        (["--from", "0,0", "--towards", "1,0", "--arithmetic", "arb"], "takes one exact start on the wall"),
        (["--start", "0,0.1", "--fields", "x,z"], "'z' is no field of a bounce; accepted: component, theta"),
        (["--start", "1e399,0"], "too large"),
    ],
)
def test_a_start_that_is_none_is_refused_in_a_sentence(capsys, words, said):
    assert said in refusal(capsys, *CIRCLE, *words)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "accepted: theta,phi"),
        ("theta,phi\n", "has 0 starts"),
        ("theta,phi\n1\n", "1 columns; accepted: 2"),
        ("theta,phi\n1,nan\n", "'nan' is no finite number"),
        ("theta,phi,component\n1,0,disc\n", "disc is not on this table; accepted: circle"),
        ("x,y,angle\n3,0,1\n", "start 1: (3.0, 0.0) is not inside"),
    ],
)
def test_a_file_of_starts_that_is_none_is_refused_in_a_sentence(tmp_path, capsys, text, said):
    (tmp_path / "starts.csv").write_text(text)

    assert said in refusal(capsys, *CIRCLE, "--starts", str(tmp_path / "starts.csv"))


def test_a_particle_escapes_through_a_door_after_the_bounces_that_a_rotation_counts(tmp_path, capsys):
    """In the circle every bounce turns by pi - 2*phi. A door from 3 to -3 lies over the end of arc length."""
    particles, file = [(0.1, 0.3), (1.0, -0.7), (2.0, 0.0), (-2.5, 0.11)], tmp_path / "starts.csv"
    file.write_text("theta,phi\n" + "".join(f"{theta},{phi}\n" for theta, phi in particles))
    for low, high in ((0.5, 0.9), (3.0, -3.0)):
        words = ["--starts", str(file), "--bounces", "60", f"--door={low}:{high}"]
        status, found, _ = answer(capsys, *CIRCLE, *words)
        places = [[theta + k * (pi - 2 * phi) for k in range(1, 61)] for theta, phi in particles]
        inside = [[0 <= (s - low) % (2 * pi) <= (high - low) % (2 * pi) for s in row] for row in places]

        assert status == 0
        assert found["escape_times"] == [row.index(True) + 1 if True in row else None for row in inside]
        ends = [each["bounces"][-1]["status"] for each in found["particles"]]
        assert ends == ["regular" if time is None else "escaped" for time in found["escape_times"]]
    assert None in found["escape_times"]
    assert "accepted: two arc lengths from -3.14159 to 3.14159" in refusal(
        capsys, *CIRCLE, "--start", "0.1,0.3", "--door", "1:9"
    )
