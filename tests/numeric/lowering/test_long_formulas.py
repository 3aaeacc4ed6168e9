"""The curve of a long formula, harmonic by harmonic or by the chain rule, is the curve that was typed."""

import time

import mpmath
import numpy as np
import pytest

from numeric import PinballMap
from numeric.lowering import lower
from symbolic import tables
from symbolic.tables.formula import parse
from symbolic.tables.table import theta

HARMONICS = "1+" + "+".join(f"cos({k}*theta)/{1000 * k * k}" for k in range(1, 41))
FACTORS = "1+" + "*".join(f"(1+cos({k}*theta)/50)" for k in range(1, 31)) + "/100"
LEVELS = "1+" + "cos(" * 30 + "theta" + ")" * 30 + "/40"
QUOTIENTS = "1/(3+" * 12 + "cos(theta)" + ")" * 12


@pytest.mark.parametrize(
    "text", [HARMONICS, FACTORS, LEVELS, QUOTIENTS], ids=["harmonics", "factors", "levels", "quotients"]
)
def test_point_velocity_and_acceleration_are_those_of_the_formula(text):
    rho = parse(text)
    table, started = tables.polar(rho, "own"), time.process_time()
    map = PinballMap(table, lam="1/2", kernels=False)
    assert time.process_time() - started < 60

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
    """The formula with mpmath's functions."""
    from sympy import lambdify

    return lambdify(theta, rho, modules=[context])(t)


@pytest.mark.parametrize("text", ["1+cos(5*theta)/40", "sqrt(4+cos(theta))/(3+sin(2*theta)/9)"])
def test_the_chain_rule_says_what_differentiation_says(text, monkeypatch):
    table = tables.polar(text, "own")
    plain = PinballMap(table, lam="1/2", kernels=False).family.boundary
    monkeypatch.setattr(lower, "LONG", 0)
    chained = PinballMap(table, lam="1/2", kernels=False).family.boundary
    at = np.linspace(-3, 3, 50)
    rows = [boundary.curve(np.zeros(50, dtype=np.int64), at) for boundary in (plain, chained)]

    assert np.max(np.abs(rows[0] - rows[1])) < 2e-15
