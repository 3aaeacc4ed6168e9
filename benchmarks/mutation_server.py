"""Which test runs which line, and what the tests say of a mutant: a fork for each, with nothing imported but libraries.

A fork starts without any module of the project that depends on the mutated one, so no `@cache` of an earlier run is
left; the mutated text enters through an import hook, and no file of the tree is written. Folders of temporary files and
of the project's cache are its own. Tests run quickest first, up to the first failure; each has three times its own
seconds and five more, and a test that is stopped counts as one that failed (status `timeout`).
"""

import ast
import gc
import importlib.abc
import importlib.util
import io
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterable
from contextlib import redirect_stdout, suppress
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path

import coverage
import pytest
from mutation_mutants import ROOT, STOREYS

LIBRARIES = ("sympy", "numpy", "scipy.optimize", "mpmath", "flint", "hypothesis.strategies", "doctest", "pytest")
QUIET = ["-q", "-x", "--tb=no", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:faulthandler"]
WAITING = 30  # seconds by the clock for one of processor, after which a test waits for something that does not come
MEMORY = 8 << 30  # bytes of address space; a mutant that asks for more fails


def function_of(node: str) -> str:
    """The node id without its parameters."""
    return node.partition("[")[0]


def file_of(node: str) -> str:
    """The file that holds a test."""
    return node.partition("::")[0]


def mirrors(path: str, nodes: Iterable[str]) -> set[str]:
    """The tests of the module's own: its doctests, and those in the files of the same name."""
    own = f"tests/{path.partition('/')[0]}/test_{Path(path).stem}"
    return {node for node in nodes if file_of(node) == path or node.startswith(own)}


def forget_kernels() -> None:
    """Kernels in memory and on disk, which an earlier test may have compiled: who uses one runs what writes it."""
    machine, folder = sys.modules.get("numeric.kernels.machine"), os.environ.get("PINBALL_CACHE")
    if machine is not None and folder:
        machine._loaded.clear()
        for kept in Path(folder).glob("kernel-*"):
            kept.unlink()


def forget_traced() -> None:
    """Traced functions, whose lines run only when they are written down: the next test that calls one does it anew."""
    traced = sys.modules.get("numeric.kernels.traced")
    for one in gc.get_objects() if traced else ():
        if type(one) is traced.Traced:
            one.run, one.outputs, one.written = None, 0, False


class Cover:
    """A pytest plugin: the lines of the project that each test executes, and its seconds; memos are emptied before."""

    def __init__(self):
        self.coverage = coverage.Coverage(data_file=None, config_file=False, source=[str(ROOT / s) for s in STOREYS])
        self.seconds = {}

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        for name, module in list(sys.modules.items()):
            if name.partition(".")[0] in STOREYS:
                for value in list(vars(module).values()):
                    with suppress(Exception):
                        value.cache_clear()
        forget_kernels()
        forget_traced()
        self.coverage.switch_context(item.nodeid)
        start = time.perf_counter()
        try:
            return (yield)
        finally:
            self.seconds[item.nodeid] = round(time.perf_counter() - start, 4)
            self.coverage.switch_context("")


def cover(paths: list[str]) -> dict:
    """Runs the tests once: node id -> seconds and, for each module, the lines executed."""
    plugin = Cover()
    plugin.coverage.start()
    status = pytest.main(["-q", "-p", "no:cacheprovider", "--assert=plain", *paths], plugins=[plugin])
    plugin.coverage.stop()
    if status != 0:
        raise SystemExit("mutation testing needs tests that pass")
    data = plugin.coverage.get_data()
    seconds = plugin.seconds | {"": 0.0}  # what an import executes has no test
    found = {node: {"seconds": own, "lines": defaultdict(list)} for node, own in seconds.items()}
    for file in data.measured_files():
        for line, nodes in data.contexts_by_lineno(file).items():
            for node in nodes:
                if node in found:
                    found[node]["lines"][str(Path(file).relative_to(ROOT))].append(line)
    return found


def name_of(path: str) -> str:
    """The module that a file holds; a script of `certificates` belongs to no package."""
    return path.removeprefix("certificates/").removesuffix(".py").replace("/", ".").removesuffix(".__init__")


@cache
def imports(module: str) -> frozenset[str]:
    """The project's modules that a module names in an import anywhere, and the packages that hold it."""
    file = ROOT / (module.replace(".", "/") + ".py")
    file = file if file.is_file() else ROOT / module.replace(".", "/") / "__init__.py"
    if not file.is_file():
        return frozenset()
    named = {module.rpartition(".")[0]}
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            named.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            named.update([node.module, *(f"{node.module}.{alias.name}" for alias in node.names)])
    return frozenset(name for name in named if name.partition(".")[0] in STOREYS)


@cache
def reached(module: str) -> frozenset[str]:
    """All that comes with a module, itself included."""
    found, open_ends = {module}, [module]
    while open_ends:
        new = imports(open_ends.pop()) - found
        found |= new
        open_ends += new
    return frozenset(found)


def independent(module: str) -> list[str]:
    """The modules of the lowest storey that may be imported before the fork: they never see the mutated one."""
    names = [name_of(str(file.relative_to(ROOT))) for file in sorted((ROOT / "symbolic").glob("*.py"))]
    return [name for name in names if module not in reached(name)]


class Mutated(SourceFileLoader, importlib.abc.MetaPathFinder):
    """Imports one module from a text in place of its file."""

    def __init__(self, path: str, text: str):
        super().__init__(name_of(path), str(ROOT / path))
        self.mutated = text

    def find_spec(self, name, path=None, target=None):
        """The module's specification, with this loader; None for any other module."""
        return importlib.util.spec_from_file_location(name, self.path, loader=self) if name == self.name else None

    def get_code(self, name):
        """The mutated text, compiled; no bytecode is read or kept."""
        return compile(self.mutated, self.path, "exec")


class Chosen:
    """Pytest plugin: only the chosen tests, quickest first, each with its time; the one that runs is written down."""

    def __init__(self, seconds: dict[str, float], report: Path, keep: bool):
        self.seconds, self.report, self.keep = seconds, report, keep
        self.functions = {function_of(node): value for node, value in seconds.items()}

    def pytest_sessionstart(self):
        from hypothesis import Phase, settings

        settings.register_profile("mutation", settings(), phases=(Phase.explicit, Phase.generate), database=None)
        settings.load_profile("mutation")  # a counterexample kills; a small one is not looked for

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items):
        here = {item.nodeid for item in items}
        gone = {function_of(node) for node in self.seconds if node not in here}  # parameters that the mutant renamed
        items[:] = [item for item in items if item.nodeid in self.seconds or function_of(item.nodeid) in gone]
        items.sort(key=lambda item: self.own(item.nodeid))

    def own(self, node: str) -> float:
        return self.seconds.get(node, self.functions[function_of(node)])

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        limit(3 * self.own(item.nodeid) + 5, self.keep)
        self.report.write_text(item.nodeid)
        return (yield)


