"""The map to any precision, in mpmath and in balls, with the first hit proved."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
