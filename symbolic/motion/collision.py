"""The collision map, and its derivative by implicit differentiation. Paper: section 2.1.

A particle leaves `q0 = (X0, Y0)(s0)` with exit angle `phi0`, counted from the inward normal towards the tangent; if
`psi` is the direction of the tangent, the particle's direction is `psi0 + pi/2 - phi0`. It lands at
`q1 = (X1, Y1)(s1)`, where the flight equation says that `q1 - q0` is parallel to that direction, with incidence angle
`eta1 = psi1 - direction - pi/2`. The law is `phi1 = -eta1 + f(eta1)`.

The module also derives how much area a bounce contracts: at a point, on average, and near the elastic case. Paper:
sections 1 and 4.1.

A flight preserves the area `ds d(sin(phi))`; the reflection changes `sin(eta)` into `-sin(lam*eta)`. So in these
coordinates a bounce multiplies areas by `g(eta) = lam*cos(lam*eta)/cos(eta)`, which depends on the incidence angle
alone. For any law `phi(eta)`, even one that depends on the place as well, the factor is minus the derivative of
`sin(phi)` by `sin(eta)`, that is `g = -phi'(eta)*cos(phi)/cos(eta)`.

- Not pointwise: `g` grows with `|eta|` from `lam` without bound, so for `0 < lam < 1` areas shrink where `|eta|` is
  below the root of `g = 1` and grow beyond it. As `lam` tends to 1 that root tends to the one of `eta*tan(eta) = 1`.
- Along an orbit `log|det D(T^n)|` is the sum of `log(g)` up to an end term, in `(s, phi)` and in `(s, sin(phi))`:
  the exact sum rule `nu_plus + nu_minus = log(lam) + <log(cos(lam*eta)/cos(eta))>`.
- So `nu_plus + nu_minus >= log(lam)` on every orbit, with equality where the incidence tends to normal.
- And `nu_plus + nu_minus <= 0` for almost every start: `T^n` is injective into phase space, whose area is finite, so
  the set where it multiplies areas by more than `exp(e*n)` is smaller than `exp(-e*n)` times the whole; these sets have
  a finite sum, and almost every start lies in finitely many of them (Borel and Cantelli), for each `e > 0`.
- On single orbits the sum may be positive: a cycle of the elastic table on which `eta*tan(eta)` is above 1 on average
  expands areas for `lam` just below 1. Over the whole of phase space that average is exactly 1: to first order
  in `1 - lam`, expansion and contraction cancel there.

The module ends with a function of the phase point that never decreases, and the limit sets that follow from it.

In an ellipse `x**2/a**2 + y**2 = 1` let `J = g(q)*cos(phi)`, with `g(q) = |(x/a**2, y)|`. Along a flight the landing
has `g(q1)*cos(eta1) = g(q0)*cos(phi0)` (Joachimsthal), and the reflection turns `cos(eta1)` into `cos(lam*eta1)`, which
is not smaller, and larger unless `eta1 = 0`. So `J` grows at every bounce that is not along the normal; a limit point
has `phi = 0` forever. Paper: section 3.2, where this is stated from numerics.
"""

from functools import cache

from sympy import (
    Expr,
    Matrix,
    S,
    Symbol,
    cos,
    diff,
    expand,
    factor,
    integrate,
    log,
    pi,
    simplify,
    sin,
    sqrt,
    symbols,
    tan,
    trigsimp,
)

