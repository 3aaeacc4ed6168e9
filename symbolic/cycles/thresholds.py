"""The stability of a cycle of period 2 depends on one number: `P = (1 + t*K0)*(1 + t*K1)`.

A cycle of period 2 runs along a chord that is normal to the boundary at both ends (the exit angle satisfies
`phi = -lam*phi` up to sign, so it vanishes for `lam < 1`; at `lam = 1` a chord that is run back and forth is normal
too). Its monodromy has determinant `lam**2` and trace `(1+lam)**2*P - 2*lam`, whatever the table. All the thresholds of
the paper's period-2 orbits follow from `P`:

    |mu| < 1    exactly when  -((1-lam)/(1+lam))**2 < P < 1,
    mu complex  exactly when  0 < P < 4*lam/(1+lam)**2     (then |mu| = lam).

The paper's thresholds in closed form are derived from the stability numbers of its period-2 cycles. Each is written so
that no digits cancel and no 0/0 occurs in the paper's range. Paper: eqs. for lambda_+-(a) (section 3.3), lambda_c
(5.1), alpha-tilde and alpha-hat (6.3).

The determinant of a cycle's monodromy matrix shows where Neimark-Sacker bifurcations are impossible. Around a cycle the
cosines of exit angles do not telescope against those of incidence: with `phi = -lam*eta`

    det M = prod lam*cos(lam*eta)/cos(eta) = prod f(lam*eta)/f(eta),    f(x) = x*cos(x),

which is `lam**p` only when every bounce is along the normal, and larger otherwise. Since `f` grows up to the root of
`x*tan(x) = 1`, some 0.8603 or 49.3 degrees, a cycle whose incidence angles stay below it contracts areas for every
`lam < 1`: no Neimark-Sacker bifurcation. For larger angles a factor exceeds 1, and the product may exceed 1 too.

A polygon that turns by `2*pi*p/q` leaves at `gamma - delta` and lands at `gamma + delta` (`symbolic.cycles.polygons`),
with `gamma = pi/2 - pi*p/q`; near `lam = 1` it contracts areas exactly when `gamma*tan(gamma) < 1`. This holds for the
triangle (30 degrees) and the square (45), but not for the pentagon (54) and polygons of more sides, whose cycles expand
areas near `lam = 1`.
"""

from functools import lru_cache

from sympy import Expr, S, cos, factor, pi, sin, sqrt

from symbolic.cycles.cycle import Cycle, cuspless_horizontal, egg_diameter, shortened
from symbolic.cycles.polygons import half_turn
from symbolic.expressions.signs import Box, SignFinding, conjunction, nonnegative, positive, vanishes
from symbolic.motion.collision import derivative_matrix
from symbolic.tables.table import K0, K1, a, alpha, lam, t


@lru_cache(maxsize=256)
def stability_number(cycle: Cycle) -> Expr:
    """`P = (1 + t*K0)*(1 + t*K1)` of a cycle of period 2; it does not depend on the unit of length.

    >>> from symbolic.cycles.cycle import cuspless_horizontal, egg_diameter
    >>> stability_number(cuspless_horizontal())
    -11/16
    >>> stability_number(egg_diameter())
    (alpha**2 - 18*alpha - 1)*(alpha**2 + 18*alpha - 1)/((alpha - 1)**2*(alpha + 1)**2)
    """
    start, end = cycle.frames
    length = cycle.length(0)
    return factor(shortened((1 + length * start.curvature) * (1 + length * end.curvature)))


