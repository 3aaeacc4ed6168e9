"""Images of parallelograms from flights that are given: midpoints, sides and rests, and arcs beyond a join, by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from by_hand import floats, integers

from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.flights import Piece
from verification.proofs.starts import parallelograms
from verification.proofs.starts.chords import DOUBLINGS, REACH, Chords
from verification.proofs.starts.parallelograms import Parallelograms, carried


def points(theta, phi, rest=0.0) -> Parallelograms:
    middle = np.stack([floats(*theta), floats(*phi)])
    return Parallelograms(np.zeros(len(theta), dtype=np.int64), middle, np.zeros((2, *middle.shape)), 0 * middle + rest)


SETS = Parallelograms(
    integers(0, 0), np.array([[1.0, 2.0], [3.0, 4.0]]),
    np.array([[[0.5, 0.25], [-0.125, 0.0]], [[0.0, 1.0], [0.25, -0.5]]]), np.array([[0.0625, 0.0], [0.0, 0.125]]),
)  # fmt: skip
MATRIX = np.array([[[2.0, 1.0], [-1.0, 0.5]], [[0.5, 4.0], [3.0, -2.0]]])  # of both sets: row, column, set


def flights(radius=0.0, arc=8.0, low=-9.0, high=9.0, known=True, landing=(0.0, 0.0), off=(0.0, 0.0)) -> SimpleNamespace:
    """What is known of flights of both sets; the rectangles' midpoints lie beside those of the sets by `off`."""
    pair = lambda x: np.full(2, float(x))  # noqa: E731
    entries = [[BallArray(x, pair(radius)) for x in row] for row in MATRIX]
    return SimpleNamespace(
        theta=BallArray(SETS.middle[0] + off[0]), phi=BallArray(SETS.middle[1] + off[1]),
        exits=lambda on, chart, arc: (np.full(2, known), pair(low), pair(high)),
        slopes=lambda on, chart, arc: SimpleNamespace(bend_there="bend", entries=entries),
        midpoints=lambda on, chart, arc, bend: (
            BallArray(floats(10.0, 20.0), pair(landing[0])), BallArray(floats(0.25, 0.5), pair(landing[1]))
        ),
    )  # fmt: skip


def image(monkeypatch, smooth=True, width=8.0, **given):
    monkeypatch.setattr(parallelograms, "matrix", lambda slopes: slopes.entries)
    arc = hull(floats(10.0, 20.0) - width, floats(10.0, 20.0) + width)
    return parallelograms._image(flights(**given), SETS, np.arange(2), integers(1, 1), arc, smooth)


@pytest.mark.parametrize(("given", "more"), [
    ({}, ([0, 0], [0, 0])),
    ({"landing": (0.5, 0.25)}, ([0.5, 0.5], [0.25, 0.25])),
    ({"radius": 0.125}, ([0.125 * 0.9375, 0.125 * 1.875], [0.125 * 0.9375, 0.125 * 1.875])),
    ({"off": (0.25, 0.0)}, ([0.5, 0.25], [0.125, 1.0])),
    ({"off": (0.0, -0.5)}, ([0.5, 0.25], [1.5, 1.0])),
])  # fmt: skip
def test_an_image_has_a_midpoint_that_lands_sides_that_turn_and_a_rest_of_what_is_not_known(monkeypatch, given, more):
    """Rests go by the moduli of the derivative; what a rectangle's midpoint is beside that of the set is a rest too."""
    found, met = image(monkeypatch, **given)
    assert met.tolist() == [True, True]
    assert found.chart.tolist() == [1, 1]
    assert found.middle.tolist() == [[10, 20], [0.25, 0.5]]
    assert np.allclose(found.sides, np.einsum("ijn,jkn->ikn", MATRIX, SETS.sides), rtol=0, atol=1e-15)
    exact = np.einsum("ijn,jn->in", np.abs(MATRIX), SETS.rest) + np.array(more)
    assert np.all(exact <= found.rest)
    assert np.all(found.rest <= exact + 1e-12)


