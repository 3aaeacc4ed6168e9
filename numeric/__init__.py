"""The map in float64: kernels generated from the exact tables, at the speed of the machine.

Rooms, from the top down: `pinball` (the map that users call), `kernels` (a bounce as machine code), `flights` (the
ways to find the next bounce), `lowering` (an exact table to programs), `backends` (number systems that run a
program). Nothing is imported before it is asked for: `import numeric` alone loads neither NumPy nor SymPy nor LLVM.

>>> from numeric import PinballMap
>>> step = PinballMap("circle", lam=0.5).step(theta=0.0, phi=0.5)
>>> round(float(step.theta), 12), round(float(step.phi), 12)
(2.14159265359, 0.25)
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
