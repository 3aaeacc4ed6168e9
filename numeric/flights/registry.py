"""The ways to find the next bounce, in the order in which they are asked whether a table is theirs.

A new one is a module beside these and a line here.
"""

from importlib import import_module

from numeric.flights.family import Boundary, Family

FAMILIES = (
    ("circle", "Circle"),
    ("cardioid", "Cardioid"),
    ("cuspless", "Cuspless"),
    ("harmonic", "Conic"),
    ("harmonic", "Ellipse"),
    ("harmonic", "Fourier"),
    ("many", "Many"),
    ("pieces", "Pieces"),
    ("spline", "Spline"),
    ("polar", "Polar"),
    ("general", "General"),
)


def family_of(boundary: Boundary) -> Family:
    """The first family that serves the table; those after it are not even imported."""
    for module, name in FAMILIES:
        family: type[Family] = getattr(import_module(f"numeric.flights.{module}"), name)
        if family.matches(boundary):
            return family(boundary)
    raise ValueError(f"{boundary.ir.table}: no flight serves this table")
