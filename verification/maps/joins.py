"""The parameter of a component continued over joins to the next one, in float64.

Where tangents agree a join is no corner: the billiard map is continuous there. Where curvatures agree as well its
derivative is continuous, and the parameter of a component may run on beyond its ends along the true boundary: `x`
beyond the end of one component is the parameter `start + (x - end)*ratio` of the next, where the ratio makes the speeds
agree. So Newton's method and a branch of cycles pass such a join like any other point. A closed curve of period 2*pi
needs no continuation, and a table with free shape parameters has none, since its ends may move.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import islice, product
from typing import Any

import numpy as np
from flint import arb
from numpy.typing import NDArray

from symbolic.expressions.text import Kernel, kernel, load
from symbolic.motion.chords import ends_kernel
from symbolic.tables.curves import is_periodic
from symbolic.tables.geometry import velocity
from symbolic.tables.joins import JoinKind, contacts, following
from symbolic.tables.table import Component, Table, theta
from verification.arithmetic.balls import FLOAT64

Array = NDArray[np.float64]
NEAR = 1e-9  # share of a component's range: a parameter so near a join is on it
MOST = 64  # at most, joins that one parameter passes
SIDES = 64  # at most, choices of the sides of a cycle's joins


@dataclass(frozen=True)
class Joins:
    """For both ends of `m` components, shape `(m, 2)`: parameter, next component, kind of contact, ratio of speeds."""

    ends: Array
    beyond: NDArray[np.int64]
    contact: tuple[tuple[JoinKind, JoinKind], ...]
    ratio: Array
    runs_on: NDArray[np.bool_]
    smooth: NDArray[np.bool_]

    @property
    def any(self) -> bool:
        """True if a parameter can run on over some join."""
        return bool(self.runs_on.any())

    def place(self, component: Any, x: Any) -> tuple[Any, Any, Any]:
        """Components, parameters on them and their derivatives by `x`, for parameters `x` that may pass `component`'s
        ends.

        >>> from symbolic import Scene
        >>> halves = [{"name": n, "x": "2*cos(theta)", "y": "sin(theta)", "from": a, "to": b}
        ...           for n, a, b in (("upper", "0", "pi"), ("lower", "pi", "2*pi"))]
        >>> part, x, slope = joins(Scene.of({"component": halves}).table).place(0, 3.5)
        >>> int(part), float(x), float(slope)
        (1, 3.5, 1.0)
        """
        here = np.array(x, dtype=float)
        part: Any = np.broadcast_to(component, here.shape)
        slope: Any = np.ones(here.shape)
        for _ in range(MOST):
            low, high = self.ends[part, 0], self.ends[part, 1]
            side = np.where(here > high, 1, 0)
            out = ((here > high) | (here < low)) & self.runs_on[part, side] & np.isfinite(here)
            if not out.any():
                break
            ratio, after = self.ratio[part, side], self.beyond[part, side]
            gap = here - np.where(side, high, low)
            here = np.where(out, self.ends[after, 1 - side] + gap * ratio, here)
            slope = np.where(out, slope * ratio, slope)
            part = np.where(out, after, part)
        return part, here, slope

    def canonical(self, component: Any, x: Any) -> tuple[Any, Any]:
        """Components and parameters of bounces, where a bounce on a smooth join is put on the next component."""
        part, at, _ = self.place(component, x)
        low, high, after = self.ends[part, 0], self.ends[part, 1], self.beyond[part, 1]
        last = (abs(at - high) < NEAR * (high - low)) & self.smooth[part, 1]
        first = (abs(at - low) < NEAR * (high - low)) & self.smooth[part, 0]
        at = np.where(last, self.ends[after, 0], np.where(first, low, at))
        return np.where(last, after, part), at

    def on_smooth(self, part: int, x: Any) -> NDArray[np.bool_]:
        """True where a parameter `x` of the component is at a smooth join."""
        low, high = self.ends[part]
        first, last = (
            smooth & (abs(x - end) < NEAR * (high - low))
            for smooth, end in zip(self.smooth[part], (low, high), strict=True)
        )
        return np.asarray(first | last)

    def slopes(self, parts: Sequence[int], others: Sequence[int]) -> list[float]:
        """Speeds of bounce parameters on the components `others`, when those on the components `parts` have speed 1."""
        both = zip(parts, others, strict=True)
        return [1.0 if part == other else float(self.ratio[part, 0]) for part, other in both]

    def sides(self, parts: Sequence[int], x: Array) -> list[tuple[tuple[int, ...], Array]]:
        """Ways to assign bounces at joins where the curvature jumps to either side, as `(components, parameters)`."""
        rows = []
        for part, at in zip(parts, x, strict=True):
            before = int(self.beyond[part, 0])
            both = [(part, at), (before, self.ends[before, 1])]
            rows.append(both[: 1 + self.jumps(part, at)])
        whole = islice(product(*rows), SIDES)
        return [(tuple(part for part, _ in one), np.array([at for _, at in one])) for one in whole]

    def jumps(self, part: int, x: float) -> bool:
        """True if this bounce is at the start of a component, where tangents but not curvatures agree."""
        low, high = self.ends[part]
        return self.contact[part][0] is JoinKind.TANGENT and bool(abs(x - low) < NEAR * (high - low))


ROUGH = (JoinKind.TANGENT, JoinKind.CURVATURE)  # the map is continuous, and two formulas meet


@dataclass(frozen=True)
class OverJoins:
    """A function that places balls of parameters on components; they may reach over joins at which tangents agree.

    A parameter beyond the end of a component is `start + (x - end)*ratio` on the next one, where the ratio makes the
    speeds agree. `ends` and `ratio` have one entry for the start and one for the end of each component.
    """

    known: Joins
    ends: tuple[tuple[arb, arb], ...]
    ratio: tuple[tuple[arb, arb], ...]

    def __call__(self, part: int, x: arb) -> list[tuple[int, arb, arb]]:
        """The components that the ball `x` meets, the ball of the parameter on each, and its derivative by `x`."""
        (low, high), found = self.ends[part], []
        before, after = (contact in ROUGH for contact in self.known.contact[part])
        if not ((before and x < low) or (after and x > high)):
            found.append((part, x, arb(1)))
        for side, wanted in enumerate((before and not x >= low, after and not x <= high)):
            if wanted:
                to, ratio = int(self.known.beyond[part, side]), self.ratio[part][side]
                gap = (x - high).max(arb(0)) if side else (x - low).min(arb(0))
                found.append((to, self.ends[to][1 - side] + gap * ratio, ratio))
        return found


def over_joins(table: Table, arithmetic: Any) -> OverJoins | None:
    """The joins that a ball may reach over, in balls; None if there are none, or if a shape parameter is free."""
    if table.shapes or len(table.components) == 1:
        return None
    known = joins(table)
    if not any(contact in ROUGH for pair in known.contact for contact in pair):
        return None
    found = load(ends_kernel(table), arithmetic)()
    ends = tuple((arb(a), arb(b)) for a, b in zip(found[::2], found[1::2], strict=True))
    speeds = []
    for pair, contact, part in zip(ends, known.contact, table.components, strict=True):
        at = (
            load(_velocity(part), arithmetic) if any(map(ROUGH.__contains__, contact)) else lambda end: (arb(1), arb(0))
        )
        speeds.append([sum((v * v for v in at(end)), arb(0)).sqrt() for end in pair])
    ratio = [tuple(speeds[i][k] / speeds[known.beyond[i, k]][1 - k] for k in (0, 1)) for i in range(len(ends))]
    return OverJoins(known, ends, tuple((a, b) for a, b in ratio))


def _velocity(part: Component) -> Kernel:
    vx, vy = velocity(part)
    return kernel("velocity", [theta], {"x": vx, "y": vy})


@cache
def joins(table: Table) -> Joins:
    """The joins of a table; no parameter continues over them if a shape parameter is free.

    >>> from symbolic.tables import ellipse, square
    >>> joins(square()).any, joins(ellipse.at(a=2)).any
    (False, False)
    """
    parts, after, agree = table.components, following(table), contacts(table)
    before = {j: i for i, j in enumerate(after)}
    beyond = np.array([(before[i], after[i]) for i in range(len(parts))])
    contact = tuple((agree[before[i]], agree[i]) for i in range(len(parts)))
    m, smooth = len(parts), np.array([[c.smooth for c in pair] for pair in contact])
    if table.shapes:
        return Joins(np.full((m, 2), np.nan), beyond, contact, np.ones((m, 2)), np.zeros((m, 2), dtype=bool), smooth)
    ends = np.array([[float(part.start), float(part.end)] for part in parts])
    speeds = np.ones((m, 2))
    runs_on = np.zeros((m, 2), dtype=bool)
    for i, part in enumerate(parts):
        if after[i] == i and all(map(is_periodic, part.point)):
            continue
        runs_on[i] = [c in (JoinKind.CURVATURE, JoinKind.SMOOTH) for c in contact[i]]
        if smooth[i].any():
            at = load(_velocity(part), FLOAT64)
            speeds[i] = [float(np.hypot(*at(float(end)))) for end in ends[i]]
    ratio = np.array([[speeds[i, k] / speeds[beyond[i][k], 1 - k] for k in (0, 1)] for i in range(m)])
    return Joins(ends, beyond, contact, ratio, runs_on, smooth)
