"""Reports on any scene, made in the time given: a page by sections, JSON and LaTeX."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
