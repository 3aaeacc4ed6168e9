"""Proofs of tangencies: they hold where cycles and published proofs say, and nowhere else; derivatives are right."""

import math
from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from flint import arb, arb_mat
from sympy import Rational

from symbolic.tables import cardioid, cuspless
from symbolic.tables.law import Law
from verification.arithmetic.balls import FLOAT64, balls, multiprecision, working
from verification.cycles.newton import refined
from verification.cycles.recurrence import Closure
from verification.named import tangency_entries
from verification.proofs.manifolds.claim import TangencyClaim
from verification.proofs.manifolds.known import CONTACTS, SHAPE, contact, shadow, table
from verification.proofs.manifolds.plane_map import Henon, Pinball
from verification.proofs.manifolds.proof import (
    ITEMS,
    STRANGE,
    admissible,
    falling,
    objection,
    settled,
    sharpened,
    smooth,
    strange_attractors,
    tangency_proved,
)
from verification.proofs.manifolds.saddle import Orbit, local, saddle
from verification.proofs.manifolds.tangency import Contact, Gap, Precision, multipliers_at, tangency
from verification.proofs.manifolds.touching import Point, Touching, flight

EGG = table(SHAPE)
# Folds of cycles that shadow the tangencies, which use no manifold: docs/crises.md.
BY_CYCLES = {
    "merging": "0.443435246081851218248509",
    "boundary": "0.662144273358224419482535",
    "symmetry-restoring": "0.410268249231453618995790",
    "band-merging-4": "0.397687368992791390776823",
    "window-merging-9": "0.504527312767549985147168",
    "interior-crisis-1": "0.428419190754595226515935",
}


@cache
def proof(kind, shift):
    """The proof within 1e-20 of the value of the cycles, moved by `shift` intervals."""
    context = mpmath.MPContext()
    context.dps = 40
    value = context.mpf(BY_CYCLES[kind]) + shift * context.mpf(10) ** -20
    return tangency_proved(contact(kind, SHAPE), EGG, str(value), 20)


@pytest.mark.parametrize("kind", BY_CYCLES)
def test_each_tangency_is_proved_where_the_cycles_say_and_strange_attractors_follow(kind):
    found = proof(kind, 0)

    assert found.holds
    assert strange_attractors(CONTACTS[kind], EGG, found) == dict.fromkeys(STRANGE, True)
    assert tuple(found.checks) == ITEMS
    with working(100):
        assert abs(found.parameter - arb(BY_CYCLES[kind])) < 1e-23


@pytest.mark.parametrize("kind", BY_CYCLES)
def test_each_saddle_is_dissipative_with_the_multipliers_of_mpmath(kind):
    """The product of the multipliers is below 1 in balls: the hypothesis of Newhouse and Robinson."""
    stable, unstable = proof(kind, 0).multipliers
    context = mpmath.MPContext()
    context.dps = 30
    found = saddle(CONTACTS[kind].unstable, EGG.over(multiprecision(context)), context.mpf(BY_CYCLES[kind]))

    assert abs(stable * unstable) < 1
    with working(100):
        assert abs(stable - arb(str(found.stable))) < 1e-10
        assert abs(unstable - arb(str(found.unstable))) < 1e-8


@pytest.mark.parametrize("shift", [-3, 3])
@pytest.mark.parametrize("kind", ["merging", "boundary"])
def test_no_tangency_is_proved_beside_it(kind, shift):
    found = proof(kind, shift)

    assert found.checks["remainder"] is True
    assert found.checks["exists"] is False
    assert not found.touches


@pytest.mark.parametrize("kind", ["symmetry-restoring", "boundary"])
def test_bend_and_speed_are_those_of_the_gap_in_float64(kind):
    """Their ratio, at one scale of `z`, depends neither on the rounds near the saddle nor on the gap's unit."""
    touch = tangency(CONTACTS[kind], EGG, 10)
    gap = Gap(CONTACTS[kind], EGG.over(FLOAT64), float(touch.parameter), 28, 1e-16)
    precision = Precision(20)
    with working(precision.bits):
        z = settled(Touching(CONTACTS[kind], EGG, arb(BY_CYCLES[kind]).mid(), precision), precision).orbit[0]
    share = gap.scales[0] / (gap.contact().z / float(z))
    found = proof(kind, 0)

    assert float(found.bend / found.speed) * share**2 == pytest.approx(touch.bend / touch.speed, rel=1e-4)


