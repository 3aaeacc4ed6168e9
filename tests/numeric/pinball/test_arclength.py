"""Arc length of a boundary, its inverse, its ends and its offsets."""

from functools import cache

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from sympy import Rational, cos, exp, pi, sin, sqrt

from numeric import PinballMap
from symbolic import tables
from symbolic.tables.table import theta

EPS = 2.0**-52
MP = mpmath.MPContext()
MP.dps = 40


@cache
def rooted():
    """A curve without symmetry whose formula is no finite Fourier sum."""
    return tables.polar(sqrt(1 + cos(theta) / 3 + sin(2 * theta) / 5), name="rooted")


@cache
def skewed():
    return tables.parametric(cos(theta) + sin(2 * theta) / 9, sin(theta) + cos(3 * theta) / 20, name="skewed")


@cache
def lens():
    """A lens of two arcs of ellipses; neither parameter range begins at 0, and one does not contain 0."""
    return tables.piecewise(
        tables.arc("lower", 2 * cos(theta), sin(theta) / 3, pi, 2 * pi),
        tables.arc("upper", 2 * cos(theta), sin(theta), 0, pi),
        name="lens",
    )


def length(map, component, low, high):
    """The arc length, by quadrature of the speed."""

    def speed(at):
        return float(map.states.speed(np.array(component), np.array(at)))

    return quad(speed, low, high, epsabs=4e-14, epsrel=1e-13)[0]


MAPS = {table.__name__: lambda table=table: PinballMap(table()) for table in (rooted, skewed, lens, tables.stadium)}
MAPS |= {name: lambda name=name: PinballMap(name) for name in ("circle", "cardioid", "cuspless")}
MAPS |= {f"ellipse {a}": lambda a=a: PinballMap("ellipse", a=a) for a in ("3/2", "10", "1000")}
MAPS |= {f"egg {alpha}": lambda alpha=alpha: PinballMap("egg", alpha=alpha) for alpha in ("0.02", "0.1")}


@pytest.mark.parametrize("name", MAPS)
def test_arc_length_is_the_integral_of_the_speed_and_the_parameter_comes_back_from_it(name):
    map = MAPS[name]()
    arc = map.arclength
    for component, (low, high) in enumerate(map.states.ends):
        at = np.linspace(low, high, 8)
        s = arc.s(at, component)
        for a, b, s0, s1 in zip(at[:-1], at[1:], s[:-1], s[1:], strict=True):
            assert abs((s1 - s0) - length(map, component, a, b)) <= 16 * EPS * max(1, abs(s0), abs(s1))
        at = np.linspace(low, high, 303)[1:-1].reshape(7, 43)
        s = arc.s(at, component)
        back, speed = arc.theta(s, component), map.states.speed(np.full(at.shape, component), at)

        assert back.shape == at.shape
        assert np.all(np.abs(back - at) <= 16 * EPS * (np.abs(at) + np.maximum(np.abs(s), 1) / speed))
        assert np.all((back >= low) & (back <= high))


def test_the_inverse_keeps_its_digits_up_to_the_cusp():
    arc = PinballMap("cardioid").arclength
    s = (4 - 2.0 ** -np.arange(30.0)) * [[1], [-1]]
    truth = [[float(2 * MP.asin(MP.mpf(x) / 4)) for x in row] for row in s.tolist()]

    assert np.max(np.abs(arc.theta(s) - truth)) <= 4 * EPS


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
    arc = PinballMap(tables.piecewise(*tables.stadium().components, origin=(index, Rational(str(at))))).arclength
    usual = PinballMap(tables.stadium()).arclength

    assert float(arc.s(at, index)) == pytest.approx(0, abs=1e-15)
    for component in range(4):  # counterclockwise from there: the components before it come last
        low, _ = arc.states.ends[component]
        turn = 4 + 2 * np.pi if component < before else 0
        start = float(usual.s(low, component) - usual.s(at, index))
        assert float(arc.s(low, component)) == pytest.approx(start + turn, abs=1e-14)


@pytest.mark.slow
def test_a_narrow_spike_has_its_length():
    """A spike 1/1000 wide and 1/4 high on a circle, against mpmath's quadrature between points around the spike."""
    context = mpmath.MPContext()
    context.dps = 25
    narrow = tables.polar(1 + exp(-(10**6) * (1 - cos(theta))) / 4, name="spike")
    length = PinballMap(narrow, kernels=False).arclength

    def speed(at):
        top = context.exp(-2 * 10**6 * context.sin(at / 2) ** 2) / 4
        return context.hypot(1 + top, 10**6 * context.sin(at) * top)

    about = [context.mpf(k) / 2500 for k in range(16)]
    assert float(length.s(np.array(1.0))) == pytest.approx(float(context.quad(speed, [*about, 1])), rel=1e-12)
    assert length.perimeter == pytest.approx(2 * float(context.quad(speed, [*about, context.pi])), rel=1e-12)
    s = np.linspace(-3, 3, 50)
    assert np.max(np.abs(length.s(length.theta(s)) - s)) < 1e-12
