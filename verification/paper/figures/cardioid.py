"""Figures on the cardioid and the cuspless cardioid. Paper: sections 4 and 5, appendix A.2.

They show Lyapunov exponents against the contraction, and attractors: cycles as closed polygons or marks, chaotic
attractors as one long orbit. `fine` is the resolution: 1 for a draft, more for more points.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from numeric import Orbit, PinballMap
from numeric.backends import elementary
from numeric.dynamics.attractors import find
from numeric.dynamics.recognition import Attractor, Kind
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.sweep import floor_of
from verification.paper.figures.phase import (
    SEED,
    TRANSIENT,
    arc_length,
    by_arc_length,
    draw_slap,
    facts,
    flights,
    outline,
    settled,
    slap_panel,
)
from verification.plots.sheet import (
    BLACK,
    DARK,
    FAINT,
    LIGHT,
    MIDDLE,
    OUTLINE,
    Array,
    Curve,
    Panel,
    Panels,
    cloud,
    legend,
    scaled,
    sheet,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


PARTICLES = 40


def attractors(fine: float = 1.0) -> Panels:
    """The attractor at `lam = 0.3` and `0.8` in phase space, and at `0.3` in the table."""
    panels = []
    for lam in ("0.3", "0.8"):
        map, bounces = PinballMap("cardioid", lam=lam), scaled(500, fine, 20)
        orbit = settled(map, PARTICLES, bounces).orbit
        known = facts(map, seed=SEED, particles=PARTICLES, bounces=bounces, transient=TRANSIENT)
        panels.append(
            Panel(rf"$\lambda = {lam}$", "s", "sin_phi", {"attractor": by_arc_length(map, orbit)}, facts=known)
        )
        if lam == "0.3":
            few = map.orbit(orbit.theta[-1, :8], orbit.phi[-1, :8], scaled(40, min(fine, 1.0)))
            curves = {"boundary": outline(map), "attractor": flights(few)}
            inset = Panel(rf"$\lambda = {lam}$, inset", "x", "y", curves, facts=known)
    return (*panels, inset)


def draw_attractors(panels: Panels) -> "Figure":
    """Draws two phase portraits; the third panel is an inset in the first."""
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
    """Both exponents and their sum against `lam`, averaged over 100 orbits. At `lam = 1` the sum is exactly 0."""
    lams = np.linspace(0.02, 1.0, scaled(50, min(fine, 2.0), 5))
    return (averaged("cardioid", lams, scaled(1000, fine, 50)),)


def draw_exponents(panels: Panels) -> "Figure":
    """Draws `nu_plus` as filled circles, `nu_minus` as open circles, and their sum as a line."""
    figure, (ax,) = sheet(panels, columns=1, height=3.0)
    (panel,) = panels
    ax.axhline(0, **FAINT)
    ax.plot(*panel.curves["nu_plus"], ls="", marker="o", ms=3, color=BLACK, label=r"$\nu_+$")
    ax.plot(*panel.curves["nu_minus"], ls="", marker="o", ms=3, mfc="white", color=DARK, label=r"$\nu_-$")
    ax.plot(*panel.curves["sum"], color="0.45", label=r"$\nu_+ + \nu_-$")
    ax.set_xlim(0, 1.01)
    legend(ax)
    return figure


def slap(fine: float = 1.0) -> Panels:
    """The slap map and its second iterate, arc length against arc length."""
    return (slap_panel("cardioid", PinballMap("cardioid", lam=0), (1, 2), fine),)


ORBITS = 100  # the paper's number for each contraction


def averaged(table: str, lams: Array, bounces: int, orbits: int = ORBITS) -> Panel:
    """Means of both exponents over all orbits, and of `nu_plus` over chaotic orbits and over the other orbits.

    Standard errors over orbits are included; a mean over no orbits is a gap in the curve.
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
    """The mean of the chosen entries of each row; NaN if no entry is chosen."""
    count = chosen.sum(axis=1)
    total = np.where(chosen, values, 0.0).sum(axis=1)
    return np.asarray(np.divide(total, count, out=np.full(count.shape, np.nan), where=count > 0))


JOIN = 3**0.5 / 4  # the arc length of the lower join; the upper one is at -JOIN
CUSPLESS_PARTICLES = 60  # orbits that show an attractor
LAMBDA_C = (27 - 8 * 11**0.5) / 5
STAR = "0.0712172"  # lambda*, as certified
RANGES = (("0.1", "0.2", "0.3"), ("0.4", "0.5", "0.6"), ("0.7", "0.8", "0.9"))


