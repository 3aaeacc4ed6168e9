"""What is claimed of a tangency, as data: enough to work the proof through anew, with nothing of it believed."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from flint import arb

from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.cycles.recurrence import Closure
from verification.maps.first_hit import closes_smoothly
from verification.proofs.manifolds.plane_map import Pinball, pinball
from verification.proofs.manifolds.proof import Checks, Proof, objection, strange_attractors, tangency_proved
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Contact
from verification.proofs.manifolds.touching import Chain

LARGEST_PERIOD, LARGEST_FLIGHT, LARGEST_TURN = 64, 1000, 1000
FARTHEST = 1000.0  # along an eigenvector, in radians


@dataclass(frozen=True)
class TangencyClaim:
    """Manifolds of a table of one smooth curve touch at one contraction within `10**-digits` of `value`."""

    contact: Contact
    table: Table
    value: str
    digits: int
    law: Law = PAPERS_LAW

    def __post_init__(self) -> None:
        if self.table.shapes or self.table.undefined or not closes_smoothly(self.table):
            wanted = "one smooth curve, a number for each of its parameters, and no point where the map is undefined"
            raise ValueError(f"tangency: {self.table.name} is out of range; accepted: {wanted}")
        if why := objection(self.contact, self.map, float(self.value)):
            raise ValueError(why)

    @cached_property
    def map(self) -> Pinball:
        """The map of the table, with its rotations where the law has them."""
        return pinball(self.table, self.law)

    def chain(self) -> dict[str, Any]:
        """The orbit bounce by bounce, for a reader that knows no series; a few seconds, not proved."""
        return Chain(self.contact, self.map, self.value, self.digits).entries()


@dataclass(frozen=True)
class TangencyProof:
    """A claim with the checklist that was worked through for it."""

    claim: TangencyClaim
    proof: Proof

    @property
    def value(self) -> arb:
        """The contraction."""
        return self.proof.parameter

    @property
    def checks(self) -> Checks:
        """The checklist."""
        return self.proof.checks

    @property
    def certified(self) -> bool:
        """Is the whole checklist proved?"""
        return self.proof.holds

    @property
    def strange(self) -> Checks:
        """The hypotheses of the theorem by which strange attractors exist near the contraction."""
        return strange_attractors(self.claim.contact, self.claim.map, self.proof)


def worked_through(claim: TangencyClaim) -> TangencyProof:
    """The proof of a claim."""
    return TangencyProof(claim, tangency_proved(claim.contact, claim.map, claim.value, claim.digits))


def contact_said(contact: Contact) -> dict[str, Any]:
    """A contact in the words of the certificate format, which calls its parameter a letter.

    >>> orbit = Orbit("triangle", (-0.16,), Closure(1, (1, 3)))
    >>> contact = Contact(orbit, orbit, 5, 1, 0.03, -0.02, 0.66)
    >>> contact_of(contact_said(contact)) == contact
    True
    """
    found = asdict(contact)
    found["letter"] = found.pop("parameter")
    return found | {"unstable": orbit_said(contact.unstable), "stable": orbit_said(contact.stable)}


def contact_of(given: Mapping[str, Any]) -> Contact:
    """The contact of such entries; `ValueError` with what is out of range."""
    unstable, stable = (orbit_of(given[name]) for name in ("unstable", "stable"))
    bounces, sign = int(given["bounces"]), int(given["sign"])
    if not 0 <= bounces <= LARGEST_FLIGHT or sign not in (1, -1):
        raise ValueError(f"certificate: bounces = {bounces} or sign = {sign} is out of range")
    z, end, parameter = (float(given[name]) for name in ("z", "end", "letter"))
    if not (0 < abs(z) < FARTHEST and 0 < abs(end) < FARTHEST and 0 < parameter < 1):
        raise ValueError(f"certificate: z = {z}, end = {end} or letter = {parameter} is out of range")
    return Contact(unstable, stable, bounces, sign, z, end, parameter)


def orbit_said(orbit: Orbit) -> dict[str, Any]:
    """The entries of a document that say which cycle it is, up to Newton's method."""
    return {"name": orbit.name, "start": orbit.start, "sign": orbit.closure.turn, "shift": orbit.closure.shift}


def orbit_of(given: Mapping[str, Any]) -> Orbit:
    """The cycle of such entries."""
    start, sign = tuple(float(x) for x in given["start"]), int(given["sign"])
    turns, parts = (int(x) for x in given["shift"])
    if not 1 <= len(start) <= LARGEST_PERIOD or sign not in (1, -1) or not 1 <= parts <= LARGEST_TURN:
        raise ValueError(f"certificate: a saddle of {len(start)} bounces, sign {sign}, turn 1/{parts} is out of range")
    return Orbit(str(given["name"]), start, Closure(sign, (turns, parts)))
