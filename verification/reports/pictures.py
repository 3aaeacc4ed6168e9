"""The pictures of a report: SVG for the page and PDF for LaTeX, transparent so that a page may be dark.

Densities are small images of one ink, whose opacity is the logarithm of a count.
"""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from numeric import PinballMap
from numeric.lowering.files import replacing
from verification.plots.results import outline
from verification.plots.sheet import AXES, FAINT, INK, OUTLINE, PALETTE, figure, ink, shaded, sides, styled
from verification.reports.asked import Arrays, Parts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
BUNDLED = 0.05  # of the picture's width, about: curves that are everywhere so near another one share its label
COLOURS = tuple(colour for colour in PALETTE if colour != "#7f7f7f")
REST = "#b0a08a"  # colour of further families
GROUND = {"chaotic": "#5a6478", "neutral": "#c3cad6", "stopped": "#e3dccb", "anything else": "#f3f3ef"}


def saved(parts: Parts, name: str, drawn: "Figure") -> None:
    """Writes a picture as PDF, then as SVG; the existence of the SVG file shows that the picture is complete."""
    with replacing(parts.folder / f"{name}.pdf") as file:
        drawn.savefig(file, format="pdf", transparent=True, metadata={"CreationDate": None})
    with replacing(parts.picture(name)) as file:
        drawn.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    parts.noted(f"{name}.pdf")
    parts.noted(f"{name}.svg")
    parts.drawn.add(name)


def table(parts: Parts, name: str, map: PinballMap, start: float) -> None:
    """Draws the boundary, and a few flights of a particle that starts at the parameter and exit angle `start`."""
    with styled():
        drawn = figure(3.6, 3.2)
        axes = drawn.add_subplot()
        axes.plot(*outline(map), **OUTLINE)
        orbit = map.orbit([start], [start], 14)
        axes.plot(orbit.x[:, 0], orbit.y[:, 0], color=INK, lw=0.6)
        axes.set_aspect("equal")
        axes.set_axis_off()
        saved(parts, name, drawn)


def portraits(parts: Parts, name: str, clouds: Sequence[tuple[str, NDArray[Any]]], half: float) -> None:
    """Draws phase portraits as densities, side by side."""
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


