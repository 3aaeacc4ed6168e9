"""A cycle of a billiard, by itself or where it folds or flips: its equations and their derivatives, over any numbers.

Unknowns are the boundary parameters of the bounces and, at a bifurcation, one free parameter: `lam` or a shape.
Equations are the collision rule at every bounce and, at a bifurcation, that the bordering function vanishes. It is 0
exactly where the linearised rules are singular on vectors that come back unchanged (fold) or negated (flip).

The normal form says how the cycle bifurcates. With `v` and `w` the right and left vectors of the singular
linearisation, `F` the rules and `e` the amplitude along `v`, the bifurcating branch is `parameter = critical +
branch*e**2`:

    fold:  branch = -[e**2] w.F / (w . dF/dparameter)
    flip:  branch = -[e**3] w.F / speed,     speed = the derivative of the bordering function along the cycle,

where the coefficient of `e**3` is taken on the curve `theta + e*v + e**2*u`, with `u` such that the coefficient of
`e**2` vanishes. `turn` is the derivative of the bordering function with respect to the multiplier; it is not 0 exactly
when the multiplier is simple.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import prod, remainder, tau
from typing import Any

import numpy as np
from sympy import Abs, Expr, atan, cos, cosh, simplify, sin, sinh, tan, tanh

from symbolic.expressions.text import constant, load
from symbolic.tables.law import PAPERS_LAW, Law
from symbolic.tables.table import Component, Table, eta, theta
from verification.arithmetic.balls import FLOAT64, Arithmetic
from verification.arithmetic.iteration import Vector
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import Chain, Elimination, by_cramer, dot, trace_and_determinant
from verification.cycles.chords import Chords
from verification.cycles.newton import Solve
from verification.cycles.recurrence import IDENTITY, BifurcationKind, Closure, Recurrence, Terms

LONG = 24  # bounces from which float64 is quicker in arrays


@dataclass(frozen=True)
class Problem:
    """A cycle by its components, in a table and under a law whose only free parameter is `free`.

    `kind` is FOLD, FLIP, or None for a cycle without a bifurcation. `closure` says what follows its bounces: their
    images under `theta -> -theta`, or under a turn by the fraction `p/q`; certificates accept no such turn. `lam` is
    None if free, or exact, or any number: with a ball a proof holds for every `lam` in it, and a jet gives derivatives.
    """

    table: Table
    components: tuple[int, ...]
    kind: BifurcationKind | None = None
    free: str = ""
    lam: Expr | Any = None
    closure: Closure = IDENTITY
    law: Law = PAPERS_LAW

    def __post_init__(self) -> None:
        if len(self.table.components) == 1:
            object.__setattr__(self, "law", self.law.on(self.table))  # in `theta` alone, as files have no arc length
        shapes = {*(p.symbol.name for p in self.table.shapes), *self.law.parameters}
        if shapes != {self.free} - {"lam", ""} or (self.lam is None) != (self.free == "lam"):
            given = f"without a number are {', '.join(sorted(shapes)) or 'no parameters'}, and lam = {self.lam}"
            raise ValueError(f"{self.table.name}: {given}; accepted: just {self.free or 'none'} without a number")
        if self.kind not in (None, BifurcationKind.FOLD, BifurcationKind.FLIP):
            raise ValueError(f"{self.table.name}: kind = {self.kind.value} is unknown here; accepted: fold, flip")
        if (self.kind is None) != (not self.free):
            kind = self.kind.name if self.kind else "CYCLE"
            given = f"{kind} with {self.free or 'no parameter'} free has not as many equations as unknowns"
            raise ValueError(f"{self.table.name}: {given}; accepted: a parameter for a fold or flip only")
        if self.mirror and not all(mirrored(component) for component in self.table.components):
            raise ValueError(
                f"{self.table.name}: theta -> -theta is no reflection of each component; accepted: mirror=False"
            )
        if self.law.placed and self.closure.shift[0] % self.closure.shift[1]:
            raise ValueError(f"law = {self.law}: a turn of the table changes the law, so no cycle closes by a turn")
        if self.mirror and not self.law.odd:
            raise ValueError(f"law = {self.law}: no odd function of eta, so mirror images of orbits are no orbits")

    @cached_property
    def ring(self) -> Chords:
        """The chord system that the bounces obey."""
        return Chords(self.table, self.components, self.closure, self.law)

    def at(self, arithmetic: Arithmetic, z: Vector) -> dict[str, Any]:
        """The parameters by name, given or taken from the unknowns `z`."""
        lam = self.lam
        if isinstance(lam, Expr):
            lam = load(constant(lam), arithmetic)()[0]
        return ({} if lam is None else {"lam": lam}) | ({self.free: z[self.period]} if self.free else {})

    @property
    def mirror(self) -> bool:
        """Do the unknowns describe half a cycle, which its mirror image completes?"""
        return self.closure.turn == -1

    @property
    def label(self) -> str:
        """The name used in messages."""
        return f"{self.table.name}, period {self.period}"

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The equations `F(z)`."""
        return Linearised(self, arithmetic, z, slope=False).value

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """The solution `x` of `F'(z) x = r`."""
        return Linearised(self, arithmetic, z).solve(r)

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's correction `F'(z)^-1 F(z)`."""
        here = Linearised(self, arithmetic, z)
        return here.solve(here.value)

    def inverses(self, arithmetic: Arithmetic, z: Vector) -> tuple[Solve, Solve]:
        """Functions that apply `F'(z)^-1` and its transpose, from one factorisation."""
        here = Linearised(self, arithmetic, z)
        return here.solve, here.solve_transposed

    def shorter(self, z: Vector, within: float) -> int:
        """The number of bounces after which the cycle repeats itself, up to `within` radians; 0 if it does not.

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


def seen_mirrored(problem: Problem, boundary: bool) -> bool:
    """Is `theta -> -theta` a symmetry of the law (and of the table, if `boundary`), by the parity of their formulas?

    No algebra is used, so that a reader without computer algebra can repeat it.
    """
    parts = {problem.table.components[i] for i in problem.components} if boundary else set()
    wanted = [(part.radius, 1) for part in parts if part.radius is not None]
    wanted += [(f, sign) for part in parts if part.radius is None for f, sign in zip(part.point, (1, -1), strict=True)]
    wanted += [] if problem.law.uniform else [(problem.law.phi, -1)]
    return all(_sign(f) == sign for f, sign in wanted)


def _sign(f: Expr) -> int:
    """The factor 1 or -1 of a formula under `theta, eta -> -theta, -eta`, from its subexpressions; 0 if undecided."""
    if not f.has(theta, eta):
        return 1
    if f in (theta, eta):
        return -1
    signs = [_sign(part) for part in f.args]
    if f.is_Add:
        return signs[0] if len(set(signs)) == 1 else 0
    if f.is_Mul:
        return int(prod(signs))
    if f.is_Pow and f.exp.is_Integer:
        return signs[0] if f.exp % 2 else abs(signs[0])
    odd, even = isinstance(f, (sin, tan, sinh, tanh, atan)), isinstance(f, (cos, cosh, Abs))
    return signs[0] if odd else abs(signs[0]) if even else int(all(sign == 1 for sign in signs))


class Linearised:
    """The equations of a problem and their first derivatives, at one point or over one box."""

    def __init__(self, problem: Problem, arithmetic: Arithmetic, z: Vector, slope: bool = True) -> None:
        kind, closure, n = problem.kind, problem.closure, problem.period
        self.problem, self.z, self.at = problem, z, problem.at(arithmetic, z)
        order = 2 if kind is not None and slope else 1
        if arithmetic is FLOAT64 and n >= LONG:
            self.terms = problem.ring.terms(np.array(z[:n]), self.at, order).listed()
        else:
            padded = closure.padded(z[:n], closure.angle(arithmetic))
            self.terms = problem.ring.bounces(arithmetic, padded, self.at, order)
        self.value: Vector = list(self.terms.value)
        self.plain = Chain(*self.terms.slope, closure.turn)
        if kind is not None:
            self.critical = Elimination(Chain(*self.terms.slope, closure.turn * kind.multiplier))
            self.value.append(self.critical.bordering)
            if slope:
                both = self.critical.right, self.critical.left
                self.row, by = bordering_slopes(self.terms, closure, *both, kind.multiplier)
                self.column, self.corner = self.terms.by[problem.free], by[problem.free]

    @cached_property
    def cycle(self) -> Elimination:
        """The elimination of the linearised collision rules."""
        return Elimination(self.plain)

    def solve(self, r: Vector) -> Vector:
        """The solution `x` of `F'(z) x = r`."""
        if self.problem.kind is None:
            return by_cramer(self.plain, r) or self.cycle.solve(r)
        return self.cycle.bordered(self.column, self.row, [self.corner], r)

    def solve_transposed(self, r: Vector) -> Vector:
        """The solution `x` of the transposed system."""
        if self.problem.kind is None:
            return by_cramer(self.plain, r, transposed=True) or self.cycle.transposed([], [], [], r)
        return self.cycle.transposed(self.column, self.row, [self.corner], r)

    def normal_form(self, arithmetic: Arithmetic) -> "NormalForm":
        """The normal form, at a solution of the equations of a fold or a flip."""
        problem, critical = self.problem, self.critical
        kind = problem.kind or BifurcationKind.FOLD
        x = self.z[: problem.period]

        def series(directions: list[Vector]) -> list[Jet]:
            return expanded(problem.ring, arithmetic, x, self.at, kind.multiplier, directions)

        return normal_form(
            kind, problem.free, self.terms, problem.closure, critical.right, critical.left, series, self.cycle.solve
        )


def bordering_slopes(
    terms: Terms[Any], closure: Closure, v: Sequence[Any], w: Sequence[Any], sign: Any
) -> tuple[Vector, dict[str, Any]]:
    """Derivatives of `w A v` by bounces and parameters; `A` is the matrix on vectors that close with the factor `sign`.

    If `v` and `w` are the null vectors of an elimination, this is the derivative of the bordering function.
    """
    n, close = len(v), sign * closure.turn
    by_bounce: Vector = [0] * n
    by_parameter: dict[str, Any] = dict.fromkeys(terms.slope_by, 0)
    entries = [[terms.bend.get((min(j, k), max(j, k))) for k in range(3)] for j in range(3)]
    for i in range(n):
        near = v[i - 1] if i else close.conjugate() * v[n - 1], v[i], v[i + 1] if i < n - 1 else close * v[0]
        turns = 1 if i else closure.turn, 1, 1 if i < n - 1 else closure.turn
        for j, turn in enumerate(turns):
            total: Any = 0
            for entry, x in zip(entries[j], near, strict=True):
                if entry is not None:
                    total = total + entry[i] * x
            at = (i + j - 1) % n
            by_bounce[at] = by_bounce[at] + w[i] * total * turn
        for name, slopes in terms.slope_by.items():
            by_parameter[name] = by_parameter[name] + w[i] * dot([slope[i] for slope in slopes], near)
    return by_bounce, by_parameter


@dataclass(frozen=True)
class NormalForm:
    """The coefficients in the module's formulas; `bend` is the one of `e**2` (fold) or `e**3` (flip) in `w.F`."""

    kind: BifurcationKind
    turn: Any
    speed: Any
    bend: Any
    determinant: Any

    @property
    def branch(self) -> Any:
        """The coefficient in `parameter = critical + branch*amplitude**2` on the new branch."""
        return -self.bend / self.speed

    @property
    def supercritical(self) -> bool | None:
        """True if the cycle born at a flip is stable where it exists beside the unstable old one; None if undecided.

        The new cycle lies on the side of the sign of `branch`. The multiplier has the derivative `-speed/turn`, which
        tells on which side the old cycle is unstable. At a supercritical flip the two sides agree.
        """
        if self.kind is not BifurcationKind.FLIP:
            return None
        side = self.bend * self.turn
        return True if side < 0 else False if side > 0 else None


