"""Property tests are the same on every machine: derandomised, and not judged by the clock.

The examples are the same in every run, so that more of them find nothing new on a second day: 25 unless a test says
another number. `pytest --hypothesis-profile long` draws 500, other ones every time.

`slow.txt` has the seconds of the tests that `make quick` leaves out; `make test` and CI run everything, file by file:
what a file computes for several tests is computed once, and the dearest files begin.
"""

from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

FOR_ALL = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("ci", derandomize=True, max_examples=25, **FOR_ALL)
settings.register_profile("long", max_examples=500, **FOR_ALL)
settings.load_profile("ci")

LINES = (Path(__file__).parent / "slow.txt").read_text(encoding="utf-8").splitlines()
SLOW = {name: float(seconds) for seconds, name in (line.split() for line in LINES)}


@pytest.hookimpl(tryfirst=True)  # before what is marked is left out
def pytest_collection_modifyitems(items):
    names = {item: item.nodeid.partition("[")[0] for item in items}
    files = Counter()
    for name in dict.fromkeys(names.values()):  # in one order, so that workers agree
        files[name.partition("::")[0]] += SLOW.get(name, 0.0)
    for item, name in names.items():
        if name in SLOW:
            item.add_marker(pytest.mark.slow)
    items.sort(key=lambda item: -files[names[item].partition("::")[0]])
