"""The report in a real browser: it shows, filters, prints, fits a phone, and is accessible."""

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

from verification.paper.report import report as claims
from verification.paper.report.page import ReportFigure
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
        ReportFigure("ellipse-slap", "The slap map of an ellipse.", "3.4 Slap billiard map of an elliptical table", DOT)
    ]
    path.write_text(html(results, {"python": "3"}, pictures), encoding="utf-8")
    return path.as_uri(), results


def shown(page):
    return page.locator("article:visible").count()


def opened(page, url):
    page.goto(url)
    page.get_by_role("button", name="open or fold all").click()


def test_every_claim_is_shown_with_its_formulas(page, report):
    url, results = report
    opened(page, url)

    assert shown(page) == len(results)
    matrix = page.locator("#ellipse\\.monodromy h3 math mtable")
    assert matrix.bounding_box()["height"] > 30
    assert page.get_by_role("img", name="The slap map of an ellipse").is_visible()


def test_filters_leave_the_claims_they_name(page, report):
    url, results = report
    opened(page, url)
    page.get_by_role("checkbox", name="confirmed").uncheck()

    expected = sum(result.verdict.value != "confirmed" for result in results)
    assert shown(page) == expected > 0
    assert page.get_by_role("status").inner_text() == f"{expected} of {len(results)} claims shown"
    assert page.locator("details.part:visible").count() < page.locator("details.part").count()


def test_words_are_looked_for_in_the_claims(page, report):
    url, _ = report
    page.goto(url)
    page.get_by_role("searchbox").fill("minor axis is stable")

    assert 0 < shown(page) < len(report[1]) / 2


def test_a_letter_is_found_by_its_name_and_by_its_sign(page, report):
    url, results = report
    page.goto(url)
    counts = []
    for typed in ("lambda", "\N{GREEK SMALL LETTER LAMDA}", "lam", "LAMBDA"):
        page.get_by_role("searchbox").fill(typed)
        counts.append(shown(page))

    assert 0 < counts[0] < len(results)
    assert len(set(counts)) == 1


def test_a_link_opens_what_it_names_even_when_it_was_filtered_away(page, report):
    url, _ = report
    page.goto(url)
    page.get_by_role("searchbox").fill("nothing says this")
    assert shown(page) == 0
    page.evaluate("location.hash = 'ellipse.monodromy'")

    page.locator("#ellipse\\.monodromy").wait_for(state="visible")
    assert 0 <= page.locator("#ellipse\\.monodromy").bounding_box()["y"] < 400


def test_a_figure_is_enlarged_on_a_click_and_closed_by_escape(page, report):
    url, _ = report
    opened(page, url)
    page.get_by_role("button", name="Enlarge: The slap map").click()
    assert page.get_by_role("dialog").is_visible()
    page.keyboard.press("Escape")

    assert not page.get_by_role("dialog").is_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [PHONE, {"width": 1280, "height": 900}], ids=["phone", "desk"])
def test_it_fits_its_window_and_is_accessible(page, report, size, scheme):
    url, _ = report
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size(size)
    page.goto(url)

    page.get_by_role("button", name="open or fold all").click()
    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize("name", ["flower", "limacon", "stadium", "egg"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_reports_of_tables_are_accessible(page, name, scheme):
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size(PHONE)
    page.goto((Path(__file__).parents[2] / "docs" / "reports" / f"{name}.html").as_uri())

    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
