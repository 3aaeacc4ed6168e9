"""Unstable curves: do they grow although they are folded, and do all come to one saddle, so that attractors are one?"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
