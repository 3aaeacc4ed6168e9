"""The page on mutation testing: figures from benchmarks/records/mutation.json, reasons from mutation.toml beside it.

A survivor is known by its module, its function and its operator, so that no record breaks when a line moves or is
written again. An entry of the TOML file is a `[[reason]]` with the `module`, the `function` (empty outside of
functions), a sentence `why`, and `operators`: how many survivors of which operator it explains.
"""

import json
import tomllib
from collections import Counter
from functools import cache
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

Why mutants survived in seeds 2 and 3, each survivor read: the list of tests was incomplete, or a fixture or memo hid
which tests run a line (both are mended); or no test saw the mistake, and now one does, mostly by a law that sees many
(all of a set is asked by each subdivision; each step of a checklist that fails leaves its own items open; what is
enclosed or bounded is compared with cases worked out by hand); or nothing false can follow, as the reasons say. None
showed a wrong statement in the package.

Of the nine that survived seed 6 seven let nothing false through. `neighbourhoods`: the same turns of a cycle in another
order. `stays_below`, `_impossible`, `Judge.mean`: a ball about a multiple of pi, or of a logarithm, never ends at the
border. `_proved` without slopes, `Judge.stretches`: an error in the place of no proof. `witness`: another box around
the same solution. Two do: `_proved` where a bounce leaves its component has a test since, `Cover.settled` on sums that
floats round has none.

Of the 19 that survived seed 7 one let something false through: `PinballImages.slopes`, the slope of the paper's law in
the place as 1 where it is 0. The other 18 prove the same or less: a guess, a search, digits or a count of boxes begun
one higher, a finer cut, a series or a kernel of one more order, an early answer left out, a limit of the work at its
border, a ball that is symmetric about 0, a radius that is rounded up anyway. The first and three of these have tests
now, by laws on what a proof is given (`tests/verification/proofs/test_what_proofs_are_given.py`).

Of the four that survived seed 9, of the judges alone, one could let something false through, `greater` of two numbers
that are one, and one would print a wrong witness (`map.dissipative`); both have a test now. The others are a strict
comparison of two numbers that are known to differ, and letters that need not be positive.

Of the 28 that survived seed 11, of all modules and on a machine with twelve times as much other work, `_lands_within`
could let something false through, an end of a landing that nobody asks about, and has a test now; so have
`_exactly_nonnegative`, a condition on coefficients, `Horseshoe._covering`, and `_around`, by which a mutant
leaves out a
ball's radius. The others prove the same, less, or nothing: guesses and searches that a proof checks
(`EnclosedMap._landed`, `bracket`, `share`, `reach`, `Chain._side`, `I.atan`, `_attractor`), balls that never end at a
border (`stays_below`, `after_corner`), a sign divided by or multiplied with (`extent`), what is cut first or told of
progress (`_followed`, `fourth_on_wall`, `no_others`, `_named`), a larger set (`no_triangles`, `incidences`), a higher
order (`_integral`, `tighten`), a number that stands for no letter (`Jet.of`), a cycle of one bounce (`admissible`), an
early answer (`_once`, `Flights.landing`), a refusal that comes later (`objection`, `_holds`).

Before seed 11b groups were made for the rooms written since, the second reader's files among them: a first look, at all
modules. Of its 32 survivors ten could let something false through, or say it, and have tests since: `_joins` (a hole
in the place of joins), `proved` (the digits of another unknown), `_hyperbolic`, `_absorbed`, `_within` twice,
`Strips.started`, `Horseshoe.checks` (a covering said of edges that nobody asks about), `cornered`, `Manifold`. The
others only propose (`Gap.contact`, `multipliers`, `neighbourhoods`), go on the border of a ball or of the work
(`positive_margins`, `polygon`, `Chords._near`, `on_arc`, `embedded`), prove less (`minimal`, `Branch.leaves`,
`BoundaryCrisis.checks`), or change nothing: `_touches` goes both ways, `attracts` asks what no convex table loses,
`Rotating.value` a higher order, `positive` pieces that overlap, `meet` a type, `evaluate` two shortcuts, `admissible` a
sign that is 1 or -1, `Cycle.__init__` a letter that is none, `generic` ends in an error, `Proof` a text.

Then what only proposes, samples or tells was read function by function and left out, each with its reason; guesses that
stood inside of proofs (`_polished`, `_vectors`, `_in_floats`) are functions of their own. Seed 12 was asked of the
second reader, first hits, interval Newton and the corner alone. Of its 12 survivors `_dot` twice, `_impossible`,
`Manifold` twice, `_folded` and `_hull` (the slopes it tells) have tests since. The others: `no_others` (a count),
`proved` (bits of a first try), `birkhoff_normal_form` (looked up never in vain), `_hull` (a norm of exactly 1), `exact`
(the longest number that is read). All groups have tests since that compare sets with samples (coverings, strips, discs,
cores, parallelograms), make each step of a checklist fail alone, and prove each short certificate as it stands.

Of the survivors of seed 13, of all modules, `settled`, `region`, `on_the_table` twice, `in_core`, `matrix`, `_held`,
`_impossible` and `one` have tests since. Not settled are two of the second reader: `touching`, which asks whether a
chord is free, and `continued`, whether an entry is not 0. The others: a first landing asked about twice
(`first_hits`), a digit more
(`number`), another whole turn (`_turned_back`), a bound with room for it (`root`), a proof not found
(`BelowStar.checks`), a guess (`strips`, `courses`), a longer tube (`pair`), a whole number more of what is
asked to be whole
(`slope`), a term more (`series`), entries that are no mapping and end in an error (`_rightly_said`), a border
(`ergodic`).

