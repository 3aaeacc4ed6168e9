"""The second reader's tables and flights, step by step, by formulas in floating point and by what was worked out."""

from fractions import Fraction
from math import atan2, cos, pi, sin, sqrt

import mpmath
import pytest
from by_hand import number

P = 100


def same(check, x, true, units=2**24):
    """Is a float, with its error, in an interval of no more than so many units in the last place?"""
    x = check.I.of(check.value(x), P)
    return abs(x.real() - true) < 1e-13 * (1 + abs(true)) and x.width() <= units


def table(check, *parts, law=None, **letters):
    return check.Table([list(part) for part in parts], {k: number(check, x) for k, x in letters.items()}, law, P)


CIRCLE = "1", "-pi", "pi"
OVAL = "2*cos(theta)", "sin(theta)", "-pi", "pi"


def test_a_table_of_one_part_is_closed_and_of_several_none_is_until_more_is_known(check):
    one, two = table(check, CIRCLE, b="1/3"), table(check, CIRCLE, OVAL, law="-lam*eta")
    assert (one.closed, one.law, one.marks, one.turns, one.p) == ([True], None, [], [], P)
    assert (two.closed, two.marks, two.turns) == ([False, False], [], [])
    assert two.law is not None
    assert [len(part) for part in two.parts] == [3, 4]


def test_a_place_has_its_point_and_its_velocity_by_a_radius_and_by_a_pair_of_formulas(check):
    both = table(check, ("2 + theta**2/3", "-1", "b"), ("theta**2", "sin(b*theta)", "0", "pi/2"), b="1/5")
    for t in (-0.75, 0.5, 1.25):
        r, dr, theta = 2 + t * t / 3, 2 * t / 3, number(check, t)
        wanted = r * cos(t), r * sin(t), dr * cos(t) - r * sin(t), dr * sin(t) + r * cos(t)
        assert all(map(same, [check] * 4, both.at(0, theta, both.letters, P), wanted))
        wanted = t * t, sin(t / 5), 2 * t, cos(t / 5) / 5
        assert all(map(same, [check] * 4, both.at(1, theta, both.letters, P), wanted))
    assert [x.real() for x in both.ends(0, P)] == [-1, 0.2]
    assert [x.real() for x in both.ends(1, P)] == [0, pi / 2]
    assert [x.p for x in both.ends(1, 30)] == [30, 30]


@pytest.mark.parametrize(("here", "there"), [("0", "2"), ("1/3", "3"), ("-1", "5/7"), ("2", "1/2"), ("-2", "2")])
def test_a_chord_leaves_at_its_angle_from_the_inward_normal(check, here, there):
    """Of the oval with half axes 2 and 1; in the circle it is a right angle less half the way round."""
    a, b = float(Fraction(here)), float(Fraction(there))
    dx, dy, tx, ty = 2 * (cos(b) - cos(a)), sin(b) - sin(a), -2 * sin(a), cos(a)
    places = (0, number(check, here)), (0, number(check, there))
    assert same(check, table(check, OVAL).angle(*places, {}), atan2(dx * tx + dy * ty, dy * tx - dx * ty))
    way = (b - a) % (2 * pi)
    assert same(check, table(check, CIRCLE).angle(*places, {}), pi / 2 - way / 2)


def test_a_chord_that_leaves_outwards_or_nowhere_has_no_angle(check):
    clockwise = table(check, ("2*cos(theta)", "-sin(theta)", "-pi", "pi"))
    zero, one = number(check, 0), number(check, 1)
    for made, end in ((clockwise, one), (table(check, CIRCLE), zero)):
        with pytest.raises(check.Unproved, match="may not leave inwards"):
            made.angle((0, zero), (0, end), {})


def landing(theta, psi):
    """In the oval, by the quadratic equation along the ray, in mpmath: where it lands and minus the incidence."""
    m = mpmath.mp
    x, y, tx, ty = 2 * m.cos(theta), m.sin(theta), -2 * m.sin(theta), m.cos(theta)
    ux, uy = tx * m.sin(psi) - ty * m.cos(psi), ty * m.sin(psi) + tx * m.cos(psi)
    t = -2 * (x * ux / 4 + y * uy) / (ux * ux / 4 + uy * uy)
    u, v = x + t * ux, y + t * uy
    there = m.atan2(v, u / 2)
    sx, sy = -2 * m.sin(there), m.cos(there)
    return there, m.atan((ux * sx + uy * sy) / (ux * sy - uy * sx))


