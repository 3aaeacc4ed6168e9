"""Figures of sweeps: basins, attractors against a parameter, parameter space, exponents of attractors.

The resolution is high enough that each cell of a grid has at least one pixel.
"""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from verification.plots.results import CELLS, LABELLED, MARK, Marked
from verification.plots.sheet import AXES, FAINT, INK, PALETTE, Array, figure, figure_of, ink, shaded, sides

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROWS = 500  # at least, in the density of a bifurcation diagram, which has a column for each value
FINEST = 2000.0  # dots per inch, at most
SHOWN = (2, 3, 4, 6, 8, 10)  # periods that a legend names
NAMED = 12  # periods up to this one have a colour of their own


def fine(made: "Figure", axes: "Axes", columns: int, rows: int) -> None:
    """Raises the resolution, up to `FINEST`, until each of `columns` times `rows` cells of the axes has a pixel.

    >>> made = figure(4.0, 3.0)
    >>> fine(made, made.add_subplot(), 2000, 3000)
    >>> made.draw_without_rendering()
    >>> [bool(side > cells) for side, cells in zip(made.axes[0].get_window_extent().size, (2000, 3000))]
    [True, True]
    """
    made.draw_without_rendering()  # which places the axes
    _, _, width, height = axes.get_window_extent().bounds
    asked = made.dpi * max(columns / width, rows / height)
    made.set_dpi(max(made.dpi, min(FINEST, 1.02 * asked)))