def general_trace_and_determinant() -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy of any double normal, from the derivative matrix.

    >>> from sympy import simplify
    >>> trace, det = general_trace_and_determinant()
    >>> simplify(trace - trace_of((1 + t * K0) * (1 + t * K1))), simplify(det)
    (0, lam**2)
    """
    there = derivative_matrix(K0, K1, t, S.One, S.One)
    back = derivative_matrix(K1, K0, t, S.One, S.One)
    monodromy = back * there
    return monodromy.trace(), monodromy.det()


def trace_of(P: Expr, contraction: Expr = lam) -> Expr:
    """The trace of the monodromy matrix of a double normal with stability number `P`.

    >>> trace_of(S.Zero)
    -2*lam
    """
    return (1 + contraction) ** 2 * P - 2 * contraction


def flip_contraction(P: Expr) -> Expr | None:
    """The contraction at which a multiplier is -1, for `-1 <= P < 0`; below it the cycle is stable.

    None for a number outside of this range, where no contraction in [0, 1] makes a multiplier -1.

    >>> from sympy import Rational
    >>> flip_contraction(Rational(-1, 4)), flip_contraction(Rational(361, 121))
    (1/3, None)
    """
    P = S(P)
    if P.is_number and (P.is_nonnegative or (P + 1).is_negative):
        return None
    r = sqrt(-P)
    return (1 - r) / (1 + r)


def focus_contraction(P: Expr) -> Expr | None:
    """The contraction above which the multipliers are complex, for `0 <= P <= 1`.

    None for a number outside of this range: then the multipliers are real at every contraction in [0, 1].

    >>> from sympy import Rational
    >>> focus_contraction(Rational(3, 4)), focus_contraction(S(25))
    (1/3, None)
    """
    P = S(P)
    if P.is_number and (P.is_negative or (P - 1).is_positive):
        return None
    r = sqrt(1 - P)
    return (1 - r) / (1 + r)


def stable_while_nonnegative(P: Expr, box: Box) -> SignFinding:
    """Is `0 <= P < 1` and `lam < 1` on the box, so that both multipliers are inside the unit circle?

    This is so because `1 - trace + det = (1+lam)**2*(1 - P)` and `1 + trace + det = (1+lam)**2*P + (1-lam)**2`.

    >>> from sympy import Interval
    >>> stable_while_nonnegative(S.Zero, {lam: Interval.Ropen(0, 1)}).outcome.name
    'PROVED'
    """
    return conjunction(positive(1 - P, box), nonnegative(P, box), positive(1 - lam, box))


def lambda_minus() -> Expr:
    """The contraction above which the ellipse's minor axis is a focus: `((w-1)/(w+1))**2`, `w = sqrt(a**2-1)`.

    With `P = ((a**2-2)/a**2)**2` of the minor axis, `1 - P = (2*w/a**2)**2`, and `(1-sqrt(1-P))/(1+sqrt(1-P))` is the
    square shown. This form is regular at `a = sqrt(2)`, where the paper's form is 0/0. `lambda_plus` is the reciprocal.

    >>> lambda_minus().subs(a, sqrt(2))
    0
    """
    w = sqrt(a**2 - 1)
    return ((w - 1) / (w + 1)) ** 2


def lambda_plus() -> Expr:
    """The other root of the paper's `P_2`, the reciprocal of `lambda_minus`: `((w+1)/(w-1))**2`, `w = sqrt(a**2-1)`."""
    return 1 / lambda_minus()


def lambda_c() -> Expr:
    """The contraction at which the cuspless cardioid's horizontal orbit doubles its period.

    >>> lambda_c()
    (1 - sqrt(11)/4)/(sqrt(11)/4 + 1)
    """
    found = flip_contraction(stability_number(cuspless_horizontal()))
    assert found is not None
    return found


@lru_cache(maxsize=64, typed=True)
def tilt(K: int | Expr = 3) -> Expr:
    """`W = 2*K**2*alpha/(1-alpha**2)`, which is `sqrt(1 - P)` on the diameters of an egg with odd K.

    >>> tilt(), tilt(5)
    (18*alpha/(1 - alpha**2), 50*alpha/(1 - alpha**2))
    """
    P = stability_number(egg_diameter(K))
    W = 2 * S(K) ** 2 * alpha / (1 - alpha**2)
    if not vanishes(1 - P - W**2):
        raise ValueError(f"egg: K = {K} is even; a vertex then faces a vertex and alpha-tilde does not exist")
    return W


def shape_of_tilt(W: Expr, K: int | Expr = 3) -> Expr:
    """The `alpha` in (0, 1) with `2*K**2*alpha/(1-alpha**2) = W`, without cancellation.

    >>> shape_of_tilt(S.One)
    1/(9 + sqrt(82))
    """
    return W / (S(K) ** 2 + sqrt(S(K) ** 4 + W**2))


