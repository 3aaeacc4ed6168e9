"""The methods for finding the next bounce; the first one that fits a table is used.

To add a method, write a module beside these, and add a line here: its module, its class, and the name of the paper's
table that it is for, if it serves only this one.
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
    """The first family that serves the table; the modules of later families are not imported."""
    for module, name, table in FAMILIES:
        if table not in ("", boundary.ir.same_as):
            continue
        family: type[Family] = getattr(import_module(f"numeric.flights.{module}"), name)
        if family.matches(boundary):
            return family(boundary)
    raise ValueError(f"{boundary.ir.table}: no method to compute flights applies to this table")
