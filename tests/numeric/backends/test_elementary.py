"""Elementary functions of arrays: 50 digits, ends of ranges, and equal bits on other instruction sets."""

import os
import subprocess
import sys

import mpmath
import numpy as np
import pytest

from numeric.backends import elementary

MP = mpmath.MPContext()
MP.dps = 50
RNG = np.random.default_rng(5)
ARGUMENTS = {
    "arcsin": np.concatenate([RNG.uniform(-1, 1, 400), 1 - np.logspace(-16, -1, 50), np.logspace(-300, -1, 50)]),
    "arctan": np.concatenate([RNG.normal(size=400) * 5, np.logspace(-300, 300, 50)]),
    "exp": np.concatenate([RNG.uniform(-700, 709, 400), RNG.normal(size=400)]),
    "log": np.concatenate([RNG.uniform(0, 3, 400), np.logspace(-320, 308, 100), 1 + np.logspace(-15, -1, 50)]),
    "sinh": np.concatenate([RNG.normal(size=400) * 5, np.logspace(-300, 2, 50)]),
    "cosh": RNG.normal(size=400) * 5,
    "tanh": np.concatenate([RNG.normal(size=400) * 5, np.logspace(-300, 2, 50)]),
}
TRUTH = {"arcsin": "asin", "arctan": "atan"}


@pytest.mark.parametrize("word", ARGUMENTS)
def test_it_errs_by_less_than_three_units_in_the_last_place(word):
    x = ARGUMENTS[word]
    found = getattr(elementary, word)(x)
    truth = [getattr(MP, TRUTH.get(word, word))(float(a)) for a in x]

    units = [abs(float(b) - a) / float(np.spacing(abs(float(a)))) for a, b in zip(truth, found, strict=True)]
    assert max(units) <= 3


def test_a_root_errs_by_less_than_two_units_in_the_last_place():
    x = np.logspace(-300, 300, 300)
    for n in (3, 5):
        truth = [MP.root(float(a), n) for a in x]
        found = elementary.root(x, n)
        assert max(abs(float(b) / a - 1) for a, b in zip(truth, found, strict=True)) <= 2.0**-51


def test_an_angle_is_right_in_every_quarter_and_at_its_ends():
    y, x = RNG.normal(size=(2, 400))
    truth = [MP.atan2(float(a), float(b)) for a, b in zip(y, x, strict=True)]
    assert max(abs(float(b) / a - 1) for a, b in zip(truth, elementary.arctan2(y, x), strict=True)) <= 3 * 2.0**-52

    ends = [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 0.0)]
    assert [float(elementary.arctan2(*end)) for end in ends] == [0.0, np.pi, np.pi / 2, -np.pi / 2, 0.0]


def test_the_ends_of_ranges_are_those_of_numpy():
    with np.errstate(all="ignore"):
        for word, x in {"log": [0.0, -1.0, np.inf, np.nan, 1.0], "exp": [-np.inf, np.inf, np.nan, 0.0, 720.0]}.items():
            assert np.array_equal(getattr(elementary, word)(x), getattr(np, word)(x), equal_nan=True)
        assert np.isnan(elementary.arcsin([1.5, -2.0, np.nan])).all()
    assert isinstance(elementary.log(2.0), float)


BITS = """
import hashlib
import numpy as np
from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.exponents import angles
from numeric.dynamics.phase_points import phase_points
from numeric.pinball.sampling import interior_starts, phase_starts

rng = np.random.default_rng(1)
x = rng.uniform(-1, 1, 20_000)
made = [getattr(elementary, word)(np.abs(x) if word == "log" else x)
        for word in ("arcsin", "arctan", "exp", "log", "sinh", "cosh", "tanh")]
made += [elementary.root(np.abs(x), 3), elementary.arctan2(x, x[::-1])]
for map in (PinballMap("egg", lam=0.6, alpha=0.08), PinballMap("cardioid", lam=0.4), PinballMap("cuspless", lam=0.3)):
    for starts in (interior_starts(map, 40, 3), phase_starts(map, 40, 3)):
        orbit = map.orbit(starts.theta, starts.phi, 60, starts.component)
        made += [starts.theta, starts.phi, orbit.x[-1], orbit.phi[-1]]
    made.append(angles(map, phase_points(starts.theta[:4], starts.phi[:4], starts.component[:4]), 20, 100))
print(*(hashlib.sha256(np.ascontiguousarray(part).tobytes()).hexdigest() for part in made))
"""


@pytest.mark.slow
def test_starts_and_chaotic_orbits_are_the_same_to_the_bit_without_wide_registers(fewer):
    """With all instructions, without AVX-512, and without AVX2, in NumPy and OpenBLAS."""
    said = [
        subprocess.run(
            [sys.executable, "-c", BITS], env=os.environ | less, capture_output=True, text=True, check=True
        ).stdout
        for less in ({}, *fewer.values())
    ]

    assert len(said[0].split()) > 30
    assert said[0] == said[1] == said[2]
