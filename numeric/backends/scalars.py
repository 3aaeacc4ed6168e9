"""NumPy arrays as an arithmetic: the step function runs on them as it stands.

Single numbers of any precision as an arithmetic: what mpmath, or any library like it, provides.

The library is handed in, never imported: a context with `mpf`, `pi`, `sqrt`, `sin`, `cos` and
`atan2`. Elementary functions are the context's own and every zero is found to its full precision.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from numeric.backends import functions
from numeric.backends.functions import bracketed_zero, polynomial_zero, value_and_slope


class ArrayBackend:
    """Float64 arrays. Masks are boolean arrays."""

    splitter = 2.0**27 + 1  # halves a mantissa of 53 bits

    zero = bracketed_zero
    polynomial_zero = polynomial_zero

    def constant(self, p: int, q: int = 1) -> Any:
        """The double nearest to `p/q`."""
        return p / q

    def number(self, x: float) -> Any:
        """A double."""
        return x

    def pi(self) -> Any:
        """The double nearest to pi."""
        return np.pi

    def pi_low(self) -> Any:
        """What that double lacks."""
        return 2 * functions.HALF_PI_LOW

    sqrt = staticmethod(np.sqrt)
    atan2 = staticmethod(np.arctan2)
    sin = staticmethod(np.sin)
    cos = staticmethod(np.cos)
    select = staticmethod(np.where)
    maximum = staticmethod(np.maximum)
    rounded = staticmethod(np.rint)
    with_sign = staticmethod(np.copysign)
    negated = staticmethod(np.logical_not)

    def times_sign(self, x: Any, y: Any) -> Any:
        """`x` with its sign flipped where `y` is negative."""
        return np.where(np.signbit(y), -x, x)

    def fma(self, x: Any, y: Any, z: Any) -> Any:
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

    def product(self, x: Any, y: Any) -> Any:
        """`x*y`, rounded by itself."""
        return x * y

    def settle(self, *values: Any) -> None:
        """Nothing to do: every value is computed where it stands."""

    def angle(self, y: Any, x: Any) -> Any:
        """`atan2(y, x)` for `x >= 0`."""
        return functions.angle(self, y, x)

    def turn(self, x: Any, quarters: int = 2) -> tuple[Any, Any]:
        """`(cos x, sin x)`."""
        return functions.turn(self, x, quarters)

    def power_of_two(self, x: Any) -> tuple[Any, Any]:
        """`(2**-e, e)` with `2**e <= x < 2**(e + 1)`."""
        exponent = np.frexp(x)[1] - 1.0
        return np.ldexp(1.0, -exponent.astype(np.int64)), exponent

    def repeat(
        self,
        condition: Callable[[list[Any]], Any],
        body: Callable[[list[Any]], list[Any]],
        state: list[Any],
        limit: int,
    ) -> list[Any]:
        """Apply `body` to the elements for which `condition` holds, until it holds for none."""
        for _ in range(limit):
            active = condition(state)
            if not np.any(active):
                break
            state = [np.where(active, new, old) for new, old in zip(body(state), state, strict=True)]
        return state

    def when(self, mask: Any, values: list[Any], changed: Callable[[], list[Any]]) -> list[Any]:
        """`changed()` if the mask holds anywhere, else `values`; selecting is the caller's affair."""
        return changed() if np.any(mask) else values


