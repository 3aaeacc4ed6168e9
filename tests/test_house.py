"""Rules for the repository itself: the imports allowed in each layer, and constructions forbidden everywhere."""

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
LINES = 500


def named(path: Path) -> str:
    return str(path.relative_to(ROOT))


def calls(path: Path) -> set[str]:
    """The plain names of the functions that a file calls."""
    nodes = ast.walk(ast.parse(path.read_text()))
    return {node.func.id for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}


def test_the_symbolic_storey_holds_no_float():
    for path in (path for path in CODE if "symbolic" in path.parts):
        with path.open("rb") as file:
            numbers = [token for token in tokenize.tokenize(file.readline) if token.type == tokenize.NUMBER]

        assert [token for token in numbers if not isinstance(ast.literal_eval(token.string), int)] == [], path


@pytest.mark.slow
def test_no_text_is_evaluated():
    for path in CODE:
        called = calls(path)

        assert not called & READERS_OF_TEXT, path
        assert "exec" not in called or path.relative_to(ROOT) in EXECUTES, path


# NumPy's are compiled for several processors and differ in the last bit: `numeric.backends.elementary` has others.
DISPATCHED = {
    "tan", "arcsin", "arccos", "arctan", "arctan2", "exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "sinh",
    "cosh", "tanh", "arcsinh", "arccosh", "arctanh", "cbrt", "power", "angle", "geomspace", "logspace",
}  # fmt: skip
FEEDING = [path for path in CODE if "symbolic" not in path.parts and "measure" not in path.parts]  # reports and orbits


def attributes(path: Path) -> set[str]:
    """The names of NumPy that a file uses."""
    nodes = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)]
    return {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id == "np"}


def test_no_number_comes_from_a_function_whose_bits_depend_on_the_processor():
    assert [named(path) for path in FEEDING if attributes(path) & DISPATCHED] == []


def test_no_array_is_raised_to_a_power_but_the_square_and_the_root():
    """NumPy takes these by product and root, others by `power`, whose bits vary; number literals may have any power."""
    for path in (path for path in FEEDING if "numeric" in path.parts):
        nodes = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.BinOp)]
        powers = [(ast.unparse(node.left), ast.unparse(node.right)) for node in nodes if isinstance(node.op, ast.Pow)]

        assert [(x, n) for x, n in powers if n not in ("2", "0.5") and not re.fullmatch(r"-?[\d.]+", x)] == [], path


WRITERS = {Path("numeric/lowering/files.py"), Path("numeric/lowering/cache.py")}  # the latter's entries may be lost
WRITES = {"write_text", "write_bytes", "savefig", "save", "savez", "savez_compressed", "write_table", "tofile"}


def written_in_place(call: ast.Call) -> bool:
    """Whether a call writes to a file that it opens itself; a call with a `file` or `buffer` argument does not."""
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    given = [
        each.value for each in (*call.args, *(key.value for key in call.keywords)) if isinstance(each, ast.Constant)
    ]
    if name in ("open", "fdopen", "NamedTemporaryFile"):
        return any(isinstance(mode, str) and re.fullmatch(r"[rwaxbt+]*[wax+][rwaxbt+]*", mode) for mode in given)
    handed = any(isinstance(each, ast.Name) and each.id in ("file", "buffer") for each in call.args)
    return (name in WRITES or ast.unparse(call.func) == "json.dump") and not handed


def test_files_are_written_whole_or_not_at_all():
    """Only `numeric.lowering.files` opens files for writing."""
    for path in (path for path in CODE if path.relative_to(ROOT) not in WRITERS):
        found = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)]

        assert [ast.unparse(call) for call in found if written_in_place(call)] == [], path


def test_precision_is_never_set_for_others():
    sets = re.compile(r"\b(mp|iv|fp|ctx)\.(dps|prec)\s*[-+*]?=[^=]")
    assert [named(path) for path in CODE if sets.search(path.read_text())] == []


def test_a_file_holds_one_idea():
    assert [named(path) for path in CODE + TESTS if len(path.read_text().splitlines()) > LINES] == []


def test_a_room_holds_at_most_fifteen_files():
    files = Counter(path.parent for path in CODE if path.name != "__init__.py")
    assert {named(folder): count for folder, count in files.items() if count > 15} == {}


@pytest.mark.slow
def test_a_file_begins_with_what_it_is():
    texts = {named(path): path.read_text() for path in CODE}

    assert [name for name, text in texts.items() if text.strip() and not ast.get_docstring(ast.parse(text))] == []


@pytest.mark.slow
def test_nothing_speaks_of_how_the_work_was_shared_out():
    """Pages state facts and never mention tickets, which readers do not know."""
    said = re.compile(rf"\b{'iss' + 'ue'}s?\b", re.IGNORECASE)

    assert [named(path) for path in WORDS if said.search(path.read_text())] == []


def test_tests_are_no_packages():
    assert list((ROOT / "tests").rglob("__init__.py")) == []


def test_imports_only_go_down():
    linter = Path(sys.executable).parent / "lint-imports"
    done = subprocess.run([linter], cwd=ROOT, capture_output=True, text=True, check=False, timeout=600)

    assert done.returncode == 0, done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("question", [0, 1, 2])
def test_a_question_is_answered_by_twenty_one_files(question):
    """A question on a user's table, once cached, leads through at most 21 files from command line to answer."""
    spec = importlib.util.spec_from_file_location("walks", ROOT / "benchmarks" / "walks.py")
    assert spec
    assert spec.loader
    walks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(walks)
    cold, warm = walks.walked([*walks.WALKS.values()][question])

    assert 0 < len(warm) <= 21
    assert {*warm} <= {*cold}


def test_a_phase_point_is_given_in_one_order():
    """The order is `theta, phi, component`, as in `PinballMap`; only the module that makes states differs."""
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


@pytest.mark.slow
def test_the_readme_is_true():
    result = doctest.testfile(str(ROOT / "README.md"), module_relative=False)

    assert result.attempted >= 5
    assert result.failed == 0


def test_every_test_is_run_by_make_test_or_by_make_slow_and_ci_runs_both():
    recipes = dict(re.findall(r"^(\w+):.*\n\t(.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE))

    assert recipes["test"] == '$(PYTEST) -m "not slow"'
    assert recipes["slow"].startswith("$(PYTEST) -m slow ")
    assert {"make test", "make slow"} <= {*(ROOT / ".ci" / "run").read_text().splitlines()}


def test_the_commands_of_the_readme_exist():
    makefile = (ROOT / "Makefile").read_text()
    for target in re.findall(r"^    make (\w+)", (ROOT / "README.md").read_text(), re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)


def test_the_source_archive_holds_every_folder_that_is_kept():
    """It leaves out only files that git ignores, so `make test` and `make verify` run in the unpacked archive."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["sdist"]
    ignored = {line.strip("/").partition("/")[0] for line in (ROOT / ".gitignore").read_text().splitlines()}
    kept = {path.name for path in ROOT.iterdir() if path.is_dir() and path.name not in ignored | {".git"}}

    assert {f"/{name}" for name in kept if not name.endswith(".egg-info")} - {*settings["include"]} == set()
