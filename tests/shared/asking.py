"""Helpers, imported as `asking`: what `pinball` answers, and how it refuses."""

import json

from verification.app import cli


def answer(capsys, *arguments):
    """The exit status, the JSON document if there is one, and what is told besides."""
    status = cli.main([*arguments, "--json", "-"])
    printed = capsys.readouterr()
    return status, json.loads(printed.out) if printed.out else None, printed.err


def refusal(capsys, *arguments: str) -> str:
    """The one sentence with which `pinball` refuses these arguments."""
    assert cli.main(arguments) == cli.BAD_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("pinball: ")
    assert printed.err.count("\n") == 1
    return printed.err[len("pinball: ") : -1]
