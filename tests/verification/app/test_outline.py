"""Files of points, paths and plans, as other programs write them, give the table that they show, or a sentence."""

import json
from fractions import Fraction
from itertools import pairwise
from math import cos, pi, sin

import pytest
import sympy

from symbolic.tables.validity import enclosed_area
from verification.app.cli import main
from verification.app.outline import Data, read

RECTANGLE = [(0, 0), (4, 0), (4, 2), (0, 2)]


def asked(capsys, *options, lam="0.5", start="0.3,0.2", bounces="2"):
    """Exit status, bounces, and the text on standard error, of `pinball orbit`."""
    status = main(["orbit", *options, "--lam", lam, "--start", start, "--bounces", bounces, "--json", "-"])
    out, err = capsys.readouterr()
    return status, json.loads(out)["bounces"] if status < 2 else None, err


def written(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    return "--data", str(tmp_path / name)


def svg(body, size='width="100" height="60"'):
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>'


def dxf(tmp_path, draw):
    import ezdxf

    document, path = ezdxf.new(), tmp_path / "drawn.dxf"
    draw(document.modelspace())
    document.saveas(path)
    return "--data", str(path)


def table_of(options):
    """The table of a file, named as for the command."""
    return read(Data(options[1])).table


def lines(*ends):
    """A function that draws lines between pairs of points."""
    return lambda model: [model.add_line(*pair) for pair in ends]


def close_rectangle(model):
    model.add_lwpolyline(RECTANGLE, close=True)


ROWS = ["2,0", "1.2,0.8", "0,1", "-2,0.1", "0,-1"]
LEAF = [(0, 0), (1, -1), (3, -1), (4, 0), (4, 2), (3, 3), (1, 3), (0, 2), (0, 0)]


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
@pytest.mark.parametrize("heading", ["", "x,y\n", "# of a pebble\n"])
def test_points_are_read_whatever_stands_between_their_numbers(tmp_path, mark, heading):
    text = (heading + "\n".join(ROWS) + "\n").replace(",", mark)
    table = table_of(written(tmp_path, "pebble.csv", text))
    assert table.fit.points[1] == (sympy.Rational(6, 5), sympy.Rational(4, 5))
    assert len(table.components) == len(ROWS)


def test_a_drawn_path_keeps_its_decimals_and_points_up(tmp_path):
    body = '<path d="M 0.1 0 L 0.1 10 L 10 10 L 10 0 Z"/>'
    table = table_of(written(tmp_path, "box.svg", svg(body)))
    assert enclosed_area(table) == sympy.Rational(99, 10) * 10
    corners = {component.at(0) for component in table.components}
    assert (sympy.Rational(1, 10), sympy.Rational(-10)) in corners


def test_a_drawn_circle_is_one_exactly_and_a_smaller_one_a_hole(tmp_path):
    body = '<circle cx="5" cy="5" r="4"/><circle cx="6" cy="5" r="1"/>'
    table = table_of(written(tmp_path, "ring.svg", svg(body)))
    assert enclosed_area(table) == 15 * sympy.pi
    x, y = table.components[0].point
    assert sympy.expand((x - 5) ** 2 + (y + 5) ** 2, trig=True).trigsimp() == 16


def stadium(model):
    """Draws sides and half circles in no order, some reversed, and a hole."""
    model.add_line((-1, -1), (1, -1))
    model.add_line((-1, 1), (1, 1))
    model.add_arc((1, 0), 1, 270, 90)
    model.add_arc((-1, 0), 1, 90, 270)
    model.add_circle((0, 0), 0.25)


@pytest.mark.parametrize(
    ("draw", "pieces", "area"),
    [
        (stadium, 5, 4 + 15 * sympy.pi / 16),
        (
            lambda m: m.add_lwpolyline([(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 0)], "xyb", close=True),
            4,
            4 + sympy.pi / 2,
        ),
        (lambda m: m.add_polyline2d([(0, 0), (3, 0), (0, 4)], close=True), 3, 6),
        (lambda m: m.add_ellipse((0, 0), (2, 0), 0.5), 1, 2 * sympy.pi),
        (lambda m: m.add_spline(dxfattribs={"degree": 3}).set_open_uniform(LEAF), 6, None),
    ],
    ids=["lines and arcs", "bulge", "polyline", "ellipse", "spline"],
)
def test_outlines_of_a_dxf_file_are_joined_to_closed_curves(tmp_path, draw, pieces, area):
    table = table_of(dxf(tmp_path, draw))

    assert len(table.components) == pieces
    assert area is None or abs(float(enclosed_area(table) - area)) < 1e-5


def test_every_command_takes_points(tmp_path, capsys):
    points = written(tmp_path, "pebble.csv", "\n".join(ROWS))
    assert main(["orbit", *points, "--lam", "0.5", "--start", "0.3,0.2", "--bounces", "2"]) == 0
    assert "the piece by halving" in capsys.readouterr().out
    assert main(["orbit", "--degree", "2", "--lam", "0.5", "--start", "0.3,0.2", "--bounces", "2"]) == 2
    assert "--degree = 2 says how points are fitted" in capsys.readouterr().err


RECT = '<rect x="10" y="10" width="80" height="40"/>'
RETRACTED = "M10 10 C10 10 90 10 90 10 C90 10 90 50 90 50 C90 50 10 50 10 50 C10 50 10 10 10 10 Z"
CIRCLE = '<circle cx="50" cy="30" r="20" {}/>'


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "said"),
    [
        (svg(RECT, 'width="100mm" height="60mm" viewBox="0 0 100 60"'), "1 curve of 4 pieces, 80 by 40 mm, area 3200"),
        (svg('<rect width="80mm" height="40mm"/>', 'width="100mm" height="60mm"'), "80 by 40 mm, area 3200"),
        (svg('<rect width="100%" height="100%" fill="white"/><path d="M20 20H60V40H20Z"/>'), "40 by 20 px, area 800"),
        (svg('<rect width="100%" height="100%" fill="white"/><path d="M20 20H60V40H20Z"/>'), "left out: 1 background"),
        (svg(CIRCLE.format('fill="#eee"') + CIRCLE.format('fill="none"')), "1 curve drawn twice, read once"),
        (svg(f'<path d="{RETRACTED}"/>'), "1 curve of 4 pieces, 80 by 40 px, area 3200"),
        (svg('<ellipse cx="50" cy="30" rx="40" ry="20"/>'), "1 curve of 1 piece, 80 by 40 px, area 2513.27"),
        (svg('<g transform="rotate(30)"><ellipse rx="4" ry="2"/></g>'), "7.2111 by 5.2915 px, area 25.1327"),
        (svg('<rect transform="rotate(30)" width="4" height="2" rx="1"/>'), "3.73205 by 3 px, area 7.14159"),
        (svg('<rect transform="skewX(45)" width="4" height="2"/>'), "6 by 2 px, area 8"),
        (svg('<path d="M0 0 C0 10 20 10 20 0 S 0 -10 0 0 Z"/>'), "20 by 15 px, area 240"),
        (svg('<path d="M0 0 A0 5 0 0 1 10 0 L5 9 Z"/>'), "3 pieces, 10 by 9 px, area 45"),
        (svg('<symbol id="s"><rect width="9" height="9"/></symbol>' + RECT), "1 curve of 4 pieces, 80 by 40 px"),
        (svg('<symbol id="s"><rect width="9" height="9"/></symbol><use href="#s" x="20"/>'), "9 by 9 px, area 81"),
        (svg('<mask id="m"><path d="M0 0H9V9Z"/></mask><path d="M0 0H9V9Z" opacity="0"/>' + RECT), "1 curve of 4"),
        (svg(RECT, 'width="100mm" height="30mm" viewBox="0 0 100 60"'), "40 by 20 mm, area 800"),
        (
            svg(RECT, 'width="100mm" height="60px" preserveAspectRatio="xMidYMid slice" viewBox="0 0 100 60"'),
            "80 by 40",
        ),
    ],
)
def test_a_drawing_is_read_as_it_looks_and_what_was_read_is_said(tmp_path, capsys, text, said):
    status, _, told = asked(capsys, *written(tmp_path, "a.svg", text))
    assert (status, said in told) == (0, True), told
    assert sum(line.startswith("a.svg: ") for line in told.splitlines()) <= 2


