"""The geometry of a component, derived from its parametrisation. Paper: section 2 and appendix.

Signs: the boundary runs counterclockwise, the normal points inwards, and the curvature of a focusing component is
negative (the paper's convention; textbooks use the opposite sign).

Arc length has a closed form where the speed allows one, and is the exact integral elsewhere. If
`speed**2 = p + q*cos(n*theta)`, it is an incomplete elliptic integral of the second kind; at parameter 1 (the cardioid)
it degenerates to a sine.

Symmetries: rotations and reflections about the origin that are proved to map the boundary to itself form a cyclic or a
dihedral group. A rotation takes `theta` to `theta + shift` and keeps exit angles. A reflection takes `theta` to
`-theta + shift` and negates them. Both take orbits of the pinball map to orbits.
"""

from dataclasses import dataclass
from functools import cache, reduce
from itertools import pairwise
from math import gcd

from sympy import (
    Dummy,
    Expr,
    I,
    Integral,
    Matrix,
    Poly,
    Rational,
    S,
    Symbol,
    conjugate,
    cos,
    diff,
    elliptic_e,
    exp,
    expand,
    floor,
    pi,
    simplify,
    sin,
    sqrt,
)
from sympy.polys.polyerrors import PolynomialError

from symbolic.expressions.signs import vanishes
from symbolic.tables.curves import LONG, exactly, size, trigonometric, waves
from symbolic.tables.polynomial import derivative, end_point
from symbolic.tables.table import Component, Table, theta

HIGHEST = 24  # harmonic that is written as a polynomial in the tangent of half the angle
FEW = 8  # most components whose arc lengths are simplified


def velocity(component: Component) -> Matrix:
    """`d(x, y)/d theta`, a 2-vector along the tangent.

    >>> from symbolic.tables import circle
    >>> velocity(circle.components[0]).T
    Matrix([[-sin(theta), cos(theta)]])
    """
    return Matrix(_derivatives(component))


@cache
def _derivatives(component: Component) -> tuple[Expr, Expr]:
    x, y = (derivative(f) if f.is_Add and f.is_polynomial(theta) else f.diff(theta) for f in component.point)
    return x, y


def speed(component: Component) -> Expr:
    """`|d(x, y)/d theta|`, in length per radian of `theta`.

    >>> from symbolic.tables import cardioid
    >>> speed(cardioid.components[0])
    sqrt(2*cos(theta) + 2)
    """
    return sqrt(trigonometric(velocity(component).dot(velocity(component))))


def tangent(component: Component) -> Matrix:
    """The unit tangent, counterclockwise."""
    return velocity(component) / speed(component)


def normal(component: Component) -> Matrix:
    """The unit normal that points into the table: the tangent turned left.

    >>> from symbolic.tables import circle
    >>> normal(circle.components[0]).T
    Matrix([[-cos(theta), -sin(theta)]])
    """
    x, y = velocity(component)
    return Matrix([-y, x]) / speed(component)


def turning(component: Component) -> Expr:
    """`x' y'' - y' x''`, which contains no square root: positive where the boundary focuses."""
    first = velocity(component)
    second = first.diff(theta)
    return trigonometric(first[0] * second[1] - first[1] * second[0])


def curvature(component: Component) -> Expr:
    """Signed curvature `kappa(theta)`, in 1/length; negative where the boundary focuses.

    Paper: section 2 (sign convention), eq. (curvature-polar). Textbooks use the opposite sign.

    >>> from symbolic.tables import cardioid
    >>> curvature(cardioid.components[0]).subs(theta, 0)
    -3/4
    """
    return -turning(component) / speed(component) ** 3


def evolute(component: Component) -> Matrix:
    """The centres of curvature, the envelope of the inward normals, simplified. Paper: section 2.2.

    >>> from symbolic.tables import circle
    >>> evolute(circle.components[0]).T
    Matrix([[0, 0]])
    """
    return centre_of_curvature(component).applyfunc(simplify)


def centre_of_curvature(component: Component) -> Matrix:
    """The centre of curvature, not simplified."""
    x, y = velocity(component)
    ratio = trigonometric(x**2 + y**2) / turning(component)
    return Matrix([p + ratio * n for p, n in zip(component.point, (-y, x), strict=True)])


