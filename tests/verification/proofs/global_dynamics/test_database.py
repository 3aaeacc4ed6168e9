"""Morse graphs over boxes of parameters: valid for each parameter of a box, and continued from box to box."""

import json
from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from numeric.sweeps.run import run
from symbolic import Scene
from verification.app.cli import main
from verification.proofs.global_dynamics.database import continued, database, same_order
from verification.proofs.global_dynamics.parameter_box import ParameterBox
from verification.rigorous.boxes import Boxes

EGG = Scene("egg", alpha="1/20")
FLOWER = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/90:0..1/30"}})
LAM = Fraction(1, 2), Fraction(33, 64)
BOXES = 60


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "parameter", "shape"),
    [
        (EGG, "alpha", ("1/20", "33/640")),
        (EGG, "alpha", ("0", "1/640")),
        (EGG, "alpha", ("63/640", "1/10")),
        (FLOWER, "b", ("1/100", "1/90")),
        (Scene("ellipse", a="3/2"), "a", ("3/2", "31/20")),
    ],
)
def test_images_hold_the_landings_at_every_parameter(scene, parameter, shape):
    low, high = map(Fraction, shape)
    box = ParameterBox(scene, LAM, parameter, (low, high))
    (chart,), rng = box.charts, np.random.default_rng(1)
    width = 0.01
    theta = rng.uniform(*chart.x, BOXES)
    phi = rng.uniform(chart.y[0], chart.y[1] - width, BOXES)
    images = box.images(Boxes(np.zeros(BOXES, dtype=np.int64), (theta, theta + width), (phi, phi + width)))
    assert images.lost.size < BOXES / 3
    for share in (0, 1, Fraction(1, 3), Fraction(2, 3)):
        for lam in (*LAM, (LAM[0] + LAM[1]) / 2):
            there = PinballMap(scene.at(**{parameter: str(low + (high - low) * share)}), lam=lam)
            corner = rng.integers(0, 2, (2, BOXES)) * width
            landed = there.step(theta + corner[0], phi + corner[1])
            known = ~np.isin(images.source, images.lost)
            ends, exit = ([end[known] for end in side] for side in (images.boxes.x, images.boxes.y))
            source = images.source[known]
            turn = 2 * np.pi * np.round(((ends[0] + ends[1]) / 2 - landed.theta[source]) / (2 * np.pi))
            assert np.all((ends[0] <= landed.theta[source] + turn) & (landed.theta[source] + turn <= ends[1]))
            assert np.all((exit[0] <= landed.phi[source]) & (landed.phi[source] <= exit[1]))


@pytest.mark.parametrize("turned", [False, True])
def test_graphs_continue_only_where_the_same_sets_lead_to_the_same(turned):
    order = np.array([[1, 1, 0], [0, 1, 0], [0, 1, 1]], dtype=np.int8)
    match = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0]], dtype=bool)  # the first and the last exchanged
    other = order[np.ix_([2, 1, 0], [2, 1, 0])]
    assert same_order(match, order, other.T if turned else other) is not turned


@pytest.fixture(scope="module")
def found():
    sweep = database(EGG, "alpha", [0.05, 0.0501, 0.0502], [0.3, 0.301, 0.302], 64, 64, 8)
    return sweep, run(sweep, workers=1)


def test_quiet_boxes_are_one_class_where_orbits_end(found):
    dataset = found[1]
    assert np.unique(continued(dataset)).tolist() == [0]
    assert (dataset.attracting.values >= 1).all()
    box = ParameterBox(EGG, (Fraction(3, 10), Fraction(301, 1000)), "alpha", (Fraction(1, 20), Fraction(501, 10000)))
    (chart,) = box.charts
    cells, rng = dataset.cells.values[0, 0], np.random.default_rng(2)
    map = PinballMap(EGG.at(alpha="0.05005"), lam=0.3005)
    end = map.exponents(rng.uniform(-np.pi, np.pi, 200), rng.uniform(-0.4, 0.4, 200), 1, 3000)
    column = np.floor((end.theta - chart.x[0]) / (chart.x[1] - chart.x[0]) * 64).astype(int) % 64
    row = np.floor((end.phi / box.height + 1) / 2 * 64).astype(int)
    assert np.all(cells[row, column] >= 0)  # where orbits end, there is a Morse set