def alpha_tilde(K: int | Expr = 3) -> Expr:
    """The shape at which the diameters of an egg with odd `K` double their period (`mu = -1`).

    There `P = -((1-lam)/(1+lam))**2`, so the `W` of `tilt` has `W**2 = 1 - P = 2*(1+lam**2)/(1+lam)**2`.

    >>> alpha_tilde().subs(lam, 1)
    2/(18 + 2*sqrt(82))
    """
    tilt(K)
    top = sqrt(2 * (1 + lam**2))
    return top / (S(K) ** 2 * (1 + lam) + sqrt(S(K) ** 4 * (1 + lam) ** 2 + top**2))


def alpha_hat(K: int | Expr = 3) -> Expr:
    """The shape above which the multipliers on the diameters of an egg with odd `K` are complex.

    There `P = 4*lam/(1+lam)**2`, so the `W` of `tilt` is `(1-lam)/(1+lam)`. The paper's form is 0/0 at `lam = 1`.

    >>> alpha_hat().subs(lam, 1)
    0
    """
    tilt(K)
    top = 1 - lam
    return top / (S(K) ** 2 * (1 + lam) + sqrt(S(K) ** 4 * (1 + lam) ** 2 + top**2))


def complex_up_to(K: int | Expr = 3) -> Expr:
    """The shape at which the stability number of an egg's diameters is 0 and above which multipliers are real again.

    >>> complex_up_to()
    1/(9 + sqrt(82))
    """
    return shape_of_tilt(S.One, K)


def even_stability_numbers(K: int | Expr) -> tuple[Expr, Expr]:
    """`P` on the diameters of an egg with even `K`: vertex to vertex, and flat to flat.

    Both are squares, so no diameter ever doubles its period. Vertex to vertex `P > 1` for every
    `alpha > 0`: unstable whatever the contraction. Flat to flat `P <= 1` over the whole convex range:
    stable for `lam < 1`, a focus where `P < 4*lam/(1+lam)**2`, with the double multiplier `-lam` where
    `alpha = 1/(1 + 2*K**2)` and `P = 0`.

    >>> even_stability_numbers(4)
    ((33*alpha + 1)**2/(alpha + 1)**2, (33*alpha - 1)**2/(alpha - 1)**2)
    """
    if S(K).is_odd:
        raise ValueError(f"egg: K = {K} is odd; its diameters run from a vertex to a flat point (see alpha_tilde)")
    return stability_number(egg_diameter(K)), stability_number(egg_diameter(K, pi / K))


def flux(x: Expr) -> Expr:
    """`f(x) = x*cos(x)`: a reflection multiplies areas by `f(lam*eta)/f(eta)`.

    >>> from sympy import simplify
    >>> from symbolic.motion.collision import area_factor
    >>> from symbolic.tables.table import eta
    >>> simplify(flux(lam * eta) / flux(eta) - area_factor())
    0
    """
    return x * cos(x)


def flux_slope(x: Expr) -> Expr:
    """`f'(x) = cos(x) - x*sin(x)`: positive where areas are sure to contract, zero where `x*tan(x) = 1`."""
    return cos(x) - x * sin(x)


def polygon_slope(p: int, q: int) -> Expr:
    """`f'(gamma)` of the polygon: positive when it contracts near `lam = 1`, negative when it expands.

    >>> bool(polygon_slope(1, 4) > 0), bool(polygon_slope(1, 5) < 0), bool(polygon_slope(2, 5) > 0)
    (True, True, True)
    """
    return flux_slope(half_turn(p, q))


def polygon_factor(delta: Expr, p: int, q: int) -> Expr:
    """`det M` of one bounce of a polygon whose normal is tilted by `delta`: `f(gamma - delta)/f(gamma + delta)`.

    >>> from sympy import S
    >>> polygon_factor(S.Zero, 1, 5)
    1
    """
    gamma = half_turn(p, q)
    return flux(gamma - delta) / flux(gamma + delta)
