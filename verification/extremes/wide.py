"""The step of `numeric/flights` on 80-bit arrays: 64 bits of mantissa, a judge of doubles with 11 bits to spare.

What `numeric.backends.arrays` has for 53 bits is put aside here, word by word, as `numeric.backends.scalars` does it:
sines and arctangents are the C library's, and a zero is sharpened until its correction is below the unit or ceases to
shrink. Splitting for exact products, and the outcomes that stop a ball, remain as they are.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from numeric.backends import roots
from numeric.backends.arrays import Arrays
from numeric.flights.family import Family

WIDE = 2.0**-63  # the unit of rounding
PI = np.longdouble("3.14159265358979323846264338327950288")
PI_LOW = np.longdouble("-5.01655761266833202355732708033075701e-20")  # what PI lacks, to its own last bit
SHARPER = 8  # Newton steps at most, from 53 bits on
Slope = Callable[[Any], tuple[Any, Any]]


class Wide(Arrays):
    """80-bit arrays. Masks are boolean arrays."""

    splitter = 2.0**32 + 1  # halves a mantissa of 64 bits

    def constant(self, p: int, q: int = 1) -> Any:
        """The 80-bit number nearest to `p/q`."""
        return np.longdouble(p) / np.longdouble(q)

    def number(self, x: float) -> Any:
        """An 80-bit number."""
        return np.longdouble(x)

    def pi(self) -> Any:
        """The 80-bit number nearest to pi."""
        return PI

    def pi_low(self) -> Any:
        """What that number lacks."""
        return PI_LOW

    def angle(self, y: Any, x: Any) -> Any:
        """`atan2(y, x)`."""
        return np.arctan2(y, x)

    def turn(self, x: Any, quarters: int = 2) -> tuple[Any, Any]:
        """`(cos x, sin x)`."""
        return np.cos(x), np.sin(x)

    def zero(
        self,
        function: Slope,
        x: Any,
        low: Any,
        high: Any,
        scale: Any,
        newton: int,
        wanted: Any = None,
        accepts: Callable[[Any], Any] | None = None,
    ) -> Any:
        """As `bracketed_zero`, to the last bits."""
        found = roots.bracketed_zero(self, function, x, low, high, scale, newton, wanted, accepts)
        return sharpened(function, found, scale, wanted)


def sharpened(function: Slope, x: Any, scale: Any, wanted: Any = None) -> Any:
    """Newton's steps from a zero known to 53 bits, each lane until its correction is below the unit or grows.

    >>> root = sharpened(lambda x: (x * x - 2, 2 * x), np.array([np.longdouble(2.0**0.5)]), np.longdouble(1))
    >>> bool(abs(root[0] - np.sqrt(np.longdouble(2))) <= 2 * np.finfo(np.longdouble).eps)
    True
    """
    before = 0 * x + np.inf
    going = np.isfinite(x) if wanted is None else np.isfinite(x) & wanted
    for _ in range(SHARPER):
        value, slope = function(x)
        step = value / slope
        size = abs(step)
        going = going & (size < before / 2)  # a step that shrinks no more is rounding; nan is not taken either
        if not np.any(going):
            break
        x, before = np.where(going, x - step, x), np.where(going, size, before)
        going = going & (size > WIDE * np.maximum(abs(x), scale))
    return x


def made_unit(family: Family, state: list[Any]) -> list[Any]:
    """An 80-bit state, of arrays, whose pairs have length one again: as doubles they have it to 53 bits only.

    >>> from numeric import PinballMap
    >>> u, v = made_unit(PinballMap("cardioid").family, [np.array([np.longdouble(x)]) for x in (0.6, 0.8)])
    >>> bool(abs(u * u + v * v - 1)[0] <= 2.0**-63)
    True
    """
    made = list(state)
    for i in family.pairs:
        if i + 1 < len(state):
            x, y = state[i : i + 2]
            size = np.hypot(x, y)
            if i == 1:  # on a wall the first of them is a height and no pair
                size = np.where(state[0] > 0.5, 1, size)
            made[i], made[i + 1] = x / size, y / size
    return made
