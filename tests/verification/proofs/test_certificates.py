"""Proofs by balls: sound, three-valued, and refusing what is not so."""

import math
from dataclasses import replace

import flint
import pytest
from flint import arb
from hypothesis import example, given, settings
from hypothesis import strategies as st
from sympy import Interval, Rational

from symbolic.cycles.normal_forms import composed
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from verification.arithmetic.balls import balls, exact_balls, working
from verification.cycles.critical import corner
from verification.cycles.newton import refined
from verification.cycles.problem import Linearised, NormalForm, Problem
from verification.cycles.recurrence import BifurcationKind
from verification.maps.first_hit import convex, inside, minimal
from verification.named.locate import certify
from verification.proofs.periodic import bifurcation, triangles
from verification.proofs.periodic.bifurcation import Claim, birkhoff_normal_form, proved
from verification.proofs.periodic.interval_newton import (
    Cover,
    Enclosure,
    Status,
    compared,
    interval_newton,
    least_gap,
    stepped,
)

AXIS = Problem(ellipse.at(a=Rational(3, 2)), (0, 0), lam=Rational(1, 3))
EGG = egg(3).at(alpha=Rational(2, 25))


TRIANGLES = Problem(EGG, (0, 0, 0), BifurcationKind.FOLD, "lam")
FOLD = TRIANGLES, exact_balls(refined(TRIANGLES, [-0.55, 1.54, 3.63, 0.378], 40).z)


def half_pi(bits: int) -> arb:
    with working(bits):
        return (arb.pi() / 2).mid()


SCENES = {  # table, the letter that is free, and its range
    "egg": (egg(3), "alpha", 0.001, 0.1),
    "pentagon": (egg(5), "alpha", 0.001, 0.03),
    "ellipse": (ellipse, "a", 1.01, 4.0),
    "cardioid": (cardioid, "lam", 0.01, 0.99),
    "cuspless": (cuspless, "lam", 0.01, 0.99),
}
SHARES = st.floats(0.01, 0.99)


CRITICAL = [BifurcationKind.FOLD, BifurcationKind.FLIP]


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(sorted(SCENES)),
    st.sampled_from(CRITICAL),
    SHARES,
    st.lists(SHARES, min_size=3),
)
@example("egg", BifurcationKind.FLIP, 0.5, [0.5, 0.5, 0.5])
@example("cardioid", BifurcationKind.FOLD, 0.01, [0.99, 0.01, 0.5, 0.5])
def test_the_ball_at_128_bits_contains_the_one_at_1024_bits_and_never_the_other_way(scene, kind, share, gaps):
    table, letter, low, high = SCENES[scene]
    gaps = gaps[:5]
    reach = 2.0 if scene == "cuspless" else math.pi
    theta = [reach * (2 * sum(gaps[:i]) / sum(gaps) - 1) + 1e-3 for i in range(len(gaps))]
    lam = None if letter == "lam" else arb(share)
    problem = Problem(table, (0,) * len(gaps), kind, letter, lam)
    z = [arb(x) for x in (*theta, low + share * (high - low))]
    found = []
    for bits in (128, 1024):
        with working(bits):
            at = Linearised(problem, balls(bits), z)
            found.append([*at.value, *at.solve(at.value), at.corner])
    for wide, narrow in zip(*found, strict=True):
        if wide.is_finite():
            assert wide.contains(narrow)
            assert wide.is_exact() or not narrow.contains(wide)


@settings(max_examples=60)
@given(st.floats(1e-6, 0.4), st.floats(-1, 1), st.floats(-1, 1), st.floats(1e-12, 1e-2))
def test_a_wrong_box_is_never_certified(distance, u, v, radius):
    if max(abs(u), abs(v)) < 0.1:
        u = 1.0
    shift = distance + 2 * radius
    scale = shift / max(abs(u), abs(v))
    x = half_pi(100)
    with working(100):
        centre = [(x + u * scale).mid(), (-x + v * scale).mid()]
        holds = all(abs(c - e) < radius for c, e in zip(centre, (x, -x), strict=True))
    found = interval_newton(AXIS, centre, arb(radius), 100)

    assert not holds
    if found.status is Status.UNIQUE:  # there is another zero: the other axis is one
        with working(100):
            assert not all(abs(c - e) < radius for c, e in zip(found.zero, (x, -x), strict=True))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4), st.floats(1e-9, 1e-3), st.floats(1.5, 20))
def test_a_wrong_box_of_a_fold_is_never_certified(way, radius, distance):
    """The fold of the egg's triangles, from 40 digits in mpmath, outside the box by half its radius at least."""
    problem, solution = FOLD
    size = max(abs(x) for x in way)
    if size < 0.1:
        way, size = [1.0, 0.0, 0.0, 0.0], 1.0
    with working(160):
        off = [(x + w / size * distance * radius).mid() for x, w in zip(solution, way, strict=True)]
        found = interval_newton(problem, off, arb(radius), 160)

        assert found.status is not Status.UNIQUE or not all(
            z.overlaps(x) for z, x in zip(found.zero, solution, strict=True)
        )