class ScalarBackend:
    """Numbers of a multiprecision context. Masks are Python's bools."""

    def __init__(self, context: Any) -> None:
        self.context = context

    def constant(self, p: int, q: int = 1) -> Any:
        """`p/q` to the context's precision."""
        return self.context.mpf(p) / q

    def number(self, x: float) -> Any:
        """A double, exactly."""
        return self.context.mpf(x)

    def pi(self) -> Any:
        """Pi to the context's precision."""
        return +self.context.pi

    def pi_low(self) -> Any:
        """Nothing: `pi` is as good as every other number here."""
        return self.context.mpf(0)

    def sqrt(self, x: Any) -> Any:
        """The square root."""
        return self.context.sqrt(x)

    def sin(self, x: Any) -> Any:
        """The sine."""
        return self.context.sin(x)

    def cos(self, x: Any) -> Any:
        """The cosine."""
        return self.context.cos(x)

    def settle(self, *values: Any) -> None:
        """Nothing to do: every value is computed where it stands."""

    def atan2(self, y: Any, x: Any) -> Any:
        """The angle of the point `(x, y)`, anywhere in the plane."""
        return self.context.atan2(y, x)

    def angle(self, y: Any, x: Any) -> Any:
        """`atan2(y, x)`."""
        return self.context.atan2(y, x)

    def turn(self, x: Any, quarters: int = 2) -> tuple[Any, Any]:
        """`(cos x, sin x)`."""
        return self.context.cos(x), self.context.sin(x)

    def select(self, mask: Any, x: Any, y: Any) -> Any:
        """`x` if the mask holds, else `y`."""
        return x if mask else y

    def maximum(self, x: Any, y: Any) -> Any:
        """The larger one."""
        return max(x, y)

    def with_sign(self, x: Any, y: Any) -> Any:
        """`|x|` with the sign of `y`."""
        return -abs(x) if y < 0 else abs(x)

    def times_sign(self, x: Any, y: Any) -> Any:
        """`x` with its sign flipped where `y` is negative."""
        return -x if y < 0 else x

    def negated(self, mask: Any) -> Any:
        """The opposite of a mask."""
        return not mask

    def fma(self, x: Any, y: Any, z: Any) -> Any:
        """`x*y + z`."""
        return x * y + z

    def product(self, x: Any, y: Any) -> Any:
        """`x*y`."""
        return x * y

    def power_of_two(self, x: Any) -> tuple[Any, Any]:
        """No scaling is needed where exponents have no bound."""
        return self.context.mpf(1), self.context.mpf(0)

    def polynomial_zero(
        self,
        p: list[Any],
        x: Any,
        low: Any,
        high: Any,
        scale: Any,
        steps: tuple[int, int],
        wanted: Any = None,
        accepts: Callable[[Any], Any] | None = None,
    ) -> Any:
        """The zero of a polynomial, negative at `low` and positive at `high`, to full precision."""
        return self.zero(lambda at: value_and_slope(p, at), x, low, high, scale, steps[1], wanted)

    def zero(
        self,
        function: Callable[[Any], tuple[Any, Any]],
        x: Any,
        low: Any,
        high: Any,
        scale: Any,
        newton: int,
        wanted: Any = None,
        accepts: Callable[[Any], Any] | None = None,
    ) -> Any:
        """Safeguarded Newton until the correction drops below the context's rounding."""
        if wanted is not None and not wanted:
            return x
        low = low() if callable(low) else low
        last = high - low
        if not low < x < high:
            x = (low + high) / 2
        for _ in range(50 * self.context.prec):
            value, slope = function(x)
            if value == 0:
                return x
            low, high = (x, high) if value < 0 else (low, x)
            step = value / slope if slope != 0 else high - low
            new = x - step
            if not (low < new < high and 2 * abs(step) <= last):
                new = (low + high) / 2
            last, x = abs(new - x), new
            if last <= max(abs(x), scale) * self.context.eps:
                return x
        raise ArithmeticError(f"no zero found in [{low}, {high}] to {self.context.dps} digits")

    def repeat(
        self,
        condition: Callable[[list[Any]], Any],
        body: Callable[[list[Any]], list[Any]],
        state: list[Any],
        limit: int,
    ) -> list[Any]:
        """Apply `body` while `condition` holds."""
        while condition(state):
            state = body(state)
        return state

    def when(self, mask: Any, values: list[Any], changed: Callable[[], list[Any]]) -> list[Any]:
        """`changed()` if the mask holds, else `values`."""
        return changed() if mask else values
