"""Alternating strips of two basins next to the vertical orbit's stable manifold, and refused statements."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb

from numeric import PinballMap
from symbolic.cycles.cycle import cuspless_vertical, trace_and_determinant
from symbolic.tables.table import lam
from verification.paper.egg.basins import alternating
from verification.proofs.starts.alternating import STARTS

FOUND = alternating()
CORE = FOUND.tube


def test_both_basins_come_to_the_stable_manifold_of_the_vertical_orbit() -> None:
    assert FOUND.proved


@pytest.mark.parametrize(
    ("changes", "items"),
    [
        ({"starts": STARTS[::-1]}, {"first", "second"}),  # each goes to the other
        ({"starts": (0.6, 0.6)}, {"second"}),
        ({"starts": (0.9, 0.9)}, {"first"}),
        ({"tube": replace(CORE, outer=0.3)}, {"core"}),  # holds starts that go to the corners
        ({"tube": replace(CORE, inner=0.14)}, {"core"}),
        ({"tube": replace(CORE, cubic=0.3)}, {"core"}),
        ({"lam": Fraction(7, 100)}, {"polygon", "second"}),  # below lambda*
        ({"lam": Fraction(95, 1000)}, {"core"}),  # above lambda_c
    ],
)
def test_what_is_not_so_is_refused(changes: dict[str, object], items: set[str]) -> None:
    assert items <= replace(FOUND, **changes).open.keys()


def test_points_beyond_the_disc_are_refused() -> None:
    for changes in ({"starts": (0.6, 1.2)}, {"side": 2}):
        with pytest.raises(ValueError, match="starts from 0 to 1"):
            replace(FOUND, **changes)


def fates(theta: np.ndarray, phi: float) -> np.ndarray:
    """Whether each particle of the arc ends on the horizontal orbit, in float64."""
    map = PinballMap("cuspless", lam="0.09")
    end = map.orbit(theta, np.full(theta.size, phi), 1500, np.zeros(theta.size, dtype=int))
    return np.asarray(np.all(np.abs(end.theta[-4:]) < 0.15, axis=0) & np.all(np.abs(end.phi[-4:]) < 0.02, axis=0))


def test_the_strips_seen_in_float64_shrink_by_the_multiplier() -> None:
    """Next to the vertical orbit the fate at a distance equals that at the distance divided by the multiplier."""
    trace, det = (x.subs(lam, Fraction(9, 100)) for x in trace_and_determinant(cuspless_vertical()))
    factor = float((abs(trace) + (trace**2 - 4 * det) ** 0.5) / 2)  # of two bounces
    distance = np.geomspace(1e-3, 1e-3 * factor, 60, endpoint=False)
    each = [fates(np.pi / 3 + distance / factor**k, 0.0) for k in range(6)]
    assert 0.2 < np.mean(each[0]) < 0.8
    assert all(np.mean(one == each[0]) >= 0.95 for one in each[1:])


def test_a_bounce_is_in_the_core_when_it_is_in_it_or_in_one_of_its_gates() -> None:
    """A core, and one gate that is longer and thinner; both on the core's component only."""
    core = replace(FOUND.tube, outer=0.4, width=0.01, entry_tubes=((0.5, 0.001),))
    some = replace(FOUND, tube=core)
    for theta, aside, held in ((0.1, 0.0, True), (0.3, 0.005, True), (0.45, 0.0, True), (0.45, 0.005, False),
                               (0.1, 0.02, False), (0.55, 0.0, False), (-0.45, 0.0005, True)):  # fmt: skip
        phi = (core.slope + core.cubic * theta**2) * theta + aside
        for component, inside in ((core.chart, held), (1 - core.chart, False)):
            here = SimpleNamespace(component=component, theta=arb(theta), phi=arb(phi))
            assert some.in_tube(here, here) is inside
