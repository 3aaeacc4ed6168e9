"""`pinball`: the command line, with the output and the errors that all commands share.

A command is imported when it is called, so `pinball --help` loads no mathematics. Output is text with a progress bar
for people, or JSON for programs. An error is one sentence on standard error; `PINBALL_DEBUG=1` adds the traceback.
"""

import gc
import json
import logging
import os
import shutil
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property, wraps
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Any

import click

from numeric.lowering.files import json_text, write_whole
from symbolic.tables.definition import like
from verification.app.lines import console, on_terminal
from verification.arithmetic.iteration import heard

if TYPE_CHECKING:
    import xarray as xr
    from rich.console import Console

LARGEST = 1 << 26  # bytes of a sweep's results that are written as JSON
RARELY = 50_000, 20, 20  # objects between garbage collections: SymPy makes many, and hardly any is unused
NARROWEST, WIDEST = 20, 10_000  # letters of a line
DIGITS = 30  # of a whole number that is typed
PATIENCE = 2.0  # seconds before a progress bar appears


def columns() -> int:
    """The width of the terminal, or COLUMNS if it is set, clipped to a fixed range."""
    return min(max(shutil.get_terminal_size().columns, NARROWEST), WIDEST)


@dataclass(frozen=True)
class Output:
    """The outputs of a command: `console` for people, the file of `--json`, and the picture of `--plot`.

    `kind` is the module and function of `verification.plots` that draws the results.
    """

    path: str | None = None
    plot: Path | None = None
    kind: str = ""

    @cached_property
    def console(self) -> "Console":
        """The console for people: standard output; it prints nothing if `--json -` writes there."""
        from rich.console import Console

        quiet, width = self.path == "-", columns()
        people = Console(quiet=quiet, highlight=False, markup=False, soft_wrap=True, width=width)
        return console(width) if people.is_terminal and not quiet else people

    @property
    def wanted(self) -> bool:
        """True if a JSON document or a picture was asked for."""
        return self.path is not None or self.plot is not None

    def write(self, document: Mapping[str, Any], *results: Any) -> None:
        """Writes the JSON document to the file of --json, and the picture of `results` to that of --plot."""
        self._write(document)
        if self.plot is None or not results:
            return
        from verification.plots.results import drawn

        try:
            write_whole(self.plot, drawn(self.kind, results, self.plot.suffix.lower()))
        except OSError as error:
            raise ValueError(f"--plot {self.plot} cannot be written ({error.strerror or error})") from None

    def _write(self, document: Mapping[str, Any]) -> None:
        if self.path is None:
            return
        text = json_text(document, indent=2) + "\n"
        if self.path == "-":
            sys.stdout.write(text)
            return
        try:
            write_whole(Path(self.path), text)
        except OSError as error:
            said = f"--json {self.path} cannot be written ({error.strerror or error})"
            try:
                rescue = Path(tempfile.mkdtemp(prefix="pinball-")) / "result.json"
                write_whole(rescue, text)
            except OSError:
                raise ValueError(said) from None
            raise ValueError(f"{said}; the result is in {rescue}") from None

    @contextmanager
    def progress(self, about: str, total: float) -> Iterator[Callable[..., None]]:
        """Context with a function `step(word, size=1)` to call after each step; a terminal shows a bar after 2 seconds.

        Progress that a long proof reports within a step (`verification.arithmetic.iteration`) moves the bar as well.
        """
        from rich.console import Console
        from rich.progress import Progress

        console = Console(stderr=True, width=columns())
        if not console.is_terminal:
            yield lambda step, size=1: None
            return
        bar = Progress(console=console, transient=True)
        task = bar.add_task(about, total=total)
        timer = Timer(PATIENCE, bar.start)
        timer.start()
        done = 0.0

        def step(word: str, size: float = 1) -> None:
            nonlocal done
            done += size
            bar.update(task, completed=done, description=f"{about} {word}")

        def within(what: str, share: float) -> None:
            bar.update(task, completed=done + share, description=f"{about}: {what}, {share:.0%}")

        try:
            with heard(within):
                yield step
        finally:
            timer.cancel()
            timer.join()
            bar.stop()


def _writable(context: click.Context, option: click.Parameter, value: str | None) -> Output:
    """The output for --json FILE; a file that cannot be written is refused before any work."""
    if value is not None and value != "-":
        _refuse(value, "a file, or - for standard output")
    return Output(value)


