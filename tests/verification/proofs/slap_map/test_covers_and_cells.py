"""Boxes of cosines and shapes that are covered, stretches that touch, and how many cells a matrix may have."""

from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from scipy.sparse import csc_matrix

from symbolic.cycles.cardioid_slap import branch
from symbolic.expressions.text import load
from verification.arithmetic.balls import FLOAT64
from verification.proofs.slap_map import exponent, transfer
from verification.proofs.slap_map.candidate import Residual
from verification.proofs.slap_map.transfer import Inverted, Variation


def test_stretches_are_one_where_they_touch_on_one_component_with_one_sign():
    for second, joined in (
        ((0, 0.5, 0.75, 1), [(0, 0.25, 0.75)]),
        ((0, 0.375, 0.5, 1), [(0, 0.25, 0.5)]),
        ((0, 0.375, 0.4375, 1), [(0, 0.25, 0.5)]),  # within
        ((0, 0.5 + 2.0**-50, 0.75, 1), None),
        ((0, 0.5, 0.75, -1), None),
        ((1, 0.5, 0.75, 1), None),
    ):
        first = (0, 0.25, 0.5, 1)
        assert exponent._joined([first, second]) == (joined or [first[:3], second[:3]])
    assert exponent._joined([]) == []


def centres(monkeypatch, answer):
    """Distances and slope at a box of cosines and of shapes are `answer(c, shape)`; told are the boxes asked for."""
    asked = []
    monkeypatch.setattr(exponent, "load", lambda *_: lambda c, shape: asked.append((c, shape)) or answer(c, shape))
    return asked


@pytest.mark.parametrize(
    ("far", "k", "slope", "enough"),
    [
        (0.5, 0, 0, True),
        (0, 0.5, 0, True),
        (0, -0.5, 0, True),
        (0, 0, -0.5, True),
        (0, 0, 0, None),
        (-1, 0, 0.5, None),
        (arb(0.5, 0.5), arb(0.5, 0.5), arb(-0.5, 0.5), None),
        (-1, arb(-0.5, 0.5), 1, None),
        (-1, arb(0, 1), arb(0, 1), None),
    ],
)
def test_one_zero_is_left_where_the_centre_is_far_inside_or_off_the_boundary_or_falls(
    monkeypatch, far, k, slope, enough
):
    asked = centres(monkeypatch, lambda *_: [arb(far), arb(k), arb(slope)])
    found = exponent.one_zero(budget=40)
    assert found.proved is enough
    assert found.boxes == (1 if enough else 41)
    assert 1 <= len(asked) <= found.boxes  # those beyond one tenth are counted


def test_all_cosines_and_all_shapes_up_to_one_tenth_are_asked(monkeypatch):
    """In boxes that are short; those of shapes from one tenth on are left out, and each other one is asked once."""
    asked = centres(monkeypatch, lambda c, shape: [arb(0), arb(shape.rad() < 0.01), arb(0)])
    found = exponent.one_zero()
    assert found.proved is True
    short = [(c, shape) for c, shape in asked if shape.rad() < 0.01]
    assert sum(float(c.rad() * shape.rad()) for c, shape in short) == pytest.approx(1.0 * 0.0625 * 7 / 8)
    for c, shape in ((-1, 0), (1, 0), (-1, "0.1"), (1, "0.1"), (0.3, 0.05), (-0.7, "0.0999")):
        assert any(box.contains(arb(c)) and high.contains(arb(shape)) for box, high in short)
    assert all(shape.lower() < 0.1 for _, shape in asked)
    assert exponent.one_zero(budget=found.boxes) == found
    assert exponent.one_zero(budget=found.boxes - 1) == exponent.OneZero(None, found.boxes)


