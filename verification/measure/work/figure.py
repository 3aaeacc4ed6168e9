"""The work-precision diagram of a question: error against seconds, one line for each method.

Errors run from 1 down to 1e-1000 and beyond: where they do, the upward scale is the logarithm of the number of digits,
so that float64 and a thousand digits are told apart on one page. Marks and dashes differ, not only colours.
"""

import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from verification.measure.work.row import Row, footer, front
from verification.measure.work.sought import WITHOUT
from verification.plots.sheet import BLACK, DARK, MIDDLE, WIDTH, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEIGHT = 4.3  # inches
WIDE = -40.0  # the decimal logarithm of an error from which on the scale is that of digits
LEAST = 0.5  # digits that the upper end of that scale stands for
TICKS = (1, 2, 4, 8, 16, 30, 100, 300, 1000, 3000)
MARKS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "h", "p", "*")
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.2)), (0, (1.2, 1)), (0, (5, 1.2, 1, 1.2)))
KNOWN = (
    "float64, Newton",
    "long double",
    "mpmath",
    WITHOUT,
    "arb, no proof",
    "arb, certified",
)  # alike in all diagrams


def drawn(title: str, unit: str, rows: Sequence[Row], known: dict[str, str]) -> "Figure":
    """The diagram of some rows; full marks are on the Pareto front, crossed ones break their claim.

    Where no error is below what a float holds by far, the error that an answer claims is a bar above its mark.
    """
    from matplotlib.figure import Figure

    with styled():
        figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
        axes = figure.add_subplot()
        shown = [row for row in rows if row.error]
        wide = min((row.magnitude for row in shown), default=0.0) < WIDE
        for name, look in looks(shown).items():
            _line(axes, [row for row in shown if row.method == name], front(rows), wide, look)
        _front(axes, [row for row in front(rows) if row.error], wide)
        axes.set_xscale("log")
        axes.set_xlabel("seconds of one core for one answer, median and quartiles")
        axes.set_ylabel(f"error, {unit}")
        _scale(axes, shown, wide)
        axes.set_title(title, loc="left")
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), handlelength=2.6)
        figure.supxlabel(_folded(footer(known)), fontsize=5.5, color="0.35", x=0.01, ha="left")
    return figure


def looks(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """Colour, mark and dashes of each method: the usual ways in orange, float64 in black, more digits in blue."""
    names = {row.method: row for row in rows}
    others = [name for name in names if name not in KNOWN]
    found = {}
    for name, row in names.items():
        place = KNOWN.index(name) if name in KNOWN else len(KNOWN) + others.index(name)
        color = MIDDLE if row.textbook else BLACK if row.arithmetic == "float64" else DARK
        found[name] = {"color": color, "marker": MARKS[place % len(MARKS)], "ls": DASHES[place % len(DASHES)]}
    return found


def image(figure: "Figure", ending: str = "svg") -> bytes:
    """A figure as the bytes of a file, the same for the same figure."""
    buffer = io.BytesIO()
    with styled():
        figure.savefig(buffer, format=ending, metadata={"Date": None} if ending == "svg" else None)
    return buffer.getvalue()


def height(magnitude: float, wide: bool) -> float:
    """Where an error with that decimal logarithm stands.

    >>> height(-16.0, wide=False), height(-100.0, wide=True)
    (-16.0, -2.0)
    """
    return -math.log10(max(-magnitude, LEAST)) if wide else magnitude


def _line(axes: "Axes", rows: list[Row], best: tuple[Row, ...], wide: bool, look: dict[str, Any]) -> None:
    x, y = [row.seconds for row in rows], [height(row.magnitude, wide) for row in rows]
    spread = [
        [max(row.seconds - row.quartiles[0], 0.0) for row in rows],
        [max(row.quartiles[1] - row.seconds, 0.0) for row in rows],
    ]
    own: dict[str, Any] = {"lw": 0.9, "ms": 5, "mfc": "white", "mew": 0.9}
    axes.plot(x, y, label=rows[0].method, zorder=3, **look, **own)
    axes.errorbar(x, y, xerr=spread, ls="", color=look["color"], elinewidth=0.6, zorder=2)
    on = [i for i, row in enumerate(rows) if row in best]
    axes.plot(
        [x[i] for i in on], [y[i] for i in on], ls="", marker=look["marker"], color=look["color"], ms=5.5, zorder=4
    )
    broken = [i for i, row in enumerate(rows) if row.kept is False]
    if not wide:
        _bars(axes, rows, x, y)
    axes.plot([x[i] for i in broken], [y[i] for i in broken], ls="", marker="x", color="0.15", ms=8, mew=0.8, zorder=5)


def _bars(axes: "Axes", rows: list[Row], x: list[float], y: list[float]) -> None:
    """The error that each answer claims, as a bar above its mark, and its setting beside it."""
    for row, at, here in zip(rows, x, y, strict=True):
        if row.promise:
            claim = float(row.promise.log10())
            axes.plot([at, at], [here, claim], color="0.5", lw=0.6, zorder=1)
            axes.plot([at], [claim], ls="", marker="_", color="0.35", ms=7, zorder=2)
        if row.textbook:
            continue
        axes.annotate(row.setting, (at, here), (4, -9), textcoords="offset points", fontsize=6, color="0.35")


def _front(axes: "Axes", best: list[Row], wide: bool) -> None:
    """The front as a staircase: what is reached within a time."""
    x, y = [row.seconds for row in best], [height(row.magnitude, wide) for row in best]
    axes.step(x, y, where="post", color="0.8", lw=4, zorder=1, solid_joinstyle="round", label="Pareto front")


def _scale(axes: "Axes", rows: list[Row], wide: bool) -> None:
    """Ticks of the upward axis, as powers of ten."""
    if wide:
        deepest = -min(row.magnitude for row in rows)
        kept = [n for n in TICKS if n <= 1.3 * deepest]
        axes.set_yticks([height(-n, wide) for n in kept], [f"$10^{{-{n}}}$" for n in kept])
        return
    low = math.floor(min((row.magnitude for row in rows), default=-1.0))
    high = math.ceil(max((row.magnitude for row in rows), default=0.0))
    stride = max(1, (high - low) // 6)
    marks = list(range(high, low - 1, -stride))
    axes.set_yticks(marks, [f"$10^{{{n}}}$" for n in marks])


def _folded(text: str, width: int = 150) -> str:
    """A long line in two or three."""
    from textwrap import fill

    return fill(text, width)
