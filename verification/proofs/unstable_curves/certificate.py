"""That a region of a table holds at most one attractor, as a document; `pinball check` proves it anew.

The document says from which points the region grows and where the saddle is, the two things that were looked for. Its
cells, cones, growth and crossings are computed again, and nothing that it says of itself is believed.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np

from symbolic.tables.scene import Scene
from verification.proofs.global_dynamics import Boxes, PinballImages
from verification.proofs.global_dynamics.graph import LARGEST
from verification.proofs.global_dynamics.regions import stated, whole
from verification.proofs.unstable_curves.no_two_attractors import NoTwoAttractors

KIND, SCHEMA = "no two attractors", 1
MOST_POINTS, LONGEST = 64, 64
Point = tuple[int, float, float]


@dataclass(frozen=True)
class Certificate:
    """At most one attractor in the region that grows from points `(component, theta, phi)`, for every `lam` of a range.

    `saddle` is a point of a cycle of `period` bounces, and `half` half the width of the rectangle about it.
    """

    scene: Scene
    lam: tuple[Fraction, Fraction]
    columns: int
    rows: int
    points: tuple[Point, ...]
    saddle: Point
    period: int
    half: float

    @cached_property
    def map(self) -> PinballImages:
        """The map, over all of the range at once; `ValueError` unless the table is proved convex."""
        return PinballImages(self.scene, self.lam)

    @property
    def name(self) -> str:
        """What is stated."""
        points = ", ".join(f"({chart}, {theta!r}, {phi!r})" for chart, theta, phi in self.points)
        grid = f"{self.columns} by {self.rows}"
        return f"at most one attractor of {self.map.label}: in the region grown from {points} on a grid of {grid}"

    @property
    def proof(self) -> NoTwoAttractors:
        """What is to be proved; `ValueError` for a point outside of its component or the strip."""
        for chart, x, y in (*self.points, self.saddle):
            (left, right), (bottom, top) = self.map.charts[chart].x, self.map.charts[chart].y
            if not (left <= x <= right and bottom <= y <= top):
                raise ValueError(f"certificate: ({chart}, {x}, {y}) is outside of its component, or of the strip")
        places = np.array(self.points)[:, 1:].T
        start = Boxes(np.array([point[0] for point in self.points]), *((at, at) for at in places))
        return NoTwoAttractors(self.map, self.columns, self.rows, start, self.saddle, self.period, self.half)

    @property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        return self.proof.needed

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document."""
        said = {"schema": SCHEMA, "name": self.name, "kind": KIND, "scene": self.scene.document}
        grid = {"lam": [str(end) for end in self.lam], "columns": self.columns, "rows": self.rows}
        points = {"points": [list(point) for point in self.points], "saddle": list(self.saddle)}
        return said | grid | points | {"period": self.period, "half": self.half}

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> "Certificate":
        """The statement of a document; `ValueError` names what is wrong with it."""
        try:
            scene, lam = stated(given, KIND, SCHEMA)
            columns, rows = (whole(name, given[name], LARGEST) for name in ("columns", "rows"))
            charts = len(scene.table.components)
            points = tuple(_point(point, charts) for point in given["points"])
            if not 1 <= len(points) <= MOST_POINTS:
                raise ValueError(f"certificate: {len(points)} points; accepted: 1 to {MOST_POINTS}")
            saddle, half = _point(given["saddle"], charts), float(given["half"])
            if not 0 < half < 1:
                raise ValueError(f"certificate: half = {half}; accepted: above 0 and below 1")
            return cls(scene, lam, columns, rows, points, saddle, whole("period", given["period"], LONGEST), half)
        except (KeyError, IndexError, TypeError, AttributeError, OverflowError) as error:
            raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def _point(given: Any, charts: int) -> Point:
    """A phase point of a document."""
    if not isinstance(given, list) or len(given) != 3:
        raise ValueError(f"certificate: {given!r} is no phase point; accepted: [component, theta, phi]")
    chart, theta, phi = given
    point = whole("a component", chart, charts - 1, 0), float(theta), float(phi)
    if not (isfinite(point[1]) and isfinite(point[2])):
        raise ValueError(f"certificate: {given!r} is no phase point")
    return point
