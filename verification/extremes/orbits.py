"""Very long orbits: does the elastic ellipse keep the product of the angular momenta about its foci?

After `n` bounces the forward error is the change of the product. Each bounce rounds once, so `n` roundings
that know nothing of one another amount to `sqrt(n)`: that is the condition number. A drift would be of order `n`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from numeric import PinballMap
from numeric.question import Question
from verification.extremes.kernels import DOUBLE, made_unit
from verification.extremes.stability import Finding, Measured

BALLS, SEED = 256, 5


@dataclass(frozen=True)
class Long:
    """The elastic ellipse with long axis `a`, for so many bounces of every ball."""

    name: str
    a: str
    bounces: int


def findings(asked: Long) -> list[Finding]:
    """The engine on the case: the root mean square over all balls."""
    map = PinballMap("ellipse", lam=1, a=asked.a)
    rng = np.random.default_rng(SEED)
    theta, phi = rng.uniform(-np.pi, np.pi, BALLS), np.arcsin(rng.uniform(-1, 1, BALLS) * 0.999)
    rows = map.states.enter(np.zeros(BALLS, dtype=np.int64), theta, phi, map.law)
    after = map.engine.run(Question(map.law), rows, np.ones(BALLS), map.shape, asked.bounces).rows
    change = momenta(map, [after[field] for field in map.family.fields(map.law)]) - momenta(map, rows)
    error = float(np.sqrt(np.mean(change**2))) / DOUBLE
    condition = float(np.sqrt(asked.bounces)) + 1
    return [Finding(asked.name, "llvm", Measured(error, error / condition, condition))]


def momenta(map: PinballMap, rows: list[Any]) -> Any:
    """The product of the angular momenta about both foci, in 80 bits, of the exact balls behind the rounded rows."""
    ux, uy, vx, vy = made_unit(map.family.name, [row.astype(np.longdouble) for row in rows])
    a = np.longdouble(map.shape[0])
    momentum = a * ux * vy - uy * vx
    return momentum * momentum - (a * a - 1) * vy * vy


SHORT = 2_560_000


def orbits(collisions: int = SHORT) -> tuple[Long, ...]:
    """One long orbit for each of two shapes, so many collisions of all balls together."""
    each = max(1, collisions // BALLS)
    return tuple(
        Long(f"elastic ellipse a = {a}, {BALLS} balls, {each:.0e} bounces each", a, each) for a in ("3/2", "3")
    )
