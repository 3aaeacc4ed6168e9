"""`pinball basins`: which attractor each start reaches."""

from typing import TYPE_CHECKING

import click

from symbolic.definition import exact
from symbolic.scene import Scene
from verification.commands.scene import scene_options
from verification.commands.sweeping import How, carried_out, sweep_options

if TYPE_CHECKING:
    import xarray as xr

COLUMNS, ROWS = 96, 24  # of the picture in letters
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


@click.command(epilog="Example: pinball basins cuspless --lam 0.09 --columns 400 --rows 400 --store basins.zarr")
@scene_options
@click.option("--columns", type=click.IntRange(1, 100_000), required=True, help="Cells along the boundary.")
@click.option("--rows", type=click.IntRange(1, 100_000), required=True, help="Cells in sin(phi).")
@click.option(
    "--window", nargs=4, metavar="S S SIN SIN", help="Ends of s and of sin(phi); all of phase space if not given."
)
@click.option("--starts", type=click.IntRange(1, 10**7), default=1000, show_default=True, help="To find attractors.")
@click.option("--transient", type=click.IntRange(10, 10**8), default=1000, show_default=True, help="Bounces of each.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the starts.")
@sweep_options
def command(
    scene: Scene,
    columns: int,
    rows: int,
    window: tuple[str, str, str, str] | None,
    starts: int,
    transient: int,
    seed: int,
    how: How,
) -> int:
    """The attractor that each cell of phase space reaches; attractors are found from random starts first."""
    from verification.dynamics.basins import Window
    from verification.sweeps.basins import basins
    from verification.sweeps.scenes import text_of

    ends = None
    if window is not None:
        left, right, low, high = (float(exact("--window", text)) for text in window)
        if not (left < right and -1 <= low < high <= 1):
            raise ValueError(
                f"--window {' '.join(window)} is no window; accepted: two values of s and two of sin(phi) in [-1, 1], "
                "the smaller first"
            )
        ends = Window((left, right), (low, high))
    lam = float(scene.lam)
    known = () if how.dry_run else None  # what the sweep costs does not depend on them
    sweep = basins(text_of(scene), lam, columns, rows, ends, starts, transient, seed, scene.table, known)
    return carried_out(sweep, how, lines)


def lines(found: "xr.Dataset") -> list[str]:
    """What share of the cells each attractor takes, and a small picture in letters."""
    import numpy as np

    from verification.sweeps.basins import attractors_of

    label = found.label.values
    shown = []
    for i, attractor in enumerate(attractors_of(found.attrs["settings"])):
        kind = f"cycle of period {attractor['period']}" if attractor["kind"] == "cycle" else attractor["kind"]
        shown.append(
            f"{letter(i)}  {np.mean(label == i):7.2%}  {kind} near theta = {round(attractor['theta'], 4) + 0.0:.4f}"
        )
    if np.any(label < 0):
        shown.append(f".  {np.mean(label < 0):7.2%}  none of these")
    down = np.linspace(0, label.shape[0] - 1, min(ROWS, label.shape[0])).round().astype(int)
    across = np.linspace(0, label.shape[1] - 1, min(COLUMNS, label.shape[1])).round().astype(int)
    shown += ["".join(letter(i) for i in row) for row in label[np.ix_(down[::-1], across)]]
    return shown


def letter(index: int) -> str:
    """The letter of an attractor.

    >>> letter(0), letter(-1)
    ('A', '.')
    """
    return "." if index < 0 else LETTERS[min(index, len(LETTERS) - 1)]
