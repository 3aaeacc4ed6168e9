"""Cycles of area-preserving maps: the trace decides their type, and images have the type of the original."""

import json

import pytest
from click.testing import CliRunner

from symbolic import Scene, tables
from verification.app.commands.orbit import cycles_command
from verification.named.questions import find_cycles


def cycles(tmp_path, *words):
    path = tmp_path / "cycles.json"
    done = CliRunner().invoke(cycles_command, [*words, "--json", str(path)])
    assert done.exit_code == 0, done.output
    return json.loads(path.read_text())["cycles"], done.output


def test_no_cycle_passes_through_the_cusp_of_the_cardioid(tmp_path):
    """One cycle, in both directions, with multiplier 7.48925, by hand from `mu + 1/mu = 10*sqrt(10) - 24`."""
    found, _ = cycles(tmp_path, "cardioid", "--lam", "1", "--period", "3")
    three = [cycle for cycle in found if cycle["period"] == 3]

    assert [round(cycle["multipliers"][0]["real"], 5) for cycle in three] == [7.48925, 7.48925]
    assert {cycle["stability"] for cycle in three} == {"hyperbolic"}
    assert {cycle["winding"] for cycle in three} == {1, 2}
    assert found[0]["length"] == pytest.approx(3 * 3**0.5)  # the chord between theta = +-pi/3, there and back


def test_the_shortest_cycle_of_a_triangle_is_parabolic_both_ways_round(tmp_path):
    """The product of three reflections in the sides is a glide reflection, so both multipliers are exactly -1."""
    found, output = cycles(tmp_path, "triangle", "--lam", "1", "--period", "3")

    assert [cycle["stability"] for cycle in found] == ["parabolic", "parabolic"]
    assert all(cycle["multipliers"] == [{"real": -1.0, "imaginary": 0.0}] * 2 for cycle in found)
    assert not any(cycle["stable"] for cycle in found)
    assert [cycle["length"] for cycle in found] == pytest.approx([1.5, 1.5])  # the pedal triangle of sides 1/2
    assert output.count("parabolic") == 2


@pytest.mark.parametrize("seed", [1, 2])
def test_images_and_reversed_cycles_of_the_elastic_egg_have_one_stability(seed):
    found = find_cycles(Scene(tables.egg(3), alpha="2/25", lam=1), period=3, seed=seed)
    kinds = {}
    for cycle in found:
        kinds.setdefault(round(cycle.multipliers[0].real, 6), []).append(cycle)

    assert {len(alike) for alike in kinds.values()} <= {2, 6}
    for alike in kinds.values():
        assert len({cycle.multipliers for cycle in alike}) == 1
        assert len({cycle.stability for cycle in alike}) == 1
    assert {cycle.stability.name for cycle in found} == {"ELLIPTIC", "HYPERBOLIC"}
    assert not found.stable


def test_an_elastic_ellipse_has_an_elliptic_and_a_hyperbolic_diameter():
    """The trace for a diameter of length d and radius of curvature R is 2*(2*(1 - d/R)**2 - 1)."""
    found = find_cycles(Scene("ellipse", a="3/2", lam=1), period=2)
    traces = {cycle.stability.value: sum(cycle.multipliers).real for cycle in found}

    assert traces["elliptic"] == pytest.approx(4 * (1 - 2 / 2.25) ** 2 - 2)
    assert traces["hyperbolic"] == pytest.approx(4 * (1 - 3 / (2 / 3)) ** 2 - 2)
