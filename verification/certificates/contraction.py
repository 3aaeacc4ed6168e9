"""One zero in a box, proved: the interval Newton operator, by elimination along the cycle.

For a box `X` with midpoint `m`, every zero in `X` lies in `N = m - F'(X)^-1 F(m)`, and when `N` lies
in the interior of `X` there is exactly one. `F'(X)^-1` is applied by elimination in balls, in linear
time (see `verification.shooting.chain`); it plays the part that a preconditioner has in Krawczyk's
operator, and contracts at least as well.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any

from flint import arb

from verification.arithmetic import balls, working
from verification.shooting.newton import System


class Status(Enum):
    """What is proved about the zeros in a box."""

    UNIQUE = "exactly one zero in the box"
    EMPTY = "no zero in the box"
    UNKNOWN = "nothing proved; try a smaller box or more bits"


@dataclass(frozen=True)
class Enclosure:
    """A status, and balls that contain every zero of the box that was examined."""

    status: Status
    zero: list[arb]


def contraction(system: System, centre: list[arb], radius: arb, bits: int) -> Enclosure:
    """What the interval Newton operator proves about the box of `radius` around exact `centre`.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.shooting.problem import Problem
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3))
    >>> with working(100):
    ...     near, off = [arb("1.5707963268"), arb("-1.5707963268")], [arb("0.5"), arb("-1.5")]
    >>> [contraction(axis, [x.mid() for x in c], arb("1e-9"), 100).status.name for c in (near, off)]
    ['UNIQUE', 'EMPTY']
    """
    with working(bits):
        box = [arb(x, radius) for x in centre]
        try:
            value = system.value(balls(bits), centre)
        except ZeroDivisionError:
            return Enclosure(Status.UNKNOWN, box)
        found = _image(system, value, centre, box, min(bits, slope_bits(len(centre))))
        if found.status is not Status.UNIQUE:
            found = _image(system, value, centre, box, bits)
        return found


def slope_bits(unknowns: int) -> int:
    """Bits that the derivatives need: `F` at the midpoint is tiny, so theirs need not grow with the digits.

    >>> slope_bits(3)
    144
    """
    return 128 + 8 * unknowns.bit_length()


def _image(system: System, value: list[arb], centre: list[arb], box: list[arb], bits: int) -> Enclosure:
    try:
        with working(bits):
            correction = system.solved(balls(bits), box, value)
    except ZeroDivisionError:
        return Enclosure(Status.UNKNOWN, box)
    image = [x - d for x, d in zip(centre, correction, strict=True)]
    return Enclosure(compared(image, box), image)


def compared(image: list[arb], box: list[arb]) -> Status:
    """The three answers to: does the image lie inside the box?"""
    if not all(y.is_finite() for y in image):
        return Status.UNKNOWN
    if all(x.contains_interior(y) for x, y in zip(box, image, strict=True)):
        return Status.UNIQUE
    if any(not x.overlaps(y) for x, y in zip(box, image, strict=True)):
        return Status.EMPTY
    return Status.UNKNOWN


def exact_balls(numbers: list[Any]) -> list[arb]:
    """Numbers of mpmath as exact balls, bit for bit.

    >>> import mpmath
    >>> [x.is_exact() for x in exact_balls([mpmath.mpf(1) / 3])]
    [True]
    """
    found = []
    for x in numbers:
        sign, mantissa, exponent, _ = x._mpf_
        found.append(arb((-int(mantissa) if sign else int(mantissa), int(exponent))))
    return found
