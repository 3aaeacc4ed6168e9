"""What the kernels need to know of a table: programs and a few facts, as plain data.

A blueprint is made once from the exact table, through `numeric.lowering.lower`, the only place where SymPy
is imported. Those of the paper's tables are kept on disk, so that a warm run never imports it.
"""

import json
from fractions import Fraction
from typing import Any, NamedTuple

from numeric.lowering import cache
from numeric.lowering.program import Program

PAPER = ("circle", "ellipse", "cardioid", "cuspless", "egg")


class ShapeRange(NamedTuple):
    """A shape parameter, its closed range (None for no bound) and what fails outside."""

    name: str
    low: str | None
    high: str | None
    otherwise: str

    def check(self, table: str, value: Fraction) -> None:
        """Refuse a value outside the range, in one sentence."""
        below = self.low is not None and value < Fraction(self.low)
        above = self.high is not None and value > Fraction(self.high)
        if below or above:
            high = "oo)" if self.high is None else f"{self.high}]"
            low = "(-oo" if self.low is None else f"[{self.low}"
            shown = value if value.denominator < 10**6 else float(value)
            raise ValueError(f"{table}: {self.name} = {shown} {self.otherwise}; {self.name} must lie in {low}, {high}")


class Part(NamedTuple):
    """A component: its parameter's ends and its curve, as programs in `theta` and the shape.

    `curve` has the six outputs `x, y` and their first and second derivatives.
    """

    name: str
    ends: Program
    curve: Program


class Blueprint(NamedTuple):
    """A table as the kernels see it.

    `same_as` names the paper's table with the same boundary, among those with a flight of their own; `programs` are
    those of a closed curve that is a finite Fourier sum.
    """

    table: str
    same_as: str
    shape: tuple[ShapeRange, ...]
    parts: tuple[Part, ...]
    programs: tuple[tuple[str, Program], ...]
    origin: tuple[int, Program]

    def program(self, name: str) -> Program:
        """A program by name."""
        return dict(self.programs)[name]

    def has(self, name: str) -> bool:
        """Is there a program of this name?"""
        return any(name == known for known, _ in self.programs)

    def as_text(self) -> str:
        """The blueprint as JSON; equal blueprints have equal text."""
        data = {
            "table": self.table,
            "same_as": self.same_as,
            "shape": [[s.name, s.low, s.high, s.otherwise] for s in self.shape],
            "parts": [[p.name, p.ends.as_data(), p.curve.as_data()] for p in self.parts],
            "programs": [[name, program.as_data()] for name, program in self.programs],
            "origin": [self.origin[0], self.origin[1].as_data()],
        }
        return json.dumps(data, separators=(",", ":"))

    @staticmethod
    def from_text(text: str) -> "Blueprint":
        """The inverse of `as_text`."""
        data = json.loads(text)
        read = Program.from_data
        return Blueprint(
            data["table"],
            data["same_as"],
            tuple(ShapeRange(*entry) for entry in data["shape"]),
            tuple(Part(name, read(ends), read(curve)) for name, ends, curve in data["parts"]),
            tuple((name, read(program)) for name, program in data["programs"]),
            (data["origin"][0], read(data["origin"][1])),
        )


def blueprint(table: Any, K: int = 3) -> Blueprint:
    """The blueprint of an exact table, or of one of the paper's tables by name.

    >>> blueprint("circle").same_as
    'circle'
    """
    if not isinstance(table, str):
        from numeric.lowering.lower import drawn

        return drawn(table)
    if table not in PAPER:
        raise ValueError(f"no table is called {table!r}; the paper's are {', '.join(PAPER)}")
    name = f"{table}{K}" if table == "egg" else table
    kept = cache.read("blueprint", name, cache.sources("symbolic", "numeric"))
    if kept is not None:
        try:
            return Blueprint.from_text(kept.decode())
        except (ValueError, KeyError, TypeError, IndexError):
            pass  # a damaged file is as good as none: it is written again
    from numeric.lowering.lower import named

    found = named(table, K)
    cache.write("blueprint", name, cache.sources("symbolic", "numeric"), found.as_text().encode())
    return found
