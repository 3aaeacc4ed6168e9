"""Accessibility of the pages that `make docs` builds, on desktop and phone, light and dark, by axe.

Of the generated reference and the index a few pages represent all: axe takes minutes over the long ones.
"""

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

BUILT = Path(__file__).parents[2] / "docs" / "_build"
GENERATED = 6  # of the pages of the reference, the shortest
SCHEMES = {"light": {}, "dark": {"runOnly": {"type": "rule", "values": ["color-contrast"]}}}  # only colours change
PHONE, DESK = {"width": 390, "height": 844}, {"width": 1400, "height": 900}


def pages():
    """The pages that Sphinx writes, and the search with a result."""
    found = sorted(BUILT.rglob("*.html"))
    themed = [path for path in found if "sidebar-drawer" in path.read_text(encoding="utf-8")]
    made = [path for path in themed if path.name == "genindex.html" or (BUILT / "reference") in path.parents]
    themed = [path for path in themed if path not in sorted(made, key=lambda path: path.stat().st_size)[GENERATED:]]
    asked = {path: "?q=cycle" if path.name == "search.html" else "" for path in themed}
    return {str(path.relative_to(BUILT)): path.as_uri() + query for path, query in asked.items()}


@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_pages_of_the_docs_are_accessible_and_fit_their_window(chromium, size):
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


@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_the_kept_reports_fit_their_window(chromium, size):
    page, wide = chromium.new_page(viewport=size), {}
    for path in sorted((BUILT.parent / "reports").glob("*.html")):
        page.goto(path.as_uri())
        wide[path.name] = page.evaluate("document.documentElement.scrollWidth")
    page.close()

    assert set(wide.values()) == {size["width"]}
