"""That there are no triangles, step by step: what is covered, what excludes a box, what a witness says."""

import itertools
import math
import random
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from sympy import Integer, Rational, atan, tan

from symbolic.cycles.polygons import characteristic_on_branch
from symbolic.tables import egg
from symbolic.tables.table import alpha as letter
from verification.arithmetic.balls import balls, working
from verification.proofs.periodic import triangles
from verification.proofs.periodic.interval_newton import Enclosure, Status
from verification.proofs.periodic.triangles import Exclusion, Witness

ALPHA = Rational(2, 25)
GAPS_OF_PARAMETERS = np.array([[1.0, 0, 0], [1, 1, 0], [1, 1, 1]])  # bounces by the first one and the two gaps


class Linear:
    """Angles of a triangle that are linear about the middle of a box, each known only up to `wide` over all of it."""

    def __init__(self, chance, box, wide):
        (first, _), (one, _), (two, _) = box
        self.at = [first, first + one, first + one + two]
        self.phi, self.eta = (np.array([chance.uniform(*ends) for _ in range(3)]) for ends in ((0, 0.5), (-0.9, 0.9)))
        self.here, self.there = (np.array([chance.uniform(-1, 1) for _ in range(6)]) for _ in range(2))
        self.wide = wide

    def ends(self):
        """Of each of the six angles the bounce that it is at, and the other end of its chord."""
        return [(i, (i + way) % 3) for way in (1, -1) for i in range(3)]

    def values(self, *theta):
        exact = all(x.is_exact() for x in theta)
        middles = [*self.phi, *self.eta]
        assert not exact or [float(x) for x in theta] == self.at
        return [arb(m) if exact else arb(m, self.wide) for m in middles]

    def slopes(self, *theta):
        rows = zip(self.here, self.there, strict=True)
        return [x for here, there in rows for x in (arb("nan"), arb(here), arb(there))]

    def matrix(self):
        """Derivatives of the six angles by the three parameters."""
        found = np.zeros((6, 3))
        for k, (i, j) in enumerate(self.ends()):
            found[k, i], found[k, j] = self.here[k], self.there[k]
        return found

    def excluded(self, largest, radii):
        """By the mean-value theorem, worked out in floats; and how near the nearest of these decisions is."""
        slopes, decisions = self.matrix(), []
        sum_by_gaps = slopes[:3].sum(axis=0) @ GAPS_OF_PARAMETERS
        decisions.append(self.phi.sum() - np.abs(sum_by_gaps) @ radii - largest)
        for i, j in ((0, 1), (1, 2), (2, 0)):
            by = slopes[[i, j, 3 + i, 3 + j]]
            factors = np.array([self.eta[j], -self.eta[i], -self.phi[j], self.phi[i]])
            middle = (factors @ by) @ GAPS_OF_PARAMETERS
            spread = (self.wide * np.abs(by).sum(axis=0)) @ GAPS_OF_PARAMETERS
            value = self.phi[i] * self.eta[j] - self.phi[j] * self.eta[i]
            decisions.append(abs(value) - (np.abs(middle) + spread) @ radii)
        return bool(max(decisions) > 0), min(map(abs, decisions))


@pytest.mark.parametrize("seed", range(3))
def test_boxes_are_excluded_by_their_middle_and_slopes_as_the_mean_value_theorem_says(seed):
    """Of linear angles, which are enclosed so widely that nothing but their slopes excludes anything."""
    chance, seen = random.Random(seed), [0, 0]
    while min(seen) < 25:
        radii = [2.0 ** chance.randint(-9, -3) for _ in range(3)]
        box = tuple(zip((chance.randint(-8, 8) / 8, 2.5, 2.0), radii, strict=True))
        made, largest = Linear(chance, box, 0.95), chance.choice([1.0, 1.5, 2.0])
        wanted, margin = made.excluded(largest, np.array(radii))
        if margin < 1e-9:
            continue
        with working(64):
            found = triangles._impossible(made.values, made.slopes, arb(largest), arb(1), 0.25, box)
        assert found is wanted
        seen[wanted] += 1


