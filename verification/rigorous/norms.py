"""Contraction in a norm: derivatives in other coordinates, and weights for which derivatives shrink vectors."""

import numpy as np

from verification.arithmetic.arrays import Array, BallArray, Indices

Matrix = list[list[BallArray]]
ROUNDS = 400  # of power iterations
LEAST = 1e-250  # an entry of a vector: products with smaller ones underflow
SLACK = 1e-9  # relative; more than the rounding of a dozen operations


def shrinkage(size: Array, target: Indices) -> float:
    """A number `q` such that `size*v <= q*v'` for vectors `v > 0`, one for each set; `v'` is that of the set's target.

    `size` has shape `(2, 2, sets)` and bounds the derivative's entries in modulus over each set; set `i` is mapped to
    set `target[i]`. Two orbits that visit the same sets approach each other like `q**n`. `q` is infinite if a
    bound is negative, infinite or nan, or if a set has no target, which is written -1.

    >>> round(shrinkage(np.array([[[0.5], [8.0]], [[0.0], [0.25]]]), np.array([0])), 2)
    0.5
    """
    if not (size.size and np.all((size >= 0) & (size < np.inf)) and np.all(target >= 0)):
        return np.inf
    size, vectors = size * (1 + SLACK) + 1e-300, np.ones((2, size.shape[2]))
    for _ in range(ROUNDS):  # the bound below holds for any positive vectors
        image = np.zeros_like(vectors)
        np.maximum.at(image.T, target, np.einsum("ijk,jk->ik", size, vectors).T)
        vectors = vectors + image
        vectors = np.maximum(vectors / vectors.max(), LEAST)
    moved = np.einsum("ijk,jk->ik", size, vectors)
    return float(np.max(moved / vectors[:, target])) * (1 + SLACK)


def times(first: Matrix, second: Matrix) -> Matrix:
    """The product of two 2 by 2 matrices."""
    return [[first[i][0] * second[0][j] + first[i][1] * second[1][j] for j in (0, 1)] for i in (0, 1)]


def in_frame(frame: tuple[tuple[float, float], tuple[float, float]], matrix: Matrix) -> Matrix:
    """The product `frame**-1 * matrix`; `frame` is a 2 by 2 matrix, given by its rows."""
    (a, b), (c, d) = ([BallArray(x) for x in row] for row in frame)
    det = a * d - b * c
    return times([[d / det, -b / det], [-c / det, a / det]], matrix)
