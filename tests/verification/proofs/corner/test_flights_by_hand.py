"""Flights over the cuspless cardioid where landings are given or angles are linear, and what is asked of courses."""

import pytest
from flint import arb

from verification.arithmetic.balls import cuts, working
from verification.proofs.corner import corner, return_map
from verification.proofs.corner.corner import ARC, WALL, Bounce, Quantity
from verification.proofs.corner.return_map import TURN, Flights, Piece

EDGE, CORNER = 2.0943951023931953, 0.4330127018922193  # the ends of the arc and of the wall: 2*pi/3 and sqrt(3)/4
START = Piece(ARC, arb(0.25), arb(1), arb(0.125))
WAYS = {
    "upper": (ARC, 0.25, EDGE + 0.2),
    "wall": (WALL, -0.6, 0.6),
    "lower": (ARC, TURN - EDGE - 0.2, 0.25 + TURN),
}


@pytest.mark.parametrize(
    ("guess", "upper", "wall", "lower", "found"),
    [
        ("wall", None, 0.25, None, ["wall"]), ("wall", None, -0.43, None, ["wall"]), ("wall", None, None, None, None),
        ("wall", 2.0, -0.44, None, ["wall", "upper"]),  # the wall's parameter grows downwards
        ("wall", None, -0.44, None, None), ("wall", None, 0.44, -2.0, ["wall", "lower"]),
        ("wall", 2.0, 0.44, None, None), ("wall", 2.0, arb(0, 0.5), -2.0, ["wall", "upper", "lower"]),
        ("wall", 2.0, arb(0, 0.5), None, None), ("wall", None, arb(0, 0.5), -2.0, None),
        ("upper", 2.0, None, None, ["upper"]), ("upper", None, 0.25, None, None), ("upper", 2.1, None, None, None),
        ("upper", 2.1, -0.44, None, ["wall", "upper"]), ("upper", 2.1, 0.25, None, ["wall"]),
        ("upper", 2.1, arb(0, 0.5), -2.1, ["wall", "upper", "lower"]), ("upper", -2.0, None, None, ["upper"]),
        ("lower", None, None, -2.0, ["lower"]), ("lower", None, 0.25, None, None), ("lower", None, None, -2.1, None),
        ("lower", None, 0.44, -2.1, ["wall", "lower"]), ("lower", None, 0.25, -2.1, ["wall"]),
        ("lower", 2.1, arb(0, 0.5), -2.1, ["wall", "upper", "lower"]),
    ],
)  # fmt: skip
def test_from_the_arc_a_particle_lands_on_each_part_that_its_root_on_the_wall_leaves_possible(
    monkeypatch, guess, upper, wall, lower, found
):
    """Roots as floats or balls, None where none is enclosed; the first one asked for is the guess."""
    flights, asked = Flights(), []
    roots = {"upper": upper, "wall": wall, "lower": lower}

    def root(piece, target, low, high):
        assert piece is START
        (name,) = [name for name, way in WAYS.items() if way == pytest.approx((target, low, high))]
        asked.append(name)
        at = roots[name]
        return None if at is None else Piece(target, at if isinstance(at, arb) else arb(at), arb(1), arb(0))

    monkeypatch.setattr(flights, "_root", root)
    monkeypatch.setattr(flights, "_guess", lambda *given: guess)
    landed = flights.landing(START)

    assert asked[0] == guess
    if found is None:
        assert landed is None
    else:
        wanted = [(WAYS[name][0], roots[name]) for name in found]
        assert [(p.component, str(p.theta)) for p in landed] == [
            (part, str(at if isinstance(at, arb) else arb(at))) for part, at in wanted
        ]


@pytest.mark.parametrize(("corner", "parts"), [(-1, [WALL, ARC]), (1, [WALL, ARC]), (0, [WALL])])
def test_a_particle_that_may_meet_the_corner_itself_lands_on_both_parts(monkeypatch, corner, parts):
    """The ends in numbers that balls hold exactly, so that the root on the wall is at the corner or is not."""
    flights = Flights()
    flights.ends = {ARC: arb(2), WALL: arb(0.5)}
    roots = {WALL: Piece(WALL, corner * arb(0.5), arb(1), arb(0)), ARC: Piece(ARC, arb(2), arb(1), arb(0))}
    monkeypatch.setattr(flights, "_root", lambda piece, target, low, high: roots[target])
    for guess in ("wall", "upper" if corner < 0 else "lower"):
        monkeypatch.setattr(flights, "_guess", lambda *given, guess=guess: guess)
        assert [piece.component for piece in flights.landing(START)] == parts


