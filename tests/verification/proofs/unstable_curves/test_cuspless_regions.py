"""At most one attractor in regions of the cuspless table, at several contractions; two attractors are refused."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from symbolic import Scene
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.unstable_curves.anchor import anchor
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors
from verification.rigorous.boxes import Boxes

SADDLES = {  # a point of an unstable cycle of period 4; half the width of its rectangle, columns and rows
    "0.09": (2.0754578, -0.0348760, 0.003, 1024, 8192),
    "0.1": (2.0657727, -0.0377605, 0.003, 1024, 8192),
    "0.11": (2.0563516, -0.0404772, 0.003, 1024, 8192),
    "0.12": (2.0471862, -0.0430328, 0.006, 1024, 8192),
    "0.13": (2.0382687, -0.0454335, 0.003, 1024, 8192),
    "0.14": (2.0295916, -0.0476851, 0.004, 1024, 8192),
    "0.15": (2.0211482, -0.0497933, 0.005, 960, 8700),
}


def region(lam, besides=()):
    """The statement for the region that grows from the cycle, its mirror image and other points."""
    theta, phi, half, columns, rows = SADDLES[lam]
    points = [(0, theta, phi), (0, -theta, -phi), *besides]
    chart, x, y = (np.array(row) for row in zip(*points, strict=True))
    map = PinballImages(Scene("cuspless"), (Fraction(lam),) * 2)
    return NoTwoAttractors(map, columns, rows, Boxes(chart, (x, x), (y, y)), (0, theta, phi), 4, half)


@pytest.mark.slow
@pytest.mark.parametrize("lam", SADDLES)
def test_the_cuspless_table_has_no_two_attractors(lam):
    found = region(lam)
    assert found.proved, found.reason
    _, theta, phi = found.saddle
    other = anchor(found.region, (0, -theta, -phi), 4, found.half)  # so the region holds the cycle's mirror image
    assert (other.low, other.high) == (-found.anchor.high, -found.anchor.low)


def test_on_coarser_cells_it_is_not_proved_and_nothing_is_said():
    coarse = replace(region("0.12"), columns=512, rows=512)
    assert not coarse.proved
    assert coarse.open


@pytest.mark.slow
def test_a_region_that_holds_the_cycle_of_period_2_besides_is_refused():
    """At 0.09 that cycle attracts too: both its multipliers lie inside the unit circle."""
    both = region("0.09", ((0, 0.0, 0.0), (1, 0.0, 0.0)))
    assert not both.proved
    assert both.checks["cones"] is None or both.checks["growth"] is None
