"""A proof in balls that the two margins of `symbolic.cycles.returns` are positive, by bisection of a box.

Paper: section 5. The box is that of `(u, v, lam)`, where the exit angle at the arc is `phi = (2*u - 1)*lam*pi/2`, and
the start has the polar angle `theta0` with `3/2*theta0 = v*(phi + pi/2)`. With `u` and `v` in `[0, 1]` the box holds
all flights to the wall whose start is not below the axis, since `eta = phi - 3/2*theta0` is above `-pi/2`. Undecided
boxes are halved along each side.
"""

from fractions import Fraction
from functools import cache

import numpy as np
from sympy import Expr

from numeric.lowering.lower import converted
from numeric.lowering.program import Builder, Program
from symbolic.cycles.defocusing import half
from symbolic.cycles.returns import HIGHEST, LOWEST, leaves, margins, returns
from symbolic.expressions.signs import Outcome, SignFinding, conjunction
from symbolic.tables.table import lam
from verification.arithmetic.arrays import ArrayOps, exactly, hull
from verification.rigorous.exclusion import Search

LETTERS = half, leaves, lam
FIRST, DEPTH, MOST = (16, 16, 32), 10, 1 << 19  # boxes along each side, the most halvings, the most boxes at once
LEAST = 2.0**-9  # the bound to prove for the margins; it is above 0, so that the search ends


def program(*formulas: Expr) -> Program:
    """The formulas, in `theta0/2`, the exit angle and `lam`, as a program for any number system."""
    builder = Builder(*map(str, LETTERS))
    nodes = dict(zip(LETTERS, builder.nodes, strict=True))
    return builder.program(*(converted(builder, formula, nodes) for formula in formulas))


def positive_margins(low: Fraction = Fraction(str(LOWEST)), high: Fraction = Fraction(str(HIGHEST))) -> Search:
    """The proof that both margins are at least `LEAST` for every contraction from `low` to `high`.

    >>> positive_margins(Fraction(1, 5), Fraction(3, 5)).proved
    True
    >>> print(positive_margins(Fraction(9, 100), Fraction(1, 10)).proved)  # below lambda_c period 2 attracts
    None
    """
    ops, run, boxes = ArrayOps(), program(*margins()), 0
    start, wide = exactly(Fraction(low)), exactly(Fraction(high) - Fraction(low))
    grid = np.meshgrid(*(np.arange(n) / n for n in FIRST), indexing="ij")
    corners, sides = np.array([x.ravel() for x in grid]), np.array([[1 / n] for n in FIRST])  # exact: powers of 2
    for _ in range(DEPTH):
        u, v, share = (hull(corner, corner + side) for corner, side in zip(corners, sides, strict=True))
        contraction = start + wide * share
        exit = (2 * u - 1) * contraction * ops.pi / 2
        values = run(ops, v * (exit + ops.pi / 2) / 3, exit, contraction)
        left = ~np.logical_and.reduce([value.lower() >= LEAST for value in values])
        boxes += left.size
        if not np.any(left):
            return Search(True, boxes)
        if np.count_nonzero(left) > MOST // 8:
            break
        sides = sides / 2
        corners = np.concatenate([corners[:, left] + sides * np.array([k]).T for k in np.ndindex(2, 2, 2)], axis=1)
    return Search(None, boxes)


@cache
def every_return() -> SignFinding:
    """The finding that every return to the arc stretches, for `LOWEST <= lam <= HIGHEST`.

    The finding combines the exact identities of `symbolic.cycles.returns` with the margins proved in balls.
    """
    found = positive_margins()
    reason = f"both margins by way of the wall are at least {LEAST} in {found.boxes} boxes"
    return conjunction(returns(), SignFinding(Outcome.PROVED if found.proved else Outcome.UNKNOWN, reason))
