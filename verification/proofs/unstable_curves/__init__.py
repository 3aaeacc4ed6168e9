"""Unstable curves: do they grow although they are folded, and do they all come to one saddle, so to one attractor?"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
