"""Helpers, imported as `committed`: the committed certificates, and the independent checker's verdict on a document."""

import json
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "certificates"


def document(name: str) -> dict:
    """A certificate of the folder, by the name of its file without the ending."""
    return json.loads((FOLDER / f"{name}.json").read_text())


def verdict(check, given: dict) -> str:
    """What the checker finds about a document, as its `main` prints it."""
    try:
        return check.checked(given)
    except check.Unproved as why:
        return f"not proved: {why}"
    except check.Wrong as why:
        return f"refused: {why}"
