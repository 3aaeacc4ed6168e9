"""Bounds for the exponent of almost every orbit: maps with known exponents, and refused or incomplete data."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from symbolic import Scene
from verification.app.cli import main
from verification.arithmetic.arrays import BallArray, hull, turned
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts import standard_pairs
from verification.proofs.starts.curves import Landed, PinballCurves
from verification.proofs.starts.standard_pairs import Pairs, kept, pairs
from verification.proofs.starts.typical import SLACK, Balance, TypicalExponent
from verification.rigorous.boxes import Boxes, Chart
from verification.rigorous.graph import Cells, Grid, morse_graph, refined

TURN = 2 * np.pi


def zero(x: BallArray) -> BallArray:
    return BallArray(0 * x.m, 0 * x.m)


def landings(rows: list[tuple]) -> Landed:
    """Landings found piece by piece: source, chart and smoothness, then middles and radii of the values in turn."""
    source, charts, smooth, *halves = (np.concatenate(column) for column in zip(*rows, strict=True))
    return Landed(source, charts, smooth, *map(BallArray, halves[::2], halves[1::2]))


@dataclass(frozen=True)
class Circle:
    """`x -> B(x)` on the circle with the fibre `y -> y/4 + cos(2*pi*x)/2`; `B` is a Blaschke product or doubling.

    `B(z) = z*(z - a)/(1 - a*z)` keeps Lebesgue measure. Its exponent is `log(1 + sqrt(1 - a^2))`, by Jensen's formula.
    """

    a: float
    label = "circle"
    closed = True
    charts = (Chart("torus", (0.0, 1.0), (-1.0, 1.0), True),)

    def rate(self, x: BallArray) -> tuple[BallArray, BallArray]:
        cos, sin = turned(x * TURN)
        below = 1 + self.a**2 - 2 * self.a * cos
        return 1 + (1 - self.a**2) / below, -(2 * self.a * TURN * (1 - self.a**2)) * sin / (below * below)

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        x, y = hull(*boxes.x), hull(*boxes.y)
        at = np.exp(1j * TURN * x.m)
        image = np.mod(np.angle(at * (at - self.a) / (1 - self.a * at)) / TURN, 1.0)
        rate, more = self.rate(x)
        spread = BallArray(0 * x.m, x.r)
        theta = BallArray(image, 1e-13 + 0 * image) + rate * spread
        cos, sin = turned(x * TURN)
        k = more / rate
        slope = (slopes / 4 - TURN / 2 * sin) / rate
        bend = (-(TURN**2 / 2) * cos - slope * more) / (rate * rate)
        by_bend = 1 / (4 * rate * rate)
        values = (theta, y / 4 + cos / 2, rate, slope, k, zero(k), bend, by_bend)
        on = np.arange(boxes.chart.size)
        return Landed(on, boxes.chart, on >= 0, *values)


class Blind(Circle):
    """The circle map, whose landing is unknown on the thin line through the middle of a column."""

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        found = super().landed(boxes, slopes)
        thin = boxes.x[1] - boxes.x[0] < 1e-12
        return found._replace(theta=BallArray(found.theta.m, np.where(thin, np.nan, found.theta.r)))


class Turned(Circle):
    """A turn of the circle by a third, with the same fibre."""

    def __init__(self) -> None:
        super().__init__(0.0)

    def rate(self, x: BallArray) -> tuple[BallArray, BallArray]:
        return zero(x) + 1, zero(x)

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        found = super().landed(boxes, slopes)
        x = hull(*boxes.x)
        return found._replace(theta=BallArray(np.mod(x.m + 1 / 3, 1.0), x.r + 1e-13))


@dataclass(frozen=True)
class Tents:
    """`x -> x/c` up to `c`, then `x -> high*(1 - x)/(1 - c)`, with the fibres `y -> y/4 + 1/4` and `y -> y/4 - 1/4`.

    With `high = 1` both branches are onto, Lebesgue measure is kept, and the exponent is the entropy of `(c, 1 - c)`.
    """

    c: float
    label = "tents"
    closed = False

    @property
    def charts(self) -> tuple[Chart, ...]:
        sides = ("left", 0.0, self.c), ("right", self.c, 1.0)
        return tuple(Chart(name, (low, high), (-1.0, 1.0), kept=True) for name, low, high in sides)

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        right = boxes.chart == 1
        rate = np.where(right, -1 / (1 - self.c), 1 / self.c)
        ends = np.sort([np.where(right, (x - 1) * rate, x * rate) for x in boxes.x], axis=0)
        y = hull(*boxes.y) / 4 + np.where(right, -0.25, 0.25)
        rows = []
        for chart, (first, last) in enumerate(((0.0, self.c), (self.c, 1.0))):
            other = (ends[0] < self.c - 1e-12) & (ends[1] > self.c + 1e-12)
            on = np.flatnonzero((ends[1] > first + 1e-12) & (ends[0] < last - 1e-12))
            theta = hull(np.clip(ends[0][on], first, last), np.clip(ends[1][on], first, last))
            r = BallArray(rate[on], 1e-15 + 0 * rate[on])
            values = theta, y[on], r, slopes[on] / 4 / r, zero(r), zero(r), zero(r), 1 / (4 * r * r)
            rows.append((on, np.full(on.size, chart), ~other[on], *(half for x in values for half in (x.m, x.r))))
        return landings(rows)


class Onto:
    """`x -> 2*x` mod 1 on one chart and `3*x` mod 1 on another, both invariant, with a fibre contracted by 4."""

    label = "two attractors"
    closed = False
    charts = tuple(Chart(name, (x, x + 1.0), (-1.0, 1.0), kept=True) for name, x in (("double", 0.0), ("triple", 1.0)))

    def landed(self, boxes: Boxes, slopes: BallArray) -> Landed:
        rows = []
        for chart, branch in ((0, 0), (0, 1), (1, 0), (1, 1), (1, 2)):
            low, high = ((x - chart) * (chart + 2.0) - branch for x in boxes.x)
            on = np.flatnonzero((boxes.chart == chart) & (high > 1e-12) & (low < 1 - 1e-12))
            theta = hull(np.clip(low[on], 0, 1) + chart, np.clip(high[on], 0, 1) + chart)
            y = hull(*boxes.y)[on] / 4 + (branch - (chart + 1) / 2) / 4
            r = BallArray(np.full(on.size, chart + 2.0), np.full(on.size, 1e-15))
            values = theta, y, r, slopes[on] / 4 / r, zero(r), zero(r), zero(r), 1 / (4 * r * r)
            smooth = (low >= -1e-12) & (high <= 1 + 1e-12)
            rows.append((on, boxes.chart[on], smooth[on], *(half for x in values for half in (x.m, x.r))))
        return landings(rows)


def whole(map: Circle | Tents | Onto) -> tuple[Grid, Cells]:
    grid = Grid(map.charts, 64, 16)
    return grid, grid.whole()


@cache
def tents() -> Pairs:
    map = Tents(0.4)
    return pairs(map, *whole(map), 400, 80)


def test_the_doubling_map_with_a_fibre_has_the_exponent_log_2():
    found = TypicalExponent(Circle(0.0), *whole(Circle(0.0)), 100, 400)
    assert found.proved
    assert found.low <= np.log(2) <= found.high < found.low + 3e-6


@pytest.mark.slow
@pytest.mark.parametrize(("columns", "width"), [(50, 0.05), (100, 0.025)])
def test_a_blaschke_product_has_the_exponent_of_jensens_formula(columns, width):
    found, exact = (
        TypicalExponent(Circle(0.4), *whole(Circle(0.4)), columns, 4 * columns),
        np.log(1 + np.sqrt(1 - 0.4**2)),
    )
    assert found.proved
    assert found.low <= exact <= found.high < found.low + width


@pytest.mark.slow
def test_the_exponent_of_a_skew_tent_map_is_its_entropy():
    balance = Balance(tents(), 8)
    high, low = balance.proved(0), balance.proved(1)
    exact = -0.4 * np.log(0.4) - 0.6 * np.log(0.6)
    assert -low <= exact <= high
    assert high + low < 0.01 < np.log(0.6 / 0.4) / 10  # cycles leave a range of log(3/2)


@pytest.mark.slow
def test_bounds_hold_for_both_of_two_attractors_in_one_region():
    both = TypicalExponent(Onto(), *whole(Onto()), 60, 16, 4)
    assert both.proved
    assert both.low <= np.log(2) < np.log(3) <= both.high


@pytest.mark.parametrize("chart", [0, 1])
def test_bounds_over_one_attractor_are_those_of_its_own_exponent(chart):
    grid, cells = whole(Onto())
    alone = TypicalExponent(Onto(), grid, Cells(*(field[cells.chart == chart] for field in cells)), 400, 100)
    assert alone.low <= np.log(2 + chart) <= alone.high < alone.low + 1e-5


@pytest.mark.parametrize("map", [Tents(0.4), Circle(0.3), Onto()])
def test_labels_hold_first_segments_and_all_of_their_own_images(map):
    """Computing the images of the final labels again gives no new label, and slopes within their cones."""
    found = pairs(map, *whole(map), 24, 48)
    labels, cast, spread = found.labels, found.labels.cast(), found.spread
    for ours, again in zip(cast, found.cast, strict=True):
        if isinstance(ours, np.ndarray):
            assert np.array_equal(ours, again)
    assert np.all(np.isfinite(labels.low) & (labels.low < labels.top))
    edges = set()
    for targets in (spread.targets, found.scattered):
        entry, to = labels.named(targets)
        source = targets.source[entry]
        assert np.all(to >= 0)
        assert np.all(labels.low[to] <= cast.slopes[0][source])
        assert np.all(cast.slopes[1][source] <= labels.top[to])
        edges |= set(zip(source.tolist(), to.tolist(), strict=True))
    assert edges == set(zip(*(side.tolist() for side in found.edges), strict=True))
    assert np.all(np.diff(found.edges[0]) >= 0)
    assert np.array_equal(np.unique(spread.targets.source), np.flatnonzero(~cast.broken))
    assert set(found.scattered.source.tolist()) == set(np.flatnonzero(cast.broken).tolist())
    start = standard_pairs.first(map, *whole(map))
    told = labels.scattered(start.landed, *2 * (np.arange(start.landed.source.size),), labels.hulls())
    entry, to = labels.named(told)
    assert np.all(to >= 0)
    assert np.all(labels.low[to] <= start.landed.slope.lower()[told.source[entry]])
    assert np.all(start.landed.slope.upper()[told.source[entry]] <= labels.top[to])


def test_boxes_that_do_not_trap_are_refused():
    grid, cells = whole(Tents(0.4))
    found = TypicalExponent(Tents(0.4), grid, Cells(*(field[cells.chart == 0] for field in cells)), 400, 80)
    assert found.why == "the boxes are not proved to be a trapping region"


def proving():
    """A balance, and numbers that prove its bound."""
    balance = Balance(tents(), 8)
    y, high = balance.potential(0)
    high += 1e-4
    w, v = balance.weights(0, y, high)
    assert balance.holds(0, y, w, v, high)
    return balance, y, w, v, high


def test_numbers_whose_roundings_are_not_covered_prove_nothing():
    balance, y, w, v, high = proving()
    assert not balance.holds(0, y + 5000.0, w, v, high)  # the same inequalities, but for roundings


def test_numbers_that_leave_something_out_prove_nothing():
    balance, y, w, v, high = proving()
    assert not balance.holds(0, y, w, v, high - 0.1)
    less = balance.weights(0, y, high - 0.1)  # all hypotheses but that on the masses hold
    assert not balance.holds(0, y, *less, high - 0.1)
    assert not balance.holds(0, y, 0 * w, v, high)  # no bound for the mass next to ends
    assert not balance.holds(0, y, w, 0 * v, high)  # nor for that next to new ends
    for lower in (0, balance.count // 2):
        assert not balance.holds(0, y - 0.5 * (np.arange(y.size) == lower), w, v, high)


def test_numbers_below_0_of_ends_prove_nothing_whatever_they_satisfy():
    """A potential unbounded from below may fall for ever; here all curves shrink by more than half."""
    balance, y, _, _, high = proving()
    balance.least = np.full(balance.count, 0.4)
    w = v = np.full(balance.count, -1.0)
    least = balance.ends(balance.excess(0, y, high) + SLACK, w, v)
    assert np.all(least[0] <= w)
    assert np.all(least[1] <= v)
    assert not balance.holds(0, y, w, v, high)


@pytest.mark.parametrize(("row", "trapped"), [(0, True), (4, False), (8, False), (11, False), (15, True)])
def test_boxes_less_one_on_which_orbits_land_are_refused(row, trapped):
    """Fibres of heights up to 1 are mapped to heights up to 1/2, which is rows 4 to 11 of 16."""
    grid, cells = whole(Tents(0.4))
    left = np.flatnonzero((cells.chart != 1) | (cells.column != 20) | (cells.row != row))
    found = TypicalExponent(Tents(0.4), grid, Cells(*(field[left] for field in cells)), 100, 40)
    assert (found.why != "the boxes are not proved to be a trapping region") is trapped


def test_numbers_found_without_what_joins_cut_are_refused():
    smooth, whole = Balance(tents(), 8), Balance(tents(), 8)
    smooth.cuts = []
    y, high = smooth.potential(0)
    high += 1e-5
    w, v = smooth.weights(0, y, high)
    assert smooth.holds(0, y, w, v, high)
    assert not whole.holds(0, y, w, v, high)
    assert high < whole.potential(0)[1]


def test_ends_gather_where_curves_are_stretched_too_little():
    """Tents stretch by at least 5/3; with a rate below 1 the ends at joins are never spread out."""
    found = tents()
    for factor, proved in ((0.9, True), (0.5, False)):
        weak = found._replace(cast=found.cast._replace(least=found.cast.least * factor))
        assert (Balance(weak, 8).proved(0) is not None) is proved


def leading_back(source, to):
    """The first label's only edge leads to itself instead, so the proof would not be about the map."""
    return source, np.where(source == source[0], source[0], to)


