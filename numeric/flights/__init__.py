"""Where does a flight end? One module for each way to find the next bounce, and one registry of them.

Each is a plain function over a number system of `numeric.backends`, so that LLVM, NumPy and numbers of any precision
run the same text.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
