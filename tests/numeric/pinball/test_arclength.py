"""Arc length of tables that have no closed form, its ends and its offsets."""

import re
from functools import cache

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import jv
from sympy import Rational, cos, pi, sin, sqrt

from numeric import PinballMap
from numeric.pinball.coordinates import MOST, Waves, chebyshev
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
MP = mpmath.MPContext()
MP.dps = 40


@cache
def rooted():
    """No symmetry, no finite sum."""
    return tables.polar(sqrt(1 + cos(theta) / 3 + sin(2 * theta) / 5), name="rooted")


@cache
def skewed():
    return tables.parametric(cos(theta) + sin(2 * theta) / 9, sin(theta) + cos(3 * theta) / 20, name="skewed")


@cache
def stadium():
    return tables.piecewise(
        tables.arc("right", 1 + cos(theta), sin(theta), -pi / 2, pi / 2),
        tables.arc("top", -theta, 1, -1, 1),
        tables.arc("left", -1 - cos(theta), -sin(theta), -pi / 2, pi / 2),
        tables.arc("bottom", theta, -1, -1, 1),
        name="stadium",
    )


@cache
def lens():
    """Two bows of ellipses; neither parameter range begins at 0, and one does not hold it."""
    return tables.piecewise(
        tables.arc("lower", 2 * cos(theta), sin(theta) / 3, pi, 2 * pi),
        tables.arc("upper", 2 * cos(theta), sin(theta), 0, pi),
        name="lens",
    )


def length(map, component, low, high):
    """By quadrature of the speed."""

    def speed(at):
        return float(map.states.speed(np.array(component), np.array(at)))

    return quad(speed, low, high, epsabs=4e-14, epsrel=1e-13)[0]


@pytest.mark.parametrize("table", [rooted, skewed, lens], ids=lambda table: table.__name__)
def test_arc_length_is_the_integral_of_the_speed(table):
    arc = PinballMap(table()).arclength
    map = PinballMap(table())
    for component, (low, high) in enumerate(map.states.ends):
        at = np.linspace(low, high, 8)
        s = arc.s(at, component)
        for a, b, s0, s1 in zip(at[:-1], at[1:], s[:-1], s[1:], strict=True):
            assert abs((s1 - s0) - length(map, component, a, b)) <= 16 * EPS * max(1, abs(s0), abs(s1))


@pytest.mark.parametrize("table", [rooted, skewed, lens, stadium], ids=lambda table: table.__name__)
def test_the_parameter_comes_back_from_its_arc_length(table):
    map = PinballMap(table())
    for component, (low, high) in enumerate(map.states.ends):
        at = np.linspace(low, high, 301).reshape(7, 43)
        back = map.arclength.theta(map.arclength.s(at, component), component)

        assert back.shape == at.shape
        assert np.max(np.abs(back - at)) <= 64 * EPS * max(1, abs(low), abs(high))
        assert np.all((back >= low) & (back <= high))


@pytest.mark.parametrize(
    ("name", "shape", "perimeter"),
    [
        ("circle", {}, 2 * np.pi),
        ("cardioid", {}, 8.0),
        ("ellipse", {"a": 1}, 2 * np.pi),
        ("egg", {"alpha": 0}, 2 * np.pi),
    ],
)
def test_perimeters_that_are_known(name, shape, perimeter):
    assert PinballMap(name, **shape).arclength.perimeter == pytest.approx(perimeter, abs=4e-15)


def test_the_stadium_is_two_half_circles_and_two_straights():
    arc = PinballMap(stadium()).arclength
    start = arc.s(np.array([-np.pi / 2, -1.0, -np.pi / 2, -1.0]), np.arange(4))
    end = arc.s(np.array([np.pi / 2, 1.0, np.pi / 2, 1.0]), np.arange(4))

    assert np.allclose(end - start, [np.pi, 2, np.pi, 2], rtol=0, atol=2e-15)
    assert np.allclose(start[1:], end[:-1], rtol=0, atol=2e-15)
    assert arc.perimeter == pytest.approx(4 + 2 * np.pi, abs=4e-15)
    assert arc.s(0.3, 0) - arc.s(0.0, 0) == pytest.approx(0.3, abs=1e-15)


@pytest.mark.parametrize(("table", "at"), [(stadium, 0.0), (lens, np.pi), (rooted, 0.0)])
def test_arc_length_is_zero_at_the_origin_or_where_its_component_begins_beyond_it(table, at):
    assert table().origin == (0, 0)
    assert float(PinballMap(table()).arclength.s(at, 0)) == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("name", ["circle", "cuspless", "ellipse", "cardioid"])
