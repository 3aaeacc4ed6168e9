"""Draws the rooms of the package from the import contracts: `python docs/rooms.py` writes docs/figures/rooms.svg.

The contracts in pyproject.toml are what `make lint` enforces, so the picture cannot say anything else.
"""

import ast
import sys
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / "docs" / "figures" / "rooms.svg"
WIDTH, LEFT, LINE, GAP, INSET = 760, 8, 22, 8, 14
STYLE = """
text { font: 13px system-ui, sans-serif; fill: #1f2328; }
.name { font-weight: 600; }
.said { fill: #57606a; }
rect { fill: #f6f8fa; stroke: #d0d7de; rx: 6px; }
.storey { fill: #ffffff; stroke: #57606a; }
@media (prefers-color-scheme: dark) {
  text { fill: #e6edf3; } .said { fill: #9198a1; } rect { fill: #161b22; stroke: #3d444d; }
  .storey { fill: #0d1117; stroke: #9198a1; }
}
"""


def orders() -> dict[str, list[str]]:
    """The rooms of each package, from the top down, as the contracts have them."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    found = {contract["containers"][0]: contract["layers"] for contract in contracts if "containers" in contract}
    (storeys,) = (c["layers"] for c in contracts if c["type"] == "layers" and "containers" not in c)
    return {"": storeys} | found


def question(package: str) -> str:
    """The first sentence of a package's docstring."""
    text = (ROOT / Path(*package.split(".")) / "__init__.py").read_text(encoding="utf-8")
    said = (ast.get_docstring(ast.parse(text)) or "").partition("\n\n")[0].replace("\n", " ")
    return said if len(said) < 100 else said.partition(":")[0]


def drawn(package: str, rooms: dict[str, list[str]], top: float, inset: float) -> tuple[list[str], float]:
    """The box of a package with the boxes of its rooms inside, and where it ends."""
    name = package.rpartition(".")[2]
    kind = "storey" if "." not in package else "room"
    y, inner = top + LINE + GAP, list[str]()
    for room in rooms.get(package, []):
        more, y = drawn(f"{package}.{room}", rooms, y, inset + INSET)
        inner += more
    height = (y if inner else top + LINE + GAP / 2) - top
    box = f'<rect class="{kind}" x="{LEFT + inset}" y="{top}" width="{WIDTH - 2 * (LEFT + inset)}" height="{height}"/>'
    words = (
        f'<text x="{LEFT + inset + 10}" y="{top + 17}"><tspan class="name">{escape(name)}</tspan>'
        f'<tspan class="said" dx="10">{escape(question(package))}</tspan></text>'
    )
    return [box, words, *inner], top + height + GAP


def picture() -> str:
    """The whole drawing; what stands higher may import what stands lower, and never the other way."""
    rooms, y, parts = orders(), float(GAP), list[str]()
    for storey in rooms[""]:
        more, y = drawn(storey, rooms, y, 0)
        parts += more
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y}" role="img"'
    title = "<title>The rooms of the package, from the top down; imports only go down</title>"
    return "\n".join([f"{head}>", title, f"<style>{STYLE}</style>", *parts, "</svg>", ""])


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")
    sys.stdout.write(f"{PICTURE.relative_to(ROOT)}\n")
