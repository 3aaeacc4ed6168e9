"""Three regions about the diameters of the egg, and the crisis in which they merge: verdicts, and what is refused."""

from fractions import Fraction

import numpy as np
import pytest

from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.scene import Scene
from verification.paper.claims.claim import Verdict
from verification.paper.egg import merging
from verification.paper.report.report import catalogue
from verification.proofs.global_dynamics.apart import kept_apart
from verification.proofs.global_dynamics.images import PinballImages

CLAIMS = {claim.id: claim for claim in catalogue()}
THREE, CRISIS = CLAIMS["egg.three_attractors"], CLAIMS["egg.merging_crisis"]
UNKNOWN = Finding(Outcome.UNKNOWN, "no proof")
PROVED = Finding(Outcome.PROVED, "a proof")
COARSE = (3072, 1024, 2)


def test_three_regions_are_apart_up_to_the_crisis_and_hold_more_than_three_attractors_in_a_window(monkeypatch):
    """Without the regions nothing is proved in the place of the printed number of attractors."""
    found = merging.three(THREE)
    assert found.verdict is Verdict.CORRECTED
    assert "six cycles of period 20" in found.printed.reason

    monkeypatch.setattr(merging, "apart", lambda: UNKNOWN)
    assert merging.three(THREE).verdict is Verdict.REFUTED
    monkeypatch.setattr(merging, "proved_at", lambda *_: UNKNOWN)
    assert merging.three(THREE).verdict is Verdict.OPEN


def test_the_merging_crisis_is_bracketed_by_regions_apart_and_an_orbit_that_goes_over(monkeypatch):
    """Nothing is confirmed where the orbit stays, or where the tangency lies outside of the bracket."""
    monkeypatch.setattr(merging, "region", lambda *_: PROVED)
    assert merging.merging_crisis(CRISIS).verdict is Verdict.CONFIRMED
    merging.merges.cache_clear()
    monkeypatch.setattr(merging, "goes_over", lambda *_: False)
    assert merging.merging_crisis(CRISIS).verdict is Verdict.OPEN
    monkeypatch.undo()
    merging.merges.cache_clear()
    monkeypatch.setattr(merging, "region", lambda *_: PROVED)
    monkeypatch.setattr(merging, "LAST", "0.4435")
    assert merging.merging_crisis(CRISIS).verdict is Verdict.OPEN
    merging.merges.cache_clear()


@pytest.mark.parametrize(("lam", "held"), [("0.44345", True), ("0.442", False)])
def test_an_orbit_goes_over_above_the_crisis_and_does_not_from_the_same_start_below(lam, held):
    """The start lies within 0.02 of the diameter; one that lies further out proves nothing."""
    assert merging.goes_over(lam, merging.START) is held
    assert not merging.goes_over(lam, (0.03, 0.0))


@pytest.mark.parametrize(
    ("lam", "grid", "held"),
    [
        (("0.428", "0.429"), COARSE, True),
        (("0.428", "0.429"), (192, 64, 1), False),  # boxes that meet those of another diameter
        (("0.428", "0.429"), (3071, 1024, 2), False),  # a turn by a third is no whole number of columns
        (("0.45", "0.45"), (6144, 4096, 2), False),  # beyond the crisis
        (("0.43", "0.45"), COARSE, False),  # a range with the crisis in it
    ],
)
def test_regions_are_kept_apart_below_the_crisis_and_with_boxes_that_are_small_enough(lam, grid, held):
    """The last of them would be false."""
    assert bool(merging.region(lam, grid)) is held


def test_a_region_that_is_kept_apart_holds_its_start_and_stays_near_both_ends():
    """Of both ends, at 0 and at half a turn, some cells lie next to it, and none is further than 0.6 radians."""
    map = PinballImages(Scene("egg", alpha="0.08"), (Fraction(43, 100), Fraction(43, 100)))
    angles = kept_apart(map, COARSE, merging.about())
    assert angles is not None
    away = np.abs(np.arcsin(np.sin(angles)))
    assert [np.min(away[np.cos(angles) * side > 0]) < 0.01 for side in (1, -1)] == [True, True]
    assert np.max(away) < 0.6
    assert kept_apart(map, COARSE, None) is None


def test_windows_and_chaos_in_turn_lie_in_one_region_and_strange_attractors_may_be_tiny(monkeypatch):
    """Not proved where a cycle is none, or the contractions stand in another order."""
    claim = CLAIMS["egg.windows_above"]
    assert merging.windows(claim).verdict is Verdict.SUPPORTED
    for changed in ((("0.42", 20), ("0.4291", 28)), (("0.42906", 28), ("0.42", 20))):
        merging.alternates.cache_clear()
        merging.region.cache_clear()
        monkeypatch.setattr(merging, "ALONG", changed)
        assert not merging.alternates()
    assert merging.windows(claim).verdict is Verdict.OPEN
    merging.alternates.cache_clear()
    merging.region.cache_clear()
