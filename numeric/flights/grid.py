"""On tables of many pieces a flight is tested only against those in the cells of a grid that it passes.

From a cell without pieces a flight goes on at once to the end of the largest empty square of cells that begins there;
the square depends on the signs of the direction, so every cell has four. As squares grow with the distance from the
boundary, their number on a flight grows like the logarithm of the number of cells in a row.

**No piece is left out that could be hit first.** A point of a flight is a sum; rounding moves it by some units of
`2**-52` of its terms. A piece is listed in every cell to which it comes as near as `2*slack`, where `slack` is
`WIDER = 2**-40` of these terms, four thousand times as much. A flight leaves a square half a slack before its edge, so
that it moves on in spite of rounding. All pieces met up to the length at which a flight left the last cell are
therefore on the lists that it has read, and the nearest of them is the first hit.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.backends.protocol import Backend, M, N, Pair, modulus
from numeric.flights.family import Boundary

WIDER = 2.0**-40
OVER = 2.0**101  # beyond all lengths
PIECE = 2.5  # cells for each piece: fewer have longer lists, more take longer to cross
FEWEST, MOST = 4, 128  # cells in a row
Array = NDArray[np.float64]


class PieceGrid(NamedTuple):
    """A grid of cells in rows, with its outermost ring outside the table, and for each cell a list of pieces.

    `squares` has four rows for each cell, one for each pair of signs of a direction in `x` and `y`. A row has the
    coordinates of the edges where a flight leaves the empty square, and the first line of the cell's list in `items`:
    `-1` for no list, `-2` outside the table. A line of `items` has what a flight needs of a piece, and last the piece's
    number `j`, or `-1 - j` on the last line of a list.
    """

    low: tuple[float, float]
    cell: tuple[float, float]
    shape: tuple[int, int]
    nudge: float
    squares: list[list[float]]
    items: list[list[float]]


def laid(table: Array, boxes: Sequence[Array], lines: Sequence[Sequence[float]], size: float) -> PieceGrid:
    """The grid over a table, for pieces each of which is covered by boxes; a row of boxes is left, right, low, high.

    `lines` has the numbers of each piece that go into `items`, the piece's number last. `size` bounds the moduli of the
    numbers that points are added up from.
    """
    slack = WIDER * size
    lowest, highest = table[:, (0, 2)].min(axis=0) - 4 * slack, table[:, (1, 3)].max(axis=0) + 4 * slack
    sides = highest - lowest
    wanted = np.sqrt(PIECE * len(lines) * sides / sides[::-1])
    inside = np.clip(np.rint(wanted), FEWEST, MOST).astype(int)
    cell = sides / inside
    low, (count, rows) = lowest - cell, (int(inside[0]) + 2, int(inside[1]) + 2)
    held: list[list[int]] = [[] for _ in range(rows * count)]
    for number, own in enumerate(boxes):
        first = np.floor((own[:, (0, 2)] - 2 * slack - low) / cell).astype(int)
        last = np.floor((own[:, (1, 3)] + 2 * slack - low) / cell).astype(int)
        found = {(i, j) for (a, b), (c, d) in zip(first.tolist(), last.tolist(), strict=True)
                 for i in range(a, c + 1) for j in range(b, d + 1)}  # fmt: skip
        for i, j in found:
            held[j * count + i].append(number)
    items: list[list[float]] = []
    link = np.full(rows * count, -1.0)
    for at, numbers in enumerate(held):
        if numbers:
            link[at] = len(items)
            items += [
                [*lines[number][:-1], lines[number][-1] if number != numbers[-1] else -1.0 - lines[number][-1]]
                for number in numbers
            ]
    links = link.reshape(rows, count)
    links[0], links[-1], links[:, 0], links[:, -1] = (-2.0,) * 4
    squares = [_square_rows(links, way, low, cell) for way in range(4)]
    known = (float(low[0]), float(low[1])), (float(cell[0]), float(cell[1]))
    return PieceGrid(*known, (count, rows), slack / 2, [row for way in squares for row in way], items)


def _square_rows(link: Array, way: int, low: Array, cell: Array) -> list[list[float]]:
    """The rows of `PieceGrid.squares` for one quadrant of directions: left if `way` is odd, down if `way >= 2`.

    `link` has for each cell the first line of its list in `items`, or -1 or -2, as in `PieceGrid`.
    """
    flip = (slice(None, None, -1 if way & 2 else 1), slice(None, None, -1 if way & 1 else 1))
    empty = (link == -1.0)[flip]
    side = np.zeros(link.shape)
    while np.any(empty):
        side += empty
        ahead = np.zeros_like(empty)
        ahead[:-1, :-1] = empty[1:, :-1] & empty[:-1, 1:] & empty[1:, 1:]
        empty = empty & ahead
    steps = np.maximum(side[flip], 1.0)
    y, x = np.indices(link.shape).astype(float)
    x = x + 1.0 - steps if way & 1 else x + steps
    y = y + 1.0 - steps if way & 2 else y + steps
    rows = np.stack([low[0] + x * cell[0], low[1] + y * cell[1], link, 0.0 * link], axis=-1)
    found: list[list[float]] = rows.reshape(-1, 4).tolist()
    return found


def met(
    ops: Backend[N, M],
    grid: PieceGrid,
    z0: Pair[N],
    v: Pair[N],
    best: list[N],
    tried: Callable[[M, list[N], list[N]], list[N]],
) -> list[N]:
    """The landing, its length first, after `tried` was called for all lines of `items` along the flight.

    `best` is the nearest landing known before. `tried` returns the nearer of two landings: a known
    one, and the one on the piece of a line of `items`.
    """
    nought, one, half = ops.number(0.0), ops.number(1.0), ops.number(0.5)
    left, down = (ops.with_sign(one, side) < nought for side in v)  # of -0.0 too
    cells = float(grid.shape[0] * grid.shape[1])
    way = ops.select(left, ops.number(cells), nought) + ops.select(down, ops.number(2 * cells), nought)
    inverse, start, step = [], [], []
    for axis in (0, 1):
        ahead = ops.with_sign(ops.maximum(modulus(v[axis]), ops.number(2.0**-500)), v[axis])
        inverse.append(one / ahead)
        scale = ops.number(1 / grid.cell[axis])
        nudged = z0[axis] + ops.with_sign(ops.number(grid.nudge), v[axis]) - ops.number(grid.low[axis])
        start.append(nudged * scale - half)
        step.append(v[axis] * scale)
    wide = ops.number(float(grid.shape[0]))

    def on(state: list[N]) -> list[N]:
        """One step over the cell of `state`, or the empty square there: the length at its edge, and the cell's list."""
        t, _ = state
        i, j = (ops.rounded(step[axis] * t + start[axis]) for axis in (0, 1))
        x, y, link, _ = ops.look_up_row(grid.squares, j * wide + i + way)
        across, up = (x - z0[0]) * inverse[0], (y - z0[1]) * inverse[1]
        t = ops.select(across < up, across, up)
        return [ops.select(link < -one - half, ops.number(OVER), t), link]

    def listed(state: list[N]) -> list[N]:
        t, line, *best = state
        t, line = ops.repeat(lambda at: (at[1] < nought) & (at[0] < best[0]), on, [t, line], 2 * sum(grid.shape))
        *known, number = ops.look_up_row(grid.items, line)
        reached, last = -half < line, number < nought
        best = tried(reached, [*known, ops.select(last, -one - number, number)], best)
        return [t, ops.select(last, -one, ops.select(reached, line + one, line)), *best]

    begin = [nought * best[0], nought * best[0] - one, *best]
    return ops.repeat(lambda at: (-half < at[1]) | (at[0] < at[2]), listed, begin, 16 * len(grid.items), True)[2:]


