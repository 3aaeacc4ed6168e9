"""Hypothesis strategies for tables, shapes, laws, contractions and phase points, for your own tables too::

    from hypothesis import given
    from verification import strategies

    @given(strategies.particles(tables=my_table))
    def test_my_law(particle):
        assert abs(particle.map.step(particle.theta, particle.phi, particle.component).phi) <= particle.lam * 1.5708

Every strategy gives exact shapes and doubles in the interior of phase space, and shrinks towards the
circle, the middle of a component and the normal exit.
"""

from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from hypothesis import strategies as st

from numeric import PinballMap
from symbolic.tables.definition import GALLERY, POINTS, UNIFORM, named_boundary, table_boundary
from symbolic.tables.scene import Scene, given_table

STEEPEST = 1.57  # radians; |phi| stays below


@dataclass(frozen=True)
class Particle:
    """A phase point of a map: `theta` is the parameter on the component of index `component`.

    `particle.map.scene.shape` has the numbers that were drawn for the parameters of the table, by name.
    """

    map: PinballMap
    lam: float
    component: int
    theta: float
    phi: float

    def __repr__(self) -> str:
        shape = ", ".join(
            f"{entry.name}={value}" for entry, value in zip(self.map.ir.shape, self.map.exact_shape, strict=True)
        )
        table = f"{self.map.ir.table}({shape})"
        law = "" if self.map.reflection.uniform else f", law='{self.map.reflection}'"
        at = f"component={self.component}, theta={self.theta!r}, phi={self.phi!r}"
        return f"Particle({table}{law}, lam={self.lam!r}, {at})"

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """Prints the particle in a Hypothesis example, with table, shape and law by name."""
        printer.text(repr(self))


def contractions(least: float = 0.0, most: float = 1.0) -> st.SearchStrategy[float]:
    """Contractions between `least` and `most`, both included."""
    return st.sampled_from([x for x in (1.0, 0.0, 0.5) if least <= x <= most] or [least]) | st.floats(least, most)


@st.composite
def shapes(draw: st.DrawFn, name: str, K: int = 3) -> dict[str, Fraction]:
    """Exact shape parameters of one of the paper's tables."""
    if name == "ellipse":
        return {"a": 1 + draw(st.fractions(0, 9, max_denominator=100))}
    if name == "egg":
        return {"alpha": draw(st.fractions(0, Fraction(1, K * K + 1), max_denominator=1000))}
    return {}


# formulas that are laws at every contraction, and the ends of the range of `a`; making a map proves that they are
BENT = {
    "-lam*eta + {a}*sin(2*eta)": (Fraction(-2, 5), Fraction(2, 5)),
    "-lam*eta - {a}*eta*(pi**2/4 - eta**2)": (Fraction(-1, 7), Fraction(1, 7)),
    "-lam*eta*(1 - {a}*cos(eta)**2)": (Fraction(0), Fraction(1)),
    "-lam*sin(eta)": (Fraction(0), Fraction(0)),
    "-lam*eta + {a}*cos(eta)**4": (Fraction(-1, 7), Fraction(1, 7)),  # not odd: no mirror is a symmetry of the map
}
PLACED = {
    "-lam*eta + {a}*cos(theta)*sin(2*eta)": (Fraction(-2, 5), Fraction(2, 5)),
    "-lam*eta*(3/4 - {a}*sin(theta))": (Fraction(-1, 7), Fraction(1, 7)),
}


@st.composite
def reflections(draw: st.DrawFn, placed: bool = True) -> str:
    """Formulas of reflection laws: the paper's law, and laws that add polynomials and sines to it.

    With `placed`, also laws that depend on where on the boundary the particle lands.
    """
    formula: str = draw(st.sampled_from([UNIFORM, *BENT, *(PLACED if placed else ())]))
    if formula == UNIFORM:
        return formula
    a = draw(st.fractions(*{**BENT, **PLACED}[formula], max_denominator=20))
    return formula.format(a=f"({a})")


