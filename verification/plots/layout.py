"""Where the axes of a figure lie: a grid of equal cells, with the room that words and legends need around them.

It is where Matplotlib's constrained layout puts them, but each word is measured once, and not a dozen times: the name
of an axis is put at a distance from the axes, which stays as it is when these move. Only what draws imports this
module, which needs Matplotlib.
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

PAD = 3 / 72  # inches around all that belongs to one axes
BETWEEN = 0.02  # of a figure's side: the least room between all columns or all rows together
PASSES = 2  # a legend lies at a part of the size of its axes, which depends on the room for legends
DECADE = 10.0  # an axis over no more than one has numbers at its minor ticks
_parsers: dict[str, Any] = {}


class Canvas(FigureCanvasAgg):
    """A canvas that shares the formulas it has parsed with all others of the process."""

    def get_renderer(self) -> RendererAgg:
        """Matplotlib's, with the parser of the first one; each would have its own, and parse the same numbers anew."""
        made: RendererAgg = super().get_renderer()  # type: ignore[no-untyped-call]
        made.mathtext_parser = _parsers.setdefault("agg", made.mathtext_parser)
        return made


class Grid(LayoutEngine):
    """The layout of axes that are the cells of one grid, each row and each column with the room that it needs.

    There are no colour bars; texts of the figure lie at its foot, and titles stay at the top of their axes.
    """

    _adjust_compatible = False
    _colorbar_gridspec = False

    def execute(self, fig: "Figure") -> None:
        """Moves the axes to their places."""
        canvas = fig.canvas if isinstance(fig.canvas, Canvas) else Canvas(fig)
        renderer = canvas.get_renderer()
        pairs = ((axes, axes.get_subplotspec()) for axes in fig.axes)
        cells = {Cell(axes, fig.dpi): spec for axes, spec in pairs if spec is not None}
        rows, columns = next(iter(cells.values())).get_gridspec().get_geometry()
        foot = max((text.get_window_extent(renderer).height / fig.dpi + 2 * PAD for text in fig.texts), default=0.0)
        for _ in range(PASSES):
            across, upward = np.zeros((columns, 2)), np.zeros((rows, 2))  # the room at both ends, in inches
            for cell, spec in cells.items():
                low, high = cell.beyond(renderer)
                column, row = spec.colspan.start, rows - 1 - spec.rowspan.start
                across[column] = np.maximum(across[column], (low[0], high[0]))
                upward[row] = np.maximum(upward[row], (low[1], high[1]))
            x, width = _parted(fig.get_figwidth(), across)
            y, height = _parted(fig.get_figheight(), upward, foot)
            for cell, spec in cells.items():
                cell.axes.set_position((x[spec.colspan.start], y[rows - 1 - spec.rowspan.start], width, height))
        for cell in cells:
            cell.words(renderer)


def _parted(size: float, room: "Array", foot: float = 0.0) -> "tuple[Array, float]":
    """Where the cells in a row begin and how long each of them is, as parts of the whole size.

    >>> _parted(10.0, np.array([[1.0, 0.0]]))[0].round(3).tolist()
    [0.104]
    """
    count = len(room)
    pads = np.full((count, 2), max(PAD, BETWEEN * size / (2 * count)))
    pads[0, 0] = pads[-1, 1] = PAD
    room = room + pads
    length = (size - foot - room.sum()) / count
    return (foot + np.cumsum(room)[::2] + length * np.arange(count)) / size, length / size


def _outside(box: Bbox, inner: BboxBase) -> "Array":
    """How far a box reaches beyond another: to the left and down, to the right and up."""
    (left, foot), (right, top) = box.get_points() - inner.get_points()
    return np.array([[-left, -foot], [right, top]])


@dataclass(eq=False)
class Cell:
    """Axes, and how far their numbers, names and title reach, measured anew only where there are other numbers."""

    axes: "Axes"
    dpi: float
    numbered: "list[list[float]] | None" = None
    legend: "Array | None" = None  # its corners, from the point that it hangs on
    reach: "Array" = field(default_factory=lambda: np.zeros((2, 2)))

    def beyond(self, renderer: RendererAgg) -> "Array":
        """How far all that belongs to the axes reaches beyond their cell, in inches: left, foot; right, top."""
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
        """The same for words, beyond the axes as they are drawn; the names are put where they stay."""
        self.axes.apply_aspect()
        shown = (self.axes.xaxis, self.axes.yaxis) if self.axes.axison else ()
        numbered = [list(axis.get_majorticklocs()) for axis in shown]
        if numbered != self.numbered:
            inside = self.axes.bbox
            boxes = [inside, *(box for axis in shown for box in self._named(axis, renderer))]
            for text in self.axes.get_children():
                if type(text) is Text and text.get_text():
                    title = text.get_window_extent(renderer)
                    boxes.append(Bbox([[inside.x0, title.y0], [inside.x0, title.y1]]))
            box = Bbox.union(boxes)
            self.numbered = numbered
            self.reach = _outside(box, inside) / self.dpi
        return self.reach

    def _named(self, axis: "Axis", renderer: RendererAgg) -> list[Bbox]:
        """The boxes of an axis's numbers, and of its name, which is put beside them."""
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
    """What is written at the ticks that are in view."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-10 * (high - low)
    for place, text in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False):
        if text.get_text() and low - slack <= place <= high + slack:
            yield text


def plain_minor_ticks(axes: "Axes") -> None:
    """The minor ticks of a logarithmic abscissa as two rows of marks, for its limits as they are now.

    They look as Matplotlib's do, each of which is five artists.
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
