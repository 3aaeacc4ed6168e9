"""`pinball slap`: the slap map and its iterates, as numbers."""

from typing import TYPE_CHECKING

import click

from symbolic.scene import Scene
from verification.cli import DONE
from verification.commands.mapped import pinball_map
from verification.commands.output import Output, json_option
from verification.commands.scene import table_options

if TYPE_CHECKING:
    from rich.console import Console

ROWS = 33  # points shown to people


@click.command(epilog="Example: pinball slap egg --alpha 0.08 --iterates 4 --points 1000 --json slap.json")
@table_options
@click.option("--iterates", type=click.IntRange(1, 1000), default=1, show_default=True, help="Up to which power.")
@click.option("--points", type=click.IntRange(2, 1_000_000), default=200, show_default=True, help="On each component.")
@json_option
def command(scene: Scene, iterates: int, points: int, output: Output) -> int:
    """The slap map: what remains at lambda = 0, where every exit is along the normal."""
    import numpy as np

    map = pinball_map(scene, lam=0)
    names = [part.name for part in map.blueprint.parts]
    component = np.repeat(np.arange(len(names)), points)
    ends = np.array(map.states.ends)
    share = (np.tile(np.arange(points), len(names)) + 0.5) / points
    theta = ends[component, 0] + (ends[component, 1] - ends[component, 0]) * share
    values = map.slap(theta, iterates, component)
    document = {
        "iterates": iterates,
        "points": [
            {
                "component": names[component[i]],
                "theta": float(theta[i]),
                "images": [
                    {"component": names[values.component[k, i]], "theta": float(values.theta[k, i])}
                    if values.code[k, i] == 0
                    else None
                    for k in range(1, iterates + 1)
                ],
                "slope": float(values.slope[i]),
            }
            for i in range(theta.size)
        ],
    }
    output.write(document)
    rows = range(0, theta.size, max(1, theta.size // ROWS))
    show(
        output.console,
        [(float(theta[i]), [float(x) for x in values.theta[1:, i]], float(values.slope[i])) for i in rows],
    )
    return DONE


def show(console: "Console", rows: list[tuple[float, list[float], float]]) -> None:
    """Some points, their images and the slope `T0'(s)`."""
    console.print("theta        slope        images")
    for theta, images, slope in rows:
        console.print(f"{theta:<13.6f}{slope:<13.6f}" + "  ".join(f"{image:.6f}" for image in images[:8]))
