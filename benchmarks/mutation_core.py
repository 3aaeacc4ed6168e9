"""Mutants of what proves: the modules that say *certified*, with the mistakes that could let something false through.

What is asked of `symbolic` and `numeric` line by line is asked here of a sample, for proofs are slow. The modules and
the tests that guard them are in benchmarks/records/mutation_core.toml. A process for each group runs its tests once,
on the package as it is: that measures which test executes which line and how long it takes, and fills the memos of
`symbolic` and `numeric`, which stay. Then each mutant has a fork in which no module of `verification` is left, so that
none remembers the unmutated one. What survives is asked the tests of `make slow` that execute its statement and
take no longer than half a minute, before anybody reads it.

Nothing false can come of a budget, of a count of boxes, of the bits that a ball is rounded to, of what is told of
progress, or of a candidate that a proof then checks (`proposes`, in the same file): these have no mutants here.

The sample is drawn by a seed, of a part or of all, from each module in proportion to its mutants. Of 400 the first 200
are those of a sample of 200, so that a run may be cut short and taken up again with a larger count.
"""

import ast
import hashlib
import json
import os
import subprocess
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import redirect_stdout
from fnmatch import fnmatch
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import coverage
import pytest
from mutation_mutants import ROOT, STATE, Mutant, changed, function_at, statements
from mutation_server import QUIET, append, ask, file_of, forget_traced, in_forks, warm