def without_fixed_points(source, to):
    return source[source != to], to[source != to]


@pytest.mark.parametrize("changed", [leading_back, without_fixed_points])
def test_a_potential_of_a_graph_with_other_edges_is_refused(changed):
    found = tents()
    short, whole = Balance(found._replace(edges=changed(*found.edges)), 8), Balance(found, 8)
    y, high = short.potential(0)
    w, v = short.weights(0, y, high + 1e-4)
    assert short.holds(0, y, w, v, high + 1e-4)
    assert not whole.holds(0, y, w, v, min(high + 1e-4, whole.potential(0)[1] - 1e-3))


def test_fibres_that_stretch_more_than_the_base_are_refused():
    """Curves would turn vertical: factors 5/3 and 5/2 along them, and 2 across."""

    class Turned(Tents):
        def landed(self, boxes, slopes):
            found = super().landed(boxes, slopes)
            return found._replace(slope=found.slope * 8 + 1.0)

    found = TypicalExponent(Turned(0.4), *whole(Tents(0.4)), 40, 40)
    assert not found.proved
    assert found.why


@cache
def cuspless(lam: str) -> tuple[PinballCurves, Grid, Cells]:
    map = PinballImages(Scene("cuspless"), (Fraction(lam),) * 2)
    graph = morse_graph(refined(map, Grid(map.charts, 2048, 1024), 4))
    return PinballCurves(map), graph.transitions.grid, graph.transitions.chosen(graph.trapping(graph.attracting[0]))


