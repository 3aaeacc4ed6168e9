"""No verdict depends on the words of a message: the judges' source files, checked as syntax trees."""

import ast
from collections.abc import Iterator

import pytest

from verification.paper.claims.folder import SHIPPED, paper

JUDGES = sorted(path.resolve() for folder in SHIPPED.glob("*/paper.toml") for path in paper(folder.parent).judges)
TEXTS = {"reason", "notes", "erratum", "evidence", "method", "derived"}  # fields that hold sentences
READERS = {"startswith", "endswith", "find", "rfind", "index", "rindex", "search", "match", "fullmatch"}
VERDICTS = {"shown", "answer"}  # findings from a decision


def called(node: ast.Call) -> str:
    """The name of the called function, without the part before its last dot."""
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def flat(node: ast.AST) -> bool:
    """Whether a node is a constant verdict: `True` or `Outcome.PROVED`. (A refutation needs a witness besides.)"""
    if isinstance(node, ast.Constant):
        return node.value is True
    outcome = isinstance(node, ast.Attribute) and node.attr == "PROVED"
    return outcome and ast.unparse(node.value).endswith("Outcome")


def asserted(tree: ast.AST) -> Iterator[ast.AST]:
    """Calls that make a finding with a constant outcome."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and called(node) in VERDICTS | {"Finding"}:
            given = [*node.args, *(keyword.value for keyword in node.keywords)]
            yield from (node for argument in given if flat(argument))


def compared(tree: ast.AST) -> Iterator[ast.AST]:
    """Decisions that depend on a sentence: a search in a text, or a comparison of a field that holds one."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and called(node) in READERS:
            yield from [] if getattr(node.func.value, "attr", "") == "id" else [node]  # a claim's name is no message
        if isinstance(node, ast.Compare):
            sides = [part for side in (node.left, *node.comparators) for part in ast.walk(side)]
            yield from (node for part in sides if isinstance(part, ast.Attribute) and part.attr in TEXTS)


def places(found: Iterator[ast.AST]) -> list[str]:
    return [f"line {node.lineno}: {ast.unparse(node)}" for node in found]


@pytest.mark.parametrize("path", JUDGES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_no_judge_writes_down_the_outcome_of_a_finding(path):
    assert places(asserted(ast.parse(path.read_text()))) == []


@pytest.mark.parametrize("path", JUDGES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_no_judge_decides_by_the_text_of_a_message(path):
    assert places(compared(ast.parse(path.read_text()))) == []


@pytest.mark.parametrize(
    "source",
    [
        'shown("so it is", True)',
        'answer(True, "so it is")',
        'answer(holds=True, reason="so it is")',
        'Finding(Outcome.PROVED, "so it is")',
        'judges.shown("so it is", True)',
        'Finding(signs.Outcome.PROVED, "so it is")',
    ],
)
def test_a_flat_assertion_is_seen(source):
    assert places(asserted(ast.parse(source)))


@pytest.mark.parametrize(
    "source",
    [
        'said.startswith("subcritical")',
        'found.notes["kind"] == "subcritical"',
        '"subcritical" in found.printed.reason',
        're.match("sub", said)',
    ],
)
def test_a_decision_by_words_is_seen(source):
    assert places(compared(ast.parse(source)))


@pytest.mark.parametrize("source", ['shown("six", count == 6)', "answer(found.certified, said)", "zero('', x - y)"])
def test_a_computed_finding_is_left_alone(source):
    tree = ast.parse(source)

    assert places(asserted(tree)) == places(compared(tree)) == []
