"""Morse graphs and trapping regions of maps with known dynamics, and false statements that are refused."""

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from symbolic.tables.scene import Scene
from verification.app.cli import main
from verification.arithmetic.arrays import ArrayOps, BallArray
from verification.named.theorems import theorem
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.global_dynamics.regions import Region, region, sampled_share, shares
from verification.rigorous.boxes import Boxes, Chart, Images, PlaneImages
from verification.rigorous.graph import (
    Cells,
    Grid,
    Rectangles,
    halved,
    inside,
    mapped,
    morse_graph,
    refined,
    transitions,
)

EGG = Scene("egg", alpha="0.08", lam="1/2")


def henon() -> PlaneImages:
    """Henon's map `x' = 1 - a*x**2 + y, y' = b*x` at `a = 1.4`, `b = 0.3`."""
    a, b = (ArrayOps().q(p, 10) for p in (14, 3))
    chart = Chart("plane", (-1.5, 1.5), (-0.6, 0.6))
    return PlaneImages("Henon", chart, lambda x, y: (1 - a * x * x + y, b * x), lambda x, y: ((-2 * a * x, 1), (b, 0)))


def logistic(r: Fraction) -> PlaneImages:
    """The logistic map, with a second coordinate that is halved."""
    letter = ArrayOps().q(r.numerator, r.denominator)
    chart = Chart("plane", (-0.05, 1.05), (-1.0, 1.0))
    return PlaneImages(
        "logistic",
        chart,
        lambda x, y: (letter * x * (1 - x), y * 0.25),
        lambda x, y: ((letter * (1 - 2 * x), 0.0), (0.0, 0.25)),
    )


def test_henons_quadrilateral_is_kept_by_outer_images():
    """Henon 1976, section 4, prints the four vertices of a region that the map takes into itself."""
    corners = np.array([(-1.33, 0.42), (1.32, 0.133), (1.245, -0.14), (-1.06, -0.5)])
    map = henon()
    grid = Grid(map.charts, 1024, 1024)
    cells = grid.whole()
    boxes = grid.boxes(cells)
    meets = wholly = np.ones(cells.chart.size, dtype=bool)
    for (px, py), (qx, qy) in zip(corners, np.roll(corners, -1, axis=0), strict=True):  # clockwise: inside is right
        sides = [(qx - px) * (y - py) - (qy - py) * (x - px) for x in boxes.x for y in boxes.y]
        meets, wholly = meets & (np.min(sides, axis=0) <= 0), wholly & (np.max(sides, axis=0) <= 0)
    block = Cells(*(field[meets] for field in cells))
    held = inside(grid, block, *mapped(map, grid, block))

    assert wholly.sum() > 100_000
    assert np.all(held[wholly[meets]])


def test_henons_attractor_has_a_trapping_region():
    map = henon()
    graph = morse_graph(refined(map, Grid(map.charts, 1024, 1024), 8))
    (attractor,) = [i for i in graph.attracting if graph.transitions.count not in graph.sets[i]]
    block = graph.transitions.chosen(graph.trapping(attractor))
    grid = graph.transitions.grid

    assert not graph.trapping(attractor)[-1]
    assert np.all(inside(grid, block, *mapped(map, grid, block)))
    picture, (x, y) = grid.to_array(block, np.ones(block.chart.size, dtype=bool))[0], (0.1, 0.1)
    for n in range(2_000):
        x, y = 1 - 1.4 * x * x + y, 0.3 * x
        if n > 50:
            assert picture[int((x + 1.5) / 3 * 1024), int((y + 0.6) / 1.2 * 1024)]


def test_the_logistic_maps_cycle_of_period_two_attracts():
    map = logistic(Fraction(33, 10))
    graph = morse_graph(refined(map, Grid(map.charts, 512, 32), 4))
    found = [i for i in graph.attracting if graph.transitions.count not in graph.sets[i]]
    fixed = 1 - 10 / 33
    (attractor,) = found
    boxes = graph.transitions.grid.boxes(
        graph.transitions.chosen(np.isin(np.arange(graph.transitions.count + 1), graph.sets[attractor]))
    )

    assert not np.any((boxes.x[0] <= fixed) & (fixed <= boxes.x[1]))
    for x in (0.4794270198, 0.8236032832):  # the cycle, to ten digits
        assert np.any((boxes.x[0] <= x) & (x <= boxes.x[1]) & (boxes.y[0] <= 0) & (boxes.y[1] >= 0))


def test_of_a_rotation_nothing_is_said_but_the_whole():
    turn = ArrayOps().q(3, 10)
    map = PlaneImages(
        "rotation",
        Chart("cylinder", (-np.pi, np.pi), (-1.0, 1.0), True, True),
        lambda x, y: (x + turn, y),
        lambda x, y: ((1.0, 0.0), (0.0, 1.0)),
    )
    graph = morse_graph(transitions(map, grid := Grid(map.charts, 64, 16), grid.whole()))

    assert [len(members) for members in graph.sets] == [64 * 16]


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


def test_an_image_that_leaves_the_chart_leads_outside():
    half, unit = BallArray(0.5), ((1.0, 0.0), (0.0, 1.0))
    away = PlaneImages("shift", Chart("plane", (0, 1), (0, 1)), lambda x, y: (x + half, y), lambda x, y: unit)
    graph = morse_graph(transitions(away, grid := Grid(away.charts, 8, 8), grid.whole()))

    assert all(graph.trapping(i)[-1] for i in range(len(graph.sets)))


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