def limit(seconds: float, of_processor: bool) -> None:
    """Stops this process after so many seconds: by the clock, or of processor, and then far later by the clock."""
    signal.setitimer(signal.ITIMER_PROF, seconds if of_processor else 0.0)
    signal.setitimer(signal.ITIMER_REAL, WAITING * seconds if of_processor else seconds)


def judge(path: str, text: str, seconds: dict[str, float], folder: Path, keep: bool) -> None:
    """In the fork: the tests on the mutant; exits with pytest's status. `keep` leaves the cache where it is."""
    os.setsid()
    null = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(null, stream)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    tempfile.tempdir = os.environ["TMPDIR"] = str(folder)
    if not keep:
        os.environ["PINBALL_CACHE"] = str(folder / "cache")
    limit(60, keep)  # for imports and collection
    status = 1
    try:
        if path:
            sys.meta_path.insert(0, Mutated(path, text))
            importlib.import_module(name_of(path))
        own = mirrors(path, seconds)
        for stage in (own, seconds.keys() - own):  # to collect the tests of all other files takes a second
            if stage:
                limit(60, keep)  # and not what the last test of the stage before has left
                files = sorted({file_of(node) for node in stage})
                chosen = Chosen({node: seconds[node] for node in stage}, folder / "test", keep)
                status = int(pytest.main([*QUIET, *files], plugins=[chosen]))
                if status:
                    break
    finally:
        os._exit(status)


def ask(path: str, text: str, seconds: dict[str, float], keep: bool = False) -> tuple[str, str, float]:
    """What the tests say of a mutant (survived, killed, timeout), the test that said it, and the seconds it took.

    `keep` is for mutants of what writes nothing into the cache of kernels: they may share it. Their tests' seconds are
    of processor, so that what else the machine does stops none.
    """
    folder, start = Path(tempfile.mkdtemp(prefix="mutant-")), time.perf_counter()
    child = os.fork()
    if not child:
        judge(path, text, seconds, folder, keep)
    _, how = os.waitpid(child, 0)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)  # what its tests may have started
    test = (folder / "test").read_text() if (folder / "test").is_file() else "import"
    shutil.rmtree(folder, ignore_errors=True)
    status = "killed"
    if os.WIFEXITED(how):
        status = {0: "survived", 5: "uncovered"}.get(os.WEXITSTATUS(how), "killed")
    elif os.WTERMSIG(how) in (signal.SIGALRM, signal.SIGPROF):
        status = "timeout"
    return status, "" if status in ("survived", "uncovered") else test, round(time.perf_counter() - start, 2)


def warm() -> None:
    """Imports the libraries, and lets SymPy and pytest import what they import late."""
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    for name in LIBRARIES:
        importlib.import_module(name)
    from sympy import Symbol, cos, factor, integrate, latex, simplify, sin, solve

    x = Symbol("x", real=True)
    _ = simplify(sin(x) ** 2 + cos(x) ** 2), factor(x**2 - 1), latex(x / 2), solve(x**2 - 2, x), integrate(cos(x), x)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "test_nothing.py").write_text("def test_nothing():\n    '''>>> 1\n    1\n    '''\n")
        with redirect_stdout(io.StringIO()):
            pytest.main([*QUIET, "--doctest-modules", "--rootdir", folder, "-c", os.devnull, folder])
    gc.collect()
    gc.freeze()


def in_fork(work) -> int:
    """Runs a function in a process of its own; its id."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    status = 1
    try:
        work()
        status = 0
    finally:
        if status:
            import traceback

            traceback.print_exc()
        sys.stdout.flush()
        os._exit(status)


def in_forks(works: Iterable[Callable[[], None]], workers: int) -> None:
    """Runs functions in processes of their own, so many at once: where one ends the next begins."""
    busy = 0
    for work in works:
        if busy == workers:
            os.wait()
            busy -= 1
        in_fork(work)
        busy += 1
    for _ in range(busy):
        os.wait()


def append(file: Path, entry: dict) -> None:
    """One line more, at once."""
    with file.open("a") as out:
        out.write(json.dumps(entry) + "\n")
