"""Trapping regions of tables and their documents, and the grid on which they stand."""

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from symbolic.tables.scene import Scene
from verification.app.cli import main
from verification.named.theorems import theorem
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.global_dynamics.regions import Region, region, sampled_share, shares
from verification.rigorous.boxes import Boxes, Chart, Images
from verification.rigorous.graph import Cells, Grid, Rectangles, halved, inside, morse_graph, refined

EGG = Scene("egg", alpha="0.08", lam="1/2")


@pytest.fixture(scope="module")
def small_region() -> Region:
    map = PinballImages(EGG)
    graph = morse_graph(refined(map, Grid(map.charts, 512, 256), 4))
    found = [region(map, graph, index) for index in graph.attracting]

    assert len(found) == 3  # attractors at least, since no point is in two regions
    assert None not in found
    assert sum(low for low, _ in (shares(graph, i) for i in graph.attracting)) < 1
    for index in graph.attracting:  # a sample is in the bounds but for what its size explains
        (low, high), (share, error) = shares(graph, index), sampled_share(map, graph, index)
        assert low - 4 * error <= share <= high + 4 * error
    return min(found, key=lambda block: block.cells.chart.size)


def test_a_region_is_proved_again_from_its_document_alone(small_region):
    document = json.loads(json.dumps(small_region.to_dict()))
    found = theorem(document)

    assert found.proved
    assert found.name == small_region.name


def test_a_region_of_which_one_box_is_removed_is_refused(small_region):
    cells = small_region.cells
    for lost in range(0, cells.chart.size, 40):
        block = Cells(*(np.delete(field, lost) for field in cells))
        assert replace(small_region, cells=block).checks["images_inside"] is None


def test_a_region_of_another_contraction_is_refused(small_region):
    document = small_region.to_dict() | {"lam": ["2/5", "1/2"]}
    with pytest.raises(ValueError, match="is not what it states"):
        theorem(document)
    renamed = document | {"name": Region.from_dict(document).name}
    assert not theorem(renamed).proved


@pytest.mark.parametrize(
    "entry",
    [{"runs": []}, {"runs": [[0, 1, 511, 0, 2], [0, 1, 512, 0, 1]]}, {"runs": [[0, 1, 0, 250, 9]]}, {"parts": 99},
     {"columns": 1 << 19, "rows": 1 << 19}, {"runs": "all"}, {"lam": ["1/2", "1"]}, {"schema": 2}, {"rows": True}],
)  # fmt: skip
def test_documents_that_are_no_regions_are_refused_in_one_sentence(small_region, entry):
    document = small_region.to_dict() | entry
    with pytest.raises(ValueError, match=r"accepted|certificate|invalid literal"):
        theorem(document)


def test_the_command_says_what_is_proved_and_its_certificates_check(tmp_path, capsys):
    arguments = ["egg", "--alpha", "0.08", "--lam", "0.5", "--columns", "256", "--rows", "128"]
    status = main(["morse", *arguments, "--certificates", str(tmp_path), "--plot", str(tmp_path / "morse.png")])
    shown = capsys.readouterr().out

    assert status == 0
    assert "proved: trapping region of egg" in shown
    assert (tmp_path / "morse.png").stat().st_size > 1000
    for path in tmp_path.glob("*.json"):
        assert main(["check", str(path)]) == 0


CHARTS = Chart("turning", (-np.pi, np.pi), (-0.1, 0.7), True), Chart("plain", (0.1, 0.3), (-1.0, 1.0))


def test_boxes_of_blocks_jut_out_by_rounding_alone():
    """Against rational numbers, for boxes and parts of boxes."""
    grid = Grid(CHARTS, 12, 7 * 4)
    for cells in (grid.whole(), grid.whole(4), halved(grid.whole(4))):
        boxes = grid.boxes(cells)
        (parts, source), across, up = boxes.parts(3, 2), 3, 2
        for side, first, count, cut in (("x", cells.column, 12, across), ("y", cells.row, 28, up)):
            ends, smaller = getattr(boxes, side), getattr(parts, side)
            for i in range(0, cells.chart.size, 5):
                low, high = (Fraction(float(end)) for end in getattr(CHARTS[cells.chart[i]], side))
                step, slack = (high - low) / count, Fraction(1, 10**14)
                exact = [low + int(first[i]) * step, low + int(first[i] + cells.size[i]) * step]
                assert exact[0] - slack < Fraction(float(ends[0][i])) <= exact[0]
                assert exact[1] <= Fraction(float(ends[1][i])) < exact[1] + slack
                own = np.flatnonzero(source == i)
                found = sorted({(float(smaller[0][k]), float(smaller[1][k])) for k in own})
                assert len(own) == across * up
                assert found[0][0] == ends[0][i]
                assert max(high for _, high in found) == ends[1][i]
                assert all(b[0] <= a[1] < b[0] + 1e-13 for a, b in pairwise(found))
                assert max(b - a for a, b in found) < float(exact[1] - exact[0]) / cut + 1e-13


