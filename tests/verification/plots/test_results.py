"""Pictures of the results of commands: of the right kind, and refused before any computation."""

import json
import subprocess
import sys

import numpy as np
import pytest

from verification.app.cli import main
from verification.plots import grids
from verification.plots.sheet import FORMATS

MAGIC = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF", ".webp": b"RIFF"}
EGG = ("egg", "--alpha", "0.08")
ELLIPSE = ("attractor", "ellipse", "--a", "1.5", "--lam", "0.3")
COMMANDS = {
    "orbit": ("orbit", *EGG, "--lam", "0.4", "--start", "0.1,0.2", "--bounces", "8"),
    "many bounces": ("orbit", *EGG, "--lam", "0.45", "--start", "0.1,0.2", "--bounces", "3000"),
    "attractor": (*ELLIPSE, "--orbits", "9", "--seed", "1", "--transient", "64", "--bounces", "100"),
    "lyapunov": ("lyapunov", *ELLIPSE[1:], "--bounces", "64", "--orbits", "8", "--seed", "1"),
    "basins": ("basins", *ELLIPSE[1:], *["--columns", "16", "--rows", "9", "--starts", "9", "--transient", "64"]),
    "bifurcation": ("bifurcation", *EGG, "--lams", "0.3:0.5:5", "--orbits", "3", "--points", "9", "--bounces", "64"),
    "slap": ("slap", *EGG, "--iterates", "3", "--points", "50"),
    "cycles": ("cycles", "ellipse", "--a", "1.5", "--lam", "0.5", "--period", "2"),
    "locate": ("locate", "saddle-node", "--alpha", "0.08", "--digits", "10"),
    "corner orbit": ("locate", "lambda-star", "--digits", "10"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_draws_what_it_computed_in_a_file_of_the_kind_that_its_ending_says(name, tmp_path):
    ending = list(FORMATS)[list(COMMANDS).index(name) % len(FORMATS)]
    path = tmp_path / f"picture{ending}"

    assert main([*COMMANDS[name], "--plot", str(path)]) in (0, 1)
    drawn = path.read_bytes()
    assert drawn.startswith(MAGIC[ending])
    assert len(drawn) > 3000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]  # nothing half done lies beside it


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


def test_parameter_space_is_painted_by_period_and_by_exponent(tmp_path):
    path = tmp_path / "space.png"

    asked = "--alphas 0.04:0.09:3 --lams 0.1:0.9:5 --starts 2 --bounces 64 --transient 64"
    assert main(["sweep", "parameter-space", *asked.split(), "--plot", str(path)]) == 0
    painted = grids.periods(np.array([[2, 8, 0, 30]]), np.array([[-1.0, -1.0, 0.5, -0.1]]))
    assert painted[0, 0].tolist() == pytest.approx([1, 0x7F / 255, 0x0E / 255])
    assert painted[0, 1:].tolist() == [[0, 0, 0], [0.5, 0.5, 0.5], [0.85, 0.85, 0.85]]
    assert path.stat().st_size > 3000
