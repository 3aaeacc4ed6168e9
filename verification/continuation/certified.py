"""Events with certified digits: the float64 event is the start, balls prove what is near it.

A fold and a period doubling are proved on the whole cycle, a pitchfork on the half that flips, turned
so that the mirror is `theta -> -theta`. Other events have no certificate here.
"""

from fractions import Fraction
from math import pi

import numpy as np
from sympy import Expr, S

from verification.certificates.bifurcation import Proof
from verification.continuation.branch import Event, What
from verification.continuation.recurrence import Array, Chords
from verification.continuation.symmetry import rotations
from verification.locate import certify
from verification.shooting.problem import Kind, Problem

KINDS = {What.FOLD: Kind.FOLD, What.FLIP: Kind.FLIP, What.PITCHFORK: Kind.FLIP}


def proof_of(event: Event, digits: int, letter: str = "lam", lam: Expr | Fraction | None = None) -> Proof | None:
    """The proof that the event happens at the enclosed `letter`; None where there is no certificate for its kind.

    Where the letter is a shape, `lam` is the contraction.

    >>> from symbolic.tables import egg
    >>> from verification.continuation.branch import branch
    >>> ring = Chords(egg(3).at(alpha="7/100"), (0, 0))
    >>> (doubling,) = branch(ring, np.array([0, pi]), "lam", 0.1, (0.0, 1.0)).events
    >>> proof = proof_of(doubling, 20)
    >>> proof is not None and proof.certified
    True
    """
    ring = event.ring
    if not isinstance(ring, Chords) or event.what not in KINDS:
        return None
    x, mirror = event.x, False
    if event.what is What.PITCHFORK:
        centred = _centred(ring, x)
        if centred is None:
            return None
        x, mirror = centred, True
    contraction = None if lam is None else S(lam)
    problem = Problem(ring.table, ring.components, KINDS[event.what], letter, contraction, mirror)
    return certify(problem, [*(float(v) for v in x), event.value], digits)


def _centred(ring: Chords, x: Array) -> Array | None:
    """The half cycle turned by a symmetry of the table until its mirror is `theta -> -theta`."""
    if ring.ends.turn != -1:
        return None
    step = 2 * pi / rotations(ring.table)
    for half in (ring.ends.shift / 2, ring.ends.shift / 2 + pi):
        if abs(np.sin(pi * half / step)) < 1e-9:
            return x - half
    return None
