from . import tables
from .scene import Law, Scene

__all__ = ["Law", "Scene", "tables"]
