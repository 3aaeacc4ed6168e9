"""`pinball explore`: a table to play with, on a local page."""

import socket

import click

from verification.cli import DONE
from verification.commands.output import Output, json_option

LOOPBACK = "127.0.0.1"


@click.command(epilog="Example: pinball explore --port 5006")
@click.option("--port", type=click.IntRange(0, 65535), default=0, show_default=True, help="0 for any that is free.")
@click.option("--open/--no-open", "show", default=True, show_default=True, help="Open a browser.")
@json_option
def command(port: int, show: bool, output: Output) -> int:
    """A live table on a page of this machine: drag the ball, move the contraction, find cycles.

    The page is served on 127.0.0.1 only, until Ctrl-C. It needs pip install 'pinball-billiards[explore]'.
    """
    from verification.explore.app import serve

    port = _free(port)
    output.write({"address": f"http://{LOOPBACK}:{port}/"})
    output.console.print(f"The table is at http://{LOOPBACK}:{port}/ until Ctrl-C.")
    serve(port, show)
    return DONE


def _free(port: int) -> int:
    """`port`, or any free one for 0; `ValueError` when it is taken."""
    with socket.socket() as probe:
        try:
            probe.bind((LOOPBACK, port))
        except OSError as error:
            raise ValueError(f"--port {port} cannot be used ({error.strerror}); accepted: a free one, or 0") from None
        return int(probe.getsockname()[1])
