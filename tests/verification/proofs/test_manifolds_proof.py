"""Proofs of tangencies: they hold at the values from cycles and publications and nowhere else."""

from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from flint import arb, arb_mat
from sympy import Rational

from symbolic.tables import cardioid, cuspless
from symbolic.tables.law import Law
from verification.arithmetic.balls import FLOAT64, balls, working
from verification.cycles.newton import refined
from verification.cycles.recurrence import Closure
from verification.proofs.manifolds.certificate import Tangency
from verification.proofs.manifolds.known import CONTACTS, SHAPE, contact, shadow, table
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.proof import (
    ManifoldsTouch,
    falling,
    objection,
    settled,
    sharpened,
    smooth,
)
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact, Gap, Precision, tangency
from verification.proofs.manifolds.touching import OrbitPoint, Touching

EGG = table(SHAPE)
# Folds of cycles that shadow the tangencies, which use no manifold: docs/crises.md.
BY_CYCLES = {
    "merging": "0.443435246081851218248509",
    "boundary": "0.662144273358224419482535",
    "symmetry-restoring": "0.410268249231453618995790",
    "band-merging-4": "0.397687368992791390776823",
    "window-merging-9": "0.504527312767549985147168",
    "interior-crisis-1": "0.428419189868092478756523",
    "interior-crisis-1-later": "0.428419190754595226515935",
}


@cache
def proof(kind, shift):
    """The proof with radius 1e-20 at the value from cycles, moved by `shift` radii."""
    context = mpmath.MPContext()
    context.dps = 40
    value = context.mpf(BY_CYCLES[kind]) + shift * context.mpf(10) ** -20
    return ManifoldsTouch(contact(kind, SHAPE), EGG, str(value), 20)


@pytest.mark.parametrize("kind", BY_CYCLES)
def test_each_tangency_is_proved_where_the_cycles_say(kind):
    found = proof(kind, 0)

    assert found.proved
    assert found.strange.proved
    with working(100):
        assert abs(found.value - arb(BY_CYCLES[kind])) < 1e-23


@pytest.mark.parametrize("shift", [-3, 3])
@pytest.mark.parametrize("kind", ["merging", "boundary"])
def test_no_tangency_is_proved_beside_it(kind, shift):
    found = proof(kind, shift)

    assert found.checks["remainder"] is True
    assert found.checks["exists"] is False
    assert not found.touches


@pytest.mark.parametrize("kind", ["symmetry-restoring", "boundary"])
def test_bend_and_speed_are_those_of_the_gap_in_float64(kind):
    """At one scale of `z` their ratio depends neither on the rounds near the saddle nor on the unit of the gap."""
    touch = tangency(CONTACTS[kind], EGG, 10)
    gap = Gap(CONTACTS[kind], EGG.over(FLOAT64), float(touch.parameter), 28, 1e-16)
    precision = Precision(20)
    with working(precision.bits):
        z = settled(Touching(CONTACTS[kind], EGG, arb(BY_CYCLES[kind]).mid(), precision), precision).orbit[0]
    share = gap.scales[0] / (gap.contact().z / float(z))
    found = proof(kind, 0).enclosed

    assert float(found.bend / found.speed) * share**2 == pytest.approx(touch.bend / touch.speed, rel=1e-4)


@cache
def system():
    """The system for the merging crisis, and its zero."""
    precision = Precision(20)
    with working(precision.bits):
        made = Touching(CONTACTS["merging"], EGG, arb(BY_CYCLES["merging"]).mid(), precision)
        return made, settled(made, precision)


@pytest.mark.parametrize("seed", range(3))
def test_the_matrix_of_the_system_holds_its_difference_quotients(seed):
    """Central differences in random directions; within the step the manifolds are affine in the parameter."""
    made, zero = system()
    with working(Precision(20).bits):
        step, here = (arb(10) ** -21).mid(), [*zero.unknowns[:-1], made.parameter]
        random = np.random.default_rng(seed).uniform(-1, 1, len(here))
        beside = []
        for move in (step, -step):
            linear = made.linear(OrbitPoint.of([x + move * arb(float(r)) for x, r in zip(here, random, strict=True)]))
            beside.append([x.mid() for x in (*linear.values, *linear.along)])
        product = made.linear(OrbitPoint.of(here)).matrix().mid() * arb_mat([[arb(float(r))] for r in random])
        for i, (high, low) in enumerate(zip(*beside, strict=True)):
            assert abs((high - low) / (2 * step) - product[i, 0].mid()) <= 1e-18