def basins(found: "xr.Dataset", axes: "Axes | None" = None) -> "Figure":
    """Figure of the starts `(s, sin(phi))`, each in the colour of the attractor it reaches; blank if none."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import Patch

    from numeric.sweeps.fields import attractors_of

    label, known = np.asarray(found.label.values), attractors_of(found.attrs["settings"])
    paint = np.array([to_rgba(PALETTE[i % len(PALETTE)]) for i in range(len(known))] + [(0.0, 0.0, 0.0, 0.0)])
    own = axes is None
    made = figure(7.0, 4.0) if axes is None else figure_of(axes)
    axes = made.add_subplot() if axes is None else axes
    edges = [sides(np.asarray(found[name].values)) for name in ("s", "sin_phi")]
    axes.imshow(paint[label], extent=(*edges[0], *edges[1]), **CELLS)
    axes.set_xlabel(AXES["s"])
    axes.set_ylabel(AXES["sin_phi"])
    axes.set_title(found.attrs.get("title", ""), loc="left")
    names = [f"period {one['period']}" if one["period"] else one["kind"] for one in known]
    shown = list(enumerate(names))[:LABELLED]
    handles = [Patch(color=PALETTE[i], label=f"{name}, {np.mean(label == i):.1%}") for i, name in shown]
    if own:
        made.legend(handles=handles, loc="outside lower center", ncols=min(4, max(1, len(handles))))
        fine(made, axes, label.shape[1], label.shape[0])
    else:
        axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return made


def bifurcation(found: "xr.Dataset", marks: Sequence[Marked] = (), axes: "Axes | None" = None) -> "Figure":
    """Figure of the attractors against the parameter as a density; proved values are lines, exponents are below.

    On given axes, only the attractors are drawn.
    """
    parameter = str(found.chaotic.dims[0])
    values = np.asarray(found[parameter].values)
    one = int(found.component.max()) == 0
    place = np.asarray((found.theta if one else found.s).values).reshape(values.size, -1)
    place = np.where(np.isfinite(found.s.values.reshape(place.shape)), place, np.nan)
    made = figure(7.0, 6.2) if axes is None else figure_of(axes)
    top, bottom = made.subplots(2, 1, sharex=True, height_ratios=(2.8, 1)) if axes is None else (axes, None)
    ends = (-np.pi, np.pi) if one else (float(np.nanmin(place)), float(np.nanmax(place)))
    place = np.remainder(place + np.pi, 2 * np.pi) - np.pi if one else place
    columns = np.broadcast_to(np.arange(values.size)[:, None], place.shape)
    kept = np.isfinite(place)
    ranges = (ends, (-0.5, values.size - 0.5))
    rows = max(ROWS, values.size * 5 // 8)
    counts, _, _ = np.histogram2d(place[kept], columns[kept], bins=(rows, values.size), range=ranges)
    edges = sides(values)
    top.imshow(ink(counts), extent=(*edges, *ends), **CELLS)
    top.set_ylabel(AXES["theta" if one else "s"])
    if one:
        top.set_yticks([-np.pi, 0, np.pi], [r"$-\pi$", "$0$", r"$\pi$"])
    top.set_xlim(*edges)
    if bottom is None:
        top.set_xlabel(AXES.get(parameter, parameter))
        return made
    nu, error = np.asarray(found.nu_plus.values), np.asarray(found.nu_plus_error.values)
    largest = np.nanargmax(np.where(np.isfinite(nu), nu, -np.inf), axis=1)
    upper, width = (np.take_along_axis(x, largest[:, None], 1)[:, 0] for x in (nu, error))
    bottom.axhline(0, **FAINT)
    bottom.plot(values, np.nanmin(np.where(np.isfinite(nu), nu, np.inf), axis=1), color="0.6", lw=0.7, label="smallest")
    bottom.fill_between(values, upper - 2 * width, upper + 2 * width, color=INK, alpha=0.25, lw=0)
    bottom.plot(values, upper, color=INK, lw=0.8, label="largest of the orbits, with twice its error")
    bottom.set_ylim(max(float(np.nanmin(nu)), -2.0) - 0.05, None)
    bottom.set_xlabel(AXES.get(parameter, parameter))
    bottom.set_ylabel(r"$\nu_+$")
    made.legend(loc="outside lower center", ncols=2)
    labelled(top, bottom, sorted(mark for mark in marks if edges[0] <= mark.value <= edges[1]), edges)
    top.set_xlim(*edges)
    fine(made, top, values.size, rows)
    return made


def labelled(top: "Axes", bottom: "Axes", marks: Iterable[Marked], ends: tuple[float, float]) -> None:
    """Draws lines at the marks in both axes, and their texts above `top`, shifted where they would overlap."""
    near, at = 0.022 * (ends[1] - ends[0]), -np.inf
    for value, words in marks:
        for axes in (top, bottom):
            axes.axvline(value, color=MARK, lw=0.5, alpha=0.7)
        at = max(value, at + near)
        coords: dict[str, Any] = dict.fromkeys(("xycoords", "textcoords"), ("data", "axes fraction"))
        look: dict[str, Any] = {"rotation": 60, "fontsize": 7, "color": MARK, "annotation_clip": False}
        top.annotate(words, (value, 1.0), (at, 1.02), **coords, **look)


def parameter_space(found: "xr.Dataset", axes: "Axes | None" = None) -> "Figure":
    """Figure of the largest exponent over shape and contraction; below it, the period of the least chaotic particle.

    Positive exponents are red, and a line surrounds cells with a chaotic particle. Each period has a colour; a cell
    without a cycle is grey, darker for a larger value of its smallest exponent. On given axes, only the exponents are
    drawn.
    """
    shape = str(found.chaotic.dims[0])
    lams, values = np.asarray(found.lam.values), np.asarray(found[shape].values)
    nu, chaotic = np.asarray(found.nu_max.values, dtype=float), np.asarray(found.chaotic.values > 0, dtype=float)
    if axes is not None:
        shaded(figure_of(axes), lams, values, nu, chaotic, shape, axes)
        return figure_of(axes)
    made = figure(7.0, 7.6)
    top, bottom = made.subplots(2, 1, sharex=True)
    shaded(made, lams, values, nu, chaotic, shape, top)
    top.set_xlabel("")
    painted = periods(np.asarray(found.period.values), np.asarray(found.nu_min.values, dtype=float))
    bottom.imshow(painted, extent=(*sides(lams), *sides(values)), **CELLS)
    bottom.set_xlabel(AXES["lam"])
    bottom.set_ylabel(AXES.get(shape, shape))
    for period in SHOWN:
        bottom.plot([], [], "s", color=colour(period), label=f"period {period}")
    bottom.plot([], [], "s", color="0.5", label="chaos, or unsettled")
    made.legend(loc="outside lower center", ncols=4)
    fine(made, top, lams.size, values.size)
    return made


def periods(period: NDArray[Any], nu: Array) -> Array:
    """RGB image of shape `(rows, columns, 3)`: a colour for each period; else grey, which is darker for larger `nu`.

    >>> periods(np.array([[2, 0]]), np.array([[-1.0, 0.6]]))[0, 1].round(2).tolist()
    [0.4, 0.4, 0.4]
    """
    from matplotlib.colors import to_rgb

    grey = 1 - np.clip(np.nan_to_num(nu), 0.15, 0.85)
    colours = np.array([(0.0, 0.0, 0.0), *(to_rgb(colour(n)) for n in range(1, NAMED + 1))])
    known = (period > 0) & (period <= NAMED)
    return np.where(known[..., None], colours[np.where(known, period, 0)], grey[..., None])


def colour(period: int) -> str:
    """The colour of a period; black for 8, whose colour in the palette would be the grey of chaos.

    >>> colour(8), colour(2) == PALETTE[1]
    ('#000000', True)
    """
    return "#000000" if period == 8 else PALETTE[(period - 1) % len(PALETTE)]


def by_attractor(found: "xr.Dataset") -> "Figure":
    """Figure of both exponents of each attractor against the parameter, with twice their standard errors."""
    parameter = str(found.orbits.dims[0])
    values = np.asarray(found[parameter].values)
    made = figure(7.0, 3.8)
    axes = made.add_subplot()
    axes.axhline(0, **FAINT)
    for name, colour, words in (("nu_plus", "#c8691c", r"$\nu_+$"), ("nu_minus", "#1f4e79", r"$\nu_-$")):
        label: str | None = words
        for group in range(found.group.size):
            nu, error = (np.asarray(found[key].isel(group=group).values) for key in (name, f"{name}_error"))
            kept = (found.orbits.isel(group=group).values > 0) & np.isfinite(nu)
            look: dict[str, Any] = {"fmt": "o", "ms": 2.5, "mew": 0, "color": colour, "elinewidth": 0.7, "capsize": 1.5}
            axes.errorbar(values[kept], nu[kept], 2 * np.nan_to_num(error[kept]), label=label, **look)
            label = None
    axes.set_xlabel(AXES.get(parameter, parameter))
    axes.set_ylabel("exponents, per bounce")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return made
