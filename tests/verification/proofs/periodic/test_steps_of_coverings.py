"""That there are no other cycles, step by step: the boxes that are asked, what settles one, and Krawczyk's operator."""

import itertools
import math
import random
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from symbolic.tables import circle, egg, ellipse
from symbolic.tables.law import PAPERS_LAW, Law
from verification.arithmetic.balls import working
from verification.cycles.newton import floats
from verification.cycles.problem import Problem
from verification.proofs.periodic import interval_newton as newton
from verification.proofs.periodic.interval_newton import Completeness, Cover, Enclosure, Status, krawczyk, no_others

EGG = egg(3).at(alpha="2/25")
SMOOTH = {"closes_smoothly": True, "convex": True, "least_gap": 0.5}


class Covered:
    """In the place of a cover: boxes are settled once they are short, and away from `hole` in one number of turns."""

    def __init__(self, most, hole=None, of_turns=0):
        self.most, self.hole, self.of_turns, self.asked = most, hole, of_turns, []

    def settled(self, box, turns):
        self.asked.append((box, turns))
        held = self.hole is not None and turns == self.of_turns
        held = held and all(abs(x - m) <= half for x, (m, half) in zip(self.hole, box, strict=True))
        return not held and all(half <= self.most for _, half in box)


def asked_of(monkeypatch, cover, law=PAPERS_LAW, n=3, box=((0.0, 1.0), (3.0, 0.5), (3.0, 0.25)), budget=4000, **other):
    """What is said of a period when the steps say so, and what they were given."""
    given = {}
    answers = SMOOTH | other
    monkeypatch.setattr(newton, "closes_smoothly", lambda table: answers["closes_smoothly"])
    monkeypatch.setattr(newton, "convex", lambda table: answers["convex"])
    monkeypatch.setattr(
        newton, "least_gap", lambda angle, largest: given.update(largest=largest) or answers["least_gap"]
    )
    monkeypatch.setattr(newton, "steepest", lambda law, reflected: arb(7))
    monkeypatch.setattr(newton, "neighbourhoods", lambda catalogue, problem: [problem])
    monkeypatch.setattr(newton, "Cover", lambda *parts: given.update(parts=parts) or cover)
    monkeypatch.setattr(newton, "start", lambda *asked: given.update(start=asked) or box)
    catalogue = SimpleNamespace(table=ellipse.at(a="3/2"), count=lambda n: 5, law=law)
    return no_others(catalogue, Rational(1, 4), n, budget), given


@pytest.mark.parametrize("failing", [{"closes_smoothly": False}, {"convex": None}, {"least_gap": 0}])
def test_a_period_is_not_asked_about_where_a_hypothesis_fails(monkeypatch, failing):
    cover = Covered(1.0)
    assert asked_of(monkeypatch, cover, **failing)[0] == Completeness(3, None, 0, 5)
    assert cover.asked == []
    assert asked_of(monkeypatch, cover)[0] == Completeness(3, True, 2, 5)


@pytest.mark.parametrize(
    ("law", "asked"),
    [
        ("-lam*eta", True),
        ("-lam*eta*(1 - eta**2/8)", True),
        ("-lam*eta + cos(theta)/20", True),
        ("-lam*eta + sin(s)/30", True),
        ("-lam*eta + theta/20", False),
    ],
)
def test_a_law_of_the_place_is_one_that_a_turn_repeats_or_of_arc_length(monkeypatch, law, asked):
    law, cover = Law(law), Covered(1.0)
    found, given = asked_of(monkeypatch, cover, law)
    assert found == Completeness(3, True if asked else None, 2 if asked else 0, 5)
    if asked:
        assert given["largest"].overlaps(arb.pi() / 8 if law.uniform else arb(7))
        assert given["start"] == (1 if law.placed else 2, 3, 0.5)  # an ellipse is the same after half a turn
        problem, angle, reflected, gap, holds = given["parts"]
        assert (gap, holds) == (0.5, [problem])
        assert problem.components == (0, 0, 0)
        assert problem.lam == 0.25
        assert problem.law == law.on(problem.table)
        assert len(angle(arb(1), arb(3))) == 3
        assert len(reflected(arb(0.5), arb(1))) == 1


