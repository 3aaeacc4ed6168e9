"""Writes the page `docs/numerics.md` from recorded measurements: `python benchmarks/dossier.py`.

The sources are `bench.json`, `bench_avx2.json` and `work_precision.json` in `benchmarks/records`, each written by the
command that the page names, and the text in `dossier.md` beside this file. A test compares the page with its sources.
"""

import json
import sys
from pathlib import Path

from verification.measure.extremes.orbits import SCENES
from verification.measure.work.figure import times
from verification.measure.work.row import MethodResult, duration, footer, front, short

ROOT = Path(__file__).resolve().parent.parent
PAGE, TEXT = ROOT / "docs" / "numerics.md", ROOT / "benchmarks" / "dossier.md"
KERNEL = "float64 llvm"
RIVAL = "float64 numba, one particle at a time"
SWEEP = "sweep"  # what rows of sweeps name in place of a table
BOUNDS = 4, 8  # units of 2**-52: of the place and of the direction
MANY = 100  # digits


def load(name):
    """The content of one of the files in the repository."""
    return json.loads((ROOT / name).read_text(encoding="utf-8"))


def table(head, lines):
    """A table in Markdown."""
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(head), *lines])


def bounce(bench):
    """A line for each table: errors, times, and the ratio to scalar numba."""
    lines = []
    for scene, shape in SCENES.items():
        own = {
            f"{r['arithmetic']} {r['kernel']}": r["seconds_per_bounce"] for r in bench["rows"] if r["scene"] == scene
        }
        cases = [case for case in bench["accuracy"] if case["scene"] == scene]
        usual = next(case for case in cases if case["case"] == "random")
        hard = max(cases, key=lambda case: max(case["position"] / BOUNDS[0], case["direction"] / BOUNDS[1]))
        label = ", ".join([scene, *(f"{k} = {v}" for k, v in shape.items())])
        more = f"{own[f'{KERNEL}, exponents'] / own[KERNEL] - 1:+.0%}"
        kept = duration(own[f"{KERNEL}, orbits as angles and points"])
        lines.append(
            [
                label,
                pair(usual),
                f"{pair(hard)}: {hard['case']}",
                duration(own[KERNEL]),
                more,
                kept,
                times(own[RIVAL] / own[KERNEL]),
            ]
        )
    head = ["table", "random", "hardest case", "time", "exponents", "kept as angles and points", "numba, times"]
    return table(head, lines)


def calls(bench):
    """A line for each call that `pinball bench` bounds, with a column for each table: ratios, or else times."""
    found, bars = {}, {}
    for row in [row for row in bench["calls"] if row["scene"] in SCENES]:
        what = row["call"], row["against"] if row["against"].startswith("a ") else ""
        value = duration(row["seconds"]) if what[1] else f"{row['ratio']:.2g}"
        found[what, row["scene"]] = value if row["ratio"] <= row["bar"] else f"**{value}**"
        bars[what] = duration(row["bar"] * row["reference"]) if what[1] else f"{row['bar']:g}"
    lines = [[call, bars[call, by], *(found.get(((call, by), s), "") for s in SCENES)] for call, by in bars]
    return table(["call", "bar", *SCENES], lines)


def elsewhere(bench):
    """The cost of particles at rest on tables that are not the paper's, as ratios."""
    rows = [row for row in bench["calls"] if row["scene"] not in (*SCENES, SWEEP)]
    return ", ".join(f"{row['scene']} {row['ratio']:.2g}" for row in rows), max(row["bar"] for row in rows)


def sweeps(bench):
    """The cost of tasks when several workers share a sweep, relative to one, and the error of its predicted time."""
    rows = [row for row in bench["calls"] if row["scene"] == SWEEP]
    return ", ".join(f"{row['call']} {row['ratio']:.2f} (bar {row['bar']:.2f})" for row in rows)


def kernels(benches):
    """A line for each processor and question of a kernel: the time of a bounce on each table."""
    lines = []
    for bench in benches:
        own = {(row["scene"], row["arithmetic"], row["kernel"]): row["seconds_per_bounce"] for row in bench["rows"]}
        for kernel, words in (("llvm", "at the end"), ("llvm, exponents", "with both exponents")):
            times = [duration(own[scene, "float64", kernel]) for scene in SCENES]
            lines.append([bench["machine"]["processor"], words, *times])
    return table(["processor", "asked for", *SCENES], lines)


