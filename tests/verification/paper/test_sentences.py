"""The paper's sentences: each is quoted by a claim of its section, or has a reason for having no claim.

The paper is not in the repository. If `PINBALL_PAPER` names its source file, the list is compared with that.
"""

import os
import re
import tomllib
from pathlib import Path

import pytest

from verification.paper.claims.folder import paper

LISTED = [entry for path in paper().sentences for entry in tomllib.loads(path.read_text())["sentence"]]
SECTIONS = {claim.id: claim.section.split()[0] for claim in paper().claims}
PAPER = os.environ.get("PINBALL_PAPER")
LEFT_OUT = r"(?<!\\)%.*\n?|\\label\{[^}]*\}|\\(?:begin|end)\{(?:equation|eqnarray)\}|\\fl\b|\\ams\{.*\}"


def flat(text):
    return " ".join(re.sub(LEFT_OUT, " ", text).split())


@pytest.mark.parametrize("sentence", LISTED, ids=lambda sentence: f"{sentence['section']} {sentence['opens']}")
def test_a_sentence_has_one_fate_and_its_claims_quote_its_section(sentence):
    assert len(sentence.keys() & {"claims", "repeats", "prose"}) == 1
    assert {SECTIONS[name] for name in sentence.get("claims", ())} <= {sentence["section"]}
    assert {*sentence.get("repeats", ())} <= SECTIONS.keys()


def test_every_claim_stands_under_a_sentence():
    assert {name for sentence in LISTED for name in sentence.get("claims", ())} == SECTIONS.keys()


if PAPER:

    def test_the_list_is_in_the_order_of_the_paper_and_every_quote_is_in_it():
        text = flat(Path(PAPER).read_text(encoding="utf-8"))
        for found in ([each["opens"] for each in LISTED], *(claim.quote.split("...") for claim in paper().claims)):
            at = 0
            for part in map(flat, found):
                at = text.find(part, at)
                assert at >= 0, part
