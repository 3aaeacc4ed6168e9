"""The judges of the sentences that are not on the egg: the map, circle and ellipse, the cardioids, what is sampled."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
