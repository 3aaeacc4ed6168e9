"""Laws on the repository itself: what each storey may hold, and what nothing may do."""

import ast
import doctest
import importlib.util
import re
import subprocess
import sys
import tokenize
import tomllib
from collections import Counter
from itertools import chain
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).parent.parent
STOREYS = ("symbolic", "numeric", "verification")
CODE = sorted(path for storey in STOREYS for path in (ROOT / storey).rglob("*.py"))
FOLDERS = ("docs", "notebooks", "benchmarks", "tests", *STOREYS)
WORDS = sorted(
    path
    for path in chain(*((ROOT / folder).rglob("*") for folder in FOLDERS), ROOT.glob("*"))
    if path.suffix in {".md", ".py", ".ipynb", ".toml", ".j2", ".html", ".bib", ".cff"} and "_build" not in path.parts
)
TESTS = sorted(path for path in (ROOT / "tests").rglob("*.py") if "golden" not in path.parts)
READERS_OF_TEXT = {"eval", "sympify", "parse_expr", "__import__"}
EXECUTES = {Path("symbolic/expressions/text.py")}  # compiles what it has written itself
LINES = 400


def named(path: Path) -> str:
    return str(path.relative_to(ROOT))


def calls(path: Path) -> set[str]:
    """The plain names that a file calls."""
    nodes = ast.walk(ast.parse(path.read_text()))
    return {node.func.id for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}


@pytest.mark.parametrize("path", [path for path in CODE if "symbolic" in path.parts], ids=named)
def test_the_symbolic_storey_holds_no_float(path):
    with path.open("rb") as file:
        numbers = [token for token in tokenize.tokenize(file.readline) if token.type == tokenize.NUMBER]

    assert [token for token in numbers if not isinstance(ast.literal_eval(token.string), int)] == []


@pytest.mark.parametrize("path", CODE, ids=named)
def test_no_text_is_evaluated(path):
    assert not calls(path) & READERS_OF_TEXT
    assert "exec" not in calls(path) or path.relative_to(ROOT) in EXECUTES


# NumPy's are compiled for several processors and differ in the last bit: `numeric.backends.elementary` has others.
DISPATCHED = {
    "tan", "arcsin", "arccos", "arctan", "arctan2", "exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "sinh",
    "cosh", "tanh", "arcsinh", "arccosh", "arctanh", "cbrt", "power", "angle", "geomspace", "logspace",
}  # fmt: skip
FEEDING = [path for path in CODE if "symbolic" not in path.parts and "measure" not in path.parts]  # reports and orbits


def attributes(path: Path) -> set[str]:
    """What a file takes from NumPy by name."""
    nodes = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)]
    return {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id == "np"}


@pytest.mark.parametrize("path", FEEDING, ids=named)
def test_no_number_comes_from_a_function_whose_bits_depend_on_the_processor(path):
    assert not attributes(path) & DISPATCHED


@pytest.mark.parametrize("path", [path for path in FEEDING if "numeric" in path.parts], ids=named)
def test_no_array_is_raised_to_a_power_but_the_square_and_the_root(path):
    """NumPy has these as a product and a square root; other powers of arrays are its `power`. Literals have any."""
    nodes = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.BinOp)]
    powers = [(ast.unparse(node.left), ast.unparse(node.right)) for node in nodes if isinstance(node.op, ast.Pow)]

    assert [(x, n) for x, n in powers if n not in ("2", "0.5") and not re.fullmatch(r"-?[\d.]+", x)] == []


@pytest.mark.parametrize("path", CODE, ids=named)
def test_precision_is_never_set_for_others(path):
    assert not re.search(r"\b(mp|iv|fp|ctx)\.(dps|prec)\s*[-+*]?=[^=]", path.read_text())


@pytest.mark.parametrize("path", CODE + TESTS, ids=named)
def test_a_file_holds_one_idea(path):
    assert len(path.read_text().splitlines()) <= LINES


def test_a_room_holds_at_most_fifteen_files():
    assert {named(folder): count for folder, count in Counter(path.parent for path in CODE).items() if count > 15} == {}


@pytest.mark.parametrize("path", CODE, ids=named)
def test_a_file_begins_with_what_it_is(path):
    text = path.read_text()

    assert not text.strip() or ast.get_docstring(ast.parse(text))


@pytest.mark.parametrize("path", WORDS, ids=named)
def test_nothing_speaks_of_how_the_work_was_shared_out(path):
    """Readers know no tickets: a page says what is so, not who asked for it."""
    assert re.findall(rf"\b{'iss' + 'ue'}s?\b", path.read_text(), re.IGNORECASE) == []


