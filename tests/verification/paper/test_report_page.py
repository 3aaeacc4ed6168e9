"""The HTML and LaTeX forms of the report: complete, faithful, self-contained."""

import base64
import re
import tomllib
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import pytest

from verification.paper.claims.claim import Verdict
from verification.paper.claims.folder import paper
from verification.paper.figures.catalogue import pictures
from verification.paper.report import report as claims
from verification.paper.report.findings import GRADES, compared, escaped, findings, graded, letter, tables
from verification.paper.report.mathml import formula, formulas, mathml, prose, remark
from verification.paper.report.page import ReportFigure, page

VOID = {"meta", "input", "br", "img"}


@cache
def results():
    """Claims with each verdict that proofs give, with formulas, errata and values."""
    return [result for only in ("ellipse.P*", "ellipse.lambda_*", "circle.*") for result in claims.verify(only)]


@cache
def html():
    return page(results(), {"python": "3"})


class Reader(HTMLParser):
    """Checks that tags close in the order of opening, and collects the targets of references."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.sources = [], [], [], []

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids += [given["id"]] if "id" in given else []
        self.links += [given["href"]] if "href" in given else []
        self.sources += [given["src"]] if "src" in given else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        self.handle_endtag(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def read(text):
    reader = Reader()
    reader.feed(text)
    assert reader.open == []
    return reader


def test_the_page_is_well_formed_and_its_links_lead_somewhere():
    found = read(html())

    assert len(set(found.ids)) == len(found.ids)
    assert {link[1:] for link in found.links} <= set(found.ids)


def test_the_page_needs_no_network():
    found = read(page(results(), {}, [ReportFigure("x", "y", "7", b"z")]))

    assert all(link.startswith("#") for link in found.links)
    assert all(source.startswith("data:") for source in found.sources)
    assert not re.search(r"url\((?!data:)|@import|<link|<script src", html())


def test_every_claim_and_every_erratum_is_on_the_page():
    assert html().count("<article") == len(results())
    wrong = [r for r in results() if r.verdict.value in ("corrected", "refuted")]
    assert html().count('class="erratum') == len({r.erratum for r in wrong}) > 0
    assert all(html().count(f'href="#{r.id}"') >= 2 for r in wrong)  # at the erratum and at the claim itself


def test_every_erratum_of_the_paper_has_a_grade_and_every_finding_its_claims_and_its_figure():
    about = paper()
    document = tomllib.loads((about.folder / "findings.toml").read_text())
    known, listed = (
        {claim.id for claim in about.claims},
        [name for each in document["grades"].values() for name in each],
    )

    assert set(document["grades"]) == set(GRADES)
    assert len(listed) == len(set(listed))
    assert known.issuperset(listed)
    for each in document["finding"]:
        assert known.issuperset(each["claims"])
        assert each["figure"] in pictures()


def test_a_finding_is_not_told_while_one_of_its_claims_is_open():
    settled = {"ellipse.mu": "confirmed", "ellipse.lambda_minus": "confirmed", "egg.alpha_tilde": "confirmed"}
    judged = [replace(results()[0], id=name) for name in (*settled, "map.derivative_matrix")]
    doubtful = [*judged[:-1], replace(judged[-1], verdict=Verdict.OPEN)]

    assert len(findings(judged, paper())["holds"]) == 1
    assert findings(doubtful, paper())["holds"] == []


def test_digits_that_differ_are_marked_and_no_others():
    wrong = replace(results()[0], verdict=Verdict.CORRECTED, printed="0.372", derived="0.371235...")

    assert compared(wrong) == ("0.37<mark>2</mark>", "0.37<mark>1</mark>235\u2026")


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("zero for a**2 - 1 and so on", "a^{2} - 1"),
        ("so nu_+ + nu_- <= 0 there", r"\nu_{+} + \nu_{-} \leq 0"),
        ("|phi1| = lam*|eta|", r"\left|\varphi_{1}\right| = \lambda \, \left|\eta\right|"),
        ("has no root for a in (1, 1/10]", r"\left(1, \frac{1}{10}\right]"),
        ("(T0^2)' = 49/324 at both", r"\left(T_{0}^{2}\right)' = \frac{49}{324}"),
        ("below 9e-04*a", r"9 \cdot 10^{-4} \, a"),
        ("a = 2 (trace -2)", "a = 2"),
        ("with (T_0^2)'(s) > 1 there", r"\left(T_{\mathrm{0}}^{2}\right)'\left(s\right) > 1"),
        ("stable for every lam < 1, a focus above it", r"\lambda < 1"),
        ("for lam < 1, a and b", r"\lambda < 1,\; a"),
    ],
)
def test_a_formula_within_a_sentence_is_set_as_one(text, latex):
    assert [found for _, _, found in formulas(text)] == [latex]


def test_words_are_no_formulas():
    assert formulas("a cycle of period 4, or a strip; at the end (in the sense of 2.1), I see: it is a union") == []
    assert formulas("kappa''(0) < -1") == []  # the argument keeps its parentheses


def test_the_letter_has_each_substantial_erratum_and_is_balanced():
    text = letter(results(), paper())
    grave = graded(results(), paper())["substantial"]

    assert len(grave) > 0
    assert text.count(r"\item {[") == text.count(r"\item ") == sum(map(len, graded(results(), paper()).values()))
    assert text.count(" -- ") >= len(grave)  # between what is printed and what is true
    assert text.count("{") == text.count("}")
    assert text.count("$") % 2 == 0
    assert paper().title in text


@pytest.mark.parametrize(
    ("typed", "latex"),
    [
        ("it reads lambda*(lambda^2 + ...) for it", r"$\lambda$$\,$($\lambda^{2}$ + $\dots$)"),
        ("at lambda* and -0.5", r"$\lambda^*$ and $-$0.5"),
        ("should read 'near the cusp'", "read `near the cusp'"),
        ("a period-2 orbit", "period-2 orbit"),
    ],
)
def test_words_of_the_letter_are_set_as_they_are_meant(typed, latex):
    claim = next(result for result in results() if result.verdict is Verdict.CORRECTED)

    assert latex in letter([replace(claim, erratum=typed)], paper())


def test_a_certificate_is_offered_once_as_it_is_and_linked_from_each_claim_that_rests_on_it():
    one, two = (replace(results()[0], id=name) for name in ("egg.doubling.3", "egg.negative_exponents"))
    text = page([one, two, results()[1]], {"python": "3"})
    (held,) = re.findall(r'download="doubling-3.json" href="data:application/json;base64,([^"]*)"', text)
    (path,) = paper().certificates()[one.id]

    assert base64.b64decode(held) == path.read_bytes()
    assert text.count('<a href="#certificate-doubling-3">') == 2
    assert "<code>pinball check doubling-3.json</code>" in text
    assert 'id="certificates"' not in html()


def test_every_quotation_of_the_paper_is_set_whole():
    for claim in claims.catalogue():
        shown = prose(claim.quote)

        assert "\\" not in re.sub(r'alttext="[^"]*"', "", str(shown)), claim.id
        assert "$" not in shown, claim.id


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("-(a + b)*c", r"-\left(a + b\right) \, c"),
        ("a - (b - c)", r"a - \left(b - c\right)"),
        ("(a + b)^2/c", r"\frac{\left(a + b\right)^{2}}{c}"),
        ("(-a)^2", r"\left(-a\right)^{2}"),
        ("(a/b)^(1/2)", r"\left(\frac{a}{b}\right)^{1/2}"),
        ("a/b/c", r"\frac{\frac{a}{b}}{c}"),
        ("a*(b*c)", r"a \, \left(b \, c\right)"),
        ("2*3", r"2 \cdot 3"),
        ("0 <= lam < 1", r"0 \leq \lambda < 1"),
    ],
)
def test_parentheses_stand_where_the_formula_needs_them(text, latex):
    assert f'alttext="{latex.replace("<", "&lt;")}"' in str(formula(text))


def test_words_cannot_become_markup():
    assert "<script>" not in remark("<script>alert(1)</script>")
    assert "<script>" not in prose("it is <script> and $a<b$")
    assert "<b>" not in mathml("a <b> c")


def test_latex_tables_are_balanced_and_plain():
    text = tables(results())

    assert text.count(r"\begin{longtable}") == text.count(r"\end{longtable}") == 3
    bare = re.sub(r"\\[{}]", "", text)
    assert bare.count("{") == bare.count("}")
    assert not re.search(r"(?<!\\)[$#_^]", text.split("\n", 1)[1])


def test_every_character_that_latex_acts_on_is_escaped():
    assert escaped(r"\a{b}$&#_%~^") == (r"\textbackslash{}a\{b\}\$\&\#\_\%\textasciitilde{}\textasciicircum{}")
