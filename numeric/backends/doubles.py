"""The common part of both float64 backends, arrays and LLVM vectors: elementary functions and zeros.

All of these are functions of `numeric.backends.functions`: sums, products, quotients, square roots and choices, each
rounded once. So they have the same bits on every processor, unlike those of a mathematical library.
"""

from collections.abc import Callable, Sequence
from typing import Protocol

from numeric.backends import functions
from numeric.backends.functions import angle, bracketed_zero, polynomial_zero, turn
from numeric.backends.protocol import Backend, Low, M, N, Pair, modulus


class DoubleBackend(Backend[N, M], Protocol[N, M]):
    """Shared by backends of float64: elementary functions and zeros by `numeric.backends.functions`."""

    doubles: bool = True

    def angle(self, y: N, x: N) -> N:
        """`atan2(y, x)` for `x >= 0`."""
        return angle(self, y, x)

    def turn(self, x: N, quarters: int = 2) -> Pair[N]:
        """`(cos x, sin x)` for `|x| <= quarters*pi/2`."""
        return turn(self, x, quarters)

    def atan2(self, y: N, x: N) -> N:
        """The angle of a point anywhere in the plane; a point on the left is first mirrored to the right."""
        turned = self.with_sign(self.pi, y) - (near := self.angle(y, modulus(x)))
        return self.select(x < self.number(0.0), turned, near)

    def exp(self, x: N) -> N:
        """The exponential."""
        return functions.exponential(self, x)

    def log(self, x: N) -> N:
        """The natural logarithm."""
        return functions.logarithm(self, x)

    def atan(self, x: N) -> N:
        """The arc tangent."""
        return self.angle(x, self.number(1.0))

    def sinh(self, x: N) -> N:
        """The hyperbolic sine."""
        return functions.hyperbolic(self, x, "sinh")

    def cosh(self, x: N) -> N:
        """The hyperbolic cosine."""
        return functions.hyperbolic(self, x, "cosh")

    def tanh(self, x: N) -> N:
        """The hyperbolic tangent."""
        return functions.hyperbolic(self, x, "tanh")

    def root(self, x: N, n: int) -> N:
        """The positive `n`-th root of a positive number."""
        return functions.root(self, x, n)

    def zero(
        self,
        function: Callable[[N], Pair[N]],
        x: N,
        low: Low[N],
        high: N,
        scale: N,
        newton: int,
        wanted: M | None = None,
        accepts: Callable[[N], M] | None = None,
    ) -> N:
        """The only zero of `function` in `[low, high]`; the arguments are those of `functions.bracketed_zero`."""
        return bracketed_zero(self, function, x, low, high, scale, newton, wanted, accepts)

    def polynomial_zero(
        self,
        p: Sequence[N],
        x: N,
        low: Low[N],
        high: N,
        scale: N,
        steps: tuple[int, int],
        wanted: M | None = None,
        accepts: Callable[[N], M] | None = None,
    ) -> N:
        """The only zero of a polynomial in `[low, high]`; the arguments are those of `functions.polynomial_zero`."""
        return polynomial_zero(self, p, x, low, high, scale, steps, wanted, accepts)
