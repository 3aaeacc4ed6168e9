"""Flights of the independent checker against closed forms in mpmath, and refused landings."""

from fractions import Fraction
from math import atan2, cos, pi, sin

import mpmath
import pytest
from by_hand import number
from scipy.optimize import brentq

P = 100


def same(check, x, true, units=2**24):
    """True if a float, with its error, lies in an interval of at most so many units in the last place."""
    x = check.I.of(check.value(x), P)
    return abs(x.real() - true) < 1e-13 * (1 + abs(true)) and x.width() <= units


def table(check, *parts, law=None, **letters):
    return check.Table([list(part) for part in parts], {k: number(check, x) for k, x in letters.items()}, law, P)


OVAL = "2*cos(theta)", "sin(theta)", "-pi", "pi"


def landing(theta, psi):
    """The landing in the oval and minus the incidence, by the quadratic equation of the ray, in mpmath."""
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
    """Derivatives by the start and the angle, against differences of mpmath; the letter of the law is 1/9."""
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
    """The landing of one particle near a place."""
    state = [check.Jet.of(number(check, x), 0) for x in (start, psi)]
    place = part, number(check, near).wide(number(check, Fraction(1, 100)))
    return made.flight(0, place, state, made.letters | {"lam": number(check, "1/3")})


def test_no_particle_lands_behind_its_start_or_arrives_from_outside(check):
    """From a disc to the right: on the wall ahead, not on the wall behind, nor on the far side of another disc."""
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


def test_a_chord_arrives_from_inside_or_the_landing_is_none(check):
    """In a peanut-shaped table the line `y = 1/2` leaves the right lobe, enters the left one, and leaves it."""
    height = lambda theta: sin(theta) * (1 + 0.6 * cos(2 * theta)) - 0.5  # noqa: E731
    outer, waist = brentq(height, 0, 0.7), brentq(height, 0.7, pi / 2)
    table, lam, _ = check.read_scene({"polar": "1 + 3/5*cos(2*theta)", "lam": "1/3"}, "", 100)
    _, _, dx, dy = (check.value(z).real() for z in table.at(0, check.I.of(Fraction(outer), 100), table.letters, 100))
    start = [check.Jet.of(check.I.of(Fraction(z), 100), 0) for z in (outer, atan2(-dx, dy))]

    def landed(at: float) -> float:
        near = check.I.of(Fraction(at), 100).wide(check.I.of(Fraction(1, 1000), 100))
        return check.value(table.flight(0, (0, near), start, table.letters | {"lam": lam})[0]).real()

    for out in (waist, pi - outer):
        assert landed(out) == pytest.approx(out, abs=1e-9)
    with pytest.raises(check.Unproved, match="may not arrive from inside"):
        landed(pi - waist)
