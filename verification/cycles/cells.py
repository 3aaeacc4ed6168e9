"""Cycles in float64: the matrices of a ring, Newton's method on thousands of rings, and a count of cycles by cells.

Elimination along the chain (`verification.cycles.chain`) does not pivot. This suits a single cycle in any arithmetic,
but a branch passes superstable cycles, where a pivot vanishes. Here float64 matrices are factored with pivoting,
densely while they are small and by sparse elimination, linear in the period, beyond.

A seed is the row of bounce parameters of an orbit that almost closes. All rows that visit the same components are
corrected together, by one call of the chord kernel and one batch of small linear systems.

The count by cells checks the search, which uses this Newton's method. Cells of phase space are quartered until `T**n`
is affine on them. The displacement `v = (sin(theta_n - theta), phi_n - phi)` is continuous on a smooth convex table. On
a cell where its values at the corners and the centre are affine up to a small deviation, the zero of the affine map is
in the cell or is not; where the deviation is too large the cell is quartered. The index is the sign of the determinant
of the affine part. The count is sampled in float64 and so is no proof, but it shares no seeds, chord system or symmetry
with the search.
"""

from dataclasses import dataclass
from enum import Enum
from functools import cache
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.backends import elementary
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import ARRAYS
from verification.arithmetic.iteration import Stop, in_rows
from verification.cycles.chords import Chords, chord_angles
from verification.cycles.recurrence import Array, Closure, Terms

DENSE = 96  # unknowns up to which a dense factorisation is the faster one


def solved(matrix: Any, right: Array) -> Array:
    """The solution of a square system; `ValueError` when the matrix is singular or not finite."""
    try:
        if matrix.shape[0] <= DENSE:
            return np.linalg.solve(matrix, right)
        found: Array = _factors(matrix).solve(right)
    except (np.linalg.LinAlgError, RuntimeError):
        raise ValueError("a singular matrix") from None
    return found


def _factors(matrix: Any) -> Any:
    """The LU factors of a sparse matrix. SciPy's sparse module is imported here, as most cycles do not need it."""
    from scipy import sparse
    from scipy.sparse.linalg import splu

    return splu(sparse.csc_matrix(matrix))


def ring_matrix(terms: Terms[Array], closure: Closure, sign: int = 1) -> Any:
    """The matrix of the linearised rules on vectors that close with a factor `sign`; sparse if the ring is long.

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
        from scipy import sparse

        return sparse.csc_matrix((values, (rows, columns)), shape=(n, n))
    made = np.zeros((n, n))
    np.add.at(made, (rows, columns), values)
    return made


def beside(matrix: Any, column: Array) -> Any:
    """The matrix with one column added on the right."""
    if isinstance(matrix, np.ndarray):
        return np.hstack([matrix, column[:, None]])
    from scipy import sparse

    return sparse.hstack([matrix, column[:, None]], format="csc")


def above(matrix: Any, row: Array) -> Any:
    """The matrix with one row added below."""
    if isinstance(matrix, np.ndarray):
        return np.vstack([matrix, row])
    from scipy import sparse

    return sparse.vstack([matrix, row[None, :]], format="csc")


def dense(matrix: Any) -> Array:
    """The matrix as a dense array."""
    return np.asarray(matrix if isinstance(matrix, np.ndarray) else matrix.toarray(), dtype=np.float64)


@dataclass(frozen=True)
class MonodromyDeterminants:
    """The determinants `det(M - 1)`, `det(M + 1)` and `det M` of a cycle's monodromy matrix `M`."""

    at_one: float
    at_minus_one: float
    determinant: float

    @property
    def trace(self) -> float:
        """The sum of the multipliers."""
        return (self.at_minus_one - self.at_one) / 2

    @property
    def multipliers(self) -> tuple[complex, complex]:
        """The multipliers, the one larger in modulus first.

        >>> MonodromyDeterminants(0.5, 4.5, 0.0).multipliers
        ((2+0j), 0j)
        """
        half, det = self.trace / 2, self.determinant
        root = np.sqrt(complex(half * half - det))
        large = half + (root if (half * root.conjugate()).real >= 0 else -root)
        return complex(large), complex(det / large if large else 0.0)

    @property
    def stable(self) -> bool:
        """Are both multipliers inside the unit circle (Jury's criterion)?"""
        return self.at_one > 0 and self.at_minus_one > 0 and self.determinant < 1


