"""Basins of attraction on a grid of phase space. Paper: appendix, figures of basins.

The attractors are found once, from random starts; then each cell's centre is a ball, and its label is the number of
the attractor that it reaches.
"""

import json
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from numeric.dynamics.attractors import find
from numeric.dynamics.basins import Window, labels, starts_at, whole
from numeric.dynamics.kinds import Attractor
from numeric.sweeps.scenes import map_of
from numeric.sweeps.sweep import Array, Axis, Field, Part, Sweep

BALLS = 1 << 15  # of a task, about; a fraction of a second for a thousand bounces
FIELDS = (Field("label", ("sin_phi", "s"), "int16", "1", "number of the attractor, -1 for none of those found"),)


@dataclass(frozen=True, eq=False)
class Cells:
    """The task: the labels of some rows of cells."""

    scene: str
    lam: float
    attractors: tuple[Attractor, ...]
    transient: int

    def __call__(self, part: Part) -> dict[str, Array]:
        columns, rows = part.values["s"], part.values["sin_phi"]
        map = map_of(self.scene, self.lam)
        balls = starts_at(map, np.tile(columns, rows.size), np.repeat(rows, columns.size))
        return {"label": labels(map, balls, self.attractors, self.transient).reshape(rows.size, columns.size)}


def basins(
    scene: str,
    lam: float,
    columns: int,
    rows: int,
    window: Window | None = None,
    starts: int = 1000,
    transient: int = 1000,
    seed: int = 1,
    table: Any = None,
    known: tuple[Attractor, ...] | None = None,
) -> Sweep:
    """The sweep over the cells of a window, or of all phase space; with `table`, its symmetries give attractors too.

    Attractors that are `known` already are not looked for.

    >>> from symbolic import Scene
    >>> from numeric.sweeps.scenes import text_of
    >>> sweep = basins(text_of(Scene("cuspless")), 0.09, 4, 2, starts=100)
    >>> sorted(set(sweep.task(sweep.part((0, 0)))["label"].ravel().tolist()))  # a chaotic attractor and period 2
    [0, 1]
    """
    map = map_of(scene, lam)
    attractors = find(map, starts, seed, table, transient) if known is None else known
    where = window or whole(map)
    cells = Cells(scene, lam, attractors, transient)
    return Sweep(
        name="basins",
        about=f"Basins of attraction at lam = {lam:g}",
        axes=(
            Axis(
                "sin_phi", _centres(where.sin_phi, rows), "1", "sine of the first exit angle", max(1, BALLS // columns)
            ),
            Axis("s", _centres(where.s, columns), "length", "arc length of the start, as in the paper"),
        ),
        fields=FIELDS,
        task=cells,
        seed=seed,
        scene=scene,
        settings={
            "lam": lam,
            "starts": starts,
            "transient": transient,
            "attractors": [described(attractor) for attractor in attractors],
        },
        collisions=columns * rows * transient,
        map=partial(map_of, scene, lam),
    )


def described(attractor: Attractor) -> dict[str, Any]:
    """An attractor in a few numbers: its kind, period, exponents, and one of its points."""
    first = {"theta": float(attractor.points.theta[0]), "phi": float(attractor.points.phi[0])}
    exponents = {"nu_plus": attractor.nu_plus, "nu_minus": attractor.nu_minus}
    finite = {name: value if np.isfinite(value) else None for name, value in exponents.items()}
    return (
        {"kind": attractor.kind.name.lower(), "period": attractor.period, "family": attractor.family} | finite | first
    )


def attractors_of(settings: str) -> list[dict[str, Any]]:
    """What `described` said of the attractors, from the settings that label a result."""
    found: list[dict[str, Any]] = json.loads(settings)["attractors"]
    return found


def _centres(ends: tuple[float, float], count: int) -> Array:
    return ends[0] + (np.arange(count) + 0.5) * ((ends[1] - ends[0]) / count)
