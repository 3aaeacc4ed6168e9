"""Sets of starts contain their points and are hardly larger: parallelograms, cores, strips, norms over boxes."""

from dataclasses import replace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic import Scene
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.mean import CORE, HIGH, LOW
from verification.proofs.starts.parallelograms import Parallelograms
from verification.proofs.starts.strips import Strips, steepest
from verification.rigorous.boxes import Boxes

LAM = 0.07126
SIGNS = np.array([(u, v, e, f) for u in (-1, 1) for v in (-1, 1) for e in (-1, 1) for f in (-1, 1)])


@pytest.fixture(scope="module")
def map() -> PinballImages:
    """The cuspless table at a contraction next to `lambda*`."""
    return PinballImages(Scene("cuspless", lam="0.0713"), (LOW, HIGH))


def drawn(seed: int, count: int, size: float = 1.0) -> Parallelograms:
    rng = np.random.default_rng(seed)
    sides, rest = size * rng.uniform(-1, 1, (2, 2, count)), size * rng.uniform(0, 0.3, (2, count))
    return Parallelograms(np.ones(count, dtype=np.int64), rng.uniform(-2, 2, (2, count)), sides, rest)


def corners(sets: Parallelograms) -> np.ndarray:
    """The extreme points of parallelograms, as an array over coordinate, corner and set."""
    u, v, e, f = SIGNS.T[..., None]
    return np.stack([
        sets.middle[k] + u * sets.sides[k, 0] + v * sets.sides[k, 1] + (e, f)[k] * sets.rest[k] for k in (0, 1)
    ])  # fmt: skip


def test_a_parallelogram_reaches_as_far_as_its_corners() -> None:
    sets, rng = drawn(1, 300), np.random.default_rng(2)
    off = corners(sets) - sets.middle[:, None]
    for first, second in ((1.0, 0.0), (0.0, 1.0), (0.3, -2.0), *rng.uniform(-2, 2, (5, 2))):
        true = np.max(np.abs(first * off[0] + second * off[1]), axis=0)
        reach = sets.reach(first, second)
        assert np.all((true <= reach * (1 + 1e-15)) & (reach <= true * (1 + 1e-12) + 1e-14))
    boxes = sets.boxes()
    for at, (low, high) in zip(corners(sets), (boxes.x, boxes.y), strict=True):
        assert np.all((low <= at.min(axis=0)) & (at.min(axis=0) <= low + 1e-12))
        assert np.all((high >= at.max(axis=0)) & (at.max(axis=0) >= high - 1e-12))
    again = Parallelograms.about(boxes).boxes()
    for ours, given in zip((*again.x, *again.y), (*boxes.x, *boxes.y), strict=True):
        assert np.all(np.abs(ours - given) < 1e-12)
    lost = replace(sets, rest=np.where(np.arange(300) % 3 == 0, np.inf, sets.rest))
    assert np.array_equal(lost.known, np.arange(300) % 3 != 0)


@pytest.mark.parametrize("gates", [(), ((0.36, 0.03),)])
def test_a_core_holds_the_sets_all_of_whose_points_it_has(gates: tuple) -> None:
    """Corners and points between them; sets that keep 2 per cent of the width and a bend from its border lie inside."""
    sets, rng, seen = drawn(3, 4000, 1e-4), np.random.default_rng(4), []
    core = replace(CORE, cubic=-0.5, entry_tubes=gates)
    outer, width = gates[0] if gates else core.bounds
    p = lambda x: (core.slope + core.cubic * x**2) * x  # noqa: E731
    theta = rng.uniform(-1.05, 1.05, 4000) * outer
    sets = replace(sets, middle=np.stack([theta, p(theta) + rng.uniform(-1.2, 1.2, 4000) * width]))
    at = corners(sets)
    aside, far = np.max(np.abs(at[1] - p(at[0])), axis=0), np.max(np.abs(at[0]), axis=0)
    inside = (aside <= width) & (far <= outer)
    held = core.enters(sets) if gates else core.holds(sets)
    own = core.holds(sets)
    assert np.array_equal(held, own | core.holds(sets, *gates)) if gates else np.array_equal(held, own)
    assert np.all(inside[held & ~own] if gates else inside[held])
    clear = (aside <= width * 0.98 - 1e-7) & (far <= outer * (1 - 1e-11))
    assert np.all(held[clear])
    assert not np.any(core.enters(replace(sets, chart=1 - sets.chart)))
    seen = [int(np.sum(inside)), int(np.sum(~inside))]
    assert min(seen) > 500


