"""Extreme and stiff cases: their errors are measured against 50 or more digits, and the results are recorded."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
