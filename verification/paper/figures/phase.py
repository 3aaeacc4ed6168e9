"""Data for figures: orbits in the paper's coordinates, long-run behaviour, graphs of slap maps, and phase portraits.

A graph of a slap map has gaps where the map jumps (sections 2.2, 3.4, 4.2, 5.4 and 6.2).
"""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import Orbit, PinballMap
from numeric.backends import elementary
from numeric.pinball.sampling import boundary, interior_starts
from verification.plots import results
from verification.plots.sheet import BLACK, OUTLINE, Array, Curve, Fact, Panel, Panels, cloud, graphs, scaled, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure


SEED = 1
TRANSIENT = 2000  # bounces before an orbit is shown


class Settled(NamedTuple):
    """Orbits after a transient, with one particle in each column, and their larger exponents."""

    orbit: Orbit
    nu_plus: Array


def settled(map: PinballMap, particles: int, bounces: int, transient: int = TRANSIENT, seed: int = SEED) -> Settled:
    """The orbits of particles from random starts in the interior, after a transient; particles that stop are omitted.

    The exponent is measured over the last quarter of the transient.

    >>> found = settled(PinballMap("ellipse", lam="1/2", a=2), 5, 8)
    >>> bool(np.all(np.abs(np.cos(found.orbit.theta)) < 1e-9)), bool(np.all(found.nu_plus < 0))
    (True, True)
    """
    starts = interior_starts(map, particles, seed)
    part = max(1, transient // 4)
    end = map.exponents(starts.theta, starts.phi, part, transient - part, starts.component)
    whole = end.code == 0
    orbit = map.orbit(end.theta[whole], end.phi[whole], bounces, end.component[whole])
    going = orbit.code[-1] == 0
    return Settled(particles_of(orbit, going), end.nu_plus[whole][going])


def particles_of(orbit: Orbit, chosen: Any) -> Orbit:
    """The particles of an orbit that an index of columns selects."""
    return Orbit(*(field[:, chosen] for field in orbit))  # type: ignore[arg-type]  # fields keep their types


def arc_length(map: PinballMap, component: NDArray[np.int64], theta: Array) -> Array:
    """The paper's arc length `s`, from `-L/2` to `L/2`, where `L` is the perimeter.

    >>> cuspless = PinballMap("cuspless")
    >>> arc_length(cuspless, np.array([0, 0]), np.array([-0.001, 0.001])).round(2).tolist()
    [3.9, -3.9]
    """
    length = map.arclength.perimeter
    return np.asarray(np.mod(map.arclength.s(theta, component) + length / 2, length) - length / 2)


def polar(map: PinballMap, theta: Array) -> Array:
    """The polar angle, in [-pi, pi], of points on the first component; it differs from `theta` on the ellipse only.

    >>> polar(PinballMap("ellipse", a=2), np.array([np.pi / 4])).round(4).tolist()
    [0.4636]
    """
    x, y = map.states.point(np.zeros(theta.shape, dtype=np.int64), theta)
    return np.asarray(elementary.arctan2(y, x))


def by_arc_length(map: PinballMap, orbit: Orbit) -> Curve:
    """The bounces as points `(s, sin(phi))`."""
    return Curve(arc_length(map, orbit.component, orbit.theta).ravel(), np.sin(orbit.phi).ravel())


def by_angle(orbit: Orbit) -> Curve:
    """The bounces as points `(theta, sin(phi))`, where `theta` is the polar angle."""
    return Curve(elementary.arctan2(orbit.y, orbit.x).ravel(), np.sin(orbit.phi).ravel())


def flights(orbit: Orbit) -> Curve:
    """The trajectories in the plane, with gaps between particles."""
    gap = np.full((1, orbit.x.shape[1]), np.nan)
    return Curve(*(np.concatenate([field, gap]).T.ravel() for field in (orbit.x, orbit.y)))


def outline(map: PinballMap) -> Curve:
    """The boundary of a table without holes, as a closed curve."""
    return Curve(*(np.append(row, row[0]) for row in results.outline(map)))


def facts(map: PinballMap, **more: Fact) -> dict[str, Fact]:
    """Table, shape and contraction of a panel, and the given further data, by name."""
    shape = {entry.name: float(value) for entry, value in zip(map.ir.shape, map.shape, strict=True)}
    lam: dict[str, Fact] = {"lam": float(map.lam)} if map.lam.size == 1 else {}
    return {"table": map.ir.table, **shape, **lam, **more}


FINEST = 1e-9  # the least step of the abscissa: larger changes over it are jumps
JUMP = 0.02  # relative to the range of the values: larger steps are halved
MOST = 200_000  # the most points of a graph


def graph(f: Callable[[Array], Array], low: float, high: float, points: int) -> Curve:
    """The graph of `f` over an open interval, refined until its steps are small, with gaps at jumps.

    >>> stairs = graph(np.floor, 0.0, 2.0, 5)
    >>> int(np.isnan(stairs.y).sum()), np.unique(stairs.y[~np.isnan(stairs.y)]).tolist()
    (1, [0.0, 1.0])
    """
    x = low + (high - low) * (np.arange(points) + 0.5) / points
    y = f(x)
    extent = float(np.nanmax(y) - np.nanmin(y)) or 1.0
    while x.size < MOST:
        wide = (np.abs(np.diff(y)) > JUMP * extent) & (np.diff(x) > FINEST * (high - low))
        if not np.any(wide):
            break
        at = np.flatnonzero(wide)
        middle = (x[at] + x[at + 1]) / 2
        x, y = np.insert(x, at + 1, middle), np.insert(y, at + 1, f(middle))
    gaps = np.flatnonzero(np.abs(np.diff(y)) > JUMP * extent) + 1
    return Curve(np.insert(x, gaps, x[gaps]), np.insert(y, gaps, np.nan))


def slap_by_arc_length(map: PinballMap, iterate: int, points: int) -> Curve:
    """The graph of an iterate of the slap map, in arc length."""
    half = map.arclength.perimeter / 2

    def image(s: Array) -> Array:
        component, theta = boundary(map, s)
        orbit = map.slap(theta, iterate, component)
        return np.where(orbit.code[-1] == 0, arc_length(map, orbit.component[-1], orbit.theta[-1]), np.nan)

    return graph(image, -half, half, points)


def slap_by_angle(map: PinballMap, iterate: int, points: int) -> Curve:
    """The graph of an iterate of the slap map, in polar angles in [-pi, pi); for tables of one component."""

    def image(theta: Array) -> Array:
        return polar(map, map.slap(theta, iterate).theta[-1])

    found = graph(image, -np.pi, np.pi, points)
    return Curve(polar(map, found.x), found.y)


def slap_panel(title: str, map: PinballMap, iterates: Iterable[int], fine: float, by_angle: bool = False) -> Panel:
    """The graphs of iterates of the slap map, in arc length or, for tables of one component, in polar angles."""
    graph_of, name = (slap_by_angle, "theta") if by_angle else (slap_by_arc_length, "s")
    curves = {f"T_0^{n}" if n > 1 else "T_0": graph_of(map, n, scaled(400, fine, 20)) for n in iterates}
    return Panel(title, name, f"{name}_image", curves, facts=facts(map))


def draw_slap(panels: Panels) -> "Figure":
    """Draws in each panel the graphs of the slap map and its iterates, with the diagonal."""
    figure, axes = sheet(panels, columns=len(panels), height=4.2 if len(panels) == 1 else 4.0)
    for ax, panel in zip(axes, panels, strict=True):
        graphs(ax, panel)
    return figure


PARTICLES, FLIGHTS = 300, 3  # orbits in phase space, and orbits drawn in the table


def portrait(map: PinballMap, fine: float = 1.0) -> Panels:
    """Two panels: the flights of a few particles, and the bounces of many, after a transient.

    >>> room, space = portrait(PinballMap("ellipse", lam="1/2", a=2), 0.1)
    >>> space.x, space.y
    ('s', 'sin_phi')
    """
    bounces = scaled(200, fine, 20)
    orbit = settled(map, PARTICLES, bounces).orbit
    theta, phi, component = (field[-1, :FLIGHTS] for field in (orbit.theta, orbit.phi, orbit.component))
    few = map.orbit(theta, phi, 60, component)
    known = facts(map, seed=SEED, particles=PARTICLES, bounces=bounces)
    room = Panel("the table", "x", "y", {"outline": outline(map), "flights": flights(few)}, facts=known)
    space = Panel("phase space", "s", "sin_phi", {"bounces": by_arc_length(map, orbit)}, facts=known)
    return room, space


def draw_portrait(panels: Panels) -> "Figure":
    """Draws the two panels of a portrait side by side."""
    figure, (room, space) = sheet(panels)
    room.plot(*panels[0].curves["flights"], color=BLACK, lw=0.3)
    room.plot(*panels[0].curves["outline"], **OUTLINE)
    cloud(space, panels[1].curves["bounces"], BLACK)
    return figure