def arc_length(component: Component) -> Expr:
    """Arc length from `theta = 0` to `theta`, negative for negative `theta`.

    Paper: section 4 (cardioid). The closed form of a cusped component holds between its cusps.

    >>> from symbolic.tables import cardioid, ellipse
    >>> arc_length(cardioid.components[0])
    4*sin(theta/2)
    >>> arc_length(ellipse.components[0])
    elliptic_e(theta, 1 - a**2)
    """
    squared = expand(speed(component) ** 2)
    c = coefficients(squared) if squared.has(theta) else {0: squared}
    if c is not None and len(c) <= 3 and all(c[-k] == c[k] for k in c):
        p, n = c.get(0, S.Zero), max(c)
        q = 2 * c[n] if n else S.Zero
        closed = not n or simplify(squared - p - q * cos(n * theta)) == 0
        if closed and (found := _elliptic(p, q, max(n, 1), component)) is not None:
            return found
    dummy = Dummy("theta", real=True)
    return Integral(speed(component).subs(theta, dummy), (dummy, 0, theta))


def _elliptic(p: Expr, q: Expr, n: int, component: Component) -> Expr | None:
    """The integral of `sqrt(p + q*cos(n*theta))` from 0; None if this root vanishes inside the component's range."""
    half = Rational(n, 2) * theta
    if simplify(q) == 0:
        return sqrt(p) * theta
    rises, falls = simplify(p + q) == 0, simplify(p - q) == 0  # the root is that of `2*p`, times `|sin|` or `|cos|`
    if not (rises or falls):
        return sqrt(p + q) * elliptic_e(half, simplify(2 * q / (p + q))) * Rational(2, n)
    first, last = ((half.subs(theta, end) / pi + (S.Half if falls else 0)) for end in (component.start, component.end))
    turns = floor(first)
    if (turns + 1 - last).is_nonnegative is not True:
        return None
    primitive = sin(half) if falls else 1 - cos(half)
    return (-1) ** turns * sqrt(2 * p) * primitive * Rational(2, n)


def positions(table: Table) -> tuple[Expr, ...]:
    """The paper's arc length `s(theta)` on each component, counted counterclockwise from the table's `origin`.

    It is not reduced modulo `perimeter(table)`; the paper reduces it where it draws `s` symmetrically about 0.

    >>> from symbolic.tables import cuspless
    >>> positions(cuspless)
    (4*sin(theta/2) + 9*sqrt(3)/4, theta)
    """
    (first, start), count = table.origin, len(table.components)
    part = table.components[first]
    if (part.start - start).is_positive:  # the default 0, before the component begins
        start = part.start
    elif (start - part.end).is_positive:  # or after its end
        start = part.end
    found: dict[int, Expr] = {}
    reached = -arc_length(table.components[first]).subs(theta, start)
    for step in range(count):
        index = (first + step) % count
        component = table.components[index]
        length = arc_length(component)
        if step:
            reached -= length.subs(theta, component.start)
            reached = simplify(reached) if count <= FEW else reached
        found[index] = length + reached
        reached = found[index].subs(theta, component.end)
    return tuple(found[index] for index in range(count))


def perimeter(table: Table) -> Expr:
    """The length of the whole boundary; an integral without a closed form is left unevaluated.

    >>> from symbolic.tables import cardioid, cuspless
    >>> perimeter(cardioid), perimeter(cuspless)
    (8, 9*sqrt(3)/2)
    """
    closed, integrals = S.Zero, S.Zero
    for component in table.components:
        length, (start, end) = arc_length(component), (component.start, component.end)
        if isinstance(length, Integral):
            integrals += Integral(length.function, (length.variables[0], start, end))
        else:
            closed += length.subs(theta, end) - length.subs(theta, start)
    return simplify(closed) + integrals


CIRCLE = 4  # rotations that are listed for a circle, which has infinitely many


@dataclass(frozen=True)
class Symmetry:
    """A symmetry: `theta` on component `i` goes to `sign*theta + shift[i]` on component `onto[i]`, `phi` to `sign*phi`.

    In the plane it is the rotation by `angle`, after the reflection `y -> -y` when `sign` is -1.
    """

    name: str
    sign: int
    angle: Expr
    onto: tuple[int, ...]
    shift: tuple[Expr, ...]

    @property
    def matrix(self) -> Matrix:
        """The orthogonal matrix of the symmetry in the plane.

        >>> Symmetry("half turn", 1, pi, (0,), (pi,)).matrix
        Matrix([
        [-1,  0],
        [ 0, -1]])
        """
        c, s = cos(self.angle), sin(self.angle)
        return Matrix([[c, -s * self.sign], [s, c * self.sign]])

    def then(self, other: "Symmetry") -> "Symmetry":
        """The composition: this symmetry, then `other`."""
        sign, angle = self.sign * other.sign, (other.angle + other.sign * self.angle) % (2 * pi)
        shift = [other.sign * by + other.shift[on] for on, by in zip(self.onto, self.shift, strict=True)]
        return Symmetry(_name(sign, angle), sign, angle, tuple(other.onto[on] for on in self.onto), tuple(shift))


