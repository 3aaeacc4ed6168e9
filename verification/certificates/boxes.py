"""Stretches of a line as balls: cut into touching pieces, halved, joined."""

import math
from collections.abc import Iterable
from itertools import pairwise

from flint import arb


def between(low: float, high: float) -> arb:
    """A ball that holds all numbers between two floats.

    >>> ball = between(0.1, 0.3)
    >>> ball.contains(arb(0.1)), ball.contains(arb(0.3)), ball.contains(arb(0.31))
    (True, True, False)
    """
    return arb(low).union(arb(high))


def cuts(low: float, high: float, longest: float) -> list[arb]:
    """A stretch as touching balls, none of them much longer than `longest`.

    >>> len(cuts(0.0, 1.0, 0.3))
    4
    """
    parts = max(1, math.ceil((high - low) / longest))
    ends = [low + (high - low) * i / parts for i in range(parts)] + [high]
    return [between(a, b) for a, b in pairwise(ends)]


def halves(x: arb) -> list[arb]:
    """Two touching balls that hold a ball."""
    low, middle, high = x.lower(), arb(x.mid()), x.upper()
    return [low.union(middle), middle.union(high)]


def joined(values: Iterable[arb]) -> arb:
    """A ball that holds all the balls given, at least one.

    >>> joined([arb(1), arb(3)]).contains(arb(2))
    True
    """
    whole, *others = values
    for value in others:
        whole = whole.union(value)
    return whole
