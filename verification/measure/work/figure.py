"""The work-precision diagram of a question: error against seconds, with one line for each method.

Errors can go from 1 down to 1e-1000 and below; the vertical scale is then the logarithm of the number of digits, so
that float64 and a thousand digits fit on one page. Marks and dashes differ, not only colours. Sentences from the same
rows say which method is best, what a proof costs, and how usual methods compare.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from verification.measure.work.row import MethodResult, duration, footer, front, short
from verification.plots.sheet import BLACK, DARK, MIDDLE, SMALL, WIDTH, encoded, figure_of, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


HEIGHT = 4.3  # inches
WIDE = -40.0  # decimal logarithm of an error: below this, the scale is that of digits
LEAST = 0.5  # digits at the upper end of that scale
TICKS = (1, 2, 4, 8, 16, 30, 100, 300, 1000, 3000)
MARKS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "h", "p", "*")
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.2)), (0, (1.2, 1)), (0, (5, 1.2, 1, 1.2)))
KNOWN = (
    "float64, Newton",
    "long double",
    "mpmath",
    "arb, no proof",
    "arb, certified",
)  # these look the same in all diagrams


def drawn(
    title: str, unit: str, rows: Sequence[MethodResult], known: dict[str, str], axes: "Axes | None" = None
) -> "Figure":
    """The diagram of some rows; full marks are on the Pareto front, crossed marks have a larger error than claimed.

    If the errors are within the range of floats, a bar above a mark is the error that the answer claims. On given
    `axes`, the footer with the machine is left out.
    """
    from matplotlib.figure import Figure

    from verification.plots.layout import PAD, GridLayout, plain_minor_ticks

    if axes is not None:
        _diagram(axes, title, unit, rows)
        return figure_of(axes)
    with styled():
        figure = Figure(figsize=(WIDTH, HEIGHT), layout=GridLayout())
        own = figure.add_subplot()
        _diagram(own, title, unit, rows)
        figure.text(0.01, PAD / HEIGHT, _folded(footer(known)), fontsize=5.5, color="0.35", va="bottom")
        plain_minor_ticks(own)
    return figure


def _diagram(axes: "Axes", title: str, unit: str, rows: Sequence[MethodResult]) -> None:
    """Draws the lines of methods, the Pareto front, the scales and the legend on one pair of axes."""
    shown = [row for row in rows if row.error]
    wide = min((row.magnitude for row in shown), default=0.0) < WIDE
    for name, look in looks(shown).items():
        _line(axes, [row for row in shown if row.method == name], front(rows), wide, look)
    _front(axes, [row for row in front(rows) if row.error], wide)
    axes.set_xscale("log")
    axes.set_xlabel("seconds of one core for one answer, median and quartiles")
    axes.set_ylabel(f"error, {unit}{'; the scale is that of the number of digits' if wide else ''}")
    _scale(axes, shown, wide)
    axes.set_title(title, loc="left", y=1.0)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), handlelength=2.6)


def looks(rows: Sequence[MethodResult]) -> dict[str, dict[str, Any]]:
    """Colour, mark and dashes of each method: usual methods in orange, float64 in black, more digits in blue."""
    names = {row.method: row for row in rows}
    others = [name for name in names if name not in KNOWN]
    found = {}
    for name, row in names.items():
        place = KNOWN.index(name) if name in KNOWN else len(KNOWN) + others.index(name)
        color = MIDDLE if row.textbook else BLACK if row.arithmetic == "float64" else DARK
        found[name] = {"color": color, "marker": MARKS[place % len(MARKS)], "ls": DASHES[place % len(DASHES)]}
    return found


def image(figure: "Figure", ending: str = "svg") -> bytes:
    """A figure as the bytes of an image file; equal figures give equal bytes. Pages use WebP: its files are small."""
    with styled():
        rastered: dict[str, Any] = {"webp": {"dpi": 110, **SMALL}, "png": {"dpi": 200}}
        return encoded(figure, f".{ending}", **rastered.get(ending, {}))


def height(magnitude: float, wide: bool) -> float:
    """The height in the diagram of an error with decimal logarithm `magnitude`; `wide` if errors span many decades.

    >>> height(-16.0, wide=False), height(-100.0, wide=True)
    (-16.0, -2.0)
    """
    return -math.log10(max(-magnitude, LEAST)) if wide else magnitude


def _line(
    axes: "Axes", rows: list[MethodResult], best: tuple[MethodResult, ...], wide: bool, look: dict[str, Any]
) -> None:
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


def _bars(axes: "Axes", rows: list[MethodResult], x: list[float], y: list[float]) -> None:
    """Draws the error that each answer claims as a bar above its mark, and its setting beside it."""
    for row, at, here in zip(rows, x, y, strict=True):
        if row.promise:
            claim = float(row.promise.log10())
            axes.plot([at, at], [here, claim], color="0.5", lw=0.6, zorder=1)
            axes.plot([at], [claim], ls="", marker="_", color="0.35", ms=7, zorder=2)
        if row.textbook:
            continue
        axes.annotate(row.setting, (at, here), (4, -9), textcoords="offset points", fontsize=6, color="0.35")


def _front(axes: "Axes", best: list[MethodResult], wide: bool) -> None:
    """Draws the Pareto front as a staircase: the least error reached within a time."""
    x, y = [row.seconds for row in best], [height(row.magnitude, wide) for row in best]
    axes.step(x, y, where="post", color="0.8", lw=4, zorder=1, solid_joinstyle="round", label="Pareto front")


def _scale(axes: "Axes", rows: list[MethodResult], wide: bool) -> None:
    """Sets the ticks of the vertical axis, as powers of ten."""
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
    """A long line, broken into lines of at most `width` letters."""
    from textwrap import fill

    return fill(text, width)


PLENTY = 100  # digits at which the time of a proof is compared


def paragraph(rows: Sequence[MethodResult]) -> str:
    """A list of sentences on the rows, in Markdown."""
    told = [
        quickest(rows) if not _with_bars(rows) else "",
        picked(rows),
        bars(rows),
        proofs(rows),
        *usual(rows),
    ]
    return "\n".join(f"- {sentence}" for sentence in told if sentence)


def quickest(rows: Sequence[MethodResult]) -> str:
    """A sentence on the most accurate float64 answer, and on the quickest one of nearly the same accuracy."""
    own = [row for row in rows if row.arithmetic == "float64" and row.error is not None]
    finest = min(own, key=lambda row: row.error or 0, default=None)
    if finest is None or finest.error is None:
        return ""
    quick = min((row for row in own if row.magnitude < finest.magnitude + 1), key=lambda row: row.seconds)
    said = f"The most accurate float64 method is {_named(finest)}: its error is {short(finest.error)}"
    if quick.method == finest.method:
        return f"{said}, in {duration(quick.seconds)}."
    return f"{said}. The quickest within one digit of this error is {_named(quick)}, in {duration(quick.seconds)}."


def picked(rows: Sequence[MethodResult]) -> str:
    """A sentence on the quickest method for each number of digits."""
    from verification.measure.work.choice import crossovers, entries  # which needs the map

    known = entries(rows)
    if not known or _with_bars(rows):
        return ""
    parts = [
        f"from {digits} {'digit' if digits == 1 else 'digits'} on, *{choice.method}*"
        f" (which gives {choice.digits} digits in {duration(choice.seconds)})"
        for digits, choice in crossovers(rows[0].question, measured=known)
    ]
    return "The quickest methods that keep the error they claim: " + "; ".join(parts) + "."


def bars(rows: Sequence[MethodResult]) -> str:
    """A sentence on the 95 % error bars after some numbers of bounces, and on the ratios of errors to error bars."""
    own = [row for row in _with_bars(rows) if row.promise and row.error is not None]
    parts = [f"{short(row.promise)} after {row.setting}" for row in own if row.promise]
    shares = [f"{float(row.error / row.promise):.2f}" for row in own if row.error is not None and row.promise]
    if not own:
        return ""
    return f"Half of the 95 % interval is {', '.join(parts)}. The errors are {', '.join(shares)} of this half width."


def _with_bars(rows: Sequence[MethodResult]) -> list[MethodResult]:
    return [row for row in rows if row.promise and row.setting.split()[1:] == ["bounces"]]


def proofs(rows: Sequence[MethodResult]) -> str:
    """A sentence on how long a proof takes."""
    at = {row.method: row for row in rows if row.digits == PLENTY}
    if "arb, certified" not in at:
        return ""
    proof = at["arb, certified"]
    pairs = [(name, at[name]) for name in ("arb, no proof", "mpmath") if name in at]
    compared = " and ".join(f"{times(proof.seconds / row.seconds)} times as long as *{name}*" for name, row in pairs)
    return f"{PLENTY} digits with a proof take {duration(proof.seconds)}{', ' if compared else ''}{compared}."


def usual(rows: Sequence[MethodResult]) -> list[str]:
    """A sentence for each textbook method: its error, and this package's quickest method at least as accurate."""
    names = dict.fromkeys(row.method for row in rows if row.textbook)
    own = [row for row in rows if not row.textbook]
    return [_judged(name, [row for row in rows if row.method == name], own) for name in names]


