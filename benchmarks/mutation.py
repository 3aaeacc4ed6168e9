"""Mutation testing: does a test notice when a line is wrong?

    python benchmarks/mutation.py cover                     once: which test runs which line of symbolic and numeric
    python benchmarks/mutation.py cover tests/symbolic/test_zero.py symbolic/expressions/signs.py  again
    python benchmarks/mutation.py run --only 'symbolic/*.py'                resumes; the smallest modules come first
    python benchmarks/mutation.py run --only 'symbolic/*.py' --near         a quick sieve: the module's own tests alone
    python benchmarks/mutation.py run --only symbolic/expressions/signs.py --again survived --budget 100  what passed it
    python benchmarks/mutation.py list --only symbolic/expressions/signs.py              survivors as they stand
    python benchmarks/mutation.py core --count 120 --seed 3 a sample of what proves; resumes; --only, --again as above
    python benchmarks/mutation.py page                      benchmarks/records/mutation.json and docs/mutation.md

`run` asks the tests that execute the mutated statement, quickest first, until their own seconds (as `cover` measured
them, under a tracer) add up to the budget; where a statement runs at import, all whose file imports its module. The
module's own tests come before all others. What survived is asked again, with a larger budget, by `--again survived`; a
mutant keeps its verdict when lines move. `--sample 0.2 --seed 1` takes a random part. A survivor needs a test, or a
reason in benchmarks/records/mutation.toml: `page` counts both, and keeps the figures of modules that this machine has
not run. State is kept in report/mutation/; nothing in the tree is written but record and page.
"""

import argparse
import ast
import json
import random
import subprocess
import sys
import time
from collections import Counter, defaultdict
from fnmatch import fnmatch
from functools import cache, partial
from importlib.metadata import version

import mutation_core
from mutation_mutants import ROOT, STATE, STOREYS, Mutant, mutants
from mutation_page import given, write_page
from mutation_server import append, ask, cover, file_of, in_forks, independent, mirrors, name_of, reached, warm

COVER, RESULTS = STATE / "cover.json", STATE / "results.jsonl"


