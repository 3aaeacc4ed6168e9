"""Rows of a tangent vector: bringing mantissas back changes how a number is written, not the number."""

import numpy as np
import pytest

from numeric.backends.scalars import ArrayBackend
from numeric.flights.circle import Circle
from numeric.flights.harmonic import Harmonic
from numeric.kernels.machine import FAR, TANGENT, KernelSpec, fields, rescaled, starting

SIZES = 2.0 ** np.array([-300, -101, -99, -1, 0, 1, 99, 101, 300])


def rows_with(**given):
    """A tangent vector of nine lanes, with some rows replaced."""
    one = np.ones(9)
    rows = dict(zip(TANGENT, [0.6 * one, -0.8 * one, 3 * one, one, one, 2 * one, 0.7 * one], strict=True))
    return list((rows | given).values())


def meaning(rows):
    """Logarithms to base 2 of the vector's two entries and of the product of cosines; the signs; `n0`."""
    q, omega, growth, up, down, volume, n0 = rows
    logs = [np.log2(abs(x)) + growth - np.log2(down) for x in (q, omega)]
    return [*logs, np.log2(up) - np.log2(down) + volume, np.sign(q), np.sign(omega), n0]


@pytest.mark.parametrize(
    "given",
    [
        {"shift": 0.6 * SIZES, "omega": -0.8 * SIZES},
        {"shift": 0.6 * SIZES},
        {"omega": -0.8 * SIZES},
        {"up": 1.3 * SIZES},
        {"down": 1.7 * SIZES},
        {"shift": 0.6 * SIZES, "up": 1.3 * SIZES[::-1], "down": 1.7 * SIZES[::-1]},
    ],
    ids=["vector", "shift", "omega", "up", "down", "all"],
)
def test_bringing_mantissas_back_changes_no_value(given):
    rows = rows_with(**given)
    new = rescaled(ArrayBackend(), rows)

    assert np.allclose(meaning(new), meaning(rows), rtol=0, atol=1e-12)
    size = np.maximum(abs(new[0]), abs(new[1]))
    for mantissa in (size, new[3], new[4]):
        assert np.all((mantissa >= 1 / FAR) & (mantissa <= FAR))


def test_only_lanes_that_are_far_away_are_brought_back():
    rows = rows_with(up=1.5 * SIZES)
    new = rescaled(ArrayBackend(), rows)
    far = (rows[3] < 1 / FAR) | (rows[3] > FAR)

    assert far.tolist() == [True, True, False, False, False, False, False, True, True]
    assert np.array_equal(new[3] != rows[3], far)
    assert np.all((new[3][far] >= 1) & (new[3][far] < 2))


def test_at_the_bounds_nothing_happens():
    bounds = np.array([FAR, 1 / FAR, FAR, 1 / FAR] + [1.0] * 5)
    for name in ("up", "down", "shift"):
        rows = rows_with(**{name: bounds}, omega=0.0 * bounds)
        assert all(np.array_equal(one, two) for one, two in zip(rescaled(ArrayBackend(), rows), rows, strict=True))


def test_a_vector_starts_with_no_growth_counted():
    q, omega, n0 = np.array([0.3, 0.0]), np.array([-2.0, 1.0]), np.array([0.5, 1.0])
    nought, one = [0.0, 0.0], [1.0, 1.0]

    assert [row.tolist() for row in starting(q, omega, n0)] == [[0.3, 0], [-2, 1], nought, one, one, nought, [0.5, 1]]


def test_a_question_has_a_name_and_rows():
    assert KernelSpec("slap").text == "slap"
    assert KernelSpec("pinball", record=True).text == "pinball-record"
    assert KernelSpec("pinball", told=("phi",), streams=True).text == "pinball-streams-phi"
    assert KernelSpec("elastic", record=True, exponents=True).text == "elastic-record-exponents"
    assert fields(Circle(), KernelSpec("pinball")) == ("theta", "phi")
    assert fields(Circle(), KernelSpec("slap", exponents=True)) == ("theta", *TANGENT)
    assert (Circle.stops, Harmonic.stops) == (False, True)
