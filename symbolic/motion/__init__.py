"""Motion on a table: flight, reflection, derivative, chord rule, and what a bounce contracts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
