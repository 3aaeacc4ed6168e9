"""Trapping regions by the independent checker: images contain sampled ones, and too few cells are refused."""

import copy
import random
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from committed import document

from numeric import PinballMap
from symbolic.tables import polar

GIVEN = document("triangle-region")
SCENES = [
    ({"table": "egg", "shape": {"alpha": "2/25"}}, {"alpha": "0.08"}, ("49/100", "1/2")),
    ({"table": "ellipse", "shape": {"a": "3/2"}}, {"a": "3/2"}, ("9/10", "9/10")),
    ({"polar": "1 + cos(5*theta)/40"}, {}, ("1/5", "1/4")),
]


@pytest.fixture(scope="module")
def region(check):
    return check.beside("region")


def made(region, scene, lam, grid=(16, 8), cells=()):
    """The checker's images and cells of a scene."""
    table, _, low, high = region.placed({"scene": scene, "lam": list(lam)})
    region.convex(table)
    return region.Inside(table, low.hull(high), high, grid, set(cells))


@pytest.mark.parametrize(("scene", "shape", "lam"), SCENES)
def test_an_image_holds_where_the_map_takes_every_point_of_its_cell(region, scene, shape, lam):
    """By the kernels, whose error is far below the slack; also at the ends of the cell and of the contractions."""
    grid, dice = (512, 256), random.Random(5)
    inside = made(region, scene, lam, grid)
    for _ in range(6):
        i, j = dice.randrange(512), dice.randrange(64, 192)
        found = inside.image(Fraction(i), Fraction(j), Fraction(1))
        ends = [[Fraction(x.lo, 1 << x.p), Fraction(x.hi, 1 << x.p)] for x in found]
        u, v = (np.array([0.0, 1.0, *(dice.random() for _ in range(9))]) for _ in range(2))
        theta = -np.pi + 2 * np.pi * (i + u) / grid[0]
        phi = float(Fraction(lam[1])) * np.pi / 2 * (2 * (j + v) / grid[1] - 1)
        for at in lam:
            name = scene.get("table") or polar(scene["polar"])
            step = PinballMap(name, lam=at, kernels=False, **shape).step(theta, phi)
            (left, right), (bottom, top) = ([float(x) for x in pair] for pair in ends)
            landed = step.theta + 2 * np.pi * np.rint(((left + right) / 2 - step.theta) / (2 * np.pi))

            assert np.all((landed > left - 1e-12) & (landed < right + 1e-12))
            assert np.all((step.phi > bottom - 1e-12) & (step.phi < top + 1e-12))
            assert right - left < 1 and top - bottom < 0.5  # noqa: PT018  (and it says something)


@pytest.mark.parametrize("left_out", range(3))
def test_a_region_without_one_of_its_runs_is_not_proved(check, left_out):
    given = copy.deepcopy(GIVEN)
    gone = given["runs"].pop((9, 20, 31)[left_out])
    count = 568 - gone[4]
    given["name"] = given["name"].replace("568", str(count))
    given["runs"] = [gone_first for gone_first in given["runs"] if abs(gone_first[2] - gone[2]) < 40]
    given["name"] = given["name"].replace(str(count), str(sum(run[4] for run in given["runs"])))

    with pytest.raises(check.Unproved, match="images_inside"):
        check.checked(given)


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        ({"table": "cardioid"}, "convex_table"),
        ({"table": "cuspless"}, "convex_table"),
        ({"table": "egg", "shape": {"alpha": "3/25"}}, "convex_table"),
        ({"polar": "1 + cos(3*theta)/5"}, "convex_table"),
        ({"polar": "1 + theta/50"}, "not closed"),
        ({"polar": "1 + cos(5*theta)/40", "undefined": [{"name": "m", "component": 0, "theta": "1"}]}, "convex_table"),
        ({"parametric": ["cos(theta)", "sin(theta)"]}, "radii alone"),
        ({"table": "circle", "law": "-lam*eta"}, "laws"),
    ],
)
def test_a_table_that_is_not_convex_smooth_and_under_the_papers_law_is_refused(check, region, scene, why):
    with pytest.raises((check.Unproved, check.Wrong), match=why):
        made(region, scene, ("1/2", "1/2"))


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"lam": ["1/2", "49/100"]}, "out of range"),
        ({"lam": ["1/2", "1"]}, "not of its format"),
        ({"lam": ["2/4", "1/2"]}, "lowest terms"),
        ({"lam": ["0.49", "1/2"]}, "not of its format"),
        ({"lam": ["1/2"]}, "not of its format"),
        ({"lam": ["49/100", "51/100"]}, "name must be"),
        ({"columns": 513}, "name must be"),
        ({"columns": True}, "not of its format"),
        ({"rows": 2**20}, "out of range"),
        ({"parts": 0}, "out of range"),
        ({"runs": []}, "not of its format"),
        ({"runs": [[0, 1, 511, 250, 7]]}, "beyond the grid"),
        ({"runs": [[1, 1, 0, 0, 1]]}, "beyond the grid"),
        ({"runs": [[0, 0, 0, 0, 1]]}, "beyond the grid"),
        ({"runs": [[0, 1, 0, 0, 0]]}, "beyond the grid"),
        ({"runs": [[0, 1, 0, 0, 2], [0, 2, 0, 1, 1]]}, "stands twice"),
        ({"runs": [[0, 1, 0, 0]]}, "not of its format"),
        ({"columns": 8192, "rows": 8192, "runs": [[0, 8192, 0, 0, 1]]}, "up to 60000 cells"),
        *(({"runs": [[0, 1, 0, 0, 1], run]}, "not of its format") for run in ([0, 1, 0, 5.0, 1], [0, 1, 0, 5, True])),
        ({"name": "an attractor"}, "not of its format"),
        ({"schema": 2}, "not of its format"),
        ({"proved_by": "me"}, "not of its format"),
    ],
)
def test_every_entry_is_looked_at(check, change, why):
    with pytest.raises(check.Wrong, match=why):
        check.checked(GIVEN | change)