def test_the_three_answers_all_occur():
    x = half_pi(100)
    with working(100):
        centre = [x, (-x).mid()]
        off = [(x + 0.01).mid(), (-x).mid()]

    assert interval_newton(AXIS, centre, arb("1e-3"), 100).status is Status.UNIQUE
    assert interval_newton(AXIS, off, arb("1e-3"), 100).status is Status.EMPTY
    assert interval_newton(AXIS, centre, arb(2), 100).status is Status.UNKNOWN


def test_the_enclosure_contains_the_exact_cycle():
    x = half_pi(200)
    with working(200):
        found = interval_newton(AXIS, [x, (-x).mid()], arb("1e-9"), 200)
        exact = arb.pi() / 2

        assert found.zero[0].overlaps(exact)
        assert found.zero[1].overlaps(-exact)


def test_no_precision_is_left_behind():
    before = flint.ctx.prec
    certify(Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam"), [0.0, 0.0, 0.0934], 40)

    assert flint.ctx.prec == before


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        (circle, True),
        (ellipse.at(a=5), True),
        (cuspless, True),
        (EGG, True),
        (egg(3).at(alpha=Rational(1, 10)), True),
        (egg(5).at(alpha=Rational(1, 26)), True),
        (cardioid, None),
    ],
)
def test_convexity_is_proved_where_it_holds_and_left_open_at_a_cusp(table, expected):
    assert convex(table) is expected


def test_a_bounce_outside_its_component_is_not_admissible():
    assert inside(cuspless, (0, 0), [arb(1), arb("2.5")]) is False
    assert inside(cuspless, (1, 0), [arb(0), arb(1)]) is True
    with working(64):
        assert inside(cuspless, (0,), [2 * arb.pi() / 3]) is None


def test_a_cycle_run_through_twice_is_not_of_minimal_period():
    assert minimal(EGG, (0,) * 4, [arb(0), arb(3), arb(0), arb(3)]) is None
    assert minimal(EGG, (0,) * 4, [arb(0), arb(3), arb("0.1"), arb(3)]) is True