@pytest.mark.parametrize(("width", "radius", "taken"), [(8.0, 0.0, True), (0.5, 0.0, False), (8.0, 20.0, False),
                                                        (8.0, np.inf, False)])  # fmt: skip
def test_a_rectangle_about_the_arc_is_taken_where_it_is_much_narrower(monkeypatch, width, radius, taken):
    with np.errstate(invalid="ignore"):
        found, _ = image(monkeypatch, width=width, radius=radius)
    told = np.allclose(found.sides, np.einsum("ijn,jkn->ikn", MATRIX, SETS.sides), rtol=0, atol=1e-15)
    assert told is taken
    boxes = found.boxes()
    if not taken:
        assert np.all((boxes.x[0] <= floats(10, 20) - width) & (boxes.x[0] > floats(10, 20) - width - 1e-9))
        assert np.all((boxes.x[1] >= floats(10, 20) + width) & (boxes.x[1] < floats(10, 20) + width + 1e-9))
        assert boxes.y[0] == pytest.approx([-9, -9])
        assert boxes.y[1] == pytest.approx([9, 9])
        assert not np.any(found.rest)


def test_a_parallelogram_may_be_half_again_as_wide_as_the_rectangle_and_no_more(monkeypatch):
    ours = image(monkeypatch)[0].reach()
    for width, which in ((ours[0] / 1.49, 0), (ours[1] / 1.49, 1)):
        found, _ = image(monkeypatch, width=width)
        assert bool(found.sides[0, 1, which] != 0)
        found, _ = image(monkeypatch, width=width * 1.49 / 1.51)
        assert not np.any(found.sides[0, 1, which])


@pytest.mark.parametrize(("known", "low", "high", "met", "lost"), [
    (True, -1.0, 1.0, True, False), (True, 0.5, 0.5, True, False), (True, 0.5, 0.25, False, True),
    (False, 0.5, 0.25, True, False),
])  # fmt: skip
def test_where_no_angle_is_left_there_is_no_image(monkeypatch, known, low, high, met, lost):
    """Of an arc that is a part of what is met; where angles are not known there may be one."""
    found, told = image(monkeypatch, smooth=False, known=known, low=low, high=high)
    assert told.tolist() == [met, met]
    assert (not np.any(found.known)) is lost


def given_images(monkeypatch, images):
    """`_carried` by stubs: of each set of a rectangle `whole` wide, or of a part, images or none; lost ones are nan."""
    asked = []

    def stub(map, sets, boxes, on):
        asked.append((boxes, on))
        rows = []
        for k in on:
            part = boxes.x[1][k] < sets.boxes().x[1][k] - 0.1
            for x in images[int(k)][int(part)]:
                rows.append((integers(k), points([x], [0.0])))
        return rows or [(on[:0], points([], []))]

    monkeypatch.setattr(parallelograms, "_carried", stub)
    return asked


def test_sets_are_carried_by_all_of_their_rectangle_or_else_by_what_is_on_the_table(monkeypatch):
    """Sets within: of one image, of two, lost; beyond an end: known, lost at first, lost; off the table: none."""
    images = {0: ([5.0], None), 1: ([6.0, 7.0], None), 2: ([np.nan], None), 3: ([8.0], None),
              4: ([9.0, np.nan], [10.0]), 5: ([np.nan], [11.0, np.nan]), 6: (None, None), 7: (None, None)}  # fmt: skip
    asked = given_images(monkeypatch, images)
    sets = points([0, 0, 0, 1, 1, 1, 3, 0], [0, 0, 0, 0, 0, 0, 0, 5], rest=0.5)
    map = SimpleNamespace(closed=False, top=1.0, outer=np.array([[-1.0], [1.0]]))
    source, found = carried(map, sets)
    order = np.lexsort((found.middle[0], source))
    told = list(zip(source[order].tolist(), found.middle[0][order].tolist(), found.known[order].tolist(), strict=True))
    assert [row[0] for row in told] == [0, 1, 1, 2, 3, 4, 5, 5]
    assert [row[1] for row in told if row[2]] == [5, 6, 7, 8, 10, 11]
    assert [row[0] for row in told if not row[2]] == [2, 5]
    assert np.all(np.isinf(found.rest[:, ~found.known]))
    assert [on.tolist() for _, on in asked] == [[0, 1, 2, 3, 4, 5], [4, 5]]
    part = asked[1][0]
    assert part.x[1][4] == 1.0
    assert part.x[0][4] == pytest.approx(0.5)


