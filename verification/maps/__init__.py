"""The map to any precision, in mpmath and in balls, with a proof that each landing is the first hit."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
