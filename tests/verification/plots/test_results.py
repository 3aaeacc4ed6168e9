"""Pictures of what commands computed: of the right kind, whole or not at all, and refused before any work."""

import json
import subprocess
import sys
from io import BytesIO

import numpy as np
import pytest
from matplotlib import image as images

from numeric import PinballMap
from symbolic import tables
from verification.app.cli import main
from verification.plots import grids, results
from verification.plots.sheet import FORMATS, image, styled

MAGIC = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF", ".webp": b"RIFF"}
EGG = ("egg", "--alpha", "0.08")
STADIUM = """
name = "two parts"
lam = "1/2"
law = "-lam*eta"
[[component]]
name = "arc"
x = "cos(theta)"
y = "sin(theta)"
from = "-pi/2"
to = "pi/2"
[[component]]
name = "other"
x = "-cos(theta)"
y = "-sin(theta)"
from = "-pi/2"
to = "pi/2"
"""
COMMANDS = {
    "orbit": ("orbit", *EGG, "--lam", "0.4", "--start", "0.1,0.2", "--bounces", "8"),
    "many bounces": ("orbit", *EGG, "--lam", "0.45", "--start", "0.1,0.2", "--bounces", "3000"),
    "attractor": (
        "attractor",
        "ellipse",
        "--a",
        "1.5",
        "--lam",
        "0.3",
        "--orbits",
        "9",
        "--seed",
        "1",
        "--transient",
        "64",
        "--bounces",
        "100",
    ),
    "lyapunov": (
        "lyapunov",
        "ellipse",
        "--a",
        "1.5",
        "--lam",
        "0.3",
        "--bounces",
        "64",
        "--orbits",
        "8",
        "--seed",
        "1",
    ),
    "basins": (
        "basins",
        "ellipse",
        "--a",
        "1.5",
        "--lam",
        "0.3",
        "--columns",
        "16",
        "--rows",
        "9",
        "--starts",
        "9",
        "--transient",
        "64",
    ),
    "bifurcation": ("bifurcation", *EGG, "--lams", "0.3:0.5:5", "--orbits", "3", "--points", "9", "--bounces", "64"),
    "slap": ("slap", *EGG, "--iterates", "3", "--points", "50"),
    "cycles": ("cycles", "ellipse", "--a", "1.5", "--lam", "0.5", "--period", "2"),
    "locate": ("locate", "saddle-node", "--alpha", "0.08", "--digits", "10"),
    "corner orbit": ("locate", "lambda-star", "--digits", "10"),
}


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(STADIUM)
    return str(path)


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_draws_what_it_computed_in_a_file_of_the_kind_that_its_ending_says(name, tmp_path):
    ending = list(FORMATS)[list(COMMANDS).index(name) % len(FORMATS)]
    path = tmp_path / f"picture{ending}"

    assert main([*COMMANDS[name], "--plot", str(path)]) in (0, 1)
    drawn = path.read_bytes()
    assert drawn.startswith(MAGIC[ending])
    assert len(drawn) > 3000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]  # nothing half done lies beside it


