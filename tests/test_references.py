"""Citations have entries in docs/references.bib, all entries are complete and cited, and quotations are exact."""

import re
import tomllib
import unicodedata
from functools import cache
from itertools import chain
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
BIBLIOGRAPHY = ROOT / "docs" / "references.bib"
FOLDERS = ("docs", "symbolic", "numeric", "verification", "notebooks", "benchmarks", "tests")
READ = {".md", ".py", ".ipynb", ".j2", ".html", ".toml"}
APART = {ROOT / "docs" / "references.md", Path(__file__)}
CLAIMS = ROOT / "verification" / "paper" / "claims"
PRINTED = {path for path in CLAIMS.rglob("*") if path.suffix != ".py"}  # papers' own words, with their own citations
TEXTS = sorted(
    path
    for path in chain(*((ROOT / folder).rglob("*") for folder in FOLDERS), ROOT.glob("*.md"))
    if path.suffix in READ and "_build" not in path.parts and path not in PRINTED and path not in APART
)
YEAR = r"(?:1[6-9]|20)\d\d"
KEY = re.compile(rf"\[([A-Z][A-Za-z]+{YEAR}[a-z]?)\]")
ROLE = re.compile(r"\{cite:[a-z]+\}`([^`]+)`")
NAME = r"[A-ZÀ-Ý][A-Za-zÀ-ÿ'-]+"
WORDS = re.compile(  # Author and Author (1998), over the end of a line too
    rf"\b({NAME}(?:(?:,| and|, and)?\s(?:# )?{NAME})*(?:,? et al\.?)?),?\s(?:# )?\(?({YEAR})\b"
)
BRACKETED = re.compile(rf"(?<!\w)\(({YEAR})[a-z]?\)")  # and no call of a function
JOURNALS = re.compile(r"Phys\. Rev|Rev\. Mod|Math\. Phys|J\. Stat|Physica D|SIAM J|Trans\. A|\bdoi:|arXiv:")
NEEDED = {
    "article": {"author", "title", "journal", "volume", "pages", "year", "checked"},
    "book": {"author", "title", "publisher", "year", "checked"},
    "misc": {"author", "title", "year", "checked"},  # what no public page confirmed is left out
}


def named(path):
    return str(path.relative_to(ROOT))


def ascii_only(text):
    """A text whose accented letters, in LaTeX or Unicode, are replaced by plain ones.

    >>> ascii_only(r"Sz{\\'a}sz"), ascii_only("Bäcker")
    ('Szasz', 'Backer')
    """
    bare = re.sub(r"\\['\"`^~cvHn=.]\s*|[{}]", "", text.replace(r"\'{\i}", "i"))
    return unicodedata.normalize("NFKD", bare).encode("ascii", "ignore").decode()


def entries(text):
    """The kind and the fields of each entry, by key."""
    found = {}
    for kind, key, body in re.findall(r"^@(\w+)\{(\w+),\n(.*?)^\}", text, re.MULTILINE | re.DOTALL):
        assert key not in found, f"{key} is there twice"
        found[key] = kind, dict(re.findall(r"^ *(\w+) *= \{(.*)\},$", body, re.MULTILINE))
    return found


ENTRIES = entries(BIBLIOGRAPHY.read_text())


@cache
def surnames(key):
    return [ascii_only(author.split(",")[0]) for author in ENTRIES[key][1]["author"].split(" and ")]


def keys(text):
    """The keys that a text cites."""
    return set(KEY.findall(text)) | {key.strip() for some in ROLE.findall(text) for key in some.split(",")}


def by_an_author(name, year):
    """Whether an entry of that year has an author of that name."""
    bare = ascii_only(name.removesuffix("'s"))
    return any(entry[1]["year"] == year and bare in surnames(key) for key, entry in ENTRIES.items())


def by_these_authors(words, year):
    """Whether an entry of that year has exactly these authors, or the first of them before *et al.*"""
    names = re.findall(NAME, ascii_only(words))
    keys = {key for key, entry in ENTRIES.items() if entry[1]["year"] == year}
    return "".join(names) + year in keys or ("et al" in words and any(surnames(key)[0] == names[0] for key in keys))


def unknown(text):
    """Citations in a text without an entry: names with a year, and a bracketed year after no author of that year."""
    words = [found.group() for found in WORDS.finditer(text) if not by_these_authors(*found.groups())]
    before = {found: text[max(0, found.start() - 60) : found.start()] for found in BRACKETED.finditer(text)}
    alone = [
        here + found.group()
        for found, here in before.items()
        if not any(by_an_author(name, found[1]) for name in re.findall(NAME, here))
    ]
    return words + alone


@pytest.mark.slow
def test_every_citation_has_an_entry():
    for path in TEXTS:
        text = path.read_text()

        assert keys(text) <= set(ENTRIES), path
        assert unknown(text) == [], path


@pytest.mark.slow
def test_volumes_and_pages_stand_in_the_bibliography_alone():
    assert [path for path in TEXTS if JOURNALS.search(path.read_text())] == []


@pytest.mark.parametrize("key", ENTRIES)
def test_every_entry_is_complete_and_named_after_its_authors(key):
    kind, fields = ENTRIES[key]

    assert NEEDED[kind] <= set(fields)
    assert key == "".join(surnames(key)).replace(" ", "") + fields["year"]


def test_every_entry_is_cited():
    assert set(ENTRIES) - set().union(*(keys(path.read_text()) for path in TEXTS)) == set()


MODULE = re.compile(r"`((?:symbolic|numeric|verification)(?:\.[a-z_0-9]+)+)")


def exists(name):
    """Whether a dotted name is a module, or a name that its module defines or its room exports."""
    path = ROOT.joinpath(*name.split("."))
    if path.is_dir() or path.with_suffix(".py").is_file():
        return True
    home = path.parent / "__init__.pyi" if path.parent.is_dir() else path.parent.with_suffix(".py")
    if home.suffix == ".pyi":
        return re.search(rf"import .*\b{path.name}\b", home.read_text()) is not None
    return home.is_file() and re.search(rf"^(?:def |class )?{path.name}\b", home.read_text(), re.MULTILINE) is not None


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=named)
def test_a_module_that_a_page_names_exists(page):
    assert [name for name in MODULE.findall(page.read_text()) if not exists(name)] == []


def plain(text):
    """The letters and digits of a text, without TeX, in which a quotation can be searched."""
    return " ".join(re.findall(r"[a-z0-9]+", re.sub(r"\\[a-z]+|[`$]", " ", text.lower())))


def quotations():
    """Quotations of the paper on pages, each with its section: `"..." (section 6.5, caption)`."""
    for page in sorted((ROOT / "docs").rglob("*.md")):
        for words, section in re.findall(r'"([^"]+)"\s+\(section ([\d.]+|[A-C]\.\d)', page.read_text()):
            yield pytest.param(words, section, id=f"{page.stem}-{section}")


OWN = sorted((CLAIMS / "focusing").glob("*.toml"))


@pytest.mark.parametrize(("words", "section"), list(quotations()))
def test_a_quotation_is_from_the_section_that_the_page_names(words, section):
    claims = [claim for file in OWN for claim in tomllib.loads(file.read_text()).get("claim", [])]
    start = plain(words)[:30]
    sections = {claim["section"].split()[0] for claim in claims if start in plain(claim["quote"])}

    assert sections == {section}
