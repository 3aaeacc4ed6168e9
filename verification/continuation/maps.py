"""Maps whose bifurcations are published: the engine that follows billiards must find them too.

Logistic, `x -> r*x*(1 - x)` [May1976]. Henon, `x -> 1 - a*x**2 + y`, `y -> b*x`, as one rule in three
successive `x` [Henon1976]. Delayed logistic, `x -> r*x*(1 - y)`, `y -> x` [MaynardSmith1968], for its torus.
"""

from sympy import Symbol

from verification.continuation.recurrence import AFTER, BEFORE, HERE, Explicit

r, a, b = (Symbol(name, real=True) for name in "rab")


def logistic(period: int) -> Explicit:
    """Cycles of the logistic map; the letter is `r`."""
    return Explicit("logistic", AFTER - r * HERE * (1 - HERE), (r,), period)


def henon(period: int) -> Explicit:
    """Cycles of the Henon map; the letters are `a` and `b`."""
    return Explicit("Henon", AFTER - 1 + a * HERE**2 - b * BEFORE, (a, b), period)


def delayed(period: int) -> Explicit:
    """Cycles of the delayed logistic map; the letter is `r`."""
    return Explicit("delayed logistic", AFTER - r * HERE * (1 - BEFORE), (r,), period)


def cubic(period: int) -> Explicit:
    """Cycles of `x -> r*x - x**3`; the letter is `r`."""
    return Explicit("cubic", AFTER - r * HERE + HERE**3, (r,), period)
