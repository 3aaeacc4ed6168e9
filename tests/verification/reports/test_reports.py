"""The report of a scene: it keeps to its time, resumes where it was stopped, and has equal content in all forms."""

import json
import re
import shlex
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from sympy import cos, sin

from symbolic import Scene, double_normals, tables
from symbolic.cycles.thresholds import flip_contraction, stability_number
from symbolic.tables.table import theta
from verification.app.cli import main
from verification.named import events
from verification.named.questions import PeriodicOrbit
from verification.paper.report.mathml import remark
from verification.reports import lives, planes
from verification.reports.asked import Asked, Parts
from verification.reports.blocks import Certificate, Known, Listing, Picture, Section, ShownNumber
from verification.reports.page import further
from verification.reports.report import composed, report
from verification.reports.scene import inflections, properties

ELLIPSE = Scene("ellipse", a="3/2")
SMALL = {"at": ("1/2",), "period": 2, "digits": 10}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A report that is stopped at its census, resumed, and out of time once a cycle has been followed."""
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


@pytest.mark.slow
def test_a_report_that_was_stopped_is_a_report_and_goes_on_without_doing_a_step_twice(made):
    out, done, first, second, half = made

    assert '<h2 id="diagram">Families of attractors' in half
    assert "Attractors and their basins (not made yet)" in half
    assert "Not finished." in half
    assert not re.search("Not finished|not made yet", out.read_text())
    assert set(first) & set(second) == {"census-0-0"}  # the one that was stopped
    assert [section.name for section in done.sections][:4] == ["diagram", "events", "families", "census"]
    assert done.sections[4].name == "missing"


@pytest.mark.slow
def test_what_does_not_fit_the_time_is_left_and_the_page_says_so(made):
    out, done, *_ = made

    assert done.left
    assert f"Left for more time, or to be refined: {further(done.left)}." in out.read_text()
    assert "attractors and their basins" in further(done.left)


@pytest.mark.slow
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


@pytest.mark.slow
def test_the_command_beneath_each_picture_draws_it(made, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, done, *_ = made
    pictures = [block for section in done.sections for block in section.blocks if isinstance(block, Picture)]

    assert {picture.name.split("-")[0] for picture in pictures} >= {"table", "slap", "portrait", "diagram", "life"}
    for command in dict.fromkeys(picture.command for picture in pictures):
        assert main(shlex.split(command)[1:]) == 0
        assert Path("FILE.svg").read_text().startswith("<?xml"), command
        Path("FILE.svg").unlink()


@pytest.mark.slow
def test_every_number_is_exact_or_has_an_error(made):
    _, done, *_ = made
    numbers = [
        cell
        for section in done.sections
        for block in section.blocks
        if isinstance(block, Listing)
        for row in block.rows
        for cell in row
        if isinstance(cell, ShownNumber)
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


@pytest.mark.slow
def test_the_article_holds_every_section_and_balances_its_braces(made):
    out, done, *_ = made
    text = out.with_suffix(".tex").read_text()

    assert all(rf"\section{{{section.title}}}" in text for section in done.sections)
    bare = re.sub(r"\\[{}]", "", text)
    assert bare.count("{") == bare.count("}")


@pytest.mark.slow
def test_the_parts_of_another_question_are_not_taken_for_its_own(made):
    out, *_ = made
    parts = Parts(out.with_suffix(".parts"), Asked(ELLIPSE, at=("1/3",), period=2, digits=10).digest)

    assert parts.read("scene") is None
    assert composed(Asked(ELLIPSE, at=("1/3",)), parts, ()).sections == ()


def test_a_limacon_with_a_dent_has_two_inflections_where_its_curvature_vanishes():
    dented = Scene.of({"polar": "1 + 3*cos(theta)/5"}).table
    round_ = Scene.of({"polar": "1 + 2*cos(theta)/5"}).table

    left, right = (float(value) for value in inflections(dented))
    assert left == pytest.approx(-right, abs=1e-6)
    assert inflections(round_) == []


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


@pytest.fixture(scope="module")
def plane(tmp_path_factory):
    """A report on the plane of the flower's parameter and the contraction: one cycle, on a small grid."""
    out = tmp_path_factory.mktemp("plane") / "flower.html"
    flower = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/60:0..1/30"}, "lam": "1/10"})
    asked = Asked(flower, at=("1/10",), period=2, digits=10, second=("b", "0", "1/30"))
    parts = Parts(out.with_suffix(".parts"), asked.digest)
    parts.made(asked)
    axis = lives.said_of(PeriodicOrbit(flower, (0, 0), (0.0, pi), (0.0, 0.0), (0.5, 0.02)))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(events, "SWITCHES", 1)
        _, _, data = planes.curves(asked, {"cycle": axis, "at": "1/10"}, 0, ())
    grid = {"values": np.linspace(0, 1 / 30, 3), "lams": np.linspace(0, 1, 4), "nu": np.linspace(-1, 1, 12)}
    parts.keep("plane-0", grid | {"nu": grid["nu"].reshape(3, 4), "chaotic": np.eye(3, 4)})
    said = {"level": 0, "command": "pinball sweep", "size": "few", "chaotic": 0.25}
    for name, found in (("plane-0", said), ("curves-0", data)):
        parts.write(name, {"seconds": 1.0, "data": found, **Section("plane", "Plane", (), ()).document()})
    return asked, parts, composed(asked, parts, ()), data["curves"]