def test_curves_layers_and_units_can_be_chosen(tmp_path, capsys):
    body = '<g id="a"><path d="M0 0H9V9H0Z"/></g><g id="b"><path d="M20 0H24V2H20Z"/></g>'
    both, inch = written(tmp_path, "two.svg", svg(body)), written(tmp_path, "i.svg", svg('<path d="M0 0H96V48H0Z"/>'))
    status, _, told = asked(capsys, *both)
    assert status == 2
    assert "--curve N chooses one" in told
    assert "4 by 2 px, area 8" in asked(capsys, *both, "--layer", "b")[2]
    assert "chosen: curve 2" in asked(capsys, *both, "--curve", "2")[2]
    assert "96 by 48 px" not in told
    assert "1 by 0.5 in" in asked(capsys, *inch, "--units", "in")[2]
    assert "--layer 'c' draws nothing; accepted: a, b" in asked(capsys, *both, "--layer", "c")[2]


def hidden(model):
    close_rectangle(model)
    for name, act in (("off", "off"), ("frozen", "freeze")):
        getattr(model.doc.layers.add(name), act)()
        model.add_line((-1, 1), (5, 1), dxfattribs={"layer": name})


def measured(model):
    close_rectangle(model)
    model.add_linear_dim(base=(0, -1), p1=(0, 0), p2=(4, 0)).render()
    model.add_text("hello")


