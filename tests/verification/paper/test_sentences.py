"""Laws on the list of the paper's sentences: complete, in order, and each with a claim or a reason to have none.

The paper is no part of the repository. Where its source is at hand, `PINBALL_PAPER` names the file, and it is compared.
"""

import os
from dataclasses import replace
from pathlib import Path

import pytest

from verification.paper.claims.claim import (
    Claim,
    Sentence,
    _misquoted,
    caption,
    defects,
    differences,
    digest,
    split,
)
from verification.paper.claims.folder import paper
from verification.paper.report.report import catalogue

PAPER = os.environ.get("PINBALL_PAPER")

MADE_UP = r"""
\title{A title is no sentence}
\begin{abstract}
Circles are round. % not this. Nor this.
\end{abstract}
\section{Triangles}\label{sec:three}
A triangle, i.e.\ three sides, has
\begin{equation} \label{eq:sum}
\alpha + \beta + \gamma = \pi
\end{equation}
for its angles (Euclid.) It has $0.5$ of a square's
area; is that
so?

\begin{figure}
\subfigure[$a=1$]{\includegraphics[scale=0.9]{ }}
\caption{A triangle $T_{0}$. Its sides are black.}
\label{fig:triangle}
\end{figure}
\subsection{Names}
They have names
%
\begin{equation}
a, b, c
\end{equation}
Thus they differ.
\appendix
\section{Proofs}
None.
\section*{References}
Not this.
"""
SENTENCES = [
    ("Abstract", "Circles are round."),
    ("1", r"A triangle, i.e.\ three sides, has \alpha + \beta + \gamma = \pi for its angles (Euclid.)"),
    ("1", "It has $0.5$ of a square's area; is that so?"),
    ("1", "A triangle $T_{0}$."),
    ("1", "Its sides are black."),
    ("1.1", "They have names a, b, c"),
    ("1.1", "Thus they differ."),
    ("A", "None."),
]
CLAIMS = [
    Claim("t.sum", "1 Triangles", r"has \alpha + \beta + \gamma = \pi ... angles (Euclid.) It has $0.5$", "x", ""),
    Claim("t.names", "1.1 Names", "a, b, c", "x", ""),
]


def made_up() -> list[Sentence]:
    """The made-up text, listed as it should be."""
    fates = {1: {"claims": ("t.sum",)}, 2: {"claims": ("t.sum",)}, 3: {"repeats": ("t.sum",)}}
    fates |= {5: {"claims": ("t.names",)}}
    return [
        Sentence(section, text[:10], digest(text), **fates.get(n, {"prose": "a reason"}))
        for n, (section, text) in enumerate(SENTENCES)
    ]


def changed(n: int, **changes: object) -> list[Sentence]:
    listed = made_up()
    listed[n] = replace(listed[n], **changes)
    return listed


def test_a_text_is_split_at_its_full_stops_and_formulas_stay_in_their_sentence():
    assert list(split(MADE_UP)) == SENTENCES


def test_a_caption_ends_with_its_own_brace():
    assert caption(r"\caption{{\small a} and {b}.} c") == r"{\small a} and {b}."


def test_a_list_that_is_in_order_has_no_defect_and_no_difference():
    assert defects(made_up(), CLAIMS) == []
    assert differences(MADE_UP, made_up(), CLAIMS) == []


def test_a_digest_is_of_words_and_not_of_line_breaks():
    assert digest("a  b\nc % remark") == digest("a b c")
    assert digest("a b c") != digest("a b d")


@pytest.mark.parametrize("listed", [made_up()[:-1], made_up()[1:], [*made_up(), made_up()[0]]])
def test_a_sentence_too_few_or_too_many_is_a_difference(listed):
    assert differences(MADE_UP, listed, CLAIMS)


@pytest.mark.parametrize(
    ("old", "new"), [("round", "square"), ("black", "white"), ("Thus", "So"), ("= \\pi", "= \\tau")]
)
def test_a_sentence_that_reads_otherwise_is_a_difference(old, new):
    assert differences(MADE_UP.replace(old, new), made_up(), CLAIMS)


def test_two_sentences_in_each_other_s_place_are_a_difference():
    listed = made_up()
    listed[3], listed[4] = listed[4], listed[3]

    assert differences(MADE_UP, listed, CLAIMS)


@pytest.mark.parametrize(
    "quote", ["has no angles", r"$0.5$ ... has \alpha", r"\alpha + \beta + \gamma = \pi", "Its sides are black."]
)
def test_a_quote_must_stand_in_every_sentence_that_it_is_listed_under(quote):
    assert differences(MADE_UP, made_up(), [replace(CLAIMS[0], quote=quote), CLAIMS[1]])


@pytest.mark.parametrize(
    "listed",
    [
        changed(0, prose=""),
        changed(0, repeats=("t.sum",)),
        changed(3, repeats=("t.other",)),
        changed(5, claims=("t.other",)),
        changed(5, claims=("t.names", "t.sum")),
        changed(5, claims=(), prose="a reason"),
    ],
    ids=["no fate", "two fates", "unknown repeat", "unknown claim", "another section", "claim without sentence"],
)
def test_a_list_that_is_not_in_order_has_a_defect(listed):
    assert defects(listed, CLAIMS)


def test_every_sentence_of_the_paper_is_quoted_by_a_claim_or_is_prose_with_a_reason():
    assert defects(paper().inventory(), catalogue()) == []


if PAPER:

    def test_the_list_is_the_paper_s_sentences_in_order_and_every_quote_is_in_its_place():
        assert differences(Path(PAPER).read_text(encoding="utf-8"), paper().inventory(), catalogue()) == []


@pytest.mark.parametrize(
    ("quote", "complaint"),
    [
        ("Circles are round. ... have corners.", ""),
        ("Circles are round. Squares have corners.", ""),
        ("Circles are round.", "quotes nothing of 'Squares have corners.'"),
        ("have corners. ... Circles", "'Circles' is not in the sentences"),
        ("Circles are square. ... corners", "'Circles are square.' is not in the sentences"),
        ("Ellipses", "'Ellipses' is not in the sentences"),
    ],
)
def test_a_quote_is_in_its_sentences_in_their_order_and_has_a_piece_of_each(quote, complaint):
    texts = ["Circles are round.", "Ellipses are not.", "Squares have corners."]
    listed = [Sentence("1", text[:9], digest(text), claims=("one",) if k != 1 else ()) for k, text in enumerate(texts)]

    assert complaint in _misquoted(Claim("one", "1", quote, "identity", "0"), texts, listed)
    assert bool(complaint) is bool(_misquoted(Claim("one", "1", quote, "identity", "0"), texts, listed))
