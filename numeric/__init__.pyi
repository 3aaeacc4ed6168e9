from .dynamics.recognition import Attractor
from .flights.family import Status
from .pinball.map import PinballMap
from .pinball.sampling import Starts, interior_starts, phase_grid, phase_starts
from .pinball.states import Exponents, Orbit, Slap
from .sweeps.questions import (
    Attractors,
    GridResult,
    LyapunovExponents,
    attractors,
    basins,
    bifurcation_diagram,
    exponents,
    parameter_space,
)

__all__ = [
    "Attractor",
    "Attractors",
    "Exponents",
    "GridResult",
    "LyapunovExponents",
    "Orbit",
    "PinballMap",
    "Slap",
    "Starts",
    "Status",
    "attractors",
    "basins",
    "bifurcation_diagram",
    "exponents",
    "interior_starts",
    "parameter_space",
    "phase_grid",
    "phase_starts",
]
