"""Table IRs that come with the package, of the paper's tables and the gallery's: the first result waits for no SymPy.

They are no second definition. Each is what `lower` makes of the exact table, written by

    python -m numeric.lowering.shipped

and used only as long as no text that it depends on has changed since: a digest says so. A test derives all anew.
"""

import json
import os

from numeric.lowering import cache

HOME = os.path.join(os.path.dirname(__file__), "shipped.json")  # noqa: PTH118, PTH120  (pathlib takes 3 ms to import)


def shipped(name: str, sources: str) -> str | None:
    """The text of the table IR of this name, if it was made from these sources.

    >>> shipped("no such table", "")
    """
    try:
        with open(HOME, encoding="utf-8") as file:  # noqa: PTH123
            made = json.load(file)
        return made["tables"].get(name) if made["sources"] == sources else None
    except (OSError, ValueError, KeyError, TypeError):
        return None  # missing or damaged: SymPy is asked


def derived() -> dict[str, str]:
    """All of them from the exact tables, by the name that the cache knows them by."""
    from numeric.lowering.lower import exact_table, lower
    from numeric.lowering.program import PAPER, Named, ir_name
    from symbolic.tables.scene import GALLERY

    tables: list[Named | str] = [*PAPER, *map(Named, GALLERY)]
    return {ir_name(table, 3): lower(exact_table(table, 3, {})).as_text() for table in tables}


def ship() -> bool:
    """Write the file anew if a text has changed that it depends on; whether it was written."""
    from numeric.lowering.program import SOURCES

    sources = cache.sources(*SOURCES)
    if shipped("circle", sources) is not None:
        return False
    with open(HOME, "w", encoding="utf-8") as file:  # noqa: PTH123
        json.dump({"sources": sources, "tables": derived()}, file, indent=0)
        file.write("\n")
    return True


if __name__ == "__main__":
    ship()
