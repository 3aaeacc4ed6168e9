"""Exact cycles: periodic orbits given by their boundary points, with monodromy matrices and multipliers.

Only the points are given, since exit and incidence angles follow from the chords that meet at a point. Paper: end of
section 2.1. Trace and determinant of the monodromy matrix show where the multipliers lie, without extracting roots: the
characteristic polynomial is `mu**2 - trace*mu + det`, and by Jury's criterion its values at 1 and -1 and the size of
`det` suffice. The cycles that the paper names or implies are at the end of this module.
"""

from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache

from sympy import (
    Expr,
    Function,
    Integer,
    Interval,
    Matrix,
    NumberSymbol,
    Pow,
    Rational,
    S,
    Symbol,
    acos,
    cancel,
    expand,
    expand_trig,
    eye,
    factor,
    pi,
    prod,
    simplify,
    solve,
    sqrt,
    symbols,
)

from symbolic.expressions.identities import over_one_root
from symbolic.expressions.signs import Box, SignFinding, conjunction, positive, vanishes
from symbolic.motion.collision import derivative_matrix, determinant
from symbolic.tables import cardioid, circle, cuspless, egg, ellipse
from symbolic.tables.table import Table, alpha, cos_eta1, cos_phi0, exact_number, lam, theta
from symbolic.tables.validity import parameter_box, root


@dataclass(frozen=True)
class Frame:
    """A boundary point with its unit tangent, inward normal and signed curvature."""

    point: Matrix
    tangent: Matrix
    normal: Matrix
    curvature: Expr


@dataclass(frozen=True, repr=False)
class Cycle:
    """A periodic orbit by its bounces, each a component's index and a boundary parameter.

    `box` holds the ranges of further parameters that `table` and the bounces may depend on.

    >>> from symbolic.tables import polar
    >>> Cycle("diameter", polar("2"), ((0, S.Zero), (0, pi)))
    Cycle('diameter', polar('2'), ((0, 0), (0, pi)))
    """

    name: str
    table: Table
    bounces: tuple[tuple[int, Expr], ...]
    box: tuple[tuple[Expr, Expr], ...] = ()

    @cached_property
    def ranges(self) -> Box:
        """The ranges of all parameters of the cycle."""
        return parameter_box(self.table) | dict(self.box)

    @cached_property
    def frames(self) -> tuple[Frame, ...]:
        """The frame at each bounce."""
        return tuple(frame(self.table, index, value, self.ranges) for index, value in self.bounces)

    @cache  # noqa: B019  (a cycle is frozen)
    def chord(self, i: int) -> Matrix:
        """The vector from bounce `i` to the next."""
        n = len(self.bounces)
        return (self.frames[(i + 1) % n].point - self.frames[i % n].point).applyfunc(shortened).as_immutable()

    @cache  # noqa: B019  (a cycle is frozen)
    def length(self, i: int) -> Expr:
        """The length of the flight that leaves bounce `i`."""
        chord = self.chord(i)
        return root(shortened(chord.dot(chord)), self.ranges)

    @cache  # noqa: B019  (a cycle is frozen)
    def cos_exit(self, i: int) -> Expr:
        """The cosine of the exit angle at bounce `i`."""
        return shortened(self.chord(i).dot(self.frames[i % len(self.bounces)].normal) / self.length(i))

    @cache  # noqa: B019  (a cycle is frozen)
    def cos_incidence(self, i: int) -> Expr:
        """The cosine of the incidence angle at bounce `i`."""
        return shortened(-self.chord(i - 1).dot(self.frames[i % len(self.bounces)].normal) / self.length(i - 1))

    @cache  # noqa: B019  (a cycle is frozen)
    def sliding(self, i: int) -> tuple[Expr, Expr]:
        """The sine of the exit angle, and minus the sine of the incidence angle, at bounce `i`."""
        tangent = self.frames[i % len(self.bounces)].tangent
        leaving = self.chord(i).dot(tangent) / self.length(i)
        arriving = self.chord(i - 1).dot(tangent) / self.length(i - 1)
        return shortened(leaving), shortened(arriving)

    def __repr__(self) -> str:
        return f"Cycle({self.name!r}, {self.table!r}, {self.bounces})"

    def _repr_latex_(self) -> str:
        from symbolic.tables.formula import equation  # needed in notebooks only

        return equation(rf"\text{{{self.table.name}, {self.name}:}}\quad D T^{{{len(self.bounces)}}}", monodromy(self))


def frame(table: Table, index: int, value: Expr, box: Box) -> Frame:
    """The frame of a table at parameter `value` of component `index`.

    >>> from symbolic.tables import cardioid
    >>> from sympy import S
    >>> frame(cardioid, 0, S.Zero, {}).curvature
    -3/4
    """
    path = table.components[index].point
    point, first, second = (
        Matrix([expand_trig(coordinate.diff(theta, order).subs(theta, value)) for coordinate in path])
        for order in (0, 1, 2)
    )
    first, second = first.applyfunc(shortened), second.applyfunc(shortened)
    speed = root(shortened(first.dot(first)), box)
    turning = shortened(first[0] * second[1] - first[1] * second[0])
    tangent = (first / speed).applyfunc(shortened)
    normal = Matrix([-tangent[1], tangent[0]])
    return Frame(point, tangent, normal, shortened(-turning / speed**3))


