"""Runs every stiff and extreme case on every kernel, and writes docs/extremes.md and the record that tests compare.

    python benchmarks/extremes.py [--longer] [--check]
    python benchmarks/extremes.py --collisions 1e9 [--particles 256] [--only WORD]
    python benchmarks/extremes.py --page

`--longer` adds cases that take a minute: cycles of period 2^8 and 2^12 and a product of 10^4 matrices; the page in the
repository has them. `--check` writes nothing and lists the verdicts that differ from the record; the exit status is
then 1. `--collisions` measures only the long orbits, with so many collisions in total, and records each as soon as it
is measured. `--page` writes the page again from the records.
"""

import argparse
import json
import sys
from pathlib import Path

from verification.measure.extremes.orbits import PARTICLES, findings, orbits
from verification.measure.extremes.page import LONG, RECORD, lines, page, record, rows

PAGE = Path(__file__).resolve().parent.parent / "docs" / "extremes.md"


def found(several):
    """All rows; prints a line on standard error for each."""
    made = []
    for group, case, answers in several:
        made.append((group, case, answers))
        sys.stderr.write(f"{group}: {case}: {', '.join(one.stability.name.lower() for one in answers)}\n")
    return record(made)


def moved(now):
    """The verdicts that differ from the record."""
    kept = {(one["case"], one["kernel"]): one["verdict"] for one in json.loads(RECORD.read_text())}
    return [
        f"{one['case']}, {one['kernel']}: {kept.get((one['case'], one['kernel']), 'new')} -> {one['verdict']}"
        for one in now
        if kept.get((one["case"], one["kernel"])) != one["verdict"]
    ]


def kept(path, several):
    """Writes a record, one line for each finding."""
    path.write_text("[\n" + ",\n".join(json.dumps(one) for one in several) + "\n]\n")


def long(collisions, particles, only):
    """Measures the long orbits, and records each as soon as it is measured."""
    command = f"python benchmarks/extremes.py --collisions {collisions:.3g} --particles {particles}"
    for one in orbits(collisions, particles):
        if only in one.name:
            now = found([(f"Orbits of {collisions:.0e} collisions", one.name, findings(one))])
            cases = {line["case"] for line in now}
            before = json.loads(LONG.read_text()) if LONG.exists() else []
            before = [line for line in before if line["case"] not in cases]
            several = before + [line | {"command": command} for line in now]
            kept(LONG, sorted(several, key=lambda line: line["command"]))


def main(asked):
    if asked.collisions:
        long(int(asked.collisions), asked.particles, asked.only)
    elif not asked.page:
        now = found(rows(asked.longer))
        if asked.check:
            differ = moved(now)
            sys.stdout.write("\n".join(differ or [f"all {len(now)} verdicts are as recorded"]) + "\n")
            return 1 if differ else 0
        kept(RECORD, now)
    PAGE.write_text(page(lines(RECORD), lines(LONG)))
    return 0


if __name__ == "__main__":
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for word in ("longer", "check", "page"):
        words.add_argument(f"--{word}", action="store_true")
    words.add_argument("--collisions", type=float)
    words.add_argument("--particles", type=int, default=PARTICLES)
    words.add_argument("--only", default="")
    sys.exit(main(words.parse_args()))
