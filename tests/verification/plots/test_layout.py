"""Axes, labels and titles lie where Matplotlib's constrained layout puts them."""

import numpy as np
from matplotlib.figure import Figure

from verification.plots.layout import Canvas, GridLayout
from verification.plots.sheet import styled

DPI = 140


def pages(layout):
    """Figures of several kinds: grids, equal sides, a legend outside, panels without axes, large numbers."""
    for rows, columns, kind in ((1, 1, "legend"), (1, 3, "plain"), (2, 2, "boxed"), (1, 4, "bare"), (3, 1, "wide")):
        made = Figure(figsize=(7.0, 2.8 * rows), layout=layout())
        Canvas(made)
        made.set_dpi(DPI)
        for i in range(rows * columns):
            axes = made.add_subplot(rows, columns, i + 1)
            axes.plot([0, 1 + i], [0, 10 ** (i % 3)], label=r"$\mu_+$")
            axes.set_title("(a) a panel", loc="left", **({"y": 1.0} if layout is GridLayout else {}))
            axes.set_xlabel(r"$\lambda$")
            axes.set_ylabel(r"$\varphi_0$")
            if kind == "boxed":
                axes.set_box_aspect(1)
            if kind == "bare":
                axes.set_aspect("equal")
                axes.set_axis_off()
            if kind in ("legend", "boxed"):
                axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17))
        yield kind, made


def settled(made):
    made.get_layout_engine().execute(made)
    made.set_layout_engine(None)
    made.draw_without_rendering()
    return made


@styled()
def test_axes_their_names_and_titles_lie_within_a_pixel_of_where_constrained_layout_puts_them():
    for (kind, ours), (_, theirs) in zip(pages(GridLayout), pages(lambda: "constrained"), strict=True):
        for one, other in zip(settled(ours).axes, settled(theirs).axes, strict=True):
            pairs = [(one.bbox, other.bbox)]
            named = (lambda axes: axes.xaxis.label, lambda axes: axes.yaxis.label, lambda axes: axes._left_title)
            if kind != "bare":
                pairs += [(words(one).get_window_extent(), words(other).get_window_extent()) for words in named]
            for mine, found in pairs:
                assert np.abs(mine.extents - found.extents).max() < 1, kind
