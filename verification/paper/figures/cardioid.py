"""The figures on the cardioid. Paper: section 4.

Lyapunov exponents against the contraction, as the paper plots them. Paper: sections 4.1 and 5.3, appendix.
"""

from typing import TYPE_CHECKING

import numpy as np

from numeric import PinballMap
from verification.paper.figures.phase import SEED, TRANSIENT, by_arc_length, facts, flights, outline, settled
from verification.paper.figures.phase import slap_by_arc_length as slap_graph
from verification.plots.sheet import BLACK, DARK, FAINT, OUTLINE, Panel, Panels, cloud, graphs, scaled, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

from numpy.typing import NDArray

from numeric.pinball.sampling import interior_starts
from numeric.sweeps.sweep import floor_of
from verification.plots.sheet import Array, Curve

BALLS = 40


def attractors(fine: float = 1.0) -> Panels:
    """The attractor at `lam = 0.3` and `0.8` in phase space, and at `0.3` in configuration space."""
    panels = []
    for lam in ("0.3", "0.8"):
        map, bounces = PinballMap("cardioid", lam=lam), scaled(500, fine, 20)
        orbit = settled(map, BALLS, bounces).orbit
        known = facts(map, seed=SEED, balls=BALLS, bounces=bounces, transient=TRANSIENT)
        panels.append(
            Panel(rf"$\lambda = {lam}$", "s", "sin_phi", {"attractor": by_arc_length(map, orbit)}, facts=known)
        )
        if lam == "0.3":
            few = map.orbit(orbit.theta[-1, :8], orbit.phi[-1, :8], scaled(40, min(fine, 1.0)))
            curves = {"boundary": outline(map), "attractor": flights(few)}
            inset = Panel(rf"$\lambda = {lam}$, inset", "x", "y", curves, facts=known)
    return (*panels, inset)


def draw_attractors(panels: Panels) -> "Figure":
    """Two phase portraits; the third panel is the inset of the first."""
    figure, axes = sheet(panels[:2])
    for ax, panel in zip(axes, panels[:2], strict=True):
        cloud(ax, panel.curves["attractor"], BLACK)
        ax.set_xlim(-4, 4)
    corner = axes[0].inset_axes((0.02, 0.04, 0.34, 0.4))
    corner.set_aspect("equal")
    corner.set_axis_off()
    corner.plot(*panels[2].curves["boundary"], **(OUTLINE | {"lw": 0.6}))
    corner.plot(*panels[2].curves["attractor"], color=BLACK, lw=0.15)
    return figure


def exponents(fine: float = 1.0) -> Panels:
    """Both exponents and their sum against `lam`, averaged over 100 orbits. Their sum at `lam = 1` is 0 exactly."""
    lams = np.linspace(0.02, 1.0, scaled(50, min(fine, 2.0), 5))
    return (averaged("cardioid", lams, scaled(1000, fine, 50)),)


def draw_exponents(panels: Panels) -> "Figure":
    """Filled and open circles, and the sum as a line."""
    figure, (ax,) = sheet(panels, columns=1, height=3.0)
    (panel,) = panels
    ax.axhline(0, **FAINT)
    ax.plot(*panel.curves["nu_plus"], ls="", marker="o", ms=3, color=BLACK, label=r"$\nu_+$")
    ax.plot(*panel.curves["nu_minus"], ls="", marker="o", ms=3, mfc="white", color=DARK, label=r"$\nu_-$")
    ax.plot(*panel.curves["sum"], color="0.45", label=r"$\nu_+ + \nu_-$")
    ax.set_xlim(0, 1.01)
    ax.legend()
    return figure


def slap(fine: float = 1.0) -> Panels:
    """The slap map and its second iterate, arc length against arc length."""
    map = PinballMap("cardioid", lam=0)
    curves = {f"T_0{power}": slap_graph(map, n, scaled(400, fine, 20)) for n, power in ((1, ""), (2, "^2"))}
    return (Panel("cardioid", "s", "s_image", curves, facts=facts(map)),)


def draw_slap(panels: Panels) -> "Figure":
    """Both graphs with the diagonal."""
    figure, (ax,) = sheet(panels, columns=1, height=4.2)
    graphs(ax, panels[0])
    return figure


ORBITS = 100  # the paper's number for each contraction


def averaged(table: str, lams: Array, bounces: int, orbits: int = ORBITS) -> Panel:
    """The means of both exponents over all orbits, and of `nu_plus` over those that converge to a cycle and the others.

    The standard errors over the orbits come with the means; a mean over no orbit is a gap.
    """
    map = PinballMap(table, lam=np.repeat(lams, orbits))
    starts = interior_starts(map.at(1), orbits, SEED)
    theta, phi, component = (np.tile(field, lams.size) for field in (starts.theta, starts.phi, starts.component))
    found = map.exponents(theta, phi, bounces, TRANSIENT, component)
    stopped = found.code != 0
    plus, minus = (
        np.where(stopped, np.nan, values).reshape(lams.size, orbits) for values in (found.nu_plus, found.nu_minus)
    )
    chaotic = plus > floor_of(bounces)
    curves = {
        "nu_plus": Curve(lams, np.nanmean(plus, axis=1)),
        "nu_minus": Curve(lams, np.nanmean(minus, axis=1)),
        "sum": Curve(lams, np.nanmean(plus + minus, axis=1)),
        "nu_plus_stderr": Curve(lams, np.nanstd(plus, axis=1, ddof=1) / np.sqrt(orbits)),
        "nu_minus_stderr": Curve(lams, np.nanstd(minus, axis=1, ddof=1) / np.sqrt(orbits)),
        "nu_plus_chaotic": Curve(lams, _mean(plus, chaotic)),
        "nu_plus_periodic": Curve(lams, _mean(plus, plus <= floor_of(bounces))),
        "chaotic_share": Curve(lams, chaotic.mean(axis=1)),
    }
    known = facts(map, seed=SEED, orbits=orbits, bounces=bounces, transient=TRANSIENT)
    return Panel(table, "lam", "nu", curves, facts=known)


def _mean(values: Array, chosen: NDArray[np.bool_]) -> Array:
    """The mean of the chosen ones in each row; nan where there is none."""
    count = chosen.sum(axis=1)
    total = np.where(chosen, values, 0.0).sum(axis=1)
    return np.asarray(np.divide(total, count, out=np.full(count.shape, np.nan), where=count > 0))
