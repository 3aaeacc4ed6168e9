"""The kernels that bounce one ball from one rounded state: LLVM, NumPy, 80-bit floats, mpmath with 16 digits.

All four run the step of `numeric/flights`; `TEXTBOOK` is the quadratic formula that one would write first, kept to
show that the measure tells it apart.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
from sympy import N

from numeric import PinballMap
from numeric.backends.scalars import Scalars
from numeric.flights.harmonic import Ellipse
from numeric.flights.status import Status
from numeric.kernels.spec import KernelSpec
from verification.extremes.wide import WIDE, Wide, made_unit

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
