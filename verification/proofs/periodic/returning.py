"""Where cycles of the egg can be for every small contraction: a cover of phase space, and what each part bears.

For `0 <= lam <= most` a ball leaves at a small angle, so that phase space is a band around `phi = 0`; its rotations
and mirror images make it a band over one sixth of the boundary, from a vertex (0) to a flat point (`pi/3`). It is cut
into cells of `theta`, each with a bound on `abs(phi)`. Where a cell lands is enclosed in balls: the exit angle of a
chord falls as its end goes round, so the ends of the image are found by two signs. A cell that no cell leads to, or
that leads to none, holds no point of a cycle; what is left is cut in halves, and falls into parts that lead to each
other in no other way: a cycle lies within one of them.

A part that leads through its pieces in turn is *repelling* when a cone of directions around that of the boundary is
kept and stretched once round the pieces, which makes every cycle in it unstable; it is *contracting* when the norm of
the derivative once round is below 1. Over the hull of all contracting parts it is below 1 too: the difference of two
points of a piece is multiplied by a matrix within the bounds for its hull, so that there is one cycle at most in all
of them, up to symmetry.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from sympy import Expr

from symbolic.expressions.text import load
from symbolic.motion.chords import chord_kernel
from symbolic.tables import egg
from symbolic.tables.table import Table
from verification.arithmetic.balls import FLOAT64, balls, working
from verification.arithmetic.iteration import Stop, Tick, Vector, iterated, silent
from verification.maps.first_hit import convex

BITS = 64
SIXTH = 1.05  # a little over pi/3
FIRST, HALVINGS = 6, 8  # cells are SIXTH/2**FIRST wide at first, and are cut in halves so often at most
SLACK = 2.0**-40  # of sums of floats


@dataclass(frozen=True)
class Piece:
    """A stretch of neighbouring cells, and bounds over it: of d theta1/d theta, from both sides."""

    low: float
    high: float
    least: float
    most: float


@dataclass(frozen=True)
class Returning:
    """The parts that repel, each in pieces, and the hull of those that contract; `proved`: there are no others."""

    proved: bool | None
    repelling: tuple[tuple[Piece, ...], ...]
    contracting: tuple[Piece, ...]
    cells: int


Span = tuple[float, float]


@dataclass(frozen=True)
class Image:
    """The image of a cell: stretches of the sixth, each mirrored (-1) or not, and its derivative, row by row."""

    stretches: tuple[tuple[float, float, int], ...]
    incidence: Span
    derivative: tuple[Span, Span, Span, Span]  # of (theta1, phi1) by (theta, phi)


def returning(alpha: Expr, lams: Span, tick: Tick = silent) -> Returning:
    """Where can cycles of the three-pointed egg be, for every contraction from `lams[0]` to `lams[1]`?

    >>> from sympy import Rational
    >>> found = returning(Rational(2, 25), (0.0, 2.0**-10))
    >>> found.proved, [(round(piece.low, 2), round(piece.high, 2)) for piece in found.contracting]
    (True, [(0.04, 0.05), (0.91, 0.95)])
    """
    table, count, most = egg(3).at(alpha=alpha), 0, lams[1]
    if convex(table) is not True:
        return Returning(None, (), (), 0)
    widest = most * math.pi / 2
    cells: dict[int, Span] = dict.fromkeys(range(2**FIRST), (-widest, widest))
    for halving in range(HALVINGS):
        width = SIXTH / 2 ** (FIRST + halving)
        images = {k: image(table, (k * width, (k + 1) * width), phi, lams) for k, phi in cells.items()}
        count += len(images)
        tick(1 / HALVINGS)
        leads = _leads(images, lams, width)
        parts = _parts(leads)
        found = [_judged(part, leads, images, width) for part in parts]
        if all(verdict is not None for verdict in found):
            each = [(pieces, repels) for pieces, repels in filter(None, found)]
            hull = _hull([pieces for pieces, repels in each if not repels], table, width, cells, lams)
            if hull is not None:
                return Returning(True, tuple(pieces for pieces, repels in each if repels), hull, count)
        kept = {k for part in parts for k in part}
        arriving: dict[int, list[Span]] = {}
        for k in kept:
            for j, phi in leads[k].items():
                arriving.setdefault(j, []).append(phi)
        cells = {2 * k + half: _spanning(arriving[k]) for k in sorted(kept) for half in (0, 1)}
    return Returning(None, (), (), count)


def _spanning(spans: Sequence[Span]) -> Span:
    return min(low for low, _ in spans), max(high for _, high in spans)


def image(table: Table, cell: Span, phi: Span, lams: Span) -> Image:
    """Where balls land that leave between two parameters at angles between two, and how their landings vary."""
    exact, angle = _angles(table)
    middle, exit = (cell[0] + cell[1]) / 2, (phi[0] + phi[1]) / 2
    end = _landing(exact, middle, exit)
    _, by_here, by_there, *_ = exact(middle, end)
    reach = (abs(by_here) * (cell[1] - cell[0]) + phi[1] - phi[0]) / 2 / abs(by_there) * 1.05 + 1e-9
    with working(BITS):
        wide = arb(middle, (cell[1] - cell[0]) / 2 + SLACK)
        while not _lands_within(angle, arb(middle), wide, end, reach, phi):
            reach *= 1.25
        landing = arb(end, reach)
        _, by_here, by_there, *_ = angle(wide, landing)
        eta, here, there, *_ = angle(landing, wide)
        along, across, lam = -by_here / by_there, 1 / by_there, ball(lams)
        entries = along, across, -lam * (here * along + there), -lam * here * across
        return Image(_folded(end, reach), span(eta), (span(entries[0]), *map(span, entries[1:])))  # type: ignore[arg-type]


def span(x: arb) -> Span:
    """The ends of a ball."""
    return float(x.lower()), float(x.upper())


def ball(ends: Span) -> arb:
    """The ball between two ends."""
    return arb((ends[0] + ends[1]) / 2, (ends[1] - ends[0]) / 2 + SLACK)


def _angles(table: Table) -> tuple[Any, Any]:
    """The exit angle of a chord and its first derivatives, in floats and in balls."""
    text = chord_kernel(table, 0, 0, 1)
    return load(text, FLOAT64), load(text, balls(BITS))


def _landing(angle: Any, here: float, phi: float) -> float:
    """Where a particle lands, in float64."""

    def correction(x: Vector) -> list[float]:
        value, _, slope, *_ = angle(here, x[0])
        return [(value - phi) / slope]

    return float(iterated(correction, [here + math.pi - 2 * phi], Stop(steps=60)).x[0])


def _lands_within(angle: Any, centre: arb, cell: arb, end: float, reach: float, phi: Span) -> bool:
    """Is the chord's angle above all of `phi` at one end, for every start of the cell, and below it at the other?"""
    if reach > 1:
        raise ArithmeticError(f"no landing of the cell at {centre} is enclosed")
    sides = []
    for x in (arb(end) - arb(reach), arb(end) + arb(reach)):
        sides.append(angle(centre, x)[0] + angle(cell, x)[1] * (cell - centre))
    return bool(sides[0] > phi[1] and sides[1] < phi[0])


