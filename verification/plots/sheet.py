"""Figures as data (panels of named curves, in the quantities of the paper's axes), and how they are drawn.

All figures have the same style, readable in black and white. Matplotlib is imported inside functions, and only when
something is drawn. There is no pyplot and no global state: the style's settings hold only while a figure is made and
saved.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from io import BytesIO
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


Array = NDArray[np.float64]
Fact = str | int | float


class Curve(NamedTuple):
    """Points of a curve in order; nan is a gap, where no line is drawn."""

    x: Array
    y: Array


class Raster(NamedTuple):
    """Labels of the cells of a grid; `names[labels[row, column]]` is a cell's name, and the first row is the lowest."""

    x: Array
    y: Array
    labels: NDArray[np.int64]
    names: tuple[str, ...]


@dataclass(frozen=True)
class Panel:
    """The data of one pair of axes: `x` and `y` are keys of `AXES`, `facts` tells how the data were computed."""

    title: str
    x: str
    y: str
    curves: Mapping[str, Curve]
    raster: Raster | None = None
    facts: Mapping[str, Fact] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """The panel as a JSON object; null stands for a gap.

        >>> gap = Curve(np.array([0.0, 1.0]), np.array([2.0, np.nan]))
        >>> Panel("a", "s", "s_1", {"T_0": gap}).document()["curves"]["T_0"]
        {'x': [0.0, 1.0], 'y': [2.0, None]}
        """
        curves = {name: {"x": _plain(curve.x), "y": _plain(curve.y)} for name, curve in self.curves.items()}
        found: dict[str, Any] = {"title": self.title, "x": self.x, "y": self.y, **self.facts, "curves": curves}
        if self.raster is not None:
            x, y, labels, names = self.raster
            found["raster"] = {"x": _plain(x), "y": _plain(y), "names": list(names), "labels": labels.tolist()}
        return found


Panels = tuple[Panel, ...]


def scaled(count: int, fine: float, least: int = 2) -> int:
    """The number of points at resolution `fine`, relative to `count` in a draft; at least `least`.

    >>> scaled(100, 8.0), scaled(100, 0.001)
    (800, 2)
    """
    return max(least, round(count * fine))


def _plain(values: Array) -> list[float | None]:
    return [None if value != value else value for value in np.asarray(values, dtype=float).tolist()]


WIDTH = 7.0  # inches, of a page
AXES = {
    "x": "$x$",
    "y": "$y$",
    "s": "$s$",
    "s_image": "$T_0^n(s)$",
    "s_4": "$s_4$",
    "sin_phi": r"$\sin\,\varphi$",
    "phi": r"$\varphi_0$",
    "theta": r"$\theta$",
    "theta_image": r"$T_0^n(\theta)$",
    "theta_3": r"$\theta_3$",
    "lam": r"$\lambda$",
    "alpha": r"$\alpha$",
    "modulus": r"$|\mu_\pm|$",
    "nu": r"$\nu$",
}
ANGLES = ("theta", "theta_image", "theta_3")
STYLE: Any = {
    "font.family": "serif",
    "font.serif": ["STIXGeneral", "DejaVu Serif"],
    "mathtext.fontset": "stix",
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.linewidth": 0.6,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "lines.linewidth": 0.9,
    "path.simplify": True,
    "savefig.dpi": 200,
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.hashsalt": "pinball",
}
BLACK, DARK, MIDDLE, LIGHT = "#000000", "#1f4e79", "#c8691c", "#9fc5e8"  # in order of lightness
INK = (0.07, 0.15, 0.33)
PALE = 0.18  # opacity of a single point of a density
PALETTE = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22", "#17becf")
FORMATS: dict[str, dict[str, Any]] = {  # file formats, with options that keep times and versions out of the files
    ".png": {"metadata": {"Software": None}},
    ".svg": {"metadata": {"Date": None}},
    ".pdf": {"metadata": {"CreationDate": None, "Producer": None}},
    ".webp": {"pil_kwargs": {"quality": 85, "method": 6}},
}
VECTORS = (".svg", ".pdf")  # these have 72 units an inch
SMALL: dict[str, Any] = {
    "pil_kwargs": {"quality": 55, "alpha_quality": 70, "method": 2}
}  # options of a small WebP for a web page
OUTLINE: dict[str, Any] = {"color": "0.35", "lw": 1.1, "solid_joinstyle": "miter"}
FAINT: dict[str, Any] = {"color": "0.6", "lw": 0.5, "ls": ":"}
CROSS: dict[str, Any] = {"ls": "", "marker": "x", "color": BLACK, "ms": 6, "mew": 1.4, "zorder": 5}


