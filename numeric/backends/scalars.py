"""NumPy arrays, and single numbers of any precision, as backends: flights run on them unchanged.

The library of single numbers, mpmath or one like it, is handed in as a `Context`, never imported. It provides the
elementary functions, and every zero is found to its full precision.
"""

from collections.abc import Callable, Sequence
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from numeric.backends import functions
from numeric.backends.doubles import DoubleBackend
from numeric.backends.functions import value_and_slope
from numeric.backends.protocol import Backend, FormulaWords, Low, N, Pair, bound, modulus

Array = NDArray[np.float64]
Masks = NDArray[np.bool_]
Unary = Callable[[Array], Array]
Binary = Callable[[Array, Array], Array]


class ArrayBackend(DoubleBackend[Array, Masks]):
    """Float64 arrays. Masks are boolean arrays."""

    splitter = 2.0**27 + 1  # halves a mantissa of 53 bits

    def q(self, p: int, n: int) -> Array:
        """The double nearest to `p/n`."""
        return self.number(p / n)

    def number(self, x: float) -> Array:
        """The double `x`, which stands for an array of any shape."""
        return cast(Array, x)

    def constant(self, x: Array) -> bool:
        """Is this one number for all particles, and no array?"""
        return not np.ndim(x)

    def same(self, x: Array, y: Array) -> bool:
        """Are two values equal everywhere?"""
        return x is y or bool(np.all(x == y))

    @property
    def pi(self) -> Array:
        """The double nearest to pi."""
        return self.number(np.pi)

    @property
    def pi_low(self) -> Array:
        """Pi minus the double nearest to it."""
        return self.number(2 * functions.HALF_PI_LOW)

    sqrt = staticmethod(cast(Unary, np.sqrt))
    sin = staticmethod(cast(Unary, np.sin))
    cos = staticmethod(cast(Unary, np.cos))
    select = staticmethod(cast(Callable[[Masks, Array, Array], Array], np.where))
    maximum = staticmethod(cast(Binary, np.maximum))
    rounded = staticmethod(cast(Unary, np.rint))
    with_sign = staticmethod(cast(Binary, np.copysign))
    negated = staticmethod(cast(Callable[[Masks], Masks], np.logical_not))

    def times_sign(self, x: Array, y: Array) -> Array:
        """`x` with its sign flipped where `y` is negative."""
        return np.where(np.signbit(y), -x, x)

    def fma(self, x: Array, y: Array, z: Array) -> Array:
        """`x*y + z` from an exact product and an exact sum; no hardware instruction is assumed."""
        product = x * y
        xs, ys = self.splitter * x, self.splitter * y
        xh, yh = xs - (xs - x), ys - (ys - y)
        xl, yl = x - xh, y - yh
        product_low = ((xh * yh - product) + xh * yl + xl * yh) + xl * yl
        total = product + z
        back = total - product
        total_low = (product - (total - back)) + (z - back)
        return total + (product_low + total_low)

    def two_to(self, k: Array) -> Array:
        """`2**k` for whole `k`."""
        return np.ldexp(1.0, np.asarray(k).astype(np.int64))

    def product(self, x: Array, y: Array) -> Array:
        """`x*y`, rounded by itself."""
        return x * y

    def look_up(self, values: Sequence[Array], index: Array) -> Array:
        """The value at an index; the first value if the index is out of range."""
        known = (index >= 0.0) & (index < len(values))
        return np.asarray(values)[np.where(known, index, 0.0).astype(np.int64)]

    def look_up_row(self, rows: Sequence[Sequence[float]], index: Array) -> list[Array]:
        """The row at `index`, a list with one number for each column; the first row if the index is out of range."""
        known = (index >= 0.0) & (index < len(rows))
        found = np.asarray(rows)[np.where(known, index, 0.0).astype(np.int64)]
        return [found[..., i] for i in range(found.shape[-1])]

    def settle(self, *values: Array) -> None:
        """Nothing to do: every value is computed where it stands."""

    def power_of_two(self, x: Array) -> Pair[Array]:
        """`(2**-e, e)` with `2**e <= x < 2**(e + 1)`."""
        exponent = np.frexp(x)[1] - 1.0
        return np.ldexp(1.0, -exponent.astype(np.int64)), exponent

    def repeat(
        self,
        condition: Callable[[list[Array]], Masks],
        body: Callable[[list[Array]], list[Array]],
        state: list[Array],
        limit: int,
        steady: bool = False,
    ) -> list[Array]:
        """Applies `body` to the elements for which `condition` holds, until it holds for none, or `limit` times.

        A `steady` body does not change the elements for which `condition` fails.
        """
        for _ in range(limit):
            active = condition(state)
            if not np.any(active):
                break
            changed = body(state)
            state = changed if steady else [np.where(active, x, y) for x, y in zip(changed, state, strict=True)]
        return state

    def when(self, mask: Masks, values: list[Array], changed: Callable[[], list[Array]]) -> list[Array]:
        """`changed()` for all elements if the mask holds for any, else `values`; the caller selects by element."""
        return changed() if np.any(mask) else values


