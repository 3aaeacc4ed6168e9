"""The bifurcations of cycles: one list, and for each the equation that defines it.

    fold                 det(M - 1) = 0 and the branch turns in the parameter
    pitchfork            det(M - 1) = 0, the branch goes straight on, half of the cycle flips
    branch point         det(M - 1) = 0, the branch goes straight on, no symmetry is broken
    period doubling      det(M + 1) = 0
    Neimark-Sacker       det M = 1 with multipliers on the unit circle
    neutral saddle       det M = 1 with real multipliers: no bifurcation
    border collision     a bounce meets a join of the boundary

`M` is the monodromy matrix. A bifurcating cycle solves one equation more than it has bounces, for one parameter more:
`bordering` is 0. `verification.cycles.shooting.critical` solves for any of them, and for several at once.
"""

from collections.abc import Sequence
from enum import Enum
from typing import Any

from verification.cycles.recurrence.chain import Chain, Elimination, trace_and_determinant


class BifurcationKind(Enum):
    """What happens to a cycle as a parameter varies; the value is the field's word for it."""

    FOLD = "fold"
    PITCHFORK = "pitchfork"
    BRANCH_POINT = "branch point"
    FLIP = "period doubling"
    TORUS = "Neimark-Sacker"
    NEUTRAL_SADDLE = "neutral saddle"
    BORDER_COLLISION = "border collision"

    @property
    def multiplier(self) -> int:
        """The critical multiplier, 1 or -1, of the ring that is solved for: the part that flips, at a pitchfork.

        >>> BifurcationKind.FOLD.multiplier, BifurcationKind.PITCHFORK.multiplier
        (1, -1)
        """
        return -1 if self.solved is BifurcationKind.FLIP else 1

    @property
    def solved(self) -> "BifurcationKind | None":
        """The kind whose equations are solved for, on the part that flips at a pitchfork; None where there are none."""
        return SOLVED.get(self)

    def bordering(self, rows: Sequence[tuple[Any, Any, Any]], turn: int) -> Any:
        """The number that is 0 at the bifurcation, from the rule's three derivatives at each bounce.

        `turn` is that of the symmetry by which the ring closes.

        >>> rows = [(2, -3, 1), (2, -3, 1)]  # multipliers 1 and 4: det(M + 1) is 10
        >>> [kind.bordering(rows, 1) for kind in (BifurcationKind.FOLD, BifurcationKind.FLIP, BifurcationKind.TORUS)]
        [0.0, -3.3333333333333335, 3.0]
        """
        if self in (BifurcationKind.TORUS, BifurcationKind.NEUTRAL_SADDLE):
            return trace_and_determinant(rows, turn)[1] - 1
        if self.solved is None:
            raise ValueError(f"a {self.value} is no zero of one equation in the multipliers")
        sign = turn * self.multiplier
        if len(rows) == 1:
            ((before, here, after),) = rows
            return sign * before + here + sign * after
        lower, diagonal, upper = zip(*rows, strict=True)
        return Elimination(Chain(lower, diagonal, upper, sign)).rest


SOLVED = {
    BifurcationKind.FOLD: BifurcationKind.FOLD,
    BifurcationKind.FLIP: BifurcationKind.FLIP,
    BifurcationKind.PITCHFORK: BifurcationKind.FLIP,
}
