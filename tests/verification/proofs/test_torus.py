"""Torus bifurcations: the normal form against a textbook's; iterates, orbits and derivatives of the map."""

import cmath
from dataclasses import replace
from fractions import Fraction
from math import cos, pi

import mpmath
import numpy as np
import pytest
from flint import arb
from hypothesis import assume, given
from hypothesis import strategies as st
from sympy import Rational, Symbol

from numeric import PinballMap
from symbolic.tables import egg
from verification.arithmetic.balls import FLOAT64, balls, exact_balls, multiprecision, working
from verification.cycles.chords import chord_angles
from verification.cycles.newton import refined
from verification.cycles.recurrence import AFTER, BEFORE, HERE, MIRROR, Explicit, delayed
from verification.maps.exact import ExactMap
from verification.named.curves import invariant_circle
from verification.proofs.periodic.bifurcation import birkhoff_normal_form
from verification.proofs.periodic.interval_newton import ZeroStatus
from verification.proofs.periodic.torus import TRACE, Rotating, Rotation, torus

t, d, bend, cubic = (Symbol(name, real=True) for name in ("t", "d", "bend", "cubic"))
RULE = AFTER - t * HERE + d * BEFORE + bend * HERE * BEFORE + cubic * HERE**2 * BEFORE
PLANE = Explicit("plane", RULE, (t, d, bend, cubic), 1)  # areas grow by d + bend*HERE + cubic*HERE**2
traces = st.floats(-1.9, 1.9).filter(lambda x: min(abs(x + 1), abs(x)) > 0.05)
coefficients = st.floats(-3, 3)


def at_zero(trace, a, c, ring=PLANE):
    """The fixed point 0 of the plane map with this trace and determinant 1, repeated once or several times."""
    once = cmath.rect(1, cmath.acos(trace / 2).real)
    whole = ring.closure.turn * once**ring.period
    fixed = {"t": Rational(trace), "bend": Rational(a), "cubic": Rational(c)}
    return Rotation(Rotating(ring, ("d", "trace"), fixed), FLOAT64, [0.0] * ring.period + [1.0, 2 * whole.real]), whole


def by_the_textbook(trace, a, c):
    """`conj(mu)` times the cubic coefficient, by the multilinear formula of [Kuznetsov2004], section 5.4."""
    matrix = np.array([[trace, -1.0], [1.0, 0.0]])
    mu = cmath.rect(1, cmath.acos(trace / 2).real)
    q = np.array([1, 1 / mu])
    p = np.array([1, -1 / mu])  # a left vector: p @ matrix = mu * p
    assert np.allclose(matrix @ q, mu * q)
    assert np.allclose(p @ matrix, mu * p)
    p = p / (p @ q)

    def second(x, y):
        return np.array([-a * (x[0] * y[1] + x[1] * y[0]), 0])

    def third(x, y, z):
        return np.array([-2 * c * (x[0] * y[0] * z[1] + x[0] * y[1] * z[0] + x[1] * y[0] * z[0]), 0])

    one, bar = np.eye(2), q.conjugate()
    inner = third(q, q, bar) + 2 * second(q, np.linalg.solve(one - matrix, second(q, bar)))
    inner = inner + second(bar, np.linalg.solve(mu**2 * one - matrix, second(q, q)))
    return (p @ inner) / (2 * mu)


@given(traces, coefficients, coefficients)
def test_the_cubic_coefficient_is_that_of_the_textbook(trace, a, c):
    here, _ = at_zero(trace, a, c)

    assert abs(here.cubic() - by_the_textbook(trace, a, c)) < 1e-9 * (1 + a * a + abs(c))


@given(traces, coefficients, coefficients, st.integers(2, 5))
def test_a_cycle_run_through_several_times(trace, a, c, times):
    once, _ = at_zero(trace, a, c)
    ring = replace(PLANE, period=times)
    assume(all(abs(cmath.exp(1j * k * times * cmath.acos(trace / 2).real) - 1) > 0.05 for k in (1, 2, 3, 4)))
    several, whole = at_zero(trace, a, c, ring)
    assert max(map(abs, several.value)) < 1e-9  # it closes, and has that multiplier
    upper = whole.imag > 0  # of the two multipliers the one with positive imaginary part is followed

    def same(x):
        return x if upper else x.conjugate()

    assert abs(several.cubic() - times * same(once.cubic())) < 1e-7 * (1 + a * a + abs(c))
    assert abs(several.drift("d") - times * same(once.drift("d"))) < 1e-8


@given(traces, coefficients)
def test_half_of_a_symmetric_cycle_has_the_same_normal_form(trace, c):
    """The cubic map is odd; following it with `x -> -x` only changes the sign of the multiplier."""
    once, _ = at_zero(trace, 0.0, c)
    half, _ = at_zero(trace, 0.0, c, replace(PLANE, closure=MIRROR))

    assert abs(half.cubic() - once.cubic().conjugate()) < 1e-9 * (1 + abs(c))
    assert abs(half.drift("d") - once.drift("d").conjugate()) < 1e-9


