"""Figures of Morse graphs: the Morse sets in phase space, and the parameter boxes over which a graph continues."""

from typing import TYPE_CHECKING

import numpy as np

from verification.plots.results import CELLS
from verification.plots.sheet import AXES, PALETTE, figure, sides

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from verification.rigorous.graph import MorseGraph

NAMED = len(PALETTE)  # classes that have a colour of their own


def morse_sets(graph: "MorseGraph", label: str) -> "Figure":
    """Figure of the Morse sets in phase space, with proved basins in pale colours; one panel per boundary component."""
    from matplotlib.colors import to_rgb

    grid, leaf, count = graph.transitions.grid, graph.transitions.leaf, graph.transitions.count
    colours = np.ones((count + 1, 3))
    attracting = graph.attracting
    for number, index in enumerate(attracting):
        block = graph.trapping(index)
        if not block[-1]:
            colours[graph.basin(block)] = 0.75 + 0.25 * np.array(to_rgb(f"C{number % 10}"))
    for index, members in enumerate(graph.sets):
        paint = f"C{attracting.index(index) % 10}" if index in attracting else "black"
        colours[members] = to_rgb(paint)
    everything = np.append(leaf, False)
    picture = grid.to_array(graph.transitions.chosen(everything), np.flatnonzero(leaf), count)
    made = figure(7.0, 3.2 * len(grid.charts))
    panels = np.atleast_1d(made.subplots(len(grid.charts), 1))
    for axes, chart, cells in zip(panels, grid.charts, picture, strict=True):
        axes.imshow(
            colours[cells].swapaxes(0, 1),
            origin="lower",
            extent=(*chart.x, *chart.y),
            aspect="auto",
            interpolation="nearest",
        )
        axes.set_xlabel(rf"$\theta$, {chart.name}")
        axes.set_ylabel(r"$\varphi$")
    word = "set" if len(graph.sets) == 1 else "sets"
    panels[0].set_title(f"{label}: {len(graph.sets)} Morse {word}, {len(attracting)} attracting")
    return made


def database(found: "xr.Dataset") -> "Figure":
    """Figure of the parameter boxes, coloured by class of Morse graphs, and by the number of trapping regions."""
    from matplotlib.colors import ListedColormap, to_rgb

    from verification.proofs.global_dynamics.database import continued

    label, attracting = continued(found), found.attracting.values.astype(float)
    colours = np.array([*map(to_rgb, PALETTE), (0.82, 0.82, 0.82), (1.0, 1.0, 1.0)])
    made = figure(7.0, 3.6)
    left, right = made.subplots(1, 2, sharey=True)
    shape = str(found.sets.dims[0])
    extent = (*sides(found.lam.values), *sides(found[shape].values))
    left.imshow(colours[np.where(label < 0, NAMED + 1, np.minimum(label, NAMED))], extent=extent, **CELLS)
    left.set_title("Morse graphs that continue", fontsize=9)
    most = max(1, int(attracting.max(initial=1)))
    shades = ListedColormap([str(0.93 - 0.75 * i / max(1, most - 1)) for i in range(most)])
    shown = right.imshow(
        np.where(attracting < 1, np.nan, attracting), extent=extent, cmap=shades, vmin=0.5, vmax=most + 0.5, **CELLS
    )
    right.set_title("disjoint trapping regions, up to rotation", fontsize=9)
    made.colorbar(shown, ax=right, ticks=range(1, most + 1), pad=0.02)
    for axes in (left, right):
        axes.set_xlabel(AXES["lam"])
    left.set_ylabel(AXES.get(shape, shape))
    return made
