"""The documentation is true: its Python prints what it shows, its commands run, and all pages can be reached."""

import ast
import doctest
import importlib.util
import json
import re
import shlex
from pathlib import Path

import pytest
from matplotlib import image as images

from verification.app.cli import main

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
READ = sorted([*PAGES, *ROOT.glob("*.md"), *(ROOT / "benchmarks").glob("*.md")])
FOLDERS = ("symbolic", "numeric", "verification", "tests", "benchmarks", "docs", "notebooks")
PATHS = re.compile(rf"`((?:{'|'.join(FOLDERS)})/[\w./*]*)`")
PYTHON = [page for page in PAGES if ">>> " in page.read_text()]
COMMANDS = [
    pytest.param(page, block, id=f"{page.stem}-{number}")
    for page in PAGES
    for number, block in enumerate(re.findall(r"```console\n(.*?)```", page.read_text(), re.DOTALL))
]


def loaded(name):
    """A script of the docs folder, loaded as a module."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


ROOMS, GALLERY = loaded("rooms"), loaded("gallery")


def named(page):
    return page.stem


@pytest.mark.slow
@pytest.mark.parametrize("page", PYTHON, ids=named)
def test_python_on_a_page_gives_what_the_page_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = doctest.testfile(str(page), module_relative=False)

    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.slow
@pytest.mark.parametrize(("page", "block"), COMMANDS)
def test_commands_on_a_page_run(page, block, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, content in re.findall(r"Save this as `([\w.]+)`:\n\n```\w+\n(.*?)```", page.read_text(), re.DOTALL):
        Path(name).write_text(content)
    for line in (line for line in block.splitlines() if line.startswith("$ ")):  # the others are what was printed
        prompt, command, *arguments = shlex.split(line)

        assert (prompt, command) == ("$", "pinball")
        assert main(arguments) in (0, 1), capsys.readouterr().err


@pytest.mark.parametrize(
    ("page", "table", "verdicts"),
    [
        ("how_to/judge_a_paper", False, ["corrected", "confirmed", "supported"]),
        ("tutorial", True, ["confirmed", "corrected", "supported"]),
    ],
)
def test_the_paper_that_a_page_makes_is_judged_as_the_page_says(page, table, verdicts, tmp_path, monkeypatch, capsys):
    """The page's files, written where it says, print the lines that it shows; also with a table's file of its own."""
    monkeypatch.chdir(tmp_path)
    text = (DOCS / f"{page}.md").read_text()
    blocks = {kind: re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("toml", "python", "text")}
    if table:
        Path("stadium.toml").write_text(blocks["toml"].pop(0))
    Path("paper.toml").write_text(blocks["toml"][0])
    Path("judges.py").write_text("\n\n".join(block for block in blocks["python"] if ">>>" not in block))

    assert main(["verify", "--claims", str(tmp_path), "--report", "report"]) == 0
    told = capsys.readouterr().out
    shown = [line for line in told.splitlines() if ": " in line and "stadium." in line]
    (expected,) = (block.splitlines() for block in blocks["text"] if block.startswith("corrected"))
    assert len(shown) == len(expected) == 2
    assert all(line.startswith(wanted) for line, wanted in zip(shown, expected, strict=True))
    report = json.loads(Path("report", "report.json").read_text())
    assert [claim["verdict"] for claim in report["claims"]] == verdicts


def test_every_page_is_reached_from_the_index():
    for page in (page for page in PAGES if page.stem != "index"):
        above = page.parent.parent / f"{page.parent.name}.md"  # a room of the reference stands under its storey
        home = above if above.is_file() else DOCS / "index.md"
        entries = re.findall(r"^[A-Za-z_/0-9]+$", home.read_text(), re.MULTILINE)

        assert str(page.relative_to(home.parent).with_suffix("")) in entries, page


def test_links_between_pages_lead_somewhere():
    for page in (*PAGES, *ROOT.glob("*.md")):
        for link in re.findall(r"\]\(([^)#:]+\.\w+)\)", page.read_text()):
            assert (page.parent / link).is_file(), (page, link)


def test_files_that_a_page_names_are_there():
    for page in READ:
        for path in PATHS.findall(page.read_text()):
            assert list(ROOT.glob(path.rstrip("/"))), (page, path)


def test_every_picture_of_the_gallery_has_its_code_and_is_small():
    """`python docs/gallery.py` makes what is missing."""
    shown = re.findall(r"\]\(gallery/([\w-]+)\.webp\)", GALLERY.PAGE.read_text())
    there = {path.stem: path.stat().st_size for path in (DOCS / "gallery").iterdir()}

    assert sorted(shown) == sorted(GALLERY.entries()) == sorted(there)
    assert len(shown) >= 24
    assert max(there.values()) < 80_000
    assert sum(there.values()) < 2_000_000


@pytest.mark.slow
def test_a_picture_of_the_gallery_is_what_its_code_draws(tmp_path):
    """A picture that is cheap to draw, compared up to fonts and codecs, which differ in the last digit."""
    drawn = images.imread(GALLERY.made("ellipse", tmp_path)).astype(float)
    shown = images.imread(DOCS / "gallery" / "ellipse.webp").astype(float)

    assert drawn.shape == shown.shape
    assert abs(drawn - shown).mean() < 2.0


def test_the_picture_of_the_rooms_is_what_the_import_contracts_say():
    """If it fails, `python docs/rooms.py` draws the picture anew."""
    assert ROOMS.PICTURE.read_text() == ROOMS.picture()


def test_the_reference_has_every_module_and_nothing_else():
    """If it fails, `python docs/rooms.py` writes the reference anew."""
    assert {path: path.read_text() for path in ROOMS.REFERENCE.rglob("*.md")} == ROOMS.reference()


@pytest.mark.slow
def test_every_room_exports_what_other_rooms_use_of_it():
    """`python docs/rooms.py` writes the stubs from which a room's `__init__` loads names when they are first used."""
    stubs = ROOMS.stubs()

    assert {path: path.read_text() for path in stubs} == stubs
    assert [path for path in stubs if "attach_stub" not in path.with_suffix(".py").read_text()] == []


@pytest.mark.slow
def test_every_public_object_of_a_module_is_in_the_reference():
    """The reference lists only objects with a docstring, so that each public object needs one."""
    for module in (name for storey in ROOMS.orders()[""] for name in ROOMS.modules(storey)):
        body = ast.parse((ROOT / Path(*module.split("."))).with_suffix(".py").read_text()).body
        public = [node for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name[0] != "_"]

        assert [node.name for node in public if not ast.get_docstring(node)] == [], module
