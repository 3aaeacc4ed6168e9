"""Lowered programs have the values of the expressions they were made from."""

from itertools import chain

import mpmath
import pytest
from sympy import Float, Rational, Symbol, asin, cos, erf, pi, sin, sqrt, sympify

from numeric.backends.scalars import ScalarBackend
from numeric.lowering.lower import converted, lower
from numeric.lowering.program import Builder, table_ir
from symbolic import tables
from symbolic.tables.geometry import velocity
from symbolic.tables.table import theta

MP = mpmath.MPContext()
MP.dps = 40
OPS = ScalarBackend(MP)
B = Symbol("b", real=True)
AT, SHAPE = Rational(7, 5), Rational(3, 11)


def program_of(*expressions):
    """The program that computes expressions in `theta` and `b`."""
    builder = Builder("theta", "b")
    nodes = dict(zip((theta, B), builder.nodes, strict=True))
    return builder.program(*(converted(builder, expression, nodes) for expression in expressions))


def value(expression):
    """The value from SymPy, to 40 digits."""
    return MP.mpf(str(expression.subs({theta: AT, B: SHAPE}).evalf(45)))


EXPRESSIONS = [
    theta, B + theta, B * theta, B - theta, B / theta, Rational(2, 3) * theta, sympify(5), Rational(-7, 3), pi,
    2 * pi * theta, pi / 3, B * theta * pi, theta**2, theta**5, theta**-1, theta**-4, sqrt(theta), 1 / sqrt(theta),
    theta ** Rational(3, 2), theta ** Rational(5, 2), theta ** Rational(-3, 2), (B + 1) ** 3, cos(theta), sin(theta),
    cos(theta) * sin(theta), sin(-2 * theta), cos(2 * theta), cos(-3 * theta), sin(3 * theta), cos(theta / 2),
    sin(theta + 1), sin(3 * B), cos(theta * B), sin(theta) + B * cos(3 * theta) - 4,
]  # fmt: skip


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_a_program_has_the_value_of_its_expression(expression):
    (found,) = program_of(expression)(OPS, MP.mpf(AT.p) / AT.q, MP.mpf(SHAPE.p) / SHAPE.q)

    assert abs(found - value(expression)) <= 100 * MP.eps


@pytest.mark.parametrize(
    ("expression", "words"),
    [
        (Float("0.1") * theta, "contains a rounded float; write its numbers exactly"),
        (erf(theta), "has no code in kernels"),
        (asin(theta), "has no code in kernels"),
        (theta ** Rational(1, 13), "has no code in kernels"),
        (theta**B, "has no code in kernels"),
        (Symbol("c") + 1, "c has no code in kernels"),
    ],
)
def test_what_has_no_word_is_refused(expression, words):
    with pytest.raises(ValueError, match=words):
        program_of(expression)


@pytest.mark.parametrize("name", ["circle", "ellipse", "cardioid", "cuspless", "egg"])
def test_a_part_is_the_curve_of_its_component_with_two_derivatives(name):
    table, made = tables.named(name, 3), lower(tables.named(name, 3))
    shape = {symbol.symbol: Rational(1, 12) if name == "egg" else Rational(7, 5) for symbol in table.shapes}
    numbers = [MP.mpf(x.p) / x.q for x in shape.values()]
    for part, component in zip(made.parts, table.components, strict=True):
        point = [*component.point, *velocity(component), *velocity(component).diff(theta)]
        truth = [MP.mpf(str(sympify(e).subs(shape).subs(theta, Rational(3, 7)).evalf(45))) for e in point]
        ends = [MP.mpf(str(sympify(e).evalf(45))) for e in (component.start, component.end)]
        found = part.curve(OPS, MP.mpf(3) / 7, *numbers)

        assert max(abs(a - b) for a, b in zip(found, truth, strict=True)) <= 100 * MP.eps
        assert max(abs(a - b) for a, b in zip(part.ends(OPS, *numbers), ends, strict=True)) <= 4 * MP.eps
        assert (part.name, part.curve.inputs[0]) == (component.name, "theta")


@pytest.mark.parametrize(("name", "K"), [("ellipse", 3), ("egg", 2), ("egg", 3), ("egg", 5)])
def test_programs_in_unit_numbers_are_the_curve(name, K):
    made = table_ir(name, K)
    shape = [MP.mpf(1) / 30 if name == "egg" else MP.mpf(7) / 5]
    at = MP.mpf(3) / 7
    whole = made.parts[0].curve(OPS, at, *shape)
    pairs = [made.program(word)(OPS, MP.cos(at), MP.sin(at), *shape) for word in ("point", "velocity", "acceleration")]

    assert max(abs(a - b) for a, b in zip(chain(*pairs), whole, strict=True)) <= 100 * MP.eps
