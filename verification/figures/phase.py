"""Orbits in the paper's coordinates, and what many orbits do in the long run. Paper: appendix."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import Orbit, PinballMap
from numeric.pinball.sampling import interior_starts
from verification.figures.panel import Array, Curve, Fact

SEED = 1
TRANSIENT = 2000  # bounces thrown away: the paper's several thousand, where draft pictures need no more
OUTLINE = 721  # points of a table's boundary


class Settled(NamedTuple):
    """Orbits after their transient, a ball to a column, and the larger exponent of each."""

    orbit: Orbit
    nu_plus: Array


def settled(map: PinballMap, balls: int, bounces: int, transient: int = TRANSIENT, seed: int = SEED) -> Settled:
    """The orbits of balls that start in the interior, long after. A ball that stops is left out.

    The exponent is that of the last quarter of the transient.

    >>> found = settled(PinballMap("ellipse", lam="1/2", a=2), 5, 8)
    >>> bool(np.all(np.abs(np.cos(found.orbit.theta)) < 1e-9)), bool(np.all(found.nu_plus < 0))
    (True, True)
    """
    starts = interior_starts(map, balls, seed)
    part = max(1, transient // 4)
    end = map.exponents(starts.theta, starts.phi, part, transient - part, starts.component)
    whole = end.code == 0
    orbit = map.orbit(end.theta[whole], end.phi[whole], bounces, end.component[whole])
    going = orbit.code[-1] == 0
    return Settled(balls_of(orbit, going), end.nu_plus[whole][going])


def balls_of(orbit: Orbit, chosen: Any) -> Orbit:
    """Some of the balls, by an index of columns."""
    return Orbit(*(field[:, chosen] for field in orbit))  # type: ignore[arg-type]  # fields keep their kinds


def arc_length(map: PinballMap, component: NDArray[np.int64], theta: Array) -> Array:
    """The paper's `s`, from `-L/2` to `L/2`, `L` the perimeter.

    >>> cuspless = PinballMap("cuspless")
    >>> arc_length(cuspless, np.array([0, 0]), np.array([-0.001, 0.001])).round(2).tolist()
    [3.9, -3.9]
    """
    length = map.arclength.perimeter
    return np.asarray(np.mod(map.arclength.s(theta, component) + length / 2, length) - length / 2)


def polar(map: PinballMap, theta: Array) -> Array:
    """The polar angle, in [-pi, pi], of points on the first component: `theta` itself but for the ellipse.

    >>> polar(PinballMap("ellipse", a=2), np.array([np.pi / 4])).round(4).tolist()
    [0.4636]
    """
    x, y = map.states.point(np.zeros(theta.shape, dtype=np.int64), theta)
    return np.asarray(np.arctan2(y, x))


def by_arc_length(map: PinballMap, orbit: Orbit) -> Curve:
    """The bounces as points `(s, sin(phi))`."""
    return Curve(arc_length(map, orbit.component, orbit.theta).ravel(), np.sin(orbit.phi).ravel())


def by_angle(orbit: Orbit) -> Curve:
    """The bounces as points `(theta, sin(phi))`, `theta` the polar angle."""
    return Curve(np.arctan2(orbit.y, orbit.x).ravel(), np.sin(orbit.phi).ravel())


def flights(orbit: Orbit) -> Curve:
    """The trajectories in the plane, with a gap between two balls."""
    gap = np.full((1, orbit.x.shape[1]), np.nan)
    return Curve(*(np.concatenate([field, gap]).T.ravel() for field in (orbit.x, orbit.y)))


def outline(map: PinballMap) -> Curve:
    """The boundary of the table, closed."""
    parts = []
    for index, (low, high) in enumerate(map.states.ends):
        theta = np.linspace(low, high, OUTLINE)
        parts.append(np.array(map.states.point(np.full(OUTLINE, index), theta)))
    x, y = np.concatenate([*parts, parts[0][:, :1]], axis=1)
    return Curve(x, y)


def facts(map: PinballMap, **more: Fact) -> dict[str, Fact]:
    """Table, shape and contraction of a panel, and whatever else its data were computed from."""
    shape = {entry.name: float(value) for entry, value in zip(map.blueprint.shape, map.shape, strict=True)}
    lam: dict[str, Fact] = {"lam": float(map.lam)} if map.lam.size == 1 else {}
    return {"table": map.blueprint.table, **shape, **lam, **more}
