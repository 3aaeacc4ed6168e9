"""Curves that the map takes below themselves: all orbits below stay below; and false statements are refused."""

from fractions import Fraction

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics.barrier import Barrier, BarrierBreaks, point
from verification.proofs.manifolds.known import SHAPE, boundary
from verification.rigorous.boxes import Boxes

EGG, AT = Scene("egg", alpha="0.08"), Fraction(66, 100)
SINK, CROSSES, AFTER = (-3.0003, 0.4175), 0.7251, Fraction(6623, 10000)


@pytest.fixture(scope="module")
def barrier() -> Barrier:
    return Barrier(EGG, (AT, AT), 4096)


def test_no_orbit_that_begins_below_the_barrier_comes_above_it(barrier):
    """Half a million bounces of the kernel, which uses no boxes, from starts concentrated just below the curve."""
    rng = np.random.default_rng(1)
    columns = rng.integers(0, barrier.columns, 5000)
    theta = (columns + 0.5) / (barrier.columns * barrier.turns) * 2 * np.pi - np.pi
    phi = barrier.heights[columns] - rng.exponential(0.01, 5000)
    orbit = PinballMap("egg", lam="0.66", alpha="0.08").orbit(theta, phi, 100)
    ends = orbit.theta[1:].ravel(), orbit.phi[1:].ravel()

    assert not np.any(barrier.above(Boxes(np.zeros(ends[0].size, dtype=np.int64), *((x, x) for x in ends))))
    assert barrier.between(point(0.3, 0.0)).all()
    assert barrier.above(point(*SINK)).all()


def test_points_of_the_staircase_are_mapped_below_it(barrier):
    """By the kernel, also across the seam; a step that was not tested again after its neighbour rose would show."""
    count, rng = barrier.columns * barrier.turns, np.random.default_rng(2)
    column = np.repeat(np.arange(count), 8)
    share, width = rng.random(column.size), 2 * np.pi / count
    left, (own, before) = column * width - np.pi, (barrier.heights[(column - k) % barrier.columns] for k in (0, 1))
    theta, phi = np.append(left + share * width, left), np.append(own, own + (before - own) * share)
    step = PinballMap("egg", lam="0.66", alpha="0.08").step(theta, phi, np.zeros(theta.size, dtype=int))
    landed = np.floor((step.theta + np.pi) / width).astype(int) % barrier.columns

    assert np.all(step.phi < barrier.heights[landed])


def test_a_barrier_is_lost_where_the_tangency_of_manifolds_is(barrier):
    """The tangency was located and proved by other methods."""
    assert BarrierBreaks(barrier, AFTER, SINK, CROSSES).proved
    assert barrier.lam[0] < Fraction(boundary(SHAPE).near) < AFTER


def test_beyond_the_crisis_no_barrier_is_below_the_triangle():
    """The lowest barrier passes above the triangle."""
    assert not Barrier(EGG, (AFTER, AFTER), 4096).above(point(*SINK)).any()


@pytest.mark.parametrize(
    ("scene", "lam"),
    [(Scene("cuspless"), AT), (EGG, Fraction(0)), (Scene("egg", law="-lam*sin(eta)", alpha="0.08"), AT)],
)
def test_other_tables_maps_and_laws_are_refused(scene, lam):
    with pytest.raises(ValueError, match="barrier: "):
        _ = Barrier(scene, (lam, AT), 64).heights
