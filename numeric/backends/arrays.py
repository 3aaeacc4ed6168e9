"""NumPy arrays as an arithmetic: the step function runs on them as it stands."""

from collections.abc import Callable
from typing import Any

import numpy as np

from numeric.backends import functions
from numeric.backends.roots import bracketed_zero, polynomial_zero


class Arrays:
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
