"""Tangencies of invariant manifolds of a table, as theorems with a certificate file."""

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Self

from flint import arb

from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Table
from verification.cycles.recurrence import Closure
from verification.maps.first_hit import closes_smoothly
from verification.proofs.manifolds.plane_map import Pinball, pinball
from verification.proofs.manifolds.proof import ManifoldsTouch, StrangeAttractors, objection
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact
from verification.proofs.manifolds.touching import ContactChain
from verification.rigorous.certificate import SCHEMA, Certified, decimal_result
from verification.rigorous.scene_entries import check_size, scene_of, scene_said, title_of
from verification.rigorous.theorem import Theorem, Verdict

LARGEST_DIGITS, LARGEST_PERIOD, LARGEST_FLIGHT, LARGEST_TURN = 600, 64, 1000, 1000
FARTHEST = 1000.0  # along an eigenvector, in radians
DECIMAL = re.compile(r"0\.[0-9]{1,1000}")
STATEMENT = (
    "{scene}: manifolds of the two saddles touch at exactly one lam in the box, quadratically, and pass through each "
    "other as lam varies."
)


@dataclass(frozen=True, repr=False)
class Tangency(Certified):
    """Manifolds of a table of one smooth curve touch at one contraction within `10**-digits` of `near`.

    `contact` names the manifolds and gives starts for Newton's method.
    """

    kind = "tangency"
    schema = SCHEMA
    beside = ("checks", "bits", "centre", "radius", "unstable", "stable", "orbit", "meets")  # `orbit` lists the bounces
    contact: Contact
    table: Table
    near: str
    digits: int
    law: Law = PAPERS_LAW

    def __post_init__(self) -> None:
        if self.table.shapes or self.table.undefined or not closes_smoothly(self.table):
            wanted = "one smooth curve, a number for each of its parameters, and no point where the map is undefined"
            raise ValueError(f"tangency: {self.table.name} is not of the accepted kind: {wanted}")
        if why := objection(self.contact, self.map, float(self.near)):
            raise ValueError(why)

    @cached_property
    def map(self) -> Pinball:
        """The table's map; it includes the table's rotations if they are symmetries of the law too."""
        return pinball(self.table, self.law)

    @cached_property
    def proof(self) -> ManifoldsTouch:
        """The theorem on the map."""
        return ManifoldsTouch(self.contact, self.map, self.near, self.digits)

    hypotheses = ManifoldsTouch.hypotheses

    @property
    def checks(self) -> dict[str, Verdict]:
        """The verdicts on the hypotheses of `ManifoldsTouch`."""
        return self.proof.checks

    @property
    def value(self) -> arb:
        """The contraction, as a ball."""
        return self.proof.value

    @property
    def strange(self) -> StrangeAttractors:
        """The theorem that strange attractors exist near the contraction."""
        return self.proof.strange

    @property
    def result(self) -> dict[str, Any]:
        """The contraction as a decimal with `digits` digits, and its radius."""
        return decimal_result(self.value, self.digits)

    @property
    def follows(self) -> dict[str, Theorem]:
        """The theorem that strange attractors exist nearby, as a dictionary."""
        return {"strange_attractors": self.strange}

    @property
    def name(self) -> str:
        """The title of the theorem: the scene whose manifolds touch."""
        return f"tangency of two manifolds: {title_of(scene_said(self.table, self.law))}"

    @property
    def evidence(self) -> dict[str, Any]:
        """The checklist and, if proved, the orbit bounce by bounce, for a checker without power-series arithmetic."""
        chain = ContactChain(self.contact, self.map, self.near, self.digits).entries() if self.proved else {}
        return chain | {"checks": self.checks}

    def to_dict(self) -> dict[str, Any]:
        """Statement as a JSON document, in which the contraction is an entry of `contact`, beside the other starts."""
        scene, contact = scene_said(self.table, self.law), contact_said(self.contact) | {"value": self.near}
        check_size(scene)
        words = STATEMENT.format(scene=title_of(scene))
        first = {"schema": self.schema, "name": self.name, "statement": words, "kind": self.kind, "scene": scene}
        return first | {"free": "lam", "digits": self.digits, "contact": contact}

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> Self:
        """The theorem that a document of this version states; `ValueError` if an entry is out of range."""
        digits, value = int(given["digits"]), str(given["contact"]["value"])
        if not 10 <= digits <= LARGEST_DIGITS or not DECIMAL.fullmatch(value):
            wanted = f"digits from 10 to {LARGEST_DIGITS}, a decimal as value"
            raise ValueError(f"certificate: digits = {digits}, value = {value[:30]}; accepted: {wanted}")
        table, law = scene_of(given["scene"], "", arb(0))
        near, off = Fraction(value), Fraction(1, 10**9)
        law.check((max(near - off, 0), min(near + off, 1)), *law.places(table))
        return cls(contact_of(given["contact"]), table, value, digits, law)


