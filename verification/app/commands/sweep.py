"""Sweeps: grids of independent tasks, run on all cores or on a Dask cluster, with results in a Zarr store.

`pinball sweep KIND` runs any kind of grid; `pinball basins` shows which attractor each start reaches, and `pinball
bifurcation` draws the attractors against the contraction.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import POINTS, exact
from symbolic.tables.scene import Scene
from verification.app.cli import DONE, FAILED, Output, Whole, document, json_option, plot_option
from verification.app.scene import along, optional_options, over, scene_options, span, varied_options

if TYPE_CHECKING:
    import xarray as xr

    from numeric.sweeps.store import Memory, Stored
    from numeric.sweeps.sweep import Sweep


COLUMNS, ROWS = 80, 24  # of the picture in letters
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
Command = Callable[..., Any]
Lines = Callable[["Memory | Stored"], list[str]]


@dataclass(frozen=True)
class How:
    """How a sweep is run: where its results go, and on which workers it is computed."""

    output: Output
    store: Path | None
    scheduler: str | None
    workers: int | None
    dry_run: bool


OPTIONS = (
    click.option("--store", type=click.Path(path_type=Path), metavar="DIR", help="Zarr store, made or resumed."),
    click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler, such as tcp://127.0.0.1:8786."),
    click.option("--workers", type=Whole(1, 4096), help="Threads; all cores if left out."),
    click.option("--dry-run", is_flag=True, help="Say what it costs, and do nothing."),
    json_option,
)


lams_option = click.option(
    "--lams", metavar="LOW:HIGH:N", required=True, help="Contractions, equally spaced, both ends included."
)
seed_option = click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of the random starts.")


def sweep_options(command: Command) -> Command:
    """Decorator that gives a command the options of every sweep, as a keyword `how`."""

    @wraps(command)
    def called(
        output: Output, store: Path | None, scheduler: str | None, workers: int | None, dry_run: bool, **others: Any
    ) -> Any:
        return command(how=How(output, store, scheduler, workers, dry_run), **others)

    for option in reversed(OPTIONS):
        called = option(called)
    return called


def carried_out(sweep: "Sweep", how: How, lines: Lines, *more: Any) -> int:
    """Runs a sweep, or estimates its cost, and prints a summary; returns the exit status. `more` is for --plot."""
    from numeric.sweeps import run
    from numeric.sweeps.cost import cost

    if how.dry_run:
        expected = cost(sweep, how.workers, how.store is not None)
        how.output.write({"dry_run": True, "sweep": sweep.name, **expected.as_data()})
        for line in expected.lines():
            how.output.console.print(line)
        return DONE
    with how.output.progress(sweep.name, len(sweep.indices())) as advance:
        shown, begun = 0, False

        def tick(done: int, parts: int) -> None:
            nonlocal shown, begun
            if done and not begun:  # the first call says what the store had
                how.output.console.print(f"{done} of {parts} parts were there")
            begun = True
            for i in range(shown, done):
                advance(f"{i + 1} of {parts}")
            shown = done

        try:
            found = run.carried_out(sweep, how.store, how.scheduler, how.workers, tick)
        except run.UnfinishedError as stop:
            click.echo(f"pinball: {stop}", err=True)
            return FAILED
    if how.output.wanted:
        labelled = found.dataset()
        how.output.write(document(labelled, how.store), labelled, *more)
    for line in lines(found):
        how.output.console.print(line)
    if how.store is not None:
        how.output.console.print(f"all of it is in {how.store}: xarray.open_zarr({str(how.store)!r})")
    return DONE


@click.command(epilog="Example: pinball basins cuspless --lam 0.09 --columns 400 --rows 400 --store basins.zarr")
@scene_options
@click.option("--columns", type=Whole(1, 100_000), required=True, help="Cells along the boundary.")
@click.option("--rows", type=Whole(1, 100_000), required=True, help="Cells in sin(phi).")
@click.option(
    "--window", nargs=4, metavar="S S SIN SIN", help="Ends of s and of sin(phi); all of phase space if not given."
)
@click.option("--starts", type=Whole(1, 10**7), default=1000, show_default=True, help="To find attractors.")
@click.option("--transient", type=Whole(10, 10**8), default=1000, show_default=True, help="Bounces of each.")
@click.option("--seed", type=Whole(0), default=1, show_default=True, help="Of the starts.")
@plot_option("grids.basins", "the basins, a colour for each attractor")
@sweep_options
def basins_command(
    scene: Scene,
    columns: int,
    rows: int,
    window: tuple[str, str, str, str] | None,
    starts: int,
    transient: int,
    seed: int,
    how: How,
) -> int:
    """Computes which attractor each cell of phase space reaches; the attractors are found from random starts first."""
    from numeric.dynamics.basins import Window
    from numeric.sweeps.fields import basins
    from numeric.sweeps.sweep import text_of

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
    sweep = basins(text_of(scene), lam, columns, rows, ends, starts, transient, seed, True, known)
    return carried_out(sweep, how, basins_lines)


def basins_lines(found: "Memory | Stored") -> list[str]:
    """Lines of text: the fraction of cells that reach each attractor, and a small picture made of letters."""
    import numpy as np

    label = found.arrays["label"][:]
    shown = []
    for i, attractor in enumerate(found.sweep.settings["attractors"]):
        kind = f"cycle of period {attractor['period']}" if attractor["kind"] == "cycle" else attractor["kind"]
        kind += f" ({reason}: undecided whether it is one)" if (reason := attractor.get("undecided")) else ""
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
    """The letter for the attractor of this index; a dot for a negative index.

    >>> letter(0), letter(-1)
    ('A', '.')
    """
    return "." if index < 0 else LETTERS[min(index, len(LETTERS) - 1)]


BIFURCATION_ROWS = 24  # contractions shown to people
DISTINCT = 1e-6  # points of phase space closer than this count as one
MANY = 64  # distinct points; more are not counted


@click.command(
    epilog="Example: pinball bifurcation egg --alpha 0.08 --lams 0.35:0.45:101 --orbits 20 --json diagram.json"
)
@varied_options
@lams_option
@click.option("--orbits", type=Whole(1, 100_000), default=20, show_default=True, help="Random particles for each.")
@click.option("--points", type=Whole(1, 100_000), default=100, show_default=True, help="Bounces kept of each.")
@click.option("--transient", type=Whole(0, 10**9), default=4000, show_default=True, help="Bounces before.")
@click.option("--bounces", type=Whole(8, 10**9), default=2000, show_default=True, help="For the exponents.")
@seed_option
@click.option("--mark", "marks", multiple=True, metavar="FILE", help="A certificate, checked and drawn by --plot.")
@plot_option("grids.bifurcation", "the attractors as a density, and the exponents")
@sweep_options
def bifurcation_command(
    scene: Scene,
    axis: str | None,
    lams: str,
    orbits: int,
    points: int,
    transient: int,
    bounces: int,
    seed: int,
    marks: tuple[str, ...],
    how: How,
) -> int:
    """Bifurcation diagram: random particles after a long time, for each contraction; starts as in the paper's appendix.

    With --shape NAME=LOW:HIGH:N a parameter of the table or of the law varies, and --lams is one number. Each --mark is
    a certificate that `pinball locate --certificate` wrote for this scene, and is drawn as a line at the proved value.
    """
    from numeric.sweeps.fields import bifurcation
    from verification.app.commands.locate import marked

    text, parameter, values, lam = over(scene, lams, axis)
    sweep = bifurcation(text, values, orbits, points, bounces, transient, seed, parameter, lam)
    shown = [] if how.dry_run else [marked(path, scene, parameter) for path in marks]
    return carried_out(sweep, how, lambda found: bifurcation_lines(found.dataset()), shown)


def bifurcation_lines(found: "xr.Dataset") -> list[str]:
    """For some contractions a line of text: how many orbits are chaotic, and how many points the attractors have."""
    import numpy as np

    parameter = str(found.chaotic.dims[0])
    values = found[parameter].values
    shown = [f"{parameter:<11}chaotic  nu_plus max  points"]
    for i in range(0, values.size, max(1, values.size // BIFURCATION_ROWS)):
        one = found.isel({parameter: i})
        places = np.stack([one.s.values.ravel(), one.phi.values.ravel()], axis=1)
        count = len(np.unique(np.round(places / DISTINCT), axis=0))
        shown.append(
            f"{values[i]:<11.6g}{int(one.chaotic.sum()):<9d}{float(one.nu_plus.max()):<13.4f}"
            + (f"{count}" if count <= MANY else "many")
        )
    return shown


TEXT_WIDTH = 100  # letters of the picture shown to people
RULED = 10  # letters from one contraction that is printed above the picture to the next
SWEEP_ROWS = 24  # contractions shown to people


class Kinds(click.Group):
    """A command group that lists the kinds of sweep if the given kind is unknown."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [*super().list_commands(ctx), "morse-graphs"]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:
        if cmd_name == "morse-graphs":
            from verification.app.commands.morse import graphs_command  # which imports this module

            return graphs_command
        if cmd_name not in self.commands:
            known = ", ".join([*self.commands, "morse-graphs"])
            raise click.UsageError(f"no sweep is called {cmd_name!r}; accepted: {known}")
        return self.commands[cmd_name]


