"""`pinball bifurcation`: the attractors against the contraction."""

from typing import TYPE_CHECKING

import click

from symbolic.scene import Scene
from verification.commands.scene import table_options
from verification.commands.sweeping import How, carried_out, lams_option, over, seed_option, sweep_options

if TYPE_CHECKING:
    import xarray as xr

ROWS = 24  # contractions shown to people
DISTINCT = 1e-6  # between points of phase space, to tell one from another
MANY = 64  # distinct points; more are not counted


@click.command(
    epilog="Example: pinball bifurcation egg --alpha 0.08 --lams 0.35:0.45:101 --orbits 20 --json diagram.json"
)
@table_options
@lams_option
@click.option("--orbits", type=click.IntRange(1, 100_000), default=20, show_default=True, help="Random balls for each.")
@click.option("--points", type=click.IntRange(1, 100_000), default=100, show_default=True, help="Bounces kept of each.")
@click.option("--transient", type=click.IntRange(0, 10**9), default=4000, show_default=True, help="Bounces before.")
@click.option("--bounces", type=click.IntRange(8, 10**9), default=2000, show_default=True, help="For the exponents.")
@seed_option
@sweep_options
def command(
    scene: Scene, lams: str, orbits: int, points: int, transient: int, bounces: int, seed: int, how: How
) -> int:
    """Where random balls are after a long time, for each contraction; starts as in the paper's appendix."""
    from verification.sweeps.bifurcation import bifurcation

    text, values = over(scene, lams)
    sweep = bifurcation(text, values, orbits, points, bounces, transient, seed)
    return carried_out(sweep, how, lines)


def lines(found: "xr.Dataset") -> list[str]:
    """For some contractions, how many orbits are chaotic and how many points the attractors show."""
    import numpy as np

    shown = ["lam        chaotic  nu_plus max  points"]
    for i in range(0, found.lam.size, max(1, found.lam.size // ROWS)):
        one = found.isel(lam=i)
        places = np.stack([one.s.values.ravel(), one.phi.values.ravel()], axis=1)
        count = len(np.unique(np.round(places / DISTINCT), axis=0))
        shown.append(
            f"{float(one.lam):<11.6g}{int(one.chaotic.sum()):<9d}{float(one.nu_plus.max()):<13.4f}"
            + (f"{count}" if count <= MANY else "many")
        )
    return shown