def test_a_box_that_no_rule_excludes_stays_whatever_is_not_finite():
    box = ((0.5, 2.0**-10), (2.5, 2.0**-10), (2.0, 2.0**-10))
    for k in range(6):
        values = [arb("nan") if i == k else arb(0) for i in range(6)]
        assert triangles._impossible(lambda *_, v=values: v, None, arb(1), arb(1), 0.25, box) is False


@pytest.mark.parametrize("at", range(3))
def test_one_rule_at_one_bounce_excludes_a_box_where_the_angles_are_known_over_all_of_it(at):
    """The sum of the exit angles, and each incidence angle: of slopes nothing is known, and the middle is free."""
    box = ((0.5, 2.0**-10), (2.5, 2.0**-10), (2.0, 2.0**-10))
    unknown = lambda *_: [arb(0, 1e9)] * 18  # noqa: E731

    def excluded(phi, eta):
        values = lambda *z: [arb(0)] * 6 if z[0].is_exact() else [*map(arb, phi), *map(arb, eta)]  # noqa: E731
        return triangles._impossible(values, unknown, arb(1), arb("0.5"), 0.25, box)

    phi = [0.4 if k == at else 0.35 for k in range(3)]
    assert excluded(phi, [-1] * 3)
    assert not excluded([0.4 if k == at else 0.25 for k in range(3)], [-1] * 3)
    for wrong in (1, -0.5):  # of the other sign, or too small for the largest contraction
        assert excluded([0.3] * 3, [wrong if k == at else -1 for k in range(3)])


@pytest.mark.parametrize(
    ("gaps", "gap", "settled"),
    [
        ((2.5, 2.0), 1.75, False),  # 1.783 is left
        ((2.5, 2.0), 1.875, True),
        ((2.0, 2.25), 0.25, True),  # the second is longer
        ((2.25, 2.5), 0.25, True),
        ((2.0, 2.0), 0.25, True),  # the third is
        ((2.0, 1.75), 0.25, True),
        ((2.125, 2.09375), 0.25, False),  # by less than the box is wide
        ((2.09375, 2.125), 0.25, False),
    ],
)
def test_a_box_is_asked_where_its_first_gap_may_be_the_largest_and_its_last_is_long_enough(gaps, gap, settled):
    free = lambda *_: [arb(0, 1)] * 6  # noqa: E731
    slopes = lambda *_: [arb(0, 1)] * 18  # noqa: E731
    box = ((0.5, 2.0**-6), *((x, 2.0**-6) for x in gaps))
    assert triangles._impossible(free, slopes, arb(1), arb(1), gap, box) is settled


def test_angles_are_asked_at_the_three_bounces_and_the_three_gaps():
    given, turn = [], 2 * float(arb.pi())
    box = ((0.5, 0.125), (2.5, 0.25), (2.0, 0.0625))

    def closer(*z):
        given.append(z)
        return [arb(0, 1)] * 6 + [arb(1)] * 6

    slopes = lambda *theta: given.append(theta) or [arb(0, 1)] * 18  # noqa: E731
    middle = lambda *theta: given.append(theta) or [arb(0)] * 6  # noqa: E731
    assert triangles._impossible(middle, slopes, arb(1), arb(1), 0.25, box, closer) is False
    wide, sloped, exact = given
    for found, wanted in (
        (wide, [(0.5, 0.125), (3, 0.375), (5, 0.4375), (2.5, 0.25), (2, 0.0625), (turn - 4.5, 0.3125)]),
        (sloped, [(0.5, 0.125), (3, 0.375), (5, 0.4375)]),
        (exact, [(0.5, 0), (3, 0), (5, 0)]),
    ):
        assert [float(x.mid()) for x in found] == pytest.approx([m for m, _ in wanted], abs=1e-15)
        assert [float(x.rad()) for x in found] == pytest.approx([r for _, r in wanted], rel=1e-6, abs=1e-15)