Seed 14, drawn after that, is not better: 112 of 141. Its 29 survivors are listed and
not yet settled. Of the functions `Cover.settled`, `_passes`, `_nonzero`, `Core.holds`, `Ring.stretches`, `_image`,
`_strip`, `_judged`, `Step.saddle`, `bound`, `Table.flight`, `function`, `Branch.proved` and `square` the mutants
look as if they could let something false through; the goal of 92 per cent is not reached.

Seed 15train, at fdcd407, was drawn after the open survivors of seed 14 had tests (cones of a branch, arrivals,
cores, gaps, chords of tangencies) and the groups had all test files that import their modules: 253 of 297 before one
was read (85.1 per cent). Of its 44 survivors 23 have tests since, most of them laws of steps that could let something
false through: a disc of which no derivative is known, a basin by walks turned round, slabs that leave a part of a gate
out, the range of contractions, joined stretches with a gap, roundings of a cell's border. With these 276 of 297 are
killed, 92.9 per cent, by the standard of `symbolic` and `numeric`; the other 21 have a reason each. Before
reading it is not 92 per cent: seed 16, drawn after that, gave 109 of 142 (108 of 141, as one was not counted at first).

Of the 33 that survived seed 16 22 are killed now, each by a test that states a law (asked of the files of these tests
alone, the mutated text in the place of the right one). So 131 of 142 are killed, 92.2 per cent, and the line "What
proves" and the table below are of this sample. The package had no hole. Of the functions where something false looked
as if it could pass, it could in these, and is seen: `_from_gaps` (angles of another chord), `holding` (a cycle in two
parts), `newton`, `shares` (a bound on the wrong side), `_edges` (walks by the last row left out), `_exits` (a
rounding), `torus` (a neutral saddle), `positive` (a radius that is negative on a part of the turn). Seen too, where the
same or less could be proved: `_impossible`, `strips`, `BelowStar.checks`, `region`, `trapping_region` (a factor covers
the ball), `in_polygon`, `claim_of`, `met`, `touching`, `Precision.step`, `Pinball`, and a text. The other 11 have
reasons: a ball about 0 added or taken off (`mean_value`), a sign that is 1 or -1 (`objection`), what is asked already
(`closed`), less proved (`cornered`), and steps, words, orders and borders. The measuring had a fault, which is mended:
a function traced to machine code ran its lines in one test, whichever came first, so tests that see a mistake in
`flown` or `newton` were not asked; now each test that is measured has it traced anew.

Seed 17, drawn from the rooms written since too, gave 115 of 145, few of them by tests of `make slow` alone: it is
laws that are missing, and not longer tests. Its 30 survivors are read. Nine are killed now by
`tests/verification/proofs/test_ends_and_last_pieces.py` (`_gap`, a last piece; `inverted`, what floats lose;
`complex_balls`; `_greatest`, a neighbour; `CommonBoundary.proved`; `Touching.clear`, a last flight; `_mapped`;
`clipped`; `_angles`). Of 16 the same or less is proved: a guess (`over_interval`, `strips`, `trapping_region`,
`Long.solved`), more digits (`judged`), a longer tube (`pair`), a count (`beyond`, `blocks`), a border that balls do not
meet (`_landed`, `inner` twice, `_inside`, `BrokenLine.images`), a product that would be negative (`_expands`), a word
that only a call or a power has (`evaluate`, `meaning`). Five were not settled by then; of `BasinEdge.checks`,
`_blocks` and both of `Course.step` tests have followed, and `cornered` is left. The line "What proves"
and the table below are still those of seed 16.

The samples 21b to 21d are of the second reader and of the rooms `global_dynamics`, `corner` and `manifolds` alone, with
what only searches there, and with tests as far as twelve seconds go. Of the last 30 survivors 19 change nothing that is
proved (a ball about 0 added or taken off, a guess, a budget, a wider enclosure), each with its reason. Of the 139
others 128 were killed before one was read, 92.0 per cent (86.3 to 95.5), and the 11 that were left are killed by tests
that were written for them. Of what could have let something false through, now seen: a saddle set of which more than
all points stay, an expansion by the upper end of a ball, a region whose walks lead outside, halves of a cell that leave
a part of it out, a chord judged free behind a wall, h-sets that meet a turn further, a law whose slope vanishes in the
last piece of its angles, a landing beyond the end of the arc. One of 21c is still not seen: in the blown-up doubling a
derivative with `v` for `-v`, which lies in the same ball. To write these laws showed one thing that was wrong: the
second reader had not looked at marks where a map is undefined on a table of the paper, and refuses them there now.

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
    text += f" {percent(first / asked)}: of all, {low} to {high} (Wilson's 95 per cent interval). The others were"
    return text + " killed later, by longer tests or by tests written for them after they were read."


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


def write_page(new: dict[str, dict], made_with: str, sample: dict) -> None:
    """Merges new figures into those that are kept, a line for each module and each sample, and writes the page."""
    modules = {path: entry for path, entry in (known()["modules"] | new).items() if (ROOT / path).is_file()}
    samples = {entry["seed"]: entry for entry in (*known()["samples"], *([sample] if sample["asked"] else []))}
    lines = [f" {json.dumps(path)}: {json.dumps(entry)}" for path, entry in sorted(modules.items())]
    drawn = ",\n".join(f" {json.dumps(entry)}" for _, entry in sorted(samples.items()))
    body = ",\n".join(lines)
    FIGURES.write_text(
        f'{{"made_with": {json.dumps(made_with)}, "samples": [\n{drawn}\n], "modules": {{\n{body}\n}}}}\n'
    )
    PAGE.write_text(page(known()))