@contextmanager
def styled() -> Iterator[None]:
    """Context in which Matplotlib has the options for our figures; they are restored afterwards."""
    try:
        import matplotlib
    except ImportError:
        raise ValueError(
            "figure: Matplotlib is missing; install it with: pip install '.[plot]' in a checkout, or ask for --json"
        ) from None
    with matplotlib.rc_context(STYLE):
        yield


def figure(width: float, height: float) -> "Figure":
    """A new, empty figure with a canvas; width and height in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(made)
    return made


def figure_of(axes: "Axes") -> "Figure":
    """The figure that the axes belong to."""
    made: Figure = axes.figure  # type: ignore[assignment]  # or a part of one
    return made


def image(drawn: "Figure", ending: str) -> bytes:
    """A figure as the bytes of a file in the format of `ending`, such as `.png`; equal figures give equal bytes."""
    from matplotlib import rcParams

    return encoded(drawn, ending, dpi=max(rcParams["savefig.dpi"], drawn.dpi))


def encoded(drawn: "Figure", ending: str, dpi: float = 72.0, **form: Any) -> bytes:
    """A figure as the bytes of a file, with further options for `savefig`.

    The layout is computed here, once; `savefig` would compute it in an extra drawing that is then discarded.
    """
    from verification.plots.layout import Canvas

    Canvas(drawn)
    drawn.set_dpi(72.0 if ending in VECTORS else dpi)
    layout = drawn.get_layout_engine()
    if layout is not None:
        layout.execute(drawn)
        drawn.set_layout_engine(None)
    buffer = BytesIO()
    drawn.savefig(buffer, format=ending[1:], dpi=dpi, **{**FORMATS[ending], **form})
    return buffer.getvalue()


def ink(counts: NDArray[Any], colour: tuple[float, float, float] = INK) -> Array:
    """RGBA image of counts: opaque at the largest count, transparent at 0; the first row is the lowest.

    >>> ink(np.array([[0, 9]]))[..., 3].tolist()
    [[0.0, 1.0]]
    """
    dense = elementary.log(1 + counts) / elementary.log(1 + max(1, counts.max()))
    alpha = np.where(counts > 0, PALE + (1 - PALE) * dense, 0.0)
    return np.concatenate([np.broadcast_to(colour, (*counts.shape, 3)), alpha[..., None]], axis=-1)


def shaded(
    made: "Figure", lams: Array, shapes: Array, nu: Array, chaotic: Array, name: str, axes: "Axes | None" = None
) -> "Axes":
    """Draws the largest exponent over contractions and shapes, red if positive, and a line around chaotic cells."""
    from matplotlib.colors import TwoSlopeNorm

    axes = axes or made.add_subplot()
    most = max(1e-3, float(np.nanmax(nu)))
    shown = axes.imshow(
        nu,
        extent=(*sides(lams), *sides(shapes)),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        cmap="RdBu_r",
        norm=TwoSlopeNorm(0.0, max(-4 * most, min(-1e-3, float(np.nanmin(nu)))), most),
    )
    if min(nu.shape) > 1 and 0 < chaotic.mean() < 1:
        axes.contour(lams, shapes, chaotic, [0.5], colors="black", linewidths=0.4)
    axes.set_xlabel(AXES["lam"])
    axes.set_ylabel(AXES.get(name, name))
    made.colorbar(shown, ax=axes, label=r"largest $\nu_+$ of the orbits", pad=0.01)
    return axes


def sides(centres: Array) -> tuple[float, float]:
    """The two outer ends of a row of equal cells with these centres.

    >>> sides(np.array([0.5, 1.5]))
    (0.0, 2.0)
    """
    half = (float(centres[-1]) - float(centres[0])) / (2 * max(1, len(centres) - 1)) or 0.5
    return float(centres[0]) - half, float(centres[-1]) + half


def sheet(panels: Sequence[Panel], columns: int = 2, height: float = 2.8) -> "tuple[Figure, list[Axes]]":
    """A figure with titled and labelled axes for each panel; `height` is that of a row, in inches."""
    from matplotlib.figure import Figure

    from verification.plots.layout import GridLayout

    rows = -(-len(panels) // columns)
    width = WIDTH if columns > 1 else 4.2
    figure = Figure(figsize=(width, rows * height), layout=GridLayout())
    axes: list[Any] = []
    for i, panel in enumerate(panels):
        ax = figure.add_subplot(rows, columns, i + 1)
        letter = f"({'abcdefgh'[i]}) " if len(panels) > 1 else ""
        ax.set_title(letter + panel.title, loc="left", y=1.0)
        _prepare(ax, panel)
        axes.append(ax)
    return figure, axes


def _prepare(ax: "Axes", panel: Panel) -> None:
    """Sets the labels, limits and ticks of the axes for the panel's quantities."""
    if panel.x == "x":
        ax.set_aspect("equal")
        ax.set_axis_off()
    ax.set_xlabel(AXES[panel.x])
    ax.set_ylabel(AXES[panel.y])
    for name, axis, limits in ((panel.x, ax.xaxis, ax.set_xlim), (panel.y, ax.yaxis, ax.set_ylim)):
        if name in ANGLES:
            turns = range(-2, 3)
            axis.set_ticks([k * 1.5707963267948966 for k in turns], [_pi(k) for k in turns])
            limits(-3.141592653589793, 3.141592653589793)
        elif name == "sin_phi":
            limits(-1, 1)


