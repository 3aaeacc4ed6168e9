"""The step of `numeric/flights` on 80-bit arrays: 64 bits of mantissa, a judge of doubles with 11 bits to spare.

What `numeric.backends.arrays` has for 53 bits is put aside here, word by word, as `numeric.backends.scalars` does it:
sines and arctangents are the C library's, and a zero is sharpened until its correction is below the unit or ceases to
shrink. Splitting for exact products, and the outcomes that stop a ball, remain as they are.

The kernels that bounce one ball from one rounded state: LLVM, NumPy, 80-bit floats, mpmath with 16 digits.

All four run the step of `numeric/flights`; `TEXTBOOK` is the quadratic formula that one would write first, kept to
show that the measure tells it apart.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from sympy import N

from numeric import PinballMap
from numeric.backends import roots
from numeric.backends.arrays import Arrays
from numeric.backends.scalars import Scalars
from numeric.flights.family import Family
from numeric.flights.harmonic import Ellipse
from numeric.flights.status import Status
from numeric.kernels.spec import KernelSpec

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


DOUBLE = 2.0**-52  # the unit of rounding
GOES_ON = Status.REGULAR.name


@dataclass(frozen=True)
class Kernel:
    """A way to bounce, under the name of the tables, with its unit of rounding."""

    name: str
    unit: float = DOUBLE

    def runs(self, map: PinballMap) -> bool:
        """Is it made for this table?"""
        if self is TEXTBOOK:
            return isinstance(map.family, Ellipse) and map.law != "slap"
        return self is not LONGDOUBLE or np.finfo(np.longdouble).nmant >= 63

    def bounce(self, map: PinballMap, state: list[Any], exact: Sequence[Any] = ()) -> tuple[list[Any], str]:
        """The fields after one bounce, and the outcome that the kernel itself names.

        `exact` is the shape where no double is it: what has 80 bits rounds it for itself.
        """
        if self in (LLVM, NUMPY):
            return _compiled(map, state, self is LLVM)
        if self is TEXTBOOK:
            return textbook(map, [float(x) for x in state]), GOES_ON
        lam = float(map.lam.flat[0])
        if self is LONGDOUBLE:
            own = made_unit(map.family, [np.array([np.longdouble(x)]) for x in state])
            shape = [np.longdouble(str(N(x, 25))) for x in exact or map.exact_shape]
            with np.errstate(all="ignore"):
                fields, code = map.family.bounce(Wide(), map.law, shape, np.array([np.longdouble(lam)]), own)
            return [field[0] for field in fields], _status(code)
        context = mpmath.MPContext()
        context.prec = 53
        mpf = context.mpf
        own, shape = [mpf(float(x)) for x in state], [mpf(x) for x in map.shape]
        try:
            fields, code = map.family.bounce(Scalars(context), map.law, shape, mpf(lam), own)
        except ZeroDivisionError:
            return own, "division by zero"
        return fields, _status(code)


LLVM = Kernel("llvm")
NUMPY = Kernel("numpy")
LONGDOUBLE = Kernel("longdouble", WIDE)
MPMATH = Kernel("mpmath, 16 digits")
TEXTBOOK = Kernel("textbook discriminant")
KERNELS = LLVM, NUMPY, LONGDOUBLE, MPMATH


def textbook(map: PinballMap, state: list[float]) -> list[Any]:
    """One bounce in the ellipse by the quadratic formula, with nothing divided out and the angles as they come."""
    a, lam = map.shape[0], float(map.lam.flat[0])
    ux, uy, vx, vy = state
    x, y = a * ux, uy
    p, q, r = vx * vx / a / a + vy * vy, x * vx / a / a + y * vy, x * x / a / a + y * y - 1
    t = (-q + math.sqrt(max(q * q - p * r, 0.0))) / p
    x, y = x + t * vx, y + t * vy
    theta = math.atan2(y, x / a)
    tangent = math.atan2(math.cos(theta), -a * math.sin(theta))
    eta = math.remainder(tangent - math.atan2(vy, vx) - math.pi / 2, math.tau)
    exit = tangent + math.pi / 2 + lam * eta
    return [math.cos(theta), math.sin(theta), math.cos(exit), math.sin(exit)]


def _compiled(map: PinballMap, state: list[Any], kernels: bool) -> tuple[list[Any], str]:
    """A bounce by the engine, on LLVM lanes or on NumPy arrays."""
    engine = map.engine._replace(kernels=kernels)
    own = [np.array([float(x)]) for x in state]
    result = engine.run(KernelSpec(map.law, record=True), own, np.full(1, float(map.lam)), map.shape, 1)
    assert result.record is not None
    return [field[0] for field in result.record[0]], _status(result.rows.get("code"))


def _status(code: Any) -> str:
    return GOES_ON if code is None else list(Status)[int(np.max(np.asarray(code, dtype=float)))].name
