"""Elementary functions and root finding, against 50 digits and on labelled pathologies."""

import mpmath
import numpy as np
import pytest

from numeric.backends.functions import angle, bracketed_zero, polynomial_zero, turn, value_and_slope
from numeric.backends.scalars import ArrayBackend

EPS = 2.0**-52
MP = mpmath.MPContext()
MP.dps = 50
OPS = ArrayBackend()


WHOLE = np.concatenate([np.linspace(-np.pi, np.pi, 1501), np.geomspace(1e-300, 1, 200)])
QUARTER = np.concatenate([np.linspace(-np.pi / 2, np.pi / 2, 601), [np.pi / 4, np.nextafter(np.pi / 4, 1), 0.0]])


@pytest.mark.parametrize(("x", "quarters"), [(WHOLE, ()), (QUARTER, (1,))], ids=["whole turns", "one quarter"])
def test_sine_and_cosine_err_by_less_than_a_unit(x, quarters):
    c, s = turn(OPS, x, *quarters)

    assert max(abs(MP.cos(float(a)) - float(b)) for a, b in zip(x, c, strict=True)) <= 0.8 * EPS
    assert max(abs(MP.sin(float(a)) - float(b)) for a, b in zip(x, s, strict=True)) <= 0.8 * EPS


def test_a_small_turn_is_relatively_exact():
    x = np.geomspace(1e-300, 0.5, 300)
    _, s = turn(OPS, x, 1)

    assert max(abs(MP.sin(float(a)) / float(b) - 1) for a, b in zip(x, s, strict=True)) <= EPS


def test_the_angle_is_relatively_exact_in_every_octant():
    t = np.concatenate([np.linspace(-np.pi / 2, np.pi / 2, 1501), np.geomspace(1e-300, 1, 200)])
    y, x = 3 * np.sin(t), 3 * np.abs(np.cos(t))
    found = angle(OPS, y, x)
    truth = [MP.atan2(float(a), float(b)) for a, b in zip(y, x, strict=True)]

    assert max(abs(a - float(b)) / max(abs(a), 1e-3) for a, b in zip(truth, found, strict=True)) <= 1.5 * EPS


PATHOLOGIES = {  # coefficients (constant first), interval, start, zero
    "a triple zero": ([-1.0, 3.0, -3.0, 1.0], (-5.0, 7.0), 0.0, 1.0),
    "newton cycles between 0 and 1": ([2.0, -2.0, 0.0, 1.0], (-4.0, 4.0), 0.0, -1.7692923542386314),
    "three zeros, the bracket holds the first": ([-6.0, 11.0, -6.0, 1.0], (0.0, 1.5), 2.9, 1.0),
    "a zero at an end": ([-1.0, 1.0], (0.0, 1.0), 0.5, 1.0),
    "a flat start": ([-1.0, 0.0, 0.0, 1.0], (-10.0, 10.0), 0.0, 1.0),
    "a huge interval": ([-1e-12, 1.0], (-1e18, 1e18), 1e17, 1e-12),
    "a start that is no number": ([-2.0, 0.0, 1.0], (0.0, 9.0), np.nan, 2**0.5),
}


@pytest.mark.parametrize("case", PATHOLOGIES)
def test_the_bracketed_zero_is_found(case):
    p, (low, high), start, zero = PATHOLOGIES[case]
    with np.errstate(all="ignore"):
        x = polynomial_zero(
            OPS, [np.array([c]) for c in p], np.array([start]), np.array([low]), np.array([high]), 1.0, (0, 3)
        )
    multiplicity = 3 if case == "a triple zero" else 1

    assert abs(x[0] - zero) <= 4 * EPS ** (1 / multiplicity) * max(1, abs(zero))


@pytest.mark.parametrize(("low", "high", "zero"), [(-2.0, 3.0, 1.0), (-9.0, 0.5, -3.0), (2.0, 99.0, 5.0)])
@pytest.mark.parametrize("newton", [0, 6])
def test_the_zero_inside_is_found_wherever_newton_ends(low, high, zero, newton):
    """For `-(x + 3)(x - 1)(x - 5)` or its negative; a Newton step out of the bracket is replaced by bisection."""
    sign, start = -1 if zero == 1 else 1, np.linspace(-10, 10, 100)

    def cubic(x):
        return tuple(sign * part for part in value_and_slope([15.0, -13.0, -3.0, 1.0], x))

    with np.errstate(all="ignore"):
        x = bracketed_zero(OPS, cubic, start, np.full(100, low), np.full(100, high), 1.0, newton)

    assert np.max(np.abs(x - zero)) <= 8 * EPS
