"""Files as other programs write them give the intended table, with a note, or a sentence that names the fault."""

import json
from fractions import Fraction
from math import cos, pi, sin

import pytest

from verification.app.cli import main

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
    draw(document)
    document.saveas(path)
    return "--data", str(path)


def close_rectangle(document):
    document.modelspace().add_lwpolyline(RECTANGLE, close=True)


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
    both = written(
        tmp_path, "two.svg", svg('<g id="a"><path d="M0 0H9V9H0Z"/></g><g id="b"><path d="M20 0H24V2H20Z"/></g>')
    )
    status, _, told = asked(capsys, *both)
    assert status == 2
    assert "--curve N chooses" in told
    assert "4 by 2 px, area 8" in asked(capsys, *both, "--layer", "b")[2]
    assert "chosen: curve 2" in asked(capsys, *both, "--curve", "2")[2]
    assert "96 by 48 px" not in told
    assert (
        "1 by 0.5 in"
        in asked(capsys, *written(tmp_path, "i.svg", svg('<path d="M0 0H96V48H0Z"/>')), "--units", "in")[2]
    )
    assert "--layer 'c' draws nothing; accepted: a, b" in asked(capsys, *both, "--layer", "c")[2]


def hidden(document):
    close_rectangle(document)
    for name, act in (("off", "off"), ("frozen", "freeze")):
        getattr(document.layers.add(name), act)()
        document.modelspace().add_line((-1, 1), (5, 1), dxfattribs={"layer": name})


def measured(document):
    close_rectangle(document)
    document.modelspace().add_linear_dim(base=(0, -1), p1=(0, 0), p2=(4, 0)).render()
    document.modelspace().add_text("hello")


@pytest.mark.parametrize("draw", [close_rectangle, hidden, measured])
def test_what_a_plan_does_not_draw_is_left_out(tmp_path, capsys, draw):
    (status, bounces, told), (_, plain, _) = (asked(capsys, *dxf(tmp_path, each)) for each in (draw, close_rectangle))
    assert status == 0
    assert bounces == plain
    assert "4 by 2 m, area 8" in told
    assert ("left out" in told) == (draw is not close_rectangle)


def open_corner(document):
    for p, q in (((0, 0), (4, 0)), ((4, 1e-4), (4, 2)), ((4, 2), (0, 2)), ((0, 2), (0, 0))):
        document.modelspace().add_line(p, q)


def test_a_gap_is_closed_within_the_tolerance_or_said_with_its_width(tmp_path, capsys):
    plan = dxf(tmp_path, open_corner)
    status, _, told = asked(capsys, *plan)
    assert status == 2
    assert "is open at (4, 0)" in told
    assert "is 0.0001 away; --tolerance 0.00011 closes" in told
    status, _, told = asked(capsys, *plan, "--tolerance", "0.00011")
    assert status == 0
    assert "closed: gaps of up to 0.0001" in told


def test_micrometres_are_printed_with_digits(tmp_path, capsys):
    path = dxf(
        tmp_path, lambda d: d.modelspace().add_lwpolyline([(x * 1e-6, y * 1e-6) for x, y in RECTANGLE], close=True)
    )
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
        ("eu.csv", "x;y\n1,5;0\n0;1,0\n-1,5;0\n0;-1,0\n", "line 2 of data is '1,5;0'; accepted: decimal points"),
        ("a.wkt", "POLYGON ((0 0, 1 0))", "points are given"),
        ("a.wkt", "LINESTRING (0 0, 1 0, 1 1)", "is no WKT of one polygon"),
        ("a.geojson", '{"type": "FeatureCollection", "features": []}', "holds 0 polygons"),
        ("a.geojson", '{"type": "Polygon"', "is no GeoJSON document"),
        ("a.svg", svg(f'<path d="M{LONG}Z"/>'), "accepted: up to 4000"),
        ("a.svg", svg('<path d="M10 10 C10 10 60 20 50 40 L10 40 Z"/>'), "no direction at (10, -10)"),
        ("a.csv", "\n".join(f"{i},{i * i}" for i in range(20000)), "20000 points are given"),
        ("a.wkt", "LINEARRING (0 0, 1 0, 1 1, 0 0)", "line 1 of data is"),
        ("a.svg", svg(RECT, 'width="9cm" height="9cm" preserveAspectRatio="none" viewBox="0 0 10 6"'), "stretches"),
        ("a.svg", svg(NESTED), "more than 4000 shapes"),
        ("a.svg", svg('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>'), "within one another"),
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused_in_one_sentence(tmp_path, capsys, name, text, says):
    status, _, told = asked(capsys, *written(tmp_path, name, text))
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
    plan = dxf(tmp_path, lambda d: d.modelspace().add_ellipse((0, 0), (1.5, 0), 1 / 1.5))
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

    def draw(document):
        low, high = -pi / 2, pi / 2
        for a in (2, 3):
            document.modelspace().add_ellipse(away, (a * cos(angle), a * sin(angle)), 1 / a, low, high)
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

    def draw(document):  # a stadium in a survey with millimetres
        document.modelspace().add_lwpolyline([*corners, (499999.084, 5400000.131, 1)], format="xyb", close=True)

    plan = dxf(tmp_path, draw)
    assert "4 joins of curved pieces bend by up to" in asked(capsys, *plan)[2]
    status, _, told = asked(capsys, *plan, "--tolerance", "0.002")
    assert status == 0
    assert "bend by" not in told


def test_a_gap_far_from_the_origin_is_told_with_its_place(tmp_path, capsys):
    def draw(document):
        for p, q in (((0, 0), (4, 0)), ((4, 1e-3), (4, 2)), ((4, 2), (0, 2)), ((0, 2), (0, 0))):
            document.modelspace().add_line(*((x + 500000, y + 5400000) for x, y in (p, q)))

    assert (
        "open at (500004, 5400000); accepted: closed outlines, and the nearest other end, (500004, 5400000.001)"
        in (asked(capsys, *dxf(tmp_path, draw))[2])
    )


def draw_lines_twice(document):
    for p, q in zip(RECTANGLE, [*RECTANGLE[1:], RECTANGLE[0]], strict=True):
        document.modelspace().add_line(p, q)
        document.modelspace().add_line(q, p)


def test_lines_that_are_drawn_twice_are_read_once(tmp_path, capsys):
    status, _, told = asked(capsys, *dxf(tmp_path, draw_lines_twice))
    assert (status, "4 pieces drawn twice, read once" in told) == (0, True), told


@pytest.mark.parametrize("name", ["a.dxf", "a.csv", "a.svg"])
def test_numbers_beyond_float64_are_refused_in_a_sentence(tmp_path, capsys, name):
    given = {"a.csv": "0 0\n1e400 0\n0 1e400\n", "a.svg": svg('<path d="M0 0H1e200V1e200Z"/>')}
    plan = written(tmp_path, name, given[name]) if name in given else dxf(tmp_path, draw_giant)
    status, _, told = asked(capsys, *plan)
    assert (status, told.count("\n")) == (2, 1), told
    assert "too large" in told or "accepted" in told


def draw_giant(document):
    document.modelspace().add_circle((1e300, 0), 1e299)
