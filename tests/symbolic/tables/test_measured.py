"""Tables from data: splines, Fourier sums and paths are exact, and state how far the body may be from them."""

from fractions import Fraction
from itertools import pairwise

import pytest
from sympy import Rational, cos, expand, pi, sin

from symbolic import Scene, tables
from symbolic.tables.outlines import area
from symbolic.tables.polynomial import as_bezier, elevated, signed_area
from symbolic.tables.table import theta
from symbolic.tables.validity import enclosed_area

OVAL = [("1.5", "0"), ("1.2", "0.61"), ("0.31", "0.98"), ("-0.73", "0.87"), ("-1.4", "0.33"),
        ("-1.41", "-0.3"), ("-0.7", "-0.9"), ("0.3", "-1"), ("1.23", "-0.58")]  # fmt: skip


def on_an_ellipse(count):
    """Rational points of the ellipse with half axes 2 and 1, in order."""
    quarter = [Fraction(k, count) for k in range(count)]
    first = [(2 * (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)) for t in quarter]
    for _ in range(3):
        first = [*first, *((-2 * y, x / 2) for x, y in first[-count:])]
    return [(Rational(x.numerator, x.denominator), Rational(y.numerator, y.denominator)) for x, y in first]


def derivative(component, order, end):
    return [coordinate.diff(theta, order).subs(theta, end) for coordinate in component.point]


def test_a_cubic_spline_has_continuous_curvature_exactly_and_passes_the_points_within_its_residual():
    table = tables.from_points(OVAL)
    ring = [*table.components, table.components[0]]
    for before, after in pairwise(ring):
        assert before.at(1) == after.at(0)
        (x, y), (u, v) = derivative(before, 1, 1), derivative(after, 1, 0)
        ratio = x / u
        assert ratio.is_Rational
        assert y == ratio * v
        assert derivative(before, 2, 1) == [ratio**2 * c for c in derivative(after, 2, 0)]
    for component, (x, y) in zip(table.components, OVAL, strict=True):
        p, q = component.at(0)
        assert (p - Rational(x)) ** 2 + (q - Rational(y)) ** 2 <= table.fit.residual**2 < Rational(1, 10**30)


@pytest.mark.parametrize("smoothness", [0, 1])
def test_rougher_splines_pass_the_points_exactly(smoothness):
    table = tables.from_points(OVAL, smoothness=smoothness)
    assert [component.at(0) for component in table.components] == [(Rational(x), Rational(y)) for x, y in OVAL]
    for before, after in pairwise(table.components):
        (x, y), (u, v) = derivative(before, 1, 1), derivative(after, 1, 0)
        assert (x * v == y * u) == (smoothness == 1)


def test_what_happens_between_points_is_estimated_from_above_and_falls_with_their_distance():
    coarse, fine = (tables.from_points(on_an_ellipse(n)) for n in (3, 6))
    assert 0 < fine.fit.between < coarse.fit.between / 4
    for table, count in ((coarse, 3), (fine, 6)):
        off = max(abs((x / 2) ** 2 + y**2 - 1) for x, y in (c.at(Rational(1, 2)) for c in table.components))
        assert off / 4 < table.fit.error, count  # |grad| is at least 1 on this ellipse, and at most 2


def test_a_fourier_sum_of_least_squares_finds_the_ellipse_its_points_lie_on():
    quarter = [("2", "0"), ("0", "1"), ("-2", "0"), ("0", "-1")]
    table = tables.from_points(quarter, degree=1, by="index")
    assert table.components[0].point == (2 * cos(theta), sin(theta))
    assert table.fit.residual < Rational(1, 10**15)