def shortened(expression: Expr) -> Expr:
    """The expression, simplified; if it is rational in symbols and at most one square root, only by cancellation.

    >>> shortened((alpha**2 - 1) / (alpha - 1)), shortened((alpha**2 - 3) / (alpha - sqrt(3)))
    (alpha + 1, alpha + sqrt(3))
    """
    rational = not expression.atoms(Function, NumberSymbol) and all(p.exp.is_Integer for p in expression.atoms(Pow))
    if rational:
        return cancel(expression)
    found = over_one_root(expression)
    return simplify(expression) if found is None else found


@cache
def is_double_normal(cycle: Cycle) -> bool:
    """True when it is proved that every chord is normal to the boundary at both its ends.

    Such a cycle exists for every contraction: exit and incidence angles all vanish.

    >>> from symbolic.cycles.cycle import minor_axis
    >>> is_double_normal(minor_axis())
    True
    """
    return all(vanishes(part) for i in range(len(cycle.bounces)) for part in cycle.sliding(i))


@cache
def is_elastic(cycle: Cycle) -> bool:
    """True if it is proved that the cycle obeys the elastic law `phi = -eta` at each bounce."""
    return all(vanishes(out - back) for out, back in (cycle.sliding(i) for i in range(len(cycle.bounces))))


def flight_matrix(cycle: Cycle, i: int, contraction: Expr = lam) -> Matrix:
    """The derivative matrix of the flight that leaves bounce `i`, with the reflection at its end."""
    start, end = cycle.frames[i % len(cycle.bounces)], cycle.frames[(i + 1) % len(cycle.bounces)]
    return derivative_matrix(
        K0=start.curvature,
        K1=end.curvature,
        t=cycle.length(i),
        cos_phi0=cycle.cos_exit(i),
        cos_eta1=cycle.cos_incidence(i + 1),
        lam=contraction,
    )


def given_cycle(label: str, cycle: Cycle) -> Cycle:
    """`cycle`, if it is a `Cycle`; otherwise raises `ValueError`, with a text that begins with `label`."""
    if not isinstance(cycle, Cycle):
        raise ValueError(
            f"{label}: {repr(cycle)[:80]} is no exact cycle; accepted: a Cycle, such as one of double_normals(table)"
        )
    return cycle


def monodromy(cycle: Cycle, base: int = 0, contraction: Expr | int | str = lam) -> Matrix:
    """The stability matrix of the cycle at bounce `base`: the product over one period.

    The trace and the determinant do not depend on `base`; the entries do. `contraction` is an exact number, such as
    `"1/2"`, or an expression; a float is refused.

    >>> from symbolic.cycles.cycle import minor_axis
    >>> monodromy(minor_axis()).det().simplify()
    lam**2
    """
    slope = contraction if isinstance(contraction, Symbol) else exact_number("contraction", contraction)
    return Matrix(_monodromy(given_cycle("monodromy", cycle), base, slope))


@lru_cache(maxsize=256)
def _monodromy(cycle: Cycle, base: int, contraction: Expr) -> Matrix:
    """The stability matrix of `monodromy`, cached, as an immutable matrix."""
    product = eye(2)
    for i in range(base, base + len(cycle.bounces)):
        product = flight_matrix(cycle, i, contraction) * product
    return product.applyfunc(_factored).as_immutable()


def _factored(expression: Expr) -> Expr:
    """The expression, factored; first written over one square root if it has one, since `factor` is slow there."""
    found = over_one_root(expression)
    return factor(expression if found is None else found)