class CycleType(Enum):
    """Stability of a cycle: elliptic, hyperbolic and parabolic where the map preserves areas.

    >>> CycleType.of((-1 + 0j, -1 + 0j), elastic=True), CycleType.of((0.5j, -0.5j), elastic=False)
    (<CycleType.PARABOLIC: 'parabolic'>, <CycleType.STABLE: 'stable'>)
    """

    STABLE = "stable"
    UNSTABLE = "unstable"
    ELLIPTIC = "elliptic"
    HYPERBOLIC = "hyperbolic"
    PARABOLIC = "parabolic"
    UNDECIDED = "undecided"  # its derivatives on the two sides of a join disagree

    @classmethod
    def of(cls, multipliers: tuple[complex, complex], elastic: bool) -> "CycleType":
        """The type of a cycle with these multipliers, the larger in modulus first; if `elastic`, their product is 1."""
        large = multipliers[0]
        if not elastic:
            return cls.STABLE if max(map(abs, multipliers)) < 1 else cls.UNSTABLE
        return cls.ELLIPTIC if large.imag else cls.PARABOLIC if abs(large) == 1 else cls.HYPERBOLIC


def spectrum(terms: Terms[Array], closure: Closure) -> MonodromyDeterminants:
    """The spectrum from determinants of the ring's matrices, accurate also where a multiplier is near 1 or -1."""
    lower, _, upper = terms.slope
    n = len(lower)
    sign_u, log_u = np.prod(np.sign(upper)), np.sum(elementary.log(np.abs(upper)))
    at = []
    for s in (1, -1):
        sign, log = _determinant(ring_matrix(terms, closure, s))
        at.append(float(s * closure.turn * (-1) ** (n + 1) * sign * sign_u * elementary.exp(min(log - log_u, 700.0))))
    return MonodromyDeterminants(at[0], at[1], float(np.prod(lower / upper)))


def _determinant(matrix: Any) -> tuple[float, float]:
    """Sign of a determinant, and logarithm of its absolute value."""
    if matrix.shape[0] <= DENSE:
        sign, log = np.linalg.slogdet(matrix)
        return float(sign), float(log)
    try:
        factors = _factors(matrix)
    except RuntimeError:
        return 0.0, -np.inf
    diagonal = factors.U.diagonal()
    sign = np.prod(np.sign(diagonal)) * _parity(factors.perm_r) * _parity(factors.perm_c)
    return float(sign), float(np.sum(elementary.log(np.abs(diagonal))))


def _parity(permutation: Array) -> int:
    seen, odd = np.zeros(len(permutation), dtype=bool), 0
    for start in range(len(permutation)):
        length, here = 0, start
        while not seen[here]:
            seen[here], here, length = True, int(permutation[here]), length + 1
        odd += max(length - 1, 0)
    return -1 if odd % 2 else 1


def null_vectors(matrix: Any) -> tuple[Array, Array]:
    """Right and left singular vectors of the smallest singular value, of root mean square 1."""
    left, _, right = np.linalg.svd(dense(matrix))
    scale = np.sqrt(len(left))
    return right[-1] * scale, left[:, -1] * scale


@cache
def radians(table: Table) -> float:
    """Radians per unit of the parameter: a single component runs one whole turn, and none of several more than one.

    >>> from symbolic.tables import circle
    >>> radians(circle)
    1.0
    """
    longest = max(float(part.end - part.start) for part in table.components)
    return 2 * pi / longest if len(table.components) == 1 else min(1.0, 2 * pi / longest)


NEWTON = Stop(enough=1e-11, steps=14, reach=0.5)


