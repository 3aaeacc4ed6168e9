"""The transfer operator of the cardioid's slap map on half the table: bounds for variation, and a bound of an inverse.

The slap map commutes with `theta -> -theta`, so it acts on the half angle `y = abs(theta)/2` in `[0, pi/2]`, by a map
`F`. A particle that lands at the half angle `b`, `-pi/2 < b < pi/4`, was launched at `g(b)`, which grows from 0 to
`pi/2`. With `rate = g'`, the inverse of the slope of `F`, and `F(g(b)) = abs(b)`, densities are mapped to

    (L f)(x) = rate(-x)*f(g(-x)) + rate(x)*f(g(x)),       the second summand for x < pi/4 only.

Let `f` have bounded variation and end in 0 at `pi/2`. Then `L f` has the same properties: the rate is 0 at the cusp,
and the second summand ends at `x = pi/4` with `f(pi/2) = 0`, so there is no jump. Its variation is at most

    integral of rate*d|f(g)|  +  integral of abs(rate')*abs(f(g)).

`symbolic.cycles.cardioid_slap` proves that away from the cusp `abs(rate') < STEEP*rate`, which adds `STEEP*||f||_1`.
Near the cusp, for launching points below `y0`, the rate grows from 0 to `eta < SHRINKS/2`, which adds at most
`eta*sup|f|`, and there `sup|f| <= Var f + (1/y0)*integral of |f|`. So variation at launching points below `y0` is
multiplied by at most `2*eta < SHRINKS`, elsewhere by `SHRINKS`, and together (the inequality of [LasotaYorke1973],
norms in `L1`)

    Var(L f) <= SHRINKS*Var f + B*||f||,      B = max(STEEP, eta/y0).

The inverse of `1 - L`, averaged over cells, is bounded with Ulam's matrix [Ulam1960]: with `N` equal cells and `P` the
average over each, `Q = P L P` is the matrix of the fractions of each cell that are mapped to each of the cells. For
vectors of sum 0, `||u|| <= K*||(I - Q) u||` in `L1`. Any matrix `X` proves such a `K`: from `u = X(I - Q)u + (I - X(I -
Q))u`,

    K = |X| / (1 - |I - X(I - Q)|),        |A| = max over columns of ||column - w||, for any vector w,

because `A u` is the sum of `u_j*(column_j - w)` when the `u_j` sum to 0. `X` is an inverse in floats, and the rounding
errors of the products are bounded and added.

For odd functions of `theta` the first summand of `L` is negated; then `w = 0`, and the bound holds for all vectors.

The entries of `Q` are differences of launching points in units of a cell. Each is rounded to a multiple of `2**-40`, so
that entries and column sums are exact in doubles. A rounded point changes a column by at most twice its displacement.
"""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb, arb_series
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from sympy import S

from symbolic.cycles.cardioid_slap import (
    CUSP,
    RATE,
    SHRINKS,
    STEEP,
    branch,
    derived,
    expands,
    forward_once,
    gentle_elsewhere,
    lands_first,
    near_launch,
    parametrised,
    q,
    quiet_near_the_cusp,
)
from symbolic.expressions.text import load
from verification.arithmetic.balls import FLOAT64, balls, real_ball, working
from verification.arithmetic.series import in_series

TURN = -0.1  # the landing at which the formula of the launching point changes


@dataclass(frozen=True)
class Variation:
    """Inequality `Var(L f) <= shrinks*Var f + adds*||f||` for the transfer operator `L`; `proved` if its lemmas are."""

    shrinks: arb
    adds: arb
    proved: bool


@cache
def variation() -> Variation:
    """The inequality for variations with its constants, from the exact proofs.

    >>> found = variation()
    >>> found.proved, found.shrinks.str(3, radius=False), found.adds.str(3, radius=False)
    (True, '0.835', '6.76')
    """
    facts = (
        parametrised,
        forward_once,
        lands_first,
        derived,
        expands,
        quiet_near_the_cusp,
        gentle_elsewhere,
    )
    proved = all(bool(fact()) for fact in facts)
    with working(64):
        near = real_ball(RATE.subs(q, CUSP)) / real_ball(near_launch())
        steep = real_ball(S(STEEP))
        return Variation(real_ball(S(SHRINKS)), steep.max(near), proved)


