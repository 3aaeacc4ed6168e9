"""Figures of the results of commands: `--plot FILE` draws the numbers that were printed.

Many points are drawn as a density, whose opacity is the logarithm of the count. All tables can be drawn, under every
reflection law, also if they have several components or holes.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.lowering.files import write_whole
from verification.plots.sheet import (
    AXES,
    FAINT,
    INK,
    OUTLINE,
    PALETTE,
    Array,
    figure,
    figure_of,
    image,
    ink,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from numeric.dynamics.attractors import Attractor
    from numeric.pinball.states import Orbit, Slap
    from symbolic.tables.scene import Scene
    from verification.cycles.search import Catalogue

OUTLINE_POINTS = 721  # on the outline of a component
DOTS = 2000  # points that are drawn one by one; more are a density
FLIGHTS = 600  # at most, of an orbit or a chaotic attractor in the table
SMALL = 12  # at most, tables on a sheet of cycles
LABELLED = 10  # at most, attractors or iterates in a legend
MARK = "#b3261e"
CELLS: dict[str, Any] = {"origin": "lower", "aspect": "auto", "interpolation": "nearest"}


class Marked(NamedTuple):
    """A proved value of the parameter, and a text that says what happens at it."""

    value: float
    words: str


def drawn(kind: str, results: Sequence[Any], ending: str) -> bytes:
    """The picture of a command's results; `kind` is `module.function` in `verification.plots`, `ending` a suffix."""
    module, _, name = kind.partition(".")
    with styled():
        return image(getattr(import_module(f"verification.plots.{module}"), name)(*results), ending)


def shown(kind: str, results: Sequence[Any], axes: Any = None) -> "Figure":
    """The figure of results for a script or a notebook; on given axes, or new.

    `kind` is the function that draws it: `module.function` in `verification.plots`, or a full name. A new figure is
    saved in the style in which it was drawn.
    """
    if isinstance(axes, str | Path):
        path = repr(str(axes))
        raise ValueError(f"plot: {path} is no Matplotlib axes; plot() gives a figure, saved by plot().savefig({path})")
    module, _, name = kind.rpartition(".")
    where = module if "." in module else f"verification.plots.{module}"
    with styled():
        made: Figure = getattr(import_module(where), name)(*results, axes=axes)
    if axes is None:
        vars(made)["_repr_png_"] = partial(_png, made)  # by which a notebook shows it
        vars(made)["savefig"] = partial(_saved, made)
    return made


def _saved(made: "Figure", file: Any, **options: Any) -> None:
    """Saves a figure in its style to an open file, or whole or not at all to the file of a path."""
    if isinstance(file, str | Path):
        _saved(made, buffer := BytesIO(), **{"format": Path(file).suffix[1:] or "png"} | options)
        write_whole(file, buffer.getvalue())
    else:
        with styled():  # fonts and resolution are looked up when a figure is saved
            type(made).savefig(made, file, **options)


def _png(made: "Figure") -> bytes:
    with styled():
        return image(made, ".png")


def outline(map: PinballMap) -> tuple[Array, Array]:
    """`x` and `y` of points along the boundary; a nan separates components that are not joined."""
    x: list[Array] = []
    y: list[Array] = []
    for index, (low, high) in enumerate(map.states.ends):
        theta = np.linspace(low, high, OUTLINE_POINTS)
        here = map.states.point(np.full(OUTLINE_POINTS, index), theta)
        if x and np.hypot(here[0][0] - x[-1][-1], here[1][0] - y[-1][-1]) > 1e-6:
            x.append(np.array([np.nan]))
            y.append(np.array([np.nan]))
        x.append(here[0])
        y.append(here[1])
    return np.concatenate(x), np.concatenate(y)


def position(map: PinballMap, s: Array) -> tuple[Array, tuple[float, float]]:
    """Arc length reduced to `[-L/2, L/2]` (unchanged if the table has holes), and the ends of its range.

    >>> position(PinballMap("circle"), np.array([4.0]))[0].round(4).tolist()
    [-2.2832]
    """
    length = map.arclength.perimeter
    if np.isnan(outline(map)[0]).any():
        low = min(map.arclength.offsets)
        return s, (low, low + length)
    return np.remainder(s + length / 2, length) - length / 2, (-length / 2, length / 2)


