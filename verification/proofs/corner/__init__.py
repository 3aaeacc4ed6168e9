"""The corner orbit of the cuspless table, and the chaotic attractor that is born there."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
