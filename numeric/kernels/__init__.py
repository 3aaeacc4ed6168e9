"""How does a bounce become machine code, and how are many particles run through it?"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