def pair(case):
    """Errors of place and direction, as text."""
    return f"{case['position']:.2g}, {case['direction']:.2g}"


def threads(bench):
    """The gain from a second thread."""
    own = {(row["scene"], row["kernel"]): row["seconds_per_bounce"] for row in bench["rows"]}
    gains = [own[scene, "llvm"] / own[scene, "llvm, 2 threads"] for scene in SCENES]
    return f"Two threads are {min(gains):.2f} to {max(gains):.2f} times as fast as one."


def questions(document, rows):
    """A line for each question."""
    lines = []
    for name, about in document["questions"].items():
        own = [row for row in rows if row.question == name]
        lines.append([f"{about['title']} (`{name}`)", *(cell(own) for cell in (doubles, proved, usual_way))])
    return table(
        ["question", "float64: error, time", f"{MANY} digits, proved", "the usual way: error, times slower"], lines
    )


def doubles(rows):
    """The most exact answer in float64, and the fastest within a digit of it."""
    own = [row for row in rows if row.arithmetic == "float64" and not row.textbook and row.error is not None]
    if not own:
        return ""
    finest = min(row.magnitude for row in own)
    quick = min((row for row in own if row.magnitude < finest + 1), key=lambda row: row.seconds)
    return f"{short(quick.error)}, {duration(quick.seconds)}"


def proved(rows):
    """The shortest time in which a method of ours gives `MANY` digits with their proof; empty if none does."""
    own = [row.seconds for row in rows if row.proved and row.digits == MANY and row.error is not None]
    return duration(min(own)) if own else ""


def usual_way(rows):
    """Text: the most exact usual method, its error, and its time relative to our fastest method as exact."""
    found = [row for row in rows if row.textbook and row.error is not None]
    if not found:
        return ""
    best = min(found, key=lambda row: (row.error, row.seconds))
    rivals = [row for row in front([r for r in rows if not r.textbook]) if row.error <= best.error]
    slower = f"{times(best.seconds / rivals[0].seconds)}" if rivals else "nothing of ours is as good"
    return f"{best.method}: {short(best.error)}, {slower}"


def broken(rows):
    """How often a usual method did not keep the error that its tolerance promised."""
    asked = [row for row in rows if row.textbook and row.promise is not None]
    worst = [row for row in asked if row.kept is False]
    ours = [row for row in rows if not row.textbook and row.kept is False]
    count = sum(row.promise is not None and not row.textbook for row in rows)
    named = "".join(f"; {one}" for one in sorted({f"{row.question}, {row.method}" for row in ours}))
    kept = f"all {count} settings of this package keep theirs"
    if ours:
        kept = f"{len(ours)} of this package's {count} settings do not keep theirs"
    return (
        f"{len(asked)} settings of usual ways state a tolerance, and {len(worst)} of them do not keep it; "
        f"{kept}{named}."
    )


def page():
    """The text of the page."""
    bench, work = load("benchmarks/records/bench.json"), load("benchmarks/records/work_precision.json")
    other = load("benchmarks/records/bench_avx2.json")
    rows = [MethodResult.from_dict(row) for row in work["rows"]]
    loose = [f"`{name}`" for name, about in work["questions"].items() if not about["certified"]]
    return TEXT.read_text().format(
        machine=footer(bench["machine"]),
        bounce=bounce(bench),
        bounds=f"{BOUNDS[0]} and {BOUNDS[1]}",
        threads=threads(bench),
        kernels=kernels([bench, other]),
        other=other["machine"]["processor"],
        one=bench["machine"]["processor"],
        own_calls=calls(bench),
        calls=calls(other),
        own_elsewhere=elsewhere(bench)[0],
        elsewhere="{} (bar {:g})".format(*elsewhere(other)),
        sweeps=sweeps(bench),
        uncertified=f" (of {', '.join(loose)} a long run)" if loose else "",
        many=MANY,
        questions=questions(work, rows),
        usual=broken(rows),
    )


if __name__ == "__main__":
    PAGE.write_text(page())
    sys.stdout.write(f"{PAGE.name}: {len(page().split())} words\n")
