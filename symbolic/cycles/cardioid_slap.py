"""The slap map `T0` of the cardioid, in two parametrisations that prove its expansion. Paper: section 4.2.

A landing at the polar angle `Theta` has the coordinate `q = sin(Theta/2)/sqrt(1 + 7*cos(Theta/2)**2)`; landings of
particles from the upper half have `q` in `UPPER`. As a function of `q`, the second iterate `T0**2` is algebraic and
expands; `y` is the coordinate of the point in between, where its last flight begins, so that `y**2 = LAUNCH_Q2(q)`. In
half angles `T0` itself expands: `b = Theta/2`, and `RATE` is one over the slope.
"""

from functools import cache

from sympy import Expr, I, Interval, Poly, Rational, S, Symbol, atan, cancel, cos, expand, pi, sin, sqrt, together

from symbolic.expressions.signs import Outcome, SignFinding, conjunction, nonnegative, positive, vanishes
from symbolic.expressions.text import Kernel, kernel

q = Symbol("q", real=True)  # the landing point: sin(Theta/2)/sqrt(1 + 7*cos(Theta/2)**2)
y = Symbol("y", real=True)  # q of the launching point, where both are needed
UPPER = Interval.open(-1, Rational(1, 3))  # landing points of the upper half

COS2 = (1 - q**2) / (1 + 7 * q**2)  # cos(Theta/2)**2 where the particle lands
LAUNCH_COS2 = (1 - 3 * q) ** 2 * (1 - q) / ((1 + 7 * q**2) * (3 - q))  # cos(theta/2)**2 where it left
LAUNCH_Q2 = (1 + q) ** 3 / (5 - 25 * q + 63 * q**2 - 35 * q**3)  # the launching point's own q, squared


def slope_squared(q: Expr = q) -> Expr:
    """`T0'(s)**2` as a function of the landing point `q`.

    >>> slope_squared(Rational(0))
    108/25
    """
    return 4 * (3 - q) ** 3 / ((1 - 3 * q) ** 2 * (1 + q) * (5 - 7 * q) ** 2)


