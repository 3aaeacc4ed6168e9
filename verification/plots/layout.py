"""Layout of a figure: a grid of equal axes, with room around them for labels and legends.

Positions are those of Matplotlib's constrained layout, but each text is measured once instead of a dozen times, since
an axis label keeps its distance when the axes move. Import this module only to draw: it needs Matplotlib.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rcParams
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.layout_engine import LayoutEngine
from matplotlib.markers import TICKDOWN, TICKUP
from matplotlib.text import Text
from matplotlib.ticker import NullLocator
from matplotlib.transforms import Bbox, BboxBase, ScaledTranslation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from verification.plots.sheet import Array

PAD = 3 / 72  # inches around axes with their labels
BETWEEN = 0.02  # of a figure's side: the least room between all columns or all rows together
PASSES = 2  # a legend's place depends on the size of its axes, which depends on the room for legends
DECADE = 10.0  # an axis that spans no more than one has numbers at its minor ticks
_parsers: dict[str, Any] = {}


class Canvas(FigureCanvasAgg):
    """Canvas that shares its formula parser with all other canvases of the process."""

    def get_renderer(self) -> RendererAgg:
        """Matplotlib's renderer, with the formula parser of the first canvas, so that formulas are parsed once."""
        made: RendererAgg = super().get_renderer()  # type: ignore[no-untyped-call]
        made.mathtext_parser = _parsers.setdefault("agg", made.mathtext_parser)
        return made


class GridLayout(LayoutEngine):
    """Layout engine for equal axes in one grid; each row and column gets the room that its labels need.

    It makes no room for colour bars. Texts of the figure are at its foot, titles at the top of their axes.
    """

    _adjust_compatible = False
    _colorbar_gridspec = False

    def execute(self, fig: "Figure") -> None:
        """Moves the axes to their positions in the grid."""
        canvas = fig.canvas if isinstance(fig.canvas, Canvas) else Canvas(fig)
        renderer = canvas.get_renderer()
        pairs = ((axes, axes.get_subplotspec()) for axes in fig.axes)
        cells = {Cell(axes, fig.dpi): spec for axes, spec in pairs if spec is not None}
        rows, columns = next(iter(cells.values())).get_gridspec().get_geometry()
        foot = max((text.get_window_extent(renderer).height / fig.dpi + 2 * PAD for text in fig.texts), default=0.0)
        for _ in range(PASSES):
            across, upward = np.zeros((columns, 2)), np.zeros((rows, 2))  # inches before and after each column and row
            for cell, spec in cells.items():
                low, high = cell.beyond(renderer)
                column, row = spec.colspan.start, rows - 1 - spec.rowspan.start
                across[column] = np.maximum(across[column], (low[0], high[0]))
                upward[row] = np.maximum(upward[row], (low[1], high[1]))
            x, width = _cell_starts(fig.get_figwidth(), across)
            y, height = _cell_starts(fig.get_figheight(), upward, foot)
            for cell, spec in cells.items():
                cell.axes.set_position((x[spec.colspan.start], y[rows - 1 - spec.rowspan.start], width, height))
        for cell in cells:
            cell.words(renderer)


def _cell_starts(size: float, room: "Array", foot: float = 0.0) -> "tuple[Array, float]":
    """The starts of the cells along a side, and their length, as fractions of `size`; `room` is in inches.

    >>> _cell_starts(10.0, np.array([[1.0, 0.0]]))[0].round(3).tolist()
    [0.104]
    """
    count = len(room)
    pads = np.full((count, 2), max(PAD, BETWEEN * size / (2 * count)))
    pads[0, 0] = pads[-1, 1] = PAD
    room = room + pads
    length = (size - foot - room.sum()) / count
    return (foot + np.cumsum(room)[::2] + length * np.arange(count)) / size, length / size


def _outside(box: Bbox, inner: BboxBase) -> "Array":
    """Lengths by which `box` reaches beyond `inner`: `[[left, below], [right, above]]`."""
    (left, foot), (right, top) = box.get_points() - inner.get_points()
    return np.array([[-left, -foot], [right, top]])