def test_every_number_of_turns_has_its_boxes_and_the_longest_side_is_halved(monkeypatch):
    for n, box in ((2, ((0.0, 1.0), (3.0, 0.5))), (4, ((0.0, 1.0), *[(3.0, 0.5)] * 3))):
        cover = Covered(0.5)
        assert asked_of(monkeypatch, cover, n=n, box=box)[0] == Completeness(n, True, 3 * (n - 1), 5)
        assert [turns for _, turns in cover.asked] == [turns for turns in range(1, n) for _ in range(3)]
        whole, *parts = [box for box, _ in cover.asked[:3]]
        assert whole == box
        assert sorted(parts) == [((x, 0.5), *box[1:]) for x in (-0.5, 0.5)]


@pytest.mark.parametrize("hole", [(-1.0, 3.5), (1.0, 2.5), (0.2, 3.1)])
@pytest.mark.parametrize("turns", [1, 2])
def test_a_period_stays_open_while_one_point_of_one_box_is_not_settled(monkeypatch, hole, turns):
    box = ((0.0, 1.0), (3.0, 0.5), (3.0, 0.25))
    cover = Covered(0.5, (*hole, 3.25), turns)
    found, _ = asked_of(monkeypatch, cover, box=box)
    assert found.complete is None
    assert found.known == 5
    assert min(half for box, _ in cover.asked for _, half in box) < newton.SMALLEST
    assert {asked for _, asked in cover.asked} == set(range(1, turns + 1))


def test_a_budget_is_of_boxes(monkeypatch):
    assert [asked_of(monkeypatch, Covered(0.5), budget=most)[0].complete for most in (5, 6)] == [None, True]


@pytest.mark.parametrize("turn", [1, 2, 3, 5])
@pytest.mark.parametrize("gap", [0.5, 1.0625, 1.5])
def test_the_first_box_holds_all_chains_up_to_a_turn_of_the_table_and_hardly_more(turn, gap):
    for n in (2, 4):
        (middle, reach), *gaps = newton.start(turn, n, gap)
        assert middle == 0
        assert math.pi / turn <= reach < math.pi / turn + 2.0**-10
        assert len(gaps) == n - 1
        for middle, half in gaps:
            assert middle - half <= gap < middle - half + 0.04
            assert 2 * math.pi - gap <= middle + half < 2 * math.pi - gap + 0.04
            assert all((x * 2**10).is_integer() for x in (middle, half, reach))


def test_a_law_is_told_with_its_slopes_and_of_arc_length_on_either_side_of_its_jump():
    """`phi`, `-d phi/d eta` and `d phi/d theta`, of formulas that are worked out by hand; on a circle `s = theta`."""
    eta, theta, lam = 0.7, 1.3, 0.25
    contraction = arb(lam)
    with working(64):
        ((phi, sigma, drift),) = newton.reflection(PAPERS_LAW, contraction, circle)(arb(eta), arb(theta))
        assert (phi, sigma, drift) == (arb(-lam) * arb(eta), contraction, 0)
        placed = Law("-lam*eta*(1 - eta**2/8) + sin(2*theta)/20")
        ((phi, sigma, drift),) = newton.reflection(placed, contraction, circle)(arb(eta), arb(theta))
        assert float(phi) == pytest.approx(-lam * eta * (1 - eta**2 / 8) + math.sin(2 * theta) / 20, rel=1e-14)
        assert float(sigma) == pytest.approx(lam * (1 - 3 * eta**2 / 8), rel=1e-14)
        assert float(drift) == pytest.approx(math.cos(2 * theta) / 10, rel=1e-14)
        measured = newton.reflection(Law("-lam*eta + s/20"), contraction, circle)
        ((phi, sigma, drift),) = measured(arb(eta), arb(theta))
        assert float(phi) == pytest.approx(-lam * eta + theta / 20, rel=1e-13)
        assert (float(sigma), float(drift)) == pytest.approx((lam, 1 / 20), rel=1e-13)
        sides = measured(arb(eta), arb(3.1, 0.1))
        values = sorted(float(phi.mid()) for phi, _, _ in sides)
        assert values == pytest.approx([-lam * eta + (3.1 - 2 * math.pi) / 20, -lam * eta + 3.1 / 20], abs=1e-4)


@pytest.mark.parametrize("turns", [-3, -1, 0, 1, 4])
@pytest.mark.parametrize("at", [-3.1, -1.0, 0.0, 2.0, 3.1])
def test_a_ball_of_parameters_is_moved_by_whole_turns_to_the_middle_one(turns, at):
    with working(64):
        first, *beyond = newton.parted(arb(at, 0.1) + 2 * turns * arb.pi())
        assert first.contains(arb(at, 0.0999))
        assert first.rad() < 0.1001
        assert len(beyond) == (abs(at) == 3.1)
        for other in beyond:
            gap = (other - first).mid() + (2 * arb.pi() if at > 0 else -2 * arb.pi())
            assert abs(gap) < 1e-12
        assert len(newton.parted(arb.pi())) == len(newton.parted(-arb.pi())) == 2


