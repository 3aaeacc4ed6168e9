"""A paper's claims as printed, the folder that holds them, and the verdicts on them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
