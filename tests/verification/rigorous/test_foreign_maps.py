"""Maps of the plane that are no billiards: what is published of them is proved, and nothing that is false."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import inf, nan, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import label

from verification.arithmetic import ArrayOps, BallArray, exactly
from verification.rigorous.absorbing import AbsorbingSet, grown, kept_apart
from verification.rigorous.boxes import Boxes, Chart, Images, PlaneImages, Turned, collected
from verification.rigorous.exclusion import Cuboids, exclude
from verification.rigorous.graph import Cells, Grid, inside, mapped, morse_graph, refined, transitions
from verification.rigorous.norms import in_frame, shrinkage

UNIT, CIRCLE = Chart("unit square", (0, 1), (0, 1)), Chart("circle", (0, 1), (-1, 1), period=True)
INTERVAL = Chart("interval", (-1, 1), (-1, 1), kept=True)


@dataclass(frozen=True)
class Torus:
    """A map of the plane modulo 1: images are cut where the second coordinate is a whole number."""

    map: PlaneImages
    label: str = "a map of the torus"
    charts: tuple[Chart, ...] = (Chart("torus", (0, 1), (0, 1), period=True, kept=True),)

    def images(self, boxes):
        source, (chart, x, (low, high)), _ = self.map.images(boxes)
        rows = []
        for turn in range(int(np.floor(low.min())), int(np.floor(high.max())) + 1):
            on = (turn <= high) & (low <= turn + 1)
            ends = np.maximum(low[on] - turn, 0), np.minimum(high[on] - turn, 1)
            rows.append((source[on], chart[on], x[0][on], x[1][on], *ends))
        return collected(rows, boxes.chart.size)


def folded(a, b, shear, chart):
    """The Lozi map `(x, y) -> (1 - a*|x| + y, b*x)`, and without shear `(1 - a*|x|, b*y)`."""
    a, b = exactly(Fraction(a)), exactly(Fraction(b))

    def slope(x, y):
        sign = np.where(x.positive(), 1.0, np.where(x.negative(), -1.0, 0.0))
        return (a * BallArray(-sign, 1 - np.abs(sign)), shear), ((b, 0) if shear else (0, b))

    formula = lambda x, y: (1 - a * ArrayOps().Abs(x) + shear * y, b * (x if shear else y))  # noqa: E731
    return PlaneImages("fold", chart, formula, slope)


def plane(x, y, chart):
    return PlaneImages.from_text("map", chart, x, y)


SMALL, LARGE = (Chart("plane", (-1.5 * k, 1.5 * k), (-0.5 * k, 0.5 * k)) for k in (1, 3))
KICK = "0.15*sin(2*pi*x)"
MAPS = {
    "Henon": (plane("1 - 1.4*x**2 + y", "0.3*x", SMALL), 512),
    "Henon, a = 3/10": (plane("1 - 0.3*x**2 + y", "0.3*x", LARGE), 256),
    "Henon, a = 3/5": (plane("1 - 0.6*x**2 + y", "0.3*x", LARGE), 256),
    "Lozi": (folded("1.7", "0.3", 1, SMALL), 512),
    "logistic": (plane("3.832*x*(1 - x)", "y/4", INTERVAL._replace(x=(0, 1))), 1024),
    "doubling": (plane("2*x", "y/2", CIRCLE), 64),
    "tent": (folded(2, "0.5", 0, INTERVAL), 64),
    "cat": (Torus(plane("2*x + y", "x + y", UNIT)), 32),
    "standard": (Torus(plane(f"x + y + {KICK}", f"y + {KICK}", UNIT)), 32),
    "rotation": (plane("x + 3/10", "y", CIRCLE._replace(kept=True)), 32),
    "turn of a disc": (plane("3/5*x - 4/5*y", "4/5*x + 3/5*y", Chart("plane", (-1, 1), (-1, 1))), 32),
}


@cache
def graph_of(name):
    map, cells = MAPS[name]
    return morse_graph(refined(map, Grid(map.charts, cells, cells), 8))


def attractors(graph):
    """The attracting Morse sets without the outside."""
    return [i for i in graph.attracting if graph.transitions.count not in graph.sets[i]]


def vertex(transitions, x, y):
    """The leaf that holds each point; the outside for points beyond the chart."""
    grid, leaf = transitions.grid, transitions.leaf
    picture = grid.to_array(transitions.chosen(np.ones(leaf.size + 1, dtype=bool)), np.flatnonzero(leaf))[0]
    ends = ((x, grid.charts[0].x, grid.columns), (y, grid.charts[0].y, grid.rows))
    column, row = (np.floor((z - low) / (high - low) * count).astype(int) for z, (low, high), count in ends)
    return np.pad(picture, 1, constant_values=leaf.size)[tuple(np.clip(i + 1, 0, grid.rows + 1) for i in (column, row))]


def parts(graph, members):
    """The leaves of a Morse set, and a 1 for each."""
    some = graph.transitions.chosen(np.isin(np.arange(graph.transitions.count + 1), members))
    return some, np.ones(some.chart.size, dtype=int)


def orbits(name, x, y, steps):
    """Points of orbits in float64."""
    map = MAPS[name][0]
    for _ in range(steps):
        x, y = (np.clip(z.m, -1e3, 1e3) for z in getattr(map, "map", map).formula(BallArray(x), BallArray(y)))
        x, y = x % 1 if map.charts[0].period else x, y % 1 if isinstance(map, Torus) else y
    return x, y


def starts(name, seed):
    (chart,) = MAPS[name][0].charts
    return [np.random.default_rng(seed).uniform(low, high, 400) for low, high in (chart.x, chart.y)]


@pytest.mark.slow
@given(st.sampled_from([*MAPS]), st.integers(0, 10**6))
def test_orbits_walk_along_edges_and_end_in_morse_sets_and_in_the_block_of_their_basin(name, seed):
    graph, start = graph_of(name), starts(name, seed)
    coarse = transitions(MAPS[name][0], graph.transitions.grid, graph.transitions.grid.whole(8))
    points = [
        start,
        orbits(name, *start, 1),
        orbits(name, *start, 50 if name == "doubling" else 200),
    ]  # floats end at 0
    first, _, last = (vertex(graph.transitions, *each) for each in points)
    assert np.all(coarse.edges[vertex(coarse, *points[0]), vertex(coarse, *points[1])])
    assert np.all(graph.transitions.recurrent[last])
    for block in map(graph.trapping, attractors(graph)):
        assert np.all(block[last[graph.basin(block)[first]]])


SINKS = {  # Henon 1976: one point attracts below a = 3*(1 - b)**2/4, then two up to (1 - b)**2 + (1 + b)**2/4
    "Henon, a = 3/10": np.roots([0.3, 0.7, -1])[1:],
    "Henon, a = 3/5": np.roots([0.36, -0.6 * 0.7, 0.49 - 0.6]),
    "logistic": [0.5, 3.832 / 4, 3.832**2 / 4 * (1 - 3.832 / 4)],  # up to 1e-4: superstable at 3.8318741
}


@pytest.mark.parametrize("name", SINKS)
def test_a_sink_is_isolated_point_by_point(name):
    graph, x = graph_of(name), np.array(SINKS[name])
    (sink,) = attractors(graph)
    y = 0 * x if name == "logistic" else 0.3 * np.roll(x, 1)

    assert label(graph.transitions.grid.to_array(*parts(graph, graph.sets[sink]))[0])[1] == x.size
    assert {*vertex(graph.transitions, x, y)} <= {*graph.sets[sink]}


@pytest.mark.parametrize(("name", "a"), [("Henon", 1.4), ("Henon, a = 3/10", 0.3), ("Henon, a = 3/5", 0.6)])
def test_fixed_points_lie_in_morse_sets_and_the_outer_saddle_in_no_attractor(name, a):
    graph, x = graph_of(name), np.sort(np.roots([a, 0.7, -1]))[::-1]
    inner, outer = vertex(graph.transitions, x, 0.3 * x)
    (attractor,) = attractors(graph)

    assert graph.transitions.recurrent[inner]
    assert graph.transitions.recurrent[outer]
    assert (inner in graph.sets[attractor]) is (name != "Henon, a = 3/5")
    assert not graph.trapping(attractor)[outer]


CORNER = (2 + 1.7 + sqrt(1.7**2 + 1.2)) / 2 / 2.4, 0.0  # where the expanding line of the fixed point meets the axis
POLYGONS = {  # corners clockwise. Henon 1976, section 4: a quadrilateral; Misiurewicz 1980: a point and its two images
    "Henon": [(-1.33, 0.42), (1.32, 0.133), (1.245, -0.14), (-1.06, -0.5)],
    "Lozi": [orbits("Lozi", *map(np.float64, CORNER), n) for n in (2, 1, 0)],
}


def beyond(corners, x, y):
    """How far points lie beyond the sides of a convex polygon, at most."""
    sides = zip(np.array(corners), np.roll(corners, -1, axis=0), strict=True)
    return np.max([((q - p)[0] * (y - p[1]) - (q - p)[1] * (x - p[0])) / np.hypot(*(q - p)) for p, q in sides], axis=0)


@pytest.mark.parametrize("name", POLYGONS)
def test_the_attractor_lies_in_the_published_polygon_and_attracts_its_points(name):
    graph, (x, y), corners = graph_of(name), starts(name, 1), POLYGONS[name]
    (attractor,) = attractors(graph)
    grid, block = graph.transitions.grid, graph.transitions.chosen(graph.trapping(attractor))
    boxes, within = grid.boxes(block), beyond(corners, x, y) < 0

    assert np.all(inside(grid, block, *mapped(MAPS[name][0], grid, block)))
    assert np.max([beyond(corners, a, b) for a in boxes.x for b in boxes.y]) < 0.04
    assert within.sum() > 100
    assert {*vertex(graph.transitions, *orbits(name, x[within], y[within], 200))} <= {*graph.sets[attractor]}


def test_henons_quadrilateral_is_kept_by_outer_images():
    """Henon 1976, section 4: the map takes it into itself, and does so with boxes, but for those on its border."""
    map, grid = MAPS["Henon"][0], Grid((Chart("plane", (-1.5, 1.5), (-0.6, 0.6)),), 1024, 1024)
    cells, boxes = grid.whole(), grid.boxes(grid.whole())
    sides = [beyond(POLYGONS["Henon"], x, y) for x in boxes.x for y in boxes.y]
    meets, wholly = np.min(sides, axis=0) <= 0, np.max(sides, axis=0) <= 0
    block = Cells(*(field[meets] for field in cells))

    assert wholly.sum() > 100_000
    assert np.all(inside(grid, block, *mapped(map, grid, block))[wholly[meets]])


@pytest.mark.parametrize("name", ["cat", "standard", "rotation", "turn of a disc"])
def test_where_area_is_preserved_nothing_less_than_everything_attracts(name):
    graph = graph_of(name)
    everything = np.append(graph.transitions.leaf, name == "turn of a disc")  # whose corners leave the square
    assert [np.count_nonzero(everything[members]) for members in graph.sets] == [everything.sum()]
    assert not graph.basin(~everything).any()


@pytest.mark.parametrize("name", ["doubling", "tent"])
def test_an_expanding_map_has_the_whole_interval_as_its_attractor(name):
    graph = graph_of(name)
    (attractor,) = attractors(graph)
    picture = graph.transitions.grid.to_array(*parts(graph, graph.sets[attractor]))[0]
    assert picture.sum() == 2 * 64  # the two rows that meet the axis
    assert picture[:, 31:33].all()


def box(x, y=(0.25, 0.5)):
    return Boxes(np.array([0]), *((np.array([low]), np.array([high])) for low, high in (x, y)))


HALF, SAME = plane("x/2 + 1/4", "y/2 + 1/4", UNIT), plane("x", "y", UNIT)
JUMP = PlaneImages(  # x/2, and 1/2 more from 1/2 on: there the derivative has no bound
    "jump",
    UNIT,
    lambda x, y: (BallArray(x.m / 2 + (x.m >= 0.5) / 2, x.r), y / 2),
    lambda x, y: ((BallArray(0.5, np.where((x - 0.5).positive() | (0.5 - x).positive(), 0, inf)), 0), (0, 0.5)),
)
BAD = [(-inf, inf), (0.0, inf), (nan, 0.5), (0.5, nan), (nan, nan), (0.75, 0.25)]
LOST = [(HALF, ends) for ends in BAD] + [(JUMP, ends) for ends in ((0.25, 0.5), (0.5, 0.75), (0.0, 1.0))]
LOST += [(plane(f"{word}/100", "y", UNIT), (0.0, 0.5)) for word in ("1/x", "sqrt(x)", "log(x)")]
GRID, WHOLE, NONE = (g := Grid((UNIT,), 8, 8)), g.whole(), Cells(*np.zeros((4, 0), dtype=int))


@pytest.mark.parametrize(("map", "ends"), LOST)
def test_a_box_without_a_proved_image_is_lost(map, ends):
    assert map.images(box(ends)).lost.tolist() == [0]
    assert map.images(box((0.125, 0.25))).lost.size == 0


@pytest.mark.parametrize("ends", [*BAD, (-0.25, 0.25), (0.0, 0.25), (0.75, 1.0), (1.5, 2.0)])
def test_nothing_holds_or_grows_from_a_box_that_is_not_inside_the_chart(ends):
    """Nor is it known where an angle lies whose ends are exchanged or not finite."""
    assert GRID.met(Images.exact(box(ends))).out.all()
    assert Grid((CIRCLE,), 8, 8).met(Images.exact(box(ends))).out.all() == (ends in BAD)
    assert grown(HALF, (8, 8, 1), box(ends)) is None
    assert not AbsorbingSet(GRID, np.arange(64)).holds(box(ends))


@given(st.sampled_from([3, 7, 100, 2**20]), st.integers(-(10**16), 10**16).map(lambda n: n / 7))
def test_a_cell_is_met_however_many_turns_away(columns, angle):
    met = Grid((CIRCLE,), columns, 1).met(Images.exact(box((angle, angle))))

    assert 0 <= met.left[0] < columns
    assert (int(Fraction(angle) % 1 * columns) - met.left[0]) % columns <= met.right[0] - met.left[0] < columns


class Forgetful:
    """A map that says nothing of every other box."""

    charts, label = (UNIT,), "forgetful"

    def images(self, boxes):
        found = HALF.images(boxes)
        return Images(found.source[::2], found.boxes.chosen(slice(None, None, 2)), found.lost)


def test_an_image_that_touches_the_border_of_a_set_is_not_inside():
    """The identity maps each set onto itself, and none into its interior."""
    block = Cells(*(field[(WHOLE.column // 2 % 3 != 0) & (WHOLE.row // 2 % 3 != 0)] for field in WHOLE))
    assert inside(GRID, block, *mapped(SAME, GRID, block)).sum() == 4
    assert grown(SAME, (8, 8, 1), box((0.25, 0.5))) is None


def test_a_box_that_is_left_out_proves_nothing():
    """By the map, of a set, or from all sets."""
    assert attractors(morse_graph(transitions(Forgetful(), GRID, WHOLE))) == []
    assert inside(GRID, WHOLE, *mapped(Forgetful(), GRID, WHOLE)).sum() == 32
    whole = grown(HALF, (8, 8, 1), box((0.25, 0.5)))
    for gone in np.flatnonzero(np.isin(whole.numbers, [3 * 9, 4 * 9])):  # cells beside the fixed point
        fewer = AbsorbingSet(GRID, np.delete(whole.numbers, gone)).cells
        assert not np.all(inside(GRID, fewer, *mapped(HALF, GRID, fewer)))
    assert morse_graph(transitions(HALF, GRID, NONE)).sets == ()
    assert grown(HALF, (8, 8, 1), GRID.boxes(NONE)) is None


ENDS = [(1, 0), (0, 0), (0, inf), (nan, 1), (Fraction(1, 3), 1), (2**53 + 1, 2**54), (0, 5e-324)]
ACROSS = [(0, 2, 4), (1, 0, 2), (8, 0, 4), (-4, 0, 4)]  # column, row, size; the third would go on at the first column
REGIONS = [np.zeros((2, 0, 2)), np.full((2, 1, 1), 1.7e308)]  # no boxes; beyond the doubles
REFUSED = [lambda x=x: Grid((Chart("plane", x, (0, 1)),), 4, 4) for x in ENDS]
REFUSED += [lambda c=c: transitions(HALF, Grid((UNIT,), 10, 8), Cells(*np.array([0, *c])[:, None])) for c in ACROSS]
REFUSED += [lambda r=r: exclude(Cuboids(*r), lambda some: some.half[:, 0] > 0, 9, 0.1) for r in REGIONS]
REFUSED += [lambda: mapped(HALF, GRID, NONE)]


@pytest.mark.parametrize("made", REFUSED)
def test_what_is_no_grid_no_block_and_no_region_is_refused(made):
    with pytest.raises(ValueError, match=r"accepted: |at least one"):
        made()


@pytest.mark.parametrize(("lift", "apart"), [("x - ", True), ("x + ", False), ("x + 1/3 - ", False)])
def test_a_set_is_kept_apart_from_its_turned_copies(lift, apart):
    """Sinks at 0, 1/3 and 2/3; where these repel or are exchanged, a set that grows from 0 meets the others."""
    map = plane(f"{lift}sin(6*pi*x)/20", "y/2", CIRCLE)
    charts = [(each, each.charts) for each in (map, Turned(map, 3))]
    count = [len(attractors(morse_graph(refined(each, Grid(chart, 96, 64), 8)))) for each, chart in charts]

    assert (kept_apart(map, (96, 64, 1), box((-0.01, 0.01), (-0.1, 0.1))) is not None) is apart
    assert count == ([1, 1] if lift == "x + 1/3 - " else [3, 1])


@given(st.sampled_from([(0.0, 5e-324), (0.0, 25e-324), (1.0, 0.3), (1e16, 3.0)]), st.sampled_from([-1, 0, 1]))
def test_a_solution_on_the_border_of_boxes_is_in_one_of_them(line, share):
    point = Fraction(line[0]) + share * Fraction(line[1])

    def free(some):
        ends = zip(some.middle[:, 0], some.half[:, 0], strict=True)
        return np.array([abs(Fraction(middle) - point) > Fraction(half) for middle, half in ends])

    assert exclude(Cuboids(*(np.array([[z]]) for z in line)), free, 300, 0.0).proved is None


ONE, TWICE = np.eye(2)[..., None], np.eye(2)[..., None] * [0.5, 0.5]
EXPANDING = [(ONE, [0]), (ONE[::-1], [0]), (-2 * ONE, [0])]  # isometries; entries, and not their moduli
EXPANDING += [(ONE + bound, [0]) for bound in (nan, inf, 1e300)] + [(TWICE * [1, 2], [1, 1])]
EXPANDING += [(TWICE, [1, -1]), (TWICE[..., :0], [])]  # a set without a target; no set


@pytest.mark.parametrize(("size", "target"), EXPANDING)
def test_what_does_not_contract_has_no_factor_below_one(size, target):
    assert shrinkage(size, np.array(target, dtype=int)) >= 1
    assert shrinkage(TWICE, np.array([1, 0])) < 0.51
    with pytest.raises(ZeroDivisionError):  # vectors that are parallel are no frame
        in_frame(((1.0, 2.0), (2.0, 4.0)), [[BallArray(0.5)] * 2] * 2)
