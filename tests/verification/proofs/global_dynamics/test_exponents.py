"""Lower bounds for the larger exponent: below those of orbits, and never positive if a cycle attracts."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray, hull
from verification.proofs.global_dynamics.flights import LandingArcs, Slopes
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.global_dynamics.regions import Derivatives, expansion, factors, least_mean, push_slopes
from verification.rigorous.boxes import Chart
from verification.rigorous.graph import Grid, Transitions, morse_graph, refined


def regions(scene, columns=512, rows=128, lam=None):
    """The map, its Morse graph, and the trapping regions about its attracting sets."""
    map = PinballImages(scene, lam)
    graph = morse_graph(refined(map, Grid(map.charts, columns, rows), 4))
    return map, graph, [graph.trapping(index) for index in graph.attracting]


@pytest.mark.slow
@pytest.mark.parametrize("lam", ["0.09", "0.12", "0.2"])
def test_every_orbit_near_the_cuspless_attractor_has_a_positive_exponent(lam):
    map, graph, (block,) = regions(Scene("cuspless", lam=lam))
    bounds = expansion(map, graph.transitions, block, parts=4)
    sampled = PinballMap("cuspless", lam=lam).exponents(np.full(5, 2.09), np.linspace(0.033, 0.037, 5), 4000, 200)
    near = sampled.nu_plus[sampled.nu_plus > 0.01]

    assert 0 < bounds.low < np.min(near)
    assert np.max(near) < bounds.high < 0.6


def test_the_exponent_of_an_attracting_cycle_is_bounded():
    """The horizontal cycle of the cuspless table, against its orbit."""
    map, graph, (block,) = regions(Scene("cuspless", lam="0.05"), 512, 256)
    bounds = expansion(map, graph.transitions, block, parts=4)
    sampled = PinballMap("cuspless", lam="0.05").exponents(np.array([0.01]), np.array([0.0]), 4000, 1000)

    assert bounds.low <= sampled.nu_plus[0] <= bounds.high < 0


@pytest.mark.parametrize(
    ("scene", "rows"),
    [
        (Scene("cuspless", lam="0.05"), 128),
        (Scene("egg", alpha="0.08", lam="1/2"), 256),
        (Scene("circle", lam="1/2"), 64),
    ],
)
def test_nothing_is_unstable_where_a_cycle_attracts(scene, rows):
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

    for some in (alone, np.zeros_like(block)):
        with pytest.raises(ValueError, match="no edge within the set"):
            expansion(map, graph.transitions, some)


def test_a_box_that_may_shrink_vectors_to_nothing_bounds_no_exponent():
    """Four boxes stretch `theta` by 1.5 to 2.5, by -0.1 to 0.3, by an unknown factor, and by 3."""
    stretch = BallArray(np.array([2.0, 0.1, 1.0, 3.0]), np.array([0.5, 0.2, np.inf, 0.0]))
    none = BallArray(np.zeros(4), np.zeros(4))
    found = Derivatives(np.arange(4), np.zeros(4, dtype=np.int64), Slopes(stretch, none, none, none, none))

    least, most = factors(found, (np.zeros(4), np.zeros(4)), 4)

    assert np.allclose(np.exp(least), [1.5, 0, 0, 3])
    assert least[0] < np.log(1.5)
    assert np.allclose(np.exp(most), [2.5, 0.3, np.inf, 3])
    assert most[0] > np.log(2.5)


def random_slopes(random, size, radius=0.0):
    """Six arrays of random balls, with a stretch away from 0."""
    middles = random.uniform(0.5, 1.5, (6, size)) * np.where(random.random((6, size)) < 0.5, -1, 1)
    return Slopes(*(BallArray(m, np.full(size, radius)) for m in middles))


def test_the_least_mean_weight_is_that_of_the_lightest_walk():
    """Against all walks of six steps in a graph with four vertices."""
    edges = [(0, 1), (1, 0), (1, 2), (2, 3), (3, 3), (3, 0), (2, 2)]
    graph = csr_matrix((np.ones(len(edges)), tuple(zip(*edges, strict=True))), shape=(4, 4))
    for weights in np.random.default_rng(2).uniform(-1, 1, (10, 4)):
        walks = [[k] for k in range(4)]
        for _ in range(5):
            walks = [[*walk, b] for walk in walks for a, b in edges if a == walk[-1]]
        least = min(sum(weights[k] for k in walk) for walk in walks) / 6
        assert abs(least_mean(weights, graph, 6) - least) < 1e-12


class Linear:
    """A map of the plane, cut into three boxes side by side, each with one constant matrix."""

    charts = (Chart("plane", (0.0, 3.0), (0.0, 1.0)),)

    def __init__(self, matrices):
        self.matrices = matrices

    def derivatives(self, boxes):
        on = np.arange(boxes.chart.size)
        which = np.floor((boxes.x[0] + boxes.x[1]) / 2).astype(int)
        piece = LandingArcs(on, boxes.chart, *boxes.x, True)
        yield piece, Slopes(*(BallArray(ball.m[which], ball.r[which]) for ball in self.matrices))


@pytest.mark.parametrize("turned", [False, True])
def test_a_bound_holds_for_every_vector_of_a_cone_along_every_walk(turned):
    """Random linear maps on a cycle of three boxes: cones contain their images, and products grow as bounded."""
    random, found = np.random.default_rng(5), 0
    grid, ends = Grid(Linear.charts, 3, 1), (np.array([0, 1, 2]), np.array([1, 2, 0]))
    edges = csr_matrix((np.ones(3, dtype=bool), ends), shape=(4, 4))
    graph, members = Transitions(grid, grid.whole(), np.ones(3, dtype=bool), edges), np.array([True, True, True, False])
    for _ in range(20):
        s = random_slopes(random, 3)._replace(law=BallArray(np.full(3, 0.1), np.zeros(3)))
        s = s._replace(by_theta=BallArray(s.by_theta.m * (4 if not turned else 0.2), np.full(3, 1e-3)))
        bound, product = expansion(Linear(s), graph, members), np.eye(2)
        for k in range(3):
            a, b, here, there, law, drift = (float(x.m[k]) for x in s)
            product = [[a, b], [drift * a - law * (there * a - here), drift * b - law * (there * b + 1)]] @ product
        rate = np.log(max(abs(np.linalg.eigvals(product)))) / 3
        assert bound.low <= rate + 1e-9
        assert bound.high >= rate - 1e-9
        if np.isfinite(bound.low) and not turned:
            found += 1
            low, high = bound.cones
            _, image = push_slopes(s, hull(low, high))
            assert np.all(low[ends[1]] <= image.lower())
            assert np.all(image.upper() <= high[ends[1]])
            assert rate - 1.0 < bound.low < bound.high < rate + 1.0
    assert found > 10 or turned


@pytest.mark.parametrize("cut", [True, False])
def test_nothing_is_bounded_where_walks_go_by_way_of_a_block_that_was_cut(cut):
    """The third box leads back to the first; edges between its parts are not edges of the map."""
    s = Slopes(*(BallArray(np.full(3, x), np.zeros(3)) for x in (2.0, 0.5, 0.5, 0.5, 0.1, 0.0)))
    grid, ends = Grid(Linear.charts, 3, 1), (np.array([0, 1, 0, 2]), np.array([1, 0, 2, 0]))
    edges = csr_matrix((np.ones(4, dtype=bool), ends), shape=(4, 4))
    graph = Transitions(grid, grid.whole(), np.array([True, True, not cut]), edges)
    bound = expansion(Linear(s), graph, np.array([True, True, not cut, False]))
    assert np.isfinite([bound.low, bound.high]).tolist() == [not cut] * 2
