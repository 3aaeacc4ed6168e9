"""The two axes of the ellipse, as the claims need them."""

from sympy import Expr, Interval, oo

from symbolic.cycles import trace_and_determinant
from symbolic.named_cycles import major_axis, minor_axis
from symbolic.symbols import a

BEYOND = {a: Interval.open(1, oo)}


def minor() -> tuple[Expr, Expr]:
    """Trace and determinant on the minor axis."""
    return trace_and_determinant(minor_axis())


def major() -> tuple[Expr, Expr]:
    """Trace and determinant on the major axis."""
    return trace_and_determinant(major_axis())