def configurations(fine: float = 1.0) -> Panels:
    """The attractors in the table at four contractions."""
    return in_the_table("cuspless", ("0.02", "0.072", "0.2", "0.5"), scaled(300, min(fine, 1.0), 8))


def in_the_table(table: str, lams: Iterable[str], bounces: int, **shape: Any) -> Panels:
    """A panel for each contraction: the attractors in the table, a chaotic one as an orbit of so many bounces on it."""
    panels = []
    for lam in lams:
        map = PinballMap(table, lam=lam, **shape)
        named = found(map)
        curves = {
            name: cycle_points(map, attractor)[1] if attractor.period else flights(orbit_on(map, attractor, bounces))
            for name, attractor in named.items()
        }
        known = facts(map, seed=SEED, bounces=bounces, **shares(named))
        panels.append(Panel(rf"$\lambda = {lam}$", "x", "y", {"boundary": outline(map), **curves}, facts=known))
    return tuple(panels)


def draw_configurations(panels: Panels) -> "Figure":
    """Draws periodic attractors as thick lines, chaotic ones as thin lines."""
    figure, axes = sheet(panels, columns=4, height=2.1)
    for ax, panel in zip(axes, panels, strict=True):
        ax.plot(*panel.curves["boundary"], **OUTLINE)
        if "chaotic" in panel.curves:
            ax.plot(*panel.curves["chaotic"], color=DARK, lw=0.25)
        if "period 2" in panel.curves:
            ax.plot(*panel.curves["period 2"], color=BLACK, lw=1.6)
    return figure


def phase_space(fine: float = 1.0) -> Panels:
    """The chaotic attractor at nine contractions, three in each panel."""
    panels = []
    for lams in RANGES:
        curves, bounces = {}, scaled(200, fine, 20)
        for lam in lams:
            map = PinballMap("cuspless", lam=lam)
            curves[lam] = by_arc_length(map, settled(map, CUSPLESS_PARTICLES, bounces).orbit)
        known = facts(
            PinballMap("cuspless", lam=[float(lam) for lam in lams]),
            seed=SEED,
            particles=CUSPLESS_PARTICLES,
            bounces=bounces,
        )
        panels.append(Panel(rf"$\lambda \in [{lams[0]}, {lams[-1]}]$", "s", "sin_phi", curves, facts=known))
    return tuple(panels)


def draw_phase_space(panels: Panels) -> "Figure":
    """Draws the attractors; that of the smallest contraction is darkest and on top."""
    figure, axes = sheet(panels, columns=3, height=2.6)
    for ax, panel in zip(axes, panels, strict=True):
        for place in (-JOIN, 0.0, JOIN):
            ax.axvline(place, **FAINT)
        for (lam, curve), color in reversed(list(zip(panel.curves.items(), (BLACK, MIDDLE, LIGHT), strict=True))):
            cloud(ax, curve, color, label=rf"${lam}$")
        whole(ax)
        steepest = max(float(np.max(np.abs(curve.y))) for curve in panel.curves.values())
        ax.set_ylim(-np.ceil(4 * steepest) / 4, np.ceil(4 * steepest) / 4)
        legend(ax)
    return figure


def corner(fine: float = 1.0) -> Panels:
    """The arc length after four bounces from the upper join, against the first angle, at three contractions."""
    phi = np.linspace(-0.25, 0.25, scaled(500, fine, 20))
    curves = {}
    for lam in ("0.05", STAR, "0.09"):
        map = PinballMap("cuspless", lam=lam)
        orbit = map.orbit(np.full(phi.shape, 2 * np.pi / 3), phi, 4)
        curves[lam] = Curve(phi, arc_length(map, orbit.component, orbit.theta)[4])
    known = facts(PinballMap("cuspless", lam=[float(lam) for lam in curves]), lambda_star=STAR)
    return (Panel("from the upper join, $s_0 = -\\sqrt{3}/4$", "phi", "s_4", curves, facts=known),)


def draw_corner(panels: Panels) -> "Figure":
    """Draws the graphs for three contractions, with dotted lines at the joins and at the centre of the wall."""
    figure, (ax,) = sheet(panels, columns=1, height=3.2)
    for place in (-JOIN, 0.0, JOIN):
        ax.axhline(place, **(FAINT | {"color": "0.3"}))
    looks: tuple[dict[str, Any], ...] = (
        {"color": MIDDLE, "ls": "--"},
        {"color": BLACK, "lw": 1.5},
        {"color": DARK, "ls": (0, (5, 1, 1, 1))},
    )
    for (lam, curve), look in zip(panels[0].curves.items(), looks, strict=True):
        star = " = \\lambda^*" if lam == STAR else ""
        ax.plot(*curve, label=rf"$\lambda = {lam}{star}$", **look)
    legend(ax)
    return figure


