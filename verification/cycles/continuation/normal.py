"""The coefficients of normal forms in float64, for any recurrence, from Taylor series along the null vector.

As in `verification.cycles.shooting.normal_form`, which has the certified ones: with `v` and `w` the vectors of
the singular ring, `e` the amplitude along `v` and `F` the rules,

    fold:  letter = critical - ([e**2] w.F)/(w.dF/dletter) * e**2,
    flip:  letter = critical - ([e**3] w.F)/speed * e**2,   speed = d(w A v)/dletter along the cycle.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from verification.arithmetic.series import Jet, jets
from verification.arithmetic.words import ARRAYS
from verification.cycles.continuation.linear import along, null_vectors, ring_matrix, solved
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.recurrence import Array, Letters, Recurrence, around

JETS = jets(ARRAYS)


@dataclass(frozen=True)
class Coefficients:
    """`branch` of `letter = critical + branch*e**2`, `e` the root mean square amplitude, and what it means.

    `supercritical` is that of a flip: the doubled cycle is born on the side where the old one is unstable.
    """

    branch: float
    bend: float
    speed: float
    supercritical: bool | None = None


def bend_of(recurrence: Recurrence, x: Array, at: Letters, kind: BifurcationKind, v: Array, w: Array) -> float:
    """`[e**2] w.F` at a fold; at a flip `[e**3] w.F` on the curve whose second order is solved for."""
    second = _series(recurrence, x, at, kind.multiplier, [v])
    if kind is BifurcationKind.FOLD:
        return float(w @ second[2])
    matrix = ring_matrix(recurrence.terms(x, at, 1), recurrence.closure)
    bent = solved(matrix, -second[2])
    return float(w @ _series(recurrence, x, at, kind.multiplier, [v, bent])[3])


def coefficients(recurrence: Recurrence, x: Array, at: Letters, kind: BifurcationKind, letter: str) -> Coefficients:
    """The normal form of a cycle where it folds or flips in `letter`."""
    terms = recurrence.terms(x, at, 2)
    v, w = null_vectors(ring_matrix(terms, recurrence.closure, kind.multiplier))
    bend = bend_of(recurrence, x, at, kind, v, w)
    if kind is BifurcationKind.FOLD:
        speed = float(w @ terms.by[letter])
        return Coefficients(-bend / speed, bend, speed)
    by_bounce, by_letter = along(terms, recurrence.closure, v, w, kind.multiplier)
    motion = solved(ring_matrix(terms, recurrence.closure), -terms.by[letter])
    speed = float(by_letter[letter] + by_bounce @ motion)
    lower, _, upper = terms.slope
    turn = recurrence.closure.turn * float(w[-1] * upper[-1] * v[0] - w[0] * lower[0] * v[-1])
    return Coefficients(-bend / speed, bend, speed, bend * turn < 0 if turn else None)


def _series(recurrence: Recurrence, x: Array, at: Letters, sign: int, directions: list[Array]) -> tuple[Any, ...]:
    """Taylor coefficients of the rules on `x + directions[0]*e + directions[1]*e**2`, one order more than given."""
    order = len(directions) + 1
    rows = [x, *directions, *([np.zeros_like(x)] * (order - len(directions)))]
    closure = recurrence.closure
    ring = [around(closure, x)]
    for k, row in enumerate(rows[1:], 1):
        close = closure.turn * sign**k
        ring.append(np.concatenate([[close * row[-1]], row, [close * row[0]]]))
    before, here, after = (Jet(*(a[part] for a in ring)) for part in (slice(0, -2), slice(1, -1), slice(2, None)))
    return tuple(
        np.asarray(c, dtype=float) + np.zeros_like(x) for c in recurrence.rule(JETS, (before, here, after), at).c
    )
