"""A tangency in the entries of a certificate, and the other way round; other kinds of certificates need no NumPy."""

import re
from collections.abc import Mapping
from typing import Any

from flint import arb

from verification.named.scene_entries import THIRD, scene_of, scene_said, title_of
from verification.proofs.manifolds.claim import TangencyClaim, contact_of, contact_said

LARGEST_DIGITS = 600
DECIMAL = re.compile(r"0\.\d{1,1000}")


def title(claim: TangencyClaim) -> str:
    """Its scene in words."""
    return title_of(scene_said(claim.table, claim.law))


def entries(claim: TangencyClaim) -> dict[str, Any]:
    """What a tangency is about; its value stands among the starts that a reader with series takes."""
    contact = contact_said(claim.contact) | {"value": claim.value}
    scene = scene_said(claim.table, claim.law)
    return {"kind": "tangency", "scene": scene, "free": "lam", "digits": claim.digits, "contact": contact}


def claim_of(given: Mapping[str, Any]) -> TangencyClaim:
    """The claim of a document, of any version; `ValueError` with the entry that is wrong."""
    try:
        if given["schema"] >= THIRD:
            scene, value = given["scene"], given["contact"]["value"]
        else:
            scene, value = {"table": given["table"], "shape": given["shape"], "K": given["points"]}, given["value"]
            scene |= {"law": given["law"]} if "law" in given else {}
        digits, value = int(given["digits"]), str(value)
        if not 10 <= digits <= LARGEST_DIGITS or not DECIMAL.fullmatch(value):
            raise ValueError(f"certificate: digits = {digits} or value = {value[:30]} is out of range")
        table, law = scene_of(scene, "", arb(0))
        return TangencyClaim(contact_of(given["contact"]), table, value, digits, law)
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def name_of(claim: TangencyClaim, schema: int) -> str:
    """What it is called: earlier versions said whether both manifolds are of one saddle, and knew the egg alone."""
    if schema >= THIRD:
        return f"tangency of two manifolds: {title(claim)}"
    kind = "homoclinic" if claim.contact.unstable == claim.contact.stable else "heteroclinic"
    return f"{kind} tangency in the {title(claim)}"