# ---- one box for each piece, of curves that are no sides or arcs


class Box(NamedTuple):
    """A box along the chord of a piece, and `numbers` from which a zero on the piece is computed.

    `frame` is the box's middle, half its longer side, and the ratio of its sides. The `numbers` are coefficients,
    component, ends of the parameter, 0, and two corners, each with the components that end and begin there, or -1.
    """

    component: int
    frame: tuple[float, ...]
    numbers: list[float]


def boxed(boundary: Boundary, pieces: Sequence[tuple[int, float, float]], rows: Sequence[Sequence[float]]) -> list[Box]:
    """The boxes of pieces cubic in the parameter, in the order of the boundary.

    A piece lies in the convex hull of its four control points, and the control points lie in the box.
    """
    size = max(abs(x) for row in rows for x in (row[0], row[4]))
    corners = joined(boundary, pieces)
    found: list[Box] = []
    where, lows, highs = (np.array(row) for row in zip(*pieces, strict=True))
    starts, stops = (boundary.curve(where, theta, 4).T for theta in (lows, highs))
    for (index, low, high), ends, one, two in zip(pieces, corners, starts, stops, strict=True):
        third = (high - low) / 3
        hull = np.array([one[:2], one[:2] + third * one[2:4], two[:2] - third * two[2:4], two[:2]])
        chord = hull[3] - hull[0]
        way = chord / np.hypot(*chord) if np.any(chord) else np.array([1.0, 0.0])
        frame = np.array([way, (-way[1], way[0])])
        spread = (hull - hull[0]) @ frame.T
        least, most = spread.min(axis=0), spread.max(axis=0)
        slack = WIDER * size * (1 + len(found) / len(pieces))  # no two alike, lest three boxes be met at one length
        half, thick = (most - least) / 2 + slack
        middle = hull[0] + (least + most) / 2 @ frame
        numbers = [*rows[index], float(index), low, high, 0.0, *ends[0], *ends[1]]
        found.append(Box(index, tuple(map(float, (*middle, *(half * way), thick / half))), [*map(float, numbers)]))
    return found


