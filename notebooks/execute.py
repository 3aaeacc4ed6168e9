"""Executes the notebooks from their texts and writes them with what they show: `python execute.py [NAME ...]`."""

import sys
from pathlib import Path
from typing import Any

import jupytext
import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).parent
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}


def texts() -> list[Path]:
    """The texts of the notebooks, in order."""
    return sorted(HERE.glob("[0-9]_*.py"))


def executed(text: Path) -> Any:
    """The notebook of a text, run from the first cell to the last in a kernel of its own."""
    notebook = jupytext.read(text)
    notebook.metadata = {"jupytext": {"formats": "ipynb,py:light"}, "kernelspec": KERNEL}
    for number, cell in enumerate(notebook.cells):
        cell["id"] = f"cell-{number}"  # the same bytes every time
        cell.metadata = {}
    where = {"metadata": {"path": str(HERE.parent)}}
    NotebookClient(notebook, timeout=600, resources=where, record_timing=False).execute()
    notebook.metadata.pop("language_info", None)
    return notebook


if __name__ == "__main__":
    for text in texts():
        if not sys.argv[1:] or text.stem in sys.argv[1:]:
            nbformat.write(executed(text), text.with_suffix(".ipynb"))
            print(text.stem, file=sys.stderr)
