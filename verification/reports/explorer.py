"""A page for a database of Morse graphs: pointing at a box of parameters shows its graph and Morse sets."""

import base64
import json
import zlib
from fractions import Fraction
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from numpy.typing import NDArray

from symbolic.tables.scene import Scene
from verification.plots.sheet import PALETTE
from verification.proofs.global_dynamics.database import KNOWN, Numbers

if TYPE_CHECKING:
    import xarray as xr

COLUMNS, ROWS = 48, 64  # cells of phase space on the page, at most


def explorer(found: "xr.Dataset", label: Numbers) -> str:
    """The page as one file of HTML that needs no network; `label` is the class of each box of parameters."""
    settings = json.loads(found.attrs["settings"])
    parameter, sets = settings["parameter"], found.sets.values
    scene = Scene.parse(found.attrs["scene"])
    cells = _thinned(found.cells.values)
    packed = np.concatenate([cells.reshape(sets.size, -1), found.leads.values.reshape(sets.size, -1)], axis=1)
    data = {
        "lams": [f"{float(Fraction(end)):.6g}" for end in settings["lams"]],
        "values": [f"{float(Fraction(end)):.6g}" for end in settings["values"]],
        "classes": label.ravel().tolist(),
        "sets": sets.ravel().tolist(),
        "attracting": found.attracting.values.ravel().tolist(),
        "tops": [None if top != top else top for top in found.top.values.ravel().tolist()],
        "packed": base64.b64encode(zlib.compress(packed.astype(np.int8).tobytes(), 9)).decode(),
    }
    few = int(label.max(initial=-1)) < len(PALETTE)
    turns, (low, high) = settings["turns"], settings["theta"]
    environment = Environment(undefined=StrictUndefined, autoescape=True)
    template = environment.from_string((files("verification.reports") / "explorer.html").read_text(encoding="utf-8"))
    return template.render(
        name=f"{scene.name}, {parameter} and lambda",
        parameter=parameter,
        lams=data["lams"],
        values=data["values"],
        across=sets.shape[1],
        down=sets.shape[0],
        columns=cells.shape[-1],
        rows=cells.shape[-2],
        known=KNOWN,
        shades="empty ones have none" if few else "the smaller classes are grey, and empty boxes have none",
        turned=f", up to turns by 1/{turns} of the circle" if turns > 1 else "",
        left=f"theta = {low:.4g}",
        right=f"theta = {high:.4g}",
        scene=found.attrs["scene"],
        fine=f"{settings['columns']} by {settings['rows']}",
        data=Markup(json.dumps(data).replace("<", "\\u003c")),
        palette=Markup(json.dumps(PALETTE)),
    )


def _thinned(cells: NDArray[np.int8]) -> NDArray[np.int8]:
    """The cells of phase space, coarsened to at most `ROWS` by `COLUMNS`, by the largest set index in each block."""
    for axis, most in ((-2, ROWS), (-1, COLUMNS)):
        step = -(-cells.shape[axis] // most)
        cells = np.maximum.reduceat(cells, np.arange(0, cells.shape[axis], step), axis=axis)
    return cells
