"""Proofs on periodic orbits: interval Newton, checklists of bifurcations, statements over a parameter interval."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
