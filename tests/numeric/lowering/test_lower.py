"""Lowered programs are the expressions they were made of, and as few lines as they need."""

from itertools import chain

import mpmath
import pytest
from sympy import Float, Rational, Symbol, asin, cos, erf, exp, pi, sin, sqrt, sympify

from numeric.backends.scalars import ScalarBackend
from numeric.lowering.lower import converted, lower
from numeric.lowering.program import Builder, table_ir
from symbolic import tables
from symbolic.motion.flight import ONE, chord_polynomial, seen_ahead
from symbolic.tables.geometry import velocity
from symbolic.tables.table import Component, Table, theta

MP = mpmath.MPContext()
MP.dps = 40
OPS = ScalarBackend(MP)
B = Symbol("b", real=True)
AT, SHAPE = Rational(7, 5), Rational(3, 11)


def program_of(*expressions):
    """The program of expressions in `theta` and `b`."""
    builder = Builder("theta", "b")
    nodes = dict(zip((theta, B), builder.nodes, strict=True))
    return builder.program(*(converted(builder, expression, nodes) for expression in expressions))


def value(expression):
    """By SymPy, to 40 digits."""
    return MP.mpf(str(expression.subs({theta: AT, B: SHAPE}).evalf(45)))


EXPRESSIONS = [
    theta,
    B + theta,
    B * theta,
    B - theta,
    B / theta,
    Rational(2, 3) * theta,
    sympify(5),
    Rational(-7, 3),
    pi,
    2 * pi * theta,
    pi / 3,
    B * theta * pi,
    theta**2,
    theta**5,
    theta**-1,
    theta**-4,
    sqrt(theta),
    1 / sqrt(theta),
    theta ** Rational(3, 2),
    theta ** Rational(5, 2),
    theta ** Rational(-3, 2),
    (B + 1) ** 3,
    cos(theta),
    sin(theta),
    cos(theta) * sin(theta),
    sin(-2 * theta),
    cos(2 * theta),
    cos(-3 * theta),
    sin(3 * theta),
    cos(theta / 2),
    sin(theta + 1),
    sin(3 * B),
    cos(theta * B),
    sin(theta) + B * cos(3 * theta) - 4,
]


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_a_program_has_the_value_of_its_expression(expression):
    (found,) = program_of(expression)(OPS, MP.mpf(AT.p) / AT.q, MP.mpf(SHAPE.p) / SHAPE.q)

    assert abs(found - value(expression)) <= 100 * MP.eps


def test_cosine_and_sine_of_multiples_share_one_call():
    program = program_of(*(f(k * theta) for f in (cos, sin) for k in (1, 2, 3, -4)))
    words = [line[0] for line in program.lines]

    assert (words.count("cos"), words.count("sin")) == (1, 1)
    assert [line[0] for line in program_of(cos(B), sin(theta / 2)).lines].count("cos") == 1


@pytest.mark.parametrize("k", [-1, -2, -5, 0])
@pytest.mark.parametrize("function", [cos, sin])
def test_multiples_that_sympy_would_turn_round_are_as_good(function, k):
    expression = function(k * theta, evaluate=False)
    (found,) = program_of(expression)(OPS, MP.mpf(AT.p) / AT.q, MP.mpf(0))

    assert abs(found - value(function(k * theta))) <= 100 * MP.eps


@pytest.mark.parametrize("k", [1, 2, 5])
def test_in_the_frame_of_the_flight_any_harmonic_has_the_same_chords(k):
    """In rational numbers, with `E` and `B` of length one; `k = 1` beside it, so that the polynomial is one."""
    E, B = (((1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)) for t in (Rational(1, 3), Rational(-9, 4)))
    one = ((Rational(2), Rational(1, 7)), (Rational(-1, 5), Rational(3, 2)))
    other = ((Rational(1, 3), Rational(-2, 5)), (Rational(3, 4), Rational(5, 7)))
    h = {1: one, k: other}
    ahead = {n: seen_ahead(n, *vectors, E) for n, vectors in h.items()}

    assert chord_polynomial(ahead, ONE, B) == chord_polynomial(h, E, B)


@pytest.mark.parametrize(
    ("expression", "words"),
    [
        (Float("0.1") * theta, "contains a rounded float; write its numbers exactly"),
        (erf(theta), "is beyond the kernels' words"),
        (asin(theta), "is beyond the kernels' words"),
        (theta ** Rational(1, 13), "is beyond the kernels' words"),
        (theta**B, "is beyond the kernels' words"),
        (Symbol("c") + 1, "c is beyond the kernels' words"),
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


FAMILIES = {
    "circle": ("circle", tables.circle),
    "ellipse": ("ellipse", tables.ellipse),
    "cardioid": ("cardioid", tables.cardioid),
    "cuspless": ("cuspless", tables.cuspless),
    "egg": ("fourier", tables.egg(4)),
    "lifted": ("ellipse", tables.parametric(cos(theta) + 1, 2 * sin(theta) - 3, name="lifted")),
    "rooted": ("polar", tables.polar(sqrt(2 + cos(theta)), name="rooted")),
    "half an angle": ("general", tables.polar(exp(sin(theta / 2) ** 2), name="half an angle")),
    "twice": (
        "general",
        Table("twice", (Component("round", (cos(2 * theta), sin(2 * theta)), -pi / 2, pi / 2),)),
    ),
    "halves": (
        "pieces",
        tables.piecewise(
            tables.arc("lower", cos(theta), sin(theta), -pi, 0), tables.arc("upper", cos(theta), sin(theta), 0, pi),
            name="halves",
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAMILIES)
def test_a_table_is_known_as_the_papers_or_has_the_programs_of_its_fourier_sum(name):
    family, table = FAMILIES[name]
    made = lower(table)
    words = {"ellipse": ["point", "velocity", "acceleration", "support"]}
    words["fourier"] = [*words["ellipse"][:3], "chord", "radius"]
    words["polar"] = ["radius"]
    words["pieces"] = ["circle 0", "circle 1"]

    assert made.same_as == (family if family in ("circle", "cardioid", "cuspless") else "")
    assert [word for word, _ in made.programs] == words.get(family, [])


def test_shapes_and_the_origin_come_along():
    made = lower(tables.named("egg", 4))
    (shape,) = made.shape

    assert (shape.name, shape.low, shape.high) == ("alpha", "0", "1/17")
    assert lower(tables.named("ellipse")).shape[0].high is None
    assert (made.table, made.origin[0], made.origin[1](OPS, MP.mpf(1))) == ("egg", 0, [0])
    assert lower(tables.named("cuspless")).origin[0] == 1
    assert len(lower(tables.named("egg")).program("chord").outputs) == 8