def _folded(end: float, reach: float) -> tuple[tuple[float, float, int], ...]:
    """The images of a stretch in the sixth from a vertex to a flat point, with -1 where it is mirrored."""
    third, whole = 2 * math.pi / 3, math.remainder(end, 2 * math.pi / 3)
    sign, middle, reach = 1 if whole >= 0 else -1, abs(whole), reach + SLACK
    low, high = middle - reach, middle + reach
    found = [(max(low, 0.0), min(high, math.pi / 3 + SLACK), sign)]
    found += [(0.0, -low, -sign)] if low < 0 else []
    return (*found, (third - high, math.pi / 3 + SLACK, -sign)) if high > math.pi / 3 else tuple(found)


def _leads(images: dict[int, Image], lams: Span, width: float) -> dict[int, dict[int, Span]]:
    """The cells that each cell leads to, and the exit angles with which it arrives there."""
    found: dict[int, dict[int, Span]] = {}
    for k, at in images.items():
        found[k] = {}
        for low, high, sign in at.stretches:
            exits = [-sign * lam * eta for lam in lams for eta in at.incidence]
            span = min(exits) - SLACK, max(exits) + SLACK
            for j in range(int(low / width - SLACK), int(high / width + SLACK) + 1):
                if j in images:
                    found[k][j] = _spanning([span, found[k].get(j, span)])
    return found


def _parts(leads: dict[int, dict[int, Span]]) -> list[list[int]]:
    """The sets of cells that lead to each other."""
    order = sorted(leads)
    place = {k: n for n, k in enumerate(order)}
    pairs = np.array([(place[k], place[j]) for k in order for j in leads[k]]).reshape(-1, 2).T
    graph = csr_matrix((np.ones(pairs.shape[1]), (pairs[0], pairs[1])), shape=(len(order), len(order)))
    _, label = connected_components(graph, connection="strong")
    groups: dict[int, list[int]] = {}
    for k, n in zip(order, label, strict=True):
        groups.setdefault(int(n), []).append(k)
    return [part for part in groups.values() if len(part) > 1 or part[0] in leads[part[0]]]