def test_what_rectangles_have_in_common_with_the_table_is_cut_at_its_ends():
    boxes = Boxes(integers(0, 1, 1), (floats(-3, 0, 0), floats(3, 4, 1)), (floats(-9, -1, 0), floats(9, 1, 1)))
    map = SimpleNamespace(closed=False, top=2.0, outer=np.array([[-1.0, 0.5], [1.0, 2.0]]))
    part = parallelograms._on_the_table(map, boxes)
    assert [x.tolist() for x in (*part.x, *part.y)] == [[-1, 0.5, 0.5], [1, 2, 1], [-2, -1, 0], [2, 1, 1]]
    map.closed = True
    part = parallelograms._on_the_table(map, boxes)
    assert [x.tolist() for x in (*part.x, *part.y)] == [[-3, 0, 0], [3, 4, 1], [-2, -1, 0], [2, 1, 1]]


@pytest.mark.parametrize("closed", [False, True])
def test_an_end_that_is_the_start_itself_is_none_beyond_the_table(monkeypatch, closed):
    """Of sets inside, and over the lower or the upper end; where the arc's end is in the place of the start, or not."""
    theta = floats(0, -1, 1, 0, -1, 1, -1, 1, -0.75, 0.75)  # the last ones end with the table
    boxes = Boxes(np.zeros(10, dtype=int), (theta - 0.5, theta + 0.5), (0 * theta, 0 * theta))
    low, high, seen = theta - 9.0, theta + 9.0, []
    low[:3], high[3:6], low[8:] = boxes.x[0][:3], boxes.x[1][3:6], boxes.x[0][8:]

    class Given:
        def __init__(self, map, boxes):
            assert boxes.chart.size == 10

        def arcs(self):
            return (integers(), low), (integers(), high)

        def split(self, low, high):
            seen.append((low[1].copy(), high[1].copy()))
            return []

    monkeypatch.setattr(parallelograms, "Chords", Given)
    map = SimpleNamespace(closed=closed, inner=np.array([[-1.25], [1.25]]))
    assert parallelograms._carried(map, points(theta, 0 * theta), boxes, np.arange(10)) == []
    lost = [] if closed else [1, 2, 4, 5]
    assert np.flatnonzero(np.isnan(seen[0][0])).tolist() == lost
    assert not np.any(np.isnan(seen[0][1]))
    none = points([], [])
    assert parallelograms._carried(map, none, boxes.chosen(slice(0)), np.arange(0))[0][0].size == 0