@pytest.mark.slow
def test_sampled_curves_are_in_the_labels_found():
    """Points with slope, bend and density, followed without error bounds; those near borders of rows are left out."""
    curves, grid, cells = cuspless("0.12")
    found = pairs(curves, grid, cells, 2048, 2048)
    labels, boxes, random = found.labels, grid.boxes(cells), np.random.default_rng(1)
    at = random.integers(cells.chart.size, size=2000)
    chart, (x, y) = boxes.chart[at], (random.uniform(*side)[at] for side in (boxes.x, boxes.y))
    slope, bend, dense = np.zeros((3, at.size))
    own, edges = np.full(at.size, -1), found.edges[0] * labels.count + found.edges[1]
    for bounce in range(30):
        landed = curves.landed(Boxes(chart, (x, x), (y, y)), BallArray(slope, 0 * slope))
        kept = (np.bincount(landed.source, minlength=x.size) == 1)[landed.source]
        source, chart = landed.source[kept], landed.chart[kept]
        x, y, rate, slope, k0, k1, bent, more = (value.m[kept] for value in landed[3:])
        dense, bend, own = (dense[source] - k0 - k1 * bend[source]) / rate, bent + more * bend[source], own[source]
        if bounce < 7:
            continue
        column = ((x - labels.left[chart]) / labels.wide[chart]).astype(int)
        far = labels.middles(chart, column) - x
        row = (y + slope * far + bend * far**2 / 2 - labels.bottom[chart]) / labels.high[chart]
        cell = np.ravel_multi_index((chart, column, row.astype(int)), labels.shape)
        place = np.minimum(np.searchsorted(labels.known, cell), labels.count - 1)
        sure = np.abs(row - np.round(row)) > 0.01
        assert np.all(labels.known[place[sure]] == cell[sure])
        now = np.where(sure, labels.number[place], -1)
        on = now[sure]
        assert np.all((labels.low[on] <= slope[sure]) & (slope[sure] <= labels.top[on]))
        assert np.all(np.abs(dense[sure]) <= found.density[on])
        both = sure & (own >= 0)
        assert np.all(np.isin(own[both] * labels.count + now[both], edges))
        own = now


