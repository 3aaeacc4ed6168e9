"""Proofs over sets: exclusion, periodic points of a slap map, the projection argument, the end of the cascade."""

import math
import random
from itertools import pairwise, product

import mpmath
import numpy as np
import pytest
from flint import arb
from sympy import Rational, acos

from numeric import PinballMap
from symbolic.cycles.polygons import saddle_node
from symbolic.expressions.signs import Outcome
from symbolic.tables import egg
from symbolic.tables.law import PAPERS_LAW
from symbolic.tables.table import alpha as letter
from verification.arithmetic.balls import cuts, exact_balls, working
from verification.cycles.critical import polygon_fold
from verification.cycles.newton import floats, refined
from verification.cycles.problem import Problem
from verification.named.curves import DELTA, aitken, limit, ratio, wynn
from verification.paper.egg.basins import points_of_period_4, without_triangles
from verification.proofs.corner.half_return import ChaosAboveLambdaStar
from verification.proofs.corner.return_map import ARC, BITS, CusplessMap, Departures, fourth_on_wall, minimum_at_kink
from verification.proofs.periodic.bifurcation import Stability, doubling_curve, over_interval
from verification.proofs.periodic.completeness import Cover
from verification.proofs.periodic.cycle_in_box import closed_form
from verification.proofs.periodic.interval_newton import ZeroStatus, interval_newton
from verification.proofs.periodic.triangles import PRODUCED, SLAP, flips_nowhere, no_triangles, witness
from verification.proofs.slap_map import exponent as slap
from verification.proofs.slap_map.exponent import periodic_points
from verification.rigorous.exclusion import Cuboids

ALPHA = Rational(2, 25)
LADDER = [  # lambda_3 to lambda_12 at alpha = 2/25, each certified by `pinball locate doubling`
    "0.371235502527919523578336532324050275102188525622321165344497",
    "0.388761023460840300793370106076533294454826453523904186833767",
    "0.392501516486075505022985915339702278914873717285746295287448",
    "0.393302227093869130725330359607485970048944219553467466096273",
    "0.393473727302274657497533299069879636401126234562683438000395",
    "0.393510457806534967868224391633800585520740198839762609461142",
    "0.393518324384185952563141252710603892261699790023154867016722",
    "0.393520009165315133620037665117809277662839690313352616059054",
    "0.393520369993896232548858405166321589370418783260980296487933",
    "0.393520447272331094885770321804636356347020367373638639307504",
]


def test_the_egg_has_no_period_3_cycle_below_the_fold():
    assert without_triangles(ALPHA, Rational(378, 1000)).outcome is Outcome.PROVED  # proved once a run
    assert saddle_node().subs(letter, ALPHA) > Rational(378, 1000)


@pytest.mark.slow
def test_what_exists_is_never_excluded():
    found = no_triangles(ALPHA, Rational(45, 100), budget=8_000)

    assert found.proved is None
    assert found.share < 1


@pytest.mark.slow
def test_a_box_that_cannot_be_halved_exactly_ends_the_proof():
    found = no_triangles(ALPHA, Rational(45, 100), budget=10**6)  # the cycles that exist are met by going deep

    assert found.proved is None
    assert found.boxes < 10**5


def test_a_budget_that_ends_is_unknown_and_says_how_far_it_came():
    found = no_triangles(ALPHA, Rational(3, 10), budget=100)

    assert found.proved is None
    assert 0 < found.share < 1
    assert found.boxes == 100


def test_every_subdivision_whose_budget_ends_leaves_its_question_open():
    assert periodic_points(4, budget=50).stretches is None
    assert doubling_curve(budget=3).proved is None
    assert fourth_on_wall(0.04, 0.0, 0.06, budget=10).proved is None
    assert flips_nowhere(ALPHA, budget=1) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    "proof",
    [
        lambda tick: no_triangles(ALPHA, Rational(1, 16), tick=tick),
        lambda tick: periodic_points(2, tick=tick),
        lambda tick: doubling_curve(tick=tick),
        lambda tick: fourth_on_wall(0.02, 0.0, 0.02, tick=tick),
        lambda tick: ChaosAboveLambdaStar(0.073, tick=tick).proved,
        lambda tick: minimum_at_kink(0.03, 0.0712, 0.0713, tick=tick),
    ],
)
def test_the_shares_that_a_proof_tells_add_up_to_all_of_it(proof):
    shares = []
    proof(shares.append)

    assert min(shares) > 0
    assert abs(sum(shares) - 1) < 1e-6


def test_the_cuspless_slap_map_has_no_cycle_of_period_4():
    ends_of_period_2 = {(0, -mpmath.pi / 3), (0, 0), (0, mpmath.pi / 3), (1, 0)}
    stretches = points_of_period_4().stretches

    assert len(stretches) == 4
    for component, low, high in stretches:
        assert sum(c == component and low <= x <= high for c, x in ends_of_period_2) == 1
    assert periodic_points(1).stretches == []


def test_a_landing_that_may_be_on_either_side_of_a_join_is_told_as_both():
    flights, random, both = CusplessMap(), np.random.default_rng(2), 0
    for _ in range(150):
        theta, size, turn = random.uniform(-2, 2), *10 ** random.uniform(-6, -2.5, 2)
        with working(BITS):
            corner = flights.balls[ARC, ARC](arb(theta), random.choice([-1, 1]) * flights.ends[ARC])[0]
            phi = float(corner.mid())
            found = flights.landing(Departures(ARC, arb(theta, size), arb(1), arb(phi, turn)))
        if found is None:
            continue
        both += len(found) > 1
        starts, angles = theta + size * random.uniform(-1, 1, 20), phi + turn * random.uniform(-1, 1, 20)
        orbit = PinballMap("cuspless", lam=0.0).orbit(starts, angles, 1, np.zeros(20, int))
        for component, at in zip(orbit.component[1], orbit.theta[1], strict=True):
            assert any(p.component == component and abs(p.theta - at).lower() < 1e-9 for p in found)
    assert both > 50


