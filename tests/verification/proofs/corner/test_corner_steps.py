"""The corner proofs step by step: what each decides of enclosures that are given, and what it leaves open."""

from dataclasses import replace

import numpy as np
import pytest
from flint import arb
from sympy import Rational

from symbolic.cycles.thresholds import lambda_c
from verification.arithmetic.balls import FLOAT64, real_ball, working
from verification.proofs.corner import corner, corner_orbit, evidence, half_return
from verification.proofs.corner.border_collision import Expansion, Piece, _to_border, fixed_point
from verification.proofs.corner.corner import ARC, WALL, Bounce, Corner, constant
from verification.proofs.corner.corner_orbit import CornerClaim, corner_proved, doubled_branch
from verification.proofs.corner.half_return import Step, TrappingRegion, _images
from verification.proofs.periodic.interval_newton import Enclosure, Status

ARC_END, WALL_END = (float(x.mid()) for x in corner.corner_parameters())


def affine(a: float, b: float, c: float, d: float) -> Piece:
    return Piece(((arb(a), arb(b)), (arb(c), arb(d))), (arb(0), arb(0)))


OPEN, SAME = arb(0, 1), affine(1, 0, 0, 1)


def sides_of(motion: float | arb = 1, slope_wall: float | arb = -1, slope_arc: float | arb = 1) -> Corner:
    return Corner(*(arb(x) for x in (slope_wall, slope_arc, motion)), SAME, SAME, arb(-1))


@pytest.mark.parametrize(
    ("motion", "slope_wall", "slope_arc", "answer"),
    [
        (1, -1, 1, True), (-1, 1, -1, True), (1, 1, 1, False), (1, -1, -1, False), (1, 1, -1, False),
        (-1, -1, 1, False), (1, OPEN, -1, False), (1, 1, OPEN, False), (1, OPEN, 1, None), (1, -1, OPEN, None),
        (OPEN, -1, 1, None), (0, -1, 1, None), (1, 0, 1, None), (1, -1, 0, None),
    ],
)  # fmt: skip
def test_a_curve_has_a_minimum_at_a_kink_where_it_falls_before_and_grows_behind(motion, slope_wall, slope_arc, answer):
    assert sides_of(motion, slope_wall, slope_arc).minimum_at_kink is answer


@pytest.mark.parametrize(
    ("piece", "unstable"),
    [
        (affine(1.5, 0.5, 0.5, 0.5), True),  # trace 2, determinant 1/2
        (affine(1.5, 0.5, 0, 0.5), None),  # its directions may lie along the border
        (affine(1.5, 0, OPEN, 0.75), None),
        (affine(0.75, -0.5, 0.5, 0.5), None),  # multipliers of modulus below 1
        (affine(1, 0, 0.5, 0.5), None),  # the multiplier 1
        (affine(0.5, 2, 0.5, 1.5), None),  # a negative one
        (affine(2, 1, 1, 0.5), None),  # the multiplier 0
        (affine(-1.5, 0.5, 0.5, -0.5), None),
    ],
)
def test_orbits_leave_where_a_side_has_a_multiplier_above_1_and_one_below_off_the_border(piece, unstable):
    for at in ("wall", "arc"):
        assert replace(sides_of(), **{at: piece}).unstable is unstable


BOTH = {ARC, WALL}


@pytest.mark.parametrize("upper", [True, False])
@pytest.mark.parametrize(
    ("arc", "wall", "parts"),
    [
        (arb(-0.1), None, {ARC}), (arb(-0.1), arb(-0.1), {ARC}), (arb(-4), None, {ARC}), (arb(-4.2), None, None),
        (arb(-4.19, 0.1), None, None), (None, arb(0.1), {WALL}), (None, arb(0.86), {WALL}), (None, arb(0.87), None),
        (None, arb(0, 0.1), None), (None, arb(-0.1), None), (arb(0.1), arb(0.1), {WALL}),
        (arb(0, 0.1), arb(-0.1), {ARC}), (arb(0, 0.1), arb(0, 0.1), BOTH), (arb(0, 0.1), arb(0.1), {WALL}),
        (arb(0, 0.1), None, None), (arb(0, 0.1), arb(0.9), None), (arb(0.1), arb(0, 0.1), None),
        (arb(0.1), arb(-0.1), None), (arb(0.1), None, None), (None, None, None),
    ],
)  # fmt: skip
def test_a_landing_near_a_corner_is_on_the_part_where_its_zero_is_proved_to_lie(monkeypatch, upper, arc, wall, parts):
    """The zeros of arc and wall, prolonged, as distances beyond the corner; where none is proved nothing is told."""
    sign = 1 if upper else -1
    edges, beyond = corner.corner_parameters(), {ARC: arc, WALL: wall}

    def following(previous, here, component, near, lam, spread):
        assert abs(near - sign * float(edges[component].mid())) < 1e-12
        if beyond[component] is None:
            raise ArithmeticError
        return Bounce(component, constant(sign * (edges[component] + beyond[component]), ()))

    monkeypatch.setattr(corner, "following", following)
    if parts is None:
        with pytest.raises(ArithmeticError, match="near a corner is not enclosed"):
            corner.after_corner(None, None, upper, None, ())
    else:
        found = corner.after_corner(None, None, upper, None, ())
        assert {bounce.component for bounce in found} == parts
        for bounce in found:
            assert abs(corner.beyond(bounce, upper).whole - beyond[bounce.component]).contains(0)


