"""What is a periodic orbit? Three neighbours and one rule, how the ring closes, its multipliers, how it bifurcates."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
