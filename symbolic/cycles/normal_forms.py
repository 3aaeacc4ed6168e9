"""The elastic map near a cycle to third order, from chord lengths, and how its rotation varies with the distance.

With elastic collisions the length `H(x, y)` of the chord between boundary parameters generates the map
`(x, p) -> (y, p')`, where `p = -dH/dx` at departure and `p' = dH/dy` at landing; it preserves area. Around an elliptic
point the map is a rotation whose angle changes with the square of the distance. When the coefficient of this change,
the twist, is not zero, and the multiplier is no root of unity of order up to four, invariant curves surround the point
[Moser1962] [SiegelMoser1971]. All computations are with truncated power series over the given numbers, exact or balls.

The module also has the normal form of the flip of the cuspless cardioid's horizontal orbit when its wall is bent.
Paper: section 5.1, "presumably it could be rendered stable if the billiard table were modified". Near `y = 0` let the
wall be `x = -1/4 + a*y^2 + b*y^4` and the arc `x = 2 - A*y^2 - B*y^4`. By the mirror symmetry the return map is odd:
`x -> M x + C(x)` with `C` cubic, so on the eigendirection of -1, with right and left eigenvectors `q` and `p`,

    xi -> -xi + c*xi^3,    c = p C(q)/(p q),

and the period-4 orbit that is born at the flip is stable for `c > 0`, unstable for `c < 0` [Kuznetsov2004]. An odd
quantity is represented by a pair: its coefficients of degree 1 and 3 in the size of the orbit.
"""

from collections.abc import Callable, Sequence
from functools import cache
from math import factorial
from typing import Any

from sympy import QQ, Expr, Matrix, Poly, Rational, S, Symbol, cos, diff, expand, radsimp, series, sin, solve, symbols
from sympy.polys.fields import field

from symbolic.cycles.thresholds import lambda_c
from symbolic.tables.table import alpha, lam, theta

Series = dict[tuple[int, int], Any]  # the coefficient of x^i y^j at (i, j)
Map = tuple[Series, Series]
QUARTIC, CUBIC = 4, 3
BINOMIAL = (1, 2), (-1, 8), (1, 16), (-5, 128)  # coefficients of u, u^2, ... in sqrt(1 + u), as fractions


def times(f: Series, g: Series, order: int) -> Series:
    """The product of two series, without terms of degree above `order`.

    >>> times({(1, 0): 2}, {(0, 1): 3, (1, 0): 1}, 2)
    {(1, 1): 6, (2, 0): 2}
    """
    found: Series = {}
    for (i, j), a in f.items():
        for (k, m), b in g.items():
            if i + j + k + m <= order:
                found[i + k, j + m] = found.get((i + k, j + m), 0) + a * b
    return found


def plus(f: Series, g: Series, factor: Any = 1) -> Series:
    """The series `f + factor*g`."""
    return {at: f.get(at, 0) + factor * g.get(at, 0) for at in {**f, **g}}


def powers(f: Series, order: int) -> list[Series]:
    """The powers `1, f, ..., f^order`, without terms of degree above `order`."""
    found: list[Series] = [{(0, 0): 1}]
    for _ in range(order):
        found.append(times(found[-1], f, order))
    return found


def chord(
    start: Sequence[Sequence[Any]],
    end: Sequence[Sequence[Any]],
    root: Callable[[Any], Any],
    weights: Sequence[Any] = (1, 1),
) -> Series:
    """Terms of degree 2 to 4 of a chord's length; the ends are given by Taylor coefficients of `x` and of `y`.

    At a cycle the terms of first order cancel against those of the neighbouring chord, so they are left out. `root` is
    the square root of the numbers used; `weights` multiply the squares of the coordinates, where these have different
    units.
    """
    square: Series = {}
    for from_here, to_there, weight in zip(start, end, weights, strict=True):
        leg = plus({(0, k): c for k, c in enumerate(to_there)}, {(k, 0): c for k, c in enumerate(from_here)}, -1)
        square = plus(square, times(leg, leg, QUARTIC), weight)
    whole = square[0, 0]
    u = {at: c / whole for at, c in square.items() if at != (0, 0)}
    length: Series = {}
    for power, (n, d) in zip(powers(u, QUARTIC)[1:], BINOMIAL, strict=True):
        length = plus(length, {at: c * n / d for at, c in power.items()})
    return {at: root(whole) * c for at, c in length.items() if sum(at) > 1}


