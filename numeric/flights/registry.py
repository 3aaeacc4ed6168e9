"""Methods for finding the next bounce, in the order in which they are asked whether they serve a table.

A new method is a module beside these and a line here: its module, its class, and the table of the paper that it is for,
if it serves one alone.
"""

from importlib import import_module

from numeric.flights.family import Boundary, Family

FAMILIES = (
    ("circle", "Circle", "circle"),
    ("cardioid", "Cardioid", "cardioid"),
    ("cuspless", "Cuspless", "cuspless"),
    ("harmonic", "Ellipse", ""),
    ("harmonic", "Fourier", ""),
    ("many", "Many", ""),
    ("pieces", "Pieces", ""),
    ("spline", "Spline", ""),
    ("conic", "Conic", ""),
    ("polar", "Polar", ""),
    ("general", "General", ""),
)


def family_of(boundary: Boundary) -> Family:
    """The first family that serves the table; those after it, and those for another table, are not even imported."""
    for module, name, table in FAMILIES:
        if table not in ("", boundary.ir.same_as):
            continue
        family: type[Family] = getattr(import_module(f"numeric.flights.{module}"), name)
        if family.matches(boundary):
            return family(boundary)
    raise ValueError(f"{boundary.ir.table}: no flight serves this table")
