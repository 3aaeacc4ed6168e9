"""Attack: sessions of the live table that are opened and left are forgotten."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from attacks.outcome import Outcome

ROOT = Path(__file__).resolve().parents[2]
LIVE = """
import sys, threading, time
from verification.app import live
live.FORGOTTEN = 1000
from bokeh.server.server import Server
from bokeh.server.session import ServerSession
known, made = [], []
begin, start = ServerSession.__init__, Server.start
def begun(self, *arguments, **named):
    made.append(1)
    begin(self, *arguments, **named)
ServerSession.__init__ = begun
def started(self):
    known.append(self)
    return start(self)
Server.start = started
def tell():
    while True:
        time.sleep(0.2)
        print(len(made), len(known[0].get_sessions()) if known else -1, flush=True)
threading.Thread(target=tell, daemon=True).start()
live.serve(int(sys.argv[1]), False)
"""


@contextmanager
def live_server() -> Iterator[tuple[int, "subprocess.Popen[str]"]]:
    """The live table in a process that reports its numbers of sessions."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "BOKEH_ALLOW_WS_ORIGIN": "*", "BOKEH_ADDRESS": "0.0.0.0"}
    process = subprocess.Popen(
        [sys.executable, "-c", LIVE, str(port)], env=environment, cwd=ROOT, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    try:
        for _ in range(600):
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                time.sleep(0.2)
        yield port, process
    finally:
        process.kill()
        process.communicate()


def answer(port: int, request: str, seconds: float = 600) -> str:
    """The first line that the server answers to a request."""
    with socket.create_connection(("127.0.0.1", port), timeout=seconds) as link:
        link.sendall(request.replace("\n", "\r\n").encode())
        return link.recv(4096).decode(errors="replace").partition("\r\n")[0]


def left(served: "tuple[int, subprocess.Popen[str]]", count: int, seconds: float = 1200) -> tuple[int, int, int]:
    """The number of answered visitors of `count`, and of sessions opened and remaining when all have left."""
    port, process = served
    answered = sum(" 200 " in answer(port, f"GET / HTTP/1.1\nHost: 127.0.0.1:{port}\n\n") for _ in range(count))
    assert process.stdout is not None
    made, here, ended = 0, -1, time.monotonic() + seconds
    while (made < count or here) and time.monotonic() < ended:
        made, here = map(int, process.stdout.readline().split())
    return answered, made, here


def visitors(count: int) -> Outcome:
    """Pages of the live table that are opened and left: each is answered, and none is remembered."""
    with live_server() as served:
        answered, made, here = left(served, count)
    return Outcome(count, count - answered + abs(made - count) + here, f"{made} sessions, {here} are left")