@pytest.mark.parametrize(("at", "there"), [(2.09, True), (-2.09, True), (2.1, False), (-2.1, False), (None, False)])
def test_a_bounce_on_the_arc_is_one_between_its_ends(monkeypatch, at, there):
    bounce = Bounce(ARC, constant(arb(2.09, 0.1) if at is None else arb(at), ()))
    monkeypatch.setattr(corner, "following", lambda *_: bounce)
    if there:
        assert corner.on_arc(None, None, 0.0, None, ()) is bounce
    else:
        with pytest.raises(ArithmeticError, match="on the arc is not enclosed"):
            corner.on_arc(None, None, 0.0, None, ())


GOOD = Enclosure(Status.UNIQUE, [arb(0.2545, 1e-12), arb(0.0712, 1e-12)])
FAR = Enclosure(Status.UNIQUE, [arb(-0.2545, 1e-12), arb(0.0712, 1e-12)])
NEAR_2 = Enclosure(Status.UNIQUE, [arb(2, 1e-12), arb(0.0712, 1e-12)])
ITEMS = {"exists", "unique", "admissible", "minimal_period", "precise"}
CORNER = {"s4_minimum_at_a_kink", "s4_dips_below", "unstable"}


@pytest.mark.parametrize(
    ("enclosure", "convex", "digits", "open_", "asked"),
    [
        (GOOD, True, 10, set(), CORNER),
        (GOOD, True, 12, {"precise"}, CORNER),
        (GOOD, None, 10, {"admissible"}, CORNER),
        (replace(GOOD, status=Status.UNKNOWN), True, 10, ITEMS, set()),
        (FAR, True, 10, {"admissible", "minimal_period"}, set()),  # the mirror image of the corner's orbit
        (NEAR_2, True, 10, {"admissible", "minimal_period"}, set()),
        (replace(GOOD, zero=[arb(0), GOOD.zero[1]]), True, 10, {"admissible", "minimal_period"}, set()),
        (replace(GOOD, zero=[arb(2), GOOD.zero[1]]), True, 10, {"admissible", "minimal_period"}, set()),
    ],
)  # fmt: skip
def test_the_checklist_of_the_corner_orbit_says_what_is_proved_of_it(
    monkeypatch, enclosure, convex, digits, open_, asked
):
    monkeypatch.setattr(corner_orbit, "interval_newton", lambda *_: enclosure)
    monkeypatch.setattr(corner_orbit, "convex", lambda *_: convex)
    claim = CornerClaim("lam", (arb(0.25), arb(0.07)), arb(0.01), 100, digits)
    found = corner_proved(claim)

    assert set(found.checks) == ITEMS | asked
    assert {item for item, value in found.checks.items() if value is not True} == open_
    assert False not in found.checks.values()
    assert found.certified is (not open_)
    assert found.value is enclosure.zero[1]


def test_where_no_zero_is_in_the_box_the_corner_orbit_is_refuted_and_nothing_else_is_said(monkeypatch):
    monkeypatch.setattr(corner_orbit, "interval_newton", lambda *_: replace(GOOD, status=Status.EMPTY))
    found = corner_proved(CornerClaim("lam", (arb(0.25), arb(0.07)), arb(0.01), 100, 10)).checks

    assert found == dict.fromkeys(("exists", "unique"), False) | dict.fromkeys(ITEMS - {"exists", "unique"})


