"""Laws of the layout: axes and words lie where Matplotlib's constrained layout puts them, found with less measuring."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from verification.plots.layout import Canvas, Grid, plain_minor_ticks
from verification.plots.sheet import styled

DPI = 140


def pages(layout):
    """Figures of a few kinds: grids, equal sides, a legend outside, no axes at all around a panel, large numbers."""
    for rows, columns, kind in ((1, 1, "legend"), (1, 3, "plain"), (2, 2, "boxed"), (1, 4, "bare"), (3, 1, "wide")):
        made = Figure(figsize=(7.0, 2.8 * rows), layout=layout())
        Canvas(made)
        made.set_dpi(DPI)
        for i in range(rows * columns):
            axes = made.add_subplot(rows, columns, i + 1)
            axes.plot([0, 1 + i], [0, 10 ** (i % 3)], label=r"$\mu_+$")
            axes.set_title("(a) a panel", loc="left", **({"y": 1.0} if layout is Grid else {}))
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
    for (kind, ours), (_, theirs) in zip(pages(Grid), pages(lambda: "constrained"), strict=True):
        for one, other in zip(settled(ours).axes, settled(theirs).axes, strict=True):
            pairs = [(one.bbox, other.bbox)]
            named = (lambda axes: axes.xaxis.label, lambda axes: axes.yaxis.label, lambda axes: axes._left_title)
            if kind != "bare":
                pairs += [(words(one).get_window_extent(), words(other).get_window_extent()) for words in named]
            for mine, found in pairs:
                assert np.abs(mine.extents - found.extents).max() < 1, kind


@styled()
def test_the_layout_measures_each_word_about_once(monkeypatch):
    measured, extent = [], Text.get_window_extent
    monkeypatch.setattr(Text, "get_window_extent", lambda text, *a: measured.append(text) or extent(text, *a))
    made = dict(pages(Grid))["plain"]
    made.get_layout_engine().execute(made)

    assert len(measured) <= 1.5 * len(set(map(id, measured)))


@styled()
def test_figures_of_one_process_parse_a_formula_once():
    first, second = (Canvas(Figure(dpi=DPI)).get_renderer() for _ in range(2))

    assert first is not second
    assert first.mathtext_parser is second.mathtext_parser


@styled()
@pytest.mark.parametrize("high", [1e1, 1e4])
def test_plain_minor_ticks_look_as_those_of_matplotlib(high):
    images = []
    for ours in (False, True):
        made = Figure(figsize=(3, 2), dpi=DPI)
        canvas = Canvas(made)
        axes = made.add_subplot()
        axes.set_xscale("log")
        axes.set_xlim(0.3, high)
        if ours:
            plain_minor_ticks(axes)
        canvas.draw()
        images.append(np.asarray(canvas.buffer_rgba()).copy())

    assert np.array_equal(*images)
