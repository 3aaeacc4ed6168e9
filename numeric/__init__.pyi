from .flights.family import Status
from .pinball.map import PinballMap
from .pinball.sampling import Starts, interior_starts, phase_grid, phase_starts
from .pinball.states import Exponents, Orbit, Slap

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