class Branches:
    """The launching point `g` and its derivative `rate`, for balls and series of balls at a given precision.

    >>> at = Branches(64)
    >>> launch, rate = at(arb(0))
    >>> print(launch.str(5, radius=False), rate.str(5, radius=False))
    0.95532 0.83333
    """

    def __init__(self, bits: int) -> None:
        self.of_balls = [load(branch(above), balls(bits)) for above in (False, True)]
        self.of_series = [load(branch(above), in_series(balls(bits), arb_series)) for above in (False, True)]

    def __call__(self, landing: Any) -> tuple[Any, Any]:
        """The launching half angle and the rate `g'`, as functions of the landing half angle."""
        series = isinstance(landing, arb_series)
        above = not (landing[0] if series else landing) < TURN
        launch, rate = (self.of_series if series else self.of_balls)[above](landing)
        return launch, rate

    def landing(self, launch: arb, bits: int) -> arb:
        """The landing half angle of a particle launched at an exact half angle, by Newton's method; not proved."""
        point = arb(landed(float(launch)))
        for _ in range(2 + bits.bit_length()):
            found, rate = self(point)
            point = (point - ((found - launch) / rate)).mid()
        return point


def landed(launch: float) -> float:
    """The landing half angle for a launching half angle, in floats, by bisection.

    >>> round(abs(landed(0.9553166181245093)), 9)  # atan(sqrt(2)) lands on the axis
    0.0
    """
    below, above = -1.5707963267948966, 0.7853981633974483
    forms = [load(branch(above), FLOAT64) for above in (False, True)]
    for _ in range(60):
        middle = (below + above) / 2
        found = forms[middle >= TURN](middle)[0]
        below, above = (below, middle) if found > launch else (middle, above)
    return (below + above) / 2


Matrix = NDArray[np.float64]
BITS = 96
GRAIN = 2.0**40
UNIT = 2.0**-53
BLANKET = 1 + 1e-9  # over the rounding of a sum of at most 1e5 positive doubles


@dataclass(frozen=True)
class Inverted:
    """A bound `||u|| <= bound*||(I - Q)u||` for Ulam's matrix `Q`; `bound` is None if the inverse is bad.

    The bound holds for vectors of sum 0 if the `sign` of the first summand is 1, and for all vectors if it is -1.
    """

    cells: int
    bound: float | None
    defect: float
    sign: int