def array_arithmetic(digits: int) -> tuple[ArrayBackend, Callable[..., Array]]:
    """The number system of float64 arrays, and a function that runs a kernel on it; `digits` has no effect.

    The kernel's arguments are broadcast against each other. A result that is a matrix has its rows and columns on the
    first two axes. Numbers have 16 digits.
    """

    def run(
        function: Callable[..., tuple[Array, ...]], arguments: Sequence[object], shape: Sequence[int] | None
    ) -> Array:
        found = function(*(np.asarray(x, dtype=float) for x in arguments))
        values = np.broadcast_arrays(*found, *(np.asarray(x, dtype=float) for x in arguments))[: len(found)]
        return values[0] if shape is None else np.stack(values).reshape(*shape, *values[0].shape)

    return ArrayBackend(), run


class Context(FormulaWords[N], Protocol[N]):
    """The names that a library of numbers must have, as in mpmath's contexts."""

    pi: N
    eps: N
    prec: int
    dps: int

    def mpf(self, x: float, /) -> N: ...
    def sqrt(self, x: N, /) -> N: ...
    def sin(self, x: N, /) -> N: ...
    def cos(self, x: N, /) -> N: ...
    def atan2(self, y: N, x: N, /) -> N: ...
    def nint(self, x: N, /) -> N: ...


