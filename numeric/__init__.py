"""The map in float64: kernels generated from the exact tables, at the speed of the machine.

>>> from numeric import PinballMap
>>> step = PinballMap("circle", lam=0.5).step(theta=0.0, phi=0.5)
>>> round(float(step.theta), 12), round(float(step.phi), 12)
(2.14159265359, 0.25)
"""

from numeric.pinball import PinballMap
from numeric.results import Exponents, Orbit
from numeric.status import Status

__all__ = ["Exponents", "Orbit", "PinballMap", "Status"]
