"""Sets of starts hold what they are said to hold and hardly more: parallelograms, cores, strips, norms over boxes."""

from dataclasses import replace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic import Scene
from verification.arithmetic.arrays import BallArray
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts import core as core_of
from verification.proofs.starts import strips as strips_of
from verification.proofs.starts.core import Core, derivative
from verification.proofs.starts.mean import CORE, HIGH, LOW
from verification.proofs.starts.parallelograms import Parallelograms
from verification.proofs.starts.strips import Strips, settled, steepest, unsettled

LAM = 0.07126
SIGNS = np.array([(u, v, e, f) for u in (-1, 1) for v in (-1, 1) for e in (-1, 1) for f in (-1, 1)])


@pytest.fixture(scope="module")
def map() -> PinballImages:
    """The cuspless table next to `lambda*`."""
    return PinballImages(Scene("cuspless", lam="0.0713"), (LOW, HIGH))


def drawn(seed: int, count: int, size: float = 1.0) -> Parallelograms:
    rng = np.random.default_rng(seed)
    sides, rest = size * rng.uniform(-1, 1, (2, 2, count)), size * rng.uniform(0, 0.3, (2, count))
    return Parallelograms(np.ones(count, dtype=np.int64), rng.uniform(-2, 2, (2, count)), sides, rest)


def corners(sets: Parallelograms) -> np.ndarray:
    """The extreme points: coordinate, which, set."""
    u, v, e, f = SIGNS.T[..., None]
    return np.stack([
        sets.middle[k] + u * sets.sides[k, 0] + v * sets.sides[k, 1] + (e, f)[k] * sets.rest[k] for k in (0, 1)
    ])  # fmt: skip


def test_a_parallelogram_reaches_as_far_as_its_corners_in_every_direction() -> None:
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


def test_other_sets_take_the_place_of_wider_ones_alone() -> None:
    """One that is not finite takes none; one that is hardly wider along `theta` does, as it keeps directions."""
    one = Parallelograms.about(Boxes(np.zeros(1, dtype=int), (np.zeros(1), np.ones(1)), (np.zeros(1), np.ones(1))))
    for wide, tall, taken in ((0.9, 1, True), (1.4, 1, True), (1.6, 1, False), (1.6, 0.6, True), (1.6, 0.7, False)):
        sides = one.sides * np.array([wide, tall])[:, None, None]
        other = replace(one, sides=sides, middle=one.middle + 5)
        assert bool(one.replaced(np.array([0]), other).middle[0, 0] == 5.5) is taken
        lost = replace(other, rest=np.full((2, 1), np.inf))
        assert one.replaced(np.array([0]), lost).middle[0, 0] == 0.5


@pytest.mark.parametrize("gates", [(), ((0.36, 0.03),)])
def test_a_core_holds_the_sets_all_of_whose_points_it_has(gates: tuple) -> None:
    """Corners and points between them; sets that keep 2 per cent of the width, and a bend, from its border are held."""
    sets, rng, seen = drawn(3, 4000, 1e-4), np.random.default_rng(4), []
    core = replace(CORE, cubic=-0.5, gates=gates)
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
    """Random points of `theta >= 0`, moved aside as said; parts reach beyond by less than a hundredth of the width."""
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


@pytest.mark.parametrize(
    ("entries", "converges"),
    [
        ((0.9, 0.05, 0.05, 0.9), True),
        ((0.9, 0.2, 0.2, 0.9), False),
        ((-0.9, 0.05, -0.05, 0.9), True),
        ((0.5, 10.0, 0.02, 0.5), True),  # 0.5 + sqrt(0.2)
        ((0.5, 10.0, 0.03, 0.5), False),
        ((1.1, 0.0, 0.0, 0.1), False),
        ((np.nan, 0.0, 0.0, 0.1), False),
    ],
)
def test_orbits_of_the_inner_core_converge_where_a_norm_shrinks(monkeypatch, map, entries, converges) -> None:
    """The matrix of the largest absolute values over all parts has its largest eigenvalue below 1."""
    a, b, c, d = (BallArray(np.array([0.0, x]), np.array([abs(x), 0.0])) for x in entries)
    monkeypatch.setattr(core_of, "derivative", lambda *_: [[a, b], [c, d]])
    assert core_of._converges(map, CORE) is converges
    monkeypatch.setattr(core_of, "derivative", lambda *_: None)
    assert not core_of._converges(map, CORE)