@pytest.mark.parametrize("placed", [False, True])
def test_the_steepest_exit_is_asked_of_all_incidence_angles_and_of_places_where_these_matter(placed):
    """Of a law that is steepest in one piece of either; its bound is the upper end of that piece, and of no other."""
    law, asked = SimpleNamespace(placed=placed), []

    def reflected(eta, theta):
        asked.append((eta, theta))
        return [(-arb(0.5), None, None), (eta * eta / 4 - (theta * theta / 100 if placed else 0) - 1, None, None)]

    with working(64):
        quarter = arb.pi() / 2
        found = newton.steepest(law, reflected)
        assert 1 + (0.0986 if placed else 0) <= float(found) < 1.001 + (0.106 if placed else 0)
        angles = [eta for eta, _ in asked][:512]
        assert all(a.overlaps(b) for a, b in itertools.pairwise(angles))
        assert angles[0].overlaps(-quarter)
        assert angles[-1].overlaps(quarter)
        assert all(eta.rad() < 0.0031 for eta in angles)
        places = [theta for _, theta in asked][::512]
        assert len(places) == (64 if placed else 1)
        assert places[0].overlaps(-arb.pi())
        assert places[-1].overlaps(arb.pi())
        assert all(a.overlaps(b) for a, b in itertools.pairwise(places))
        assert all(theta.rad() < (0.0491 if placed else 3.15) for theta in places)
        once = lambda eta, theta: [(arb("inf") if eta.overlaps(quarter) else arb(0), None, None)]  # noqa: E731
        assert newton.steepest(law, once).overlaps(quarter)
        assert newton.steepest(law, lambda *_: [(arb(3, 1), None, None)]) >= 4  # as it is, below a quarter turn or not


def test_a_least_gap_is_the_largest_sixteenth_at_which_chords_both_ways_are_steep():
    asked = []

    def angle(here, there):
        asked.append((here, there))
        gap = (there - here).mid()
        return [1.25 - gap if gap > 0 else -1.25 - gap]  # falls in size with the gap

    with working(64):
        for largest, gap in ((0.0, 1.1875), (0.5, 0.6875), (1.17, 0.0625), (1.1875, 0.0), (0.03, 1.1875), (-1.0, 1.5)):
            asked.clear()
            assert newton.least_gap(angle, arb(largest)) == gap
            places = [here for here, _ in asked[-512::2]]
            if gap:
                assert places[0].overlaps(arb(0))
                assert places[-1].overlaps(2 * arb.pi())
                assert all(a.overlaps(b) for a, b in itertools.pairwise(places))
                assert all(place.rad() < 0.0124 for place in places)
        for way in (1, -1):
            one = lambda here, there, way=way: [arb(way)]  # noqa: E731
            assert newton.least_gap(one, arb(0)) == 0
        hole = lambda here, there: [(there - here) * (0 if here.overlaps(arb(2)) else 1)]  # noqa: E731
        assert newton.least_gap(hole, arb(0)) == 0


def test_a_neighbourhood_is_the_widest_that_is_proved_and_stands_for_each_bounce_of_its_cycle(monkeypatch):
    """A cycle of period 2 asked as one of 4, of which boxes up to 0.1 are proved; and one of which none is."""
    asked = []

    def krawczyk(problem, centre, radii, bits):
        asked.append((centre, radii))
        return Enclosure(Status.UNIQUE if radii[0] < 0.1 and centre[0] < 2 else Status.UNKNOWN, [])

    monkeypatch.setattr(newton, "krawczyk", krawczyk)
    lost, kept = (SimpleNamespace(theta=list(theta), period=2) for theta in ((2.5, 5.5), (0.5, 3.0)))
    catalogue = SimpleNamespace(of=lambda n: [lost, kept])
    found = newton.neighbourhoods(catalogue, Problem(EGG, (0,) * 4, lam=arb("0.5")))
    radius = 0.2 / 1.5 / 1.5
    turn = 2 * math.pi
    assert [r for _, r in found] == pytest.approx([radius] * 2)
    assert found[0][0] == pytest.approx([0.5, 3.0, 0.5, 3.0])
    assert np.remainder(found[1][0], turn) == pytest.approx([3.0, 0.5, 3.0, 0.5])
    assert [r for _, radii in asked[-3:] for r in radii] == pytest.approx([0.2] * 4 + [0.2 / 1.5] * 4 + [radius] * 4)
    assert 1e-7 < min(radii[0] for _, radii in asked) < 1.5e-7 * 1.5
    assert [float(x) for x in asked[-1][0]] == pytest.approx(found[0][0])


