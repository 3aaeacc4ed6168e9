"""Small steps of proofs, each by itself: cells, cones, strips and bounds that a fresh sample of mutants left unseen."""

from fractions import Fraction
from math import cos, sin
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb

from verification.arithmetic.arrays import BallArray
from verification.proofs.corner import half_return
from verification.proofs.corner.border_collision import Expansion, _strip
from verification.proofs.corner.half_return import Step
from verification.proofs.global_dynamics.boxes import Chart
from verification.proofs.global_dynamics.graph import Grid
from verification.proofs.manifolds import enclosed
from verification.proofs.periodic.bifurcation import _nonzero
from verification.proofs.starts import division
from verification.proofs.starts.division import Ring


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_boxes_hold_their_cells_with_exact_ends(scale):
    """In rationals: columns and rows that are no powers of two, on charts large and small."""
    rng = np.random.default_rng(1)
    for columns, rows in ((7, 3), (48, 36), (100, 10)):
        ends = [tuple(sorted(rng.uniform(-scale, scale, 2).tolist())) for _ in range(2)]
        grid = Grid((Chart("one", *ends),), columns, rows)
        cells = grid.whole()
        boxes = grid.boxes(cells)
        for (low, high), count, first, (left, right) in (
            (ends[0], columns, cells.column, boxes.x),
            (ends[1], rows, cells.row, boxes.y),
        ):
            step = (Fraction(high) - Fraction(low)) / count
            for k, a, b in zip(first.tolist(), left.tolist(), right.tolist(), strict=True):
                assert Fraction(a) < Fraction(low) + k * step
                assert Fraction(low) + (k + 1) * step < Fraction(b)


def test_a_number_is_not_0_where_its_ball_is_finite_and_holds_no_0():
    assert _nonzero(arb(2, 1)) is True
    assert _nonzero(arb(-2, 1)) is True
    for unknown in (arb(0), arb(1, 2), arb("inf"), arb("-inf"), arb("nan")):
        assert _nonzero(unknown) is None


@pytest.mark.parametrize("good", [(1, -1), (1,), (-1,), ()])
def test_a_ring_stretches_where_both_of_its_parts_do(monkeypatch, good):
    """Each part is known by the sign of its places."""
    ring = Ring(0.1, 0.2, 0.0, 0.0, 0.1, 0.1, 1.001)

    def derivative(map, boxes):
        side = 1 if np.all(boxes.x[0] > 0) else -1
        one, none = (BallArray(np.full(boxes.chart.size, x), np.zeros(boxes.chart.size)) for x in (1.0, 0.0))
        return (one * (2.0 if side in good else 0.5), none), (none, one * 0.1)

    monkeypatch.setattr(division, "derivative", derivative)
    assert ring.stretches(None, 0) is (good == (1, -1))


def test_the_width_of_a_strip_is_measured_across_its_longest_diagonal():
    """Of a rhombus, turned and moved: its diagonals."""
    for angle, shift in ((0.0, (0.0, 0.0)), (0.7, (3.0, -1.0)), (2.0, (-5.0, 4.0))):
        along, across = (cos(angle), sin(angle)), (-sin(angle), cos(angle))
        tips = [(2.0, 0.0), (0.0, 0.25), (-2.0, 0.0), (0.0, -0.5)]
        points = [tuple(s + u * a + v * b for s, a, b in zip(shift, along, across, strict=True)) for u, v in tips]
        length, width = _strip(points)
        assert length == pytest.approx(4, abs=1e-8)
        assert width == pytest.approx(0.75, abs=1e-8)
        assert length > 4
        assert width > 0.75


@pytest.mark.parametrize(
    ("inside", "v", "told"), [(True, -1, True), (True, 0, None), (True, 1, None), (False, -1, None)]
)
def test_a_fixed_point_is_on_the_arc_where_it_is_inside_and_below_the_border(monkeypatch, inside, v, told):
    monkeypatch.setattr(half_return, "holds", lambda region, cycle: inside)
    made = Step((0.0, 1.0), [], Expansion((arb(0), arb(1)), arb(1), arb(2)), (arb(0), arb(v)))
    assert made.saddle is told


@pytest.mark.parametrize(("unstable", "factor"), [(True, 2), (False, Fraction(1, 2))])
def test_errors_shrink_by_a_power_of_the_factor_with_each_round_outwards(unstable, factor):
    """Of one bounce a round, to the order 1: a quarter a round, so a sixteenth for the one after the next."""
    factor = arb(Fraction(factor).numerator) / Fraction(factor).denominator
    made = SimpleNamespace(unstable=unstable, factor=factor, order=1)
    (found,) = enclosed.bounds(made, [(0, arb(1), arb(8), arb(32))], [arb(1)])
    assert found.contains(1 + 8 / 4 + 32 / 16)
    assert found.upper() < 5 + 1e-6
