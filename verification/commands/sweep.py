"""`pinball sweep KIND`: grids of independent tasks, on all cores or on a Dask cluster, into a Zarr store."""

from fractions import Fraction
from typing import TYPE_CHECKING

import click

from symbolic.scene import Scene
from verification.commands.basins import command as basins
from verification.commands.bifurcation import command as bifurcation
from verification.commands.scene import table_options
from verification.commands.sweeping import How, carried_out, lams_option, over, seed_option, span, sweep_options

if TYPE_CHECKING:
    import xarray as xr

TEXT_WIDTH = 100  # letters of the picture shown to people
ROWS = 24  # contractions shown to people


class Kinds(click.Group):
    """A group that says which kinds there are when another is asked for."""

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:
        if cmd_name not in self.commands:
            raise click.UsageError(f"no sweep is called {cmd_name!r}; accepted: {', '.join(self.commands)}")
        return self.commands[cmd_name]


@click.group(
    cls=Kinds,
    no_args_is_help=False,
    epilog="Example: pinball sweep parameter-space --alphas 0:0.1:21 --lams 0:1:41 --dry-run",
)
def command() -> None:
    """Parameter space, exponents, basins and bifurcation diagrams.

    The bits of the results depend on the seed and on nothing else, and a sweep with a --store that was stopped goes
    on from there when the same command is given again.
    """


@command.command(
    "parameter-space",
    epilog="Example: pinball sweep parameter-space --alphas 0:0.1:101 --lams 0:1:101 --store parameter-space.zarr",
)
@click.option(
    "--alphas", metavar="LOW:HIGH:N", required=True, help="Shapes of the egg, equally spaced, with both ends."
)
@lams_option
@click.option("--K", "K", type=click.IntRange(2, 100), default=3, show_default=True, help="Points of the egg.")
@click.option("--starts", type=click.IntRange(1, 100_000), default=100, show_default=True, help="Random balls a pair.")
@click.option("--bounces", type=click.IntRange(8, 10**9), default=2000, show_default=True, help="That count, each.")
@click.option("--transient", type=click.IntRange(0, 10**9), default=2000, show_default=True, help="Bounces before.")
@seed_option
@sweep_options
def parameter_space(
    alphas: str, lams: str, K: int, starts: int, bounces: int, transient: int, seed: int, how: How
) -> int:
    """Chaos or none in the egg, for each pair of shape and contraction.

    An orbit counts as chaotic when its exponent is positive beyond two standard errors and beyond what shear shows.
    """
    import numpy as np

    from verification.sweeps import parameter_space as space

    shapes = np.array(span("--alphas", alphas, high=Fraction(1, K * K + 1)))
    sweep = space.parameter_space(shapes, np.array(span("--lams", lams)), starts, bounces, transient, K, seed)
    return carried_out(sweep, how, picture)


def picture(found: "xr.Dataset") -> list[str]:
    """The parameter space in letters: `#` where some orbit is chaotic, `.` where none is. Paper: section 6.5."""
    step = max(1, -(-found.lam.size // TEXT_WIDTH))
    shown = [f"alpha down, lam from {float(found.lam[0]):g} to {float(found.lam[-1]):g} across; # chaos, . none"]
    for alpha, counts in zip(found.alpha.values, found.chaotic.values[:, ::step], strict=True):
        shown.append(f"{alpha:<9.5g}" + "".join("#" if count else "." for count in counts))
    return shown


@command.command(
    "exponents", epilog="Example: pinball sweep exponents cuspless --lams 0:1:51 --orbits 100 --json exponents.json"
)
@table_options
@lams_option
@click.option("--orbits", type=click.IntRange(2, 10**6), default=100, show_default=True, help="Random balls for each.")
@click.option("--groups", type=click.IntRange(1, 64), default=6, show_default=True, help="Attractors kept for each.")
@click.option("--bounces", type=click.IntRange(64, 10**9), default=4096, show_default=True, help="That count, each.")
@click.option("--transient", type=click.IntRange(0, 10**9), default=2000, show_default=True, help="Bounces before.")
@seed_option
@sweep_options
def exponents(
    scene: Scene, lams: str, orbits: int, groups: int, bounces: int, transient: int, seed: int, how: How
) -> int:
    """Both Lyapunov exponents against the contraction, with standard errors, for each attractor."""
    from verification.sweeps import exponents as kind

    text, values = over(scene, lams)
    return carried_out(kind.exponents(text, values, orbits, groups, bounces, transient, seed), how, table_of_groups)


def table_of_groups(found: "xr.Dataset") -> list[str]:
    """For some contractions, a line for each attractor."""
    shown = ["lam        orbits  period  nu_plus               nu_minus"]
    for i in range(0, found.lam.size, max(1, found.lam.size // ROWS)):
        one = found.isel(lam=i).load()
        for j in range(found.group.size):
            group = one.isel(group=j)
            if int(group.orbits) > 0:
                shown.append(
                    f"{float(one.lam):<11.6g}{int(group.orbits):<8d}{int(group.period) or '-':<8}"
                    f"{float(group.nu_plus):<11.6f}+- {float(group.nu_plus_error):<8.1g}"
                    f"{float(group.nu_minus):<11.6f}+- {float(group.nu_minus_error):.1g}"
                )
    return shown


command.add_command(bifurcation, "bifurcation")
command.add_command(basins, "basins")
