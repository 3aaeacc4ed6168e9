"""The paper's sentences: each is quoted by a claim of its section, or has a reason for having no claim.

The paper is not in the repository. If `PINBALL_PAPER` names its source file, the list is compared with that.
"""

import os
import re
import tomllib
from pathlib import Path

from verification.paper.claims.folder import paper

LISTED = [
    (section, opens, fate)
    for path in paper().sentences
    for section, sentences in tomllib.loads(path.read_text(encoding="utf-8")).items()
    for opens, fate in sentences.items()
]
SECTIONS = {claim.id: claim.section.split()[0] for claim in paper().claims}
PAPER = os.environ.get("PINBALL_PAPER")
LEFT_OUT = r"(?<!\\)%.*\n?|\\label\{[^}]*\}|\\(?:begin|end)\{(?:equation|eqnarray)\}|\\fl\b|\\ams\{.*\}"


def flat(text):
    return " ".join(re.sub(LEFT_OUT, " ", text).split())


def test_a_sentence_is_prose_or_its_claims_quote_its_section():
    for section, opens, fate in LISTED:
        if isinstance(fate, list):
            assert {SECTIONS[name] for name in fate} == {section}, opens
        elif not isinstance(fate, str):
            assert fate.keys() == {"repeats"}, opens
            assert {*fate["repeats"]} <= SECTIONS.keys(), opens


def test_every_claim_stands_under_a_sentence():
    assert {name for *_, fate in LISTED if isinstance(fate, list) for name in fate} == SECTIONS.keys()


if PAPER:

    def test_the_list_is_in_the_order_of_the_paper_and_every_quote_is_in_it():
        text = flat(Path(PAPER).read_text(encoding="utf-8"))
        for found in ([opens for _, opens, _ in LISTED], *(claim.quote.split("...") for claim in paper().claims)):
            at = 0
            for part in map(flat, found):
                at = text.find(part, at)
                assert at >= 0, part