@pytest.mark.parametrize(
    ("minimum", "descent", "unstable"),
    [(True, -1, True), (None, OPEN, None), (False, 1, None), (True, 0, True), (True, 1, True)],
)
def test_what_is_said_of_s4_and_of_stability_is_what_the_one_sided_derivatives_say(
    monkeypatch, minimum, descent, unstable
):
    class Sides:
        slope_arc = slope_wall = arb(1)
        wall = arc = affine(1.5, 0, 0.5, 0.25)
        robust = None

    Sides.minimum_at_kink, Sides.unstable = minimum, unstable
    Sides.descent = descent if isinstance(descent, arb) else arb(descent)
    monkeypatch.setattr(corner_orbit, "interval_newton", lambda *_: GOOD)
    monkeypatch.setattr(corner_orbit, "at_corner", lambda *_: Sides)
    found = corner_proved(CornerClaim("phi", (arb(0.25), arb(0.07)), arb(0.01), 100, 10))

    dips = None if descent is OPEN or descent == 0 else descent < 0
    assert [found.checks[key] for key in ("s4_minimum_at_a_kink", "s4_dips_below", "unstable")] == [
        minimum,
        dips,
        unstable,
    ]
    assert abs(found.value + 0.029) < 1e-2  # phi-star, and not lambda-star
    assert found.certified is (minimum is True and dips is True and unstable is True)


def two(first: float, second: float) -> Enclosure:
    return Enclosure(Status.UNIQUE, [arb(first), arb(second), arb(0.05, 1e-12)])


@pytest.mark.parametrize(
    ("enclosure", "convex", "open_"),
    [
        (two(1, -2), True, set()),
        (two(1, 1), True, {"admissible", "minimal_period"}),
        (two(1, -2), False, {"admissible"}),
        (replace(two(1, -2), status=Status.UNKNOWN), True, ITEMS),
    ],
)
def test_where_multipliers_turn_complex_two_bounces_are_apart_in_a_convex_table(monkeypatch, enclosure, convex, open_):
    monkeypatch.setattr(corner_orbit, "interval_newton", lambda *_: enclosure)
    monkeypatch.setattr(corner_orbit, "convex", lambda *_: convex)
    monkeypatch.setattr(CornerClaim, "system", None)
    found = corner_proved(CornerClaim("alpha", (arb(0),) * 3, arb(0.01), 100, 10, Rational(1, 3)))

    assert {item for item, value in found.checks.items() if value is None} == open_
    assert found.value is enclosure.zero[-1]


@pytest.mark.parametrize(("value", "lam"), [("alpha", None), ("lam", Rational(1, 3)), ("a", None)])
def test_a_corner_claim_is_of_one_of_three_numbers_and_the_third_alone_has_a_contraction(value, lam):
    with pytest.raises(ValueError, match="is unknown"):
        CornerClaim(value, (), arb(1), 100, 10, lam)


@pytest.mark.parametrize("fails", range(4))
def test_no_branch_is_told_where_one_of_its_steps_is_not_proved(monkeypatch, fails):
    """Over all `e` once, and then three times at the last one."""
    real, asked = corner_orbit.step, []
    monkeypatch.setattr(corner_orbit, "step", lambda *g: asked.append(g) or (None if len(asked) > fails else real(*g)))
    assert doubled_branch() is None
    assert len(asked) == fails + 1


@pytest.mark.parametrize(
    "wrong",
    [
        {}, {"inside": lambda *_: None}, {"inside": lambda *_: False}, {"convex": lambda *_: None},
        {"half": lambda e, m, lam: (arb(1.5), arb(0.5))},  # the multiplier 1 may be one
        {"half": lambda e, m, lam: (arb(1), arb(0.5))},
        {"half": lambda e, m, lam: (arb(9), arb(-1))},
        {"half": lambda e, m, lam: (arb(9), arb(1))},
        {"third_order": lambda *_: [arb(0), arb(0)]},  # the contraction may not change along the branch
    ],
    ids=lambda wrong: next(iter(wrong), "nothing"),
)  # fmt: skip
def test_a_branch_is_said_to_be_unstable_only_where_each_of_its_reasons_is_proved(monkeypatch, wrong):
    for name, other in wrong.items():
        monkeypatch.setattr(corner_orbit, name, other)
    found = doubled_branch()

    assert found.unstable is (None if wrong else True)
    assert found.m.contains(found.m.mid())
    assert found.lam.contains_interior(found.end)


FAMILY = {ARC: affine(0.5, 0, 0, -3), WALL: affine(0.5, 0, 0, 2)}
PLACES = {ARC: (arb(0.2), arb(-0.5)), WALL: (arb(5), arb(10))}