def reason(error: Exception) -> object:
    """Why a file cannot be read or written, in the system's words where it has some."""
    return getattr(error, "strerror", None) or error


def _refuse(value: str, accepted: str) -> Path:
    """The path, if a file can be written there; otherwise raises click's error."""
    path = Path(value)
    try:
        path.exists()
    except (OSError, ValueError) as error:
        raise click.BadParameter(f"{value!r} cannot be written ({reason(error)}); accepted: {accepted}") from None
    if path.is_dir():
        raise click.BadParameter(f"{value!r} is a directory; accepted: {accepted}")
    if not path.parent.is_dir():
        raise click.BadParameter(f"{value!r}: there is no directory {str(path.parent)!r}; create it first")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise click.BadParameter(f"{value!r} may not be written; accepted: a file in a directory of yours")
    return path


def _drawable(context: click.Context, option: click.Parameter, value: str | None) -> Path | None:
    """The path of the picture; a file that cannot be drawn or written is refused before any work."""
    if value is None:
        return None
    from verification.plots.sheet import FORMATS

    known = ", ".join(FORMATS)
    if Path(value).suffix.lower() not in FORMATS:
        raise click.BadParameter(f"{value!r} has no known ending; accepted: {known}")
    if find_spec("matplotlib") is None:
        raise ModuleNotFoundError(name="matplotlib")
    return _refuse(value, f"a file that ends in {known}")


class Whole(click.IntRange):
    """A whole number in a range; text with more than `DIGITS` digits is refused unread, as reading it takes long.

    >>> Whole(1, 9).convert(" 7 ", None, None)
    7
    """

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number; raises click's error, which says what is accepted, for anything else."""
        if isinstance(value, str) and len(value) > DIGITS:
            self.fail(f"{value[:DIGITS]!r}... has {len(value)} digits", param, ctx)
        return super().convert(value, param, ctx)


json_option = click.option(
    "--json",
    "output",
    metavar="FILE",
    callback=_writable,
    help="Write the result as JSON; - is standard output, and then no text for people is printed.",
)


