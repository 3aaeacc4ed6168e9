"""Which tests are slow: runs the whole suite and writes tests/slow.txt, which `make quick` leaves out.

    python benchmarks/slow_tests.py     # half an hour

A test is slow when its examples together take more than `SLOW` seconds of one processor, what it sets up included.
"""

import os
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

LIST = Path(__file__).resolve().parents[1] / "tests" / "slow.txt"
SLOW = 0.1


class Seconds:
    """What each test takes, with all its parameters."""

    def __init__(self) -> None:
        self.spent: Counter[str] = Counter()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Setting up, calling and tearing down."""
        start = sum(os.times()[:4])  # of this process and of those that it started
        result = yield
        self.spent[item.nodeid.partition("[")[0]] += sum(os.times()[:4]) - start
        return result


def main() -> int:
    """Runs everything in this process, and writes the list when everything passed."""
    seconds = Seconds()
    status = pytest.main(["-q", "-n", "0"], plugins=[seconds])
    if status == pytest.ExitCode.OK:
        slow = (f"{spent:7.1f} {name}\n" for name, spent in sorted(seconds.spent.items()) if spent > SLOW)
        LIST.write_text("".join(slow), encoding="utf-8")
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
