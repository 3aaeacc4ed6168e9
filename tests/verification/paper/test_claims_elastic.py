"""Canaries: the judges of the egg's elastic cycles, driven to other verdicts by other facts."""

import pytest
from sympy import Integer

from symbolic.cycles.resonance import flat_triangle
from verification.paper.claims.claim import Verdict
from verification.paper.egg import elastic as on_elastic_cycles
from verification.paper.report.report import catalogue

CLAIMS = {claim.id: claim for claim in catalogue()}


def verdict(judge, name: str) -> Verdict:
    return judge(CLAIMS[name]).verdict


def test_elliptic_and_hyperbolic_points_alternate_and_islands_surround_the_elliptic_ones():
    assert verdict(on_elastic_cycles.alternating, "egg.alternating_points") is Verdict.CONFIRMED
    assert verdict(on_elastic_cycles.bias, "egg.period3_bias") is Verdict.CONFIRMED
    assert verdict(on_elastic_cycles.period3_islands, "egg.period3_islands") is Verdict.CONFIRMED


def test_a_vertex_triangle_that_were_elliptic_would_not_alternate(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(on_elastic_cycles, "elastic_trace", lambda at_flat: Integer(1))

    assert verdict(on_elastic_cycles.alternating, "egg.alternating_points") is Verdict.REFUTED


def test_a_triangle_that_left_the_circle_at_second_order_would_show_no_bias(monkeypatch: pytest.MonkeyPatch):
    _, twist, drift = flat_triangle()
    monkeypatch.setattr(on_elastic_cycles, "flat_triangle", lambda: (Integer(2), twist, drift))

    assert verdict(on_elastic_cycles.bias, "egg.period3_bias") is not Verdict.CONFIRMED


@pytest.mark.parametrize(("place", "wrong"), [(1, 0), (0, -1), (2, 1)])  # of trace, twist and drift
def test_no_island_is_proved_without_twist_at_a_resonance_or_where_area_is_lost(
    place: int, wrong: int, monkeypatch: pytest.MonkeyPatch
):
    right = flat_triangle()
    facts = (*right[:place], Integer(wrong), *right[place + 1 :])
    monkeypatch.setattr(on_elastic_cycles, "flat_triangle", lambda: facts)

    assert verdict(on_elastic_cycles.period3_islands, "egg.period3_islands") is not Verdict.CONFIRMED


@pytest.mark.parametrize("name", ["egg.chaotic_sea_panels", "egg.transition_to_chaos"])
def test_a_chaotic_sea_is_sampled_and_not_proved(name: str, monkeypatch: pytest.MonkeyPatch):
    assert verdict(on_elastic_cycles.sea, name) is Verdict.SUPPORTED
    monkeypatch.setattr(on_elastic_cycles, "chaotic_shares", lambda shapes: [(shape, 0.1) for shape in shapes])

    assert verdict(on_elastic_cycles.sea, name) is Verdict.OPEN
