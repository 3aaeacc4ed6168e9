"""Judges of claims on the map, the circle, the ellipse and the cardioids, and of sampled claims."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
