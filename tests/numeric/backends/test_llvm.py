"""Each word of the lanes, compiled and run, against the same word in exact or library arithmetic."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from numeric.backends.llvm import LLVMBackend, LLVMVector
from numeric.backends.scalars import ArrayBackend
from numeric.flights.family import Family, Landing
from numeric.kernels.engine import Engine
from numeric.kernels.machine import KernelSpec

EPS = 2.0**-52
RNG = np.random.default_rng(7)
X, Y, Z = RNG.normal(size=(3, 40))
X[:6], Y[:6] = [0.0, -0.0, 1.0, -1.0, 2.0, -3.0], [1.0, -2.0, 1.0, 2.0, -0.5, -3.0]
ROW = X.tolist(), Y.tolist(), Z.tolist()


class Words(Family):
    """A step that puts the value of a formula in `x, y, z` into the fourth row."""

    name = "words"
    position = ("x", "y", "z", "value")
    stops = False

    def __init__(self, formula):
        self.formula = formula

    def fly(self, ops, shape, law, position, exit):
        *given, _ = position
        return Landing([*given, self.formula(ops, *given)], ops.number(0.0), ops.number(1.0))

    def slapped(self, ops, shape, position):
        return []


Words.__abstractmethods__ = frozenset()  # nothing else is asked of it

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


def test_where_one_is_no_number_the_other_is_the_larger():
    nan = np.full(8, np.nan)

    assert valued(lambda o, x, y, z: o.maximum(x, y), nan, Y[:8], Z[:8]) == Y[:8].tolist()


@pytest.mark.parametrize("index", [0, 1])
def test_the_power_of_two_below_a_number(index):
    x = np.array([1e-300, 0.49, 0.5, 1.0, 1.5, 2.0, 1023.0, 2.0**100, 1e300])
    found = valued(lambda o, x, y, z: o.power_of_two(x)[index], x, x, x)
    exponents = [math.frexp(a)[1] - 1 for a in x.tolist()]

    assert found == [float(e) if index else 2.0**-e for e in exponents]
    assert found == valued(lambda o, x, y, z: o.power_of_two(x)[index], x, x, x, kernels=False)


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


@pytest.mark.parametrize("quarters", [1, 2])
def test_lanes_and_arrays_have_the_same_elementary_functions(quarters):
    x = np.linspace(-1, 1, 101) * quarters * np.pi / 2
    for index in (0, 1):
        one, two = (
            valued(lambda o, x, y, z, i=index: o.turn(x, quarters)[i], x, x, x, kernels=k) for k in (True, False)
        )
        assert np.max(np.abs(np.array(one) - two)) <= EPS
    one, two = (valued(lambda o, x, y, z: o.angle(x, abs(y)), kernels=k) for k in (True, False))
    assert np.max(np.abs(np.array(one) - two)) <= 2 * EPS


def collatz(o, x, y, z):
    """Halves until the size is below 1/8, counting; at most six times."""
    state = [abs(x), o.number(0.0) * x]
    size, count = o.repeat(
        lambda s: o.number(0.125) <= s[0], lambda s: [s[0] * o.number(0.5), s[1] + o.number(1.0)], state, 6
    )
    return size * o.number(100.0) + count


@pytest.mark.parametrize("kernels", [True, False])
def test_a_loop_runs_in_the_lanes_that_need_it_and_not_beyond_its_limit(kernels):
    x = np.array([0.0, 0.1, 0.125, 0.25, 1.0, -3.0, 100.0, np.nan])
    expected = []
    for size in np.abs(x):
        count = 0
        while size >= 0.125 and count < 6:
            size, count = size / 2, count + 1
        expected.append(size * 100 + count)

    assert np.array_equal(valued(collatz, x, x, x, kernels), expected, equal_nan=True)


@pytest.mark.parametrize("kernels", [True, False])
def test_a_branch_is_taken_where_its_mask_holds_anywhere(kernels):
    def formula(o, x, y, z):
        product = x * y  # not written before it is needed: once inside the branch, once behind it
        (changed,) = o.when(x < z, [x], lambda: [o.select(x < z, product + z, x)])
        (same,) = o.when(o.number(1e9) < x, [changed], lambda: [o.number(0.0) * changed])
        return same + product

    expected = [rounded((x, y), (rounded((x, y), (z,)) if x < z else x,)) for x, y, z in zip(*ROW, strict=True)]
    found = valued(formula, kernels=kernels)

    assert np.max(np.abs(np.array(found) - expected)) <= (0 if kernels else 4 * EPS)


def traced():
    """Lanes and two values that are not known."""
    ops = LLVMBackend(8)
    return ops, LLVMVector(ops, "%x"), LLVMVector(ops, "%y")


def test_numbers_are_computed_while_tracing():
    ops, x, _ = traced()
    six, two, nought, one = (ops.number(value) for value in (6, 2, 0, 1))
    values = six + two, six - two, six * two, six / two, -six, abs(-six), ops.sqrt(ops.number(9)), ops.q(3, 4)

    assert [lane.value for lane in values] == [8, 4, 12, 3, -6, 6, 3, 0.75]
    assert all(lane is x for lane in (x + nought, nought + x, x - nought, x * one, one * x, x / one))
    assert [(x * nought).value, (nought * x).value] == [0, 0]
    assert ops.lines == []


def test_signs_of_known_numbers_become_negations():
    for formula in (lambda o, x: o.number(0) - x, lambda o, x: o.number(-1) * x, lambda o, x: x * o.number(-1)):
        ops, x, _ = traced()
        text = formula(ops, x).text
        assert ops.lines == [f"  {text} = fneg <8 x double> %x"]


def test_equal_instructions_are_written_once_and_products_only_when_needed():
    ops, x, y = traced()
    total = x * y + x
    again = x * y + x

    assert total.text == again.text
    assert [line.split(" = ")[1].split()[0] for line in ops.lines] == ["call"]
    ops.settle(x * y, y - x)
    assert [line.split(" = ")[1].split()[0] for line in ops.lines] == ["call", "fsub", "fmul"]


@pytest.mark.parametrize("factor", [0.0, 1.0, -1.0])
def test_a_fused_product_with_a_trivial_factor_is_none(factor):
    for swapped in (False, True):
        ops, x, y = traced()
        f = ops.number(factor)
        result = ops.fma(*((x, f) if swapped else (f, x)), y)
        words = [line.split(" = ")[1].split()[0] for line in ops.lines]
        assert words == {0.0: [], 1.0: ["fadd"], -1.0: ["fneg", "fadd"]}[factor]
        assert (result is y) == (factor == 0.0)
    ops, x, y = traced()
    assert ops.fma(x, y, ops.number(0.0)).text
    assert [line.split(" = ")[1].split()[0] for line in ops.lines] == ["fmul"]


def test_a_number_is_written_with_all_its_bits():
    ops, *_ = traced()

    assert ops.number(-1.5).text == "splat (double 0xBFF8000000000000)"
    assert ops.number(0.1).text == "splat (double 0x3FB999999999999A)"
    assert (ops.pi.value, ArrayBackend().pi) == (math.pi, math.pi)


@pytest.mark.parametrize("kernels", [True, False])
def test_a_product_written_in_a_branch_is_written_again_behind_it(kernels):
    """What is written inside of a branch, or of a loop, is not there for what follows."""

    def formula(o, x, y, z):
        product = x * y
        for _ in range(2):
            (z,) = o.when(x < z, [z], lambda z=z: [o.select(x < z, product, z)])
        (z, _) = o.repeat(
            lambda s: o.number(0.5) < s[1],
            lambda s: [o.select(s[0] < x, product, s[0]), o.number(0.0) * x],
            [z, abs(x)],
            3,
        )
        return o.select(z < x, product, o.maximum(product, z))

    expected = []
    for x, y, z in zip(*ROW, strict=True):
        for _ in range(2):
            z = x * y if x < z else z
        z = x * y if abs(x) > 0.5 and z < x else z
        expected.append(x * y if z < x else max(x * y, z))

    assert valued(formula, kernels=kernels) == expected


def test_blocks_are_named_as_the_count_of_operations_reads_them():
    ops, x, y = traced()
    ops.repeat(lambda s: s[0] < y, lambda s: [s[0] + y], [x], 3)
    ops.when(x < y, [x], lambda: [y])
    labels = [line[:-1] for line in ops.lines if line.endswith(":")]

    assert [label.rstrip("0123456789") for label in labels] == ["head", "inside", "after", "inside", "after"]
    assert len(set(labels)) == 5
    assert (LLVMBackend().width, ops.q(7, 1).value) == (32, 7.0)


def test_what_is_written_when_a_scope_is_closed_belongs_to_the_one_around_it():
    ops, seen = LLVMBackend(8), []
    for _ in range(3):
        ops.open()
        seen.append(ops.scope)
    ops.close()

    assert len({0, *seen}) == 4
    assert ops.scope == seen[1]
    ops.close()
    assert ops.scope == seen[0]
    ops.close()
    assert ops.scope == 0


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


@pytest.mark.parametrize("kernels", [True, False], ids=["lanes", "arrays"])
def test_a_logarithm_or_a_root_of_a_negative_number_is_no_number(kernels):
    x = np.array([-1.0, -1e-300, -1e300, -2.5])
    with np.errstate(invalid="ignore"):
        logarithms, roots = (
            valued(lambda o, x, y, z, f=f: f(o, x), x, x, x, kernels)
            for f in (lambda o, x: o.log(x), lambda o, x: o.root(x, 3))
        )

    assert np.all(np.isnan(logarithms + roots))
    assert valued(lambda o, x, y, z: o.root(x, 3), *[np.zeros(4)] * 3, kernels) == [0.0] * 4
