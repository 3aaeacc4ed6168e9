"""The report in a real browser: it shows, filters, prints, fits a phone, and is accessible."""

import pytest
from axe_playwright_python.sync_playwright import Axe

from verification.paper.report import report as claims
from verification.paper.report.page import Picture
from verification.paper.report.page import page as html

DOT = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010806000000"
    "1f15c4890000000d49444154789c63f8ffff3f0005fe02fea1399e180000000049454e44ae426082"
)
PHONE = {"width": 360, "height": 740}


@pytest.fixture(scope="session")
def report(tmp_path_factory):
    """The report on the symbolic claims about the ellipse and the egg's curvature."""
    results = [*claims.verify("ellipse.*"), *claims.verify("egg.curvature*"), *claims.verify("cuspless.monodromy")]
    path = tmp_path_factory.mktemp("report") / "report.html"
    pictures = [
        Picture("ellipse-slap", "The slap map of an ellipse.", "3.4 Slap billiard map of an elliptical table", DOT)
    ]
    path.write_text(html(results, {"python": "3"}, pictures), encoding="utf-8")
    return path.as_uri(), results


def shown(page):
    return page.locator("article:visible").count()


def test_every_claim_is_shown_with_its_formulas(page, report):
    url, results = report
    page.goto(url)

    assert shown(page) == len(results)
    matrix = page.locator("#ellipse\\.monodromy blockquote math mtable")
    assert matrix.bounding_box()["height"] > 30
    assert page.get_by_role("img", name="ellipse-slap").is_visible()


def test_filters_leave_the_claims_they_name(page, report):
    url, results = report
    page.goto(url)
    page.get_by_role("checkbox", name="confirmed").uncheck()

    expected = sum(result.verdict.value != "confirmed" for result in results)
    assert shown(page) == expected > 0
    assert page.get_by_role("status").inner_text() == f"{expected} of {len(results)} claims shown"
    assert page.locator("section.part:visible").count() < page.locator("section.part").count()


def test_words_are_looked_for_in_the_claims(page, report):
    url, _ = report
    page.goto(url)
    page.get_by_role("searchbox").fill("minor axis is stable")

    assert 0 < shown(page) < 5


def test_filters_work_from_the_keyboard(page, report):
    url, results = report
    page.goto(url)
    page.get_by_role("checkbox", name="corrected").focus()
    page.keyboard.press("Space")

    assert shown(page) == sum(result.verdict.value != "corrected" for result in results)
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.value") == "refuted"


def test_it_prints(page, report):
    url, _ = report
    page.goto(url)

    assert page.pdf(format="A4")[:5] == b"%PDF-"


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [PHONE, {"width": 1280, "height": 900}], ids=["phone", "desk"])
def test_it_fits_its_window_and_is_accessible(page, report, size, scheme):
    url, _ = report
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size(size)
    page.goto(url)

    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