@pytest.mark.slow
def test_the_exponent_of_the_cuspless_table_is_bounded():
    found = TypicalExponent(*cuspless("0.12"), 8192, 8192, 16)
    assert found.proved
    assert 0.17 < found.low < 0.277 < found.high < 0.36


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lam", "columns", "why"), [("0.05", 2048, "stretched often enough"), ("0.12", 1024, "gather")]
)
def test_a_cycles_basin_and_columns_that_are_too_wide_are_refused(lam, columns, why):
    found = TypicalExponent(*cuspless(lam), columns, columns)
    assert not found.proved
    assert why in found.why
    assert (found.low, found.high) == (-np.inf, np.inf)


@pytest.mark.slow
def test_labels_of_whose_middle_no_landing_is_known_are_broken():
    found = pairs(Blind(0.0), *whole(Blind(0.0)), 100, 400)
    assert np.all(found.cast.broken)
    assert not TypicalExponent(Blind(0.0), *whole(Blind(0.0)), 100, 400).proved


def test_a_rotation_is_refused():
    found = TypicalExponent(Turned(), *whole(Turned()), 64, 64)
    assert not found.proved
    assert found.high == np.inf


@pytest.mark.slow
@pytest.mark.parametrize(
    ("columns", "said"), [("512", "nothing is proved of almost every orbit there"), ("8192", "<= nu_plus <= 0.33")]
)
def test_the_command_says_what_is_proved_of_almost_every_orbit(capsys, columns, said):
    size = "--columns", "1024", "--rows", "512"
    assert main(["morse", "cuspless", "--lam", "0.12", *size, "--almost-every", columns]) == 0
    assert said in capsys.readouterr().out


