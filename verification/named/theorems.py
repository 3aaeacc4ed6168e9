"""Theorems that have a certificate file, found by the `kind` in the file.

A file can claim anything and proves nothing: each of its entries must be, as JSON text, the one that its theorem would
write, and the whole checklist is worked through again. `docs/certificate_format.md` explains each entry.
"""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from verification.rigorous.certificate import Certified, read_document

PROOFS = "verification.proofs."
THEOREMS = {
    "cycle": "periodic.cycle_in_box.UniqueCycle",
    "fold": "periodic.cycle_in_box.Bifurcation",
    "flip": "periodic.cycle_in_box.Bifurcation",
    "corner": "corner.corner_orbit.CornerOrbit",
    "focus": "corner.corner_orbit.EqualMultipliers",
    "tangency": "manifolds.certificate.Tangency",
    "trapping region": "global_dynamics.regions.Region",
    "boundary crisis": "global_dynamics.crisis.BoundaryCrisis",
    "no two attractors": "unstable_curves.certificate.AtMostOneAttractor",
}


def theorem_class(kind: str) -> type[Certified]:
    """The class of theorems of this kind; its module is imported by this call."""
    if kind not in [*THEOREMS]:
        raise ValueError(f"certificate: kind = {ascii(kind)[:60]} is unknown; accepted: {', '.join(THEOREMS)}")
    module, _, name = (PROOFS + THEOREMS[kind]).rpartition(".")
    found: type[Certified] = getattr(import_module(module), name)
    return found


def theorem(document: Mapping[str, Any]) -> Certified:
    """The theorem that a document states, not yet proved; `ValueError` if the theorem would write another entry."""
    stated = theorem_class(document.get("kind", "")).from_dict(document)
    stated.check_entries(document)
    return stated


def checked(document: Mapping[str, Any]) -> Certified:
    """The theorem of a document, proved anew; `ValueError` if the file claims more than is proved."""
    stated = theorem(document)
    stated.check_entries(document, stated.evidence)
    return stated


def check(path: Path | str) -> Certified:
    """The theorem that a certificate file states, proved anew; `proved` says whether every item holds."""
    try:
        return checked(read_document(Path(path)))
    except ValueError as why:
        raise ValueError(str(why) if str(path) in str(why) else f"{path}: {why}") from None