def test_the_closed_curve_of_the_delayed_logistic_map():
    """At `r = 2 + h` the amplitude of `x` is `2*abs(z)`, with `abs(z)**2 = -growth*h/lyapunov`."""
    here = Rotation(Rotating(delayed(1), ("r", "trace")), FLOAT64, [0.5, 2.0, 1.0])
    drift, coefficient = here.drift("r"), here.cubic()
    h, x, y = 1e-3, 0.52, 0.5
    for _ in range(20_000):
        x, y = (2 + h) * x * (1 - y), x
    tail = []
    for _ in range(60_000):
        x, y = (2 + h) * x * (1 - y), x
        tail.append(x)
    away = np.array(tail) - np.mean(tail)
    angles = np.unwrap(np.angle(away[1:] - np.exp(-1j * pi / 3) * away[:-1]))  # the part along the first vector
    square = -drift.real * h / coefficient.real

    assert coefficient == pytest.approx(-2 - 2j * 3**0.5, abs=1e-12)
    assert drift.real == pytest.approx(0.5, abs=1e-12)  # the determinant at the fixed point is r - 1
    assert np.mean(away**2) == pytest.approx(2 * square, rel=0.02)
    turned = (angles[-1] - angles[0]) / (len(angles) - 1) - pi / 3
    assert abs(turned) == pytest.approx(abs(drift.imag * h + coefficient.imag * square), rel=0.02)


@pytest.mark.parametrize(("c", "attracting"), [("-1/4", True), ("1/4", False)])
def test_the_cubic_term_tells_attracting_circles(c, attracting):
    """Without a square the coefficient is `cubic/2`, the real part of `-cubic*(1 + 2*w)/(1 - w)`, `w = conj(mu)**2`."""
    fixed = {"trace": Rational(1, 2), "bend": Rational(0), "cubic": Rational(c)}
    found = torus(Rotating(PLANE, ("t", "d"), fixed), [0.01, 0.49, 1.02], "d")
    other = torus(Rotating(PLANE, ("t", "d"), fixed | {"cubic": Rational(0)}), [0.0, 0.49, 1.02], "d")

    assert found.certified
    assert (found.attracting, found.side) == (attracting, 1 if attracting else -1)
    assert abs(found.lyapunov - float(Rational(c)) / 2) < 1e-15
    assert other.checks == found.checks | {"nondegenerate": None}
    assert (other.attracting, other.side) == (None, 0)


@pytest.mark.parametrize("trace", [0, -1])
def test_strong_resonances_are_not_certified(trace):
    fixed = {"trace": Rational(trace), "bend": Rational(1), "cubic": Rational(1)}
    found = torus(Rotating(PLANE, ("t", "d"), fixed), [0.0, trace + 0.01, 1.02], "d")

    assert found.checks["nonresonant"] is None
    assert not found.certified


@given(st.fractions(-2, 2, max_denominator=6))
def test_a_rational_turn_with_a_rational_trace_has_an_integer_one(turn):
    """The criterion for irrational turns rests on this: no `2*cos(2*pi*p/q)` is a fraction other than an integer."""
    trace = Fraction(2 * cos(2 * pi * turn)).limit_denominator(12)

    if abs(trace - 2 * cos(2 * pi * turn)) < 1e-12:
        assert trace.denominator == 1
    fixed = {"trace": Rational(trace.numerator, trace.denominator)}
    assert Rotating(PLANE, ("t", "d"), fixed).irrational is (trace.denominator != 1)


def test_the_egg_bears_an_attracting_circle_at_period_17():
    found = invariant_circle()

    assert found.certified
    assert found.enclosure.status is ZeroStatus.UNIQUE
    assert found.attracting is True
    assert found.side == 1
    assert found.problem.irrational
    assert found.enclosure.zero[-1] < Rational(964, 1000)
    for trace in ("3/2", "-1/2", "-3/2"):
        near = [*map(float, found.enclosure.zero)]
        other = torus(replace(found.problem, fixed={TRACE: Rational(trace)}), near, "lam", 30)
        assert (other.certified, other.attracting, other.side, other.problem.irrational) == (True, True, 1, True)


def test_its_coefficient_is_that_of_the_derivatives_of_the_map_itself():
    """A second method: differences to third order of the 17th iterate, flight after flight.

    The two normal forms use different units; the ratio of imaginary and real part is free of them.
    """
    found = invariant_circle()
    solution = refined(found.problem, [float(x) for x in found.enclosure.zero], 80)
    shape, contraction = (mpmath.nstr(x, 80) for x in solution.z[-2:])
    exact = ExactMap(PinballMap("egg", alpha=shape, lam=0.5), 80, lam=Fraction(contraction))
    mp = exact.context
    here = [mp.mpf(x) for x in solution.z[:2]]
    leaving = chord_angles(egg(3), multiprecision(mp))(0, 0, 0)(*here, mp.mpf(shape))[0]
    step = mp.mpf(10) ** -24
    places = [(i, j) for i in range(4) for j in range(4 - i)]
    ends = [exact.orbit(exact.start(here[0] + i * step, leaving + j * step), 17)[-1] for i, j in places]
    vandermonde = mp.matrix([[mp.mpf(i) ** k * mp.mpf(j) ** m for k, m in places] for i, j in places])
    series = []
    for values in ([mp.asin(mp.sin(end.theta - here[0])) for end in ends], [end.phi - leaving for end in ends]):
        terms = mp.lu_solve(vandermonde, mp.matrix(values))
        series.append(
            {at: mpmath.nstr(c / step ** sum(at), 40) for at, c in zip(places, terms, strict=True) if sum(at)}
        )
    with working(200):
        x, p = ({at: arb(c) for at, c in terms.items()} for terms in series)
        form = birkhoff_normal_form((x, p))
        other = Rotation(found.problem, balls(200), exact_balls(solution.z)).cubic()
        ratio = (form.twist / form.drift) / (other.imag / other.real)

    assert abs(form.trace - 0.5) < 1e-9
    assert form.drift < 0
    assert abs(abs(ratio) - 1) < 1e-9