def test_a_scene_file_of_several_components_is_drawn_like_a_table_of_one(scene, tmp_path):
    path = tmp_path / "slap.png"

    assert main(["slap", "--scene", scene, "--points", "20", "--plot", str(path)]) == 0
    assert np.ptp(images.imread(BytesIO(path.read_bytes()))) > 0.5


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("picture.gif", "'picture.gif' has no known ending; accepted: .png, .svg, .pdf, .webp"),
        ("picture", "'picture' has no known ending; accepted: .png, .svg, .pdf, .webp"),
        ("nowhere/picture.png", "there is no directory 'nowhere'; create it first"),
    ],
)
def test_a_picture_that_cannot_be_drawn_is_refused_in_one_sentence_before_any_work(
    path, said, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(PinballMap, "__init__", None)  # work would end in a TypeError

    assert main([*COMMANDS["orbit"], "--plot", path]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_matplotlib_is_imported_only_for_a_picture():
    arguments = ["orbit", "circle", "--lam", "0.5", "--start", "0,0.1", "--bounces", "2"]
    program = (
        f"import sys; from verification.app.cli import main; main({arguments}); sys.exit('matplotlib' in sys.modules)"
    )

    assert subprocess.run([sys.executable, "-c", program], stdout=subprocess.DEVNULL).returncode == 0


def test_a_picture_is_written_whole_or_the_old_one_stays(tmp_path, monkeypatch):
    path = tmp_path / "picture.png"
    path.write_bytes(b"old")
    monkeypatch.setattr(results, "orbit", lambda *data: 1 / 0)

    assert main([*COMMANDS["orbit"], "--plot", str(path)]) == 1
    assert path.read_bytes() == b"old"


def test_a_mark_is_a_certificate_that_is_checked_anew_and_is_about_the_same_scene(tmp_path, capsys):
    proof, changed = tmp_path / "fold.json", tmp_path / "changed.json"
    main(["locate", "saddle-node", "--alpha", "0.08", "--digits", "10", "--certificate", str(proof)])
    given = json.loads(proof.read_text())
    given["centre"][-1][0] = str(int(given["centre"][-1][0]) // 2)  # a contraction where nothing folds
    changed.write_text(json.dumps(given))
    diagram = list(COMMANDS["bifurcation"])

    assert main([*diagram, "--mark", str(proof), "--plot", str(tmp_path / "marked.svg")]) == 0
    assert b"period 3 folds" in (tmp_path / "marked.svg").read_bytes()
    capsys.readouterr()
    assert main([*diagram, "--mark", str(changed)]) == 2
    diagram[diagram.index("0.08")] = "0.07"
    assert main([*diagram, "--mark", str(proof)]) == 2
    assert "is about another scene: egg, alpha = 2/25" in capsys.readouterr().err


def test_an_outline_has_a_gap_where_a_hole_begins_and_none_within_one_curve():
    hole, curve = (results.outline(PinballMap(table))[0] for table in (tables.sinai(), tables.square()))

    assert int(np.isnan(hole).sum()) == 1
    assert not np.isnan(curve).any()


def test_a_density_counts_every_point_in_its_cell():
    """As many opaque cells as the points fill, whichever way the axes run."""
    from verification.plots.sheet import figure

    axes = figure(3.0, 2.0).add_subplot()
    axes.set_xlim(-1, 1)
    axes.set_ylim(-2, 2)
    rng = np.random.default_rng(1)
    x, y = rng.uniform(0.5, 1, results.DOTS + 1), rng.uniform(-2, -1, results.DOTS + 1)
    results.cloud(axes, x, y, "black")
    shown = np.asarray(axes.images[0].get_array())[..., 3] > 0

    rows, columns = shown.shape
    assert shown[: rows // 4, 3 * columns // 4 :].any()
    assert shown.sum() == shown[: rows // 4, 3 * columns // 4 - 1 :].sum()


def test_every_cell_of_a_fine_grid_has_a_dot_of_its_own():
    """Rows that alternate are all there: with fewer dots than rows one of the two would be lost in places."""
    import xarray as xr

    label = np.repeat(np.arange(900)[:, None] % 2, 4, axis=1)
    settings = json.dumps({"attractors": [{"period": 2, "kind": "cycle"}, {"period": 0, "kind": "chaotic"}]})
    axes = {"sin_phi": np.linspace(-1, 1, 900), "s": np.arange(4.0)}
    found = xr.Dataset({"label": (("sin_phi", "s"), label)}, axes, {"settings": settings})
    with styled():
        made = grids.basins(found)
        drawn = images.imread(BytesIO(image(made, ".png")))
    column = drawn[:, drawn.shape[1] // 2, 0]
    low, high = ({"C0": 0x1F, "C1": 0xFF}[name] / 255 for name in ("C0", "C1"))
    seen = column[(np.abs(column - low) < 0.01) | (np.abs(column - high) < 0.01)]
    assert np.count_nonzero(np.diff(seen)) >= 899 - 4  # but for those under the frame


def test_parameter_space_is_painted_by_period_and_by_exponent(tmp_path):
    path = tmp_path / "space.png"

    asked = "--alphas 0.04:0.09:3 --lams 0.1:0.9:5 --starts 2 --bounces 64 --transient 64"
    assert main(["sweep", "parameter-space", *asked.split(), "--plot", str(path)]) == 0
    painted = grids.periods(np.array([[2, 8, 0, 30]]), np.array([[-1.0, -1.0, 0.5, -0.1]]))
    assert painted[0, 0].tolist() == pytest.approx([1, 0x7F / 255, 0x0E / 255])
    assert painted[0, 1:].tolist() == [[0, 0, 0], [0.5, 0.5, 0.5], [0.85, 0.85, 0.85]]
    assert path.stat().st_size > 3000
