"""The orbit of a contact in float64: from one local manifold to the other, far into both, with its tangent.

Near the saddle the points come from the series, which costs no digit; only between the two neighbourhoods
the map is followed.
"""

from dataclasses import dataclass
from typing import Any

from verification.manifolds.recurrence import Recurrence
from verification.manifolds.series import Local, horner
from verification.manifolds.tangency import Contact, rounds
from verification.shooting.jets import Jet


@dataclass(frozen=True)
class Flight:
    """Bounces with their derivatives by `z`, from bounce -1 on the one manifold to bounce 1 on the other.

    `z` and `w` are the parameters at its ends, displacements along the eigenvectors; `w` is a jet in `z`.
    """

    bounces: list[Jet]
    z: float
    w: Jet


def flight(contact: Contact, map: Recurrence, out: Local, into: Local, early: int, late: int) -> Flight:
    """The orbit from `early` rounds before the start of the contact to `late` rounds after its end.

    Both are at least as many as take the ends of the contact into the domains of the series.

    >>> from verification.arithmetic import FLOAT64
    >>> from verification.manifolds.known import CONTACTS, SHAPE, table
    >>> from verification.manifolds.saddle import saddle
    >>> from verification.manifolds.series import local
    >>> triangle, map = CONTACTS["boundary"], table(SHAPE).over(FLOAT64)
    >>> out, into = (local(saddle(triangle.unstable, map, triangle.letter), side) for side in (True, False))
    >>> len(flight(triangle, map, out, into, 2, 3).bounces)
    13
    """
    p, q = len(contact.unstable.start), len(contact.stable.start)
    before, after = (
        rounds(contact.z / out.unit, float(out.factor)),
        rounds(contact.end / into.unit, 1 / float(into.factor)),
    )
    z, w0 = contact.z / float(out.factor) ** early, contact.end * float(into.factor) ** after
    found = [bounce(out, j, Jet(z, 1.0)) for j in range(-1, (early - before) * p + 2)]
    for _ in range(contact.bounces + before * p + after * q):
        found.append(map.lifted.following(found[-2], found[-1], contact.letter))
    end, rate = bounce(into, 0, Jet(w0, 1.0)).c
    sign = contact.sign * contact.unstable.sign**early * contact.stable.sign**after  # each round may mirror the rest
    w = Jet(w0, sign * found[-2].c[1] / rate)
    turn = found[-2].c[0] - sign * end
    if map.turn:
        unit = 2 * map.words["pi"] / map.turn
        turn = round(turn / unit) * unit
    for j in range(2, (late - after) * q + 2):
        found.append(sign * bounce(into, j, w) + turn)
    return Flight(found, z, w * float(into.factor) ** (late - after))


def bounce(local: Local, j: int, z: Jet) -> Jet:
    """Bounce `j`, any integer, of the orbit through a displacement `z` along the eigenvector."""
    orbit, (rounds, place) = local.saddle.orbit, divmod(j, len(local.coefficients))
    shift: Any = orbit.shifted(local.saddle.map)
    x: Jet = horner(local.coefficients[place], z * (float(local.factor) ** rounds / local.unit))
    for _ in range(abs(rounds)):
        x = orbit.sign * x + shift if rounds > 0 else orbit.sign * (x - shift)
    return x