@pytest.mark.parametrize(("shortest", "proved"), [(2.0**-27, True), (2.0**-30, True), (2.0**-31, None)])
def test_boxes_are_halved_until_both_their_sides_are_too_short(monkeypatch, shortest, proved):
    """About one place the answer is known only of a box whose cosines are within `shortest` of its middle."""

    def answer(c, shape):
        here = c.overlaps(arb(0.3)) and shape.overlaps(arb(0.05))
        return [arb(0), arb(not here or c.rad() <= shortest * 1.0001), arb(0)]

    centres(monkeypatch, answer)
    assert exponent.one_zero(budget=2000).proved is proved


def test_a_defect_bounds_an_inverse_when_it_is_below_one_half(monkeypatch):
    """Two cells and floats that lose nothing: of `X = x` for the inverse 2 of all vectors `abs(1 - x/2)` is left."""
    monkeypatch.setattr(transfer, "ulam", lambda cells, sign: csc_matrix(np.diag([0.5, 0.5])))
    for name, value in (("UNIT", 0.0), ("GRAIN", np.inf), ("BLANKET", 1.0)):
        monkeypatch.setattr(transfer, name, value)
    for x, defect, bound in ((2.0, 0.0, 2.0), (1.5, 0.25, 2.0), (3.0, 0.5, None), (1.0, 0.5, None)):
        assert transfer.inverted(2, np.diag([x, x]), -1) == Inverted(2, bound, defect, -1)


@pytest.mark.parametrize("cells", [-2, 0, 1, 3, 4095, 4097, 4098])
def test_cells_are_an_even_number_of_at_most_4096(cells):
    with pytest.raises(ValueError, match="an even number of at most 4096"):
        transfer.launching_points(cells)


def test_the_fewest_and_the_most_cells_have_launching_points(monkeypatch):
    below, above = transfer.launching_points(2)  # landings at 0, -pi/4, and at 0
    middle = np.arctan(np.sqrt(2)) * 4 / np.pi
    quarter = load(branch(False), FLOAT64)(-np.pi / 4)[0] * 4 / np.pi
    assert below == pytest.approx([middle, quarter, 0], abs=1e-11)
    assert above == pytest.approx([middle, 2], abs=1e-11)
    monkeypatch.setattr(transfer, "Branches", lambda bits: lambda landing: (arb(1), arb(1)))
    below, above = transfer.launching_points(4096)
    assert (len(below), len(above)) == (4097, 2049)


@pytest.mark.parametrize(
    ("mass", "width", "items"),
    [
        (arb(0.5), 0.0049, set()),  # a radius of 0.0098, of which 10**-2 is asked
        (arb(0.5), 0.0051, {"precise"}),
        (arb(0), 0.0, {"mass", "precise"}),
        (arb(0, 1), 0.0, {"mass", "precise"}),
    ],
)
def test_an_exponent_is_precise_to_two_digits_fewer_and_its_density_has_a_mass(monkeypatch, mass, width, items):
    made = SimpleNamespace(residual=lambda: Residual(arb(0), arb(0)), mean=lambda: arb(1, width))
    near = SimpleNamespace(grounded=lambda: SimpleNamespace(integral=lambda: mass))
    monkeypatch.setattr(exponent, "Judge", lambda *_: made)
    found = exponent.judged(near, 4, Inverted(1000, 9.0, 0.0, 1), Variation(arb(0.5), arb(1), True))
    assert {item for item, value in found.checks.items() if value is None} == items


def test_a_density_is_at_most_so_far_away_as_the_upper_end_of_what_is_enclosed(monkeypatch):
    made = SimpleNamespace(residual=lambda: Residual(arb(0), arb(0.5, 0.25)), mean=lambda: arb(1))
    near = SimpleNamespace(grounded=lambda: SimpleNamespace(integral=lambda: arb(1)))
    monkeypatch.setattr(exponent, "Judge", lambda *_: made)
    monkeypatch.setattr(exponent, "gap", lambda *_: arb(0.5))
    found = exponent.judged(near, 4, Inverted(1000, 9.0, 0.0, 1), Variation(arb(0.5), arb(1), True))
    assert float(found.distance) == pytest.approx(0.75 / (0.5 * 0.5), rel=1e-6)
