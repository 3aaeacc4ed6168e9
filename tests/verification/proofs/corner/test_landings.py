"""The enclosure of a piece's landing contains the landings of its points."""

import random

import pytest
from flint import arb

from verification.arithmetic.balls import working
from verification.proofs.corner import corner
from verification.proofs.corner.corner import ARC, WALL
from verification.proofs.corner.return_map import CusplessMap, Departures


@pytest.mark.parametrize("component", [ARC, WALL])
def test_a_piece_lands_where_its_points_land(component):
    """Points at the ends and inside of the piece, with angles and contractions from the given balls."""
    chance, landed = random.Random(8), 0
    with working(corner.BITS):
        wide, thin = CusplessMap(arb(0.3, 0.02)), [CusplessMap(arb(x)) for x in (0.28, 0.3, 0.32)]
        for _ in range(60):
            at, phi = chance.uniform(-1, 1) * (1.5 if component == ARC else 0.4), chance.uniform(-0.6, 0.6)
            half, spread = 10 ** chance.uniform(-6, -1.7), 10 ** chance.uniform(-6, -2)
            images = wide.landing(Departures(component, arb(at, half), arb(1), arb(phi, spread)))
            if images is None or len(images) > 1:
                continue
            (image,), starts = images, [at + x * half for x in (-0.999, -0.4, 0, 0.7, 0.999)]
            for flights, start in zip(thin * 2, starts, strict=False):
                for leaving in (phi - 0.999 * spread, phi, phi + 0.999 * spread):
                    (point,) = flights.landing(Departures(component, arb(start), arb(1), arb(leaving))) or [None]
                    assert point.component == image.component
                    assert image.theta.contains(point.theta)
                    assert image.slope.contains(point.slope)
                    assert image.phi.contains(point.phi)
            landed += 1
            if spread < half / 50 and half < 1e-3:
                assert image.theta.rad() < 1.3 * abs(image.slope).upper() * half
    assert landed > 30