CORE = ROOT / "benchmarks" / "records" / "mutation_core.toml"
RESULTS = STATE / "core.jsonl"
SLOW = ROOT / "tests" / "slow.txt"
LONGEST, DEAREST = 1.5, 20.0  # seconds, by slow.txt: what `make test` runs, and all parameters of a test together
PATIENT, PATIENCE = 30.0, 4.0  # seconds of a test of `make slow` that a survivor is asked, and budgets that they have
NOTICED = ("killed", "timeout")
COUNTS = {"budget", "spent", "boxes"}  # how long a proof may take, and has taken
HARMLESS = {"tick", "bits_of", "slope_bits"}  # calls that tell of progress, or say how many bits are rounded to
ALL = "all"  # parts
LARGE = 16  # a whole number beyond is a budget, a precision, a size: one more proves the same
BINARY = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.Pow: ("**", "*")}
BINARY |= {ast.BitOr: ("|", "&"), ast.BitAnd: ("&", "|")}
COMPARISON = {
    ast.Lt: ("<", "<=", ">="),
    ast.LtE: ("<=", "<", ">"),
    ast.Gt: (">", ">=", "<="),
    ast.GtE: (">=", ">", "<"),
}
COMPARISON |= {ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"), ast.IsNot: ("is not", "is")}
COMPARISON |= {ast.In: ("in", "not in"), ast.NotIn: ("not in", "in")}
OPPOSITES = (
    ("any", "all"), ("min", "max"), ("minimum", "maximum"), ("lower", "upper"), ("abs_lower", "abs_upper"),
    ("floor", "ceil"), ("logical_and", "logical_or"), ("contains", "overlaps"),
)  # fmt: skip
OPPOSITE = {one: other for pair in OPPOSITES for one, other in (pair, pair[::-1])} | {"contains_interior": "contains"}


class Group(NamedTuple):
    """Modules, the test files that guard them, and the part of what proves that they belong to."""

    modules: list[str]
    tests: list[str]
    part: str = "core"


@cache
def groups() -> list[Group]:
    """What proves, and its guards."""
    return [Group(**entry) for entry in tomllib.loads(CORE.read_text())["group"]]


def parts() -> list[str]:
    """The names of the parts, and of all together."""
    return [ALL, *dict.fromkeys(group.part for group in groups())]


@cache
def proposing() -> dict[str, list[str]]:
    """The functions of each module that only propose what a proof then checks; `Class.*` are all of a class."""
    found: dict[str, list[str]] = {}
    for entry in tomllib.loads(CORE.read_text())["proposes"]:
        found.setdefault(entry["module"], []).extend(entry["functions"])
    return found


class Text:
    """A source as bytes, in which the places of a syntax tree are found and written over."""

    def __init__(self, source: str):
        self.whole, self.starts = source.encode(), [0]
        for line in self.whole.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def first(self, node: ast.expr) -> int:
        """Where a node begins."""
        return self.starts[node.lineno - 1] + node.col_offset

    def last(self, node: ast.expr) -> int:
        """Where it ends."""
        return self.starts[node.end_lineno - 1] + node.end_col_offset

    def spliced(self, first: int, last: int, by: str) -> str:
        """The source with another text between two places."""
        return (self.whole[:first] + by.encode() + self.whole[last:]).decode()

    def replaced(self, node: ast.expr, by: str) -> str:
        """The source with another text for a node."""
        return self.spliced(self.first(node), self.last(node), by)

    def between(self, left: ast.expr, right: ast.expr, old: str, new: str) -> str:
        """The source with another operator between two operands."""
        first, last = self.last(left), self.first(right)
        return self.spliced(first, last, self.whole[first:last].decode().replace(old, new, 1))


def uncounted(node: ast.AST) -> bool:
    """Whether a node counts the work, bounds it, tells of it, or says how many bits are rounded to."""
    if isinstance(node, ast.Call):
        return ast.unparse(node.func) in HARMLESS
    named = map(ast.unparse, ast.iter_child_nodes(node)) if isinstance(node, ast.AugAssign | ast.Compare) else ()
    return bool(COUNTS & set(named))


def harmless(tree: ast.Module) -> Iterator[ast.AST]:
    """What no proof hangs on: texts of errors, annotations, memos, `strict` of a zip, budgets, precisions, progress."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise | ast.JoinedStr):
            yield node
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield from node.decorator_list
            if node.name.startswith(("__repr", "_repr")):
                yield node
            if isinstance(node, ast.FunctionDef) and node.returns:
                yield node.returns
        elif isinstance(node, ast.arg | ast.AnnAssign) and node.annotation:
            yield node.annotation
        elif uncounted(node):
            yield node
        elif isinstance(node, ast.If) and all(isinstance(x, ast.Expr) and uncounted(x.value) for x in node.body):
            yield node.test  # when it is told of progress
        elif isinstance(node, ast.arguments):
            named = [*node.posonlyargs, *node.args][::-1]
            pairs = [
                *zip(named, node.defaults[::-1], strict=False),
                *zip(node.kwonlyargs, node.kw_defaults, strict=True),
            ]
            yield from (default for arg, default in pairs if default and arg.arg in COUNTS)
        elif (
            getattr(node, "arg", "") in ("strict", "repr")
            or ast.unparse(getattr(node, "test", ast.Pass())) == "TYPE_CHECKING"
        ):
            yield node
    for node in tree.body:  # of the module itself
        if isinstance(node, ast.Assign):
            yield node


def changes(source: str) -> Iterator[tuple[str, int, str]]:
    """Each mistake that could let something false through: its kind, its line and the mutated text."""
    tree, text = ast.parse(source), Text(source)
    quiet = {id(inner) for node in harmless(tree) for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) not in quiet and hasattr(node, "lineno"):
            for kind, mutated in mistakes(node, text):
                yield kind, node.lineno, mutated


def mistakes(node: ast.AST, text: Text) -> Iterator[tuple[str, str]]:
    """Those of one node of the syntax tree."""
    if isinstance(node, ast.BinOp) and type(node.op) in BINARY:
        old, new = BINARY[type(node.op)]
        if ast.unparse(node.right) != "arb(0)":  # which makes a ball of a number, added or taken away
            yield "Arithmetic", text.between(node.left, node.right, old, new)
    elif isinstance(node, ast.Compare):
        for (left, right), op in zip(pairwise([node.left, *node.comparators]), node.ops, strict=True):
            old, *others = COMPARISON[type(op)]
            for new in others:
                yield "Comparison", text.between(left, right, old, new)
    elif isinstance(node, ast.BoolOp):
        yield from conditions(node, text)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
        yield "Sign", text.replaced(node, f"({ast.unparse(node.operand)})")
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield "Truth", text.replaced(node, str(not node.value))
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        if not (isinstance(node.value, int) and node.value > LARGE):
            yield "Number", text.replaced(node, repr(node.value + 1))
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        if not isinstance(node.test, ast.Compare | ast.BoolOp | ast.UnaryOp):  # those have mutants of their own
            yield "Condition", text.replaced(node.test, f"not ({ast.unparse(node.test)})")
        if isinstance(node, ast.If) and not node.orelse and isinstance(node.body[-1], ast.Return | ast.Continue):
            yield "Condition", text.replaced(node.test, "False")
    elif isinstance(node, ast.For):
        yield "Loop", text.replaced(node.iter, "()")
    elif isinstance(node, ast.Name) and node.id in OPPOSITE:
        yield "Opposite", text.replaced(node, OPPOSITE[node.id])
    elif isinstance(node, ast.Attribute) and node.attr in OPPOSITE:
        yield "Opposite", text.spliced(text.last(node) - len(node.attr), text.last(node), OPPOSITE[node.attr])


def conditions(node: ast.BoolOp, text: Text) -> Iterator[tuple[str, str]]:
    """`or` for `and`, and each operand left out."""
    other = ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values)
    yield "Condition", text.replaced(node, f"({ast.unparse(other)})")
    for left in node.values:
        rest = [value for value in node.values if value is not left]
        yield "Condition", text.replaced(node, f"({ast.unparse(ast.BoolOp(node.op, rest) if rest[1:] else rest[0])})")


@cache
def source_of(path: str) -> str:
    """A module's text, read once: a run outlives changes of the tree."""
    return (ROOT / path).read_text()


class Change(NamedTuple):
    """A mutant that is not yet made: the `count`th of its kind in a function."""

    path: str
    kind: str
    function: str
    count: int
    line: int
    text: str

    @property
    def key(self) -> str:
        """A name that does not move when lines above are added or taken away."""
        return f"{self.path}: {self.function}: {self.kind} {self.count}"

    def made(self) -> Mutant:
        """The mutant, with the lines that differ and the statement that they belong to."""
        source = source_of(self.path)
        old, new = changed(source, self.text)
        around = [span for span in statements(ast.parse(source)) if span[0] <= self.line <= span[1]]
        span = min(around, key=lambda span: span[1] - span[0])
        return Mutant(self.path, self.kind, self.function, self.line, old, new, self.count, span, self.text)


@cache
def population(path: str) -> list[Change]:
    """All mutants of a module that proves, in the order of its lines."""
    source = source_of(path)
    tree, counts, places = ast.parse(source), Counter(), {}
    found, left_out = [], proposing().get(path, ())
    for kind, line, text in sorted(changes(source), key=lambda change: change[1]):
        function = places.setdefault(line, function_at(tree, line))
        if any(fnmatch(function, name) for name in left_out):
            continue
        found.append(Change(path, kind, function, counts[function, kind], line, text))
        counts[function, kind] += 1
    return found


def rank(mutant: Change, seed: str) -> str:
    """The place of a mutant in the random order."""
    return hashlib.sha256(f"{seed} {mutant.key}".encode()).hexdigest()


def sample(count: int, seed: str, part: str) -> dict[str, list[Change]]:
    """A share of the mutants of each module of a part, together about `count`."""
    every = {path: population(path) for group in groups() if part in (ALL, group.part) for path in group.modules}
    total = sum(map(len, every.values()))
    return {
        path: sorted(found, key=lambda mutant: rank(mutant, seed))[: max(1, round(count * len(found) / total))]
        for path, found in every.items()
    }


class Guards:
    """A pytest plugin: which test executes which line of the modules, and its seconds of processor.

    Its tests take `longest` seconds at most, and longer than `above` where that is not 0.
    """

    def __init__(self, group: Group, longest: float = LONGEST, above: float = 0.0):
        self.longest, self.above = longest, above
        self.coverage = coverage.Coverage(
            data_file=None, config_file=False, include=[str(ROOT / path) for path in group.modules]
        )
        self.seconds: dict[str, float] = {}
        lines = SLOW.read_text(encoding="utf-8").splitlines()
        self.listed = {name: float(seconds) for seconds, name in (line.split() for line in lines)}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items):
        wanted = [item for item in items if not self.slow(item.nodeid, self.longest)]
        items[:] = [item for item in wanted if not self.above or self.slow(item.nodeid, self.above)]

    def slow(self, node, seconds):
        """Whether a test takes longer: the list has the seconds of all its parameters together."""
        name, bracket, _ = node.partition("[")
        return self.listed.get(name, 0.0) > (max(DEAREST, seconds) if bracket else seconds)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        forget_traced()
        self.coverage.switch_context(item.nodeid)
        start = time.process_time()
        try:
            return (yield)
        finally:
            self.seconds[item.nodeid] = time.process_time() - start
            self.coverage.switch_context("")