A, B, C = 0.5, -0.75, 0.25


def linear(here, there):
    return A * here + B * there + C, A + 0 * here, B + 0 * there


@pytest.mark.parametrize(("low", "high", "turn"), [(-2.0, 2.0, 0), (TURN - 2, TURN + 2, 1), (0.0, TURN / 2, 0)])
def test_a_landing_by_a_linear_angle_is_the_one_worked_out_by_hand(monkeypatch, low, high, turn):
    """`theta1 = (A*theta + C - phi)/(-B)`, its slope `-A/B` times that before, and `phi1 = -lam*eta`."""
    flights = Flights(arb(0.5, 0.125))
    monkeypatch.setattr(flights, "floats", {(ARC, WALL): linear})
    monkeypatch.setattr(flights, "balls", {(ARC, WALL): linear})
    values = {(ARC, WALL): linear, (WALL, ARC): lambda here, there: (2 * here - 3 * there,)}
    monkeypatch.setattr(flights, "values", values)
    ends = []
    near = lambda angle, start, phi, a, b: ends.append((start, phi, a, b)) or (A * 0.5 + C - 0.125) / -B + TURN * turn  # noqa: E731
    monkeypatch.setattr(return_map, "_falling_root", near)
    piece = Piece(ARC, arb(0.5, 2.0**-6), arb(3), arb(0.125, 2.0**-7))
    with working(64):
        found = flights._root(piece, WALL, low, high)
    assert ends == [(0.5, 0.125, low, high)]
    places = [(A * (0.5 + s * 2.0**-6) + C - 0.125 - r * 2.0**-7) / -B for s in (-1, 1) for r in (-1, 1)]
    assert found.component == WALL
    assert all((found.theta + arb(0, 1e-14)).contains(arb(x)) for x in places)
    assert found.theta.rad() < 1.001 * (max(places) - min(places)) / 2
    assert abs(found.slope - 3 * A / -B) < 1e-12
    etas = [2 * x - 3 * (0.5 + s * 2.0**-6) for x in places for s in (-1, 1)]
    exits = [-lam * eta for lam in (0.375, 0.625) for eta in etas]
    assert all((found.phi + arb(0, 1e-14)).contains(arb(x)) for x in exits)
    assert found.phi.rad() < 1.15 * (max(exits) - min(exits)) / 2


@pytest.mark.parametrize(("off", "there"), [(0.0, True), (1e-11, True), (6.4e-11 * 2, False), (-1e-11, True)])
def test_a_guess_of_a_landing_may_be_off_by_what_six_boxes_reach(monkeypatch, off, there):
    """Of a point: from `1e-12` on, each twice as wide as that before it."""
    flights = Flights()
    for name in ("floats", "balls"):
        monkeypatch.setattr(flights, name, {(ARC, WALL): linear})
    monkeypatch.setattr(flights, "values", {(ARC, WALL): linear, (WALL, ARC): lambda here, there: (here,)})
    monkeypatch.setattr(return_map, "_falling_root", lambda *_: (A * 0.5 + C) / -B + off)
    found = flights._root(Piece(ARC, arb(0.5), arb(1), arb(0)), WALL, -1.0, 1.0)
    assert (found is not None) is there
    if there:
        assert abs(found.theta - (A * 0.5 + C) / -B) < 1e-14
        assert found.phi == 0  # the contraction 0


def test_where_the_angle_may_not_vary_no_landing_is_told(monkeypatch):
    flights = Flights()
    flat = lambda here, there: (A * here + B * there + C, A + 0 * here, arb(0, 1))  # noqa: E731
    monkeypatch.setattr(flights, "balls", {(ARC, WALL): flat})
    monkeypatch.setattr(flights, "values", {(ARC, WALL): flat})
    monkeypatch.setattr(flights, "floats", {(ARC, WALL): linear})
    assert flights._root(Piece(ARC, arb(0.5), arb(1), arb(0)), WALL, -1.0, 1.0) is None


def test_the_ends_of_arc_and_wall_are_those_of_the_corners_and_the_map_is_odd():
    flights = Flights()
    with working(100):
        assert abs(flights.ends[ARC] - 2 * arb.pi() / 3) < 1e-18
        assert abs(flights.ends[WALL] - arb(3).sqrt() / 4) < 1e-18
    assert flights.odd is True
    assert flights.lam == 0


