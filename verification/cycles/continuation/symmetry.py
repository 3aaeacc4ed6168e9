"""The symmetries of a table and of its cycles: which part of a cycle makes up the whole.

A rotation by `2*pi/k`, or the mirror `theta -> -theta`, that maps the boundary to itself maps cycles to
cycles. A cycle that is its own image after `m` of its `n` bounces is a ring of `m` bounces that closes
by the symmetry. Where a multiplier 1 is no fold, such a cycle gives way to two that lack the symmetry.
"""

from dataclasses import replace
from functools import cache
from math import pi, remainder

import numpy as np
from sympy import Matrix, Rational, cos, expand_trig, simplify, sin
from sympy import pi as exact_pi

from symbolic.tables.symbols import theta
from symbolic.tables.table import Table
from verification.cycles.recurrence.chords import Chords
from verification.cycles.recurrence.closure import IDENTITY, Closure
from verification.cycles.recurrence.recurrence import Array
from verification.cycles.shooting.problem import mirrored

SAME = 1e-7  # radians
ORDERS = range(12, 1, -1)


@cache
def rotations(table: Table) -> int:
    """The largest `k` up to 12 such that a turn by `2*pi/k` is proved to map the table to itself.

    >>> from symbolic.tables import cuspless, egg
    >>> rotations(egg(3)), rotations(cuspless)
    (3, 1)
    """
    if len(table.components) > 1:
        return 1
    point = Matrix(table.components[0].point)
    for k in ORDERS:
        angle = 2 * exact_pi * Rational(1, k)
        turned = Matrix([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]) * point
        values = {theta: Rational(1, 3)} | {p.symbol: Rational(1, 97) for p in table.shapes}
        gap = (turned - point.subs(theta, theta + angle)).subs(values)
        if max(abs(float(x)) for x in gap) > SAME:
            continue
        if all(simplify(expand_trig(x)) == 0 for x in turned - point.subs(theta, theta + angle)):
            return k
    return 1


@cache
def symmetries(table: Table) -> tuple[Closure, ...]:
    """The symmetries but the identity, as `theta -> turn*theta + shift`; mirrors first."""
    k = rotations(table)
    turns = [(j, k) if j else (0, 1) for j in range(k)]
    mirror = all(mirrored(component) for component in table.components)
    return tuple([Closure(-1, s) for s in turns] if mirror else []) + tuple(Closure(1, s) for s in turns[1:])


def parts(ring: Chords, x: Array) -> list[tuple[Chords, Array]]:
    """The rings, shorter than this one, that make up a full cycle by a symmetry; the shortest first.

    >>> from symbolic.tables import egg
    >>> triangle = Chords(egg(3).at(alpha="2/25"), (0, 0, 0))
    >>> [(ring.period, ring.closure.turn) for ring, _ in parts(triangle, np.pi / 3 * np.array([1.0, 3.0, 5.0]))]
    [(1, 1)]
    """
    n, found = ring.period, []
    if ring.closure != IDENTITY:
        return []
    for m in (m for m in range(1, n) if n % m == 0):
        for g in symmetries(ring.table):
            if all(_maps(ring, g, x, i, m) for i in range(n)):
                found.append((replace(ring, components=ring.components[:m], closure=g), x[:m].copy()))
    return found


def _maps(ring: Chords, g: Closure, x: Array, i: int, m: int) -> bool:
    j = (i + m) % ring.period
    image = g.carried(x[i], g.radians, 1)
    gap = remainder(x[j] - image, 2 * pi) if len(ring.table.components) == 1 else x[j] - image
    return ring.components[j] == ring.components[i] and abs(gap) < SAME


def whole(part: Chords, x: Array, n: int) -> tuple[Chords, Array]:
    """The full cycle of `n` bounces that a part makes up."""
    pieces, piece = [x], x
    while len(pieces) * part.period < n:
        piece = part.closure.carried(piece, part.closure.radians, 1)
        pieces.append(piece)
    return replace(part, components=part.components * len(pieces), closure=IDENTITY), np.concatenate(pieces)
