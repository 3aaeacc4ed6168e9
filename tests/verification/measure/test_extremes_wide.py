"""The 80-bit reference functions are right to their last bits."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from verification.measure.extremes.kernels import PI, PI_LOW, WIDE, Wide, sharpened

pytestmark = pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="no 80-bit floats on this machine")
MP = mpmath.MPContext()
MP.dps = 40


def exact(x):
    high = float(x)
    return MP.mpf(high) + MP.mpf(float(x - np.longdouble(high)))


def near(found, truth):
    return abs(exact(found) - truth) <= 2 * WIDE * max(abs(truth), MP.mpf(2) ** -40)


@given(st.floats(-1, 1), st.floats(0, 1))
def test_angles_have_64_bits(y, x):
    found = Wide().angle(np.longdouble(y), np.longdouble(x))

    assert near(found, MP.atan2(MP.mpf(y), MP.mpf(x)))


@given(st.floats(-3.1, 3.1))
def test_turns_have_64_bits(x):
    c, s = Wide().turn(np.longdouble(x))

    assert near(c, MP.cos(MP.mpf(x)))
    assert near(s, MP.sin(MP.mpf(x)))


def test_pi_and_what_it_lacks_are_pi_to_twice_the_bits():
    assert abs(exact(PI) + exact(PI_LOW) - MP.pi) < MP.mpf(2) ** -122


@given(st.floats(0.1, 10))
def test_a_zero_is_sharpened_to_the_last_bit(square):
    rough = np.array([np.longdouble(np.sqrt(square))])
    root = sharpened(lambda x: (x * x - np.longdouble(square), 2 * x), rough, np.longdouble(1))

    assert near(root[0], MP.sqrt(MP.mpf(square)))
