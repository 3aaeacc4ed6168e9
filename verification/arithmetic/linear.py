"""Large sparse linear systems in balls: solved in float64, with an enclosure of the error.

With `R` an approximate inverse of the matrix `A`, the error `d` of any vector `x` obeys `d = R*r + (I - R*A)*d`, where
`r = b - A*x`. So where `E` bounds `abs(I - R*A)` and `c` bounds `abs(R*r)`, entry by entry, and some `e > 0` has `c +
E*e < e`, the spectral radius of `E` is below 1, `A` is regular, and `abs(d) <= e` (Collatz and Wielandt). `R` is made
in float64 and holds for every matrix in the balls: its own errors, those of the products in floats (summed in any
order, fused or not: Higham, Accuracy and Stability, section 3.5) and the radii of the balls are all in `E`.
"""

import math
from collections.abc import Sequence
from itertools import starmap

import numpy as np
from flint import arb
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Sparse = list[list[tuple[int, arb]]]
UNIT = 2.0**-53
TINY = 1e-300  # above what one operation loses by underflow, also where subnormal numbers count as 0
ROUNDS = 12


def solved(rows: Sequence[Sequence[arb]], right: Sequence[Sequence[arb]]) -> list[list[arb]]:
    """Enclosure of the solutions of `A*x = right` for all matrices `A` in the balls `rows`; `right` has shape `(n, k)`.

    `ZeroDivisionError` where no bound is found: the matrix may be singular.

    >>> found = solved([[arb(2), arb(0)], [arb(1, "1e-9"), arb(4)]], [[arb(2)], [arb(9)]])
    >>> found[0][0].contains(1), found[1][0].contains(2), found[1][0].rad() < 1e-8
    (True, True, True)
    """
    size = len(rows)
    sparse = [[(j, x) for j, x in enumerate(row) if not x.is_zero()] for row in rows]
    middle, radius = np.zeros((size, size)), np.zeros((size, size))
    for i, row in enumerate(sparse):
        for j, x in row:
            middle[i, j] = float(x.mid())
            radius[i, j] = _above(x - arb(middle[i, j]))
    inverse, blanket = _inverse(middle), 1 + 8 * (size + 4) * UNIT
    with np.errstate(all="ignore"):  # what is not finite fulfils no condition
        products = abs(inverse) @ (radius + 4 * (size + 4) * UNIT * abs(middle))
        off = (abs(np.eye(size) - inverse @ middle) + products) * blanket + size * TINY
    columns = [_column(sparse, inverse, off, blanket, column) for column in zip(*right, strict=True)]
    return [list(row) for row in zip(*columns, strict=True)]


def approximated(rows: Sequence[Sequence[arb]], right: Sequence[Sequence[arb]]) -> list[list[arb]]:
    """The solution in float64, as balls of radius 0, without proof. `ZeroDivisionError` for a singular matrix."""
    matrix, sides = (np.array([[_middle(x) for x in row] for row in part]) for part in (rows, right))
    try:
        found = np.linalg.solve(matrix, sides)
    except np.linalg.LinAlgError as error:
        raise ZeroDivisionError("a singular matrix") from error
    return [[arb(float(x)) for x in row] for row in found]


def _inverse(matrix: Floats) -> Floats:
    if not np.isfinite(matrix).all():
        raise ZeroDivisionError("a matrix that is not finite")
    try:
        return np.asarray(np.linalg.inv(matrix))
    except np.linalg.LinAlgError as error:
        raise ZeroDivisionError("a singular matrix") from error


def _column(sparse: Sparse, inverse: Floats, off: Floats, blanket: float, right: Sequence[arb]) -> list[arb]:
    """One column of the solution: corrected twice in float64, then enclosed with a bound of the remaining error."""
    x = [arb(0)] * len(sparse)
    for _ in range(2):
        left = np.array([_middle(r) for r in _residual(sparse, x, right)])
        x = [(old + arb(float(more))).mid() for old, more in zip(x, inverse @ left, strict=True)]
    bound = np.array([_above(r) for r in _residual(sparse, x, right)])
    with np.errstate(all="ignore"):
        gap = (abs(inverse) @ bound) * blanket + len(sparse) * TINY
        error = 2 * gap
        for _ in range(ROUNDS):
            after = (gap + off @ error) * blanket + len(sparse) * TINY
            if np.all(after < error):
                return list(starmap(arb, zip(x, map(float, error), strict=True)))
            error = 1.25 * after
    raise ZeroDivisionError("no bound of the error: the matrix may be singular")


def _residual(sparse: Sparse, x: Sequence[arb], right: Sequence[arb]) -> list[arb]:
    """The residual `b - A*x` in balls, where `b` is `right`."""
    return [b - sum((a * x[j] for j, a in row), arb(0)) for row, b in zip(sparse, right, strict=True)]


def _middle(x: arb) -> float:
    return 0.0 if x.is_zero() else float(x.mid())


def _above(x: arb) -> float:
    """A float above the absolute value of every number in a ball; not finite where the ball is not."""
    return math.nextafter(float(x.abs_upper()), math.inf)