@click.group(
    cls=Kinds,
    no_args_is_help=False,
    epilog="Example: pinball sweep parameter-space --alphas 0:0.1:21 --lams 0:1:41 --dry-run",
)
def command() -> None:
    """Parameter space, exponents, basins, bifurcation diagrams and Morse graphs.

    The results depend on the seed and on nothing else, to the last bit. If a sweep with a --store was stopped, the same
    command resumes it.
    """


@command.command(
    "parameter-space",
    epilog="Example: pinball sweep parameter-space --alphas 0:0.1:101 --lams 0:1:101 --store parameter-space.zarr",
)
@optional_options
@click.option("--alphas", metavar="LOW:HIGH:N", help="Shapes of the egg, equally spaced, with both ends.")
@lams_option
@click.option("--starts", type=Whole(1, 100_000), default=100, show_default=True, help="Random particles a pair.")
@click.option("--bounces", type=Whole(8, 10**9), default=2000, show_default=True, help="That count, each.")
@click.option("--transient", type=Whole(0, 10**9), default=2000, show_default=True, help="Bounces before.")
@seed_option
@plot_option("grids.parameter_space", "the largest exponent over both parameters")
@sweep_options
def parameter_space(
    scene: Scene | None,
    axis: str | None,
    bare: dict[str, Any],
    alphas: str | None,
    lams: str,
    starts: int,
    bounces: int,
    transient: int,
    seed: int,
    how: How,
) -> int:
    """For each pair of shape and contraction: does a chaotic orbit exist, in the egg or in a table with --shape?

    An orbit counts as chaotic if its exponent is above two standard errors, and above the values that shear alone can
    give.
    """
    import numpy as np

    from numeric.sweeps import space
    from numeric.sweeps.sweep import map_of, text_of

    if (axis is None) == (alphas is None) or (scene is None) != (axis is None):
        raise ValueError(
            "one shape parameter must vary; accepted: --alphas LOW:HIGH:N, or a table with --shape NAME=LOW:HIGH:N"
        )
    if bare["law"] is not None:
        raise ValueError(f"--law {bare['law']} is for a table, and none is given")
    contractions = np.array(span("--lams", lams))
    if scene is None or axis is None:
        K = bare["K"] or POINTS
        shapes = np.array(span("--alphas", str(alphas), high=Fraction(1, K * K + 1)))
        sweep = space.parameter_space(shapes, contractions, starts, bounces, transient, K, seed)
    else:
        scene, parameter, shapes = along(scene, axis)
        map_of(text := text_of(scene), contractions)
        count = starts, bounces, transient
        sweep = space.parameter_space(shapes, contractions, *count, seed=seed, scene=text, parameter=parameter)
    return carried_out(sweep, how, lambda found: picture(found.dataset()))


