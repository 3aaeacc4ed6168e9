"""The pictures of a report: SVG for the page and PDF for LaTeX, on no ground so that a page may be dark.

Densities are small images of one ink, whose opacity is the logarithm of a count.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from verification.plots.results import outline
from verification.plots.sheet import AXES, FAINT, INK, OUTLINE, PALETTE, figure, ink, shaded, sides, styled
from verification.reports.asked import Arrays, Parts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
LABELS = 14  # events with words on a diagram; further ones are lines only


def saved(parts: Parts, name: str, drawn: "Figure") -> None:
    """Writes both forms of a picture; the second one whole before the first appears."""
    drawn.savefig(parts.folder / f"{name}.pdf", transparent=True, metadata={"CreationDate": None})
    temporary = parts.folder / f".{name}.svg"
    drawn.savefig(temporary, transparent=True, metadata={"Date": None})
    temporary.replace(parts.picture(name))


def table(parts: Parts, name: str, map: PinballMap, start: float) -> None:
    """The boundary, with a few flights of one particle that starts at this parameter and exit angle."""
    with styled():
        drawn = figure(3.6, 3.2)
        axes = drawn.add_subplot()
        axes.plot(*outline(map), **OUTLINE)
        orbit = map.orbit([start], [start], 14)
        axes.plot(orbit.x[:, 0], orbit.y[:, 0], color=INK, lw=0.6)
        axes.set_aspect("equal")
        axes.set_axis_off()
        saved(parts, name, drawn)


def slap(parts: Parts, name: str, s: Array, image: Array, slope: Array, half: float) -> None:
    """The slap map and its derivative over arc length."""
    with styled():
        drawn = figure(7.0, 2.9)
        left, right = drawn.subplots(1, 2)
        left.plot([-half, half], [-half, half], **FAINT)
        left.plot(s, _broken(image, half), color=INK)
        left.set_ylabel("$T_0(s)$")
        left.set_ylim(-half, half)
        right.axhspan(-1, 1, color="0.85", lw=0)
        right.plot(s, slope, color=INK)
        right.set_ylabel("$T_0'(s)$")
        bound = float(np.nanquantile(np.abs(slope), 0.98)) * 1.3
        right.set_ylim(-max(bound, 1.5), max(bound, 1.5))
        for axes in (left, right):
            axes.set_xlabel("$s$")
            axes.set_xlim(-half, half)
        saved(parts, name, drawn)


def _broken(values: Array, half: float) -> Array:
    """A graph with a gap where it jumps over the end of the circle."""
    jumps = np.abs(np.diff(values, append=values[-1:])) > half
    return np.where(jumps, np.nan, values)


def portraits(parts: Parts, name: str, clouds: Sequence[tuple[str, NDArray[Any]]], half: float) -> None:
    """Phase portraits as densities, one beside the other."""
    with styled():
        drawn = figure(7.0, 2.5 if len(clouds) > 1 else 3.4)
        for axes, (lam, counts) in zip(np.atleast_1d(drawn.subplots(1, len(clouds), sharey=True)), clouds, strict=True):
            _density(axes, counts, (-half, half, -1, 1))
            axes.set_title(rf"$\lambda = {lam}$", loc="left")
            axes.set_xlabel("$s$")
        drawn.axes[0].set_ylabel(AXES["sin_phi"])
        saved(parts, name, drawn)


def _density(axes: "Axes", counts: NDArray[Any], extent: tuple[float, float, float, float]) -> None:
    axes.imshow(ink(counts), origin="lower", extent=extent, aspect="auto", interpolation="nearest")


def diagram(parts: Parts, name: str, found: Arrays, parameter: str, events: Iterable[tuple[float, str]]) -> None:
    """The attractors against the parameter as a density, events as lines, and the largest exponent with error bars."""
    values, half = found["values"], float(found["half"])
    low, high = float(values[0]), float(values[-1])
    with styled():
        drawn = figure(7.0, 5.2)
        top, bottom = drawn.subplots(2, 1, sharex=True, height_ratios=(2.6, 1))
        step = (high - low) / (2 * max(1, len(values) - 1))
        _density(top, found["counts"], (low - step, high + step, -half, half))
        top.set_ylabel("$s$")
        bottom.axhline(0, **FAINT)
        bottom.plot(values, found["least"], color="0.6", lw=0.7, label="smallest of the orbits")
        bottom.plot(values, found["largest"], color=INK, lw=0.8, label="largest of the orbits")
        few = slice(None, None, max(1, len(values) // 60))
        bottom.errorbar(values[few], found["largest"][few], found["error"][few], color=INK, ls="", elinewidth=0.8)
        bottom.set_ylabel(r"$\nu_+$")
        bottom.set_xlabel(AXES.get(parameter, parameter))
        bottom.set_ylim(max(float(np.nanmin(found["least"])), -2.0) - 0.05, None)
        drawn.legend(loc="outside lower center", ncols=2)
        _events(top, bottom, sorted(events), (low, high))
        top.set_xlim(low, high)
        saved(parts, name, drawn)


def _events(top: "Axes", bottom: "Axes", events: Sequence[tuple[float, str]], ends: tuple[float, float]) -> None:
    """Lines at the events, and their words above them, moved apart where they would lie on each other."""
    near, at = 0.022 * (ends[1] - ends[0]), -np.inf
    for number, (value, words) in enumerate(events):
        for axes in (top, bottom):
            axes.axvline(value, color="#b3261e", lw=0.5, alpha=0.7)
        if number < LABELS:
            at = max(value, at + near)
            top.annotate(
                words,
                (value, 1.0),
                (at, 1.02),
                xycoords=("data", "axes fraction"),
                textcoords=("data", "axes fraction"),
                rotation=60,
                fontsize=6.5,
                color="#b3261e",
                annotation_clip=False,
            )


SHORT = {"period doubling": "doubling"}
DASHES = {"fold": "-", "period doubling": (0, (5, 1.5)), "pitchfork": (0, (1.2, 1.2))}


def plane(parts: Parts, name: str, found: Arrays, letter: str, curves: Sequence[Mapping[str, Any]], own: float) -> None:
    """The largest exponent over a parameter and the contraction, and the curves of events with their words."""
    lams, values = found["lams"], found["values"]
    taken, size = list[Array](), np.array([np.ptp(lams), 0.4 * np.ptp(values)])  # words are wider than they are high
    with styled():
        drawn = figure(7.0, 4.6)
        axes = shaded(drawn, lams, values, found["nu"], np.asarray(found["chaotic"] > 0, dtype=float), letter)
        axes.axhline(own, color="0.45", lw=0.8)
        for number, curve in enumerate(curves):
            points = np.array(curve["points"])[:, 1::-1]
            axes.plot(*points.T, color="black", lw=1.1, ls=DASHES.get(curve["kind"], "-"))
            words = f"{number + 1} {SHORT.get(curve['kind'], curve['kind'])} {curve['period']}"
            ground = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8}
            if number < LABELS:
                taken.append(_apart(points / size, taken))
                axes.annotate(words, tuple(taken[-1] * size), ha="center", va="center", fontsize=6.5, bbox=ground)
        axes.set_xlim(*sides(lams))
        axes.set_ylim(*sides(values))
        saved(parts, name, drawn)


def _apart(points: Array, taken: Sequence[Array]) -> Array:
    """The place on a curve, away from its ends, that is farthest from those that have words; its middle at first."""
    length = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    places = np.stack([np.interp(np.linspace(0.12, 0.88, 39) * length[-1], length, x) for x in points.T], axis=1)
    if not taken:
        return np.asarray(places[19])
    gaps = np.min([np.hypot(*(places - other).T) for other in taken], axis=0)
    return np.asarray(places[int(np.argmax(gaps))])


def basins(parts: Parts, name: str, label: NDArray[Any], colours: Sequence[int], half: float, title: str) -> None:
    """Which attractor each start reaches: a colour for each; empty where none of those found."""
    from matplotlib.colors import to_rgba

    paint = np.array([to_rgba(PALETTE[i % len(PALETTE)]) for i in colours] + [(0.0, 0.0, 0.0, 0.0)])
    with styled():
        drawn = figure(7.0, 2.6)
        axes = drawn.add_subplot()
        axes.imshow(paint[label], origin="lower", extent=(-half, half, -1, 1), aspect="auto", interpolation="nearest")
        axes.set_title(title, loc="left")
        axes.set_xlabel("$s$")
        axes.set_ylabel(AXES["sin_phi"])
        saved(parts, name, drawn)