class ScalarBackend(Backend[N, bool]):
    """Numbers of a multiprecision context. Masks are Python's bools."""

    doubles = False

    def __init__(self, context: Context[N]) -> None:
        self.context = context

    def q(self, p: int, n: int) -> N:
        """`p/n` to the context's precision."""
        return self.context.mpf(p) / n  # type: ignore[operator,no-any-return]  # an integer of any size, exactly

    def number(self, x: float) -> N:
        """The double `x`, converted exactly."""
        return self.context.mpf(x)

    def constant(self, x: N) -> bool:
        """True: there is one particle, so that every number is known."""
        return True

    def same(self, x: N, y: N) -> bool:
        """Are two values equal?"""
        return x is y or bool(x == y)

    @property
    def pi(self) -> N:
        """Pi to the context's precision."""
        return self.context.pi + self.number(0.0)

    @property
    def pi_low(self) -> N:
        """Zero: `pi` is as good as every other number here."""
        return self.context.mpf(0)

    def sqrt(self, x: N) -> N:
        """The square root."""
        return self.context.sqrt(x)

    def sin(self, x: N) -> N:
        """The sine."""
        return self.context.sin(x)

    def cos(self, x: N) -> N:
        """The cosine."""
        return self.context.cos(x)

    def exp(self, x: N) -> N:
        """The exponential."""
        return self.context.exp(x)

    def log(self, x: N) -> N:
        """The natural logarithm."""
        return self.context.log(x)

    def atan(self, x: N) -> N:
        """The arc tangent."""
        return self.context.atan(x)

    def sinh(self, x: N) -> N:
        """The hyperbolic sine."""
        return self.context.sinh(x)

    def cosh(self, x: N) -> N:
        """The hyperbolic cosine."""
        return self.context.cosh(x)

    def tanh(self, x: N) -> N:
        """The hyperbolic tangent."""
        return self.context.tanh(x)

    def root(self, x: N, n: int) -> N:
        """The positive `n`-th root of a positive number."""
        return self.context.root(x, n)

    def two_to(self, k: N) -> N:
        """`2**k`."""
        return self.context.exp(k * self.context.log(self.number(2.0)))

    def look_up(self, values: Sequence[N], index: N) -> N:
        """The entry of `values` at an index."""
        return values[int(index)]  # type: ignore[call-overload]

    def look_up_row(self, rows: Sequence[Sequence[float]], index: N) -> list[N]:
        """The numbers of the row at an index."""
        return [self.number(x) for x in rows[int(index)]]  # type: ignore[call-overload]

    def settle(self, *values: N) -> None:
        """Nothing to do: every value is computed where it stands."""

    def atan2(self, y: N, x: N) -> N:
        """The angle of the point `(x, y)`, anywhere in the plane."""
        return self.context.atan2(y, x)

    def angle(self, y: N, x: N) -> N:
        """`atan2(y, x)`."""
        return self.context.atan2(y, x)

    def turn(self, x: N, quarters: int = 2) -> Pair[N]:
        """`(cos x, sin x)` for any `x`: the bound `quarters` is not needed."""
        return self.context.cos(x), self.context.sin(x)

    def select(self, mask: bool, x: N, y: N) -> N:
        """`x` if the mask holds, else `y`."""
        return x if mask else y

    def maximum(self, x: N, y: N) -> N:
        """The larger of two numbers."""
        return y if x < y else x

    def with_sign(self, x: N, y: N) -> N:
        """`|x|` with the sign of `y`."""
        return -modulus(x) if y < self.number(0.0) else modulus(x)

    def times_sign(self, x: N, y: N) -> N:
        """`x` with its sign flipped where `y` is negative."""
        return -x if y < self.number(0.0) else x

    def rounded(self, x: N) -> N:
        """The nearest integer."""
        return self.context.nint(x)

    def negated(self, mask: bool) -> bool:
        """The opposite of a mask."""
        return not mask

    def fma(self, x: N, y: N, z: N) -> N:
        """`x*y + z`."""
        return x * y + z

    def product(self, x: N, y: N) -> N:
        """`x*y`."""
        return x * y

    def power_of_two(self, x: N) -> Pair[N]:
        """`(1, 0)`: no scaling is needed, as exponents have no bound."""
        return self.context.mpf(1), self.context.mpf(0)

    def polynomial_zero(
        self,
        p: Sequence[N],
        x: N,
        low: Low[N],
        high: N,
        scale: N,
        steps: tuple[int, int],
        wanted: bool | None = None,
        accepts: Callable[[N], bool] | None = None,
    ) -> N:
        """The zero of a polynomial that is negative at `low` and positive at `high`, to full precision."""
        return self.zero(lambda at: value_and_slope(p, at), x, low, high, scale, steps[1], wanted)

    def zero(
        self,
        function: Callable[[N], Pair[N]],
        x: N,
        low: Low[N],
        high: N,
        scale: N,
        newton: int,
        wanted: bool | None = None,
        accepts: Callable[[N], bool] | None = None,
    ) -> N:
        """The zero by safeguarded Newton steps, until the correction is below the context's rounding."""
        if wanted is not None and not wanted:
            return x
        bottom, top = bound(low), high
        last, half, nought = top - bottom, self.number(0.5), self.number(0.0)
        if not bottom < x < top:
            x = (bottom + top) * half
        for _ in range(50 * self.context.prec):
            value, slope = function(x)
            if value == nought:
                return x
            bottom, top = (x, top) if value < nought else (bottom, x)
            step = value / slope if slope != nought else top - bottom
            new = x - step
            if not (bottom < new < top and modulus(step) <= last * half):
                new = (bottom + top) * half
            last, x = modulus(new - x), new
            if last <= self.maximum(modulus(x), scale) * self.context.eps:
                return x
        raise ArithmeticError(f"no zero found in [{bottom}, {top}] to {self.context.dps} digits")

    def repeat(
        self,
        condition: Callable[[list[N]], bool],
        body: Callable[[list[N]], list[N]],
        state: list[N],
        limit: int,
        steady: bool = False,
    ) -> list[N]:
        """Applies `body` while `condition` holds."""
        while condition(state):
            state = body(state)
        return state

    def when(self, mask: bool, values: list[N], changed: Callable[[], list[N]]) -> list[N]:
        """`changed()` if the mask holds, else `values`."""
        return changed() if mask else values
