"""The report of a scene: it fits its time, goes on where it was stopped, and says the same in each form."""

import json
import re
import shlex
from fractions import Fraction
from importlib.util import find_spec
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from sympy import cos, sin

from numeric.sweeps.run import on_threads
from symbolic import Scene, tables
from symbolic.cycles.thresholds import flip_contraction, stability_number
from symbolic.tables.gallery import GALLERY
from symbolic.tables.table import theta
from verification.app.cli import main
from verification.named import events
from verification.named.files import checked
from verification.named.questions import PeriodicOrbit
from verification.paper.report.mathml import remark
from verification.reports import lives
from verification.reports.asked import Asked, Parts
from verification.reports.blocks import Certificate, Known, Listing, Number, Picture, Section
from verification.reports.dynamics import diagram
from verification.reports.page import STEPS, again, further
from verification.reports.report import FIRST, composed, report
from verification.reports.scene import double_normals, inflections, properties

ROOT = Path(__file__).parents[3]
ELLIPSE = Scene("ellipse", a="3/2")
SMALL = {"at": ("1/2",), "period": 2, "digits": 10}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A report that is stopped at its census, asked for again, and out of time once a cycle has been followed."""
    out = tmp_path_factory.mktemp("report") / "ellipse.html"
    first, second = [], []

    def stopped(step):
        first.append(step)
        if step.startswith("census"):
            raise KeyboardInterrupt

    def clock():
        return 1e6 if any(step.startswith("life") for step in second) else 0.0

    with pytest.raises(KeyboardInterrupt):
        report(ELLIPSE, out, clock=clock, tick=stopped, **SMALL)
    half = out.read_text()
    done = report(ELLIPSE, out, clock=clock, tick=second.append, latex=out.with_suffix(".tex"), **SMALL)
    return out, done, first, second, half


def test_a_report_that_was_stopped_is_a_report_and_goes_on_without_doing_a_step_twice(made):
    out, done, first, second, half = made

    assert '<h2 id="diagram">Bifurcation diagram and exponents' in half
    assert "Cycles from birth to death (not made yet)" in half
    assert "Not finished." in half
    assert not re.search("Not finished|not made yet", out.read_text())
    assert set(first) & set(second) == {"census-0-0"}  # the one that was stopped
    assert [section.name for section in done.sections][:4] == ["scene", "derivation", "slap", "portrait"]
    assert {"cycles", "census"} <= {section.name for section in done.sections}


def test_what_does_not_fit_the_time_is_left_and_the_page_says_so(made):
    out, done, *_ = made

    assert done.left
    assert f"Left for more time, or to be refined: {further(done.left)}." in out.read_text()
    assert "attractors and their basins" in further(done.left)


def test_the_page_shows_what_the_json_says_and_needs_no_network(made):
    out, done, *_ = made
    page, document = out.read_text(), json.loads(json.dumps(done.document()))

    assert not re.search(r"(src|href)=\"(?!data:|#)", page)
    assert [Section.read(section) for section in document["sections"]] == list(done.sections)
    for block in (block for section in done.sections for block in section.blocks):
        if isinstance(block, Listing):
            cells = [cell for row in block.rows for cell in row]
            said = [remark(cell if isinstance(cell, str) else cell.words) for cell in cells if _plain(cell)]
            assert str(remark(block.caption)) in page
            assert all(str(words) in page for words in said)
        if isinstance(block, Picture):
            assert f'id="figure-{block.name}"' in page
            assert f'alt="{block.alt}"' in page


def _plain(cell):
    return isinstance(cell, str) or cell.known is not Known.EXACT


def test_the_command_beneath_each_picture_draws_it(made, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, done, *_ = made
    pictures = [block for section in done.sections for block in section.blocks if isinstance(block, Picture)]

    assert {picture.name.split("-")[0] for picture in pictures} >= {"table", "slap", "portrait", "diagram", "life"}
    for command in dict.fromkeys(picture.command for picture in pictures):
        assert main(shlex.split(command)[1:]) == 0
        assert Path("FILE.svg").read_text().startswith("<?xml"), command
        Path("FILE.svg").unlink()


def test_every_number_is_exact_or_has_an_error(made):
    _, done, *_ = made
    numbers = [
        cell
        for section in done.sections
        for block in section.blocks
        if isinstance(block, Listing)
        for row in block.rows
        for cell in row
        if isinstance(cell, Number)
    ]

    assert {number.known for number in numbers} >= {Known.SAMPLED, Known.PROVED}
    for number in numbers:
        assert number.known is Known.EXACT or number.error or not re.match(r"[-\d]", number.value), number


@pytest.mark.parametrize(
    ("table", "simple", "convex"),
    [
        (tables.square(), "bends inwards everywhere", "yes"),
        (tables.reuleaux(), "bends inwards everywhere", "yes"),
        (
            tables.parametric(cos(theta) + cos(2 * theta) / 10, 2 * sin(theta) + sin(3 * theta) / 3),
            "no two parts",
            "no",
        ),
    ],
    ids=["square", "reuleaux", "dented"],
)
def test_a_boundary_is_said_to_be_simple_by_proof_where_there_is_one(table, simple, convex):
    said = {what: (words, known) for what, words, known in properties(table)}

    assert simple in said["simple"][0]
    assert said["simple"][1] is Known.PROVED
    assert said["convex"][0].startswith(convex)


def test_the_article_holds_every_section_and_balances_its_braces(made):
    out, done, *_ = made
    text = out.with_suffix(".tex").read_text()

    assert all(rf"\section{{{section.title}}}" in text for section in done.sections)
    bare = re.sub(r"\\[{}]", "", text)
    assert bare.count("{") == bare.count("}")


def test_the_parts_of_another_question_are_not_taken_for_its_own(made):
    out, *_ = made
    parts = Parts(out.with_suffix(".parts"), Asked(ELLIPSE, at=("1/3",), period=2, digits=10).digest)

    assert parts.read("scene") is None
    assert composed(Asked(ELLIPSE, at=("1/3",)), parts, ()).sections == ()


def test_a_threshold_in_closed_form_lies_in_the_ball_of_the_certified_event(tmp_path):
    """Two ways to one number: symmetry and algebra, and a branch followed to its flip."""
    flower = Asked(Scene.of({"polar": "1 + cos(5*theta)/40"}), at=("1/10",), period=2, digits=15)
    axis = PeriodicOrbit(flower.scene.at(lam="1/10"), (0, 0), (0.0, pi), (0.0, 0.0), (0.5, 0.02))
    parts = Parts(tmp_path / "parts", flower.digest)
    parts.made(flower)
    blocks, _, data = lives.life(flower, parts, "1/10", lives.said_of(axis), 0)
    (chord,) = double_normals(flower.scene.table)
    closed = flip_contraction(stability_number(chord))
    (event,) = [row[1] for block in blocks if isinstance(block, Listing) for row in block.rows if "doubling" in row[0]]
    (file,) = [block for block in blocks if isinstance(block, Certificate)]

    assert event.known is Known.PROVED
    assert abs(closed.evalf(30) - float(event.value)) < 1e-15
    assert str(closed.evalf(30)).startswith(event.value[:15])
    assert checked(json.loads(json.dumps(file.document))).certified
    assert data["events"][0][1] == "period doubling 2"


def test_a_limacon_with_a_dent_has_two_inflections_where_its_curvature_vanishes():
    dented = Scene.of({"polar": "1 + 3*cos(theta)/5"}).table
    round_ = Scene.of({"polar": "1 + 2*cos(theta)/5"}).table

    left, right = (float(value) for value in inflections(dented))
    assert left == pytest.approx(-right, abs=1e-6)
    assert inflections(round_) == []


def test_the_commands_of_a_report_name_the_scene():
    stadium = Asked(Scene(GALLERY["stadium"]()))

    assert Asked(ELLIPSE).command("slap") == "pinball slap ellipse --a 3/2"
    assert stadium.command("slap") == "pinball slap --scene scene.toml"
    assert Scene.parse(stadium.scene_file()) == stadium.scene


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--minutes", "0"], "minutes = 0.0 is no time"),
        (["--vary", "b=0:1", "--lam", "1/2"], "--b = 0 is no shape parameter"),
        (["--vary", "a=2:1", "--lam", "1/2"], "a from 2 to 1 is no interval"),
        (["--vary", "b=0:1"], "--b = 0 is no shape parameter"),
        (["--lam", "1:0"], "lam from 1 to 0 is no interval"),
        (["--lam", "1"], "accepted: LOW:HIGH"),
        (["--at", "2"], "lam = 2 is no contraction"),
        (["--out", "/no/such/place.html"], "/no/such/place.html cannot be written"),
        (["--scheduler", "nowhere"], "--scheduler nowhere: no Dask scheduler answers there"),
    ],
)
def test_bad_input_is_one_sentence(arguments, said, tmp_path, capsys):
    out = [] if "--out" in arguments else ["--out", str(tmp_path / "page.html")]

    assert main(["report", "ellipse", "--a", "3/2", *out, *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert len(error.splitlines()) == 1


def test_every_kind_of_step_has_words(made):
    _, done, first, second, _ = made
    assert {name.split("-")[0] for name in (*done.left, *first, *second, *FIRST)} <= set(STEPS)


def test_a_first_guess_of_the_seconds_exists_for_each_kind_of_later_step():
    assert {"census", "search", "life", "cascade", "plane", "curves"} <= set(FIRST)


def test_another_parameter_varies_at_one_contraction_from_the_scenes_own_number_or_the_middle(tmp_path):
    flower = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/100"}})
    vary = ("b", "0", "1/30")
    inside = report(flower, tmp_path / "b.html", vary=vary, lam="1/10", minutes=1e-9)
    at_an_end = report(flower.at(b=0), tmp_path / "b.html", vary=vary, lam="1/10", minutes=1e-9)

    assert inside.asked.scene.shape["b"] == Fraction(1, 100)
    assert at_an_end.asked.scene.shape["b"] == Fraction(1, 60)
    assert inside.asked.scene.ranges["b"] == (0, Fraction(1, 30))
    assert inside.asked.varied == "--lam 1/10 --shape b=0:1/30"
    assert inside.document()["asked"]["vary"] == "b"
    with pytest.raises(ValueError, match="give two contractions"):
        report(flower, tmp_path / "b.html", lam="1/10")


def test_the_grids_of_a_report_are_done_where_its_scheduler_says_with_the_same_picture(tmp_path, monkeypatch):
    """Threads stand for a cluster: that Dask gives the bits of threads is the law of sweeps."""
    asked, asked_of = Asked(ELLIPSE, **SMALL), []

    def cluster(sweep, indices, address):
        asked_of.append((sweep.name, address))
        return on_threads(sweep, indices, 2)

    monkeypatch.setattr("numeric.sweeps.run.on_cluster", cluster)
    found = {}
    for scheduler in (None, "tcp://cluster:8786"):
        parts = Parts(tmp_path / str(scheduler is None), asked.digest, scheduler)
        parts.made(asked)
        diagram(asked, parts, 0)
        found[scheduler] = parts.arrays("diagram-0")

    assert asked_of == [("bifurcation", "tcp://cluster:8786")]
    assert all(np.array_equal(a, b) for a, b in zip(*(each.values() for each in found.values()), strict=True))


def test_a_package_that_a_report_needs_is_asked_for_before_any_work(tmp_path, capsys, monkeypatch):
    there = find_spec
    monkeypatch.setattr(
        "verification.app.commands.report.find_spec", lambda name: None if name == "xarray" else there(name)
    )

    assert main(["report", "circle", "--out", str(tmp_path / "circle.html")]) == 2
    said = "report: xarray is missing; install what it needs with: pip install 'pinball-billiards[plot,sweep]'"
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def plane(tmp_path_factory):
    """The plane of the flower's parameter and the contraction, as far as one cycle leads, over a small grid."""
    out = tmp_path_factory.mktemp("plane") / "flower.html"
    flower = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/60:0..1/30"}, "lam": "1/10"})
    asked = Asked(flower, at=("1/10",), period=2, digits=10, second=("b", "0", "1/30"))
    parts = Parts(out.with_suffix(".parts"), asked.digest)
    parts.made(asked)
    axis = lives.said_of(PeriodicOrbit(flower, (0, 0), (0.0, pi), (0.0, 0.0), (0.5, 0.02)))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(events, "SWITCHES", 1)
        _, _, data = lives.curves(asked, {"cycle": axis, "at": "1/10"}, 0, ())
    grid = {"values": np.linspace(0, 1 / 30, 3), "lams": np.linspace(0, 1, 4), "nu": np.linspace(-1, 1, 12)}
    parts.keep("plane-0", grid | {"nu": grid["nu"].reshape(3, 4), "chaotic": np.eye(3, 4)})
    said = {"level": 0, "command": "pinball sweep", "size": "few", "chaotic": 0.25}
    for name, found in (("plane-0", said), ("curves-0", data)):
        parts.write(name, {"seconds": 1.0, "data": found, **Section("plane", "Plane", (), ()).document()})
    return asked, parts, composed(asked, parts, ()), data["curves"]