def _judged(name: str, rows: Sequence[MethodResult], own: Sequence[MethodResult]) -> str:
    found = [(row.error, row.seconds, row) for row in rows if row.error is not None]
    if not found:
        return f"*{name}* gives no answer: {rows[0].failure}."
    error, seconds, _ = min(found, key=lambda each: each[:2])
    text = f"*{name}* has the error {short(error)} in {duration(seconds)}"
    rivals = [row for row in front(own) if row.error is not None and row.error <= error]
    if rivals and rivals[0].seconds < seconds:
        text += f"; *{rivals[0].method}* is at least as accurate and {times(seconds / rivals[0].seconds)} times as fast"
    elif rivals:
        text += f", {times(rivals[0].seconds / seconds)} times as fast as *{rivals[0].method}*"
    else:
        text += ", which no method of this package beats"
    broken = [(row.error / row.promise, row) for row in rows if row.kept is False and row.error and row.promise]
    if broken:
        _, worst = max(broken, key=lambda each: each[0])
        text += f"; with {worst.setting} its error is {short(worst.error or error)}"
    lost = [row for row in rows if row.error is None]
    if lost:
        text += f"; with {lost[-1].setting} it fails: {lost[-1].failure}"
    return text + "."


def times(ratio: float) -> str:
    """A ratio as text with two digits, without a power of ten.

    >>> times(1.234), times(58.3), times(14_321.0)
    ('1.2', '58', '14,000')
    """
    return f"{ratio:.2g}" if ratio < 99.5 else f"{int(float(f'{ratio:.2g}')):,}"


def _named(row: MethodResult) -> str:
    return f"*{row.method}* ({row.setting})" if row.setting else f"*{row.method}*"
