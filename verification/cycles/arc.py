"""Pseudo-arclength continuation: a curve of solutions of `n` equations in `n + 1` unknowns, point by point.

A step goes along the tangent and comes back to the curve in the plane across it, so folds are passed
like any other point. The step grows where Newton's method is quick and shrinks where it is slow or
where the curve turns; it never leaves the box of `limits`, at whose sides the last point lies.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from verification.arithmetic.iteration import Stop, bracketed, iterated, largest
from verification.cycles.cells import above, solved
from verification.cycles.recurrence import Array

NEWTON = Stop(small=1e-7, enough=1e-11, steps=9)  # in units of the unknowns
FAR = 1e3  # a larger correction means that the iteration diverges
TURNED = 0.95  # the least cosine between successive tangents
QUICK, SLOW = 3, 5  # corrector steps that lengthen and shorten the next arc


class End(Enum):
    """Reason why a path ends."""

    INTERVAL = "an end of the interval"
    CLOSED = "the branch is closed"
    ENOUGH = "as many points as were asked for"
    OBSTACLE = "no cycle beyond"
    LOST = "the branch was lost"


class CurveSystem(Protocol):
    """A system of equations whose solutions form a curve."""

    @property
    def label(self) -> str:
        """The name used in messages."""

    @property
    def weights(self) -> Array:
        """The weight of each unknown in the length of the curve."""

    def linear(self, z: Array) -> tuple[Array, Any]:
        """The values of the equations, and their matrix of derivatives, which has one column more than rows."""

    def tests(self, z: Array) -> dict[str, float]:
        """Values of the test functions, whose zeros on the curve are events."""

    def obstacle(self, z: Array) -> str:
        """Reason why a solution `z` of the equations is not admissible; empty when it is."""

    def renewed(self, z: Array) -> "CurveSystem":
        """The same equations, prepared for the surroundings of `z`."""


@dataclass(frozen=True)
class Steps:
    """The step lengths in arc length (first, smallest, largest), and the largest number of points of a path."""

    first: float = 0.01
    smallest: float = 1e-8
    largest: float = 0.05
    most: int = 400


@dataclass(frozen=True)
class CurvePoint:
    """A solution with its tangent, the arc length up to it, and the values of the test functions at it."""

    z: Array = field(repr=False)
    tangent: Array = field(repr=False)
    s: float
    tests: dict[str, float]


@dataclass(frozen=True)
class Path:
    """The points of a path in order, and the reason why it ends."""

    system: CurveSystem = field(repr=False)
    points: tuple[CurvePoint, ...] = field(repr=False)
    end: End
    why: str


class LostError(ValueError):
    """Raised if Newton's method does not converge to a point of the curve, or if the curve has no tangent there."""


def corrected(system: CurveSystem, guess: Array, row: Array, level: float) -> tuple[Array, int]:
    """Solution near `guess` with `row . z = level`, and the number of Newton steps; `LostError` if there is none."""
    lost = LostError(f"{system.label}: Newton's method no longer converges")

    def correction(unknowns: list[Array]) -> list[Array]:
        (z,) = unknowns
        value, matrix = system.linear(z)
        whole, right = above(matrix, row), np.append(value, row @ z - level)
        if not (np.all(np.isfinite(whole.data)) and np.all(np.isfinite(right))):
            raise lost
        if not np.any(right):
            return [right]  # exact, and perhaps a crossing of branches, where the matrix is singular
        moved = solved(whole, right)
        if np.max(np.abs(moved)) > FAR:
            raise lost
        return [moved]

    try:
        found = iterated(correction, [guess], NEWTON, largest)
    except ValueError:
        raise lost from None
    if not found.settled:
        raise lost
    return found.x[0], found.steps


def tangent_at(system: CurveSystem, z: Array, along: Array) -> Array:
    """The unit tangent at `z` that makes an acute angle with `along`."""
    _, matrix = system.linear(z)
    found = solved(above(matrix, along * system.weights), np.append(np.zeros(len(z) - 1), 1.0))
    length = float(np.sqrt(found @ (system.weights * found)))
    if not np.isfinite(length) or length == 0:
        raise LostError(f"{system.label}: the curve has no tangent at this point")
    return found / length


def arc(system: CurveSystem, start: CurvePoint, length: float) -> tuple[Array, int]:
    """The point of the curve in the plane across the tangent, `length` ahead of `start`; and the Newton steps made."""
    row = start.tangent * system.weights
    guess = start.z + length * start.tangent
    return corrected(system, guess, row, float(row @ guess))


def started(system: CurveSystem, z: Array, direction: Array) -> CurvePoint:
    """The first point of a path, corrected to lie on the curve, in the plane across `direction`."""
    weighted = direction * system.weights
    place, _ = corrected(system, z, weighted, float(weighted @ z))
    return CurvePoint(place, tangent_at(system, place, direction), 0.0, system.tests(place))


