"""Manifolds grown from their local series to a given length, with points as close as the curve's bends ask for.

The parameter of the series is good for the whole branch: a point far out is one near the saddle, some
rounds of the map later (or earlier, on a stable manifold). So new points are put between neighbours
that are too far apart, or between which the curve turns too much, and nothing is interpolated.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from verification.arithmetic import ARRAYS
from verification.manifolds.series import Local

FIRST = 24  # points of a round before any is added
PASSES = 14
SETTLED = 3.0  # `ln(abs(z))` from which a short round means a sink
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Branch:
    """Points in the order of the curve, from the saddle outwards, and their parameters `ln(abs(z))`."""

    here: Array
    following: Array
    parameter: Array
    x: Array
    y: Array

    @property
    def length(self) -> float:
        """Arc length of the polygon, in the plane of the map."""
        return float(np.sum(np.hypot(np.diff(self.x), np.diff(self.y))))


def branch(local: Local, side: int, length: float, spacing: float = 0.02, turning: float = 0.2) -> Branch:
    """One branch of a manifold, `side` 1 or -1, until it is `length` long.

    It ends sooner where it leaves the domain of the map, or at a sink: where a round adds less than ten times
    `spacing`.

    >>> from sympy import Rational
    >>> from verification.manifolds.recurrence import Henon
    >>> from verification.manifolds.saddle import Orbit, saddle
    >>> from verification.manifolds.series import local
    >>> fixed = saddle(Orbit("fixed point", (0.6,)), Henon(Rational(3, 10)), 1.4)
    >>> 5 < branch(local(fixed, unstable=True), 1, 5).length < 5.1
    True
    """
    if side not in (1, -1) or not length > 0:
        raise ValueError(f"manifold: side = {side}, length = {length}; accepted: side 1 or -1, a positive length")
    step = abs(math.log(abs(float(local.factor))))
    low, done, pieces = -step, 0.0, []
    while done < length:
        piece = _piece(local, side, low, low + step, spacing, turning)
        pieces.append(piece)
        whole = np.isfinite(piece.x)
        if not whole.all() or (low > SETTLED and piece.length < 10 * spacing):
            break
        done += piece.length
        low += step
    fields = [np.concatenate([getattr(p, name) for p in pieces]) for name in Branch.__dataclass_fields__]
    good = np.cumsum(~np.isfinite(fields[3])) == 0
    path = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fields[3]), np.diff(fields[4])))])
    good &= np.concatenate([[True], path[:-1] <= length])
    return Branch(*(field[good] for field in fields))


def _piece(local: Local, side: int, low: float, high: float, spacing: float, turning: float) -> Branch:
    """The points with `ln(abs(z))` from `low` up to, but not at, `high`."""
    made = _points(local, side, np.linspace(low, high, FIRST))
    for _ in range(PASSES):
        dx, dy = np.diff(made.x), np.diff(made.y)
        far = np.hypot(dx, dy) > spacing
        turn = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(dy, dx))))) > turning
        small = np.hypot(dx, dy) < spacing / 1000
        bent = np.concatenate([turn, [False]]) | np.concatenate([[False], turn])
        where = np.nonzero(far | (bent & ~small))[0]
        if not where.size:
            break
        more = _points(local, side, (made.parameter[where] + made.parameter[where + 1]) / 2)
        order = np.argsort(np.concatenate([made.parameter, more.parameter]), kind="stable")
        joined = (
            np.concatenate([getattr(made, name), getattr(more, name)])[order] for name in Branch.__dataclass_fields__
        )
        made = Branch(*joined)
    return Branch(*(getattr(made, name)[:-1] for name in Branch.__dataclass_fields__))


def _points(local: Local, side: int, parameter: Array) -> Branch:
    """The points at `z = side*exp(parameter)`, those of one number of rounds together."""
    rounds = np.maximum(0, np.ceil(parameter / abs(math.log(abs(float(local.factor)))))).astype(int)
    here, following = np.full(parameter.size, np.nan), np.full(parameter.size, np.nan)
    for count in np.unique(rounds):
        those = rounds == count
        here[those], following[those] = far(local, side * np.exp(parameter[those]), int(count))
    x, y = local.saddle.map.over(ARRAYS).plane(here, following)
    return Branch(here, following, parameter, np.asarray(x), np.asarray(y))


def far(local: Local, z: Array, rounds: int) -> tuple[Any, Any]:
    """The points at `z` of the manifold, from those `rounds` rounds nearer to the saddle."""
    map, orbit, letter = local.saddle.map.over(ARRAYS), local.saddle.orbit, float(local.saddle.letter)
    outwards = abs(float(local.factor)) > 1
    factor = float(local.factor) if outwards else 1 / float(local.factor)
    here, following = local.points(z / factor**rounds)
    shift = orbit.shifted(map)
    for _ in range(rounds):
        if not outwards:
            here, following = orbit.sign * here + shift, orbit.sign * following + shift
        for _ in orbit.start:
            if outwards:
                here, following = following, map.following(here, following, letter)
            else:
                here, following = map.previous(here, following, letter), here
        if outwards:
            here, following = orbit.sign * (here - shift), orbit.sign * (following - shift)
        if map.turn:  # a mirror leaves the next bounce behind, where the map takes it ahead
            following = here + np.remainder(following - here, 2 * np.pi)
    return here, following
