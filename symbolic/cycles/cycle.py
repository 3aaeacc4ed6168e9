"""Cycles, exact: periodic orbits given by their boundary points, and their monodromy matrices.

Exit and incidence angles follow from the chords that meet at a point, so nothing but the points is
typed in. Paper: end of section 2.1.
"""

from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, Matrix, cancel, expand_trig, eye, factor, simplify, sqrt

from symbolic.motion.collision import derivative_matrix
from symbolic.proofs.signs import Box
from symbolic.proofs.zero import vanishes
from symbolic.tables.ranges import parameter_box, root
from symbolic.tables.symbols import lam, theta
from symbolic.tables.table import Table


@dataclass(frozen=True)
class Frame:
    """A boundary point with its unit tangent, inward normal and signed curvature."""

    point: Matrix
    tangent: Matrix
    normal: Matrix
    curvature: Expr


@dataclass(frozen=True)
class Cycle:
    """A periodic orbit by its bounces, each a component's index and a boundary parameter.

    `box` holds the ranges of further letters that `table` and the bounces may depend on.
    """

    name: str
    table: Table
    bounces: tuple[tuple[int, Expr], ...]
    box: tuple[tuple[Expr, Expr], ...] = ()

    @cached_property
    def ranges(self) -> Box:
        """The ranges of all letters of the cycle."""
        return parameter_box(self.table) | dict(self.box)

    @cached_property
    def frames(self) -> tuple[Frame, ...]:
        """The frame at each bounce."""
        return tuple(frame(self.table, index, value, self.ranges) for index, value in self.bounces)

    def chord(self, i: int) -> Matrix:
        """The vector from bounce `i` to the next."""
        n = len(self.bounces)
        return (self.frames[(i + 1) % n].point - self.frames[i % n].point).applyfunc(simplify)

    def length(self, i: int) -> Expr:
        """The length of the flight that leaves bounce `i`."""
        chord = self.chord(i)
        return root(simplify(chord.dot(chord)), self.ranges)

    def cos_exit(self, i: int) -> Expr:
        """The cosine of the exit angle at bounce `i`."""
        return simplify(self.chord(i).dot(self.frames[i % len(self.bounces)].normal) / self.length(i))

    def cos_incidence(self, i: int) -> Expr:
        """The cosine of the incidence angle at bounce `i`."""
        return simplify(-self.chord(i - 1).dot(self.frames[i % len(self.bounces)].normal) / self.length(i - 1))

    def sliding(self, i: int) -> tuple[Expr, Expr]:
        """`(sin of the exit angle, minus sin of the incidence angle)` at bounce `i`."""
        tangent = self.frames[i % len(self.bounces)].tangent
        leaving = self.chord(i).dot(tangent) / self.length(i)
        arriving = self.chord(i - 1).dot(tangent) / self.length(i - 1)
        return simplify(leaving), simplify(arriving)

    def _repr_latex_(self) -> str:
        from symbolic.tables.notation import equation  # a notebook asks for it, nothing else does

        return equation(rf"\text{{{self.table.name}, {self.name}:}}\quad D T^{{{len(self.bounces)}}}", monodromy(self))


def frame(table: Table, index: int, value: Expr, box: Box) -> Frame:
    """The frame of a table at parameter `value` of component `index`.

    >>> from symbolic.tables import cardioid
    >>> from sympy import S
    >>> frame(cardioid, 0, S.Zero, {}).curvature
    -3/4
    """
    path = Matrix(table.components[index].point)
    point, first, second = (
        path.diff(theta, order).subs(theta, value).applyfunc(lambda entry: simplify(expand_trig(entry)))
        if order
        else path.subs(theta, value).applyfunc(expand_trig)
        for order in (0, 1, 2)
    )
    speed = root(simplify(first.dot(first)), box)
    turning = simplify(first[0] * second[1] - first[1] * second[0])
    tangent = (first / speed).applyfunc(cancel)
    normal = Matrix([-tangent[1], tangent[0]])
    return Frame(point, tangent, normal, cancel(-turning / speed**3))


def is_double_normal(cycle: Cycle) -> bool:
    """True when it is proved that every chord is normal to the boundary at both its ends.

    Such a cycle exists for every contraction: exit and incidence angles all vanish.

    >>> from symbolic.cycles.named import minor_axis
    >>> is_double_normal(minor_axis())
    True
    """
    return all(vanishes(part) for i in range(len(cycle.bounces)) for part in cycle.sliding(i))


def is_elastic(cycle: Cycle) -> bool:
    """True when it is proved that the cycle obeys the elastic law `phi = -eta` at each bounce."""
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


def monodromy(cycle: Cycle, base: int = 0, contraction: Expr = lam) -> Matrix:
    """The stability matrix of the cycle at bounce `base`: the product over one period.

    The trace and the determinant do not depend on `base`; the entries do.

    >>> from symbolic.cycles.named import minor_axis
    >>> monodromy(minor_axis()).det().simplify()
    lam**2
    """
    product = eye(2)
    for i in range(base, base + len(cycle.bounces)):
        product = flight_matrix(cycle, i, contraction) * product
    return product.applyfunc(factor)


def trace_and_determinant(cycle: Cycle, contraction: Expr = lam) -> tuple[Expr, Expr]:
    """Trace and determinant of the monodromy matrix."""
    matrix = monodromy(cycle, 0, contraction)
    return simplify(matrix.trace()), simplify(matrix.det())


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
