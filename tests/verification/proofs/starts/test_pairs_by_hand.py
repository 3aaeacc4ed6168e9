"""Standard pairs step by step: where first segments go, ranges that a step keeps, and bounds that are told."""

from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats, integers

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.global_dynamics.graph import Cells, Grid
from verification.proofs.starts import typical as typical_of
from verification.proofs.starts.curves import Landed
from verification.proofs.starts.standard_pairs import TILT, First, densities, first, kept, pushed
from verification.proofs.starts.typical import typical

FREE = Chart("free", (0.0, 4.0), (0.0, 4.0))
BOXES = ((0, 0), (0, 1), (1, 2), (3, 3), (0, 2))  # columns and rows of a grid of four by four
#        box, from theta, to,   phi, to,     stretch, slope, k0, k1, bend, by bend
ROWS = ((0, 0.25, 0.75, 0.25, 1.75, 2.0, 1.0, 0.5, 0.25, 1.0, 0.5),
        (1, 1.25, 1.75, 2.25, 2.75, 4.0, -1.0, -0.5, 0.5, -2.0, 0.25),
        (2, 0.25, 0.75, 1.25, 1.75, -2.0, 3.0, 0.25, -0.25, 4.0, -0.5),
        (2, 1.25, 1.75, 2.25, 2.75, 2.0, 0.5, 0.125, 1.0, 0.5, 0.25),
        (3, 0.25, 1.75, 2.25, 2.75, 8.0, 0.25, 1.0, 2.0, -0.5, 0.125))  # fmt: skip
LEADS = {0: (0, 1), 1: (2,), 2: (1,), 3: (2,), 4: (2, 4)}  # to which boxes each row leads


class Stub:
    """A map that says of five boxes what stands in the rows, and what it was asked; some entries are changed."""

    charts = (FREE,)

    def __init__(self, change=None, chart=FREE):
        self.asked, self.change, self.charts = [], change or {}, (chart,)

    def landed(self, boxes, slopes):
        self.asked.append(slopes)
        source, a, b, c, d, *rest = map(np.array, zip(*ROWS, strict=True))
        named = dict(zip(("stretch", "slope", "k0", "k1", "bend", "by_bend"), rest, strict=True))
        values = {"theta": hull(a, b), "phi": hull(c, d)} | {name: BallArray(x, 0.0 * x) for name, x in named.items()}
        values |= {name: BallArray(values[name].m, np.where(source == 3, r, values[name].r))
                   for name, r in self.change.items()}  # fmt: skip
        return Landed(source, 0 * source, source >= 0, *(values[name] for name in Landed._fields[3:]))


def cells(boxes=BOXES) -> Cells:
    column, row = integers(*(c for c, _ in boxes)), integers(*(r for _, r in boxes))
    return Cells(0 * row, column, row, np.ones(row.size, dtype=np.int64))


def by_hand(bounces: int) -> tuple[list, list, list]:
    """Slopes of the boxes before the last bounce; bends and densities of the rows after it; all as ranges."""
    slopes, bends, dense = [(-TILT, TILT)] * 5, [(0.0, 0.0)] * 5, [(0.0, 0.0)] * 5
    for bounce in range(bounces):
        bent, denser = [], []
        for on, *_, r, _, k0, k1, bend, by in ROWS:
            ends = [(bend + by * w, (d - k0 - k1 * w) / r) for w in bends[on] for d in dense[on]]
            # the two are bounded apart from one another, but the density with all of the bends
            bent.append((min(e[0] for e in ends), max(e[0] for e in ends)))
            denser.append((min(e[1] for e in ends), max(e[1] for e in ends)))
        if bounce == bounces - 1:
            return slopes, bent, denser
        comes = [[row for row, to in LEADS.items() if box in to] for box in range(5)]
        told = [(ROWS[k][6], ROWS[k][6]) for k in range(5)]
        slopes, bends, dense = (
            [(min(x[k][0] for k in some), max(x[k][1] for k in some)) if some else (0.0, 0.0) for some in comes]
            for x in (told, bent, denser)
        )
    raise AssertionError


@pytest.mark.parametrize("bounces", [1, 2, 3, 4])
def test_first_segments_have_the_slopes_bends_and_densities_of_all_that_comes_to_their_boxes(bounces):
    """And where nothing comes, those of a segment of slope 0."""
    map = Stub()
    found = first(map, Grid((FREE,), 4, 4), cells(), bounces)
    slopes, bends, dense = by_hand(bounces)
    assert len(map.asked) == bounces
    for ball, exact in ((map.asked[-1], slopes), (found.bend, bends), (found.density, dense)):
        low, high = map_ends(exact)
        assert np.all((ball.lower() <= low) & (high <= ball.upper()))
        assert ball.lower() == pytest.approx(low, abs=1e-12)
        assert ball.upper() == pytest.approx(high, abs=1e-12)


def map_ends(ranges) -> tuple[np.ndarray, np.ndarray]:
    low, high = np.array(ranges).T
    return low, high


