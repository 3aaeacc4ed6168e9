"""Bounces near a corner where the angle of a chord is linear: all that is enclosed can be worked out by hand."""

import pytest
from flint import arb

from verification.arithmetic.balls import working
from verification.proofs.corner import corner
from verification.proofs.corner.corner import ARC, WALL, Bounce, Quantity, Rule

SLOPES = {(ARC, ARC): (0.5, 0.75, 0.25), (ARC, WALL): (-0.25, -2.0, 0.125), (WALL, ARC): (1.5, -0.5, 0.375)}


def linear(pair):
    a, b, c = SLOPES[pair]
    return lambda here, there: (a * here + b * there + c, a + 0 * here, b + 0 * there)


@pytest.fixture
def by_hand(monkeypatch):
    monkeypatch.setattr(corner, "_angles", lambda order=1: {pair: linear(pair) for pair in SLOPES})


def test_where_an_angle_takes_a_value_is_one_place_for_each_start_and_each_value():
    """The angle is `here - 2*x`: the place is `(here - value)/2`."""
    angle = lambda here, x: (here - 2 * x, 1 + 0 * here, -2 + 0 * x)  # noqa: E731
    for near in (0.5, 0.625):
        found = corner._root(angle, angle, arb(1.25, 0.25), arb(0.25, 0.125), near, 0.25)
        for here in (1.0, 1.25, 1.5):
            for value in (0.125, 0.375):
                assert found.contains(arb(here - value) / 2)
        assert found.rad() < 0.376 / 2
        assert found.mid() == 0.5


@pytest.mark.parametrize(("off", "there"), [(0.499, True), (0.501, False), (-0.499, True), (-0.501, False)])
def test_a_guess_may_be_as_far_off_as_ten_boxes_reach_and_no_farther(off, there):
    """Each is twice as large as that before, from `2**-10` on."""
    angle = lambda here, x: (here - 2 * x, arb(1), arb(-2))  # noqa: E731
    if there:
        assert corner._root(angle, angle, arb(1), arb(0), 0.5 + off, 2.0**-10) == 0.5
    else:
        with pytest.raises(ArithmeticError, match="a landing is not enclosed"):
            corner._root(angle, angle, arb(1), arb(0), 0.5 + off, 2.0**-10)


def test_no_landing_is_told_where_the_angle_may_not_vary():
    angle = lambda here, x: (here - 2 * x, arb(1), arb(-1, 1))  # noqa: E731
    with pytest.raises(ArithmeticError, match="a landing is not enclosed"):
        corner._root(angle, angle, arb(1), arb(0), 0.5, 2.0**-10)


@pytest.mark.parametrize(("component", "target"), [(ARC, WALL), (ARC, ARC), (WALL, ARC)])
def test_a_bounce_follows_by_the_rule_with_its_slopes_and_holds_that_of_every_box(
    monkeypatch, by_hand, component, target
):
    """`forth(here, after) = -lam*back(here, before)`, solved for `after`; each of the three has slopes of its own."""
    (a, b, c), (p, q, r) = SLOPES[component, target], SLOPES[component, ARC]
    slopes = {"before": (2, 0, -1), "here": (0, 1, 3), "lam": (0.5, 0, 1)}
    centres, spread = {"before": 0.25, "here": -0.5, "lam": 0.75}, tuple(arb(0, 2.0**-k) for k in (7, 8, 9))

    def quantity(name):
        whole = arb(centres[name]) + sum((s * d for s, d in zip(slopes[name], spread, strict=True)), arb(0))
        return Quantity(arb(centres[name]), tuple(map(arb, slopes[name])), whole)

    def landing(before, here, lam):
        return (-lam * (p * here + q * before + r) - a * here - c) / b

    monkeypatch.setattr(corner, "_polished", lambda here, component, value, near: near)
    at = landing(*centres.values())
    with working(64):
        given = [quantity(name) for name in centres]
        found = corner.following(
            Bounce(ARC, given[0]), Bounce(component, given[1]), target, at + 1e-15, given[2], spread
        )
    assert found.component == target
    assert abs(found.at.centre - at) < 1e-14
    assert found.at.centre.contains(arb(at)) or abs(found.at.centre - at) < 1e-15
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    values, by = [], [[], [], []]
    for signs in corners:
        moves = [s * 2.0**-k for s, k in zip(signs, (7, 8, 9), strict=True)]
        before, here, lam = (
            centres[name] + sum(s * m for s, m in zip(slopes[name], moves, strict=True)) for name in centres
        )
        values.append(landing(before, here, lam))
        own = -lam * q / b, -(a + lam * p) / b, -(p * here + q * before + r) / b
        for k in range(3):
            by[k].append(sum(x * slopes[name][k] for x, name in zip(own, centres, strict=True)))
    for slope, known in zip(found.at.slopes, by, strict=True):
        assert all((slope + arb(0, 1e-13)).contains(arb(x)) for x in known)
        assert slope.rad() < 1.6 * (max(known) - min(known)) / 2 + 1e-6
    assert all((found.at.whole + arb(0, 1e-13)).contains(arb(x)) for x in values)
    assert found.at.whole.rad() < 1.25 * (max(values) - min(values)) / 2


