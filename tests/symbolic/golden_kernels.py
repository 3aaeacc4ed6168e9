"""Writes the golden kernels: `python tests/symbolic/golden_kernels.py [FOLDER]`, from the repository's root."""

import sys
from pathlib import Path

from symbolic.expressions.text import Kernel, kernel, module_text
from symbolic.motion.chords import chord_kernel
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import egg
from symbolic.tables.geometry import curvature
from symbolic.tables.table import K0, K1, Table, cos_eta1, cos_phi0, lam, t, theta

TABLES: dict[str, Table] = {"egg": egg(3)}  # the bits of all tables are in golden_bits.json


def curvatures(table: Table) -> list[Kernel]:
    """A kernel of `theta` and the shape that returns each component's curvature."""
    shapes = [p.symbol for p in table.shapes]
    return [
        kernel(f"curvature_{i}", [theta, *shapes], {"curvature": curvature(c)}, about=f"Signed curvature, {c.name}.")
        for i, c in enumerate(table.components)
    ]


def files() -> dict[str, str]:
    """The text of each golden file, by name."""
    made = {}
    for name, table in TABLES.items():
        chords = [chord_kernel(table, 0, 0, order=2)]
        made[f"chords_{name}.py"] = module_text(chords, f"symbolic.motion.chords.chord_angle, table {name}")
        made[f"curvature_{name}.py"] = module_text(
            curvatures(table), f"symbolic.tables.geometry.curvature, table {name}"
        )
    matrix = derivative_matrix()
    entries = {
        f"d{row}_d{column}": matrix[i, j]
        for i, row in enumerate(("s1", "phi1"))
        for j, column in enumerate(("s0", "phi0"))
    }
    step = kernel("derivative_matrix", [K0, K1, t, cos_phi0, cos_eta1, lam], entries, about="d(s1, phi1)/d(s0, phi0).")
    made["derivative_matrix.py"] = module_text([step], "symbolic.motion.collision.derivative_matrix")
    return made


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "golden"
    for name, text in files().items():
        (folder / name).write_text(text)
