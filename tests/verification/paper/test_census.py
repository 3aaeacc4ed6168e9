"""Laws of the census: branches end where certified events are, and judges say no more than was seen."""

from dataclasses import replace

import pytest
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.attractors import Kind
from symbolic.cycles.polygons import saddle_node
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables import egg
from symbolic.tables.table import alpha
from verification.named.attractors import branches, coexisting, row
from verification.named.branches import Event
from verification.paper.claims.claim import Verdict
from verification.paper.egg import basins as on_basins
from verification.paper.judges import attractors as on_attractors
from verification.paper.judges import cuspless_chaos as on_chaos
from verification.paper.report.report import catalogue

EGG = egg(3).at(alpha="0.08")
CLAIMS = {claim.id: claim for claim in catalogue()}


@pytest.fixture(scope="module")
def grown():
    """The branches that one contraction leads to, and those that they lead to."""
    map = PinballMap("egg", alpha="0.08", lam=0)
    return list(branches(map, EGG, [row(map.at(0.39), 200, 1)], longest=16))


def test_the_cycles_of_period_3_are_born_at_the_fold_in_closed_form(grown):
    three = next(b for b in grown if b.period == 3)

    assert three.low.event is Event.FOLD
    assert three.low.proved
    assert abs(float(three.low.value) - float(saddle_node().subs(alpha, Rational(2, 25)))) < 1e-11
    assert (three.copies, three.symmetry, three.high.event) == (2, "C3", Event.EDGE)


def test_the_cascade_is_found_doubling_by_doubling_from_one_contraction(grown):
    """The doublings are those of `pinball locate doubling`, found there in another way."""
    flips = {b.period: float(b.high.value) for b in grown if b.high.event is Event.FLIP}

    assert abs(flips[4] - 0.371235502527874) < 1e-12
    assert abs(flips[8] - 0.388761023460750) < 1e-12
    assert abs(flips[16] - 0.392501516486055) < 1e-12


def test_every_doubling_hands_over_where_it_ends(grown):
    born = {b.period: b.low.value for b in grown if b.low.event is Event.HALVED}

    for period, value in born.items():
        assert value == next(b.high.value for b in grown if 2 * b.period == period)


def test_symmetry_is_lost_before_the_period_doubles(grown):
    first, second = sorted((b for b in grown if b.period == 4), key=lambda b: b.low.lam)

    assert (first.symmetry, first.copies, second.symmetry, second.copies) == ("D1", 3, "C1", 6)
    assert first.high.event is second.low.event is Event.PITCHFORK
    assert first.high.value == second.low.value == "0.2877854765032"
    assert all(b.high.proved for b in (first, second))


def test_the_branches_that_attract_are_those_that_starts_reach(grown):
    map = PinballMap("egg", alpha="0.08", lam=0.35)
    seen = {(m.period, m.symmetry, m.copies) for m in row(map, 200, 3).members}

    assert {(b.period, b.symmetry, b.copies) for b in coexisting(grown, 0.35)} == seen == {(4, "C1", 6)}


def test_a_row_accounts_for_every_start():
    found = row(PinballMap("cuspless", lam=0.09), 150, 1)

    assert sum(m.share.count for m in found.members) + found.unsettled == 150
    assert found.attractors == 2


def test_without_attractors_nothing_is_said_of_them(monkeypatch):
    monkeypatch.setattr(on_attractors, "proved_at", lambda *_, **__: Finding(Outcome.UNKNOWN, "no proof"))
    monkeypatch.setattr(on_attractors, "egg", lambda *_: ())
    monkeypatch.setattr(on_basins, "found", lambda *_, **__: ())

    assert on_attractors.higher_periods(CLAIMS["egg.higher_period_attractors"]).verdict is Verdict.OPEN


def test_a_second_attractor_leaves_the_only_one_open(monkeypatch):
    chaos, cycle = found = on_attractors.found("cuspless", "0.09")
    assert {a.kind for a in found} == {Kind.CHAOTIC, Kind.CYCLE}
    monkeypatch.setattr(on_chaos, "found", lambda *_: (chaos, cycle))

    assert on_chaos.only_attractor(CLAIMS["cuspless.only_attractor"]).verdict is Verdict.OPEN
    alone = chaos if chaos.kind is Kind.CHAOTIC else cycle
    whole = replace(alone, share=replace(alone.share, count=on_attractors.STARTS))
    monkeypatch.setattr(on_chaos, "found", lambda *_: (whole,))
    assert on_chaos.only_attractor(CLAIMS["cuspless.only_attractor"]).verdict is Verdict.SUPPORTED
    monkeypatch.setattr(on_chaos, "splits", lambda: Finding(Outcome.UNKNOWN, "a step is missing"))
    assert on_chaos.only_attractor(CLAIMS["cuspless.only_attractor"]).verdict is Verdict.OPEN


def test_grazing_is_left_behind_and_not_approached():
    judgement = on_attractors.whispering_gallery(CLAIMS["map.whispering_gallery"])

    assert judgement.verdict is Verdict.CORRECTED
    assert "pi/2" in judgement.erratum


def test_boxes_of_which_a_third_fate_is_not_excluded_leave_two_basins_open(monkeypatch):
    proved, claim = on_basins.division(), CLAIMS["cuspless.two_basins"]
    assert on_basins.two_basins(claim).verdict is Verdict.CONFIRMED

    monkeypatch.setattr(on_basins, "division", lambda: replace(proved, ring=replace(proved.ring, low=0.17)))
    assert on_basins.two_basins(CLAIMS["cuspless.two_basins"]).verdict is Verdict.OPEN
