"""Proofs over sets: exclusion, periodic points of a slap map, the projection argument, the end of the cascade."""

import math
import random
from dataclasses import replace
from itertools import accumulate, pairwise, product

import mpmath
import numpy as np
import pytest
from flint import arb, arb_mat
from sympy import Rational, acos

from numeric import PinballMap
from symbolic.cycles.polygons import saddle_node
from symbolic.expressions.signs import Outcome
from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel, polar_polygon_kernel, polygon_kernel
from symbolic.tables import egg
from symbolic.tables.law import PAPERS_LAW
from symbolic.tables.table import alpha as letter
from verification.arithmetic.balls import balls, cuts, exact_balls, working
from verification.cycles.chain import Chain
from verification.cycles.critical import polygon_fold
from verification.cycles.newton import refined
from verification.cycles.problem import Problem
from verification.named.curves import DELTA, aitken, limit, ratio, wynn
from verification.named.locate import closed_form
from verification.paper.egg.basins import points_of_period_4, without_triangles
from verification.proofs.corner.half_return import trapping_region
from verification.proofs.corner.return_map import ARC, BITS, WALL, Flights, Piece, fourth_on_wall, minimum_at_kink
from verification.proofs.periodic import bifurcation, triangles
from verification.proofs.periodic import interval_newton as newton
from verification.proofs.periodic.bifurcation import Stability, doubling_curve, over_interval
from verification.proofs.periodic.interval_newton import Cover, Status, dense, interval_newton, least_gap, reflection
from verification.proofs.periodic.triangles import PRODUCED, SLAP, flips_nowhere, no_triangles, witness
from verification.proofs.slap_map import exponent as slap
from verification.proofs.slap_map.exponent import periodic_points

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


def test_what_exists_is_never_excluded():
    found = no_triangles(ALPHA, Rational(45, 100), budget=8_000)

    assert found.excluded is None
    assert found.share < 1


def test_a_box_that_cannot_be_halved_exactly_ends_the_proof():
    found = no_triangles(ALPHA, Rational(45, 100), budget=10**6)  # the cycles that exist are met by going deep

    assert found.excluded is None
    assert found.boxes < 10**5


def test_a_budget_that_ends_is_unknown_and_says_how_far_it_came():
    found = no_triangles(ALPHA, Rational(3, 10), budget=100)

    assert found.excluded is None
    assert 0 < found.share < 1
    assert found.boxes == 100


def test_every_subdivision_whose_budget_ends_leaves_its_question_open():
    assert periodic_points(4, budget=50).stretches is None
    assert doubling_curve(budget=3).supercritical is None
    assert fourth_on_wall(0.04, 0.0, 0.06, budget=10).on_wall is None
    assert flips_nowhere(ALPHA, budget=1) is None