@pytest.mark.parametrize(
    ("family", "places", "answer"),
    [
        ({}, {}, True),
        ({ARC: affine(0.5, 0, 0, -1)}, {}, None),  # trace -1/2, and 1 + det = 1/2
        ({WALL: affine(0.5, 0, 0, 1)}, {}, None),  # the multiplier 1
        ({}, {ARC: (arb(3), arb(-0.5))}, None),  # beyond the polygon
        ({}, {ARC: (arb(0.2), arb(-1))}, None),  # on its border
        ({}, {WALL: (arb(0.2), arb(-0.5))}, None),  # on the other side
        ({}, {ARC: (arb(0.2), arb(0, 0.1))}, None),
        ({}, {ARC: (arb(0.2), arb(0))}, None),  # at the corner
    ],
)
def test_two_saddles_are_told_where_each_lies_on_its_side_within_the_polygon(monkeypatch, family, places, answer):
    made = FAMILY | family
    at = {id(made[component]): place for component, place in (PLACES | places).items()}
    monkeypatch.setattr(evidence, "pieces", lambda *_: made)
    monkeypatch.setattr(evidence, "fixed_point", lambda piece: at[id(piece)])
    assert evidence.saddles() == (PLACES if answer else None)


def test_the_one_sided_derivatives_are_difference_quotients_of_the_bounces_that_the_rules_say():
    """From the upper corner to `theta1`, by the rule near the lower corner, prolonged, and near the upper one."""
    theta1, star = (float(x.mid()) for x in corner.enclosed())
    found, h = corner.at_corner(FLOAT64, theta1, star), 1e-5

    def distances(theta, lam, component):
        with working(200):
            contraction = constant(arb(lam), ())
            start, first = (Bounce(ARC, constant(x, ())) for x in (corner.corner_parameters()[ARC], arb(theta)))
            near = -(ARC_END, WALL_END)[component]
            second = corner.following(start, first, component, near, contraction, ())
            third = corner.following(first, second, ARC, -theta1, contraction, ())
            fourth = corner.following(second, third, ARC, ARC_END, contraction, ())
            angle = corner.angle(start, first)[0]
        return [float(x.mid()) for x in (-second.at.whole, fourth.at.whole, angle)]

    for component, slope in ((ARC, found.slope_arc), (WALL, found.slope_wall)):
        low, high = (np.array(distances(theta1 + e, star, component)) for e in (-h, h))
        before, after = (np.array(distances(theta1, star + e, component)) for e in (-h, h))
        (second, fourth, phi), (shift, growth, _) = (high - low) / (2 * h), (after - before) / (2 * h)
        assert abs(fourth / phi - slope) < 1e-4 * abs(slope)
        if component == WALL:
            assert abs(growth - fourth * shift / second - found.descent) < 1e-3
        assert abs(abs(second / phi) - abs(found.motion)) < 1e-3 * abs(found.motion)


def test_the_contraction_moves_along_the_branch_as_fast_as_is_said():
    """From `lambda_c` on it is `lambda_c + bend*e**2` with some value of the ball, by the mean-value theorem."""
    found = doubled_branch()
    with working(corner_orbit.BITS):
        moved = (found.end - real_ball(lambda_c(), 30)) / arb(corner_orbit.MOST) ** 2

        assert found.bend.contains(moved)
        assert abs(found.bend / moved - 1) < 0.5


@pytest.mark.parametrize("e", ["0.001", "0.01", "0.04"])
def test_the_derivatives_of_the_divided_rules_are_their_difference_quotients(e):
    """By `m` and by `lam`, at a point of the branch, and a wide ball of `e` holds them."""
    with working(corner_orbit.BITS):
        m, lam, h = corner_orbit.slope_at_zero(), real_ball(lambda_c(), 30).mid(), arb(10) ** -8
        thin = corner_orbit.derivatives(arb(e), m, lam)
        wide = corner_orbit.derivatives(arb(0.02, 0.02), m, lam)
        for k, (dm, dlam) in enumerate(((h, 0), (0, h))):
            ends = [corner_orbit.divided(arb(e), m + s * dm, lam + s * dlam) for s in (-1, 1)]
            for i, (low, high) in enumerate(zip(*ends, strict=True)):
                quotient = ((high - low) / (2 * h)).mid()
                assert (thin[i, k] + arb(0, 1e-9)).contains(quotient)
                assert thin[i, k].rad() < 0.01
                assert wide[i, k].contains(quotient)


