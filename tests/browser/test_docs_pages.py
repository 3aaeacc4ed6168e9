"""Every page that `make docs` built, on a desk and a phone, light and dark, as axe judges it."""

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

BUILT = Path(__file__).parents[2] / "docs" / "_build"
PHONE, DESK = {"width": 390, "height": 844}, {"width": 1400, "height": 900}


def pages():
    """The pages that Sphinx writes; the search with something found."""
    found = sorted(BUILT.rglob("*.html"))
    themed = [path for path in found if "sidebar-drawer" in path.read_text(encoding="utf-8")]
    asked = {path: "?q=cycle" if path.name == "search.html" else "" for path in themed}
    return {str(path.relative_to(BUILT)): path.as_uri() + query for path, query in asked.items()}


@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_every_page_of_the_docs_is_accessible_and_fits_its_window(chromium, size):
    assert pages(), "docs/_build has no page: make docs comes first"
    page = chromium.new_page(viewport=size)
    wrong = {}
    for name, url in pages().items():
        page.goto(url)
        if page.evaluate("document.documentElement.scrollWidth") > size["width"]:
            wrong[name] = "is wider than its window"
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            found = Axe().run(page)
            if found.violations_count:
                wrong[name, scheme] = found.generate_report()
    page.close()

    assert wrong == {}
