"""What every command says: text for people, JSON for programs, a bar for the patient."""

import json
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Any

import click

from verification.arithmetic.progress import heard

if TYPE_CHECKING:
    from rich.console import Console

PATIENCE = 2.0  # seconds before a progress bar appears


@dataclass(frozen=True)
class Output:
    """Where a command writes: `console` for people, and the JSON file that `--json` names, if any."""

    path: str | None = None

    @cached_property
    def console(self) -> "Console":
        """Standard output, or standard error when the JSON document has standard output to itself."""
        from rich.console import Console

        return Console(stderr=self.path == "-", highlight=False, markup=False, soft_wrap=True)

    def write(self, document: Mapping[str, Any]) -> None:
        """Writes the JSON document where `--json` said; nowhere when it was not given."""
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
    def progress(self, about: str, total: int) -> Iterator[Callable[[str], None]]:
        """A verb to call with a word on each step done; a bar shows on a terminal after two seconds.

        What a long proof tells of itself within a step (`verification.arithmetic.progress`) moves the bar as well.
        """
        from rich.console import Console
        from rich.progress import Progress

        console = Console(stderr=True)
        if not console.is_terminal:
            yield lambda step: None
            return
        bar = Progress(console=console, transient=True)
        task = bar.add_task(about, total=total)
        timer = Timer(PATIENCE, bar.start)
        timer.start()
        done = 0

        def step(word: str) -> None:
            nonlocal done
            done += 1
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


def write_whole(path: Path, text: str) -> None:
    """Writes a file at once: a reader finds the old text or the new, and never half of either."""
    if path.exists() and not path.is_file():  # a pipe or a device
        path.write_text(text, encoding="utf-8")
        return
    path = path.resolve()
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _writable(context: click.Context, option: click.Parameter, value: str | None) -> Output:
    """Refuses an unwritable file before any work is done for it."""
    if value is None or value == "-":
        return Output(value)
    path = Path(value)
    if path.is_dir():
        raise click.BadParameter(f"{value!r} is a directory; accepted: a file, or - for standard output")
    if not path.parent.is_dir():
        raise click.BadParameter(f"{value!r}: there is no directory {str(path.parent)!r}; create it first")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise click.BadParameter(f"{value!r} may not be written; accepted: a file in a directory of yours")
    return Output(value)


json_option = click.option(
    "--json",
    "output",
    metavar="FILE",
    callback=_writable,
    help="Write the result as JSON; - is standard output, and then nothing else is printed there.",
)