def test_courses_go_from_the_upper_corner_by_the_lower_one_to_where_the_fourth_bounce_falls(monkeypatch):
    """Each bounce comes from the two before it, with the slopes by `theta1` and `lam`; each of both ends counts."""
    asked = []
    bounces = {name: Bounce(part, name) for name, part in (("a", ARC), ("b", WALL), ("third", ARC), ("y", WALL))}

    def after_corner(previous, here, upper, lam, spread):
        asked.append((previous, here, upper, lam, spread))
        return [bounces["y"]] if upper else [bounces["a"], bounces["b"]]

    def on_arc(previous, here, near, lam, spread):
        asked.append((previous, here, near, lam, spread))
        return bounces["third"]

    monkeypatch.setattr(return_map, "after_corner", after_corner)
    monkeypatch.setattr(return_map, "on_arc", on_arc)
    monkeypatch.setattr(return_map, "beyond", lambda bounce, upper: (bounce.at, upper))
    found = return_map.courses(arb(0.25, 2.0**-9), arb(0.0625, 2.0**-10))
    (start, first, no, lam, spread), (one, second, near, *_), (two, third, yes, *_), *_ = asked

    assert [(c.component, c.second, c.fourth) for c in found] == [
        (ARC, ("a", False), ("y", True)), (WALL, ("b", False), ("y", True)),
    ]  # fmt: skip
    assert [float(x.rad()) for x in spread] == pytest.approx([2.0**-9, 2.0**-10])
    assert all(x.mid() == 0 for x in spread)
    assert (start.component, first.component) == (ARC, ARC)
    assert abs(start.at.centre - 2 * arb.pi() / 3) < 1e-15
    assert start.at.slopes == (arb(0), arb(0))
    assert (first.at.centre, first.at.slopes) == (arb(0.25), (arb(1), arb(0)))
    assert (lam.centre, lam.slopes) == (arb(0.0625), (arb(0), arb(1)))
    assert first.at.whole.contains(arb(0.25 + 2.0**-9))
    assert lam.whole.contains(arb(0.0625 - 2.0**-10))
    assert (no, yes) == (False, True)
    assert one is first
    assert second is two is bounces["a"]
    assert third is bounces["third"]
    assert near == pytest.approx(-float(corner.enclosed()[0]))
    assert [len(given[4]) for given in asked] == [2] * 5


@pytest.mark.parametrize("wrong", [None, 0, 1, 2, 3])
def test_the_angles_that_are_asked_for_lie_between_those_of_the_strips_and_beyond_those_at_the_ends(monkeypatch, wrong):
    """`_towards` only guesses: a strip that ends before the angle, or ends that lie beyond it, prove nothing."""
    monkeypatch.setattr(return_map, "exit_angle", lambda theta: -theta)
    guessed, strips = [], []

    def towards(phi):
        guessed.append(phi)
        off = 1 if len(guessed) - 1 != wrong else -1
        return -0.25 * (1 if phi > 0 else -1) * (1 + (off if abs(phi) > 0.25 else -off) * return_map.MARGIN / 2)

    def followed(strip, lam):
        strips.append((strip, lam))
        return []

    one = lambda part: [return_map.Course(part, None, None)]  # noqa: E731
    monkeypatch.setattr(return_map, "_towards", towards)
    monkeypatch.setattr(return_map, "_followed", followed)
    monkeypatch.setattr(return_map, "courses", lambda theta, lam: one(WALL if theta < 0 else ARC))
    found = return_map.minimum_at_kink(0.25, 0.0625, 0.0703125)

    assert sorted(abs(phi) / 0.25 - 1 for phi in guessed) == pytest.approx([-1e-6, -1e-6, 1e-6, 1e-6])
    assert found is (True if wrong is None else None)
    if wrong is None:
        lams = {str(lam) for _, lam in strips}
        assert lams == {str(lam) for lam in cuts(0.0625, 0.0703125, return_map.LONGEST_LAM)}
        for at in (-0.25, -0.1, 0.0, 0.25):
            assert any(strip.contains(arb(at)) for strip, _ in strips)
        assert all(strip.rad() < return_map.LONGEST_THETA for strip, _ in strips)