def test_sharpened_values_do_not_depend_on_where_they_start():
    few, many = (sharpened(CONTACTS["boundary"], EGG, start, 20) for start in ("0.66214427", "0.662144273358224"))

    assert few[:24] == many[:24] == BY_CYCLES["boundary"][:24]


@pytest.mark.parametrize("kind", BY_CYCLES)
def test_the_manifolds_that_touch_belong_to_one_cycle(kind):
    """The symmetry at the end of the orbit takes the cycle into itself, so the tangency is homoclinic as it stands."""
    precision = Precision(20)
    with working(precision.bits):
        system = Touching(CONTACTS[kind], EGG, arb(CONTACTS[kind].parameter), precision)
    orbit = CONTACTS[kind].unstable
    points = list(orbit.start)
    while len(points) < 6 * len(orbit.start):
        points.append(orbit.closure.carried(points[-len(orbit.start)], orbit.closure.radians, 1))
    image = system.sign * (points[0] + system.turns * 2 * math.pi / 3)

    assert min(abs(math.remainder(image - x, 2 * math.pi)) for x in points) < 1e-4


@pytest.mark.parametrize("kind", CONTACTS)
@pytest.mark.parametrize(("early", "late"), [(2, 2), (3, 5)])
def test_a_flight_obeys_the_rule_however_far_it_goes_into_the_manifolds(kind, early, late):
    """All rules to rounding, but the two where the orbit meets the stable series, which hold as well as the start."""
    where, map = CONTACTS[kind], EGG.over(FLOAT64)
    out, into = (local(saddle(where.unstable, map, where.parameter), unstable) for unstable in (True, False))
    points = [x.c[0] for x in flight(where, map, out, into, early, late).bounces]
    rules = sorted(abs(map.rule(points[k : k + 3], where.parameter)) for k in range(len(points) - 2))

    assert len(points) == 3 + where.bounces + (early + late) * len(where.unstable.start)
    assert rules[-3] < 1e-12
    assert rules[-1] < 1e-5


@cache
def system():
    """The merging crisis' system near its zero, and the zero."""
    precision = Precision(20)
    with working(precision.bits):
        made = Touching(CONTACTS["merging"], EGG, arb(BY_CYCLES["merging"]).mid(), precision)
        return made, settled(made, precision)


@pytest.mark.parametrize("seed", range(3))
def test_the_matrix_of_the_system_holds_its_difference_quotients(seed):
    """Along random directions, by central differences; the manifolds are affine in the parameter up to the step."""
    made, zero = system()
    with working(Precision(20).bits):
        step, here = (arb(10) ** -21).mid(), [*zero.unknowns[:-1], made.parameter]
        random = np.random.default_rng(seed).uniform(-1, 1, len(here))
        beside = []
        for move in (step, -step):
            linear = made.linear(Point.of([x + move * arb(float(r)) for x, r in zip(here, random, strict=True)]))
            beside.append([x.mid() for x in (*linear.values, *linear.along)])
        product = made.linear(Point.of(here)).matrix().mid() * arb_mat([[arb(float(r))] for r in random])
        for i, (high, low) in enumerate(zip(*beside, strict=True)):
            assert abs((high - low) / (2 * step) - product[i, 0].mid()) <= 1e-18


def test_newtons_step_in_two_halves_solves_the_whole_system():
    made, zero = system()
    with working(Precision(20).bits):
        linear = made.linear(Point.of([*zero.unknowns[:-1], made.parameter]))
        values = [arb(k + 1) for k in range(2 * len(linear.rows))]
        step = replace(linear, halves=True).step(values, "precond")
        whole = linear.matrix().solve(arb_mat([[x] for x in values]), algorithm="precond")

        assert all(whole[i, 0].overlaps(x) for i, x in enumerate(step))
        assert max(x.rad() for x in step) < 1e-5 * max(abs(x.mid()) for x in step)


