"""The notebooks run from their first cell to the last, and each agrees with its text form."""

import importlib.util
from pathlib import Path

import jupytext
import pytest

HERE = Path(__file__).parents[2] / "notebooks"
SPEC = importlib.util.spec_from_file_location("execute", HERE / "execute.py")
execute = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(execute)
TEXTS = execute.texts()


def sources(path):
    return [(cell.cell_type, cell.source) for cell in jupytext.read(path).cells]


@pytest.mark.slow
@pytest.mark.parametrize("text", TEXTS, ids=lambda path: path.stem)
def test_a_notebook_derives_what_it_says(text):
    notebook = execute.executed(text)

    assert all(cell.get("execution_count") for cell in notebook.cells if cell.cell_type == "code")


@pytest.mark.parametrize("text", TEXTS, ids=lambda path: path.stem)
def test_a_notebook_and_its_text_say_the_same(text):
    assert sources(text.with_suffix(".ipynb")) == sources(text)


@pytest.mark.parametrize("text", TEXTS, ids=lambda path: path.stem)
def test_a_notebook_ends_with_a_check_that_can_fail(text):
    assert "assert " in sources(text)[-1][1]


@pytest.mark.parametrize("text", TEXTS, ids=lambda path: path.stem)
def test_a_notebook_shows_a_picture(text):
    cells = jupytext.read(text.with_suffix(".ipynb")).cells
    shown = [output for cell in cells for output in cell.get("outputs", [])]

    assert any("image/png" in output.get("data", {}) for output in shown)


def test_there_are_notebooks_one_to_eight():
    assert [int(text.name[0]) for text in TEXTS] == list(range(1, 9))
