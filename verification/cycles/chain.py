"""Cyclic tridiagonal systems, solved in linear time over any kind of number.

Row `i` of a chain says `lower[i]*x[i-1] + diagonal[i]*x[i] + upper[i]*x[i+1] = r[i]`; the chain closes by `x[n] =
sign*x[0]`, with `sign = -1` for vectors that come back negated, or a complex number of modulus 1 for vectors that come
back multiplied by it. The last unknown is set apart; the others are eliminated in order, without pivoting. The pivots
follow the direction that the cycle's derivative attracts, so in a dissipative map rounding errors (and the radii of
balls) die out along the chain instead of multiplying. A pivot that may be 0 gives `nan` balls, which prove nothing.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from verification.arithmetic.iteration import Vector

SMALL_PIVOT = 1 << 10  # a small pivot is so many times smaller than the entry beside it


@dataclass(frozen=True)
class Chain:
    """The three diagonals of a cyclic tridiagonal matrix, and its sign: 1, -1, or a complex number of modulus 1."""

    lower: Sequence[Any]
    diagonal: Sequence[Any]
    upper: Sequence[Any]
    sign: Any = 1

    def __post_init__(self) -> None:
        if not self.diagonal:
            raise ValueError("chain: no row; a cycle has a bounce at least")

    @property
    def back(self) -> Any:
        """The factor in `x[-1] = back*x[n-1]`: 1 over the sign."""
        return self.sign.conjugate()

    @property
    def rows(self) -> list[tuple[Any, Any, Any]]:
        """The three entries of each row of the matrix, as tuples."""
        return list(zip(self.lower, self.diagonal, self.upper, strict=True))

    def times(self, x: Sequence[Any]) -> Vector:
        """The product of the matrix with the vector `x`.

        >>> Chain([1, 1, 1], [2, 2, 2], [3, 3, 3], -1).times([1, 0, 0])
        [2, 1, -3]
        """
        n = len(x)
        padded = [self.back * x[-1], *x, self.sign * x[0]]
        return [
            self.lower[i] * padded[i] + self.diagonal[i] * padded[i + 1] + self.upper[i] * padded[i + 2]
            for i in range(n)
        ]


def trace_and_determinant(rows: Iterable[tuple[Any, Any, Any]], turn: int = 1) -> tuple[Any, Any]:
    """Trace and determinant of the monodromy matrix, from the three derivatives of the rule at each bounce.

    Where the orbit closes by a symmetry the matrix is that of the map followed by the inverse symmetry: `turn` is -1
    for a mirror.

    >>> trace_and_determinant([(2, 3, 1), (2, 3, 1)])
    (5.0, 4.0)
    """
    m: list[list[Any]] = [[1, 0], [0, 1]]
    determinant: Any = 1
    for before, here, after in rows:
        m = [m[1], [-(before * a + here * b) / after for a, b in zip(*m, strict=True)]]
        determinant = determinant * before / after
    return turn * (m[0][0] + m[1][1]), determinant


class Elimination:
    """A chain in which all unknowns but the last are eliminated; the pivot of the last one is called `bordering`.

    `right` and `left` are the vectors with last entry 1 that the matrix, from either side, maps to `(0, ..., 0,
    bordering)`. The matrix is singular exactly when `bordering` is 0; then `right` and `left` span its kernels.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        n, s, back = len(chain.diagonal), chain.sign, chain.back
        self.pivots: Vector = [chain.diagonal[0]][: n - 1]
        self.factors: Vector = [0][: n - 1]
        for i in range(1, n - 1):
            factor = chain.lower[i] / self.pivots[-1]
            self.factors.append(factor)
            self.pivots.append(chain.diagonal[i] - factor * chain.upper[i - 1])
        self.column: Vector = [0] * (n - 1)
        self.row: Vector = [0] * (n - 1)
        self.last = chain.diagonal[n - 1]
        if n == 1:  # both neighbours are the bounce itself
            self.last = self.last + back * chain.lower[0] + s * chain.upper[0]
        else:
            self.column[0] = back * chain.lower[0]
            self.column[-1] = self.column[-1] + chain.upper[n - 2]
            self.row[0] = s * chain.upper[n - 1]
            self.row[-1] = self.row[-1] + chain.lower[n - 1]
        self.right: Vector = [*self.inner([-c for c in self.column]), 1]
        self.left: Vector = [*self._transposed([-c for c in self.row]), 1]
        self.bordering = self.last + dot(self.row, self.right)

    def inner(self, r: Sequence[Any]) -> Vector:
        """The solution of all rows but the last, with the last unknown set to 0."""
        if not self.pivots:
            return []
        x = [r[0]]
        for i in range(1, len(self.pivots)):
            x.append(r[i] - self.factors[i] * x[i - 1])
        x[-1] = x[-1] / self.pivots[-1]
        for i in range(len(x) - 2, -1, -1):
            x[i] = (x[i] - self.chain.upper[i] * x[i + 1]) / self.pivots[i]
        return x

    def _transposed(self, r: Sequence[Any]) -> Vector:
        if not self.pivots:
            return []
        x = [r[0] / self.pivots[0]]
        for i in range(1, len(self.pivots)):
            x.append((r[i] - self.chain.upper[i - 1] * x[i - 1]) / self.pivots[i])
        for i in range(len(x) - 2, -1, -1):
            x[i] = x[i] - self.factors[i + 1] * x[i + 1]
        return x

    def solve(self, r: Sequence[Any]) -> Vector:
        """The solution `x` of `chain.times(x) = r`."""
        return self.bordered([], [], [], r)

    def bordered(self, column: Sequence[Any], row: Sequence[Any], corner: Sequence[Any], r: Sequence[Any]) -> Vector:
        """The solution of the chain with one more unknown and one more equation.

        `column` has the coefficients of the new unknown in the chain's rows; `row` and `corner` form the new equation.
        If `column` is empty, no unknown and no equation is added. `r` is the right side.

        >>> from fractions import Fraction
        >>> one = Elimination(Chain(*[[Fraction(1)] * 3, [Fraction(4)] * 3, [Fraction(1)] * 3]))
        >>> [int(x) for x in one.bordered([1, 0, 0], [1, 1, 1], [0], [5, 6, 6, 3])]
        [1, 1, 1, -1]
        """
        sides = _Sides(self.inner, self.row, self.right)
        return self._bordered(sides, column, row, corner, r)

    def transposed(self, column: Sequence[Any], row: Sequence[Any], corner: Sequence[Any], r: Sequence[Any]) -> Vector:
        """The solution of the transpose of the system that `bordered` solves, from the same factorisation.

        >>> from fractions import Fraction
        >>> one = Elimination(Chain(*[[Fraction(n)] * 3 for n in (1, 4, 2)]))
        >>> [int(x) for x in one.transposed([], [], [], [8, 4, 9])]  # rows 4 1 2, 2 4 1, 1 2 4
        [1, 0, 2]
        """
        sides = _Sides(self._transposed, self.column, self.left)
        return self._bordered(sides, row, column, corner, r)

    def _bordered(
        self, sides: "_Sides", column: Sequence[Any], row: Sequence[Any], corner: Sequence[Any], r: Sequence[Any]
    ) -> Vector:
        n, (inner, far, kernel) = len(self.chain.diagonal), sides
        plain = inner(r[: n - 1])
        gap = r[n - 1] - dot(far, plain)
        if not column:
            last = gap / self.bordering
            return [p + last * v for p, v in zip(plain, kernel, strict=False)] + [last]
        with_new = inner(column[: n - 1])
        a, b = self.bordering, column[n - 1] - dot(far, with_new)
        c, d = dot(row, kernel), corner[0] - dot(row, with_new)
        other = r[n] - dot(row, plain)
        determinant = a * d - b * c
        last, new = (gap * d - b * other) / determinant, (a * other - gap * c) / determinant
        found = [p - new * m + last * v for p, m, v in zip(plain, with_new, kernel, strict=False)]
        return [*found, last, new]