def test_multipliers_at_the_tangency_are_known_better_and_are_those_of_the_same_cycle():
    made, zero = system()
    around, precision = made.pairs[0].saddle, Precision(20)
    with working(precision.bits):
        at = multipliers_at(zero.parameter, around, EGG, precision)
        apart = replace(around, points=tuple(x + 1 for x in around.points))  # another cycle
        assert all(wide.contains(x) for wide, x in zip((around.stable.real, around.unstable.real), at, strict=True))
        assert all(x.rad() < wide.real.rad() for wide, x in zip((around.stable, around.unstable), at, strict=True))
        assert multipliers_at(zero.parameter, apart, EGG, precision)[0].rad() == around.stable.real.rad()


def test_the_vector_along_a_tangency_is_the_tangent_of_the_orbits_on_the_manifold():
    made, zero = system()
    with working(Precision(20).bits):
        step = (arb(10) ** -20).mid()
        moved = Point([x + step * v for x, v in zip(zero.orbit, zero.along, strict=True)], zero.along, zero.parameter)
        apart = [x.mid() for x in made.linear(moved).values]

    assert max(abs(float(x)) for x in apart) < 1e-33  # of second order in the step; of first order it would be 1e-20


INNER, FAR = Orbit("inner fixed point", (0.63,)), Orbit("outer fixed point", (-1.13,))
# [AraiMischaikow2006] proved the first two intervals in another way.
# [GrebogiOttRomeirasYorke1987]: the boundary crisis, a heteroclinic tangency.
HENON = {
    "inner, homoclinic": (
        Contact(INNER, INNER, 4, 1, -0.635006, -1.319803, 1.3924),
        Rational(3, 10),
        (1.392419807915, 1.392419807931),
    ),
    "outer, homoclinic": (
        Contact(
            Orbit("outer fixed point", (-1.5,)), Orbit("outer fixed point", (-1.5,)), 1, 1, 7.206345, 0.23941, 1.3145
        ),
        Rational(-3, 10),
        (1.314527109319, 1.314527109334),
    ),
    "crisis": (Contact(INNER, FAR, 1, 1, -0.627005, 2.211054, 1.4269), Rational(3, 10), (1.42692, 1.42693)),
}


@cache
def published(name):
    """The contact and its proof."""
    where, b, _ = HENON[name]
    map = Henon(b)
    value = sharpened(where, map, str(tangency(where, map, 10).parameter), 20)
    return where, map, tangency_proved(where, map, value, 20)


@pytest.mark.parametrize("name", HENON)
def test_the_tangencies_of_the_henon_map_are_proved_where_they_were_published(name):
    _, _, found = published(name)
    low, high = HENON[name][2]

    assert found.holds
    assert low <= found.parameter <= high


def test_the_henon_map_has_strange_attractors_next_to_its_homoclinic_tangencies_and_not_by_a_heteroclinic_one():
    """[AraiMischaikow2006] call the first two generic; at the third two saddles take part, and the theorem has one."""
    strange = {name: strange_attractors(*published(name)) for name in HENON}

    assert set(strange["inner, homoclinic"].values()) == set(strange["outer, homoclinic"].values()) == {True}
    assert [item for item in STRANGE if not strange["crisis"][item]] == ["homoclinic"]


@pytest.mark.parametrize(
    ("multipliers", "missing"),
    [
        (("0.5", "2.5"), {"dissipative": False}),  # expands areas
        (("0.3 +/- 0.1", "3.3"), {"dissipative": None, "nonresonant": None}),  # keeps them, for all that is known
        (("-0.0625", "4"), {"nonresonant": None}),  # stable*unstable**2 has size 1
        ((), {"dissipative": None, "nonresonant": None}),  # no saddle was proved
    ],
)
def test_no_strange_attractors_follow_from_a_saddle_that_may_break_a_hypothesis(multipliers, missing):
    changed = replace(proof("boundary", 0), multipliers=tuple(map(arb, multipliers)))

    assert strange_attractors(CONTACTS["boundary"], EGG, changed) == dict.fromkeys(STRANGE, True) | missing


def test_no_strange_attractors_follow_beside_a_tangency_or_where_the_boundary_has_joins():
    assert strange_attractors(CONTACTS["boundary"], EGG, proof("boundary", 3))["tangency"] is None
    assert strange_attractors(CONTACTS["boundary"], Pinball(cuspless), proof("boundary", 0))["analytic"] is None
    assert smooth(Pinball(cardioid)) is None


