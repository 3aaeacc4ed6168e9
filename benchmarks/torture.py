"""Long attacks on parsers, stores and proofs, hours at full scale: `torture.py [PART ...] [--scale SHARE]`.

Each part prints one line: attack, attempts, failures and time. The exit status is 1 when anything failed. The attacks
are in benchmarks/attacks, a file for each subject; `--help` lists them.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable
from typing import Any

from attacks.aarch64 import aarch64
from attacks.calibration import bars, counts, dimensions, intervals, known, shares
from attacks.faults import disks, restarts
from attacks.joins import joins
from attacks.machine_code import images
from attacks.outcome import Outcome
from attacks.processors import processors
from attacks.sessions import visitors
from attacks.statements import falsehoods

SEEDS, LEAST = 500, 100  # of each interval, at full scale and at any


def seeds(share: float) -> int:
    """The number of seeds for an interval."""
    return max(LEAST, int(SEEDS * share))


PARTS: dict[Callable[..., Outcome], Callable[[float], Any]] = {  # attacks, and how much of each at a share of the whole
    images: lambda share: int(1_000_000 * share),
    restarts: lambda share: int(400 * share),
    disks: lambda share: max(3, int(40 * share)),
    visitors: lambda share: max(8, int(100 * share)),
    falsehoods: lambda share: int(1000 * share),
    **dict.fromkeys((intervals, shares, dimensions, known, bars), seeds),
    counts: lambda share: max(1, seeds(share) // 50),
    aarch64: lambda share: max(16, int(256 * share)),
    processors: lambda share: "*" if share >= 1 else "egg.*",
    joins: lambda share: int(10_800_000 * share),
}
NAMES = {attack.__name__: attack for attack in PARTS}


def processor() -> float:
    """The processor time of this process and of its finished children, in seconds."""
    return sum(os.times()[:4])


def main() -> int:
    """Runs the named parts, or all but the longest."""
    listed = "\n".join(f"{name:<12}{(attack.__doc__ or '').splitlines()[0]}" for name, attack in NAMES.items())
    shape = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, epilog=listed, formatter_class=shape)
    parser.add_argument("parts", nargs="*", metavar="PART", help="a name from the list below")
    parser.add_argument("--scale", type=float, default=1.0, help="a share of the full counts")
    given = parser.parse_args()
    unknown = set(given.parts) - set(NAMES)
    if unknown:
        parser.error(f"no part is called {', '.join(unknown)}; accepted: {', '.join(NAMES)}")
    failed = 0
    for name in given.parts or [name for name in NAMES if name != "processors"]:  # which makes the report three times
        began, busy = time.perf_counter(), processor()
        outcome = NAMES[name](PARTS[NAMES[name]](given.scale))
        failed += outcome.failed
        spent = f"{time.perf_counter() - began:.0f} s, {processor() - busy:.0f} s of processor"
        sys.stdout.write(f"{name}: {outcome.tried:,} tried, {outcome.failed} failed, {spent}; {outcome.said}\n")
        sys.stdout.flush()
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
