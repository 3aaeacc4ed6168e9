"""Float64 aids for a flight in many digits: a guess of the landing, and a proof that the flight meets nothing before
it.

Newton's method with doubling precision (`precisions`) refines the guess, on a curve compiled once for each number
system (`curve`). `Obstacles` shows that the landing is the first hit. On a table that is proved convex this is clear,
since a line meets its boundary only twice. On others the boundary is covered by boxes, with bounds for all points in
them. Each box is off the line, or not between the ends of the flight, or on a stretch where the line is crossed once,
at one end of the flight. So nothing that is proved rests on the kernel.
"""

from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from functools import cache, cached_property
from typing import Any

import numpy as np

from numeric import PinballMap
from numeric.backends.intervals import CentredIntervals, Interval
from numeric.lowering.program import BINARY, ROOTS, Program
from symbolic.expressions.text import Kernel, load
from symbolic.tables.joins import following
from verification.arithmetic.balls import working
from verification.maps.first_hit import turns_once

Curve = Callable[[Any], Sequence[Any]]  # from the parameter to the outputs of a program
Place = tuple[int, Any, Any, Any]  # component and parameter of a bounce, and its point

GUESSED = 48  # bits that are right in a kernel's guess
SPARE = 12  # bits more than half of those wanted, before a Newton step
STEEPEST = 1.57  # radians: for a steeper flight there is no guess
BESIDE = 2.0**-40  # share of a component's range: so near its end there is no guess
CELLS = 256  # boxes of a component
FAR = 2.0**100  # half width of a box about which nothing is known
SLACK = 2.0**-40  # times the size of the table: more than the rounding errors of a flight


def curve(program: Program, ops: Any, shape: Sequence[Any], count: int = 6) -> Curve:
    """The first `count` outputs (point, velocity, ...) of a component's curve as a function of its parameter.

    Expressions that depend on the shape alone are computed once, in advance.

    >>> from numeric.lowering.program import table_ir
    >>> from verification.arithmetic.balls import FLOAT64
    >>> curve(table_ir("ellipse").parts[0].curve, FLOAT64, [2.0], 2)(0.0)
    (2.0, 0.0)
    """
    kernel = _closure(program.only(*range(count)) if count < len(program.outputs) else program, hasattr(ops, "turned"))
    found: Curve = load(kernel, ops)(*shape)
    return found


@cache
def _closure(program: Program, both: bool) -> Kernel:
    """Source of a function of all inputs but the first that returns a function of the first; `both` uses `turned`."""
    first, words = len(program.inputs), set[str]()
    moving, outside, inside = {0}, list[str](), list[str]()
    turned = set[int]()
    for number, (word, *operands) in enumerate(program.lines, start=first):
        moves = word != "q" and not moving.isdisjoint(operands)
        if moves:
            moving.add(number)
        lines = inside if moves else outside
        if word in BINARY:
            value = f"v{operands[0]} {word} v{operands[1]}"
        elif word == "neg":
            value = f"-v{operands[0]}"
        elif both and word in ("cos", "sin"):
            (at,) = operands
            if at not in turned:
                lines.append(f"c{at}, s{at} = turned(v{at})")
                turned.add(at)
                words.add("turned")
            value = f"{word[0]}{at}"
        else:
            given = list(map(str, operands)) if word == "q" else [f"v{i}" for i in operands]
            name = "root" if word in ROOTS else word
            words.add(name)
            value = (
                name
                if word == "pi"
                else f"{name}({', '.join([*given, *([str(ROOTS[word])] if word in ROOTS else [])])})"
            )
        lines.append(f"v{number} = {value}")
    results = ", ".join(f"v{i}" for i in program.outputs)
    text = "\n".join(
        [
            f"def curve({', '.join(f'v{i}' for i in range(1, first))}):",
            *(f"    {line}" for line in outside),
            "    def at(v0):",
            *(f"        {line}" for line in inside),
            f"        return ({results},)",
            "    return at",
        ]
    )
    return Kernel("curve", program.inputs[1:], ("at",), tuple(sorted(words)), text)