def test_the_ends_of_a_component_are_on_it_and_what_is_beyond_is_not(name):
    map = PinballMap(name, **({"a": 2} if name == "ellipse" else {}))
    arc = map.arclength
    for component, (low, high) in enumerate(map.states.ends):
        first, last = (float(arc.s(end, component)) for end in (low, high))
        slack = 1e-14 * (last - first)

        assert np.allclose(arc.theta([first, last], component), [low, high], rtol=0, atol=1e-7)
        assert np.all(
            np.abs(arc.theta([first - 0.9 * slack, last + 0.9 * slack], component)) <= max(-low, high) + 1e-13
        )
        lies = re.escape(f"there s lies in [{first:.17g}, {last:.17g}]")
        for s in (first - 1.2 * slack, last + 1.2 * slack):
            with pytest.raises(ValueError, match=rf"s = {f'{s:.6f}'[:-1]}\d* is not on the .*; {lies}"):
                arc.theta([first, last, s], component)


def test_the_place_that_is_refused_is_named_in_the_tables_arc_length():
    with pytest.raises(ValueError, match=r"s = 7\.5 is not on the wall"):
        PinballMap("cuspless").arclength.theta([7.5], 1)


def test_shapes_of_arguments_are_kept():
    arc = PinballMap("egg", alpha="0.08").arclength

    assert (arc.s(0.3).shape, arc.theta(0.3).shape) == ((), ())
    assert arc.s(np.zeros((2, 3)), np.zeros((2, 1), dtype=int)).shape == (2, 3)
    assert arc.theta(np.empty((0,))).shape == (0,)
    assert (float(arc.s(0.3)), float(arc.theta(0.3))) == (float(arc.s(0.3, 0)), float(arc.theta(0.3, 0)))


def test_an_ellipse_by_another_name_has_the_same_arc_length():
    other = tables.parametric(3 * cos(theta) / 2, sin(theta), name="other")
    at = np.linspace(-3, 3, 25)
    one, two = (map.arclength.s(at) for map in (PinballMap("ellipse", a=Rational(3, 2)), PinballMap(other)))

    assert np.allclose(one, two, rtol=0, atol=8 * EPS)


def counted(speed):
    """A speed that remembers how many samples it was asked for."""
    asked = []

    def sampled(at):
        asked.append(at.size)
        return speed(at)

    return sampled, asked


def test_the_waves_of_a_finite_sum_are_its_own_and_no_others():
    speed, asked = counted(lambda at: 2 + np.cos(3 * at) / 10 - np.sin(5 * at) / 7 + np.cos(20 * at) / 30)
    waves = Waves.of(speed)

    assert asked == [64]
    assert waves.mean == pytest.approx(2, abs=EPS)
    assert waves.frequencies.tolist() == [3, 5, 20]
    assert np.allclose(waves.sines, [1 / 30, 0, 1 / 600], rtol=0, atol=EPS)
    assert np.allclose(waves.rises, [0, -1 / 35, 0], rtol=0, atol=EPS)
    assert np.all(waves(np.zeros((2, 1))) == 0)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.5, 0.8, 0.9, 0.97])
