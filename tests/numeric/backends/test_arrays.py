"""Arrays as an arithmetic: the words, the emulated fused product, and loops that leave finished elements alone."""

import math
from fractions import Fraction

import numpy as np
import pytest

from numeric.backends.scalars import ArrayBackend

OPS = ArrayBackend()
PI_TAIL = 1.2246467991473532e-16  # pi less its double


def test_numbers_are_doubles():
    assert (OPS.q(1, 3), OPS.q(7, 1), OPS.number(0.1)) == (1 / 3, 7.0, 0.1)
    assert (OPS.pi, OPS.pi_low) == (math.pi, PI_TAIL)


def test_signs():
    y = np.array([1.0, -1.0, 0.0, -0.0])

    assert [math.copysign(1, x) for x in OPS.times_sign(-2.0, y)] == [-1, 1, -1, 1]
    assert OPS.with_sign(np.array([-2.0] * 4), y).tolist() == [2, -2, 2, -2]


@pytest.mark.parametrize("size", [1.0, 1e-9, 1e9])
def test_the_emulated_fused_product_is_rounded_once(size):
    """Where the sum does not cancel: one rounding, up to the rounding of the correction."""
    rng = np.random.default_rng(4)
    x, y, z = rng.normal(size=(3, 400)) * np.array([[1.0], [1.0], [size]])
    z[::2] = -(x * y)[::2] * (1 + 1e-12 * rng.normal(size=200))
    found = OPS.fma(x, y, z).tolist()
    truth = [Fraction(a) * Fraction(b) + Fraction(c) for a, b, c in zip(*(r.tolist() for r in (x, y, z)), strict=True)]

    assert sum(f == float(t) for f, t in zip(found, truth, strict=True)) >= 398
    assert all(abs(Fraction(f) - t) <= 2.0**-52 * abs(t) for f, t in zip(found, truth, strict=True))
    assert OPS.product(3.0, 0.1) == 3.0 * 0.1


def test_what_a_product_loses_is_exact():
    """Also of mantissas of ones, and of those next to where they are cut in halves."""
    ends = [2 - 2.0**-52, 1 + 2.0**-52, 1 + 2.0**-26 + 2.0**-52, 1 + 2.0**-27 - 2.0**-52, 2 - 2.0**-26, 4 / 3, 1.1]
    rng = np.random.default_rng(6)
    x = np.concatenate([np.repeat(ends, len(ends)), rng.uniform(1, 2, 2000)])
    y = np.concatenate([np.tile(ends, len(ends)), rng.uniform(1, 2, 2000)])
    lost = OPS.fma(x, y, -x * y).tolist()
    for a, b, c in zip(x.tolist(), y.tolist(), lost, strict=True):
        assert Fraction(a) * Fraction(b) == Fraction(a * b) + Fraction(c)


def test_the_power_of_two_below_a_number():
    x = np.array([1e-300, 0.49, 0.5, 1.0, 1.5, 2.0, 1023.0, 1e300])
    inverse, exponent = OPS.power_of_two(x)

    assert inverse.tolist() == [2.0**-e for e in exponent.tolist()]
    assert np.all((x * inverse >= 1) & (x * inverse < 2))


def test_a_loop_leaves_finished_elements_alone_and_ends_at_its_limit():
    start = np.array([0.0, 3.0, 100.0])
    passes = []

    def halved(state):
        passes.append(1)
        return [state[0] / 2, state[1] + 1]

    size, count = OPS.repeat(lambda state: state[0] > 1, halved, [start, np.zeros(3)], 4)

    assert (size.tolist(), count.tolist()) == ([0, 0.75, 6.25], [0, 2, 4])
    assert len(passes) == 4
    OPS.repeat(lambda state: state[0] > 1, halved, [start[:2], np.zeros(2)], 99)
    assert len(passes) == 4 + 2


def test_a_branch_is_taken_where_its_mask_holds_anywhere():
    assert OPS.when(np.array([False, True]), [1], lambda: [2]) == [2]
    assert OPS.when(np.array([False, False]), [1], lambda: [2]) == [1]


def test_a_turn_is_two_quarters_unless_one_is_enough():
    x = np.array([-3.0, -1.0, 0.5, 2.0])
    (c, s), (one, _) = OPS.turn(x), OPS.turn(x[1:3], 1)

    assert np.allclose([c, s], [np.cos(x), np.sin(x)], rtol=0, atol=2.0**-52)
    assert np.allclose(one, np.cos(x[1:3]), rtol=0, atol=2.0**-52)
    assert np.allclose(OPS.angle(x, np.ones(4)), np.arctan(x), rtol=0, atol=2.0**-52)
