"""What is measured of an answer, and the verdict on whoever gave it.

With data `x`, truth `f(x)` and answer `y`, the *forward error* is `|y - f(x)|`. The *backward error* is the smallest
`(dx, dy)` with `y + dy = f(x + dx)`, to first order: what the data and the result would have to be off by for the
answer to be right ([Higham2002], section 1.5, calls this the mixed error).
The *condition number* is the largest factor between the two. Errors are absolute, in units of rounding of one.
"""

from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite

from verification.shooting.condition import ROUNDINGS, Conditioning, costs_half

SMALL = ROUNDINGS  # units: a dozen roundings, each of them explained by the data
UNIT, DIGITS = 2.0**-52, 15  # of a float64


class Stability(Enum):
    """The verdict; the value says what it means for whoever asks."""

    STABLE = "as right as rounded data allow"
    SENSITIVE = "as right as rounded data allow, which is less than half of the digits; give data with more digits"
    STOPPED = "no number: the kernel stops the ball and names the outcome"
    UNSTABLE = "wrong by more than rounded data explain; use what is named in its place"


@dataclass(frozen=True)
class Measured:
    """Forward and backward error in units of rounding, and the condition number between them."""

    forward: float
    backward: float
    condition: float

    @property
    def ratio(self) -> float:
        """`error / (cond * eps)`; at most 1 means that one rounding of the data would have done as much."""
        return self.forward / self.condition if isfinite(self.condition) else 0.0

    @property
    def stability(self) -> Stability:
        """The verdict.

        >>> Measured(forward=4e3, backward=2, condition=1e4).stability.name
        'STABLE'
        >>> Measured(forward=4e3, backward=2e3, condition=2).stability.name
        'UNSTABLE'
        """
        if not self.backward <= SMALL:
            return Stability.UNSTABLE
        return Stability.SENSITIVE if costs_half(self.condition, UNIT, DIGITS) else Stability.STABLE


WRONG = Measured(inf, inf, 1.0)  # another component, or no number at all


@dataclass(frozen=True)
class Finding:
    """One kernel on one case: the worst answer of all starts, what stopped, and what to do instead.

    `named` is what the kernel itself says of its condition number, where it says anything; `reason` is what the
    verdict is due to, where it is not plainly stable.
    """

    case: str
    kernel: str
    measured: Measured | None
    status: str = ""
    instead: str = ""
    named: Conditioning | None = None
    reason: str = ""

    @property
    def stability(self) -> Stability:
        """The verdict on the worst start; a kernel that gave no number at all has stopped.

        How sensitive the answer is is taken from what the kernel names, not from what was measured of it.

        >>> Finding("fold", "Newton", Measured(4e9, 0.5, 8e12), named=Conditioning.SENSITIVE).stability.name
        'SENSITIVE'
        """
        if self.measured is None:
            return Stability.STOPPED
        if self.named is None or self.measured.stability is Stability.UNSTABLE:
            return self.measured.stability
        return Stability.STABLE if self.named is Conditioning.SOUND else Stability.SENSITIVE
