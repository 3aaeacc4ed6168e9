from . import tables
from .cycles.cycle import Cycle, monodromy
from .cycles.derivations import (
    SlapMap,
    arc_length,
    area,
    curvature,
    derivative_matrix,
    double_normals,
    generate,
    multipliers,
    perimeter,
    slap_map,
    theta0,
    theta1,
    thresholds,
)
from .tables.law import Law
from .tables.scene import Scene
from .tables.table import a, alpha, eta, lam, phi, theta

__all__ = [
    "Cycle",
    "Law",
    "Scene",
    "SlapMap",
    "a",
    "alpha",
    "arc_length",
    "area",
    "curvature",
    "derivative_matrix",
    "double_normals",
    "eta",
    "generate",
    "lam",
    "monodromy",
    "multipliers",
    "perimeter",
    "phi",
    "slap_map",
    "tables",
    "theta",
    "theta0",
    "theta1",
    "thresholds",
]
