"""What each test takes: runs the whole suite and writes tests/slow.txt, by which the levels of tests are told apart.

    python benchmarks/slow_tests.py              # half an hour
    python benchmarks/slow_tests.py tests/FILE   # of these files only; the other lines stay
    python benchmarks/slow_tests.py -m "not slow" tests/FILE   # with the marks, as pytest takes them

A test has a line when its examples together take more than `LEAST` seconds of one processor. What a file sets up for
several tests counts for each of them: whichever of them is left out, the others have it to do.
"""

import os
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

LIST = Path(__file__).resolve().parents[1] / "tests" / "slow.txt"
LEAST = 0.1


def clock() -> float:
    """The processor's seconds, of this process and of those that it started."""
    return sum(os.times()[:4])


class Seconds:
    """What each test takes, with all its parameters."""

    def __init__(self) -> None:
        self.spent: Counter[str] = Counter()
        self.shared: dict[Any, float] = {}  # what a fixture for several tests takes
        self.users: defaultdict[str, set[Any]] = defaultdict(set)
        self.setting_up = 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Setting up, calling and tearing down, without what is shared."""
        start, before = clock(), self.setting_up
        result = yield
        name = item.nodeid.partition("[")[0]
        self.spent[name] += clock() - start - (self.setting_up - before)
        fixtures = getattr(item, "_fixtureinfo", None)
        if fixtures is not None:
            self.users[name] |= {some[-1] for some in fixtures.name2fixturedefs.values()}
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[Any]:
        """Fixtures of a file or of a session; one that asks for another has it before."""
        start, before = clock(), self.setting_up
        result = yield
        if fixturedef.scope != "function":
            spent = clock() - start - (self.setting_up - before)
            self.shared[fixturedef] = self.shared.get(fixturedef, 0.0) + spent
            self.setting_up += spent
        return result

    def lines(self) -> Iterator[str]:
        """The lines of the list."""
        for name, spent in self.spent.items():
            whole = spent + sum(self.shared.get(fixture, 0.0) for fixture in self.users[name])
            if whole > LEAST:
                yield f"{whole:7.1f} {name}"


def main(arguments: list[str]) -> int:
    """Runs what is asked for in this process, and writes the list when everything passed."""
    seconds = Seconds()
    status = pytest.main(["-q", "-n", "0", *arguments], plugins=[seconds])
    if status == pytest.ExitCode.OK:
        old = LIST.read_text(encoding="utf-8").splitlines() if arguments else []
        kept = [line for line in old if line.split()[1] not in seconds.spent]
        lines = sorted([*kept, *seconds.lines()], key=lambda line: line.split()[1])
        LIST.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return int(status)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
