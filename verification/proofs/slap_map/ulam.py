"""How well the transfer operator, averaged over cells, can be inverted: Ulam's matrix [Ulam1960], with a proof.

`N` equal cells, `P` the average over each, `Q = P L P`: a matrix of the shares of a cell that are carried to
another. On vectors of sum 0, in `L1`, `||u|| <= K*||(I - Q) u||`. Any matrix `X` proves such a `K`: from
`u = X(I - Q)u + (I - X(I - Q))u`,

    K = |X| / (1 - |I - X(I - Q)|),        |A| = max over columns of ||column - w||, for any vector w,

because `A u` is the sum of `u_j*(column_j - w)` when the `u_j` sum to 0. `X` is an inverse in floats, and what
rounding may have done to the products is bounded and added.

For densities that the mirror image negates, the first summand of `L` is negated; then `w = 0`, and any vector is meant.

The entries of `Q` are differences of launching points in units of a cell. Each is rounded to a multiple of
`2**-40`, so that entries and sums of columns are exact in doubles, and a displaced point moves at most twice its
displacement of mass in a column.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import arb
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from verification.arithmetic.words import working
from verification.proofs.slap_map.transfer import Branches

Matrix = NDArray[np.float64]
BITS = 96
GRAIN = 2.0**40
UNIT = 2.0**-53
BLANKET = 1 + 1e-9  # over the rounding of a sum of at most 1e5 positive doubles


@dataclass(frozen=True)
class Inverted:
    """`||u|| <= K*||(I - Q)u||`, `bound` above `K`; None where `X` was no good inverse.

    For vectors of sum 0 when the `sign` of the first summand is 1, for all when it is -1.
    """

    cells: int
    bound: float | None
    defect: float
    sign: int


def launching_points(cells: int) -> tuple[Matrix, Matrix]:
    """`g(-x)` and `g(x)` at the ends of cells, in cells, exact multiples of `1/GRAIN` and within that of the truth."""
    if cells % 2 or not 0 < cells <= 4096:
        raise ValueError(f"ulam: cells = {cells}; an even number of at most 4096 is needed")
    at = Branches(BITS)
    with working(BITS):
        quarter = arb.pi() / 4

        def point(k: int) -> float:  # landing at b = k cells
            launch = at(arb(k) * 2 * quarter / cells)[0]
            units = (launch * cells / (2 * quarter) * GRAIN).floor().unique_fmpz() if launch.is_finite() else None
            if units is None:
                raise ArithmeticError(f"ulam: the launching point of b = {k} cells is not known to {GRAIN}")
            return float(int(units)) / GRAIN

        below = [point(-k) for k in range(cells)] + [0.0]
        above = [point(k) for k in range(cells // 2)] + [float(cells)]
    return np.array(below), np.array(above)


def ulam(cells: int, sign: int = 1) -> csc_matrix:
    """`Q`, with column sums of exactly 1; or with the first summand of the operator times a `sign` of -1.

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
    """The bound `K`, from an `inverse` of `I - Q` on vectors of sum 0 (if left out, one made in floats).

    With a `sign` of -1, `K` is for all vectors.

    >>> found = inverted(64)
    >>> found.defect < 1e-6, 10 < found.bound < 30
    (True, True)
    """
    matrix, size_of = ulam(cells, sign), spread if sign == 1 else largest
    identity = np.eye(cells)
    if inverse is None:
        mass = np.full(cells, 1 / cells)
        for _ in range(60):
            mass = matrix @ mass
        inverse = np.linalg.inv(identity - matrix.toarray() + (mass[:, None] if sign == 1 else 0))
    entries = int(np.diff(matrix.indptr).max())
    rounding = (entries + 4) * UNIT * (2 * largest(inverse) + 1)
    size = size_of(inverse)
    displaced = 2 * (cells * 1.5 + 3) / GRAIN
    defect = size_of(identity - inverse + (matrix.T @ inverse.T).T) + rounding * BLANKET + size * displaced
    bound = size / (1 - defect) * BLANKET if sign in (1, -1) and defect < 0.5 else None
    return Inverted(cells, bound, defect, sign)


def largest(matrix: Matrix) -> float:
    """The largest `L1` norm of a column: the norm of the matrix, from above."""
    return float(abs(matrix).sum(axis=0).max()) * BLANKET


def spread(matrix: Matrix) -> float:
    """The largest distance, in `L1`, of a column from one vector: what the matrix does to vectors of sum 0, at most.

    >>> spread(np.array([[1.0, 1.0], [2.0, 2.0]]))
    0.0
    """
    about = np.median(matrix, axis=1)
    return largest(matrix - about[:, None])