def test_a_parameter_that_is_called_as_a_field_of_the_results_is_refused():
    scene = Scene.of({"polar": "1 + top*cos(5*theta)", "shape": {"top": "1/90:0..1/30"}})
    with pytest.raises(ValueError, match="give the parameter another name"):
        database(scene, "top", [0.01, 0.02], [0.1, 0.2], 16, 16, 4)


def test_where_convexity_is_not_proved_nothing_is_said():
    star = Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/30:0..1/10"}})
    dataset = run(database(star, "b", [0.05, 0.06], [0.1, 0.2], 16, 16, 4))
    assert dataset.sets.values.tolist() == [[-1]]
    assert continued(dataset).tolist() == [[-1]]


HALVES = {"x": "cos(theta)", "y": "sin(theta)"}


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ({"component": [{**HALVES, "from": "0", "to": "pi + b"}, {**HALVES, "from": "pi + b", "to": "2*pi"}]}, "end"),
        ({"polar": "1 + b*cos(3*theta)", "law": "-lam*eta*(1/2 + 10*b)"}, "law"),
    ],
)
def test_a_shape_that_moves_the_ends_of_the_charts_or_the_law_is_refused(scene, words):
    scene = Scene.of({**scene, "shape": {"b": "1/50"}})
    with pytest.raises(ValueError, match=words):
        database(scene, "b", [0.01, 0.02], [0.1, 0.2], 16, 16, 4)
    with pytest.raises(ValueError, match=words):
        ParameterBox(scene, LAM, "b", (Fraction(1, 100), Fraction(1, 50)))


@pytest.mark.parametrize("size", [(18, 16, 4), (18, 18, 6)])
def test_blocks_that_do_not_fit_are_refused(size):
    with pytest.raises(ValueError, match="a power of 2 that divides"):
        database(EGG, "alpha", [0.05, 0.06], [0.1, 0.2], *size)


@pytest.mark.parametrize(
    ("lams", "shape", "words"),
    [
        ("0:1:3", "alpha=0:1/10:3", "accepted: 0 <= LOW < HIGH < 1"),
        ("0:0.9:3", "alpha=1/20:1/20:1", "one value bounds no box of parameters"),
        ("0.5", "alpha=0:1/10:3", "is no range"),
    ],
)
def test_what_is_no_grid_of_boxes_is_refused_in_a_sentence(lams, shape, words, capsys):
    assert main(["sweep", "morse-graphs", "egg", "--shape", shape, "--lams", lams]) == 2
    assert words in " ".join(capsys.readouterr().err.split())


@pytest.mark.slow
def test_the_command_writes_a_picture_and_a_page_that_holds_every_box(tmp_path):
    page, picture, told = tmp_path / "graphs.html", tmp_path / "graphs.png", tmp_path / "graphs.json"
    size = ["--columns", "24", "--rows", "16", "--coarsest", "4"]
    files = ["--page", str(page), "--plot", str(picture), "--json", str(told)]
    grid = ["--shape", "alpha=0.05:0.06:3", "--lams", "0.1:0.3:3"]
    assert main(["sweep", "morse-graphs", "egg", *grid, *size, *files]) == 0
    assert picture.read_bytes()[:4] == b"\x89PNG"
    text = page.read_text(encoding="utf-8")
    data = json.loads(text.split('id="data">')[1].split("</script>")[0])
    assert len(data["sets"]) == len(data["classes"]) == 4
    assert data["lams"] == ["0.1", "0.2", "0.3"]
    assert "turns by 1/3" in text
