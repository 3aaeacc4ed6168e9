"""Curvature, normals and evolutes agree with the paper's formulas and have the right invariances."""

import pytest
from sympy import Expr, Function, Matrix, Rational, S, cos, integrate, pi, simplify, sin, sqrt

from symbolic.expressions.signs import vanishes
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.geometry import curvature, evolute, normal, speed, tangent, turning, velocity
from symbolic.tables.table import Component, a, alpha, theta

COMPONENTS = [*circle.components, *ellipse.components, *cardioid.components, *cuspless.components, *egg(3).components]
CURVED = [c for c in COMPONENTS if c.name not in ("wall", "egg")]
ANGLES = [S.Zero, Rational(1, 3), Rational(-7, 5), Rational(2)]
SHAPE = {a: Rational(3, 2), alpha: Rational(1, 20)}


def identity(component: Component) -> str:
    return component.name


def at(expression: Expr, value: Expr) -> Expr:
    return expression.subs(SHAPE).subs(theta, value)


def test_the_polar_formula_of_the_paper_holds_for_an_undetermined_radius():
    rho = Function("rho", positive=True)(theta)
    first, second = rho.diff(theta), rho.diff(theta, 2)
    paper = -(rho**2 + 2 * first**2 - rho * second) / (rho**2 + first**2) ** Rational(3, 2)
    curve = Component("any", (rho * cos(theta), rho * sin(theta)), -pi, pi)

    assert simplify(curvature(curve) - paper) == 0


def test_the_ellipse_has_the_curvature_the_paper_prints():
    paper = -a / (a**2 * sin(theta) ** 2 + cos(theta) ** 2) ** Rational(3, 2)
    kappa = curvature(ellipse.components[0])

    assert simplify(kappa - paper) == 0
    assert simplify(kappa.subs(theta, 0)) == -a
    assert simplify(kappa.subs(theta, pi / 2)) == -1 / a**2


def test_the_cardioid_has_the_curvature_the_paper_prints():
    assert vanishes(curvature(cardioid.components[0]) + 3 / sqrt(8 * (1 + cos(theta))))


@pytest.mark.parametrize("K", [3, 5, 7])
def test_the_egg_has_the_extreme_curvatures_of_its_vertices_and_flats(K):
    kappa, n = curvature(egg(K).components[0]), 1 + K * K
    flat, vertex = (-(1 - sign * n * alpha) / (1 - sign * alpha) ** 2 for sign in (1, -1))

    for angle, expected in ((pi / K, flat), (S.Zero, vertex)):
        difference = kappa.subs(theta, angle) - expected
        assert all(simplify(difference.subs(alpha, Rational(k, 10 * n))) == 0 for k in range(11))


@pytest.mark.parametrize("component", COMPONENTS, ids=identity)
def test_tangent_and_inward_normal_form_a_right_handed_orthonormal_frame(component):
    T, n = tangent(component), normal(component)

    assert vanishes(T.dot(T) - 1)
    assert vanishes(T.dot(n))
    assert vanishes(T[0] * n[1] - T[1] * n[0] - 1)


@pytest.mark.parametrize("component", COMPONENTS, ids=identity)
def test_the_normal_points_into_the_table(component):
    inside = Matrix([Rational(1, 4), 0])  # every table here is star-shaped around this point
    middle = [component.start + (component.end - component.start) * Rational(k, 8) for k in (1, 3, 4, 6)]
    for value in middle:
        towards = (inside - Matrix(component.point)).dot(normal(component))

        assert at(towards, value).evalf(30) > 0


@pytest.mark.parametrize("component", COMPONENTS, ids=identity)
def test_frenet_the_tangent_turns_by_minus_the_curvature_per_length(component):
    for value in ANGLES[:3]:
        change = (tangent(component).diff(theta) + speed(component) * curvature(component) * normal(component)).subs(
            SHAPE
        )

        assert all(abs(entry.subs(theta, value).evalf(40)) < Rational(1, 10**35) for entry in change)


@pytest.mark.parametrize("component", COMPONENTS, ids=identity)
def test_running_the_other_way_changes_the_sign_of_the_curvature(component):
    x, y = (coordinate.subs(theta, -theta) for coordinate in component.point)
    back = Component("back", (x, y), -component.end, -component.start)

    assert vanishes(curvature(back).subs(theta, -theta) + curvature(component))


@pytest.mark.parametrize("table", [circle, cuspless], ids=lambda t: t.name)
def test_a_table_turns_by_two_pi_exactly(table):
    turns = [
        integrate(simplify(turning(c) / speed(c) ** 2), (theta, c.start, c.end)) for c in table.components
    ]  # fmt: skip

    assert simplify(sum(turns)) == 2 * pi


def test_the_evolute_of_the_cardioid_is_a_third_of_its_mirror_image():
    E = evolute(cardioid.components[0])
    opposite = Matrix(cardioid.components[0].point).subs(theta, theta + pi)

    assert all(vanishes(entry) for entry in E - (Matrix([Rational(2, 3), 0]) - opposite / 3))


def test_the_evolute_of_the_ellipse_is_a_stretched_astroid():
    expected = (a**2 - 1) * Matrix([cos(theta) ** 3 / a, -(sin(theta) ** 3)])

    assert all(vanishes(entry) for entry in evolute(ellipse.components[0]) - expected)


@pytest.mark.parametrize("component", CURVED, ids=identity)
def test_normals_are_tangent_to_the_evolute_and_reach_it_at_the_radius_of_curvature(component):
    E, (x, y) = evolute(component), velocity(component)
    along, arm = E.diff(theta), E - Matrix(component.point)

    assert vanishes(along[0] * x + along[1] * y)
    assert vanishes(arm.dot(Matrix([-y, x])) * turning(component) - x**2 * x**2 - 2 * x**2 * y**2 - y**2 * y**2)
