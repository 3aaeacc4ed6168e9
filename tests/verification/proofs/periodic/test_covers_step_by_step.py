"""The cover of phase space, step by step: which cells go on, with which angles, and what is said at the end."""

from types import SimpleNamespace

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from symbolic.tables import egg
from verification.proofs.periodic import returning
from verification.proofs.periodic.returning import SIXTH, SLACK, Image, Piece, Returning

SHAPE, LAMS = Rational(2, 25), (0.25, 0.5)
TABLE = egg(3).at(alpha=SHAPE)
LEADS = [
    {0: {1: (-0.1, 0.2)}, 1: {0: (-0.3, 0.1), 2: (-0.5, 0.0)}, 2: {2: (0.1, 0.3)}, 3: {0: (-9.0, 9.0)}}
    | {k: {} for k in range(4, 8)},
    {0: {2: (0.0, 0.5)}, 2: {0: (-0.5, 0.0)}, **{k: {} for k in (1, 3, 4, 5)}},
    {k: {} for k in range(6)},
]
PARTS = [[[0, 1], [2]], [[0, 2]], [[0, 1], [4]]]
PIECES = (Piece(0.0, 1.0, 2.0, 3.0),), (Piece(0.0, 2.0, 0.5, 0.75),)
HULL = (Piece(0.0, 4.0, 0.25, 0.5),)


@pytest.fixture
def scripted(monkeypatch):
    """Three rounds that are given: one part stays open, then no hull is found, then all is proved."""
    told = SimpleNamespace(cells=[], judged=[], hulls=[], answers=[[PIECES[0], None], [PIECES[1]], PIECES], round=-1)

    def image(table, cell, phi, lams):
        assert (table, lams) == (TABLE, LAMS)
        told.cells[-1].append((cell, phi))
        return cell

    def leads(images, lams, width):
        told.round += 1
        told.widths = [*getattr(told, "widths", []), width]
        assert images == {k: (k * width, (k + 1) * width) for k in images}
        told.cells.append([])
        return LEADS[told.round]

    def judged(part, leads, images, width):
        told.judged.append(list(part))
        pieces = told.answers[told.round][PARTS[told.round].index(part)]
        return pieces and (pieces, pieces is PIECES[0])

    def hull(*given):
        told.hulls.append(given)
        return HULL if told.round == 2 else None

    told.cells.append([])
    for name, other in (("image", image), ("_leads", leads), ("_judged", judged), ("_hull", hull), ("FIRST", 3)):
        monkeypatch.setattr(returning, name, other)
    monkeypatch.setattr(returning, "_parts", lambda leads: PARTS[told.round])
    monkeypatch.setattr(returning, "convex", lambda _: True)
    return told


def test_cells_that_cycles_may_meet_are_halved_with_the_angles_with_which_others_of_these_arrive(scripted, monkeypatch):
    monkeypatch.setattr(returning, "HALVINGS", 3)
    found = returning.returning(SHAPE, LAMS)
    widest = 0.5 * np.pi / 2
    first, second, third, _ = scripted.cells

    assert found == Returning(True, (PIECES[0],), HULL, 8 + 6 + 4)
    assert [cell for cell, _ in first] == [(k * SIXTH / 8, (k + 1) * SIXTH / 8) for k in range(8)]
    assert {phi for _, phi in first} == {(-widest, widest)}
    assert scripted.widths == [SIXTH / 8, SIXTH / 16, SIXTH / 32]
    assert [round(cell[0] * 16 / SIXTH) for cell, _ in second] == list(range(6))  # cell 3 is in no part
    assert [phi for _, phi in second] == [(-0.3, 0.1)] * 2 + [(-0.1, 0.2)] * 2 + [(-0.5, 0.3)] * 2
    assert [round(cell[0] * 32 / SIXTH) for cell, _ in third] == [0, 1, 4, 5]
    assert [phi for _, phi in third] == [(-0.5, 0.0)] * 2 + [(0.0, 0.5)] * 2
    assert scripted.judged == [part for parts in PARTS for part in parts]
    assert [(parts, width, lams) for parts, _, width, _, lams in scripted.hulls] == [
        ([PIECES[1]], SIXTH / 16, LAMS),
        ([PIECES[1]], SIXTH / 32, LAMS),
    ]
    assert set(scripted.hulls[1][3].values()) == {(-0.5, 0.0), (0.0, 0.5)}


def test_what_is_left_open_by_the_last_halving_is_open(scripted, monkeypatch):
    monkeypatch.setattr(returning, "HALVINGS", 2)
    assert returning.returning(SHAPE, LAMS) == Returning(None, (), (), 14)


@pytest.mark.parametrize("answer", [None, False])
def test_of_a_table_that_is_not_proved_convex_nothing_is_said(monkeypatch, answer):
    monkeypatch.setattr(returning, "convex", lambda _: answer)
    assert returning.returning(SHAPE, LAMS) == Returning(None, (), (), 0)