def joins(axes: "Axes", map: PinballMap) -> None:
    """Draws a faint line at the arc length of each join of two components."""
    ends = [ends[0] for ends in map.states.ends]
    if len(ends) > 1:
        s = np.array([map.arclength.s(np.array(low), index) for index, low in enumerate(ends)], dtype=float)
        for place in position(map, s)[0]:
            axes.axvline(place, **FAINT)


def table(axes: "Axes", map: PinballMap) -> None:
    """Draws the boundary alone, to scale."""
    axes.plot(*outline(map), **OUTLINE)
    axes.set_aspect("equal")
    axes.set_axis_off()


def phase(axes: "Axes", map: PinballMap) -> tuple[float, float]:
    """Labels the axes as phase space of `s` and `sin(phi)`, sets their limits, and returns the ends of `s`."""
    ends = position(map, np.zeros(1))[1]
    joins(axes, map)
    axes.set_xlim(*ends)
    axes.set_ylim(-1, 1)
    axes.set_xlabel(AXES["s"])
    axes.set_ylabel(AXES["sin_phi"])
    return ends


def cloud(axes: "Axes", x: Array, y: Array, colour: str, size: float = 2.5) -> None:
    """Draws the points within the limits of the axes: as dots if there are at most `DOTS`, else as a density."""
    from matplotlib.colors import to_rgb

    if x.size <= DOTS:
        axes.plot(x, y, "o", ms=size, mew=0, color=colour)
        return
    x_ends, y_ends = axes.get_xlim(), axes.get_ylim()
    counts, _, _ = np.histogram2d(y, x, bins=(300, 420), range=(y_ends, x_ends))
    axes.imshow(ink(counts, to_rgb(colour)), extent=(*x_ends, *y_ends), **CELLS)


def pair() -> "tuple[Figure, Axes, Axes]":
    """A new figure, with its axes for the table (left) and for phase space (right)."""
    made = figure(7.0, 3.0)
    left, right = made.subplots(1, 2, width_ratios=(1, 1.25))
    return made, left, right


def orbit(map: PinballMap, entries: Sequence[Mapping[str, Any]]) -> "Figure":
    """Figure of the flights of one particle in the table, later ones darker, and of its bounces in phase space."""
    x, y, s, phi = (
        np.array([np.nan if entry[key] is None else float(entry[key]) for entry in entries])
        for key in ("x", "y", "s", "phi")
    )
    made, left, right = pair()
    table(left, map)
    _flights(left, x, y)
    phase(right, map)
    _bounces(right, map, s, phi, "#12264f")
    right.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return made


def flights(found: "Orbit", axes: "Axes | None" = None) -> "Figure":
    """Figure of an `Orbit`: flights and bounces, with the first particles in colours; on given axes, flights only."""
    map = found.map
    assert map is not None
    rows: list[Any] = [np.asarray(row).reshape(len(found.theta), -1)[:, :LABELLED] for row in found]
    component, theta, phi, _, x, y, _ = rows
    left: Any
    right: Any
    made, left, right = pair() if axes is None else (figure_of(axes), axes, None)
    table(left, map)
    if right is not None:
        phase(right, map)
    for number in range(theta.shape[1]):
        colour = PALETTE[number % len(PALETTE)] if theta.shape[1] > 1 else "#12264f"
        _flights(left, x[:, number], y[:, number], colour)
        if right is not None:
            s = np.asarray(map.arclength.s(theta[:, number], component[:, number]))
            _bounces(right, map, s, phi[:, number], colour, None if number else "start")
    if right is not None:
        right.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0))
    return made


