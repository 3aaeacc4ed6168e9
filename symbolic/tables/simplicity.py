"""Proofs that a boundary bounds a table: its closed curves are simple, disjoint, and oriented the right way.

Every quantity is enclosed between integers (in units of `2**-BITS`), so that no rounding decides. A closed curve is cut
into arcs until the tangents of any two neighbours lie in one open half plane: both then advance along one direction, so
that together they do not meet themselves. At a cusp, where the direction turns back, the two arcs lie on different
sides of the common tangent, or have different curvatures. Arcs that are not neighbours are separated by a line, or are
cut again. The tangent turns once, counterclockwise on the outer curve and clockwise on a hole (Hopf); and a ray from a
point of a hole meets the outer curve an odd number of times, and each other hole an even number.

A letter (a shape parameter without a value) may have a range; bounds and proof then hold for all values in the range.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import reduce
from itertools import combinations_with_replacement, product

from sympy import Expr, Rational, S, Symbol, log

from symbolic.expressions.enclosures import BITS, ONE, Bounds, Enclosures, UnboundedError
from symbolic.expressions.signs import vanishes
from symbolic.tables.arcs import (
    WORK,
    Arc,
    Box,
    Formulas,
    Piece,
    Vector,
    cross,
    disjoint,
    dot,
    hull,
    in_half_plane,
    products,
    separated,
    shown,
    turn,
)
from symbolic.tables.curves import LONG, curves, size
from symbolic.tables.table import Table, theta

DEEPEST = 56  # most halvings of a component
COARSE = 8  # the same where a letter has a range of length 1
NARROWEST = 20  # most halvings of the range of a letter
RUN = 8  # most consecutive arcs whose tangents are tested together
PLACES = 8  # about so many components are sampled to find the size of a boundary
FLAT = BITS // 4  # from this ratio of width and height on, in powers of two, each axis has a unit of its own


NONE: Mapping[Symbol, tuple[Expr, Expr]] = {}


class NotProvedError(ValueError):
    """No proof was found that a boundary bounds a table."""


def prove_simple(table: Table, ranges: Mapping[Symbol, tuple[Expr, Expr]] = NONE) -> None:
    """Proves that a boundary is closed, simple and counterclockwise, and its holes clockwise, within it and disjoint.

    `ranges` has the ends of the range of every shape parameter without a value; the proof holds for all values in them.
    Raises `NotProvedError`, a `ValueError`, with the place where the proof fails.

    >>> from symbolic.tables import ellipse
    >>> from symbolic.tables.table import a
    >>> prove_simple(ellipse, {a: (S(1), S(3))})
    """
    names = tuple(ranges)
    ends = [Enclosures(pair)() for pair in ranges.values()]
    whole = tuple((low[0], high[1]) for low, high in ends)
    boundary = _Boundary(table, names, _middle(whole))
    boxes = [whole]
    while boxes:
        box = boxes.pop()
        middle = _middle(box)
        try:
            boundary.prove(box)
            continue
        except NotProvedError:
            if box == middle:
                raise
        where = ", ".join(f"{x} = {shown(value)}" for x, (value, _) in zip(names, middle, strict=True))
        try:
            boundary.prove(middle)
        except NotProvedError as why:
            raise NotProvedError(f"{why}, where {where}") from None
        widest = max(range(len(box)), key=lambda i: box[i][1] - box[i][0])
        (low, high), (at, _) = box[widest], middle[widest]
        if high - low <= whole[widest][1] - whole[widest][0] >> NARROWEST:
            raise NotProvedError(f"{table.name} is not proved to be a table for all parameters near {where}")
        boxes += [(*box[:widest], half, *box[widest + 1 :]) for half in ((low, at), (at, high))]


def _middle(box: tuple[Bounds, ...]) -> tuple[Bounds, ...]:
    return tuple((sum(bounds) // 2, sum(bounds) // 2) for bounds in box)


# ---- closed curves


@dataclass(frozen=True)
class _Node:
    """A node of a tree over consecutive arcs: a box, with two child nodes or with the indices of a curve and an arc."""

    box: Box
    parts: "tuple[_Node, ...]"
    place: tuple[int, int] = (0, 0)


class _Boundary:
    """The closed curves of a table, for proofs over boxes of parameters; `near` has one value of each parameter."""

    def __init__(self, table: Table, letters: tuple[Symbol, ...], near: tuple[Bounds, ...]) -> None:
        self.name, self._budget, self._deepest = table.name, [WORK], DEEPEST
        factors = _units(table, dict(zip(letters, (Rational(low, ONE) for low, _ in near), strict=True)))
        marks = [(table.components[mark.component], mark.theta) for mark in table.undefined]
        self._rings = []
        try:
            for curve in curves(table):
                ring: list[Piece] = []
                for component in curve:
                    formulas = Formulas(component, factors, letters, self._budget)
                    ring += _pieces(formulas, [at for of, at in marks if of == component], near)
                self._rings.append([_with_cusp(p, q, near) for p, q in zip(ring, [*ring[1:], ring[0]], strict=True)])
        except UnboundedError as why:
            raise self._error(str(why)) from None

    def prove(self, letters: tuple[Bounds, ...]) -> None:
        """Proves that the curves bound a table for all parameters in `letters`; wide bounds allow fewer halvings."""
        width = max([high - low for low, high in letters], default=0)
        self._deepest = min(DEEPEST, max(0, BITS - width.bit_length()) + COARSE)
        rings = [self._cut([piece.at(letters) for piece in ring]) for ring in self._rings]
        turns = [self._turns(ring) for ring in rings]
        self._apart(rings)
        for ring, count, wanted in zip(rings, turns, [1] + [-1] * len(rings), strict=False):
            if count != wanted:
                raise self._error(f"the curve through {ring[0].place} does not run {'counter' * (wanted > 0)}clockwise")
        boxes = [reduce(hull, (arc.box for arc in ring)) for ring in rings]
        for i, hole in enumerate(rings[1:], 1):
            for j, ring in enumerate(rings):
                if i != j and (not disjoint(hole[0].start, boxes[j]) and _surrounds(ring, hole)) != (j == 0):
                    raise self._error(f"the hole through {hole[0].place} is not inside the table, outside other holes")

    def _error(self, why: str) -> NotProvedError:
        return NotProvedError(f"{self.name} is not proved to be a table: {why}")

    def _halves(self, *arcs: Arc, near: tuple[Arc, ...] = ()) -> list[Arc]:
        """The halves of arcs; `NotProvedError`, with the place of `near` or the arcs, at the limit of depth or work."""
        places = " and ".join(dict.fromkeys(arc.place for arc in near or arcs))
        if max(arc.depth for arc in arcs) >= self._deepest:
            lost = "the boundary is thinner than 1e-20 of its size, stops, turns back or has no tangent"
            raise self._error(f"{'the boundary meets itself, or may do so,' if near else lost} near {places}")
        if self._budget[0] < 0:
            raise self._error(f"the proof takes too many steps near {places}")
        return [half for arc in arcs for half in arc.halves()]

    def _cut(self, ring: list[Piece]) -> list[Arc]:
        """A closed curve cut into arcs, each of which meets its neighbours only where they join."""
        found: list[Arc] = []
        rest = [piece.whole for piece in reversed(ring)]
        while rest:
            arc = rest.pop()
            if not in_half_plane(arc.directions):
                rest += reversed(self._halves(arc))
            elif found and turn(found[-1], arc) is None:
                rest += reversed(self._halves(found.pop(), arc))
            else:
                found.append(arc)
        while turn(found[-1], found[0]) is None:
            found = [*self._halves(found[0]), *found[1:-1], *self._halves(found[-1])]
        return found

    def _turns(self, ring: list[Arc]) -> int:
        """The turning number of a closed curve: the full turns of its tangent, counterclockwise."""
        directions: list[Vector] = []
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
            between = turn(a, b)
            if between is None:
                raise self._error(f"the boundary meets itself, or may do so, near {a.place} and {b.place}")
            directions += [a.direction, *between]
        count = 0
        for v, w in zip(directions, [*directions[1:], directions[0]], strict=True):
            if v[1] < 0 <= w[1]:
                count += cross(v, w) > 0
            elif w[1] < 0 <= v[1]:
                count -= cross(v, w) < 0
        return count

    def _apart(self, rings: list[list[Arc]]) -> None:
        """Proves that arcs which are not neighbours do not meet; otherwise `NotProvedError`."""
        nodes = [_Node(arc.box, (), (k, i)) for k, ring in enumerate(rings) for i, arc in enumerate(ring)]
        while len(nodes) > 1:
            pairs = [nodes[i : i + 2] for i in range(0, len(nodes), 2)]
            nodes = [_Node(hull(p[0].box, p[-1].box), tuple(p)) if len(p) > 1 else p[0] for p in pairs]
        todo = [(nodes[0], nodes[0])]
        while todo:
            one, other = todo.pop()
            if one is other:
                todo += combinations_with_replacement(one.parts, 2)
            elif not disjoint(one.box, other.box):
                if one.parts or other.parts:
                    todo += product(one.parts or (one,), other.parts or (other,))
                else:
                    self._arcs_apart(rings, one.place, other.place)

    def _arcs_apart(self, rings: list[list[Arc]], one: tuple[int, int], other: tuple[int, int]) -> None:
        (k, i), (n, j) = sorted((one, other))
        ring = rings[k]
        if k == n:
            rows = [ring[i : j + 1], ring[j:] + ring[: i + 1]]
            if min(map(len, rows)) <= 2 or any(
                len(row) <= RUN and in_half_plane(*(arc.directions for arc in row)) for row in rows
            ):
                return
        todo = [(ring[i], rings[n][j])]
        while todo:
            a, b = todo.pop()
            if not separated(a, b):
                if a.extent >= b.extent:
                    todo += [(half, b) for half in self._halves(a, near=(a, b))]
                else:
                    todo += [(a, half) for half in self._halves(b, near=(a, b))]


def _pieces(formulas: Formulas, marks: list[Expr], near: tuple[Bounds, ...]) -> list[Piece]:
    """A component cut into pieces at the marked parameters inside it."""
    component = formulas.component
    inside = [at for at in marks if (at - component.start).is_positive and (component.end - at).is_positive]
    places = [component.start, *sorted(inside, key=lambda at: at.evalf()), component.end]
    orders = [formulas.order(at, near) for at in places]
    return [Piece(formulas, (places[i], places[i + 1]), (orders[i], orders[i + 1])) for i in range(len(places) - 1)]


def _with_cusp(piece: Piece, after: Piece, near: tuple[Bounds, ...]) -> Piece:
    """`piece`, with `cusp` set if the curve turns back where the piece `after` begins."""
    here, there = piece.at(near).leaving(1), after.at(near).leaving(0)
    low, high = products(cross, here, there)
    if not low <= 0 <= high or products(dot, here, there)[0] <= 0:
        return piece
    (a, b), (c, d) = piece.leaves(1), after.leaves(0)
    return replace(piece, cusp=vanishes(a * d - b * c))


def _surrounds(ring: list[Arc], hole: list[Arc]) -> bool:
    """Does the closed curve `ring` wind round the closed curve `hole`, which it does not meet?"""
    for arc in hole:
        found = _crossings(ring, arc.start)
        if found is not None:
            return found % 2 == 1
    return False


def _crossings(ring: list[Arc], point: Box) -> int | None:
    """The number of arcs that cross the ray from a point to the right; None if this is not decided."""
    (left, right), (low, high) = point
    count, todo = 0, list(ring)
    while todo:
        arc = todo.pop()
        (_, end), (bottom, top) = arc.box
        if end < left or top < low or bottom > high:
            continue
        if arc.box[0][0] <= right:
            if arc.depth >= DEEPEST:
                return None
            todo += arc.halves()
            continue
        ends = arc.start[1], arc.end[1]
        if any(a <= high and low <= b for a, b in ends):
            return None
        count += (ends[0][0] > high) != (ends[1][0] > high)
    return count


def _units(table: Table, values: Mapping[Symbol, Expr]) -> tuple[Expr, Expr]:
    """Powers of two that scale `x` and `y` to a size of about 1; the two differ only if the boundary is very flat.

    Scaling changes no proof: each statement that is proved here is invariant under affine maps.
    """
    found: list[list[Expr]] = [[], []]
    if any(size(c) > LONG for c in table.components[0].point):
        return S.One, S.One
    for component in table.components[:: len(table.components) // PLACES + 1]:
        low, high = component.start.subs(values), component.end.subs(values)
        for share in (S.Zero, Rational(1, 3)):
            for axis, coordinate in zip(found, component.point, strict=True):
                axis.append(coordinate.evalf(BITS // 4, subs={**values, theta: low + (high - low) * share}))
    sizes = [[abs(value - axis[0]) for value in axis] for axis in found]
    powers = [
        max((int(log(each, 2).evalf(9)) for each in axis if each.is_Float and each > 0), default=None) for axis in sizes
    ]
    x, y = (max((p for p in powers if p is not None), default=0) if power is None else power for power in powers)
    if abs(x - y) < FLAT:
        x = y = max(x, y)
    return S(2) ** -x, S(2) ** -y