@pytest.mark.parametrize("law", [None, "-lam*eta", "lam*eta**2 - theta/5", "theta/7 + lam"])
@pytest.mark.parametrize(("theta", "psi"), [("1/3", "1/5"), ("-1/2", "-1/3"), ("1", "0")])
def test_a_flight_lands_where_the_line_meets_the_curve_again_with_its_derivatives(check, law, theta, psi):
    """By the start and the angle, against differences of mpmath; under the law, whose letter is 1/9."""
    made, lam = table(check, OVAL, law=law), Fraction(1, 9)
    leaves = {
        None: lambda t, out: out / 9,
        "-lam*eta": lambda t, out: out / 9,
        "lam*eta**2 - theta/5": lambda t, out: out**2 / 9 - t / 5,
        "theta/7 + lam": lambda t, out: t / 7 + mpmath.mpf(1) / 9,
    }[law]
    at = [mpmath.mpf(x.numerator) / x.denominator for x in (Fraction(theta), Fraction(psi))]
    with mpmath.workdps(40):
        near = Fraction(float(landing(*at)[0]))
        state = [check.Jet.of(number(check, x), 1, k) for k, x in enumerate((theta, psi))]
        place = 0, number(check, near).wide(number(check, Fraction(1, 500)))
        found = made.flight(0, place, state, {"lam": number(check, lam)})
        truths = [lambda *x: landing(*x)[0], lambda *x: leaves(*landing(*x))]
        for jet, true in zip(found, truths, strict=True):
            assert same(check, jet, float(true(*at)))
            for slope, order in zip(jet.gradient(P), ((1, 0), (0, 1)), strict=False):
                assert slope.real() == pytest.approx(float(mpmath.diff(true, tuple(at), order)), rel=1e-10)
                assert slope.width() < 2**30
            assert jet.gradient(P)[2].real() == 0


def landed(check, made, start, psi, part, near):
    """The flight of one particle to a place."""
    state = [check.Jet.of(number(check, x), 0) for x in (start, psi)]
    place = part, number(check, near).wide(number(check, Fraction(1, 100)))
    return made.flight(0, place, state, made.letters | {"lam": number(check, "1/3")})


def test_no_particle_lands_behind_its_start_or_arrives_from_outside(check):
    """From a disc to the right: on the wall ahead, not on the wall behind, nor on another disc's far side."""
    disc = "cos(theta)", "-sin(theta)", "-pi", "pi"
    made = table(
        check, disc, ("9*cos(theta)", "9*sin(theta)", "-pi", "pi"), ("4 + cos(theta)", "-sin(theta)", "-pi", "pi")
    )
    there, psi = landed(check, made, 0, 0, 1, 0)
    assert (check.value(there).real(), check.value(psi).real()) == pytest.approx((0, 0))
    assert check.value(landed(check, made, 0, 0, 2, Fraction(22, 7))[0]).real() == pytest.approx(pi)
    for part, near in ((1, Fraction(22, 7)), (2, 0), (0, Fraction(22, 7))):
        with pytest.raises(check.Unproved, match="may not arrive from inside"):
            landed(check, made, 0, 0, part, near)


def test_no_particle_leaves_outwards_though_its_line_meets_a_wall_from_inside(check):
    """Through the disc itself: at an angle of 9/5 from the normal, which is between a right one and 2."""
    disc, walls = ("cos(theta)", "-sin(theta)", "-pi", "pi"), ("9*cos(theta)", "9*sin(theta)", "-pi", "pi")
    ux, uy = cos(1.8), -sin(1.8)
    t = sqrt(80 + ux * ux) - ux
    near = Fraction(atan2(t * uy, 1 + t * ux))
    with pytest.raises(check.Unproved, match="may not arrive from inside"):
        landed(check, table(check, disc, walls), 0, "9/5", 1, near)


def test_a_table_may_be_small(check):
    there, psi = landed(check, table(check, ("1/100", "-pi", "pi")), 0, 0, 0, Fraction(22, 7))
    assert (check.value(there).real(), check.value(psi).real()) == pytest.approx((pi, 0))


@pytest.mark.parametrize("psi", ["31/5", "-31/5", "25/4", "-25/4", "3", "-3", "22/7", "41/20", "-41/20"])
def test_an_angle_beyond_a_right_one_is_none_though_a_line_has_it(check, psi):
    """In the circle the line itself meets the boundary again at `theta + pi - 2*psi`."""
    x = float(Fraction(psi))
    with pytest.raises(check.Unproved, match="may not arrive from inside"):
        landed(check, table(check, CIRCLE), "1/3", psi, 0, Fraction(1 / 3 + pi - 2 * x))