def bounce(H: Series) -> Map:
    """The map `(x, p) -> (y, p')` to third order, from the terms `H` of a chord's length (as `chord` gives them)."""
    x, p = {(1, 0): 1}, {(0, 1): 1}
    by_start = {(i - 1, j): i * c for (i, j), c in H.items() if i}
    by_end = {(i, j - 1): j * c for (i, j), c in H.items() if j}
    y: Series = {}
    for _ in range(CUBIC):  # p = -dH/dx, solved for y, one order at a time
        y = plus(y, {at: c / H[1, 1] for at, c in plus(p, put(by_start, x, y)).items()}, -1)
    return y, put(by_end, x, y)


def put(f: Series, x: Series, y: Series) -> Series:
    """The series `f(x, y)` with series in the place of `x` and `y`, up to third order."""
    found: Series = {}
    along, across = powers(x, CUBIC), powers(y, CUBIC)
    for (i, j), c in f.items():
        if i + j <= CUBIC:
            found = plus(found, times(along[i], across[j], CUBIC), c)
    return found


def composed(maps: Sequence[Map]) -> Map:
    """The composition of maps to third order; the first in the list acts first."""
    x, p = maps[0]
    for following in maps[1:]:
        x, p = put(following[0], x, p), put(following[1], x, p)
    return x, p


def twist_of_odd(map: Map) -> Any:
    """The twist of an odd area-preserving map with linear part `M = [[A, B], [C, D]]`, `A = D`, up to a factor.

    `F = M(v + J grad S)` to third order, and `M` turns along the ellipses `-C*x^2 + B*p^2`; the mean of the quartic `S`
    along them is the twist. The sign of the factor depends only on the sign of `B`. As there are no even terms, a
    multiplier that is a third root of unity is allowed.
    """
    (x, p), S = map, dict[tuple[int, int], Any]()
    A, B, C, D = x[1, 0], x[0, 1], p[1, 0], p[0, 1]
    for i, j in ((3, 0), (2, 1), (0, 3)):
        S[i, j] = D * x.get((i, j), 0) - B * p.get((i, j), 0), A * p.get((i, j), 0) - C * x.get((i, j), 0)
    s40, s22, s04 = -S[3, 0][1] / 4, S[2, 1][0] / 2, S[0, 3][0] / 4
    return 3 * s40 * B**2 - s22 * B * C + 3 * s04 * C**2


@cache
def egg_diameter() -> tuple[Expr, Expr, Expr]:
    """`B` (as in `twist_of_odd`), the trace and the twist of the elastic diameter of the three-pointed egg, exact.

    >>> egg_diameter()[1].subs(alpha, 0)
    2
    """
    numbers, a = field("alpha", QQ)
    rho = 1 + Symbol("alpha") * cos(3 * theta)
    ends = []
    for at in (S.Zero, S.Pi):
        point = rho * cos(theta), rho * sin(theta)
        ends.append([[_number(diff(x, theta, k).subs(theta, at), a) / factorial(k) for k in range(5)] for x in point])
    there, back = chord(ends[0], ends[1], lambda _: numbers(2)), chord(ends[1], ends[0], lambda _: numbers(2))
    whole = composed([bounce(there), bounce(back)])
    found = whole[0][0, 1], whole[0][1, 0] + whole[1][0, 1], twist_of_odd(whole)
    exact = [value.as_expr().subs(Symbol("alpha"), alpha).factor() for value in found]
    return exact[0], exact[1], exact[2]


def _number(expression: Expr, a: Any) -> Any:
    """The polynomial `expression`, of degree 1 in alpha, as an element of the field of `a`, which stands for alpha."""
    parameter = Symbol("alpha")
    return a * int(expression.coeff(parameter, 1)) + int(expression.coeff(parameter, 0))