@lru_cache(maxsize=256)
def trace_and_determinant(cycle: Cycle, contraction: Expr = lam) -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy matrix, the latter as the product over the flights."""
    area = prod(
        determinant(contraction).subs({cos_phi0: cycle.cos_exit(i), cos_eta1: cycle.cos_incidence(i + 1)})
        for i in range(len(cycle.bounces))
    )
    return shortened(monodromy(cycle, 0, contraction).trace()), shortened(area)


def discriminant(trace: Expr, det: Expr) -> Expr:
    """`trace**2 - 4*det`: negative where the multipliers are complex conjugates."""
    return factor(trace**2 - 4 * det)


def multipliers(trace: Expr, det: Expr) -> tuple[Expr, Expr]:
    """`(mu_plus, mu_minus)`, the eigenvalues of a monodromy matrix.

    >>> from sympy import S
    >>> multipliers(S(3), S(2))
    (2, 1)
    """
    half = sqrt(discriminant(trace, det)) / 2
    return trace / 2 + half, trace / 2 - half


def saddle(trace: Expr, det: Expr, box: Box) -> SignFinding:
    """Is `0 < mu_minus < 1 < mu_plus` everywhere in the box?

    >>> from sympy import Rational, S
    >>> saddle(S(3), S(1), {}).outcome.name
    'PROVED'
    """
    return conjunction(positive(trace - 1 - det, box), positive(det, box))


@cache
def contracting_norm() -> SignFinding:
    """Is there, for every attracting monodromy matrix, a quadratic norm in which it contracts?

    For the companion matrix `M` of any trace and determinant inside Jury's triangle, `N - M.T*N*M = 1` has a positive
    definite solution `N`. A matrix that is no multiple of the identity is similar to its companion matrix, and a
    multiple contracts in any norm. By continuity of `DT`, the map contracts near an attracting cycle too.

    >>> contracting_norm().outcome.name
    'PROVED'
    """
    det, share = symbols("det share", real=True)  # trace = share*(1 + det)
    inside = {det: Interval.open(-1, 1), share: Interval.open(-1, 1)}
    first, mixed, last = symbols("first mixed last")
    companion, norm = Matrix([[0, 1], [-det, share * (1 + det)]]), Matrix([[first, mixed], [mixed, last]])
    (found,) = solve(list(norm - companion.T * norm * companion - eye(2)), [first, mixed, last], dict=True)
    solution = norm.subs(found)
    return conjunction(positive(solution[0, 0], inside), positive(solution.det().factor(), inside))


c = Symbol("c", real=True)  # cos(theta) of a bounce of the egg's orbit between parallel tangents


@cache
def diameter() -> Cycle:
    """A diameter of the circle. Paper: section 3.1."""
    return Cycle("diameter", circle, ((0, S.Zero), (0, pi)))


@cache
def major_axis() -> Cycle:
    """The long axis of the ellipse. Paper: section 3.2."""
    return Cycle("major axis", ellipse, ((0, S.Zero), (0, pi)))


@cache
def minor_axis() -> Cycle:
    """The short axis of the ellipse. Paper: section 3.2."""
    return Cycle("minor axis", ellipse, ((0, pi / 2), (0, -pi / 2)))


@cache
def cardioid_vertical() -> Cycle:
    """The chord from `s = 2` to `s = -2`. Paper: section 4, caption of the slap map."""
    return Cycle("vertical", cardioid, ((0, pi / 3), (0, -pi / 3)))


@cache
def cuspless_vertical() -> Cycle:
    """The chord of `cardioid_vertical` in the cuspless cardioid. Paper: section 5."""
    return Cycle("vertical", cuspless, ((0, pi / 3), (0, -pi / 3)))


@cache
def cuspless_horizontal() -> Cycle:
    """The orbit along `y = 0`, from the wall's centre to the rightmost point. Paper: section 5.1."""
    return Cycle("horizontal", cuspless, ((1, S.Zero), (0, S.Zero)))


@lru_cache(maxsize=64, typed=True)
def egg_diameter(K: int | Expr = 3, angle: Expr = S.Zero) -> Cycle:
    """The chord of the egg from `angle` through the centre: vertex to flat for odd K. Paper: section 6.3.

    For even K a vertex faces a vertex (`angle = 0`) and a flat point a flat point (`pi/K`).
    """
    return Cycle("diameter", egg(K), ((0, angle), (0, angle + pi)))


@cache
def egg_parallel() -> Cycle:
    """The egg's period-2 orbit between parallel tangents that is not a diameter. Paper: section 6.2.

    Its bounces lie at `theta` and `-theta`, where the tangent is horizontal; `alpha` is then a
    rational function of `c = cos(theta)`, which runs from 0 at `alpha = 0` down to the root of
    `16*c**4 - 18*c**2 + 10*c + 3` at `alpha = 1/10`, above -2/9.
    """
    shape = parallel_shape()
    table = egg(3)
    given = table.components[0]
    point = tuple(coordinate.subs(alpha, shape) for coordinate in given.point)
    return Cycle(
        "parallel tangents",
        replace(table, components=(replace(given, point=point),), shapes=()),
        ((0, acos(c)), (0, -acos(c))),
        ((c, Interval(Rational(-2, 9), 0)),),
    )


@cache
def parallel_shape() -> Expr:
    """`alpha` as a function of `c` on `egg_parallel`: where the height `rho*sin(theta)` is stationary.

    >>> parallel_shape()
    -c/(16*c**4 - 18*c**2 + 3)
    """
    _, y = egg(3).components[0].point
    slope = y.diff(theta).subs(theta, acos(c))
    slope = expand(slope.expand(trig=True))
    return cancel(-slope.coeff(alpha, 0) / slope.coeff(alpha, 1))


@lru_cache(maxsize=64, typed=True)
def egg_triangle(at_flat: bool = True) -> Cycle:
    """The equilateral period-3 orbit of the elastic egg: at its flat points, or else at its vertices.

    It runs counterclockwise; its mirror image runs clockwise. Paper: section 6.4 (`lambda = 1`).
    """
    first = pi / 3 if at_flat else Integer(0)
    third = 2 * pi / 3
    return Cycle("triangle", egg(3), tuple((0, first + k * third) for k in range(3)))
