"""A scene as a map in float64, and a starting point as exact numbers."""

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from symbolic.definition import exact
from symbolic.scene import Scene

if TYPE_CHECKING:
    from numeric import PinballMap


def pinball_map(scene: Scene, lam: Any = None) -> "PinballMap":
    """The map of a scene; SymPy is imported only for a formula or an irrational shape.

    >>> pinball_map(Scene("egg", alpha="2/25", lam="1/2")).path
    'chord polynomial, one real zero'
    """
    from numeric import PinballMap

    lam = numeral(scene.lam) if lam is None else lam
    shape: dict[str, Any] = dict(scene.shape)
    if "table" in scene.document and all(isinstance(value, Fraction) for value in shape.values()):
        return PinballMap(scene.name, lam=lam, K=scene.K, **shape)
    return PinballMap(scene.table, lam=lam)


def numeral(value: Any) -> Any:
    """A contraction for a kernel: a fraction as it is, an expression as the nearest float."""
    return value if isinstance(value, Fraction) else float(value)


def start_of(text: str) -> tuple[Any, Any]:
    """`THETA,PHI` as two exact numbers.

    >>> start_of("1/3,0.25")
    (Fraction(1, 3), Fraction(1, 4))
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise ValueError(f"--start {text!r} is no pair; give THETA,PHI such as 0.5,-pi/6")
    theta, phi = (exact("--start", part.strip()) for part in parts)
    return theta, phi