def test_the_projection_meets_the_diagonal_where_the_paper_says_that_it_misses():
    free = witness(ALPHA, Rational(0), *SLAP)
    produced = witness(ALPHA, Rational(3, 10), *PRODUCED)

    assert free.exists
    assert produced.exists
    assert produced.produced


def test_the_cascade_ends_at_feigenbaums_constant():
    found = ratio(LADDER)

    assert abs(found.value - mpmath.mpf(DELTA)) < found.error < 1e-6


def test_more_doublings_agree_with_the_stated_error():
    short, long = limit(LADDER[:-2]), limit(LADDER)

    assert abs(short.value - long.value) < 10 * short.error
    assert long.error < 1e-18
    assert mpmath.nstr(long.value, 18) == "0.39352046833370729"


@pytest.mark.slow
def test_below_lambda_star_the_fourth_collision_is_on_the_wall():
    assert fourth_on_wall(0.06, 0.0, 0.03).proved is True
    assert fourth_on_wall(0.06, 0.0712, 0.0713, budget=1000).proved is None  # lambda-star lies between


def test_the_diameters_double_supercritically_along_the_whole_curve():
    assert doubling_curve().proved is True


@pytest.mark.parametrize(("K", "p", "q"), [(3, 1, 3), (4, 1, 4), (5, 1, 5), (5, 2, 5), (6, 1, 3), (6, 1, 6)])
def test_the_fold_of_every_polygon_is_where_the_closed_form_says(K, p, q):
    shape = Rational(1, 2 * (1 + K * K))
    exact = saddle_node(K, p, q).subs(letter, shape)
    where = -float(acos(-shape)) / K
    found = refined(polygon_fold(K, shape, p, q), [where, float(exact)], 30)

    proof = interval_newton(polygon_fold(K, shape, p, q), exact_balls(found.z), arb("1e-25"), 200)

    assert proof.status is ZeroStatus.UNIQUE
    assert proof.zero[1].overlaps(closed_form(exact, 30))
    assert proof.zero[1].rad() < arb("1e-30")


@pytest.mark.parametrize("process", [wynn, aitken])
def test_a_geometric_sequence_is_summed_exactly(process):
    assert process([2 - mpmath.mpf(2) ** -n for n in range(5)]) == 2


def test_the_pieces_of_a_stretch_touch_and_cover_it_and_are_short():
    for low, high, longest in ((0.0, 1.0, 0.3), (-2.0, -1.9, 0.01), (3.0, 3.5, 7.0)):
        pieces = cuts(low, high, longest)
        assert pieces[0].contains(arb(low))
        assert pieces[-1].contains(arb(high))
        assert all(a.overlaps(b) for a, b in pairwise(pieces))
        assert all(2 * piece.rad() < longest * 1.001 for piece in pieces)
        assert all(arb(low - 1e-9) < piece < arb(high + 1e-9) for piece in pieces)


def test_a_cycle_run_through_twice_is_none_of_twice_the_period():
    """The axis, run through twice: over these contractions its box holds no other cycle and proves no period 4."""
    table = egg(3).at(alpha=ALPHA)
    axis = {n: over_interval(table, (0,) * n, [0, math.pi] * (n // 2), (0.2, 0.201), Stability.SADDLE) for n in (2, 4)}

    assert axis[2].proved
    assert not axis[4].proved


@pytest.mark.parametrize("box", [((0.0, 1.0), (0.0625, 0.0625)), ((0.25, 0.5), (0.03125, 0.25))])
def test_the_halves_of_a_box_cover_it(box):
    (c, wide), (shape, high) = box
    for x, y in product(np.linspace(c - wide, c + wide, 21), np.linspace(shape - high, shape + high, 21)):
        assert any(abs(x - m) <= r and abs(y - n) <= q for (m, r), (n, q) in slap.halves(box))


@pytest.mark.slow
def test_no_box_that_holds_a_cycle_is_settled_and_boxes_beside_it_are():
    """The egg's triangle from its largest gap on, in boxes of all sizes with exact binary ends."""
    table, chance = egg(3).at(alpha=ALPHA), random.Random(1)
    z = floats(Problem(table, (0, 0, 0), lam=Rational(1, 2)), [1.05, 3.14, 5.24])
    gaps = [(b - a) % (2 * math.pi) for a, b in pairwise([*z, z[0]])]
    first = max(range(3), key=gaps.__getitem__)
    held = (z[first] + math.pi) % (2 * math.pi) - math.pi, gaps[first], gaps[(first + 1) % 3]
    beside = held[0], held[1] + 0.05, held[2] - 0.05

    def around(values, size):
        middle = [round((x + chance.uniform(-0.9, 0.9) / 2**size) * 2**40) / 2**40 for x in values]
        return Cuboids(np.array([middle]), np.full((1, 3), 0.5**size))

    cover = Cover.of(table, PAPERS_LAW.on(table), Rational(1, 2))
    assert not any(cover.empty(around(held, size), 1) for size in range(4, 28))
    assert all(cover.empty(around(beside, size), 1) for size in range(9, 20))