@pytest.mark.slow
def test_the_curve_of_a_doubling_in_two_parameters_runs_along_its_closed_form(plane):
    """The flower's axes double where their stability number says; the curve was followed from one such point."""
    asked, *_, curves = plane
    first = curves[0]
    (chord,) = double_normals(Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}}).table)

    assert (first["kind"], first["period"]) == ("period doubling", 2)
    where = [b for b, lam, _ in first["points"] if lam in (0.0, 1.0)]
    assert min(where) < 1 / 40 < max(where)
    table = [(b, lam) for b, lam, _ in first["points"]]
    closed = float(flip_contraction(stability_number(chord)))
    (a, b) = next((one, two) for one, two in pairwise(table) if (one[0] - 1 / 40) * (two[0] - 1 / 40) <= 0)
    assert min(a[1], b[1]) <= closed <= max(a[1], b[1])
    rows = [row for block in planes.curve_blocks(asked, [first])[:1] for row in block.rows if row[0] == "proved there"]
    assert [(row[1].value, row[1].known.name) for row in rows] == [(b, "EXACT") for b, *_ in first["proved"]] != []


@pytest.mark.slow
def test_the_json_lists_events_attractors_and_exponents_and_an_event_of_image_cycles_once(made):
    _, done, *_ = made
    document = json.loads(json.dumps(done.document()))

    assert document["schema"] == 1
    assert {"lam", "nu_plus", "nu_plus_stderr"} <= set(document["exponents"][0])
    assert {row["kind"] for row in document["attractors"]} <= {"cycle", "chaotic", "neutral", "stopped"}
    assert [(branch["period"], branch["attracts"]) for branch in document["branches"]] == [(2, [[0.0, 1.0]])]
    assert document["accounted"]["missing"] == []
    for event in document["events"]:
        assert {"kind", "period", "parameter", "value", "radius", "certified"} <= set(event)
    assert len(document["events"]) == len({json.dumps(event) for event in document["events"]})


def test_a_cascade_is_whole_although_its_families_double_again_elsewhere():
    """Doublings at 1 - 5^-k, each family once more near the end of its life; and one family that is born twice."""
    once = [(1 - 5.0**-k, 3 * 2**k, k, k + 1) for k in range(5)]
    again = [(2.0 + k, 3 * 2**k, k, 7 if k == 1 else None) for k in range(3)]
    events = [
        {"kind": "flip", "period": n, "value": repr(at), "branch": on, "born": born, "key": "", "supercritical": None}
        for at, n, on, born in sorted(once + again)
    ]
    _, *said = lives.event_blocks({"events": events, "command": ""}, {}, [])

    assert len(said) == 1
    assert said[0].text.startswith("Cascade from family 0 of period 3: 5 doublings in a row; successive distances have")
    assert "ratios 5.0000, 5.0000, 5.0000;" in said[0].text


def test_certificates_stand_in_the_order_of_the_events_with_their_kind_period_and_value():
    places = [("0.33333333", "pitchfork"), ("0.5", "flip")]
    events = [{"kind": kind, "period": 2, "parameter": "lam", "value": x, "key": kind} for x, kind in places]
    proved = {"flip": {"file": "event-0"}, "pitchfork": {"file": "event-1"}}
    blocks = [Certificate(f"event-{i}", {"name": "long"}) for i in range(2)]

    titles = [each.title for each in lives.named_certificates({"events": events}, proved, blocks)]
    assert titles == ["pitchfork of period 2 at lam = 0.333333", "period doubling of period 2 at lam = 0.500000"]


def test_a_folder_takes_page_json_and_article(tmp_path):
    out = tmp_path / "ellipse"

    assert main(["report", "ellipse", "--a", "3/2", "--minutes", "1e-9", "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {"report.html", "report.json", "report.tex", "report.parts"}
