"""What is the mathematics? Tables and scenes, exact, and what is derived from them by SymPy.

from symbolic import Law, Scene, tables
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