class Corrector:
    """Newton's method on the chord system of a table at one contraction, for many cycles at a time."""

    def __init__(self, table: Table, lam: float, law: Law = PAPERS_LAW) -> None:
        self.table, self.lam, self.law = table, lam, law

    def closed(self, components: tuple[int, ...], seeds: Array, known: Array | None = None) -> Array:
        """The cycles that Newton's method reaches from the rows of `seeds`; rows that do not converge are dropped.

        With `known` rows the equations are deflated: multiplied by `1 + 1/distance**2` for each of them, so that those
        cycles are no zeros any more and a seed next to one leads to another (Farrell, Birkisson and Funke).

        >>> from symbolic.tables import ellipse
        >>> axes = Corrector(ellipse.at(a=2), 0.5).closed((0, 0), np.array([[1.4, -1.6], [0.1, 3.0]]))
        >>> np.round(axes, 6) + 0.0
        array([[ 1.570796, -1.570796],
               [ 0.      ,  3.141593]])
        """

        def correction(x: Array) -> Array:
            step = self._correction(components, x)
            if known is None or not len(known):
                return step
            return step * deflation(*(radians(self.table) * rows for rows in (x, step, known)))[:, None]

        x, settled = in_rows(correction, seeds, NEWTON)
        kept: Array = x[settled]
        return kept

    def diagonals(self, components: tuple[int, ...], x: Array) -> tuple[Array, Array, Array, Array]:
        """The rule's value at each bounce, and its derivatives with respect to the bounces before, here and after."""
        n, rule = len(components), Chords(self.table, components, law=self.law).over(ARRAYS)
        if len(set(components)) == 1:  # one formula for all bounces
            terms = rule(0, (np.roll(x, 1, axis=1), x, np.roll(x, -1, axis=1)), {"lam": self.lam})
            lower, middle, upper = (np.broadcast_to(slope, x.shape) for slope in terms.slope)
            return terms.value, lower, middle, upper
        value, lower, middle, upper = (np.empty_like(x) for _ in range(4))
        for i in range(n):
            near = x[:, i - 1], x[:, i], x[:, (i + 1) % n]
            terms = rule(i, near, {"lam": self.lam})
            value[:, i], (lower[:, i], middle[:, i], upper[:, i]) = terms.value, terms.slope
        return value, lower, middle, upper

    def at_one(self, components: tuple[int, ...], x: Array) -> Array:
        """The absolute value of `det(1 - M)`, with the monodromy matrix `M` of the cycle in each row."""
        _, *bands = self.diagonals(components, x)
        with np.errstate(all="ignore"):
            log = np.linalg.slogdet(_rings(*bands))[1] - np.sum(elementary.log(np.abs(bands[2])), axis=1)
            return np.asarray(elementary.exp(np.minimum(log, 700.0)), dtype=np.float64)

    def _correction(self, components: tuple[int, ...], x: Array) -> Array:
        value, *bands = self.diagonals(components, x)
        n, matrix = len(components), _rings(*bands)
        good = np.all(np.isfinite(matrix), axis=(1, 2)) & np.all(np.isfinite(value), axis=1)
        matrix[~good] = np.eye(n)
        value[~good] = np.nan
        try:
            step = np.linalg.solve(matrix, value[:, :, None])
        except np.linalg.LinAlgError:
            matrix += 1e-13 * np.eye(n)
            lost = np.linalg.slogdet(matrix)[0] == 0  # entries so large that this changes nothing
            matrix[lost], value[lost] = np.eye(n), np.nan
            step = np.linalg.solve(matrix, value[:, :, None])
        return np.asarray(step[:, :, 0], dtype=np.float64)

    def exits(self, components: tuple[int, ...], x: Array) -> Array:
        """The exit angle at each bounce of each row."""
        n, angle = len(components), chord_angles(self.table, ARRAYS)
        with np.errstate(all="ignore"):  # where bounces meet
            ahead = [angle(components[i], components[(i + 1) % n], 0)(x[:, i], x[:, (i + 1) % n])[0] for i in range(n)]
        return np.stack(ahead, axis=1)


