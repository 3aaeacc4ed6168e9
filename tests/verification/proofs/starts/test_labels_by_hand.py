"""Labels of pieces of curves on charts of a few columns: cells, images and crossings worked out by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats, integers

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.starts import labels as labels_of
from verification.proofs.starts.curves import Landed
from verification.proofs.starts.labels import Labels, Targets, mapped

SHORT, LONG = Chart("short", (0.0, 1.0), (-1.0, 1.0)), Chart("long", (1.0, 3.0), (-2.0, 2.0), kept=True)
FINE = 1 << 14  # rows that tell where a curve crosses


def landing(source, chart=0, smooth=True, **given) -> Landed:
    """Rows of images; what is not given is a ball about 0.25, of no width; a stretching by 2."""
    size = len(source)
    full = lambda x: np.broadcast_to(np.asarray(x, dtype=float), (size,)).copy()  # noqa: E731
    values = {"stretch": (2.0, 0.0)} | given
    balls = (BallArray(*map(full, values.get(name, (0.25, 0.0)))) for name in Landed._fields[3:])
    whole = np.broadcast_to(np.asarray(smooth), (size,)).copy()
    return Landed(integers(*source), np.broadcast_to(np.asarray(chart), (size,)).copy(), whole, *balls)


def made(rows: int = 8, cells=((0, 1, 2),), closed: bool = False, charts=(SHORT, LONG), columns: int = 8, **more):
    """Labels of the cells `(chart, column, row)`, in their order."""
    found = Labels(SimpleNamespace(charts=charts, closed=closed, **more), columns, rows)
    found.add(*np.array(cells, dtype=np.int64).T)
    return found


def test_columns_are_about_as_wide_on_all_charts_and_at_least_four():
    found = Labels(SimpleNamespace(charts=(SHORT, LONG)), 10, 4)
    assert found.columns.tolist() == [5, 10]
    assert found.wide.tolist() == [0.2, 0.2]
    assert (found.left.tolist(), found.bottom.tolist(), found.high.tolist()) == ([0, 1], [-1, -2], [0.5, 1])
    assert (found.shape, found.kept.tolist(), found.count) == ((2, 10, 4), [False, True], 0)
    assert Labels(SimpleNamespace(charts=(SHORT, LONG)), 6, 4).columns.tolist() == [4, 6]
    assert Labels(SimpleNamespace(charts=(SHORT, LONG)), 7, 4).columns.tolist() == [4, 7]
    assert Labels(SimpleNamespace(charts=(SHORT, LONG)), 9, 4).columns.tolist() == [5, 9]
    assert found.middles(integers(0, 1), integers(2, 3)) == pytest.approx([0.5, 1.7], abs=1e-15)


@pytest.mark.parametrize(("parts", "taken"), [(1, False), (2, True), (3, False), (4, True)])
def test_the_middle_of_a_column_is_a_border_of_its_parts(parts, taken):
    if taken:
        assert Labels(SimpleNamespace(charts=(SHORT,)), 8, 4, parts).parts == parts
    else:
        with pytest.raises(ValueError, match="even number"):
            Labels(SimpleNamespace(charts=(SHORT,)), 8, 4, parts)


def targets(chart, column, bottom, top) -> Targets:
    return Targets(np.arange(len(chart)), *(integers(*x) for x in (chart, column, bottom, top)))


def test_each_cell_is_one_label_and_is_found_again_by_its_number(monkeypatch):
    """Added in two goes, some twice; of a range of rows each row that is in use is named, and no other."""
    found = made(cells=((1, 3, 5), (0, 1, 2), (0, 1, 2), (1, 3, 7)))
    assert found.count == 3
    assert found.begun(targets((1, 0), (3, 1), (4, 2), (5, 2))) == 1
    assert found.begun(targets((1, 0), (3, 1), (4, 2), (5, 2))) == 0
    assert found.count == 4
    cells = list(zip(found.chart.tolist(), found.column.tolist(), found.row.tolist(), strict=True))
    assert set(cells) == {(0, 1, 2), (1, 3, 4), (1, 3, 5), (1, 3, 7)}
    assert cells[3] == (1, 3, 4)
    assert np.all(np.diff(found.known) > 0)
    assert np.all(found.low == np.inf)
    assert np.all(found.top == -np.inf)
    entry, name = found.named(targets((1, 0, 1), (3, 1, 7), (3, 1, 6), (7, 2, 7)))
    assert entry.tolist() == [0] * 5 + [1] * 2 + [2] * 2
    wanted = [(1, 3, r) for r in range(3, 8)] + [(0, 1, 1), (0, 1, 2), (1, 7, 6), (1, 7, 7)]
    assert name.tolist() == [cells.index(cell) if cell in cells else -1 for cell in wanted]
    alone = made()
    assert alone.named(targets((0, 0, 1), (1, 0, 7), (2, 0, 7), (2, 0, 7)))[1].tolist() == [0, -1, -1]
    monkeypatch.setattr(labels_of, "MOST", 6)
    assert found.begun(targets((0,), (0,), (0,), (1,))) == 2
    with pytest.raises(ValueError, match="more than 6 labels"):
        found.begun(targets((0,), (0,), (2,), (2,)))


def test_the_parts_of_a_cell_hold_all_lines_of_its_slopes_through_its_middle_and_hardly_more():
    found = made(cells=((0, 1, 2), (1, 3, 5), (1, 0, 0)))
    found.low, found.top = floats(-1.0, 0.5, -3.0), floats(2.0, 0.75, -1.0)
    boxes, label, part = found.cells()
    assert label.tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert part.tolist() == [0, 1, 2, 3] * 3
    for k in range(12):
        own = label[k]
        middle, foot = (
            found.middles(found.chart, found.column)[own],
            (-1, -2)[found.chart[own]] + found.row[own] * (0.25 if found.chart[own] == 0 else 0.5),
        )
        left, right = (middle + ((part[k] + i) / 4 - 0.5) * 0.25 for i in (0, 1))
        ends = [slope * (x - middle) for slope in (found.low[own], found.top[own]) for x in (left, right)]
        tall = 0.25 if found.chart[own] == 0 else 0.5
        wanted = left, -right, foot + min(ends), -(foot + tall + max(ends))  # all rounded outwards
        ours = boxes.x[0][k], -boxes.x[1][k], boxes.y[0][k], -boxes.y[1][k]
        for a, b in zip(ours, wanted, strict=True):
            assert b - 1e-11 < a < b
    assert boxes.chart.tolist() == found.chart[label].tolist()


def test_images_of_blocks_are_those_of_all_boxes(monkeypatch):
    """With the numbers of the boxes, whatever the size of a block; each has its own slopes."""
    found = made(cells=((0, 1, 2), (1, 3, 5)))
    found.low, found.top = floats(-1.0, 0.5), floats(2.0, 0.75)

    def landed(boxes, slopes):
        asked.append(boxes.chart.size)
        twice = np.repeat(np.arange(boxes.chart.size), 2)
        return landing(
            twice, boxes.chart[twice], twice % 2 == 0, theta=(boxes.x[0][twice], 0.5), slope=(slopes.m[twice], 0.125)
        )

    boxes, label, _ = found.cells()
    slopes, asked = hull(found.low, found.top)[label], []
    whole = mapped(SimpleNamespace(landed=landed), boxes, slopes)
    monkeypatch.setattr(labels_of, "BLOCK", 3)
    cut = mapped(SimpleNamespace(landed=landed), boxes, slopes)
    assert asked == [8, 3, 3, 2]
    assert whole.source.tolist() == cut.source.tolist() == np.repeat(np.arange(8), 2).tolist()
    assert np.array_equal(whole.chart, cut.chart)
    assert np.array_equal(whole.theta.m, cut.theta.m)
    assert np.array_equal(cut.theta.m, np.repeat(boxes.x[0], 2))
    assert np.array_equal(cut.slope.m, np.repeat(slopes.m, 2))
    assert set(cut.theta.r.tolist()) == {0.5}


CELLS = (0, 1, 2), (0, 2, 2), (1, 3, 5)  # three labels, of four parts each: the second one is tried


def cast_of(whole=(), middle=(), source=None, middles=(0, 1, 2)):
    """What is said of three labels of which parts are mapped by given rows, some of them changed."""
    source = list(range(12)) if source is None else source
    whole, middle, asked = dict(whole), dict(middle), []

    def landed(boxes, slopes):
        asked.append((boxes, slopes))
        return landing(source, **whole) if len(asked) == 1 else landing(middles, **middle)

    found = made(cells=CELLS, landed=landed)
    found.low, found.top = floats(-1.0, 0.5, 0.0), floats(2.0, 0.75, 1.0)
    return found.cast(), asked


def one(at: int, there: float, elsewhere: float, count: int = 12):
    return np.where(np.arange(count) == at, there, elsewhere)


def test_the_stretching_and_the_slopes_of_a_label_are_those_of_all_of_its_parts():
    rate = np.array([2.0, 3, 4, 2.5, -2, -3, -5, -2.5, 0.5, 0.5, 0.5, 0.5])
    slope = np.arange(12.0) - 6
    cast, ((boxes, slopes), (lines, none)) = cast_of({"stretch": (rate, 0.25), "slope": (slope, 0.5)})
    assert not np.any(cast.broken)
    assert cast.rising.tolist() == [True, False, True]
    assert cast.least == pytest.approx([1.75, 1.75, 0.25], rel=1e-13)
    assert cast.most == pytest.approx([4.25, 5.25, 0.75], rel=1e-13)
    assert np.all(cast.least < [1.75, 1.75, 0.25])
    assert np.all(cast.most > [4.25, 5.25, 0.75])
    assert cast.slopes[0] == pytest.approx([-6.5, -2.5, 1.5])
    assert cast.slopes[1] == pytest.approx([-2.5, 1.5, 5.5])
    assert (cast.label.tolist(), cast.part.tolist()) == ([0] * 4 + [1] * 4 + [2] * 4, [0, 1, 2, 3] * 3)
    for k in range(12):  # each part is asked of all slopes of its cone
        assert slopes.lower()[k] <= (-1.0, 0.5, 0.0)[k // 4]
        assert slopes.upper()[k] >= (2.0, 0.75, 1.0)[k // 4]
    assert np.all(none.m == 0)
    assert np.all(none.r == 0)
    for k, (x, foot, tall) in enumerate(((0.375, -0.5, 0.25), (0.625, -0.5, 0.25), (1.875, 0.5, 0.5))):
        assert x - 1e-14 < lines.x[0][k] < x < lines.x[1][k] < x + 1e-14
        assert foot - 1e-11 < lines.y[0][k] < foot < foot + tall < lines.y[1][k] < foot + tall + 1e-11
    assert boxes.chart.size == 12


@pytest.mark.parametrize(
    "change",
    [
        {"whole": {"smooth": one(5, False, True) > 0}},
        {"whole": {"chart": one(4, 1, 0).astype(int)}},
        {"whole": {"chart": one(7, 1, 0).astype(int)}},
        {"source": [*range(5), 5, 5, *range(6, 12)]},  # two images of a part
        {"source": [*range(5), *range(6, 12)]},  # none of it
        {"middle": {"smooth": one(1, False, True, 3) > 0}},
        {"middle": {"theta": (0.25, one(1, np.inf, 0.0, 3))}},
        {"middle": {"phi": (0.25, one(1, np.nan, 0.0, 3))}},
        {"middles": (0, 1, 1, 2)},
        {"middles": (0, 2)},
    ],
)
def test_a_label_is_broken_where_one_of_its_parts_or_its_middle_may_land_on_a_join(change):
    assert cast_of(**change)[0].broken.tolist() == [False, True, False]


@pytest.mark.parametrize("name", Landed._fields[3:])
def test_where_nothing_is_known_of_a_part_nothing_is_said(name):
    with pytest.raises(ValueError, match="not bounded away from 0"):
        cast_of({name: (2.0, one(6, np.inf, 0.0))})


@pytest.mark.parametrize(("rate", "radius"), [(0.0, 0.0), (0.5, 0.5), (-0.5, 0.5), (0.5, 0.75)])
def test_stretchings_that_may_be_0_are_refused(rate, radius):
    with pytest.raises(ValueError, match="not bounded away from 0"):
        cast_of({"stretch": (one(6, rate, 2.0), one(6, radius, 0.0))})


def test_a_label_whose_parts_are_stretched_both_ways_is_refused():
    for at in (4, 6, 7):
        with pytest.raises(ValueError, match="turn over"):
            cast_of({"stretch": (one(at, -2.0, 2.0), 0.25)})


def test_the_slopes_of_a_column_are_those_of_all_its_labels():
    found = made(cells=((0, 1, 2), (0, 1, 5), (0, 2, 1), (1, 7, 0)))
    found.low, found.top = floats(-1, -2, 3, 5), floats(1, 0.5, 4, 6)
    low, high = found.hulls()
    assert low.shape == high.shape == (2, 8)
    assert (low[0, 1], high[0, 1], low[0, 2], high[0, 2], low[1, 7], high[1, 7]) == (-2, 1, 3, 4, 5, 6)
    assert np.sum(np.isfinite(low)) == np.sum(np.isfinite(high)) == 3
    assert (low[0, 0], high[0, 0]) == (np.inf, -np.inf)


@pytest.mark.parametrize(("closed", "columns"), [
    (False, [[1], [0, 1], [1, 2], [0, 1, 2, 3], [0, 1]]), (True, [[1], [0, 1], [1, 2], [-1, 0, 1, 2, 3, 4], [-1, 0, 1]])
])  # fmt: skip
def test_columns_are_met_by_landings_with_their_borders_included(closed, columns):
    """Of four columns: within one, at its lower border, at its upper one, over both ends of the chart, over one."""
    found = made(closed=closed, columns=8)
    first, last = floats(0.3, 0.25, 0.3, -0.1, -0.125), floats(0.4, 0.3, 0.5, 1.1, 0.375)
    row, chart, column = found.across(np.zeros(5, dtype=np.int64), (first, last))
    assert [column[row == k].tolist() for k in range(5)] == columns
    assert set(chart.tolist()) == {0}
    row, chart, column = found.across(integers(1, 0), (floats(2.8, 0.1), floats(2.9, 0.1)))
    assert (row.tolist(), chart.tolist(), column.tolist()) == ([0, 1], [1, 0], [7, 0])


def ends(found: Labels, told: Targets) -> list[tuple[float, float]]:
    """Between which angles curves cross the middles of the columns that are told."""
    high, foot = found.high[told.chart], found.bottom[told.chart]
    return list(zip(foot + told.bottom * high, foot + (told.top + 1) * high, strict=True))


STEEP = ((-1.0, 0.5), (0.25, 0.75), (0.25, 0.75), (0.5, 1.0)), (-0.25, -0.125)  # cones; a way


@pytest.mark.parametrize("way", [(-0.125, 0.125), (0.0625, 0.125), (-0.25, -0.125), (0.0, 0.0)])
@pytest.mark.parametrize(("cone", "column"), [((-1, 0.5), (0.25, 0.75)), ((0.25, 0.75), (-0.5, 1.5)),
                                              ((-0.5, -0.25), (np.inf, -np.inf))])  # fmt: skip
def test_a_curve_crosses_a_middle_where_slopes_of_its_cone_or_the_columns_take_it(way, cone, column):
    """On a chart of columns of width 1/4, from angles -1/8 to 1/16: paths that go on, back and on again."""
    found = made(rows=FINE)
    hulls = np.full((2, 8), np.inf), np.full((2, 8), -np.inf)
    hulls[0][0, 1], hulls[1][0, 1] = column
    given = (floats(-0.125), floats(0.0625)), tuple(map(floats, way)), tuple(map(floats, cone))
    told = found.crossed(integers(7), integers(0), integers(5), *given, hulls)  # the sixth is the second of a turn
    assert (told.source.tolist(), told.chart.tolist(), told.column.tolist()) == ([7], [0], [1])
    low, high = min(cone[0], column[0]), max(cone[1], column[1])
    far = max(map(abs, way)) + 0.25
    wanted = [
        min((low + high) / 2 * x for x in way) - (high - low) / 2 * far - 0.125,
        max((low + high) / 2 * x for x in way) + (high - low) / 2 * far + 0.0625,
    ]
    ((foot, head),) = ends(found, told)
    assert foot <= wanted[0] < foot + 2.1 * found.high[0]
    assert head - 2.1 * found.high[0] < wanted[1] <= head


@pytest.mark.parametrize(("chart", "low", "high", "leaves"), [
    (0, -0.99, 0.99, False), (0, -1.0, 0.9, True), (0, -0.9, 1.0, True), (1, -1.99, 1.99, False), (1, 0.0, 2.0, True),
])  # fmt: skip
def test_a_curve_that_comes_to_the_border_of_its_chart_is_refused(chart, low, high, leaves):
    found, none = made(rows=64), (np.full((2, 8), np.inf), np.full((2, 8), -np.inf))
    given = (floats(low), floats(high)), (floats(0), floats(0)), (floats(0), floats(0))
    if leaves:
        with pytest.raises(ValueError, match="leave its chart"):
            found.crossed(integers(0), integers(chart), integers(0), *given, none)
    else:
        told = found.crossed(integers(0), integers(chart), integers(0), *given, none)
        assert (told.bottom.tolist(), told.top.tolist()) == ([0], [63])
    zero, one = floats(0, 0), integers(0, 0)
    with pytest.raises(ValueError, match="leave its chart"):  # where one of two does
        found.crossed(one, one, one, (floats(-0.5, -1), floats(0, 0)), (zero, zero), (zero, zero), none)


def test_rows_are_met_with_their_borders_included():
    """A curve that crosses a middle at the border of two rows is of both; of eight rows of 1/4."""
    found, none = made(rows=8), (np.full((2, 8), np.inf), np.full((2, 8), -np.inf))
    still = (floats(0, 0), floats(0, 0)), (floats(0, 0), floats(0, 0))
    phi = floats(-0.5, -0.4), floats(-0.3, -0.25)
    told = found.crossed(integers(0, 1), integers(0, 0), integers(0, 0), phi, *still, none)
    assert (told.bottom.tolist(), told.top.tolist()) == ([1, 2], [2, 3])


def test_angles_are_cut_off_at_the_border_of_charts_that_the_map_keeps():
    found = made()
    low, high = found.cut_off(integers(0, 1, 1), BallArray(np.zeros(3), floats(3, 3, 1)))
    assert (low[0], high[0]) == pytest.approx((-3, 3))
    assert (low[1], high[1]) == (-2, 2)
    assert (low[2], high[2]) == pytest.approx((-1, 1))


def test_images_of_which_only_the_landing_is_known_have_all_labels_that_they_may_have():
    """A landing over two columns; slopes of its own from -1/2 to 1/4 may take it to either middle."""
    found = made(rows=FINE)
    none = np.full((2, 8), np.inf), np.full((2, 8), -np.inf)
    where = landing((0, 1, 2), 0, theta=(0.375, 0.1875), phi=(0.25, 0.125), slope=(-0.125, 0.375))
    told = found.scattered(where, integers(1, 2), integers(40, 50), none)
    assert told.source.tolist() == [40] * 3 + [50] * 3
    assert told.column.tolist() == [0, 1, 2] * 2
    wanted = 0.125 - 0.125 / 8 - 0.375 * 0.375, 0.375 + 0.125 / 8 + 0.375 * 0.375
    for foot, head in ends(found, told):
        assert foot <= wanted[0] < foot + 2.1 * found.high[0]
        assert head - 2.1 * found.high[0] < wanted[1] <= head


def test_what_is_added_for_roundings_goes_outwards(monkeypatch):
    """With much for it, or little, a curve crosses rows from below all of those without, to above them."""
    found = made(rows=FINE)
    none = np.full((2, 8), np.inf), np.full((2, 8), -np.inf)

    def rows():
        given = (floats(-0.125), floats(0.0625)), (floats(-0.25), floats(0.5)), (floats(-0.25), floats(0.5))
        one = found.crossed(integers(0), integers(0), integers(4), *given, none)
        where = landing((0,), 0, theta=(0.375, 0.0), phi=(0.25, 0.0), slope=(0.5, 0.0))
        other = found.scattered(where, integers(0), integers(0), none)
        return one.bottom[0], -one.top[0], other.bottom[0], -other.top[-1]

    monkeypatch.setattr(labels_of, "PAD", 1e-9)
    monkeypatch.setattr(labels_of, "SLOP", 0.0)
    exact = rows()
    for name in ("SLOP", "PAD"):
        monkeypatch.setattr(labels_of, name, 2.0**-6)
        wider = [int(a - b) for a, b in zip(exact, rows(), strict=True)]
        if name == "SLOP":  # 1/64 of a unit, and of half of what cones allow
            reach = 2.0**-6 * (1 + 0.375 * 0.75)
            assert wider == pytest.approx([reach / found.high[0]] * 2 + [2.0**-6 / found.high[0]] * 2, abs=1.1)
        else:  # and of the way within a column, of slope 1/2
            assert wider[2:] == pytest.approx([2.0**-6 * 0.125 * 0.5 / found.high[0]] * 2, abs=1.1)
        monkeypatch.setattr(labels_of, name, 0.0)