GAP = 0.5
TURN = 2 * math.pi


@pytest.mark.parametrize(
    ("gaps", "turns", "settled"),
    [
        ((3.0, 2.0), 1, False),  # 1.283 is left
        ((3.5, 2.5), 1, True),  # 0.283
        ((3.0, 2.0), 2, True),  # more than a turn
        ((4.0, 3.0), 2, True),  # 5.566, longer than the first
        ((5.0, 4.0), 2, False),  # 3.566
        ((3.5, 3.0), 2, True),  # 6.066, as good as a turn
        ((2.0, 2.5), 1, True),  # the second is longer than the first
        ((2.0, 2.0), 1, True),  # the last is, 2.283
        ((2.125, 2.0), 1, False),  # by less than the box is wide
    ],
)
def test_a_box_is_asked_where_its_gaps_may_be_those_of_a_cycle_with_the_largest_first(
    monkeypatch, gaps, turns, settled
):
    box = ((0.25, 0.125), *((gap, 2.0**-5) for gap in gaps))
    for known, impossible in ((False, False), (False, True), (True, False)):
        asked = []
        monkeypatch.setattr(Cover, "_known", lambda self, *given, a=asked, k=known: a.append(given) or k)
        monkeypatch.setattr(Cover, "_impossible", lambda self, *given, a=asked, i=impossible: a.append(given) or i)
        cover = Cover(Problem(circle, (0, 0, 0), lam=arb(1) / 2), None, None, GAP, [])
        assert cover.settled(box, turns) is (settled or known or impossible)
        assert len(asked) == (0 if settled else 1 if known else 2)
        if not settled:
            at = [0.25, 0.25 + gaps[0], 0.25 + sum(gaps)]
            assert asked[0][0] == at
            assert asked[0][1] == pytest.approx([0.125, 0.15625, 0.1875], rel=1e-6)
        if len(asked) == 2:
            found, exact, theta = asked[1]
            assert found == box
            assert [float(x) for x in exact] == at
            assert all(x.is_exact() for x in exact)
            assert [float(x.rad()) for x in theta] == pytest.approx([0.125, 0.15625, 0.1875], rel=1e-6)


class Linear:
    """Angles of chords between neighbours of a chain, and a law at each bounce, linear about the middle of a box."""

    def __init__(self, chance, box, wide):
        self.n, self.wide, self.at = len(box), wide, np.cumsum([m for m, _ in box])
        ends = {(i, (i + way) % self.n) for i in range(self.n) for way in (1, -1)}
        self.angles = {pair: [chance.uniform(-1, 1) for _ in range(3)] for pair in sorted(ends)}
        self.law = [[chance.uniform(-1, 1) for _ in range(3)] for _ in range(self.n)]

    def place(self, theta):
        return int(np.argmin(np.abs(self.at - float(theta.mid()))))

    def ball(self, middle, exact):
        return arb(middle) if exact else arb(middle, self.wide)

    def angle(self, here, there):
        value, *slopes = self.angles[self.place(here), self.place(there)]
        return [self.ball(value, here.is_exact()), *map(arb, slopes)]

    def reflected(self, eta, theta):
        offset, sigma, drift = self.law[self.place(theta)]
        return [(self.ball(offset - sigma * float(eta.mid()), theta.is_exact()), arb(sigma), arb(drift))]

    def decisions(self, radii):
        """How far the rule at each bounce is from holding, by its middle and its slopes."""
        for i in range(self.n):
            before, after = (i - 1) % self.n, (i + 1) % self.n
            (out, out_here, out_there), (into, into_here, into_there) = self.angles[i, after], self.angles[i, before]
            offset, sigma, drift = self.law[i]
            slope = np.zeros(self.n)
            slope[i] += out_here + sigma * into_here - drift
            slope[before] += sigma * into_there
            slope[after] += out_there
            by_gaps = slope @ np.tril(np.ones((self.n, self.n)))
            yield abs(out - offset + sigma * into) - np.abs(by_gaps) @ radii


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_box_is_impossible_where_one_rule_fails_by_its_middle_and_slopes(monkeypatch, n):
    """Linear angles and laws, enclosed so widely that their values exclude nothing; Krawczyk's operator neither."""
    monkeypatch.setattr(newton, "krawczyk", lambda *_: Enclosure(Status.UNKNOWN, []))
    chance, seen = random.Random(n), [0, 0]
    problem = Problem(circle, (0,) * n, lam=arb(1) / 2)
    while min(seen) < 25:
        radii = [2.0 ** chance.randint(-5, 0) for _ in range(n)]
        box = tuple(zip((chance.randint(-8, 8) / 8, *[2.0] * (n - 1)), radii, strict=True))
        made = Linear(chance, box, 5.0)
        decisions = list(made.decisions(np.array(radii)))
        if min(map(abs, decisions)) < 1e-9:
            continue
        exact = [arb(x) for x in made.at]
        wide = [arb(x, r) for x, r in zip(made.at, np.cumsum(radii), strict=True)]
        with working(64):
            found = Cover(problem, made.angle, made.reflected, GAP, [])._impossible(box, exact, wide)
        wanted = bool(max(decisions) > 0)
        assert found is wanted
        seen[wanted] += 1


