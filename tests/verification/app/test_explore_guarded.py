"""The live table answers only this machine, whatever the request, and frees the state of visitors who left."""

import socket

import pytest
from attacks.sessions import answer, left, live_server


def websocket(port, origin):
    """The server's answer to a page of some origin that requests the live connection."""
    return answer(
        port,
        f"GET /ws HTTP/1.1\nHost: 127.0.0.1:{port}\nUpgrade: websocket\nConnection: Upgrade\nOrigin: {origin}\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\nSec-WebSocket-Version: 13\n\n",
    )


@pytest.fixture(scope="module")
def served():
    """The port of a server in its own process, with environment variables that would open it to others."""
    with live_server() as found:
        yield found


@pytest.mark.slow
@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://127.0.0.1.evil.example", "null", "http://127.0.0.1:1"]
)
def test_pages_of_other_origins_are_refused(served, origin):
    assert " 403 " in websocket(served[0], origin)


def test_other_addresses_of_this_machine_get_no_answer(served):
    """A server on 0.0.0.0 would answer on 127.0.0.2 as well."""
    with pytest.raises(OSError, match=r"refused|unreachable|timed out|assign"):
        socket.create_connection(("127.0.0.2", served[0]), timeout=2).close()


@pytest.mark.slow
def test_those_who_left_are_forgotten(served):
    """`benchmarks/torture.py visitors` opens and leaves a hundred pages."""
    assert left(served, 8) == (8, 8, 0)