def _flights(axes: "Axes", x: Array, y: Array, colour: Any = INK) -> None:
    """Draws the last flights of one particle, later ones darker, and a ring where it started."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgb

    shown = slice(max(0, x.size - FLIGHTS - 1), None)
    points = np.stack([x[shown], y[shown]], axis=1)
    opacity = np.linspace(0.25, 1.0, max(1, len(points) - 1)) * min(1.0, 0.25 + 40 / len(points))
    paint = [(*to_rgb(colour), float(share)) for share in opacity]
    axes.add_collection(LineCollection(list(np.stack([points[:-1], points[1:]], axis=1)), colors=paint, linewidths=0.7))
    axes.plot(x[:1], y[:1], "o", ms=4, mfc="none", color=MARK)
    more = f", the last {FLIGHTS} drawn" if x.size > FLIGHTS + 1 else ""
    axes.set_title(f"{x.size - 1} bounces{more}", loc="left")


def _bounces(axes: "Axes", map: PinballMap, s: Array, phi: Array, colour: str, label: str | None = "start") -> None:
    """Draws the bounces of one particle in phase space, with a ring at the first."""
    cloud(axes, position(map, s)[0], np.sin(phi), colour)
    axes.plot(position(map, s[:1])[0], np.sin(phi[:1]), "o", ms=5, mfc="none", ls="", color=MARK, label=label)


def attractors(map: PinballMap, found: "Sequence[Attractor]", axes: "Axes | None" = None) -> "Figure":
    """Figure of attractors, each in its colour: flights in the table, points in phase space, fraction of starts.

    On given axes, only phase space is drawn.
    """
    left: Any
    right: Any
    made, left, right = pair() if axes is None else (figure_of(axes), None, axes)
    phase(right, map)
    if left is not None:
        made.set_size_inches(7.0, 3.5)
        table(left, map)
    for number, one in enumerate(found):
        colour = PALETTE[number % len(PALETTE)]
        component, theta, phi = one.points
        few = slice(None) if one.period else slice(0, FLIGHTS)
        leg = map.orbit(theta[few], phi[few], 1, component[few])
        going = leg.code[1] == 0
        if left is not None:
            left.plot(leg.x[:, going], leg.y[:, going], color=colour, lw=1.1 if one.period else 0.25, alpha=0.9)
        s = position(map, np.asarray(map.arclength.s(theta, component)))[0]
        cloud(right, s, np.sin(phi), colour, 4.0 if one.period else 1.5)
        name = f"period {one.period}" if one.period else one.kind.name.lower()
        share = f", {one.share.count / one.share.of:.1%}" if one.share else ""
        if number < LABELLED:
            right.plot([], [], "o", ms=5, mew=0, color=colour, label=name + share)
    beside(made, right, axes is None, min(4, max(1, len(found))))
    return made


def beside(made: "Figure", axes: "Axes", own: bool, columns: int) -> None:
    """Puts the legend below the figure if `own` is true, else to the right of the axes."""
    if own:
        made.legend(loc="outside lower center", ncols=columns)
    else:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))


def exponents(document: Mapping[str, Any], axes: "Axes | None" = None) -> "Figure":
    """Figure of both exponents of each attractor, with two standard errors, and of the errors by number of bounces.

    On given axes, only the exponents are drawn.
    """
    if axes is None:
        made = figure(7.0, 3.4)
        left, right = made.subplots(1, 2)
    else:
        made, left, right = figure_of(axes), axes, None
    groups = [group for group in document["groups"] if group["nu_plus"] is not None]
    left.axhline(0, **FAINT)
    for number, group in enumerate(groups):
        colour = PALETTE[number % len(PALETTE)]
        for name, face in (("nu_plus", colour), ("nu_minus", "none")):
            if group[name] is not None:
                error = 2 * (group[f"{name}_stderr"] or 0.0)
                left.errorbar(number, group[name], error, fmt="o", ms=5, mfc=face, color=colour, capsize=3)
        trace = [row for row in group.get("trace", ()) if row["nu_plus_stderr"]]
        if right is not None and trace and not group.get("period"):  # a cycle's exponents are those of its multipliers
            count = [row["collisions"] for row in trace]
            right.loglog(count, [row["nu_plus_stderr"] for row in trace], "o-", ms=3, color=colour)
        name = f"period {group['period']}" if group.get("period") else group["kind"]
        if number < LABELLED:
            left.plot([], [], "o", color=colour, label=f"{name}, {group['orbits']} orbits")
    left.set_xticks([])
    left.set_xlim(-0.7, max(0.7, len(groups) - 0.3))
    left.set_ylabel(r"$\nu_+$ (filled), $\nu_-$ (open)")
    if right is not None:
        right.set_xlabel("bounces counted")
        right.set_ylabel(r"standard error of $\nu_+$")
    if groups:
        beside(made, left, axes is None, min(3, len(groups)))
    return made


def slap(map: PinballMap, component: NDArray[np.int64], theta: Array, values: "Slap") -> "Figure":
    """Figure of the iterates of the slap map over arc length, with the diagonal, and of the map's slope."""
    s, ends = position(map, np.asarray(map.arclength.s(theta, component)))
    order = np.argsort(s)
    made = figure(7.0, 3.6)
    left, right = made.subplots(1, 2)
    left.plot(ends, ends, **FAINT)
    looks: tuple[dict[str, Any], ...] = ({"color": INK, "lw": 1.4}, {"color": "#c8691c"}, {"color": "#2ca02c"})
    for k in range(1, len(values.theta)):
        images = position(map, np.asarray(map.arclength.s(values.theta[k], values.component[k])))[0]
        images = np.where(values.code[k] == 0, images, np.nan)[order]
        look = looks[k - 1] if k <= len(looks) else {"color": "0.6", "lw": 0.6}
        label = f"$T_0^{{{k}}}$" if k > 1 else "$T_0$"
        left.plot(s[order], _with_gaps(images), zorder=9 - k, label=label if k < LABELLED else None, **look)
    right.axhspan(-1, 1, color="0.85", lw=0)
    right.plot(s[order], _with_gaps(values.slope[order]), color=INK)
    bound = 1.3 * float(np.nanquantile(np.abs(values.slope), 0.98)) if np.isfinite(values.slope).any() else 1.5
    right.set_ylim(-max(bound, 1.5), max(bound, 1.5))
    left.set_ylim(*ends)
    left.set_ylabel("$T_0^n(s)$" if len(values.theta) > 2 else "$T_0(s)$")
    right.set_ylabel("$T_0'(s)$")
    for axes in (left, right):
        joins(axes, map)
        axes.set_xlabel("$s$")
        axes.set_xlim(*ends)
    if len(values.theta) > 2:
        made.legend(loc="outside lower center", ncols=min(6, len(values.theta) - 1))
    return made


