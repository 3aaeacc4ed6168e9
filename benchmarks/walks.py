"""Which files of the package three questions pass through: `python benchmarks/walks.py`.

A file counts when one of its functions runs; what runs while a module is imported does not.
"""

import contextlib
import io
import sys
import tempfile
from pathlib import Path

import click

from verification.app import cli

ROOT = Path(__file__).resolve().parents[1]
STOREYS = tuple(str(ROOT / name) for name in ("symbolic", "numeric", "verification"))
WALKS = {
    "a table typed on the command line, to its orbit": (
        "orbit --polar 1+cos(3*theta)/20 --lam 1/2 --start 0.3,0.2 --bounces 10"
    ),
    "locate lambda-star, to its digits": "locate lambda-star --digits 30",
    "one claim, to its page": "verify --only egg.monodromy --report {folder}",
}


def walked(command: str) -> list[str]:
    """The files whose functions run, in the order in which they are entered."""
    found: dict[str, None] = {}
    importing = 0

    def seen(frame, event, _):
        nonlocal importing
        if frame.f_code.co_name == "<module>":
            importing += {"call": 1, "return": -1}.get(event, 0)
        elif event == "call" and not importing and frame.f_code.co_filename.startswith(STOREYS):
            found.setdefault(str(Path(frame.f_code.co_filename).relative_to(ROOT)))

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        sys.setprofile(seen)
        try:
            with contextlib.suppress(SystemExit):
                cli.main(command.format(folder=folder).split())
        finally:
            sys.setprofile(None)
    return list(found)


if __name__ == "__main__":
    for name, command in WALKS.items():
        files = walked(command)
        click.echo(f"{name}: {len(files)} files\n  " + "\n  ".join(files))
