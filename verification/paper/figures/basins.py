"""Figures of basins of attraction in phase space. Paper: sections 5.2 and 6.7, appendix A.3.

`fine` is the resolution: 1 for a draft, more for more points.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.basins import classify_cells
from numeric.dynamics.recognition import Kind
from numeric.pinball.sampling import phase_grid
from verification.paper.figures.cardioid import cycle_points, orbit_on
from verification.paper.figures.phase import by_angle, by_arc_length, facts
from verification.plots.sheet import CROSS, DARK, Array, Panel, Panels, Raster, cloud, scaled, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACROSS, UP = 360, 240  # cells of a draft
TRANSIENT = 1000  # bounces before a particle's attractor is determined
SOON = 250  # the same where most particles reach a cycle by then; the others continue
BLANK, SHADE = (1.0, 1.0, 1.0), (0.78, 0.84, 0.78)
RED = (0.87, 0.55, 0.5)


def basins(map: PinballMap, fine: float, angle: bool, transient: int = TRANSIENT) -> Panel:
    """A panel with the attractor that each cell of phase space reaches, and the attractors themselves.

    The abscissa is `theta` if `angle` is true, else arc length; cells are equal in arc length in both cases.
    """
    grid = phase_grid(map, scaled(ACROSS, fine**0.5, 8), scaled(UP, fine**0.5, 6))
    particles = grid.starts
    label, attractors = classify_cells(map, grid, transient)
    curves, names, count = {}, [], scaled(4000, fine, 50)
    for i, attractor in enumerate(attractors):
        name = "chaotic" if attractor.kind is Kind.CHAOTIC else f"period {attractor.period}"
        names.append(name if name not in names else f"{name} ({i + 1})")
        orbit = orbit_on(map, attractor, count)
        shown = by_angle(orbit) if angle else by_arc_length(map, orbit)
        curves[names[-1]] = cycle_points(map, attractor)[0] if angle and attractor.period else shown
    x = elementary.arctan2(particles.y, particles.x)[: grid.s.size] if angle else grid.s
    order = np.argsort(x)
    table = label.reshape(grid.sin_phi.size, grid.s.size)[:, order]
    raster = Raster(x[order], grid.sin_phi, np.where(table < 0, len(names), table), (*names, "unsettled"))
    known = facts(map, transient=transient, columns=x.size, rows=grid.sin_phi.size)
    return Panel(rf"$\lambda = {float(map.lam):g}$", "theta" if angle else "s", "sin_phi", curves, raster, known)


def paint(ax: "Axes", raster: Raster, colours: dict[str, Any]) -> None:
    """Draws the cells in the colours of their names; a cell whose name has no colour stays blank."""
    table = np.array([colours.get(name, BLANK) for name in raster.names])
    ax.pcolormesh(edges(raster.x), edges(raster.y), table[raster.labels], rasterized=True)


def edges(centres: Array) -> Array:
    """The borders of cells whose centres are given.

    >>> edges(np.array([1.0, 2.0, 4.0])).tolist()
    [0.5, 1.5, 3.0, 5.0]
    """
    inner = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])


def cuspless(fine: float = 1.0) -> Panels:
    """The basins of the chaotic and of the period-2 attractor at `lam = 0.09`."""
    return (basins(PinballMap("cuspless", lam="0.09"), fine, angle=False),)


def draw_cuspless(panels: Panels) -> "Figure":
    """Draws the chaotic attractor's basin shaded and the other one blank, and both attractors."""
    figure, (ax,) = sheet(panels, columns=1, height=3.2)
    (panel,) = panels
    assert panel.raster is not None
    paint(ax, panel.raster, {"chaotic": SHADE})
    points(ax, panel)
    return figure


def egg(fine: float = 1.0) -> Panels:
    """The basins of the egg just below the boundary crisis, and above it."""
    maps = [PinballMap("egg", lam=lam, alpha="0.08") for lam in ("0.66", "0.7")]
    return tuple(basins(map, fine, angle=True, transient=SOON) for map in maps)


def draw_egg(panels: Panels) -> "Figure":
    """Draws in each panel the chaotic basin (or, if there is none, that of one triangle) and the attractors."""
    figure, axes = sheet(panels, height=3.0)
    for ax, panel in zip(axes, panels, strict=True):
        assert panel.raster is not None
        paint(ax, panel.raster, {"chaotic": SHADE} if "chaotic" in panel.curves else {"period 3": RED})
        points(ax, panel)
    return figure


def points(ax: "Axes", panel: Panel) -> None:
    """Draws chaotic attractors as dots, and cycles as crosses."""
    for name, curve in panel.curves.items():
        if name.startswith("chaotic"):
            cloud(ax, curve, DARK, size=0.7)
        else:
            ax.plot(*curve, **(CROSS | {"ms": 5}))
