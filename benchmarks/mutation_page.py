"""The page on mutation testing: figures from benchmarks/records/mutation.json, reasons from mutation.toml beside it.

A survivor is known by its module, its function and its operator, so that no record breaks when a line moves or is
written again. An entry of the TOML file is a `[[reason]]` with the `module`, the `function` (empty outside of
functions), a sentence `why`, and `operators`: how many survivors of which operator it explains.
"""

import json
import tomllib
from collections import Counter
from functools import cache
from itertools import takewhile
from math import sqrt
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RECORDS = ROOT / "benchmarks" / "records"
FIGURES, REASONS, PAGE = RECORDS / "mutation.json", RECORDS / "mutation.toml", ROOT / "docs" / "mutation.md"
LEFT_OUT = {
    "the other replacements of an operator (`*` by `>>`, `<` by `is`, ...)": "nearly all raise a `TypeError` at once,"
    " and would only raise the share",
    "`VariableReplacer`, `VariableInserter`": "they need names as arguments and put random numbers in",
    "mutants in type annotations and under `if TYPE_CHECKING`": "not executed",
    "docstrings and other text": "cosmic-ray does not change text; doctests are tests here",
    "`@cache` and `@lru_cache`, taken away or of another size": "a memo changes the time, not the result",
    "mutants that do not compile, or have the syntax tree of the original or of another mutant": "no mutants, or"
    " counted already (`not a == b` is `a != b`)",
}
HEAD = """\
# Mutation testing

A mutant is the package with one small mistake: a `+` for a `-`, a `<` for a `<=`, a 3 for a 2. The tests kill it when
one of them fails. This page has the figures. They come from `benchmarks/records/mutation.json` by
`python benchmarks/mutation.py page`; `make mutation` measures again.

{summary}

## How it is measured

Mutants are made with the operators of {made_with}. A coverage run says which tests execute which statement. A
fork for each mutant, in which no module that depends on it has been imported before, asks these tests: the module's own
first, the quickest first. No memo and no file of an earlier run is left, so nothing hides a mutant. A test has three
times its own seconds and five more; one that is stopped by then has failed (`timeout`), as has a module that cannot be
imported. A survivor needs a test, or a reason in `benchmarks/records/mutation.toml`, under its module and function.

Left out are:

{left_out}

### What proves

Of `verification` those modules are asked that say *certified*: balls, interval Newton, first hits, checklists, trapping
regions, transfer operator, manifolds, judges, and the reader of certificates that shares no line with the package. Of
their mutants a sample is drawn, in proportion, and only of mistakes that could let something false through: `+` and
`-`, `*` and `/` exchanged, a comparison negated or moved to its border, a condition negated, dropped or one of its
parts left out, `any` for `all`, a lower end for an upper one, a sign lost, a number one larger, a truth turned, a loop
that does nothing. Left out are budgets and precisions (constants of modules, whole numbers above 16), the texts of
errors, annotations and `strict`; since seed 6 also what counts the work, tells of it or says how many bits are rounded
to, and functions that only propose what a proof then checks: `benchmarks/records/mutation_core.toml` names them, each
with the reason why a wrong result is refused. Asked are the files named there, without tests of more than a second
and a half (what `make test` runs; until seed 4 half a second), as far as fifteen seconds of processor go: first those
that execute the mutated statement, then the others of their files, which may share what one of these has made. A test
is stopped by its own seconds of processor, so that what else the machine does kills no mutant. Since seed 17 a mutant
that survives these is asked the tests of `make slow` of up to half a minute, for a minute, before anybody reads it.
`python benchmarks/mutation.py core --count 120 --seed 3` draws, asks and resumes; `--part core` draws of balls, first
hits, interval Newton, checklists, trapping regions, slap maps, judges and the second reader, `--part 'global dynamics'`
of the other rooms alone.

A sample says how good the tests are only once: when its survivors have been read, and tests been written for them, it
is fitted. So each round draws another.

| seed | asked | killed before a survivor was read | of all, 95 per cent interval (Wilson) | commit |
|---|---|---|---|---|
{samples}

### What survived

Every survivor of every sample was read. The reasons of those of the last one stand in
`benchmarks/records/mutation.toml`, a line each under module and function, those of earlier samples under `earlier`.
Most change nothing that is proved: a guess or a search that a proof checks, a count, a piece or an order of a series
more, a ball about 0 added or taken off, a sign that is 1 or -1, a larger set, a longer tube, a border that a ball
never ends at, a refusal that comes later or for another reason, an error in the place of no proof.

Those that could have let something false through, or say it, have a law each since: an end of a landing that nobody
asked about (`_lands_within`), a bounce that leaves its component, angles of another chord, a hole in the place of
joins, a bound or an expansion by the wrong end of a ball, a slope of the paper's law in the place of another, a
radius left out (`_around`) or negative on a part of the turn, a cycle in two parts, a neutral saddle, a saddle set of
which more than all points stay, a region whose walks lead outside, halves that leave a part of a cell out, a chord
judged free behind a wall, h-sets that meet a turn further, a disc of which no derivative is known, slabs that leave a
part of a gate out. None of them was in the package. Four weaknesses were, found while such laws were written: the
second reader had not looked at marks where a map is undefined on a table of the paper, and refuses them there now; it
refused a right table with constant coordinates; a formula with a pole at a witness ended in an error; and pieces of a
slap map were given by rounded middles, so that only the rounding of radii left nothing between them.

What helped most, in this order: laws of single steps (each step of a checklist fails alone, each subdivision is all
of a set, what is enclosed is compared with a case worked out by hand or with a sample, ends are asked at numbers that
balls hold exactly); measuring right, for a memo, a fixture or a function traced to machine code hides which tests run
a line; simpler code, in which there is less to be wrong. Longer tests helped little. In the blown-up doubling one
mutant is known that is not seen: a derivative with `v` for `-v`, which lies in the same ball.

## By module

The figures are of the text that a module had at the commit in the last column, under the name that it has now; modules
that were written later are not here, and where two files became one their figures are added.

| module | mutants | killed | of these by timeout | survived | share killed | explained | commit |
|---|---|---|---|---|---|---|---|
"""


