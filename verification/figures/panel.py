"""What a figure shows, as data: panels of named point sequences, in the quantities of the paper's axes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Fact = str | int | float


class Curve(NamedTuple):
    """Points in order; a nan is a gap, where no line is drawn."""

    x: Array
    y: Array


class Raster(NamedTuple):
    """A label for each cell of a grid: `names[labels[row, column]]`, the first row lowest."""

    x: Array
    y: Array
    labels: NDArray[np.int64]
    names: tuple[str, ...]


@dataclass(frozen=True)
class Panel:
    """One pair of axes. `x` and `y` name what they measure, `facts` what the data were computed from."""

    title: str
    x: str
    y: str
    curves: Mapping[str, Curve]
    raster: Raster | None = None
    facts: Mapping[str, Fact] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """The panel as JSON has it; a gap is null.

        >>> gap = Curve(np.array([0.0, 1.0]), np.array([2.0, np.nan]))
        >>> Panel("a", "s", "s_1", {"T_0": gap}).document()["curves"]["T_0"]
        {'x': [0.0, 1.0], 'y': [2.0, None]}
        """
        curves = {name: {"x": _plain(curve.x), "y": _plain(curve.y)} for name, curve in self.curves.items()}
        found: dict[str, Any] = {"title": self.title, "x": self.x, "y": self.y, **self.facts, "curves": curves}
        if self.raster is not None:
            x, y, labels, names = self.raster
            found["raster"] = {"x": _plain(x), "y": _plain(y), "names": list(names), "labels": labels.tolist()}
        return found


Panels = tuple[Panel, ...]


def scaled(count: int, fine: float, least: int = 2) -> int:
    """How many at resolution `fine`, of which a draft has `count`.

    >>> scaled(100, 8.0), scaled(100, 0.001)
    (800, 2)
    """
    return max(least, round(count * fine))


def _plain(values: Array) -> list[float | None]:
    return [None if value != value else value for value in np.asarray(values, dtype=float).tolist()]
