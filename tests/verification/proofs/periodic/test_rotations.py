"""Equations of a rotating cycle: derivatives agree with differences, for each ring, closure and set of unknowns."""

import cmath
from dataclasses import replace

import numpy as np
import pytest
from flint import arb
from sympy import Rational, Symbol, cos, sin

from verification.arithmetic.balls import FLOAT64
from verification.cycles.recurrence import AFTER, BEFORE, HERE, IDENTITY, MIRROR, Closure, Explicit
from verification.proofs.periodic.torus import Rotating, Rotation, Torus

t, d, push = (Symbol(name, real=True) for name in ("t", "d", "push"))
RULE = AFTER * (2 + HERE**2) - t * HERE + d * BEFORE * (1 + HERE / 3) + HERE**2 * BEFORE + d * t * HERE**3
RING = Explicit("ring", RULE, (t, d), 3)
PLACES = [0.25, -0.5, 0.0]
POINTS = {
    ("t", "d"): ({"trace": Rational(1, 2)}, [1.25, 0.75]),
    ("d", "trace"): ({"t": Rational(5, 4)}, [0.75, 0.5]),
    ("trace", "t"): ({"d": Rational(3, 4)}, [-0.5, 1.25]),
}


@pytest.mark.parametrize("free", POINTS)
@pytest.mark.parametrize("ring", [RING, replace(RING, closure=MIRROR), replace(RING, period=1)], ids=str)
def test_what_is_solved_for_are_the_differences_of_the_equations(free, ring):
    """The matrix of first derivatives against differences of the values, at random points away from a cycle."""
    fixed, given = POINTS[free]
    problem, h = Rotating(ring, free, fixed), 1e-6
    z = [*PLACES[-ring.period :], *given] if ring.period > 1 else [0.0, *given]
    columns = []
    for k in range(len(z)):
        ends = [np.array(problem.value(FLOAT64, [*z[:k], z[k] + s * h, *z[k + 1 :]])) for s in (-1, 1)]
        columns.append((ends[1] - ends[0]) / (2 * h))
    right = [0.5, -1.0, 0.25, 2.0, -0.75][: len(z)]
    solved = problem.solved(FLOAT64, z, right)

    assert np.array(columns).T @ solved == pytest.approx(right, abs=1e-7)
    assert problem.newton(FLOAT64, z) == pytest.approx(problem.solved(FLOAT64, z, problem.value(FLOAT64, z)))


@pytest.mark.parametrize("ring", [RING, replace(RING, closure=MIRROR), replace(RING, period=1)], ids=str)
def test_a_turn_is_the_difference_of_the_bordering_function_along_the_circle(ring):
    """The derivative of `mu = exp(i*omega)` by `omega` is `i*mu`."""
    h = 1e-6
    problem = Rotating(ring, ("t", "d"), {"trace": Rational(1, 2)})
    here = Rotation(problem, FLOAT64, [*PLACES[: ring.period], 1.25, 0.75])
    low, high = (here.closed(here.mu * cmath.rect(1, s * h)).bordering for s in (-1, 1))

    assert abs(here.mu - cmath.rect(1, cmath.acos(0.25).real)) < 1e-15
    assert abs((high - low) / (2 * h) - 1j * here.mu * here.turn) < 1e-8
    assert here.value[:-2] == here.terms.value
    assert here.value[-2:] == [here.critical.bordering.real, here.critical.bordering.imag]


def test_an_orbit_that_goes_on_by_whole_turns_has_the_normal_form_of_one_that_stays():
    """A rule in differences and sines keeps its coefficients when `2*pi` is added at each bounce."""
    rule = AFTER - HERE - d * (HERE - BEFORE) + push * sin(HERE) - push * sin(Rational(1, 2)) + cos(HERE - BEFORE)
    stays = Explicit("kicked", rule - 1, (d, push), 1)
    fixed = {"push": Rational(3, 2)}
    trace = 2 - 1.5 * np.cos(0.5)  # of 1 + d - push*cos(x) at d = 1
    found = [
        Rotation(Rotating(ring, ("d", "trace"), fixed), FLOAT64, [0.5, 1.0, trace])
        for ring in (stays, replace(stays, closure=Closure(1, (1, 1))), replace(stays, closure=Closure(1, (-2, 1))))
    ]
    for one in found:
        assert max(map(abs, one.value)) < 1e-12
        assert abs(one.cubic()) > 0.1
        assert abs(one.cubic() - found[0].cubic()) < 1e-9


@pytest.mark.parametrize("closure", [IDENTITY, MIRROR])
def test_a_rule_times_a_function_that_is_not_0_has_the_same_normal_form(closure):
    """An odd rule times an even function is odd, so that half of a cycle can be followed too."""
    bent = 2 * HERE * BEFORE if closure == IDENTITY else 0
    plane = AFTER - t * HERE + d * BEFORE + bent - HERE**2 * BEFORE + push * HERE**3
    factor = 2 + 3 * AFTER * HERE + AFTER**2 + (AFTER if closure == IDENTITY else 0)
    fixed = {"t": Rational(1, 2), "push": Rational(1, 3)}
    for times in (1, 2):
        whole = closure.turn * (0.25 + 1j * (1 - 0.25**2) ** 0.5) ** times
        forms = [
            Rotation(
                Rotating(Explicit("plane", rule, (t, d, push), times, closure), ("d", "trace"), fixed),
                FLOAT64,
                [0.0] * times + [1.0, 2 * whole.real],
            )
            for rule in (plane, plane * factor)
        ]
        assert max(map(abs, (*forms[0].value, *forms[1].value))) < 1e-9
        assert abs(forms[0].cubic()) > 0.1
        assert abs(forms[0].cubic() - forms[1].cubic()) < 1e-9
        assert abs(forms[0].drift("d") - forms[1].drift("d")) < 1e-12


@pytest.mark.parametrize(
    ("lyapunov", "growth", "attracting", "side"),
    [
        (-1, 1, True, 1), (-1, -1, True, -1), (1, 1, False, -1), (1, -1, False, 1),
        (arb(0, 1), 1, None, 0), (-1, arb(0, 1), True, 0), (0, 1, None, 0), (1, 0, False, 0),
    ],
)  # fmt: skip
def test_a_curve_attracts_by_the_sign_of_its_coefficient_and_lies_where_the_product_of_both_is_negative(
    lyapunov, growth, attracting, side
):
    for checks, certified in (({"one": True}, True), ({"one": True, "other": None}, False), ({"one": False}, False)):
        found = Torus(None, None, checks, *(x if isinstance(x, arb) else arb(x) for x in (growth, lyapunov)))
        assert (found.certified, found.attracting, found.side) == (certified, attracting, side)
