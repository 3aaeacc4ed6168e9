"""What is the mathematics? Tables and scenes, exact, and what is derived from them by SymPy.

from symbolic import Law, Scene, tables
"""

import os

import lazy_loader

# Results that SymPy keeps of each of its functions: with its own 1,000 the derivations here take a quarter longer.
os.environ.setdefault("SYMPY_CACHE_SIZE", "20000")

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
