"""Sphinx: `make docs` builds the pages into docs/_build."""

project = "Pinball billiards"
author = "The pinball-billiards authors"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
source_suffix = {".md": "markdown"}
html_theme = "furo"
html_title = "Pinball billiards"
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
autodoc_typehints = "description"
add_module_names = False
default_role = "code"


def plain(app, what, name, obj, options, lines):
    """Docstrings are plain text: a bar is a modulus, no substitution."""
    lines[:] = [line.replace("|", r"\|") for line in lines]


def setup(app):
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", plain)
