"""What is sought: a cycle of the chord system, by itself or where it bifurcates.

Unknowns are the boundary parameters of the bounces and, at a bifurcation, one free letter: `lam` or
a shape. Equations are the collision rule at every bounce and, at a bifurcation, `rest = 0`: the one
number that makes the linearised system singular on vectors that come back unchanged (fold) or
negated (flip). All of it holds for any kind of number that the kernels can be loaded with.

How a cycle bifurcates: the numbers of the normal form, over any kind of number.

With `v` and `w` the right and left vectors of the singular linearisation, `F` the collision rule and
`e` the amplitude along `v`, the bifurcating branch is `letter = critical + branch*e**2`:

    fold:  branch = -[e**2]F / (w . dF/dletter)
    flip:  branch = -[e**3]F / speed,     speed = d rest/d letter along the cycle,

where the coefficient of `e**3` is taken on the curve `theta + e*v + e**2*u`, `u` chosen such that
the one of `e**2` vanishes. `turn` is `d rest/d multiplier`: not 0 exactly when the multiplier is simple.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from math import remainder, tau
from typing import Any

from sympy import Expr, simplify

from symbolic.expressions.text import constant, load
from symbolic.tables.table import Component, Table, theta
from verification.arithmetic.balls import Arithmetic
from verification.arithmetic.series import Jet, jets
from verification.cycles.recurrence.chain import Chain, Elimination, Vector, dot, trace_and_determinant
from verification.cycles.recurrence.chords import chord_angles
from verification.cycles.recurrence.newton import Solve
from verification.cycles.recurrence.recurrence import IDENTITY, BifurcationKind, Closure


@dataclass(frozen=True)
class Problem:
    """A cycle by its components, in a table whose only free shape is `free`.

    `kind` is FOLD or FLIP, None for a cycle by itself. `closure` says what comes after its bounces: their images
    under `theta -> -theta`, or the same `p/q` of a turn further on; certificates know no shift.
    `lam` is free when None, exact, or a number as it is: a ball proves for every `lam` in it, a jet differentiates.
    """

    table: Table
    components: tuple[int, ...]
    kind: BifurcationKind | None = None
    free: str = ""
    lam: Expr | Any = None
    closure: Closure = IDENTITY

    def __post_init__(self) -> None:
        shapes = {p.symbol.name for p in self.table.shapes}
        if shapes != {self.free} - {"lam", ""} or (self.lam is None) != (self.free == "lam"):
            raise ValueError(f"{self.table.name}: free letters must be just {self.free or 'none'}; lam = {self.lam}")
        if self.kind not in (None, BifurcationKind.FOLD, BifurcationKind.FLIP):
            raise ValueError(f"{self.table.name}: a {self.kind.value} is no problem of one cycle; accepted: fold, flip")
        if (self.kind is None) != (not self.free):
            kind = self.kind.name if self.kind else "CYCLE"
            raise ValueError(f"{self.table.name}: {kind} with {self.free or 'no letter'} free is not square")
        if self.mirror and not all(mirrored(component) for component in self.table.components):
            raise ValueError(f"{self.table.name}: theta -> -theta is no mirror image of a component")

    @property
    def mirror(self) -> bool:
        """Is it half a cycle, that its mirror image completes?"""
        return self.closure.turn == -1

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{self.table.name}, period {self.period}"

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """`F(z)`."""
        return Linearised(Rows(self, arithmetic), z, slope=False).value

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """`F'(z)^-1 r`."""
        return Linearised(Rows(self, arithmetic), z).solve(r)

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """`F'(z)^-1 F(z)`, Newton's correction."""
        here = Linearised(Rows(self, arithmetic), z)
        return here.solve(here.value)

    def inverses(self, arithmetic: Arithmetic, z: Vector) -> tuple[Solve, Solve]:
        """`F'(z)^-1` and its transpose, from one factorisation."""
        here = Linearised(Rows(self, arithmetic), z)
        return here.solve, here.solve_transposed

    def shorter(self, z: Vector, within: float) -> int:
        """The bounces after which the cycle repeats itself, up to `within` radians; 0 for never.

        >>> from sympy import S
        >>> from symbolic.tables import ellipse
        >>> Problem(ellipse.at(a=2), (0,) * 4, lam=S(1) / 3).shorter([1.5, -1.5, 1.5, -1.5], 1e-9)
        2
        """
        n, parts = self.period, self.components
        for m in (m for m in range(2, n) if n % m == 0 and not self.mirror):
            apart = (abs(remainder(float(z[i] - z[(i + m) % n]), tau)) for i in range(n))
            if parts == parts[m:] + parts[:m] and all(gap <= within for gap in apart):
                return m
        return 0

    @property
    def period(self) -> int:
        """The number of bounces."""
        return len(self.components)


