"""Expressions: proofs of their signs and identities, and code generated from them for every number system."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
