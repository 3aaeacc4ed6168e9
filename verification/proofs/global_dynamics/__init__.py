"""Global dynamics of pinball maps: attractor blocks and Morse graphs, proved by covering phase space with boxes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