@pytest.mark.parametrize("draw", [close_rectangle, hidden, measured])
def test_what_a_plan_does_not_draw_is_left_out(tmp_path, capsys, draw):
    (status, bounces, told), (_, plain, _) = (asked(capsys, *dxf(tmp_path, each)) for each in (draw, close_rectangle))
    assert status == 0
    assert bounces == plain
    assert "4 by 2 m, area 8" in told
    assert ("left out" in told) == (draw is not close_rectangle)


def test_a_gap_is_closed_within_the_tolerance_or_said_with_its_width(tmp_path, capsys):
    plan = dxf(tmp_path, lines(((0, 0), (4, 0)), ((4, 1e-4), (4, 2)), ((4, 2), (0, 2)), ((0, 2), (0, 0))))
    status, _, told = asked(capsys, *plan)
    assert status == 2
    assert "is open at (4, 0)" in told
    assert "is 0.0001 away; --tolerance 0.00011 closes" in told
    status, _, told = asked(capsys, *plan, "--tolerance", "0.00011")
    assert status == 0
    assert "closed: gaps of up to 0.0001" in told


def test_micrometres_are_printed_with_digits(tmp_path, capsys):
    small = [(x * 1e-6, y * 1e-6) for x, y in RECTANGLE]
    path = dxf(tmp_path, lambda model: model.add_lwpolyline(small, close=True))
    assert main(["orbit", *path, "--lam", "0.5", "--start", "0.3,0.2", "--bounces", "1"]) == 0
    assert "2.00e-06" in capsys.readouterr().out


GEOJSON = {"type": "Polygon", "coordinates": [[*map(list, RECTANGLE), [0, 0]]]}
FEATURE = {"type": "Feature", "geometry": GEOJSON}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.geojson", json.dumps(GEOJSON)),
        ("a.geojson", json.dumps({"type": "FeatureCollection", "features": [FEATURE]})),
        ("a.wkt", "POLYGON ((0 0, 4 0, 4 2, 0 2, 0 0))"),
        ("a.wkt", "SRID=4326;MULTIPOLYGON Z (((0 0 1, 4 0 1, 4 2 1, 0 2 1, 0 0 1)))"),
    ],
)
def test_polygons_of_gis_programs_are_those_of_the_command_line(tmp_path, capsys, name, text):
    (status, bounces, _), (_, plain, _) = (
        asked(capsys, *options) for options in (written(tmp_path, name, text), ("--polygon", "0,0 4,0 4,2 0,2 0,0"))
    )
    assert status == 0
    keys = ("theta", "s", "x", "y", "phi")
    assert [[row[k] for k in keys] for row in bounces] == [[row[k] for k in keys] for row in plain]


def test_a_polygon_with_a_hole_is_a_table_with_one(tmp_path, capsys):
    text = "POLYGON ((0 0, 4 0, 4 2, 0 2, 0 0), (1 1, 2 1, 2 1.5, 1 1))"
    assert "7 points of 2 curves" in asked(capsys, *written(tmp_path, "a.wkt", text))[2]


