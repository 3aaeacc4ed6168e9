"""Sides and arcs in a row: their numbers, which follows which, the closed curves, and what a flight may pass there."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from numeric.backends import functions as plane
from numeric.backends.protocol import Backend, M, N, modulus
from numeric.flights.family import Boundary
from numeric.flights.general import UNSURE

LINE, CIRCLE, ELLIPSE = "line", "circle", "ellipse"
MANY = 24  # pieces of a convex curve, from which on it pays to find one by halving, with numbers from memory
TURNS = 1e-12  # sine of the largest angle by which a corner of a convex curve may bend the wrong way, by rounding
Pair = tuple[Any, Any]
Masks = Any


class Piece(NamedTuple):
    """The numbers of a piece in some arithmetic."""

    kind: str
    origin: Pair
    A: Pair
    B: Pair
    start: Pair  # its first corner
    D: Any  # A x B: positive where the arc focuses
    radius: Any
    middle: Pair  # (p, q) in the middle of an arc; the ends of the parameter of a side
    half: Pair  # sine and cosine of half the angle of an arc


def piece_of(kind: str, x: Sequence[Any]) -> Piece:
    """From the fourteen numbers of a piece's program."""
    pairs = [(x[i], x[i + 1]) for i in (0, 2, 4, 6, 10, 12)]
    return Piece(kind, pairs[0], pairs[1], pairs[2], pairs[3], x[8], x[9], pairs[4], pairs[5])


def span(piece: Piece) -> Pair:
    """Bounds of the sum of moduli that a point of a piece is added up from: at `p = 0`, and more for a unit of `p`."""
    x, y, ax, ay, bx, by = (modulus(z) for pair in (piece.origin, piece.A, piece.B) for z in pair)
    return (x + y, ax + ay) if piece.kind == LINE else (x + y + ax + ay + bx + by, x - x)


def column(pieces: list[Piece], i: int) -> list[Any]:
    """One entry of every piece."""
    return [piece[i] for piece in pieces]


def chosen(ops: Any, component: Any, values: list[Any]) -> Any:
    """The value of the particle's piece; neighbours that are equal cost nothing."""
    if len(values) > MANY and all(map(_constant, values)):
        return values[0] if all(same(value, values[0]) for value in values) else ops.look_up(values, component)
    found = values[0]
    for i in range(1, len(values)):
        if not same(values[i], values[i - 1]):
            found = ops.select(ops.number(i - 0.5) < component, values[i], found)
    return found


def _constant(value: Any) -> bool:
    """Is this one number, of a vector of LLVM a known one? An array has one for each particle."""
    return getattr(value, "value", 0.0) is not None and not getattr(value, "ndim", 0)


def chosen_mask(ops: Any, component: Any, values: list[bool]) -> Any:
    """Where the particle's piece is one of those marked."""
    return ops.number(0.5) < chosen(ops, component, [ops.number(float(value)) for value in values])


def same(x: Any, y: Any) -> bool:
    """Are two values of an arithmetic known to be equal?"""
    if x is y:
        return True
    if hasattr(x, "factors"):  # a vector of LLVM
        return bool(x.value == y.value if None not in (x.value, y.value) else x.value is y.value and x.text == y.text)
    return bool(np.all(x == y))


def following(boundary: Boundary, pieces: list[Piece]) -> list[int]:
    """The piece that begins where each one ends: the next one, or the first of a closed curve."""
    found, first, count = [], 0, len(pieces)
    size = max(abs(x) for piece in pieces for x in piece.start) + 1.0
    for j in range(count):
        x, y, *_ = boundary.curve(np.array([j]), np.array([boundary.ends[j][1]]))[:, 0]
        after = (j + 1) % count
        back = np.hypot(x - pieces[first].start[0], y - pieces[first].start[1]) <= 1e-9 * size
        if back and (j > first or pieces[j].kind != LINE):
            found.append(first)
            first = j + 1
        else:
            found.append(after)
    return found


def loops(after: list[int]) -> list[list[int]]:
    """The closed curves, each as the pieces in order."""
    found, first = [], 0
    for j, following in enumerate(after):
        if following <= j:
            found.append(list(range(first, j + 1)))
            first = j + 1
    return found


def convex(boundary: Boundary, pieces: list[Piece], loop: list[int], after: list[int]) -> bool:
    """Does every arc of the curve focus, and every corner bend inwards?"""
    if any(pieces[j].kind != LINE and not pieces[j].D > 0 for j in loop):
        return False
    turning = 0.0
    for j in loop:
        arriving, leaving = _direction(boundary, j, 1), _direction(boundary, after[j], 0)
        sine = float(plane.cross(arriving, leaving))
        if sine < -TURNS or (abs(sine) <= TURNS and plane.dot(arriving, leaving) < 0):
            return False
        turning += float(np.arctan2(sine, plane.dot(arriving, leaving)))
        low, high = boundary.ends[j]
        turning += high - low if pieces[j].kind == CIRCLE else _turned(boundary, j)
    return abs(turning - 2 * np.pi) < 1e-6


def passable(boundary: Boundary, pieces: list[Piece], j: int, after: list[int]) -> bool:
    """May a flight pass the first corner of a piece? Not where the curve bends inwards, or is smooth and focuses.

    A cusp counts as one that may be passed: its tangents do not say to which side it points.
    """
    before = after.index(j)
    if before == j:
        return False  # a closed arc
    arriving, leaving = _direction(boundary, before, 1), _direction(boundary, j, 0)
    sine = float(plane.cross(arriving, leaving))
    if abs(sine) > TURNS:
        return sine < 0
    focuses = all(pieces[i].kind == LINE or bool(pieces[i].D > 0) for i in (before, j))
    return bool(plane.dot(arriving, leaving) < 0 or not focuses)


def _direction(boundary: Boundary, j: int, end: int) -> Pair:
    """The unit tangent at an end of a piece."""
    _, _, dx, dy, _, _ = boundary.curve(np.array([j]), np.array([boundary.ends[j][end]]))[:, 0]
    size = np.hypot(dx, dy)
    return dx / size, dy / size


def _turned(boundary: Boundary, j: int) -> float:
    """The angle by which the tangent of a piece turns."""
    low, high = boundary.ends[j]
    theta = np.linspace(low, high, 257)
    _, _, dx, dy, _, _ = boundary.curve(np.full(theta.shape, j), theta)
    return float(np.ptp(np.unwrap(np.arctan2(dy, dx))))


class Flight(NamedTuple):
    """The line along which a particle leaves: its piece, point and direction, and `d x v` there."""

    ops: Any
    component: Any
    z0: Pair
    v: Pair
    rate: Any
    p: Any  # of the point


def passing(flight: Flight, corner: Pair, side: Any, start: Any, t: Any) -> Masks:
    """Does a flight of length `t` come to a corner on its way, as near as its rounding?"""
    ops, (x, y) = flight.ops, corner
    slack = ops.number(UNSURE) * (start + modulus(x) + modulus(y))
    ahead = plane.dot(flight.v, (x - flight.z0[0], y - flight.z0[1]))
    return (modulus(side) <= slack) & (slack < ahead) & (ahead < t)


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
