"""Where the fourth collision falls, step by step: what is decided of courses and landings that are given."""

import random

import pytest
from flint import arb

from verification.arithmetic.balls import working
from verification.proofs.corner import corner, half_return, return_map
from verification.proofs.corner.corner import ARC, WALL, Quantity
from verification.proofs.corner.return_map import Course, Flights, Fourth, Kink, Piece

OPEN = arb(0, 1)


def course(second: float | arb, component: int, *fourth: float | arb, whole: float | arb = 0) -> Course:
    ball = lambda x: x if isinstance(x, arb) else arb(x)  # noqa: E731
    slopes = tuple(map(ball, fourth)) or (arb(1), arb(0))
    return Course(component, Quantity(arb(0), (ball(second), arb(1)), ball(whole)), Quantity(arb(0), slopes, arb(0)))


@pytest.mark.parametrize(
    ("given", "turns"),
    [
        (course(-1, WALL, -1), True), (course(-1, ARC, 1), True), (course(-1, WALL, 1), False),
        (course(-1, ARC, -1), False), (course(1, WALL, -1), False), (course(1, ARC, 1), False),
        (course(OPEN, ARC, 1), False), (course(-1, ARC, OPEN), False), (course(-1, WALL, OPEN), False),
        (course(0, WALL, -1), False), (course(-1, WALL, 0), False), (course(-1, ARC, 0), False),
    ],
)  # fmt: skip
def test_a_course_turns_where_the_second_bounce_moves_to_the_arc_and_s4_falls_before_and_grows_behind(given, turns):
    assert return_map._turns(given) is turns


RIGHT = {"strips": [course(-1, WALL, -1), course(-1, ARC, 1)], "ends": [[WALL], [ARC]]}


@pytest.mark.parametrize(
    ("wrong", "answer"),
    [
        ({}, True), ({"strips": [course(-1, WALL, -1), course(-1, ARC, -1)]}, None),
        ({"strips": [course(-1, WALL, 1)]}, None), ({"ends": [[ARC], [ARC]]}, None), ({"ends": [[WALL], [WALL]]}, None),
        ({"ends": [[WALL, ARC], [ARC]]}, None), ({"ends": [[ARC], [WALL]]}, None), ({"ends": None}, None),
    ],
)  # fmt: skip
def test_s4_has_its_minimum_at_the_kink_where_every_box_turns_and_the_kink_is_within_the_angles(
    monkeypatch, wrong, answer
):
    given = RIGHT | wrong
    ends = []

    def courses(theta1, lam):
        if given["ends"] is None:
            raise ArithmeticError
        ends.append(float(theta1))
        return [course(-1, part) for part in given["ends"][float(theta1) > 0.25]]

    monkeypatch.setattr(return_map, "_followed", lambda *_: given["strips"])
    monkeypatch.setattr(return_map, "courses", courses)
    assert return_map.minimum_at_kink(0.03, 0.0712, 0.0713) is answer
    if answer:  # at angles just within those that are asked for
        angles = [float(return_map.exit_angle(arb(end)).mid()) for end in sorted(set(ends))]
        assert all(0.03 * (1 - 1e-5) < abs(x) < 0.03 for x in angles)
        assert angles[0] > 0 > angles[1]


def crossing(first: float, last: float):
    """The second bounce passes the corner at `first` on the left of the box, at `last` on its right."""

    def courses(theta1, lam):
        whole = arb(0, 1e-12) if theta1.rad() > 0 or abs(float(theta1.mid()) - 0.25) < 1e-15 else None
        whole = whole or arb(first if theta1 < 0.25 else last)
        return [course(-2, component, -3, slope, whole=whole) for component, slope in ((WALL, 4), (ARC, 5))]

    return courses


@pytest.mark.parametrize(("first", "last", "held"), [(1, -1, True), (-1, -1, False), (1, 1, False), (0, -1, False),
                                                     (1, 0, False)])  # fmt: skip
def test_the_kink_is_in_a_box_at_whose_ends_the_second_bounce_is_on_either_side_of_the_corner(
    monkeypatch, first, last, held
):
    """`s4 = -3*theta1 + (4 or 5)*lam` and `s2 = -2*theta1 + lam`: at the kink it moves by `4 - 3/2` or `5 - 3/2`."""
    monkeypatch.setattr(return_map, "courses", crossing(first, last))
    monkeypatch.setattr(return_map, "_near", lambda _: 0.25)
    lam = arb(0.0712, 1e-4)
    if not held:
        with pytest.raises(ArithmeticError, match="the kink is not enclosed"):
            return_map.kink(lam)
        return
    found = return_map.kink(lam)
    assert found.speed.contains(arb("2.5"))
    assert found.speed.contains(arb("3.5"))
    assert found.theta1.contains(arb(0.25))
    assert found.value.contains(arb(3.5) * 1e-4)
    assert found.value.contains(arb(-3.5) * 1e-4)
    assert found.value.rad() < 4e-4


