"""What becomes of any scene: a report by sections, in the time given, as a page, as JSON and as LaTeX."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
