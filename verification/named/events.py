"""Bifurcations met on a branch: each certified, and followed as a curve in two parameters.

The event in float64 is the start, and balls prove what is near it. A fold and a period doubling are proved on the
whole cycle, a pitchfork on the half that flips, turned so that the mirror is `theta -> -theta`. Other events have no
certificate here.

`survey` finds all cycles of the egg up to a period and follows each in `lam`, and every fold, doubling and pitchfork
on the way as a curve in `(alpha, lam)`, with its points of codimension two. Cycles that a symmetry maps to each other
count once.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi

import numpy as np
from sympy import Expr, S

from symbolic.tables import egg
from verification.cycles.arc import Steps
from verification.cycles.branch import Event, branch
from verification.cycles.chords import Chords
from verification.cycles.problem import Problem
from verification.cycles.recurrence import IDENTITY, MIRROR, Array, BifurcationKind
from verification.cycles.search import all_cycles
from verification.cycles.switching import Curve, curve
from verification.cycles.systems import rotations
from verification.named.curves import TWO, largest_shape
from verification.named.locate import certify
from verification.proofs.periodic.bifurcation import Proof


def proof_of(event: Event, digits: int, parameter: str = "lam", lam: Expr | Fraction | None = None) -> Proof | None:
    """The proof that the event happens at the enclosed `parameter`; None where there is no certificate for its kind.

    Where the parameter is a shape, `lam` is the contraction.

    >>> from symbolic.tables import egg
    >>> from verification.cycles.branch import branch
    >>> ring = Chords(egg(3).at(alpha="7/100"), (0, 0))
    >>> (doubling,) = branch(ring, np.array([0, pi]), "lam", 0.1, (0.0, 1.0)).events
    >>> proof = proof_of(doubling, 20)
    >>> proof is not None and proof.certified
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
    return certify(problem, [*(float(v) for v in x), event.value], digits)


def _centred(ring: Chords, x: Array) -> Array | None:
    """The half cycle turned by a symmetry of the table until its mirror is `theta -> -theta`."""
    if ring.closure.turn != -1:
        return None
    step = 2 * pi / rotations(ring.table)
    for half in (ring.closure.radians / 2, ring.closure.radians / 2 + pi):
        if abs(np.sin(pi * half / step)) < 1e-9:
            return x - half
    return None


Tick = Callable[[str], None]


@dataclass(frozen=True)
class Surveyed:
    """An event on the branch of a cycle of `period` bounces, and its curve; None when it could not be followed."""

    period: int
    event: Event
    curve: Curve | None


def survey(
    alpha: Expr, lam: Expr, longest: int, K: int = 3, tick: Tick = lambda said: None, steps: Steps | None = None
) -> Iterator[Surveyed]:
    """The curves of the egg with K points that the cycles at one shape and contraction lead to.

    >>> from sympy import Rational
    >>> [(one.period, one.event.kind.value) for one in survey(Rational(7, 100), Rational(1, 20), 2)]
    [(2, 'period doubling')]
    """
    table = egg(K)
    seen: set[tuple[object, ...]] = set()
    for cycle in all_cycles(table.at(alpha=alpha), lam, longest).catalogue.cycles:
        mark = cycle.period, round(cycle.spectrum.trace, 6), round(cycle.spectrum.determinant, 6)
        if mark in seen:
            continue
        seen.add(mark)
        tick(f"period {cycle.period}")
        ring, at = Chords(table, (0,) * cycle.period), {"alpha": float(alpha)}
        try:
            one = branch(ring, np.array(cycle.theta), "lam", float(lam), (0.0, 1.0), at, steps=Steps(most=250))
        except ValueError:
            continue  # at a bifurcation to within rounding: its neighbours lead there too
        for event in one.events:
            own = cycle.period, event.kind, round(event.value, 7)
            if event.kind.solved and own not in seen:
                seen.add(own)
                yield Surveyed(cycle.period, event, curve_of(event, at["alpha"], K, steps))


def curve_of(event: Event, alpha: float, K: int = 3, steps: Steps | None = None) -> Curve | None:
    """The curve in `(alpha, lam)` through an event of the egg at shape `alpha`; None when it has none or is lost."""
    if event.kind.solved is None or not isinstance(event.ring, Chords):
        return None
    top = largest_shape(K)
    box = ((top / 100, top), (0.0, 1.0))
    steps = steps or Steps(largest=0.3, most=150)
    ring = replace(event.ring, table=egg(K))
    try:
        return curve(ring, event.kind.solved, event.x, TWO, (alpha, event.value), box, steps=steps)
    except ValueError:
        return None
