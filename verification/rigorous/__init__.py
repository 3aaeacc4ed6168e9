"""Theorems on piecewise-smooth maps of a surface: their hypotheses, boxes, transition graphs and certificates."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
