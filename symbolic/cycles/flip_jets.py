"""The flip of the horizontal orbit of the cuspless cardioid when its wall is bent: the normal form in jets of the wall.

Paper: section 5.1, "presumably it could be rendered stable if the billiard table were modified". Near `y = 0` let the
wall be `x = -1/4 + a*y^2 + b*y^4` and the arc `x = 2 - A*y^2 - B*y^4`. By the mirror symmetry the return map is odd,
`x -> M x + C(x)` with `C` cubic, so on the eigendirection of -1, with right and left eigenvectors `q` and `p`,

    xi -> -xi + c*xi^3,    c = p C(q)/(p q),

and the period-4 orbit that is born at the flip is stable for `c > 0`, unstable for `c < 0` [Kuznetsov2004].
An odd quantity is a pair: its coefficients of degree 1 and 3 in the size of the orbit.
"""

from functools import cache

from sympy import QQ, Expr, Matrix, Poly, Rational, cos, expand, radsimp, series, sin, solve, symbols

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables.symbols import lam, theta

a, b = symbols("a b", real=True)  # jets of the wall
height, exit_angle = symbols("height exit_angle", real=True)  # where the ball leaves the wall
RING = QQ[a, b, lam, height, exit_angle]
LENGTH = Rational(9, 4)
Odd = tuple[Expr, Expr]


def arc_jets() -> tuple[Expr, Expr]:
    """`A` and `B` of the arc at `theta = 0`.

    >>> arc_jets()
    (3/8, 7/128)
    """
    A, B = symbols("A B")
    x, y = ((1 + cos(theta)) * f(theta) for f in (cos, sin))
    jet = series(x - 2 + A * y**2 + B * y**4, theta, 0, 6).removeO().expand()
    (found,) = solve([jet.coeff(theta, 2), jet.coeff(theta, 4)], [A, B], dict=True)
    return found[A], found[B]


def total(*parts: Odd) -> Odd:
    """A sum, degree by degree."""
    return sum((part[0] for part in parts), RING(0)), sum((part[1] for part in parts), RING(0))


def times(factor: Expr, part: Odd) -> Odd:
    """A multiple."""
    return factor * part[0], factor * part[1]


def arctangent(part: Odd, sign: int = 1) -> Odd:
    """`atan` of an odd quantity, or `tan` with `sign = -1`."""
    return part[0], part[1] - sign * RING.from_sympy(Rational(1, 3)) * part[0] ** 3


def slope(jets: tuple[Expr, Expr], y: Odd) -> Odd:
    """The slope of a wall `x = p*y^2 + q*y^4`."""
    return 2 * jets[0] * y[0], 2 * jets[0] * y[1] + 4 * jets[1] * y[0] ** 3


def fly(y: Odd, phi: Odd, leaves: tuple[Expr, Expr], lands: tuple[Expr, Expr]) -> tuple[Odd, Odd]:
    """From one wall to the opposite one: where the ball lands, and its incidence angle, with the sign of the exit's."""
    direction = total(phi, times(RING(-1), arctangent(slope(leaves, y))))
    steep = arctangent(direction, -1)
    far = y[0] + RING.from_sympy(LENGTH) * steep[0]
    shorter = lands[0] * far**2 + leaves[0] * y[0] ** 2
    across = total(y, times(RING.from_sympy(LENGTH), steep), (RING(0), -shorter * steep[0]))
    return across, total(direction, times(RING(-1), arctangent(slope(lands, across))))


@cache
def return_map() -> tuple[Matrix, Matrix]:
    """`M` and the cubic terms of the return map to the wall, in `height` and `exit_angle`.

    >>> M, _ = return_map()
    >>> M.subs(a, 0).trace().expand()
    -11*lam**2/16 - 27*lam/8 - 11/16
    """
    wall = RING.from_sympy(a), RING.from_sympy(b)
    arc = tuple(RING.from_sympy(jet) for jet in arc_jets())
    contraction = RING.from_sympy(lam)
    start = (RING.from_sympy(height), RING(0)), (RING.from_sympy(exit_angle), RING(0))
    across, eta = fly(*start, wall, arc)
    back, last = fly(across, times(contraction, eta), arc, wall)
    ends = back, times(contraction, last)
    letters = height, exit_angle
    linear = [Poly(RING.to_sympy(end[0]), *letters) for end in ends]
    rows = Matrix(2, 2, lambda i, j: linear[i].coeff_monomial(letters[j]))
    return rows, Matrix([RING.to_sympy(end[1]) for end in ends])


@cache
def coefficient() -> tuple[Expr, Expr]:
    """`c = c0 + c1*b` at the flip with a wall that is flat at its centre (`a = 0`, so `lambda_c` stays), as `(c0, c1)`.

    Here `q` has height 1: `xi` is the height at the wall.

    >>> coefficient()
    (-541*sqrt(11)/4356, 9*sqrt(11)/4)
    """
    M, cubic = (part.subs(a, 0) for part in return_map())
    q = M[0, 1], -1 - M[0, 0]
    p = M[1, 0], -1 - M[0, 0]
    along = [entry.subs({height: q[0], exit_angle: q[1]}, simultaneous=True) for entry in cubic]
    above = expand(p[0] * along[0] + p[1] * along[1])
    below = expand((p[0] * q[0] + p[1] * q[1]) * q[0] ** 2).subs(lam, lambda_c())
    parts = [radsimp(expand(above.coeff(b, k).subs(lam, lambda_c())) / expand(below)) for k in (0, 1)]
    return parts[0], parts[1]


def least_bend() -> Expr:
    """The `b` beyond which the period-4 orbit is born stable; the wall's curvature is `-12*b*s^2` near its centre.

    >>> least_bend()
    541/9801
    """
    free, bent = coefficient()
    return radsimp(-free / bent)
