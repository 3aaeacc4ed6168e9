"""The slap map of the cardioid, parametrised algebraically; so its expansion can be proved.

With `u = exp(i*theta)` the boundary is `z = (1 + u)**2/2`. The normal at `u` meets it again at `U`
where `U**3 + (2+u)*U**2 + u*(2*u+1)*U + u**2 = 0`, which is quadratic in `u` with the square root
of `1 + 7*cos(Theta/2)**2` in its solution. In the coordinate

    q = sin(theta/2)/sqrt(1 + 7*cos(theta/2)**2)        (odd, growing, -1 and 1 at the cusp)

of the landing point everything is rational. A ball that leaves the upper half, `0 < theta < pi`,
lands at each `-1 < q < 1/3` exactly once; the lower half is the mirror image. Paper: section 4.2,
which has the expansion from a plot.
"""

from functools import cache

from sympy import CRootOf, Expr, I, Interval, Poly, Rational, S, Symbol, cancel, expand, factor_list, sqrt, together

from symbolic.signs import Finding, Outcome, conjunction, positive

q = Symbol("q", real=True)  # the landing point
y = Symbol("y", real=True)  # q of the launching point, where both are needed
UPPER = Interval.open(-1, Rational(1, 3))  # landing points of the upper half

COS2 = (1 - q**2) / (1 + 7 * q**2)  # cos(Theta/2)**2 where the ball lands
LAUNCH_COS2 = (1 - 3 * q) ** 2 * (1 - q) / ((1 + 7 * q**2) * (3 - q))  # cos(theta/2)**2 where it left
LAUNCH_Q2 = (1 + q) ** 3 / (5 - 25 * q + 63 * q**2 - 35 * q**3)  # the launching point's own q, squared


def slope_squared(q: Expr = q) -> Expr:
    """`T0'(s)**2` as a function of the landing point `q`.

    >>> slope_squared(S.Zero)
    108/25
    """
    return 4 * (3 - q) ** 3 / ((1 - 3 * q) ** 2 * (1 + q) * (5 - 7 * q) ** 2)


def parametrised() -> Finding:
    """The landing at `q` from `LAUNCH_COS2` solves the flight equation, and `slope_squared` follows.

    The launching point is `u = -U*E*(cos - i*r)/(2*U + 1)` with `E = exp(i*Theta/2)`, `U = E**2`,
    `cos = cos(Theta/2)` and `r = sqrt(1 + 7*cos**2)`, so that `E = cos + i*q*r`.
    """
    u, U = Symbol("u"), Symbol("U")
    ray = (U - u) * (2 + u + U) * u**-3 - (1 / U - 1 / u) * (2 + 1 / u + 1 / U)  # Im((Z - z)/normal), scaled
    cubic = U**3 + (2 + u) * U**2 + u * (2 * u + 1) * U + u**2
    half, conjugate = _C + I * q * _R, _C - I * q * _R
    top, bottom = -(half**3) * (_C - I * _R), 2 * half**2 + 1
    solved = together(cubic.subs(u, top / bottom).subs(U, half**2)).as_numer_denom()[0]
    twice_real = top * (2 * conjugate**2 + 1) - conjugate**3 * (_C + I * _R) * bottom  # 2*Re(u)*|2*U + 1|**2
    ratio = (COS2.diff(q) / LAUNCH_COS2.diff(q)) ** 2 * (1 - LAUNCH_COS2) / (1 - COS2)
    facts = {
        "the flight equation is the cubic": ray * u**3 * U**2 - (U - u) * cubic,
        "the launching point solves it": _on_circle(solved),
        "its cos(theta/2)^2": _on_circle(twice_real) - 2 * (2 * LAUNCH_COS2 - 1) * (1 + 8 * COS2),
        "its q^2": LAUNCH_Q2 - (1 - LAUNCH_COS2) / (1 + 7 * LAUNCH_COS2),
        "T0'^2 = (ds1/ds0)^2 with s = 4*sin(theta/2)": slope_squared() - ratio,
    }
    return conjunction(*(Finding(_zero(expression), fact) for fact, expression in facts.items()))


_C, _R = Symbol("cos"), Symbol("r")


def _on_circle(expression: Expr) -> Expr:
    """`expression` with `cos**2` and `r**2` as functions of `q`; it must hold even powers only."""
    terms = Poly(expand(expression), _C, _R).terms()
    return cancel(sum(c * COS2 ** Rational(i, 2) * (8 / (1 + 7 * q**2)) ** Rational(j, 2) for (i, j), c in terms))