def diagram(
    parts: Parts,
    name: str,
    found: Arrays,
    parameter: str,
    events: Sequence[tuple[float, str, float]],
    families: Arrays | None = None,
    periods: Sequence[int] = (),
    window: tuple[float, float] | None = None,
) -> None:
    """Draws families in colour over the density of other orbits, with events, fractions of starts, and exponents.

    With a `window`, only that range of the parameter is drawn.
    """
    from matplotlib.collections import LineCollection

    values, half = found["values"], float(found["half"])
    low, high = float(values[0]), float(values[-1])
    with styled():
        drawn = figure(7.0, 6.6)
        top, middle, bottom = drawn.subplots(3, 1, sharex=True, height_ratios=(2.6, 0.9, 0.9))
        step = (high - low) / (2 * max(1, len(values) - 1))
        counts = found["counts"] if families is None else found["spread"] * _without_cycle(families, values)
        _density(top, counts, (low - step, high + step, -half, half))
        if families is not None:
            paints = _paints(families["counts"])
            at = np.stack([families["at"], families["s"]], axis=1)
            gaps = np.nonzero(np.isnan(at).any(axis=1))[0]
            pieces = zip(np.split(at, gaps), np.split(families["family"], gaps), strict=True)
            drawn_of = [(piece[~np.isnan(piece).any(axis=1)], own) for piece, own in pieces]
            kept = [(piece, paints[int(own[-1])]) for piece, own in drawn_of if len(piece) > 1]
            lines = LineCollection([piece for piece, _ in kept], colors=[paint for _, paint in kept], lw=1.0)
            lines.set_rasterized(True)
            top.add_collection(lines)
            _shares(middle, families, paints, periods)
            drawn.legend(*_alone(middle), loc="outside right upper", fontsize=6.5)
        top.set_ylabel("$s$")
        top.set_ylim(-half, half)
        middle.set_ylabel("share")
        middle.set_ylim(0, 1)
        bottom.axhline(0, **FAINT)
        bottom.plot(values, found["least"], color="0.6", lw=0.7, label="smallest")
        bottom.plot(values, found["largest"], color=INK, lw=0.8, label="largest")
        few = slice(None, None, max(1, len(values) // 60))
        bottom.errorbar(values[few], found["largest"][few], found["error"][few], color=INK, ls="", elinewidth=0.8)
        bottom.set_ylabel(r"$\nu_+$")
        bottom.set_xlabel(AXES.get(parameter, parameter))
        left, right = window or (low, high)
        within = (values >= left - step) & (values <= right + step) & np.isfinite(found["least"])
        if np.any(within):
            least, largest = float(np.min(found["least"][within])), float(np.max(found["largest"][within]))
            bottom.set_ylim(max(least, -2.0) - 0.05, largest + 0.05)
        bottom.legend(loc="lower left", bbox_to_anchor=(1.01, 0.0), fontsize=6.5)
        _events((top, middle, bottom), [event for event in events if left <= event[0] <= right], (left, right))
        top.set_xlim(left, right)
        saved(parts, name, drawn)


def _without_cycle(families: Arrays, values: Array) -> NDArray[np.bool_]:
    """True where some start at the nearest sampled value is chaotic or neutral, so that a cloud is drawn there."""
    at, kinds = families["shares_at"], families["counts"][:, -len(GROUND) :]
    nearest = np.argmin(np.abs(values[:, None] - at), axis=1)
    return np.asarray((kinds[:, 0] + kinds[:, 1] > 0)[nearest])


def _paints(counts: NDArray[Any]) -> list[str]:
    """A colour for each family; the families that most starts reach come first, and the last ones share a colour."""
    families = counts.shape[1] - len(GROUND)
    order = np.argsort(-counts[:, :families].sum(axis=0)).tolist()
    return [COLOURS[order.index(i)] if order.index(i) < len(COLOURS) else REST for i in range(families)]


def _shares(axes: "Axes", families: Arrays, paints: Sequence[str], periods: Sequence[int]) -> None:
    """Draws the fractions of starts as a stack of areas, those of the families first."""
    at, counts = families["shares_at"], families["counts"].astype(float)
    shares = counts / counts.sum(axis=1, keepdims=True)
    order = sorted(range(len(paints)), key=lambda i: (paints[i] == REST, -shares[:, i].sum()))
    labels = [f"{i}: period {periods[i]}" if paints[i] != REST else "" for i in order]
    if any(paint == REST for paint in paints):
        labels[next(k for k, i in enumerate(order) if paints[i] == REST)] = "other families"
    colours = [paints[i] for i in order] + [*GROUND.values()]
    names = labels + [name if shares[:, len(paints) + k].any() else "" for k, name in enumerate(GROUND)]
    rows = shares[:, [*order, *range(len(paints), shares.shape[1])]].T
    for band in axes.stackplot(at, rows, colors=colours, labels=names, lw=0):
        band.set_rasterized(True)  # thousands of values


def _alone(axes: "Axes") -> tuple[list[Any], list[str]]:
    """The handles and labels of a legend, without those with an empty label."""
    pairs = [(handle, label) for handle, label in zip(*axes.get_legend_handles_labels(), strict=True) if label]
    return [handle for handle, _ in pairs], [label for _, label in pairs]


def _events(axes: Sequence["Axes"], events: Sequence[tuple[float, str, float]], ends: tuple[float, float]) -> None:
    """Draws lines at the events, with texts above those that most starts reach, as far as there is room."""
    near, worded = 0.03 * (ends[1] - ends[0]), list[tuple[float, str, float]]()
    for event in sorted(events, key=lambda event: -event[2]):
        for each in axes:
            each.axvline(event[0], color="#b3261e", lw=0.4, alpha=0.4)
        if all(abs(event[0] - other[0]) >= near for other in worded):
            worded.append(event)
    for value, words, _ in worded:
        axes[0].annotate(
            words,
            (value, 1.0),
            (value, 1.03),
            xycoords=("data", "axes fraction"),
            textcoords=("data", "axes fraction"),
            rotation=60,
            fontsize=6.5,
            color="#b3261e",
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": "#b3261e", "lw": 0.3, "shrinkA": 0, "shrinkB": 0},
        )


SHORT = {"period doubling": "doubling"}
DASHES = {"fold": "-", "period doubling": (0, (5, 1.5)), "pitchfork": (0, (1.2, 1.2))}


def plane(parts: Parts, name: str, found: Arrays, letter: str, curves: Sequence[Mapping[str, Any]], own: float) -> None:
    """Draws the largest exponent over a parameter and the contraction, and the curves of events with their names."""
    with styled():
        drawn = figure(7.0, 4.6)
        lams, values, chaotic = found["lams"], found["values"], np.asarray(found["chaotic"] > 0, dtype=float)
        _curves(shaded(drawn, lams, values, found["nu"], chaotic, letter), lams, values, curves, own)
        saved(parts, name, drawn)


def regions(
    parts: Parts, name: str, found: Arrays, letter: str, curves: Sequence[Mapping[str, Any]], own: float
) -> None:
    """Draws which attractors coexist, by both parameters: a colour for each set, and the curves of events."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import Patch

    sets, label = found["sets"], found["label"]
    order = np.argsort(-np.bincount(label.ravel(), minlength=len(sets))).tolist()
    paint = np.array(
        [to_rgba(COLOURS[order.index(i)] if order.index(i) < len(COLOURS) else REST) for i in range(len(sets))]
    )
    with styled():
        drawn = figure(7.0, 4.6)
        axes = drawn.add_subplot()
        lams, values = found["at"], found["of"]
        extent = (*sides(lams), *sides(values))
        axes.imshow(paint[label], origin="lower", extent=extent, aspect="auto", interpolation="nearest", alpha=0.75)
        axes.set_xlabel(AXES["lam"])
        axes.set_ylabel(AXES.get(letter, letter))
        _curves(axes, lams, values, curves, own)
        handles = [Patch(color=paint[i], label=sets[i]) for i in order[: len(COLOURS)]]
        handles += [Patch(color=REST, label="other sets")] if len(sets) > len(COLOURS) else []
        drawn.legend(handles=handles, loc="outside right upper", fontsize=6.5)
        saved(parts, name, drawn)


def _curves(axes: "Axes", lams: Array, values: Array, curves: Sequence[Mapping[str, Any]], own: float) -> None:
    """Draws the curves of events with their names, dots where they are proved, and a line at the scene's own value."""
    size = np.array([np.ptp(lams), 0.4 * np.ptp(values)])  # words are wider than they are high
    bundles = list[tuple[Array, Array, list[int]]]()  # the points of a first curve, where words stand, and who is near
    axes.axhline(own, color="0.45", lw=0.8)
    for number, curve in enumerate(curves):
        points = np.array(curve["points"])[:, 1::-1]
        axes.plot(*points.T, color="black", lw=1.1, ls=DASHES.get(curve["kind"], "-"))
        axes.plot(*[[float(row[k]) for row in curve["proved"]] for k in (1, 0)], "o", color="black", ms=2.5)
        points = _even(points / size)
        for first, _, members in bundles:
            if np.max(np.min(np.hypot(*(points[:, None] - first).T), axis=0)) < BUNDLED:
                members.append(number)
                break
        else:
            bundles.append((points, _apart(points, [place for _, place, _ in bundles]), [number]))
    for _, place, members in bundles:
        runs = [[i for _, i in run] for _, run in groupby(enumerate(members), lambda pair: pair[1] - pair[0])]
        words = ", ".join(f"{run[0] + 1}" + f" to {run[-1] + 1}" * (len(run) > 1) for run in runs)
        if len(members) == 1:
            curve = curves[members[0]]
            words += f" {SHORT.get(curve['kind'], curve['kind'])} {curve['period']}"
        ground = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8}
        axes.annotate(words, tuple(place * size), ha="center", va="center", fontsize=6.5, bbox=ground)
    axes.set_xlim(*sides(lams))
    axes.set_ylim(*sides(values))


def _even(points: Array) -> Array:
    """Points on a curve at equal distances along it."""
    length = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    return np.stack([np.interp(np.linspace(0, length[-1], 51), length, x) for x in points.T], axis=1)


def _apart(points: Array, taken: Sequence[Array]) -> Array:
    """The point, away from the ends, farthest from the points in `taken`; the middle if `taken` is empty."""
    places = points[6:-6]
    gaps = [np.min([np.hypot(*(place - other)) for other in taken], initial=np.inf) for place in places]
    return np.asarray(places[int(np.argmax(gaps)) if taken else len(places) // 2])