def parametrised() -> SignFinding:
    """Is it proved that a launch with `cos(theta/2)**2 = LAUNCH_COS2` lands at `q`, with `T0'**2 = slope_squared(q)`?

    Let `theta` and `Theta` be the polar angles of launch and landing, `u = exp(i*theta)` and `U = exp(i*Theta)`. With
    `cos = cos(Theta/2)`, `r = sqrt(1 + 7*cos**2)` and `E = exp(i*Theta/2) = cos + i*q*r` the launch is at
    `u = -U*E*(cos - i*r)/(2*U + 1)`.
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
    return conjunction(*(SignFinding(_zero(expression), fact) for fact, expression in facts.items()))


_C, _R = Symbol("cos"), Symbol("r")


def _on_circle(expression: Expr) -> Expr:
    """`expression`, a polynomial with even powers of `cos` and `r` only, as a function of `q`."""
    terms = Poly(expand(expression), _C, _R).terms()
    return sum((c * COS2 ** Rational(i, 2) * (8 / (1 + 7 * q**2)) ** Rational(j, 2) for (i, j), c in terms), S.Zero)


def _zero(expression: Expr) -> Outcome:
    return Outcome.PROVED if vanishes(expression) else Outcome.UNKNOWN


def forward_once() -> SignFinding:
    """Is it proved that exactly one launch from the upper half lands at each `q` of `UPPER`?

    On `UPPER`, `cos(theta/2)**2` falls strictly from 1 to 0, and no flight has length 0: a landing at the launching
    point would need `4*u**2*(u + 1) = 0`, which holds at the cusp only.

    >>> forward_once().outcome.name
    'PROVED'
    """
    falls = positive(-LAUNCH_COS2.diff(q), {q: UPPER})
    ends = _zero(LAUNCH_COS2.subs(q, -1) - 1), _zero(LAUNCH_COS2.subs(q, UPPER.end))
    return conjunction(falls, *(SignFinding(end, "cos(theta/2)^2 runs from 1 to 0") for end in ends))


def slow_region() -> tuple[Expr, Expr]:
    """Both ends `0 < s < s'` of the arc on which `T0' < 1` at the launch; its mirror image is another such arc.

    >>> [value.n(6) for value in slow_region()]
    [0.0692582, 1.20379]
    """
    edges = Poly(expand(4 * (3 - q) ** 3 - (1 - 3 * q) ** 2 * (1 + q) * (5 - 7 * q) ** 2), q)
    inside = [root for root in edges.real_roots() if root > UPPER.start and root < UPPER.end]
    first, last = (4 * sqrt(1 - LAUNCH_COS2.subs(q, root)) for root in inside)
    return first, last


def _expanding_by(bound: Expr) -> Expr:
    """A polynomial in `q` and `y` (see the module) that vanishes where `|(T0**2)'| = bound`."""
    (top, bottom), (top_y, bottom_y) = slope_squared(q).as_numer_denom(), slope_squared(y).as_numer_denom()
    return top * top_y - bound**2 * bottom * bottom_y


def _critical() -> Expr:
    """A polynomial in `q` and `y` (see the module) that vanishes where `(T0**2)'' = 0` on a branch of `T0**2`."""
    log_slope = cancel(slope_squared().diff(q) / slope_squared())
    chained = log_slope + log_slope.subs(q, y) * LAUNCH_Q2.diff(q) / (2 * y)
    return together(chained).as_numer_denom()[0]


@cache
def expansion_polynomial(bound: Expr) -> Expr:
    """A polynomial in the final `q`: if it has no root, `|(T0**2)'|` equals `bound` nowhere on the table.

    The launching point of the last flight is `y = +-sqrt(LAUNCH_Q2)`; the polynomial is the product over both signs.
    """
    return _norm(*_split(_expanding_by(bound))).as_expr()


def expands_by(bound: Expr) -> SignFinding:
    """Is `|(T0**2)'| > bound` everywhere? As `|(T0**2)'|` is infinite at the ends of each branch, it suffices that it
    never equals `bound`.

    >>> expands_by(Rational(3, 2)).outcome.name
    'PROVED'
    """
    polynomial = Poly(expansion_polynomial(bound), q).sqf_part()
    roots = polynomial.count_roots(UPPER.start, UPPER.end)
    if roots == 0:
        return conjunction(
            unbounded(), SignFinding(Outcome.PROVED, f"Sturm: |(T0^2)'| = {bound} has no solution on either branch")
        )
    return SignFinding(Outcome.UNKNOWN, f"|(T0^2)'| = {bound} has {roots} formal solution(s)")


def unbounded() -> SignFinding:
    """Is `|(T0**2)'|` infinite at the ends of both branches of `T0**2`?

    On one branch `y` runs from 0 to -1 as `q` runs from -1 to 1/3; on the other `y` runs from 0 to 1/3, and `q` from
    -1.

    >>> unbounded().outcome.name
    'PROVED'
    """
    inverse = cancel(1 / slope_squared())
    ends = [inverse.subs(q, end) for end in (UPPER.start, UPPER.end)] + [
        LAUNCH_Q2.subs(q, -1),
        LAUNCH_Q2.subs(q, UPPER.end) - 1,
    ]
    whole = conjunction(
        positive(inverse, {q: UPPER}), *(SignFinding(_zero(end), "T0' is infinite at the ends") for end in ends)
    )
    return SignFinding(whole.outcome, "(T0^2)' is infinite at the ends of its branches") if whole else whole


@cache
def expansion_infimum() -> Expr:
    """The least value of `|(T0**2)'|`, an algebraic number, attained on the branch whose first flight crosses the axis.

    `infimum_attained` proves that it is the least.

    >>> expansion_infimum().n(12)
    1.50626223937
    """
    critical = _critical()
    ((low, high),) = [ends for ends, side in zeros(critical) if side < 0]
    (root,) = [r for r in _norm(*_split(critical)).real_roots() if r >= low and r <= high]
    return sqrt(slope_squared(root) * slope_squared(-sqrt(LAUNCH_Q2.subs(q, root))))


@cache
def infimum_attained() -> SignFinding:
    """Is `expansion_infimum` the least value of `|(T0**2)'|` on the table? This is decided exactly, by counting roots.

    On the branch that changes halves, `y < 0`, `|(T0**2)'|` is infinite at both ends and has one critical point, its
    minimum. On this branch it takes the value `ABOVE` twice, so the minimum is smaller. On the other branch it is
    infinite at both ends too and never takes this value, so it is larger than `ABOVE` everywhere.

    >>> infimum_attained().outcome.name
    'PROVED'
    """
    critical = [side for _, side in zeros(_critical())]
    level = [side for _, side in zeros(_expanding_by(ABOVE))]
    if not unbounded() or critical.count(-1) != 1 or sorted(level) != [-1, -1]:
        said = f"critical points {critical}, solutions of |(T0^2)'| = {ABOVE} {level} by the sign of y"
        return SignFinding(Outcome.UNKNOWN, said)
    said = f"Sturm: (T0^2)' has one critical point on the branch that changes halves, and is {ABOVE} twice, there alone"
    return SignFinding(Outcome.PROVED, said)


@cache
def fixed_points() -> list[tuple[Expr, Expr]]:
    """Bounds on the last landing point `q` of each fixed point of `T0**2`, for one of each mirror pair.

    An orbit goes from the coordinate `x > 0` to `y` and back. For `y < 0` the second flight is mirrored and lands at
    `q = -x`, else at `q = x`. So `LAUNCH_Q2(y) = q**2`, where `q` has the sign of `y`. There is one pair, the vertical
    orbit.

    >>> fixed_points()
    [(-1/5, -1/5)]
    """
    found = zeros(together(LAUNCH_Q2.subs(q, y) - q**2).as_numer_denom()[0])
    return [ends for ends, side in found if sum(ends) * side > 0]


ABOVE = Rational(151, 100)  # between the least values of (T0**2)' on its two branches, 1.506... and 1.890...


def zeros(expression: Expr) -> list[tuple[tuple[Expr, Expr], int]]:
    """Zeros over `UPPER` of a polynomial in `q` and `y`, where `y**2 = LAUNCH_Q2`: bounds on `q`, and the sign of `y`.

    The polynomial is `even + y*odd`. A zero of its norm belongs to the `y` that has the sign of `-even*odd`; a common
    zero of `even` and `odd` belongs to both signs. Points with `y >= 1/3`, where no particle that leaves the upper half
    lands, are left out.

    >>> zeros(q + y)  # LAUNCH_Q2 is 1/25 at q = -1/5
    [((-1/5, -1/5), 1)]
    """
    even, odd = _split(expression)
    common = even.gcd(odd)
    even, odd = even.quo(common), odd.quo(common)
    edge = Poly(together(LAUNCH_Q2 - UPPER.end**2).as_numer_denom()[0], q)  # y = 1/3
    found = []
    for low, high in _isolated(_norm(even, odd), (even, odd, edge)):
        middle = (low + high) / 2
        found.append(((low, high), 1 if even.eval(middle) * odd.eval(middle) < 0 else -1))
    found += [(ends, side) for ends in _isolated(common, (edge,)) for side in (-1, 1)]
    return [(ends, side) for ends, side in found if side < 0 or LAUNCH_Q2.subs(q, sum(ends) / 2) < UPPER.end**2]


def _isolated(polynomial: Poly, others: tuple[Poly, ...]) -> list[tuple[Expr, Expr]]:
    """Intervals in `UPPER`, each with one root of `polynomial` and none of the `others`.

    Roots at the ends of `UPPER`, and those that are also roots of the last of the `others`, are left out.
    """
    squarefree = polynomial.sqf_part()
    for known in (Poly(q - UPPER.start, q), Poly(q - UPPER.end, q), others[-1]):
        squarefree = squarefree.quo(squarefree.gcd(known))
    found = []
    for (low, high), _ in squarefree.intervals(inf=UPPER.start, sup=UPPER.end):
        while any(other.count_roots(low, high) for other in others):
            low, high = squarefree.refine_root(low, high, steps=4)
        found.append((low, high))
    return found


def _split(expression: Expr) -> tuple[Poly, Poly]:
    """Polynomials `even` and `odd` in `q` such that `expression` is `even + y*odd` over a power of a denominator."""
    top, bottom = (Poly(part, q) for part in LAUNCH_Q2.as_numer_denom())
    terms = Poly(expression, y).terms()
    half = max(k for (k,), _ in terms) // 2
    parts = [Poly(0, q), Poly(0, q)]
    for (k,), coefficient in terms:
        parts[k % 2] += Poly(coefficient, q) * top ** (k // 2) * bottom ** (half - k // 2)
    return parts[0], parts[1]


def _norm(even: Poly, odd: Poly) -> Poly:
    """The product of `even + y*odd` over `y = +-sqrt(LAUNCH_Q2)`, without denominators."""
    top, bottom = (Poly(part, q) for part in LAUNCH_Q2.as_numer_denom())
    return even**2 * bottom - odd**2 * top


b = Symbol("b", real=True)  # half the landing angle, negative on the lower half
RATE = (1 + q) * (5 - 7 * q) / (2 * (3 - q))  # one over the slope
LAUNCH_TAN2 = 2 * (1 + q) ** 3 / ((1 - 3 * q) ** 2 * (1 - q))  # tan(theta/2)**2 where the particle left
SPEED2 = (1 + 7 * q**2) ** 2 * (1 - q**2) / 8  # (dq/db)**2
CUSP = Rational(-69, 100)  # landings below it are near the cusp
SHRINKS = Rational(835, 1000)
STEEP = Rational(31, 10)


def derived() -> SignFinding:
    """Do `RATE`, `LAUNCH_TAN2` and `SPEED2` follow from `slope_squared`, `LAUNCH_COS2` and `COS2`?

    Arc length is `s = 4*sin(theta/2)`, so the slope in half angles is `T0'(s)*cos(theta/2)/cos(b)`.

    >>> derived().outcome.name
    'PROVED'
    """
    sin2 = 1 - COS2
    facts = {
        "the slope squared": RATE**2 * slope_squared() * LAUNCH_COS2 / COS2 - 1,
        "the launching point": LAUNCH_TAN2 * LAUNCH_COS2 - (1 - LAUNCH_COS2),
        "q^2 of the half angle": q**2 * (1 + 7 * COS2) - sin2,
        "its speed: d(sin(b)^2)/dq = 2*sin(b)*cos(b)*db/dq": sin2.diff(q) ** 2 * SPEED2 - 4 * sin2 * COS2,
    }
    zero = {fact: _zero(e) for fact, e in facts.items()}
    return conjunction(*(SignFinding(outcome, fact) for fact, outcome in zero.items()))


def lands_first() -> SignFinding:
    """Is the landing at `q < 1/3` the only point ahead of an upper launch where its normal meets the boundary?

    The flight equation is quadratic in `u`, so two launches have the landing `q`: `u(q)` and, mirrored, `u(-q)`. The
    launch `u(q)` is continuous for `-1 < q < 1`; it lies in the upper half for `q < 1/3` and in the lower half for
    `q > 1/3`. Take the length of its flight along `-exp(3*I*theta/2)`. It is 0 nowhere, as then the flight would end
    where it began, which is possible only at the cusp, where no `q` between -1 and 1 lands. It is positive at `q = 0`,
    and so everywhere. The direction points inward in the upper half and outward in the lower one. So for a launch in
    the lower half the landing lies behind it.

    >>> lands_first().outcome.name
    'PROVED'
    """
    u, cosine = Symbol("u"), sqrt(LAUNCH_COS2.subs(q, 0))
    cubic = u**3 + (2 + u) * u**2 + u * (2 * u + 1) * u + u**2  # the flight equation where it ends as it began
    facts = {
        "only the cusp lands on itself": expand(cubic - 4 * u**2 * (u + 1)) == 0,
        "the landing at q = 0 is theta = 0": COS2.subs(q, 0) == 1,
        "ahead there": bool(flown(cosine) > 0),
    }
    found = [SignFinding(Outcome.PROVED if true else Outcome.UNKNOWN, fact) for fact, true in facts.items()]
    return conjunction(positive(COS2, {q: Interval.open(-1, 1)}), *found)


def flown(cosine: Expr) -> Expr:
    """The distance to `z = 2` along the normal `-exp(3*I*theta/2)`, from the launch with `cos(theta/2) = cosine`.

    >>> flown(Rational(1, 2))  # from theta = 2*pi/3, at x = -1/4, where the normal is the x axis
    9/4
    """
    return 2 * cosine**3 - 2 * (4 * cosine**3 - 3 * cosine)


def expands() -> SignFinding:
    """Is `0 < RATE < SHRINKS` at every landing? One bounce then expands half angles by more than 1.197.

    >>> expands().outcome.name
    'PROVED'
    """
    return conjunction(positive(RATE, {q: UPPER}), positive(SHRINKS - RATE, {q: Interval(-1, UPPER.end)}))


def quiet_near_the_cusp() -> SignFinding:
    """Does `RATE` grow, as `q` runs from the cusp to `CUSP`, from 0 to less than `SHRINKS/2`?

    >>> quiet_near_the_cusp().outcome.name
    'PROVED'
    """
    near = {q: Interval(-1, CUSP)}
    grows = positive(RATE.diff(q), near)
    return conjunction(grows, nonnegative(SHRINKS / 2 - RATE, near), SignFinding(_zero_at_cusp(), "0 at the cusp"))


def _zero_at_cusp() -> Outcome:
    return Outcome.PROVED if RATE.subs(q, -1) == 0 else Outcome.UNKNOWN


def gentle_elsewhere() -> SignFinding:
    """Is `abs(d log(RATE)/db) < STEEP` for all landings from `q = CUSP` on?

    >>> gentle_elsewhere().outcome.name
    'PROVED'
    """
    return positive(STEEP**2 - (RATE.diff(q) / RATE) ** 2 * SPEED2, {q: Interval(CUSP, UPPER.end)})


@cache
def branch(above: bool) -> Kernel:
    """The generated function `(launch, rate)` of the landing half angle `b`, without cancellation at the cusp.

    `launch` is the half angle of the launch, and `rate` its derivative by `b`. `launch` is `atan(sqrt(LAUNCH_TAN2))`,
    for `b < pi/4`, or if `above` is true `pi/2 - atan(1/sqrt(LAUNCH_TAN2))`, for `b > -pi/2`.

    >>> branch(False).results
    ('launch', 'rate')
    """
    r, landing = sqrt(1 + 7 * cos(b) ** 2), _landing()
    tangent = 32 * cos(b) ** 3 / (r**3 * (1 - landing) ** 2 * (1 - 3 * landing))  # 1 + q is 8*cos(b)**2/(r**2*(1 - q))
    rate = 4 * cos(b) ** 2 * (5 - 7 * landing) / (r**2 * (1 - landing) * (3 - landing))
    values = {"launch": pi / 2 - atan(1 / tangent) if above else atan(tangent), "rate": rate}
    return kernel("branch", [b], values, about="Where a particle that lands at half angle b left, and db0/db.")


def near_launch() -> Expr:
    """The half angle of the launch that lands at `q = CUSP`.

    >>> near_launch().n(6)
    0.0610851
    """
    return atan(sqrt(LAUNCH_TAN2.subs(q, CUSP)))


def _landing() -> Expr:
    return sin(b) / sqrt(1 + 7 * cos(b) ** 2)