def forget() -> None:
    """Takes away every module that might know a mutated one; those of the storeys below stay, with their memos."""
    scripts = str(ROOT / "certificates"), str(ROOT / "tests")
    for name, file in [(name, getattr(module, "__file__", None) or "") for name, module in sys.modules.items()]:
        if name.partition(".")[0] in ("verification", "tests") or file.startswith(scripts):
            del sys.modules[name]


def measured(
    group: Group, longest: float, above: float = 0.0
) -> tuple[dict[str, float], dict[tuple[str, int], set[str]]]:
    """The guards' seconds, and which of them execute a line: found by running them, which is then forgotten."""
    start = time.perf_counter()
    plugin = Guards(group, longest, above)
    plugin.coverage.start()
    files = [*group.tests, *(path for path in group.modules if path.startswith("verification/"))]
    quiet = [option for option in QUIET if option != "--tb=no"]
    with Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
        status = pytest.main([*quiet, *files], plugins=[plugin])
    plugin.coverage.stop()
    if status not in (0, pytest.ExitCode.NO_TESTS_COLLECTED):
        raise SystemExit(f"mutation testing needs tests that pass: {group.tests}")
    told = f"{len(plugin.seconds)} tests in {time.perf_counter() - start:.0f} s guard {', '.join(group.modules)}"
    print(told, flush=True)  # noqa: T201
    forget()
    data, lines = plugin.coverage.get_data(), {}
    for file in data.measured_files():
        path = str(Path(file).relative_to(ROOT))
        for line, nodes in data.contexts_by_lineno(file).items():
            lines[path, line] = set(nodes)
    return {node: spent for node, spent in plugin.seconds.items() if spent <= 2 * longest}, lines  # coverage takes time


