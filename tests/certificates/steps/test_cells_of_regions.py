"""Steps of the second reader's trapping regions, each by itself: cells of a document, borders, images on an ellipse."""

import json
from fractions import Fraction
from math import atan2, cos, pi, sin
from pathlib import Path
from types import SimpleNamespace

import pytest

GIVEN = json.loads((Path(__file__).parents[3] / "certificates" / "triangle-region.json").read_text())
TURN = 2 * pi


@pytest.fixture(scope="module")
def region(check):
    return check.beside("region")


def test_of_a_document_each_cell_is_asked_once_as_a_whole_after_its_table(check, region, monkeypatch):
    asked, tables = [], []
    monkeypatch.setattr(region, "convex", tables.append)
    monkeypatch.setattr(region.Inside, "cell", lambda self, *square: asked.append((self, *square)))
    said = region.trapping(GIVEN)

    assert (
        said == f"proved: {GIVEN['name']}\n  For every such lam the image of each of its points lies in its interior."
    )
    cells, _ = region.blocks(GIVEN)
    assert [square[1:] for square in asked] == [(c, r, 1, region.HALVINGS) for c, r in sorted(cells)]
    inside = asked[0][0]
    assert tables == [inside.table]
    assert (inside.columns, inside.rows) == (GIVEN["columns"], GIVEN["rows"])
    assert inside.cells == cells
    low, high = (Fraction(x) for x in GIVEN["lam"])
    assert inside.lam.lo <= low * 2**64 <= inside.lam.lo + 1
    assert inside.lam.hi - 1 <= high * 2**64 <= inside.lam.hi
    assert inside.top.real() == pytest.approx(float(high) * pi / 2, rel=1e-15)
    assert len(inside.points) == region.POINTS
    for k in (0, 1, 100, 511):
        theta = TURN * k / 512
        r = 1 + 2 * cos(3 * theta) / 25
        assert inside.points[k] == pytest.approx((r * cos(theta), r * sin(theta)), abs=1e-12)


def grid(columns=4, rows=6, parts=1, runs=((0, 1, 0, 0, 1),)):
    return {"columns": columns, "rows": rows, "parts": parts, "runs": [list(run) for run in runs]}