def _zero(expression: Expr) -> Outcome:
    return Outcome.PROVED if cancel(together(expression)) == 0 else Outcome.UNKNOWN


def forward_once() -> Finding:
    """The upper half launches to each `q` of `UPPER` exactly once.

    `cos(theta/2)**2` falls strictly from 1 to 0 on it, and the flight never has length 0 there: a
    landing at the launching point would need `4*u**2*(u + 1) = 0`, the cusp.

    >>> forward_once().outcome.name
    'PROVED'
    """
    falls = positive(-LAUNCH_COS2.diff(q), {q: UPPER})
    ends = _zero(LAUNCH_COS2.subs(q, -1) - 1), _zero(LAUNCH_COS2.subs(q, UPPER.end))
    return conjunction(falls, *(Finding(end, "cos(theta/2)^2 runs from 1 to 0") for end in ends))


def slow_region() -> tuple[Expr, Expr]:
    """The launching arc lengths `0 < s < s'` between which `T0' < 1`, one region on each half.

    >>> [value.n(6) for value in slow_region()]
    [0.0692582, 1.20379]
    """
    edges = Poly(expand(4 * (3 - q) ** 3 - (1 - 3 * q) ** 2 * (1 + q) * (5 - 7 * q) ** 2), q)
    inside = [root for root in edges.real_roots() if root > UPPER.start and root < UPPER.end]
    first, last = (4 * sqrt(1 - LAUNCH_COS2.subs(q, root)) for root in inside)
    return first, last


@cache
def expansion_polynomial(bound: Expr) -> Expr:
    """A polynomial in the final `q` without a root where `|(T0**2)'| = bound` nowhere on the table.

    The launching point of the last flight is `y = +-sqrt(LAUNCH_Q2)`; both signs are multiplied.
    """
    (top, bottom), (top_y, bottom_y) = slope_squared(q).as_numer_denom(), slope_squared(y).as_numer_denom()
    return _norm(top * top_y - bound**2 * bottom * bottom_y)


def expands_by(bound: Expr) -> Finding:
    """Is `|(T0**2)'| > bound` everywhere? Unbounded at the ends of each branch, it is if it nowhere equals it.

    >>> expands_by(Rational(3, 2)).outcome.name
    'PROVED'
    """
    polynomial = Poly(expansion_polynomial(bound), q).sqf_part()
    roots = polynomial.count_roots(UPPER.start, UPPER.end)
    if roots == 0:
        return Finding(Outcome.PROVED, f"Sturm: |(T0^2)'| = {bound} has no solution on either branch")
    return Finding(Outcome.UNKNOWN, f"|(T0^2)'| = {bound} has {roots} formal solution(s)")


@cache
def expansion_infimum() -> Expr:
    """The least value of `|(T0**2)'|`, an algebraic number; reached where the first flight crosses the axis.

    The logarithmic derivative along the branch that changes halves has one zero between two ends
    where the product is infinite.

    >>> expansion_infimum().n(12)
    1.50626223937
    """
    log_slope = -3 / (3 - q) + 6 / (1 - 3 * q) - 1 / (1 + q) + 14 / (5 - 7 * q)
    chained = log_slope + log_slope.subs(q, y) * LAUNCH_Q2.diff(q) / (2 * y)
    critical = _norm(together(chained).as_numer_denom()[0])
    candidates = []
    for factor, _ in factor_list(critical)[1]:
        for root in Poly(factor, q).real_roots():
            if isinstance(root, CRootOf) and root > UPPER.start and root < UPPER.end:
                back = -sqrt(LAUNCH_Q2.subs(q, root))
                if abs(chained.subs({q: root, y: back}).evalf(15)) < Rational(1, 10**6):
                    candidates.append(sqrt(slope_squared(root) * slope_squared(back)))
    (least,) = candidates
    return least


def _norm(expression: Expr) -> Expr:
    """The product of a polynomial in `q`, `y` over `y = +-sqrt(LAUNCH_Q2)`, without denominators."""
    top, bottom = LAUNCH_Q2.as_numer_denom()
    terms = Poly(expand(expression), y).terms()
    half = max(k for (k,), _ in terms) // 2
    even = sum((c * top ** (k // 2) * bottom ** (half - k // 2) for (k,), c in terms if k % 2 == 0), S.Zero)
    odd = sum((c * top ** (k // 2) * bottom ** (half - k // 2) for (k,), c in terms if k % 2 == 1), S.Zero)
    return expand(even**2 * bottom - odd**2 * top)
