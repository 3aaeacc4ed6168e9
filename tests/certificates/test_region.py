"""Trapping regions by the second reader: images hold what they must, and cells that hold no more prove nothing."""

import copy
import json
import random
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from numeric import PinballMap
from symbolic.tables import polar

GIVEN = json.loads((Path(__file__).parents[2] / "certificates" / "triangle-region.json").read_text())
SCENES = [
    ({"table": "egg", "shape": {"alpha": "2/25"}}, {"alpha": "0.08"}, ("49/100", "1/2")),
    ({"table": "ellipse", "shape": {"a": "3/2"}}, {"a": "3/2"}, ("9/10", "9/10")),
    ({"polar": "1 + cos(5*theta)/40"}, {}, ("1/5", "1/4")),
]


@pytest.fixture(scope="module")
def region(check):
    return check.beside("region")


def made(region, scene, lam, grid=(16, 8), cells=()):
    """The reader's images and cells of a scene."""
    table, _, low, high = region.placed({"scene": scene, "lam": list(lam)})
    region.convex(table)
    return region.Inside(table, low.hull(high), high, grid, set(cells))


@pytest.mark.parametrize(("scene", "shape", "lam"), SCENES)
def test_an_image_holds_where_the_map_takes_every_point_of_its_cell(region, scene, shape, lam):
    """By the kernels' arrays, whose error is far below the slack; ends of the cell and of the contractions too."""
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
        (["circle"], "laws"),
    ],
)
def test_a_table_that_is_not_convex_smooth_and_under_the_papers_law_is_refused(check, region, scene, why):
    with pytest.raises((check.Unproved, check.Wrong), match=why):
        made(region, scene, ("1/2", "1/2"))


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"lam": ["1/2", "49/100"]}, "out of range"),
        ({"lam": ["1/2", "1"]}, "out of range"),
        ({"lam": ["2/4", "1/2"]}, "lowest terms"),
        ({"lam": ["0.49", "1/2"]}, "lowest terms"),
        ({"lam": ["1/2"]}, "two numbers"),
        ({"lam": ["49/100", "51/100"]}, "name must be"),
        ({"columns": 513}, "name must be"),
        ({"columns": True}, "out of range"),
        ({"rows": 2**20}, "out of range"),
        ({"parts": 0}, "out of range"),
        ({"runs": []}, "no cell"),
        ({"runs": [[0, 1, 511, 250, 7]]}, "beyond the grid"),
        ({"runs": [[1, 1, 0, 0, 1]]}, "beyond the grid"),
        ({"runs": [[0, 0, 0, 0, 1]]}, "beyond the grid"),
        ({"runs": [[0, 1, 0, 0, 0]]}, "beyond the grid"),
        ({"runs": [[0, 1, 0, 0, 2], [0, 2, 0, 1, 1]]}, "stands twice"),
        ({"runs": [[0, 1, 0, 0]]}, "five whole numbers"),
        *(({"runs": [[0, 1, 0, 0, 1], run]}, "five whole numbers") for run in ([0, 1, 0, 5.0, 1], [0, 1, 0, 5, True])),
        ({"name": "an attractor"}, "name must be"),
        ({"schema": 2}, "schema 1"),
        ({"proved_by": "me"}, "entries"),
    ],
)
def test_every_entry_is_looked_at(check, change, why):
    with pytest.raises(check.Wrong, match=why):
        check.checked(GIVEN | change)


@pytest.mark.parametrize(("small", "proved"), [(1, True), (Fraction(1, 2), True), (Fraction(1, 8), True), (0, False)])
def test_the_squares_whose_images_are_asked_are_all_of_a_cell(check, region, small, proved):
    """Halved both ways, up to four times, where an image is not covered or not enclosed."""
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
    """At the border of a cell the next one is asked for as well, and beyond the last column the first."""
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
