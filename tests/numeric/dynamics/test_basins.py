"""Laws of basins: labels are limits of orbits, smooth boundaries have dimension 1, mixing is as defined."""

import numpy as np
import pytest

from numeric import PinballMap
from numeric.dynamics.attractors import Kind, classify, find
from numeric.dynamics.basins import (
    Window,
    classify_cells,
    fitted,
    image_cells,
    intermingling,
    labels,
    power_laws,
    random_points,
    starts_at,
    uncertainty,
    whole,
)
from numeric.dynamics.phase_points import advanced, embedded
from numeric.dynamics.symmetries import moved, symmetries_of
from numeric.pinball.sampling import phase_grid
from symbolic.tables import egg
from symbolic.tables.geometry import group

RNG = 5


def settled(lam):
    map = PinballMap("egg", alpha="0.08", lam=lam)
    return map, find(map, 200, 1)


def test_a_ball_has_the_label_of_the_cycle_it_ends_on():
    map, found = settled("0.7")
    particles = starts_at(map, *random_points(whole(map), 400, np.random.default_rng(RNG)))

    label = labels(map, particles, found)
    end = embedded(map, advanced(map, particles, 5000).points)
    for index, attractor in enumerate(found):
        points = embedded(map, attractor.points)
        gaps = np.linalg.norm(end[label == index][:, None] - points, axis=2).min(axis=1)
        assert gaps.max() < 1e-8


@pytest.mark.slow
def test_the_quick_labels_are_the_sure_ones():
    map, found = settled("0.66")
    particles = starts_at(map, *random_points(whole(map), 5000, np.random.default_rng(RNG)))

    assert labels(map, particles, found).tolist() == labels(map, particles, found, sure=True).tolist()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("map", "columns", "kept"),
    [
        (PinballMap("cuspless", lam="0.09"), 40, 2),
        (PinballMap("egg", alpha="0.08", lam="0.66"), 42, 6),
        (PinballMap("egg", alpha="0.08", lam="0.66"), 40, 2),  # a third of a turn takes no column to a column
    ],
)
def test_a_cell_is_followed_once_for_all_its_images_and_all_have_the_label_of_their_own_orbits(map, columns, kept):
    cells = phase_grid(map, columns, 30)
    images = [onto for g in symmetries_of(map) if (onto := image_cells(map, cells, g)) is not None]
    label, found = classify_cells(map, cells)
    alone = classify(map, cells.starts.theta, cells.starts.phi, cells.starts.component, known=found)

    assert len(images) == kept
    assert all(np.array_equal(np.sort(onto), np.arange(columns * 30)) for onto in images)
    assert len(alone.attractors) == len(found)
    assert np.mean(label == alone.label) > 0.998  # only at a boundary does rounding decide


@pytest.mark.slow
def test_a_mirror_exchanges_the_basins_of_the_two_ways_round():
    map, found = settled("0.66")
    cycles = [i for i, a in enumerate(found) if a.kind is Kind.CYCLE]
    mirror = next(s for s in group(egg(3).at(alpha="0.08")) if s.sign < 0)
    particles = starts_at(map, *random_points(whole(map), 2000, np.random.default_rng(RNG)))

    label, image = labels(map, particles, found), labels(map, moved(mirror, particles), found)
    exchanged = {cycles[0]: cycles[1], cycles[1]: cycles[0]}
    expected = np.array([exchanged.get(int(i), int(i)) for i in label])
    assert np.mean(expected == image) > 0.998  # only at a boundary does rounding decide


@pytest.mark.slow
@pytest.mark.parametrize("true", [0.05, 0.5, 1.0])
def test_the_exponent_of_a_power_law_is_found_within_its_error(true):
    rng = np.random.default_rng(RNG)
    eps = 10.0 ** -np.arange(1, 5)
    found = fitted(eps, rng.uniform(size=30_000) < 0.5 * (eps[:, None] / eps[0]) ** true, rng)

    assert abs(found.exponent - true) < 3 * found.error < 0.2
    assert abs(found.curvature[0]) < 3 * found.curvature[1]


@pytest.mark.parametrize(("true", "first"), [(0.5, 40), (0.75, 60), (0.25, 200)])
def test_small_counts_do_not_bend_the_exponent(true, first):
    """Means of logarithms of counts above ten are off by 0.32, 0.24 and 0.06 of the error."""
    eps, of, rows = 10.0 ** (-np.arange(7) / 2), 3000, 4000
    counts = np.random.default_rng(RNG).binomial(of, first / of * eps**true, (rows, eps.size))
    slopes = np.array(power_laws(np.log(eps), counts, of))[:, 0]

    assert abs(np.mean(slopes) - true) < 0.1 * np.std(slopes)  # what is left of likelihood at finite counts


def test_a_bent_law_is_seen_to_bend():
    rng = np.random.default_rng(RNG)
    eps = 10.0 ** -np.arange(1.0, 4.0, 0.5)
    share = 0.3 * eps / (eps + 0.01)
    found = fitted(eps, rng.uniform(size=30_000) < share[:, None], rng)

    assert found.curvature[0] < -3 * found.curvature[1]


def test_where_nothing_differs_there_is_no_exponent():
    map = PinballMap("ellipse", a=2, lam="0.5")

    assert np.isnan(uncertainty(map, find(map, 50, 1), 200, 1, distances=(0.1, 0.01)).exponent)


@pytest.mark.slow
def test_basins_of_period_4_have_smooth_boundaries_and_those_after_the_crisis_have_not():
    smooth = uncertainty(*settled("0.2"), 6000, 2, distances=(0.03, 0.01, 0.003))
    mixed = uncertainty(*settled("0.7"), 4000, 2, distances=(1e-3, 1e-5, 1e-7))

    assert abs(smooth.dimension - 1) < 3 * smooth.error
    assert 1.9 < mixed.dimension - 3 * mixed.error < mixed.dimension < 2


def test_a_square_is_mixed_when_it_holds_two_fates():
    map, found = settled("0.7")
    row = intermingling(map, found, [1e-3], 200, 3, Window((-0.2, 0.2), (-0.1, 0.1)))[0]

    assert row.mixed.low > 0.75  # in the middle of what was the chaotic attractor's basin
    assert 0.9 * np.log(2) < row.boundary_entropy < np.log(2)
    assert np.isclose(row.entropy, row.boundary_entropy * row.mixed.count / 200)
