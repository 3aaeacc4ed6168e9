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
    thresholds,
)
from .tables.law import Law
from .tables.scene import Scene

__all__ = [
    "Cycle",
    "Law",
    "Scene",
    "SlapMap",
    "arc_length",
    "area",
    "curvature",
    "derivative_matrix",
    "double_normals",
    "generate",
    "monodromy",
    "multipliers",
    "perimeter",
    "slap_map",
    "tables",
    "thresholds",
]
