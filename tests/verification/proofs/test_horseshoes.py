"""Horseshoes: proved where they are known, with entropies that no theorem forbids; refused where they are changed."""

import math
from dataclasses import replace
from functools import cache

import pytest
from sympy import Rational

from symbolic.tables import cuspless
from verification.proofs.manifolds.horseshoe import Edge, HSet, built, crossings, horseshoe
from verification.proofs.manifolds.known import SHAPE, TRIANGLE, table
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Contact

HENON, INNER = Henon(Rational(3, 10)), Orbit("inner fixed point", (0.63,))
EGG = Contact(TRIANGLE, TRIANGLE, 4, 1, 0.0286537538597, -0.160320745918, 0.7)


@cache
def classical():
    """The horseshoe of the Henon map at the classical parameters."""
    return horseshoe(INNER, HENON, 1.4, 1e-3)


def test_the_henon_map_has_a_horseshoe_at_the_classical_parameters():
    """Its entropy is at most log 2, as that of every quadratic map of the plane of this form [FriedlandMilnor1989]."""
    found = classical()

    assert found.checks == dict.fromkeys(("admissible", "covering", "disjoint", "cones"), True)
    assert 0.18 < found.entropy < math.log(2)


def test_where_all_points_that_stay_are_a_full_shift_a_horseshoe_is_found_below_its_entropy():
    """For a > (5 + 2*sqrt(5))*(1 + b)**2/4 the entropy is log 2 [DevaneyNitecki1979]."""
    found = horseshoe(Orbit("inner fixed point", (0.35,)), HENON, 5.0, 1e-4)

    assert found.proved
    assert 0.2 < found.entropy < math.log(2)


def test_the_entropy_bound_is_the_growth_rate_of_words_in_two_loops():
    p, n = classical().loops
    h = classical().entropy
    counts = [1]
    for k in range(1, 400):
        counts.append(sum(counts[k - step] for step in (p, n) if k >= step))

    assert h <= math.log(counts[-1] / counts[-2]) < h + 1e-9


def test_orbits_of_the_henon_map_follow_the_h_sets():
    found = classical()
    for k in range(1, len(found.sets) - 1):
        before, here = found.sets[k].centre
        assert HENON.following(before, here, 1.4) == pytest.approx(found.sets[k + 1].centre[1], abs=1e-9)


@pytest.mark.parametrize(
    "changed",
    [
        lambda made: {"middle": 1.3},  # other parameters
        lambda made: {"radius": 0.1},
        lambda made: {"sets": (made.sets[0], *reversed(made.sets[1:]))},
        lambda made: {"edges": made.edges[:-1]},  # the orbit does not come back
        lambda made: {"edges": (*made.edges[:-1], Edge(made.edges[-1].source, 1))},  # one edge turned
        lambda made: {"sets": tuple(HSet(s.centre, s.contracted, s.expanded) for s in made.sets)},
        lambda made: {"sets": (*made.sets[:3], scaled(made.sets[3], 2.0), *made.sets[4:])},
        lambda made: {"sets": (*made.sets[:1], made.sets[0], *made.sets[2:])},  # two loops that begin alike
    ],
)
def test_a_horseshoe_that_is_changed_is_not_proved(changed):
    found = replace(classical(), **changed(classical()))

    assert not found.proved
    assert found.entropy == 0


def scaled(h, by):
    return HSet(h.centre, tuple(by * x for x in h.expanded), tuple(by * x for x in h.contracted))


def test_h_sets_with_a_common_point_prove_nothing():
    found = classical()
    near = HSet(found.sets[1].centre, found.sets[0].expanded, found.sets[1].contracted)

    assert replace(found, sets=(found.sets[0], near, *found.sets[2:])).checks["disjoint"] is None


def test_no_horseshoe_is_found_where_every_orbit_that_stays_tends_to_a_cycle():
    assert crossings(Orbit("outer fixed point", (-2.2,)), HENON, 0.3, 4) == []
    with pytest.raises(ValueError, match="none of the outer fixed point"):
        horseshoe(Orbit("outer fixed point", (-2.2,)), HENON, 0.3, 1e-6, 4)


@cache
def egg():
    return built(EGG, table(SHAPE), 4, 4, 3e-5)


def test_the_egg_has_a_horseshoe_where_its_chaotic_attractor_has_ended():
    """At alpha = 0.08, 0.69997 <= lam <= 0.70003: infinitely many cycles, with orbits of positive entropy."""
    found = egg()

    assert found.proved
    assert found.loops == (1, 13)
    assert 0.151 < found.entropy < 0.152


def test_elastic_collisions_have_chaotic_orbits_in_the_egg():
    found = built(replace(EGG, z=0.024272312279, end=-0.107805922573, parameter=1.0), table(SHAPE), 3, 4, 1e-6)

    assert found.proved
    assert found.loops == (1, 12)


def test_a_horseshoe_of_the_egg_is_refused_with_another_symmetry_at_its_end():
    last = egg().edges[-1]
    turned = replace(last, turns=(last.turns[0] + 1, last.turns[1] + 1))

    assert not replace(egg(), edges=(*egg().edges[:-1], turned)).proved
    assert replace(egg(), map=Pinball(cuspless)).checks["admissible"] is None
