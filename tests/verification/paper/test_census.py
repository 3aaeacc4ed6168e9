"""The census: families end at certified events, and judges state no more than the samples show."""

import pytest
from sympy import Rational

from numeric import PinballMap
from numeric.dynamics.attractors import find
from symbolic import Scene
from symbolic.cycles.polygons import saddle_node
from symbolic.tables.table import alpha
from verification.arithmetic.balls import decimal
from verification.cycles.recurrence import BifurcationKind
from verification.named.attractors import joined
from verification.named.families import Continuation
from verification.paper.claims.claim import Verdict
from verification.paper.judges import attractors as on_attractors
from verification.paper.report.report import catalogue

CLAIMS = {claim.id: claim for claim in catalogue()}


@pytest.fixture(scope="module")
def grown():
    """All families that continue from one contraction, and those born from them."""
    return Continuation(Scene("egg", alpha="0.08"), "lam", ("0.25", "0.53")).run(values=1)


def of(grown, kind):
    """The events of a kind, each with the family on which it is met and the family that is born there."""
    at = [(one, grown.families[one.family]) for one in grown.events if one.event.kind is kind]
    return [(one, family, None if one.born is None else grown.families[one.born]) for one, family in at]


def row(map, starts, seed):
    """The attractors on which so many random starts end."""
    return joined(find(map, starts, seed, images=True), starts, float(map.lam.flat[0]))


@pytest.mark.slow
def test_the_cycles_of_period_3_are_born_at_the_fold_in_closed_form(grown):
    ((one, family, born),) = of(grown, BifurcationKind.FOLD)
    proof = grown.proof(one.event, 12)

    assert family.period == 3
    assert family is born
    assert proof.proved
    assert abs(float(proof.value.mid()) - float(saddle_node().subs(alpha, Rational(2, 25)))) < 1e-11
    assert grown.symmetry(family) == ("C3", 2)
    assert family.attracts[-1][1] == grown.interval[1]


def test_the_cascade_is_found_doubling_by_doubling_from_one_contraction(grown):
    """The doublings equal those of `pinball locate doubling`, which finds them in another way."""
    flips = {family.period: float(grown.proof(one.event, 12).value.mid())
             for one, family, _ in of(grown, BifurcationKind.FLIP) if family.period <= 16}  # fmt: skip

    assert abs(flips[4] - 0.371235502527874) < 1e-12
    assert abs(flips[8] - 0.388761023460750) < 1e-12
    assert abs(flips[16] - 0.392501516486055) < 1e-12


def test_every_doubling_hands_over_where_it_ends(grown):
    handed = [row for row in of(grown, BifurcationKind.FLIP) if row[2] is not None]

    assert len(handed) >= 3
    for one, family, born in handed:
        assert born.period == 2 * family.period
        assert abs(born.attracts[0][0] - one.event.value) < 1e-11
        assert abs(family.attracts[-1][1] - one.event.value) < 1e-11


def test_symmetry_is_lost_before_the_period_doubles(grown):
    ((one, first, second),) = of(grown, BifurcationKind.PITCHFORK)
    flip = next(each for each, family, _ in of(grown, BifurcationKind.FLIP) if family is second)

    assert (first.period, second.period) == (4, 4)
    assert (*grown.symmetry(first), *grown.symmetry(second)) == ("D1", 3, "C1", 6)
    assert decimal(grown.proof(one.event, 12).value, 13)[0] == "0.2877854765032"
    assert all(grown.proof(each.event, 12).proved for each in (one, flip))


def test_the_families_that_attract_are_those_that_starts_reach(grown):
    seen = {(m.period, m.symmetry, m.copies) for m in row(PinballMap("egg", alpha="0.08", lam=0.35), 200, 3).members}
    there = [family for family in grown.families if any(low < 0.35 < high for low, high in family.attracts)]

    assert {(family.period, *grown.symmetry(family)) for family in there} == seen == {(4, "C1", 6)}


def test_a_row_accounts_for_every_start():
    found = row(PinballMap("cuspless", lam=0.09), 150, 1)

    assert sum(m.share.count for m in found.members) + found.unsettled == 150
    assert found.attractors == 2


def test_grazing_is_left_behind_and_not_approached():
    judgement = on_attractors.whispering_gallery(CLAIMS["map.whispering_gallery"])

    assert judgement.verdict is Verdict.CORRECTED
    assert "pi/2" in judgement.erratum