def test_the_cuspless_orbit_doubles_subcritically():
    proof = certify(Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam"), [0.0, 0.0, 0.0934], 30)

    assert proof.certified
    assert proof.supercritical is False


def test_a_value_outside_the_range_of_its_parameter_is_not_admissible():
    """The equations have a solution there, but no table."""
    doubling = Problem(egg(3), (0, 0), BifurcationKind.FLIP, "alpha", Rational(1, 2))
    found = certify(doubling, [0.0, math.pi, 0.05], 20)
    narrow = Interval(0, Rational(1, 100))
    beyond = replace(doubling, table=replace(egg(3), shapes=(replace(egg(3).shapes[0], range=narrow),)))

    assert found.certified
    assert found.value > 0.02
    assert proved(replace(found.claim, problem=beyond)).checks["admissible"] is None


def test_a_fold_is_no_flip():
    fold = certify(Problem(EGG, (0, 0, 0), BifurcationKind.FOLD, "lam"), [-0.55, 1.54, 3.63, 0.378], 30)
    as_flip = replace(fold.claim, problem=replace(fold.claim.problem, kind=BifurcationKind.FLIP))

    assert fold.certified
    assert proved(as_flip).checks["unique"] is not True


def test_a_claim_with_too_few_bits_is_unknown_and_not_refuted():
    solution = refined(corner(), [0.25, 0.07], 30)
    centre = exact_balls(solution.z)
    proof = interval_newton(corner(), centre, arb("1e-28"), 60)

    assert proof.status is Status.UNKNOWN


def test_a_proof_needs_every_item():
    x = half_pi(120)
    with working(120):
        claim = Claim(AXIS, (x, (-x).mid()), arb("1e-6"), 120, 200)
    proof = proved(claim)

    assert proof.checks["unique"] is True
    assert proof.checks["precise"] is not True
    assert not proof.certified


UNTIL = {  # what is not shown, and the items that are open then
    "_admissible": {"admissible"},
    "_allowed": {"admissible"},
    "minimal": {"minimal_period"},
    "_generic": {"nondegenerate"},
    "": set(),
}


@pytest.mark.parametrize("wrong", UNTIL, ids=lambda wrong: wrong or "nothing")
def test_each_item_of_the_checklist_is_what_its_step_says(monkeypatch, wrong):
    claim = Claim(
        Problem(cuspless, (1, 0), BifurcationKind.FLIP, "lam"), (arb(0), arb(0), arb(0.0934)), arb(1e-3), 80, 1
    )
    monkeypatch.setattr(
        bifurcation, "interval_newton", lambda *_: Enclosure(Status.UNIQUE, [arb(0), arb(0), arb(0.0934)])
    )
    monkeypatch.setattr(bifurcation, "_admissible", lambda *_: None if wrong == "_admissible" else True)
    monkeypatch.setattr(bifurcation, "_allowed", lambda *_: wrong != "_allowed")
    monkeypatch.setattr(bifurcation, "minimal", lambda *_: None if wrong == "minimal" else True)
    monkeypatch.setattr(bifurcation, "_form", lambda *_: None)
    monkeypatch.setattr(bifurcation, "_generic", lambda form: {"nondegenerate": None if wrong == "_generic" else True})
    found = proved(claim)

    assert {item for item, value in found.checks.items() if value is not True} == UNTIL[wrong]
    assert set(found.checks) == {"exists", "unique", "precise", "admissible", "minimal_period", "nondegenerate"}
    assert found.certified is (wrong == "")
    for status, items in ((Status.EMPTY, {False}), (Status.UNKNOWN, {None})):
        monkeypatch.setattr(bifurcation, "interval_newton", lambda *_, status=status: Enclosure(status, [arb(0)] * 3))
        checks = proved(claim).checks
        assert {checks["exists"], checks["unique"]} == items
        assert {checks["precise"], checks["admissible"], checks["minimal_period"]} == {None}


@pytest.mark.parametrize(
    ("changed", "broken"),
    [
        ({}, {}),
        ({"turn": arb(0, 1)}, {"simple_multiplier": None}),
        ({"speed": arb(0)}, {"transversal": None}),
        ({"bend": arb("nan")}, {"nondegenerate": None}),
        ({"bend": arb(1, "inf")}, {"nondegenerate": None}),
        ({"determinant": arb("-1.5")}, {"other_multiplier_stable": False}),
        ({"determinant": arb("1.5")}, {"other_multiplier_stable": False}),
        ({"determinant": arb(1)}, {"other_multiplier_stable": False}),
        ({"determinant": arb("-0.9", "0.2")}, {"other_multiplier_stable": None}),
    ],
)
def test_each_number_of_a_normal_form_decides_its_own_item(changed, broken):
    good = NormalForm(BifurcationKind.FLIP, arb(2), arb(-1, "0.5"), arb("1e-9"), arb("-0.5"))
    items = bifurcation._generic(replace(good, **changed))
    wanted = dict.fromkeys(("simple_multiplier", "transversal", "nondegenerate", "other_multiplier_stable"), True)

    if changed.get("determinant") == 1:  # neither smaller nor larger
        items["other_multiplier_stable"] = items["other_multiplier_stable"] or False
    assert items == wanted | broken
    assert set(bifurcation._generic(None).values()) == {None}


@pytest.mark.parametrize(
    ("free", "low", "high"), [("lam", "0", "1"), ("alpha", "0", "1/10")], ids=["contraction", "shape"]
)
def test_a_free_parameter_is_allowed_in_its_range_ends_included(free, low, high):
    problem = (
        Problem(EGG, (0, 0), BifurcationKind.FLIP, "lam")
        if free == "lam"
        else Problem(egg(3), (0, 0), BifurcationKind.FLIP, "alpha", Rational(1, 2))
    )
    with working(80):
        ends = [arb(int(Rational(x).p)) / int(Rational(x).q) for x in (low, high)]
        middle = (ends[0] + ends[1]) / 2
        assert bifurcation._allowed(problem, middle)
        assert bifurcation._allowed(problem, arb(0))
        for off in (ends[0] - arb("1e-20"), ends[1] + arb("1e-20"), arb(middle, 1), arb("nan")):
            assert not bifurcation._allowed(problem, off)


def test_the_twist_of_a_turn_that_grows_is_found_in_any_coordinates_that_keep_areas():
    """`z -> mu*z*(1 + i*twist*abs(z)**2)`, `z = x - i*p`, after a shear with two bends and a linear map of area 1."""
    ball = lambda x: arb(float(x))  # noqa: E731
    for angle, twist, a, b, q, r in (
        (0.7, 1.5, 0, 0, 1, 0),
        (1.9, -0.75, 0.5, 0.25, 2, 0.5),
        (2.6, 0.25, -1, 0.5, 0.5, -1),
        (None, 2, 0, 0, 1, 0),  # a quarter turn, whose terms of order three are in one coordinate each
    ):
        with working(120):
            quarter = angle is None
            c, s = (arb(0), arb(1)) if quarter else (arb(angle).cos(), arb(angle).sin())
            minus = -s
        cubes = {(3, 0): 1, (1, 2): 1}, {(2, 1): 1, (0, 3): 1}  # x*(x**2 + p**2), p*(x**2 + p**2)
        turn = ({(0, 1): s}, {(1, 0): minus}) if quarter else ({(1, 0): c, (0, 1): s}, {(1, 0): minus, (0, 1): c})
        # (x - i*p)*i*twist*size = twist*size*(p + i*x): to x comes twist*p*size, to p comes -twist*x*size
        grown = (
            {(1, 0): ball(1), (0, 1): ball(0)} | {k: ball(twist) for k in cubes[1]},
            {(1, 0): ball(0), (0, 1): ball(1)} | {k: ball(-twist) for k in cubes[0]},
        )
        shear = lambda sign: (  # noqa: E731
            {(1, 0): ball(1), (0, 1): ball(0)},
            {(0, 1): ball(1), (1, 0): ball(0), (2, 0): ball(sign * a), (3, 0): ball(sign * b)},  # noqa: B023
        )
        there = {(1, 0): ball(q), (0, 1): ball(r)}, {(1, 0): ball(0), (0, 1): ball(1 / q)}
        back = {(1, 0): ball(1 / q), (0, 1): ball(-r)}, {(1, 0): ball(0), (0, 1): ball(q)}
        with working(120):
            found = birkhoff_normal_form(
                composed([grown, turn] if quarter else [there, shear(1), grown, turn, shear(-1), back])
            )

            assert found.trace.overlaps(2 * c)
            assert abs(found.twist - twist) < 1e-20
            assert abs(found.drift) < 1e-20


@pytest.mark.parametrize(
    ("image", "status"),
    [
        (["0.1", "0.9 +/- 0.05"], Status.UNIQUE),
        (["0.1", "0.9 +/- 0.1001"], Status.UNKNOWN),  # reaches an end
        (["0.1", "1.5 +/- 0.4"], Status.EMPTY),
        (["5", "nan"], Status.UNKNOWN),
        (["0", "1 +/- 0.5"], Status.UNKNOWN),
        (["-1.01", "0"], Status.EMPTY),
    ],
)
def test_a_box_holds_one_zero_when_the_image_lies_inside_and_none_when_they_are_apart(image, status):
    box = [arb(0, 1), arb(0, 1)]
    balls_of = [arb(x) for x in image]

    assert compared(balls_of, box) is status
    centre = [arb("0.25"), arb("-0.5")]
    step = stepped(centre, box, lambda: [c - y for c, y in zip(centre, balls_of, strict=True)])
    assert step.status in (status, Status.UNKNOWN)
    assert all(x.overlaps(y) for x, y in zip(step.zero, balls_of, strict=True) if y.is_finite())

    def singular():
        raise ZeroDivisionError

    assert stepped(centre, box, singular) == Enclosure(Status.UNKNOWN, box)


def test_a_box_is_known_when_it_lies_in_a_neighbourhood_up_to_whole_turns():
    cover = Cover(AXIS, None, None, 0.5, [([1.0, -3.0], 0.25), ([2.0, 2.0], 0.5)])

    assert cover._known([1.1, -3.1 + 4 * math.pi], [0.1, 0.1])
    assert cover._known([1.1 - 2 * math.pi, -2.9], [0.1, 0.1])
    assert not cover._known([1.1, -3.1], [0.1, 0.16])
    assert not cover._known([1.1, -3.1], [0.16, 0.1])
    assert not cover._known([1.25, -3.0], [0.0, 0.0])
    assert cover._known([2.2, 1.8], [0.2, 0.2])
    assert not cover._known([1.0, 2.0], [0.0, 0.0])  # one bounce in each


@pytest.mark.parametrize("place", [0.1, 1.0, 3.0, 4.5, 6.2])
@pytest.mark.parametrize("allowed", [0.3, 0.9])
def test_a_gap_is_steep_all_around_and_the_largest_of_its_kind(place, allowed):
    """Chords shorter than 1.2 leave steeply, but for a stretch about one place, where only those below `allowed` do."""

    def angle(here, there):
        near = abs((here - place) - 2 * arb.pi() * round(float((here - place).mid()) / (2 * math.pi)))
        gap = abs(there - here)
        steep = gap < (allowed if near < 0.2 else 1.2)
        return ((1 if float(there) > float(here) else -1) * arb(1 if steep else 0),)

    one_way = lambda here, there: (abs(angle(here, there)[0]),)  # noqa: E731
    with working(64):
        for found in (least_gap(angle, arb("0.5")), triangles._gap(one_way, arb("0.5"))):
            assert allowed - 1 / 16 <= found < allowed
        assert least_gap(one_way, arb("0.5")) == 0  # the other way round they do not
        assert least_gap(angle, arb(1)) == triangles._gap(one_way, arb("1.5")) == 0