Series = Callable[[list[Any]], Sequence[Jet]]


def bend_of(kind: BifurcationKind, w: Sequence[Any], v: Any, series: Series, solve: Solve) -> Any:
    """The coefficient of `e**2` in `w.F` at a fold; at a flip of `e**3`, on a curve where `F` has no term in `e**2`."""
    second = [rule.c[2] for rule in series([v])]
    if kind is BifurcationKind.FOLD:
        return dot(w, second)
    return dot(w, [rule.c[3] for rule in series([v, solve([-x for x in second])])])


def normal_form(
    kind: BifurcationKind,
    parameter: str,
    terms: Terms[Any],
    closure: Closure,
    v: Sequence[Any],
    w: Sequence[Any],
    series: Series,
    solve: Solve,
) -> NormalForm:
    """The normal form of a cycle that folds or flips, from its singular vectors.

    `series(directions)` gives the rules as jets on a curve through the cycle; `solve` inverts the linearised rules.
    """
    lower, _, upper = terms.slope
    turn = closure.turn * (w[-1] * upper[-1] * v[0] - w[0] * lower[0] * v[-1])
    _, determinant = trace_and_determinant(terms.rows)
    speed, bend = dot(w, terms.by[parameter]), bend_of(kind, w, v, series, solve)
    if kind is not BifurcationKind.FOLD:
        by_bounce, by = bordering_slopes(terms, closure, v, w, kind.multiplier)
        speed = by[parameter] + dot(by_bounce, solve([-x for x in terms.by[parameter]]))
    return NormalForm(kind, turn, speed, bend, determinant)


def expanded(
    ring: Recurrence, arithmetic: Arithmetic, x: Sequence[Any], at: Mapping[str, Any], sign: int, directions: list[Any]
) -> list[Jet]:
    """The rules as jets on the curve `x + directions[0]*e + directions[1]*e**2`, to one order beyond the directions.

    Where the ring closes, the odd powers of `e` are multiplied by `sign`, and with a mirror all powers are negated.
    """
    own = [Jet(*coefficients, 0) for coefficients in zip(x, *directions, strict=True)]
    padded = ring.closure.padded(own, ring.closure.angle(arithmetic))
    padded[0], padded[-1] = (Jet(*(c * sign**k for k, c in enumerate(y.c))) for y in (padded[0], padded[-1]))
    rule = ring.over(jets(arithmetic))
    return [rule(i, padded[i : i + 3], at, 0).value for i in range(len(own))]
