"""Laws of the cover that says where cycles of the egg can be for small contractions."""

import math

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from numeric import PinballMap
from symbolic.tables import egg
from verification.proofs.periodic import returning as cover
from verification.proofs.periodic.returning import (
    Image,
    Piece,
    _folded,
    _hull,
    _joined,
    _judged,
    _lands_within,
    _leads,
    _once_round,
    _parts,
    _round,
    _runs,
    _spanning,
    image,
    returning,
)

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


@pytest.mark.parametrize(
    ("end", "reach", "held"), [(1, 0.2, True), (1, 0.05, False), (0.95, 0.12, False), (1.05, 0.12, False)]
)
def test_a_landing_lies_within_reach_where_all_angles_are_met_on_either_side(end, reach, held):
    """The chord's angle is `1 - x`, and those of the cell reach from -1/10 to 1/10."""
    zero = arb(0)

    assert _lands_within(lambda _, x: (1 - x, zero), zero, zero, end, reach, (-0.1, 0.1)) is held


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


def thin(*entries):
    """The image of a cell whose derivative is known."""
    return Image((), (0.0, 0.0), tuple((x, x) for x in entries))


def test_what_holds_for_several_images_are_the_outermost_bounds():
    spans = [(0.1, 0.4), (-0.2, 0.3), (0.0, 0.5)]
    assert _spanning(spans) == (-0.2, 0.5)
    joined = _joined([thin(1, 2, 3, 4), thin(0, 5, 3, -1)])
    assert joined.derivative == ((0, 1), (2, 5), (3, 3), (-1, 4))
    assert _runs([3, 4, 5, 9, 10, 12]) == [[3, 4, 5], [9, 10], [12]]


def test_once_round_vectors_of_the_cone_stretch_as_said_and_the_norm_bounds_the_multipliers():
    random, both = np.random.default_rng(1), set()
    for _ in range(200):
        matrices = [np.array([[u * 2, v], [w / 100, x / 100]]) for u, v, w, x in random.uniform(-1, 1, (3, 4))]
        slowest, fastest = _once_round([thin(*m.ravel()) for m in matrices])
        product = matrices[2] @ matrices[1] @ matrices[0]
        wide = 2 * abs(product[1, 0]) + 2.0**-20
        corners = np.array([[1, 1, 1], [wide, 0, -wide]])
        images = product @ corners
        assert max(abs(np.linalg.eigvals(product))) <= fastest * (1 + 1e-9)
        if slowest:
            assert slowest <= np.min(np.abs(images[0])) * (1 + 1e-9)
            assert np.all(np.abs(images[1]) <= wide * np.abs(images[0]) * (1 + 1e-9))
            assert slowest > np.min(np.abs(images[0])) * 0.99 - 1e-6
        norm = max(abs(product[0]) @ (1, wide), abs(product[1]) @ (1 / wide, 1))
        assert fastest == pytest.approx(norm, rel=1e-6)
        both.add((slowest > 1, fastest < 1))
    assert len(both) > 1
    assert _once_round([thin(0.1, -2, 2, 0.1)])[0] == 0  # a quarter turn keeps no such cone
    spread = _once_round([Image((), (0.0, 0.0), ((1.5, 2.5), (-0.1, 0.1), (0, 0), (0, 0)))])
    assert spread[0] == pytest.approx(1.5, abs=1e-4)
    assert spread[1] == pytest.approx(2.5, abs=1e-4)


def test_cells_lead_to_all_cells_that_a_stretch_meets_with_the_angles_of_all_contractions():
    low = Image(((0.05, 0.15, 1), (0.32, 0.34, -1)), (-0.4, 0.2), ((0, 0),) * 4)
    leads = _leads(dict.fromkeys((0, 1, 3, 7), low), (0.25, 0.5), 0.1)

    assert set(leads) == {0, 1, 3, 7}
    for found in leads.values():
        assert set(found) == {0, 1, 3}
        assert found[0] == found[1] == pytest.approx((-0.1, 0.2))  # -lam*eta, for both contractions
        assert found[3] == pytest.approx((-0.2, 0.1))
    twice = Image(((0.05, 0.08, 1), (0.02, 0.04, -1)), (-0.4, 0.2), ((0, 0),) * 4)
    assert _leads({0: twice}, (0.5, 0.5), 0.1)[0][0] == pytest.approx((-0.2, 0.2))
    edge = Image(((0.1, 0.15, 1),), (0.0, 0.1), ((0, 0),) * 4)
    assert set(_leads({0: edge, 1: edge}, (0.5, 0.5), 0.1)[0]) == {0, 1}  # a rounding from the border