def cover(impossible, start, budget=1000):
    told = []
    return triangles._subdivided(impossible, start, budget, told.append), told


START = ((0.0, 1.0), (2.0, 0.5), (1.0, 0.25))


def test_a_box_is_halved_along_its_longest_side_until_all_of_it_is_excluded():
    asked = []

    def small(box):
        asked.append(box)
        return max(half for _, half in box) <= 0.25

    found, told = cover(small, START)
    assert (found.excluded, found.boxes, found.share, found.smallest) == (True, 15, 1.0, 0.25)  # 4*2*1 of 15
    assert told == [0.125] * 8
    leaves = [box for box in asked if max(half for _, half in box) <= 0.25]
    assert sorted(box[0] for box in leaves) == sorted([(x, 0.25) for x in (-0.75, -0.25, 0.25, 0.75)] * 2)
    assert {box[1] for box in leaves} == {(1.75, 0.25), (2.25, 0.25)}
    assert {box[2] for box in leaves} == {(1.0, 0.25)}
    assert cover(small, START, budget=14)[0].excluded is None
    assert cover(small, START, budget=15)[0].excluded is True
    assert cover(lambda box: True, START)[0] == Exclusion(True, 1, 1.0, 1.0)


@pytest.mark.parametrize("at", [(-1.0, 1.5, 0.75), (1.0, 2.5, 1.25), (0.0, 2.0, 1.0), (0.3, 1.7, 1.1)])
def test_a_set_of_boxes_is_not_excluded_while_one_of_its_points_is_not(at):
    holds = lambda box: all(abs(x - m) <= half for x, (m, half) in zip(at, box, strict=True))  # noqa: E731
    found, _ = cover(lambda box: not holds(box), START)
    assert found.excluded is None
    assert found.smallest < triangles.SMALLEST


@pytest.mark.parametrize(("K", "most"), [(3, Rational(1, 4)), (3, Integer(0)), (5, Rational(1, 2)), (8, Integer(1))])
@pytest.mark.parametrize("gap", [0.25, 1.5])
def test_all_triangles_up_to_a_turn_of_the_egg_are_in_the_box_that_is_covered(monkeypatch, K, most, gap):
    """Whose ends are exact in binary; and each formula is asked what it is for."""
    given, allowed, own = {}, [], triangles.load

    def subdivided(excluded, start, budget, tick):
        given["start"] = start
        excluded(start)
        return Exclusion(True, 1, 1.0, 1.0)

    monkeypatch.setattr(triangles, "egg", lambda K: SimpleNamespace(at=lambda alpha: (K, alpha)))
    monkeypatch.setattr(triangles, "convex", lambda table: True)
    for name in ("chord_kernel", "polygon_kernel", "polar_polygon_kernel"):
        monkeypatch.setattr(triangles, name, lambda *of, name=name: (name, *of))
    monkeypatch.setattr(triangles, "load", lambda made, words: made if isinstance(made, tuple) else own(made, words))
    monkeypatch.setattr(triangles, "_subdivided", subdivided)
    monkeypatch.setattr(triangles, "_gap", lambda angle, largest: allowed.append((angle, largest)) or gap)
    monkeypatch.setattr(triangles, "_impossible", lambda *asked, closer: given.update(asked=asked, closer=closer))
    assert triangles.no_triangles(ALPHA, most, K).excluded is True
    (first, reach), *others = given["start"]
    assert first - reach <= 0
    assert 2 * math.pi / K <= first + reach < 2 * math.pi / K + 0.04
    for middle, half in others:
        assert middle - half <= gap
        assert 2 * math.pi - gap <= middle + half < 2 * math.pi - gap + 0.02
    assert all((256 * x).is_integer() for ends in given["start"] for x in ends)
    angles, slopes, largest, ratio, least, box = given["asked"]
    assert (least, box) == (gap, given["start"])
    assert ratio.overlaps(arb(int(most.p)) / int(most.q))
    assert largest.overlaps(arb.pi() * int(most.p) / int(most.p + most.q))
    assert largest.rad() < 1e-15
    table = K, ALPHA
    assert allowed[0][0] == ("chord_kernel", table, 0, 0, 0)
    assert allowed[0][1].overlaps(largest)
    assert (angles, slopes) == tuple(("polygon_kernel", table, 3, order) for order in (0, 1))
    assert given["closer"] == ("polar_polygon_kernel", table, 3)


