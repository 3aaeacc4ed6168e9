"""What must a kernel know of an exact table? Straight-line programs and a few facts, as plain data kept on disk.

`lower` is the only module of `numeric` that imports SymPy, and it is imported only when the data are not on disk.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
