"""Generated code: a closed vocabulary, exact rationals, reproducible bytes, and the value of its expression."""

import os
import runpy
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import (
    Float,
    Function,
    I,
    Integral,
    Rational,
    acos,
    cos,
    cosh,
    exp,
    log,
    oo,
    pi,
    sin,
    sinh,
    sqrt,
    symbols,
    tan,
    tanh,
)

from symbolic.expressions.text import VOCABULARY, kernel, load
from verification.arithmetic.balls import FLOAT64, balls, working

HERE = Path(__file__).parent.parent
x, y = symbols("x y", real=True)


def golden() -> dict[str, str]:
    return runpy.run_path(str(HERE / "golden_kernels.py"))["files"]()


@pytest.mark.slow
def test_golden_kernels_are_what_the_definitions_generate():
    made = golden()

    assert sorted(made) == sorted(p.name for p in (HERE / "golden").glob("*.py"))
    for name, text in made.items():
        assert text == (HERE / "golden" / name).read_text(), f"{name} changed; run python {HERE.name}/golden_kernels.py"


@pytest.mark.slow
def test_bytes_do_not_depend_on_the_hash_seed(tmp_path):
    root = HERE.parents[1]
    environment = {**os.environ, "PYTHONHASHSEED": "1", "PYTHONPATH": str(root)}  # that of this process is another
    subprocess.run(
        [sys.executable, str(HERE / "golden_kernels.py"), str(tmp_path)], env=environment, check=True, cwd=root
    )
    for file in sorted((HERE / "golden").glob("*.py")):
        assert (tmp_path / file.name).read_bytes() == file.read_bytes()


def test_a_temporary_takes_the_name_of_no_argument_no_definition_and_no_value():
    c = symbols("c0:4", real=True)
    shared = sqrt(1 + c[0] ** 2)
    values = {"c4": shared / 4, "c5": c[3] * shared, "c6": c[1] - c[0]}
    made = kernel("f", c[:2], values, {c[3]: c[0] + c[1]})
    found = load(made, FLOAT64)(0.75, 2.0)

    assert found == (1.25 / 4, 2.75 * 1.25, 1.25)


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (x * Float("0.08"), r"f: value: 0.0800000000000000 is a rounded float; write it exactly, as Rational\(2, 25\)"),
        (acos(x), "acos in acos.x. is outside the vocabulary"),
        (x**x, "Pow in .* is outside the vocabulary"),
        (x * I, "ImaginaryUnit"),
        (oo, "Infinity"),
        (Function("g")(x), "g in g.x. is outside"),
        (Integral(cos(x), (x, 0, 1)), "Integral"),
        (x * y, "y is neither an argument nor defined; known are x"),
    ],
)
def test_what_is_outside_the_vocabulary_is_refused_when_the_kernel_is_generated(expression, message):
    with pytest.raises(ValueError, match=message):
        kernel("f", [x], {"value": expression})


def test_an_arithmetic_that_lacks_a_word_is_refused_when_the_kernel_is_loaded():
    with pytest.raises(ValueError, match="f: this arithmetic has no cos; it has q"):
        load(kernel("f", [x], {"value": cos(x)}), SimpleNamespace(q=Fraction))


def test_loaded_text_reaches_nothing_but_its_arithmetic():
    function = load(kernel("f", [x], {"value": x + 1}), SimpleNamespace())

    assert set(function.__globals__) == {"__builtins__", "f"}
    assert function.__globals__["__builtins__"] == {}


rationals = st.fractions(-5, 5, max_denominator=20).map(lambda f: Rational(f.numerator, f.denominator))
leaves = st.one_of(st.just(x), st.just(y), rationals)
rational_expressions = st.recursive(
    leaves,
    lambda e: st.one_of(
        st.tuples(e, e).map(lambda p: p[0] + p[1]),
        st.tuples(e, e).map(lambda p: p[0] * p[1]),
        st.tuples(e, st.integers(2, 6)).map(lambda p: p[0] ** p[1]),
        e.map(lambda p: 1 / (p**2 + 1)),
    ),
    max_leaves=12,
)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(st.lists(rational_expressions, min_size=1, max_size=3), rationals, rationals)
def test_rational_functions_are_computed_exactly_over_fractions(expressions, u, v):
    values = {f"value{i}": e for i, e in enumerate(expressions)}
    function = load(kernel("f", [x, y], values), SimpleNamespace(q=Fraction))
    found = function(Fraction(u.p, u.q), Fraction(v.p, v.q))

    assert [Rational(Fraction(f)) for f in found] == [e.subs({x: u, y: v}) for e in expressions]


@pytest.mark.parametrize(
    "expression",
    [
        sqrt(x) ** 5 + tan(x) / exp(x) - log(x + pi) ** -3 + exp(1) * Rational(2, 7), -2 * x / (3 * y), y / tan(x),
        x ** Rational(-4, 3) + (x - y) ** Rational(5, 3), -(x**2) + (x + y) ** 9 - x**-2, x * (1 - y * (x + 1)) - pi,
        1 / (sin(x) * cos(x)), sqrt(-2 * y) * sinh(x) - tanh(x / 2) * cosh(y), (x - y) / (y - x - 1), y * tan(x) * -1,
    ],
)  # fmt: skip
def test_a_kernel_has_the_value_of_its_expression_in_floats_and_in_balls(expression):
    made, at = kernel("f", [x, y], {"value": expression}), {x: Rational(3, 4), y: Rational(-7, 8)}
    truth = expression.subs(at).evalf(60)
    (value,) = load(made, FLOAT64)(0.75, -0.875)
    with working(200):
        (ball,) = load(made, balls(200))(balls(200).q(3, 4), balls(200).q(-7, 8))
        assert abs(ball - arb(str(truth))) < 1e-50 * (1 + abs(ball))

    assert abs(value - truth) < 1e-13 * (1 + abs(truth))
    assert set(made.words) <= set(VOCABULARY)