def percent(share: float) -> str:
    """A share with one digit, cut and not rounded up."""
    return f"{int(share * 1000 + 1e-9) / 10:.1f} %"


def killed(entry: dict) -> int:
    """How many mutants of a module some test noticed."""
    return entry.get("killed", 0) + entry.get("timeout", 0)


def survived(entry: dict) -> int:
    """How many mutants of a module no test noticed."""
    return sum(sum(operators.values()) for operators in entry["alive"].values())


@cache
def given() -> dict[tuple[str, str], Counter[str]]:
    """How many survivors of each operator are explained, by module and function."""
    found: dict[tuple[str, str], Counter[str]] = {}
    for entry in tomllib.loads(REASONS.read_text())["reason"]:
        found.setdefault((entry["module"], entry["function"]), Counter()).update(entry["operators"])
    return found


def explained(path: str, alive: dict[str, dict[str, int]]) -> int:
    """How many of a module's survivors have a reason."""
    pairs = [(given().get((path, function), Counter()), operators) for function, operators in alive.items()]
    return sum(min(count, known[operator]) for known, operators in pairs for operator, count in operators.items())


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Wilson's 95 per cent interval of a share."""
    z = 1.96
    middle, wide = hits + z * z / 2, z * sqrt(hits * (count - hits) / count + z * z / 4)
    return (middle - wide) / (count + z * z), (middle + wide) / (count + z * z)


def summary(name: str, figures: dict[str, dict]) -> str:
    """One sentence on a storey, or on what proves."""
    asked, total = (sum(entry[key] for entry in figures.values()) for key in ("asked", "mutants"))
    hits, alive = sum(map(killed, figures.values())), sum(map(survived, figures.values()))
    reasons = sum(explained(path, entry["alive"]) for path, entry in figures.items())
    every = "all " if asked == total else ""
    text = f"{name}: {hits} of {every}{asked} mutants killed, {percent(hits / asked)}; {alive} survive, "
    text += f"of which {reasons} have a reason" if reasons < alive else "each with a reason"
    if asked == total:
        return text + "."
    first = sum(entry.get("first", killed(entry)) for entry in figures.values())
    low, high = map(percent, wilson(first, asked))
    text += f". Asked was a random part of {total}. Before anybody had read a survivor {first} of them were killed,"
    text += f" {percent(first / asked)}: of all, {low} to {high} (Wilson's 95 per cent interval)."
    later = " The others were killed later, by longer tests or by tests written for them after they were read."
    return text + (later if hits > first else "")


def sample_row(sample: dict) -> str:
    """The line of a sample in the table of samples."""
    asked, hits = sample["asked"], sample["unread"]
    low, high = map(percent, wilson(hits, asked))
    cells = [sample["seed"], f"{asked} of {sample['of']}", f"{hits}, {percent(hits / asked)}", f"{low} to {high}"]
    return "| " + " | ".join([*cells, sample["at"]]) + " |"


def row(path: str, entry: dict) -> str:
    """The line of a module in the table."""
    part = f"{entry['asked']}" if entry["asked"] == entry["mutants"] else f"{entry['asked']} of {entry['mutants']}"
    cells = [f"`{path}`", part, killed(entry), entry.get("timeout", 0), survived(entry)]
    cells += [percent(killed(entry) / entry["asked"]), explained(path, entry["alive"]), entry["at"]]
    return "| " + " | ".join(map(str, cells)) + " |\n"


def page(record: dict) -> str:
    """The whole page."""
    modules: dict[str, dict] = record["modules"]
    parts: dict[str, dict[str, dict]] = {"`symbolic`": {}, "`numeric`": {}, "What proves": {}}
    for path, entry in modules.items():
        parts.get(f"`{path.partition('/')[0]}`", parts["What proves"])[path] = entry
    text = HEAD.format(
        made_with=record["made_with"],
        summary="\n\n".join(summary(*part) for part in parts.items() if part[1]),
        left_out="\n".join(f"- {what}: {why}." for what, why in LEFT_OUT.items()),
        samples="\n".join(map(sample_row, record["samples"])),
    )
    return text + "".join(row(path, entry) for path, entry in sorted(modules.items()))


def known() -> dict:
    """The record as it stands."""
    return json.loads(FIGURES.read_text())


def in_order(sample: tuple[str, dict]) -> tuple[int, str]:
    """Samples by the number that their seed begins with."""
    seed = sample[0]
    return int("".join(takewhile(str.isdigit, seed))), seed


def write_page(new: dict[str, dict], made_with: str, sample: dict) -> None:
    """Merges new figures into those that are kept, a line for each module and each sample, and writes the page."""
    modules = {path: entry for path, entry in (known()["modules"] | new).items() if (ROOT / path).is_file()}
    samples = {entry["seed"]: entry for entry in (*known()["samples"], *([sample] if sample["asked"] else []))}
    lines = [f" {json.dumps(path)}: {json.dumps(entry)}" for path, entry in sorted(modules.items())]
    drawn = ",\n".join(f" {json.dumps(entry)}" for _, entry in sorted(samples.items(), key=in_order))
    body = ",\n".join(lines)
    FIGURES.write_text(
        f'{{"made_with": {json.dumps(made_with)}, "samples": [\n{drawn}\n], "modules": {{\n{body}\n}}}}\n'
    )
    PAGE.write_text(page(known()))
