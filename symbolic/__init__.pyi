from . import tables
from .tables.law import Law
from .tables.scene import Scene

__all__ = ["Law", "Scene", "tables"]
