from .paper import arc, cardioid, circle, cuspless, egg, ellipse, named, parametric, piecewise, polar
from .scene import Law, Scene
from .table import Component, Mark, Shape, Table

__all__ = [
    "Component",
    "Law",
    "Mark",
    "Scene",
    "Shape",
    "Table",
    "arc",
    "cardioid",
    "circle",
    "cuspless",
    "egg",
    "ellipse",
    "named",
    "parametric",
    "piecewise",
    "polar",
]