def _with_gaps(values: Array) -> Array:
    """The values, with nan before each jump (a step of more than 8 times the upper quartile of the steps).

    >>> _with_gaps(np.array([0.0, 1.0, 2.0, 30.0, 31.0, 32.0])).tolist()
    [0.0, 1.0, nan, 30.0, 31.0, 32.0]
    """
    steps = np.abs(np.diff(values, append=values[-1:]))
    usual = np.nanquantile(steps, 0.75) if np.isfinite(steps).any() else 0.0
    return np.where(steps > 8 * usual, np.nan, values)


def closed(axes: "Axes", map: PinballMap, components: Sequence[int], theta: Sequence[float], **look: Any) -> None:
    """Draws the chords of a cycle, each once: a second dashed line would fill the gaps of the first."""
    x, y = map.states.point(np.array([*components, components[0]]), np.array([*theta, theta[0]], dtype=float))
    ends = [tuple(end) for end in np.round(np.stack([x, y], axis=1), 6)]
    chords = {frozenset(pair): i for i, pair in reversed(list(enumerate(pairwise(ends))))}
    at = np.array(sorted(chords.values()))
    axes.plot(*(np.stack([z[at], z[at + 1], np.full(at.size, np.nan)], axis=1).ravel() for z in (x, y)), **look)


def cycles(scene: "Scene", catalogue: "Catalogue") -> "Figure":
    """Figure of the first cycles in the catalogue, each in a table; solid if stable, dashed if unstable."""
    map, found = PinballMap(scene), catalogue.cycles
    rows = max(1, -(-min(len(found), SMALL) // 4))
    made = figure(7.0, 2.0 * rows + 0.3)
    panels = np.ravel(made.subplots(rows, 4))
    for axes in panels:
        axes.set_axis_off()
    for axes, one in zip(panels, found, strict=False):
        stable = one.spectrum.stable
        table(axes, map)
        look: dict[str, Any] = {"color": PALETTE[0], "lw": 1.3} if stable else {"color": MARK, "lw": 0.9, "ls": "--"}
        closed(axes, map, one.components, one.theta, **look)
        largest = max(abs(m) for m in one.spectrum.multipliers)
        axes.set_title(f"{one.period}:  $|\\mu| = {largest:.3g}$", fontsize=8)
    more = f", the first {SMALL} shown" if len(found) > SMALL else ""
    made.suptitle(f"{len(found)} cycles{more}: period, and the larger multiplier; dashed: unstable", fontsize=9)
    return made
