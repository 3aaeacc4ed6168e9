"""What does a table do, asked in angles, points and arc lengths? The map that users call, and what it answers with."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
