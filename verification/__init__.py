"""Is it true, how well, at what cost? Questions on a scene, proofs in balls, the judged paper.

    from verification import certify, check, find_cycles, follow, locate, report, verify
    from verification import EnclosedMap, ExactMap, laws, strategies

Nothing is loaded before it is asked for: neither mpmath nor python-flint, neither SymPy nor NumPy.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