@pytest.mark.parametrize("at", range(3))
def test_a_rule_that_cannot_hold_at_one_bounce_settles_a_box_and_one_that_is_not_known_does_not(monkeypatch, at):
    """By values alone; of a law on two sides of its jump neither may hold."""
    monkeypatch.setattr(newton, "krawczyk", lambda *_: Enclosure(Status.UNKNOWN, []))
    box, exact = ((0.0, 0.125), (2.0, 0.125), (2.0, 0.125)), [arb(0), arb(2), arb(4)]
    wide = [arb(x, r) for x, r in ((0, 0.125), (2, 0.25), (4, 0.375))]
    problem = Problem(circle, (0, 0, 0), lam=arb(1) / 2)
    angle = lambda here, there: [arb(0, 1)] * 3  # noqa: E731
    for exits, settled in (
        (["0 +/- 1"], False),
        (["3 +/- 1"], True),
        (["-3 +/- 1"], True),
        (["3 +/- 1", "-3 +/- 1"], True),
        (["3 +/- 1", "0 +/- 1"], False),
        (["0 +/- 1", "3 +/- 1"], False),
        (["nan"], False),
        (["3 +/- 1", "nan"], False),
    ):
        told = lambda eta, theta, exits=exits: [  # noqa: E731
            (arb(x), arb(0, 9), arb(0, 9)) for x in (exits if theta.overlaps(exact[at]) else ["0 +/- 1"])
        ]
        assert Cover(problem, angle, told, GAP, [])._impossible(box, exact, wide) is settled


def test_derivatives_by_gaps_are_sums_over_the_bounces_that_move_with_them():
    assert newton._by_gaps({0: arb(1), 1: arb(10), 2: arb(100)}, 3) == [111, 110, 100]
    assert newton._by_gaps({1: arb(10)}, 3) == [10, 10, 0]


def test_an_image_that_reaches_an_end_of_a_box_is_not_inside_it():
    box = [arb(0, 1)] * 2
    end = box[0].rad()  # a little more than 1
    for image in ([end, arb(0)], [arb(0), -end], [end, end], [arb(0, 1), arb(0)]):
        assert newton.compared(image, box) is Status.UNKNOWN
    assert newton.compared([end * (1 - arb(2) ** -20)] * 2, box) is Status.UNIQUE
    assert newton.compared([arb(0), end * (1 + arb(2) ** -20)], box) is Status.EMPTY
    assert newton.slope_bits(1) == 136


@pytest.mark.parametrize("off", [0.0, 0.3, -0.3])
@pytest.mark.parametrize("half", [0.0, 1e-4])
def test_krawczyks_operator_holds_the_cycle_of_each_contraction_and_is_hardly_wider_than_it_moves(off, half):
    """The egg's triangle, which has no symmetry, in a box that is moved by a part of its size."""
    near, radius = [-0.2, 1.9, 4.0], 0.002
    cycles = [floats(Problem(EGG, (0, 0, 0), lam=Rational(lam)), near) for lam in (0.4 - half, 0.4, 0.4 + half)]
    centre = [arb(x + off * radius) for x in cycles[1]]
    with working(64):
        found = krawczyk(Problem(EGG, (0, 0, 0), lam=arb(0.4, half)), centre, [radius] * 3, 64)
        assert found.status is Status.UNIQUE
        for k, image in enumerate(found.zero):
            places = [cycle[k] for cycle in cycles]
            assert all(image.overlaps(arb(x, 1e-14)) for x in places)
            moved = (max(places) - min(places)) / 2
            assert float(image.rad()) < 1.3 * moved + radius / 6