def launching_points(cells: int) -> tuple[Matrix, Matrix]:
    """Launching points `g(-x)` and `g(x)` at the ends of cells, in units of a cell, rounded to the grid `1/GRAIN`."""
    if cells not in range(2, 4097, 2):
        raise ValueError(f"ulam: cells = {cells}; an even number of at most 4096 is needed")
    at = Branches(BITS)
    with working(BITS):
        quarter = arb.pi() / 4

        def point(k: int) -> float:  # for the landing b = k cells
            launch = at(arb(k) * 2 * quarter / cells)[0]
            units = (launch * cells / (2 * quarter) * GRAIN).floor().unique_fmpz() if launch.is_finite() else None
            if units is None:
                raise ArithmeticError(
                    f"ulam: the launching point for b = {k} cells could not be enclosed to within {GRAIN}"
                )
            return float(int(units)) / GRAIN

        below = [point(-k) for k in range(cells)] + [0.0]
        above = [point(k) for k in range(cells // 2)] + [float(cells)]
    return np.array(below), np.array(above)


def ulam(cells: int, sign: int = 1) -> csc_matrix:
    """The matrix `Q`, with column sums of exactly 1; with `sign = -1` the first summand of the operator is negated.

    >>> float(abs(ulam(16).sum(axis=0) - 1).max())
    0.0
    """
    rows, columns, shares = [], [], []
    for factor, ends in zip((sign, 1), launching_points(cells), strict=True):
        for row, (one, other) in enumerate(pairwise(ends)):
            low, high = min(one, other), max(one, other)
            for column in range(int(low), min(int(np.ceil(high)), cells)):
                rows.append(row)
                columns.append(column)
                shares.append(factor * (min(high, column + 1.0) - max(low, float(column))))
    return csc_matrix((shares, (rows, columns)), shape=(cells, cells))


def inverted(cells: int, inverse: Matrix | None = None, sign: int = 1) -> Inverted:
    """The bound `K` of the module docstring, from an approximate `inverse` of `I - Q`, made in floats if not given.

    The bound holds for vectors of sum 0; with `sign = -1` it holds for all vectors.

    >>> found = inverted(64)
    >>> found.defect < 1e-6, 10 < found.bound < 30
    (True, True)
    """
    matrix = ulam(cells, sign)
    inverse = _in_floats(matrix, sign) if inverse is None else inverse
    entries = int(np.diff(matrix.indptr).max())
    rounding = (entries + 4) * UNIT * (2 * largest(inverse) + 1)
    size = spread(inverse) if sign == 1 else largest(inverse)
    displaced = 2 * (cells * 1.5 + 3) / GRAIN
    left = (matrix.T @ inverse.T).T
    left -= inverse
    left[np.diag_indices(cells)] += 1
    if sign == 1:  # any vector w may be subtracted; the mean is cheaper than a median
        left -= left.mean(axis=1)[:, None]
    defect = largest(left) + rounding * BLANKET + size * displaced
    bound = size / (1 - defect) * BLANKET if sign in (1, -1) and defect < 0.5 else None
    return Inverted(cells, bound, defect, sign)


def _in_floats(matrix: csc_matrix, sign: int) -> Matrix:
    """An approximate inverse of `I - Q`, with Ulam's `Q = matrix`, on vectors of sum 0 (`sign = 1`) or on all vectors
    (`sign = -1`).

    The upper half `A` of the cells is mapped to the lower half `B`. So the unknowns of `A` are eliminated, and the
    matrix to invert is half as large. With `r = (I - Q)u` the equations of `B` are

        (I - Q_BB - Q_BA*Q_AB) u_B = r_B + Q_BA*r_A,     u_A = r_A + Q_AB*u_B,

    and the condition that `u` has sum 0 is added to each of them, times the mass of its cell.
    """
    cells = matrix.shape[0]
    half = cells // 2
    rows = matrix.tocsr()
    ahead, into, out = rows[:half, :half], rows[:half, half:], rows[half:, :half]
    mass = np.full(half, 1.0 / cells)
    for _ in range(60 if sign == 1 else 0):
        mass = ahead @ mass + into @ (out @ mass)
    total = 1 + np.asarray(out.sum(axis=0)).ravel()  # the contribution of each entry of u_B to the sum
    reduced = np.eye(half) - (ahead + into @ out).toarray() + (np.outer(mass, total) if sign == 1 else 0)
    inverse = np.linalg.inv(reduced)
    found = np.empty((cells, cells))
    found[:half, :half] = inverse
    found[:half, half:] = (into.T @ inverse.T).T
    if sign == 1:
        found[:half, half:] -= (inverse @ mass)[:, None]
    found[half:] = out @ found[:half]
    found[half:, half:].flat[:: half + 1] += 1
    return found


def largest(matrix: Matrix) -> float:
    """An upper bound of the matrix norm in `L1`: the largest norm of a column."""
    return float(abs(matrix).sum(axis=0).max()) * BLANKET


def spread(matrix: Matrix) -> float:
    """The largest `L1` distance of a column from the entrywise median: a bound of the matrix on vectors of sum 0.

    >>> spread(np.array([[1.0, 1.0], [2.0, 2.0]]))
    0.0
    """
    about = np.median(matrix, axis=1)
    return largest(matrix - about[:, None])
