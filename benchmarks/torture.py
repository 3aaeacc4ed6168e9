"""Long attacks on parsers, stores and proofs, hours at full scale: `torture.py [PART ...] [--scale SHARE]`.

    images      object files and images of machine code with fields written over, read in children that may die
    restarts    sweeps that are killed, refused and damaged again and again, until they are done
    disks       sweeps onto disks of memory that are full at each of their writes
    visitors    sessions of the live table that are opened and left
    falsehoods  certificates of true statements made slightly false: none may be certified
    intervals   how often 95 per cent intervals of an exponent hold the value that balls enclose
    shares      how often those of a basin's share hold one half, where a mirror maps one basin to another
    dimensions  how often those of a boundary's dimension hold that of random fractal graphs
    known       how often intervals hold exponents that follow from the table
    bars        how often they hold the result of many orbits, on tables that the paper does not have
    counts      how many attractors regular polygons are found to have
    aarch64     kernels compiled for AArch64 and run in QEMU, against those of this machine, bit by bit
    processors  the whole report with fewer instructions: the same bytes; an hour more, so only when it is named
    joins       on which side of a join flights of the cuspless table land that pass it within rounding

Each part prints one line: attack, attempts, failures and time. The exit status is 1 when anything failed. The attacks
are in benchmarks/attacks, a file for each subject.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable

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


PARTS: dict[str, Callable[[float], Outcome]] = {
    "images": lambda share: images(int(1_000_000 * share)),
    "restarts": lambda share: restarts(int(400 * share)),
    "disks": lambda share: disks(max(3, int(40 * share))),
    "visitors": lambda share: visitors(max(8, int(100 * share))),
    "falsehoods": lambda share: falsehoods(int(1000 * share)),
    "intervals": lambda share: intervals(seeds(share)),
    "shares": lambda share: shares(seeds(share)),
    "dimensions": lambda share: dimensions(seeds(share)),
    "known": lambda share: known(seeds(share)),
    "bars": lambda share: bars(seeds(share)),
    "counts": lambda share: counts(max(1, seeds(share) // 50)),
    "aarch64": lambda share: aarch64(max(16, int(256 * share))),
    "processors": lambda share: processors("*" if share >= 1 else "egg.*"),
    "joins": lambda share: joins(int(10_800_000 * share)),
}


BY_NAME = {"processors"}  # the report, three times


def processor() -> float:
    """The processor time of this process and of its finished children, in seconds."""
    return sum(os.times()[:4])


def main() -> int:
    """Runs the named parts, or all but the longest."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--scale", type=float, default=1.0, help="a share of the full counts")
    given = parser.parse_args()
    unknown = set(given.parts) - set(PARTS)
    if unknown:
        parser.error(f"no part is called {', '.join(unknown)}; accepted: {', '.join(PARTS)}")
    failed = 0
    for name in given.parts or [part for part in PARTS if part not in BY_NAME]:
        began, busy = time.perf_counter(), processor()
        outcome = PARTS[name](given.scale)
        failed += outcome.failed
        spent = f"{time.perf_counter() - began:.0f} s, {processor() - busy:.0f} s of processor"
        sys.stdout.write(f"{name}: {outcome.tried:,} tried, {outcome.failed} failed, {spent}; {outcome.said}\n")
        sys.stdout.flush()
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