def test_the_parts_of_a_core_cover_its_half_and_hardly_more() -> None:
    """Random displaced points of `theta >= 0`; parts extend beyond by less than a hundredth of the width."""
    core, rng = replace(CORE, cubic=-0.5, cells=100), np.random.default_rng(5)
    for aside in (np.zeros(1), np.array([-2e-3, 1e-3])):
        parts = core.parts(aside)
        assert parts.chart.size == core.cells * aside.size
        x = core.outer * rng.random(3000)
        for k, shift in enumerate(aside):
            y = (core.slope + core.cubic * x**2) * x + shift + core.width * rng.choice([-1, 1, 0.3], 3000)
            cell = k * core.cells + np.minimum((x / core.outer * core.cells).astype(int), core.cells - 1)
            sides, middle, rest = parts.sides[:, :, cell], parts.middle[:, cell], parts.rest[:, cell]
            u = (x - middle[0]) / sides[0, 0]
            assert np.all(np.abs(u) <= 1)
            off = np.abs(y - middle[1] - u * sides[1, 0])
            assert np.all(off <= sides[1, 1] + rest[1] + 1e-15)
            assert np.all(sides[1, 1] + rest[1] < core.width * 1.05)
        assert np.all(parts.sides[0, 1] == 0)
        assert np.all(parts.rest[0] == 0)


def twice(theta: np.ndarray, phi: np.ndarray, chart: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The kernels' derivative of two bounces by arc length and exit angle, and `theta` and component of the end."""
    map, product = PinballMap("cuspless", lam=str(LAM)), np.eye(2)
    for _ in range(2):
        product = map.derivative(theta, phi, chart) @ product
        step = map.step(theta, phi, chart)
        theta, phi, chart = step.theta, step.phi, step.component
    return product, theta, chart


def small_boxes(map: PinballImages, seed: int, size: float) -> tuple[Boxes, np.ndarray, np.ndarray]:
    """Random small boxes on both components, and the coordinates of a point in each."""
    rng, count = np.random.default_rng(seed), 150
    chart = rng.integers(0, 2, count)
    low, high = np.array([c.x for c in map.charts])[chart].T
    x, y = low + (high - low - size) * rng.random(count), rng.uniform(-0.11, 0.11, count)
    boxes = Boxes(chart, (x, x + size), (y, y + size / 3))
    return boxes, x + size * rng.random(count), y + size / 3 * rng.random(count)


def speed(chart: np.ndarray, theta: np.ndarray) -> np.ndarray:
    return np.where(chart == 0, 2 * np.cos(theta / 2), 1.0)


def test_a_bound_of_two_bounces_holds_the_kernels_norm_and_is_near_it(map) -> None:
    """In the norm `max(abs(ds), abs(dphi)/weight)`, where `phi` counts `weight` times in row sums."""
    for size, weight, most in ((1e-4, 0.05, 1.05), (4e-3, 0.3, 2.0)):
        boxes, theta, phi = small_boxes(map, 6, size)
        found = steepest(map, boxes, 2, weight)
        m = np.abs(twice(theta, phi, boxes.chart)[0])
        true = np.maximum(m[:, 0, 0] + weight * m[:, 0, 1], m[:, 1, 0] / weight + m[:, 1, 1])
        assert np.all(true <= found * (1 + 1e-12))
        finite = np.isfinite(found)
        assert np.mean(finite) > 0.9
        assert np.median(found[finite] / true[finite]) < most


def test_the_measure_of_a_strip_is_a_little_more_than_its_integral(map) -> None:
    """The integral of `cos(eta)*ds*deta`, by sums over 60 by 60 midpoints."""
    rng, count = np.random.default_rng(8), 60
    chart = rng.integers(0, 2, count)
    left, wide = rng.uniform(-0.6, 0.5, count), rng.uniform(0.01, 0.1, count)
    middle, half = rng.uniform(0.05, 1.4, count), rng.uniform(0.01, 0.04, count)
    leans = rng.uniform(-0.1, 0.1, (2, count))
    found = Strips(chart, left, left + wide, *leans, middle, half).measures(map)
    share = (np.arange(60) + 0.5) / 60
    u = half * (2 * share[:, None, None] - 1)
    low, high = left + leans[0] * u, left + wide + leans[1] * u
    theta = low + (high - low) * share[:, None]
    true = np.mean((high - low) * 2 * half * np.cos(middle + u) * speed(chart, theta), axis=(0, 1))
    assert np.all(true <= found)
    steeper = np.cos(np.maximum(middle - half, 0)) / np.cos(middle)
    assert np.all(found <= true * steeper * (1.05 + 5 * wide))
