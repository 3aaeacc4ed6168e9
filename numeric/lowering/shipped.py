"""Table IRs and symmetries of tables with a name, which come with the package, so that a first run needs no SymPy.

They are copies, not a second definition. Each is derived by `lower` from the exact table, written by

    python -m numeric.lowering.shipped

and used only while the program text that it depends on has the same digest. A test derives all of them anew.
"""

import json
import os

from numeric.lowering import cache

HOME = os.path.join(os.path.dirname(__file__), "shipped.json")  # noqa: PTH118, PTH120  (pathlib takes 3 ms to import)


def shipped(name: str, sources: str) -> str | None:
    """The text of the table IR of this name, if it was made from sources with this digest; else None.

    >>> shipped("no such table", "")
    """
    try:
        with open(HOME, encoding="utf-8") as file:  # noqa: PTH123
            made = json.load(file)
        return made["tables"].get(name) if made["sources"] == sources else None
    except (OSError, ValueError, KeyError, TypeError):
        return None  # missing or damaged: SymPy is asked


def derived() -> dict[str, str]:
    """The text of all shipped table IRs and symmetries, derived from the exact tables, by their names in the cache."""
    from numeric.lowering.lower import exact_table, lower, symmetry_text
    from numeric.lowering.program import PAPER, Named, ir_name, symmetry_name
    from symbolic.tables.scene import GALLERY

    named: list[Named | str] = [*PAPER, *map(Named, GALLERY)]
    found = dict[str, str]()
    for name, table in zip(named, (exact_table(name, 3, {}) for name in named), strict=True):
        found[ir_name(name, 3)] = lower(table).as_text()
        if not table.shapes:  # whose numbers decide which symmetries there are
            found[symmetry_name(name, 3, {})] = symmetry_text(table)
    return found


def ship() -> bool:
    """Writes the file again if program text that it depends on has changed; returns whether it was written."""
    from numeric.lowering.files import write_whole
    from numeric.lowering.program import SOURCES

    sources = cache.sources(*SOURCES)
    if shipped("circle", sources) is not None:
        return False
    write_whole(HOME, json.dumps({"sources": sources, "tables": derived()}, indent=0) + "\n")
    return True


if __name__ == "__main__":
    ship()
