"""Theorems on slap maps: periodic points, critical points, and the Lyapunov exponent of the natural measure."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
