"""Splines: a boundary of pieces that are polynomials of degree three, whose numbers lie in memory.

Round a convex curve the corners between pieces lie to the right of a line through the boundary up to one of them, and
to its left from there on. So the piece on which a flight lands is found by halving, in as many steps as the number of
pieces has binary digits, and one polynomial is solved there; on the piece of departure the known root is divided out.
Elsewhere a flight goes down a tree of boxes round the pieces, and what it meets is solved as `numeric.flights.general`
does. State: the component, the parameter `theta`, and the direction `v`.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, Fields, M, N, Pair, modulus
from numeric.flights.family import Boundary, Landing
from numeric.flights.general import FAR, General

FEW = 2  # pieces, each of which the general flight tries as fast
SAME = 1e-9  # two corners closer than this, against the size of the table, are one
BEND = 1e-9  # of the turning, against its largest value: less is rounding
WIDER = 2.0**-40  # a box is larger by this share of the table than what it holds


class Spline(General):
    """Paper: section 2, the definition of the map, on pieces cubic in the parameter."""

    name = "spline"
    width = 16

    def __init__(self, boundary: Boundary) -> None:
        super().__init__(boundary)
        programs = [program for _, program in boundary.ir.programs]
        self.rows = [[float(x) for x in program(boundary.ops, *boundary.numbers)] for program in programs]
        self.closed = False
        self.convex = convex(boundary)
        self.tree = None if self.convex else grown(boundary, self.pieces)
        how = "the piece by halving" if self.convex else "pieces from a tree of boxes"
        self.path = f"{how}, the zero of a cubic on it" if self.convex else f"{how}, every zero on them, first hit"

    @classmethod
    def matches(cls, boundary: Boundary) -> bool:
        names = [name.split()[0] for name, _ in boundary.ir.programs]
        return len(names) > FEW and not boundary.shape and all(name == "cubic" for name in names)

    @property
    def identity(self) -> str:
        return repr((self.rows, self.convex, self.tree))

    def _row(self, ops: Backend[N, M], which: N) -> list[N]:
        """The eight coefficients of a component."""
        columns = zip(*self.programmed(ops), strict=True)
        return [ops.look_up(list(column), which) for column in columns]

    def programmed(self, ops: Backend[N, M]) -> list[list[N]]:
        """The coefficients of every component in some arithmetic; in floats they are constants."""
        exact = getattr(ops, "context", None) is not None
        if not exact:
            return [[ops.number(x) for x in row] for row in self.rows]
        return [program(ops) for _, program in self.boundary.ir.programs]

    def curve(self, ops: Backend[N, M], shape: Fields[N], component: N, theta: N) -> list[N]:
        return evaluated(ops, self._row(ops, component), theta)

    def fly(self, ops: Backend[N, M], shape: Fields[N], law: str, position: Fields[N], exit: Fields[N]) -> Landing[N]:
        component, theta = position
        row = self._row(ops, component)
        x0, y0, *_ = evaluated(ops, row, theta)
        v = exit[0], exit[1]
        if self.tree is None:
            best = self._across(ops, (component, theta), row, (x0, y0), v)
        else:
            best = self._nearest(ops, self.tree, (component, theta), (x0, y0), v)
        return self._landed(ops, shape, best, v, (component, x0, y0))

    def _across(self, ops: Backend[N, M], start: Pair[N], own: list[N], z0: Pair[N], v: Pair[N]) -> list[N]:
        """Length, component and parameter of the only landing on a convex curve."""
        component, theta = start
        count, nought, one = len(self.rows), ops.number(0.0), ops.number(1.0)
        table = self.programmed(ops)
        corners = [[row[0] for row in table], [row[4] for row in table]]  # theta starts at 0

        def side(at: N) -> N:
            x, y = (ops.look_up(values, at) for values in corners)
            return plane.cross(v, (x - z0[0], y - z0[1]))

        first, last, low, below, above = halved(ops, component, count, side)
        ahead = nought <= first
        behind = (last < nought) & ops.negated(ahead)
        here = ahead | behind
        where = ops.select(here, component, low)
        other = self._row(ops, where)
        p = [plane.cross(v, (other[i], other[i + 4])) for i in range(4)]
        p[0] = plane.cross(v, (other[0] - z0[0], other[4] - z0[1]))
        divided = [
            plane.cross(v, (own[1] + (own[2] + own[3] * theta) * theta, own[5] + (own[6] + own[7] * theta) * theta)),
            plane.cross(v, (own[2] + own[3] * theta, own[6] + own[7] * theta)),
            plane.cross(v, (own[3], own[7])),
            nought,
        ]
        sign = ops.select(behind, -one, one)
        p = [ops.select(here, sign * x, y) for x, y in zip(divided, p, strict=True)]
        bottom, top = ops.select(ahead, theta, nought), ops.select(behind, theta, one + nought * theta)
        guess = ops.select(here, ops.number(0.5) * (bottom + top), below / (below - above))
        at = ops.polynomial_zero(p, guess, bottom, top, one, (0, 3))
        x, y, *_ = evaluated(ops, other, at)
        return [plane.dot(v, (x - z0[0], y - z0[1])), where, at]

    def _nearest(self, ops: Backend[N, M], tree: "Tree", start: Pair[N], z0: Pair[N], v: Pair[N]) -> list[N]:
        """The nearest landing: down the tree wherever the flight meets a box before the best so far."""
        nought, half = ops.number(0.0), ops.number(0.5)
        size = modulus(v[0]), modulus(v[1])
        end = ops.number(float(len(tree.skip)))

        def column(values: Sequence[float], node: N) -> N:
            return ops.look_up([ops.number(x) for x in values], node)

        def meets(node: N, best: N) -> M:
            c = column(tree.x, node) - z0[0], column(tree.y, node) - z0[1]
            w, h = column(tree.wide, node), column(tree.high, node)
            reach, away = size[0] * w + size[1] * h, plane.dot(v, c)
            beside: M = modulus(plane.cross(v, c)) <= size[1] * w + size[0] * h
            found: M = beside & (nought < away + reach) & (away - reach < best)
            return found

        def walked(state: list[N]) -> list[N]:
            """On to the next node, until a piece is reached or the tree is at its end."""
            node, _, best = state
            inside = meets(node, best)
            found = ops.select(inside, column(tree.piece, node), -ops.number(1.0))
            return [ops.select(inside, node + ops.number(1.0), column(tree.skip, node)), found, best]

        def tried(state: list[N]) -> list[N]:
            node, *best = state
            waiting = [node, -ops.number(1.0) + nought * node, best[0]]
            node, piece, _ = ops.repeat(
                lambda at: (at[1] < -half) & (at[0] < end - half), walked, waiting, len(tree.skip) + 1
            )
            reached = -half < piece
            index, low, high = (ops.look_up([ops.number(row[i]) for row in tree.pieces], piece) for i in range(3))
            row = self._row(ops, index)
            curve: Callable[[N], list[N]] = lambda at: evaluated(ops, row, at)  # noqa: E731
            hit = self._hits(ops, curve, (index, low, high, high - low), start, z0, v, best)
            return [node, *(ops.select(reached, new, old) for new, old in zip(hit, best, strict=True))]

        begin = nought * start[1]
        state = [begin, ops.number(FAR) + begin, start[0] + begin, start[1] + begin]
        return ops.repeat(lambda at: at[0] < end - half, tried, state, len(tree.skip) + 1)[1:]


def halved(ops: Backend[N, M], component: N, count: int, side: Callable[[N], N]) -> list[N]:
    """The piece of a closed curve whose first corner lies to the right of a line from `component`, and its last not.

    `side` of a corner, that of the piece which begins there, is negative to the right. Also those of the first corner
    after the departure and of the last, and of the two corners of the piece.
    """
    one, many = ops.number(1.0), ops.number(float(count))

    def which(k: N) -> N:
        at = component + k
        return ops.select(at < many, at, at - many)

    low, high = one + ops.number(0.0) * component, many + ops.number(0.0) * component
    first, last = side(which(one)), side(component)
    below, above = first, last
    for _ in range(max(1, (count - 2).bit_length())):
        middle = ops.rounded(ops.number(0.5) * (low + high) - ops.number(0.25))
        value = side(which(middle))
        right = value < ops.number(0.0)
        low, high = ops.select(right, middle, low), ops.select(right, high, middle)
        below, above = ops.select(right, value, below), ops.select(right, above, value)
    return [first, last, which(low), below, above]


def evaluated(ops: Backend[N, M], row: Sequence[N], u: N) -> list[N]:
    """Point, velocity and acceleration of a cubic."""
    two, three, six = (ops.number(x) for x in (2.0, 3.0, 6.0))
    values = []
    for a, b, c, d in (row[:4], row[4:]):
        values.append((((d * u + c) * u + b) * u + a, (three * d * u + two * c) * u + b, six * d * u + two * c))
    return [value for pair in zip(*values, strict=True) for value in pair]


class Tree(NamedTuple):
    """A tree of boxes in the order of a walk through it: a box that is not met leads on to the node `skip`.

    `piece` is that of a leaf, else -1; `pieces` are a component and the ends of its parameter.
    """

    x: list[float]
    y: list[float]
    wide: list[float]
    high: list[float]
    skip: list[float]
    piece: list[float]
    pieces: list[tuple[float, float, float]]


def grown(boundary: Boundary, pieces: Sequence[tuple[int, float, float]]) -> Tree:
    """The tree of pieces in the order of the boundary, halved again and again."""
    boxes = []
    for index, low, high in pieces:
        theta = np.linspace(low, high, 17)
        x, y, _, _, ax, ay = boundary.curve(np.full(theta.shape, index), theta)
        bulge = (high - low) ** 2 / 16**2 / 4 * max(np.max(np.abs(ax)), np.max(np.abs(ay)))
        boxes.append((x.min() - bulge, x.max() + bulge, y.min() - bulge, y.max() + bulge))
    slack = WIDER * max(abs(side) for box in boxes for side in box)
    tree = Tree([], [], [], [], [], [], [(float(i), low, high) for i, low, high in pieces])

    def node(first: int, last: int) -> None:
        held = boxes[first:last]
        left, right = min(b[0] for b in held), max(b[1] for b in held)
        low, high = min(b[2] for b in held), max(b[3] for b in held)
        at = len(tree.skip)
        tree.x.append(float(left + right) / 2)
        tree.y.append(float(low + high) / 2)
        tree.wide.append(float(right - left) / 2 + slack)
        tree.high.append(float(high - low) / 2 + slack)
        tree.skip.append(0.0)
        tree.piece.append(float(first) if last - first == 1 else -1.0)
        if last - first > 1:
            middle = (first + last) // 2
            node(first, middle)
            node(middle, last)
        tree.skip[at] = float(len(tree.skip))

    node(0, len(pieces))
    return tree


def convex(boundary: Boundary) -> bool:
    """Does one closed curve of pieces on [0, 1] turn to the left all the way, and once round?"""
    if any((low, high) != (0.0, 1.0) for low, high in boundary.ends):
        return False
    theta = np.linspace(0.0, 1.0, 129)
    rows: Any = [boundary.curve(np.full(theta.shape, i), theta) for i in range(len(boundary.ends))]
    size = max(np.max(np.abs(row[:2])) for row in rows)
    total = 0.0
    for row, after in zip(rows, [*rows[1:], rows[0]], strict=True):
        turning = row[2] * row[5] - row[3] * row[4]
        if np.min(turning) < -BEND * np.max(np.abs(turning)):
            return False
        if np.hypot(*(row[:2, -1] - after[:2, 0])) > SAME * size:
            return False  # a second curve begins
        angle = np.unwrap(np.arctan2(row[3], row[2]))
        corner = np.arctan2(plane.cross(row[2:4, -1], after[2:4, 0]), plane.dot(row[2:4, -1], after[2:4, 0]))
        if corner < -BEND:
            return False
        total += float(angle[-1] - angle[0] + corner)
    return abs(total - 2 * np.pi) < 1e-6
