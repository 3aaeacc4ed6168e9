"""The evolutes of the tables, which every flight of the slap map touches. Paper: section 2.2; no figure there."""

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from numeric import PinballMap
from symbolic.geometry import evolute
from symbolic.symbols import theta
from verification.figures.panel import Array, Curve, Panel, Panels, scaled
from verification.figures.phase import facts, flights, outline
from verification.figures.sheet import BLACK, OUTLINE, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TABLES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("ellipse", {"a": "1.2"}),
    ("cardioid", {}),
    ("cuspless", {}),
    ("egg", {"alpha": "0.05"}),
)


@cache
def centres(table: str, **shape: str) -> Callable[[Array], tuple[Array, Array]]:
    """The centre of curvature of the first component against `theta`, from the exact formula."""
    from symbolic.codegen import kernel, load
    from symbolic.tables import named
    from verification.arithmetic import ARRAYS

    x, y = evolute(named(table).at(**shape).components[0])
    return load(kernel("evolute", [theta], {"x": x, "y": y}), ARRAYS)


def evolutes(fine: float = 1.0) -> Panels:
    """The envelope of the normals, with flights of the slap map that touch it.

    The wall of the cuspless cardioid is straight and has its centre of curvature at infinity.
    """
    panels = []
    for table, shape in TABLES:
        map = PinballMap(table, lam=0, **shape)
        low, high = map.states.ends[0]
        starts = low + (high - low) * (np.arange(40) + 0.5) / 40
        curves = {
            "boundary": outline(map),
            "flights": flights(map.orbit(starts, np.zeros(40), 1)),
            "evolute": Curve(*centres(table, **shape)(np.linspace(low, high, scaled(400, fine, 20)))),
        }
        letters = {"alpha": r"\alpha"}
        title = table + "".join(f", ${letters.get(name, name)} = {value}$" for name, value in shape.items())
        panels.append(Panel(title, "x", "y", curves, facts=facts(map)))
    return tuple(panels)


def draw_evolutes(panels: Panels) -> "Figure":
    """The evolutes thick."""
    figure, axes = sheet(panels, columns=4, height=2.2)
    for ax, panel in zip(axes, panels, strict=True):
        ax.plot(*panel.curves["boundary"], **OUTLINE)
        ax.plot(*panel.curves["flights"], color="0.7", lw=0.3)
        ax.plot(*panel.curves["evolute"], color=BLACK, lw=1.4)
    return figure