def kinks(theta1=None, star=None, speed=-1.0, apart=False) -> list[Kink]:
    at, lam = corner.enclosed()
    places = [at if theta1 is None else arb(theta1)] * 2
    places[1] = places[1] + (1 if apart else 0)
    return [Kink(lam if star is None else arb(star), place, arb(0), arb(speed)) for place in places]


@pytest.mark.parametrize(
    ("found", "answer"),
    [
        (kinks(), True), (kinks(speed=0.0), None), (kinks(speed=1.0), None), (kinks(apart=True), None),
        (kinks(theta1=0.3), None), (kinks(star=0.08), None),
    ],
)  # fmt: skip
def test_s4_falls_at_one_kink_that_is_the_corner_orbit_at_lambda_star(monkeypatch, found, answer):
    left = list(found)
    monkeypatch.setattr(return_map, "cuts", lambda *_: found)
    monkeypatch.setattr(return_map, "kink", lambda _: left.pop(0))
    assert return_map.kink_falls(0.071, 0.0713) is answer


def test_s4_is_not_said_to_fall_where_a_kink_is_not_enclosed(monkeypatch):
    def kink(_):
        raise ArithmeticError

    monkeypatch.setattr(return_map, "kink", kink)
    assert return_map.kink_falls(0.071, 0.0713) is None


def landed(component: int, theta: float | arb) -> return_map.Piece:
    return return_map.Piece(component, theta if isinstance(theta, arb) else arb(theta), arb(1), arb(0))


@pytest.mark.parametrize(
    ("images", "on_wall", "beyond"),
    [
        (None, False, False), ([landed(WALL, 0.4)], True, True), ([landed(WALL, -0.4)], True, True),
        ([landed(WALL, 0.44)], False, True), ([landed(WALL, -0.44)], False, False), ([landed(ARC, -1)], False, True),
        ([landed(ARC, 1)], False, False), ([landed(ARC, arb(0, 1))], False, False), ([landed(ARC, 0)], False, False),
        ([landed(WALL, 0.4), landed(ARC, -2)], False, True), ([landed(WALL, 0.4), landed(ARC, 2)], False, False),
        ([landed(WALL, arb(0, 0.5))], False, False),
    ],
)  # fmt: skip
def test_the_fourth_collision_is_on_the_wall_or_on_its_lower_side_where_all_pieces_are(
    monkeypatch, images, on_wall, beyond
):
    asked = []
    monkeypatch.setattr(return_map.Flights, "iterated", lambda self, pieces, n: asked.append((pieces, n)) or images)
    assert return_map._lands_inside(arb(0.01), arb(0.02), False) is on_wall
    assert return_map._lands_inside(arb(0.01), arb(0.02), True) is beyond
    ((piece,), count), _ = asked
    assert (piece.component, count) == (ARC, 4)
    assert piece.theta.overlaps(2 * arb.pi() / 3)
    assert abs(piece.theta - 2 * arb.pi() / 3) < 1e-12
    assert piece.phi == arb(0.01)


@pytest.mark.parametrize(("wide", "answer"), [(0.3, True), (1e-13, None)])
def test_boxes_are_halved_until_each_is_settled_and_together_they_are_all_that_was_asked(monkeypatch, wide, answer):
    settled, shares = [], []

    def lands(phi, lam, or_lower):
        small = float(phi.rad()) < wide and float(lam.rad()) < wide
        return small and not settled.append((phi, lam))

    monkeypatch.setattr(return_map, "_lands_inside", lands)
    found = return_map.fourth_on_wall(1.0, 0.25, 0.75, 200, False, shares.append)
    assert found.on_wall is answer
    if answer:
        assert abs(sum(shares) - 1) < 1e-12
        for k in range(21):
            for i in range(11):
                phi, lam = arb(-1 + k / 10), arb(0.25 + i / 20)
                assert any(a.contains(phi) and b.contains(lam) for a, b in settled)
    assert return_map.fourth_on_wall(1.0, 0.25, 0.75, 3) == Fourth(None, 4)


