"""`pinball`: one command for each question, and what every command says.

A command is imported when it is called, so `pinball --help` loads no mathematics. People read text and a bar,
programs read JSON. Whatever goes wrong is one sentence on standard error; `PINBALL_DEBUG=1` adds the traceback.
"""

import gc
import json
import os
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, wraps
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Any

import click

from symbolic.tables.definition import like
from verification.app.lines import console, on_terminal
from verification.arithmetic.iteration import heard

if TYPE_CHECKING:
    import xarray as xr
    from rich.console import Console

LARGEST = 1 << 26  # bytes of a sweep's results that are written as JSON
RARELY = 50_000, 20, 20  # objects between searches for unused cycles: SymPy makes many, and hardly any is unused
PATIENCE = 2.0  # seconds before a progress bar appears


@dataclass(frozen=True)
class Output:
    """Where a command writes: `console` for people, the file that `--json` names, and the picture of `--plot`.

    `kind` says which module and function of `verification.plots` draws the results.
    """

    path: str | None = None
    plot: Path | None = None
    kind: str = ""

    @cached_property
    def console(self) -> "Console":
        """Standard output, or standard error when the JSON document has standard output to itself."""
        from rich.console import Console

        people = Console(stderr=self.path == "-", highlight=False, markup=False, soft_wrap=True)
        return console(people.stderr) if people.is_terminal else people

    def write(self, document: Mapping[str, Any], *results: Any) -> None:
        """Writes the JSON document where `--json` said, and where `--plot` said the picture of the same results."""
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
        text = json.dumps(document, indent=2, allow_nan=False) + "\n"
        if self.path == "-":
            sys.stdout.write(text)
            return
        try:
            write_whole(Path(self.path), text)
        except OSError as error:
            with tempfile.NamedTemporaryFile("w", suffix=".json", delete=False) as rescue:
                rescue.write(text)
            reason = error.strerror or error
            raise ValueError(
                f"--json {self.path} cannot be written ({reason}); the result is in {rescue.name}"
            ) from None

    @contextmanager
    def progress(self, about: str, total: float) -> Iterator[Callable[..., None]]:
        """A verb to call with a word on each step done, and its size where that is not 1.

        A bar shows on a terminal after two seconds.

        What a long proof tells of itself within a step (`verification.arithmetic.iteration`) moves the bar as well.
        """
        from rich.console import Console
        from rich.progress import Progress

        console = Console(stderr=True)
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


def write_whole(path: Path, content: str | bytes) -> None:
    """Writes a file at once: a reader finds the old content or the new, and never half of either."""
    content = content.encode() if isinstance(content, str) else content
    if path.exists() and not path.is_file():  # a pipe or a device
        path.write_bytes(content)
        return
    path = path.resolve()
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(content)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _writable(context: click.Context, option: click.Parameter, value: str | None) -> Output:
    """Refuses an unwritable file before any work is done for it."""
    if value is not None and value != "-":
        _refuse(value, "a file, or - for standard output")
    return Output(value)


def _refuse(value: str, accepted: str) -> Path:
    """The file as a path, when it may be written."""
    path = Path(value)
    if path.is_dir():
        raise click.BadParameter(f"{value!r} is a directory; accepted: {accepted}")
    if not path.parent.is_dir():
        raise click.BadParameter(f"{value!r}: there is no directory {str(path.parent)!r}; create it first")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise click.BadParameter(f"{value!r} may not be written; accepted: a file in a directory of yours")
    return path


def _drawable(context: click.Context, option: click.Parameter, value: str | None) -> Path | None:
    """Refuses, before any work is done for it, a picture of an unknown kind, or one that cannot be drawn or written."""
    if value is None:
        return None
    from verification.plots.sheet import FORMATS

    known = ", ".join(FORMATS)
    if Path(value).suffix.lower() not in FORMATS:
        raise click.BadParameter(f"{value!r} has no known ending; accepted: {known}")
    if find_spec("matplotlib") is None:
        raise ModuleNotFoundError(name="matplotlib")
    return _refuse(value, f"a file that ends in {known}")


json_option = click.option(
    "--json",
    "output",
    metavar="FILE",
    callback=_writable,
    help="Write the result as JSON; - is standard output, and then nothing else is printed there.",
)