@pytest.mark.parametrize(("a", "b"), [(-1.5, -0.5), (0.75, -1.25), (-0.5, -2.0)])
@pytest.mark.parametrize("phi", [(-0.25, 0.5), (0.125, 0.125)])
def test_of_angles_that_are_linear_an_image_is_what_is_worked_out_by_hand(monkeypatch, a, b, phi):
    """`phi = a*theta + b*theta1 + 1/4`: so `theta1` is `(phi - 1/4 - a*theta)/b`, and `eta = a*theta1 + b*theta + 1/4`.

    Then `phi1 = -lam*eta` has the slopes `-lam*(b - a*a/b)` and `-lam*a/b`.
    """
    folded, cell = [], (0.25, 0.375)
    linear = lambda here, there: (a * here + b * there + 0.25, a + 0 * here, b + 0 * here)  # noqa: E731
    monkeypatch.setattr(returning, "_angles", lambda _: (linear, linear))
    monkeypatch.setattr(returning, "_folded", lambda *given: folded.append(given) or ())
    found = returning.image(TABLE, cell, phi, LAMS)
    ends = [(p - 0.25 - a * x) / b for p in phi for x in cell]
    etas = [a * end + b * x + 0.25 for end in ends for x in cell]
    ((end, reach),) = folded

    assert end - reach < min(ends) < max(ends) < end + reach
    assert reach < 0.53 * (max(ends) - min(ends)) + 1e-8
    assert found.incidence[0] <= min(etas)
    assert max(etas) <= found.incidence[1]
    assert found.incidence[1] - found.incidence[0] < 1.6 * (max(etas) - min(etas))
    assert found.derivative[0] == pytest.approx((-a / b, -a / b))
    assert found.derivative[1] == pytest.approx((1 / b, 1 / b))
    for span, factor in zip(found.derivative[2:], (a * -a / b + b, a / b), strict=True):
        assert span == pytest.approx(sorted(-lam * factor for lam in LAMS))
        assert span[0] <= min(-lam * factor for lam in LAMS)
        assert span[1] >= max(-lam * factor for lam in LAMS)


@pytest.mark.parametrize(
    ("end", "reach", "phi", "held"),
    [
        (1, 0.5, (-0.125, 0.125), True),  # of the cell the angles reach from 1/2 - 1/4 to 1/2 + 1/4 at the one end
        (1, 0.375, (-0.125, 0.125), False),  # 1/8: the same angle is that of a ball
        (1, 0.375, (-0.124, 0.124), True),
        (1, 0.5, (-0.125, 0.25), False),
        (1, 0.5, (-0.25, 0.125), False),
        (1, 1, (-0.5, 0.5), True),
    ],
)
def test_every_start_of_a_cell_counts_where_a_landing_is_enclosed(end, reach, phi, held):
    """The angle is `1 - x + c/2` for starts `c` in [-1/2, 1/2]."""
    angle = lambda c, x: (1 - x + c / 2, arb(0.5) + 0 * c)  # noqa: E731
    assert returning._lands_within(angle, arb(0), arb(0, 0.5), end, reach, phi) is held


def test_a_landing_that_is_not_enclosed_within_a_radian_is_refused():
    angle = lambda c, x: (1 - x, arb(0))  # noqa: E731
    assert returning._lands_within(angle, arb(0), arb(0), 1.0, 1.0, (0.0, 0.0)) is True
    for phi, held in (((-0.125, 0.124), False), ((-0.124, 0.125), False), ((-0.124, 0.124), True)):  # at 1/8 and -1/8
        assert returning._lands_within(angle, arb(0), arb(0), 1.0, 0.125, phi) is held
    with pytest.raises(ArithmeticError, match="no landing"):
        returning._lands_within(angle, arb(0), arb(0), 1.0, 1.0 + 2.0**-20, (0.0, 0.0))


def test_a_ball_holds_its_ends_and_spans_are_those_of_balls():
    for ends in ((0.1, 0.3), (-0.7, -0.7), (-1.0, 2.0), (0.5 - SLACK, 0.5 + SLACK)):
        made = returning.ball(ends)
        assert all(made.contains(arb(end)) for end in ends)
        assert made.rad() < (ends[1] - ends[0]) / 2 + 1e-8
        low, high = returning.span(made)
        assert low <= ends[0] <= ends[1] <= high
        assert high - low < ends[1] - ends[0] + 1e-8


def test_a_round_is_one_of_all_pieces_or_none():
    """Two pieces: the first leads to itself only; both lead to the second; three in turn."""
    assert returning._round([{0}, {1}]) == [0]
    assert returning._round([{1}, {1}]) == []
    assert returning._round([{1}, {2}, {0}]) == [0, 1, 2]
    assert returning._round([set(), {0}]) == []


@pytest.mark.parametrize(("reach", "parts"), [(0.25, 1), (0.5, 2), (0.75, 2)])
def test_a_stretch_about_a_vertex_is_folded_there_with_the_other_sign(reach, parts):
    for end in (0.375, -0.375):
        sign = 1 if end > 0 else -1
        found = returning._folded(end, reach)
        assert len(found) == parts + (0.375 + reach > np.pi / 3)
        assert found[0] == pytest.approx((max(0.375 - reach, 0), min(0.375 + reach, np.pi / 3), sign))
        assert found[0][0] <= max(0.375 - reach, 0)
        if parts == 2:
            assert found[1] == pytest.approx((0, reach - 0.375, -sign))
            assert found[1][1] > reach - 0.375
        if len(found) > parts:
            assert found[-1] == pytest.approx((2 * np.pi / 3 - 0.375 - reach, np.pi / 3, -sign))
            assert found[-1][0] < 2 * np.pi / 3 - 0.375 - reach
            assert min(found[-1][1], found[0][1]) > np.pi / 3  # which is below the true one


def test_what_is_joined_is_of_derivatives_alone():
    one = Image(((0.0, 1.0, 1),), (0.5, 1.0), ((0.0, 1.0),) * 4)
    assert returning._joined([one]) == Image((), (0.0, 0.0), ((0.0, 1.0),) * 4)


def test_angles_of_arrival_have_room_for_rounding_on_both_sides():
    stays = Image(((0.025, 0.05, 1),), (-0.5, 0.25), ((0.0, 0.0),) * 4)
    low, high = returning._leads({0: stays}, (0.5, 0.5), 0.1)[0][0]
    assert -0.125 - 2 * SLACK < low < -0.125
    assert 0.25 < high < 0.25 + 2 * SLACK
