"""Each function of the vector kernels, compiled and run, against exact or library arithmetic."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from numeric.flights.family import Family, Landing
from numeric.kernels.engine import Engine
from numeric.kernels.machine import KernelSpec

EPS = 2.0**-52
RNG = np.random.default_rng(7)
X, Y, Z = RNG.normal(size=(3, 40))
X[:6], Y[:6] = [0.0, -0.0, 1.0, -1.0, 2.0, -3.0], [1.0, -2.0, 1.0, 2.0, -0.5, -3.0]
ROW = X.tolist(), Y.tolist(), Z.tolist()


class Words(Family):
    """A step that writes the value of a formula in `x, y, z` to the fourth row."""

    name = "words"
    position = ("x", "y", "z", "value")
    stops = False

    def __init__(self, formula):
        self.formula = formula

    def fly(self, ops, shape, law, position, exit):
        *given, _ = position
        return Landing([*given, self.formula(ops, *given)], ops.number(0.0), ops.number(1.0))

    def normal_exit(self, ops, shape, position):
        return []


Words.__abstractmethods__ = frozenset()  # the tests need no other method

COUNTER = iter(range(10**6))


def valued(formula, x=X, y=Y, z=Z, kernels=True):
    """The value of a formula in every lane."""
    engine = Engine(Words(formula), f"words {next(COUNTER)}", [], kernels, 8)
    return engine.run(KernelSpec("slap"), [x, y, z, 0 * x], np.zeros(x.size), [], 1).rows["value"].tolist()


def rounded(*terms):
    """The double nearest to a sum of products."""
    return float(sum(math.prod(map(Fraction, term)) for term in terms))


WORDS = {  # the formula on lanes, and what it is for three doubles
    "sum": (lambda o, x, y, z: x + y, lambda x, y, z: x + y),
    "difference": (lambda o, x, y, z: x - y, lambda x, y, z: x - y),
    "product": (lambda o, x, y, z: x * y, lambda x, y, z: x * y),
    "quotient": (lambda o, x, y, z: x / y, lambda x, y, z: x / y),
    "negative": (lambda o, x, y, z: -x, lambda x, y, z: -x),
    "size": (lambda o, x, y, z: abs(x), lambda x, y, z: abs(x)),
    "fused": (lambda o, x, y, z: o.fma(x, y, z), lambda x, y, z: rounded((x, y), (z,))),
    "a product added": (lambda o, x, y, z: x * y + z, lambda x, y, z: rounded((x, y), (z,))),
    "added to a product": (lambda o, x, y, z: z + x * y, lambda x, y, z: rounded((x, y), (z,))),
    "less a product": (lambda o, x, y, z: z - x * y, lambda x, y, z: rounded((-x, y), (z,))),
    "a product less": (lambda o, x, y, z: x * y - z, lambda x, y, z: rounded((x, y), (-z,))),
    "minus a product": (lambda o, x, y, z: -(x * y) + z, lambda x, y, z: rounded((-x, y), (z,))),
    "two products": (lambda o, x, y, z: x * y + y * z, lambda x, y, z: rounded((x, y), (y * z,))),
    "products apart": (lambda o, x, y, z: o.product(x, y) + z, lambda x, y, z: x * y + z),
    "a number more": (lambda o, x, y, z: x * y + o.number(3), lambda x, y, z: rounded((x, y), (3,))),
    "a number less": (lambda o, x, y, z: x - o.number(3), lambda x, y, z: x - 3),
    "less from a number": (lambda o, x, y, z: o.number(3) - x, lambda x, y, z: 3 - x),
    "a number times": (lambda o, x, y, z: o.number(3) * x, lambda x, y, z: 3 * x),
    "a share": (lambda o, x, y, z: o.q(1, 3) * x, lambda x, y, z: 1 / 3 * x),
    "inverse": (lambda o, x, y, z: o.number(1) / y, lambda x, y, z: 1 / y),
    "by a number": (lambda o, x, y, z: x / o.number(3), lambda x, y, z: x / 3),
    "root": (lambda o, x, y, z: o.sqrt(abs(x)), lambda x, y, z: math.sqrt(abs(x))),
    "larger": (lambda o, x, y, z: o.maximum(x, y), lambda x, y, z: max(x, y)),
    "below": (lambda o, x, y, z: o.select(x < y, x, z), lambda x, y, z: x if x < y else z),
    "at most": (lambda o, x, y, z: o.select(x <= y, x, z), lambda x, y, z: x if x <= y else z),
    "equal": (lambda o, x, y, z: o.select(x == y, x, z), lambda x, y, z: x if x == y else z),
    "and": (lambda o, x, y, z: o.select((x < y) & (y < z), x, z), lambda x, y, z: x if x < y < z else z),
    "or": (lambda o, x, y, z: o.select((x < y) | (y < z), x, z), lambda x, y, z: x if x < y or y < z else z),
    "not": (lambda o, x, y, z: o.select(o.negated(x < y), x, z), lambda x, y, z: z if x < y else x),
    "whole": (lambda o, x, y, z: o.rounded(o.number(9) * x), lambda x, y, z: float(round(9 * x))),
    "sign of": (lambda o, x, y, z: o.with_sign(x, y), lambda x, y, z: math.copysign(x, y)),
    "sign by": (lambda o, x, y, z: o.times_sign(x, y), lambda x, y, z: x * math.copysign(1, y)),
    "half turn": (lambda o, x, y, z: o.pi * x, lambda x, y, z: math.pi * x),
    "rest of it": (lambda o, x, y, z: o.pi_low * x, lambda x, y, z: 1.2246467991473532e-16 * x),
}


@pytest.mark.parametrize("word", WORDS)
def test_a_word_gives_the_bits_of_its_definition(word):
    formula, truth = WORDS[word]
    found, expected = valued(formula), [truth(*row) for row in zip(*ROW, strict=True)]

    assert found == expected
    if word in ("size", "negative", "sign of", "sign by"):  # of zeros as well
        assert [math.copysign(1, f) for f in found] == [math.copysign(1, e) for e in expected]


def test_angles_of_many_turns_have_their_sine_and_cosine():
    import mpmath

    mp = mpmath.MPContext()
    mp.dps = 40
    x = np.concatenate([np.linspace(-7, 7, 201), [1e3, -1e5, 2.0**20, 3 * np.pi, -5 * np.pi / 2]])
    for word in ("sin", "cos"):
        found = valued(lambda o, x, y, z, word=word: getattr(o, word)(x), x, x, x)
        truth = [getattr(mp, word)(a) for a in x.tolist()]
        assert (
            max(abs(f - t) for f, t in zip(found, truth, strict=True)) <= 2 * EPS
        )  # of which an eps is the rest's own rounding


SPREAD = np.concatenate([np.linspace(-30, 30, 300), np.geomspace(1e-12, 600, 60), -np.geomspace(1e-12, 600, 60)])
POSITIVE = np.concatenate(
    [np.geomspace(1e-300, 1e300, 300), 1 + np.linspace(-0.3, 0.5, 101), 1 + np.geomspace(1e-15, 0.1, 40)]
)
ANALYTIC = {  # the word, what it is at 50 digits, where, and its largest relative error in units of 2**-52
    "exp": (lambda o, x: o.exp(x), lambda mp, x: mp.exp(x), SPREAD, 1.2),
    "log": (lambda o, x: o.log(x), lambda mp, x: mp.log(x), POSITIVE, 1.2),
    "atan": (lambda o, x: o.atan(x), lambda mp, x: mp.atan(x), SPREAD, 1.5),
    "sinh": (lambda o, x: o.sinh(x), lambda mp, x: mp.sinh(x), SPREAD, 3),
    "cosh": (lambda o, x: o.cosh(x), lambda mp, x: mp.cosh(x), SPREAD, 2),
    "tanh": (lambda o, x: o.tanh(x), lambda mp, x: mp.tanh(x), SPREAD, 3),
    **{
        f"root {n}": (lambda o, x, n=n: o.root(x, n), lambda mp, x, n=n: mp.root(x, n), POSITIVE, 2) for n in (3, 5, 12)
    },
}


@pytest.mark.parametrize("kernels", [True, False], ids=["lanes", "arrays"])
@pytest.mark.parametrize("word", ANALYTIC)
def test_an_analytic_function_is_relatively_exact_wherever_it_is_a_double(word, kernels):
    mp = mpmath.MPContext()
    mp.dps = 50
    formula, truth, x, bound = ANALYTIC[word]
    found = valued(lambda o, x, y, z: formula(o, x), x, x, x, kernels)
    errors = [abs(mp.mpf(a) / truth(mp, mp.mpf(float(b))) - 1) / EPS for a, b in zip(found, x, strict=True)]

    assert max(errors) <= bound
