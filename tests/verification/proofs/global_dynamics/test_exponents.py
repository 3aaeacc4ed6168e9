"""A lower bound for the larger exponent: below what orbits show, and never positive where a cycle attracts."""

from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics.boxes import BallArray, Boxes
from verification.proofs.global_dynamics.graph import Grid, morse_graph, refined
from verification.proofs.global_dynamics.images import PinballImages, Slopes
from verification.proofs.global_dynamics.regions import Derivatives, _factors, expansion


def regions(scene, columns=512, rows=128, lam=None):
    """The map, its Morse graph, and the trapping regions about attracting sets."""
    map = PinballImages(scene, lam)
    graph = morse_graph(refined(map, Grid(map.charts, columns, rows), 4))
    return map, graph, [graph.trapping(index) for index in graph.attracting]


@pytest.mark.parametrize("scene", [Scene("egg", alpha="0.08", lam="1/2"), Scene("cuspless", lam="0.3")])
def test_the_derivative_over_a_small_box_is_that_of_the_map(scene):
    map, h = PinballImages(scene), 1e-5
    theta, phi = np.linspace(-1.9, 1.9, 60), np.linspace(-0.9, 0.9, 60) * map.top
    boxes = Boxes(np.zeros(60, dtype=np.int64), (theta - 1e-6, theta + 1e-6), (phi - 1e-6, phi + 1e-6))
    judged = 0
    for piece, slopes in map.derivatives(boxes):
        on = piece.on
        for dx, dy, along in ((h, 0, slopes.by_theta), (0, h, slopes.by_phi)):
            a, b = (map.map.step(theta[on] + s * dx, phi[on] + s * dy, 0) for s in (-1, 1))
            near = piece.smooth & (a.component == b.component) & (np.abs(b.theta - a.theta) < 1)
            moved = ((b.theta - a.theta) / (2 * h))[near]
            turned = ((b.phi - a.phi) / (2 * h))[near]
            law = -float(scene.lam) * (slopes.bend_there * along - slopes.bend_here * bool(dx) + bool(dy))
            judged += int(near.sum())

            assert np.all(np.abs(moved - along.m[near]) < 1e-3 * (1 + np.abs(moved)))
            assert np.all(np.abs(turned - law.m[near]) < 1e-3 * (1 + np.abs(turned)))
    assert judged > 100


@pytest.mark.parametrize("lam", ["0.09", "0.12", "0.2"])
def test_every_orbit_near_the_cuspless_attractor_has_a_positive_exponent(lam):
    map, graph, (block,) = regions(Scene("cuspless", lam=lam))
    low = expansion(map, graph.transitions, block, parts=4).low
    sampled = PinballMap("cuspless", lam=lam).exponents(np.full(5, 2.09), np.linspace(0.033, 0.037, 5), 4000, 200)

    assert 0 < low < np.min(sampled.nu_plus[sampled.nu_plus > 0.01])


def test_a_vector_stays_in_the_cones_along_an_orbit_and_grows_by_more_than_the_bound():
    map, graph, (block,) = regions(Scene("cuspless", lam="0.12"))
    found, grid, bounces = expansion(map, graph.transitions, block, parts=4), graph.transitions.grid, 300
    cells = graph.transitions.chosen(block)
    box = grid.painted(cells, np.arange(cells.chart.size), -1)
    orbit = PinballMap("cuspless", lam="0.12").orbit(2.09, 0.035, bounces + 50)
    chart, theta, phi = (field[50:] for field in (orbit.component, orbit.theta, orbit.phi))
    low, high = (np.array([c.x[i] for c in map.charts])[chart] for i in (0, 1))
    column, row = (theta - low) / (high - low) * grid.columns, (phi + map.top) / (2 * map.top) * grid.rows
    where = box[chart, np.minimum(column.astype(int), grid.columns - 1), row.astype(int)]
    slope, grown = float(found.cones[0][where[0]]), 0.0
    for i in range(bounces):
        point = Boxes(chart[i : i + 1], (theta[i : i + 1],) * 2, (phi[i : i + 1],) * 2)
        ((_, at),) = [(piece, slopes) for piece, slopes in map.derivatives(point) if piece.on.size]
        factor = float(at.by_theta.m[0] + at.by_phi.m[0] * slope)
        slope = -0.12 * float(at.bend_there.m[0] * factor - at.bend_here.m[0] + slope) / factor  # d phi1 / d theta1
        grown += np.log(abs(factor))

        assert found.cones[0][where[i + 1]] - 1e-9 <= slope <= found.cones[1][where[i + 1]] + 1e-9
    assert grown / bounces > found.low


def test_the_bound_holds_for_a_range_of_contractions_at_once():
    map, graph, (block,) = regions(Scene("cuspless", lam="0.12"), 512, 256, (Fraction("0.12"), Fraction("0.121")))

    assert expansion(map, graph.transitions, block, parts=4).low > 0


@pytest.mark.parametrize(
    ("scene", "rows"),
    [
        (Scene("cuspless", lam="0.05"), 128),
        (Scene("egg", alpha="0.08", lam="1/2"), 256),
        (Scene("circle", lam="1/2"), 64),
    ],
)
def test_no_orbit_is_said_to_be_unstable_where_a_cycle_attracts_or_is_neutral(scene, rows):
    map, graph, blocks = regions(scene, 256 if scene.name == "circle" else 512, rows)
    lows = [expansion(map, graph.transitions, block).low for block in blocks]

    assert min(lows) <= 0
    if scene.name == "egg":  # both cycles of period 3 attract
        assert sorted(low > 0 for low in lows)[:2] == [False, False]


def test_a_set_in_which_a_walk_ends_is_refused():
    map, graph, (block,) = regions(Scene("cuspless", lam="0.12"), 256, 64)
    last = np.flatnonzero(block)[:1]
    alone = np.zeros_like(block)
    alone[last] = True
    if graph.transitions.edges[last[0], last[0]]:
        pytest.fail("the box chosen is fixed; choose another")

    with pytest.raises(ValueError, match="no edge within the set"):
        expansion(map, graph.transitions, alone)


def test_a_box_that_may_shrink_vectors_to_nothing_bounds_no_exponent():
    """Of four boxes that stretch `theta` by 1.5 to 2.5, by -0.1 to 0.3, by what is not known, and by 3."""
    stretch = BallArray(np.array([2.0, 0.1, 1.0, 3.0]), np.array([0.5, 0.2, np.inf, 0.0]))
    none = BallArray(np.zeros(4), np.zeros(4))
    found = Derivatives(np.arange(4), np.zeros(4, dtype=np.int64), Slopes(stretch, none, none, none, none))

    least = _factors(found, (np.zeros(4), np.zeros(4)), 4)

    assert np.allclose(np.exp(least), [1.5, 0, 0, 3])
    assert least[0] < np.log(1.5)
