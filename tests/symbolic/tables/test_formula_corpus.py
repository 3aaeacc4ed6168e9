"""Texts found by a coverage-guided fuzzer (`benchmarks/fuzz.py`): each parses or is refused in one sentence."""

import json
from pathlib import Path

import pytest
from sympy import Expr

from symbolic.tables.formula import number, parse

TEXTS = json.loads((Path(__file__).parent.parent / "corpus.json").read_text())


def answered(reader, text):
    """The formula that `reader` makes of the text, or the sentence that refuses the text."""
    try:
        return reader(text)
    except ValueError as error:
        return str(error)


@pytest.mark.slow
@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
@pytest.mark.parametrize("reader", [parse, lambda text: number(text, "--alpha")], ids=["formula", "number"])
def test_what_was_found_by_fuzzing_is_a_formula_or_refused_in_one_line(text, reader):
    answer = answered(reader, text)

    assert isinstance(answer, Expr) or any(word in answer for word in ("accepted", "at most", "is not a real number"))
    assert "\n" not in str(answer)
