"""The symmetries of a table, found and proved: rotations and reflections about the origin that keep its boundary.

They form a cyclic or a dihedral group. One that turns the boundary parameter into `+theta + shift` keeps
exit angles, one that turns it into `-theta + shift` negates them, and both take orbits of the pinball map to
orbits: an attractor has images, and a stabiliser.
"""

from dataclasses import dataclass
from functools import cache, reduce
from math import gcd

from sympy import Expr, Matrix, S, conjugate, cos, expand, pi, simplify, sin

from symbolic.proofs.zero import vanishes
from symbolic.tables.fourier import boundary_coefficients
from symbolic.tables.symbols import theta
from symbolic.tables.table import Component, Table

CIRCLE = 4  # of its infinitely many symmetries, those of the square are listed


@dataclass(frozen=True)
class Symmetry:
    """`theta` on component `i` goes to `sign*theta + shift[i]` on component `onto[i]`; `sign*phi` is the exit angle.

    In the plane it is the rotation by `angle`, after the reflection `y -> -y` when `sign` is -1.
    """

    name: str
    sign: int
    angle: Expr
    onto: tuple[int, ...]
    shift: tuple[Expr, ...]

    @property
    def matrix(self) -> Matrix:
        """The orthogonal matrix.

        >>> Symmetry("half turn", 1, pi, (0,), (pi,)).matrix
        Matrix([
        [-1,  0],
        [ 0, -1]])
        """
        c, s = cos(self.angle), sin(self.angle)
        return Matrix([[c, -s * self.sign], [s, c * self.sign]])


@cache
def group(table: Table) -> tuple[Symmetry, ...]:
    """The symmetries that are proved, the identity first.

    Complete for the paper's tables but the circle, of which only the symmetries of the square are listed: a
    symmetry keeps the curvature, so it permutes the vertices of an ellipse (`a > 1`) or an egg
    (`alpha > 0`), the cusp, or the wall.

    >>> from symbolic.tables import cardioid, cuspless, egg, ellipse
    >>> [len(group(table)) for table in (ellipse.at(a=2), cardioid, cuspless, egg(3).at(alpha="0.08"))]
    [4, 2, 2, 6]
    >>> [symmetry.name for symmetry in group(cuspless)]
    ['identity', 'reflection in the line at 0']
    """
    turns, axes = _of_one(table) if len(table.components) == 1 else _of_many(table)
    return (*turns, *axes)


def order_of_rotation(component: Component) -> int:
    """How many turns of the parameter are symmetries: the common divisor of all differences of frequencies.

    `z(theta + d) = exp(i*w)*z(theta)` asks `k*d = w`, up to whole turns, of every frequency `k` of `z = x + i*y`.

    >>> from symbolic.tables import egg
    >>> order_of_rotation(egg(5).components[0])
    5
    """
    waves = boundary_coefficients(component)
    if waves is None:
        return 1
    first = next(iter(waves))
    return reduce(gcd, (k - first for k in waves), 0) or CIRCLE


def _of_one(table: Table) -> tuple[list[Symmetry], list[Symmetry]]:
    """Shifts by `2*pi*k/n`, and reflections in `n` axes if there is one at 0 or `pi/(2*n)`."""
    component = table.components[0]
    n = order_of_rotation(component)
    shifts = [2 * pi * k / n for k in range(n)]
    turns = [_one(component, 1, shift) for shift in shifts]
    first = [shift for shift in (S.Zero, pi / n) if _one(component, -1, shift)][:1]
    axes = [_one(component, -1, begin + shift) for begin in first for shift in shifts]
    return [found for found in turns if found], [found for found in axes if found]


def _one(component: Component, sign: int, shift: Expr) -> Symmetry | None:
    """The symmetry `theta -> sign*theta + shift` of a boundary of one closed component, if it is one."""
    waves = boundary_coefficients(component)
    if waves is None:
        found = Symmetry(_name(sign, shift), sign, shift, (0,), (shift,))
        return found if _keeps(component, component, found.matrix, sign, shift) else None
    first = next(k for k in waves if k)
    for angle in (first * shift % (2 * pi), (first * shift + pi) % (2 * pi)):
        if all(_turned(c, (angle - k * shift) / pi, sign) for k, c in waves.items()):
            return Symmetry(_name(sign, angle), sign, angle, (0,), (shift,))
    return None


def _turned(c: Expr, half_turns: Expr, sign: int) -> bool:
    """Is a coefficient (its conjugate in a reflection), turned by so many half turns, the coefficient itself?"""
    turned = c if sign > 0 else conjugate(c)
    return bool(half_turns.is_Integer and vanishes(S.NegativeOne**half_turns * turned - c))


def _of_many(table: Table) -> tuple[list[Symmetry], list[Symmetry]]:
    """The identity, and reflections in the two axes that permute the components, ends to ends."""
    parts = table.components
    same = Symmetry("identity", 1, S.Zero, tuple(range(len(parts))), (S.Zero,) * len(parts))
    axes = []
    for angle in (S.Zero, pi):
        found = Symmetry(_name(-1, angle), -1, angle, (), ())
        onto, shifts = [], []
        for part in parts:
            for index, image in enumerate(parts):
                shift = simplify(part.start + image.end)
                if _keeps(part, image, found.matrix, -1, shift):
                    onto.append(index)
                    shifts.append(shift)
                    break
        if len(onto) == len(parts):
            axes.append(Symmetry(found.name, -1, angle, tuple(onto), tuple(shifts)))
    return [same], axes


def _keeps(part: Component, image: Component, matrix: Matrix, sign: int, shift: Expr) -> bool:
    """Is the image of a point the point of the image?"""
    moved = matrix * Matrix(part.point)
    target = [coordinate.subs(theta, sign * theta + shift) for coordinate in image.point]
    return all(vanishes(expand(left - right, trig=True)) for left, right in zip(moved, target, strict=True))


def _name(sign: int, angle: Expr) -> str:
    if sign > 0:
        return "identity" if angle == 0 else f"rotation by {angle}"
    return f"reflection in the line at {angle / 2}"
