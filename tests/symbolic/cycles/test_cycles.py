"""Cycles and their monodromy matrices: their dependence on the base point, and the values in the paper."""

import pytest
from sympy import Matrix, S, cancel, pi, simplify, sqrt

from symbolic.cycles.cycle import (
    Cycle,
    cardioid_vertical,
    cuspless_horizontal,
    cuspless_vertical,
    diameter,
    egg_diameter,
    egg_parallel,
    egg_triangle,
    flight_matrix,
    is_double_normal,
    is_elastic,
    major_axis,
    minor_axis,
    monodromy,
    trace_and_determinant,
)
from symbolic.expressions.signs import vanishes
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import circle, ellipse
from symbolic.tables.table import a, lam

DOUBLE_NORMALS = [
    diameter(), major_axis(), minor_axis(), cardioid_vertical(), cuspless_vertical(), cuspless_horizontal(),
    egg_diameter(3), egg_diameter(4), egg_parallel(),
]  # fmt: skip
TRIANGLES = [egg_triangle(at_flat) for at_flat in (True, False)]
QUICK = [cycle for cycle in DOUBLE_NORMALS + TRIANGLES if cycle.name != "parallel tangents"]


def identity(cycle: Cycle) -> str:
    return f"{cycle.table.name}-{cycle.name}"


def is_zero(matrix: Matrix) -> bool:
    return all(cancel(entry) == 0 or vanishes(entry) for entry in matrix)


@pytest.mark.slow
@pytest.mark.parametrize("cycle", QUICK, ids=identity)
def test_trace_and_determinant_do_not_depend_on_the_base_point(cycle):
    first = monodromy(cycle)
    for base in range(1, len(cycle.bounces)):
        other = monodromy(cycle, base)

        assert cancel(other.trace() - first.trace()) == 0
        assert cancel(other.det() - first.det()) == 0


@pytest.mark.slow
@pytest.mark.parametrize("cycle", QUICK, ids=identity)
def test_monodromies_at_neighbouring_bounces_are_conjugate_by_the_flight_between_them(cycle):
    flight = flight_matrix(cycle, 0)

    assert is_zero(monodromy(cycle, 1) * flight - flight * monodromy(cycle, 0))


@pytest.mark.slow
@pytest.mark.parametrize("cycle", DOUBLE_NORMALS, ids=identity)
def test_double_normals_contract_area_by_lambda_to_the_period(cycle):
    assert is_double_normal(cycle)
    assert is_elastic(cycle)
    assert cancel(monodromy(cycle).det() - lam ** len(cycle.bounces)) == 0


@pytest.mark.slow
@pytest.mark.parametrize("cycle", TRIANGLES, ids=["flats", "vertices"])
def test_triangles_are_elastic_cycles_and_no_double_normals(cycle):
    assert is_elastic(cycle)
    assert not is_double_normal(cycle)
    assert simplify(monodromy(cycle, 0, S.One).det()) == 1
    assert cycle.cos_exit(0) == cycle.cos_incidence(0) == sqrt(3) / 2


def test_a_chord_that_is_no_diameter_is_no_cycle():
    for cycle in (
        Cycle("chord", circle, ((0, S.Zero), (0, pi / 2))),
        Cycle("chord", ellipse, ((0, S.Zero), (0, pi / 2))),
    ):
        assert not is_double_normal(cycle)
        assert not is_elastic(cycle)


def test_the_cuspless_matrix_of_the_paper_is_that_of_the_bounce_opposite_the_wall():
    paper = Matrix([[-4 * (27 * lam + 11), 144 * (lam + 1)], [33 * lam * (lam + 1), -4 * lam * (11 * lam + 27)]]) / 64

    assert is_zero(monodromy(cuspless_horizontal(), 1) - paper)
    assert not is_zero(monodromy(cuspless_horizontal(), 0) - paper)


def test_the_minor_axis_has_the_trace_of_the_paper():
    P1 = (a**2 - 2) ** 2 * lam**2 - 8 * (a**2 - 1) * lam + (a**2 - 2) ** 2

    assert cancel(monodromy(minor_axis()).trace() - P1 / a**4) == 0


def test_a_diameter_of_the_circle_has_the_multipliers_one_and_lambda_squared():
    trace, det = trace_and_determinant(diameter())

    assert simplify(trace - (1 + lam**2)) == 0
    assert simplify(det - lam**2) == 0


def test_in_the_circle_a_chord_makes_the_same_angle_at_both_its_ends():
    """Arcs of 60, 120 and 180 degrees have chords 1, sqrt(3) and 2, and the cosines are half of these."""
    cycle = Cycle("scalene", circle, ((0, S.Zero), (0, pi / 3), (0, pi)))
    lengths, sines = [S.One, sqrt(3), S(2)], [sqrt(3) / 2, S.Half, S.Zero]

    for i in range(3):
        assert cycle.length(i) == lengths[i]
        assert (cycle.cos_exit(i), cycle.cos_incidence(i)) == (lengths[i] / 2, lengths[i - 1] / 2)
        assert cycle.sliding(i) == (sines[i], sines[i - 1])
        same = {"t": lengths[i], "cos_phi0": lengths[i] / 2, "cos_eta1": lengths[i] / 2}
        assert is_zero(flight_matrix(cycle, i) - derivative_matrix(K0=-S.One, K1=-S.One, **same))
        assert is_zero(flight_matrix(cycle, i + 3) - flight_matrix(cycle, i))