def test_the_residual_of_a_fourier_sum_is_what_is_left_and_no_other_sum_of_its_degree_leaves_less():
    """The sum of squares grows when any one coefficient is changed."""
    by_index = tables.from_points(OVAL, degree=2, by="index")
    x, y = by_index.components[0].point
    at = [2 * Rational(k, len(OVAL)) for k in range(len(OVAL))]

    def squares(dx, dy):
        moved = [(c + d) for c, d in ((x, dx), (y, dy))]
        from sympy import pi

        found = [[c.subs(theta, share * pi).evalf(30) for c in moved] for share in at]
        return [(p - Rational(a)) ** 2 + (q - Rational(b)) ** 2 for (p, q), (a, b) in zip(found, OVAL, strict=True)]

    best = squares(0, 0)
    assert max(best) <= by_index.fit.residual**2 <= max(best) * Rational(101, 100)
    for wave in (Rational(1), cos(theta), sin(2 * theta)):
        for sign in (-1, 1):
            assert sum(squares(sign * wave / 1000, 0)) > sum(best)
            assert sum(squares(0, sign * wave / 1000)) > sum(best)


def test_points_in_either_order_give_a_table_with_its_inside_to_the_left():
    there, back = tables.from_points(OVAL), tables.from_points(OVAL[::-1])
    assert enclosed_area(there) > 0
    assert enclosed_area(back) > 0


@pytest.mark.parametrize("smoothness", [0, 1, 2])
def test_a_spline_that_crosses_itself_is_refused_with_the_place(smoothness):
    eight = [(-2, -1), (2, 1), (2, -1), (-2, 1), (-3, 0)]
    with pytest.raises(ValueError, match=r"crosses itself, or stops, near \("):
        tables.from_points(eight, smoothness=smoothness)


def test_a_thin_table_is_none_that_meets_itself():
    gap = Fraction(1, 10**6)
    thin = [(0, -gap), (10, -gap), (10, gap), (0, gap)]
    assert tables.from_points([(str(x), str(y)) for x, y in thin], smoothness=0).name == "measured"


@pytest.mark.parametrize(
    ("points", "given", "says"),
    [
        ([(0, 0), (1, 0)], {}, "2 points are given"),
        ([(0, 0), (0, 0), (1, 1)], {}, "points 1 and 2 are the same"),
        (OVAL, {"smoothness": 3}, "smoothness = 3"),
        (OVAL, {"degree": 5}, "accepted: from 11"),
        (OVAL, {"degree": 2, "smoothness": 1}, "smoothness = 1 and degree = 2 are given; give only one"),
        ([("x", 0), (1, 0), (0, 1)], {}, "x of point 1"),
        ([(0, 0), (1, 0), (0, float("nan"))], {}, "y of point 3"),
        (OVAL, {"uncertainty": "-1"}, "is no distance"),
        (OVAL, {"by": "guess"}, "accepted: 'chord', 'index'"),
    ],
)
def test_what_is_no_measurement_is_refused_in_one_sentence(points, given, says):
    with pytest.raises(ValueError, match=says):
        tables.from_points(points, **given)


@pytest.mark.parametrize("given", [{}, {"smoothness": 1}, {"degree": 2}, {"uncertainty": "1/100", "by": "index"}])
def test_a_measured_table_is_one_line_of_text_and_back(given):
    table = tables.from_points(OVAL, **given)
    scene = Scene(table, lam="1/2")
    again = Scene.parse(scene.text)
    assert (again, again.table, again.table.fit) == (scene, table, table.fit)
    assert "component" not in scene.text
    assert len(scene.text) < 500


def test_a_scene_file_says_points_with_decimals(tmp_path):
    rows = ", ".join(f'["{x}", "{y}"]' for x, y in OVAL)
    (tmp_path / "pebble.toml").write_text(f'name = "pebble"\nlam = "0.5"\nsmoothness = 1\npoints = [{rows}]\n')
    found = Scene.load(tmp_path / "pebble.toml")
    assert found.table.name == "pebble"
    assert found.table.components == tables.from_points(OVAL, "pebble", smoothness=1).components
    with pytest.raises(ValueError, match="rounded float"):
        Scene.parse("points = [[0.5, 0], [1, 0], [0, 1]]")


