"""Figures on the circle and the ellipse (section 3), and the evolutes of all tables, which the paper does not show.

`fine` is the resolution: 1 for a draft, more for more points.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from symbolic.cycles.cycle import discriminant, minor_axis
from symbolic.cycles.thresholds import lambda_minus, stability_number, trace_of
from symbolic.tables.table import a as a_letter
from symbolic.tables.table import lam as lam_letter
from verification.paper.figures.phase import SEED, facts, flights, outline, slap_panel
from verification.paper.figures.phase import draw_slap as draw_slap
from verification.plots.sheet import (
    BLACK,
    DARK,
    FAINT,
    OUTLINE,
    Array,
    Curve,
    Panel,
    Panels,
    legend,
    scaled,
    sheet,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


TABLES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("ellipse", {"a": "1.2"}),
    ("cardioid", {}),
    ("cuspless", {}),
    ("egg", {"alpha": "0.05"}),
)


def centres(map: PinballMap, theta: Array) -> tuple[Array, Array]:
    """The centre of curvature of the first component at each `theta`.

    It lies on the inward normal at the distance of the radius of curvature. Paper: section 2.2. A cusp has none.

    >>> x, y = centres(PinballMap("ellipse", a=2), np.array([0.0]))  # at the tip of the major axis, b**2/a from it
    >>> float(x[0]), abs(float(y[0]))
    (1.5, 0.0)
    """
    where = np.zeros(theta.shape, dtype=np.int64)
    x, y, tx, ty = map.states.frame(where, theta)
    radius = -1 / map.states.curvature(where, theta)
    return x - radius * ty, y + radius * tx


def evolutes(fine: float = 1.0) -> Panels:
    """The evolutes of the tables (envelopes of the normals), and flights of the slap map, which touch them."""
    panels = []
    for table, shape in TABLES:
        map = PinballMap(table, lam=0, **shape)
        low, high = map.states.ends[0]
        starts, points = (low + (high - low) * (np.arange(n) + 0.5) / n for n in (40, scaled(400, fine, 20)))
        curves = {
            "boundary": outline(map),
            "flights": flights(map.orbit(starts, np.zeros(40), 1)),
            "evolute": Curve(*centres(map, points)),
        }
        letters = {"alpha": r"\alpha"}
        title = table + "".join(f", ${letters.get(name, name)} = {value}$" for name, value in shape.items())
        panels.append(Panel(title, "x", "y", curves, facts=facts(map)))
    return tuple(panels)


def draw_evolutes(panels: Panels) -> "Figure":
    """Draws the evolutes as thick lines, with the boundary and flights."""
    figure, axes = sheet(panels, columns=4, height=2.2)
    for ax, panel in zip(axes, panels, strict=True):
        ax.plot(*panel.curves["boundary"], **OUTLINE)
        ax.plot(*panel.curves["flights"], color="0.7", lw=0.3)
        ax.plot(*panel.curves["evolute"], color=BLACK, lw=1.4)
    return figure


LONG = 5  # the semi-axis of the ellipse whose eigenvalues are shown


def configuration(fine: float = 1.0) -> Panels:
    """One trajectory in the circle and one in the ellipse at `lam = 0.99`.

    In the circle the start is random; in the ellipse the particle leaves an end of the major axis, at a thousandth of a
    radian to that axis.
    """
    circle, ellipse = PinballMap("circle", lam="0.99"), PinballMap("ellipse", lam="0.99", a="1.5")
    start = interior_starts(circle, 1, SEED)
    random = float(start.theta[0]), float(start.phi[0])
    bounces = scaled(600, min(fine, 1.0), 20)
    panels = []
    for map, (polar, phi), title in ((circle, random, "circle"), (ellipse, (0.0, 1e-3), "ellipse, $a = 1.5$")):
        orbit = map.orbit(np.array([polar]), np.array([phi]), bounces)
        curves = {"boundary": outline(map), "trajectory": flights(orbit)}
        panels.append(Panel(title, "x", "y", curves, facts=facts(map, theta=polar, phi=phi, bounces=bounces)))
    return tuple(panels)


def draw_configuration(panels: Panels) -> "Figure":
    """Draws the trajectories, with later flights lighter."""
    from matplotlib.collections import LineCollection

    figure, axes = sheet(panels, height=3.0)
    for ax, panel in zip(axes, panels, strict=True):
        ax.plot(*panel.curves["boundary"], **OUTLINE)
        points = np.array(panel.curves["trajectory"]).T[:-1]
        shades = np.linspace(0, 0.8, len(points) - 1)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        ax.add_collection(LineCollection(list(segments), colors=[(g, g, g) for g in shades], linewidths=0.4))
    return figure


def eigenvalues(fine: float = 1.0) -> Panels:
    """The moduli of both multipliers of the minor axis at `a = 5`, against `lam`; and `lambda_-(5)`."""
    from symbolic.expressions.text import kernel, load
    from verification.arithmetic.balls import ARRAYS

    P = stability_number(minor_axis()).subs(a_letter, LONG)
    trace = trace_of(P)
    values = {"half": trace / 2, "quarter": discriminant(trace, lam_letter**2) / 4}
    turn = float(lambda_minus().subs(a_letter, LONG))
    lam = np.unique(np.append(np.linspace(0, 1, scaled(400, fine, 5)), turn))
    half, quarter = load(kernel("eigenvalues", [lam_letter], values), ARRAYS)(lam)
    root = np.sqrt(quarter.astype(complex))
    curves = {name: Curve(lam, np.abs(half + sign * root)) for name, sign in (("mu_plus", 1), ("mu_minus", -1))}
    return (Panel("ellipse, $a = 5$", "lam", "modulus", curves, facts={"a": LONG, "lambda_minus": turn}),)


def draw_eigenvalues(panels: Panels) -> "Figure":
    """Draws the moduli of both multipliers, and a dotted line where they meet."""
    figure, (ax,) = sheet(panels, columns=1, height=3.0)
    (panel,) = panels
    ax.plot(*panel.curves["mu_plus"], color=BLACK, label=r"$|\mu_+|$")
    ax.plot(*panel.curves["mu_minus"], color=DARK, ls="--", lw=1.4, label=r"$|\mu_-|$")
    ax.axvline(float(panel.facts["lambda_minus"]), **FAINT)
    ax.set_xlim(0, 1)
    ax.set_ylim(0, 1)
    legend(ax)
    return figure


def slap(fine: float = 1.0) -> Panels:
    """The slap map and its second iterate at `a = 1.2`, in polar angles."""
    return (slap_panel("ellipse, $a = 1.2$", PinballMap("ellipse", lam=0, a="1.2"), (1, 2), fine, by_angle=True),)
