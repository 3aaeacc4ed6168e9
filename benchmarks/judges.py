"""Records the time to judge each claim, and which claims share results, for the scheduling of `pinball verify`.

    python benchmarks/judges.py          # five minutes; writes verification/paper/claims/focusing/seconds.json
    python benchmarks/judges.py --jobs 4 # reads it: how long so many processes need, by the record

The claims are judged in turn in one process, and every caching function of the package notes which claim computed a
result and which reused it: the time that the first saved the other.
"""

import functools
import json
import sys
import time
from collections.abc import Callable
from heapq import heappop, heappush
from importlib import import_module
from pathlib import Path
from typing import Any

RECORD = Path(__file__).resolve().parents[1] / "verification" / "paper" / "claims" / "focusing" / "seconds.json"
OURS = ("symbolic", "numeric", "verification")
WORTH = 0.04  # seconds that are worth a line
DIGITS = 2  # of the seconds

judged = ""  # the claim that is being judged
seen: set[tuple[str, Any]] = set()  # results that this claim took from others
taken: dict[tuple[str, str], float] = {}  # what a claim was saved by another


def noting(function: Callable[..., Any]) -> Callable[..., Any]:
    """As `functools.cache`, with notes of the claims that compute and reuse results."""
    name = f"{function.__module__}.{function.__qualname__}"
    kept: dict[Any, tuple[Any, str, float]] = {}  # a result, the claim that computed it, and how long that took

    @functools.wraps(function)
    def called(*arguments: Any, **named: Any) -> Any:
        key = (arguments, *named.items()) if named else arguments
        found = kept.get(key)
        if found is None:
            start = time.process_time()
            found = kept[key] = function(*arguments, **named), judged, time.process_time() - start
        result, first, seconds = found
        if first != judged and (name, key) not in seen:
            seen.add((name, key))
            taken[first, judged] = taken.get((first, judged), 0.0) + seconds
        return result

    called.cache_clear = kept.clear  # type: ignore[attr-defined]
    return called


def note_all() -> None:
    """Makes the caches of the package's modules take notes; call it before they are imported."""
    cache, lru_cache = functools.cache, functools.lru_cache

    def noted(function: Any) -> Any:
        return noting(function) if function.__module__.partition(".")[0] in OURS else cache(function)

    def sized(maxsize: Any = 128, typed: bool = False) -> Any:
        plain = lru_cache(maxsize, typed)
        if callable(maxsize):
            return noted(maxsize)
        return lambda function: noting(function) if function.__module__.partition(".")[0] in OURS else plain(function)

    functools.cache, functools.lru_cache = noted, sized  # type: ignore[assignment]


def spared() -> dict[str, dict[str, float]]:
    """For each claim the seconds that it saved each other one, where that was more than `WORTH`."""
    found: dict[str, dict[str, float]] = {}
    for (first, other), seconds in sorted(taken.items()):
        if round(seconds, DIGITS) > WORTH:
            found.setdefault(first, {})[other] = round(seconds, DIGITS)
    return found


def measure() -> None:
    """Judges all claims and writes the record."""
    global judged
    note_all()
    report = import_module("verification.paper.report.report")
    for module in sorted({claim.home for claim in report.catalogue()}):
        import_module(module)
    seconds = {}
    for claim in report.catalogue():
        judged, start = claim.id, time.process_time()
        seen.clear()
        report.judge(claim)
        seconds[judged] = round(time.process_time() - start, DIGITS)
        sys.stdout.write(f"{seconds[judged]:8.2f}  {judged}\n")
    lines = ",\n".join(f'    "{name}": {value}' for name, value in seconds.items())
    spares = ",\n".join(f"    {json.dumps(name)}: {json.dumps(others)}" for name, others in spared().items())
    text = f'{{\n  "seconds": {{\n{lines}\n  }},\n  "spares": {{\n{spares}\n  }}\n}}\n'
    RECORD.write_text(text, encoding="utf-8")


def shown(jobs: int) -> None:
    """The time that `jobs` processes need, most expensive group first, compared with an even share of the work."""
    report = import_module("verification.paper.report.report")
    groups = report.shared_out(report.catalogue(), jobs)
    ends = [0.0] * jobs
    for group in groups:
        heappush(ends, heappop(ends) + report.seconds(group))
    whole = sum(ends)
    sys.stdout.write(f"{len(groups)} groups, {whole:.0f} s; the dearest {report.seconds(groups[0]):.1f} s; ")
    sys.stdout.write(f"{jobs} processes: {max(ends):.1f} s, an even share {whole / jobs:.1f} s\n")


if __name__ == "__main__":
    shown(int(sys.argv[2])) if "--jobs" in sys.argv else measure()
