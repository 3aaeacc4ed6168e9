"""Symmetry groups of tables: closed, complete for the paper's tables, and verified on the curves."""

import pytest
from sympy import Matrix, Rational, S, cos, exp, pi, simplify, sin, sqrt

from symbolic.tables import arc, cardioid, circle, cuspless, egg, ellipse, polar
from symbolic.tables.gallery import diamond, sinai, stadium
from symbolic.tables.geometry import group
from symbolic.tables.table import Table, alpha, theta

TABLES = (ellipse.at(a=2), cardioid, cuspless, egg(3).at(alpha="0.08"), egg(4).at(alpha="0.02"), egg(7))
PEAR = polar(1 / (9 + cos(theta)), name="pear")
BONE = polar(exp(cos(2 * theta) / 8), name="bone")


def quarter_turned(table):
    """The table turned by 90 degrees."""
    x, y = table.components[0].point
    return Table(f"{table.name} a quarter turned", (arc("turned", -y, x, -pi, pi),))


TURNED = tuple(quarter_turned(table) for table in (ellipse.at(a=2), egg(3).at(alpha="0.08")))


@pytest.mark.slow
@pytest.mark.parametrize("table", [*TABLES, *TURNED, circle, PEAR, BONE], ids=lambda table: table.name)
def test_a_symmetry_takes_the_point_at_a_parameter_to_the_point_at_its_image(table):
    for symmetry in group(table):
        for index, part in enumerate(table.components):
            image = table.components[symmetry.onto[index]]
            for value in (part.start + (part.end - part.start) * share for share in (Rational(1, 3), Rational(3, 5))):
                moved = symmetry.matrix * Matrix(part.at(value))
                there = Matrix(image.at(symmetry.sign * value + symmetry.shift[index]))
                assert max(abs(complex(x)) for x in (moved - there).subs(alpha, S(1) / 60).evalf(30)) < 1e-25


@pytest.mark.slow
@pytest.mark.parametrize("table", [*TABLES, BONE, stadium(), sinai(), diamond()], ids=lambda table: table.name)
def test_two_symmetries_make_a_third(table):
    matrices = [symmetry.matrix for symmetry in group(table)]

    for left in matrices:
        for right in matrices:
            product = (left * right).evalf(20)
            assert any((product - m.evalf(20)).norm() < 1e-15 for m in matrices)


@pytest.mark.parametrize("table", [*TABLES, *TURNED, circle, PEAR, BONE], ids=lambda table: table.name)
def test_a_symmetry_is_a_rotation_or_a_reflection_and_its_shift_is_less_than_a_turn(table):
    for symmetry in group(table):
        assert simplify(symmetry.matrix.det()) == symmetry.sign
        line = f"reflection in the line at {symmetry.angle / 2}"
        assert symmetry.name == line if symmetry.sign < 0 else not symmetry.name.startswith("reflection")
        assert len(symmetry.onto) == len(symmetry.shift) == len(table.components)
        assert all(0 <= shift < 2 * pi for shift in (*symmetry.shift, symmetry.angle))


@pytest.mark.parametrize("K", [2, 3, 4, 5, 7, 12])
def test_the_egg_with_k_points_has_the_dihedral_group_of_the_k_gon(K):
    found = group(egg(K))

    assert [sum(symmetry.sign == sign for symmetry in found) for sign in (1, -1)] == [K, K]


@pytest.mark.slow
@pytest.mark.parametrize("K", [2, 3, 5])
@pytest.mark.parametrize("shaped", [lambda x: exp(x / 30), lambda x: 1 / (9 + x), lambda x: sqrt(9 + x)])
def test_a_radius_that_is_no_finite_sum_has_the_symmetries_of_the_wave_in_it(K, shaped):
    found = group(polar(shaped(cos(K * theta))))

    assert [sum(symmetry.sign == sign for symmetry in found) for sign in (1, -1)] == [K, K]
    assert len(group(polar(shaped(cos(K * theta) + cos((K + 1) * theta) / 40)))) == 2


def test_a_table_without_a_mirror_has_only_turns():
    twisted = polar(1 + sin(3 * theta) / 40 + cos(6 * theta) / 80 + sin(6 * theta) / 90)

    assert [symmetry.sign for symmetry in group(twisted)] == [1, 1, 1]
