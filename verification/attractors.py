"""Random orbits sorted by the attractor they end on, with Lyapunov exponents and their errors."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from numeric import Exponents, PinballMap
from numeric.sampling import phase_starts

LONGEST = 64  # period that is looked for
CLOSE = 1e-7  # of a return, in the boundary parameter and the angle


def survey(map: PinballMap, bounces: int, orbits: int, seed: int, transient: int) -> dict[str, Any]:
    """Exponents of random orbits, all together and for each attractor."""
    component, theta, phi = phase_starts(map, orbits, seed)[:3]
    if map.law == "slap":
        phi = np.zeros_like(phi)  # every exit is along the normal, the first one too
    found = map.exponents(theta, phi, bounces, transient, component)
    kinds = sorted_by_kind(map, found)
    groups = [{"kind": kind, **summary(found, np.array(members))} for kind, members in kinds.items()]
    groups.sort(key=lambda group: -group["orbits"])
    whole = summary(found, np.arange(orbits))
    return {**whole, "bounces": bounces, "transient": transient, "seed": seed, "groups": groups}


def summary(found: Exponents, members: NDArray[np.int64]) -> dict[str, Any]:
    """Means and standard errors over some of the orbits; null where there is no finite number."""
    result: dict[str, Any] = {}
    for name, values in (("nu_plus", found.nu_plus[members]), ("nu_minus", found.nu_minus[members])):
        finite = values[np.isfinite(values)]
        whole = finite.size == values.size
        result[name] = float(np.mean(finite)) if whole else None
        error = float(np.std(finite, ddof=1) / np.sqrt(finite.size)) if whole and finite.size > 1 else None
        result[f"{name}_stderr"] = error
    return {**result, "orbits": int(members.size)}


def sorted_by_kind(map: PinballMap, found: Exponents) -> dict[str, list[int]]:
    """The orbits by what they ended on: a cycle, named by period and place, chaos, or an early end."""
    orbit = map.orbit(found.theta, found.phi, LONGEST, found.component)
    kinds: dict[str, list[int]] = {}
    for i in range(found.nu_plus.size):
        kinds.setdefault(_kind(orbit, found, i), []).append(i)
    return kinds


def _kind(orbit: Any, found: Exponents, i: int) -> str:
    if found.code[i]:
        return f"stopped: {found.status[i].name.lower()}"
    x, y, phi = orbit.x[:, i], orbit.y[:, i], orbit.phi[:, i]
    gaps = np.hypot(x[1:] - x[0], y[1:] - y[0]) + np.abs(phi[1:] - phi[0])
    returns = np.nonzero(gaps < CLOSE)[0]
    if returns.size:
        period = int(returns[0]) + 1
        first = min(range(period), key=lambda j: (round(x[j], 5), round(y[j], 5)))
        place = f"{orbit.theta[first, i]:.4f}, {orbit.phi[first, i] + 0.0:.4f}"
        return f"cycle of period {period} through ({place})"
    return "chaotic" if found.nu_plus[i] > 0 else "no short cycle, no growth"