def test_a_bounce_whose_plain_ball_is_wider_than_its_mean_value_form_has_that_and_the_other_way_round(
    monkeypatch, by_hand
):
    """The mean-value form knows that `here` and `before` move together, so that little is left."""
    monkeypatch.setattr(corner, "_polished", lambda here, component, value, near: near)
    spread, (a, b, c), (p, q, r) = (arb(0, 2.0**-8),), SLOPES[ARC, WALL], SLOPES[ARC, ARC]
    lam = corner.constant(arb(0.75), spread)
    slope = -(a + 0.75 * p) / (0.75 * q)  # of `before` by `here`, which keeps the landing where it is
    before = Quantity(arb(0), (arb(slope),), slope * spread[0])
    here = corner.parameter(arb(0), 0, spread)
    near = (-0.75 * r - c) / b
    with working(64):
        found = corner.following(Bounce(ARC, before), Bounce(ARC, here), WALL, near, lam, spread)
        assert found.at.whole.rad() < 1e-12
        known = Quantity(before.centre, (arb(0, 9),), before.whole)  # of which the slope is not known
        other = corner.following(Bounce(ARC, known), Bounce(ARC, here), WALL, near, lam, spread)
    assert abs(found.at.whole - near) < 1e-12
    assert abs(found.at.slopes[0]) < 1e-12
    plain = (abs(a) + abs(0.75 * p) + abs(0.75 * q * slope)) / abs(b)
    assert other.at.whole.rad() < 1.01 * plain * 2.0**-8


def test_a_parameter_moves_by_itself_alone_and_a_constant_by_none():
    spread = arb(0, 0.25), arb(0, 0.5), arb(0, 1)
    for index, radius in enumerate((0.25, 0.5, 1)):
        found = corner.parameter(arb(3), index, spread)
        assert found.centre == 3
        assert [float(x) for x in found.slopes] == [float(k == index) for k in range(3)]
        assert found.whole.mid() == 3
        assert radius <= found.whole.rad() < radius + 1e-8
    assert corner.constant(arb(3), spread) == Quantity(arb(3), (arb(0),) * 3, arb(3))


def test_a_rule_moves_the_next_bounce_as_the_two_before_and_the_contraction_do():
    assert Rule(2.0, 3.0, 4.0, 5.0).next(7.0, 11.0, 13.0) == -(2 * 7 + 3 * 11 + 5 * 13) / 4
    first, second = Rule(2.0, 3.0, 4.0, 5.0), Rule(-1.0, 0.5, 8.0, 3.0)
    half = corner._half(first, second)
    for u, v, lam in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (2, -3, 5)):
        third = first.next(-u, -v, lam)  # displacements of the mirror image
        fourth = second.next(-v, third, lam)
        assert third == pytest.approx(half.rows[0][0] * u + half.rows[0][1] * v + half.shift[0] * lam)
        assert fourth == pytest.approx(half.rows[1][0] * u + half.rows[1][1] * v + half.shift[1] * lam)


def test_the_angle_between_bounces_is_that_of_their_components_over_the_box(by_hand):
    spread = (arb(0, 0.25),)
    ends = [Bounce(ARC, corner.parameter(arb(0.5), 0, spread)), Bounce(WALL, corner.constant(arb(0.25), spread))]
    value, here, there = corner.angle(*ends)
    assert value.contains(arb(-0.25 * 0.75 - 2 * 0.25 + 0.125))
    assert value.rad() < 0.25 * 0.25 + 1e-9
    assert (here, there) == (arb(-0.25), arb(-2))


@pytest.mark.parametrize("upper", [True, False])
def test_distances_beyond_a_corner_are_those_of_the_mirror_image_beyond_the_other(upper):
    at = Quantity(arb(0.5), (arb(2), arb(-3)), arb(0.5, 0.25))
    for component in (ARC, WALL):
        edge = corner.corner_parameters()[component]
        found = corner.beyond(Bounce(component, at), upper)
        sign = 1 if upper else -1
        assert abs(found.centre - (sign * 0.5 - edge)) < 1e-15
        assert found.slopes == (arb(2 * sign), arb(-3 * sign))
        assert all(abs(end - (sign * 0.5 + side * 0.25 - edge)) < 1e-8 for side, end in
                   ((-1, found.whole.lower()), (1, found.whole.upper())))  # fmt: skip