def test_an_orbit_goes_along_its_way_and_is_seen_at_last(check):
    """Of flights that are made up: each is told from where it starts and to which place it goes."""
    made, told = table(check, CIRCLE), []
    one, boxes = number(check, 1), [number(check, k).wide(number(check, "1/4")) for k in (1, 2, 3)]
    way = [(5, "start"), (6, "next"), (7, "last")]

    def flight(part, place, state, names):
        told.append((part, place, names, state[0].degree))
        return [state[0] * 2, state[1] + one]

    made.flight = flight
    launch = lambda x, y, lam: (x, y, {"lam": lam})  # noqa: E731
    for view in (None, lambda x, y, lam: [x * 100, y * 0 + lam]):
        told.clear()
        states = made.orbit(launch, boxes, way, 2, view=view)
        assert [(part, place) for part, place, *_ in told] == [(5, way[1]), (6, way[2])] * 2
        assert [degree for *_, degree in told] == [1, 1, 2, 2]  # from the middle first, of one degree less
        assert all(check.value(names["lam"]).mid().real() == 3 for *_, names, _ in told)
        values = [[check.value(x) for x in state] for state in states]
        wanted = [[(1, 0.25), (2, 0.25)], [(2, 0.5), (3, 0.25)], [(4, 1), (4, 0.25)]]
        wanted += [[(400, 100), (3, 0.25)]] if view else []
        assert [[(x.mid().real(), x.width() / 2 / 2**P) for x in state] for state in values] == wanted
        assert [x.degree for x in states[-1]] == [2, 2]


def test_an_orbit_over_a_box_is_tightened_by_its_middle_and_the_slopes(check):
    """Of `x*x - x` about 1/2, where the slope is 0: by the box itself its range is four times as wide."""
    made = table(check, CIRCLE)
    made.flight = lambda part, place, state, names: [state[0] * state[0] - state[0], state[1]]
    boxes = [number(check, "1/2").wide(number(check, "1/8")), number(check, 0), number(check, 0)]
    launch = lambda x, y, lam: (x, y, {})  # noqa: E731
    for degree in (1, 2):
        x = check.value(made.orbit(launch, boxes, [(0, None)] * 2, degree)[-1][0])
        assert Fraction(x.lo, 2**P) == -Fraction(1, 4) - Fraction(1, 32)  # the slopes are in [-1/4, 1/4]
        assert Fraction(x.hi, 2**P) == -Fraction(1, 4) + Fraction(1, 32)


class EnoughError(Exception):
    """A chord was looked at so often that it is taken to be none that is seen to be free."""


class Counted:
    """A table that counts how often a piece of its boundary is looked at; from `most` on nothing is seen."""

    def __init__(self, made):
        self.made, self.count, self.at = made, 0, made.at
        made.at = self.counted

    def counted(self, *given):
        self.count += 1
        if self.count > self.most:
            raise EnoughError
        return self.at(*given)

    def free(self, check, start, end, most=62):
        """Pieces that are looked at until a chord is seen to be free; None where it is not seen of so many."""
        self.count, self.most = 0, most
        places = [[(part, check.I.of(Fraction(x), P)) for part, x in bounce] for bounce in (start, end)]
        try:
            self.made.free(*places, self.made.letters)
        except EnoughError:
            return None
        return self.count


FLOWER = "1 + cos(6*theta)*9/20", "-pi", "pi"
BOX = [("theta", "0"), ("1", "theta"), ("1 - theta", "1"), ("0", "1 - theta")]
PIECES = [(x, y, "0", "1") for x, y in BOX]


@pytest.mark.parametrize(
    ("parts", "start", "end", "most"),
    [
        ([CIRCLE], [(0, "1/3")], [(0, "2")], 36),
        ([CIRCLE], [(0, "0")], [(0, "22/7")], 50),
        ([OVAL], [(0, "-1")], [(0, "1")], 36),
        ([FLOWER], [(0, "0")], [(0, "22/7")], 90),
        (PIECES, [(0, "1/3")], [(2, "1/4")], 11),
        (PIECES, [(0, "1/3")], [(1, "1/4")], 11),
        (PIECES, [(3, "1/3")], [(1, "1/4")], 11),
        (PIECES, [(0, "1"), (1, "0")], [(2, "1"), (3, "0")], 15),  # from corner to corner
    ],
)
def test_a_free_chord_is_seen_to_be_free_soon_and_in_both_directions(check, parts, start, end, most):
    made = Counted(table(check, *parts))
    for a, b in ((start, end), (end, start)):
        assert made.free(check, a, b, most)