Judged = tuple[tuple[Piece, ...], bool] | None


def _judged(
    part: Sequence[int],
    leads: dict[int, dict[int, Span]],
    images: dict[int, Image],
    width: float,
) -> Judged:
    """Its pieces, and whether the part repels (True) or contracts (False); None when neither is proved."""
    pieces = _runs(part)
    after = [{n for n, other in enumerate(pieces) for k in run if leads[k].keys() & set(other)} for run in pieces]
    order = _round(after)
    if len(order) != len(pieces):
        return None
    pieces = [pieces[n] for n in order]
    wide = [_joined([images[k] for k in run]) for run in pieces]
    found = tuple(
        Piece(run[0] * width, (run[-1] + 1) * width, *at.derivative[0]) for run, at in zip(pieces, wide, strict=True)
    )
    slowest, fastest = _once_round(wide)
    return (found, True) if slowest > 1 else (found, False) if fastest < 1 else None


def _once_round(pieces: Sequence[Image]) -> tuple[float, float]:
    """Of the derivative once round the pieces: the least stretch in a cone, 0 when it is not kept, and a norm.

    The cone is `abs(dphi) <= c*abs(dtheta)`, the norm `max(abs(dtheta), abs(dphi)/c)`, with a `c` that suits both.
    """
    with working(BITS):
        a, b, c, d = arb(1), arb(0), arb(0), arb(1)
        for at in pieces:
            p, q, r, s = map(ball, at.derivative)
            a, b, c, d = p * a + q * c, p * b + q * d, r * a + s * c, r * b + s * d
        wide = 2 * abs(c).upper() + 2.0**-20
        least = abs(a).lower() - abs(b).upper() * wide
        kept = abs(c).upper() + abs(d).upper() * wide <= wide * least
        largest = max(float((abs(a) + abs(b) * wide).upper()), float((abs(c) / wide + abs(d)).upper()))
        return float(least.lower()) if kept else 0.0, largest


def _hull(
    parts: Sequence[Sequence[Piece]], table: Table, width: float, cells: dict[int, Span], lams: Span
) -> tuple[Piece, ...] | None:
    """The hulls of the pieces of all contracting parts, if the norm contracts over them; None when it is not proved.

    Pieces must keep off vertices and flat points, and the image of each lie on one side of these.
    """
    if len({len(part) for part in parts}) != 1:
        return None
    phi, hulls = _spanning(list(cells.values())), []
    for pieces in zip(*parts, strict=True):
        low, high = min(piece.low for piece in pieces), max(piece.high for piece in pieces)
        steps = [low + k * width for k in range(round((high - low) / width) + 1)]
        images = [image(table, (x, x + width), phi, lams) for x in steps]
        if not (low > 0 and high < math.pi / 3) or len({sign for at in images for *_, sign in at.stretches}) != 1:
            return None
        wide = _joined(images)
        hulls.append((Piece(low, high, *wide.derivative[0]), wide))
    apart = all(a.high < b.low for a, b in pairwise(sorted((piece for piece, _ in hulls), key=lambda piece: piece.low)))
    contracts = _once_round([wide for _, wide in hulls])[1] < 1
    return tuple(piece for piece, _ in hulls) if apart and contracts else None


def _runs(part: Sequence[int]) -> list[list[int]]:
    """Stretches of neighbouring cells."""
    runs = [[part[0]]]
    for k in part[1:]:
        runs[-1:] = [[*runs[-1], k]] if k == runs[-1][-1] + 1 else [runs[-1], [k]]
    return runs


def _round(after: Sequence[set[int]]) -> list[int]:
    """The pieces in the order in which each leads to the next, from the first; none when one leads to several."""
    order = [0]
    while len(order) <= len(after) and len(after[order[-1]]) == 1:
        (following,) = after[order[-1]]
        if following == 0:
            return order
        order.append(following)
    return []


def _joined(images: Sequence[Image]) -> Image:
    """Bounds that hold for each of several images."""
    entries = (_spanning([at.derivative[n] for at in images]) for n in range(4))
    return Image((), (0.0, 0.0), tuple(entries))  # type: ignore[arg-type]  # of four entries
