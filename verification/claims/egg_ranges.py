"""The ranges that the claims on the egg share."""

from sympy import Interval, Rational

SHAPES = Interval(0, Rational(1, 10))
ROUND = Interval.Lopen(0, Rational(1, 10))  # without the circle
FULL = Interval(-1, 1)  # of cos(3*theta)


def at(numeral: str) -> Rational:
    """A shape or a contraction as the exact number that its decimal shows."""
    return Rational(numeral)
