"""Laws of the symmetry groups: closed, complete on the paper's tables, and proved in the plane."""

import pytest
from sympy import Matrix, Rational, S, cos, eye, pi, simplify, sin

from symbolic.tables import arc, cardioid, circle, cuspless, egg, ellipse, piecewise, polar
from symbolic.tables.gallery import diamond, sinai, stadium
from symbolic.tables.geometry import group, order_of_rotation
from symbolic.tables.table import Table, alpha, theta

TABLES = (ellipse.at(a=2), cardioid, cuspless, egg(3).at(alpha="0.08"), egg(4).at(alpha="0.02"), egg(7))
PEAR = polar(1 / (9 + cos(theta)), name="pear")


def quarter_turned(table):
    """A turned table is one: that is not shown again."""
    x, y = table.components[0].point
    return Table(f"{table.name} a quarter turned", (arc("turned", -y, x, -pi, pi),))


TURNED = tuple(quarter_turned(table) for table in (ellipse.at(a=2), egg(3).at(alpha="0.08")))


@pytest.mark.parametrize("table", [*TABLES, *TURNED, circle, PEAR], ids=lambda table: table.name)
def test_a_symmetry_takes_the_point_at_a_parameter_to_the_point_at_its_image(table):
    for symmetry in group(table):
        for index, part in enumerate(table.components):
            image = table.components[symmetry.onto[index]]
            for value in (part.start + (part.end - part.start) * share for share in (Rational(1, 3), Rational(3, 5))):
                moved = symmetry.matrix * Matrix(part.at(value))
                there = Matrix(image.at(symmetry.sign * value + symmetry.shift[index]))
                assert max(abs(complex(x)) for x in (moved - there).subs(alpha, S(1) / 60).evalf(30)) < 1e-25


@pytest.mark.parametrize("table", [*TABLES, stadium(), sinai(), diamond()], ids=lambda table: table.name)
def test_two_symmetries_make_a_third(table):
    matrices = [symmetry.matrix for symmetry in group(table)]

    for left in matrices:
        for right in matrices:
            product = (left * right).evalf(20)
            assert any((product - m.evalf(20)).norm() < 1e-15 for m in matrices)


@pytest.mark.parametrize("table", [*TABLES, *TURNED, circle, PEAR], ids=lambda table: table.name)
def test_a_symmetry_is_a_rotation_or_a_reflection_and_its_shift_is_less_than_a_turn(table):
    for symmetry in group(table):
        assert simplify(symmetry.matrix.det()) == symmetry.sign
        line = f"reflection in the line at {symmetry.angle / 2}"
        assert symmetry.name == line if symmetry.sign < 0 else not symmetry.name.startswith("reflection")
        assert len(symmetry.onto) == len(symmetry.shift) == len(table.components)
        assert all(0 <= shift < 2 * pi for shift in (*symmetry.shift, symmetry.angle))


@pytest.mark.parametrize("table", [*TABLES, *TURNED, circle, PEAR], ids=lambda table: table.name)
def test_a_symmetry_permutes_the_components(table):
    for symmetry in group(table):
        assert sorted(symmetry.onto) == list(range(len(table.components)))


def test_turning_a_table_by_a_quarter_moves_its_mirrors_by_a_quarter():
    for table, turned in zip((ellipse.at(a=2), egg(3).at(alpha="0.08")), TURNED, strict=True):
        mirrors, moved = ({s.angle for s in group(t) if s.sign < 0} for t in (table, turned))

        assert moved == {(angle + pi) % (2 * pi) for angle in mirrors}


def test_the_symmetries_of_an_ellipse_are_named_by_what_they_do():
    assert [symmetry.name for symmetry in group(ellipse.at(a=2))] == [
        "identity",
        "rotation by pi",
        "reflection in the line at 0",
        "reflection in the line at pi/2",
    ]


def test_the_mirrors_of_a_rectangle_exchange_opposite_sides():
    sides = [(2 * theta, -S.One), (2 * S.One, theta), (-2 * theta, S.One), (-2 * S.One, -theta)]
    table = piecewise(*(arc(f"side {i}", x, y, -1, 1) for i, (x, y) in enumerate(sides)))

    found = {symmetry.name: (symmetry.sign, symmetry.onto, symmetry.shift) for symmetry in group(table)}
    assert found == {
        "identity": (1, (0, 1, 2, 3), (0, 0, 0, 0)),
        "rotation by pi": (1, (2, 3, 0, 1), (0, 0, 0, 0)),
        "reflection in the line at 0": (-1, (2, 1, 0, 3), (0, 0, 0, 0)),
        "reflection in the line at pi/2": (-1, (0, 3, 2, 1), (0, 0, 0, 0)),
    }


def test_a_trapezium_has_one_mirror_and_its_sides_are_run_through_backwards():
    sides = [(4 * theta - 2, S.Zero), (2 - theta, theta), (1 - 2 * theta, S.One), (-1 - theta, 1 - theta)]
    table = piecewise(*(arc(f"side {i}", x, y, 0, 1) for i, (x, y) in enumerate(sides)))
    same, mirror = group(table)

    assert (same.name, same.sign, same.matrix) == ("identity", 1, eye(2))
    assert (mirror.sign, mirror.angle, mirror.onto, mirror.shift) == (-1, pi, (0, 3, 2, 1), (1, 1, 1, 1))


def test_a_boundary_that_is_no_finite_sum_has_no_rotation_that_is_known_from_its_frequencies():
    assert order_of_rotation(PEAR.components[0]) == 1
    assert [symmetry.name for symmetry in group(PEAR)] == ["identity", "reflection in the line at 0"]


@pytest.mark.parametrize("K", [2, 3, 4, 5, 7, 12])
def test_the_egg_with_k_points_has_the_dihedral_group_of_the_k_gon(K):
    found = group(egg(K))

    assert [sum(symmetry.sign == sign for symmetry in found) for sign in (1, -1)] == [K, K]


def test_the_identity_comes_first():
    assert all(group(table)[0].matrix == eye(2) for table in TABLES)


def test_a_table_without_a_mirror_has_only_turns():
    twisted = polar(1 + sin(3 * theta) / 40 + cos(6 * theta) / 80 + sin(6 * theta) / 90)

    assert [symmetry.sign for symmetry in group(twisted)] == [1, 1, 1]


def test_a_turned_egg_has_its_mirrors_turned():
    turned = group(polar(1 + cos(3 * (theta - pi / 6)).expand(trig=True) / 20))

    assert {simplify(symmetry.angle) for symmetry in turned if symmetry.sign < 0} == {pi / 3, pi, 5 * pi / 3}


def test_a_turned_egg_with_an_even_number_of_points_has_its_mirrors_between_those_of_the_egg():
    turned = group(polar(1 + sin(4 * theta) / 60))

    assert {symmetry.angle for symmetry in turned if symmetry.sign < 0} == {pi * k / 4 for k in (1, 3, 5, 7)}


def test_the_circle_is_listed_by_the_symmetries_of_the_square():
    assert order_of_rotation(circle.components[0]) == 4
    assert len(group(circle)) == 8
