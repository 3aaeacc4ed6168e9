"""Figures on the egg with three vertices. Paper: section 6.

They show elastic collisions, the slap map, cycles of period 3, the parameter plane, and the attractors, also as
functions of the contraction. `fine` is the resolution: 1 for a draft, more for more points.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from sympy import Rational

from numeric import PinballMap
from numeric.backends import elementary
from numeric.pinball.sampling import Starts, interior_starts, phase_starts
from numeric.sweeps.run import in_memory
from numeric.sweeps.space import followed
from numeric.sweeps.sweep import Array, counted
from numeric.sweeps.workers import cores
from symbolic.cycles.polygons import near_flat
from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables.table import alpha as alpha_letter
from symbolic.tables.table import lam as lam_letter
from verification.paper.figures.cardioid import cycle_points, found, in_the_table, orbit_on
from verification.paper.figures.phase import SEED, by_angle, facts, outline, particles_of, polar, slap_panel
from verification.paper.figures.phase import draw_slap as draw_slap
from verification.paper.figures.phase import slap_by_angle as slap_graph
from verification.plots.sheet import (
    BLACK,
    CROSS,
    DARK,
    FAINT,
    LIGHT,
    MIDDLE,
    OUTLINE,
    Curve,
    Fact,
    Panel,
    Panels,
    Raster,
    cloud,
    legend,
    scaled,
    sheet,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


ALPHA = "0.08"
TRIANGLES = ("1.0", "0.9", "0.8", "0.7", "0.6", "0.5", "0.45", "0.41", "0.40")


def islands(fine: float = 1.0) -> Panels:
    """Elastic orbits from many starts, at three shapes; each orbit is a separate curve."""
    panels = []
    for alpha in ("0.02", "0.05", "0.08"):
        map, particles, bounces = PinballMap("egg", lam=1, alpha=alpha), 60, scaled(400, fine, 20)
        starts = phase_starts(map, particles, SEED)
        orbit = map.orbit(starts.theta, starts.phi, bounces)
        curves = {f"orbit {i}": by_angle(particles_of(orbit, i)) for i in range(particles)}
        known = facts(map, seed=SEED, bounces=bounces)
        panels.append(Panel(rf"$\alpha = {alpha}$", "theta", "sin_phi", curves, facts=known))
    return tuple(panels)


def draw_islands(panels: Panels) -> "Figure":
    """Draws the orbits; neighbouring orbits differ in lightness, so that they can be distinguished."""
    figure, axes = sheet(panels, columns=3, height=2.6)
    for ax, panel in zip(axes, panels, strict=True):
        for i, curve in enumerate(panel.curves.values()):
            cloud(ax, curve, (BLACK, DARK, MIDDLE, "0.6", LIGHT)[i % 5], size=0.5)
    return figure


def slap(fine: float = 1.0) -> Panels:
    """The slap map and its iterates up to the fourth, at two shapes."""
    return tuple(
        slap_panel(rf"$\alpha = {alpha}$", PinballMap("egg", lam=0, alpha=alpha), range(1, 5), fine, by_angle=True)
        for alpha in ("0.05", "0.08")
    )


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
    """Draws the elastic triangle thick, the other triangles lighter as `lam` falls, and the diameters dotted."""
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
    """The position after three bounces against the first one, for all first angles that a collision can produce.

    These are the angles `|phi| <= lam*pi/2`; at `lam = 0` the result is the graph of the slap map's third iterate.
    """
    curves = {"0.0": slap_graph(PinballMap("egg", lam=0, alpha=ALPHA), 3, scaled(400, fine, 20))}
    rng, particles = np.random.default_rng(SEED), scaled(600, fine, 20)
    for lam in ("0.2", "0.3", "0.4"):
        map = PinballMap("egg", lam=lam, alpha=ALPHA)
        theta = rng.uniform(-np.pi, np.pi, particles)
        phi = rng.uniform(-1, 1, particles) * (float(lam) * np.pi / 2)
        curves[lam] = Curve(theta, polar(map, map.orbit(theta, phi, 3).theta[-1]))
    known = facts(PinballMap("egg", lam=[float(lam) for lam in curves], alpha=ALPHA), seed=SEED, particles=particles)
    return (Panel(rf"$\alpha = {ALPHA}$", "theta", "theta_3", curves, facts=known),)


def draw_perturbed_slap(panels: Panels) -> "Figure":
    """Draws the curve for contraction 0, points with a different mark for each other contraction, and the diagonal."""
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


SHADES = (DARK, MIDDLE, LIGHT)
SHOWN = 250  # flights of a chaotic orbit in one direction
RANGE = (0.36, 0.46)  # contractions of the bifurcation diagram


def configurations(fine: float = 1.0) -> Panels:
    """The attractors in the table at four contractions; a chaotic one is shown by an orbit on it."""
    return in_the_table("egg", ("0.1", "0.39", "0.43", "0.45"), scaled(4000, min(fine, 1.0), 20), alpha=ALPHA)


def along(curve: Curve, k: int) -> Curve:
    """The flights that are nearest in direction to the diameter at `k*pi/3`, at most `SHOWN`, with gaps between.

    >>> along(Curve(np.array([0.0, 1.0, 1.0]), np.array([0.0, 0.1, 2.0])), 0).x.tolist()
    [0.0, 1.0, nan]
    """
    x, y = curve
    direction = elementary.arctan2(np.diff(y), np.diff(x))
    chosen = np.flatnonzero(np.round(np.nan_to_num(direction, nan=9.0) / (np.pi / 3)) % 3 == k)[:SHOWN]
    gaps = np.full(chosen.size, np.nan)
    return Curve(*(np.stack([z[chosen], z[chosen + 1], gaps], axis=1).ravel() for z in (x, y)))


def draw_configurations(panels: Panels) -> "Figure":
    """Draws flights in three shades, by the diameter that they follow, and period 3 in black."""
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
    """Draws the attractors at 0.43 on top of the one at 0.45, period 3 as crosses, and the enlarged part."""
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
    """Particles from random starts after a long time, for contractions around the cascade and the merging crisis."""
    from numeric.sweeps.fields import bifurcation as sweep
    from numeric.sweeps.sweep import text_of
    from symbolic.tables.scene import Scene

    lams = np.linspace(*RANGE, scaled(300, fine**0.5, 4))
    orbits, points = scaled(12, fine**0.25, 4), scaled(40, fine**0.25, 8)
    found = in_memory(sweep(text_of(Scene("egg", alpha=ALPHA)), lams, orbits, points, 80, 3000, seed=SEED), cores())
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
    """Draws a horizontal slice for each contraction, as in the paper."""
    figure, (ax,) = sheet(panels, columns=1, height=4.4)
    (panel,) = panels
    cloud(ax, panel.curves["attractors"], BLACK, size=0.35)
    ax.set_ylim(*RANGE)
    return figure


NAMES = ("no chaos found", "chaos", "undecided")


EARLY = 200  # bounces after which most orbits have reached a cycle and are dropped
FIRST = 8  # starts that are followed first: if one of them is chaotic, the pair is decided


def parameter_space(fine: float = 1.0) -> Panels:
    """The pairs `(alpha, lam)` for which one of 100 random starts is chaotic, and the curve `alpha_tilde(lam)`.

    An exponent counts as positive if it exceeds twice its error (`numeric.sweeps.sweep`); a pair with no chaotic orbit,
    but with an undecided one, is undecided. The starts differ between values of `lam`; they are those of the elastic
    egg of the middle shape, which are valid for every shape.
    """
    from symbolic.expressions.text import kernel, load
    from verification.arithmetic.balls import ARRAYS

    side, each = scaled(40, fine**0.5, 3), scaled(100, min(fine, 1.0), 4)
    bounces = scaled(1000, min(fine, 2.0), 40)
    alphas, lams = np.round(np.linspace(0, 0.1, side + 1), 12), np.round(np.linspace(0, 1, side + 1), 12)
    starts = interior_starts(PinballMap("egg", lam=1, alpha="0.05"), lams.size * each, SEED)
    rows = [signs(PinballMap("egg", alpha=repr(float(a))), lams, starts, bounces) for a in alphas]
    raster = Raster(lams, alphas, np.array(rows), NAMES)
    lam = np.linspace(0, 1, 201)
    tilde = load(kernel("alpha_tilde", [lam_letter], {"alpha": alpha_tilde()}), ARRAYS)(lam)[0]
    known: dict[str, Fact] = {"table": "egg", "seed": SEED, "starts": each, "bounces": bounces, "transient": bounces}
    return (Panel("", "lam", "alpha", {"alpha_tilde": Curve(lam, tilde)}, raster, known),)


def signs(table: PinballMap, lams: Array, starts: Starts, bounces: int) -> NDArray[np.int64]:
    """For each contraction 1 if one of its starts is chaotic, 2 if this is undecided, else 0.

    Exponents are measured over `bounces` bounces after a transient of the same length. An orbit that is periodic after
    `EARLY` bounces is on an attracting cycle and is dropped. If one of the `FIRST` starts is chaotic, the others are
    not computed.

    >>> starts = interior_starts(PinballMap("egg", lam=1, alpha="0.09"), 8, 1)
    >>> signs(PinballMap("egg", alpha="0.09"), np.array([0.1, 0.3]), starts, 400).tolist()
    [0, 1]
    """
    each, some, all_ = starts.theta.size // lams.size, np.zeros(lams.size, dtype=bool), np.ones(lams.size, dtype=bool)
    for first, last in ((0, FIRST), (FIRST, each)):
        left = np.flatnonzero(~some)
        which = (left[:, None] * each + np.arange(each)[first:last]).ravel()
        if which.size:
            lam = np.repeat(lams[left], which.size // left.size)
            signed = _signs(table.at(lam), lam, starts.only(which), bounces)
            chaotic, decided = (row.reshape(left.size, -1) for row in signed)
            some[left], all_[left] = chaotic.any(axis=1), all_[left] & decided.all(axis=1)
    return np.where(some, 1, np.where(all_, 0, 2))


def _signs(map: PinballMap, lam: Array, starts: Starts, bounces: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Two masks: which starts are chaotic, and which are decided."""
    early = min(EARLY, bounces)
    soon = followed(map, starts, (early,))
    chaotic, decided = np.zeros(lam.size, dtype=bool), soon.period > 0
    if soon.going.size:
        late = followed(map.at(lam[soon.going]), soon.starts.only(soon.going), (bounces - early,))
        decided[soon.going] = late.period > 0
        if late.going.size:
            found, going = counted(late.growth, bounces), soon.going[late.going]
            chaotic[going], decided[going] = found.chaotic, found.chaotic | found.regular
    return chaotic, decided


def draw_parameter_space(panels: Panels) -> "Figure":
    """Draws chaotic, regular and undecided pairs with different marks; the doubling of period 2 is a black curve."""
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
