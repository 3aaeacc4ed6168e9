"""What several tests write numbers with that are worked out by hand; imported as `by_hand`."""

from fractions import Fraction

import numpy as np


def integers(*values):
    """An array of indices."""
    return np.array(values, dtype=np.int64)


def floats(*values):
    """An array of float64."""
    return np.array(values, dtype=float)


def number(check, x, p=100):
    """A number of the second reader: an interval of a width of one unit in the last of `p` places at most."""
    return check.I.of(Fraction(x), p)


def holds(found, true, units=4) -> bool:
    """Does an interval hold a fraction, and is it no wider than so many units of its last place?"""
    return found.lo <= Fraction(true) * 2**found.p <= found.hi and found.width() <= units
