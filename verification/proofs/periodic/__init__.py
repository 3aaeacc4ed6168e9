"""Theorems on periodic orbits: interval Newton boxes, bifurcations, completeness, and stability over an interval."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
