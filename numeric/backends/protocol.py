"""The protocol of a backend: a number system with selection, rounding, zeros and loops, on which flights run.

`LLVMBackend`, `ArrayBackend` and `ScalarBackend` implement `Backend[N, M]` for their numbers `N` and masks `M`.
"""

from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, Protocol, TypeVar, Union

from symbolic.expressions.numbers import Mask, NumberSystem, Real

N = TypeVar("N", bound=Real)
M = TypeVar("M", bound=Mask)
Pair = tuple[N, N]
Fields = Sequence[N]  # of a state, or the parameters of a shape
Low = Union[N, Callable[[], N]]  # noqa: UP007  (a union that begins with a variable)  a lower bound, or how to find it where it is dear


def modulus(x: N) -> N:
    """`abs(x)`, typed as `x` is; the annotation of the builtin loses the type."""
    size: N = abs(x)  # type: ignore[assignment]
    return size


def bound(low: Low[N]) -> N:
    """The value of a lower bound, which may be given as a function without arguments."""
    return low() if callable(low) else low


class FormulaWords(Protocol[N]):
    """The functions that formulas may contain, in addition to those that every number system has."""

    def exp(self, x: N, /) -> N: ...
    def log(self, x: N, /) -> N: ...
    def atan(self, x: N, /) -> N: ...
    def sinh(self, x: N, /) -> N: ...
    def cosh(self, x: N, /) -> N: ...
    def tanh(self, x: N, /) -> N: ...
    def root(self, x: N, n: int, /) -> N: ...


class Backend(NumberSystem[N], FormulaWords[N], Protocol[N, M]):
    """A number system on which flights run; its masks select among numbers, particle by particle."""

    doubles: bool  # are its numbers doubles? Then known numbers may be kept as such; else they may have more digits

    @property
    def pi_low(self) -> N:
        """The number pi minus the value of `pi`."""
        ...

    def number(self, x: float, /) -> N:
        """The double `x` as a number of this system."""
        ...

    def constant(self, x: N, /) -> bool:
        """Is this a known number, the same for all particles?"""
        ...

    def same(self, x: N, y: N, /) -> bool:
        """Are two values known to be equal?"""
        ...

    def atan2(self, y: N, x: N, /) -> N:
        """The angle of the point `(x, y)`, anywhere in the plane; it is used between bounces only, never within one."""
        ...

    def angle(self, y: N, x: N, /) -> N:
        """`atan2(y, x)` for `x >= 0`."""
        ...

    def turn(self, x: N, quarters: int = 2, /) -> Pair[N]:
        """`(cos x, sin x)` for `|x| <= quarters*pi/2`."""
        ...

    def fma(self, x: N, y: N, z: N, /) -> N:
        """`x*y + z`, rounded once."""
        ...

    def product(self, x: N, y: N, /) -> N:
        """`x*y`, rounded by itself."""
        ...

    def maximum(self, x: N, y: N, /) -> N:
        """The larger of two numbers."""
        ...

    def rounded(self, x: N, /) -> N:
        """The nearest integer."""
        ...

    def with_sign(self, x: N, y: N, /) -> N:
        """`|x|` with the sign of `y`."""
        ...

    def times_sign(self, x: N, y: N, /) -> N:
        """`x` with its sign flipped where `y` is negative."""
        ...

    def two_to(self, k: N, /) -> N:
        """`2**k` for whole `k`."""
        ...

    def power_of_two(self, x: N, /) -> Pair[N]:
        """`(2**-e, e)` with `2**e <= x < 2**(e + 1)`."""
        ...

    def select(self, mask: M, x: N, y: N, /) -> N:
        """`x` where the mask holds, else `y`."""
        ...

    def negated(self, mask: M, /) -> M:
        """The opposite of a mask."""
        ...

    def look_up(self, values: Sequence[N], index: N, /) -> N:
        """The value at an index, which is a whole number; the first value if the index is out of range."""
        ...

    def look_up_row(self, rows: Sequence[Sequence[float]], index: N, /) -> list[N]:
        """The row at `index`, a list with one number for each column; the first row if the index is out of range."""
        ...

    def settle(self, *values: N) -> None:
        """Makes a compiled backend compute these values now, and not where they are first used."""
        ...

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
        /,
    ) -> N:
        """The only zero in `[low, high]` of a function that is negative at `low` and positive at `high`.

        `function` returns value and slope, `x` is a first guess, and `scale` the size below which the absolute error
        counts. After `newton` steps of Newton's method convergence is tested. `accepts` is a cheap test that a number
        is above `low`. Numbers outside the mask `wanted` need not converge.
        """
        ...

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
        /,
    ) -> N:
        """The zero of the polynomial `p`, constant first; arguments as in `zero`, `steps` of Halley, then of Newton."""
        ...

    def repeat(
        self,
        condition: Callable[[list[N]], M],
        body: Callable[[list[N]], list[N]],
        state: list[N],
        limit: int,
        steady: bool = False,
        /,
    ) -> list[N]:
        """Applies `body` to the numbers for which `condition` holds, until it holds for none, or `limit` times.

        A `steady` body does not change the numbers for which `condition` fails, so that they need no selection.
        """
        ...

    def when(self, mask: M, values: list[N], changed: Callable[[], list[N]], /) -> list[N]:
        """`changed()` for all particles if the mask holds for any, else `values`; the caller selects by particle."""
        ...


class Frame(NamedTuple, Generic[N]):
    """Points of the boundary with the unit tangent there; the normal to its left points into the table."""

    x: N
    y: N
    tx: N
    ty: N

    def direction(self, ops: Backend[N, M], phi: N) -> Pair[N]:
        """The unit direction of exit angle `phi`."""
        c, s = ops.cos(phi), ops.sin(phi)
        return s * self.tx - c * self.ty, s * self.ty + c * self.tx

    def angle(self, ops: Backend[N, M], vx: N, vy: N) -> N:
        """The angle of a direction from the inward normal, positive towards the tangent."""
        return ops.atan2(vx * self.tx + vy * self.ty, vy * self.tx - vx * self.ty)