def test_a_series_of_waves_is_as_long_as_it_must_be(share):
    """The coefficients of Poisson's kernel are powers of `share`, and the first that is rounding decides."""
    speed, asked = counted(lambda at: (1 - share**2) / (1 - 2 * share * np.cos(at) + share**2))
    waves = Waves.of(speed)
    largest = (1 + share) / (1 - share)
    enough = next(64 << i for i in range(20) if share ** ((64 << i) // 3) < 4e-16 * largest)
    first, last = (int(np.log(rounding * largest) / np.log(share)) for rounding in (5e-16, 3e-16))
    k, noise = waves.frequencies, 64 * EPS / (1 - share) ** 2  # of the kernel, where the cosine is rounded

    assert asked == [64 << i for i in range(len(asked))]
    assert asked[-1] == enough
    assert np.array_equal(k, np.arange(1, k.size + 1))
    assert first <= k.size <= last
    assert np.max(np.abs(waves.sines * k - 2 * share**k)) <= noise
    assert np.max(np.abs(waves.rises * k)) <= noise


def test_what_is_not_smooth_is_sampled_no_finer_than_is_said():
    for speed, asked in (counted(lambda at: 2 + np.abs(np.sin(at))), counted(lambda at: 2 + np.abs(at - 0.1))):
        Waves.of(speed)
        assert asked == [64 << i for i in range(9)]
    assert MOST == 64 << 8

    speed, asked = counted(lambda at: 2 + np.abs(at - 0.1))
    chebyshev(speed, -1.0, 1.0)
    assert asked == [17, 33, 65, 129, 257, 513, 1025]


@pytest.mark.parametrize("rate", [0.25, 0.8, 2, 5, 12, 20])
@pytest.mark.parametrize(
    ("low", "high", "zero"),
    [(-0.9, 2.1, 0.0), (0.0, 1.5, 0.0), (-2.0, 0.0, 0.0), (0.5, 2.0, 0.5), (-3.0, -2.5, -3.0), (-2.0, -0.5, -2.0)],
)
def test_a_chebyshev_series_is_as_long_as_it_must_be(rate, low, high, zero):
    """The coefficients of `cos(rate*theta)` are Bessel functions of half its phase (Jacobi and Anger)."""
    speed, asked = counted(lambda at: 2 + np.cos(rate * at))
    length = chebyshev(speed, low, high)
    at, half = np.linspace(low, high, 50), rate * (high - low) / 2
    middle = rate * (high + low) / 2 - np.arange(1100) * np.pi / 2
    size = 2 * np.abs(jv(np.arange(1100), half) * np.cos(middle))
    largest = 2 + np.max(np.cos(rate * at))
    enough = next(16 << i for i in range(9) if np.max(size[2 * (16 << i) // 3 : 16 << i]) < 4e-16 * largest)
    truth = 2 * (at - zero) + (np.sin(rate * at) - np.sin(rate * zero)) / rate

    assert np.max(np.abs(length(at) - truth)) <= 8 * EPS * max(1, abs(zero))
    assert asked == [(16 << i) + 1 for i in range(len(asked))]
    assert asked[-1] == enough + 1


def test_the_inverse_keeps_its_digits_up_to_the_cusp():
    arc = PinballMap("cardioid").arclength
    s = (4 - 2.0 ** -np.arange(30.0)) * [[1], [-1]]
    truth = [[float(2 * MP.asin(MP.mpf(x) / 4)) for x in row] for row in s.tolist()]

    assert np.max(np.abs(arc.theta(s) - truth)) <= 4 * EPS


def test_the_inverse_takes_two_steps_from_its_grid(monkeypatch):
    for map in (PinballMap(table()) for table in (rooted, skewed, lens)):
        arc, asked = map.arclength, []
        speed = type(map.states).speed
        monkeypatch.setattr(type(map.states), "speed", lambda *at, ask=speed, said=asked: said.append(0) or ask(*at))
        for component, (low, high) in enumerate(map.states.ends):
            arc.theta(arc.s(np.linspace(low, high, 500), component), component)
        monkeypatch.undo()

        assert len(asked) == 2 * len(map.states.ends)


def test_closed_curves_have_waves_and_arcs_have_polynomials():
    def has_waves(length):
        return isinstance(getattr(length, "__self__", None), Waves)

    assert has_waves(PinballMap("egg", alpha="0.08").arclength.lengths[0])
    assert all(has_waves(PinballMap(table()).arclength.lengths[0]) for table in (rooted, skewed))
    assert not any(has_waves(length) for length in PinballMap(stadium()).arclength.lengths)


@pytest.mark.parametrize("rate", [pi, pi / 3, Rational(1, 2)])
def test_a_closed_curve_has_its_length_whatever_its_parameter_runs_through(rate):
    once = tables.arc("once", 2 * cos(rate * theta), sin(rate * theta), -pi / rate, pi / rate)
    arc, truth = PinballMap(tables.piecewise(once)).arclength, PinballMap("ellipse", a=2).arclength
    at = np.linspace(-3, 3, 40)

    assert arc.perimeter == pytest.approx(truth.perimeter, abs=8e-15)
    assert np.allclose(arc.s(at / float(rate)), truth.s(at), rtol=0, atol=1e-14)


@pytest.mark.parametrize(("origin", "before"), [((0, 1.25), 0), ((1, 0.5), 1), ((3, -0.25), 3)])
def test_arc_length_begins_where_a_table_says(origin, before):
    index, at = origin
    arc = PinballMap(tables.piecewise(*stadium().components, origin=(index, Rational(str(at))))).arclength
    usual = PinballMap(stadium()).arclength

    assert float(arc.s(at, index)) == pytest.approx(0, abs=1e-15)
    for component in range(4):  # counterclockwise from there: the components before it come last
        low, _ = arc.states.ends[component]
        turn = 4 + 2 * np.pi if component < before else 0
        start = float(usual.s(low, component) - usual.s(at, index))
        assert float(arc.s(low, component)) == pytest.approx(start + turn, abs=1e-14)


def test_the_first_place_that_is_on_no_component_is_named():
    with pytest.raises(ValueError, match=r"s = 7\.5 is not on the wall"):
        PinballMap("cuspless").arclength.theta([0.0, 7.5, -8.5], 1)


def test_on_the_unit_circle_and_along_the_wall_arc_length_is_the_parameter():
    at = np.linspace(-0.4, 0.4, 9)

    assert np.array_equal(PinballMap("circle").arclength.s(at), at)
    assert np.array_equal(PinballMap("cuspless").arclength.s(at, 1), at)
