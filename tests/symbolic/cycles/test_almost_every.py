"""Two rates for almost every orbit of the cardioid: proved, and compared with the numeric map."""

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap
from symbolic.cycles.almost_every import area_bound, two_rates
from symbolic.expressions.signs import Outcome


def test_the_steps_are_proved():
    assert two_rates().outcome is Outcome.PROVED


@pytest.mark.slow
@pytest.mark.parametrize("power", ["13/20", "27/40"])
def test_areas_are_bounded_by_no_other_power(power):
    """At `x = C = 1` both sides are 1, and 2/3 is the slope of the left one."""
    assert area_bound(Rational(power)).outcome is Outcome.UNKNOWN


def starts(particles):
    """`theta` in the middles of equal parts of the wall."""
    return (2 * np.arange(particles) + 1 - particles) * np.pi / particles


def line(lam, phi, particles, bounces):
    """`theta` along the images of a horizontal line, the local stretch factor, and areas in `(|K|*ds, dphi)`."""
    map = PinballMap("cardioid", lam=lam)
    theta, angle = starts(particles), np.full(particles, phi)
    first = np.cos(theta / 2)  # ds is twice that times d(theta), and |K| is 3/4 over it
    vector, area = np.stack([2 * first, 0 * first], axis=1), np.ones(particles)
    images, grown, areas = [], [], []
    for _ in range(bounces):
        matrix = map.derivative(theta, angle)
        vector, area = np.einsum("pij,pj->pi", matrix, vector), area * np.abs(np.linalg.det(matrix))
        landed = map.step(theta, angle)
        theta, angle = landed.theta, landed.phi
        images.append(theta)
        grown.append(np.abs(vector[:, 0]) / (2 * np.cos(theta / 2)))
        areas.append(area * first / np.cos(theta / 2))
    return images, grown, areas


LINES = [(0.1, 0.0), (0.5, 0.3), (0.9, -1.2)]


@pytest.mark.parametrize(("lam", "phi"), LINES)
def test_a_horizontal_line_grows_by_two_at_each_bounce_at_most(lam, phi):
    images, grown, _ = line(lam, phi, 40_000, 6)

    for n, (theta, product) in enumerate(zip(images, grown, strict=True), start=1):
        cuts = np.sum(np.abs(np.diff(theta)) > 0.5)  # on a piece theta moves by less between neighbours, off the cusp
        assert cuts <= 2**n - 1
        assert np.mean(product) <= 1.01 * 2**n


@pytest.mark.parametrize(("lam", "phi"), LINES)
def test_areas_grow_by_the_contraction_times_the_growth_of_lines_at_most(lam, phi):
    images, grown, areas = line(lam, phi, 20_000, 8)
    first = np.cos(starts(20_000) / 2)

    for n, (theta, product, area) in enumerate(zip(images, grown, areas, strict=True), start=1):
        assert np.all(area <= lam**n * product * (first / np.cos(theta / 2)) ** (2 / 3) * (1 + 1e-6))
