"""The stability of cycles with a bounce on a join where the curvature jumps, from the derivatives on all sides.

Let `x` be the bounces and `F(x) = 0` the collision rules; let parameters continue over a join with matched speeds.

1. `F` is continuous, and analytic on each side of the hyperplanes `x[i] = join`. So `F(x) - F(y) = S*(x - y)` in a box,
`S` in the convex hull of the Jacobians of all sides there: an interval Newton or Krawczyk step with the union of their
balls proves that the box has exactly one cycle, on whichever side it lies [Krawczyk1969]. 2. In the coordinates
`(x[-1], x[0])` the return map has one derivative `M` for each choice of sides. If all products of `L` of them are below
1 in one norm, `L` returns contract: the cycle attracts. 3. If `det(1 - M) < 0` for all products `M` of one length, the
fixed point of that power has a negative index. An attracting cycle has the index 1, so a cycle with a negative index
does not attract. 4. When the sign of `det(1 - M)` is the same on both sides of a join, a branch that crosses it keeps
the direction of its parameter: persistence. When the signs differ it turns back there: a nonsmooth fold
[NusseYorke1992]. 5. Tests 2 and 3 may both fail; then nothing is decided.
"""

from collections.abc import Iterable, Iterator, Sequence
from enum import Enum
from itertools import islice
from typing import Any

import numpy as np

Matrix = tuple[tuple[Any, Any], tuple[Any, Any]]
Row = tuple[Any, Any, Any]
WORDS = 4096  # products of derivatives that are formed, at most
LONGEST = 64  # returns after which lengths are compared
ROUNDS = 60  # of the iteration to a norm


class OneSided(Enum):
    """The verdict on a cycle's stability that follows from all its one-sided derivatives."""

    ATTRACTS = "attracts: in one norm the products of its one-sided derivatives contract, whichever sides are taken"
    REPELS = "does not attract: det(1 - M) < 0 on all sides, and an attracting cycle has the index 1"
    OPEN = "not decided: the two sides differ, or no norm was found in which all of them contract"

    @property
    def stability(self) -> str:
        """The verdict in one word: stable, unstable or undecided.

        >>> OneSided.OPEN.stability
        'undecided'
        """
        return {OneSided.ATTRACTS: "stable", OneSided.REPELS: "unstable"}.get(self, "undecided")


def of_rows(rows: Iterable[Row], slopes: Sequence[Any]) -> Matrix:
    """The derivative of the return map in two successive bounces, from the derivatives of the rule at each bounce.

    `slopes[i]` is the speed of the parameter of bounce `i` on its own component when the parameter that continues over
    the join has speed 1.

    >>> of_rows([(2.0, 3.0, 1.0), (2.0, 3.0, 1.0)], [1.0, 1.0])
    ((-2.0, -3.0), (6.0, 7.0))
    """
    rows, m = list(rows), ((1, 0), (0, 1))
    for i, (before, here, after) in enumerate(rows):
        low, own, high = before * slopes[i - 1], here * slopes[i], after * slopes[(i + 1) % len(rows)]
        (a, b), (c, d) = m
        m = (c, d), (-(low * a + own * c) / high, -(low * b + own * d) / high)
    return m


def times(p: Matrix, q: Matrix) -> Matrix:
    """The product of two matrices."""
    (a, b), (c, d) = p
    (e, f), (g, h) = q
    return (a * e + b * g, a * f + b * h), (c * e + d * g, c * f + d * h)


def words(matrices: Sequence[Matrix]) -> Iterator[list[Matrix]]:
    """The products of one matrix, of two, and so on, as long as there are at most `WORDS` products of one length."""
    found = list(matrices)
    while len(found) <= WORDS:
        yield found
        found = [times(m, word) for m in matrices for word in found]


def at_one(m: Matrix) -> Any:
    """`det(1 - M)`."""
    (a, b), (c, d) = m
    return (1 - a) * (1 - d) - b * c


def verdict(matrices: Sequence[Matrix]) -> OneSided:
    """The verdict from one-sided derivatives, in floats or balls; with balls it is proved.

    >>> half, kink = ((0.5, 0.0), (0.0, 0.4)), ((0.5, 0.0), (9.0, 0.4))
    >>> [verdict(some).name for some in ((half, kink), (((2.0, 0.0), (0.0, 0.4)),), (half, ((2.0, 0.0), (0.0, 0.4))))]
    ['ATTRACTS', 'REPELS', 'OPEN']
    """
    if any(all(at_one(m) < 0 for m in products) for products in islice(words(matrices), 2)):
        return OneSided.REPELS
    frame = _frame(matrices)
    framed = words([_within(frame, m) for m in matrices])
    shrinks = any(all(map(_shrinks, products)) for products in islice(framed, LONGEST))
    return OneSided.ATTRACTS if shrinks else OneSided.OPEN


def _frame(matrices: Sequence[Matrix]) -> Matrix:
    """A triangular frame in whose norm the derivatives are small; proofs do not depend on how the frame was found."""
    floats = np.array([[[float(x) for x in row] for row in m] for m in matrices])
    gram = np.eye(2)
    for _ in range(ROUNDS):
        gram = np.eye(2) + np.mean(np.transpose(floats, (0, 2, 1)) @ gram @ floats, axis=0)
        if not np.all(np.isfinite(gram)) or np.max(gram) > 1e12:
            gram = np.eye(2)
            break
    a = float(np.sqrt(gram[0, 0]))
    b = float(gram[0, 1] / a)
    return (a, b), (0.0, float(np.sqrt(max(gram[1, 1] - b * b, 1e-9))))


def _within(frame: Matrix, m: Matrix) -> Matrix:
    """A matrix in the coordinates of a triangular frame."""
    (a, b), (_, d) = frame
    one = times(frame, m)
    zero = 0 * one[0][0]
    return times(one, ((1 / (a + zero), -b / (a * (d + zero))), (zero, 1 / (d + zero))))


def _shrinks(m: Matrix) -> bool:
    """Are both singular values of the matrix below 1?"""
    (a, b), (c, d) = m
    squares, det = a * a + b * b + c * c + d * d, a * d - b * c
    return bool(det * det < 1 and squares < 1 + det * det)
