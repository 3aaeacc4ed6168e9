"""Trapping regions as statements that stand alone: which boxes, of which map; proved again without the search.

A trapping region is a set of boxes that the map takes into its interior. What proves it is short: the outer image of
each of its boxes meets no cell outside it. So every orbit that enters it stays, and what such orbits come near again
and again, their limit sets, lies inside; regions without a common point hold different attractors. On a table with
joins this speaks of orbits that never land on one.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics.graph import LARGEST, Cells, Grid, MorseGraph, inside, mapped
from verification.proofs.global_dynamics.images import PinballImages

KIND, SCHEMA = "trapping region", 1
MOST_PARTS, MOST_BOXES = 16, 1 << 24


@dataclass(frozen=True)
class Region:
    """A union of blocks of cells in the strip `|phi| <= HIGH*pi/2`, said to be trapping for every `lam` of a range.

    `parts` by `parts` is how finely each box is cut before it is mapped.
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    columns: int
    rows: int
    parts: int
    cells: Cells

    @cached_property
    def map(self) -> PinballImages:
        """The map, over all of the range at once; `ValueError` unless the table is proved convex."""
        return PinballImages(self.scene, self.lam)

    @property
    def name(self) -> str:
        """What is stated."""
        count = self.cells.chart.size
        boxes = f"{count} box{'es'[: 2 * (count > 1)]} on a grid of {self.columns} by {self.rows}"
        return f"trapping region of {self.map.label}: {boxes}"

    @property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        grid = Grid(self.map.charts, self.columns, self.rows)
        met, lost = mapped(self.map, grid, self.cells, self.parts)
        trapped = inside(grid, self.cells, met, lost)
        return {
            "convex_table": True,
            "images_enclosed": _proved(not lost.any()),
            "images_inside": _proved(trapped.all()),
        }

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document; blocks above one another are one run."""
        low, high = self.lam
        said = {"schema": SCHEMA, "name": self.name, "kind": KIND, "scene": self.scene.document}
        numbers = {"lam": [str(low), str(high)], "columns": self.columns, "rows": self.rows, "parts": self.parts}
        return said | numbers | {"runs": list(_runs(self.cells))}

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> "Region":
        """The region of a document; `ValueError` names what is wrong with it."""
        try:
            if given["schema"] != SCHEMA or given["kind"] != KIND:
                raise ValueError(f"certificate: {given['kind']!r} of schema {given['schema']!r} is no {KIND}")
            scene = Scene.of(given["scene"])
            low, high = (Fraction(str(text)) for text in given["lam"])
            columns, rows, parts = (_whole(name, given[name], LARGEST) for name in ("columns", "rows", "parts"))
            if parts > MOST_PARTS:
                raise ValueError(f"certificate: parts = {parts} is out of range; accepted: 1 to {MOST_PARTS}")
            charts = len(scene.table.components)
            return cls(scene, (low, high), columns, rows, parts, _unrolled(given["runs"], charts, columns, rows))
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def checked(given: Mapping[str, Any]) -> tuple[str, dict[str, bool | None]]:
    """What a document states, and its checklist worked through anew; a wrong name is refused."""
    region = Region.from_dict(given)
    if given.get("name") != region.name:
        said = ascii(given.get("name"))[:80]
        raise ValueError(f"certificate: name = {said} is not what it states, which is {region.name!r}")
    return region.name, region.checks


def region(map: PinballImages, graph: MorseGraph, index: int, parts: int = 1) -> Region | None:
    """The trapping region of a Morse set; None when walks from it lead outside."""
    block = graph.trapping(index)
    if block[-1]:
        return None
    grid = graph.transitions.grid
    return Region(map.scene, map.range, grid.columns, grid.rows, parts, graph.transitions.chosen(block))


def shares(graph: MorseGraph, index: int) -> tuple[float, float]:
    """Bounds for the share of phase space, by area in `theta` and `phi`, whose orbits end in a trapping region.

    Below: the boxes from which every walk ends there. Above: those from which some walk does.
    """
    block = graph.trapping(index)
    cells, grid = graph.transitions.cells, graph.transitions.grid
    width = np.array([(c.x[1] - c.x[0]) * (c.y[1] - c.y[0]) for c in grid.charts])
    area = cells.size.astype(float) ** 2 * width[cells.chart] * graph.transitions.leaf
    sure, maybe = graph.basin(block)[:-1], graph.transitions.reached(block, backward=True)[:-1]
    slack = 1e-9  # far more than a sum of at most 2**28 positive doubles errs by, relatively
    low, high = (float(area[some].sum() / area.sum()) for some in (sure, maybe))
    return max(0.0, low - slack), min(1.0, high + slack)


def _proved(held: Any) -> bool | None:
    return True if held else None  # an image that juts out may be the fault of its enclosure: nothing is refuted


def _runs(cells: Cells) -> Iterator[list[int]]:
    """`[chart, size, column, row, how many]` for blocks that stand on one another."""
    order = np.lexsort((cells.row, cells.column, cells.size, cells.chart))
    chart, column, row, size = (field[order].tolist() for field in cells)
    run: list[int] = []
    for entry in zip(chart, size, column, row, strict=True):
        if run and list(entry) == [*run[:3], run[3] + run[1] * run[4]]:
            run[4] += 1
        else:
            if run:
                yield run
            run = [*entry, 1]
    if run:
        yield run


def _unrolled(runs: Any, charts: int, columns: int, rows: int) -> Cells:
    """The blocks of runs; none may jut out of the grid."""
    found = np.array([[_whole("a run", x, LARGEST, 0) for x in run] for run in runs], dtype=np.int64)
    if found.ndim != 2 or found.shape[1] != 5 or not 1 <= int(found[:, 4].sum()) <= MOST_BOXES:
        raise ValueError("certificate: runs is no list of [chart, size, column, row, how many]")
    chart, size, column, row, count = found.T
    good = (chart < charts) & (size >= 1) & (count >= 1) & (column + size <= columns) & (row + size * count <= rows)
    if not np.all(good):
        raise ValueError(f"certificate: the run {found[~good][0].tolist()} juts out of {columns} by {rows} cells")
    own = np.repeat(np.arange(chart.size), count)
    step = np.arange(own.size) - np.repeat(np.cumsum(count) - count, count)
    return Cells(chart[own], column[own], row[own] + step * size[own], size[own])


def _whole(name: str, given: Any, most: int, least: int = 1) -> int:
    if isinstance(given, bool) or not isinstance(given, int) or not least <= given <= most:
        raise ValueError(f"certificate: {name} holds {given!r}; accepted: whole numbers from {least} to {most}")
    return given