@pytest.mark.parametrize("name", Landed._fields[3:])
def test_where_a_segment_may_be_folded_nothing_is_said(name):
    with pytest.raises(ValueError, match="folded before they are stretched"):
        first(Stub({name: np.inf}), Grid((FREE,), 4, 4), cells(), 1)


@pytest.mark.parametrize("box", [1, 2, 4])
def test_boxes_without_one_of_those_that_images_meet_are_no_trapping_region(box):
    class Less(Stub):
        def landed(self, boxes, slopes):
            found = super().landed(boxes, slopes)
            on = found.source != box
            source = found.source[on] - (found.source[on] > box)
            return Landed(source, *(field[on] for field in found[1:]))

    with pytest.raises(ValueError, match="no trapping region"):
        first(Less(), Grid((FREE,), 4, 4), cells(BOXES[:box] + BOXES[box + 1 :]), 2)


@pytest.mark.parametrize("kept_to", [False, True])
@pytest.mark.parametrize("side", [-1, 1])
def test_what_juts_out_of_a_chart_is_refused_unless_the_map_keeps_to_it(kept_to, side):
    """One image from -1/2, or to 4.5; where all the column is in use."""
    chart = FREE._replace(kept=kept_to)

    class Tall(Stub):
        def landed(self, boxes, slopes):
            on, zero = np.arange(16), np.zeros(16)
            still = BallArray(zero, zero)
            far = np.where(on == 5, 0.5, -0.5)  # one of them
            phi = hull(zero + (2 if side > 0 else -far), zero + (4 + far if side > 0 else 2))
            values = hull(zero + 0.25, zero + 0.75), phi, still + 2.0, still, still, still, still, still
            return Landed(on, 0 * on, on >= 0, *values)

    grid = Grid((chart,), 4, 4)
    if kept_to:
        assert first(Tall(chart=chart), grid, grid.whole(), 2).landed.source.size == 16
    else:
        with pytest.raises(ValueError, match="no trapping region"):
            first(Tall(chart=chart), grid, grid.whole(), 2)


def test_what_comes_to_a_box_is_within_the_hull():
    value = BallArray(floats(1.0, -2.0, 4.0), floats(0.5, 0.25, 0.0))
    found = pushed(value, integers(0, 1, 2, 0), integers(2, 2, 0, 3), 4)
    for ball, (low, high) in zip(zip(found.lower(), found.upper(), strict=True), ((4, 4), (0, 0), (-2.25, 1.5),
                                 (0.5, 1.5)), strict=True):  # fmt: skip
        assert ball[0] <= low
        assert high <= ball[1]
        assert ball == pytest.approx((low, high), abs=1e-12)


def affine(low_rate, high_rate, low, high):
    """Ends that go each by its own way."""
    return lambda some: (some[0] * low_rate + low, some[1] * high_rate + high)


@pytest.mark.parametrize(("step", "ends"), [
    (affine(0.5, 0.5, -1.0, 1.0), (-2.0, 2.0)),
    (affine(0.5, 0.0, -1.0, 0.0), (-2.0, 0.0)),  # one end goes on alone
    (affine(0.0, 0.5, 0.0, 1.0), (0.0, 2.0)),
    (affine(0.9, 0.2, 0.0, 4.0), (0.0, 5.0)),
])  # fmt: skip
def test_ranges_are_kept_that_hold_the_start_and_are_taken_into_themselves(step, ends):
    """By a step whose fixed ends are known: hardly more is kept."""
    start = floats(-0.125, 0.0), floats(0.0, 0.125)
    low, high = kept(start, step)
    assert np.all((low <= start[0]) & (start[1] <= high))
    again = step((low, high))
    assert np.all((low <= again[0]) & (again[1] <= high))
    assert np.all(low >= min(ends[0], -0.125) - 0.05)
    assert np.all(high <= max(ends[1], 0.125) + 0.05)


def test_of_many_ranges_each_has_to_be_kept():
    rate = floats(0.0, 0.75)
    step = lambda some: (some[0] * rate - rate, some[1] * rate + rate)  # noqa: E731
    found = kept((floats(0, 0), floats(0, 0)), step)
    assert found[0] == pytest.approx([0, -3], abs=0.05)
    assert found[1] == pytest.approx([0, 3], abs=0.05)
    assert np.all(found[0] <= step(found)[0])


