"""How a periodic orbit closes: by the identity, or by a symmetry of the table that carries a part of it to the next."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

from verification.arithmetic.words import Arithmetic


@dataclass(frozen=True)
class Closure:
    """`x[n] = turn*x[0] + 2*pi*p/q` with `shift = (p, q)`; an orbit that closes by the identity is a whole cycle.

    Half of a mirror-symmetric cycle has `turn = -1`; one bounce of a polygon turns by `p/q`.
    """

    turn: int = 1
    shift: tuple[int, int] = (0, 1)

    @property
    def radians(self) -> float:
        """The shift in float64."""
        p, q = self.shift
        return 2 * pi * p / q

    def angle(self, words: Arithmetic) -> Any:
        """The shift in radians, in any kind of number."""
        p, q = self.shift
        return 2 * words["pi"] * words["q"](p, q) if p else 0

    def padded(self, x: Sequence[Any], angle: Any) -> list[Any]:
        """`x[-1], x[0], ..., x[n]`, with the shift's `angle` in the same numbers.

        >>> Closure(-1).padded([1, 2], 0)
        [-2, 1, 2, -1]
        """
        return [self.turn * (x[-1] - angle), *x, self.turn * x[0] + angle]

    def carried(self, x: Any, angle: Any, rounds: int) -> Any:
        """`x` carried ahead by so many rounds of the orbit, or back."""
        for _ in range(abs(rounds)):
            x = self.turn * x + angle if rounds > 0 else self.turn * (x - angle)
        return x

    def twice(self) -> "Closure":
        """How the orbit run through twice closes.

        >>> Closure(-1, (2, 3)).twice(), Closure(1, (1, 3)).twice()
        (Closure(turn=1, shift=(0, 1)), Closure(turn=1, shift=(2, 3)))
        """
        p, q = self.shift
        return IDENTITY if self.turn == -1 or p == 0 else Closure(1, (2 * p, q))


IDENTITY, MIRROR = Closure(), Closure(-1)