def guards(mutant: Mutant, seconds: dict[str, float], lines: dict, budget: float) -> dict[str, float]:
    """The tests to be asked, quickest first, as far as the budget goes: those that execute the mutated statement.

    What runs at import is not theirs: of such a statement those are asked that run any line of the module. The other
    tests of their files come after them, for what is kept for a file (a fixture, a memo) was made in the first test
    that asked for it; in the fork it is made anew, so they have the time of that one.
    """
    first, last = mutant.statement
    running = set().union(*(lines.get((mutant.path, line), set()) for line in range(first, last + 1)))
    if "" in running:
        running = set().union(*(nodes for (path, _), nodes in lines.items() if path == mutant.path))
    running &= seconds.keys()
    dearest: dict[str, float] = {}
    for node in running:
        dearest[file_of(node)] = max(dearest.get(file_of(node), 0.0), seconds[node])
    beside = {node for node in seconds if file_of(node) in dearest} - running
    chosen: dict[str, float] = {}
    for some in (running, beside):  # each as far as the budget goes
        total = 0.0
        for node in sorted(some, key=seconds.__getitem__):
            total += seconds[node]
            if chosen and total > budget:
                break
            chosen[node] = seconds[node] if some is running else max(seconds[node], dearest[file_of(node)])
    return chosen


def serve(group: Group, wanted: list[Change], budget: float, longest: float) -> None:
    """Asks the guards of a group about each mutant, and slow ones about survivors; writes the verdicts down."""
    survived = {}
    for change, entry in asked(wanted, *measured(group, longest), budget):
        if entry["status"] in NOTICED or longest >= PATIENT:
            append(RESULTS, entry)
        else:
            survived[change] = entry
    if survived:
        for change, entry in asked(survived, *measured(group, PATIENT, longest), PATIENCE * budget):
            append(RESULTS, survived[change] if entry["status"] == "uncovered" else entry)


