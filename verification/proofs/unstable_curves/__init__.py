"""Growth of unstable curves in a trapping region, and the theorem that the region holds at most one attractor."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