def _rings(lower: Array, middle: Array, upper: Array) -> Array:
    """The cyclic tridiagonal matrices, one for each row of the three diagonals."""
    count, n = middle.shape
    matrix = np.zeros((count, n, n))
    for i in range(n):
        matrix[:, i, i] += middle[:, i]
        matrix[:, i, i - 1] += lower[:, i]
        matrix[:, i, (i + 1) % n] += upper[:, i]
    return matrix


def deflation(x: Array, step: Array, known: Array) -> Array:
    """The factor of each Newton step, when the known zeros on a closed boundary are divided out.

    Near a known zero, the factor of a step that leads to it is negative, so that the deflated step turns back.
    Distances between all rows and all known zeros come from two matrix products.

    >>> bool(deflation(np.array([[0.1, 0.1]]), np.array([[0.1, 0.1]]), np.zeros((1, 2)))[0] < 0)
    True
    """
    turned = np.concatenate([np.cos(x), np.sin(x)], axis=1)
    moved = np.concatenate([-np.sin(x) * step, np.cos(x) * step], axis=1)
    zeros = np.concatenate([np.cos(known), np.sin(known)], axis=1)
    squared = np.maximum(2 * x.shape[1] - 2 * np.einsum("ik,jk->ij", turned, zeros), 0)  # on one core, unlike `@`
    ahead = -2 * np.einsum("ik,jk->ij", moved, zeros)
    slope = -np.sum(ahead / (squared * (squared + 1) + 1e-300), axis=1)
    return np.asarray(1 / (1 + slope), dtype=np.float64)


COLUMNS, ROWS = 96, 48
DEPTH = 16  # quarterings of a cell at most
MOST = 100_000  # cells of one level, at most
POINTS = 60_000  # on the boundary, at lam = 0
SAME = 1e-6


@dataclass(frozen=True)
class Zeros:
    """Numbers of fixed points of index 1 and -1, and of undecided cells (`open`): if 0, the counts are complete."""

    positive: int
    negative: int
    open: int


def fixed_points(map: PinballMap, n: int) -> Zeros:
    """Numbers of fixed points of `T**n` on a smooth convex table of one component, by index.

    >>> fixed_points(PinballMap("ellipse", lam=0.5, a=1.5), 2)
    Zeros(positive=2, negative=2, open=0)
    """
    lam = float(map.lam)
    if lam == 0:
        return _on_the_circle(map, n)
    half = np.array([pi / COLUMNS, lam * pi / 2 / ROWS])
    columns, rows = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS), indexing="ij")
    cells = np.stack([-pi + 0.07 + (2 * columns.ravel() + 1) * half[0], (2 * rows.ravel() + 1 - ROWS) * half[1]], -1)
    found: list[Array] = []
    for _ in range(DEPTH):
        zeros, unsettled = _examined(map, cells, half, n)
        found.append(zeros)
        half = half / 2
        quarters = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]) * half
        cells = (unsettled[:, None, :] + quarters[None]).reshape(-1, 2)
        if not len(cells) or len(cells) > MOST:
            break
    index = _each_once(map, np.concatenate(found), n)
    return Zeros(int(np.sum(index > 0)), int(np.sum(index < 0)), len(cells))


def _displacement(map: PinballMap, at: Array, n: int) -> tuple[Array, NDArray[np.bool_]]:
    """The displacement `v` at phase points, and whether `cos(theta_n - theta) > 0`, as near a return."""
    theta, phi = np.mod(at[..., 0].ravel() + pi, 2 * pi) - pi, np.clip(at[..., 1].ravel(), -1.57, 1.57)
    place, out = theta, phi
    for _ in range(n):
        step = map.step(place, out)
        place, out = step.theta, step.phi
    v = np.stack([np.sin(place - theta), out - phi], -1).reshape(at.shape)
    return v, (np.cos(place - theta) > 0).reshape(at.shape[:-1])