@pytest.mark.parametrize(("small", "proved"), [(1, True), (Fraction(1, 2), True), (Fraction(1, 8), True), (0, False)])
def test_the_squares_whose_images_are_asked_are_all_of_a_cell(check, region, small, proved):
    """A cell is halved in both directions, up to four times, where an image is not covered or not enclosed."""
    inside, done = region.Inside.__new__(region.Inside), []

    def image(column, row, size):
        if size > 2 * small and (column - row) % 1:
            raise check.Unproved("not enclosed")
        return column, row, size

    inside.image = image
    inside.covered = lambda column, row, size: size <= small and not done.append((column, row, size))
    if not proved:
        with pytest.raises(check.Unproved):
            inside.cell(Fraction(3), Fraction(5), Fraction(1), 4)
        return
    inside.cell(Fraction(3), Fraction(5), Fraction(1), 4)
    assert sum(size**2 for *_, size in done) == 1
    for u, v in [(3 + Fraction(2 * i + 1, 32), 5 + Fraction(2 * k + 1, 32)) for i in range(16) for k in range(16)]:
        assert any(x < u < x + size and y < v < y + size for x, y, size in done)
    assert all(0 <= x - 3 <= 1 - size and 0 <= y - 5 <= 1 - size for x, y, size in done)


def test_blocks_reach_to_the_last_column_and_row_and_each_is_counted(region):
    given = {"columns": 4, "rows": 6, "parts": 1, "runs": [[0, 2, 2, 0, 3], [0, 1, 0, 5, 1]]}
    cells, count = region.blocks(given)

    assert cells == {(column, row) for column in (2, 3) for row in range(6)} | {(0, 5)}
    assert count == 4


def test_an_image_beyond_the_cells_by_less_than_a_rounding_is_not_covered(check, region):
    """At the border of a cell the next cell is needed as well, and beyond the last column the first."""
    inside = made(region, GIVEN["scene"], ("1/2", "1/2"), (16, 8), {(15, j) for j in range(8)})
    number = lambda x: check.I.of(Fraction(x), inside.p)  # noqa: E731
    middle = inside.top * 0
    within = check.pi(inside.p) * number("15/16")

    assert inside.covered(within, middle)
    assert not inside.covered(check.pi(inside.p) * number("7/8"), middle)
    assert not inside.covered(within.hull(check.pi(inside.p)), middle)
    assert inside.covered(within - check.pi(inside.p) * 4, middle)
    with pytest.raises(check.Unproved, match="outside the strip"):
        inside.covered(within, inside.top * 2)


def met(check, region, theta, phi, columns=8, rows=2):
    """The cells met in the strip from -2 to 2; ends are units of the last place, or two of them across."""
    made = SimpleNamespace(columns=columns, rows=rows, p=64, top=check.I.of(2, 64))
    return region.Inside.met(made, check.I(*theta, 64), check.I(*(2 * x for x in phi), 64))


ONE = 1 << 64


INNER = int(0.1 * ONE), int(0.2 * ONE)  # of the fifth column


@pytest.mark.parametrize(
    ("phi", "rows"),
    [
        ((1, ONE // 2), [1]), ((ONE // 4, ONE // 4), [1]), ((ONE // 4, 2 * ONE), [1]), ((ONE, ONE), [1]),
        ((-ONE // 2, -2), [0]), ((-2 * ONE, -ONE // 4), [0]), ((-ONE - 1, -ONE - 1), [0]),
        ((0, ONE // 2), [0, 1]), ((-ONE // 2, -1), [0, 1]), ((-ONE // 2, 0), [0, 1]),
    ],
)  # fmt: skip
def test_a_row_is_met_where_a_rectangle_is_within_it_or_at_its_border(check, region, phi, rows):
    assert met(check, region, INNER, phi) == [(4, row) for row in rows]


@pytest.mark.parametrize("phi", [(-2 * ONE, -ONE - 2), (ONE + 1, 2 * ONE)])
def test_a_rectangle_beyond_the_strip_meets_no_row(check, region, phi):
    with pytest.raises(check.Unproved, match="an image lies outside the strip"):
        met(check, region, INNER, phi)


@pytest.mark.parametrize(
    ("theta", "columns"),
    [
        ((0.1, 0.2), [4]), ((6.3, 6.4), [4]), ((-3.1, -3.0), [0]), ((3.0, 3.1), [7]), ((3.0, 3.2), [7, 0]),
        ((-4.0, -2.0), [6, 7, 0, 1]), ((0.5, 1.0), [4, 5]), ((-0.1, 6.1), [3, 4, 5, 6, 7, 0, 1, 2]),
        ((-4.0, 4.0), [6, 7, 0, 1, 2, 3, 4, 5]), ((-9.0, 9.0), [0, 1, 2, 3, 4, 5, 6, 7]),
    ],
)  # fmt: skip
def test_columns_are_met_round_and_each_but_once(check, region, theta, columns):
    found = met(check, region, tuple(round(x * 2**32) << 32 for x in theta), (ONE // 4, ONE // 2))
    first = found[0][0]
    assert found == [((first + k) % 8, 1) for k in range(len(columns))]
    assert sorted(column for column, _ in found) == sorted(columns)
    assert first == columns[0] or len(columns) == 8
