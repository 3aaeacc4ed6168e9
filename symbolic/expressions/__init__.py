"""What expressions are: signs proved, and text generated that every number system reads."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
