"""How much area a bounce contracts: at a point, on average, and near the elastic case. Paper: sections 1 and 4.1.

A flight keeps the area `ds d(sin(phi))`; the reflection turns `sin(eta)` into `sin(lam*eta)`. So in these coordinates
a bounce multiplies areas by `g(eta) = lam*cos(lam*eta)/cos(eta)`, which depends on the incidence angle alone.

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
"""

from sympy import Expr, Matrix, Symbol, cos, diff, integrate, log, pi, simplify, sin, sqrt, symbols, tan, trigsimp

from symbolic.motion.collision import birkhoff_matrix, derivative_matrix, determinant
from symbolic.tables.symbols import cos_eta1, cos_phi0, eta, lam


def area_factor() -> Expr:
    """`g(eta)`: what a bounce that lands at the incidence angle `eta` multiplies `ds d(sin(phi))` by.

    >>> area_factor()
    lam*cos(eta*lam)/cos(eta)
    """
    factor = birkhoff_matrix(derivative_matrix(), cos_phi0, cos(lam * eta)).det()
    return simplify(factor.subs(cos_eta1, cos(eta)))


def telescoped(bounces: int) -> Expr:
    """`prod det DT / (prod g * cos(phi_0)/cos(phi_n))` along an orbit, in `(s, phi)`: 1, which is the sum rule.

    >>> telescoped(3)
    1
    """
    angles = symbols(f"eta1:{bounces + 1}", real=True)
    start = Symbol("phi_0", real=True)
    exits = [cos(start), *(cos(lam * angle) for angle in angles)]  # cos(phi_k) = cos(lam*eta_k)
    ratio: Expr = exits[-1] / exits[0]
    for leaving, angle in zip(exits, angles, strict=False):
        ratio *= determinant().subs({cos_phi0: leaving, cos_eta1: cos(angle)}) / area_factor().subs(eta, angle)
    return simplify(ratio)


def steepening() -> Expr:
    """`d log(g)/d eta`: positive for `0 < eta < pi/2` and `lam < 1`, since the tangent grows.

    >>> steepening()
    -lam*tan(eta*lam) + tan(eta)
    """
    return trigsimp(simplify(diff(log(area_factor()), eta))).rewrite(tan)


def weak_dissipation() -> Expr:
    """`d log(g)/d lam` at `lam = 1`: what one bounce contributes when the elastic law is left.

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


def log_cosine_mean() -> Expr:
    """The mean of `log(cos(eta))` with the elastic map's own measure: finite, though the logarithm is not bounded.

    With `y = sin(eta)`, uniform on (-1, 1), it is half the mean of `log(1 - y**2)`. The mean of `log(cos(theta/2))`
    along the cardioid is the same, because its arc length is `4*sin(theta/2)`.

    >>> log_cosine_mean()
    -1 + log(2)
    """
    y = Symbol("y", real=True)
    return simplify(integrate(log(1 - y) + log(1 + y), (y, -1, 1)) / 4)


def growth_defects() -> list[Expr]:
    """The growth rates of the Gram-Schmidt method add up to that of areas: zeros.

    In turn: the square of the product of both normalising factors of a matrix, minus that of its determinant; its first
    factor squared, minus the squared length of its first column; and the determinant of a product, minus the product.

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


def image_share() -> Expr:
    """The share of phase space that the image of `T` may fill: the mean of `g` over it.

    >>> image_share()
    sin(pi*lam/2)
    """
    angle = Symbol("angle", real=True)  # the exit angle, lam*eta
    return simplify(integrate(cos(angle), (angle, -lam * pi / 2, lam * pi / 2)) / 2)
