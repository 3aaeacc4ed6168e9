"""Tables that are very small, very large or far away have the orbits of the same table at its ordinary place.

A copy scaled by 2**k has the same numbers up to powers of two, and so the same bits; likewise a copy moved by a whole
number. Copies with other scales and turned copies agree within the rounding of their own coordinates.
"""

import subprocess
import sys

import mpmath
import numpy as np
import pytest
from sympy import Rational, cos, pi, sin

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import theta

CORNERS = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
BOUNCES = 12


def polygon(corners):
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    arcs = [
        tables.arc(f"side{i}", a[0] + theta * (b[0] - a[0]), a[1] + theta * (b[1] - a[1]), 0, 1)
        for i, (a, b) in enumerate(sides)
    ]
    return tables.piecewise(*arcs, name="L shape")


def lens(k, x, y, name="lens"):
    return tables.piecewise(
        tables.arc("lower", x + k * theta, y + k * (theta**2 - 1) / 2, -1, 1),
        tables.arc("upper", x - k * theta, y + k * (1 - theta**2) / 2, -1, 1),
        name=name,
    )


def parametric(u, v, name):
    return lambda k, x, y: tables.parametric(x + k * u, y + k * v, name=name)


COPIES = {
    "ellipse": parametric(2 * cos(theta) + sin(theta) / 3, sin(theta), "ellipse"),
    "egg": parametric(cos(theta) + cos(2 * theta) / 12, sin(theta) + sin(2 * theta) / 12, "egg"),
    "flower": lambda k, x, y: tables.polar(k * (1 + cos(3 * theta) / 5), name="flower") if x == y == 0 else None,
    "L shape": lambda k, x, y: polygon([(x + k * a, y + k * b) for a, b in CORNERS]),
    "stadium": lambda k, x, y: tables.piecewise(
        tables.arc("right", x + k * (1 + cos(theta)), y + k * sin(theta), -pi / 2, pi / 2),
        tables.arc("top", x - k * theta, y + k, -1, 1),
        tables.arc("left", x + k * (-1 - cos(theta)), y - k * sin(theta), -pi / 2, pi / 2),
        tables.arc("bottom", x + k * theta, y - k, -1, 1),
        name="stadium",
    ),
    "lens": lens,
}


def near(one, other, share):
    """Whether two arrays agree up to this share of their largest number."""
    return np.max(np.abs(one - other)) <= share * np.max(np.abs(one))


def answers(table):
    map = PinballMap(table, lam=Rational(3, 5))
    count = len(map.states.ends)
    where = np.arange(6) % count
    low, high = np.array(map.states.ends)[where].T
    at, phi = low + (high - low) * np.linspace(0.2, 0.7, 6), np.linspace(-1.1, 1.0, 6)
    orbit = map.orbit(at, phi, BOUNCES, where)
    growth = map.exponents(at, phi, BOUNCES, component=where)
    s = map.arclength.s(orbit.theta, orbit.component)
    back = map.locate(orbit.x[-1], orbit.y[-1])
    return map, orbit, growth, s, map.derivative(at, phi, where), back


@pytest.fixture(scope="module", params=COPIES)
def copy(request):
    return COPIES[request.param], answers(COPIES[request.param](1, 0, 0))


@pytest.mark.slow
@pytest.mark.parametrize("power", [-60])
def test_a_copy_that_is_a_power_of_two_as_large_has_the_same_bits(copy, power):
    made, (_, orbit, growth, s, derivative, _) = copy
    k, size = Rational(2) ** power, 2.0**power
    _, other, more, length, slope, (component, at) = answers(made(k, 0, 0))

    for name in ("component", "theta", "phi", "eta", "code"):
        assert np.array_equal(getattr(orbit, name), getattr(other, name), equal_nan=True), name
    assert np.array_equal(orbit.x * size, other.x)
    assert np.array_equal(orbit.y * size, other.y)
    assert near(s, length / size, 1e-13)
    assert np.max(np.abs(more.nu_minus + more.nu_plus - growth.nu_plus - growth.nu_minus)) < 1e-12
    assert near(derivative, slope * [[1, 1 / size], [size, 1]], 1e-12)
    assert np.array_equal(component, other.component[-1])
    assert np.max(np.abs(np.cos(at) - np.cos(other.theta[-1]))) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("away", [(10**6, -(10**6)), (10**9, 10**9)])
def test_a_copy_that_is_moved_has_the_same_orbits(copy, away):
    made, (_, orbit, growth, s, derivative, _) = copy
    if made(1, *away) is None:
        return  # a radius is about the origin
    map, other, more, length, slope, (component, _) = answers(made(1, *away))
    spacing = np.spacing(float(max(map.unit.x, map.unit.y)))

    assert np.array_equal(orbit.component, other.component)
    assert np.max(np.abs(orbit.theta - other.theta)) < 1e-11
    assert np.max(np.abs(orbit.phi - other.phi)) < 1e-11
    assert np.max(np.hypot(other.x - away[0] - orbit.x, other.y - away[1] - orbit.y)) <= 2 * spacing
    assert np.max(np.abs(length - s)) < 1e-11
    assert np.max(np.abs(more.nu_plus - growth.nu_plus)) < 1e-10
    assert near(derivative, slope, 1e-10)
    assert np.array_equal(component, other.component[-1])