def test_a_fourier_sum_is_what_its_coefficients_say():
    table = tables.from_fourier({1: 1, -2: ("1/10", "1/20")})
    x, y = table.components[0].point
    assert expand(x - (cos(theta) + cos(2 * theta) / 10 + sin(2 * theta) / 20)) == 0
    assert expand(y - (sin(theta) - sin(2 * theta) / 10 + cos(2 * theta) / 20)) == 0


def test_paths_are_turned_so_that_the_inside_lies_to_the_left_and_the_largest_is_the_boundary():
    hole = [[(1, 1), (2, 1)], [(2, 1), (2, 2)], [(2, 2), (1, 1)]]
    outer = [[(0, 0), (0, 5)], [(0, 5), (5, 5)], [(5, 5), (6, 3), (5, 0)], [(5, 0), (0, 0)]]
    table = tables.from_path([hole, outer])
    areas = [signed_area([as_bezier(c) for c in table.components[i:j]]) for i, j in ((0, 4), (4, 7))]
    assert areas == [25 + Fraction(5, 3), -Fraction(1, 2)]
    with pytest.raises(ValueError, match="hole 1 does not lie in the table"):
        tables.from_path([outer, [[(x + 9, y) for x, y in piece] for piece in hole]])
    with pytest.raises(ValueError, match="not closed"):
        tables.from_path([outer[:3]])


def test_arrays_are_read_as_the_numbers_they_hold_and_masked_points_are_refused():
    import numpy as np

    turn = np.linspace(0, 2 * np.pi, 13)
    points = np.stack([2 * np.cos(turn), np.sin(turn)], axis=1)
    assert len(tables.from_points(points).components) == 12  # the last is the first, up to rounding
    single = tables.from_points(points[:-1].astype(np.float32), smoothness=0)
    assert single.components[1].at(0)[0] == Rational(*np.float32(points[1, 0]).as_integer_ratio())
    masked = np.ma.masked_array(points, mask=np.zeros(points.shape, bool))
    assert tables.from_points(masked) == tables.from_points(points)
    masked.mask[2, 1] = True
    with pytest.raises(ValueError, match="y of point 3 is masked; leave the point out"):
        tables.from_points(masked)


def test_arcs_and_sides_bound_a_table_and_one_that_crosses_is_refused():
    bow = tables.ConicArc((Fraction(0), Fraction(0)), (Fraction(1), Fraction(0)), (Fraction(0), Fraction(2)), 2)
    table = tables.from_path([[bow, [(-1, 0), (1, 0)]]])
    assert enclosed_area(table) == pi
    assert tables.from_path([[bow.turned(), [(1, 0), (-1, 0)]][::-1]]) == table
    with pytest.raises(ValueError, match=r"crosses itself, or stops, near \("):
        tables.from_path([[bow, [(-1, 0), (0, 3)], [(0, 3), (1, 0)]]])
    for quarters, rest in ((0, Fraction(1, 3)), (1, Fraction(2, 7)), (3, Fraction(0)), (3, Fraction(9, 10))):
        arc = bow._replace(quarters=quarters, rest=rest)
        chord = [arc.end, arc.start]
        assert (
            abs(
                enclosed_area(tables.from_path([[arc, chord]]))
                - Rational(str(abs(float(area([arc, elevated(chord)])))))
            )
            < 1e-9
        )


def test_many_points_are_judged_within_seconds():
    """A comb whose long teeth have overlapping bounding boxes is proved simple; with one crossing tooth it is not."""
    teeth = [(x, y) for k in range(200) for x, y in ((4 * k, 0), (4 * k + 1, 900), (4 * k + 2, 900), (4 * k + 3, 0))]
    comb = [*teeth, (800, 0), (800, -1), (0, -1)]
    assert len(tables.from_points(comb[::-1], smoothness=0).components) == len(comb)
    bent = [p if p != (402, 900) else (406, 450) for p in comb]
    with pytest.raises(ValueError, match="crosses itself"):
        tables.from_points(bent, smoothness=0)