@cache
def group(table: Table) -> tuple[Symmetry, ...]:
    """The proved symmetries of a table, the identity first.

    The list is complete for the paper's tables, because a symmetry preserves curvature: it permutes the vertices of an
    ellipse (`a > 1`) or an egg (`alpha > 0`), and it fixes the cusp or the wall. The circle is the exception; for it
    only the symmetries of the square are listed.

    >>> from symbolic.tables import cardioid, cuspless, egg, ellipse
    >>> [len(group(table)) for table in (ellipse.at(a=2), cardioid, cuspless, egg(3).at(alpha="0.08"))]
    [4, 2, 2, 6]
    >>> [symmetry.name for symmetry in group(cuspless)]
    ['identity', 'reflection in the line at 0']
    """
    turns, axes = _of_one(table) if len(table.components) == 1 else _of_many(table)
    return (*turns, *axes)


def order_of_rotation(component: Component) -> int:
    """The number of rotations that map a closed component to itself: the gcd of the differences of its frequencies.

    `z(theta + d) = exp(i*w)*z(theta)` means `k*d = w` modulo `2*pi` for every frequency `k` of `z = x + i*y`. A radius
    that is no finite sum has at least the period of the sines and cosines of which it is a function.

    >>> from symbolic.tables import egg, polar
    >>> order_of_rotation(egg(5).components[0]), order_of_rotation(polar("exp(cos(2*theta)/8)").components[0])
    (5, 2)
    """
    waves = boundary_coefficients(component)
    if waves is None:
        rho = component.radius or theta
        within = rho.atoms(sin, cos)
        times = [diff(each.args[0], theta) for each in within]
        alone = theta in rho.xreplace({each: Dummy() for each in within}).free_symbols
        return 1 if alone or not all(k.is_Integer for k in times) else reduce(gcd, map(int, times), 0) or 1
    first = next(iter(waves))
    return reduce(gcd, (k - first for k in waves), 0) or CIRCLE


def _of_one(table: Table) -> tuple[list[Symmetry], list[Symmetry]]:
    """The rotations and reflections of one closed component, from shifts of `theta` by multiples of `2*pi/n`."""
    component = table.components[0]
    n = order_of_rotation(component)
    shifts = [2 * pi * k / n for k in range(n)]
    turns = [_one(component, 1, shift) for shift in shifts]
    first = [shift for shift in (S.Zero, pi / n) if _one(component, -1, shift)][:1]
    axes = [_one(component, -1, begin + shift) for begin in first for shift in shifts]
    return [found for found in turns if found], [found for found in axes if found]


def _one(component: Component, sign: int, shift: Expr) -> Symmetry | None:
    """The symmetry `theta -> sign*theta + shift` of a boundary of one closed component, if it is one."""
    waves = boundary_coefficients(component)
    if waves is None:
        found = Symmetry(_name(sign, shift), sign, shift, (0,), (shift,))
        return found if _keeps(component, component, found.matrix, sign, shift) else None
    first = next(k for k in waves if k)
    for angle in (first * shift % (2 * pi), (first * shift + pi) % (2 * pi)):
        if all(_turned(c, (angle - k * shift) / pi, sign) for k, c in waves.items()):
            return Symmetry(_name(sign, angle), sign, angle, (0,), (shift,))
    return None


def _turned(c: Expr, half_turns: Expr, sign: int) -> bool:
    """Is a Fourier coefficient `c` equal to its product with `(-1)**half_turns`, conjugated if `sign` is -1?"""
    turned = c if sign > 0 else conjugate(c)
    return bool(half_turns.is_Integer and vanishes(S.NegativeOne**half_turns * turned - c))


def _of_many(table: Table) -> tuple[list[Symmetry], list[Symmetry]]:
    """Symmetries of a boundary of several components: identity, half turn, and reflections in coordinate axes."""
    parts = table.components
    same = Symmetry("identity", 1, S.Zero, tuple(range(len(parts))), (S.Zero,) * len(parts))
    places = [
        (i, by) for i, image in enumerate(parts) for by in ((0, pi) if image.end - image.start == 2 * pi else (0,))
    ]
    chords = [
        sum((q - p) ** 2 for p, q in zip(end_point(part, False), end_point(part, True), strict=True)) for part in parts
    ]  # squares of chords, which symmetries preserve
    by_chord = dict[Expr, list[tuple[int, Expr]]]()
    for i, by in places:
        by_chord.setdefault(chords[i] if chords[i].is_Rational else S.NaN, []).append((i, by))
    axes = []
    for angle in (S.Zero, pi):
        found = Symmetry(_name(-1, angle), -1, angle, (), ())
        onto = []
        for part, chord in zip(parts, chords, strict=True):
            alike = places if S.NaN in by_chord else by_chord[chord]  # of numbers that are not rational nothing is said
            tried = ((i, simplify(part.start + parts[i].end) + by) for i, by in alike)
            onto += [next(((i, by) for i, by in tried if _keeps(part, parts[i], found.matrix, -1, by)), None)]
            if onto[-1] is None:  # each part is tried on all of them
                break
        if None not in onto:
            axes.append(Symmetry(found.name, -1, angle, *map(tuple, zip(*onto, strict=True))))
    return [same, *(first.then(second) for first, second in pairwise(axes))], axes