@cache
def mirrored(component: Component) -> bool:
    """True when `theta -> -theta` is proved to map a component to its image under `y -> -y`.

    >>> from symbolic.tables import cuspless
    >>> all(mirrored(component) for component in cuspless.components)
    True
    """
    x, y = component.point
    image = x.subs(theta, -theta) - x, y.subs(theta, -theta) + y, component.start + component.end
    return all(simplify(part) == 0 for part in image)


class Rows:
    """The collision rule along a cycle, with derivatives, in one kind of number."""

    def __init__(self, problem: Problem, arithmetic: Arithmetic) -> None:
        self.problem, self.arithmetic = problem, arithmetic
        self.shape = problem.free if problem.free not in ("", "lam") else ""
        self.kernel = chord_angles(problem.table, arithmetic)

    def contraction(self, z: Vector) -> Any:
        """`lam`, given or unknown."""
        lam = self.problem.lam
        if lam is None:
            return z[-1]
        return load(constant(lam), self.arithmetic)()[0] if isinstance(lam, Expr) else lam

    def angles(self, z: Vector, order: int) -> tuple[list[Any], list[Any]]:
        """Exit and incidence angles with derivatives at each bounce, as the kernels return them."""
        components, n, closure = self.problem.components, self.problem.period, self.problem.closure
        ring = closure.padded(z[:n], closure.angle(self.arithmetic))
        shape = (z[n],) if self.shape else ()
        out, into = [], []
        for i in range(n):
            here, before, after = components[i], (i - 1) % n, (i + 1) % n
            out.append(self.kernel(here, components[after], order)(z[i], ring[i + 2], *shape))
            into.append(self.kernel(here, components[before], order)(z[i], ring[i], *shape))
        return out, into


class Linearised:
    """The equations of a problem and their first derivatives at one point, or over one box."""

    def __init__(self, rows: Rows, z: Vector, slope: bool = True) -> None:
        problem = rows.problem
        self.problem, self.z, self.rows = problem, z, rows
        order = 2 if problem.kind is not None and slope else 1
        self.lam = lam = rows.contraction(z)
        self.out, self.into = out, into = rows.angles(z, order)
        self.rule = [f[0] + lam * b[0] for f, b in zip(out, into, strict=True)]
        upper = [f[2] for f in out]
        diagonal = [f[1] + lam * b[1] for f, b in zip(out, into, strict=True)]
        lower = [lam * b[2] for b in into]
        self.value: Vector = list(self.rule)
        self.plain = Chain(lower, diagonal, upper, problem.closure.turn)
        if problem.kind is not None:
            self.critical = Elimination(Chain(lower, diagonal, upper, problem.closure.turn * problem.kind.multiplier))
            self.value.append(self.critical.rest)
            if slope:
                self.by_letter = self._by_letter()
                self.row, self.corner = self._of_rest()

    @cached_property
    def cycle(self) -> Elimination:
        """The linearised collision rules, eliminated."""
        return Elimination(self.plain)

    def solve(self, r: Vector) -> Vector:
        """The matrix of first derivatives, inverted on `r`."""
        if self.problem.kind is None:
            return self.cycle.solve(r)
        return self.cycle.bordered(self.by_letter[0], self.row, [self.corner], r)

    def solve_transposed(self, r: Vector) -> Vector:
        """The transposed matrix, inverted on `r`."""
        if self.problem.kind is None:
            return self.cycle.transposed([], [], [], r)
        return self.cycle.transposed(self.by_letter[0], self.row, [self.corner], r)

    def _by_letter(self) -> tuple[Vector, Vector, Vector, Vector]:
        """The derivatives by the free letter of the rule and of the three diagonals."""
        if self.problem.free == "lam":
            rule, lower, diagonal = ([b[k] for b in self.into] for k in (0, 2, 1))
            return rule, lower, diagonal, [0] * len(rule)
        at, s, lam = self.rows.kernel.places(2), self.rows.shape, self.lam
        r, d, u = at[f"angle_{s}"], at[f"angle_0_{s}"], at[f"angle_1_{s}"]
        both = list(zip(self.out, self.into, strict=True))
        return (
            [f[r] + lam * b[r] for f, b in both],
            [lam * b[u] for _, b in both],
            [f[d] + lam * b[d] for f, b in both],
            [f[u] for f, _ in both],
        )

    def _of_rest(self) -> tuple[Vector, Any]:
        """The derivatives of `rest` by the parameters and by the free letter: `left . dJ . right`."""
        at = self.rows.kernel.places(2)
        hh, ho, oo = at["angle_00"], at["angle_01"], at["angle_11"]
        n, sign, turn, lam = self.problem.period, self.critical.chain.sign, self.problem.closure.turn, self.lam
        v, w = self.critical.right, self.critical.left
        by_theta: Vector = [0] * n
        for i, (f, b, weight) in enumerate(zip(self.out, self.into, w, strict=True)):
            here = v[i]
            before = v[i - 1] if i else sign * v[n - 1]
            after = v[i + 1] if i < n - 1 else sign * v[0]
            back_mixed, forth_mixed = lam * b[ho], f[ho]
            back = lam * b[oo] * before + back_mixed * here
            own = back_mixed * before + (f[hh] + lam * b[hh]) * here + forth_mixed * after
            forth = forth_mixed * here + f[oo] * after
            by_theta[i - 1] = by_theta[i - 1] + weight * back * (1 if i else turn)
            by_theta[i] = by_theta[i] + weight * own
            by_theta[(i + 1) % n] = by_theta[(i + 1) % n] + weight * forth * (1 if i < n - 1 else turn)
        _, lower, diagonal, upper = self.by_letter
        return by_theta, dot(w, Chain(lower, diagonal, upper, sign).times(v))