def precisions(bits: int) -> list[int]:
    """Working precision in bits of each Newton step, from a kernel's guess to a zero with `bits` bits.

    >>> precisions(400)
    [71, 118, 212, 400]
    """
    found = [bits]
    while found[-1] > 2 * GUESSED:
        found.append(found[-1] // 2 + SPARE)
    return found[::-1]


class Curves(dict[int, Curve]):
    """Functions for point and velocity, by component, compiled on first use; `bits` is the precision of balls."""

    def __init__(self, programs: Sequence[Program], ops: Any, shape: Sequence[Any], count: int = 4, bits: int = 0):
        super().__init__()
        self.programs, self.given, self.bits = programs, (ops, shape, count), bits

    def __missing__(self, component: int) -> Curve:
        with working(self.bits) if self.bits else nullcontext():
            return self.setdefault(component, curve(self.programs[component], *self.given))


class Landings:
    """Guesses of the landings on a table, by its float64 kernel."""

    def __init__(self, map: PinballMap) -> None:
        self.map = map if map.lam.size == 1 else map.at(float(map.lam.flat[0]))

    def guess(self, theta: float, phi: float, component: int) -> tuple[int, float] | None:
        """Component and parameter of the landing in float64; None where the guess is unreliable.

        It is unreliable where the particle stops or flies along the boundary, and near the ends of components.
        """
        if not (self._within(component, theta) and abs(phi) < STEEPEST):
            return None
        step = self.map.step(theta, phi, component)
        where, at = int(step.component), float(step.theta)
        return None if step.code or not self._within(where, at) else (where, at)

    def _within(self, component: int, theta: float) -> bool:
        low, high = self.map.states.ends[component]
        edge = BESIDE * (high - low)
        return bool(low + edge < theta < high - edge)


class Obstacles:
    """Proofs that a flight on the table of a map meets nothing before it lands.

    >>> flower = Obstacles(PinballMap("circle"))
    >>> flower.convex
    True
    """

    def __init__(self, map: PinballMap) -> None:
        self.map = map

    @cached_property
    def convex(self) -> bool:
        """Is the table proved to be convex? Then a line crosses its boundary only twice."""
        with suppress(ValueError):  # a shape beyond what a table may have
            return _convex(self.map.table)
        return False

    def passed(self, start: Place, end: Place, radius: float = 0.0) -> bool:
        """Is the flight from `start` to `end` proved to meet nothing between them?

        The flight must leave inwards and arrive from inside. `radius` bounds the errors of parameters and points.
        """
        if self.convex:
            return True
        with suppress(ValueError):
            return self._boxes.passed(start, end, radius)
        return False

    @cached_property
    def _boxes(self) -> "_Boxes":
        return _Boxes(self.map)


@cache
def _convex(table: Any) -> bool:
    return turns_once(table) is True


class _Boxes:
    """Boxes that cover a boundary: midpoints and half widths of point and velocity, and the boxes next to each."""

    def __init__(self, map: PinballMap) -> None:
        ops, parts = map.states.ops, map.ir.parts
        exact = [ops.number(float(value)) for value in map.exact_shape]
        shape = [Interval.around(np.array(value)) for value in exact]
        self.ends = [(float(low), float(high)) for low, high in (part.ends(ops, *exact) for part in parts)]
        after = following(map.table) if len(parts) > 1 else (0,)
        self.next = np.arange(1, len(parts) * CELLS + 1)
        self.next[CELLS - 1 :: CELLS] = np.array(after) * CELLS
        self.before = np.empty_like(self.next)
        self.before[self.next] = np.arange(len(self.next))
        boxes = []
        for part, (low, high) in zip(parts, self.ends, strict=True):
            edges = np.linspace(low, high, CELLS + 1)
            edges[[0, -1]] += np.array([-1, 1]) * SLACK * (abs(low) + abs(high))
            with np.errstate(all="ignore"):
                cells = CentredIntervals(edges[:-1], edges[1:])
                found = part.first(4)(cells, cells.variable, *(cells.constant(x) for x in shape))
                boxes.append(
                    [[np.broadcast_to(x, CELLS) for x in (value.whole.low, value.whole.high)] for value in found]
                )
        low, high = np.moveaxis(np.concatenate(boxes, axis=2), 1, 0)
        known = np.isfinite(low) & np.isfinite(high)
        self.middle = np.where(known, 0.5 * (low + high), 0.0)
        self.half = np.where(known, 0.5 * (high - low), FAR)
        x, y, vx, vy = np.abs(self.middle) + self.half
        size = float(np.max(x + y))
        self.slack, self.drift = SLACK * size**2, SLACK * size * (vx + vy)
        self.known = SLACK / 16 * min(size, *(high - low for low, high in self.ends))

    def passed(self, start: Place, end: Place, radius: float) -> bool:
        """Is the flight proved to meet nothing between `start` and `end`, as in `Obstacles.passed`?"""
        if not radius < self.known:
            return False
        px, py, qx, qy = map(float, (*start[2:], *end[2:]))
        dx, dy = qx - px, qy - py
        (x, y, vx, vy), (rx, ry, rvx, rvy) = self.middle, self.half
        wx, wy, ax, ay = x - px, y - py, abs(dx), abs(dy)
        near = np.abs(dx * wy - dy * wx) <= ax * ry + ay * rx + self.slack
        along, reach = dx * wx + dy * wy, ax * rx + ay * ry + self.slack
        near &= (along >= -reach) & (along - reach <= dx * dx + dy * dy)
        left, runs = {*np.flatnonzero(near).tolist()}, list[set[int]]()
        for component, theta, *_ in (start, end):
            low, high = self.ends[component]
            share = (float(theta) - low) / (high - low)
            if not 0 <= share <= 1:
                return False
            own = component * CELLS + min(int(share * CELLS), CELLS - 1)
            run = {own}
            for way in (self.next, self.before):
                at = int(way[own])  # at least one box on: rounding may hide on which side of an edge the place is
                run.add(at)
                while (at := int(way[at])) in left and at not in run:
                    run.add(at)
            runs.append(run)
        if left - runs[0] - runs[1] or runs[0] & runs[1]:
            return False
        for here in map(list, runs):
            slope = dx * vy[here] - dy * vx[here]
            least = ax * rvy[here] + ay * rvx[here] + self.drift[here]
            if not (np.all(slope > least) or np.all(slope < -least)):
                return False
        return True