def test_the_way_to_the_border_is_along_the_multiplier_below_minus_1():
    for rows in ((0.1, 0.2, 0.1, -2.0), (0.5, -1.0, 0.75, -2.5), (-3.0, 0.5, 0.25, 0.5)):
        piece = replace(affine(*rows), shift=(arb(0.25), arb(1)))
        at, border = fixed_point(piece), _to_border(piece)
        way = [b - a for a, b in zip(at, border, strict=True)]
        moved = [b - a for a, b in zip(at, piece.of(border), strict=True)]
        multiplier = min(np.roots([1, -float(piece.trace), float(piece.determinant)]))

        assert border[1] == 0
        assert multiplier < -1
        assert [float(x) for x in moved] == pytest.approx([multiplier * float(x) for x in way], abs=1e-9)
    assert _to_border(affine(0.5, 0, 0, -1)) is None
    assert _to_border(affine(0.5, 0, 0, 2)) is None


def test_the_exponents_of_a_region_are_bounded_over_all_of_its_steps():
    steps = [
        Step((0.0, 1.0), [], Expansion(OPEN, arb(least), arb(most)), (OPEN, OPEN))
        for least, most in ((1.5, 2.0), (1.25, 1.75), (1.75, 3.0))
    ]
    low, high = TrappingRegion(True, 1.0, tuple(steps)).exponent

    assert (low, high) == pytest.approx((np.log(1.25) / 2, np.log(3) / 2))


@pytest.mark.parametrize("component", [ARC, WALL])
def test_the_images_of_a_box_hold_those_of_the_smaller_boxes_within_it(component):
    """As a whole, and as the middle's plus the slopes times the way from there; small boxes are nearly points."""
    sign = -1 if component == ARC else 1
    with working(64):
        box = arb("0.002", "0.001"), sign * arb("0.001", "0.0005"), arb("0.003", "0.001")
        found = _images(component, *box)
        for shares in ((0, 0, 0), (1, 1, 1), (-1, 1, -1), (1, -1, 0), (0, 1, -1)):
            at = [x.mid() + s * arb(x.rad()) * 15 / 16 for x, s in zip(box, shares, strict=True)]
            for point in _images(component, *(arb(x.mid(), 1e-12) for x in at)):
                held = []
                for image in found:
                    off = [x.mid() - b.mid() for x, b in zip(at, box, strict=True)]
                    told = [
                        q.centre + sum((s * d for s, d in zip(q.slopes, off, strict=True)), arb(0, 1e-9)) for q in image
                    ]
                    held.append(all(q.whole.contains(p.centre.mid()) and t.contains(p.centre.mid())
                                    for q, p, t in zip(image, point, told, strict=True)))  # fmt: skip
                assert any(held)
                assert all(abs(q.whole) < 0.05 for image in found for q in image)


@pytest.mark.parametrize(
    ("wrong", "traps", "grown", "proved"),
    [
        ({}, [True], 1, True),
        ({}, [None, None, True], 3, True),  # a region that the family does not trap is grown anew from it
        ({}, [None] * 9, 5, False),
        ({"expansion": lambda _: None}, [True], 1, False),
        ({"expansion": lambda _: Expansion(OPEN, arb(1), arb(2))}, [True], 1, False),
        ({"expansion": lambda _: Expansion(OPEN, arb(1, 0.5), arb(2))}, [True], 1, False),
        ({"pieces": None}, [True], 1, False),
        ({"grown": None}, [True], 1, False),
    ],
)
def test_a_step_is_proved_where_a_region_is_trapped_and_vectors_of_its_cone_grow(
    monkeypatch, wrong, traps, grown, proved
):
    asked, region = [], [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0)]

    def pieces(region, e):
        if "pieces" in wrong:
            raise ArithmeticError
        return {ARC: affine(0.5, 0, 0, -2), WALL: affine(0.5, 0, 0, 2)}

    monkeypatch.setattr(
        half_return, "grown", lambda *given: asked.append(given) or (None if "grown" in wrong else region)
    )
    monkeypatch.setattr(half_return, "pieces", pieces)
    monkeypatch.setattr(half_return, "trapped", lambda *_: traps.pop(0))
    monkeypatch.setattr(
        half_return, "expansion", wrong.get("expansion", lambda _: Expansion(OPEN, arb("1.125"), arb(2)))
    )
    found = half_return.step({}, (0.0, 1e-3))

    assert (found is not None) is proved
    assert len(asked) == grown
    assert found is None or (found[1].region is region and found[1].e == (0.0, 1e-3))
