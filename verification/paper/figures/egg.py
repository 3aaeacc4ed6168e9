"""The figures on the three-pointed egg: elastic, slap, and its cycles of period 3. Paper: sections 6.1, 6.2, 6.4."""

from typing import TYPE_CHECKING

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.pinball.sampling import phase_starts
from symbolic.cycles.polygons import near_flat
from symbolic.tables.table import alpha as alpha_letter
from symbolic.tables.table import lam as lam_letter
from verification.paper.figures.phase import SEED, balls_of, by_angle, facts, outline, polar
from verification.paper.figures.phase import slap_by_angle as slap_graph
from verification.plots.sheet import (
    BLACK,
    DARK,
    FAINT,
    LIGHT,
    MIDDLE,
    OUTLINE,
    Curve,
    Panel,
    Panels,
    cloud,
    graphs,
    legend,
    scaled,
    sheet,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALPHA = "0.08"
TRIANGLES = ("1.0", "0.9", "0.8", "0.7", "0.6", "0.5", "0.45", "0.41", "0.40")


def islands(fine: float = 1.0) -> Panels:
    """Elastic orbits of many starts at three shapes, each orbit a curve of its own."""
    panels = []
    for alpha in ("0.02", "0.05", "0.08"):
        map, balls, bounces = PinballMap("egg", lam=1, alpha=alpha), 60, scaled(400, fine, 20)
        starts = phase_starts(map, balls, SEED)
        orbit = map.orbit(starts.theta, starts.phi, bounces)
        curves = {f"orbit {i}": by_angle(balls_of(orbit, i)) for i in range(balls)}
        known = facts(map, seed=SEED, bounces=bounces)
        panels.append(Panel(rf"$\alpha = {alpha}$", "theta", "sin_phi", curves, facts=known))
    return tuple(panels)


def draw_islands(panels: Panels) -> "Figure":
    """Neighbouring orbits differ in lightness."""
    figure, axes = sheet(panels, columns=3, height=2.6)
    for ax, panel in zip(axes, panels, strict=True):
        for i, curve in enumerate(panel.curves.values()):
            cloud(ax, curve, (BLACK, DARK, MIDDLE, "0.6", LIGHT)[i % 5], size=0.5)
    return figure


def slap(fine: float = 1.0) -> Panels:
    """The slap map and its iterates up to the fourth, at two shapes."""
    panels = []
    for alpha in ("0.05", "0.08"):
        map = PinballMap("egg", lam=0, alpha=alpha)
        named = ((1, "T_0"), (2, "T_0^2"), (3, "T_0^3"), (4, "T_0^4"))
        curves = {name: slap_graph(map, n, scaled(400, fine, 20)) for n, name in named}
        panels.append(Panel(rf"$\alpha = {alpha}$", "theta", "theta_image", curves, facts=facts(map)))
    return tuple(panels)


def draw_slap(panels: Panels) -> "Figure":
    """Four graphs a panel, with the diagonal."""
    figure, axes = sheet(panels, height=4.0)
    for ax, panel in zip(axes, panels, strict=True):
        graphs(ax, panel)
    return figure


def period3(fine: float = 1.0) -> Panels:
    """The attracting triangle at the paper's nine contractions, in closed form, and the diameters."""
    map = PinballMap("egg", lam=[float(lam) for lam in TRIANGLES], alpha=ALPHA)
    curves = {"boundary": outline(map)}
    for lam in TRIANGLES:
        corners = triangle(lam) + 2 * np.pi / 3 * np.arange(4.0)
        curves[lam] = Curve(*map.states.point(np.zeros(4, dtype=np.int64), corners))
    for k in range(3):
        ends = 2 * np.pi / 3 * k + np.array([0, np.pi])
        curves[f"diameter {k}"] = Curve(*map.states.point(np.zeros(2, dtype=np.int64), ends))
    return (Panel(rf"$\alpha = {ALPHA}$", "x", "y", curves, facts=facts(map)),)


def triangle(lam: str) -> float:
    """The bounce nearest to `pi/3` of the attracting triangle that turns counterclockwise as `lam` falls.

    >>> round(triangle("1.0") / np.pi, 12)
    0.333333333333
    """
    return float(near_flat().subs({alpha_letter: Rational(ALPHA), lam_letter: Rational(lam)}))


def draw_period3(panels: Panels) -> "Figure":
    """The elastic triangle thick, the others lighter as `lam` falls; dotted diameters."""
    figure, (ax,) = sheet(panels, columns=1, height=4.2)
    (panel,) = panels
    ax.plot(*panel.curves["boundary"], **OUTLINE)
    for name, curve in panel.curves.items():
        if name.startswith("diameter"):
            ax.plot(*curve, **(FAINT | {"color": "0.4", "lw": 0.8}))
    for i, lam in enumerate(TRIANGLES):
        ax.plot(*panel.curves[lam], color=str(0.07 * i), lw=2.0 if i == 0 else 0.8)
    return figure


def perturbed_slap(fine: float = 1.0) -> Panels:
    """The third position against the first, from every first angle that a collision can produce, `|phi| <= lam*pi/2`.

    At `lam = 0` this is the graph of the slap map's third iterate.
    """
    curves = {"0.0": slap_graph(PinballMap("egg", lam=0, alpha=ALPHA), 3, scaled(400, fine, 20))}
    rng, balls = np.random.default_rng(SEED), scaled(600, fine, 20)
    for lam in ("0.2", "0.3", "0.4"):
        map = PinballMap("egg", lam=lam, alpha=ALPHA)
        theta = rng.uniform(-np.pi, np.pi, balls)
        phi = rng.uniform(-1, 1, balls) * (float(lam) * np.pi / 2)
        curves[lam] = Curve(theta, polar(map, map.orbit(theta, phi, 3).theta[-1]))
    known = facts(PinballMap("egg", lam=[float(lam) for lam in curves], alpha=ALPHA), seed=SEED, balls=balls)
    return (Panel(rf"$\alpha = {ALPHA}$", "theta", "theta_3", curves, facts=known),)


def draw_perturbed_slap(panels: Panels) -> "Figure":
    """A line, dots, plus signs and crosses, as in the paper; and the diagonal."""
    figure, (ax,) = sheet(panels, columns=1, height=4.2)
    (panel,) = panels
    ax.plot([-np.pi, np.pi], [-np.pi, np.pi], **(FAINT | {"color": "0.3"}))
    looks = ((".", MIDDLE, 3.0), ("+", "0.55", 4.0), ("x", DARK, 4.0))
    for (lam, curve), (marker, color, size) in reversed(list(zip(list(panel.curves.items())[1:], looks, strict=True))):
        ax.plot(*curve, ls="", marker=marker, color=color, ms=size, mew=0.6, label=rf"$\lambda = {lam}$")
    ax.plot(*panel.curves["0.0"], color=BLACK, lw=1.4, label=r"$\lambda = 0$")
    ax.set_box_aspect(1)
    legend(ax, columns=4)
    return figure