def test_the_curve_of_a_doubling_in_two_parameters_runs_along_its_closed_form(plane):
    """The axes of the flower double where their stability number says; the curve was followed from one such point."""
    *_, curves = plane
    first = curves[0]
    (chord,) = double_normals(Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}}).table)

    assert (first["kind"], first["period"]) == ("period doubling", 2)
    where = [b for b, lam, _ in first["points"] if lam in (0.0, 1.0)]
    assert min(where) < 1 / 40 < max(where)
    table = [(b, lam) for b, lam, _ in first["points"]]
    closed = float(flip_contraction(stability_number(chord)))
    (a, b) = next((one, two) for one, two in pairwise(table) if (one[0] - 1 / 40) * (two[0] - 1 / 40) <= 0)
    assert min(a[1], b[1]) <= closed <= max(a[1], b[1])


def test_a_curve_is_drawn_once_over_the_shaded_plane_and_named_with_the_command_that_follows_it(plane):
    _, parts, done, curves = plane
    (section,) = (section for section in done.sections if section.name == "plane")
    listings = [block for block in section.blocks if isinstance(block, Listing)]
    (picture,) = (block for block in section.blocks if isinstance(block, Picture))

    assert len({json.dumps(curve["points"]) for curve in curves}) == len(curves)
    assert len(listings) == len(curves) >= 1
    assert all(f"Curve {i}:" in block.caption for i, block in enumerate(listings, 1))
    assert "--curves lam=0:1" in listings[0].command
    assert "--vary b=0:1/30" in " ".join(again(done))
    assert picture.values["curves"][0]["period"] == 2
    assert parts.picture(picture.name).exists()
    assert done.document()["asked"]["second"] == {"vary": "b", "from": "0", "to": "1/30"}


def test_the_json_lists_events_attractors_and_exponents_and_an_event_of_image_cycles_once(made):
    _, done, *_ = made
    document = json.loads(json.dumps(done.document()))

    assert document["schema"] == 1
    assert {"lam", "nu_plus", "nu_plus_stderr"} <= set(document["exponents"][0])
    assert {row["kind"] for row in document["attractors"]} <= {"cycle", "chaotic", "neutral", "stopped"}
    for event in document["events"]:
        assert set(event) == {"kind", "period", "parameter", "value", "radius", "certified"}
    assert len(document["events"]) == len({json.dumps(event) for event in document["events"]})


def test_a_folder_takes_page_json_and_article(tmp_path):
    out = tmp_path / "ellipse"

    assert main(["report", "ellipse", "--a", "3/2", "--minutes", "1e-9", "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {"report.html", "report.json", "report.tex", "report.parts"}
