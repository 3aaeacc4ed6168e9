"""The collision map, and its derivative by implicit differentiation. Paper: section 2.1.

A ball leaves `q0 = (X0, Y0)(s0)` with exit angle `phi0`, counted from the inward normal towards
the tangent; with `psi` the direction of the tangent its own direction is `psi0 + pi/2 - phi0`. It
lands at `q1 = (X1, Y1)(s1)`, where the flight equation says that `q1 - q0` is parallel to that
direction, with incidence angle `eta1 = psi1 - direction - pi/2`. The law is `phi1 = -eta1 + f(eta1)`.
"""

from functools import cache

from sympy import Derivative, Expr, Function, Matrix, Symbol, cos, diff, pi, simplify, sin, symbols

from symbolic.tables.symbols import K0, K1, cos_eta1, cos_phi0, eta, lam, phi, t

UNIFORM = (1 - lam) * eta  # the paper's f(eta): phi = -eta + f(eta) = -lam*eta


def exit_angle(f: Expr = UNIFORM) -> Expr:
    """The exit angle `phi = -eta + f(eta)` of a reflection law. Paper: section 2.

    >>> exit_angle()
    -eta*lam
    """
    return simplify(-eta + f)


def exit_slope(f: Expr = UNIFORM) -> Expr:
    """`-d phi/d eta`, the factor by which a reflection contracts angles: `lam` for the paper's law.

    >>> exit_slope(), exit_slope(eta**3)
    (lam, 1 - 3*eta**2)
    """
    return -diff(exit_angle(f), eta)


@cache
def implicit_derivative() -> Matrix:
    """`d(s1, -eta1)/d(s0, phi0)` for any two components, by differentiating the flight equation.

    Rows: landing arc length and minus the incidence angle. The Frenet equations `X' = cos psi`,
    `Y' = sin psi`, `psi' = -kappa` are all that is used of the boundary.
    """
    s0, s1, landing = symbols("s0 s1 landing", real=True)
    ends = {}
    for index, s in ((0, s0), (1, s1)):
        ends[index] = [Function(f"{name}{index}", real=True)(s) for name in ("X", "Y", "psi")]
    (X0, Y0, psi0), (X1, Y1, psi1) = ends[0], ends[1]
    direction = psi0 + pi / 2 - phi
    flight = (X1 - X0) * sin(direction) - (Y1 - Y0) * cos(direction)
    minus_eta = direction - psi1 + pi / 2

    frenet: dict[Expr, Expr] = {}
    for (X, Y, psi), s, kappa in ((ends[0], s0, K0), (ends[1], s1, K1)):
        frenet |= {Derivative(X, s): cos(psi), Derivative(Y, s): sin(psi), Derivative(psi, s): -kappa}

    def partial(expression: Expr, variable: Symbol) -> Expr:
        flown = {X1: X0 + t * cos(direction), Y1: Y0 + t * sin(direction)}
        found = diff(expression, variable).subs(frenet).subs(flown)
        return simplify(found.subs(psi1, direction + landing + pi / 2))  # landing is eta1

    slope = [-partial(flight, x) / partial(flight, s1) for x in (s0, phi)]
    angle = [partial(minus_eta, x) + partial(minus_eta, s1) * dx for x, dx in zip((s0, phi), slope, strict=True)]
    cosines = {cos(phi): cos_phi0, cos(landing): cos_eta1}
    return Matrix([slope, angle]).applyfunc(lambda entry: simplify(entry).subs(cosines))


def derivative_matrix(
    K0: Expr = K0,
    K1: Expr = K1,
    t: Expr = t,
    cos_phi0: Expr = cos_phi0,
    cos_eta1: Expr = cos_eta1,
    lam: Expr = lam,
) -> Matrix:
    """`d(s1, phi1)/d(s0, phi0)` of one flight and one reflection. Paper: eq. (derivative_of_map).

    `lam` is the slope of the reflection law at the landing, `lambda` for the uniform contraction
    and `1 - f'(eta1)` for any other (`exit_slope`).

    >>> derivative_matrix(K0=-1, K1=-1, t=2, cos_phi0=1, cos_eta1=1).tolist()
    [[1, -2], [0, lam]]
    """
    own = {"K0": K0, "K1": K1, "t": t, "cos_phi0": cos_phi0, "cos_eta1": cos_eta1}
    matrix = implicit_derivative()
    values = {symbol: own[symbol.name] for symbol in matrix.free_symbols}
    reflected = Matrix([matrix.row(0), lam * matrix.row(1)])
    return reflected.subs(values, simultaneous=True)


def determinant() -> Expr:
    """`det DT` in the coordinates `(s, phi)`: `lam * cos_phi0 / cos_eta1`.

    It exceeds 1 at grazing landings, however small `lam` is: contraction holds on average only.

    >>> determinant()
    cos_phi0*lam/cos_eta1
    """
    return simplify(derivative_matrix().det())


def slap_derivative(K0: Expr = K0, t: Expr = t, cos_eta1: Expr = cos_eta1) -> Expr:
    """`T0'(s)`, the derivative of the slap map (`lambda = 0`, exit along the normal). Paper: section 2.2.

    >>> slap_derivative(K0=-1, t=2, cos_eta1=1)
    1
    """
    return derivative_matrix(K0=K0, t=t, cos_phi0=1, cos_eta1=cos_eta1, lam=0)[0, 0]


def birkhoff_matrix(matrix: Matrix, cos_phi0: Expr, cos_phi1: Expr) -> Matrix:
    """A derivative matrix moved from `(s, phi)` to the Birkhoff coordinates `(s, sin phi)`.

    >>> birkhoff_matrix(derivative_matrix(lam=1), cos_phi0, cos_eta1).det().simplify()
    1
    """
    return Matrix([[1, 0], [0, cos_phi1]]) * matrix * Matrix([[1, 0], [0, 1 / cos_phi0]])
