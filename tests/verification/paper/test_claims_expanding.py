"""The judges of how the egg's attractor expands: what each step is worth, and cycles that lie beyond the barriers."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from numeric import PinballMap
from symbolic import Scene
from symbolic.expressions.signs import Outcome
from verification.paper.claims.claim import Verdict
from verification.paper.egg import expanding
from verification.paper.egg.barriers import barrier
from verification.paper.report.report import catalogue
from verification.proofs.global_dynamics.barrier import Barrier

CLAIMS = {claim.id: claim for claim in catalogue()}
SINGLE, GROWS = CLAIMS["egg.single_expands"], CLAIMS["egg.attractor_expands"]
CACHED = ("saddle", "kept", "ceiling", "expands", "several")


@pytest.fixture(autouse=True)
def _anew():
    """Each test works the proofs out for itself and leaves none behind."""
    forget = [getattr(expanding, name).cache_clear for name in CACHED]
    for clear in forget:
        clear()
    yield
    for clear in forget:
        clear()


def test_what_attracts_is_not_single_in_a_window_and_what_is_kept_expands():
    assert expanding.single_expands(SINGLE).verdict is Verdict.CORRECTED
    assert expanding.attractor_expands(GROWS).verdict is Verdict.SUPPORTED
    reach = expanding.reach()
    for lam in reach:  # a second method: what orbits from `phi = 0` come to in 3000 bounces
        map = PinballMap("egg", lam=lam, alpha="0.08")
        seen = np.max(np.abs(map.orbit(np.linspace(-3, 3, 400), np.zeros(400), 3000).phi))
        assert seen < np.max(barrier(lam).heights)
        assert reach[lam] < np.max(barrier(lam).heights)


def test_cycles_beyond_the_barriers_are_not_counted(monkeypatch):
    """Two cycles of period 9 attract at 0.493, and one that is followed there from 0.5054 repels: none is kept."""
    changed = {"WINDOW": "0.493", "PERIOD": 9, "COUNT": 2, "SADDLE": "0.493", "STOPS": ("0.43", "0.46")}
    for name, value in changed.items():
        monkeypatch.setattr(expanding, name, value)
    monkeypatch.setattr(expanding, "ceiling", lambda *_: 0.0)
    assert len(expanding.cycles(expanding.egg("0.493", expanding.STARTS), 9)) == 2
    assert expanding.kept() == ()
    assert expanding.saddle() is None
    assert set(expanding.reach().values()) == {0.0}
    assert expanding.several().outcome is expanding.expands().outcome is Outcome.UNKNOWN
    assert expanding.single_expands(SINGLE).verdict is Verdict.OPEN


def test_one_cycle_found_twice_is_no_two(monkeypatch):
    one, *_ = expanding.kept()
    turned = one._replace(x=(one.x[0] + 2 * np.pi, one.x[1] + 2 * np.pi))
    for some in ((one, one, one), (one, turned, turned), (one,)):
        monkeypatch.setattr(expanding, "kept", lambda some=some: some)
        expanding.several.cache_clear()
        assert expanding.several().outcome is Outcome.UNKNOWN


@pytest.mark.parametrize("bound", [np.inf, 0.255, 0.195])
def test_without_an_upper_bound_below_what_is_reached_nothing_expands(monkeypatch, bound):
    """0.195 is below what is reached at 0.641 and above what is at 0.506: both steps are asked."""
    monkeypatch.setattr(expanding, "ceiling", lambda *_: bound)
    assert expanding.expands().outcome is Outcome.UNKNOWN
    assert expanding.single_expands(SINGLE).verdict is not Verdict.CORRECTED


def test_where_no_barrier_is_there_is_no_upper_bound(monkeypatch):
    monkeypatch.setattr(expanding, "Barrier", lambda scene, lam: Barrier(Scene("egg", alpha="0.08"), lam, 256))
    assert expanding.ceiling("0.43", "0.5") == np.inf


def test_chaotic_orbits_that_reach_no_further_support_nothing(monkeypatch):
    monkeypatch.setattr(expanding.crises, "extent", lambda _: SimpleNamespace(height=0.15))
    assert expanding.attractor_expands(GROWS).verdict is Verdict.OPEN


def test_bounds_are_printed_outwards():
    assert (expanding.down(0.18796), expanding.up(0.18841), expanding.up(np.inf)) == ("0.1879", "0.1885", "nothing")


def test_bounds_serve_from_the_first_contraction_to_a_stop_below():
    stops = [Fraction(stop) for stop in expanding.STOPS]
    for lam in expanding.reach():
        stop, most = expanding.before(lam)
        assert Fraction(stop) in stops
        assert Fraction(stop) < Fraction(lam)
        assert most >= expanding.ceiling(*expanding.STOPS[:2])