@st.composite
def scenes(draw: st.DrawFn, scene: Scene) -> Scene:
    """The scene, with each parameter that has a range drawn from this range."""
    numbers: dict[str, Any] = {
        name: low + (high - low) * draw(st.fractions(0, 1, max_denominator=100))
        for name, (low, high) in scene.ranges.items()
    }
    return scene.at(**numbers) if numbers else scene


def listed(tables: Any) -> list[Any]:
    """The given table or tables as a list, empty for None; `ValueError` at once for a name that no table has."""
    given = list(tables) if isinstance(tables, list | tuple) else [tables] if tables is not None else []
    for each in given:
        if isinstance(each, str) and each not in GALLERY:
            named_boundary(each, POINTS)
    return given


@st.composite
def maps(
    draw: st.DrawFn,
    tables: Any = None,
    lams: st.SearchStrategy[float] | None = None,
    laws: st.SearchStrategy[str] | None = None,
) -> PinballMap:
    """Maps of the paper's tables with any shape, or of the given table or tables: names, exact tables, scenes, maps.

    Free shape parameters are drawn from their ranges. With `laws` the reflection law is drawn too, unless a scene has
    one of its own; without `laws` it is the paper's.
    """
    chosen = [each if isinstance(each, str | Scene) else _with_ranges(each) for each in listed(tables)]
    table = draw(st.sampled_from(chosen or ["circle", "ellipse", "egg", "cardioid", "cuspless"]))
    lam = draw(contractions() if lams is None else lams)
    law = UNIFORM if laws is None else draw(laws)
    if isinstance(table, Scene):
        scene = draw(scenes(table))
        return _of_scene(scene if scene.law.uniform is False else scene.at(law=law), lam)
    if not isinstance(table, str):
        return _cached(table, lam) if law == UNIFORM else PinballMap(table, lam=lam, law=law, kernels=False)
    shape: dict[str, Any] = draw(shapes(table))
    return PinballMap(table, lam=lam, law=law, kernels=law == UNIFORM, **shape)


@st.composite
def particles(
    draw: st.DrawFn,
    tables: Any = None,
    lams: st.SearchStrategy[float] | None = None,
    steepest: float = STEEPEST,
    laws: st.SearchStrategy[str] | None = None,
) -> Particle:
    """Phase points in the interior of phase space, away from the ends of components, of maps drawn by `maps`."""
    map = draw(maps(tables, lams, laws))
    component = draw(st.integers(0, len(map.states.ends) - 1))
    low, high = map.states.ends[component]
    share = draw(st.floats(0.001, 0.999))
    theta = low + (high - low) * share
    return Particle(map, float(map.lam), component, theta, draw(st.floats(-steepest, steepest)))


@lru_cache(maxsize=64)
def _with_ranges(given: Any) -> Any:
    """A scene for a map, or for a table with free shape parameters; else the table, or its name."""
    if isinstance(scene := getattr(given, "scene", None), Scene):  # of a map
        return scene
    table, _ = given_table(given, POINTS, {})
    shapes = getattr(table, "shapes", ())
    if not shapes:
        return table
    if table_boundary(table) == ({"table": table.name}, {}):
        return table.name
    ends = {shape.symbol.name: (shape.range.start, shape.range.end) for shape in shapes}
    numbers: dict[str, Any] = {name: f"{(low + high) / 2}:{low}..{high}" for name, (low, high) in ends.items()}
    return Scene(table, **numbers)


def _of_scene(scene: Scene, lam: float) -> PinballMap:
    """Map of a scene at `lam`, or at the scene's own contraction where its law is not valid at `lam`."""
    with suppress(ValueError):
        scene = scene.at(lam=Fraction(lam))
    return PinballMap(scene, kernels=False)


@lru_cache(maxsize=64)
def _prepared(table: Any) -> PinballMap:
    return PinballMap(table, lam=1)


def _cached(table: Any, lam: float) -> PinballMap:
    """The map of an exact table at `lam`; its programs are prepared once."""
    return _prepared(table).at(lam)
