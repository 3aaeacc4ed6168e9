"""Tables from files: points in CSV, closed paths in SVG or DXF; other files are refused in a sentence."""

import pytest
from sympy import Rational, expand, pi

from symbolic.tables.validity import enclosed_area
from verification.app.cli import main
from verification.app.outline import Data, read

ROWS = ["2,0", "1.2,0.8", "0,1", "-2,0.1", "0,-1"]


def table_of(path, **how):
    return read(Data(path, **how)).table


def written(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
@pytest.mark.parametrize("heading", ["", "x,y\n", "# of a pebble\n"])
def test_points_are_read_whatever_stands_between_their_numbers(tmp_path, mark, heading):
    text = (heading + "\n".join(ROWS) + "\n").replace(",", mark)
    table = table_of(written(tmp_path, "pebble.csv", text))
    assert table.fit.points[1] == (Rational(6, 5), Rational(4, 5))
    assert len(table.components) == len(ROWS)


def test_a_first_point_that_is_repeated_to_close_the_curve_counts_once(tmp_path):
    assert len(table_of(written(tmp_path, "p.csv", "\n".join([*ROWS, ROWS[0]]))).components) == len(ROWS)


def test_a_line_that_holds_no_point_is_named(tmp_path):
    with pytest.raises(ValueError, match="line 3 of data is '7,eight'"):
        table_of(written(tmp_path, "p.csv", "1,2\n3,4\n7,eight\n"))
    with pytest.raises(ValueError, match="line 1 of data is '1,two'"):
        table_of(written(tmp_path, "p.csv", "1,two\n3,4\n7,8\n"))


def svg(body):
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">{body}</svg>'


def test_a_drawn_path_keeps_its_decimals_and_points_up(tmp_path):
    body = '<path d="M 0.1 0 L 0.1 10 L 10 10 L 10 0 Z"/>'
    table = table_of(written(tmp_path, "box.svg", svg(body)))
    assert enclosed_area(table) == Rational(99, 10) * 10
    corners = {component.at(0) for component in table.components}
    assert (Rational(1, 10), Rational(-10)) in corners


def test_a_drawn_circle_is_one_exactly_and_a_smaller_one_a_hole(tmp_path):
    body = '<circle cx="5" cy="5" r="4"/><circle cx="6" cy="5" r="1"/>'
    table = table_of(written(tmp_path, "ring.svg", svg(body)))
    assert enclosed_area(table) == 15 * pi
    x, y = table.components[0].point
    assert expand((x - 5) ** 2 + (y + 5) ** 2, trig=True).trigsimp() == 16


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("no drawing", "is no SVG file"),
        (svg(""), "has no closed path"),
        (svg('<path d="M 0 0 L 1 0 L 1 1"/>'), "a path is not closed"),
        (svg('<path d="M 0 0 L 2 2 L 2 0 L 0 2 Z"/>'), "crosses itself|area 0"),
    ],
)
def test_what_is_no_drawing_of_a_table_is_refused_in_one_sentence(tmp_path, text, says):
    with pytest.raises(ValueError, match=says):
        table_of(written(tmp_path, "bad.svg", text))


def dxf(tmp_path, draw):
    """Writes a drawing of ezdxf to a file."""
    import ezdxf

    document, path = ezdxf.new(), str(tmp_path / "drawn.dxf")
    draw(document.modelspace())
    document.saveas(path)
    return path


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
        (stadium, 5, 4 + 15 * pi / 16),
        (lambda m: m.add_lwpolyline([(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 0)], "xyb", close=True), 4, 4 + pi / 2),
        (lambda m: m.add_polyline2d([(0, 0), (3, 0), (0, 4)], close=True), 3, 6),
        (lambda m: m.add_ellipse((0, 0), (2, 0), 0.5), 1, 2 * pi),
        (lambda m: m.add_spline(dxfattribs={"degree": 3}).set_open_uniform(LEAF), 6, None),
    ],
    ids=["lines and arcs", "bulge", "polyline", "ellipse", "spline"],
)
def test_outlines_of_a_dxf_file_are_joined_to_closed_curves(tmp_path, draw, pieces, area):
    table = table_of(dxf(tmp_path, draw))

    assert len(table.components) == pieces
    assert area is None or abs(float(enclosed_area(table) - area)) < 1e-5


LEAF = [(0, 0), (1, -1), (3, -1), (4, 0), (4, 2), (3, 3), (1, 3), (0, 2), (0, 0)]


@pytest.mark.parametrize(
    ("draw", "says"),
    [
        (lambda m: [m.add_line((0, 0), (1, 0)), m.add_line((1, 0), (1, 1))], r"is open at \(1, 1\); accepted: closed"),
        (lambda m: [m.add_line(p, (1, 0)) for p in ((0, 0), (1, 1), (2, 1))], r"branches at \(1, 0\)"),
        (lambda m: m.add_text("no outline"), "has no outline; accepted: LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE"),
    ],
    ids=["open", "branching", "none"],
)
def test_what_bounds_no_table_in_a_dxf_file_is_refused_in_one_sentence(tmp_path, draw, says):
    with pytest.raises(ValueError, match=says):
        table_of(dxf(tmp_path, draw))


def test_what_is_no_dxf_file_is_refused_in_one_sentence(tmp_path):
    with pytest.raises(ValueError, match="is no DXF file"):
        table_of(written(tmp_path, "bad.dxf", "no drawing"))


def test_every_command_takes_points(tmp_path, capsys):
    path = written(tmp_path, "pebble.csv", "\n".join(ROWS))
    assert main(["orbit", "--data", path, "--lam", "0.5", "--start", "0.3,0.2", "--bounces", "2"]) == 0
    assert "the piece by halving" in capsys.readouterr().out
    assert main(["orbit", "--degree", "2", "--lam", "0.5", "--start", "0.3,0.2", "--bounces", "2"]) == 2
    assert "--degree = 2 says how points are fitted" in capsys.readouterr().err
