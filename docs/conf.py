"""Sphinx: `make docs` builds the pages into docs/_build."""

import re
import sys
from pathlib import Path

from docutils import nodes
from pybtex.plugin import register_plugin
from pybtex.style.formatting.plain import Style
from pybtex.style.labels import BaseLabelStyle

project = "Pinball billiards"
author = "The pinball-billiards authors"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinxcontrib.bibtex"]
source_suffix = {".md": "myst-nb", ".ipynb": "myst-nb"}
nb_execution_mode = "off"  # they are kept with what they show; the tests execute them
html_math_renderer = "mathml"
html_theme = "furo"
html_title = "Pinball billiards"
html_static_path = ["static", "../verification/paper/report/math.woff2"]  # the font of the reports' formulas
html_css_files = ["page.css"]
exclude_patterns = ["_build", "jupyter_execute"]  # what an earlier build has left is no page
myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 3
autodoc_typehints = "description"
autodoc_mock_imports = ["bokeh", "panel"]  # of the live table; pages are built without them
suppress_warnings = ["ref.python"]  # an annotation names a class without its module, and two rooms may have one
add_module_names = False
default_role = "code"
bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "keys"


class Keys(BaseLabelStyle):
    """Labels that are the keys, so that pages show what docstrings say."""

    def format_labels(self, sorted_entries):
        """Called by pybtex."""
        return [entry.key for entry in sorted_entries]


class Keyed(Style):
    """Entries as pybtex writes them, labelled with their keys."""

    default_label_style = Keys


register_plugin("pybtex.style.formatting", "keys", Keyed)


def plain(app, what, name, obj, options, lines):
    """Docstrings are plain text: a bar is a modulus, no substitution; `[Key]` names an entry of the bibliography."""
    lines[:] = [re.sub(r"\[([A-Z][A-Za-z]+\d{4})\]", r":cite:p:`\1`", line.replace("|", r"\|")) for line in lines]


def notebooks(app):
    """Puts the notebooks beside the pages."""
    there = Path(__file__).parent / "notebooks"
    there.mkdir(exist_ok=True)
    for notebook in (there.parents[1] / "notebooks").glob("*.ipynb"):
        (there / notebook.name).write_bytes(notebook.read_bytes())


def pictures(app):
    """Makes the pictures of the gallery that are missing, each from the code below it."""
    sys.path.insert(0, str(Path(__file__).parent))
    from gallery import make

    make([])


def typeset(visitor, node):
    """A formula as the reports typeset it, in MathML: no script and no network is needed to read it."""
    from verification.paper.report.mathml import mathml

    display = isinstance(node, nodes.math_block)
    formula = str(mathml(node.astext(), display))
    visitor.body.append(f'<div class="math" tabindex="0">{formula}</div>' if display else formula)
    raise nodes.SkipNode


NAMED = {  # what the theme leaves without a level, name or heading, in a role of old, or out of the keyboard's reach
    '<p class="caption" role="heading">': '<p class="caption" role="heading" aria-level="2">',
    '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="All pages">',
    '<aside class="toc-drawer">': '<aside class="toc-drawer" aria-label="On this page">',
    '<div class="content-icon-container">': '<div class="content-icon-container" role="region" aria-label="Page">',
    '<div class="table-wrapper ': '<div tabindex="0" class="table-wrapper ',
    "<pre>": '<pre tabindex="0">',
    'role="doc-biblioentry"': 'role="listitem"',
    '<div id="search-results">': '<h1>Search</h1><div role="region" aria-label="Results" id="search-results">',
}


TABLE, HEAD, ROW, CELL = (
    re.compile(pattern, re.DOTALL)
    for pattern in (
        r'<table class="docutils (.*?)</table>',
        r'<th class="head[^"]*">(.*?)</th>',
        r"<tr .*?</tr>",
        r"<td>(.*?)</td>",
    )
)
LONG_WORD = re.compile(r'(?<=<span class="pre">)[^<&]{25,}')  # a path, which may break at its parts
FOLDED, LONGEST = range(3, 6), 24  # columns: fewer fit a phone, more are numbers, which scroll; and rows


def foldable(found):
    """A table whose cells say what column they are in, so that a narrow screen can set them below each other."""
    table = LONG_WORD.sub(lambda word: re.sub(r"(?<=[/._])", "<wbr>", word[0]), found[0])
    heads = [plain_text(head) for head in HEAD.findall(table)]
    if len(heads) > FOLDED[-1] or table.count("<tr ") > LONGEST:
        return table
    if len(heads) < FOLDED[0]:
        return table.replace('class="docutils', 'class="wrapped docutils', 1)
    labelled = ROW.sub(lambda row: label_cells(row[0], heads), table)
    return labelled.replace('class="docutils', 'class="folded docutils', 1)


def label_cells(row, heads):
    """A row of a table, each cell with the head of its column; empty cells are marked."""
    labels = iter(heads)

    def labelled(cell):
        empty = "" if plain_text(cell[1]) else ' class="empty"'
        return f'<td data-label="{next(labels)}"{empty}>{cell[1]}</td>'

    return CELL.sub(labelled, row)


def plain_text(html):
    """What a piece of HTML says, as the value of an attribute."""
    return re.sub(r"<[^>]*>", "", html).strip().replace('"', "&quot;")


def accessible(app, exception):
    """Puts into the theme's pages what assistive technology and phones ask for; the reports beside them have it."""
    for path in Path(app.outdir).rglob("*.html"):
        page = path.read_text(encoding="utf-8")
        if "sidebar-drawer" in page:
            for bare, named in NAMED.items():
                page = page.replace(bare, named)
            page = TABLE.sub(foldable, page)
            path.write_text(page, encoding="utf-8")


def setup(app):
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (typeset, None), (typeset, None))
    app.connect("builder-inited", notebooks)
    app.connect("builder-inited", pictures)
    app.connect("autodoc-process-docstring", plain)
    app.connect("build-finished", accessible)
