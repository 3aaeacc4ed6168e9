"""The figures on the attractors of the three-pointed egg. Paper: sections 6.6 and 6.7.

The figure of the egg's parameter space: chaos or none. Paper: section 6.5.

A small sweep for a figure: on all cores, as plain arrays, with neither xarray nor Zarr.
"""

from typing import TYPE_CHECKING

import numpy as np

from numeric import PinballMap
from verification.paper.figures.cuspless import cycle_points, found, orbit_on, shares
from verification.paper.figures.phase import SEED, by_angle, facts, flights, outline
from verification.plots.sheet import (
    BLACK,
    CROSS,
    DARK,
    LIGHT,
    MIDDLE,
    OUTLINE,
    Curve,
    Fact,
    Panel,
    Panels,
    cloud,
    legend,
    scaled,
    sheet,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

from typing import TYPE_CHECKING

from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables.table import lam as lam_letter
from verification.plots.sheet import Raster

if TYPE_CHECKING:
    from matplotlib.figure import Figure

from numeric.sweeps.run import on_threads
from numeric.sweeps.store import Memory
from numeric.sweeps.sweep import Array, Sweep, cores

ALPHA = "0.08"
SHADES = (DARK, MIDDLE, LIGHT)
SHOWN = 250  # flights of a chaotic orbit in one direction
RANGE = (0.36, 0.46)  # of the bifurcation diagram


def configurations(fine: float = 1.0) -> Panels:
    """The attractors in configuration space at four contractions, a chaotic one by an orbit on it."""
    panels = []
    for lam in ("0.1", "0.39", "0.43", "0.45"):
        map, bounces = PinballMap("egg", lam=lam, alpha=ALPHA), scaled(4000, min(fine, 1.0), 20)
        named = found(map)
        curves = {
            name: cycle_points(map, attractor)[1] if attractor.period else flights(orbit_on(map, attractor, bounces))
            for name, attractor in named.items()
        }
        known = facts(map, seed=SEED, bounces=bounces, **shares(named))
        panels.append(Panel(rf"$\lambda = {lam}$", "x", "y", {"boundary": outline(map), **curves}, facts=known))
    return tuple(panels)


def along(curve: Curve, k: int) -> Curve:
    """The flights that are nearest in direction to the diameter at `k*pi/3`, no more than `SHOWN`, with gaps between.

    >>> along(Curve(np.array([0.0, 1.0, 1.0]), np.array([0.0, 0.1, 2.0])), 0).x.tolist()
    [0.0, 1.0, nan]
    """
    x, y = curve
    direction = np.arctan2(np.diff(y), np.diff(x))
    chosen = np.flatnonzero(np.round(np.nan_to_num(direction, nan=9.0) / (np.pi / 3)) % 3 == k)[:SHOWN]
    gaps = np.full(chosen.size, np.nan)
    return Curve(*(np.stack([z[chosen], z[chosen + 1], gaps], axis=1).ravel() for z in (x, y)))


def draw_configurations(panels: Panels) -> "Figure":
    """A shade for each of the three directions, so that a merged attractor shows its parts; period 3 black."""
    figure, axes = sheet(panels, columns=4, height=2.1)
    for ax, panel in zip(axes, panels, strict=True):
        ax.plot(*panel.curves["boundary"], **OUTLINE)
        for name, curve in panel.curves.items():
            for k, shade in enumerate(SHADES):
                if name.startswith("chaotic") or (name.startswith("period") and not name.startswith("period 3")):
                    ax.plot(*along(curve, k), color=shade, lw=0.7 if name.startswith("period") else 0.2)
        if float(panel.facts["lam"]) > 0.4:
            ax.plot(*panel.curves["period 3"], color=BLACK, lw=1.2)
    return figure


def attractors(fine: float = 1.0) -> Panels:
    """The attractors in phase space before and after the merging crisis, and a part of the merged one, enlarged."""
    curves, bounces = {}, scaled(4000, fine, 50)
    for lam in ("0.43", "0.45"):
        map = PinballMap("egg", lam=lam, alpha=ALPHA)
        for name, attractor in found(map).items():
            if attractor.period:
                curves[f"{name}, {lam}"] = cycle_points(map, attractor)[0]
            else:
                curves[f"{name}, {lam}"] = by_angle(orbit_on(map, attractor, bounces))
                enlarged = {f"{name}, {lam}": by_angle(orbit_on(map, attractor, 5 * bounces))}
    known = facts(PinballMap("egg", lam=[0.43, 0.45], alpha=ALPHA), seed=SEED, bounces=bounces)
    whole = Panel(rf"$\alpha = {ALPHA}$", "theta", "sin_phi", curves, facts=known)
    return whole, Panel(r"$\lambda = 0.45$, enlarged", "theta", "sin_phi", enlarged, facts=known)


def draw_attractors(panels: Panels) -> "Figure":
    """The smaller set on top of the larger one; period 3 as crosses."""
    figure, (left, right) = sheet(panels, height=3.0)
    whole, enlarged = panels
    for start, color, label in (("0.45", MIDDLE, r"$\lambda = 0.45$"), ("0.43", BLACK, r"$\lambda = 0.43$")):
        chaotic = [curve for name, curve in whole.curves.items() if name.startswith("chaotic") and name.endswith(start)]
        for i, curve in enumerate(chaotic):
            cloud(left, curve, color, label=None if i else label)
    triangles = [curve for name, curve in whole.curves.items() if name.startswith("period 3")]
    for i, curve in enumerate(triangles):
        left.plot(*curve, **(CROSS | {"ms": 5, "mew": 1.0}), label=None if i else "period 3")
    left.set_ylim(-0.5, 0.5)
    left.set_yticks([-0.4, -0.2, 0, 0.2, 0.4])
    legend(left)
    curve = enlarged.curves["chaotic, 0.45"]
    cloud(right, curve, BLACK, size=0.5)
    near = np.abs(curve.x) < 0.5
    right.set_xlim(-0.5, 0.5)
    right.set_xticks([-0.4, -0.2, 0, 0.2, 0.4], ["$-0.4$", "$-0.2$", "$0$", "$0.2$", "$0.4$"])
    right.set_ylim(float(curve.y[near].min()) * 1.05, float(curve.y[near].max()) * 1.05)
    return figure


def bifurcation(fine: float = 1.0) -> Panels:
    """Where balls from random starts are after a long time, for contractions around the cascade and the merging."""
    from numeric.sweeps.fields import bifurcation as sweep
    from numeric.sweeps.sweep import text_of
    from symbolic.tables.scene import Scene

    lams = np.linspace(*RANGE, scaled(300, fine**0.5, 4))
    orbits, points = scaled(12, fine**0.25, 4), scaled(40, fine**0.25, 8)
    found = swept(sweep(text_of(Scene("egg", alpha=ALPHA)), lams, orbits, points, 80, 3000, seed=SEED))
    theta = found["theta"].ravel()
    curve = Curve(theta, np.repeat(lams, orbits * points))
    known: dict[str, Fact] = {
        "table": "egg",
        "alpha": float(ALPHA),
        "seed": SEED,
        "orbits": orbits,
        "points": points,
        "transient": 3080,
    }
    return (Panel(rf"$\alpha = {ALPHA}$", "theta", "lam", {"attractors": curve}, facts=known),)


def draw_bifurcation(panels: Panels) -> "Figure":
    """A horizontal slice for each contraction, as in the paper."""
    figure, (ax,) = sheet(panels, columns=1, height=4.4)
    (panel,) = panels
    cloud(ax, panel.curves["attractors"], BLACK, size=0.35)
    ax.set_ylim(*RANGE)
    return figure


NAMES = ("no chaos found", "chaos", "undecided")


def parameter_space(fine: float = 1.0) -> Panels:
    """Which pairs `(alpha, lam)` have a chaotic orbit among 100 random starts, and `alpha_tilde(lam)`.

    Each sign counts beyond twice its error (`numeric.sweeps.sweep`); a pair with no chaotic orbit and one whose
    sign its error leaves open is undecided.
    """
    from numeric.sweeps.fields import parameter_space as sweep
    from symbolic.expressions.text import kernel, load
    from verification.arithmetic.balls import ARRAYS

    side, starts = scaled(40, fine**0.5, 3), scaled(100, min(fine, 1.0), 4)
    bounces = scaled(1000, min(fine, 2.0), 40)
    alphas, lams = np.round(np.linspace(0, 0.1, side + 1), 12), np.round(np.linspace(0, 1, side + 1), 12)
    found = swept(sweep(alphas, lams, starts, bounces, bounces, seed=SEED))
    chaotic = found["chaotic"] > 0
    undecided = ~chaotic & (found["regular"] < starts)
    raster = Raster(lams, alphas, np.where(chaotic, 1, np.where(undecided, 2, 0)), NAMES)
    lam = np.linspace(0, 1, 201)
    tilde = load(kernel("alpha_tilde", [lam_letter], {"alpha": alpha_tilde()}), ARRAYS)(lam)[0]
    known: dict[str, Fact] = {"table": "egg", "seed": SEED, "starts": starts, "bounces": bounces, "transient": bounces}
    return (Panel("", "lam", "alpha", {"alpha_tilde": Curve(lam, tilde)}, raster, known),)


def draw_parameter_space(panels: Panels) -> "Figure":
    """Crosses and small plus signs, as in the paper; the doubling of period 2 as a black curve."""
    figure, (ax,) = sheet(panels, columns=1, height=3.6)
    (panel,) = panels
    assert panel.raster is not None
    lams, alphas, labels, names = panel.raster
    x, y = np.meshgrid(lams, alphas)
    looks = (("+", "0.72", 2.5, 0.4), ("x", "#a01010", 3.5, 0.8), ("$\\circ$", "0.3", 3.5, 0.2))
    for value, (marker, color, size, width) in enumerate(looks):
        here = labels == value
        if np.any(here):
            ax.plot(x[here], y[here], ls="", marker=marker, color=color, ms=size, mew=width, label=names[value])
    ax.plot(*panel.curves["alpha_tilde"], color=BLACK, lw=1.8, label=r"$\tilde\alpha(\lambda)$")
    ax.set_xlim(-0.015, 1.015)
    ax.set_ylim(-0.0015, 0.1015)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4, handletextpad=0.4)
    return figure


def swept(sweep: Sweep) -> dict[str, Array]:
    """The fields of a sweep by name.

    >>> from numeric.sweeps.fields import parameter_space
    >>> import numpy as np
    >>> int(swept(parameter_space(np.array([0.0]), np.array([0.5]), 3, 40, 40))["chaotic"][0, 0])
    0
    """
    results = Memory(sweep)
    for index, arrays in on_threads(sweep, results.missing(), cores()):
        results.write(index, arrays)
    return results.arrays
