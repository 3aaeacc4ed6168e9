from . import tables
from .tables.scene import Law, Scene

__all__ = ["Law", "Scene", "tables"]