def test_an_angle_that_is_the_one_asked_for_is_not_beyond_it(monkeypatch):
    monkeypatch.setattr(return_map, "_followed", lambda *_: [])
    monkeypatch.setattr(return_map, "courses", lambda theta, lam: [return_map.Course(int(theta < 0), None, None)])
    for left, inner, right, last, told in (
        (0.375, 0.125, -0.375, -0.125, True), (0.25, 0.125, -0.375, -0.125, None), (0.375, 0.25, -0.375, -0.125, None),
        (0.375, 0.125, -0.25, -0.125, None), (0.375, 0.125, -0.375, -0.25, None), (0.375, -0.125, -0.375, -0.125, True),
        (0.375, -0.5, -0.375, -0.125, None), (0.375, 0.125, -0.375, 0.5, None),
    ):  # fmt: skip
        places = iter([-1.0, 1.0, -0.5, 0.5])
        angles = {-1.0: left, 1.0: right, -0.5: inner, 0.5: last}
        monkeypatch.setattr(return_map, "_towards", lambda _, places=places: next(places))
        monkeypatch.setattr(return_map, "exit_angle", lambda theta, angles=angles: arb(angles[float(theta)]))
        assert return_map.minimum_at_kink(0.25, 0.0625, 0.0630) is told


def test_a_kink_is_enclosed_in_a_box_six_tenths_as_wide_as_the_contractions(monkeypatch):
    asked = []

    def courses(theta1, lam):
        asked.append((theta1, lam))
        side = arb(1) if theta1 < 0.2499 else arb(-1) if theta1 > 0.2501 else arb(0, 2.0**-20)
        second = Quantity(arb(0), (arb(-2), arb(1)), side)
        return [return_map.Course(WALL, second, Quantity(arb(0), (arb(-4), arb(3)), arb(8)))]

    monkeypatch.setattr(return_map, "courses", courses)
    monkeypatch.setattr(return_map, "_near", lambda _: 0.25)
    lam = arb(0.0625, 2.0**-10)
    found = return_map.kink(lam)

    assert found.lam is lam
    assert float(found.theta1.rad()) == pytest.approx(0.6 * 2.0**-10 + 1e-9, rel=1e-6)
    assert found.speed == 1  # 3 - (-4)*1/(-2)
    assert found.value.mid() == 8
    assert float(found.value.rad()) == pytest.approx(2.0**-10 + 2 * 2.0**-20, rel=1e-6)  # 4/2 of what is missed
    assert [float(theta.mid()) for theta, _ in asked] == pytest.approx(
        [0.25 - 0.6 * 2.0**-10, 0.25 + 0.6 * 2.0**-10, 0.25, 0.25], abs=1e-8
    )
    assert [x is lam for _, x in asked] == [True, True, True, False]
    assert asked[-1][1] == arb(0.0625)


def test_a_map_is_odd_where_every_component_is_its_own_mirror_image(monkeypatch):
    asked = []
    monkeypatch.setattr(return_map, "mirrored", lambda part: asked.append(part) or len(asked) != 2)
    assert Flights().odd is False
    assert len(asked) == 2


@pytest.mark.parametrize(("angle", "low", "high"), [(0.25, 0.0, 2.0), (1.0, 0.25, 0.5), (0.5, 0.0, 1.0)])
def test_boxes_of_angles_and_contractions_are_halved_along_either_side_and_cover_all(monkeypatch, angle, low, high):
    settled, asked = [], set()

    def lands(phi, lam, or_lower):
        asked.add(or_lower)
        small = float(phi.rad()) < angle / 3 and float(lam.rad()) < (high - low) / 6
        return small and not settled.append((phi, lam))

    monkeypatch.setattr(return_map, "_lands_inside", lands)
    found = return_map.fourth_on_wall(angle, low, high)
    assert found.on_wall is True
    assert asked == {False}
    for k in range(-8, 9):
        for i in range(9):
            phi, lam = arb(angle * k / 8), arb(low + (high - low) * i / 8)
            assert any(a.contains(phi) and b.contains(lam) for a, b in settled)
    for phi, lam in settled:
        assert abs(phi) < angle + 1e-8
        assert low - 1e-8 < lam < high + 1e-8
    assert sum(float(phi.rad() * lam.rad()) for phi, lam in settled) == pytest.approx(angle * (high - low) / 2)
    assert return_map.fourth_on_wall(angle, low, high, or_lower=True).on_wall is True
    assert asked == {False, True}


def test_boxes_too_small_to_be_cut_on_end_the_question(monkeypatch):
    monkeypatch.setattr(return_map, "_lands_inside", lambda *_: False)
    found = return_map.fourth_on_wall(0.25, 0.0, 0.5, 5000)
    assert found.on_wall is None
    assert 70 < found.boxes < 90  # 38 halvings of either side, one after the other


