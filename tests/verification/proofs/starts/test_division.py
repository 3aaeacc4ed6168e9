"""Two basins and the set that divides them: the proof at 0.09, orbits that agree, and refused statements."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from symbolic import Scene
from verification.paper.egg.basins import division
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.core import attracts
from verification.proofs.starts.division import ExpandingAnnulus
from verification.rigorous.boxes import Boxes

FOUND = division()
RING, CHART = FOUND.annulus, FOUND.tube.chart


@pytest.mark.slow
def test_almost_every_orbit_at_0_09_goes_to_one_of_two():
    """Random starts agree: each comes to the cycle or into the region, and both occur."""
    assert set(FOUND.checks.values()) == {True}
    map, graph = PinballMap("cuspless", lam="0.09"), FOUND.graph.transitions
    start = interior_starts(map, 1000, 3)
    end = map.exponents(start.theta, start.phi, 3000, 3000, start.component)
    cells = graph.chosen(FOUND.region)
    member = graph.grid.to_array(cells, np.ones(cells.chart.size, dtype=bool)).astype(bool)
    place = []
    for side, value, count in (("x", end.theta, graph.grid.columns), ("y", end.phi, graph.grid.rows)):
        low, high = np.array([getattr(c, side) for c in graph.grid.charts])[end.component].T
        place.append(np.clip(((value - low) / (high - low) * count).astype(int), 0, count - 1))
    kept = member[end.component, place[0], place[1]]
    assert np.array_equal(kept, np.abs(end.theta) > 0.2)
    assert 0.1 < np.mean(kept) < 0.9
    assert np.all(end.nu_plus[~kept] < 0)
    assert np.all(end.nu_plus[kept] > 0)


def test_the_ring_stretches_as_the_kernels_find_it():
    """At the two ends of a part the kernels stretch by 1.0105 and 1.0500 along the ring, the proof a little less."""
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


@pytest.mark.parametrize(("share", "held"), [(0.99, True), (1.01, False)])
def test_growth_is_that_of_the_least_stretched_vector_of_the_cone(share, held):
    """On the ellipse's long axis the kernels give 82 along the ring, and 78.6 at the upper edge of the cone."""
    scene, (low, high) = Scene.of({"parametric": ["cos(theta)", "2*sin(theta)"], "lam": "3/10"}), (-0.6167, -0.4167)
    there, back = PinballMap(scene).derivative(np.array([1, -1]) * np.pi / 2, np.zeros(2))
    (a, b), (c, d) = back @ there
    assert all(low < (c + d * end) / (a + b * end) < high for end in (low, high))
    slope, growth = (low + high) / 2, share * float(min(abs(a + b * end) for end in (low, high)))
    start, end = np.pi / 2 - 1e-4, np.pi / 2 + 1e-4
    ring = ExpandingAnnulus(start, end, slope, -slope * np.pi / 2, 1e-5, (high - low) / 2, growth)
    assert ring.stretches(PinballImages(scene, (Fraction(3, 10),) * 2), 0) is held


@pytest.mark.parametrize("change", [{"low": -0.1}, {"low": 0.3}, {"width": 0.0}, {"cone": -0.1}])
def test_a_ring_without_two_parts_that_are_apart_is_refused(change):
    with pytest.raises(ValueError, match="accepted: 0 <= low < high"):
        replace(RING, **change)


@pytest.mark.parametrize("slope", [RING.slope, -3.0])
def test_boxes_cover_a_part_and_its_points_are_in_it(slope):
    """Random points of a part, on rising and falling lines; points farther off than its width are outside."""
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


def test_points_of_settled_boxes_converge_in_float64():
    graph, map = FOUND.graph.transitions, PinballMap("cuspless", lam="0.09")
    boxes, rng = graph.grid.boxes(graph.cells), np.random.default_rng(2)
    some = rng.choice(np.flatnonzero(FOUND.entering), 3000)
    theta, phi = (low[some] + rng.random(3000) * (high[some] - low[some]) for low, high in (boxes.x, boxes.y))
    end = map.exponents(theta, phi, 1, 3000, graph.cells.chart[some])
    assert np.all(np.abs(end.phi) < 1e-6)


def test_what_is_left_out_is_not_proved():
    """A ring too thin leaves undecided boxes; a bound above the exponents of all orbits is refused."""
    short = replace(FOUND, annulus=replace(RING, width=1e-5), rate=2.0).checks
    assert {name for name, held in short.items() if held is not True} == {"unstable", "saddles"}


def test_a_core_of_no_basin_is_refused():
    """Orbits leave a core of half width 0.18 instead of 0.167, and beyond lambda_c = 0.0934 none converges."""
    assert attracts(FOUND.map, FOUND.tube)["orbits come to the middle"]
    assert not attracts(FOUND.map, replace(FOUND.tube, outer=0.18))["orbits come to the middle"]
    beyond = PinballImages(Scene("cuspless", lam="0.095"), (Fraction(95, 1000),) * 2)
    assert not attracts(beyond, FOUND.tube)["they converge there"]
