"""Where the sampled attractor changes at once: homoclinic tangencies near by, of the saddles that a search finds there.

A crisis is such a tangency. That the attractor changes at the one that was located, and not beside it, is what sampling
shows, and no proof; so a tangency is not called a crisis here. The boundary has to be a convex curve of one formula.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import pi

from numeric import PinballMap
from numeric.sweeps.fields import bifurcation
from numeric.sweeps.run import run
from numeric.sweeps.sweep import text_of
from symbolic.tables.geometry import group
from symbolic.tables.table import Table
from verification.cycles.recurrence import Closure
from verification.maps.first_hit import closes_smoothly, convex
from verification.named.questions import PeriodicOrbit, Tick, find_cycles
from verification.proofs.manifolds.grow import touches
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Touch
from verification.reports.asked import Asked, Parts
from verification.reports.blocks import Block, Effort, Known, Listing, Number, Words
from verification.reports.dynamics import density
from verification.reports.lives import mark

Found = tuple[list[Block], list[Effort], dict[str, Any]]
GROWN = 0.15  # part of the cells that an attractor meets, gained or lost from one contraction to the next
MOST = 3  # changes that are looked into
COLUMNS, ORBITS, POINTS, LONG = 25, 16, 512, 20_000  # of the closer look: contractions, particles, bounces, transient
NEAR = 4  # steps of that look within which a tangency belongs to a change
BOUNCES, TRIED = 6, 6  # that an unstable manifold is followed, and the places on it from which a tangency is sought
SAME = 1e-6  # parameters of bounces that a symmetry exchanges, found in float64
ASKED = "Tangencies are looked for on convex tables of one formula under the law phi = -lam*eta."


def crises(asked: Asked, parts: Parts, heard: Tick = lambda said: None) -> Found:
    """A table of the tangencies near the changes that the diagram shows."""
    table = asked.scene.table
    whole = len(table.components) == 1 and not table.undefined and closes_smoothly(table)
    if not (whole and asked.scene.law.uniform and convex(table)):
        return [Words(ASKED)], [], {}
    arrays = parts.arrays("diagram-0")
    changes = changed(arrays["counts"], arrays["chaotic"])
    rows, found = list[tuple[Any, ...]](), list[Touch]()
    for j in changes:
        low, high = closer(asked, parts, arrays["values"], j)
        for touch, orbit in near(asked, (low + high) / 2, NEAR * (high - low), heard):
            if all(abs(touch.parameter - other.parameter) > SAME for other in found):
                found.append(touch)
                rows.append(_row(touch, orbit, (low, high)))
    rows.sort(key=lambda row: float(row[0].value))
    size = f"{len(changes)} changes, {len(found)} tangencies"
    events = [[float(row[0].value), "tangency"] for row in rows]
    located = [_document(row) for row in rows]
    blocks: list[Block] = [_told(asked, len(changes), rows)]
    return blocks, [Effort("tangencies", size, 0.0)], {"events": events, "located": located}


def changed(counts: NDArray[Any], chaotic: NDArray[Any]) -> list[int]:
    """The columns after which chaos gains or loses the largest part of the cells that it meets, the largest first.

    >>> changed(np.array([[1, 1, 1, 1], [1, 1, 0, 0], [1, 1, 0, 0]]), np.array([1, 1, 0, 0]))
    [1]
    """
    met = np.count_nonzero(counts, axis=0)
    part = np.abs(np.diff(met)) / np.maximum(1, np.maximum(met[:-1], met[1:]))
    part[~((chaotic[:-1] > 0) | (chaotic[1:] > 0))] = 0
    kept: list[int] = []
    for j in np.argsort(-part):
        if part[j] > GROWN and len(kept) < MOST and all(abs(j - other) > 1 for other in kept):
            kept.append(int(j))
    return kept


def closer(asked: Asked, parts: Parts, values: NDArray[Any], j: int) -> tuple[float, float]:
    """The change after column `j` between two nearer contractions, where chaos that only lasts long has more time."""
    first, last = max(0, j - 2), min(len(values) - 1, j + 3)
    finer = np.linspace(values[first], values[last], COLUMNS)
    sweep = bifurcation(text_of(asked.scene), finer, ORBITS, POINTS, POINTS, LONG, asked.seed)
    seen = run(sweep, scheduler=parts.scheduler)
    half = PinballMap(asked.scene).arclength.perimeter / 2
    counts = density(seen.s.values, half)
    k = next(iter(changed(counts, seen.chaotic.values.mean(axis=1))), COLUMNS // 2)
    return float(finer[k]), float(finer[k + 1])


def near(asked: Asked, lam: float, reach: float, heard: Tick) -> list[tuple[Touch, PeriodicOrbit]]:
    """The tangencies within reach of a contraction, each with the saddle whose manifolds touch."""
    here = asked.scene.at(lam=repr(round(lam, 9)))
    turn, mirrored = rotations(here.table)
    map, known, found = Pinball(here.table, turn=turn), list[list[float]](), list[tuple[Touch, PeriodicOrbit]]()
    for cycle in find_cycles(here, up_to=asked.period, seed=asked.seed, tick=heard):
        one, two = cycle.multipliers
        look = mark(cycle.period, (one + two).real, (one * two).real)
        saddle = one.imag == 0 and min(abs(one), abs(two)) < 1 < max(abs(one), abs(two))
        if not saddle or look in known:
            continue
        known.append(look)
        heard("tangencies")
        orbit = round_of(cycle, turn, mirrored)
        rounds = max(2, BOUNCES // len(orbit.start))
        for touch in touches(orbit, map, lam, rounds, TRIED, any_bounce=mirrored):
            if abs(touch.parameter - lam) <= reach:
                found.append((touch, cycle))
    return found


def rotations(table: Table) -> tuple[int, bool]:
    """How many rotations the table has, as shifts of its parameter, and whether `theta -> -theta` is a symmetry.

    >>> from symbolic.tables import egg
    >>> rotations(egg(3).at(alpha="2/25"))
    (3, True)
    """
    symmetries = group(table)
    turn = sum(symmetry.sign > 0 for symmetry in symmetries)
    uniform = all((turn * symmetry.shift[0] / (2 * pi)).is_integer for symmetry in symmetries if symmetry.sign > 0)
    return (turn if uniform else 1), any(symmetry.sign < 0 and symmetry.shift[0] == 0 for symmetry in symmetries)


def round_of(cycle: PeriodicOrbit, turn: int, mirrored: bool) -> Orbit:
    """The least part of a cycle that a symmetry continues, on angles that count turns.

    >>> from symbolic import Scene
    >>> egg, thirds = Scene("egg", alpha="2/25"), (0.0, 2.0943951, -2.0943951)
    >>> triangle = PeriodicOrbit(egg, (0,) * 3, thirds, (0.0,) * 3, (0j, 0j))
    >>> round_of(triangle, 3, True).closure.shift
    (1, 3)
    """
    x = [cycle.theta[0]]
    for theta in (*cycle.theta[1:], cycle.theta[0]):
        x.append(x[-1] + (theta - x[-1]) % (2 * math.pi))
    once = x[-1] - x[0]
    twice, unit, name = [*x[:-1], *(y + once for y in x[:-1])], 2 * math.pi / turn, f"cycle of period {cycle.period}"
    for k in range(1, cycle.period):
        for sign in (1, -1) if mirrored else (1,):
            moved = [(twice[i + k] - sign * twice[i]) / unit for i in range(cycle.period)]
            if all(abs(y - round(moved[0])) < SAME for y in moved):
                return Orbit(name, tuple(x[:k]), Closure(sign, (round(moved[0]), turn)))
    return Orbit(name, tuple(x[:-1]), Closure(1, (round(once / (2 * math.pi)), 1)))


def _row(touch: Touch, cycle: PeriodicOrbit, change: tuple[float, float]) -> tuple[Any, ...]:
    stable, unstable = touch.multipliers[:2]
    size = f"{unstable:.5g}, {stable:.3g}"
    return (
        Number(f"{float(touch.parameter):.12f}", f"{max(touch.error, 1e-12):.0e}", Known.FLOAT),
        str(cycle.period),
        Number(size, known=Known.FLOAT),
        str(touch.contact.bounces),
        Number(f"{change[0]:.4f} to {change[1]:.4f}", known=Known.SAMPLED),
    )


def _document(row: Sequence[Any]) -> dict[str, Any]:
    return {
        "kind": "homoclinic_tangency",
        "period": int(row[1]),
        "parameter": "lam",
        "value": row[0].value,
        "radius": row[0].error,
        "certified": False,
    }


def _told(asked: Asked, changes: int, rows: list[tuple[Any, ...]]) -> Block:
    if not changes:
        return Words("The diagram shows no contraction at which a chaotic attractor gains or loses much at once.")
    if not rows:
        where = "one contraction" if changes == 1 else f"{changes} contractions"
        return Words(
            f"At {where} of the diagram a chaotic attractor gains or loses much at once; no tangency of the manifolds "
            f"of a cycle up to period {asked.period} was found near by."
        )
    caption = (
        "Homoclinic tangencies near the contractions at which the diagram shows a chaotic attractor to gain or lose "
        f"much at once: the manifolds of a saddle touch, among cycles up to period {asked.period}. A crisis is such a "
        "tangency. Solved for in float64, each by Newton's method and secants; that the attractor changes there is "
        "sampled: the last column."
    )
    columns = ("lam", "period", "multipliers of a round", "bounces", "the attractor changes")
    return Listing(caption, columns, tuple(rows), asked.command("bifurcation", f"--lams {asked.low}:{asked.high}:150"))
