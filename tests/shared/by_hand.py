"""Helpers, imported as `by_hand`, with which several tests write numbers worked out by hand."""

from fractions import Fraction


def number(check, x, p=100):
    """A number of the independent checker: an interval at most one unit wide in the last of `p` places."""
    return check.I.of(Fraction(x), p)


def holds(found, true, units=4) -> bool:
    """Whether an interval contains a fraction and is no wider than so many units of its last place."""
    return found.lo <= Fraction(true) * 2**found.p <= found.hi and found.width() <= units
