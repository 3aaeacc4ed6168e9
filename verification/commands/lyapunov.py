"""`pinball lyapunov`: the two exponents, with error bars, for every attractor found."""

from typing import TYPE_CHECKING, Any

import click

from verification.cli import DONE
from verification.commands.mapped import pinball_map
from verification.commands.output import Output, json_option
from verification.commands.scene import Scene, scene_options

if TYPE_CHECKING:
    from rich.console import Console


@click.command(epilog="Example: pinball lyapunov cuspless --lam 0.8 --bounces 10000 --orbits 100 --seed 1")
@scene_options
@click.option("--bounces", type=click.IntRange(10, 1_000_000_000), required=True, help="Bounces that count, each.")
@click.option("--orbits", type=click.IntRange(2, 10_000_000), required=True, help="How many random starts.")
@click.option("--seed", type=click.IntRange(0), required=True, help="Of the random starts.")
@click.option("--transient", type=click.IntRange(0, 1_000_000_000), help="Bounces before; --bounces if left out.")
@json_option
def command(scene: Scene, bounces: int, orbits: int, seed: int, transient: int | None, output: Output) -> int:
    """The two exponents per bounce, in the coordinates (s, phi), with their standard errors.

    Starts are uniform in arc length and in sin(phi).
    """
    from verification.attractors import survey

    document = survey(pinball_map(scene), bounces, orbits, seed, bounces if transient is None else transient)
    output.write(document)
    show(output.console, document)
    return DONE


def show(console: "Console", document: dict[str, Any]) -> None:
    """The averages, and a line for each attractor."""
    console.print(f"nu_plus  = {_measured(document, 'nu_plus')}")
    console.print(f"nu_minus = {_measured(document, 'nu_minus')}")
    console.print(f"over {document['orbits']} orbits of {document['bounces']} bounces, per bounce")
    for group in document["groups"]:
        console.print(
            f"{group['orbits']:>8} orbits: {group['kind']}"
            f"  nu_plus = {_measured(group, 'nu_plus')}  nu_minus = {_measured(group, 'nu_minus')}"
        )


def _measured(document: dict[str, Any], name: str) -> str:
    value, error = document[name], document[f"{name}_stderr"]
    if value is None:
        return "-oo"
    return f"{value:.6g}" + ("" if error is None else f" +- {error:.1g}")