LONG = " ".join(f"{i} {i * i % 97}" for i in range(5000))
NESTED = '<g id="g0"><path d="M0 0H1V1Z"/></g>' + "".join(
    f'<g id="g{i}">' + f'<use href="#g{i - 1}"/>' * 10 + "</g>" for i in range(1, 12)
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.csv", "1,2\n3,4\n7,eight\n", "line 3 of data is '7,eight'"),
        ("a.csv", "1,two\n3,4\n7,8\n", "line 1 of data is '1,two'"),
        ("a.svg", "no drawing", "is no SVG file"),
        ("a.svg", svg(""), "has no closed path"),
        ("a.svg", svg('<path d="M 0 0 L 1 0 L 1 1"/>'), "a path is not closed"),
        ("a.svg", svg('<path d="M 0 0 L 2 2 L 2 0 L 0 2 Z"/>'), "area 0"),
        ("a.dxf", "no drawing", "is no DXF file"),
        ("eu.csv", "x;y\n1,5;0\n0;1,0\n-1,5;0\n0;-1,0\n", "line 2 of data is '1,5;0'; accepted: decimal points"),
        ("a.wkt", "POLYGON ((0 0, 1 0))", "points are given"),
        ("a.wkt", "LINESTRING (0 0, 1 0, 1 1)", "is no WKT of one polygon"),
        ("a.geojson", '{"type": "FeatureCollection", "features": []}', "holds 0 polygons"),
        ("a.geojson", '{"type": "Polygon"', "is no GeoJSON document"),
        ("a.svg", svg(f'<path d="M{LONG}Z"/>'), "accepted: up to 4000"),
        ("a.svg", svg('<path d="M10 10 C10 10 60 20 50 40 L10 40 Z"/>'), "no direction at its end (10, -10)"),
        ("a.csv", "\n".join(f"{i},{i * i}" for i in range(20000)), "20000 points are given"),
        ("a.wkt", "LINEARRING (0 0, 1 0, 1 1, 0 0)", "line 1 of data is"),
        ("a.svg", svg(RECT, 'width="9cm" height="9cm" preserveAspectRatio="none" viewBox="0 0 10 6"'), "differently"),
        ("a.svg", svg(NESTED), "more than 4000 shapes"),
        ("a.svg", svg('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>'), "within one another"),
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused_in_one_sentence(tmp_path, capsys, name, text, says):
    status, _, told = asked(capsys, *written(tmp_path, name, text))
    assert (status, told.count("\n")) == (2, 1)
    assert says in told


@pytest.mark.parametrize(
    ("draw", "says"),
    [
        (lines(((0, 0), (1, 0)), ((1, 0), (1, 1))), "is open at (1, 1); accepted: closed"),
        (lines(((0, 0), (1, 0)), ((1, 1), (1, 0)), ((2, 1), (1, 0))), "branches at (1, 0)"),
        (
            lambda model: model.add_text("no outline"),
            "has no outline; accepted: LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE",
        ),
    ],
    ids=["open", "branching", "none"],
)
def test_what_bounds_no_table_in_a_dxf_file_is_refused_in_one_sentence(tmp_path, capsys, draw, says):
    status, _, told = asked(capsys, *dxf(tmp_path, draw))
    assert (status, told.count("\n")) == (2, 1)
    assert says in told


def test_a_point_that_is_the_first_again_up_to_rounding_closes_the_curve(tmp_path, capsys):
    rows = [f"{2 * cos(k * pi / 6)!r},{sin(k * pi / 6)!r}" for k in range(13)]
    (status, closed, told), (_, plain, _) = (
        asked(capsys, *written(tmp_path, name, "\n".join(lines)))
        for name, lines in (("a.csv", rows), ("b.csv", rows[:-1]))
    )
    assert status == 0
    assert closed == plain
    assert "closed: the last point is the first up to rounding" in told


def test_one_ellipse_is_one_table_whether_drawn_or_written_as_a_formula(tmp_path, capsys):
    drawn = written(tmp_path, "e.svg", svg('<ellipse cx="0" cy="0" rx="1.5" ry="1"/>'))
    plan = dxf(tmp_path, lambda model: model.add_ellipse((0, 0), (1.5, 0), 1 / 1.5))
    _, first, _ = asked(capsys, "ellipse", "--a", "3/2", bounces="6")
    for options in (drawn, plan):
        status, bounces, _ = asked(capsys, *options, bounces="6")
        assert status == 0
        for row, other in zip(bounces, first, strict=True):
            assert [row[k] for k in ("theta", "phi", "x", "y")] == pytest.approx(
                [other[k] for k in ("theta", "phi", "x", "y")], abs=1e-12
            )


def test_what_was_read_is_kept_and_said_again(tmp_path, capsys):
    points = written(tmp_path, "a.csv", "\n".join(f"{x},{y}" for x, y in [*RECTANGLE, RECTANGLE[-1]]))
    first, second = (asked(capsys, *points, "--smoothness", "0") for _ in range(2))
    assert first == second
    assert "1 repeated points are left out" in first[2]


def two_halves(angle, away):
    """Draws half an ellipse and half of a longer one, joined on the short axis, turned and far from the origin."""

    def draw(model):
        low, high = -pi / 2, pi / 2
        for a in (2, 3):
            model.add_ellipse(away, (a * cos(angle), a * sin(angle)), 1 / a, low, high)
            low, high = high, low + 2 * pi

    return draw


@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.3, 0.7391, 1.9, -1.234567, -2.8])
@pytest.mark.parametrize("away", [(0.0, 0.0), (500000.25, 5400000.75), (9.1e6, 1e7 + 0.1)])
def test_half_turns_that_join_smoothly_do_so_turned_and_far_from_the_origin(tmp_path, capsys, angle, away):
    """The short axis, whose ends are the joins, is an attracting cycle."""
    plan, (c, s) = dxf(tmp_path, two_halves(angle, away)), (cos(angle), sin(angle))
    (x, y), (dx, dy) = ((c * u - s * v, s * u + c * v) for u, v in ((0.02, 0.1), (0.05, 1)))
    words = ["--from", f"{away[0] + x!r},{away[1] + y!r}", "--towards", f"{dx!r},{dy!r}", "--bounces", "200"]
    assert main(["orbit", *plan, "--lam", "1/2", *words, "--json", "-"]) == 0
    rows = json.loads(capsys.readouterr().out)["bounces"]
    assert {row["status"] for row in rows} == {"regular"}
    ends = [float(Fraction(row[key]) - Fraction(at)) for row in rows[-2:] for key, at in zip("xy", away, strict=True)]
    sign = 1 if ends[1] * cos(angle) > 0 else -1
    expected = [-sin(angle) * sign, cos(angle) * sign, sin(angle) * sign, -cos(angle) * sign]
    assert ends == pytest.approx(expected, abs=1e-7 if any(away) else 1e-12)