from symbolic.tables.table import K0, K1, a, cos_eta1, cos_phi0, eta, lam, phi, t

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

    Rows: landing arc length and minus the incidence angle. The Frenet equations `X' = cos psi`, `Y' = sin psi`,
    `psi' = -kappa` are all that is used of the boundary. A rotation of the plane does not change them, so that the
    flight may be assumed to run along the first axis.
    """
    landing = Symbol("landing", real=True)
    ends = [symbols(f"X{index} Y{index} psi{index}", real=True) for index in (0, 1)]
    (X0, Y0, psi0), (X1, Y1, psi1) = ends
    direction = psi0 + pi / 2 - phi
    flight = (X1 - X0) * sin(direction) - (Y1 - Y0) * cos(direction)
    minus_eta = direction - psi1 + pi / 2
    flown = {X1: X0 + t * cos(direction), Y1: Y0 + t * sin(direction)}
    first_axis = {psi0: phi - pi / 2, psi1: landing + pi / 2}  # landing is eta1

    def at_flight(derivative: Expr) -> Expr:
        return derivative.subs(flown).subs(first_axis)

    def along(index: int, expression: Expr) -> Expr:
        """The derivative along the boundary at an end, by the chain rule with the Frenet equations."""
        (X, Y, psi), kappa = ends[index], (K0, K1)[index]
        moved = diff(expression, X) * cos(psi) + diff(expression, Y) * sin(psi) - diff(expression, psi) * kappa
        return at_flight(moved)

    def by_departure(expression: Expr) -> list[Expr]:
        return [along(0, expression), at_flight(diff(expression, phi))]

    slope = [-part / along(1, flight) for part in by_departure(flight)]
    turned = along(1, minus_eta)
    angle = [part + turned * moved for part, moved in zip(by_departure(minus_eta), slope, strict=True)]
    cosines = {cos(phi): cos_phi0, cos(landing): cos_eta1}
    matrix = Matrix([slope, angle]).subs(cosines)
    return Matrix([[factor(by_place), expand(by_angle)] for by_place, by_angle in matrix.tolist()])


def derivative_matrix(
    K0: Expr = K0,
    K1: Expr = K1,
    t: Expr = t,
    cos_phi0: Expr = cos_phi0,
    cos_eta1: Expr = cos_eta1,
    lam: Expr = lam,
    drift: Expr = S.Zero,
) -> Matrix:
    """`d(s1, phi1)/d(s0, phi0)` of one flight and one reflection. Paper: eq. (derivative_of_map).

    `lam` is the slope of the reflection law at the landing, `lambda` for the uniform contraction
    and `1 - f'(eta1)` for any other (`exit_slope`). `drift` is the derivative of the exit angle along the boundary,
    per unit of arc length, for a law that depends on the place.

    >>> derivative_matrix(K0=-1, K1=-1, t=2, cos_phi0=1, cos_eta1=1).tolist()
    [[1, -2], [0, lam]]
    """
    own = {"K0": K0, "K1": K1, "t": t, "cos_phi0": cos_phi0, "cos_eta1": cos_eta1}
    matrix = implicit_derivative()
    values = {symbol: own[symbol.name] for symbol in matrix.free_symbols}
    reflected = Matrix([matrix.row(0), lam * matrix.row(1) + drift * matrix.row(0)])
    return reflected.xreplace({symbol: S(value) for symbol, value in values.items()})


@cache
def determinant(slope: Expr = lam, drift: Expr = S.Zero) -> Expr:
    """`det DT` in the coordinates `(s, phi)`: `lam * cos_phi0 / cos_eta1`, where `lam` is the slope of the law.

    It exceeds 1 at grazing landings, however small `lam` is: contraction holds on average only. The drift of a law that
    depends on the place adds a multiple of the first row to the second, which does not change the determinant.

    >>> determinant(), determinant(drift=Symbol("c"))
    (cos_phi0*lam/cos_eta1, cos_phi0*lam/cos_eta1)
    """
    return simplify(derivative_matrix(lam=slope, drift=drift).det())


def slap_derivative(
    K0: Expr = K0, t: Expr = t, cos_eta1: Expr = cos_eta1, cos_phi0: Expr = S.One, drift: Expr = S.Zero
) -> Expr:
    """`T0'(s)`, the derivative of the slap map (`lambda = 0`, exit along the normal). Paper: section 2.2.

    If a law does not depend on the incidence angle at all, `phi = c(s)`, the map is one-dimensional too. Then `drift`
    is `c'`, and `cos_phi0` is the cosine of `c`.

    >>> slap_derivative(K0=-1, t=2, cos_eta1=1)
    1
    >>> slap_derivative(cos_phi0=cos_phi0, drift=Symbol("slope"))
    (-K0*t - cos_phi0 - slope*t)/cos_eta1
    """
    row = derivative_matrix(K0=K0, t=t, cos_phi0=cos_phi0, cos_eta1=cos_eta1, lam=0).row(0)
    return row[0] if drift == 0 else simplify(row[0] + drift * row[1])


def birkhoff_matrix(matrix: Matrix, cos_phi0: Expr, cos_phi1: Expr) -> Matrix:
    """A derivative matrix converted from `(s, phi)` to the Birkhoff coordinates `(s, sin phi)`.

    >>> birkhoff_matrix(derivative_matrix(lam=1), cos_phi0, cos_eta1).det().simplify()
    1
    """
    return Matrix([[1, 0], [0, cos_phi1]]) * matrix * Matrix([[1, 0], [0, 1 / cos_phi0]])


@cache
def area_factor(phi: Expr = -lam * eta) -> Expr:
    """`g(eta)`, the factor of the area `ds d(sin(phi))` at a bounce with incidence angle `eta`, for any law `phi(eta)`.

    >>> area_factor(), area_factor(-eta)
    (lam*cos(eta*lam)/cos(eta), 1)
    """
    factor = birkhoff_matrix(derivative_matrix(lam=-diff(phi, eta)), cos_phi0, cos(phi)).det()
    return simplify(factor.subs(cos_eta1, cos(eta)))


def telescoped(bounces: int, phi: Expr = -lam * eta) -> Expr:
    """The sum rule: along an orbit, in `(s, phi)`, `prod det DT / (prod g * cos(phi_0)/cos(phi_n))`, which is 1.

    >>> telescoped(3)
    1
    """
    angles = symbols(f"eta1:{bounces + 1}", real=True)
    start = Symbol("phi_0", real=True)
    exits = [cos(start), *(cos(phi.subs(eta, angle)) for angle in angles)]
    ratio: Expr = exits[-1] / exits[0]
    whole, factor = determinant(-diff(phi, eta)), area_factor(phi)
    for leaving, angle in zip(exits, angles, strict=False):
        ratio *= whole.subs({cos_phi0: leaving, cos_eta1: cos(angle)}).subs(eta, angle) / factor.subs(eta, angle)
    return simplify(ratio)


def steepening() -> Expr:
    """`d log(g)/d eta`: positive for `0 < eta < pi/2` and `lam < 1`, since the tangent grows.

    >>> steepening()
    -lam*tan(eta*lam) + tan(eta)
    """
    return trigsimp(simplify(diff(log(area_factor()), eta))).rewrite(tan)


def weak_dissipation() -> Expr:
    """`d log(g)/d lam` at `lam = 1`: the first-order effect of dissipation on the area factor of one bounce.

    >>> weak_dissipation()
    -eta*tan(eta) + 1
    """
    return simplify(diff(log(area_factor()), lam).subs(lam, 1))


def elastic_mean(f: Expr) -> Expr:
    """The mean of `f(eta)` over phase space with the elastic map's own measure, `cos(eta)/2 d(eta)`.

    >>> elastic_mean(weak_dissipation())
    0
    """
    density = simplify((f * cos(eta)).subs(tan(eta), sin(eta) / cos(eta)))
    return simplify(integrate(density, (eta, -pi / 2, pi / 2)) / 2)


@cache
def log_cosine_mean() -> Expr:
    """The mean of `log(cos(eta))` with the elastic map's own measure: finite, though the logarithm is not bounded.

    With `y = sin(eta)`, uniform on (-1, 1), it is half the mean of `log(1 - y) + log(1 + y)`, and both terms have the
    mean of `log(u)` on (0, 2). The mean of `log(cos(theta/2))` along the cardioid is the same, because its arc length
    is `4*sin(theta/2)`.

    >>> log_cosine_mean()
    -1 + log(2)
    """
    u = Symbol("u", positive=True)
    return simplify(integrate(log(u), (u, 0, 2)) / 2)


def growth_defects() -> list[Expr]:
    """Three expressions that are 0, so that the growth rates of the Gram-Schmidt method add up to that of areas.

    In order: the square of the product of both normalising factors of a matrix, minus that of its determinant; its
    first factor squared, minus the squared length of its first column; and the determinant of a product, minus the
    product.

    >>> growth_defects()
    [0, 0, 0]
    """
    first, second = Matrix(symbols("a c", real=True)), Matrix(symbols("b d", real=True))
    unit = first / sqrt(first.dot(first))
    rest = second - second.dot(unit) * unit
    factors = first.dot(unit) ** 2, rest.dot(rest)
    matrix, other = Matrix.hstack(first, second), Matrix(2, 2, symbols("e f g h", real=True))
    return [
        simplify(factors[0] * factors[1] - matrix.det() ** 2),
        simplify(factors[0] - first.dot(first)),
        simplify((other * matrix).det() - other.det() * matrix.det()),
    ]


def image_share(phi: Expr = -lam * eta) -> Expr:
    """An upper bound of the share of phase space that the image of `T` fills: the mean of `g`, for a decreasing law.

    >>> image_share()
    sin(pi*lam/2)
    """
    angle = Symbol("angle", real=True)  # minus the exit angle
    ends = [-phi.subs(eta, end) for end in (-pi / 2, pi / 2)]
    return simplify(integrate(cos(angle), (angle, *ends)) / 2)


def gradient(x: Expr, y: Expr) -> Matrix:
    """Half the gradient of `x**2/a**2 + y**2`.

    >>> gradient(a, 0).T
    Matrix([[1/a, 0]])
    """
    return Matrix([x / a**2, y])


def joachimsthal_defect() -> Expr:
    """The scalar product of `gradient(q0) + gradient(q1)` and `q1 - q0` on the ellipse; it is 0, so a flight conserves
    `J`.

    >>> from symbolic.expressions.signs import vanishes
    >>> vanishes(joachimsthal_defect())
    True
    """
    t0, t1 = symbols("theta0 theta1")
    q0, q1 = Matrix([a * cos(t0), sin(t0)]), Matrix([a * cos(t1), sin(t1)])
    return (gradient(*q0) + gradient(*q1)).dot(q1 - q0)
