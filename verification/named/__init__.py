"""Bifurcations, crises and attractors that are found by name or search, with proofs and certificate files."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
