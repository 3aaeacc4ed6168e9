"""The exact bits of the kernels, stored once: starts, bounces and tangent vectors as hexadecimal floats.

Kernels set no fast-math flag, so their bits depend on no processor. The starts are stored as kernel fields because
NumPy's sine may round differently elsewhere. After an intended change of bits, write the file anew from the
repository's root: `python tests/numeric/test_golden_bits.py`.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from sympy import Rational, cos

from numeric import PinballMap
from numeric.kernels.machine import KernelSpec, starting
from numeric.pinball.sampling import phase_starts
from symbolic import tables
from symbolic.tables.table import theta

FILE = Path(__file__).parent / "golden_bits.json"
LENS = tables.piecewise(  # of two parabolas, which have no closed form of their own
    tables.arc("lower", theta, (theta**2 - 1) / 2, -1, 1),
    tables.arc("upper", -theta, (1 - theta**2) / 2, -1, 1),
    name="lens",
)
SCENES = {
    "circle": ("circle", {}),
    "ellipse": ("ellipse", {"a": "3/2"}),
    "cardioid": ("cardioid", {}),
    "cuspless": ("cuspless", {}),
    "egg": ("egg", {"alpha": "2/25"}),
    "limacon, not convex": (tables.polar(1 + Rational(3, 5) * cos(theta), name="limacon"), {}),
    "stadium": (tables.stadium(), {}),
    "lens, any boundary": (LENS, {}),
}
LAMS = {"slap": 0, "pinball": 0.7, "elastic": 1}
COUNT, BOUNCES = 6, 40
LAWS = {name: [*LAMS] if isinstance(table, str) else ["pinball"] for name, (table, _) in SCENES.items()}
CASES = [(scene, law) for scene, laws in LAWS.items() for law in laws]


def hexed(rows):
    return [[float(x).hex() for x in row] for row in rows]


def unhexed(rows):
    return [np.array([float.fromhex(x) for x in row]) for row in rows]


def begun(scene, law):
    """The fields of particles with random starts, and the numbers `N0` of their departures."""
    table, shape = SCENES[scene]
    map = PinballMap(table, lam=LAMS[law], **shape)
    starts = phase_starts(map, COUNT, seed=11)
    own = map.states.enter(starts.component, starts.theta, starts.phi * (law != "slap"), law)
    return {"own": hexed(own), "n0": hexed([map.states.exit_normal_speed(own, law)])}


def ended(scene, law, start):
    """All rows by name after one bounce, after many bounces, and after many bounces with a tangent vector."""
    table, shape = SCENES[scene]
    map = PinballMap(table, lam=LAMS[law], **shape)
    own, (n0,) = unhexed(start["own"]), unhexed(start["n0"])
    lam = np.full(COUNT, float(LAMS[law]))
    vector = starting(0.8 * n0, np.full(COUNT, 0.6), n0)
    step = map.engine.run(KernelSpec(law, record=True), own, lam, map.shape, 1)
    orbit = map.engine.run(KernelSpec(law, record=True), own, lam, map.shape, BOUNCES)
    growth = map.engine.run(KernelSpec(law, exponents=True), own, lam, map.shape, BOUNCES, vector)
    assert np.array_equal(orbit.record[0], step.record[0])
    return {
        "step": hexed(step.record[0]),
        "orbit": hexed(orbit.record[-1]),
        "exponents": dict(zip(growth.rows, hexed(growth.rows.values()), strict=True)),
    }


@pytest.fixture(scope="module")
def golden():
    """The content of the stored file."""
    return json.loads(FILE.read_text())


@pytest.mark.parametrize(("scene", "law"), CASES)
def test_no_bit_of_a_kernel_has_moved(golden, scene, law):
    entry = golden[f"{scene}, {law}"]

    assert ended(scene, law, entry["start"]) == entry["end"]


@pytest.mark.parametrize(("scene", "law"), CASES)
def test_fields_of_a_start_are_those_written_down_up_to_rounding(golden, scene, law):
    now, then = begun(scene, law), golden[f"{scene}, {law}"]["start"]

    for key in ("own", "n0"):
        assert np.allclose(unhexed(now[key]), unhexed(then[key]), rtol=0, atol=8 * 2.0**-52)


if __name__ == "__main__":
    written = {}
    for scene, law in CASES:
        start = begun(scene, law)
        written[f"{scene}, {law}"] = {"start": start, "end": ended(scene, law, start)}
    FILE.write_text(json.dumps(written, indent=1) + "\n")
