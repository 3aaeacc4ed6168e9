"""The fold of a polygon cycle, one bounce seen q times: any egg, any rotation number.

Where a turn by `2*pi*p/q` maps the table to itself, the collision rule of one bounce, with its
neighbours a turn away, is the whole system: `F(theta, lam) = 0`, and `dF/dtheta = 0` at the fold.
"""

from sympy import Expr, Rational, pi

from symbolic.chords import chord_kernel
from symbolic.codegen import kernel, load
from symbolic.tables import egg
from verification.arithmetic import Arithmetic
from verification.shooting.chain import Vector
from verification.shooting.small import Small


def polygon_fold(K: int, alpha: Expr, p: int = 1, q: int = 3) -> Small:
    """Unknowns `theta` and `lam` at the fold of the cycle that turns by `2*pi*p/q` at each bounce.

    >>> from verification.shooting.newton import refined
    >>> import mpmath
    >>> found = refined(polygon_fold(3, Rational(2, 25)), [-0.55, 0.378], 20)
    >>> mpmath.nstr(found.z[1], 15)
    '0.37812125259009'
    """
    if K * p % q:
        raise ValueError(f"polygon: a turn by {p}/{q} does not map the egg with K = {K} to itself")
    table = egg(K).at(alpha=alpha)

    def equations(arithmetic: Arithmetic, z: Vector) -> Vector:
        theta, lam = z
        turn = load(kernel("turn", [], {"turn": 2 * pi * Rational(p, q)}), arithmetic)()[0]
        angle = load(chord_kernel(table, 0, 0, 1), arithmetic)
        forth, back = angle(theta, theta + turn), angle(theta, theta - turn)
        return [forth[0] + lam * back[0], forth[1] + forth[2] + lam * (back[1] + back[2])]

    return Small(f"egg with K = {K}, the polygon {p}/{q}", equations)
