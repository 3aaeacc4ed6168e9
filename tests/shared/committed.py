"""Helpers, imported as `committed`: committed certificates, changed ones, and the independent checker's verdict."""

import json
from fractions import Fraction
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


COUNTS = {
    "cycle": "exactly one cycle has its {n} bounces in the box.",
    "flip": "exactly one cycle with its {n} bounces and {free} in the box has the multiplier -1: a flip.",
}


def told(given: dict) -> dict:
    """The document with the name and the statement that its other entries require: docs/certificate_format.md."""
    scene, free, n = given["scene"], given["free"], len(given["components"])
    title = scene.get("table") or (f"polar {scene['polar']}" if "polar" in scene else None)
    title = title or (f"parametric {'; '.join(scene['parametric'])}" if "parametric" in scene else None)
    title = title or f"boundary of {len(scene['component'])} pieces"
    said = [("phi", scene.get("law")), *scene.get("shape", {}).items(), ("lam", scene.get("lam"))]
    title += "".join(f", {key} = {text}" for key, text in said if text and ".." not in text)
    kind = "a cycle" if given["kind"] == "cycle" else f"{given['kind']} of a cycle"
    given["name"] = f"{kind} of period {n}{f' in {free}' if free else ''}: {title}"
    given["statement"] = f"{title}: {COUNTS[given['kind']].format(n=n, free=free)}"
    return given


def moved(given: dict, place: int, by: Fraction | int) -> dict:
    """The document with the middle of one unknown moved by so many radii."""
    (m, e), (r, f) = given["centre"][place], given["radius"]
    x = int(m) * Fraction(2) ** int(e) + by * int(r) * Fraction(2) ** int(f)
    centre = [*given["centre"]]
    centre[place] = [str(round(x * 2**400)), "-400"]
    return given | {"centre": centre}
