"""Files are written whole or not at all, despite interruptions and disk errors."""

import os
import signal
import subprocess
import sys

import pytest

from numeric.lowering.files import replacing, write_whole

FULL = """
import resource, signal, sys
from numeric.lowering.files import write_whole
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    write_whole(sys.argv[1], "new" * 1000)
except OSError:
    sys.exit(7)
"""
KILLED = """
import os, signal, sys
from numeric.lowering.files import replacing
signal.signal(signal.SIGINT, signal.default_int_handler)  # which a process in the background lacks
with replacing(sys.argv[1]) as file:
    file.write(b"new" * 10**6)
    os.kill(os.getpid(), int(sys.argv[2]))
"""


@pytest.mark.parametrize(
    ("program", "more", "status"),
    [(FULL, [], 7), (KILLED, [signal.SIGKILL], -signal.SIGKILL), (KILLED, [signal.SIGINT], -signal.SIGINT)],
)
def test_what_was_there_stays_when_a_write_ends_early(tmp_path, program, more, status):
    path = tmp_path / "orbit.csv"
    path.write_text("old")
    words = [sys.executable, "-c", program, path, *(str(int(number)) for number in more)]
    done = subprocess.run(words, capture_output=True, check=False)

    assert done.returncode == status
    assert path.read_text() == "old"
    left = [each.name for each in tmp_path.iterdir() if each != path]
    assert len(left) == (signal.SIGKILL in more)


def test_a_write_takes_the_place_of_the_old_file_and_keeps_its_permissions(tmp_path):
    path = tmp_path / "report.md"
    path.write_text("old")
    path.chmod(0o640)
    write_whole(path, "new")

    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    assert [each.name for each in tmp_path.iterdir()] == ["report.md"]


def test_writing_through_a_link_keeps_the_link(tmp_path):
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "real")

    write_whole(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_a_pipe_is_written_to(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    reader = subprocess.Popen(["cat", tmp_path / "pipe"], stdout=subprocess.PIPE)
    with replacing(tmp_path / "pipe") as file:
        file.write(b"whole")

    assert reader.communicate(timeout=10)[0] == b"whole"