def plot_option(kind: str, about: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorator that adds the option `--plot FILE` to a command; the function `kind` draws the command's results."""

    def given(command: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(command)
        def called(plot: Path | None, output: Output, **others: Any) -> Any:
            return command(output=replace(output, plot=plot, kind=kind), **others)

        about_it = f"Draw {about}, in a file that ends in .png, .svg, .pdf or .webp."
        return click.option("--plot", metavar="FILE", callback=_drawable, help=about_it)(called)

    return given


GROUPS = {
    "Orbits": {
        "orbit": "Where does this particle go?",
        "cycles": "Which cycles are there, up to a period?",
        "lyapunov": "The two exponents, with error bars.",
        "slap": "The slap map: what remains at lambda = 0.",
        "explore": "A live table on a page of this machine.",
    },
    "Attractors": {
        "attractor": "Where do particles end, and in how many ways?",
        "basins": "Which attractor does each start reach?",
        "report": "What becomes of this table? One page for all questions.",
    },
    "Bifurcations": {
        "bifurcation": "The attractors against the contraction.",
        "follow": "What becomes of this cycle as lambda changes?",
        "locate": "Where does it happen, to N certified digits?",
        "sweep": "Grids of tasks, on all cores or a Dask cluster.",
    },
    "Proofs": {
        "morse": "Which attractors and repellers are proved, and in what order?",
        "check": "Does a certificate still hold, without the search?",
    },
    "The paper": {
        "verify": "Is each claim of the paper true?",
        "claims": "What the paper claims, or a folder for another paper's claims.",
        "figure": "One of the paper's figures, or the data behind it.",
    },
    "Tools": {
        "work": "Error against run time for a whole question, as a diagram.",
        "bench": "Error against run time, for every arithmetic and every kernel.",
        "cache": "Where compiled kernels are kept, and how to remove them.",
    },
}
COMMANDS = {name: about for group in GROUPS.values() for name, about in group.items()}
HOMES = {  # commands that share a module
    "attractor": ("lyapunov", "attractor_command"),
    "work": ("bench", "work_command"),
    "cache": ("bench", "cache_command"),
    "figure": ("verify", "figure_command"),
    "cycles": ("orbit", "cycles_command"),
    "check": ("locate", "check_command"),
    "slap": ("orbit", "slap_command"),
    "basins": ("sweep", "basins_command"),
    "bifurcation": ("sweep", "bifurcation_command"),
    "explore": ("verify", "explore_command"),
    "claims": ("verify", "claims_command"),
}
DONE, FAILED, BAD_INPUT, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 130, 141
EXTRAS = {"matplotlib": "plot", "panel": "explore", "bokeh": "explore", "svgelements": "outline", "ezdxf": "outline"}
EXTRAS |= {"pyarrow": "table", "hypothesis": "hypothesis"}
EXTRAS |= dict.fromkeys(("xarray", "zarr", "dask", "distributed", "filelock"), "sweep")
COMPLETE = "_PINBALL_COMPLETE"  # the variable of the environment by which a shell asks for completions
LONGEST = 600  # characters of an error; of a longer one the middle is left out


class Questions(click.Group):
    """A command group that knows its commands' names and short helps, and imports a command only when it is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            accepted = ", ".join(COMMANDS) + like(cmd_name, COMMANDS)
            raise click.UsageError(f"no command is called {cmd_name!r}; accepted: {accepted}")
        home, attribute = HOMES.get(cmd_name, (cmd_name, "command"))
        command: click.Command = getattr(import_module(f"verification.app.commands.{home}"), attribute)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None and not ctx.resilient_parsing:
            refuse_repeated(command, rest)
        return name, command, rest

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        wide = max(map(len, COMMANDS))  # the same column in all groups
        for title, commands in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(name.ljust(wide), about) for name, about in commands.items()])


def refuse_repeated(command: click.Command, words: Sequence[str]) -> None:
    """Raises click's error if an option that takes one value is given twice; click would keep the last."""
    context, given = click.Context(command), list[click.Parameter]()
    with suppress(click.UsageError):  # what else is wrong is said when the command reads its words
        given = context.command.make_parser(context).parse_args([*words])[2]
    for option in given:
        once = isinstance(option, click.Option) and not (option.multiple or option.is_flag or option.count)
        if once and given.count(option) > 1:
            raise click.UsageError(f"{option.opts[0]} is given {given.count(option)} times; accepted: once")


@click.group(
    cls=Questions,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: pinball verify --only 'ellipse.*'",
)
@click.version_option(package_name="pinball-billiards")
@click.pass_context
def pinball(context: click.Context) -> None:
    """Pinball billiards: what the paper says, derived, computed and judged."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs `pinball` and returns its exit status: 0 done, 1 something is open or failed, 2 bad input."""
    gc.set_threshold(*RARELY)
    if sys.stdout is None or sys.stderr is None:
        return _no_streams()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # of NumPy, on numbers that are then not finite
            warnings.showwarning = _print_warning
            status = run(sys.argv[1:] if arguments is None else arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        _discard_output()
        return BROKEN_PIPE
    except (KeyboardInterrupt, click.Abort) as stop:
        logging.getLogger("asyncio").setLevel(logging.CRITICAL)  # no messages about unfinished reads and writes
        return _print_error(str(stop) or "interrupted", INTERRUPTED)
    except click.ClickException as error:
        return _print_error(sentence(error), BAD_INPUT)
    except ValueError as error:
        return _print_error(str(error), BAD_INPUT)
    except ModuleNotFoundError as error:
        return _print_error(missing(error), BAD_INPUT)
    except OSError as error:
        if error.filename is None:
            _discard_output()
        where = "standard output cannot be written" if error.filename is None else f"{error.filename} cannot be used"
        return _print_error(f"{where}: {error.strerror or error}", FAILED)
    except RecursionError:
        return _print_error(
            "a formula or a file is nested too deeply; accepted: at most some hundred levels", BAD_INPUT
        )
    except MemoryError:
        return _print_error("there is too little memory for this; accepted: fewer points, digits or cells", FAILED)
    except Exception as error:
        return _print_error(f"an unexpected {type(error).__name__}: {error}; PINBALL_DEBUG=1 shows where", FAILED)
    return status


def _no_streams() -> int:
    """Prints that standard output is closed, unless standard error is closed too; returns the status of bad input."""
    if sys.stderr is not None:
        sys.stderr.write("pinball: standard output is closed; accepted: an open one, or > FILE\n")
    return BAD_INPUT


def _discard_output() -> None:
    """Discards the output that is still buffered, since flushing it at exit would fail."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _print_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Prints a warning as one sentence."""
    click.echo(on_terminal(f"pinball: {message}", sys.stderr, columns()), err=True)


def run(arguments: Sequence[str]) -> int:
    """Runs one command line and returns its exit status; errors are raised."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    if asked := os.environ.get(COMPLETE):  # by a shell, for its script or for what may follow
        from click.shell_completion import shell_complete

        return shell_complete(pinball, {}, "pinball", COMPLETE, asked)
    try:
        with pinball.make_context("pinball", list(arguments)) as context:
            return int(pinball.invoke(context) or DONE)
    except click.exceptions.Exit as done:
        return done.exit_code


def missing(error: ModuleNotFoundError) -> str:
    """A sentence that names the missing package and the command that installs it.

    >>> missing(ModuleNotFoundError(name="zarr.storage"))
    "zarr is missing; install it with: pip install '.[sweep]' in a checkout"
    """
    package = (error.name or str(error)).partition(".")[0]
    extra = f"[{EXTRAS[package]}]" if package in EXTRAS else ""
    return f"{package} is missing; install it with: pip install '.{extra}' in a checkout"


def sentence(error: click.ClickException) -> str:
    """A sentence that says what is wrong and what would be accepted, which click leaves out.

    >>> digits = click.Option(["--digits"], type=click.IntRange(1, 9))
    >>> sentence(click.BadParameter("'x' is not a valid integer range.", param=digits))
    "Invalid value for '--digits': 'x' is not a valid integer range; accepted: integers from 1 to 9"
    """
    message = error.format_message().strip().removesuffix(".")
    context = getattr(error, "ctx", None)
    if isinstance(error, click.NoSuchOption) and context is not None:
        known = [each for each in context.command.get_params(context) if not getattr(each, "hidden", False)]
        options = {name for each in known for name in each.opts if name[0] == "-"}
        names = sorted(options)
        return f"no option is called {error.option_name}; accepted: {', '.join(names)}{like(error.option_name, names)}"
    kind = getattr(getattr(error, "param", None), "type", None)
    if isinstance(kind, click.Choice) and " is not one of " in message:
        return message + like(message.partition(" is not one of ")[0].rpartition(": ")[2].strip("'"), kind.choices)
    if isinstance(kind, click.IntRange):
        return f"{message}; accepted: integers from {kind.min}" + ("" if kind.max is None else f" to {kind.max}")
    if type(error) is click.UsageError and context is not None and context.parent is not None:
        return f"{message}; {context.command_path} --help shows what is accepted"
    return message


def _print_error(message: str, status: int) -> int:
    """Prints `message` as one sentence and returns `status`."""
    message = " ".join(message.split())
    message = message if len(message) <= LONGEST else message[: LONGEST - 200] + " ... " + message[-195:]
    if os.environ.get("PINBALL_DEBUG") == "1":
        traceback.print_exc()
    click.echo(on_terminal(f"pinball: {message}", sys.stderr, columns()), err=True)
    return status


def document(found: "xr.Dataset", store: Path | None) -> dict[str, Any]:
    """The results of a sweep as JSON: coordinates, fields with units, and their values unless they are in a store."""
    fields: dict[str, Any] = {}
    for name, values in found.data_vars.items():
        units, about = values.attrs["units"], values.attrs["long_name"]
        fields[str(name)] = {"dims": list(values.dims), "units": units, "about": about}
        if store is None and found.nbytes <= LARGEST:
            fields[str(name)]["values"] = values.values.tolist()
    coords: Mapping[str, Any] = {str(name): values.values.tolist() for name, values in found.coords.items()}
    labels = {str(key): _read(value) for key, value in found.attrs.items()}
    return {**labels, "coords": coords, "fields": fields} | ({} if store is None else {"store": str(store)})


def _read(value: Any) -> Any:
    """The value of an attribute; a text that holds a JSON object is parsed."""
    return json.loads(value) if isinstance(value, str) and value.startswith("{") else value


async def refusal(words: Sequence[str], seconds: float) -> str | None:
    """Runs a command in another process; returns the error that it prints, or None if it succeeds.

    The process is ended after `seconds`. What it reads, proves and compiles is kept in the cache on disk.
    """
    import asyncio

    from numeric.sweeps.workers import own_command

    command, environment = own_command("verification", *words)
    process = await asyncio.create_subprocess_exec(
        *command, env=environment, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE
    )
    try:
        _, said = await asyncio.wait_for(process.communicate(), seconds)
    except TimeoutError:
        return f"this takes more than {seconds:g} seconds to read, prove and compile"
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    return None if process.returncode == 0 else said.decode(errors="replace").strip().removeprefix("pinball: ")
