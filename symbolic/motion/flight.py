"""The flight equation, divided exactly by its known root.

Let the boundary be `z(theta) = sum_k C_k cos(k*theta) + S_k sin(k*theta)` with vectors `C_k`, `S_k`, and let a particle
fly along the unit vector `v` from `theta0` to `theta1`. With `m` the mean of the two parameters, `B = m - theta0` and
`E = -i*v`, which is `exp(i*m)` for a chord of the circle,

    Im(conj(v)*(z1 - z0)) = 2*sin(B) * sum_k U_{k-1}(cos B) * Im(conj(M_k) * exp(i*k*m)),

where `M_k = C_k.E + i*S_k.E`. The factor `sin(B)` is the known root. The rest, in `T = tan(delta)` with
`exp(i*m) = E*exp(i*delta)`, is `cos(delta)**(2*n-1)` times a real polynomial of degree `2*n - 1`, `n` the highest
harmonic: 1 for circle and ellipse, 2 for the cardioid, `K + 1` for the K-egg. Paper: the flights of section 2.

The functions on `Harmonics` use `+`, `-` and `*` only and work on any kind of number, so the text that SymPy proves is
the text that the numeric kernels run. Complex numbers are pairs.

The module ends with the pinball map of the unit circle. Paper: section 3.1.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

from sympy import Dummy, Expr, I, Pow, S, cos, exp, expand, im, pi, re, simplify, sin, sqrt, symbols

from symbolic.expressions.signs import Box
from symbolic.tables.geometry import boundary_coefficients
from symbolic.tables.table import Component, lam, phi, s, theta
from symbolic.tables.validity import is_positive

Complex = tuple[Any, Any]
Harmonics = Mapping[int, tuple[Complex, Complex]]  # C_k and S_k by k
ONE: Complex = (1, 0)
HIGH = 64  # most periods of a wave in one turn of theta


def harmonics(component: Component) -> dict[int, tuple[Complex, Complex]] | None:
    """The vectors `C_k` and `S_k` by `k`; None when the boundary is no finite sum.

    >>> from symbolic.tables import ellipse
    >>> harmonics(ellipse.components[0])
    {1: ((a, 0), (0, 1))}
    """
    c = boundary_coefficients(component)
    if c is None:
        return None
    found = {}
    for k in sorted(set(map(abs, c))):
        there, back = c.get(k, S.Zero), c.get(-k, S.Zero)
        C, sine = _tidy(there + back if k else there), _tidy(I * (there - back))
        found[k] = ((re(C), im(C)), (re(sine), im(sine)))
    return found


def _tidy(value: Expr) -> Expr:
    """A coefficient, simplified; for a complex number with rational parts it is only expanded."""
    fraction = not value.has(Pow) and all(part.is_Rational or part is I for part in value.atoms())
    return expand(value) if fraction else simplify(value)


def times(z: Complex, w: Complex) -> Complex:
    """The product of two complex numbers."""
    return z[0] * w[0] - z[1] * w[1], z[0] * w[1] + z[1] * w[0]


def powers(z: Complex, highest: int) -> list[Complex]:
    """`1, z, z**2, ...` up to `z**highest`."""
    found = [ONE, z]
    for k in range(2, highest + 1):
        found.append(times(found[k // 2], found[k - k // 2]))
    return found


def power(z: Complex, n: int) -> Complex:
    """`z**n`, computed by those products of `powers` that it needs.

    >>> power((0, 1), 10**6 + 1)
    (0, 1)
    """
    needed = [n] if n > 1 else []
    for k in needed:
        needed += [half for half in (k // 2, k - k // 2) if half > 1 and half not in needed[-2:]]
    found = {0: ONE, 1: z}
    for k in sorted(set(needed)):
        found[k] = times(found[k // 2], found[k - k // 2])
    return found[n]


def point_at(h: Harmonics, u: Complex) -> Complex:
    """The boundary point at `u = exp(i*theta)`, summed from the highest harmonic down."""
    up = powers(u, max(h, default=0))
    x, y = 0, 0
    for k in sorted(h, reverse=True):
        (cx, cy), (sx, sy) = h[k]
        c, s = up[k]
        x, y = x + cx * c + sx * s, y + cy * c + sy * s
    return x, y


def differentiated(h: Harmonics) -> dict[int, tuple[Complex, Complex]]:
    """The harmonics of `d z/d theta`.

    >>> differentiated({1: ((3, 0), (0, 2))})
    {1: ((0, 2), (-3, 0))}
    """
    return {k: ((k * sx, k * sy), (-k * cx, -k * cy)) for k, ((cx, cy), (sx, sy)) in h.items() if k}


def support(h: Harmonics, k: int, E: Complex) -> Complex:
    """`M_k` of the module's text. For `n = 1` this alone gives the chord: `exp(i*m)` lies along `M_1`.

    >>> support({1: ((4, 0), (0, 2))}, 1, (5, 7))
    (20, 14)
    """
    (cx, cy), (sx, sy) = h[k]
    return cx * E[0] + cy * E[1], sx * E[0] + sy * E[1]


def seen_ahead(k: int, C: Complex, S: Complex, E: Complex) -> tuple[Complex, Complex]:
    """`C_k` and `S_k` in the frame of the flight, where `E = 1`; components that do not affect the chord are set to 0.

    `exp(i*k*m)*conj(M_k)` is the sum of multiples of `E**(k + 1)` and `E**(k - 1)`. Here `|E| = 1` is used, so that the
    products `E*conj(E)` are exactly one, and the circular part of a table adds no rounding to the chord polynomial.
    """
    half = Fraction(1, 2)
    up = powers(E, k + 1)
    above = (C[0] - S[1]) * half, (S[0] + C[1]) * -half
    below = (C[0] + S[1]) * half, (C[1] - S[0]) * half
    g = [x + y for x, y in zip(times(above, up[k + 1]), times(below, up[k - 1]), strict=True)]
    return (g[0], 0), (-g[1], 0)


def oscillates(expression: Expr) -> bool:
    """Does an expression contain a wave of more than `HIGH` periods in a turn? Then `about_focus` returns None.

    >>> oscillates(1 + cos(65 * theta)), oscillates(cos(theta) ** 3)
    (True, False)
    """
    multiples = (wave.args[0].coeff(theta) for wave in expression.atoms(cos, sin))
    return any(k.is_Rational and abs(k) > HIGH for k in multiples)


class Focal(NamedTuple):
    """The ellipse `1/rho = p + size*cos(theta - w)` with its eccentric anomaly `E`, which is 0 at `theta = w`."""

    harmonics: Harmonics  # of the parameter `E`
    ahead: tuple[Expr, Expr]  # cosine and sine of `w`
    p: Expr
    size: Expr
    left: Expr  # `p*p - size*size`


def about_focus(rho: Expr) -> Focal | None:
    """The ellipse with a focus in the origin and the radius `rho(theta)`; None for other curves, and for a circle.

    With `1/rho = p + size*cos(theta - w)` and `left = p*p - size*size` the half axes are `p/left` and `1/sqrt(left)`,
    and the centre is at `-size/left` along the long axis. The result is None, too, if the direction of this axis
    depends on a parameter.

    >>> about_focus(1 / (5 + 3 * cos(theta))).harmonics
    {0: ((-3/16, 0), (0, 0)), 1: ((5/16, 0), (0, 1/4))}
    >>> about_focus(1 + cos(theta) / 2) is None
    True
    """
    if oscillates(rho):  # before waves become powers
        return None
    c, s = Dummy(real=True), Dummy(real=True)
    found = expand(1 / rho, trig=True).xreplace({cos(theta): c, sin(theta): s})
    if found.has(theta) or not found.is_polynomial(c, s):
        return None
    p, q, r = found.subs({c: 0, s: 0}), *(found.coeff(x).subs({c: 0, s: 0}) for x in (c, s))
    if expand(found - p - q * c - r * s) != 0 or q == r == 0 or (q != 0 and (r / q).free_symbols):
        return None
    slope = r / q if q != 0 else S.Zero
    size = q * sqrt(1 + slope**2) if q != 0 else r
    x, y = (1 / sqrt(1 + slope**2), slope / sqrt(1 + slope**2)) if q != 0 else (S.Zero, S.One)
    if size.is_negative:
        size, x, y = -size, -x, -y
    free = p.free_symbols | size.free_symbols
    left = (p - size) * (p + size) if free else expand(p * p - q * q - r * r)
    if not free and not (p.is_positive and left.is_positive):
        return None
    a, b = p / left, 1 / sqrt(left)
    centre = -x * size / left, -y * size / left
    return Focal({0: (centre, (S.Zero, S.Zero)), 1: ((a * x, a * y), (-b * y, b * x))}, (x, y), p, size, left)


def about_far_focus(component: Component, box: Box) -> Component:
    """The component; an arc of a conic with a focus in the origin is rewritten so as to lose no digits at a far tip.

    There `1/rho = p + size*cos(theta - w)` is a small difference. In terms of the cosine `c` of half of `theta - w` it
    is `(p - size) + 2*size*c*c`, a sum of two positive numbers on an ellipse. The new form uses cosine and sine of
    `theta/2` only. The component is returned unchanged where `size` has no proved sign on the box or is not above
    `p/2`.

    >>> rho = 1 / (5 + 4 * cos(theta))
    >>> about_far_focus(Component("arc", (rho * cos(theta), rho * sin(theta)), S.Zero, pi), {}).point[1]
    2*sin(theta/2)*cos(theta/2)/(8*cos(theta/2)**2 + 1)
    """
    rho = component.radius
    known = None if rho is None else about_focus(rho)
    if known is None:
        return component
    size, (x, y) = known.size, known.ahead
    if not is_positive(size, box):
        size, x, y = -size, -x, -y
    if not is_positive(size, box) or not is_positive(2 * size - known.p, box):
        return component
    u, half = (cos(theta / 2), sin(theta / 2)), half_of((x, y))
    c = u[0] * half[0] + u[1] * half[1]
    inverse = (known.p - size) + 2 * size * c**2
    return replace(component, point=((2 * u[0] ** 2 - 1) / inverse, 2 * u[0] * u[1] / inverse))


def focal_arc(component: Component, box: Box) -> list[Expr] | None:
    """The 17 numbers of an arc of an ellipse that is given by its radius about a focus in the origin; None for others.

    The point is `(p - e)*A + q*B`: `(p, q)` are cosine and sine of the eccentric anomaly, `e` is the eccentricity. The
    numbers are the focus; `A`; `B`; the first corner; `A x B`; `1 - e`; cosine and sine of the arc's middle; sine and
    cosine of half its angle; the direction of `A`; and `sqrt((1 + e)/(1 - e))`, the ratio of the tangents of half the
    polar angle and half the eccentric anomaly.

    >>> rho = 1 / (5 + 3 * cos(theta))
    >>> focal_arc(Component("arc", (rho * cos(theta), rho * sin(theta)), -pi / 2, pi / 2), {})[2:6]
    [5/16, 0, 0, 1/4]
    """
    rho = component.radius
    known = None if rho is None else about_focus(rho)
    if known is None or not is_positive(known.p, box) or not is_positive(known.left, box):
        return None
    A, B = known.harmonics[1]
    ratio = (known.p + known.size) / sqrt(known.left)
    x, y = half_of(known.ahead)
    ends = []
    for end in (component.start, component.end):
        c, s = cos(end / 2), sin(end / 2)
        h = ratio * (c * x + s * y), s * x - c * y
        size = sqrt(h[0] ** 2 + h[1] ** 2)
        ends.append((h[0] / size, h[1] / size))
    first, last = ends
    half = first[0] * last[1] - first[1] * last[0], first[0] * last[0] + first[1] * last[1]
    gap, D = (known.p - known.size) / known.p, known.p / known.left / sqrt(known.left)
    corner = component.at(component.start)
    return [S.Zero, S.Zero, *A, *B, *corner, D, gap, *times(first, last), *half, *known.ahead, ratio]


def half_of(direction: tuple[Expr, Expr]) -> tuple[Expr, Expr]:
    """Cosine and sine of half an angle in (-pi, pi], from the cosine and sine of the angle."""
    x, y = direction
    sine = sqrt((1 - x) / 2)
    return sqrt((1 + x) / 2), -sine if y.is_negative else sine


def chord_polynomial(h: Harmonics, E: Complex, B: Complex) -> list[Any]:
    """The coefficients, constant first, of the deflated flight equation in `T = tan(delta)`.

    `E = -i*v` is a unit vector, and `B = E*conj(exp(i*theta0))`.

    >>> chord_polynomial({1: ((1, 0), (0, 1))}, (1, 0), (0, 1))  # the circle: T = 0
    [0, 1]
    """
    n = max(h)
    up = powers(E, n)
    x = [B[0], -B[1]]  # cos(B)/cos(delta) as a polynomial in T
    r = [1, 0, 1]  # 1/cos(delta)**2
    chebyshev: list[list[Any]] = [[1], _scaled(2, x)]
    while len(chebyshev) < n:
        chebyshev.append(_sum(_product(_scaled(2, x), chebyshev[-1]), _scaled(-1, _product(r, chebyshev[-2]))))
    total: list[Any] = [0]
    for k in sorted(set(h) - {0}):
        M = support(h, k, E)
        term = _product(chebyshev[k - 1], _imaginary_part(times(up[k], (M[0], -M[1])), k))
        for _ in range(n - k):
            term = _product(r, term)
        total = _sum(total, term)
    return total


def flight_residual(component: Component) -> Expr:
    """The flight equation minus its factored form: 0 proves `chord_polynomial` for this component.

    >>> from symbolic.tables import cardioid
    >>> flight_residual(cardioid.components[0])
    0
    """
    h = harmonics(component)
    if h is None:
        raise ValueError(f"{component.name}: the boundary is no finite Fourier sum, so it has no chord polynomial")
    start, direction, delta = symbols("theta0 psi delta", real=True)
    m0 = direction - pi / 2
    E, B = (cos(m0), sin(m0)), (cos(m0 - start), sin(m0 - start))
    n = max(h)
    coefficients = chord_polynomial(h, E, B)
    polynomial = sum(p * sin(delta) ** j * cos(delta) ** (2 * n - 1 - j) for j, p in enumerate(coefficients))
    x, y = component.point
    end = 2 * (m0 + delta) - start
    flight = cos(direction) * (y.subs(theta, end) - y.subs(theta, start)) - sin(direction) * (
        x.subs(theta, end) - x.subs(theta, start)
    )
    residual = flight - 2 * sin(m0 + delta - start) * polynomial
    return expand(expand(residual.rewrite(exp)).replace(exp, lambda power: exp(expand(power))))


def _sum_pair(z: Complex, w: Complex) -> Complex:
    return z[0] + w[0], z[1] + w[1]


def _imaginary_part(g: Complex, k: int) -> list[Any]:
    """`Im(g*(1 + i*T)**k)` as a polynomial in T."""
    w: list[Complex] = [ONE]
    for _ in range(k):
        w = [_sum_pair(z, (-up[1], up[0])) for z, up in zip([*w, (0, 0)], [(0, 0), *w], strict=True)]
    return [g[0] * z[1] + g[1] * z[0] for z in w]


def _scaled(factor: Any, p: Sequence[Any]) -> list[Any]:
    return [factor * a for a in p]


def _sum(p: Sequence[Any], q: Sequence[Any]) -> list[Any]:
    longer, shorter = (p, q) if len(p) >= len(q) else (q, p)
    return [a + shorter[i] if i < len(shorter) else a for i, a in enumerate(longer)]


def _product(p: Sequence[Any], q: Sequence[Any]) -> list[Any]:
    total: list[Any] = [0] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            total[i + j] = total[i + j] + a * b
    return total


def flight(s: Expr = s, phi: Expr = phi) -> tuple[Expr, Expr]:
    """The pinball map of the unit circle: a flight advances `s` by `pi - 2*phi` and multiplies the angle by `lam`.

    >>> flight()
    (-2*phi + s + pi, lam*phi)
    """
    return s + pi - 2 * phi, lam * phi


def iterate(n: int) -> tuple[Expr, Expr]:
    """The map `flight`, applied `n` times, with arc length not reduced modulo the perimeter.

    >>> iterate(2)
    (-2*lam*phi - 2*phi + s + 2*pi, lam**2*phi)
    """
    state: tuple[Expr, Expr] = (s, phi)
    for _ in range(n):
        state = flight(*state)
    return state


def limit_position() -> Expr:
    """The arc length to which the even bounces on the circle converge: `s - 2*phi/(1 - lam)`.

    >>> limit_position().subs(lam, 0)
    -2*phi + s
    """
    return s - 2 * phi / (1 - lam)
