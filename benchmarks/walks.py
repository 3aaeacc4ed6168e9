"""Lists the files of the package whose functions run for three questions: `python benchmarks/walks.py [--files]`.

Code that runs while a module is imported does not count. Each question is asked twice, each time in a new process:
first with empty caches, then with the filled ones. `--files` prints the files in the order in which they are entered.
"""

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import click

ROOT = Path(__file__).resolve().parents[1]
STOREYS = tuple(str(ROOT / name) for name in ("symbolic", "numeric", "verification"))
WALKS = {
    "a table typed on the command line, to its orbit": (
        "orbit --polar 1+cos(3*theta)/20 --lam 1/2 --start 0.3,0.2 --bounces 10"
    ),
    "locate lambda-star, to its digits": "locate lambda-star --digits 30",
    "one claim, to its page": "verify --only egg.monodromy --report {folder}",
}


def entered(command: str) -> tuple[list[str], int]:
    """The files whose functions run, in order, and the exit status of the command."""
    from verification.app import cli

    found: dict[str, None] = {}
    importing = status = 0

    def seen(frame, event, _):
        nonlocal importing
        if frame.f_code.co_name == "<module>":
            importing += {"call": 1, "return": -1}.get(event, 0)
        elif event == "call" and not importing and frame.f_code.co_filename.startswith(STOREYS):
            found.setdefault(str(Path(frame.f_code.co_filename).relative_to(ROOT)))

    with contextlib.redirect_stdout(io.StringIO()):
        sys.setprofile(seen)
        try:
            status = cli.main(command.split())
        finally:
            sys.setprofile(None)
    return list(found), status


def walked(command: str) -> tuple[list[str], list[str]]:
    """The files used with empty caches, and with filled ones."""
    with tempfile.TemporaryDirectory() as folder:
        call = [sys.executable, __file__, "--walk", command.format(folder=folder)]
        kept = os.environ | {"PINBALL_CACHE": folder}
        cold, warm = (
            json.loads(subprocess.run(call, cwd=ROOT, env=kept, capture_output=True, text=True, check=True).stdout)
            for _ in range(2)
        )
    return cold, warm


@click.command()
@click.option("--files", is_flag=True, help="Name the files.")
@click.option("--walk", "command", help="The files of one command, as JSON, with what is kept now.")
def main(files: bool, command: str | None) -> None:
    """Prints the files of three questions."""
    if command is not None:
        found, status = entered(command)
        click.echo(json.dumps(found))
        sys.exit(status)
    for name, words in WALKS.items():
        cold, warm = walked(words)
        click.echo(f"{name}: {len(cold)} files with nothing kept, {len(warm)} then")
        if files:
            more = [f"{each} (with nothing kept)" for each in cold if each not in warm]
            click.echo("  " + "\n  ".join([*warm, *more]))


if __name__ == "__main__":
    main()