def _examined(map: PinballMap, cells: Array, half: Array, n: int) -> tuple[Array, Array]:
    """The zeros of the displacement in the decided cells, as phase points, and the centres of the undecided cells."""
    points = np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    v, near = _displacement(map, cells[:, None, :] + points[None] * half, n)
    centre, corners = v[:, 0], v[:, 1:]
    mean = corners.mean(axis=1)
    slope = np.stack(
        [
            (corners[:, [1, 3]].sum(1) - corners[:, [0, 2]].sum(1)) / 4,
            (corners[:, 2:].sum(1) - corners[:, :2].sum(1)) / 4,
        ],
        -1,
    )  # v changes by slope[:, :, k] from the centre to side k
    twist = (corners[:, 0] + corners[:, 3] - corners[:, 1] - corners[:, 2]) / 4
    rest = np.abs(twist) + 2 * np.abs(mean - centre)
    reach = np.abs(slope).sum(axis=2)
    away = np.any(np.abs(centre) > 1.2 * reach + 4 * rest + 1e-12, axis=1) & np.all(rest < 0.3 + 0 * rest, axis=1)
    away |= ~np.any(near, axis=1)
    det = slope[:, 0, 0] * slope[:, 1, 1] - slope[:, 0, 1] * slope[:, 1, 0]
    with np.errstate(all="ignore"):
        inverse = (
            np.stack(
                [
                    np.stack([slope[:, 1, 1], -slope[:, 0, 1]], -1),
                    np.stack([-slope[:, 1, 0], slope[:, 0, 0]], -1),
                ],
                1,
            )
            / det[:, None, None]
        )
        zero = -np.einsum("ijk,ik->ij", inverse, centre)
        unsure = np.einsum("ijk,ik->ij", np.abs(inverse), rest)
        outside = np.any(np.abs(zero) > 1.1 + 4 * unsure, axis=1) & np.all(unsure < 3, axis=1)
        inside = np.all(unsure < 0.2, axis=1) & np.all(np.abs(zero) < 1.2, axis=1)
    settled = away | outside | inside
    hits = cells + zero * half
    return hits[inside & ~away & near[:, 0]], cells[~settled]


def _each_once(map: PinballMap, zeros: Array, n: int) -> Array:
    """The index of each distinct zero, after refinement by Newton's method on the map itself."""
    if not len(zeros):
        return np.zeros(0)
    h, at = 1e-7, zeros
    for _ in range(5):
        shifts = np.array([[0.0, 0.0], [h, 0.0], [0.0, h]])
        v, _ = _displacement(map, at[:, None, :] + shifts[None], n)
        slope = np.stack([(v[:, 1] - v[:, 0]) / h, (v[:, 2] - v[:, 0]) / h], -1)
        step = np.linalg.solve(slope, v[:, 0][:, :, None])[:, :, 0]
        at = at - np.clip(step, -1e-2, 1e-2)
    v, near = _displacement(map, at, n)
    good = (np.max(np.abs(v), axis=1) < 1e-5) & near
    at, det = at[good], np.linalg.det(slope[good])
    key = np.stack([np.cos(at[:, 0]), np.sin(at[:, 0]), at[:, 1]], -1)
    kept: list[int] = []
    for i in range(len(key)):
        if not kept or np.min(np.max(np.abs(key[kept] - key[i]), axis=1)) > SAME:
            kept.append(i)
    return np.asarray(np.sign(det[kept]), dtype=np.float64)


def _on_the_circle(map: PinballMap, n: int) -> Zeros:
    """The count for the slap map `T0`, at `lam = 0`: sign changes of `T0**n(theta) - theta` along the boundary.

    The transverse multiplier is 0, so the index of a sign change is 1 where the function falls.
    """
    theta = -pi + (np.arange(POINTS) + 0.123) * 2 * pi / POINTS
    place = theta
    for _ in range(n):
        place = map.step(place, 0.0 * place).theta
    v, real = np.sin(place - theta), np.cos(place - theta) > 0
    crossing = (np.sign(v) != np.sign(np.roll(v, -1))) & real
    return Zeros(int(np.sum(crossing & (v > 0))), int(np.sum(crossing & (v < 0))), 0)
