"""The map in float64: kernels generated from the exact tables, at the speed of the machine.

Rooms, from the top down: `pinball` (the map that users call), `kernels` (a bounce as machine code), `flights` (the ways
to find the next bounce), `lowering` (an exact table to programs), `backends` (number systems that run a program).
Nothing is imported before it is asked for: `import numeric` alone loads neither NumPy nor SymPy nor LLVM.

>>> from numeric import PinballMap
>>> step = PinballMap("circle", lam=0.5).step(theta=0.0, phi=0.5)
>>> round(float(step.theta), 12), round(float(step.phi), 12)
(2.14159265359, 0.25)
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numeric.flights.family import Status
    from numeric.pinball.map import PinballMap
    from numeric.pinball.sampling import Starts, interior_starts, phase_grid, phase_starts
    from numeric.pinball.states import Exponents, Orbit, Slap

__all__ = [
    "Exponents",
    "Orbit",
    "PinballMap",
    "Slap",
    "Starts",
    "Status",
    "interior_starts",
    "phase_grid",
    "phase_starts",
]

if not TYPE_CHECKING:
    HOMES = {
        "flights.family": ("Status",),
        "pinball.map": ("PinballMap",),
        "pinball.states": ("Exponents", "Orbit", "Slap"),
        "pinball.sampling": ("Starts", "interior_starts", "phase_grid", "phase_starts"),
    }

    def __getattr__(name):
        """A public name, imported when it is first asked for."""
        from importlib import import_module

        for home, names in HOMES.items():
            if name in names:
                value = globals()[name] = getattr(import_module(f"numeric.{home}"), name)
                return value
        raise AttributeError(f"numeric has no {name}; it has {', '.join(__all__)}")

    def __dir__():
        return sorted({*globals(), *__all__})
