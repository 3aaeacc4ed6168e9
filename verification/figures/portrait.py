"""Any scene in two panels, for tables of one's own: where balls end, in the table and in phase space."""

from typing import TYPE_CHECKING

from numeric import PinballMap
from verification.figures.panel import Panel, Panels, scaled
from verification.figures.phase import SEED, by_arc_length, facts, flights, outline, settled
from verification.figures.sheet import BLACK, OUTLINE, cloud, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BALLS, FLIGHTS = 300, 3  # orbits in phase space, and of those drawn in the table


def portrait(map: PinballMap, fine: float = 1.0) -> Panels:
    """The flights of a few balls and the bounces of many, long after their start.

    >>> room, space = portrait(PinballMap("ellipse", lam="1/2", a=2), 0.1)
    >>> space.x, space.y
    ('s', 'sin_phi')
    """
    bounces = scaled(200, fine, 20)
    orbit = settled(map, BALLS, bounces).orbit
    theta, phi, component = (field[-1, :FLIGHTS] for field in (orbit.theta, orbit.phi, orbit.component))
    few = map.orbit(theta, phi, 60, component)
    known = facts(map, seed=SEED, balls=BALLS, bounces=bounces)
    room = Panel("the table", "x", "y", {"outline": outline(map), "flights": flights(few)}, facts=known)
    space = Panel("phase space", "s", "sin_phi", {"bounces": by_arc_length(map, orbit)}, facts=known)
    return room, space


def draw_portrait(panels: Panels) -> "Figure":
    """Both panels side by side."""
    figure, (room, space) = sheet(panels)
    room.plot(*panels[0].curves["flights"], color=BLACK, lw=0.3)
    room.plot(*panels[0].curves["outline"], **OUTLINE)
    cloud(space, panels[1].curves["bounces"], BLACK)
    return figure