@pytest.mark.parametrize(
    ("changed", "value", "known"),
    [
        ({}, "0.66", ["saddle", "remainder", "admissible"]),  # no tangency near this parameter
        ({"bounces": 7, "z": 0.02}, BY_CYCLES["boundary"], ["saddle", "remainder"]),  # nor near this orbit
        ({"unstable": Orbit("flat points", (-0.905,), Closure(1, (1, 3)))}, BY_CYCLES["boundary"], []),  # no saddle
    ],
)
def test_where_a_proof_fails_its_checks_say_how_far_it_came(changed, value, known):
    found = tangency_proved(replace(CONTACTS["boundary"], **changed), EGG, value, 20)

    assert [item for item in ITEMS if found.checks[item]] == known
    assert not found.touches


def test_chords_are_admissible_in_convex_tables_only():
    assert admissible(EGG) is True
    assert admissible(Pinball(cardioid)) is None
    assert admissible(Henon(Rational(3, 10))) is True


# The boundary tangency under another law, followed there from the paper's, and the fold of a cycle of 35 bounces.
BENT = Law("-lam*eta*(1 - eta**2/40)")
TRIANGLE = Orbit("triangle of the vertices", (-0.16812306,), Closure(1, (1, 3)))
UNDER_LAW = Contact(TRIANGLE, TRIANGLE, 5, 1, 0.0352, -0.0257, 0.66481197)


def test_a_tangency_under_another_law_is_proved_where_the_cycles_that_shadow_it_fold():
    map = table(SHAPE, BENT)
    cycle = shadow(UNDER_LAW, map, UNDER_LAW.parameter, 24)
    fold = refined(cycle.problem, cycle.start, 20).z[-1]
    value = sharpened(UNDER_LAW, map, "0.66481197", 12)
    found = tangency_proved(UNDER_LAW, map, value, 12)

    assert cycle.problem.law == BENT
    assert abs(mpmath.mpf(value) - fold) < 1e-12
    assert found.holds
    assert strange_attractors(UNDER_LAW, map, found) == dict.fromkeys(STRANGE, True)
    assert not tangency_proved(UNDER_LAW, EGG, value, 12).touches
    assert not tangency_proved(UNDER_LAW, map, str(mpmath.mpf(value) + 3e-12), 12).touches


def test_the_rule_and_its_derivative_by_the_parameter_are_the_same_in_either_way_of_writing_the_papers_law():
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


def test_backwards_a_particle_comes_from_where_forwards_it_left():
    map = table(SHAPE, BENT)
    before, here = np.array([0.1, 0.4]), np.array([2.3, 3.3])

    following = map.following(before, here, 0.6)
    assert np.allclose(map.previous(here, following, 0.6), before, atol=1e-12)


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
def test_a_law_without_what_a_contact_needs_is_refused_and_proves_nothing(kind, formula, says):
    law, where = Law(formula), CONTACTS[kind]

    assert says in objection(where, table(SHAPE, law), 0.9)
    with pytest.raises(ValueError, match=says):
        TangencyClaim(where, EGG.table, "0.9", 12, law)


def test_a_law_of_the_place_is_asked_of_a_map_that_counts_whole_turns_alone():
    """The orbit closes by whole turns; that of the egg is told up to thirds of one."""
    map, orbit = table(SHAPE, Law("-lam*eta + cos(theta)*eta**3/99")), Orbit("a fixed point", (0.5,))
    where = Contact(orbit, orbit, 3, 1, 0.01, 0.02, 0.6)

    assert "closes by turns" in objection(where, replace(map, turn=3), 0.4)
    assert "closes by turns" not in objection(where, replace(map, turn=1), 0.4)


def test_a_law_with_a_slope_that_vanishes_or_with_a_root_is_not_proved_to_be_analytic_both_ways():
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
    claim = TangencyClaim(UNDER_LAW, EGG.table, "0.66481196848210", 12, BENT)

    said = {"schema": 4} | tangency_entries.entries(claim)
    plain = {key: text for key, text in said["scene"].items() if key != "law"}

    assert tangency_entries.claim_of(said) == claim
    assert tangency_entries.claim_of(said | {"scene": plain}).law.uniform