@pytest.mark.parametrize(
    ("at", "there"),
    [(arb(2), True), (arb(-2), True), (arb(2.2), False), (arb(-2.2), False), (arb(2, 0.2), False), (None, False)],
)
def test_a_particle_from_the_wall_lands_on_the_arc_where_its_root_is_proved_to_lie_between_the_ends(
    monkeypatch, at, there
):
    flights, asked = return_map.Flights(), []
    monkeypatch.setattr(
        flights, "_root", lambda *given: asked.append(given) or (None if at is None else landed(ARC, at))
    )
    found = flights.landing(landed(WALL, 0.1))

    assert (found is not None) is there
    assert found is None or [piece.theta for piece in found] == [at]
    assert [given[1] for given in asked] == [ARC]


def test_where_one_of_several_pieces_does_not_land_nothing_is_told(monkeypatch):
    flights = return_map.Flights()
    ways = {1: [landed(ARC, 2), landed(WALL, 3)], 2: [landed(ARC, 4)], 3: None, 4: [landed(ARC, 5)]}
    monkeypatch.setattr(flights, "landing", lambda piece: ways[int(float(piece.theta))])

    assert [float(piece.theta) for piece in flights.iterated([landed(ARC, 1)], 1)] == [2, 3]
    assert [float(piece.theta) for piece in flights.iterated([landed(ARC, 2)], 2)] == [5]
    assert flights.iterated([landed(ARC, 1)], 2) is None
    assert flights.iterated([landed(ARC, 1)], 0)[0].theta == 1


@pytest.mark.parametrize(("size", "told"), [(1.0, True), (0.4, True), (0.07, True), (0.06, False)])
def test_strips_are_halved_up_to_four_times_and_cover_all_that_was_asked(monkeypatch, size, told):
    done = []

    def courses(theta1, lam):
        if theta1.rad() > size:
            raise ArithmeticError
        done.append(theta1)
        return [theta1]

    monkeypatch.setattr(return_map, "courses", courses)
    if not told:
        with pytest.raises(ArithmeticError):
            return_map._followed(arb(0, 1), arb(0))
        return
    assert return_map._followed(arb(0, 1), arb(0)) == done
    assert all(any(part.contains(arb(k) / 16) for part in done) for k in range(-16, 17))


SIZES = [(1, 1, True), (0.3, 1, True), (1, 0.3, True), (0.13, 0.13, True), (0.07, 0.13, False), (0.13, 0.07, False)]


@pytest.mark.parametrize(("wide", "late", "told"), SIZES)
def test_boxes_of_a_half_return_are_halved_along_the_longer_of_two_sides_up_to_six_times(monkeypatch, wide, late, told):
    done = []

    def images(component, u, v, e):
        if v.rad() > wide or e.rad() > late:
            raise ArithmeticError
        done.append((u, v, e))
        return [(component, v)]

    monkeypatch.setattr(half_return, "_images", images)
    box = arb(5), arb(0, 1), arb(0, 1)
    if not told:
        with pytest.raises(ArithmeticError):
            half_return.followed(WALL, *box)
        return
    assert half_return.followed(WALL, *box) == [(WALL, v) for _, v, _ in done]
    for v, e in [(arb(i) / 8, arb(k) / 8) for i in range(-8, 9) for k in range(-8, 9)]:
        assert any(a.contains(v) and b.contains(e) for _, a, b in done)
    assert all(u == 5 for u, _, _ in done)


@pytest.mark.parametrize("component", [ARC, WALL])
def test_where_a_piece_lands_holds_where_its_points_land_and_is_not_much_wider(component):
    """The points are taken at the ends of the piece and inside, with angles and contractions of the balls given."""
    chance, landed = random.Random(8), 0
    with working(corner.BITS):
        wide, thin = Flights(arb(0.3, 0.02)), [Flights(arb(x)) for x in (0.28, 0.3, 0.32)]
        for _ in range(60):
            at, phi = chance.uniform(-1, 1) * (1.5 if component == ARC else 0.4), chance.uniform(-0.6, 0.6)
            half, spread = 10 ** chance.uniform(-6, -1.7), 10 ** chance.uniform(-6, -2)
            images = wide.landing(Piece(component, arb(at, half), arb(1), arb(phi, spread)))
            if images is None or len(images) > 1:
                continue
            (image,), starts = images, [at + x * half for x in (-0.999, -0.4, 0, 0.7, 0.999)]
            for flights, start in zip(thin * 2, starts, strict=False):
                for leaving in (phi - 0.999 * spread, phi, phi + 0.999 * spread):
                    (point,) = flights.landing(Piece(component, arb(start), arb(1), arb(leaving))) or [None]
                    assert point.component == image.component
                    assert image.theta.contains(point.theta)
                    assert image.slope.contains(point.slope)
                    assert image.phi.contains(point.phi)
            landed += 1
            if spread < half / 50 and half < 1e-3:
                assert image.theta.rad() < 1.3 * abs(image.slope).upper() * half
    assert landed > 30
