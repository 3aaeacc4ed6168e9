"""Two basins and what divides them: the proof at 0.09, orbits that agree with it, and what is refused."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from symbolic import Scene
from verification.arithmetic.arrays import BallArray
from verification.paper.egg.basins import division
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.graph import Cells, Grid, Transitions, sparse
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts import division as division_of
from verification.proofs.starts.core import attracts
from verification.proofs.starts.division import Division

FOUND = division()
RING, CHART = FOUND.ring, FOUND.core.chart


def test_almost_every_orbit_of_the_cuspless_table_at_0_09_goes_to_one_of_two():
    """And samples agree: of random starts each comes to the cycle or into the region, and some to either."""
    assert set(FOUND.checks.values()) == {True}
    map, graph = PinballMap("cuspless", lam="0.09"), FOUND.graph.transitions
    start = interior_starts(map, 1000, 3)
    end = map.exponents(start.theta, start.phi, 3000, 3000, start.component)
    cells = graph.chosen(FOUND.region)
    member = graph.grid.painted(cells, np.ones(cells.chart.size, dtype=bool)).astype(bool)
    place = []
    for side, value, count in (("x", end.theta, graph.grid.columns), ("y", end.phi, graph.grid.rows)):
        low, high = np.array([getattr(c, side) for c in graph.grid.charts])[end.component].T
        place.append(np.clip(((value - low) / (high - low) * count).astype(int), 0, count - 1))
    kept = member[end.component, place[0], place[1]]
    assert np.array_equal(kept, np.abs(end.theta) > 0.2)
    assert 0.1 < np.mean(kept) < 0.9
    assert np.all(end.nu_plus[~kept] < 0)
    assert np.all(end.nu_plus[kept] > 0)


def test_the_derivative_of_two_bounces_stretches_the_ring_as_the_kernels_find_it():
    """At the two ends of a part, by 1.0105 and 1.0500 along the ring; a little less is proved, with the cone."""
    map = PinballMap("cuspless", lam="0.09")
    theta = np.array([RING.low, RING.high])
    at, phi, on = theta, RING.slope * theta + RING.offset, np.full(2, CHART)
    vector = np.stack([np.ones(2), np.full(2, RING.slope)], 1)[..., None]
    for _ in range(2):
        step, vector = map.step(at, phi, on), map.derivative(at, phi, on) @ vector
        at, phi, on = step.theta, step.phi, step.component
    assert np.all(np.abs(np.abs(vector[:, 0, 0]) - [1.0105, 1.0500]) < 1e-4)
    assert RING.stretches(FOUND.map, CHART)


@pytest.mark.parametrize(
    "change",
    [
        {"growth": 1.02},  # the inner end stretches by 1.0105
        {"growth": 1.0},  # no stretching
        {"low": 0.05},  # there the map of two bounces shrinks
        {"cone": 0.001},  # images of its slopes lie within 0.0022
        {"slope": -0.08551},  # no direction that the map keeps
    ],
)
def test_a_ring_that_does_not_stretch_is_refused(change):
    """Each hypothesis fails alone."""
    assert not replace(RING, **change).stretches(FOUND.map, CHART)


@pytest.mark.parametrize("change", [{"low": -0.1}, {"low": 0.3}, {"width": 0.0}, {"cone": -0.1}])
def test_a_ring_without_two_parts_that_are_apart_is_refused(change):
    with pytest.raises(ValueError, match="accepted: 0 <= low < high"):
        replace(RING, **change)


@pytest.mark.parametrize("slope", [RING.slope, -3.0])
def test_boxes_cover_a_part_and_its_points_are_in_it(slope):
    """Random points of either part, whether the line rises or falls; those beside it by more than the width are out."""
    ring, rng = replace(RING, slope=slope), np.random.default_rng(5)
    x = rng.uniform(ring.low, ring.high, 3000)
    off = ring.width * rng.uniform(-1, 1, x.size)
    for side in (1, -1):
        part = ring.part(CHART, side)
        for aside, inside in ((off, True), (off + np.sign(off) * ring.width, False)):
            place = side * x, side * (ring.slope * x + ring.offset + aside)
            boxes = Boxes(np.full(x.size, CHART), *((end, end) for end in place))
            assert np.array_equal(ring.sides(boxes, CHART), np.full(x.size, side * inside))
        at = np.searchsorted(part.x[1] if side > 0 else -part.x[0], x)
        y = side * (ring.slope * x + ring.offset + off)
        assert np.all((part.x[0][at] <= side * x) & (side * x <= part.x[1][at]))
        assert np.all((part.y[0][at] <= y) & (y <= part.y[1][at]))


def test_a_box_is_in_a_falling_part_only_if_all_its_corners_are():
    ring = replace(RING, slope=-3.0)
    x, width = np.array([0.15]), 1.9 * ring.width / 3
    y = ring.slope * (x + width / 2) + ring.offset
    assert ring.sides(Boxes(np.array([CHART]), (x, x + width), (y, y)), CHART) == 1
    tall = y + 0.1 * ring.width
    assert ring.sides(Boxes(np.array([CHART]), (x, x + width), (y, tall)), CHART) == 0


def test_boxes_are_in_a_part_of_the_ring_only_as_a_whole():
    """A box on the line is in, its mirror image in the other part; one that juts out, or is elsewhere, in neither."""
    x = np.array([0.15, 0.15, 0.139, 0.15, -0.16])
    y = RING.slope * np.abs(x) + RING.offset
    y[1] += RING.width
    chart = np.array([CHART, CHART, CHART, 1 - CHART, CHART])
    boxes = Boxes(chart, (x, x + 1e-4), (np.copysign(y, x), np.copysign(y, x)))
    assert RING.sides(boxes, CHART).tolist() == [1, 0, 0, 0, -1]
    part = RING.part(CHART, -1)
    assert part.x[0].min() <= -RING.high < -RING.low <= part.x[1].max()


@pytest.mark.parametrize(
    ("rows", "held"),
    [
        ((-1.5, -0.15), True),
        ((-1.1, -0.15), False),  # by less than is asked
        ((-1.5, -0.30), False),  # to slopes of 0.17 and more
        ((np.where(np.arange(division_of.PARTS) % 9, 1.5, -1.5), -0.15), False),  # vectors may cancel along a segment
    ],
)
def test_a_cone_is_kept_and_stretched_only_if_each_of_three_inequalities_holds(monkeypatch, rows, held):
    """Of matrices `[[a, 0], [c, -2*c]]`, by hand: slopes from 0.05 to 0.15 go to 0.07 to 0.09 where a is -1.5."""
    ring = replace(RING, slope=0.1, cone=0.05, growth=1.2)
    a, c = (np.broadcast_to(np.asarray(x, dtype=float), (division_of.PARTS,)) for x in rows)
    c = c * np.sign(a) * -1
    entries = [[BallArray(a), BallArray(0 * a)], [BallArray(c), BallArray(-2 * c)]]
    monkeypatch.setattr(division_of, "derivative", lambda *_: entries)
    assert ring.stretches(FOUND.map, CHART) is held
    monkeypatch.setattr(division_of, "derivative", lambda *_: None)
    assert not ring.stretches(FOUND.map, CHART)


@pytest.mark.parametrize(
    ("row", "turn", "held"),
    [
        ((1.5, 0.0), (0.165, 0.33), True),  # slopes go to 0.121 to 0.143
        ((1.5, 0.0), (0.18, 0.36), False),  # to 0.156 where they are 0.15, and to 0.132 where they are 0.05
        ((1.5, 0.0), (0.24, -0.48), True),  # to 0.144 to 0.112
        ((1.5, 0.0), (0.255, -0.51), False),  # to 0.153 where they are 0.05
        ((1.5, 0.0), (0.12, -0.24), True),
        ((1.5, 0.0), (0.12, -0.9), False),  # to less than 0.05 where they are 0.15
        ((1.6, -2.0), (0.15, 0.0), True),  # stretched by 1.5 to 1.3
        ((1.45, -2.0), (0.15, 0.0), False),  # by 1.15 where slopes are 0.15
        ((1.05, 2.0), (0.1, 0.0), False),  # by 1.15 where they are 0.05
        ((1.15, 2.0), (0.13, 0.0), True),
    ],
)
def test_a_cone_is_kept_and_stretched_at_both_of_its_ends(monkeypatch, row, turn, held):
    """Of matrices with these rows, by at least 1.2, from slopes of 0.05 to 0.15 to such slopes."""
    full = lambda x: BallArray(np.full(division_of.PARTS, x), np.zeros(division_of.PARTS))  # noqa: E731
    entries = [[full(x) for x in row], [full(x) for x in turn]]
    monkeypatch.setattr(division_of, "derivative", lambda *_: entries)
    assert replace(RING, slope=0.1, cone=0.05, growth=1.2).stretches(None, CHART) is held


RIGHT, LEFT, ARC, OTHER, BESIDE = range(5)  # boxes of the two parts, two on the arc, and one on the wall beside


@pytest.mark.parametrize(
    ("edges", "good"),
    [
        ([(RIGHT, ARC), (ARC, LEFT), (LEFT, OTHER), (OTHER, RIGHT)], {RIGHT, LEFT, ARC, OTHER}),
        ([(RIGHT, ARC), (ARC, RIGHT)], set()),  # back to the same part
        ([(RIGHT, ARC), (ARC, LEFT), (LEFT, OTHER), (OTHER, RIGHT), (OTHER, LEFT)], set()),  # to either part
        ([(RIGHT, LEFT), (LEFT, RIGHT)], set()),  # on the wall twice
        ([(RIGHT, ARC), (ARC, LEFT), (LEFT, OTHER), (OTHER, RIGHT), (ARC, OTHER)], set()),  # on the arc twice
        ([(ARC, OTHER), (OTHER, ARC)], set()),  # on the arc alone
        ([(BESIDE, ARC), (ARC, LEFT), (LEFT, OTHER), (OTHER, BESIDE)], set()),
        ([(RIGHT, ARC), (ARC, LEFT), (LEFT, OTHER), (OTHER, RIGHT), (BESIDE, BESIDE)], {RIGHT, LEFT, ARC, OTHER}),
    ],
)
def test_orbits_are_in_the_ring_where_walks_go_from_one_part_to_the_other_by_way_of_the_arc(edges, good):
    x, chart = np.array([0.17, -0.17, 1.0, -1.0, 0.3]), np.array([CHART, CHART, 1 - CHART, 1 - CHART, CHART])
    y = np.where(chart == CHART, np.sign(x) * (RING.slope * np.abs(x) + RING.offset), 0.0)
    grid = Grid(FOUND.map.charts, *FOUND.grid)
    sides = [np.array([getattr(c, side) for c in grid.charts])[chart].T for side in ("x", "y")]
    at = [
        np.floor((value - low) / (high - low) * count).astype(np.int64)
        for value, (low, high), count in zip((x, y), sides, FOUND.grid, strict=True)
    ]
    links = sparse(*(np.array(ends, dtype=np.int32) for ends in zip(*edges, strict=True)), 6)
    some = Transitions(grid, Cells(chart, *at, np.ones(5, dtype=np.int64)), np.ones(5, dtype=bool), links)
    rest = np.array([True] * 5 + [False])
    found = Division._around(SimpleNamespace(graph=SimpleNamespace(transitions=some), ring=RING, core=FOUND.core), rest)
    inside = set(np.flatnonzero(found).tolist())
    assert {box for edge in edges for box in edge if edge[0] != edge[1]} & inside == good


def test_points_of_settled_boxes_converge_in_float64():
    graph, map = FOUND.graph.transitions, PinballMap("cuspless", lam="0.09")
    boxes, rng = graph.grid.boxes(graph.cells), np.random.default_rng(2)
    some = rng.choice(np.flatnonzero(FOUND.settled), 3000)
    theta, phi = (low[some] + rng.random(3000) * (high[some] - low[some]) for low, high in (boxes.x, boxes.y))
    end = map.exponents(theta, phi, 1, 3000, graph.cells.chart[some])
    assert np.all(np.abs(end.phi) < 1e-6)


def test_what_is_left_out_is_not_proved():
    """A ring too short leaves boxes that are neither; a bound above the exponents of all orbits is none."""
    short = replace(FOUND, ring=replace(RING, low=0.17), rate=2.0).checks
    assert {name for name, held in short.items() if held is not True} == {"unstable", "saddles"}


def test_a_core_beyond_the_cycle_of_period_4_and_one_of_an_unstable_cycle_are_refused():
    """Between 0.167 and 0.18 orbits leave; beyond lambda_c = 0.0934 all do."""
    assert attracts(FOUND.map, FOUND.core)["orbits come to the middle"]
    assert not attracts(FOUND.map, replace(FOUND.core, outer=0.18))["orbits come to the middle"]
    beyond = PinballImages(Scene("cuspless", lam="0.095"), (Fraction(95, 1000),) * 2)
    assert not attracts(beyond, FOUND.core)["they converge there"]


STEPS = {
    "invertible": set(division_of.CHECKS),
    "core": {"core"},
    "no region": set(division_of.CHECKS) - {"core"},
    "expansion": {"unstable"},
    "just as much": set(),
    "ring": {"ring"},
    "a sink": {"saddles"},
    "all stay": {"saddles"},
    "not told": {"saddles"},
    "lost": {"saddles"},
    "none": set(),
    "no rate": {"unstable"},
    "no contraction": set(division_of.CHECKS),
}


@pytest.mark.parametrize(("step", "missing"), STEPS.items())
def test_each_item_of_a_division_is_what_its_own_step_proves(monkeypatch, step, missing):
    """With all others proved; and the rest that is asked for saddles is neither region, settled nor about the ring."""
    rate, low = (0.0 if step == "no rate" else 0.1), Fraction(0 if step == "no contraction" else "0.09")
    made, asked = replace(FOUND, rate=rate, lam=(low, Fraction("0.09"))), []
    returning, region, settled, around = (
        np.array([k in some for k in range(7)]) for some in ({0, 1, 2, 3}, {0, 5}, {1}, {2})
    )
    made.__dict__.update(settled=settled, region=None if step == "no region" else region)
    made.__dict__["graph"] = SimpleNamespace(transitions=SimpleNamespace(recurrent=returning))
    factor = {"all stay": 1.0, "not told": None}.get(step, 0.9)
    found = None if step == "lost" else [SimpleNamespace(sink=step == "a sink", factor=factor)] * (step != "none")

    def clusters(map, graph, near, among):
        asked.append(among.tolist())
        return found

    def expansion(map, graph, members, steps, parts):
        asked.append(members.tolist())
        return SimpleNamespace(low={"expansion": 0.05, "just as much": 0.1}.get(step, 0.2) if rate else 0.2)

    monkeypatch.setattr(division_of, "invertible", lambda _: step != "invertible")
    monkeypatch.setattr(division_of, "attracts", lambda *_: {"one": True, "other": step != "core"})
    monkeypatch.setattr(division_of, "expansion", expansion)
    monkeypatch.setattr(division_of, "clusters", clusters)
    monkeypatch.setattr(division_of.Ring, "stretches", lambda *_: step != "ring")
    monkeypatch.setattr(Division, "_around", lambda self, rest: asked.append(rest.tolist()) or around)
    monkeypatch.setattr(Division, "map", None)

    assert {name for name, held in made.checks.items() if held is not True} == missing
    assert made.proved is (not missing)
    if len(missing) < 4:
        kept = [np.flatnonzero(some).tolist() for some in asked]
        assert kept == [[0], [2, 3], [3]]


def test_a_box_is_settled_when_it_is_in_the_core_or_each_of_its_images_is(monkeypatch):
    """Some have one image or two in the core, some one of two outside, some none; the last is there itself."""
    images = {0: [], 1: [True], 2: [True, True], 3: [True, False], 4: [False], 5: [False, True]}
    rows = [(k, held) for k, some in images.items() for held in some]
    recurrent = np.array(
        [True] * 6 + [False, True, False]
    )  # the last is the vertex outside; 6 returns not, 7 is no leaf
    graph = SimpleNamespace(
        recurrent=recurrent, leaf=np.array([True] * 7 + [False]), count=8, cells=None,
        grid=SimpleNamespace(boxes=lambda _: SimpleNamespace(chosen=lambda some: some)),
    )  # fmt: skip
    inside = np.array([held for _, held in rows])
    monkeypatch.setattr(division_of.Parallelograms, "about", lambda some: np.isin(some, [5]))
    monkeypatch.setattr(division_of, "carried", lambda map, sets: (np.array([k for k, _ in rows]), inside))
    some = SimpleNamespace(
        graph=SimpleNamespace(transitions=graph), map=None, core=SimpleNamespace(enters=lambda sets: sets)
    )
    assert np.flatnonzero(Division.settled.func(some)).tolist() == [1, 2, 5]


@pytest.mark.parametrize(
    ("sets", "outside", "at_cycle", "region"),
    [
        ([[0], [2]], False, None, [2, 3]),
        ([[0], [2], [4]], False, None, [2, 3, 4, 5]),
        ([[0, 2]], False, None, [0, 1, 2, 3]),  # it is not settled as a whole
        ([[0]], False, None, None),  # all of it is
        ([[2]], True, None, None),
        ([[2]], False, 3, None),  # a box about the cycle
    ],
)
def test_a_region_is_what_attracting_sets_beside_the_core_lead_to_and_holds_no_box_about_the_cycle(
    sets, outside, at_cycle, region
):
    """From each box walks lead to the next one; boxes 0 and 1 are settled."""
    trapping = lambda i: np.array([any(k in (s, s + 1) for s in sets[i]) for k in range(7)] + [outside])  # noqa: E731
    middle = np.array([0.0 if k == at_cycle else 1.0 for k in range(7)])
    whole = Boxes(np.zeros(7, dtype=int), (middle - 0.1, middle + 0.1), (np.full(7, -0.1), np.full(7, 0.1)))
    graph = SimpleNamespace(
        grid=SimpleNamespace(boxes=lambda some: whole.chosen(np.flatnonzero(some[:-1]))), chosen=lambda found: found
    )
    morse = SimpleNamespace(transitions=graph, attracting=range(len(sets)), sets=sets, trapping=trapping)
    some = SimpleNamespace(graph=morse, settled=np.array([True, True] + [False] * 6))
    found = Division.region.func(some)
    assert (None if found is None else np.flatnonzero(found).tolist()) == region
