"""Two rates for almost every orbit of the cardioid: the steps, broken on purpose, and the numeric map beside them."""

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.cycles import almost_every
from symbolic.cycles.almost_every import two_rates
from symbolic.expressions.signs import Outcome


def test_the_steps_are_proved():
    assert two_rates().outcome is Outcome.PROVED


@pytest.mark.parametrize("step", ["growth_defects", "cusp_defects", "shrinking_defects"])
def test_a_step_that_is_no_identity_proves_nothing(monkeypatch, step):
    monkeypatch.setattr(almost_every, step, lambda: [almost_every.y])
    two_rates.cache_clear()
    outcome = two_rates().outcome
    two_rates.cache_clear()

    assert outcome is Outcome.UNKNOWN


def line(lam, phi, particles, bounces):
    """`theta` along the images of a horizontal line, by what it is stretched there, and areas in `(|K|*ds, dphi)`."""
    map = PinballMap("cardioid", lam=lam)
    edges = np.linspace(-np.pi, np.pi, particles + 1)
    theta, angle = (edges[1:] + edges[:-1]) / 2, np.full(particles, phi)
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
def test_areas_grow_by_twice_the_contraction_times_the_growth_of_lines_at_most(lam, phi):
    _, grown, areas = line(lam, phi, 20_000, 8)

    for n, (product, area) in enumerate(zip(grown, areas, strict=True), start=1):
        assert np.all(area <= (2 * lam) ** n * product * (1 + 1e-6))
