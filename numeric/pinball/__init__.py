"""How do users run the map? Starts and results are given in angles, points and arc lengths."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
