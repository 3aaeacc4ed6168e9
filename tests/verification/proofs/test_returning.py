"""Laws of the cover that says where cycles of the egg can be for small contractions."""

import math

import numpy as np
import pytest
from sympy import Rational

from numeric import PinballMap
from symbolic.tables import egg
from verification.proofs.periodic import returning as cover
from verification.proofs.periodic.returning import _folded, _round, image, returning

SHAPE = Rational(2, 25)
TABLE = egg(3).at(alpha=SHAPE)
THIRD = 2 * math.pi / 3


@pytest.mark.parametrize("low", [0.0, 0.1, 0.31, 0.6, 0.9, 1.02])
def test_balls_of_a_cell_land_in_its_image_and_arrive_within_its_angles(low):
    """300 balls in float64, of which none may land elsewhere; 1e-12 is for their roundings."""
    cell, phi, lam = (low, low + 0.02), (-0.01, 0.03), 0.02
    found = image(TABLE, cell, phi, (lam, lam))
    rng = np.random.default_rng(1)
    map = PinballMap("egg", alpha="0.08", lam=lam)
    step = map.step(rng.uniform(*cell, 300), rng.uniform(*phi, 300))
    turned = np.remainder(step.theta + THIRD / 2, THIRD) - THIRD / 2
    where = np.abs(turned)
    inside = [(lo - 1e-12 <= where) & (where <= hi + 1e-12) & (np.sign(turned) == s) for lo, hi, s in found.stretches]

    assert np.all(np.any(inside, axis=0))
    eta = -step.phi / lam
    assert np.all((eta >= found.incidence[0] - 1e-12) & (eta <= found.incidence[1] + 1e-12))


def test_differences_of_landings_lie_within_the_bounds_of_the_derivative():
    cell, phi, lam = (0.3, 0.32), (-0.01, 0.01), 0.5
    found = image(TABLE, cell, phi, (lam, lam))
    map = PinballMap("egg", alpha="0.08", lam=lam)
    theta, angle, h = np.linspace(*cell, 9), np.linspace(*phi, 9), 1e-6
    along = [map.step(theta + s * h, angle) for s in (1, -1)]
    across = [map.step(theta, angle + s * h) for s in (1, -1)]
    columns = [[(a.theta - b.theta) / (2 * h), (a.phi - b.phi) / (2 * h)] for a, b in (along, across)]
    entries = columns[0][0], columns[1][0], columns[0][1], columns[1][1]

    for values, (low, high) in zip(entries, found.derivative, strict=True):
        assert np.all((low - 1e-6 <= values) & (values <= high + 1e-6))


def test_the_attracting_cycle_lies_where_it_may():
    found = returning(SHAPE, (0.0, 1 / 256))
    map = PinballMap("egg", alpha="0.08", lam=1 / 256)
    orbit = map.orbit(0.3, 0.0, 2000)
    last = np.abs(np.remainder(orbit.theta[-4:] + THIRD / 2, THIRD) - THIRD / 2)

    assert found.proved
    assert all(any(piece.low <= x <= piece.high for piece in found.contracting) for x in last)
    assert any(len(part) == 1 for part in found.repelling)  # the chords between parallel tangents
    assert any(part[0].low == 0 for part in found.repelling)  # the diameters


def test_nothing_is_proved_where_a_diameter_attracts_or_where_the_cover_is_too_coarse(monkeypatch):
    assert returning(Rational(1, 20), (0.0, 1 / 256)).proved is None
    monkeypatch.setattr(cover, "HALVINGS", 3)
    assert returning(SHAPE, (0.0, 1 / 256)).proved is None


def test_a_stretch_over_a_vertex_or_a_flat_point_has_a_mirrored_part():
    assert [(round(low, 6), round(high, 6), sign) for low, high, sign in _folded(0.01, 0.03)] == [
        (0.0, 0.04, 1),
        (0.0, 0.02, -1),
    ]
    (first, second) = _folded(math.pi / 3 - 0.01, 0.03)
    assert first[2] == -second[2]
    assert second[0] == pytest.approx(math.pi / 3 - 0.02)
    assert _folded(-0.5, 0.1)[0][2] == -1


def test_pieces_are_taken_in_the_order_in_which_they_lead_to_each_other():
    assert _round([{2}, {0}, {1}]) == [0, 2, 1]
    assert _round([{0}]) == [0]
    assert _round([{1, 0}, {0}]) == _round([{1}, {1}]) == []
