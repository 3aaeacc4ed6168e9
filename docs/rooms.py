"""Draws the rooms of the package from the import contracts, and lists their modules: `python docs/rooms.py`.

It writes docs/figures/rooms.svg and the pages of docs/reference. The contracts in pyproject.toml are what `make lint`
enforces, so picture and pages cannot say anything else. The words beside a room are the first sentence of its package.
"""

import ast
import re
import sys
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PICTURE, REFERENCE = ROOT / "docs" / "figures" / "rooms.svg", ROOT / "docs" / "reference"
SHOWN = ("members:", "member-order: bysource")
WIDTH, LEFT, LINE, GAP, INSET = 760, 6, 23, 6, 12
LETTER, BOLD = 6.4, 9.0  # pixels, of a wide face
STYLE = """
text { font: 13px system-ui, sans-serif; fill: #1f2328; }
.name { font-weight: 600; }
.said { fill: #57606a; }
rect { fill: #f6f8fa; stroke: #d0d7de; }
.storey { fill: #ffffff; stroke: #57606a; }
@media (prefers-color-scheme: dark) {
  text { fill: #e6edf3; } .said { fill: #9198a1; } rect { fill: #161b22; stroke: #3d444d; }
  .storey { fill: #0d1117; stroke: #9198a1; }
}
"""


def orders() -> dict[str, list[str]]:
    """The rooms of each package, from the top down, as the contracts have them; the storeys under the empty name."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    layers = [contract for contract in settings["tool"]["importlinter"]["contracts"] if contract["type"] == "layers"]
    return {contract.get("containers", [""])[0]: contract["layers"] for contract in layers}


def question(package: str) -> str:
    """The first sentence of a package's docstring."""
    folder = ROOT / Path(*package.split("."))
    path = folder / "__init__.py" if folder.is_dir() else folder.with_suffix(".py")  # a room may be one module
    text = path.read_text(encoding="utf-8")
    said = (ast.get_docstring(ast.parse(text)) or "").partition("\n\n")[0].replace("\n", " ").replace("`", "")
    return re.split(r"(?<=[.?])\s", said)[0]


def fitted(said: str, name: str, width: float) -> str:
    """The words that stand beside a name: the whole sentence, or as many of its clauses as there is room for."""
    room = (width - 30 - BOLD * len(name)) / LETTER
    parts = [said, *(f"{said[: stop.start()]}." for stop in reversed([*re.finditer(r"[:;,]", said)]))]
    return next((part for part in parts if len(part) <= room), "")


def drawn(package: str, rooms: dict[str, list[str]], top: float, inset: float) -> tuple[list[str], float]:
    """The box of a package with the boxes of its rooms inside, and where it ends."""
    name = package.rpartition(".")[2]
    kind = "room" if "." in package else "storey"
    y, inner = top + LINE + 2, list[str]()
    for room in rooms.get(package, []):
        more, y = drawn(f"{package}.{room}", rooms, y, inset + INSET)
        inner += more
    height = (y if inner else top + LINE) - top
    x, width = LEFT + inset, WIDTH - 2 * (LEFT + inset)
    box = f'<rect class="{kind}" x="{x}" y="{top}" width="{width}" height="{height}" rx="5"/>'
    words = (
        f'<text x="{x + 10}" y="{top + 16}"><tspan class="name">{escape(name)}</tspan>'
        f'<tspan class="said" dx="10">{escape(fitted(question(package), name, width))}</tspan></text>'
    )
    return [box, words, *inner], top + height + GAP


def picture() -> str:
    """The whole drawing; what stands higher may import what stands lower, and never the other way."""
    rooms, y, parts = orders(), GAP, list[str]()
    for storey in rooms[""]:
        more, y = drawn(storey, rooms, y, 0)
        parts += more
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y}" width="{WIDTH}" height="{y}" role="img">'
    note = "<!-- Generated from the import contracts of pyproject.toml by docs/rooms.py. -->"
    title = "<title>The rooms of the package, from the top down; imports only go down</title>"
    return "\n".join([head, note, title, f"<style>{STYLE}</style>", *parts, "</svg>", ""])


def modules(package: str) -> list[str]:
    """The modules of a package and of the packages in it, those that run when called by name apart."""
    folder = ROOT / Path(*package.split("."))
    paths = [path.relative_to(ROOT).with_suffix("").parts for path in sorted(folder.rglob("*.py"))]
    return [".".join(parts) for parts in paths if parts[-1] not in ("__init__", "__main__")]


def documented(module: str, *options: str) -> str:
    """The block that has Sphinx write a module."""
    lines = [f".. automodule:: {module}", *(f"   :{option}" for option in options)]
    return "\n".join(["```{eval-rst}", *lines, "```", ""])


def reference() -> dict[Path, str]:
    """A page for each room, with every module in it, and one for each storey."""
    rooms, pages = orders(), dict[Path, str]()
    for storey in rooms[""]:
        parts = [f"# {storey}\n", documented(storey, "no-members:"), "```{toctree}"]
        parts += [f"{storey}/{room}" for room in rooms[storey]]
        pages[REFERENCE / f"{storey}.md"] = "\n".join([*parts, "```", ""])
        for room in rooms[storey]:
            package = f"{storey}.{room}"
            blocks = [f"# {package}\n", documented(package, "no-members:")]
            for module in modules(package):
                blocks += [f"## {module.removeprefix(package + '.')}\n", documented(module, *SHOWN)]
            pages[REFERENCE / storey / f"{room}.md"] = "\n".join(blocks)
    return pages


def write() -> None:
    """Writes the picture and the pages; a page of a room that is gone goes too."""
    PICTURE.write_text(picture(), encoding="utf-8")
    pages = reference()
    for page in REFERENCE.rglob("*.md"):
        if page not in pages:
            page.unlink()
    for page, text in pages.items():
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(text, encoding="utf-8")
    sys.stdout.write(f"{PICTURE.relative_to(ROOT)}, {len(pages)} pages in {REFERENCE.relative_to(ROOT)}\n")


if __name__ == "__main__":
    write()