@pytest.mark.parametrize("step", [
    affine(1.0, 1.0, -1.0, 1.0), affine(1.0, 1.0, -1.0, 0.0), affine(1.0, 1.0, 0.0, 1.0), affine(2.0, 2.0, 0.0, 0.0),
    affine(1.0, 2.0, 0.0, 1.0), affine(2.0, 1.0, -1.0, 0.0), affine(np.nan, 1.0, 0.0, 0.0),
    affine(0.0, 0.0, -np.inf, 0.0), affine(0.0, 0.0, 0.0, np.inf), affine(0.5, 0.5, -1e6, 1e6),
])  # fmt: skip
def test_ranges_that_grow_on_and_on_are_refused(step):
    with pytest.raises(ValueError, match="grow on and on"):
        kept((floats(-1.0, 0.0), floats(0.0, 1.0)), step)


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("end", [0, 1])
def test_of_many_ranges_one_may_be_kept_late_at_one_end_alone(which, end):
    rates = np.zeros((2, 2))
    rates[end, which] = 0.75
    step = lambda some: (some[0] * rates[0] - rates[0], some[1] * rates[1] + rates[1])  # noqa: E731
    low, high = kept((floats(0, 0), floats(0, 0)), step)
    again = step((low, high))
    assert np.all((low <= again[0]) & (again[1] <= high))
    exact = np.zeros((2, 2))
    exact[end, which] = (-3.0, 3.0)[end]
    assert np.array([low, high]) == pytest.approx(exact, abs=0.05)


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize(("end", "factor"), [(0, 10.0), (1, 10.0), (0, np.nan), (1, np.nan)])
def test_ranges_are_given_up_when_one_end_of_one_of_them_is_too_large(which, end, factor):
    calls, rates = [], np.zeros((2, 2))
    rates[end, which] = factor

    def step(some):
        calls.append(0)
        return some[0] * rates[0], some[1] * rates[1]

    with pytest.raises(ValueError, match="grow on and on"):
        kept((floats(-1, -1), floats(1, 1)), step)
    assert len(calls) == (6 if factor == 10.0 else 1)  # beyond a million


@pytest.mark.parametrize("sign", [1, -1])
def test_bounds_of_bends_and_densities_are_those_of_all_walks_along_edges(sign):
    """Three labels; the first two lead to one another, the third comes from segments alone, and leads to the first."""
    values = {"k0": (0.5, -0.25, 0.5, 3.0), "k1": (0.25, -0.5, 0.25, 0.0), "bend": (1.0, -2.0, 0.5, 0.0),
              "by_bend": (0.5, -0.25, 0.5, 0.25), "stretch": (2.0, -4.0, 3.0, 2.0)}  # fmt: skip
    values |= {name: tuple(sign * x for x in values[name]) for name in ("k0", "bend")}  # and all that follows
    landed = SimpleNamespace(**{name: BallArray(floats(*x), np.zeros(4)) for name, x in values.items()})
    cast = SimpleNamespace(landed=landed, label=integers(0, 1, 0, 2))
    edges = integers(0, 1, 2), integers(1, 0, 0)
    start = First(
        None,
        BallArray(sign * floats(0.25, 5.0), floats(0.0, 1.0)),
        BallArray(sign * floats(-0.5, -9.0), floats(0.25, 1.0)),
    )
    begun = integers(0, 0, 1), integers(0, 1, 2)
    found = densities(start, begun, cast, edges, 3)
    ends = [[(0.25, 0.25), (-0.75, -0.25)], [(0.25, 0.25), (-0.75, -0.25)], [(4.0, 6.0), (-10.0, -8.0)]]
    ends = [[sorted((sign * x[0], sign * x[1])) for x in label] for label in ends]
    ends = [[(min(x[0], 0), max(x[1], 0)) for x in label] for label in ends]
    for _ in range(200):
        new = [list(map(list, label)) for label in ends]
        for k, own in enumerate((0, 1, 0, 2)):
            to = {0: 1, 1: 0, 2: 0}[own]
            for w in ends[own][0]:
                for d in ends[own][1]:
                    bent = values["bend"][k] + values["by_bend"][k] * w
                    dense = (d - values["k0"][k] - values["k1"][k] * w) / values["stretch"][k]
                    for place, x in enumerate((bent, dense)):
                        new[to][place] = [min(new[to][place][0], x), max(new[to][place][1], x)]
        ends = new
    exact = np.array([max(-label[1][0], label[1][1]) for label in ends])
    assert np.all(exact <= found)
    assert found == pytest.approx(exact, rel=0.03)


@pytest.mark.parametrize(("bounds", "said"), [
    ((0.30000001, -0.2999999), (0.299999, 0.300001)), ((None, 0.1), None), ((0.1, None), None),
    ((-0.25, 0.5), (-0.5, -0.25)),
])  # fmt: skip
def test_bounds_are_rounded_outwards_and_both_are_needed(monkeypatch, bounds, said):
    balance = SimpleNamespace(proved=lambda gain: bounds[gain], count=5)
    monkeypatch.setattr(typical_of, "pairs", lambda *given: given)
    monkeypatch.setattr(typical_of, "Balance", lambda found, window: balance)
    found = typical(None, None, None, 10, 20)
    assert found.proved is (said is not None)
    assert (found.low, found.high) == (pytest.approx(said, abs=1e-9) if said else (-np.inf, np.inf))
    assert found.labels == 5

    def refused(found, window):
        raise ValueError("no cone")

    monkeypatch.setattr(typical_of, "Balance", refused)
    found = typical(None, None, None, 10, 20)
    assert (found.low, found.high, found.labels, found.why, found.proved) == (-np.inf, np.inf, 0, "no cone", False)