@pytest.mark.parametrize("turns", [-20, -7, -1, 0, 1, 2, 13, 40])
def test_a_bounce_on_a_closed_curve_may_be_told_by_any_of_its_parameters(check, turns):
    made, x = Counted(table(check, CIRCLE)), Fraction(turns * 2 * pi + 1 / 3)
    for end in ("2", "-3", "1/2"):
        assert made.free(check, [(0, x)], [(0, end)])
        assert made.free(check, [(0, end)], [(0, x)])


WALLS = [
    (("1/2", "1/4", "1/2", "3/4"), False), (("1/4", "1/4", "3/4", "3/4"), False), (("1/2", "1/8", "1/2", "3/8"), True),
    (("1/2", "5/8", "1/2", "7/8"), True), (("0", "2", "1", "3"), True), (("3/2", "1/4", "3/2", "3/4"), True),
    (("-1/2", "1/4", "-1/2", "3/4"), True), (("5/4", "1/2", "7/4", "1/2"), True),
    (("-3/4", "1/2", "-1/4", "1/2"), True),
    (("1/4", "1/2", "3/4", "1/2"), False), (("1/2", "1/2", "1/2", "3/4"), False), (("9/8", "1/2", "1", "1"), True),
]  # fmt: skip


@pytest.mark.parametrize("turned", range(4))
@pytest.mark.parametrize(("wall", "free"), WALLS)
def test_a_wall_is_in_the_way_where_it_meets_the_chord_between_its_ends(check, wall, free, turned):
    """Of the chord `y = 1/2` from side to side of the square, turned by quarters about its middle."""
    a, b, c, d = map(Fraction, wall)
    for _ in range(turned):
        a, b, c, d = 1 - b, a, 1 - d, c
    made = Counted(
        table(check, *PIECES, (f"{a} + ({c - a})*(theta + 2)/3", f"{b} + ({d - b})*(theta + 2)/3", "-2", "1"))
    )
    start, end = [((3, "1/2"), (1, "1/2")), ((0, "1/2"), (2, "1/2"))][turned % 2]
    for chord in ((start, end), (end, start)):
        assert bool(made.free(check, *([place] for place in chord), 14)) is free


@pytest.mark.parametrize("sign", ["", "-"])
@pytest.mark.parametrize(
    ("wall", "free"),
    [
        (("theta/4", "theta*(1/2 - theta)/8", "-1/2", "1"), False),  # back at 1/2, and slow
        (("theta/4", "theta*(7 - theta)/40", "-1", "3"), True),
        (("theta/40", "theta*(7 - theta)/40", "-1", "9"), False),  # back at 7, which is more than a turn of a circle
        (("theta/40", "theta*(7 - theta)/40*(theta**2 - 4*theta + 9)/(theta**2 - 4*theta + 9)", "-1", "9"), False),
        (("theta/4", "theta*(7 - theta)/40*(theta**2 - 2*theta + 9/8)/(theta**2 - 2*theta + 9/8)", "-1", "2"), True),
    ],
)
def test_a_wall_that_comes_back_to_the_chord_that_it_sends_is_in_the_way(check, wall, free, sign):
    """The chord is the axis from 0 to 1; of a quotient a wide piece has no value, and then it is halved."""
    x, y, *ends = wall
    made = Counted(table(check, (x, f"{sign}({y})", *ends), ("1", "theta", "-1/2", "1/2")))
    for chord in (((0, "0"), (1, "0")), ((1, "0"), (0, "0"))):
        assert bool(made.free(check, *([place] for place in chord))) is free


def test_where_a_chord_is_free_the_boundary_is_asked_once_about_the_middle_of_it(check):
    made, asked = table(check, CIRCLE), []
    made.turns = [lambda *given: asked.append(given)]
    for end in (2, 1):
        made.free([(0, number(check, "1/3"))], [(0, number(check, end))], {"b": 7})
    ((given, x, y, names),) = asked
    assert (given, names) == (made, {"b": 7})
    wanted = (cos(1 / 3) + cos(2)) / 2, (sin(1 / 3) + sin(2)) / 2
    assert (x.real(), y.real()) == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize("off", ["0", "1/10000000000"])
def test_a_chord_that_touches_the_boundary_on_its_way_is_not_free_and_one_that_passes_by_is(check, off):
    """A parabola whose vertex is on the chord `y = 1/2`, or below."""
    bump = "1/2 - (theta - 1/2)**2"
    made = Counted(table(check, *PIECES, ("theta", f"{bump} - {off}", "0", "1")))
    assert bool(made.free(check, [(3, "1/2")], [(1, "1/2")], 300)) is (off != "0")