def test_where_a_table_is_not_proved_convex_nothing_is_asked(monkeypatch):
    monkeypatch.setattr(triangles, "convex", lambda table: None)
    assert triangles.no_triangles(ALPHA, Rational(1, 4)) == Exclusion(None, 0, 0.0, 0.0)


def test_a_gap_is_the_largest_sixteenth_at_which_all_chords_leave_more_steeply_than_the_bound():
    """All around in pieces that touch; the chord is as long as the gap."""
    asked = []

    def angle(here, there):
        asked.append((here, there))
        return [arb(1.25) - (there - here).mid()]  # falls with the gap

    for largest, gap in ((0.0, 1.1875), (0.5, 0.6875), (1.17, 0.0625), (1.1875, 0.0), (0.03, 1.1875), (-1.0, 1.5)):
        asked.clear()
        assert triangles._gap(angle, arb(largest)) == gap
        if gap:
            places = [here for here, _ in asked[-400:]]
            assert places[0].overlaps(arb(0))
            assert places[-1].overlaps(2 * arb.pi())
            assert all(a.overlaps(b) for a, b in itertools.pairwise(places))
            assert all(place.rad() < 0.01 for place in places)


@pytest.mark.parametrize("hole", [None, 0.0, 0.4, 1.0])
def test_the_branch_of_triangles_is_asked_from_one_end_to_the_other(monkeypatch, hole):
    """In pieces of its length 3, of which those are positive that are short and beside the hole."""
    asked, formulas = [], {}

    def at(x):
        asked.append(x)
        inside = hole is not None and x.overlaps(3 * arb(hole))
        return [arb(1) if x.rad() < 0.4 and not inside else arb(0) if x.rad() < 0.4 else arb(1, 2)]

    monkeypatch.setattr(triangles, "load", lambda kernel, words: (lambda: [arb(3)]) if not kernel.arguments else at)
    monkeypatch.setattr(
        triangles, "kernel", lambda name, letters, terms: formulas.update(terms) or SimpleNamespace(arguments=letters)
    )
    assert triangles.flips_nowhere(ALPHA, budget=60) is (True if hole is None else None)
    assert formulas["value"] == characteristic_on_branch(triangles.theta, Integer(-1)).subs(letter, ALPHA)
    assert formulas["fold"] == triangles.acos_of(ALPHA)
    if hole is None:
        assert len(asked) == 7
        short = sorted((x for x in asked if x.rad() < 0.4), key=lambda x: float(x.mid()))
        assert [float(x.mid()) for x in short] == [0.375, 1.125, 1.875, 2.625]
        assert all(x.contains(arb(m, 0.374)) for x, m in zip(short, (0.375, 1.125, 1.875, 2.625), strict=True))
        assert triangles.flips_nowhere(ALPHA, budget=7) is True
        assert triangles.flips_nowhere(ALPHA, budget=6) is None


@pytest.mark.parametrize("alpha", [0, Rational(2, 25), Rational(1, 3), Rational(9, 10)])
def test_the_angle_of_a_cosine_is_written_in_words_of_the_kernels(alpha):
    assert float(triangles.acos_of(Rational(alpha))) == pytest.approx(math.acos(alpha), rel=1e-14)


