"""A scene as a map in float64, and a starting point as exact numbers."""

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from verification.commands.scene import Scene, exact

if TYPE_CHECKING:
    from numeric import PinballMap


def pinball_map(scene: Scene, lam: Any = None) -> "PinballMap":
    """The map of a scene; SymPy is imported only for a formula or an irrational shape.

    >>> pinball_map(Scene("egg", {"alpha": "2/25"}, lam="1/2")).path
    'chord polynomial, one real zero'
    """
    from numeric import PinballMap

    lam = contraction(scene.lam) if lam is None else lam
    if scene.formula:
        return PinballMap(scene.table(), lam=lam)
    shape: dict[str, Any] = {name: exact(f"--{name}", text) for name, text in scene.shape.items()}
    if not all(isinstance(value, Fraction) for value in shape.values()):
        return PinballMap(scene.table(), lam=lam)
    return PinballMap(scene.table_name, lam=lam, K=scene.K, **shape)


def contraction(text: str) -> Any:
    """`lam` as an exact number."""
    value = exact("--lam", text)
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