def test_parts_are_cells_that_lead_to_each_other_and_a_cell_alone_only_when_it_leads_to_itself():
    leads = {0: {1: (0, 0)}, 1: {0: (0, 0), 5: (0, 0)}, 5: {5: (0, 0)}, 7: {0: (0, 0)}, 8: {9: (0, 0)}, 9: {}}

    assert sorted(map(sorted, _parts(leads))) == [[0, 1], [5]]


@pytest.mark.parametrize(("slope", "repels"), [(1.2, True), (0.8, False), (1.0, None), (-1.2, True), (-0.8, False)])
def test_a_part_repels_or_contracts_by_its_derivative_once_round(slope, repels):
    """Two pieces of two cells each, that lead to each other."""
    images = {k: thin(slope, 0, 0, 0) for k in (2, 3, 6, 7)}
    leads = {k: dict.fromkeys((6, 7) if k < 4 else (2, 3), (0.0, 0.0)) for k in images}
    found = _judged([2, 3, 6, 7], leads, images, 0.1)

    assert (found and found[1]) is repels
    if found:
        assert np.allclose([(piece.low, piece.high) for piece in found[0]], [(0.2, 0.4), (0.6, 0.8)])
    leads[3][2] = (0.0, 0.0)  # then a piece leads to two
    assert _judged([2, 3, 6, 7], leads, images, 0.1) is None


@pytest.mark.parametrize(
    ("wrong", "signs", "slope", "found"),
    [
        ({}, (1, 1), 0.5, True),
        ({}, (-1, -1), -0.5, True),
        ({}, (1, -1), 0.5, False),  # on both sides of a vertex
        ({}, (1, 1), 1.0, False),
        ({"other": (Piece(0.3, 0.4, 0, 0),)}, (1, 1), 0.5, False),  # of another number of pieces
        ({"low": 0.0}, (1, 1), 0.5, False),  # reaches a vertex
        ({"high": math.pi / 3}, (1, 1), 0.5, False),  # or a flat point
        ({"second": 0.28}, (1, 1), 0.5, False),  # the hulls meet
        ({"second": 0.3}, (1, 1), 0.5, False),  # in a point
    ],
)
def test_contracting_parts_have_one_hull_each_where_the_norm_contracts_over_all_of_it(
    monkeypatch, wrong, signs, slope, found
):
    asked = []

    def made(table, cell, phi, lams):
        asked.append((cell, phi))
        sign = signs[0] if cell[0] < 0.25 else signs[1]
        return Image(
            ((0.0, 0.1, sign),) + (((0.0, 0.1, signs[0]),) if cell[0] > 0.25 else ()),
            (0, 0),
            thin(slope, 0, 0, 0).derivative,
        )

    monkeypatch.setattr(cover, "image", made)
    low, second = wrong.get("low", 0.1), wrong.get("second", 0.5)
    parts = [
        (Piece(low, 0.2, 0, 0), Piece(second, 0.6, 0, 0)),
        (Piece(0.15, 0.3, 0, 0), Piece(0.5, wrong.get("high", 0.7), 0, 0)),
    ]
    parts = [*parts, wrong["other"]] if "other" in wrong else parts
    hulls = _hull(parts, TABLE, 0.1, {1: (-0.1, 0.2), 2: (-0.3, 0.1)}, (0.0, 0.1))

    assert (hulls is not None) is found
    if found:
        assert np.allclose([(piece.low, piece.high) for piece in hulls], [(0.1, 0.3), (0.5, 0.7)])
        assert {phi for _, phi in asked} == {(-0.3, 0.2)}
        for piece in hulls:
            assert (piece.least, piece.most) == pytest.approx((slope, slope))
            cells = [cell for cell, _ in asked if piece.low - 1e-9 <= cell[0] and cell[1] <= piece.high + 0.1 + 1e-9]
            assert min(a for a, _ in cells) == pytest.approx(piece.low)
            assert max(b for _, b in cells) >= piece.high - 1e-9