@pytest.mark.parametrize(("largest", "grows"), [(Rational(86, 100), True), (Rational(861, 1000), False), (1, False)])
def test_an_angle_times_its_cosine_grows_up_to_the_root_of_x_tan_x(monkeypatch, largest, grows):
    """`x*tan(x) = 1` at 0.86033: the largest angle is half a turn and the tilt, which are made up."""
    monkeypatch.setattr(triangles, "half_turn", lambda: Rational(1, 2))
    monkeypatch.setattr(triangles, "largest_tilt", lambda: tan(largest - Rational(1, 2)))
    assert triangles.contracts(ALPHA) is grows
    assert atan(0) == 0


@pytest.mark.parametrize(("status", "exists"), [(Status.UNIQUE, True), (Status.EMPTY, None), (Status.UNKNOWN, None)])
@pytest.mark.parametrize("lam", [Rational(0), Rational(3, 10), Rational(1, 2), Rational(99, 100)])
def test_a_witness_exists_where_one_zero_is_proved_and_is_produced_up_to_its_angle(monkeypatch, status, exists, lam):
    """Of made-up bounces: the exit angle of the first chord, and the bound `lam*pi/2` of what a collision produces."""
    boxes = []
    monkeypatch.setattr(triangles, "refined", lambda system, near, digits: SimpleNamespace(z=near))
    monkeypatch.setattr(triangles, "exact_balls", lambda z: [arb(x) for x in z])

    def newton(system, centre, radius, bits):
        boxes.append((centre, radius))
        return Enclosure(status, [arb(2), arb(4)])

    monkeypatch.setattr(triangles, "interval_newton", newton)
    found = triangles.witness(ALPHA, lam, Rational(1, 5), (2.0, 4.0))
    table = egg(3).at(alpha=ALPHA)
    with working(100):
        angle = triangles.load(triangles.chord_kernel(table, 0, 0, 0), balls(100))(arb(1) / 5, arb(2))[0]
        assert found.angle.overlaps(angle)
        assert found.angle.rad() < 1e-20
    assert abs(float(angle)) == pytest.approx(0.688, abs=0.3)
    assert found == Witness(exists, abs(float(angle)) < float(lam) * math.pi / 2, found.angle)
    assert boxes[0][0] == [arb(2), arb(4)]
    assert 1e-23 < float(boxes[0][1]) < 1e-21


def test_a_witness_at_the_bound_of_what_is_produced_is_neither(monkeypatch):
    monkeypatch.setattr(triangles, "refined", lambda system, near, digits: SimpleNamespace(z=near))
    monkeypatch.setattr(triangles, "exact_balls", lambda z: [arb(x) for x in z])
    monkeypatch.setattr(triangles, "interval_newton", lambda *_: Enclosure(Status.UNIQUE, [arb(2, 1), arb(4, 1)]))
    assert triangles.witness(ALPHA, Rational(1, 2), Rational(1, 5), (2.0, 4.0)).produced is None


@pytest.mark.parametrize("lam", [0, Rational(3, 10)])
def test_the_equations_of_a_return_are_the_rule_at_the_second_and_third_bounce(lam):
    table, at = egg(3).at(alpha=ALPHA), [arb(1), arb(3), arb(5)]
    with working(80):
        angle = triangles.load(triangles.chord_kernel(table, 0, 0, 0), balls(80))
        found = triangles.returning(ALPHA, Rational(lam), Rational(1)).equations(balls(80), at[1:])
        share = arb(Rational(lam).p) / Rational(lam).q
        out = [angle(at[k], at[(k + 1) % 3])[0] for k in range(3)]
        back = [angle(at[k], at[k - 1])[0] for k in range(3)]
        for k, value in zip((1, 2), found, strict=True):
            assert abs(value - (out[k] + share * back[k])) < 1e-20
