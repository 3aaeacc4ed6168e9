"""Bifurcations that are met on a branch: their proofs, and their curves in two parameters.

The event in float64 is the start of a proof in balls. A fold and a period doubling are proved on the whole cycle; a
pitchfork on the half cycle that flips, rotated so that the mirror is `theta -> -theta`. Other events have no
certificate here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
from sympy import Expr, S

from symbolic.tables import egg
from symbolic.tables.definition import exact
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.scene import Scene
from symbolic.tables.table import Table
from verification.arithmetic.balls import decimal
from verification.cycles.arc import Steps
from verification.cycles.branch import Branch, Event
from verification.cycles.chords import Chords
from verification.cycles.problem import Problem
from verification.cycles.recurrence import IDENTITY, MIRROR, Array, BifurcationKind
from verification.cycles.switching import Box, CodimensionOneCurve, Tick, curve, switched
from verification.cycles.systems import SHAPE, rotations, symmetries
from verification.named.curves import TWO, largest_shape
from verification.named.locate import proof_near
from verification.proofs.periodic.cycle_in_box import UniqueCycle


def proof_of(
    event: Event, digits: int, parameter: str = "lam", lam: Expr | Fraction | None = None
) -> UniqueCycle | None:
    """The proof that the event happens at the enclosed `parameter`; None if its kind has no certificate.

    If the parameter is a shape, `lam` is the contraction.

    >>> from symbolic.tables import egg
    >>> from verification.cycles.branch import branch
    >>> ring = Chords(egg(3).at(alpha="7/100"), (0, 0))
    >>> (doubling,) = branch(ring, np.array([0, pi]), "lam", 0.1, (0.0, 1.0)).events
    >>> proof = proof_of(doubling, 20)
    >>> proof is not None and proof.proved
    True
    """
    ring = event.ring
    if not isinstance(ring, Chords) or event.kind.solved is None:
        return None
    x, closure = event.x, IDENTITY
    if event.kind is BifurcationKind.PITCHFORK:
        centred = _centred(ring, x)
        if centred is None:
            return None
        x, closure = centred, MIRROR
    contraction = None if lam is None else S(lam)
    problem = Problem(ring.table, ring.components, event.kind.solved, parameter, contraction, closure, ring.law)
    return proof_near(problem, [*(float(v) for v in x), event.value], digits)


def digits_to_follow(period: int) -> int:
    """Digits to add to a proof so that the independent checker can follow the whole cycle, up to `FOLLOWED` bounces."""
    return 2 * period if 6 < period <= FOLLOWED else 0


def _centred(ring: Chords, x: Array) -> Array | None:
    """The half cycle, rotated by a symmetry of the table so that its mirror is `theta -> -theta`, or None."""
    if ring.closure.turn != -1:
        return None
    step = 2 * pi / rotations(ring.table)
    for half in (ring.closure.radians / 2, ring.closure.radians / 2 + pi):
        if abs(np.sin(pi * half / step)) < 1e-9:
            return x - half
    return None


FOLLOWED = 32  # bounces, at most, that the independent checker follows all round
SWITCHES = 3  # crossings at which a branch is left for the one that is born there
BORN = 60  # points of that branch
SAME = 2e-3  # in parts of the plane's size, and of the determinant: a point so near lies on a curve
ALIKE = 1e-6  # between the ends of equal curves
PROVED_AT = (0.2, 0.4, 0.6, 0.8)  # places along the points of a curve where the event is proved


@dataclass(frozen=True)
class Plane:
    """A plane of two parameters, the second of which is `lam`: table and law with both free, and their ranges.

    >>> from symbolic import Scene
    >>> plane = Plane.of(Scene.of({"polar": "1 + b*cos(5*theta)", "shape": {"b": "1/40"}}), "b", ("0", "1/30"))
    >>> plane.two, plane.box[1]
    (('b', 'lam'), (0.0, 1.0))
    """

    table: Table
    law: Law
    two: tuple[str, str]
    box: Box

    @classmethod
    def of_egg(cls, K: int = 3) -> "Plane":
        """The plane of the egg with `K` points: shapes from 1/100 to 1 times the largest, contractions from 0 to 1."""
        top = largest_shape(K)
        return cls(egg(K), PAPERS_LAW, TWO, ((top / 100, top), (0.0, 1.0)))

    @classmethod
    def of(cls, scene: Scene, parameter: str, ends: tuple[Any, Any], lams: tuple[Any, Any] = ("0", "1")) -> "Plane":
        """The plane of a parameter of a scene's table or law and the contraction; `ValueError` if one has no range.

        The ends are exact numbers or text; the formula is proved to be a law in the whole plane.
        """
        shapes, contractions = ([exact(name, end) for end in pair] for name, pair in ((parameter, ends), ("lam", lams)))
        table, law = scene.table, scene.law
        if parameter in scene.shape:
            table = scene.over(parameter, *ends)
        elif parameter not in dict(law.numbers):
            accepted = ", ".join([*scene.shape, *dict(law.numbers)]) or "none"
            raise ValueError(f"{scene.name}: {parameter} is no parameter of its shape or law; accepted: {accepted}")
        if not law.uniform:
            own = {} if parameter in scene.shape else {parameter: (shapes[0], shapes[1])}
            law = Law(law.formula, tuple(pair for pair in law.numbers if pair[0] not in own))
            law.check((contractions[0], contractions[1]), *law.places(table), **own)
        low, high, least, most = (float(end) for end in (*shapes, *contractions))
        return cls(table, law, (parameter, "lam"), ((low, high), (least, most)))


@dataclass(frozen=True, eq=False)
class EventCurve:
    """The curve of a bifurcation of a cycle of `period` bounces, and the point `near` of the plane where it was met.

    Each point has the two parameters and `det M - 1`; those of codimension two are listed in `special` by name. `depth`
    is the number of doublings and pitchforks between the branch that was followed and the cycle of the curve. `proved`
    lists points of the curve at which the event is proved in balls: an exact shape, the contraction, its radius; and
    `certificates` the certificates of these points.
    """

    kind: str
    period: int
    near: tuple[float, float]
    points: Sequence[Sequence[float]] = field(repr=False)
    special: Sequence[tuple[str, float, float]]
    ends: Sequence[str]
    depth: int = 0
    command: str = ""
    proved: Sequence[Sequence[str]] = ()
    certificates: Sequence[dict[str, Any]] = field(default=(), repr=False)

    def document(self) -> dict[str, Any]:
        """The curve as JSON."""
        return dict(self.__dict__)

    def passes(self, at: tuple[float, float, float], box: Box) -> bool:
        """True if the curve passes the point `at` (two parameters, `det M - 1`), up to `SAME` of the plane's size.

        At a pitchfork the determinant is that of the half cycle that flips, and is not compared.
        """
        third = np.inf if self.kind == BifurcationKind.PITCHFORK.value else 1.0
        points = (np.array(self.points) - np.array(at)) / np.array([*(high - low for low, high in box), third])
        before, step = points[:-1], np.diff(points, axis=0)
        length = np.maximum(np.sum(step[:, :2] ** 2, axis=1), np.finfo(float).tiny)
        share = np.clip(-np.sum(before[:, :2] * step[:, :2], axis=1) / length, 0.0, 1.0)
        return bool(np.any(np.max(np.abs(before + share[:, None] * step), axis=1) < SAME))

    def runs_as(self, other: "EventCurve") -> bool:
        """True if both curves have the same ends, in either order. Symmetric images of a cycle have equal curves."""
        ends = np.array([self.points[0], self.points[-1]])
        return any(np.allclose(ends, other.points[::way][:: len(other.points) - 1], atol=ALIKE) for way in (1, -1))


def curves_along(
    branch: Branch,
    plane: Plane,
    other: float,
    known: Sequence[EventCurve] = (),
    steps: Steps | None = None,
    tick: Tick | None = None,
) -> Iterator[EventCurve]:
    """The curves, in a plane, of events on a branch and on the branches born on it, up to `SWITCHES` generations.

    `other` is the value of the plane's other parameter, fixed on the branch. Curves in `known` are not repeated.
    """
    first = branch.system.parameter == plane.two[0]
    seen, interval = list(known), plane.box[0 if first else 1]
    for depth in range(SWITCHES + 1):
        period = branch.system.recurrence.period
        for event in branch.events:
            kind, near = event.kind.value, (event.value, other) if first else (other, event.value)
            alike = [each for each in seen if (each.kind, each.period) == (kind, period)]
            if any(each.passes((*near, event.point.tests["volume"]), plane.box) for each in alike):
                continue
            found = curve_of(event, plane, near, steps, tick)
            if found is None or len(found.points) < 2:
                continue
            points = [[float(x) for x in (*p.z[-2:], p.tests["volume"])] for p in found.points]
            special, ends = [(d.kind.value, *d.parameters) for d in found.special], [why for _, why in found.ends]
            proved, certificates = proved_on(event, found, plane)
            curve = EventCurve(kind, period, near, points, special, ends, depth, "", proved, certificates)
            if not any(curve.runs_as(each) for each in alike):
                seen.append(curve)
                yield curve
        crossing = next((e for e in branch.events if e.kind.solved is BifurcationKind.FLIP), None)
        if crossing is None or depth == SWITCHES:
            return
        try:
            branch = switched(branch, crossing, interval, Steps(most=BORN))[0]
        except (ValueError, IndexError):
            return


def proved_on(
    event: Event, found: CodimensionOneCurve, plane: Plane, digits: int = 12
) -> tuple[list[tuple[str, str, str]], list[dict[str, Any]]]:
    """Points spread over a curve at which the event is proved, and their certificates.

    A point is an exact shape, the contraction, and its radius. Between these points the curve is known in float64 only.
    Empty if the parameter is one of the law.
    """
    rows, certificates = list[tuple[str, str, str]](), list[dict[str, Any]]()
    (letter, _), ring = plane.two, event.ring
    if not isinstance(ring, Chords) or letter not in {p.symbol.name for p in plane.table.shapes}:
        return rows, certificates
    for share in PROVED_AT:
        text = f"{found.points[int(share * (len(found.points) - 1))].z[-2]:.6g}"
        try:
            for z in found.crossing(float(text)):
                here = replace(ring, table=plane.table.at(**{letter: exact(letter, text)}))
                at = replace(event, ring=here, point=replace(event.point, z=z[[*range(len(z) - 2), -1]]), x=z[:-2])
                proof = proof_of(at, digits + digits_to_follow(ring.period))
                if proof is not None and proof.proved:
                    certificates.append(proof.document())
                    rows.append((text, *decimal(proof.value, digits)))
        except (ValueError, ZeroDivisionError):
            continue
    return rows, certificates


def curve_of(
    event: Event, plane: Plane, near: tuple[float, float], steps: Steps | None = None, tick: Tick | None = None
) -> CodimensionOneCurve | None:
    """The curve through an event in a plane of two parameters, met at `near`; None if there is none or it is lost.

    A pitchfork needs the symmetry that it breaks; if the table has it at one value of the parameter only, there is no
    curve. `tick` is called with each point.
    """
    ring = event.ring
    if event.kind.solved is None or not isinstance(ring, Chords):
        return None
    if ring.closure != IDENTITY and ring.closure not in symmetries(plane.table, plane.law):
        return None
    ring, (low, high) = replace(ring, table=plane.table, law=plane.law), plane.box[0]
    steps = steps or Steps(largest=0.3, most=150)
    unit = SHAPE if plane.two == TWO else high - low
    try:
        return curve(ring, event.kind.solved, event.x, plane.two, near, plane.box, None, steps, tick, unit)
    except ValueError:
        return None