def given(second, fourth=8.0):
    return return_map.Course(
        WALL, Quantity(arb(0), (arb(-2), arb(1)), second), Quantity(arb(0), (arb(-4), arb(3)), arb(fourth))
    )


def test_a_kink_is_between_ends_where_every_course_is_on_its_side_and_all_that_is_missed_counts(monkeypatch):
    sides = {"left": [arb(1), arb(2)], "right": [arb(-1), arb(-2)]}

    def courses(theta1, lam):
        if theta1 < 0.2499 or theta1 > 0.2501:
            return [given(x) for x in sides["left" if theta1 < 0.25 else "right"]]
        return [given(arb(0, 2.0**-20)), given(arb(0, 2.0**-16))]

    monkeypatch.setattr(return_map, "courses", courses)
    monkeypatch.setattr(return_map, "_near", lambda _: 0.25)
    lam = arb(0.0625, 2.0**-10)
    assert float(return_map.kink(lam).value.rad()) == pytest.approx(2.0**-10 + 2 * 2.0**-16, rel=1e-6)
    for side, wrong in (("left", [arb(1), arb(-1)]), ("left", [arb(0), arb(1)]), ("right", [arb(-1), arb(1)]),
                        ("right", [arb(0), arb(-1)])):  # fmt: skip
        right, sides[side] = sides[side], wrong
        with pytest.raises(ArithmeticError, match="the kink is not enclosed"):
            return_map.kink(lam)
        sides[side] = right


@pytest.mark.parametrize(
    ("lam", "theta1", "answer"),
    [
        (arb("0.07", "0.01"), arb("0.25", "0.1"), True), (arb("0.08", "0.01"), arb("0.25", "0.1"), None),
        (arb("0.07", "0.01"), arb("0.35", "0.1"), None), (arb("0.07", "0.0001"), arb("0.25", "0.1"), None),
        (arb("0.07", "0.01"), arb("0.25", "0.001"), None),
    ],
)  # fmt: skip
def test_the_corner_orbit_must_be_at_a_kink_with_all_that_its_enclosure_holds(monkeypatch, lam, theta1, answer):
    """It is known up to 1/100 and 1/1000: a kink whose ball meets that, and does not hold it, may be another."""
    monkeypatch.setattr(return_map, "enclosed", lambda: (arb("0.25", "0.01"), arb("0.07", "0.001")))
    monkeypatch.setattr(return_map, "cuts", lambda *_: [lam])
    monkeypatch.setattr(return_map, "kink", lambda lam: return_map.Kink(lam, theta1, arb(0), arb(-1)))
    assert return_map.kink_falls(0.06, 0.08) is answer


def test_the_speed_and_the_value_at_a_kink_count_the_worst_of_its_courses(monkeypatch):
    """With `s2` moving by -2 and 5, `s4` by -4 and 3, or -8 and 3: the kink by 3 - 4*5/2 or 3 - 8*5/2."""

    def courses(theta1, lam):
        side = arb(1) if theta1 < 0.2499 else arb(-1) if theta1 > 0.2501 else arb(0, 2.0**-20)
        second = Quantity(arb(0), (arb(-2), arb(5)), side)
        return [
            return_map.Course(WALL, second, Quantity(arb(0), (arb(slope), arb(3)), arb(8))) for slope in (-4.0, -8.0)
        ]

    monkeypatch.setattr(return_map, "courses", courses)
    monkeypatch.setattr(return_map, "_near", lambda _: 0.25)
    found = return_map.kink(arb(0.0625, 2.0**-10))
    assert (found.speed.contains(-7), found.speed.contains(-17), found.speed.rad() < 5.001) == (True, True, True)
    assert float(found.value.rad()) == pytest.approx(17 * 2.0**-10 + 4 * 2.0**-20, rel=1e-6)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_one_stretch_of_contractions_has_the_corner_orbit(monkeypatch, place):
    monkeypatch.setattr(return_map, "enclosed", lambda: (arb(0.25), arb(0.0625)))
    monkeypatch.setattr(return_map, "cuts", lambda *_: [0, 1, 2])
    monkeypatch.setattr(
        return_map,
        "kink",
        lambda k: return_map.Kink(arb(0.0625 if k == place else 1), arb(0.25, 0.125), arb(0), arb(-1)),
    )
    assert return_map.kink_falls(0.0, 1.0) is True
