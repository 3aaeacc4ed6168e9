"""The elastic map near a cycle to third order, from chord lengths, and how its rotation varies with the distance.

With elastic collisions the length `H(x, y)` of the chord between boundary parameters generates the map:
`p = -dH/dx` leaves, `p' = dH/dy` lands, and `(x, p) -> (y, p')` preserves area. Around an elliptic point the
map is a rotation whose angle changes with the square of the distance; when that coefficient, the twist, is not
zero and the multiplier is no root of unity up to the fourth, invariant curves surround the point [Moser1962]
[SiegelMoser1971].
Everything here is truncated power series over whatever numbers are put in, exact or balls.
"""

from collections.abc import Callable, Sequence
from functools import cache
from math import factorial
from typing import Any

from sympy import QQ, Expr, S, Symbol, cos, diff, sin
from sympy.polys.fields import field

from symbolic.tables.symbols import alpha, theta

Series = dict[tuple[int, int], Any]  # the coefficient of x^i y^j at (i, j)
Map = tuple[Series, Series]
QUARTIC, CUBIC = 4, 3
BINOMIAL = (1, 2), (-1, 8), (1, 16), (-5, 128)  # sqrt(1 + u)


def times(f: Series, g: Series, order: int) -> Series:
    """The product up to `order`.

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
    """`f + factor*g`."""
    return {at: f.get(at, 0) + factor * g.get(at, 0) for at in {**f, **g}}


def powers(f: Series, order: int) -> list[Series]:
    """`1, f, f^2, ...` up to `order`."""
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
    """The length of the chord, second to fourth order; the ends are Taylor coefficients of `x` and `y` there.

    At a cycle the first order cancels against the neighbouring chord, so it is left out. `weights` are factors of the
    squares of the two coordinates, for coordinates of different units.
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
    """`(x, p) -> (y, p')` to third order, from the length of the chord that is flown."""
    x, p = {(1, 0): 1}, {(0, 1): 1}
    by_start = {(i - 1, j): i * c for (i, j), c in H.items() if i}
    by_end = {(i, j - 1): j * c for (i, j), c in H.items() if j}
    y: Series = {}
    for _ in range(CUBIC):  # p = -dH/dx, solved for y, one order at a time
        y = plus(y, {at: c / H[1, 1] for at, c in plus(p, put(by_start, x, y)).items()}, -1)
    return y, put(by_end, x, y)


def put(f: Series, x: Series, y: Series) -> Series:
    """`f(x, y)` with series for both, up to third order."""
    found: Series = {}
    along, across = powers(x, CUBIC), powers(y, CUBIC)
    for (i, j), c in f.items():
        if i + j <= CUBIC:
            found = plus(found, times(along[i], across[j], CUBIC), c)
    return found


def composed(maps: Sequence[Map]) -> Map:
    """The maps, the first one first."""
    x, p = maps[0]
    for following in maps[1:]:
        x, p = put(following[0], x, p), put(following[1], x, p)
    return x, p


def twist_of_odd(map: Map) -> Any:
    """The twist of an area-preserving map with `F(-v) = -F(v)` and `A = D`, up to a positive factor and the sign of B.

    `F = M(v + J grad S)` to third order, and `M` turns along the ellipses `-C*x^2 + B*p^2`; the mean of the quartic
    `S` along them is the twist. Without even terms the third root of unity is no obstacle.
    """
    (x, p), S = map, dict[tuple[int, int], Any]()
    A, B, C, D = x[1, 0], x[0, 1], p[1, 0], p[0, 1]
    for i, j in ((3, 0), (2, 1), (0, 3)):
        S[i, j] = D * x.get((i, j), 0) - B * p.get((i, j), 0), A * p.get((i, j), 0) - C * x.get((i, j), 0)
    s40, s22, s04 = -S[3, 0][1] / 4, S[2, 1][0] / 2, S[0, 3][0] / 4
    return 3 * s40 * B**2 - s22 * B * C + 3 * s04 * C**2


@cache
def egg_diameter() -> tuple[Expr, Expr, Expr]:
    """`B`, the trace and the twist (as `twist_of_odd`) of the elastic period-2 orbit of the three-pointed egg, exact.

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
    """A polynomial of degree 1 in alpha, as an element of the field."""
    letter = Symbol("alpha")
    return a * int(expression.coeff(letter, 1)) + int(expression.coeff(letter, 0))
