"""Every stiff and extreme case by every kernel: writes docs/extremes.md and the record that tests compare.

    python benchmarks/extremes.py [--longer] [--check] [--collisions N]

`--longer` adds what takes a minute, cycles of period 2^8 and 2^12 and a product of 10^4 matrices; the page in the
repository has it. `--check` writes nothing and says which verdicts differ from the record; the exit code is then 1.
"""

import json
import sys
from pathlib import Path

from verification.extremes.catalogue import rows
from verification.extremes.orbits import SHORT
from verification.extremes.page import WORDS, page, record

ROOT = Path(__file__).resolve().parent.parent
PAGE, RECORD = ROOT / "docs" / "extremes.md", ROOT / "verification" / "extremes" / "recorded.json"


def found(longer, collisions):
    """All rows, with a line on standard error for each."""
    made = []
    for group, case, several in rows(longer, collisions):
        made.append((group, case, several))
        sys.stderr.write(f"{group}: {case}: {', '.join(one.stability.name.lower() for one in several)}\n")
    return made


def moved(now):
    """The verdicts that are not as recorded."""
    kept = {(one["case"], one["kernel"]): one["verdict"] for one in json.loads(RECORD.read_text())}
    return [
        f"{one['case']}, {one['kernel']}: {kept.get((one['case'], one['kernel']), 'new')} -> {one['verdict']}"
        for one in now
        if kept.get((one["case"], one["kernel"])) != one["verdict"]
    ]


def main(longer, check, collisions):
    several = found(longer, collisions)
    now = record(several)
    if check:
        differ = moved(now)
        sys.stdout.write("\n".join(differ or [f"all {len(now)} verdicts are as recorded"]) + "\n")
        return 1 if differ else 0
    PAGE.write_text(page(several, WORDS))
    RECORD.write_text("[\n" + ",\n".join(json.dumps(one) for one in now) + "\n]\n")
    return 0


if __name__ == "__main__":
    size = int(float(sys.argv[sys.argv.index("--collisions") + 1])) if "--collisions" in sys.argv else SHORT
    sys.exit(main("--longer" in sys.argv, "--check" in sys.argv, size))
