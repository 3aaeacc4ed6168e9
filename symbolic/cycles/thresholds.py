"""The closed thresholds of the paper, derived from the stability numbers of its period-2 cycles.

Each is written so that no digit cancels and nothing is 0/0 in the paper's range. Paper: eqs. for
lambda_+-(a) (section 3.3), lambda_c (5.1), alpha-tilde and alpha-hat (6.3).
"""

from sympy import Expr, S, pi, simplify, sqrt

from symbolic.cycles.double_normal import flip_contraction, stability_number
from symbolic.cycles.named import cuspless_horizontal, egg_diameter
from symbolic.tables.symbols import a, alpha, lam


def lambda_minus() -> Expr:
    """The contraction above which the ellipse's minor axis is a focus: `((w-1)/(w+1))**2`, `w = sqrt(a**2-1)`.

    With `P = ((a**2-2)/a**2)**2` of the minor axis, `1 - P = (2*w/a**2)**2`, and
    `(1-sqrt(1-P))/(1+sqrt(1-P))` is the square shown. Regular at `a = sqrt(2)`, where the paper's
    form is 0/0. `lambda_plus` is its inverse.

    >>> lambda_minus().subs(a, sqrt(2))
    0
    """
    w = sqrt(a**2 - 1)
    return ((w - 1) / (w + 1)) ** 2


def lambda_plus() -> Expr:
    """The other root of `P_2`: `((w+1)/(w-1))**2` with `w = sqrt(a**2-1)`, never below 1."""
    return 1 / lambda_minus()


def lambda_c() -> Expr:
    """The period doubling of the cuspless cardioid's horizontal orbit.

    >>> lambda_c()
    (1 - sqrt(11)/4)/(sqrt(11)/4 + 1)
    """
    return flip_contraction(stability_number(cuspless_horizontal()))


def tilt(K: int | Expr = 3) -> Expr:
    """`W = 2*K**2*alpha/(1-alpha**2)`, which is `sqrt(1 - P)` on the diameters of an egg with odd K.

    >>> tilt(), tilt(5)
    (18*alpha/(1 - alpha**2), 50*alpha/(1 - alpha**2))
    """
    P = stability_number(egg_diameter(K))
    W = 2 * S(K) ** 2 * alpha / (1 - alpha**2)
    if simplify(1 - P - W**2) != 0:
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

    `P = -((1-lam)/(1+lam))**2`, so `W**2 = 1 - P = 2*(1+lam**2)/(1+lam)**2`.

    >>> alpha_tilde().subs(lam, 1)
    2/(18 + 2*sqrt(82))
    """
    tilt(K)
    top = sqrt(2 * (1 + lam**2))
    return top / (S(K) ** 2 * (1 + lam) + sqrt(S(K) ** 4 * (1 + lam) ** 2 + top**2))


def alpha_hat(K: int | Expr = 3) -> Expr:
    """The shape above which the multipliers on the diameters of an egg with odd `K` are complex.

    `P = 4*lam/(1+lam)**2`, so `W = (1-lam)/(1+lam)`. The paper's form is 0/0 at `lam = 1`.

    >>> alpha_hat().subs(lam, 1)
    0
    """
    tilt(K)
    top = 1 - lam
    return top / (S(K) ** 2 * (1 + lam) + sqrt(S(K) ** 4 * (1 + lam) ** 2 + top**2))


def complex_up_to(K: int | Expr = 3) -> Expr:
    """The shape at which `P` vanishes and the complex region ends: `alpha-tilde(1)`.

    >>> complex_up_to()
    1/(9 + sqrt(82))
    """
    return shape_of_tilt(S.One, K)


def even_stability_numbers(K: int | Expr) -> tuple[Expr, Expr]:
    """`P` on the diameters of an egg with even `K`: vertex to vertex, and flat to flat.

    Both are squares, so no diameter ever doubles its period. Vertex to vertex `P > 1` for every
    `alpha > 0`: unstable whatever the contraction. Flat to flat `P <= 1` over the whole convex range:
    stable for `lam < 1`, a focus where `P < 4*lam/(1+lam)**2`, superstable in direction where
    `alpha = 1/(1 + 2*K**2)` and `P = 0`.

    >>> even_stability_numbers(4)
    ((33*alpha + 1)**2/(alpha + 1)**2, (33*alpha - 1)**2/(alpha - 1)**2)
    """
    if S(K).is_odd:
        raise ValueError(f"egg: K = {K} is odd; its diameters run from a vertex to a flat point (see alpha_tilde)")
    return stability_number(egg_diameter(K)), stability_number(egg_diameter(K, pi / K))