def asked(
    wanted: Collection[Change], seconds: dict[str, float], lines: dict, budget: float
) -> Iterator[tuple[Change, dict]]:
    """Each mutant with what the record keeps of it."""
    for number, change in enumerate(wanted, 1):
        mutant = change.made()
        tests = guards(mutant, seconds, lines, budget)
        status, test, spent = ask(mutant.path, mutant.text, tests, keep=True) if tests else ("uncovered", "", 0.0)
        place = f"{mutant.path}:{mutant.line} {mutant.operator}"
        print(f"{time.strftime('%H:%M:%S')} {number}/{len(wanted)} {status} {spent:.1f} s {place} {test}", flush=True)  # noqa: T201
        entry = {"key": change.key, "operator": mutant.operator, "status": status, "test": test, "seconds": spent}
        yield change, entry | {"tests": len(tests), "budget": budget}


def run(count: int, seed: str, part: str, budget: float, only: str, again: str, longest: float, workers: int) -> None:
    """Asks about what is not known of the sample, group by group; or again about what has the verdict `again`.

    Asked are tests of at most `longest` seconds, as far as a budget of seconds goes; `workers` groups at once.
    """
    known = results()
    os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
    os.environ["PINBALL_CACHE"] = str(STATE / "kernels")  # of float64: no module that is mutated writes there
    drawn = sample(count, seed, part)
    warm()
    works = []
    for group in groups():
        found = [mutant for path in group.modules if fnmatch(path, only) for mutant in drawn.get(path, ())]
        wanted = [m for m in found if (known.get(m.key, {"status": ""})["status"] == again)]
        if wanted:
            wanted.sort(key=lambda mutant: rank(mutant, seed))
            works.append(partial(serve, group, wanted, budget, longest))
    in_forks(works, workers)


def figures(count: int, seed: str, part: str) -> dict[str, dict]:
    """What the record keeps of each module: those asked, those noticed at first and now, and survivors by function."""
    head = ["git", "rev-parse", "--short", "HEAD"]
    at = subprocess.run(head, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    first, known = results(last=False), results()
    found = {}
    for path, drawn in sample(count, seed, part).items():
        asked = [change for change in drawn if change.key in known]
        if asked:
            status = Counter(known[change.key]["status"] for change in asked)
            noticed = sum(first[change.key]["status"] in NOTICED for change in asked)
            alive = [change for change in asked if known[change.key]["status"] not in NOTICED]
            kept = {c.function: Counter(other.kind for other in alive if other.function == c.function) for c in alive}
            found[path] = {"at": at, "mutants": len(population(path)), "asked": len(asked), "first": noticed}
            found[path] |= {"killed": status["killed"], "timeout": status["timeout"], "alive": kept}
    return found


def drawn(seed: str, figures: Collection[dict]) -> dict[str, str | int]:
    """What the record keeps of a sample: how many of all were asked, and killed before a survivor was read."""
    asked, total, unread = (sum(entry[key] for entry in figures) for key in ("asked", "mutants", "first"))
    return {
        "seed": seed,
        "asked": asked,
        "of": total,
        "unread": unread,
        "at": max((e["at"] for e in figures), default=""),
    }


def listing(count: int, seed: str, part: str) -> None:
    """The survivors, as text."""
    known = results()
    for path, drawn in sample(count, seed, part).items():
        for change in drawn:
            if known.get(change.key, {"status": "killed"})["status"] not in NOTICED:
                mutant = change.made()
                place = f"{path}:{change.line} {change.function} {change.kind} {known[change.key]['status']}"
                print(f"{place}\n    - {mutant.old}\n    + {mutant.new}")  # noqa: T201


def results(last: bool = True) -> dict[str, dict]:
    """The last verdict on each mutant that was ever asked, or the first."""
    lines = RESULTS.read_text().splitlines() if RESULTS.is_file() else []
    return {entry["key"]: entry for entry in map(json.loads, lines if last else reversed(lines))}
