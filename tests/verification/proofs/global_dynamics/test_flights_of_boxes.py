"""Flights of small boxes of a table: they contain the kernel's flights of points, and are hardly wider."""

import numpy as np
import pytest

from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import hull
from verification.proofs.global_dynamics.flights import Flights, matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.rigorous.boxes import Boxes

SHARES = np.linspace(-1, 1, 5)
SCENES = [Scene("ellipse", a="3/2", lam="1/2"), Scene("cuspless", lam="0.3"), Scene("egg", alpha="0.08", lam="1/2")]


@pytest.fixture(params=SCENES, ids=lambda scene: scene.name)
def small(request):
    """A map, flights of small boxes, and a grid of points in each box with the kernel's landings."""
    map, h = PinballImages(request.param), 1e-4
    theta = np.array([-1.3, -0.4, 0.3, 1.1, 1.7])
    phi = np.array([0.3, -0.35, 0.1, 0.25, -0.2])
    boxes = Boxes(np.zeros(5, dtype=int), (theta - h, theta + h), (phi - 2 * h, phi + 2 * h))
    along, up = (x[:, :, None] for x in np.meshgrid(SHARES, SHARES))
    at = np.broadcast_arrays(theta + h * along, phi + 2 * h * up)
    landed = map.map.step(*at, np.zeros(at[0].shape, dtype=int))
    assert np.all(landed.component == landed.component[:1, :1])
    return map, Flights(map, boxes), at, landed


def each(values, k):
    return np.asarray(values)[:, :, k]


def landings(made):
    """The nonempty pieces on which the boxes land, each with its arc."""
    return [(piece, hull(piece.low, piece.high)) for piece in made.pieces(*made.arcs()) if piece.on.size]


def test_landings_and_incidences_are_enclosed(small, tight):
    map, made, _, landed = small
    seen = set()
    for piece, _ in landings(made):
        _, theta, eta, phi = made.landing(piece)
        assert phi is None
        for row, k in enumerate(piece.on):
            turn = 2 * np.pi * np.rint((theta.m[row] - each(landed.theta, k)[0, 0]) / (2 * np.pi)) * map.closed
            assert tight(theta[row], each(landed.theta, k) + turn, 1.05)
            assert tight(eta[row], each(landed.eta, k), 1.05)
            assert piece.low[row] < np.min(each(landed.theta, k) + turn)
            assert np.max(each(landed.theta, k) + turn) < piece.high[row]
            seen.add(k)
    assert seen == set(range(5))


def test_the_derivative_over_small_boxes_is_enclosed_and_hardly_more(small):
    """Against difference quotients of the kernel at points."""
    map, made, at, _ = small
    h, chart = 1e-5, np.zeros(at[0].shape, dtype=int)
    ends = [[map.map.step(at[0] + i * s * h, at[1] + (1 - i) * s * h, chart) for s in (1, -1)] for i in (1, 0)]
    truth = [[(getattr(a, name) - getattr(b, name)) / (2 * h) for a, b in ends] for name in ("theta", "phi")]
    for piece, arc in landings(made):
        entries = matrix(made.slopes(piece.on, piece.chart, arc))
        for row, k in enumerate(piece.on):
            for i, j in np.ndindex(2, 2):
                ball, some = entries[i][j][row], each(truth[i][j], k)
                assert np.all(np.abs(some - ball.m) <= ball.r + 1e-8)
                assert ball.r < 0.015
