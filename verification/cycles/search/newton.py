"""Newton's method on thousands of closed chains of bounces at once, in float64.

A seed is a row of bounce parameters, an orbit that almost closes. All rows that visit the same
components are corrected together: one call of the chord kernel, one batch of small linear systems.
"""

import numpy as np
from numpy.typing import NDArray

from symbolic.tables.table import Table
from verification.arithmetic.words import ARRAYS
from verification.cycles.recurrence.chords import Chords, chord_angles

Array = NDArray[np.float64]
STEPS = 14
REACH = 0.5  # radians that a bounce may move in one step
CLOSE = 1e-11


class Corrector:
    """The chord system of a table at one contraction, for many cycles at a time."""

    def __init__(self, table: Table, lam: float) -> None:
        self.table, self.lam = table, lam

    def closed(self, components: tuple[int, ...], seeds: Array, known: Array | None = None) -> Array:
        """The cycles that Newton's method reaches from the rows of `seeds`; rows that do not settle are dropped.

        With `known` rows the equations are deflated: multiplied by `1 + 1/distance**2` for each of them, so that
        those cycles are zeros no more and a seed next to one is driven on to another (Farrell, Birkisson and Funke).

        >>> from symbolic.tables import ellipse
        >>> axes = Corrector(ellipse.at(a=2), 0.5).closed((0, 0), np.array([[1.4, -1.6], [0.1, 3.0]]))
        >>> np.round(axes, 6) + 0.0
        array([[ 1.570796, -1.570796],
               [ 0.      ,  3.141593]])
        """
        x, settled = seeds.copy(), np.zeros(len(seeds), dtype=bool)
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                active = ~settled
                if not np.any(active):
                    break
                step = self._correction(components, x[active])
                if known is not None and len(known):
                    step = step * deflation(x[active], step, known)[:, None]
                size = np.max(np.abs(step), axis=1)
                reach = np.minimum(1.0, REACH / np.maximum(size, 1e-300))
                x[active] -= reach[:, None] * step
                settled[active] = size < CLOSE
        kept: Array = x[settled & np.all(np.isfinite(x), axis=1)]
        return kept

    def diagonals(self, components: tuple[int, ...], x: Array) -> tuple[Array, Array, Array, Array]:
        """The rules at each bounce and their derivatives by the bounce before, the bounce, and the one after."""
        n, rule = len(components), Chords(self.table, components).over(ARRAYS)
        value, lower, middle, upper = (np.empty_like(x) for _ in range(4))
        for i in range(n):
            near = x[:, i - 1], x[:, i], x[:, (i + 1) % n]
            value[:, i], (lower[:, i], middle[:, i], upper[:, i]) = rule(i, near, {"lam": self.lam})
        return value, lower, middle, upper

    def _correction(self, components: tuple[int, ...], x: Array) -> Array:
        value, lower, middle, upper = self.diagonals(components, x)
        n = len(components)
        matrix = np.zeros((len(x), n, n))
        for i in range(n):
            matrix[:, i, i] += middle[:, i]
            matrix[:, i, i - 1] += lower[:, i]
            matrix[:, i, (i + 1) % n] += upper[:, i]
        good = np.all(np.isfinite(matrix), axis=(1, 2)) & np.all(np.isfinite(value), axis=1)
        matrix[~good] = np.eye(n)
        value[~good] = np.nan
        try:
            step = np.linalg.solve(matrix, value[:, :, None])
        except np.linalg.LinAlgError:
            step = np.linalg.solve(matrix + 1e-13 * np.eye(n), value[:, :, None])
        return np.asarray(step[:, :, 0], dtype=np.float64)

    def exits(self, components: tuple[int, ...], x: Array) -> Array:
        """Exit angles at each bounce."""
        n, angle = len(components), chord_angles(self.table, ARRAYS)
        ahead = [angle(components[i], components[(i + 1) % n], 0)(x[:, i], x[:, (i + 1) % n])[0] for i in range(n)]
        return np.stack(ahead, axis=1)


def deflation(x: Array, step: Array, known: Array) -> Array:
    """What each Newton step is multiplied by when the known zeros are divided out, on a closed boundary.

    Half way to a zero that is known, Newton's own step would get there; the deflated one turns back.

    >>> bool(deflation(np.array([[0.1, 0.1]]), np.array([[0.1, 0.1]]), np.zeros((1, 2)))[0] < 0)
    True
    """
    slope = np.zeros(len(x))
    for row in known:
        gap = x - row
        squared = np.sum(4 * np.sin(gap / 2) ** 2, axis=1)
        slope -= np.sum(2 * np.sin(gap) * step, axis=1) / (squared * (squared + 1) + 1e-300)
    return np.asarray(1 / (1 + slope), dtype=np.float64)