def _keeps(part: Component, image: Component, matrix: Matrix, sign: int, shift: Expr) -> bool:
    """Does `matrix` map `part` onto `image`, its point at `theta` to the point at `sign*theta + shift`?"""
    moved = matrix * Matrix(part.point)
    target = [coordinate.subs(theta, sign * theta + shift) for coordinate in image.point]
    differences = [left - right for left, right in zip(moved, target, strict=True)]
    if max(map(size, differences)) > LONG:
        return all(waves(each) == {} for each in differences)
    return all(vanishes(expand(each, trig=True)) for each in differences)


def _name(sign: int, angle: Expr) -> str:
    if sign > 0:
        return "identity" if angle == 0 else f"rotation by {angle}"
    return f"reflection in the line at {angle / 2}"


def coefficients(expression: Expr) -> dict[int, Expr] | None:
    """The nonzero coefficients `c_k` of `exp(i*k*theta)` in an expression, by `k`; None if it is no finite such sum.

    >>> coefficients(2 * cos(theta) ** 2)
    {-2: 1/2, 0: 1, 2: 1/2}
    >>> coefficients(1 / (2 + cos(theta))) is None
    True
    """
    found = waves(S(expression))
    if found is not None:
        return {k: exactly(c) for k, c in found.items()}
    if size(S(expression)) > LONG or any(f.args[0].atoms(cos, sin) for f in S(expression).atoms(cos, sin)):
        return None
    u = Dummy("u")
    text = S(expression).rewrite(exp) if S(expression).has(cos, sin) else S(expression)
    rational = expand(expand(text).replace(exp, lambda power: u ** expand(power / (I * theta))))
    if rational.has(theta):
        return None
    lowest = min([0, *(-_degree(term, 1 / u) for term in rational.as_ordered_terms())])
    try:
        poly = Poly(expand(rational * u**-lowest), u)
    except PolynomialError:
        return None
    terms = {power[0] + lowest: c for power, c in poly.terms() if c != 0}
    return dict(sorted(terms.items()))


def boundary_coefficients(component: Component) -> dict[int, Expr] | None:
    """The nonzero Fourier coefficients `c_k` of `z = x + i*y` on a component, by `k`; None if `z` is no finite sum.

    >>> from symbolic.tables import cardioid
    >>> boundary_coefficients(cardioid.components[0])
    {0: 1/2, 1: 1, 2: 1/2}
    """
    x, y = component.point
    return coefficients(x + I * y)


def in_half_tangent(expression: Expr) -> tuple[Expr, Symbol, Expr] | None:
    """A polynomial in `T = tan(x/2)` with the sign of a trigonometric polynomial; `T`; and the value of `expression` at
    `x = pi`.

    Here `x = g*theta`, where `g` is the common divisor of the frequencies. None if the expression is not a
    trigonometric polynomial, or has harmonics above `HIGHEST`.

    >>> p, T, value = in_half_tangent(2 + cos(3 * theta))
    >>> p.subs(T, 0), value
    (3, 1)
    """
    c = coefficients(expression)
    if c is None or max(map(abs, c), default=0) > HIGHEST:
        return None
    step = reduce(gcd, (abs(k) for k in c), 0) or 1
    n = max((abs(k) for k in c), default=0) // step
    T = Dummy("T", real=True)
    total = S.Zero
    for k, value in c.items():
        power = k // step
        wave = (1 + (1 if power > 0 else -1) * I * T) ** (2 * abs(power))
        total += value * wave * (1 + T**2) ** (n - abs(power))
    at_pi = sum((value * S.NegativeOne ** (k // step) for k, value in c.items()), S.Zero)
    return expand(expand(total).as_real_imag()[0]), T, expand(at_pi)


def _degree(term: Expr, base: Expr) -> int:
    power = term.as_powers_dict().get(1 / base, 0)
    return -int(power) if S(power).is_Integer else 0
