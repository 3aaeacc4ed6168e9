"""The documentation is true: its Python gives what it shows, its commands run, its pages are all reached."""

import doctest
import importlib.util
import re
import shlex
from pathlib import Path

import pytest

from verification.app.shell.cli import main

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


spec = importlib.util.spec_from_file_location("rooms", DOCS / "rooms.py")
ROOMS = importlib.util.module_from_spec(spec)
spec.loader.exec_module(ROOMS)


def named(page):
    return page.stem


@pytest.mark.parametrize("page", PYTHON, ids=named)
def test_python_on_a_page_gives_what_the_page_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = doctest.testfile(str(page), module_relative=False)

    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize(("page", "block"), COMMANDS)
def test_commands_on_a_page_run(page, block, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for line in (line for line in block.splitlines() if line.startswith("$ ")):  # the others are what was printed
        prompt, command, *arguments = shlex.split(line)

        assert (prompt, command) == ("$", "pinball")
        assert main(arguments) in (0, 1), capsys.readouterr().err


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_every_page_is_reached_from_the_index(page):
    entries = re.findall(r"^[A-Za-z_/0-9]+$", (DOCS / "index.md").read_text(), re.MULTILINE)

    assert page.stem == "index" or str(page.relative_to(DOCS).with_suffix("")) in entries


@pytest.mark.parametrize("page", sorted([*PAGES, *ROOT.glob("*.md")]), ids=named)
def test_links_between_pages_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)#:]+\.\w+)\)", page.read_text()):
        assert (page.parent / link).is_file(), link


@pytest.mark.parametrize("page", READ, ids=named)
def test_files_that_a_page_names_are_there(page):
    for path in PATHS.findall(page.read_text()):
        assert list(ROOT.glob(path.rstrip("/"))), path


def test_the_picture_of_the_rooms_is_what_the_import_contracts_say():
    """`python docs/rooms.py` draws it anew."""
    assert ROOMS.PICTURE.read_text() == ROOMS.picture()
