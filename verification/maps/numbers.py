"""Number systems in which a table's programs run with many digits: mpmath, real balls and complex balls.

Each has the method `turned`, which gives cosine and sine at the cost of one of them.
"""

from operator import methodcaller
from types import SimpleNamespace
from typing import Any

from flint import acb, arb, fmpq

from numeric.backends.scalars import ScalarBackend
from verification.arithmetic.balls import FUNCTIONS


class Numbers(ScalarBackend[Any]):
    """The numbers of an mpmath context, as an arithmetic in which programs run."""

    def turned(self, x: Any) -> tuple[Any, Any]:
        """Cosine and sine."""
        found: tuple[Any, Any] = self.context.cos_sin(x)  # type: ignore[attr-defined]
        return found


class Balls(ScalarBackend[Any]):
    """Operations of ball arithmetic that a program calls: constants, roots and elementary functions."""

    context: Any = SimpleNamespace(
        root=lambda x, n: x.root(n),
        **{word: methodcaller(word) for word in FUNCTIONS},  # methods of the balls themselves
    )

    def __init__(self) -> None:
        """Accepts no context, unlike the other number systems."""

    def q(self, p: int, n: int) -> arb:
        """A ball that holds `p/n`."""
        return arb(fmpq(p, n))

    @property
    def pi(self) -> arb:
        """A ball that holds pi."""
        return arb.pi()

    def turned(self, x: Any) -> tuple[Any, Any]:
        """Cosine and sine."""
        sine, cosine = x.sin_cos()
        return cosine, sine


class ComplexBalls(Balls):
    """Analytic operations on complex balls; the result is not finite where a branch cut may meet the ball."""

    def sqrt(self, x: Any) -> Any:
        """The principal square root."""
        return x.sqrt(analytic=True)

    def log(self, x: Any) -> Any:
        """The natural logarithm."""
        return x.log(analytic=True)

    def atan(self, x: Any) -> Any:
        """The arc tangent; not finite on balls that may meet its branch cuts."""
        return x.atan() if abs(x.imag) < 1 else acb("nan")

    def root(self, x: Any, n: int) -> Any:
        """The principal `n`-th root."""
        return (x.log(analytic=True) / n).exp()

    def q(self, p: int, n: int) -> Any:
        """A ball that holds `p/n`."""
        return acb(fmpq(p, n))

    @property
    def pi(self) -> Any:
        """A ball that holds pi."""
        return acb.pi()