def plot_option(kind: str, about: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Gives a command `--plot FILE`: what it hands to `Output.write` beside the document is drawn as `kind` says."""

    def given(command: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(command)
        def called(plot: Path | None, output: Output, **others: Any) -> Any:
            return command(output=replace(output, plot=plot, kind=kind), **others)

        about_it = f"Draw {about}, in a file that ends in .png, .svg, .pdf or .webp."
        return click.option("--plot", metavar="FILE", callback=_drawable, help=about_it)(called)

    return given


COMMANDS = {
    "verify": "Is each claim of the paper true?",
    "claims": "A folder for another paper: its sentences, and who judges them.",
    "report": "What becomes of this table? One page for all questions.",
    "locate": "Where does it happen, to N certified digits?",
    "check": "Does a certificate still hold, without the search?",
    "orbit": "Where does this particle go?",
    "cycles": "Which cycles are there, up to a period?",
    "follow": "What becomes of this cycle as lambda changes?",
    "lyapunov": "The two exponents, with error bars.",
    "attractor": "Where do particles end, and in how many ways?",
    "slap": "The slap map: what remains at lambda = 0.",
    "basins": "Which attractor does each start reach?",
    "bifurcation": "The attractors against the contraction.",
    "morse": "Which attractors and repellers are proved, and in what order?",
    "sweep": "Grids of tasks, on all cores or a Dask cluster.",
    "figure": "One of the paper's figures, or the data behind it.",
    "explore": "A live table on a page of this machine.",
    "bench": "Error against run time, for every arithmetic and every kernel.",
    "work": "Error against run time for a whole question, as a diagram.",
    "cache": "Where compiled kernels are kept, and how to remove them.",
}
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
COMPLETE = "_PINBALL_COMPLETE"  # the variable of the environment by which a shell asks
LONGEST = 600  # characters of a sentence; a reader sees the end of it


class Questions(click.Group):
    """A group that knows the names and one-line helps of its commands without importing them."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            accepted = ", ".join(COMMANDS) + like(cmd_name, COMMANDS)
            raise click.UsageError(f"no command is called {cmd_name!r}; accepted: {accepted}")
        home, attribute = HOMES.get(cmd_name, (cmd_name, "command"))
        command: click.Command = getattr(import_module(f"verification.app.commands.{home}"), attribute)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


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
    """The exit status of `pinball`: 0 done, 1 something is open or failed, 2 bad input."""
    gc.set_threshold(*RARELY)
    try:
        status = run(sys.argv[1:] if arguments is None else arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or the last flush complains
        return BROKEN_PIPE
    except (KeyboardInterrupt, click.Abort) as stop:
        return _told(str(stop) or "interrupted", INTERRUPTED)
    except click.ClickException as error:
        return _told(sentence(error), BAD_INPUT)
    except ValueError as error:
        return _told(str(error), BAD_INPUT)
    except ModuleNotFoundError as error:
        return _told(missing(error), BAD_INPUT)
    except Exception as error:
        return _told(f"an unexpected {type(error).__name__}: {error}; PINBALL_DEBUG=1 shows where", FAILED)
    return status


def run(arguments: Sequence[str]) -> int:
    """Runs one command line; errors are left to `main`."""
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
    """Which package is not there, and the command that brings it.

    >>> missing(ModuleNotFoundError(name="zarr.storage"))
    "zarr is missing; install it with: pip install 'pinball-billiards[sweep]'"
    """
    package = (error.name or str(error)).partition(".")[0]
    extra = f"[{EXTRAS[package]}]" if package in EXTRAS else ""
    return f"{package} is missing; install it with: pip install 'pinball-billiards{extra}'"


def sentence(error: click.ClickException) -> str:
    """What is wrong and what would be accepted; click leaves out the second half.

    >>> digits = click.Option(["--digits"], type=click.IntRange(1, 9))
    >>> sentence(click.BadParameter("'x' is not a valid integer range.", param=digits))
    "Invalid value for '--digits': 'x' is not a valid integer range; accepted: integers from 1 to 9"
    """
    message = error.format_message().strip().removesuffix(".")
    context = getattr(error, "ctx", None)
    if isinstance(error, click.NoSuchOption) and context is not None:
        options = {name for each in context.command.get_params(context) for name in each.opts if name[0] == "-"}
        known = sorted(options)
        return f"no option is called {error.option_name}; accepted: {', '.join(known)}{like(error.option_name, known)}"
    kind = getattr(getattr(error, "param", None), "type", None)
    if isinstance(kind, click.Choice) and " is not one of " in message:
        return message + like(message.partition(" is not one of ")[0].rpartition(": ")[2].strip("'"), kind.choices)
    if isinstance(kind, click.IntRange):
        return f"{message}; accepted: integers from {kind.min}" + ("" if kind.max is None else f" to {kind.max}")
    if type(error) is click.UsageError and context is not None and context.parent is not None:
        return f"{message}; {context.command_path} --help shows what is accepted"
    return message


def _told(message: str, status: int) -> int:
    """Prints `message` as one sentence, and gives `status` back."""
    message = " ".join(message.split())
    message = message if len(message) <= LONGEST else message[: LONGEST - 200] + " ... " + message[-195:]
    if os.environ.get("PINBALL_DEBUG") == "1":
        traceback.print_exc()
    click.echo(on_terminal(f"pinball: {message}", sys.stderr), err=True)
    return status


def finite(values: Any) -> Any:
    """Nested lists in which null stands for what is no finite number.

    >>> finite([1.0, [float("nan"), float("-inf")]])
    [1.0, [None, None]]
    """
    if isinstance(values, list):
        return [finite(value) for value in values]
    return values if abs(values) < float("inf") else None


def document(found: "xr.Dataset", store: Path | None) -> dict[str, Any]:
    """The JSON document: coordinates, fields with units, and their values unless they are in a store."""
    fields: dict[str, Any] = {}
    for name, values in found.data_vars.items():
        units, about = values.attrs["units"], values.attrs["long_name"]
        fields[str(name)] = {"dims": list(values.dims), "units": units, "about": about}
        if store is None and found.nbytes <= LARGEST:
            fields[str(name)]["values"] = finite(values.values.tolist())
    coords: Mapping[str, Any] = {str(name): values.values.tolist() for name, values in found.coords.items()}
    labels = {str(key): _read(value) for key, value in found.attrs.items()}
    return {**labels, "coords": coords, "fields": fields} | ({} if store is None else {"store": str(store)})


def _read(value: Any) -> Any:
    """What an attribute says; those that hold JSON are read."""
    return json.loads(value) if isinstance(value, str) and value.startswith("{") else value


async def refusal(words: Sequence[str], seconds: float) -> str | None:
    """Runs a command in a process of its own, and gives the sentence with which it fails; None when all is well.

    It is ended after so many seconds. What it reads, proves and compiles is kept on disk for whoever asks next.
    """
    import asyncio

    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "verification", *words, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE
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
