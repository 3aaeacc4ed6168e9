"""Elementary functions and root finding, against 50 digits and on labelled pathologies."""

import mpmath
import numpy as np
import pytest

from numeric.backends.functions import angle, exact_cross, halley, polynomial_zero, turn, unit, value_and_slope
from numeric.backends.scalars import ArrayBackend

EPS = 2.0**-52
MP = mpmath.MPContext()
MP.dps = 50
OPS = ArrayBackend()


def test_sine_and_cosine_err_by_less_than_a_unit():
    x = np.concatenate([np.linspace(-np.pi, np.pi, 1501), np.geomspace(1e-300, 1, 200)])
    c, s = turn(OPS, x)

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


def test_the_difference_of_products_survives_cancellation():
    rng = np.random.default_rng(3)
    z = rng.normal(size=(2, 500))
    w = z * (1 + 1e-15 * rng.normal(size=(2, 500)))
    found = exact_cross(OPS, (z[0], z[1]), (w[0], w[1]))
    for i in range(500):
        truth = MP.mpf(z[0, i]) * MP.mpf(w[1, i]) - MP.mpf(z[1, i]) * MP.mpf(w[0, i])
        assert abs(found[i] - truth) <= 2 * EPS * abs(truth)


def test_the_emulated_fused_product_is_exact_to_a_rounding():
    rng = np.random.default_rng(4)
    x, y = rng.normal(size=(2, 500))
    z = -x * y
    found = OPS.fma(x, y, z)
    truth = [MP.mpf(a) * MP.mpf(b) + MP.mpf(c) for a, b, c in zip(x, y, z, strict=True)]

    assert all(abs(a - b) <= EPS * abs(b) for a, b in zip(found.tolist(), truth, strict=True))


def test_renormalising_a_unit_vector_leaves_its_direction():
    t = np.linspace(0, 6, 100)
    z = np.cos(t) * (1 + 1e-14), np.sin(t) * (1 + 1e-14)
    x, y = unit(OPS, z)

    assert np.max(np.abs(x * x + y * y - 1)) <= 2 * EPS
    assert np.max(np.abs(x * z[1] - y * z[0])) <= 2 * EPS


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


def test_one_step_of_halley_is_of_third_order():
    p = [MP.mpf(c) for c in (-2, 0, 0, 1)]
    zero = MP.mpf(2) ** (MP.mpf(1) / 3)
    errors = [abs(halley(p, zero + h) - zero) for h in (MP.mpf("1e-6"), MP.mpf("1e-8"))]

    assert 5.9 < MP.log10(errors[0] / errors[1]) < 6.1


def test_value_and_slope_are_those_of_the_polynomial():
    assert value_and_slope([1, 2, 3, 4], 2) == (1 + 4 + 12 + 32, 2 + 12 + 48)


def test_a_turn_of_one_quarter_serves_the_whole_quarter():
    x = np.concatenate([np.linspace(-np.pi / 2, np.pi / 2, 601), [np.pi / 4, np.nextafter(np.pi / 4, 1), 0.0]])
    c, s = turn(OPS, x, 1)

    assert max(abs(MP.cos(float(a)) - float(b)) for a, b in zip(x, c, strict=True)) <= 0.8 * EPS
    assert max(abs(MP.sin(float(a)) - float(b)) for a, b in zip(x, s, strict=True)) <= 0.8 * EPS


def test_the_angle_of_the_axes_and_of_the_diagonal():
    y, x = np.array([0.0, 2.0, -2.0, 3.0, -3.0, -0.0]), np.array([5.0, 0.0, 0.0, 3.0, 3.0, 1.0])

    assert angle(OPS, y, x).tolist() == [0.0, np.pi / 2, -np.pi / 2, np.pi / 4, -np.pi / 4, 0.0]
    assert np.signbit(angle(OPS, y, x)).tolist() == [False, False, True, False, True, True]
