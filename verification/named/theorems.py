"""Theorems with a certificate file, by the `kind` that their files state: one line for each.

A file can claim anything and prove nothing: each entry of it must be, as JSON text, the one that its theorem would
write, and the whole checklist is worked through again. `docs/certificate_format.md` says what each entry means.
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
    """The class of theorems of this kind; its module is imported only now."""
    if kind not in [*THEOREMS]:
        raise ValueError(f"certificate: kind = {ascii(kind)[:60]} is unknown; accepted: {', '.join(THEOREMS)}")
    module, _, name = (PROOFS + THEOREMS[kind]).rpartition(".")
    found: type[Certified] = getattr(import_module(module), name)
    return found


def theorem(document: Mapping[str, Any]) -> Certified:
    """The theorem that a document states, not proved yet; `ValueError` where an entry is not what it would write."""
    stated = theorem_class(document.get("kind", "")).from_dict(document)
    stated.check_entries(document)
    return stated


def checked(document: Mapping[str, Any]) -> Certified:
    """The theorem of a document, worked through anew; `ValueError` where the file says more of it than is proved."""
    stated = theorem(document)
    stated.check_entries(document, stated.evidence)
    return stated


def check(path: Path | str) -> Certified:
    """The theorem that a certificate file states, worked through anew; `proved` says whether every item holds."""
    return checked(read_document(Path(path)))
