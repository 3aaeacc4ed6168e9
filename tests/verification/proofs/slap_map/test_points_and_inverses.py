"""Periodic points of slap maps that are given; Ulam's matrix and the defect of an inverse, by hand."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb, arb_series
from scipy.sparse import csc_matrix

from symbolic.cycles.cardioid_slap import branch
from symbolic.expressions.text import load
from verification.arithmetic.balls import FLOAT64, working
from verification.arithmetic.series import taylor
from verification.proofs.corner.return_map import Piece
from verification.proofs.slap_map import exponent, transfer
from verification.proofs.slap_map.exponent import PeriodicPoints, halves, periodic_points
from verification.proofs.slap_map.transfer import BLANKET, GRAIN, UNIT, Branches, Inverted, Variation

ARC, WALL = 0, 1


def slap(monkeypatch, image, ends=(1.0, 0.5), odd=False):
    """The components reach as far as `ends`; `image(component, theta)` gives component, angle and slope, or None."""
    asked = []

    class Flights:
        def __init__(self):
            self.ends, self.odd = {ARC: arb(ends[0]), WALL: arb(ends[1])}, odd

        def iterated(self, pieces, n):
            (piece,) = pieces
            asked.append((piece, n))
            assert (piece.slope, piece.phi) == (arb(1), arb(0))
            made = image(piece.component, piece.theta)
            return made and [Piece(part, theta, arb(slope), arb(0)) for part, theta, slope in made]

    monkeypatch.setattr(exponent, "Flights", Flights)
    return asked


@pytest.mark.parametrize(("slope", "n"), [(3, 1), (-2, 4), (0.25, 2)])
def test_a_fixed_point_of_an_affine_map_is_in_the_one_stretch_that_is_told(monkeypatch, slope, n):
    """`x -> slope*(x - 0.3) + 0.3` on the arc; the wall is carried to the arc, or elsewhere on the wall."""
    at = arb("0.3")
    for wall in ((ARC, arb(0), 2), (WALL, arb(7), 2)):
        asked = slap(monkeypatch, lambda c, x, wall=wall: [(ARC, slope * (x - at) + at, slope) if c == ARC else wall])
        found = periodic_points(n)
        ((component, low, high),) = found.stretches
        assert component == ARC
        assert low <= 0.3 <= high
        assert high - low < 0.04
        assert {k for _, k in asked} == {n}
        assert len(asked) == found.boxes


def test_all_points_of_all_components_are_asked_for_and_one_half_of_an_odd_map(monkeypatch):
    for odd in (False, True):
        asked = slap(monkeypatch, lambda c, x: [(1 - c, x, 2)], odd=odd)
        assert periodic_points(1) == PeriodicPoints([], 2)  # no point returns to its component
        boxes = {piece.component: piece.theta for piece, _ in asked}
        for component, end in ((ARC, 1.0), (WALL, 0.5)):
            low, high = (float(x) for x in (boxes[component].lower(), boxes[component].upper()))
            assert end < high < end * (1 + 1e-8)
            assert low == pytest.approx(0.0 if odd else -high, abs=1e-8)


def test_the_points_of_an_odd_map_are_told_with_their_mirror_images(monkeypatch):
    """`x -> 4*x - 0.75`, for positive `x`: the fixed point 1/4 has -1/4 beside it."""
    slap(monkeypatch, lambda c, x: [(ARC, 4 * x - arb("0.75"), 4)] if c == ARC else [(ARC, x, 4)], odd=True)
    (first, second) = periodic_points(1).stretches
    assert first[0] == second[0] == ARC
    assert (first[1], first[2]) == (-second[2], -second[1])
    assert second[1] <= 0.25 <= second[2]


@pytest.mark.parametrize(
    "image",
    [
        lambda c, x: [(c, x, 1)],  # each point is fixed, and the slope 1
        lambda c, x: [(c, x * 2, 2), (c, x * 3, 3)],  # of two pieces no slope is told
        lambda c, x: [(c, x * 2, 2), (1 - c, x, 3)],  # one of them returns
        lambda c, x: [(c, arb(9), 2), (c, x * 3, 3)],
        lambda c, x: None,  # what is not enclosed
        lambda c, x: [(c, x * 2, arb("nan"))],
        lambda c, x: [(c, x * 2, arb(1, 1))],
    ],
)
def test_where_the_slope_may_be_1_or_is_not_known_nothing_is_told(monkeypatch, image):
    slap(monkeypatch, image)
    found = periodic_points(1, budget=400)
    assert found.stretches is None


def test_points_beside_each_other_are_two_where_the_slope_changes_its_side_of_1(monkeypatch):
    """The map has the slopes 2 and 1/2 on either side of its fixed point 0: the kink can hold one on each side."""

    def image(c, x):
        if c == WALL or x.contains(0):
            return [(1, arb(9), 2)] if c == WALL else [(c, x, 2 if x.mid() > 0 else 0.5)]
        return [(c, 2 * x, 2) if x > 0 else (c, x / 2, 0.5)]

    slap(monkeypatch, image)
    found = periodic_points(1).stretches
    assert [component for component, *_ in found] == [ARC, ARC]
    assert found[0][2] == pytest.approx(0, abs=1e-9)
    assert found[1][1] == pytest.approx(0, abs=1e-9)


def test_the_stretches_of_a_component_leave_nothing_out_between_them(monkeypatch):
    """Those that touch begin where the one before ends, whatever floats do to thirds of halves."""
    slap(monkeypatch, lambda c, x: [(c, x, 3 if x.mid() > -0.1 else 0.5)] if x.rad() < 0.004 else None, (1 / 3, 0.7))
    ends = {part: exponent._end(arb(end)) for part, end in ((ARC, 1 / 3), (WALL, 0.7))}
    monkeypatch.setattr(exponent, "_joined", lambda stretches: stretches)
    found = periodic_points(1).stretches
    for part, end in ends.items():
        own = [(low, high) for component, low, high, _ in found if component == part]
        assert own[0][0] == -end
        assert own[-1][1] == end
        assert all(a[1] == b[0] for a, b in pairwise(own))


def test_a_budget_of_boxes_that_ends_leaves_points_unknown(monkeypatch):
    slap(monkeypatch, lambda c, x: [(c, 3 * x, 3)])
    enough = periodic_points(1).boxes
    assert periodic_points(1, budget=enough).stretches is not None
    assert periodic_points(1, budget=enough - 1) == PeriodicPoints(None, enough)


@pytest.mark.parametrize(("shortest", "known"), [(2.0**-30, True), (2.0**-31, False)])
def test_stretches_are_halved_until_they_are_too_short(monkeypatch, shortest, known):
    """About the fixed point 1/4 the image is known only of a stretch that reaches no further than `shortest`."""
    monkeypatch.setattr(exponent, "_end", float)

    def image(component, x):
        if component == ARC and x.overlaps(arb(0.25)) and x.rad() > shortest * 1.0001:
            return None
        return [(ARC, 3 * x - 0.5, 3) if component == ARC else (ARC, x, 3)]

    slap(monkeypatch, image)
    found = periodic_points(1)
    assert (found.stretches is not None) is known
    assert found.boxes < 200
    if known:
        ((_, low, high),) = found.stretches
        assert low <= 0.25 <= high


def test_a_sign_is_told_of_balls_on_one_side_of_0_and_an_end_lies_beyond():
    for ball, sign in ((arb(1, 0.5), 1), (arb(-1, 0.5), -1), (arb(0), 0), (arb(0, 1), 0), (arb("nan"), 0)):
        assert exponent._sign(ball) == sign
    for end in (arb(3), arb(2, 0.25), arb(1) / 3):
        assert end.upper() < exponent._end(end) < end.upper() * (1 + 2.0**-39)


def test_halves_of_a_box_are_cut_across_the_side_that_is_more_than_ten_times_the_other():
    assert halves(((0.5, 1.0), (0.25, 0.0625))) == [((0.0, 0.5), (0.25, 0.0625)), ((1.0, 0.5), (0.25, 0.0625))]
    assert halves(((0.5, 0.5), (0.25, 0.0625))) == [((0.5, 0.5), (0.21875, 0.03125)), ((0.5, 0.5), (0.28125, 0.03125))]
    assert halves(((0.0, 5.0), (0.0, 0.5))) == [((0.0, 5.0), (-0.25, 0.25)), ((0.0, 5.0), (0.25, 0.25))]
    assert halves(((0.0, 5.25), (0.0, 0.5))) == [((-2.625, 2.625), (0.0, 0.5)), ((2.625, 2.625), (0.0, 0.5))]


def test_an_exponent_is_judged_from_a_candidate_and_two_inverses(monkeypatch):
    asked = []
    proof = exponent.ChaoticProof(arb(1), {"gap": True}, 0.5, 2.0, arb(1))
    monkeypatch.setattr(exponent, "candidate", lambda digits: ("candidate", digits))
    monkeypatch.setattr(exponent, "inverted", lambda cells, sign=1: (cells, sign))
    monkeypatch.setattr(exponent, "variation", lambda: "known")
    monkeypatch.setattr(exponent, "judged", lambda *given: asked.append(given) or proof)
    for answer in (True, None):
        monkeypatch.setattr(exponent, "symmetric", lambda *given, answer=answer: asked.append(given) or answer)
        found = exponent.slap_exponent(6, 64)
        assert found.checks == {"gap": True, "symmetric": answer}
        assert found.certified is (answer is True)
    assert asked[:2] == [(("candidate", 6), 6, (64, 1)), ((1024, -1), "known")]


def test_a_candidate_is_judged_by_the_inequality_that_is_proved_where_no_other_is_given(monkeypatch):
    made = SimpleNamespace(residual=lambda: SimpleNamespace(norm=arb(0), variation=arb(0)), mean=lambda: arb(1))
    near = SimpleNamespace(integral=lambda: arb(0.5))
    near.grounded = lambda: near
    known, other = Variation(arb("0.5"), arb(1), True), Variation(arb("0.5"), arb(1), False)
    monkeypatch.setattr(exponent, "Judge", lambda *_: made)
    monkeypatch.setattr(exponent, "variation", lambda: known)
    inverse = Inverted(1000, 9.0, 0.0, 1)
    assert exponent.judged(near, 4, inverse).certified is True
    assert exponent.judged(near, 4, inverse, other).checks["variation"] is None
    assert exponent.judged(near, 4, inverse).value == 2
    monkeypatch.setattr(exponent, "gap", lambda *_: arb(0.5, 0.25))
    assert 0.2499 < exponent.judged(near, 4, inverse).gap <= 0.25
    monkeypatch.setattr(exponent, "gap", lambda *_: arb(0))
    assert exponent.judged(near, 4, inverse).checks["gap"] is None
    assert exponent.symmetric(Inverted(1000, 9.0, 0.0, -1), known) is None


FACTS = (
    "parametrised", "forward_once", "lands_first", "derived", "expands", "quiet_near_the_cusp", "gentle_elsewhere",
)  # fmt: skip


@pytest.mark.parametrize("wrong", [None, *FACTS])
def test_the_inequality_for_variations_rests_on_seven_facts(monkeypatch, wrong):
    for name in FACTS:
        monkeypatch.setattr(transfer, name, lambda name=name: name != wrong)
    found = transfer.variation.__wrapped__()
    near = float(transfer.RATE.subs(transfer.q, transfer.CUSP)) / float(transfer.near_launch())

    assert found.proved is (wrong is None)
    assert found.shrinks.overlaps(arb(float(transfer.SHRINKS), 1e-15))
    assert float(found.adds) == pytest.approx(max(float(transfer.STEEP), near), rel=1e-12)


def test_the_larger_of_two_bounds_is_what_a_variation_adds(monkeypatch):
    for name in FACTS:
        monkeypatch.setattr(transfer, name, lambda: True)
    monkeypatch.setattr(transfer, "STEEP", 1000)
    assert transfer.variation.__wrapped__().adds == 1000


def test_launching_points_are_in_units_of_a_cell_a_grain_below_the_truth_at_most():
    cells, forms = 16, [load(branch(form), FLOAT64) for form in (False, True)]
    below, above = transfer.launching_points(cells)
    assert (len(below), len(above)) == (cells + 1, cells // 2 + 1)
    assert (below[-1], above[-1]) == (0.0, float(cells))
    for points, places in ((below[:-1], range(0, -cells, -1)), (above[:-1], range(cells // 2))):
        for point, k in zip(points, places, strict=True):
            landing = k * np.pi / 2 / cells
            truth = forms[int(landing >= -0.1)](landing)[0] * cells / (np.pi / 2)
            assert point * GRAIN == int(point * GRAIN)
            assert -1e-13 < truth - point < 1 / GRAIN + 1e-13


def test_shares_of_cells_are_those_between_launching_points(monkeypatch):
    """Two cells: to the first from 0.5 to 1.25 and from 1.25 to 2, to the second from 0 to 0.5."""
    points = np.array([1.25, 0.5, 0.0]), np.array([1.25, 2.0])
    monkeypatch.setattr(transfer, "launching_points", lambda cells: points)
    assert transfer.ulam(2).toarray().tolist() == [[0.5, 1.0], [0.5, 0.0]]
    assert transfer.ulam(2, -1).toarray().tolist() == [[-0.5, 0.5], [-0.5, 0.0]]
    monkeypatch.setattr(transfer, "launching_points", lambda cells: (np.array([2.5, 1.0, 0.5, 0.0]), np.array([3.0])))
    assert transfer.ulam(3).toarray().tolist() == [[0, 1, 0.5], [0.5, 0, 0], [0.5, 0, 0]]


@pytest.mark.parametrize(
    ("sign", "matrix", "inverse", "left", "size", "entries"),
    [
        (1, [[0.5, 0.5], [0.5, 0.5]], [[1, 0], [0, 1]], 0, 1, 2),  # I - X*(I - Q) has equal columns
        (-1, [[0.5, 0], [0, 0.5]], [[2, 0], [0, 2]], 0, 2, 1),
        (-1, [[0.5, 0], [0, 0.5]], [[1.25, 0], [0, 1.5]], 0.375, 1.5, 1),
        (-1, [[0.5, 0], [0, 0.5]], [[1, 0], [0, 2]], 0.5, 2, 1),
        (-1, [[0.5, 0.25], [0, 0.5]], [[2, 1], [0, 2]], 0, 3, 2),
        (2, [[0.5, 0], [0, 0.5]], [[2, 0], [0, 2]], 0, 2, 1),
        (1, [[0.5, 0.5], [0.5, 0.5]], [[2, 1], [1, 2]], 0, 1, 2),  # columns of norm 3, a distance of 1 from (1.5, 1.5)
    ],
)
def test_the_defect_of_an_inverse_is_what_is_left_what_floats_lose_and_what_displaced_points_move(
    monkeypatch, sign, matrix, inverse, left, size, entries
):
    """Two cells: a displaced point moves `2/2**40` in each of six entries; an entry loses a unit for each product."""
    asked = []
    monkeypatch.setattr(transfer, "ulam", lambda *given: asked.append(given) or csc_matrix(np.array(matrix)))
    inverse = np.array(inverse, float)
    found = transfer.inverted(2, inverse, sign)
    rounded = (entries + 4) * UNIT * (2 * abs(inverse).sum(axis=0).max() * BLANKET + 1) * BLANKET
    lost = rounded + 12 / GRAIN * size * BLANKET

    assert asked == [(2, sign)]
    assert (found.cells, found.sign) == (2, sign)
    assert found.defect - left * BLANKET == pytest.approx(lost, rel=1e-4 if left else 1e-14, abs=0)
    if left < 0.5 and sign in (1, -1):
        assert found.bound == pytest.approx(size / (1 - found.defect), rel=1e-8)
        assert found.bound > size / (1 - found.defect)
    else:
        assert found.bound is None


def test_norms_of_matrices_are_those_of_their_columns_from_above():
    made = np.array([[1.0, -2.0, 0.5], [3.0, 0.25, 0.5]])
    assert 4 < transfer.largest(made) == 4 * BLANKET
    about = np.median(made, axis=1)
    assert transfer.spread(made) == pytest.approx(max(abs(made - about[:, None]).sum(axis=0)))
    assert transfer.spread(np.array([[0.0, 0.0, 3.0], [1.0, 1.0, 1.0]])) == pytest.approx(3)


def test_the_gap_is_asked_with_the_bound_of_an_inverse_and_0_where_there_is_none():
    known = Variation(arb("0.75"), arb(2), True)
    with working(64):
        for bound, held in ((9.0, 10), (None, 1)):
            found = exponent.gap(Inverted(1000, bound, 0.0, 1), known)
            assert abs(found - (1 - 2 * arb.pi() / 4000 * held / arb("0.25"))) < 1e-15


@pytest.mark.parametrize("landing", [-1.5, -0.5, -0.1, -0.05, 0.0, 0.5])
def test_branches_of_balls_and_of_series_are_the_same_and_rates_are_their_slopes(landing):
    with working(96):
        at = Branches(96)
        launch, rate = at(arb(landing))
        h = arb(2) ** -30
        slope = (at(arb(landing) + h)[0] - at(arb(landing) - h)[0]) / (2 * h)
        assert abs(slope - rate) < 1e-15
        assert launch.rad() < 1e-24
        with taylor(2):
            first, second = at(arb_series([arb(landing), 1]))
            assert first[0].overlaps(launch)
            assert first[1].overlaps(rate)
            assert second[0].overlaps(rate)


def test_launching_points_and_rates_are_sharp_up_to_the_ends_of_both_branches():
    """Next to the cusp and to `pi/4`, in balls and in series, by the form that loses nothing there."""
    with working(96), taylor(2):
        at, near = Branches(96), arb(10) ** -9
        for landing in (-arb.pi() / 2 + near, arb.pi() / 4 - near):
            for launch, rate in (at(landing), [x[0] for x in at(arb_series([landing, 1]))]):
                assert launch.rad() < (1e-40 if landing < 0 else 1e-25)  # it is near 0 at the cusp
                assert rate.rad() < 1e-15
                assert 0 <= rate < 1
        for launch in (at(arb.pi() / 4)[0], at(arb_series([arb.pi() / 4, 1]))[0][0]):  # from the cusp
            assert launch.overlaps(arb.pi() / 2)
            assert launch.rad() < 1e-13