INNER, FAR = SaddleCycle("inner fixed point", (0.63,)), SaddleCycle("outer fixed point", (-1.13,))
OUTER = SaddleCycle("outer fixed point", (-1.5,))  # for the other sign of b
# Contact, b and the interval of a. [AraiMischaikow2006] proved the first two in another way: quadratic homoclinic
# tangencies. [GrebogiOttRomeirasYorke1987]: the boundary crisis, a heteroclinic tangency.
HENON = {
    "inner, homoclinic": (
        Contact(INNER, INNER, 4, 1, -0.635006, -1.319803, 1.3924), Rational(3, 10), (1.392419807915, 1.392419807931)
    ),
    "outer, homoclinic": (
        Contact(OUTER, OUTER, 1, 1, 7.206345, 0.23941, 1.3145), Rational(-3, 10), (1.314527109319, 1.314527109334)
    ),
    "crisis": (Contact(INNER, FAR, 1, 1, -0.627005, 2.211054, 1.4269), Rational(3, 10), (1.42692, 1.42693)),
}  # fmt: skip


@cache
def published(name):
    """A tangency that is published, in float64, and its proof."""
    where, b, _ = HENON[name]
    map = Henon(b)
    touch = tangency(where, map, 10)
    return touch, ManifoldsTouch(where, map, sharpened(where, map, str(touch.parameter), 20), 20)


@pytest.mark.parametrize("name", HENON)
def test_tangencies_of_the_henon_map_are_the_published_ones(name):
    (touch, found), (*_, (low, high)) = published(name), HENON[name]

    assert low <= touch.parameter <= high
    assert abs(touch.bend) > 1e-3
    assert abs(touch.speed) > 1e-3
    assert found.proved
    assert low <= found.value <= high


def test_strange_attractors_follow_from_homoclinic_tangencies_alone():
    """[AraiMischaikow2006] call the first two generic; the third involves two saddles, and the theorem one."""
    assert {name: [*published(name)[1].strange.open] for name in HENON} == {
        "inner, homoclinic": [],
        "outer, homoclinic": [],
        "crisis": ["homoclinic"],
    }


@pytest.mark.parametrize(
    ("multipliers", "missing"),
    [
        (("0.5", "2.5"), {"dissipative": False}),  # expands areas
        (("0.3 +/- 0.1", "3.3"), {"dissipative": None, "nonresonant": None}),  # keeps them, for all that is known
        (("-0.0625", "4"), {"nonresonant": None}),  # stable*unstable**2 has size 1
        ((), {"dissipative": None, "nonresonant": None}),  # no saddle was proved
    ],
)
def test_no_strange_attractors_where_a_saddle_breaks_a_hypothesis(multipliers, missing):
    strange = proof("boundary", 0).strange
    assert replace(strange, multipliers=tuple(map(arb, multipliers))).checks == strange.checks | missing


def test_no_strange_attractors_beside_a_tangency_or_with_joins():
    assert "tangency" in proof("boundary", 3).strange.open
    assert [*replace(proof("boundary", 0).strange, map=Pinball(cuspless)).open] == ["analytic"]
    assert smooth(Pinball(cardioid)) is None


@pytest.mark.parametrize(
    ("changed", "value", "known"),
    [
        ({}, "0.66", ["saddle", "remainder", "admissible"]),  # no tangency near this parameter
        ({"bounces": 7, "z": 0.02}, BY_CYCLES["boundary"], ["saddle", "remainder"]),  # nor near this orbit
        (
            {"unstable": SaddleCycle("flat points", (-0.905,), Closure(1, (1, 3)))},
            BY_CYCLES["boundary"],
            [],
        ),  # no saddle
    ],
)
def test_where_a_proof_fails_its_checks_say_how_far_it_came(changed, value, known):
    found = ManifoldsTouch(replace(CONTACTS["boundary"], **changed), EGG, value, 20)

    assert [item for item, held in found.checks.items() if held] == known
    assert not found.touches


# The boundary tangency under another law, followed there from the paper's, and the fold of a cycle of 35 bounces.
BENT = Law("-lam*eta*(1 - eta**2/40)")
TRIANGLE = SaddleCycle("triangle of the vertices", (-0.16812306,), Closure(1, (1, 3)))
UNDER_LAW = Contact(TRIANGLE, TRIANGLE, 5, 1, 0.0352, -0.0257, 0.66481197)