@pytest.mark.parametrize(
    "proof",
    [
        lambda tick: no_triangles(ALPHA, Rational(1, 16), tick=tick),
        lambda tick: periodic_points(2, tick=tick),
        lambda tick: doubling_curve(tick=tick),
        lambda tick: fourth_on_wall(0.02, 0.0, 0.02, tick=tick),
        lambda tick: trapping_region(0.073, tick=tick),
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


class Kinked:
    """In the place of flights, a map of the arc with a kink at 0, where it is 0.002 below the diagonal."""

    def __init__(self):
        self.ends, self.odd = {ARC: arb(1), WALL: arb(1)}, False

    def iterated(self, pieces, n):
        (piece,) = pieces
        left = piece.theta.mid() < 0
        slope = arb("0.5") if left else arb("1.5")
        return [replace(piece, theta=slope * piece.theta - arb("0.002"), slope=slope)]


def test_stretches_are_joined_only_where_the_slope_stays_on_one_side_of_the_diagonals(monkeypatch):
    """On either side of the kink is a fixed point: -0.004 and 0.004, in stretches that touch at 0."""
    monkeypatch.setattr(slap, "Flights", Kinked)
    on_arc = [(low, high) for component, low, high in periodic_points(1).stretches if component == ARC]

    for low, high in on_arc:
        assert sum(low <= x <= high for x in (-0.004, 0.004)) <= 1
    assert on_arc[0][0] <= -0.004 <= on_arc[0][1] <= 0 <= on_arc[-1][0] <= 0.004 <= on_arc[-1][1]


def test_a_landing_is_on_any_part_of_the_boundary_that_the_ball_may_reach(monkeypatch):
    """A wall whose both ends lie in the ball of the ray's crossing: upper arc, wall and lower arc."""
    flights = Flights()
    roots = {ARC: {1: arb(2.2, 0.3), -1: arb(-2.2, 0.3)}, WALL: {1: arb(0.01, 0.5), -1: arb(0.01, 0.5)}}

    def enclosed(piece, target, low, high):
        return Piece(target, roots[target][1 if low < math.pi / 2 else -1], arb(1), arb(0))

    monkeypatch.setattr(flights, "_root", enclosed)
    for at, to in ((0.3, 0.0), (0.3, 0.2), (-0.3, -0.2)):  # from here the middle of the ball is on the wall or an arc
        found = flights.landing(Piece(ARC, arb(at), arb(1), arb(to, 0.3)))
        assert {(p.component, bool(p.theta > 0.1), bool(p.theta < -0.1)) for p in found} == {
            (ARC, True, False),
            (WALL, False, False),
            (ARC, False, True),
        }


def test_a_landing_that_may_be_on_either_side_of_a_join_is_told_as_both():
    flights, random, both = Flights(), np.random.default_rng(2), 0
    for _ in range(150):
        theta, size, turn = random.uniform(-2, 2), *10 ** random.uniform(-6, -2.5, 2)
        with working(BITS):
            corner = flights.balls[ARC, ARC](arb(theta), random.choice([-1, 1]) * flights.ends[ARC])[0]
            phi = float(corner.mid())
            found = flights.landing(Piece(ARC, arb(theta, size), arb(1), arb(phi, turn)))
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


def test_below_lambda_star_the_fourth_collision_is_on_the_wall():
    assert fourth_on_wall(0.06, 0.0, 0.03).on_wall is True
    assert fourth_on_wall(0.06, 0.0712, 0.0713, budget=1000).on_wall is None  # lambda-star lies between


def test_the_diameters_double_supercritically_along_the_whole_curve():
    assert doubling_curve().supercritical is True


@pytest.mark.parametrize(("K", "p", "q"), [(3, 1, 3), (4, 1, 4), (5, 1, 5), (5, 2, 5), (6, 1, 3), (6, 1, 6)])
def test_the_fold_of_every_polygon_is_where_the_closed_form_says(K, p, q):
    shape = Rational(1, 2 * (1 + K * K))
    exact = saddle_node(K, p, q).subs(letter, shape)
    where = -float(acos(-shape)) / K
    found = refined(polygon_fold(K, shape, p, q), [where, float(exact)], 30)

    proof = interval_newton(polygon_fold(K, shape, p, q), exact_balls(found.z), arb("1e-25"), 200)

    assert proof.status is Status.UNIQUE
    assert proof.zero[1].overlaps(closed_form(exact, 30))
    assert proof.zero[1].rad() < arb("1e-30")


@pytest.mark.parametrize("process", [wynn, aitken])
def test_a_geometric_sequence_is_summed_exactly(process):
    assert process([2 - mpmath.mpf(2) ** -n for n in range(5)]) == 2


def around(values, size, chance):
    """A box, exact in binary, that holds the values: the first bounce and the gaps."""
    half = 2.0**-size
    return tuple((round((x + chance.uniform(-0.9, 0.9) * half) * 2**40) / 2**40, half) for x in values)


def triangle(lam):
    """A cycle of period 3 of the egg of alpha = 2/25, begun so that its first gap is the largest."""
    found = refined(Problem(egg(3).at(alpha=ALPHA), (0, 0, 0), lam=lam), [1.05, 3.14, 5.24], 20)
    z = [float(x) for x in found.z]
    gaps = [(b - a) % (2 * math.pi) for a, b in pairwise([*z, z[0]])]
    first = max(range(3), key=gaps.__getitem__)
    return (z[first] + math.pi) % (2 * math.pi) - math.pi, gaps[first], gaps[(first + 1) % 3]


def sides(angle):
    """What `polygon_kernel` generates for a triangle, without slopes and with them, of any angle of a chord."""
    ends = [(i, (i + step) % 3) for step in (1, -1) for i in range(3)]
    return [lambda *at, n=n: [x for i, j in ends for x in angle(at[i], at[j])[:n]] for n in (1, 3)]


def test_no_box_that_holds_a_cycle_is_settled_and_boxes_beside_it_are():
    """Of the egg's triangle, in boxes of all sizes, by both proofs that there are no others."""
    lam, chance = Rational(1, 2), random.Random(1)
    held, table = triangle(lam), egg(3).at(alpha=ALPHA)
    beside = held[0], held[1] + 0.05, held[2] - 0.05
    with working(64):
        angle, half = load(chord_kernel(table, 0, 0, 1), balls(64)), arb("0.5")
        gap = least_gap(angle, half * arb.pi() / 2)
        both = [load(polygon_kernel(table, 3, order), balls(64)) for order in (0, 1)]
        ways = None, load(polar_polygon_kernel(table, 3), balls(64))
        cover = Cover(Problem(table, (0, 0, 0), lam=half), angle, reflection(PAPERS_LAW, half, table), gap, [])
        largest = half * arb.pi() / (1 + half)
        for size in range(4, 28):
            assert not cover.settled(box := around(held, size, chance), 1)
            assert not any(triangles._impossible(*both, largest, half, gap, box, closer) for closer in ways)
        for size in range(9, 20):
            box = around(beside, size, chance)
            assert cover.settled(box, 1)
            assert all(triangles._impossible(*both, largest, half, gap, box, closer) for closer in ways)


@pytest.mark.parametrize("n", [2, 3, 5])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_matrix_of_a_chain_is_the_chain(n, sign):
    chain = Chain(
        [arb(2 + 7 * i) for i in range(n)], [arb(3 + i * i) for i in range(n)], [arb(5 - i) for i in range(n)], sign
    )
    x = [arb(k + 1) ** 2 for k in range(n)]
    product = dense(chain) * arb_mat([[each] for each in x])

    assert [product[i, 0] for i in range(n)] == chain.times(x)


def test_the_pieces_of_a_stretch_touch_and_cover_it_and_are_short():
    for low, high, longest in ((0.0, 1.0, 0.3), (-2.0, -1.9, 0.01), (3.0, 3.5, 7.0)):
        pieces = cuts(low, high, longest)
        assert pieces[0].contains(arb(low))
        assert pieces[-1].contains(arb(high))
        assert all(a.overlaps(b) for a, b in pairwise(pieces))
        assert all(2 * piece.rad() < longest * 1.001 for piece in pieces)
        assert all(arb(low - 1e-9) < piece < arb(high + 1e-9) for piece in pieces)


def test_the_contractions_asked_along_a_curve_cover_all_of_them(monkeypatch):
    asked = []
    monkeypatch.setattr(bifurcation, "_supercritical", lambda K, lam, alpha: lam.rad() < 0.1 and not asked.append(lam))

    assert doubling_curve().supercritical is True
    for k in range(101):
        assert any(lam.contains(arb(k) / 100) or lam.overlaps(arb(k) / 100) for lam in asked)


def test_a_cycle_run_through_twice_is_none_of_twice_the_period():
    """The axis, twice: the box holds it alone, and over all of these contractions nothing is proved of period 4."""
    table = egg(3).at(alpha=ALPHA)
    axis = {n: over_interval(table, (0,) * n, [0, math.pi] * (n // 2), (0.2, 0.201), Stability.SADDLE) for n in (2, 4)}

    assert axis[2].proved
    assert not axis[4].proved


@pytest.mark.parametrize("box", [((0.0, 1.0), (0.0625, 0.0625)), ((0.25, 0.5), (0.03125, 0.25))])
def test_the_halves_of_a_box_cover_it(box):
    (c, wide), (shape, high) = box
    for x, y in product(np.linspace(c - wide, c + wide, 21), np.linspace(shape - high, shape + high, 21)):
        assert any(abs(x - m) <= r and abs(y - n) <= q for (m, r), (n, q) in slap.halves(box))


class Fixed:
    """In the place of flights, a map of arc and wall that three times stretches the distance from one point."""

    def __init__(self, at):
        self.ends, self.odd, self.at = {ARC: arb(1), WALL: arb(1)}, True, at

    def iterated(self, pieces, n):
        return [replace(piece, theta=3 * (piece.theta - self.at) + self.at, slope=arb(3)) for piece in pieces]


@pytest.mark.parametrize("at", [0.01, 0.3, 0.98])
def test_a_fixed_point_is_found_wherever_it_is_on_the_half_that_is_asked(monkeypatch, at):
    monkeypatch.setattr(slap, "Flights", lambda: Fixed(at))

    for part in (ARC, WALL):
        assert any(c == part and low <= at <= high for c, low, high in periodic_points(1).stretches)


def test_a_fourth_power_of_the_multiplier_that_may_be_1_leaves_the_islands_open():
    held = {trace: bifurcation.Twist(arb(trace, 0.01), arb(1), arb(0)).islands for trace in (-2.0, -1.0, 0.0, 0.5, 2.0)}

    assert held == {-2.0: None, -1.0: None, 0.0: None, 0.5: True, 2.0: None}


@pytest.mark.parametrize(
    ("gaps", "asked"), [((2.5, 1.5), True), ((2.5, 2.25), True), ((1.5, 2.5), False), ((2.0, 1.75), False)]
)
def test_a_triangle_is_asked_from_its_largest_gap_on(gaps, asked):
    """Where every chord leaves along the normal, nothing but the order of the three gaps, of 2*pi, excludes a box."""
    normal = lambda here, there: (arb(0), arb(0), arb(0))  # noqa: E731
    box = ((0.0, 2.0**-8), *((gap, 2.0**-8) for gap in gaps))

    assert triangles._impossible(*sides(normal), arb(1), arb("0.5"), 0.25, box) is not asked


def made_up(values):
    """A chord angle that has given values: a polynomial of both parameters, with its derivatives."""
    pairs, powers = sorted(values), list(product(range(3), repeat=2))
    c = np.linalg.lstsq([[h**a * t**b for a, b in powers] for h, t in pairs], [values[pair] for pair in pairs])[0]
    terms = [(arb(float(x)), a, b) for x, (a, b) in zip(c, powers, strict=True)]

    def angle(h, t):
        by_here = sum(x * a * h ** max(a - 1, 0) * t**b for x, a, b in terms)
        by_there = sum(x * b * h**a * t ** max(b - 1, 0) for x, a, b in terms)
        return sum(x * h**a * t**b for x, a, b in terms), by_here, by_there

    return angle


def test_no_triangle_without_symmetry_is_excluded_and_one_that_breaks_a_rule_is(monkeypatch):
    """Angles made up so that a triangle with three different gaps obeys all rules, or all but one of them.

    A box around it is then excluded when it is small; much smaller ones would do without the mean-value theorem.
    """
    chance, ratio, contraction = random.Random(2), arb("0.5"), 0.4
    monkeypatch.setattr(newton, "krawczyk", lambda *_: newton.Enclosure(Status.UNKNOWN, []))
    problem, total = Problem(egg(3).at(alpha=ALPHA), (0,) * 3, lam=arb(contraction)), math.pi * 0.4 / 1.4
    for _ in range(6):
        gap = chance.uniform(2.2, 2.6)
        held = chance.uniform(-1, 1), gap, chance.uniform(2 * math.pi - 2 * gap + 0.1, gap - 0.1)
        at, phi = list(accumulate(held)), [total * chance.uniform(0.03, 0.2), total * chance.uniform(0.1, 0.5)]
        phi.append(total - sum(phi))
        for broken in (None, 0, 1, 2):
            eta = [-p / contraction * (1.05 if i == broken else 1) for i, p in enumerate(phi)]
            values = {(at[i], at[(i + 1) % 3]): phi[i] for i in range(3)} | {
                (at[i], at[i - 1]): eta[i] for i in range(3)
            }
            with working(64):
                angle, largest = made_up(values), ratio * arb.pi() / (1 + ratio)
                cover = Cover(problem, angle, reflection(PAPERS_LAW, arb(contraction), problem.table), 0.5, [])
                for size in (*range(2, 14), 22, 26):
                    box = around(held, size, chance)
                    exact, wide = accumulate(arb(m) for m, _ in box), accumulate(arb(m, r) for m, r in box)
                    excluded = {
                        triangles._impossible(*sides(angle), largest, ratio, 0.5, box),
                        cover._impossible(box, list(exact), list(wide)),
                    }
                    assert True not in excluded or broken is not None
                    assert False not in excluded or broken is None or size < 10


def test_a_sign_is_told_only_of_what_is_finite_and_off_zero():
    for text, sign in (("2 +/- 1", 1), ("-2 +/- 1", -1), ("0 +/- 1", 0), ("0", 0), ("nan", 0), ("1 +/- inf", 0)):
        assert slap._sign(arb(text)) == sign
