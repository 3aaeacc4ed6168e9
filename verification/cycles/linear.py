"""The matrices of a ring: its linearised rules, what they say about multipliers, and their null vectors.

Elimination along the chain (`verification.cycles.chain`) does not pivot: right for one cycle in any
arithmetic, but a branch passes superstable cycles, where a pivot vanishes. Here float64 matrices are
factored with pivoting, densely while they are small and by sparse elimination, linear in the period, beyond.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from verification.cycles.recurrence import Array, Closure, Terms

DENSE = 96  # unknowns up to which a dense factorisation is the faster one


def solved(matrix: Any, right: Array) -> Array:
    """The solution of a square system; `ValueError` when the matrix is singular or not finite."""
    try:
        if matrix.shape[0] <= DENSE:
            return np.linalg.solve(matrix, right)
        found: Array = splu(sparse.csc_matrix(matrix)).solve(right)
    except (np.linalg.LinAlgError, RuntimeError):
        raise ValueError("a singular matrix") from None
    return found


def ring_matrix(terms: Terms[Array], closure: Closure, sign: int = 1) -> Any:
    """The linearised rules on vectors that come back multiplied by `sign`; sparse when it is large.

    >>> one = np.ones(3)
    >>> t = Terms(one, (one, 2 * one, 3 * one), {}, {}, {})
    >>> ring_matrix(t, Closure(), -1).tolist()
    [[2.0, 3.0, -1.0], [1.0, 2.0, 3.0], [-3.0, 1.0, 2.0]]
    """
    lower, diagonal, upper = terms.slope
    n = len(diagonal)
    at = np.arange(n)
    back, forth = np.ones(n), np.ones(n)
    back[0] = forth[-1] = sign * closure.turn
    rows, columns = np.tile(at, 3), np.concatenate([at, (at - 1) % n, (at + 1) % n])
    values = np.concatenate([diagonal, lower * back, upper * forth])
    if n > DENSE:
        return sparse.csc_matrix((values, (rows, columns)), shape=(n, n))
    made = np.zeros((n, n))
    np.add.at(made, (rows, columns), values)
    return made


def beside(matrix: Any, column: Array) -> Any:
    """A matrix with one column more."""
    if sparse.issparse(matrix):
        return sparse.hstack([matrix, column[:, None]], format="csc")
    return np.hstack([matrix, column[:, None]])


def above(matrix: Any, row: Array) -> Any:
    """A matrix with one row more."""
    if sparse.issparse(matrix):
        return sparse.vstack([matrix, row[None, :]], format="csc")
    return np.vstack([matrix, row])


def dense(matrix: Any) -> Array:
    """A matrix as an array."""
    return np.asarray(matrix.toarray() if sparse.issparse(matrix) else matrix, dtype=np.float64)


@dataclass(frozen=True)
class Spectrum:
    """`det(M - 1)`, `det(M + 1)` and `det M` of a cycle's monodromy matrix `M`."""

    at_one: float
    at_minus_one: float
    determinant: float

    @property
    def trace(self) -> float:
        """`mu_1 + mu_2`."""
        return (self.at_minus_one - self.at_one) / 2

    @property
    def multipliers(self) -> tuple[complex, complex]:
        """The larger one in modulus first.

        >>> Spectrum(0.5, 4.5, 0.0).multipliers
        ((2+0j), 0j)
        """
        half, det = self.trace / 2, self.determinant
        root = np.sqrt(complex(half * half - det))
        large = half + (root if (half * root.conjugate()).real >= 0 else -root)
        return complex(large), complex(det / large if large else 0.0)

    @property
    def stable(self) -> bool:
        """Both multipliers inside the unit circle (Jury's criterion)."""
        return self.at_one > 0 and self.at_minus_one > 0 and self.determinant < 1


def spectrum(terms: Terms[Array], closure: Closure) -> Spectrum:
    """The three numbers, from determinants of the ring: none cancels where a multiplier nears 1 or -1."""
    lower, _, upper = terms.slope
    n = len(lower)
    sign_u, log_u = np.prod(np.sign(upper)), np.sum(np.log(np.abs(upper)))
    at = []
    for s in (1, -1):
        sign, log = _determinant(ring_matrix(terms, closure, s))
        at.append(float(s * closure.turn * (-1) ** (n + 1) * sign * sign_u * np.exp(min(log - log_u, 700.0))))
    return Spectrum(at[0], at[1], float(np.prod(lower / upper)))


def _determinant(matrix: Any) -> tuple[float, float]:
    """Sign and logarithm of a determinant."""
    if matrix.shape[0] <= DENSE:
        sign, log = np.linalg.slogdet(matrix)
        return float(sign), float(log)
    try:
        factors = splu(sparse.csc_matrix(matrix))
    except RuntimeError:
        return 0.0, -np.inf
    diagonal = factors.U.diagonal()
    sign = np.prod(np.sign(diagonal)) * _parity(factors.perm_r) * _parity(factors.perm_c)
    return float(sign), float(np.sum(np.log(np.abs(diagonal))))


def _parity(permutation: Array) -> int:
    seen, odd = np.zeros(len(permutation), dtype=bool), 0
    for start in range(len(permutation)):
        length, here = 0, start
        while not seen[here]:
            seen[here], here, length = True, int(permutation[here]), length + 1
        odd += max(length - 1, 0)
    return -1 if odd % 2 else 1


def null_vectors(matrix: Any) -> tuple[Array, Array]:
    """Right and left vectors of the smallest singular value, of root mean square 1."""
    left, _, right = np.linalg.svd(dense(matrix))
    scale = np.sqrt(len(left))
    return right[-1] * scale, left[:, -1] * scale