def by_cramer(chain: Chain, r: Sequence[Any], transposed: bool = False) -> Vector | None:
    """The solution of a chain of two rows whose first pivot is small, or may be 0; None for any other chain.

    This occurs at a diameter whose two ends are each other's centres of curvature, such as the ellipse's minor axis at
    `a = sqrt(2)`, where the diagonal is 0 and yet the matrix is regular.

    >>> by_cramer(Chain([1, 2], [0, 0], [1, 2]), [4, 6]), by_cramer(Chain([1, 2], [3, 0], [1, 2]), [4, 6])
    ([1.5, 2.0], None)
    """
    if len(chain.diagonal) != 2:
        return None
    (a, d), s = chain.diagonal, chain.sign
    b, c = chain.upper[0] + s * chain.lower[0], chain.lower[1] + s * chain.upper[1]
    if not abs(a) * SMALL_PIVOT < abs(b):
        return None
    b, c = (c, b) if transposed else (b, c)
    determinant = a * d - b * c
    return [(r[0] * d - b * r[1]) / determinant, (a * r[1] - c * r[0]) / determinant]


class _Sides(NamedTuple):
    """Solver of all rows but the last, last row, and kernel vector, for an eliminated matrix or its transpose."""

    inner: Callable[[Sequence[Any]], Vector]
    far: Vector
    kernel: Vector


def dot(x: Sequence[Any], y: Sequence[Any]) -> Any:
    """The inner product of two vectors; further entries of the longer one are ignored."""
    total: Any = 0
    for p, r in zip(x, y, strict=False):
        total = total + p * r
    return total