def follow(
    system: CurveSystem,
    first: CurvePoint,
    limits: Mapping[int, tuple[float, float]],
    steps: Steps | None = None,
    tick: Callable[[CurvePoint], object] | None = None,
    other: Callable[[Array], bool] | None = None,
) -> Path:
    """The path from `first` along its tangent, until it ends; `limits` are the ranges of unknowns, by their index.

    `tick` is called with each point, and ends the path when it returns True. A step to a point where `other` is True
    (another branch) is refused and shortened.
    """
    steps = steps or Steps()
    points, step = [first], steps.first
    while len(points) < steps.most:
        here = points[-1]
        try:
            z, count = arc(system, here, step)
            tangent = tangent_at(system, z, here.tangent)
            if tangent @ (system.weights * here.tangent) < TURNED:
                raise LostError(f"{system.label}: the curve turns too far within one step")
            if other is not None and other(z):
                raise LostError(f"{system.label}: the step ended on another branch")
            if sides := _beyond(here.z, z, limits):
                last = _landed(system, here, z, sides, limits)
                return Path(system, (*points, last), End.INTERVAL, "the end of the interval was reached")
            why = system.obstacle(z)
            tests = system.tests(z)
        except ValueError as error:
            step /= 2
            if step < steps.smallest:
                return Path(system, tuple(points), End.LOST, _lost(here, str(error)))
            continue
        if why:
            if step > 64 * steps.smallest:
                step /= 4  # come close before giving up
                continue
            return Path(system, tuple(points), End.OBSTACLE, why)
        points.append(CurvePoint(z, tangent, here.s + step, tests))
        if tick is not None and tick(points[-1]):
            return Path(system, tuple(points), End.ENOUGH, "the path was ended here")
        if _closed(system, points, step):
            return Path(system, (*points, first), End.CLOSED, "the branch came back to its start")
        system = system.renewed(z)
        step = min(steps.largest, step * (1.5 if count <= QUICK else 1.0 if count <= SLOW else 0.6))
    return Path(system, tuple(points), End.ENOUGH, f"{steps.most} points were asked for")


def passing(system: CurveSystem, points: Sequence[CurvePoint], index: int, value: float) -> list[Array]:
    """The solutions on a path at which the unknown `index` has this value, each corrected by Newton's method."""
    found = []
    for a, b in pairwise(points):
        if (a.z[index] - value) * (b.z[index] - value) < 0 or b.z[index] == value:
            row = np.zeros(len(a.z))
            row[index] = 1.0
            share = (value - a.z[index]) / (b.z[index] - a.z[index])
            found.append(corrected(system.renewed(a.z), a.z + share * (b.z - a.z), row, value)[0])
    return found


def zero(system: CurveSystem, start: CurvePoint, end: CurvePoint, name: str) -> CurvePoint:
    """The point between two neighbouring points where the test function `name` vanishes."""

    def value(length: float) -> float:
        return system.tests(arc(system, start, length)[0])[name] if length else start.tests[name]

    row = start.tangent * system.weights
    whole = float(row @ (end.z - start.z))
    length = bracketed(value, 0.0, whole, 1e-13 + 1e-11 * abs(whole), 1e-13)
    z, _ = arc(system, start, length)
    try:
        tangent = tangent_at(system, z, start.tangent)
    except ValueError:
        tangent = start.tangent  # branches cross there and have no common tangent
    return CurvePoint(z, tangent, start.s + length, system.tests(z))


def zero_near(system: CurveSystem, first: Array, last: Array, name: str) -> CurvePoint | None:
    """Point where a test function vanishes between the solutions near two guesses; None if its signs there agree."""
    row = np.append(np.zeros(len(first) - 1), 1.0 if last[-1] > first[-1] else -1.0)
    try:
        start, end = (started(system, z, row) for z in (first, last))
        return zero(system, start, end, name) if start.tests[name] * end.tests[name] < 0 else None
    except ValueError:
        return None


def leaves(point: CurvePoint, interval: tuple[float, float]) -> bool:
    """Is the parameter (the last unknown) at an end of the interval, and does the tangent point outwards?"""
    value, slope = point.z[-1], point.tangent[-1]
    return bool((value <= interval[0] and slope < 0) or (value >= interval[1] and slope > 0))


def _beyond(here: Array, z: Array, limits: Mapping[int, tuple[float, float]]) -> list[tuple[int, float]]:
    """The sides (index, value) of the box crossed on the way from `here` to `z`, in the order of crossing."""
    crossed = []
    for index, (low, high) in limits.items():
        if not low <= z[index] <= high:
            side = low if z[index] < low else high
            crossed.append(((side - here[index]) / (z[index] - here[index]), index, side))
    return [(index, side) for _, index, side in sorted(crossed)]


def _landed(
    system: CurveSystem,
    here: CurvePoint,
    z: Array,
    sides: list[tuple[int, float]],
    limits: Mapping[int, tuple[float, float]],
) -> CurvePoint:
    """The point of the curve on the side by which the curve leaves the box."""
    for index, side in sides:
        last = _at_side(system, here, z, index, side)
        if not _beyond(here.z, last.z, limits):
            return last
    raise LostError(f"{system.label}: the point where the curve leaves its box was not found")


def _at_side(system: CurveSystem, here: CurvePoint, beyond: Array, index: int, side: float) -> CurvePoint:
    """The point of the curve where the unknown `index` is `side`, on a side of the box."""
    share = (side - here.z[index]) / (beyond[index] - here.z[index])
    row = np.zeros(len(beyond))
    row[index % len(beyond)] = 1.0
    z, _ = corrected(system, here.z + share * (beyond - here.z), row, side)
    z[index] = side
    tangent = tangent_at(system, z, here.tangent)
    length = float((here.tangent * system.weights) @ (z - here.z))
    return CurvePoint(z, tangent, here.s + length, system.tests(z))


def _closed(system: CurveSystem, points: list[CurvePoint], step: float) -> bool:
    first, last = points[0], points[-1]
    gap = last.z - first.z
    near = float(np.sqrt(gap @ (system.weights * gap)))
    return len(points) > 6 and near < step and float(first.tangent @ (system.weights * last.tangent)) > TURNED


def _lost(here: CurvePoint, error: str) -> str:
    return f"{error}, next to the last point, with any step down to the smallest"
