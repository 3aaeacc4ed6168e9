"""`docs/leave_out.md` agrees with the kernels and with a process's imports; memory and times are not compared."""

import pytest

from verification.measure.work.bench import module

PAGE = module("first_result")
LINES = [
    line
    for line in PAGE.PAGE.read_text().split(PAGE.COLD)[0].splitlines()
    if line.startswith("| ") and "scene" not in line
]


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_the_page_has_a_line_for_every_scene_law_and_question():
    assert [tuple(cells(line)[:3]) for line in LINES] == [
        (name, law, asked) for name in PAGE.TABLES for law in PAGE.LAWS for asked in PAGE.QUESTIONS
    ]


@pytest.mark.parametrize("line", LINES, ids=lambda line: " ".join(cells(line)[:3]))
def test_operations_and_state_are_as_on_the_page(line):
    name, law, asked, operations, share, state, *_ = cells(line)
    own, part, rows = PAGE.counted(name, law, asked)

    assert (str(own), f"{part:.0%}", str(rows)) == (operations, share, state)
    assert part <= 1


@pytest.mark.slow
@pytest.mark.parametrize("name", PAGE.TABLES)
def test_a_process_imports_the_modules_on_the_page_and_no_more(name, tmp_path):
    asked = {"circle": "end", "ellipse": "orbit"}.get(name, "exponents")
    line = next(line for line in LINES if line.startswith(f"| {name} | pinball | {asked} "))
    most, packages = cells(line)[6].split(": ")
    imported = PAGE.probe(PAGE.program(name, "pinball", asked), str(tmp_path))

    assert set(imported["tops"]) == {*packages.split(", "), "numeric"}
    assert len(imported["own"]) <= int(most)
