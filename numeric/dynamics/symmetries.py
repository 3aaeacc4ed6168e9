"""Images of phase points under the symmetries of a table, and the symmetries that take orbits to orbits."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from numeric import PinballMap
from numeric.dynamics.phase_points import PhasePoints

if TYPE_CHECKING:
    from numeric.lowering.program import TableSymmetry
    from symbolic.tables.law import Law


def moved(symmetry: "TableSymmetry", particles: PhasePoints) -> PhasePoints:
    """The images of particles under a symmetry; a reflection negates exit angles. Paper: section 6.4, opposite angles.

    >>> from symbolic.tables.geometry import group
    >>> from symbolic.tables import cuspless
    >>> from numeric.dynamics.phase_points import phase_points
    >>> image = moved(group(cuspless)[1], phase_points([1.0, 0.25], 0.5, [0, 1]))
    >>> image.component.tolist(), image.theta.tolist(), image.phi.tolist()
    ([0, 1], [-1.0, -0.25], [-0.5, -0.5])
    """
    shift = np.array([float(x) for x in symmetry.shift])[particles.component]
    theta = symmetry.sign * particles.theta + shift
    if len(symmetry.onto) == 1:
        theta = np.remainder(theta + np.pi, 2 * np.pi) - np.pi
    return PhasePoints(np.array(symmetry.onto)[particles.component], theta, symmetry.sign * particles.phi)


def kept_by(law: "Law", symmetry: "TableSymmetry") -> bool:
    """Does a symmetry take orbits to orbits? It does if the law is the same everywhere and, for reflections, odd."""
    return law.uniform or is_identity(symmetry) or (not law.placed and (symmetry.sign == 1 or law.odd))


def is_identity(symmetry: "TableSymmetry") -> bool:
    """Does the symmetry leave every point of the plane where it is?"""
    return symmetry.sign == 1 and bool(symmetry.angle == 0)


def symmetries_of(map: PinballMap) -> "tuple[TableSymmetry, ...]":
    """The symmetries of the table under which images of orbits are orbits, the identity first.

    >>> [g.sign for g in symmetries_of(PinballMap("cuspless", lam="0.09"))]
    [1, -1]
    """
    return tuple(g for g in map.symmetries if kept_by(map.reflection, g))


def name(own: "Sequence[TableSymmetry]") -> str:
    """The name of a group in Schoenflies' notation: `Cn` for n rotations, `Dn` when there are reflections too.

    >>> from symbolic.tables.geometry import group
    >>> from symbolic.tables import egg
    >>> name(group(egg(3).at(alpha="0.08")))
    'D3'
    """
    rotations = sum(symmetry.sign > 0 for symmetry in own)
    return f"{'D' if rotations < len(own) else 'C'}{rotations}"
