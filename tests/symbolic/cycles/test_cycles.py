"""Cycles and their monodromy: what depends on the base point, what does not, and what the paper prints."""

import pytest
from sympy import Matrix, Rational, S, cancel, pi, simplify, sqrt

from symbolic.cycles.cycle import (
    Cycle,
    cardioid_vertical,
    cuspless_horizontal,
    cuspless_vertical,
    diameter,
    discriminant,
    egg_diameter,
    egg_parallel,
    egg_triangle,
    flight_matrix,
    is_double_normal,
    is_elastic,
    major_axis,
    minor_axis,
    monodromy,
    multipliers,
    parallel_shape,
    trace_and_determinant,
)
from symbolic.expressions.signs import vanishes
from symbolic.motion.collision import derivative_matrix
from symbolic.tables import circle, egg, ellipse
from symbolic.tables.table import a, alpha, lam

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


@pytest.mark.parametrize("cycle", QUICK, ids=identity)
def test_trace_and_determinant_do_not_depend_on_the_base_point(cycle):
    first = monodromy(cycle)
    for base in range(1, len(cycle.bounces)):
        other = monodromy(cycle, base)

        assert cancel(other.trace() - first.trace()) == 0
        assert cancel(other.det() - first.det()) == 0


@pytest.mark.parametrize("cycle", QUICK, ids=identity)
def test_monodromies_at_neighbouring_bounces_are_conjugate_by_the_flight_between_them(cycle):
    flight = flight_matrix(cycle, 0)

    assert is_zero(monodromy(cycle, 1) * flight - flight * monodromy(cycle, 0))


@pytest.mark.parametrize("cycle", DOUBLE_NORMALS, ids=identity)
def test_double_normals_contract_area_by_lambda_to_the_period(cycle):
    assert is_double_normal(cycle)
    assert is_elastic(cycle)
    assert cancel(monodromy(cycle).det() - lam ** len(cycle.bounces)) == 0


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


def test_lengths_are_those_of_the_tables():
    assert [c.length(0) for c in (diameter(), major_axis(), minor_axis(), egg_diameter(3))] == [2, 2 * a, 2, 2]
    assert cuspless_horizontal().length(0) == Rational(9, 4)
    assert egg_diameter(4).length(0) == 2 + 2 * alpha
    assert simplify(egg_triangle(True).length(0) - sqrt(3) * (1 - alpha)) == 0


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


def test_the_slap_map_of_a_cycle_has_one_multiplier_zero():
    for cycle in DOUBLE_NORMALS[:6]:
        assert monodromy(cycle, 0, S.Zero).row(1) == Matrix([[0, 0]])


@pytest.mark.parametrize("angle", [2 * pi / 3, -2 * pi / 3])
def test_the_images_of_a_diameter_by_the_symmetry_have_its_monodromy(angle):
    assert is_zero(monodromy(egg_diameter(3, angle)) - monodromy(egg_diameter(3)))


def test_cycles_of_the_egg_at_alpha_zero_are_those_of_the_circle():
    assert is_zero(monodromy(egg_diameter(3)).subs(alpha, 0) - monodromy(diameter()))


def test_the_parallel_tangents_of_the_egg_are_horizontal():
    c = next(iter(parallel_shape().free_symbols))
    shape = parallel_shape().subs(c, Rational(-1, 9))
    table = egg(3).at(alpha=shape)
    cycle = egg_parallel()

    assert all(frame.tangent[1] == 0 or vanishes(frame.tangent[1]) for frame in cycle.frames)
    assert 0 < shape < Rational(1, 10)
    assert table.fixed[0][1] == shape


def test_vieta():
    trace, det = trace_and_determinant(minor_axis())
    plus, minus = multipliers(trace, det)

    assert simplify(plus + minus - trace) == 0
    assert simplify(plus * minus - det) == 0
    assert simplify((plus - minus) ** 2 - discriminant(trace, det)) == 0


def test_in_the_circle_a_chord_makes_the_same_angle_at_both_its_ends():
    """Arcs of 60, 120 and 180 degrees: chords of length 1, sqrt(3), 2, whose cosines are half of that."""
    cycle = Cycle("scalene", circle, ((0, S.Zero), (0, pi / 3), (0, pi)))
    lengths, sines = [S.One, sqrt(3), S(2)], [sqrt(3) / 2, S.Half, S.Zero]

    for i in range(3):
        assert cycle.length(i) == lengths[i]
        assert (cycle.cos_exit(i), cycle.cos_incidence(i)) == (lengths[i] / 2, lengths[i - 1] / 2)
        assert cycle.sliding(i) == (sines[i], sines[i - 1])
        same = {"t": lengths[i], "cos_phi0": lengths[i] / 2, "cos_eta1": lengths[i] / 2}
        assert is_zero(flight_matrix(cycle, i) - derivative_matrix(K0=-S.One, K1=-S.One, **same))
        assert is_zero(flight_matrix(cycle, i + 3) - flight_matrix(cycle, i))


def test_the_parallel_tangents_touch_at_mirror_images_away_from_the_axis():
    cycle = egg_parallel()
    (c,) = parallel_shape().free_symbols
    (x0, y0), (x1, y1) = (
        [coordinate.subs(c, Rational(-1, 9)) for coordinate in cycle.table.components[index].at(value)]
        for index, value in cycle.bounces
    )

    assert simplify(x0 - x1) == simplify(y0 + y1) == 0
    assert y0 > 1 > abs(x0)


def test_a_flight_takes_the_curvature_it_leaves_and_the_one_it_lands_on():
    """From `(2, 0)`, curvature -2, to `(0, 1)`, curvature -1/4, of the ellipse with `a = 2`."""
    cycle = Cycle("three of four vertices", ellipse.at(a=2), ((0, S.Zero), (0, pi / 2), (0, pi)))
    hand = derivative_matrix(K0=-S(2), K1=-Rational(1, 4), t=sqrt(5), cos_phi0=2 / sqrt(5), cos_eta1=1 / sqrt(5))

    assert is_zero(flight_matrix(cycle, 0) - hand)
