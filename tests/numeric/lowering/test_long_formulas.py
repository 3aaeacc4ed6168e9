"""The curve of a long formula is the one that was typed; a formula that would take minutes is refused."""

import mpmath
import numpy as np
import pytest
from sympy import Add, cos, pi, sin

from numeric import PinballMap
from numeric.lowering.program import table_ir
from symbolic import tables
from symbolic.tables.formula import parse
from symbolic.tables.table import Component, Table, theta

HARMONICS = "1+" + "+".join(f"cos({k}*theta)/{1000 * k * k}" for k in range(1, 41))
FACTORS = "1+" + "*".join(f"(1+cos({k}*theta)/50)" for k in range(1, 31)) + "/100"
LEVELS = "1+" + "cos(" * 30 + "theta" + ")" * 30 + "/40"
QUOTIENTS = "1/(3+" * 12 + "cos(theta)" + ")" * 12


@pytest.mark.slow
@pytest.mark.parametrize(
    "text", [HARMONICS, FACTORS, LEVELS, QUOTIENTS], ids=["harmonics", "factors", "levels", "quotients"]
)
def test_point_velocity_and_acceleration_are_those_of_the_formula(text):
    rho = parse(text)
    map = PinballMap(tables.polar(rho, "own"), lam="1/2", kernels=False)

    context = mpmath.MPContext()
    context.dps = 40
    for x in (0.3, -2.1):
        rows = map.family.boundary.curve(np.zeros(1, dtype=np.int64), np.array([x]))[:, 0]

        turned = [
            lambda t: _value(context, rho, t) * context.cos(t),
            lambda t: _value(context, rho, t) * context.sin(t),
        ]
        exact = [context.diff(f, context.mpf(x), n) for n in range(3) for f in turned]
        scale = [1, 1, 1, 1, 60, 60]

        assert np.allclose(rows, [float(value) for value in exact], rtol=0, atol=[2e-15 * 60 * s for s in scale])


def _value(context, rho, t):
    """The value of the formula with mpmath's functions."""
    from sympy import lambdify

    return lambdify(theta, rho, modules=[context])(t)


def test_a_formula_that_would_take_minutes_is_refused():
    radius = Add(1, *(cos(k * theta) / k**4 for k in range(1, 801)))
    many = Table("many", (Component("round", (radius * cos(theta), radius * sin(theta)), -pi, pi),))

    with pytest.raises(
        ValueError, match=r"many: a coordinate of round has .* numbers and operations; at most 4000 are"
    ):
        PinballMap(many)


def test_a_fast_wave_is_few_operations():
    """`cos(10**6*theta)` takes forty products, and no polynomial of that degree is expanded."""
    lobed = Table("lobed", (Component("round", polar_point(1 + cos(10**6 * theta) / 10**13), -pi, pi),))

    assert len(table_ir(lobed).parts[0].curve.lines) < 250


def polar_point(radius):
    return radius * cos(theta), radius * sin(theta)