def test_of_a_set_over_a_join_the_crossing_of_a_longer_curve_counts_where_it_is_told(monkeypatch):
    """Three sets over a join, of which the second is told, and the third meets nothing; each with its own number."""
    asked = []

    class Given:
        def __init__(self, map, boxes):
            self.boxes = boxes

        def arcs(self):
            return (integers(), floats(0, 0, 0)), (integers(), floats(1, 1, 1))

        def split(self, low, high):
            yield np.arange(3), integers(1, 1, 1), low[1], high[1], False

        def beyond(self, on, chart, first, last):
            return hull(first - 1, last + 2), np.array([False, True, False])

    def image(flights, sets, on, chart, arc, smooth):
        asked.append((on.tolist(), arc.upper().max(), smooth))
        return points(10.0 * (1 + smooth) + on, 0.0 * on, rest=0.5), np.array([True, True, False])[on]

    monkeypatch.setattr(parallelograms, "Chords", Given)
    monkeypatch.setattr(parallelograms, "_image", image)
    sets = points([0.0] * 5, [0.0] * 5)
    boxes = Boxes(np.zeros(5, dtype=int), (np.zeros(5), np.ones(5)), (np.zeros(5), np.ones(5)))
    ((on, found),) = parallelograms._carried(SimpleNamespace(closed=True), sets, boxes, integers(1, 3, 4))
    assert on.tolist() == [1, 3]
    assert found.middle[0].tolist() == [10.0, 21.0]
    assert [(on, smooth) for on, _, smooth in asked] == [([0, 1, 2], False), ([1], True)]
    assert asked[0][1] == pytest.approx(1.0)
    assert asked[1][1] == pytest.approx(3.0)


def test_exit_angles_at_landings_are_cut_off_at_the_steepest():
    exit = BallArray(floats(0, 1, -1, 0), floats(0.25, 0.5, 0.5, np.inf))
    map = SimpleNamespace(top=1.25, exit=lambda eta, arc: exit)
    stub = SimpleNamespace(map=map, over=lambda on, chart, arc: (None, "eta"))
    known, low, high = Chords.exits(stub, None, None, None)
    assert known.tolist() == [True, True, True, False]
    assert low[:3] == pytest.approx([-0.25, 0.5, -1.25])
    assert high[:3] == pytest.approx([0.25, 1.25, -0.5])


def test_arcs_that_are_all_go_first_and_parts_of_others_are_put_together():
    whole = Piece(integers(2), integers(0), floats(1), floats(2), True)
    parts = [Piece(integers(0, 1), integers(0, 1), floats(3, 4), floats(5, 6), False),
             Piece(integers(1), integers(0), floats(7), floats(8), False)]  # fmt: skip
    none = Piece(integers(), integers(), floats(), floats(), True)
    split = lambda pieces: Chords.split(SimpleNamespace(pieces=lambda low, high: pieces), None, None)  # noqa: E731
    first, second = split([whole, *parts])
    assert first is whole
    assert [np.asarray(x).tolist() for x in second] == [[0, 1, 1], [0, 1, 0], [3, 4, 7], [5, 6, 8], False]
    assert split([whole]) == [whole]
    assert split([none]) == []
    assert len(split([none, *parts])) == 1


@pytest.mark.parametrize(("low", "high", "crossing", "found"), [
    (-0.5, 1.0, 1.25, (-0.5, 1.75)),  # over the upper end: one step is beyond all flights
    (-0.5, 1.0, 2.0, (-0.5, 2.5)),  # two
    (-0.5, 1.0, 1.0 + 0.75 * 2 ** (DOUBLINGS - 1) + 0.1, None),  # as many as are tried
    (-0.5, 1.0, 1.0 + 0.75 * 2 ** (DOUBLINGS - 1) - 0.1, (-0.5, 1.0 + 0.75 * 2 ** (DOUBLINGS - 1))),
    (-1.0, 0.5, -1.25, (-1.75, 0.5)), (-1.0, 0.5, -2.0, (-2.5, 0.5)),
    (-1.0, 1.0, 0.0, None),  # over both ends
    (-0.5, 0.5, 0.0, (-0.5, 0.5)),
    (0.5, 0.5, 0.0, None), (np.nan, 0.5, 0.0, None), (-0.5, np.nan, 0.0, None),
])  # fmt: skip
def test_arcs_go_on_beyond_a_join_until_all_flights_cross_them(low, high, crossing, found):
    """Of a component from -1 to 1; a step is what a box is wide, and a long flight turns by."""
    reach = BallArray(floats(9, 0), floats(9, 0.75 - REACH * 0.125)), BallArray(floats(9, 0), floats(9, 0.125))
    asked = []

    def sides(end, on):
        asked.append((end, on))
        return BallArray(end[1] - crossing, 0 * end[1])

    stub = SimpleNamespace(map=SimpleNamespace(outer=np.array([[-1.0], [1.0]])), reach=reach, sides=sides)
    arc, known = Chords.beyond(stub, integers(1), integers(0), floats(low), floats(high))
    assert known.tolist() == [found is not None]
    if found:
        assert (arc.lower()[0], arc.upper()[0]) == pytest.approx(found)
        assert arc.lower()[0] <= found[0]
        assert arc.upper()[0] >= found[1]
    assert all((on.tolist(), end[0].tolist()) in (([1], [0]), ([], [])) for end, on in asked)


