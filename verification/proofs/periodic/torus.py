"""Torus (Neimark-Sacker) bifurcations: complex multipliers of a cycle cross the unit circle.

Let `v` and `w` be the right and left null vectors of the linearised rules, for vectors that a round multiplies by `mu =
exp(i*omega)`. The bounces of orbits near the cycle are

    x[i](z) = x[i] + 2*Re(v[i]*z + h20[i]*z**2 + h21[i]*z**2*conj(z) + ...) + h11[i]*abs(z)**2 + ...,

and one round carries `z` to `mu*z + cubic*z**2*conj(z)`, up to `abs(z)**4`, unless `mu**k = 1` for a `k` up to 4.
Inserted into the rules, each power of `z` gives a linear system, closed by that power of `mu`; the system of
`z**2*conj(z)` is singular, and solvable for one value of `cubic` only. The powers are separated by means of three real
curves, with `z` at 0, 120 and 240 degrees.

**Theorem** ([RuelleTakens1971]; [Kuznetsov2004], section 4.7). Let a smooth map of the plane have, at one value of a
parameter, a fixed point with the multipliers `mu` and `conj(mu)` on the unit circle. If

- `mu**k` is not 1 for any `k` up to 4,
- `growth`, the derivative of the multiplier's size by the parameter, is not 0,
- `lyapunov = Re(conj(mu)*cubic)` is not 0,

then for each parameter near that value, on the side with the sign of `-lyapunov/growth`, one closed invariant curve
surrounds the fixed point nearby, and shrinks to it. It attracts if `lyapunov < 0` and repels if `lyapunov > 0`. The
curve has any finite smoothness near enough to the value. In the angle of `z` the map on the curve tends to the rotation
by `omega`.

**Irrational rotation.** The curves are graphs over that angle with a common Lipschitz bound, and there is one for each
parameter, so they depend on the parameter continuously, and so does the rotation number. It tends to `omega/(2*pi)`.
Suppose that `omega/(2*pi)` is irrational. Then the rotation number is constant, or takes all values of an interval: in
both cases it is irrational for parameters arbitrarily near. For these the map on the curve, which is twice
differentiable, is conjugate to an irrational rotation [Denjoy1932]. And `omega/(2*pi)` is irrational whenever
`2*cos(omega)` is rational and not an integer: otherwise `exp(i*omega)` would be a root of unity and twice its real part
an algebraic integer. So the trace is prescribed, and two parameters are the unknowns.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from flint import acb, arb
from sympy import Expr, Rational

from symbolic.expressions.text import constant, load
from verification.arithmetic.balls import Arithmetic, balls, bits_of, exact_balls, working
from verification.arithmetic.iteration import Vector
from verification.arithmetic.series import Jet, jets
from verification.cycles.chain import Chain, Elimination, dot
from verification.cycles.chords import Chords
from verification.cycles.newton import refined
from verification.cycles.problem import bordering_slopes
from verification.cycles.recurrence import IDENTITY, Recurrence, Terms
from verification.maps.first_hit import closes_smoothly, convex, inside, minimal
from verification.proofs.periodic.interval_newton import Enclosure, ZeroStatus, interval_newton

TRACE = "trace"
GUARD = 128  # extra bits
MARGIN = 6  # extra digits of the start


@dataclass(frozen=True)
class Rotating:
    """The system for a cycle with multipliers `exp(+-i*omega)`: the unknowns are its bounces and two `free` numbers.

    The `free` numbers are parameters, or `trace = 2*cos(omega)`; the other parameters are `fixed`. Besides the rules
    there is one complex equation: the linearised rules are singular for vectors that a round multiplies by `mu`.

    >>> from verification.cycles.newton import floats
    >>> from verification.cycles.recurrence import delayed
    >>> [round(x, 12) for x in floats(Rotating(delayed(1), ("r", "trace")), [0.45, 2.05, 0.9])]
    [0.5, 2.0, 1.0]
    """

    ring: Recurrence
    free: tuple[str, str]
    fixed: Mapping[str, Expr] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """The name of the system in messages."""
        return f"torus bifurcation of {self.ring.label}"

    @property
    def irrational(self) -> bool:
        """True if the trace is fixed, rational and not an integer; then `omega/(2*pi)` is irrational."""
        trace = self.fixed.get(TRACE)
        return isinstance(trace, Rational) and not trace.is_integer

    def at(self, arithmetic: Arithmetic, z: Vector) -> dict[str, Any]:
        """The values of the parameters and of the trace, by name, fixed or unknown."""
        given = {name: load(constant(value), arithmetic)()[0] for name, value in self.fixed.items()}
        return given | dict(zip(self.free, z[self.ring.period :], strict=True))

    def value(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """The residuals `F(z)`."""
        return Rotation(self, arithmetic, z, 1).value

    def solved(self, arithmetic: Arithmetic, z: Vector, r: Vector) -> Vector:
        """The solution `F'(z)^-1 r` of the linearised system."""
        return Rotation(self, arithmetic, z).solve(r)

    def newton(self, arithmetic: Arithmetic, z: Vector) -> Vector:
        """Newton's correction `F'(z)^-1 F(z)`."""
        here = Rotation(self, arithmetic, z)
        return here.solve(here.value)


class Rotation:
    """Equations of a cycle with complex multipliers, their derivatives and normal form, at a point or over a box.

    The *bordering function* is the last pivot of the linearised rules for vectors that a round multiplies by `mu`; it
    is 0 where there are such vectors.
    """

    def __init__(self, problem: Rotating, arithmetic: Arithmetic, z: Vector, order: int = 2) -> None:
        self.problem, self.arithmetic = problem, arithmetic
        self.ring, n = problem.ring, problem.ring.period
        self.closure, self.angle = self.ring.closure, self.ring.closure.angle(arithmetic)
        self.x, self.at = z[:n], problem.at(arithmetic, z)
        half = (self.at[TRACE] + 0 * self.x[0]) / 2  # converts an integer to their kind of number
        self.mu = complex_number(half, arithmetic.sqrt(1 - half * half))
        padded, rule = self.closure.padded(self.x, self.angle), self.ring.over(arithmetic)
        self.terms = Terms.along([rule(i, padded[i : i + 3], self.at, order) for i in range(n)])
        self.plain, self.critical = self.closed(1), self.closed(self.mu)
        self.value: Vector = [*self.terms.value, self.critical.bordering.real, self.critical.bordering.imag]

    def closed(self, sign: Any) -> Elimination:
        """The factorised linearised rules, for vectors that a round multiplies by `sign`."""
        return Elimination(Chain(*self.terms.slope, self.closure.turn * sign))

    @property
    def turn(self) -> Any:
        """The derivative of the bordering function by the multiplier; 0 if and only if the multiplier is multiple."""
        lower, _, upper = self.terms.slope
        v, w, back = self.critical.right, self.critical.left, self.mu.conjugate()
        return self.closure.turn * (w[-1] * upper[-1] * v[0] - back * back * w[0] * lower[0] * v[-1])

    def speeds(self, names: Sequence[str]) -> tuple[Vector, list[tuple[Vector, Any]]]:
        """Derivatives of the bordering function by the bounces; and by each parameter, with the motion of the cycle."""
        by_bounce, by = bordering_slopes(self.terms, self.closure, self.critical.right, self.critical.left, self.mu)
        found = []
        for name in names:
            if name == TRACE:
                zero = 0 * self.x[0]
                along = complex_number(zero + 1, -self.mu.real / self.mu.imag) / 2  # d mu/d trace
                found.append(([zero] * len(self.x), self.turn * along))
            else:
                motion = self.plain.solve([-d for d in self.terms.by[name]])
                found.append((motion, by[name] + dot(by_bounce, motion)))
        return by_bounce, found

    def solve(self, r: Vector) -> Vector:
        """The solution of the linearised system for the right side `r`."""
        by_bounce, ((first, a), (second, b)) = self.speeds(self.problem.free)
        n = len(self.x)
        own = self.plain.solve(r[:n])
        gap = complex_number(r[n], r[n + 1]) - dot(by_bounce, own)
        area = _area(a, b)
        p, q = _area(gap, b) / area, _area(a, gap) / area
        return [*(x + p * u + q * v for x, u, v in zip(own, first, second, strict=True)), p, q]

    def drift(self, parameter: str) -> Any:
        """`conj(mu)` times the derivative of the multiplier by a parameter, along the cycle, with all others fixed.

        Its real part is the derivative of the multiplier's size, its imaginary part that of its angle.
        """
        ((_, speed),) = self.speeds([parameter])[1]
        return -self.mu.conjugate() * speed / self.turn

    def cubic(self) -> Any:
        """The module's `conj(mu)*cubic`, for `z` scaled so that the last bounce moves by `2*Re(z)`."""
        words, mu = self.arithmetic, self.mu
        half, root = words.q(1, 2), words.sqrt(words.q(3, 4))
        phases = [complex_number(2 * half, 0 * half), complex_number(-half, root), complex_number(-half, -root)]
        second = [self.expanded(phase, []) for phase in phases]
        h20 = self.closed(mu * mu).solve([-x for x in harmonic(phases, second, 2)])
        h11 = self.plain.solve([-x.real for x in harmonic(phases, second, 0)])
        third = [self.expanded(phase, list(zip(h20, h11, strict=True))) for phase in phases]
        return -mu.conjugate() * dot(self.critical.left, harmonic(phases, third, 1)) / self.turn

    def expanded(self, phase: Any, bent: Sequence[tuple[Any, Any]]) -> Vector:
        """The coefficients of `e**2` in the rules along `z = e*phase`; or of `e**3`, if `bent` has the `(h20, h11)`."""
        rule, order = self.ring.over(jets(self.arithmetic)), 3 if bent else 2

        def at(i: int, phase: Any) -> Jet:
            first = 2 * (self.critical.right[i] * phase).real
            second = [2 * (h20 * phase * phase).real + h11 for h20, h11 in bent[i : i + 1]]
            return Jet(self.x[i], first, *second, 0)

        n = len(self.x)
        before = self.closure.carried(at(n - 1, phase * self.mu.conjugate()), self.angle, -1)
        after = self.closure.carried(at(0, phase * self.mu), self.angle, 1)
        ring = [before, *(at(i, phase) for i in range(n)), after]
        return [rule(i, ring[i : i + 3], self.at, 0).value.c[order] for i in range(n)]


def complex_number(real: Any, imaginary: Any) -> Any:
    """A complex number of the same kind as its real and imaginary part.

    >>> complex_number(1.0, 2.0)
    (1+2j)
    """
    if isinstance(real, arb):
        return acb(real, imaginary)
    return real.context.mpc(real, imaginary) if hasattr(real, "context") else complex(real, imaginary)


def harmonic(phases: Sequence[Any], rows: Sequence[Vector], k: int) -> Vector:
    """The Fourier coefficients of `phase**k`, from values at equally spaced phases on the circle."""
    turned = [phase.conjugate() ** k for phase in phases]
    return [dot(turned, column) / len(phases) for column in zip(*rows, strict=True)]


def _area(a: Any, b: Any) -> Any:
    return a.real * b.imag - a.imag * b.real


@dataclass(frozen=True)
class Torus:
    """A torus bifurcation: the checklist of the theorem, and the enclosed numbers in it.

    `growth` is the derivative of the multiplier's modulus by the varied parameter; the sign of `lyapunov` decides
    whether the closed curves attract or repel.
    """

    problem: Rotating
    enclosure: Enclosure
    checks: dict[str, bool | None]
    growth: arb
    lyapunov: arb

    @property
    def certified(self) -> bool:
        """True if every item of the checklist is proved."""
        return all(value is True for value in self.checks.values())

    @property
    def attracting(self) -> bool | None:
        """True if the closed curve attracts, False if it repels, None if undecided."""
        return True if self.lyapunov < 0 else False if self.lyapunov > 0 else None

    @property
    def side(self) -> int:
        """The sign 1 if the curve exists for larger values of the parameter, -1 if for smaller ones, 0 if undecided."""
        way = -self.lyapunov * self.growth
        return 1 if way > 0 else -1 if way < 0 else 0


def torus(problem: Rotating, start: Sequence[Any], parameter: str, digits: int = 20) -> Torus:
    """The torus bifurcation near `start` as `parameter` varies, with its checklist.

    >>> from verification.cycles.recurrence import delayed
    >>> found = torus(Rotating(delayed(1), ("r", "trace")), [0.45, 2.05, 1.0], "r")  # six rounds make a turn
    >>> found.certified, found.attracting, found.side, found.problem.irrational
    (True, True, 1, False)
    """
    solution = refined(problem, start, digits + MARGIN)
    bits = bits_of(digits, GUARD)
    with working(bits):
        found = interval_newton(problem, exact_balls(solution.z), (arb(10) ** -digits).mid(), bits)
        if found.status is not ZeroStatus.UNIQUE:
            return Torus(problem, found, {"exists": None}, arb("nan"), arb("nan"))
        at = Rotation(problem, balls(bits), found.zero)
        growth, lyapunov, trace = at.drift(parameter).real, at.cubic().real, 2 * at.mu.real
        checks: dict[str, bool | None] = {
            "exists": True,
            "nonresonant": nonzero(trace, trace + 1)
            if abs(trace) < 2
            else None,  # mu is not real, mu**3 and mu**4 not 1
            "transversal": nonzero(growth),
            "nondegenerate": nonzero(lyapunov),
        }
        if isinstance(problem.ring, Chords):
            checks |= on_the_table(problem.ring, at)
        return Torus(problem, found, checks, growth, lyapunov)


def on_the_table(ring: Chords, at: Rotation) -> dict[str, bool | None]:
    """Further items of the checklist: the cycle is an orbit of a convex table of one smooth curve, and its minimal
    period is that of the `ring`.

    The contraction must lie between 0 and 1, so that the map has a smooth inverse.
    """
    shape = tuple(at.at[name] for name in ring.shapes)
    smooth = closes_smoothly(ring.table) and ring.law.uniform and ring.closure == IDENTITY
    placed = smooth and convex(ring.table, shape) and inside(ring.table, ring.components, at.x, shape)
    return {
        "admissible": True if placed else None,
        "minimal_period": minimal(ring.table, ring.components, at.x),
        "contraction": True if at.at["lam"] > 0 and at.at["lam"] < 1 else None,
    }


def nonzero(*values: arb) -> bool | None:
    """True if all values are proved not 0; else None."""
    return True if all(x.is_finite() and not x.contains(0) for x in values) else None