a, b = symbols("a b", real=True)  # of the wall: x = -1/4 + a*y^2 + b*y^4
height, exit_angle = symbols("height exit_angle", real=True)  # where the particle leaves the wall
RING = QQ[a, b, lam, height, exit_angle]
LENGTH = Rational(9, 4)
Odd = tuple[Expr, Expr]


def arc_jets() -> tuple[Expr, Expr]:
    """`A` and `B` in `x = 2 - A*y**2 - B*y**4`, the cardioid near `theta = 0`.

    >>> arc_jets()
    (3/8, 7/128)
    """
    A, B = symbols("A B")
    x, y = ((1 + cos(theta)) * f(theta) for f in (cos, sin))
    jet = series(x - 2 + A * y**2 + B * y**4, theta, 0, 6).removeO().expand()
    (found,) = solve([jet.coeff(theta, 2), jet.coeff(theta, 4)], [A, B], dict=True)
    return found[A], found[B]


def total(*parts: Odd) -> Odd:
    """The sum of odd quantities, given by their coefficients of degree 1 and 3."""
    return sum((part[0] for part in parts), RING(0)), sum((part[1] for part in parts), RING(0))


def jet_times(factor: Expr, part: Odd) -> Odd:
    """An odd quantity times a number."""
    return factor * part[0], factor * part[1]


def arctangent(part: Odd, sign: int = 1) -> Odd:
    """`atan` of an odd quantity, or `tan` with `sign = -1`."""
    return part[0], part[1] - sign * RING.from_sympy(Rational(1, 3)) * part[0] ** 3


def slope(jets: tuple[Expr, Expr], y: Odd) -> Odd:
    """The slope of a wall `x = p*y^2 + q*y^4`."""
    return 2 * jets[0] * y[0], 2 * jets[0] * y[1] + 4 * jets[1] * y[0] ** 3


def fly(y: Odd, phi: Odd, leaves: tuple[Expr, Expr], lands: tuple[Expr, Expr]) -> tuple[Odd, Odd]:
    """The height where a flight lands on the opposite wall, and its incidence angle with the sign of the exit angle."""
    direction = total(phi, jet_times(RING(-1), arctangent(slope(leaves, y))))
    steep = arctangent(direction, -1)
    far = y[0] + RING.from_sympy(LENGTH) * steep[0]
    shorter = lands[0] * far**2 + leaves[0] * y[0] ** 2
    across = total(y, jet_times(RING.from_sympy(LENGTH), steep), (RING(0), -shorter * steep[0]))
    return across, total(direction, jet_times(RING(-1), arctangent(slope(lands, across))))


@cache
def return_map() -> tuple[Matrix, Matrix]:
    """The linear part `M` and the cubic terms of the return map to the wall, in `height` and `exit_angle`.

    >>> M, _ = return_map()
    >>> M.subs(a, 0).trace().expand()
    -11*lam**2/16 - 27*lam/8 - 11/16
    """
    wall = RING.from_sympy(a), RING.from_sympy(b)
    arc = tuple(RING.from_sympy(jet) for jet in arc_jets())
    contraction = RING.from_sympy(lam)
    start = (RING.from_sympy(height), RING(0)), (RING.from_sympy(exit_angle), RING(0))
    across, eta = fly(*start, wall, arc)
    back, last = fly(across, jet_times(contraction, eta), arc, wall)
    ends = back, jet_times(contraction, last)
    unknowns = height, exit_angle
    linear = [Poly(RING.to_sympy(end[0]), *unknowns) for end in ends]
    rows = Matrix(2, 2, lambda i, j: linear[i].coeff_monomial(unknowns[j]))
    return rows, Matrix([RING.to_sympy(end[1]) for end in ends])


@cache
def coefficient() -> tuple[Expr, Expr]:
    """The coefficient `c = c0 + c1*b` of the flip as `(c0, c1)`; the wall is flat at its centre, `a = 0`.

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
    """The `b` above which the period-4 orbit is born stable; the wall's curvature is `-12*b*s^2` near its centre.

    >>> least_bend()
    541/9801
    """
    free, bent = coefficient()
    return radsimp(-free / bent)
