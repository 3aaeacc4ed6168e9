"""Attack: flights of the cuspless table that pass a join within rounding land on the correct side."""

from typing import Any, NamedTuple

from attacks.outcome import Outcome


class Passed(NamedTuple):
    """The results of flights that pass a join closely: arrays, and the distances in units of 2**-52."""

    miss: Any
    stopped: Any
    regular: Any
    wrong: Any


def past_joins(count: int, units: float, near: bool, kernels: bool, seed: int) -> Passed:
    """Flights of the cuspless table from arc to join that miss it by some units of 2**-52; the side in 80 bits.

    They leave from anywhere on the arc, or from `near` the join. The side is that of the rounded state, not of the aim.
    """
    import numpy as np

    from numeric import PinballMap, Status
    from numeric.kernels.machine import KernelSpec

    rng, wide, join = np.random.default_rng(seed), np.longdouble, 2 * np.pi / 3
    beside = np.where(np.arange(count) % 2, 1, -1) * (join - 10 ** rng.uniform(-9, -1, count))
    theta = beside if near else rng.uniform(-join, join, count)
    map = PinballMap("cuspless", lam=0.9, kernels=kernels)
    own = [np.asarray(row) for row in map.states.enter(np.zeros(count, dtype=int), theta, 0 * theta, map.law)]
    p, q = (row.astype(wide) for row in own[1:3])
    p, q = p / np.hypot(p, q), q / np.hypot(p, q)
    height, wall, top = 4 * p**3 * q, -((2 * p * p - wide(0.5)) ** 2), np.sqrt(wide(3)) / 4  # from start to wall
    tangent = q * (q * q - 3 * p * p), p * (p * p - 3 * q * q)

    x, y = wall, rng.choice([-1, 1], count) * top - height
    turn = rng.uniform(-units, units, count) * wide(2.0**-52) / (x * x + y * y)
    x, y = x - turn * y, y + turn * x
    cosine, sine = (
        part / np.hypot(x, y) for part in (y * tangent[0] - x * tangent[1], x * tangent[0] + y * tangent[1])
    )
    leaves = cosine > 1e-12
    own = [row[leaves] for row in (*own[:3], cosine.astype(float), sine.astype(float))]
    result = map.engine.run(KernelSpec(map.law, record=True), own, np.full(len(own[0]), 0.9), map.shape, 1)

    c, s = (row.astype(wide) for row in own[3:])
    (tx, ty), wall, height = (row[leaves] for row in tangent), wall[leaves], height[leaves]
    vx, vy = (tx * s - ty * c) / np.hypot(c, s), (ty * s + tx * c) / np.hypot(c, s)
    above, below = (vx * (side * top - height) - vy * wall for side in (1, -1))
    onto_wall, miss = (above * below < 0) & (vx < 0), np.minimum(np.abs(above), np.abs(below)) * 2.0**52
    stopped, regular = (result.rows["code"] == status.code for status in (Status.JOIN, Status.REGULAR))
    return Passed(miss, stopped, regular, regular & ((result.record[0][0] == 1) != onto_wall))


def joins(flights: int, seed: int = 1, batch: int = 100_000) -> Outcome:
    """Flights past a join by up to eight units, half from anywhere and half from near it: none on the wrong side.

    Flights that stop although they pass it by ten units fail, too.
    """
    import numpy as np

    count, failed, on, stopped, farthest = 0, 0, 0, 0, 0.0
    for k in range(0, flights, batch):
        found = past_joins(batch, 8, bool(k // batch % 2), True, seed + k)
        count, on, stopped = count + found.miss.size, on + int(found.regular.sum()), stopped + int(found.stopped.sum())
        farthest = max(farthest, float(np.max(found.miss[found.stopped], initial=0)))
        failed += int(found.wrong.sum() + np.sum(found.stopped & (found.miss >= 10)))
    return Outcome(count, failed, f"{stopped:,} stop, the last {farthest:.1f} units off, and {on:,} go on")