def say(text: str) -> None:
    """One line, at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def modules(pattern: str) -> list[str]:
    """The files that match, smallest first."""
    files = [file for storey in STOREYS for file in (ROOT / storey).rglob("*.py")]
    named = {str(file.relative_to(ROOT)): file.stat().st_size for file in files}
    return sorted((path for path in named if fnmatch(path, pattern)), key=lambda path: named[path])


def results() -> dict[str, dict]:
    """The last verdict on each mutant that was ever asked."""
    lines = RESULTS.read_text().splitlines() if RESULTS.is_file() else []
    return {entry["key"]: entry for entry in map(json.loads, lines)}


@cache
def executed_late(path: str) -> frozenset[int]:
    """The lines inside of functions. All others run when the module is imported, be that in the middle of a test."""
    functions = [n for n in ast.walk(ast.parse((ROOT / path).read_text())) if isinstance(n, ast.FunctionDef)]
    return frozenset(line for f in functions for line in range(f.body[0].lineno, (f.end_lineno or 0) + 1))


class Plan:
    """Which tests to ask about a mutant."""

    def __init__(self):
        if not COVER.is_file():
            raise SystemExit("no coverage yet: python benchmarks/mutation.py cover")
        found = json.loads(COVER.read_text())
        self.seconds = {node: entry["seconds"] for node, entry in found.items()}
        self.lines = defaultdict(lambda: defaultdict(set))
        for node, entry in found.items():
            for path, lines in entry["lines"].items():
                for line in lines:
                    self.lines[path][line].add(node)

    def tests(self, mutant: Mutant, budget: float, near: bool) -> dict[str, float]:
        """Node ids with their seconds: as far as the budget goes, the own first, then the quickest.

        `near` takes the module's own tests alone, where it has some.
        """
        first, last = mutant.statement
        here = self.lines[mutant.path]
        running = set().union(*(here[line] for line in range(first, last + 1)))
        rest = set()
        if "" in running or not running or first not in executed_late(mutant.path):
            files = {file_of(node) for node in self.seconds if node}
            users = {file for file in files if name_of(mutant.path) in reached(name_of(file))}
            rest = {node for node in self.seconds if file_of(node) in users}
        own = mirrors(mutant.path, running | rest)
        chosen, total = {}, 0.0
        for group in (own,) if near and own else (own, running - own, rest - running - own):
            for node in sorted(group - {""}, key=self.seconds.__getitem__):
                total += self.seconds[node]
                if chosen and total > budget:
                    return chosen
                chosen[node] = self.seconds[node]
        return chosen


def covering(paths: list[str]) -> None:
    """Runs the tests named, in a process of their own, and merges what they cover."""
    STATE.mkdir(parents=True, exist_ok=True)

    def work() -> None:
        new = cover(paths)
        known = json.loads(COVER.read_text()) if COVER.is_file() else {}  # read late: another run may have written
        whole = set(paths)  # of files that are named, tests that are gone are forgotten
        old = {node: entry for node, entry in known.items() if file_of(node) not in whole}
        for path, lines in known.get("", {"lines": {}})["lines"].items():
            new[""]["lines"][path] = sorted({*new[""]["lines"][path], *lines})
        COVER.write_text(json.dumps(old | new))
        say(f"{len(new) - 1} tests, {sum(entry['seconds'] for entry in new.values()):.0f} s")

    in_forks([work], 1)


def wanted(path: str, known: dict[str, dict], args: argparse.Namespace) -> list[Mutant]:
    """The mutants of a module that are still to be asked; again only those for whose survival no reason is given."""
    found = mutants(path)
    if args.sample < 1:
        found = [mutant for mutant in found if random.Random(f"{args.seed} {mutant.key}").random() < args.sample]
    if not args.again:
        return [mutant for mutant in found if mutant.key not in known]
    again = ("survived", "uncovered", "timeout", "killed") if args.again == "all" else (args.again,)
    explained, open_ones = {place: counts.copy() for place, counts in given().items()}, []
    for mutant in (mutant for mutant in found if mutant.key in known and known[mutant.key]["status"] in again):
        left = explained.get((path, mutant.function), Counter())
        if left[mutant.operator] > 0:
            left[mutant.operator] -= 1
        else:
            open_ones.append(mutant)
    return open_ones


def run_module(path: str, chosen: list[Mutant], plan: Plan, args: argparse.Namespace) -> None:
    """In a server of its own: imports what does not depend on the module, then asks about each mutant."""
    for name in independent(name_of(path)):
        __import__(name)
    for number, mutant in enumerate(chosen, 1):
        tests = plan.tests(mutant, args.budget, args.near)
        status, test, seconds = ask(path, mutant.text, tests) if tests else ("uncovered", "", 0.0)
        known = {"key": mutant.key, "operator": mutant.operator, "status": status, "test": test, "seconds": seconds}
        append(RESULTS, known | {"tests": len(tests), "budget": args.budget})
        say(f"{time.strftime('%H:%M:%S')} {path}:{mutant.line} {number}/{len(chosen)} {status} {seconds:.1f} s {test}")


def running(args: argparse.Namespace) -> None:
    """Module by module, a fork server for each; at most as many at once as there are workers."""
    plan, known = Plan(), results()
    warm()
    found = ((path, wanted(path, known, args)) for path in modules(args.only))
    works = (partial(run_module, path, chosen, plan, args) for path, chosen in found if chosen)
    in_forks(works, args.workers)


def asked(args: argparse.Namespace) -> dict[str, tuple[int, list[tuple[Mutant, str]]]]:
    """For each module that was run: how many mutants there are, and those that were asked with their verdicts."""
    known = results()
    run = {key.partition(": ")[0] for key in known}
    every = {path: mutants(path) for path in modules(args.only) if path in run}
    pairs = {path: [(m, known[m.key]["status"]) for m in found if m.key in known] for path, found in every.items()}
    return {path: (len(every[path]), found) for path, found in pairs.items() if found}


def is_alive(status: str) -> bool:
    """Whether no test noticed."""
    return status in ("survived", "uncovered")


def figures(args: argparse.Namespace) -> dict[str, dict]:
    """What the record keeps of each module: counts, and how many survivors each function has of each operator."""
    head = ["git", "rev-parse", "--short", "HEAD"]
    at = subprocess.run(head, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    found: dict[str, dict] = {}
    for path, (total, pairs) in asked(args).items():
        count, alive = Counter(status for _, status in pairs), defaultdict(Counter)
        for mutant, status in pairs:
            alive[mutant.function][mutant.operator] += is_alive(status)
        kept = {name: +operators for name, operators in alive.items() if +operators}
        found[path] = {"at": at, "mutants": total, "asked": len(pairs), "killed": count["killed"]}
        found[path] |= {"timeout": count["timeout"], "alive": kept}
    return found


def listing(args: argparse.Namespace) -> None:
    """Counts and survivors, as text."""
    for path, (total, pairs) in asked(args).items():
        say(f"{path}: {total} mutants, {len(pairs)} asked, {sum(not is_alive(status) for _, status in pairs)} killed")
        for mutant in (mutant for mutant, status in pairs if is_alive(status)):
            place = f"{path}:{mutant.line} {mutant.function} {mutant.operator}"
            say(f"  {place}\n    - {mutant.old}\n    + {mutant.new}")


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=["cover", "run", "list", "core", "page"])
    parser.add_argument("paths", nargs="*", help="for cover: what pytest is given")
    parser.add_argument("--only", default="*", metavar="GLOB", help="modules, as symbolic/*.py")
    parser.add_argument("--sample", type=float, default=1.0, metavar="SHARE", help="a random share of the mutants")
    parser.add_argument("--seed", default="1", help="of the sample")
    parser.add_argument("--count", type=int, default=120, help="for core and page: how many of what proves")
    parser.add_argument("--part", default=mutation_core.ALL, choices=mutation_core.parts(), help="for core, list, page")
    parser.add_argument("--workers", type=int, default=1, help="modules, or for core groups, at once")
    parser.add_argument("--budget", type=float, default=15.0, help="seconds of tests asked about one mutant")
    parser.add_argument(
        "--longest", type=float, default=mutation_core.LONGEST, help="for core: seconds of a test asked"
    )
    parser.add_argument("--near", action="store_true", help="a first sieve: the module's own tests alone")
    parser.add_argument("--again", default="", choices=["", "survived", "uncovered", "timeout", "all"])
    args = parser.parse_args()
    if args.verb == "cover":
        covering(args.paths or ["tests/symbolic", "symbolic", "tests/numeric", "numeric"])
    elif args.verb == "run":
        running(args)
    elif args.verb == "list":
        listing(args)
        mutation_core.listing(args.count, args.seed, args.part)
    elif args.verb == "core":
        mutation_core.run(
            args.count, args.seed, args.part, args.budget, args.only, args.again, args.longest, args.workers
        )
    else:
        core = mutation_core.figures(args.count, args.seed, args.part)
        write_page(
            figures(args) | core, f"cosmic-ray {version('cosmic-ray')}", mutation_core.drawn(args.seed, core.values())
        )


if __name__ == "__main__":
    main()