@dataclass(frozen=True)
class NormalForm:
    """`turn`, `speed` and `bend` as above; `determinant` is that of the monodromy matrix."""

    turn: Any
    speed: Any
    bend: Any
    determinant: Any

    @property
    def branch(self) -> Any:
        """`letter = critical + branch*amplitude**2`."""
        return -self.bend / self.speed

    @property
    def multiplier_speed(self) -> Any:
        """The derivative of the critical multiplier by the letter, at a flip."""
        return -self.speed / self.turn


def normal_form(at: Linearised, arithmetic: Arithmetic) -> NormalForm:
    """The normal form where the equations of a fold or a flip hold."""
    chain, v, w = at.critical.chain, at.critical.right, at.critical.left
    turn = at.problem.closure.turn * (w[-1] * chain.upper[-1] * v[0] - w[0] * chain.lower[0] * v[-1])
    _, determinant = trace_and_determinant(chain.rows)
    second = along(at, jets(arithmetic), [v])
    if at.problem.kind is BifurcationKind.FOLD:
        return NormalForm(turn, dot(w, at.by_letter[0]), dot(w, [r.c[2] for r in second]), determinant)
    bent = at.cycle.solve([-r.c[2] for r in second])
    third = along(at, jets(arithmetic), [v, bent])
    motion = at.cycle.solve([-r for r in at.by_letter[0]])
    return NormalForm(turn, at.corner + dot(at.row, motion), dot(w, [r.c[3] for r in third]), determinant)


def along(at: Linearised, arithmetic: Arithmetic, directions: list[Vector]) -> list[Jet]:
    """The collision rule on the curve `theta + directions[0]*e + directions[1]*e**2`.

    Around the end of a flip the odd powers of `e` come back negated, with a mirror all of them. One
    order more than there are directions is kept.
    """
    problem, z = at.problem, at.z
    n, order = problem.period, len(directions) + 1
    rows = Rows(problem, arithmetic)
    own = [Jet(z[i], *(d[i] for d in directions), *([0] * (order - len(directions)))) for i in range(n)]
    sign = problem.kind.multiplier if problem.kind else 0
    first, last = (Jet(*(c * problem.closure.turn * sign**k for k, c in enumerate(x.c))) for x in (own[0], own[-1]))
    ring = [last, *own, first]
    parts, shape = problem.components, (z[n],) if rows.shape else ()
    found = []
    for i in range(n):
        f = rows.kernel(parts[i], parts[(i + 1) % n], 0)(ring[i + 1], ring[i + 2], *shape)[0]
        b = rows.kernel(parts[i], parts[i - 1], 0)(ring[i + 1], ring[i], *shape)[0]
        found.append(f + at.lam * b)
    return found
