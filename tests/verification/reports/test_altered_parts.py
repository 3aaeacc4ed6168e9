"""A report verifies its stored parts: altered parts are computed again, and certificates are proved again."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from symbolic import Scene
from verification.app.cli import main
from verification.reports import pictures
from verification.reports.asked import Parts
from verification.reports.report import report

SMALL = {"at": ("1/2",), "period": 2, "digits": 10}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The path of a report of an ellipse, stopped after its first followed cycle, and the bytes of its parts."""
    out = tmp_path_factory.mktemp("altered") / "ellipse.html"
    steps: list[str] = []
    again(out, steps)
    return out, {path: path.read_bytes() for path in out.with_suffix(".parts").iterdir()}


def again(out, steps):
    """Makes the report; it ends once a cycle has been followed or nothing is left to do."""

    def clock():
        return 1e6 if any(step.startswith("life") for step in steps) else 0.0

    return report(Scene("ellipse", a="3/2"), out, clock=clock, tick=steps.append, **SMALL)


@pytest.mark.slow
def test_parts_of_which_a_number_or_the_picture_was_altered_are_made_again(made):
    out, before = made
    parts = out.with_suffix(".parts")
    for part in ("scene", "census-0-0", "life-0"):
        head, blocks, tail = before[parts / f"{part}.json"].decode().partition('"blocks"')
        (parts / f"{part}.json").write_text(head + blocks + re.sub(r"\d+", "77777", tail, count=1))
    (parts / "slap.svg").write_text("<svg/>")
    steps: list[str] = []
    done = again(out, steps)

    assert {"scene", "census-0-0", "life-0", "slap"} <= {*steps}
    assert "portrait-0" not in steps
    assert "77777" not in json.dumps(done.document())
    assert "77777" not in out.read_text()


@pytest.mark.slow
def test_parts_that_were_not_altered_are_not_made_again(made):
    out, before = made
    for path, content in before.items():
        path.write_bytes(content)
    steps: list[str] = []
    again(out, steps)

    assert not {"scene", "slap", "portrait-0", "census-0-0", "life-0"} & {*steps}


@pytest.mark.slow
def test_a_table_without_attractors_has_a_page(tmp_path):
    """In the unit square at contraction 0 each normal flight returns on itself, so there is no attractor."""
    out = tmp_path / "square.html"
    words = ["report", "square", "--minutes", "0.05", "--period", "2", "--at", "0,1/2", "--out", str(out)]

    assert main(words) == 0
    assert "The scene" in out.read_text()


def test_families_that_are_none_are_drawn(tmp_path):
    parts = Parts(tmp_path, "none")
    none = {"family": np.empty(0), "at": np.empty(0), "s": np.empty(0)}
    shares = {"shares_at": np.array([0.2, 0.8]), "counts": np.array([[0, 9, 1, 0], [0, 10, 0, 0]])}
    row = np.zeros(2)
    found = {"values": np.array([0.0, 1.0]), "half": np.array(1.0), "spread": np.eye(2, dtype=int)}
    pictures.diagram(parts, "none", found | {"largest": row, "least": row, "error": row}, "lam", [], none | shares)

    assert parts.picture("none").exists()


def test_what_is_no_table_has_no_page(tmp_path, capsys):
    """The boundary runs out and back along one line."""
    corners = [(0, 0), (2, 0), (4, 0), (2, 0), (2, 2), (0, 2)]
    sides = zip(corners, [*corners[1:], corners[0]], strict=True)
    words = (f'x = "{p} + {q - p}*theta"\ny = "{r} + {s - r}*theta"' for (p, r), (q, s) in sides)
    (tmp_path / "spike.toml").write_text("".join(f'[[component]]\n{said}\nfrom = "0"\nto = "1"\n' for said in words))

    assert main(["report", "--scene", str(tmp_path / "spike.toml"), "--out", str(tmp_path / "page")]) == 2
    assert "is not proved to be a table" in capsys.readouterr().err
    assert not (tmp_path / "page").exists()


@pytest.mark.slow
def test_an_interrupted_report_says_where_it_is_and_goes_on(tmp_path):
    out = tmp_path / "report"
    words = ["report", "circle", "--period", "2", "--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-m", "verification", *words],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    while not (out / "report.html").exists() and process.poll() is None:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[1]

    assert said == f"pinball: interrupted; what was done is in {out / 'report.html'}, and the same command goes on\n"
    assert main([*words, "--minutes", "0.01"]) == 0
