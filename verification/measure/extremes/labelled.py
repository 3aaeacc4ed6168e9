"""Balls that are hard on a map, under names: grazing, next to a cusp or a join, flat points, long tables.

`pinball bench` prints the errors of a few against 50 digits, `benchmarks/adversarial.py` those of millions against
80-bit floats. Bounds are 4 units of 2**-52 for the position and 8 for the direction, or 8 condition numbers:
the row sums of the absolute derivative matrix, and one for the rounding of the result.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.kernels.spec import KernelSpec
from verification.maps.exact import ExactMap, errors

Array = NDArray[np.float64]
SCENES: dict[str, dict[str, Any]] = {
    "circle": {},
    "ellipse": {"a": "3/2"},
    "cardioid": {},
    "cuspless": {},
    "egg": {"alpha": "2/25"},
}
LAM, OTHERS = "19/20", (0, 1e-300, 1)
BALLS, DIGITS, SEED = 24, 50, 11


class Case(NamedTuple):
    """Balls of one kind on one table."""

    label: str
    map: PinballMap
    component: NDArray[np.int64]
    theta: Array
    phi: Array


class Accuracy(NamedTuple):
    """Largest errors of one bounce, in units of 2**-52; the second pair is divided by the condition numbers."""

    scene: str
    case: str
    balls: int
    position: float
    direction: float
    position_by_condition: float
    direction_by_condition: float


def cases(count: int, seed: int = SEED) -> Iterator[Case]:
    """`count` balls of every kind; the first word of a label is the table."""
    rng = np.random.default_rng(seed)
    side = np.where(rng.integers(0, 2, count) == 0, 1, -1)
    tiny = 10.0 ** rng.uniform(-12, -1, count)
    zero = np.zeros(count, dtype=np.int64)
    angle = np.arcsin(rng.uniform(-1, 1, count) * (1 - 1e-12))
    for name, shape in SCENES.items():
        map = PinballMap(name, lam=LAM, **shape)
        low, high = map.states.ends[0]
        theta = low + (high - low) * rng.uniform(1e-9, 1 - 1e-9, count)
        yield Case(f"{name}, random", map, zero, theta, angle)
        yield Case(f"{name}, grazing to 1e-12", map, zero, theta, side * (np.pi / 2 - tiny))
        for lam in OTHERS:
            exit = angle if lam else 0 * angle  # at lam = 0 every exit is along the normal
            yield Case(f"{name}, lam = {lam:g}", PinballMap(name, lam=lam, **shape), zero, theta, exit)
    cardioid = PinballMap("cardioid", lam=LAM)
    yield Case("cardioid, start near the cusp", cardioid, zero, side * (np.pi - tiny), angle)
    theta = rng.uniform(-2.9, 2.9, count)
    yield Case("cardioid, aimed at the cusp", cardioid, zero, theta, theta / 2 + side * tiny)
    yield from _cuspless(rng, side, tiny, angle)
    flat = PinballMap("egg", lam=LAM, alpha="0.1")
    theta = rng.integers(-1, 2, count) * 2 * np.pi / 3 + np.pi / 3 + side * tiny
    around = np.remainder(theta + np.pi, 2 * np.pi) - np.pi
    yield Case("egg, alpha = 0.1, from flat points", flat, zero, around, angle)
    long = PinballMap("ellipse", lam=LAM, a=10000)
    yield Case("ellipse, a = 1e4", long, zero, rng.uniform(-np.pi, np.pi, count), angle)
    yield Case("ellipse, a = 1e4, near the tip", long, zero, side * tiny, angle)


def _cuspless(rng: np.random.Generator, side: Any, tiny: Array, angle: Array) -> Iterator[Case]:
    map, count = PinballMap("cuspless", lam=LAM), angle.size
    zero, join = np.zeros(count, dtype=np.int64), 2 * np.pi / 3
    yield Case("cuspless, start near a join", map, zero, side * (join - tiny), angle)
    yield Case("cuspless, from the wall", map, zero + 1, rng.uniform(-0.4329, 0.4329, count), angle)
    along = side * (np.pi / 2 - tiny)
    yield Case("cuspless, along the wall", map, zero + 1, rng.uniform(-0.4329, 0.4329, count), along)
    yield Case("cuspless, from the wall near a join", map, zero + 1, side * (np.sqrt(3) / 4 - tiny), angle)
    theta = rng.uniform(-2, 2, count)
    x, y = map.states.point(zero, theta)
    aim = map.states.angle_to_normal(zero, theta, -0.25 - x, side * np.sqrt(3) / 4 - y)
    aim = aim + np.where(rng.integers(0, 2, count) == 0, 1, -1) * tiny
    good = np.abs(aim) < 1.57
    yield Case("cuspless, aimed at a join", map, zero[good], theta[good], aim[good])


def conditions(case: Case) -> tuple[Array, Array]:
    """The condition numbers of position and direction after one bounce."""
    matrix = np.abs(case.map.derivative(case.theta, case.phi, case.component))
    return 1 + matrix[:, 0].sum(axis=-1), 1 + matrix[:, 1].sum(axis=-1)


def bounced(case: Case) -> tuple[list[Array], list[Array], NDArray[np.bool_]]:
    """The kernel's fields before and after one bounce, and which balls go on."""
    map = case.map
    own = map.states.enter(case.component, case.theta, case.phi, map.law)
    lam = np.full(case.theta.size, float(map.lam))
    result = map.engine.run(KernelSpec(map.law, record=True), own, lam, map.shape, 1)
    assert result.record is not None
    going = result.rows["code"] == 0 if "code" in result.rows else np.ones(case.theta.size, dtype=bool)
    return own, list(result.record[0]), going


def accuracy(scene: str, balls: int = BALLS) -> Iterator[Accuracy]:
    """The errors of every case of a table, against the exact map of the rounded state."""
    for case in cases(balls):
        if case.label.split(",")[0] == scene:
            own, after, going = bounced(case)
            before, found = [row[going] for row in own], [row[going] for row in after]
            position, direction = errors(case.map, ExactMap(case.map, DIGITS), before, found)
            there, turned = (condition[going] for condition in conditions(case))
            largest = (position, direction, position / there, direction / turned)
            name = case.label.partition(", ")[2]
            yield Accuracy(scene, name, int(going.sum()), *(float(e.max(initial=0)) for e in largest))
