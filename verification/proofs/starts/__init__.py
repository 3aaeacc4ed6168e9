"""Theorems on random starts of the cuspless table: the measure that converges to a cycle, and mean exponents."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