@pytest.mark.slow
@pytest.mark.parametrize("k", [Rational(1, 10**10), 10**30])
def test_a_bounce_does_not_depend_on_the_unit_of_length(copy, k):
    made, _ = copy
    one, other = (PinballMap(made(size, 0, 0), lam=Rational(1, 2)) for size in (1, k))
    low, high = one.states.ends[0]
    at, phi = low + (high - low) * np.linspace(0.1, 0.9, 20), np.linspace(-1.3, 1.3, 20)
    here, there = one.step(at, phi), other.step(at, phi)

    assert np.array_equal(here.component, there.component)
    assert np.array_equal(here.code, there.code)
    assert np.max(np.abs(here.theta - there.theta) * np.cos(here.eta)) < 1e-13
    assert np.max(np.abs(here.eta - there.eta) * np.cos(here.eta)) < 1e-13


def test_a_law_that_speaks_of_arc_length_hears_that_of_the_table():
    """On a circle of radius `R` the law `-eta/2 + s/(10*R)` acts as with `R = 1` on the unit circle."""
    maps = []
    for R in (1, 2**40):
        circle = tables.parametric(R * cos(theta), R * sin(theta), name="round")
        maps.append(PinballMap(circle, lam=Rational(1, 2), law=f"-eta/2 + sin(s/{R})/10"))
    (one, other), (slope, more) = zip(*((m.orbit(0.4, 0.3, 8), m.derivative(0.4, 0.3)) for m in maps), strict=True)

    assert np.max(np.abs(one.phi - other.phi)) < 1e-13
    assert np.max(np.abs(slope - more * [[1, 2.0**-40], [2.0**40, 1]])) < 1e-12


@pytest.mark.parametrize(
    ("a", "words"),
    [("1e160", "ellipse: a box of 2e+160 by 2 is too flat for float64"), ("1e310", "points do not fit float64")],
)
def test_what_does_not_fit_a_float_is_one_sentence(a, words):
    said = subprocess.run(
        [sys.executable, "-m", "verification", "orbit", "ellipse", "--a", a, "--lam", "1/2", "--start", "0.3,0.2"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert said.returncode == 2
    assert words in said.stderr
    assert said.stderr.count("\n") == 1
    assert not said.stdout


@pytest.mark.parametrize("a", [10**20, 10**40, 10**59])
def test_an_ellipse_as_flat_as_a_line_is_a_table(a):
    """Divided by `a`, its points are those of the unit circle, where a chord's ends are mirror images."""
    start, phi = np.array([0.3, 2.0, -1.2]), np.array([0.2, -1.0, 0.7])
    landed = PinballMap(tables.parametric(a * cos(theta), sin(theta), name="flat"), lam=1).step(start, phi)
    for i, (at, angle) in enumerate(zip(start, phi, strict=True)):
        x, y, c, s = (f(mpmath.mpf(each)) for each in (at, angle) for f in (mpmath.cos, mpmath.sin))
        w = -(a * s * y + c * x) / a, s * x - c * a * y  # the direction, up to a length
        along = 2 * (x * w[0] + y * w[1]) / (w[0] ** 2 + w[1] ** 2)
        end = mpmath.atan2(y - along * w[1], x - along * w[0])
        assert landed.code[i] == 0
        assert float(end) == pytest.approx(landed.theta[i], abs=1e-14)


@pytest.mark.parametrize("k", [Rational(1, 10**80), 10**60])
def test_a_star_of_any_size(k):
    star = [tables.polar(size * (1 + cos(5 * theta) / 5), name="star") for size in (1, k)]
    one, other = (PinballMap(table, lam=1).step(np.linspace(-3, 3, 40), np.linspace(-1.4, 1.4, 40)) for table in star)

    assert np.array_equal(one.code, other.code)
    assert np.max(np.abs(one.theta - other.theta) * np.cos(one.eta)) < 1e-13


@pytest.mark.parametrize("gap", [Rational(1, 10), Rational(1, 10**7), Rational(1, 10**12)])
def test_the_near_tip_of_a_long_ellipse_keeps_its_digits(gap):
    """The radius `1/(1 + e*cos(theta))` from the focus, in mpmath at the angle of the landing itself."""
    context = mpmath.MPContext()
    context.dps = 40
    e = 1 - context.mpf(gap.p) / gap.q
    long = PinballMap(tables.polar(1 / (1 + (1 - gap) * cos(theta)), name="long"), lam=1)
    landed = long.orbit(np.linspace(-3, 3, 60), np.linspace(-1.3, 1.3, 60), 5)
    near = np.abs(landed.theta) < 1.5
    assert np.count_nonzero(near) > 20
    for at, x, y in zip(landed.theta[near], landed.x[near], landed.y[near], strict=True):
        r = 1 / (1 + e * context.cos(at))
        assert abs(r * context.cos(at) - x) < 4e-15
        assert abs(r * context.sin(at) - y) < 4e-15