def test_joins_that_decimals_bend_are_told_of_and_smooth_within_the_tolerance(tmp_path, capsys):
    corners = [(500001.105, 5399997.914, 0), (500004.061, 5400000.609, 1), (500002.040, 5400002.826, 0)]

    def draw(model):  # a stadium in a survey with millimetres
        model.add_lwpolyline([*corners, (499999.084, 5400000.131, 1)], format="xyb", close=True)

    plan = dxf(tmp_path, draw)
    assert "4 joins of curved pieces bend by up to" in asked(capsys, *plan)[2]
    status, _, told = asked(capsys, *plan, "--tolerance", "0.002")
    assert status == 0
    assert "bend by" not in told


def test_a_gap_far_from_the_origin_is_told_with_its_place(tmp_path, capsys):
    ends = ((0, 0), (4, 0)), ((4, 1e-3), (4, 2)), ((4, 2), (0, 2)), ((0, 2), (0, 0))
    away = (((x + 500000, y + 5400000) for x, y in pair) for pair in ends)
    told = asked(capsys, *dxf(tmp_path, lines(*away)))[2]
    assert "open at (500004, 5400000); accepted: closed outlines" in told
    assert "and the nearest other end, (500004, 5400000.001)" in told


def test_lines_that_are_drawn_twice_are_read_once(tmp_path, capsys):
    sides = list(pairwise([*RECTANGLE, RECTANGLE[0]]))
    status, _, told = asked(capsys, *dxf(tmp_path, lines(*sides, *((q, p) for p, q in sides))))
    assert (status, "4 pieces drawn twice, read once" in told) == (0, True), told


@pytest.mark.parametrize("name", ["a.dxf", "a.csv", "a.svg"])
def test_numbers_beyond_float64_are_refused_in_a_sentence(tmp_path, capsys, name):
    given = {"a.csv": "0 0\n1e400 0\n0 1e400\n", "a.svg": svg('<path d="M0 0H1e200V1e200Z"/>')}
    plan = (
        written(tmp_path, name, given[name])
        if name in given
        else dxf(tmp_path, lambda model: model.add_circle((1e300, 0), 1e299))
    )
    status, _, told = asked(capsys, *plan)
    assert (status, told.count("\n")) == (2, 1), told
    assert "too large" in told or "accepted" in told
