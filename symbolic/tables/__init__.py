"""Tables: components, the paper's own, typed formulas, validity, symmetry, laws and scenes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