def test_a_tangency_under_another_law_is_proved():
    map = table(SHAPE, BENT)
    cycle = shadow(UNDER_LAW, map, UNDER_LAW.parameter, 24)
    fold = refined(cycle.problem, cycle.start, 20).z[-1]
    value = sharpened(UNDER_LAW, map, "0.66481197", 12)
    found = ManifoldsTouch(UNDER_LAW, map, value, 12)

    assert cycle.problem.law == BENT
    assert abs(mpmath.mpf(value) - fold) < 1e-12
    assert found.proved
    assert found.strange.proved
    assert not ManifoldsTouch(UNDER_LAW, EGG, value, 12).touches
    assert not ManifoldsTouch(UNDER_LAW, map, str(mpmath.mpf(value) + 3e-12), 12).touches


def test_the_rule_is_the_same_however_the_law_is_written():
    egg = EGG.over(balls(64))
    same = replace(egg, law=Law("-lam*eta + sin(eta)**2 + cos(eta)**2 - 1"))
    near = [arb("0.1"), arb("2.3"), arb("4.2")]

    one, two = (map.linear(near, arb("0.6")) for map in (egg, same))
    assert all((x - y).contains(0) for x, y in zip((one[0], *one[1], one[2]), (two[0], *two[1], two[2]), strict=True))
    bent = table(SHAPE, Law("-sin(lam*eta)")).over(balls(64))
    value, slopes, moving = bent.linear(near, arb("0.6"))
    quotient = (bent.rule(near, arb("0.6") + arb("1e-6")) - bent.rule(near, arb("0.6") - arb("1e-6"))) / arb("2e-6")
    assert (value - bent.rule(near, arb("0.6"))).contains(0)
    assert all((x - y).contains(0) for x, y in zip(slopes, bent.slopes(near, arb("0.6")), strict=True))
    assert abs(moving - quotient) < 1e-6


@pytest.mark.parametrize(
    ("kind", "formula", "says"),
    [
        ("merging", "-lam*eta + eta**2/99", "no odd function of eta"),
        ("boundary", "-lam*eta + cos(theta)/99", "the orbit closes by turns of the table"),
        ("band-merging", "-lam*eta + cos(theta/2)/99", "the orbit closes by turns of the table"),
        ("boundary", "-lam*eta + sin(s)/99", "arc length s"),
        ("boundary", "-lam*eta - b*sin(2*eta)", "b is no number"),
        ("boundary", "-2*lam*eta", "at eta = "),
    ],
)
def test_a_law_without_what_a_contact_needs_is_refused(kind, formula, says):
    law, where = Law(formula), CONTACTS[kind]

    assert says in objection(where, table(SHAPE, law), 0.9)
    with pytest.raises(ValueError, match=says):
        Tangency(where, EGG.table, "0.9", 12, law)


def test_a_law_with_a_zero_slope_or_a_root_does_not_fall():
    assert falling(Law("-lam*eta*(1 - eta**2/40)"), arb("0.6"))
    assert falling(Law("-lam*eta + cos(theta)/99"), arb("0.6"))
    assert not falling(Law("-lam*eta + eta**3/10"), arb("0.6"))
    assert not falling(Law("-lam*eta*sqrt(1 + eta**2/99)"), arb("0.6"))
    assert not falling(BENT, None)
    assert smooth(table(SHAPE, BENT), arb("0.6")) is True
    assert smooth(table(SHAPE, BENT)) is smooth(table(SHAPE, Law("-lam*eta + eta**3/10")), arb("0.6")) is None
    for sign in "+-":  # its slope is -0.6 +- c*eta: at one end of the incidence angles it vanishes, or just does not
        assert falling(Law(f"-lam*eta {sign} 0.6*eta**2/(2*1.5718)"), arb("0.6"))
        assert not falling(Law(f"-lam*eta {sign} 0.6*eta**2/(2*1.5703)"), arb("0.6"))


def test_a_claim_with_a_law_is_read_back_with_its_law():
    stated = Tangency(UNDER_LAW, EGG.table, "0.66481196848210", 12, BENT)
    said = stated.to_dict()
    plain = {key: text for key, text in said["scene"].items() if key != "law"}

    assert Tangency.from_dict(said) == stated
    assert Tangency.from_dict(said | {"scene": plain}).law.uniform