@pytest.mark.parametrize("name", Landed._fields[3:])
def test_a_map_of_which_one_value_of_one_image_is_not_known_is_refused(name):
    class Vague(Circle):
        def landed(self, boxes, slopes):
            found = super().landed(boxes, slopes)
            ball = getattr(found, name)
            radius = np.where((boxes.x[0] > 0.3) & (boxes.x[1] < 0.32) & (boxes.y[0] > 0), np.inf, ball.r)
            return found._replace(**{name: BallArray(ball.m, radius)})

    found = TypicalExponent(Vague(0.0), *whole(Circle(0.0)), 100, 40)
    assert not found.proved
    assert found.why


@pytest.mark.parametrize("factor", [-1.0, 0.0])
def test_curves_turned_over_or_not_stretched_are_refused(factor):
    class Folded(Circle):
        def landed(self, boxes, slopes):
            found = super().landed(boxes, slopes)
            return found._replace(stretch=found.stretch * np.where(boxes.x[0] > 0.4, factor, 1.0))

    found = TypicalExponent(Folded(0.0), *whole(Circle(0.0)), 96, 40)
    assert not found.proved
    assert found.why


def affine(low_rate, high_rate, low, high):
    """A step whose two ends move independently, each by an affine map."""
    return lambda some: (some[0] * low_rate + low, some[1] * high_rate + high)


@pytest.mark.parametrize(("step", "ends"), [
    (affine(0.5, 0.5, -1.0, 1.0), (-2.0, 2.0)),
    (affine(0.5, 0.0, -1.0, 0.0), (-2.0, 0.0)),  # one end goes on alone
    (affine(0.0, 0.5, 0.0, 1.0), (0.0, 2.0)),
    (affine(0.9, 0.2, 0.0, 4.0), (0.0, 5.0)),
])  # fmt: skip
def test_ranges_are_taken_into_themselves(step, ends):
    """With a step whose fixed ends are known, the invariant range is hardly wider."""
    start = np.array([-0.125, 0.0]), np.array([0.0, 0.125])
    low, high = kept(start, step)
    assert np.all((low <= start[0]) & (start[1] <= high))
    again = step((low, high))
    assert np.all((low <= again[0]) & (again[1] <= high))
    assert np.all(low >= min(ends[0], -0.125) - 0.05)
    assert np.all(high <= max(ends[1], 0.125) + 0.05)


@pytest.mark.parametrize("step", [
    affine(1.0, 1.0, -1.0, 1.0), affine(1.0, 1.0, -1.0, 0.0), affine(1.0, 1.0, 0.0, 1.0), affine(2.0, 2.0, 0.0, 0.0),
    affine(1.0, 2.0, 0.0, 1.0), affine(2.0, 1.0, -1.0, 0.0), affine(np.nan, 1.0, 0.0, 0.0),
    affine(0.0, 0.0, -np.inf, 0.0), affine(0.0, 0.0, 0.0, np.inf), affine(0.5, 0.5, -1e6, 1e6),
])  # fmt: skip
def test_ranges_that_grow_on_and_on_are_refused(step):
    with pytest.raises(ValueError, match="not proved bounded"):
        kept((np.array([-1.0, 0.0]), np.array([0.0, 1.0])), step)