def picture(found: "xr.Dataset") -> list[str]:
    """The parameter space as lines of text: `#` if some orbit is chaotic, `.` if none is. Paper: section 6.5."""
    step = max(1, -(-found.lam.size // TEXT_WIDTH))
    shape, lams = str(found.chaotic.dims[0]), found.lam.values[::step]
    shown = [f"{shape} down, lam from {lams[0]:g} to {lams[-1]:g} across, printed above each |; # chaos, . none"]
    shown.append(f"{'lam':<11}" + " ".join(f"{lam:<{RULED - 1}.4g}" for lam in lams[::RULED]).rstrip())
    shown.append(f"{shape:<11}" + (f"{'|':<{RULED}}" * lams[::RULED].size).rstrip())
    for value, counts in zip(found[shape].values, found.chaotic.values[:, ::step], strict=True):
        shown.append(f"{value:<11.6g}" + "".join("#" if count else "." for count in counts))
    return shown


@command.command(
    "exponents", epilog="Example: pinball sweep exponents cuspless --lams 0:1:51 --orbits 100 --json exponents.json"
)
@varied_options
@lams_option
@click.option("--orbits", type=Whole(2, 10**6), default=100, show_default=True, help="Random particles for each.")
@click.option("--groups", type=Whole(1, 64), default=6, show_default=True, help="Attractors kept for each.")
@click.option("--bounces", type=Whole(64, 10**9), default=4096, show_default=True, help="That count, each.")
@click.option("--transient", type=Whole(0, 10**9), default=2000, show_default=True, help="Bounces before.")
@seed_option
@plot_option("grids.by_attractor", "the exponents with their errors")
@sweep_options
def exponents(
    scene: Scene,
    axis: str | None,
    lams: str,
    orbits: int,
    groups: int,
    bounces: int,
    transient: int,
    seed: int,
    how: How,
) -> int:
    """Both Lyapunov exponents against the contraction, with standard errors, for each attractor.

    With --shape NAME=LOW:HIGH:N a parameter of the table or of the law varies, and --lams is one number.
    """
    from numeric.sweeps import fields as kind

    text, parameter, values, lam = over(scene, lams, axis)
    sweep = kind.exponents(text, values, orbits, groups, bounces, transient, seed, parameter, lam)
    return carried_out(sweep, how, lambda found: table_of_groups(found.dataset()))


def table_of_groups(found: "xr.Dataset") -> list[str]:
    """For some contractions, the exponents as lines of text, one line for each attractor."""
    parameter = str(found.orbits.dims[0])
    values = found[parameter].values
    shown = [f"{parameter:<11}orbits  period  nu_plus               nu_minus"]
    for i in range(0, values.size, max(1, values.size // SWEEP_ROWS)):
        one = found.isel({parameter: i}).load()
        for j in range(found.group.size):
            group = one.isel(group=j)
            if int(group.orbits) > 0:
                shown.append(
                    f"{values[i]:<11.6g}{int(group.orbits):<8d}{int(group.period) or '-':<8}"
                    f"{float(group.nu_plus):<11.6f}+- {float(group.nu_plus_error):<8.1g}"
                    f"{float(group.nu_minus):<11.6f}+- {float(group.nu_minus_error):.1g}"
                )
    return shown


command.add_command(bifurcation_command, "bifurcation")
command.add_command(basins_command, "basins")