def test_tests_are_no_packages():
    assert list((ROOT / "tests").rglob("__init__.py")) == []


def test_imports_only_go_down():
    linter = Path(sys.executable).parent / "lint-imports"
    done = subprocess.run([linter], cwd=ROOT, capture_output=True, text=True, check=False, timeout=600)

    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("question", [0, 1, 2])
def test_a_question_is_answered_by_twenty_files(question):
    """A reader who follows one from the command line to its answer opens no more, once a table of one's own is kept."""
    spec = importlib.util.spec_from_file_location("walks", ROOT / "benchmarks" / "walks.py")
    assert spec
    assert spec.loader
    walks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(walks)
    cold, warm = walks.walked([*walks.WALKS.values()][question])

    assert 0 < len(warm) <= 20
    assert {*warm} <= {*cold}


def test_a_phase_point_is_given_in_one_order():
    """`theta, phi, component`, as `PinballMap` takes them; states are made from a place and angles."""
    states = ROOT / "numeric" / "pinball" / "coordinates.py"
    for path in CODE:
        functions = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef)]
        for node in functions if path != states else ():
            names = [each.arg for each in node.args.args if each.arg in ("theta", "phi", "component")]
            if {"theta", "phi"} <= {*names}:
                assert names == ["theta", "phi", "component"][: len(names)], f"{path}: {node.name}"


def test_dependencies_have_lower_bounds_only():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    own = re.compile(rf"{project['name']}\[[a-z,]+\]")  # extras that bring other extras
    for requirement in chain(project["dependencies"], *project["optional-dependencies"].values()):
        assert own.fullmatch(requirement) or re.fullmatch(r"[a-z0-9-]+>=[\d.]+", requirement)


def test_the_readme_is_true():
    result = doctest.testfile(str(ROOT / "README.md"), module_relative=False)

    assert result.attempted >= 5
    assert result.failed == 0


def test_every_test_is_run_by_make_test_or_by_make_slow_and_a_quick_one_by_make_quick_too(request):
    """`python benchmarks/slow_tests.py` writes the list; a few may have another name since."""
    levels = request.config.pluginmanager.get_plugin(str(ROOT / "tests" / "conftest.py"))
    listed = [name.split("::") for name in levels.SECONDS]
    text = {path: (ROOT / path).read_text() for path, _ in listed if (ROOT / path).is_file()}
    there = [name for path, name in listed if name.rpartition(".")[2] in text.get(path, "")]
    assert len(there) > 0.8 * len(listed)

    for name in [*levels.SECONDS, "tests/test_house.py::test_that_is_not_listed"]:
        assert levels.marks(name) in (["quick"], [], ["slow"])

    recipes = dict(re.findall(r"^(\w+):.*\n\t(.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE))
    marked = {"quick": "quick", "test": '"not slow"', "slow": "slow"}
    assert {name: recipes[name] for name in marked} == {name: f"$(PYTEST) -m {mark}" for name, mark in marked.items()}
    assert {"make test", "make slow"} <= {*(ROOT / ".ci" / "run").read_text().splitlines()}


def test_a_file_is_left_unread_only_where_no_test_of_it_is_asked_for(request):
    levels = request.config.pluginmanager.get_plugin(str(ROOT / "tests" / "conftest.py"))
    options = {level: SimpleNamespace(getoption=lambda _, level=level: level) for level in levels.LEVELS}
    for path in TESTS:
        tree = ast.parse(path.read_text())
        names = [node.name for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]
        held = {mark for name in names for mark in levels.marks(f"{named(path)}::{name}")}
        for level, options_of in options.items():
            left = levels.pytest_ignore_collect(path, options_of)
            assert not (left and level in held), f"{named(path)} holds a {level} test"


def test_the_commands_of_the_readme_exist():
    makefile = (ROOT / "Makefile").read_text()
    for target in re.findall(r"^    make (\w+)", (ROOT / "README.md").read_text(), re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)


def test_the_source_archive_holds_every_folder_that_is_kept():
    """What is left out is what git leaves out; from the unpacked archive `make test` and `make verify` run."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["sdist"]
    ignored = {line.strip("/").partition("/")[0] for line in (ROOT / ".gitignore").read_text().splitlines()}
    kept = {path.name for path in ROOT.iterdir() if path.is_dir() and path.name not in ignored | {".git"}}

    assert {f"/{name}" for name in kept if not name.endswith(".egg-info")} - {*settings["include"]} == set()
