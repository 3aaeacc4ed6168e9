"""The cardioid's slap map on half the table, its transfer operator, and what the operator does to variation.

The mirror image carries orbits to orbits, so the slap map acts on the half angle `y = abs(theta)/2` in
`[0, pi/2]`; call that map `F`. A particle that lands at the half angle `b`, `-pi/2 < b < pi/4`, left at `g(b)`, which
grows from 0 to `pi/2`, with `rate = g'`: one over the slope of `F`. So `F(g(b)) = abs(b)`, and densities go to

    (L f)(x) = rate(-x)*f(g(-x)) + rate(x)*f(g(x)),       the second summand for x < pi/4 only.

Let `f` have bounded variation and end in 0 at `pi/2`. Then so does `L f`: the rate is 0 at the cusp, and the
second summand ends at `x = pi/4` with `f(pi/2) = 0`, so that nothing jumps. Its variation is at most

    integral of rate*d|f(g)|  +  integral of abs(rate')*abs(f(g)).

With `symbolic.cycles.cardioid_slap`: off the cusp `abs(rate') < STEEP*rate`, which adds `STEEP*||f||_1`. Near it,
for launches
below `y0`, the rate grows from 0 to `eta < SHRINKS/2`, which adds at most `eta*sup|f|`, and there
`sup|f| <= Var f + (1/y0)*integral of |f|`. Launches near `y0` are so multiplied by `2*eta < SHRINKS`, others by
`SHRINKS`, and altogether (the inequality of [LasotaYorke1973], norms in `L1`)

    Var(L f) <= SHRINKS*Var f + B*||f||,      B = max(STEEP, eta/y0).

How well `1 - L`, averaged over cells, can be inverted is proved with Ulam's matrix [Ulam1960]: `N` equal cells, `P`
the average over each, `Q = P L P`: a matrix of the shares of a cell that are carried to another. On vectors of sum 0,
in `L1`, `||u|| <= K*||(I - Q) u||`. Any matrix `X` proves such a `K`: from `u = X(I - Q)u + (I - X(I - Q))u`,

    K = |X| / (1 - |I - X(I - Q)|),        |A| = max over columns of ||column - w||, for any vector w,

because `A u` is the sum of `u_j*(column_j - w)` when the `u_j` sum to 0. `X` is an inverse in floats, and what
rounding may have done to the products is bounded and added.

For densities that the mirror image negates, the first summand of `L` is negated; then `w = 0`, and any vector is
meant.

The entries of `Q` are differences of launching points in units of a cell. Each is rounded to a multiple of
`2**-40`, so that entries and sums of columns are exact in doubles, and a displaced point moves at most twice its
displacement of mass in a column.
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

TURN = -0.1  # the landing where the form of the launching point changes


@dataclass(frozen=True)
class Variation:
    """`Var(L f) <= shrinks*Var f + adds*||f||`, and whether every fact that it needs is proved."""

    shrinks: arb
    adds: arb
    proved: bool


@cache
def variation() -> Variation:
    """The inequality with its constants, from the exact proofs.

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
    """`g` and `rate` of balls and of series, at a stated precision.

    >>> at = Branches(64)
    >>> launch, rate = at(arb(0))
    >>> print(launch.str(5, radius=False), rate.str(5, radius=False))
    0.95532 0.83333
    """

    def __init__(self, bits: int) -> None:
        self.of_balls = [load(branch(above), balls(bits)) for above in (False, True)]
        self.of_series = [load(branch(above), in_series(balls(bits), arb_series)) for above in (False, True)]

    def __call__(self, landing: Any) -> tuple[Any, Any]:
        """The launching half angle and the rate of a landing half angle."""
        series = isinstance(landing, arb_series)
        above = not (landing[0] if series else landing) < TURN
        launch, rate = (self.of_series if series else self.of_balls)[above](landing)
        return launch, rate

    def landing(self, launch: arb, bits: int) -> arb:
        """About where a particle lands that left at an exact half angle: Newton's method, not enclosed."""
        point = arb(landed(float(launch)))
        for _ in range(2 + bits.bit_length()):
            found, rate = self(point)
            point = (point - ((found - launch) / rate)).mid()
        return point


def landed(launch: float) -> float:
    """The same in floats, by halving.

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
    """`||u|| <= K*||(I - Q)u||`, `bound` above `K`; None where `X` was no good inverse.

    For vectors of sum 0 when the `sign` of the first summand is 1, for all when it is -1.
    """

    cells: int
    bound: float | None
    defect: float
    sign: int


def launching_points(cells: int) -> tuple[Matrix, Matrix]:
    """`g(-x)` and `g(x)` at the ends of cells, in cells, exact multiples of `1/GRAIN` and within that of the truth."""
    if cells not in range(2, 4097, 2):
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
    matrix = ulam(cells, sign)
    inverse = _in_floats(matrix, sign) if inverse is None else inverse
    entries = int(np.diff(matrix.indptr).max())
    rounding = (entries + 4) * UNIT * (2 * largest(inverse) + 1)
    size = spread(inverse) if sign == 1 else largest(inverse)
    displaced = 2 * (cells * 1.5 + 3) / GRAIN
    left = (matrix.T @ inverse.T).T
    left -= inverse
    left[np.diag_indices(cells)] += 1
    if sign == 1:  # less any one vector, and this one costs less than a median
        left -= left.mean(axis=1)[:, None]
    defect = largest(left) + rounding * BLANKET + size * displaced
    bound = size / (1 - defect) * BLANKET if sign in (1, -1) and defect < 0.5 else None
    return Inverted(cells, bound, defect, sign)


def _in_floats(matrix: csc_matrix, sign: int) -> Matrix:
    """About an inverse of `I - Q` on vectors of sum 0, or on all.

    The upper half of the cells is carried to the lower half `B`, so its unknowns are put into the equations of `B`, and
    what is inverted is half as large: with `r` for what `(I - Q)u` is, the equations of `B` are

        (I - Q_BB - Q_BA*Q_AB) u_B = r_B + Q_BA*r_A,     u_A = r_A + Q_AB*u_B,

    and that all `u` sum to 0 is one more, which is added to each, times the mass of its cell.
    """
    cells = matrix.shape[0]
    half = cells // 2
    rows = matrix.tocsr()
    ahead, into, out = rows[:half, :half], rows[:half, half:], rows[half:, :half]
    mass = np.full(half, 1.0 / cells)
    for _ in range(60 if sign == 1 else 0):
        mass = ahead @ mass + into @ (out @ mass)
    total = 1 + np.asarray(out.sum(axis=0)).ravel()  # what each of `u_B` adds to the sum of all
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
    """The largest `L1` norm of a column: the norm of the matrix, from above."""
    return float(abs(matrix).sum(axis=0).max()) * BLANKET


def spread(matrix: Matrix) -> float:
    """The largest distance, in `L1`, of a column from one vector: what the matrix does to vectors of sum 0, at most.

    >>> spread(np.array([[1.0, 1.0], [2.0, 2.0]]))
    0.0
    """
    about = np.median(matrix, axis=1)
    return largest(matrix - about[:, None])