def _pi(halves: int) -> str:
    """A multiple of `pi/2` in mathtext.

    >>> _pi(-1), _pi(2)
    ('$-\\\\pi/2$', '$\\\\pi$')
    """
    sign = "-" if halves < 0 else ""
    return "$0$" if halves == 0 else rf"${sign}\pi{'/2' if halves % 2 else ''}$"


def cloud(ax: "Axes", curve: Curve, color: str, size: float = 0.6, label: str | None = None) -> None:
    """Draws a curve as separate points; more than 4000 points are drawn as pixels even in a vector file."""
    ax.plot(*curve, ls="", marker="o", mew=0, ms=size, color=color, rasterized=curve.x.size > 4000, label=label)


def legend(ax: "Axes", columns: int = 3) -> None:
    """Draws a legend below the axes, with marks large enough to distinguish."""
    shown = ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=columns, handletextpad=0.4)
    handles: list[Any] = shown.legend_handles
    for handle in handles:
        handle.set_markersize(max(5.0, handle.get_markersize()))


def graphs(ax: "Axes", panel: Panel) -> None:
    """Draws the graphs of a map and its iterates, lighter for higher iterates, with the diagonal."""
    low = min(float(curve.x[0]) for curve in panel.curves.values())
    high = max(float(curve.x[-1]) for curve in panel.curves.values())
    ax.plot([low, high], [low, high], **FAINT)
    looks: tuple[dict[str, Any], ...] = (
        {"color": BLACK, "lw": 1.5},
        {"color": DARK, "lw": 0.9, "ls": (0, (5, 1.2))},
        {"color": MIDDLE, "lw": 0.9, "ls": (0, (1.2, 1))},
        {"color": "0.62", "lw": 0.7},
    )
    for order, (look, (name, curve)) in enumerate(zip(looks, panel.curves.items(), strict=False)):
        ax.plot(*curve, label=f"${name}$", zorder=4 - order, **look)
    if panel.x not in ANGLES:
        ax.set_xlim(low, high)
        ax.set_ylim(low, high)
    ax.set_box_aspect(1)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=len(panel.curves), handlelength=2.2)
