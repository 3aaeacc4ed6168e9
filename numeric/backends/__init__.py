"""On what numbers does a program run? LLVM vectors, NumPy arrays, single numbers of any precision: one protocol."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