@pytest.mark.parametrize(
    ("changed", "cells", "count"),
    [
        ({}, {(0, 0)}, 1),
        ({"columns": 2, "rows": 2}, {(0, 0)}, 1),
        ({"columns": 8192, "rows": 8192, "parts": 16}, {(0, 0)}, 1),
        ({"runs": [(0, 1, 3, 5, 1)]}, {(3, 5)}, 1),
        ({"runs": [(0, 2, 2, 2, 2)]}, {(c, r) for c in (2, 3) for r in (2, 3, 4, 5)}, 2),
        ({"runs": [(0, 4, 0, 0, 1), (0, 1, 1, 4, 2)]}, {(k % 4, k // 4) for k in range(16)} | {(1, 4), (1, 5)}, 3),
    ],
)  # fmt: skip
def test_the_cells_of_runs_are_blocks_one_above_the_other(region, changed, cells, count):
    assert region.blocks(grid(**changed)) == (cells, count)


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        *(({key: n}, "a count is out of range") for key in ("columns", "rows") for n in (0, 1, 8193, True, 4.0)),
        *(({"parts": n}, "a count is out of range") for n in (0, 17, True, 1.0, -1)),
        *(({"runs": [run]}, "five whole numbers") for run in ((0, 1, 0, 0), (0, 1, 0, 0, 1, 1), (0, 1, 0, 0, 1.0))),
        *(({"runs": [run]}, "five whole numbers") for run in ((False, 1, 0, 0, 1), (0.0, 1, 0, 0, 1))),
        *(({"runs": [run]}, "beyond the grid") for run in ((1, 1, 0, 0, 1), (-1, 1, 0, 0, 1), (0, 0, 0, 0, 1))),
        *(({"runs": [run]}, "beyond the grid") for run in ((0, 1, 0, 0, 0), (0, -1, 1, 1, -1), (0, 1, 0, 0, -1))),
        *(({"runs": [run]}, "beyond the grid") for run in ((0, 1, -1, 0, 1), (0, 1, 4, 0, 1), (0, 2, 3, 0, 1))),
        *(({"runs": [run]}, "beyond the grid") for run in ((0, 1, 0, -1, 1), (0, 1, 0, 6, 1), (0, 1, 0, 5, 2))),
        *(({"runs": [run]}, "beyond the grid") for run in ((0, 2, 0, 3, 2), (0, 5, 0, 0, 1))),
        ({"runs": [(0, 2, 0, 0, 1), (0, 1, 1, 1, 1)]}, "stands twice"),
        ({"runs": [(0, 1, 1, 0, 3), (0, 1, 1, 2, 1)]}, "stands twice"),
        ({"runs": [(0, 1, 0, 0, 1), (0, 1, 1, 0, 1), (0, 1, 0, 0, 1)]}, "stands twice"),
        ({"runs": []}, "no cell"),
    ],
)
def test_runs_beyond_the_grid_or_told_twice_are_refused(check, region, changed, why):
    with pytest.raises(check.Wrong, match=why):
        region.blocks(grid(**changed))


DISC = {"polar": "1"}


@pytest.mark.parametrize(
    ("scene", "lam", "why"),
    [
        (["circle"], ["0", "1/2"], "of laws this reader knows"),
        (DISC | {"law": "-lam*eta"}, ["0", "1/2"], "of laws this reader knows"),
        (DISC, {"0": "0", "1": "1/2"}, "a list of two numbers"),
        (DISC, "01", "a list of two numbers"),
        (DISC, ["1/4", "1/3", "1/2"], "a list of two numbers"),
        (DISC, ["1/4"], "a list of two numbers"),
        (DISC, ["2/8", "1/2"], "lowest terms"),
        (DISC, ["1/4", "2/4"], "lowest terms"),
        (DISC, ["-1/4", "1/2"], "out of range"),
        (DISC, ["1/2", "1/4"], "out of range"),
        (DISC, ["1/2", "1"], "out of range"),
        (DISC, ["1/2", "3/2"], "out of range"),
        (DISC, ["0", "0"], "out of range"),
        ({"parametric": ["cos(theta)", "sin(theta)"]}, ["0", "1/2"], "the paper's tables and radii alone"),
        ({"table": "cuspless"}, ["0", "1/2"], "not one smooth closed curve"),
        (DISC | {"undefined": [{"name": "m", "component": 0, "theta": "1"}]}, ["0", "1/2"], "not one smooth closed"),
        ({"polar": "cos(theta/2) + 2"}, ["0", "1/2"], "not one smooth closed curve"),
    ],
)
def test_a_scene_or_a_range_that_is_none_is_refused_in_its_own_words(check, region, scene, lam, why):
    with pytest.raises((check.Wrong, check.Unproved), match=why):
        region.placed({"scene": scene, "lam": lam})


@pytest.mark.parametrize(
    ("lam", "words"), [(["0", "1/2"], "0 to 1/2"), (["1/4", "1/4"], "1/4"), (["1/4", "99/100"], "1/4 to 99/100")]
)
def test_a_scene_is_said_in_words_with_its_range(region, lam, words):
    for scene, called in ((DISC, "polar 1"), ({"table": "circle"}, "circle"), (DISC | {"lam": "1/2"}, "polar 1")):
        table, said, low, high = region.placed({"scene": scene, "lam": lam})
        assert said == f"{called}, lam = {words}"
        assert [low.real(), high.real()] == [float(Fraction(x)) for x in lam]
        assert table.closed == [True]


def test_a_boundary_is_seen_to_turn_over_the_whole_of_it(check, region, monkeypatch):
    """Asked in eighths of a turn, and no piece is left out or lies beyond."""
    asked = []

    def bend(table, theta):
        if theta.width() > 2**64 * 0.8:
            return check.I(-1, 1, 64)
        asked.append((theta.lo / 2**64, theta.hi / 2**64))
        return check.I(1, 2, 64)

    monkeypatch.setattr(region, "bend", bend)
    region.convex(SimpleNamespace(p=64))
    wanted = [(pi * (k / 4 - 1), pi * (k / 4 - 3 / 4)) for k in range(8)]
    assert [x for pair in sorted(asked) for x in pair] == pytest.approx([x for pair in wanted for x in pair], abs=1e-15)


@pytest.mark.parametrize(
    ("turn", "error", "why"),
    [
        ((-2, 0), "Wrong", "bends outwards"),
        ((0, 0), "Wrong", "bends outwards"),
        ((-1, 1), "Unproved", "may bend outwards"),
        ((0, 1), "Unproved", "may bend outwards"),
        (None, "Unproved", "may bend outwards"),
    ],
)
def test_a_boundary_that_does_not_turn_or_may_not_is_refused(check, region, monkeypatch, turn, error, why):
    def bend(table, theta):
        check.need(turn, "no value")
        return check.I(*turn, 64)

    monkeypatch.setattr(region, "bend", bend)
    with pytest.raises(getattr(check, error), match=why):
        region.convex(SimpleNamespace(p=64))


@pytest.mark.parametrize("theta", [-3.0, -1.2, 0.0, 0.4, 1.9, 2.8])
def test_the_tangent_of_an_ellipse_turns_as_its_formula_says(check, region, theta):
    """`a/(a**2*sin**2 + cos**2)` for half axes `a` and 1."""
    table = check.read_scene({"table": "ellipse", "shape": {"a": "3/2"}}, "lam", 64)[0]
    found = region.bend(table, check.I.of(Fraction(theta), 64))
    assert found.real() == pytest.approx(1.5 / (2.25 * sin(theta) ** 2 + cos(theta) ** 2), rel=1e-14)
    assert found.width() < 1000


A = 1.5


def flown(theta: float, phi: float) -> tuple[float, float]:
    """Where a particle on the ellipse lands and minus the angle at which it arrives, in closed form."""
    x, y, tx, ty = A * cos(theta), sin(theta), -A * sin(theta), cos(theta)
    ux, uy = tx * sin(phi) - ty * cos(phi), ty * sin(phi) + tx * cos(phi)
    t = -2 * (x * ux / A**2 + y * uy) / (ux**2 / A**2 + uy**2)
    landing = atan2(y + t * uy, (x + t * ux) / A)
    dx, dy = -A * sin(landing), cos(landing)
    return landing, atan2(ux * dx + uy * dy, ux * dy - uy * dx)


@pytest.mark.parametrize(
    ("column", "row", "size"),
    [(10, 60, "1/32"), (300, 128, "1/32"), (400, 90, "1/16"), (0, 20, "1/64"), (511, 200, "1/32")],
)
def test_the_image_of_a_square_on_an_ellipse_is_that_of_its_points_and_hardly_more(check, region, column, row, size):
    table, _, low, high = region.placed({"scene": {"table": "ellipse", "shape": {"a": "3/2"}}, "lam": ["1/4", "3/4"]})
    inside = region.Inside(table, low.hull(high), high, (512, 256), set())
    size = Fraction(size)
    found = inside.landing(Fraction(column), Fraction(row), size)
    shares = [k / 8 * float(size) for k in range(9)]
    seen = [
        flown(-pi + TURN * (column + u) / 512, 0.75 * pi / 2 * (2 * (row + v) / 256 - 1))
        for u in shares
        for v in shares
    ]
    middle = found[0].real()
    seen = [(landing + TURN * round((middle - landing) / TURN), psi) for landing, psi in seen]
    for enclosure, true in zip(found, zip(*seen, strict=True), strict=True):
        ends = enclosure.lo / 2**64, enclosure.hi / 2**64
        assert ends[0] - 1e-12 <= min(true)
        assert max(true) <= ends[1] + 1e-12
        assert ends[1] - ends[0] <= 1.25 * (max(true) - min(true))
    image = inside.image(Fraction(column), Fraction(row), size)
    assert (image[0].lo, image[0].hi) == (found[0].lo, found[0].hi)
    wanted = found[1] * low.hull(high)
    assert (image[1].lo, image[1].hi) == (wanted.lo, wanted.hi)


def test_the_middle_of_a_square_has_to_land_where_the_square_does(check, region):
    table, _, low, high = region.placed({"scene": DISC, "lam": ["1/4", "3/4"]})
    inside, real = region.Inside(table, low.hull(high), high, (512, 256), set()), table.flight

    def elsewhere(part, place, state, names):
        landing, psi = real(part, place, state, names)
        return (landing + (1 if state[0].degree == 0 else 0), psi)

    table.flight = elsewhere
    with pytest.raises(check.Unproved, match="the middle does not land where the square does"):
        inside.landing(Fraction(3), Fraction(128), Fraction(1))


def met(check, region, theta, phi, columns=8, rows=2):
    """Of the strip between -2 and 2, ends in units of the last place, or in two of them across."""
    made = SimpleNamespace(columns=columns, rows=rows, p=64, top=check.I.of(2, 64))
    return region.Inside.met(made, check.I(*theta, 64), check.I(*(2 * x for x in phi), 64))


ONE = 1 << 64
INNER = int(0.1 * ONE), int(0.2 * ONE)  # of the fifth column


@pytest.mark.parametrize(
    ("phi", "rows"),
    [
        ((1, ONE // 2), [1]),
        ((0, ONE // 2), [0, 1]),
        ((-ONE // 2, -2), [0]),
        ((-ONE // 2, -1), [0, 1]),
        ((-ONE // 2, 0), [0, 1]),
        ((ONE // 4, ONE // 4), [1]),
        ((-2 * ONE, -ONE // 4), [0]),
        ((ONE // 4, 2 * ONE), [1]),
        ((-ONE - 1, -ONE - 1), [0]),
        ((ONE, ONE), [1]),
    ],
)
def test_a_row_is_met_where_a_rectangle_is_within_it_or_at_its_border(check, region, phi, rows):
    assert met(check, region, INNER, phi) == [(4, row) for row in rows]


@pytest.mark.parametrize("phi", [(-2 * ONE, -ONE - 2), (ONE + 1, 2 * ONE)])
def test_a_rectangle_beyond_the_strip_meets_no_row(check, region, phi):
    with pytest.raises(check.Unproved, match="an image lies outside the strip"):
        met(check, region, INNER, phi)


@pytest.mark.parametrize(
    ("theta", "columns"),
    [
        ((0.1, 0.2), [4]),
        ((-3.1, -3.0), [0]),
        ((3.0, 3.1), [7]),
        ((3.0, 3.2), [7, 0]),
        ((-4.0, -2.0), [6, 7, 0, 1]),
        ((0.5, 1.0), [4, 5]),
        ((6.3, 6.4), [4]),
        ((-0.1, 6.1), [3, 4, 5, 6, 7, 0, 1, 2]),
        ((-4.0, 4.0), [6, 7, 0, 1, 2, 3, 4, 5]),
        ((-9.0, 9.0), [0, 1, 2, 3, 4, 5, 6, 7]),
    ],
)
def test_columns_are_met_round_and_each_but_once(check, region, theta, columns):
    found = met(check, region, tuple(round(x * 2**32) << 32 for x in theta), (ONE // 4, ONE // 2))
    first = found[0][0]
    assert found == [((first + k) % 8, 1) for k in range(len(columns))]
    assert sorted(column for column, _ in found) == sorted(columns)
    assert first == columns[0] or len(columns) == 8


def test_a_rectangle_is_covered_where_every_cell_that_it_meets_is_there(region):
    inside = region.Inside.__new__(region.Inside)
    inside.cells, inside.met = {(0, 0), (1, 0)}, lambda theta, phi: [*theta, *phi]
    assert inside.covered([(0, 0)], [(1, 0)])
    assert not inside.covered([(0, 0)], [(1, 1)])
    assert not inside.covered([(1, 1)], [(2, 1)])