def twice(theta: np.ndarray, phi: np.ndarray, chart: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The kernels' derivative of two bounces by arc length and exit angle; and where they end."""
    map, product = PinballMap("cuspless", lam=str(LAM)), np.eye(2)
    for _ in range(2):
        product = map.derivative(theta, phi, chart) @ product
        step = map.step(theta, phi, chart)
        theta, phi, chart = step.theta, step.phi, step.component
    return product, theta, chart


def small_boxes(map: PinballImages, seed: int, size: float) -> tuple[Boxes, np.ndarray, np.ndarray]:
    """On either component, and a point in each."""
    rng, count = np.random.default_rng(seed), 150
    chart = rng.integers(0, 2, count)
    low, high = np.array([c.x for c in map.charts])[chart].T
    x, y = low + (high - low - size) * rng.random(count), rng.uniform(-0.11, 0.11, count)
    boxes = Boxes(chart, (x, x + size), (y, y + size / 3))
    return boxes, x + size * rng.random(count), y + size / 3 * rng.random(count)


def speed(chart: np.ndarray, theta: np.ndarray) -> np.ndarray:
    return np.where(chart == 0, 2 * np.cos(theta / 2), 1.0)


def test_a_bound_of_two_bounces_holds_the_kernels_norm_and_is_near_it(map) -> None:
    """In `max(abs(ds), abs(dphi)/weight)`: rows are summed with `weight` times what `phi` does."""
    for size, weight, most in ((1e-4, 0.05, 1.05), (4e-3, 0.3, 2.0)):
        boxes, theta, phi = small_boxes(map, 6, size)
        found = steepest(map, boxes, 2, weight)
        m = np.abs(twice(theta, phi, boxes.chart)[0])
        true = np.maximum(m[:, 0, 0] + weight * m[:, 0, 1], m[:, 1, 0] / weight + m[:, 1, 1])
        assert np.all(true <= found * (1 + 1e-12))
        finite = np.isfinite(found)
        assert np.mean(finite) > 0.9
        assert np.median(found[finite] / true[finite]) < most


def test_the_derivative_of_two_bounces_over_boxes_holds_that_at_their_points(map) -> None:
    """On the wall about the cycle, from where all land on the arc and come back."""
    rng = np.random.default_rng(7)
    x, y = rng.uniform(-0.3, 0.3, 300), rng.uniform(-0.02, 0.02, 300)
    chart, size = np.ones(300, dtype=np.int64), 1e-3
    boxes = Boxes(chart, (x, x + size), (y, y + size))
    entries = derivative(map, boxes)
    assert entries is not None
    theta, phi = x + size * rng.random(300), y + size * rng.random(300)
    product, _, last = twice(theta, phi, chart)
    assert np.all(last == 1)
    for i in (0, 1):
        for j in (0, 1):
            gap = np.abs(product[:, i, j] - entries[i][j].m)  # the wall's parameter is its arc length
            assert np.all(gap <= entries[i][j].r + 1e-12)
            assert np.median(entries[i][j].r) < 0.05
    across = Boxes(chart, (x + 0.3, x + 0.9), (y, y + size))
    assert derivative(map, across) is None  # these land on both sides of a join


def test_the_measure_of_a_strip_is_a_little_more_than_its_integral(map) -> None:
    """`cos(eta)*ds*deta` by sums of 60 by 60 midpoints."""
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


def flat(count: int) -> Strips:
    """Strips side by side on the wall."""
    left, nought = np.arange(count) * 1e-3, np.zeros(count)
    return Strips(np.ones(count, dtype=int), left, left + 1e-3, nought, nought, nought + 0.5, nought + 1e-3)


def test_a_strip_is_settled_when_each_of_its_images_comes_home(monkeypatch, map) -> None:
    """Strips whose images part in two: one comes to the core at once, the other after a bounce, never, or is lost."""
    home, far, late, lost = range(4)
    place = {home: 0.0, far: 50.0, late: 100.0}
    fates = [(home, home), (home, far), (home, late), (home, lost), (far, far), (lost, home), (late, late), (far, late)]

    def carried(map, sets):
        each = [then(x) for x in sets.middle[0]]
        kinds = np.array([k for some in each for k in some])
        source = np.repeat(np.arange(sets.chart.size), [len(some) for some in each])
        images = sets[source]
        middle = images.middle.copy()
        middle[0] = [place.get(k, 0.0) for k in kinds]
        rest = np.where(kinds == lost, np.inf, 1e-6) * np.ones((2, 1))
        return source, replace(images, middle=middle, rest=rest)

    def then(x):
        return fates[round(x / 1e-3 - 0.5)] if x < 1 else (home,) if x == place[late] else (far,)

    monkeypatch.setattr(strips_of, "carried", carried)
    monkeypatch.setattr(strips_of, "FEW", 0.0)
    monkeypatch.setattr(Core, "enters", lambda self, sets: (sets.middle[0] == 0) & sets.known)
    done, _ = settled(map, CORE, flat(len(fates))._replace(left=flat(9).left[:8] + 1e-9))
    assert done.tolist() == [set(fate) <= {home, late} for fate in fates]


def test_what_is_left_is_the_measure_of_all_strips_that_are_not_settled(monkeypatch, map) -> None:
    """Of both signs of `eta`; strips that are not hopeful are not asked, and count."""
    first, asked = flat(10), []
    whole = 2 * first.measures(map)
    good = np.arange(10) % 2 == 0

    def settles(map, core, some):
        asked.append(some.left.size)
        return some.left > 5e-3, np.zeros(some.left.size, dtype=bool)

    monkeypatch.setattr(strips_of, "hopeful", lambda map, core, some: (good[: some.left.size], ~good[: some.left.size]))
    monkeypatch.setattr(strips_of, "settled", settles)
    left = unsettled(map, CORE, first, 0.0, rounds=1)
    assert left.measure == pytest.approx(np.sum(whole[~(good & (first.left > 5e-3))]), rel=1e-9)
    assert left.measure >= np.sum(whole[~(good & (first.left > 5e-3))])
    assert (left.strips, asked) == (5, [5])
