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
    mp, name = exact.context, map.family.name
    f = [_number(mp, x) for x in fields]
    if map.law == "slap":
        component, theta = _place(exact, name, f)
        return exact.ball(component, theta, 0)
    if name == "circle":
        return exact.ball(0, f[0], f[1])
    if name in ("cardioid", "cuspless"):
        component, theta = _place(exact, name, f)
        return exact.ball(component, theta, mp.atan2(f[-1], f[-2]))
    component, theta = _place(exact, name, f)
    return exact.along(component, theta, f[-2:])


def errors(map: PinballMap, exact: ExactMap, before: list[Array], after: list[Array]) -> tuple[Array, Array]:
    """Errors of position and direction of one bounce; infinite where it ended on the wrong component."""
    mp, name = exact.context, map.family.name
    position, direction = np.zeros(before[0].size), np.zeros(before[0].size)
    for i in range(before[0].size):
        truth = exact.bounce(exact_ball(map, exact, [row[i] for row in before]))
        g = [mp.mpf(float(row[i])) for row in after]
        component, theta = _place(exact, name, g)
        if component != truth.component:
            position[i] = direction[i] = np.inf
            continue
        position[i] = _distance(mp, name, component, g, theta, truth) / EPS
        if map.law == "slap":
            continue
        if name == "circle":
            direction[i] = abs(g[1] - truth.phi) / EPS
        elif name in ("cardioid", "cuspless"):
            direction[i] = mp.hypot(g[-2] - mp.cos(truth.phi), g[-1] - mp.sin(truth.phi)) / EPS
        else:
            direction[i] = mp.hypot(g[-2] - truth.v[0], g[-1] - truth.v[1]) / EPS
    return position, direction


def _number(mp: Any, x: Any) -> Any:
    """A float of 64 or 80 bits, exactly."""
    high = float(x)
    return mp.mpf(high) + mp.mpf(float(x - high))


def _place(exact: ExactMap, name: str, f: list[Any]) -> tuple[int, Any]:
    """Component and parameter of exact fields."""
    mp = exact.context
    if name == "circle":
        return 0, f[0]
    if name == "cardioid":
        return 0, 2 * mp.atan2(f[1], f[0])
    if name == "cuspless":
        return (1, -f[1]) if f[0] else (0, 2 * mp.atan2(f[2], f[1]))
    if name == "general":
        return int(f[0]), f[1]
    return 0, mp.atan2(f[1], f[0])


def _distance(mp: Any, name: str, component: int, g: list[Any], theta: Any, truth: Ball) -> Any:
    """In the number that a kernel keeps as the position: an angle, a unit vector or a height."""
    if name in ("circle", "general"):
        gap = theta - truth.theta
        return abs(gap - 2 * mp.pi * mp.nint(gap / (2 * mp.pi))) if name == "circle" else abs(gap)
    if name == "cuspless" and component == 1:
        return abs(theta - truth.theta)
    share = 2 if name in ("cardioid", "cuspless") else 1
    x, y = g[-4:-2] if len(g) >= 4 else g[-2:]
    return mp.hypot(x - mp.cos(truth.theta / share), y - mp.sin(truth.theta / share))
