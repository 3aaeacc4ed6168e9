"""Reports on any scene, made within a given time: a page in sections, JSON and LaTeX."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
