"""What a proof of a tangency claims, as a document: enough to work it through anew, with nothing of it believed."""

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from flint import arb
from sympy import Expr

from symbolic import tables
from symbolic.tables.formula import number
from verification.cycles.recurrence.closure import Closure
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.proof import Checks, Proof, tangency_proved
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.tangency import Contact

LARGEST_DIGITS, LARGEST_PERIOD, LARGEST_FLIGHT = 600, 64, 1000
FARTHEST = 1000.0  # along an eigenvector, in radians
DECIMAL = re.compile(r"0\.\d{1,1000}")
KIND = "tangency"


@dataclass(frozen=True)
class TangencyClaim:
    """Manifolds of the three-pointed egg touch at one contraction within `10**-digits` of `value`."""

    contact: Contact
    alpha: Expr
    value: str
    digits: int

    @property
    def map(self) -> Pinball:
        """The map of the table, with its rotations."""
        return Pinball(tables.egg(3).at(alpha=self.alpha), turn=3)

    def to_dict(self) -> dict[str, Any]:
        """The entries of a document that state the claim.

        >>> from sympy import Rational
        >>> where = Contact(Orbit("a", (0.5,)), Orbit("a", (0.5,)), 3, 1, 0.01, 0.02, 0.6)
        >>> claim = TangencyClaim(where, Rational(2, 25), "0.6", 20)
        >>> claim_of(claim.to_dict()) == claim
        True
        """
        return {
            "kind": KIND,
            "table": "egg",
            "points": 3,
            "shape": {"alpha": str(self.alpha)},
            "contact": asdict(self.contact)
            | {"unstable": _document(self.contact.unstable), "stable": _document(self.contact.stable)},
            "value": self.value,
            "digits": self.digits,
        }


@dataclass(frozen=True)
class TangencyProof:
    """A claim with the checklist that was worked through for it."""

    claim: TangencyClaim
    proof: Proof

    @property
    def value(self) -> arb:
        """The contraction."""
        return self.proof.letter

    @property
    def checks(self) -> Checks:
        """The checklist."""
        return self.proof.checks

    @property
    def certified(self) -> bool:
        """Is the whole checklist proved?"""
        return self.proof.holds


def worked_through(claim: TangencyClaim) -> TangencyProof:
    """The proof of a claim."""
    return TangencyProof(claim, tangency_proved(claim.contact, claim.map, claim.value, claim.digits))


def claim_of(given: Mapping[str, Any]) -> TangencyClaim:
    """The claim of a document; `ValueError` with the entry that is wrong."""
    try:
        if (given["table"], given["points"]) != ("egg", 3):
            raise ValueError(f"certificate: table = {given['table']!r} is out of range; accepted: the egg of 3 points")
        alpha = number(given["shape"]["alpha"], "alpha")
        digits, value = int(given["digits"]), str(given["value"])
        if not 10 <= digits <= LARGEST_DIGITS or not DECIMAL.fullmatch(value):
            raise ValueError(f"certificate: digits = {digits} or value = {value[:30]} is out of range")
        contact = _contact(given["contact"])
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None
    return TangencyClaim(contact, alpha, value, digits)


def _contact(given: Mapping[str, Any]) -> Contact:
    unstable, stable = (_orbit(given[name]) for name in ("unstable", "stable"))
    bounces, sign = int(given["bounces"]), int(given["sign"])
    if not 0 <= bounces <= LARGEST_FLIGHT or sign not in (1, -1):
        raise ValueError(f"certificate: bounces = {bounces} or sign = {sign} is out of range")
    z, end, letter = (float(given[name]) for name in ("z", "end", "letter"))
    if not (0 < abs(z) < FARTHEST and 0 < abs(end) < FARTHEST and 0 < letter < 1):
        raise ValueError(f"certificate: z = {z}, end = {end} or letter = {letter} is out of range")
    return Contact(unstable, stable, bounces, sign, z, end, letter)


def _document(orbit: Orbit) -> dict[str, Any]:
    return {"name": orbit.name, "start": orbit.start, "sign": orbit.closure.turn, "shift": orbit.closure.shift}


def _orbit(given: Mapping[str, Any]) -> Orbit:
    start, sign = tuple(float(x) for x in given["start"]), int(given["sign"])
    turns, parts = (int(x) for x in given["shift"])
    if not 1 <= len(start) <= LARGEST_PERIOD or sign not in (1, -1) or parts not in (1, 3):
        raise ValueError(f"certificate: a saddle of {len(start)} bounces, sign {sign}, turn 1/{parts} is out of range")
    return Orbit(str(given["name"]), start, Closure(sign, (turns, parts)))
