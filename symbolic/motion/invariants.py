"""Functions of the phase point that never decrease, and the limit sets they force.

In an ellipse `x**2/a**2 + y**2 = 1` let `J = g(q)*cos(phi)`, with `g(q) = |(x/a**2, y)|`. Along a
flight the landing has `g(q1)*cos(eta1) = g(q0)*cos(phi0)` (Joachimsthal), and the reflection turns
`cos(eta1)` into `cos(lam*eta1)`, which is not smaller, and larger unless `eta1 = 0`. So `J` grows
at every bounce that is not along the normal; a limit point has `phi = 0` forever. Paper: section
3.2, where this is stated from numerics.
"""

from sympy import Expr, Matrix, cos, sin, symbols

from symbolic.tables.symbols import a


def gradient(x: Expr, y: Expr) -> Matrix:
    """Half the gradient of `x**2/a**2 + y**2`.

    >>> gradient(a, 0).T
    Matrix([[1/a, 0]])
    """
    return Matrix([x / a**2, y])


def joachimsthal_defect() -> Expr:
    """`<G(q0) + G(q1), q1 - q0>` for two points of the ellipse: zero, so `J` survives a flight.

    >>> from symbolic.proofs.zero import vanishes
    >>> vanishes(joachimsthal_defect())
    True
    """
    t0, t1 = symbols("theta0 theta1")
    q0, q1 = Matrix([a * cos(t0), sin(t0)]), Matrix([a * cos(t1), sin(t1)])
    return (gradient(*q0) + gradient(*q1)).dot(q1 - q0)
