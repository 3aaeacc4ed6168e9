"""How a cycle bifurcates: the numbers of the normal form, over any kind of number.

With `v` and `w` the right and left vectors of the singular linearisation, `F` the collision rule and
`e` the amplitude along `v`, the bifurcating branch is `letter = critical + branch*e**2`:

    fold:  branch = -[e**2]F / (w . dF/dletter)
    flip:  branch = -[e**3]F / speed,     speed = d rest/d letter along the cycle,

where the coefficient of `e**3` is taken on the curve `theta + e*v + e**2*u`, `u` chosen such that
the one of `e**2` vanishes. `turn` is `d rest/d multiplier`: not 0 exactly when the multiplier is simple.
"""

from dataclasses import dataclass
from typing import Any

from verification.arithmetic.series import Jet, jets
from verification.arithmetic.words import Arithmetic
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.chain import Vector, dot, trace_and_determinant
from verification.cycles.shooting.problem import Linearised, Rows


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