def joined(boundary: Boundary, pieces: Sequence[tuple[int, float, float]]) -> list[tuple[tuple[float, ...], ...]]:
    """The two corners of every piece, each with the components that end and begin there, or -1.

    Where one piece ends and the next begins is one corner, with the same numbers for both.
    """
    first: dict[int, int] = {}  # of a component its first piece
    for i, (index, *_) in enumerate(pieces):
        first.setdefault(index, i)
    before = {after: index for index, after in enumerate(boundary.following)}
    corners, after = [], []
    where, lows, _ = (np.array(row) for row in zip(*pieces, strict=True))
    for i, ((index, *_), point) in enumerate(zip(pieces, boundary.curve(where, lows, 2).T, strict=True)):
        begins = first[index] == i
        corners.append((*map(float, point), float(before[index] if begins else -1), float(index if begins else -1)))
        goes_on = i + 1 < len(pieces) and pieces[i + 1][0] == index
        after.append(i + 1 if goes_on else first[boundary.following[index]])
    return [(corners[i], corners[after[i]]) for i in range(len(pieces))]


def grown(boundary: Boundary, pieces: Sequence[tuple[int, float, float]]) -> list[list[float]]:
    """A binary tree of boxes round the pieces, in the order of the boundary.

    Nodes are listed in preorder: the middle, half the sides, the node to go to if the box is not met, and the piece of
    a leaf, else -1. Two columns are empty.
    """
    boxes = []
    where, lows, highs = (np.array(row) for row in zip(*pieces, strict=True))
    places = np.linspace(lows, highs, 17, axis=1)
    along = boundary.curve(np.broadcast_to(where[:, None], places.shape), places)
    for (_, low, high), (x, y, _, _, ax, ay) in zip(pieces, along.swapaxes(0, 1), strict=True):
        bulge = (high - low) ** 2 / 16**2 / 4 * max(np.max(np.abs(ax)), np.max(np.abs(ay)))
        boxes.append((x.min() - bulge, x.max() + bulge, y.min() - bulge, y.max() + bulge))
    slack = WIDER * max(abs(side) for box in boxes for side in box)
    nodes: list[list[float]] = []

    def node(first: int, last: int) -> None:
        held = boxes[first:last]
        left, right = min(b[0] for b in held), max(b[1] for b in held)
        low, high = min(b[2] for b in held), max(b[3] for b in held)
        leaf = float(first) if last - first == 1 else -1.0
        mine = [(left + right) / 2, (low + high) / 2, (right - left) / 2 + slack, (high - low) / 2 + slack, 0.0, leaf]
        nodes.append([*map(float, mine), 0.0, 0.0])
        at = len(nodes) - 1
        if last - first > 1:
            middle = (first + last) // 2
            node(first, middle)
            node(middle, last)
        nodes[at][4] = float(len(nodes))

    node(0, len(pieces))
    return nodes
