"""The live table answers this machine only, whatever is asked of it, and forgets those who left."""

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SERVER = """
import sys
from verification.app import live
live.FORGOTTEN = 1000
import threading, time
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


def answer(port, request, seconds=600):
    """The first line that the server answers to a request."""
    with socket.create_connection(("127.0.0.1", port), timeout=seconds) as link:
        link.sendall(request.replace("\n", "\r\n").encode())
        return link.recv(4096).decode(errors="replace").partition("\r\n")[0]


def websocket(port, origin):
    """What a page of some origin is told when it asks for the live connection."""
    return answer(
        port,
        f"GET /ws HTTP/1.1\nHost: 127.0.0.1:{port}\nUpgrade: websocket\nConnection: Upgrade\nOrigin: {origin}\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\nSec-WebSocket-Version: 13\n\n",
    )


@pytest.fixture(scope="module")
def served():
    """A server in a process of its own, started in an environment that would open it to others."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "BOKEH_ALLOW_WS_ORIGIN": "*", "BOKEH_ADDRESS": "0.0.0.0"}
    process = subprocess.Popen(
        [sys.executable, "-c", SERVER, str(port)], env=environment, cwd=ROOT, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    for _ in range(600):
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
            break
        except OSError:
            time.sleep(0.2)
    yield port, process
    process.kill()
    process.communicate()


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://127.0.0.1.evil.example", "null", "http://127.0.0.1:1"]
)
def test_pages_of_other_origins_are_refused(served, origin):
    assert " 403 " in websocket(served[0], origin)


def test_other_addresses_of_this_machine_get_no_answer(served):
    """A server on 0.0.0.0 would answer on 127.0.0.2 as well."""
    with pytest.raises(OSError, match=r"refused|unreachable|timed out|assign"):
        socket.create_connection(("127.0.0.2", served[0]), timeout=2).close()


def test_those_who_left_are_forgotten(served):
    port, process = served
    for _ in range(8):
        assert " 200 " in answer(port, f"GET / HTTP/1.1\nHost: 127.0.0.1:{port}\n\n")
    made, here, ended = 0, -1, time.monotonic() + 600
    while (made < 8 or here) and time.monotonic() < ended:
        made, here = map(int, process.stdout.readline().split())

    assert made == 8
    assert here == 0
