"""A picture of branches: a bounce against the letter, solid where stable, events marked."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from verification.continuation.branch import Branch, What
from verification.continuation.dataset import spectrum_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARKS = {
    What.FOLD: ("s", "tab:blue"),
    What.PITCHFORK: ("D", "tab:purple"),
    What.BRANCHING: ("D", "tab:brown"),
    What.FLIP: ("o", "tab:red"),
    What.TORUS: ("*", "tab:green"),
    What.NEUTRAL: ("x", "tab:gray"),
    What.BORDER: ("v", "tab:orange"),
}


def plotted(branches: Sequence[Branch], bounces: Sequence[int] | None = None) -> "Figure":
    """The parameters of `bounces` (all when None) along each branch, in a figure of its own."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    seen: set[What] = set()
    for number, branch in enumerate(branches):
        shown = range(branch.system.recurrence.period) if bounces is None else bounces
        colour = f"C{number}" if len(branches) > 1 else "black"
        for bounce in shown:
            for values, angles, stable in runs(branch, bounce):
                axes.plot(values, angles, color=colour, lw=1.4 if stable else 0.9, ls="-" if stable else "--")
            for event in branch.events:
                marker, paint = MARKS[event.what]
                label = None if event.what in seen else event.what.value
                seen.add(event.what)
                axes.plot(
                    event.value, _wrapped(event.point.z[bounce]), marker, color=paint, ms=5, label=label, zorder=3
                )
    axes.set_xlabel(
        {"lam": r"$\lambda$", "alpha": r"$\alpha$"}.get(branches[0].system.letter, branches[0].system.letter)
    )
    axes.set_ylabel(r"$\theta$ of the bounces" if branches[0].system.letter in ("lam", "alpha", "a") else "$x$")
    axes.set_title(", ".join(dict.fromkeys(b.system.label for b in branches)) + "  (dashed: unstable)", fontsize=10)
    if seen:
        axes.legend(frameon=False, fontsize=9)
    return figure


def runs(branch: Branch, bounce: int) -> Iterator[tuple[list[float], list[float], bool]]:
    """Stretches of one stability that do not jump across the end of the circle."""
    values: list[float] = []
    angles: list[float] = []
    for a, b in pairwise(branch.points):
        stable = spectrum_of(b).stable
        ends = [(float(p.z[-1]), float(_wrapped(p.z[bounce]))) for p in (a, b)]
        if not values:
            values, angles = [ends[0][0]], [ends[0][1]]
        if abs(ends[1][1] - ends[0][1]) > np.pi:
            yield values, angles, spectrum_of(a).stable  # the end at lam = 1 is on the edge itself
            values, angles = [], []
            continue
        values.append(ends[1][0])
        angles.append(ends[1][1])
        if spectrum_of(a).stable != stable:
            yield values[:-1], angles[:-1], not stable
            values, angles = [ends[0][0], ends[1][0]], [ends[0][1], ends[1][1]]
    if values:
        yield values, angles, spectrum_of(branch.points[-1]).stable


def _wrapped(theta: float) -> float:
    return float(np.mod(theta + np.pi, 2 * np.pi) - np.pi)