def test_rectangles_meet_the_cells_of_all_their_points():
    """Across the seam of a periodic chart, and beyond the ends of one that is not."""
    random, grid = np.random.default_rng(2), Grid(CHARTS, 12, 8)
    for _ in range(300):
        number = int(random.integers(2))
        chart = CHARTS[number]
        sides = []
        for low, high in (chart.x, chart.y):
            middle, half = random.uniform(low, high), random.uniform(0, 0.4) * (high - low)
            sides.append((np.array([middle - half]), np.array([middle + half])))
        met = grid.met(Images(np.zeros(1, dtype=int), Boxes(np.array([number]), *sides), np.zeros(0, dtype=int)))
        share = [
            [(end[0] - low) / (high - low) for end in side]
            for side, (low, high) in zip(sides, (chart.x, chart.y), strict=True)
        ]
        out = share[1][0] < 0 or share[1][1] > 1 or (number == 1 and (share[0][0] < 0 or share[0][1] > 1))
        columns, rows = (
            np.floor(np.linspace(*part, 500) * count).astype(int) for part, count in zip(share, (12, 8), strict=True)
        )
        rows = rows[(rows >= 0) & (rows < 8)]
        columns = columns % 12 if number == 0 else columns[(columns >= 0) & (columns < 12)]

        assert bool(met.out[0]) is bool(out)
        assert {k % 12 for k in range(met.left[0], met.right[0] + 1)} == set(columns)
        assert 0 <= met.left[0] <= met.right[0] < met.left[0] + 12
        assert set(range(met.bottom[0], met.top[0] + 1)) == set(rows)


def test_on_a_border_both_cells_are_met():
    unit = Chart("unit", (0.0, 1.0), (0.0, 1.0))
    for kept in (False, True):
        grid = Grid((unit._replace(kept=kept),), 4, 4)
        sides = [(np.array([x]), np.array([y])) for x, y in ((0.25, 0.5), (-0.1, 1.5))]
        met = grid.met(Images(np.zeros(1, dtype=int), Boxes(np.array([0]), *sides), np.zeros(0, dtype=int)))

        assert [int(x[0]) for x in met[2:6]] == [0, 2, 0, 3]
        assert bool(met.out[0]) is not kept


def test_a_block_is_mapped_inside_with_every_cell():
    """Against a count of single cells, also across the seam."""
    random, grid = np.random.default_rng(4), Grid(CHARTS, 6, 4)
    for share in (0.5, 0.9, 1.0):
        member = random.random((2, 6, 4)) < share
        chart, column, row = np.nonzero(member)
        cells = Cells(chart, column, row, np.ones(chart.size, dtype=int))
        count = 200
        source, on = random.integers(0, chart.size, count), random.integers(0, 2, count)
        left, bottom = random.integers(0, 6, count), random.integers(0, 4, count)
        right = left + random.integers(0, 6, count) * (on == 0)
        top = np.minimum(bottom + random.integers(0, 2, count), 3)
        out, lost = random.random(count) < 0.02, random.random(chart.size) < 0.05
        wanted = ~lost
        for k in range(count):
            held = all(
                member[on[k], i % 6, j] for i in range(left[k], right[k] + 1) for j in range(bottom[k], top[k] + 1)
            )
            wanted[source[k]] &= held and not out[k]
        found = inside(grid, cells, Rectangles(source, on, left, right, bottom, top, out), lost)

        assert np.array_equal(found, wanted)


@pytest.mark.parametrize(
    ("columns", "rows"), [(0, 1), (1, 0), ((1 << 20) + 1, 1), (1, (1 << 20) + 1), (1 << 13, 1 << 12)]
)
def test_a_grid_without_cells_or_with_too_many_is_refused(columns, rows):
    with pytest.raises(ValueError, match="grid: "):
        Grid(CHARTS, columns, rows)
    assert Grid(CHARTS, 1, 1).whole().chart.size == 2
    assert Grid(CHARTS[:1], 1 << 20, 16).columns == 1 << 20
