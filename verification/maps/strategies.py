"""Hypothesis strategies for tables, shapes, contractions and phase points, for your own tables too::

    from hypothesis import given
    from verification.maps import strategies

    @given(strategies.particles(tables=my_table))
    def test_my_law(particle):
        assert abs(particle.map.step(particle.theta, particle.phi, particle.component).phi) <= particle.lam * 1.5708

Every strategy gives exact shapes and doubles in the interior of phase space, and shrinks towards the
circle, the middle of a component and the normal exit.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from hypothesis import strategies as st

from numeric import PinballMap

STEEPEST = 1.57  # radians; |phi| stays below
SMOOTH = ("circle", "ellipse", "egg")


@dataclass(frozen=True)
class Particle:
    """A phase point of a map. `theta` belongs to the component of that index."""

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
        return (
            f"Particle({table}, lam={self.lam!r}, component={self.component}, theta={self.theta!r}, phi={self.phi!r})"
        )


def contractions(least: float = 0.0, most: float = 1.0) -> st.SearchStrategy[float]:
    """Contractions, the ends included."""
    return st.sampled_from([x for x in (1.0, 0.0, 0.5) if least <= x <= most] or [least]) | st.floats(least, most)


@st.composite
def shapes(draw: st.DrawFn, name: str, K: int = 3) -> dict[str, Fraction]:
    """Exact shape parameters of one of the paper's tables."""
    if name == "ellipse":
        return {"a": 1 + draw(st.fractions(0, 9, max_denominator=100))}
    if name == "egg":
        return {"alpha": draw(st.fractions(0, Fraction(1, K * K + 1), max_denominator=1000))}
    return {}


@st.composite
def maps(draw: st.DrawFn, tables: Any = None, lams: st.SearchStrategy[float] | None = None) -> PinballMap:
    """Maps of the paper's tables with any shape, or of the table or tables given (names or exact tables)."""
    chosen = list(tables) if isinstance(tables, list | tuple) else [tables] if tables is not None else None
    table = draw(st.sampled_from(chosen or ["circle", "ellipse", "egg", "cardioid", "cuspless"]))
    lam = draw(contractions() if lams is None else lams)
    if not isinstance(table, str):
        return _cached(table, lam)
    shape: dict[str, Any] = draw(shapes(table))
    return PinballMap(table, lam=lam, **shape)


@st.composite
def particles(
    draw: st.DrawFn,
    tables: Any = None,
    lams: st.SearchStrategy[float] | None = None,
    steepest: float = STEEPEST,
) -> Particle:
    """Phase points in the interior of phase space, at any place but the ends of components."""
    map = draw(maps(tables, lams))
    component = draw(st.integers(0, len(map.states.ends) - 1))
    low, high = map.states.ends[component]
    share = draw(st.floats(0.001, 0.999))
    theta = low + (high - low) * share
    return Particle(map, float(map.lam), component, theta, draw(st.floats(-steepest, steepest)))


@lru_cache(maxsize=64)
def _prepared(table: Any) -> PinballMap:
    return PinballMap(table, lam=1)


def _cached(table: Any, lam: float) -> PinballMap:
    """An exact table's programs are drawn up once, whatever `lam`."""
    return _prepared(table).at(lam)