@dataclass(eq=False)
class Cell:
    """One pair of axes, and the room that its labels and title need, which is cached until the ticks change."""

    axes: "Axes"
    dpi: float
    numbered: "list[list[float]] | None" = None
    legend: "Array | None" = None  # its corners, relative to its anchor
    reach: "Array" = field(default_factory=lambda: np.zeros((2, 2)))

    def beyond(self, renderer: RendererAgg) -> "Array":
        """How far labels and legend extend beyond the cell, in inches: `[[left, below], [right, above]]`."""
        words = self.words(renderer)
        box = Bbox(self.axes.bbox.get_points() + self.dpi * words * [[-1], [1]])
        legend = self.axes.get_legend()
        if legend is not None and legend.get_bbox_to_anchor() is not self.axes.bbox:  # else it lies within
            anchor = legend.get_bbox_to_anchor().min
            if self.legend is None:
                self.legend = legend.get_window_extent(renderer).get_points() - anchor
            box = Bbox.union([box, Bbox(anchor + self.legend)])
        cell = self.axes.get_position(original=True).transformed(self.axes.figure.transFigure)
        return _outside(box, cell) / self.dpi

    def words(self, renderer: RendererAgg) -> "Array":
        """Places the axis labels; returns how far they, tick labels and title reach beyond the axes, as in `beyond`."""
        self.axes.apply_aspect()
        shown = (self.axes.xaxis, self.axes.yaxis) if self.axes.axison else ()
        numbered = [list(axis.get_majorticklocs()) for axis in shown]
        if numbered != self.numbered:
            inside = self.axes.bbox
            boxes = [inside, *(box for axis in shown for box in self._label_boxes(axis, renderer))]
            for text in self.axes.get_children():
                if type(text) is Text and text.get_text():
                    title = text.get_window_extent(renderer)
                    boxes.append(Bbox([[inside.x0, title.y0], [inside.x0, title.y1]]))
            box = Bbox.union(boxes)
            self.numbered = numbered
            self.reach = _outside(box, inside) / self.dpi
        return self.reach

    def _label_boxes(self, axis: "Axis", renderer: RendererAgg) -> list[Bbox]:
        """Boxes of the tick labels of an axis and of its axis label, which is placed beside them."""
        inside, across = self.axes.bbox, axis is self.axes.xaxis
        numbers = [text.get_window_extent(renderer) for text in _numbers(axis)]
        away = _outside(Bbox.union([inside, *numbers]), inside)[0, int(across)] / self.dpi + axis.labelpad / 72
        x, y = (0.0, -away) if across else (-away, 0.0)
        shift = ScaledTranslation(x, y, self.axes.figure.dpi_scale_trans)
        x, y = (0.5, 0.0) if across else (0.0, 0.5)
        axis.set_label_coords(x, y, transform=self.axes.transAxes + shift)
        if not axis.label.get_text():
            return numbers
        name = axis.label.get_window_extent(renderer)
        ends = ((inside.x0, name.y0), (inside.x0, name.y1)) if across else ((name.x0, inside.y0), (name.x1, inside.y0))
        return [*numbers, Bbox(ends)]


def _numbers(axis: "Axis") -> "Iterable[Text]":
    """The tick labels that are in view."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-10 * (high - low)
    for place, text in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False):
        if text.get_text() and low - slack <= place <= high + slack:
            yield text


def plain_minor_ticks(axes: "Axes") -> None:
    """Draws the minor ticks of a logarithmic x-axis as two rows of markers, for its present limits.

    They look like Matplotlib's own minor ticks, each of which takes five artists.
    """
    low, high = axes.get_xlim()
    if not high > DECADE * low:
        return
    places = [place for place in axes.xaxis.get_minorticklocs() if low <= place <= high]
    axes.xaxis.set_minor_locator(NullLocator())
    look: dict[str, Any] = {"color": rcParams["xtick.color"], "ls": "", "clip_on": False, "zorder": 1.5}
    look |= {"ms": rcParams["xtick.minor.size"], "mew": rcParams["xtick.minor.width"]}
    look |= {"transform": axes.get_xaxis_transform(), "scalex": False, "scaley": False}
    for end, marker in enumerate((TICKUP, TICKDOWN)):
        axes.plot(places, [end] * len(places), marker=marker, **look)