def contact_said(contact: Contact) -> dict[str, Any]:
    """A contact as entries of a certificate; the entry for the parameter is called `letter`.

    >>> orbit = SaddleCycle("triangle", (-0.16,), Closure(1, (1, 3)))
    >>> contact = Contact(orbit, orbit, 5, 1, 0.03, -0.02, 0.66)
    >>> contact_of(contact_said(contact)) == contact
    True
    """
    found = asdict(contact)
    found["letter"] = found.pop("parameter")
    return found | {"unstable": orbit_said(contact.unstable), "stable": orbit_said(contact.stable)}


def contact_of(given: Mapping[str, Any]) -> Contact:
    """The contact that the entries of a certificate describe; `ValueError` names an entry that is out of range."""
    unstable, stable = (orbit_of(given[name]) for name in ("unstable", "stable"))
    bounces, sign = int(given["bounces"]), int(given["sign"])
    if not 0 <= bounces <= LARGEST_FLIGHT or sign not in (1, -1):
        wanted = f"bounces from 0 to {LARGEST_FLIGHT}, sign 1 or -1"
        raise ValueError(f"certificate: bounces = {bounces}, sign = {sign}; accepted: {wanted}")
    z, end, parameter = (float(given[name]) for name in ("z", "end", "letter"))
    if not (0 < abs(z) < FARTHEST and 0 < abs(end) < FARTHEST and 0 < parameter < 1):
        wanted = f"z and end not 0, of size below {FARTHEST}, a letter (the parameter) between 0 and 1"
        raise ValueError(f"certificate: z = {z}, end = {end}, letter = {parameter}; accepted: {wanted}")
    return Contact(unstable, stable, bounces, sign, z, end, parameter)


def orbit_said(orbit: SaddleCycle) -> dict[str, Any]:
    """A cycle as entries of a certificate: name, starts for Newton's method, and the symmetry by which it repeats."""
    return {"name": orbit.name, "start": orbit.start, "sign": orbit.closure.turn, "shift": orbit.closure.shift}


def orbit_of(given: Mapping[str, Any]) -> SaddleCycle:
    """The cycle that the entries of a certificate describe; `ValueError` if an entry is out of range."""
    start, sign = tuple(float(x) for x in given["start"]), int(given["sign"])
    turns, parts = (int(x) for x in given["shift"])
    if not 1 <= len(start) <= LARGEST_PERIOD or sign not in (1, -1) or not 1 <= parts <= LARGEST_TURN:
        wanted = f"up to {LARGEST_PERIOD} bounces, sign 1 or -1, turn 1/1 to 1/{LARGEST_TURN}"
        raise ValueError(f"certificate: saddle: {len(start)} bounces, sign {sign}, turn 1/{parts}; accepted: {wanted}")
    return SaddleCycle(str(given["name"]), start, Closure(sign, (turns, parts)))
