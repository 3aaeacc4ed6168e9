"""How far a float64 step is from the exact map of the rounded state, in units of 2**-52."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from verification.exact_map import Ball, ExactMap

EPS = 2.0**-52
Array = NDArray[np.float64]


def exact_ball(map: PinballMap, exact: ExactMap, fields: list[Any]) -> Ball:
    """The exact ball whose rounded state these kernel fields are."""
    f = [_number(exact.context, x) for x in fields]
    component, theta = _place(map, exact, f)
    leaving = f[len(map.family.position) :]
    phi = map.family.exit(exact.ops, exact.frame(component, theta), leaving) if leaving else 0
    return exact.ball(component, theta, phi)


def errors(map: PinballMap, exact: ExactMap, before: list[Array], after: list[Array]) -> tuple[Array, Array]:
    """Errors of position and direction of one bounce; infinite where it ended on the wrong component."""
    family, ops, at = map.family, exact.ops, len(map.family.position)
    position, direction = np.zeros(before[0].size), np.zeros(before[0].size)
    for i in range(before[0].size):
        truth = exact.bounce(exact_ball(map, exact, [row[i] for row in before]))
        g = [exact.context.mpf(float(row[i])) for row in after]
        if _place(map, exact, g)[0] != truth.component:
            position[i] = direction[i] = np.inf
            continue
        right = family.enter(ops, ops.number(float(truth.component)), truth.theta)
        position[i] = family.distance(ops, g[:at], right) / EPS
        if map.law != "slap":
            aim = family.aim(ops, exact.frame(truth.component, truth.theta), truth.phi)
            direction[i] = exact.context.norm([x - y for x, y in zip(g[at:], aim, strict=True)]) / EPS
    return position, direction


def _number(mp: Any, x: Any) -> Any:
    """A float of 64 or 80 bits, exactly."""
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - high))


def _place(map: PinballMap, exact: ExactMap, fields: list[Any]) -> tuple[int, Any]:
    """Component and parameter of exact fields."""
    component, theta = map.family.place(exact.ops, fields[: len(map.family.position)])
    return int(component), theta