def test_a_set_that_touches_the_table_has_an_image(monkeypatch):
    """In one point of its border, in either coordinate; beyond it there is none."""
    one = points([1.5], [1.5], rest=0.5)
    left, low = one.boxes().x[0][0], one.boxes().y[0][0]
    for end, top, met in ((left, low, 1), (np.nextafter(left, 0), low, 0), (left, np.nextafter(low, 0), 0)):
        asked = given_images(monkeypatch, {0: ([5.0], [5.0])})
        carried(SimpleNamespace(closed=False, top=top, outer=np.array([[-1.0], [end]])), one)
        assert asked[0][1].size == met


@pytest.mark.parametrize("at", [0.0, 1.0, -3.0])
def test_a_rectangle_about_a_point_holds_it_inside(at):
    boxes = points([at], [at]).boxes()
    for low, high in (boxes.x, boxes.y):
        assert low[0] < at < high[0]
        assert high[0] - low[0] < 1e-14


@pytest.mark.parametrize(("on", "arc", "at"), [
    (0, (0.0, 1.0), None), (1, (0.0, 1.0), 0.625), (1, (0.4375, 0.5625), 0.5), (0, (0.5, 1.0), 0.875),
])  # fmt: skip
def test_a_landing_is_taken_if_it_lies_in_the_arc_on_its_component_and_else_a_guess_or_the_middle(on, arc, at):
    """Landings at 1/4, on the component that is asked for, and at 1/2 on the next; a guess is 1/8 beyond the middle."""
    stub = SimpleNamespace(
        landed=(integers(0, 1), floats(0.25, 0.5), [BallArray(floats(10.0, 20.0), floats(0, 0))]),
        map=SimpleNamespace(place=lambda chart, at: (chart.tolist(), at.m.tolist())),
        _polished=lambda on, chart, near: near + 0.125,
    )
    ball, place = Chords._near(stub, integers(on), integers(0), hull(floats(arc[0]), floats(arc[1])))
    assert ball.m.tolist() == [0.25 if at is None else at]
    assert not np.any(ball.r)
    assert ([x.m.tolist() for x in place] == [[10.0]]) if at is None else (place == ([0], [at]))


def test_where_sides_cancel_a_reach_is_what_rounding_may_leave():
    """Of `2*theta - phi` on a set along `phi = 2*theta`: nothing, but for the last bits of all terms."""
    sides = np.array([[[0.5], [-0.25]], [[1.0], [-0.5]]])
    one = Parallelograms(integers(0), np.zeros((2, 1)), sides, np.zeros((2, 1)))
    assert one.reach(2.0, -1.0)[0] == pytest.approx(3.0 * 2.0**-48, rel=1e-9, abs=0)
    assert replace(one, rest=floats(0.125, 0.25)[:, None]).reach(2.0, -1.0)[0] == pytest.approx(0.5, rel=1e-9)


def test_lost_sets_are_known_to_be_lost():
    for field in ("middle", "sides", "rest"):
        value = getattr(SETS, field).copy()
        value[(0,) * (value.ndim - 1) + (1,)] = np.nan
        assert replace(SETS, **{field: value}).known.tolist() == [True, False]
        value[(1,) * (value.ndim - 1) + (0,)] = np.inf
        assert replace(SETS, **{field: value}).known.tolist() == [False, False]
