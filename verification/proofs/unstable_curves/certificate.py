"""The theorem that a region of a table holds at most one attractor, as a JSON document.

The document lists the points from which the region grows, and the saddle. The command `pinball check` recomputes cells,
cones, growth and crossings.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np

from verification.proofs.global_dynamics.images import RangeTheorem
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors
from verification.rigorous.boxes import Boxes
from verification.rigorous.certificate import Certified, entry, whole, whole_number
from verification.rigorous.graph import LARGEST
from verification.rigorous.theorem import Verdict

MOST_POINTS, LONGEST = 64, 64
Point = tuple[int, float, float]


def _charts(read: Mapping[str, Any]) -> int:
    return len(read["scene"].table.components)


def _point(given: Any, charts: int) -> Point:
    """A phase point of a document; `ValueError` if the entry is not a phase point."""
    if not isinstance(given, list) or len(given) != 3:
        raise ValueError(f"certificate: {given!r} is no phase point; accepted: [component, theta, phi]")
    chart, theta, phi = given
    point = whole_number("a component", chart, charts - 1, 0), float(theta), float(phi)
    if not (isfinite(point[1]) and isfinite(point[2])):
        raise ValueError(f"certificate: {given!r} is no phase point; accepted: finite theta and phi")
    return point


def _points(given: Any, charts: int) -> tuple[Point, ...]:
    """The phase points of a document; `ValueError` if there are too many or none."""
    points = tuple(_point(point, charts) for point in given)
    if not 1 <= len(points) <= MOST_POINTS:
        raise ValueError(f"certificate: {len(points)} points; accepted: 1 to {MOST_POINTS}")
    return points


def _half(given: Any) -> float:
    """Half the width of a rectangle, from a document; `ValueError` unless it is between 0 and 1."""
    half = float(given)
    if not 0 < half < 1:
        raise ValueError(f"certificate: half = {half}; accepted: above 0 and below 1")
    return half


@dataclass(frozen=True, eq=False, repr=False)
class AtMostOneAttractor(RangeTheorem, Certified):
    """At most one attractor in the region that grows from points `(component, theta, phi)`, for every `lam` of a range.

    `saddle` is a point of a cycle of `period` bounces, and `half` half the width of the rectangle around it.
    """

    kind = "no two attractors"
    columns: int = field(metadata=whole("columns", LARGEST))
    rows: int = field(metadata=whole("rows", LARGEST))
    points: tuple[Point, ...] = field(
        metadata=entry(lambda given, read: _points(given, _charts(read)), lambda points: [list(x) for x in points])
    )
    saddle: Point = field(metadata=entry(lambda given, read: _point(given, _charts(read)), list))
    period: int = field(metadata=whole("period", LONGEST))
    half: float = field(metadata=entry(lambda given, _: _half(given)))

    @property
    def name(self) -> str:
        """The statement in one line."""
        points = ", ".join(f"({chart}, {theta!r}, {phi!r})" for chart, theta, phi in self.points)
        grid = f"{self.columns} by {self.rows}"
        return f"at most one attractor of {self.map.label}: in the region grown from {points} on a grid of {grid}"

    @cached_property
    def proof(self) -> NoTwoAttractors:
        """Theorem about the map; `ValueError` for a point outside its component or outside the strip of exit angles."""
        for chart, x, y in (*self.points, self.saddle):
            (left, right), (bottom, top) = self.map.charts[chart].x, self.map.charts[chart].y
            if not (left <= x <= right and bottom <= y <= top):
                raise ValueError(
                    f"certificate: ({chart}, {x}, {y}) has theta or phi outside the ranges of component {chart}"
                )
        places = np.array(self.points)[:, 1:].T
        start = Boxes(np.array([point[0] for point in self.points]), *((at, at) for at in places))
        return NoTwoAttractors(self.map, self.columns, self.rows, start, self.saddle, self.period, self.half)

    hypotheses = NoTwoAttractors.hypotheses

    @property
    def checks(self) -> dict[str, Verdict]:
        """The verdicts on the hypotheses of `NoTwoAttractors`."""
        return self.proof.checks