def cuspless_exponents(fine: float = 1.0) -> Panels:
    """Both exponents against `lam`, averaged over 100 orbits; `nu_plus` also over cycles and over chaotic orbits."""
    count = min(fine, 2.0)
    stretches = ((0.005, 0.055, 10), (0.06, 0.1, 30), (0.11, 1, 30))  # ranges of lam, and values in a draft
    lams = np.concatenate([np.linspace(low, high, scaled(many, count, 3)) for low, high, many in stretches])
    return (averaged("cuspless", lams, scaled(1000, fine, 50)),)


def draw_cuspless_exponents(panels: Panels) -> "Figure":
    """Draws averages as circles, and `nu_plus` of chaotic and of periodic orbits as lines, with an inset."""
    figure, (ax,) = sheet(panels, columns=1, height=3.2)
    (panel,) = panels
    inset = ax.inset_axes((0.42, 0.08, 0.55, 0.46))
    for here in (ax, inset):
        for place in (float(STAR), LAMBDA_C):
            here.axvline(place, **FAINT)
        here.axhline(0, **FAINT)
        here.plot(*panel.curves["nu_plus_chaotic"], color=MIDDLE, lw=1.2, label=r"$\nu_+$, chaotic orbits only")
        here.plot(*panel.curves["nu_plus_periodic"], color="0.5", ls="--", label=r"$\nu_+$, periodic orbits only")
        here.plot(*panel.curves["nu_plus"], ls="", marker="o", ms=2.6, color=BLACK, label=r"$\nu_+$, all orbits")
    ax.plot(*panel.curves["nu_minus"], ls="", marker="o", ms=2.6, mfc="white", color=DARK, label=r"$\nu_-$, all orbits")
    inset.set_xlim(0.055, 0.11)
    inset.set_ylim(-0.08, 0.32)
    ax.set_xlim(0, 1.01)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2)
    return figure


def cuspless_slap(fine: float = 1.0) -> Panels:
    """The graphs of the slap map, its second and its fourth iterate."""
    return (slap_panel("cuspless cardioid", PinballMap("cuspless", lam=0), (1, 2, 4), fine),)


draw_cuspless_slap = draw_slap


def whole(ax: "Axes") -> None:
    """Sets the range of the abscissa to the whole boundary: `s` from `-C` to `C`, where `C` is half its length."""
    ax.set_xlim(-9 * JOIN, 9 * JOIN)


STARTS = 200  # random starts for the search of attractors


def found(map: PinballMap, starts: int = STARTS) -> dict[str, Attractor]:
    """The attractors by name, such as `period 3`, `period 3 (2)` or `chaotic`, the most visited first.

    >>> list(found(PinballMap("egg", lam="0.7", alpha="0.08"), 50))
    ['period 3', 'period 3 (2)']
    """
    named: dict[str, Attractor] = {}
    for attractor in find(map, starts, SEED):
        if attractor.kind in (Kind.CYCLE, Kind.CHAOTIC):
            base = f"period {attractor.period}" if attractor.kind is Kind.CYCLE else "chaotic"
            count = sum(name.startswith(base) and name[len(base) :][:1] in ("", " ") for name in named)
            named[base + (f" ({count + 1})" if count else "")] = attractor
    return named


def orbit_on(map: PinballMap, attractor: Attractor, bounces: int) -> Orbit:
    """An orbit on the attractor, for one particle; for a cycle, one period, closed."""
    first, turns = attractor.points, attractor.period or bounces
    return map.orbit(first.theta[:1], first.phi[:1], turns, first.component[:1])


def cycle_points(map: PinballMap, attractor: Attractor) -> tuple[Curve, Curve]:
    """A cycle's bounces in `(theta, sin(phi))`, and its closed polygon in the plane."""
    where, theta, phi = attractor.points
    x, y = map.states.point(where, theta)
    return Curve(elementary.arctan2(y, x), np.sin(phi)), Curve(np.append(x, x[0]), np.append(y, y[0]))


def shares(named: dict[str, Attractor]) -> dict[str, float]:
    """The fraction of the starts that each attractor attracts."""
    return {f"share of {name}": a.share.count / a.share.of for name, a in named.items() if a.share is not None}
