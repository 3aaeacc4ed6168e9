"""One zero in a box, proved: the interval Newton operator for long cycles, Krawczyk's for wide boxes around short ones.

For a box `X` with midpoint `m`, every zero in `X` lies in `N = m - F'(X)^-1 F(m)`, and when `N` lies
in the interior of `X` there is exactly one. `F'(X)^-1` is applied by elimination in balls, in linear
time (see `verification.cycles.recurrence.chain`); it plays the part that a preconditioner has in Krawczyk's
operator, and contracts at least as well.

Krawczyk's operator [Krawczyk1969] is
`K = m - Y F(m) + (1 - Y F'(X)) (X - m)` with `Y` near the inverse of the middle of `F'(X)`. The
preconditioner is a full matrix, so the cost is cubic in the period; in return the balls of `F'(X)`
may be wide, which elimination along the chain does not forgive. For a ball of contractions the
motion of the cycle with `lam` is kept in one piece, `Y dF/dlam (lam - middle)`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from flint import arb, arb_mat

from verification.arithmetic.balls import balls, working
from verification.cycles.recurrence.chain import Chain
from verification.cycles.recurrence.newton import System
from verification.cycles.recurrence.problem import Linearised, Problem


class Status(Enum):
    """What is proved about the zeros in a box."""

    UNIQUE = "exactly one zero in the box"
    EMPTY = "no zero in the box"
    UNKNOWN = "nothing proved; try a smaller box or more bits"


@dataclass(frozen=True)
class Enclosure:
    """A status, and balls that contain every zero of the box that was examined."""

    status: Status
    zero: list[Any]


def interval_newton(system: System, centre: list[arb], radius: arb, bits: int) -> Enclosure:
    """What the interval Newton operator proves about the box of `radius` around exact `centre`.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.recurrence.problem import Problem
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3))
    >>> with working(100):
    ...     near, off = [arb("1.5707963268"), arb("-1.5707963268")], [arb("0.5"), arb("-1.5")]
    >>> [interval_newton(axis, [x.mid() for x in c], arb("1e-9"), 100).status.name for c in (near, off)]
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


def stepped(centre: Sequence[Any], box: Sequence[Any], correction: Callable[[], Sequence[Any]]) -> Enclosure:
    """What an interval Newton step proves of a box, in real or complex balls.

    `correction()` encloses `F'(box)^-1 F(centre)`; a division by 0 there proves nothing.
    """
    try:
        image = [x - d for x, d in zip(centre, correction(), strict=True)]
    except ZeroDivisionError:
        return Enclosure(Status.UNKNOWN, list(box))
    return Enclosure(compared(image, box), image)


def slope_bits(unknowns: int) -> int:
    """Bits that the derivatives need: `F` at the midpoint is tiny, so theirs need not grow with the digits.

    >>> slope_bits(3)
    144
    """
    return 128 + 8 * unknowns.bit_length()


def _image(system: System, value: list[arb], centre: list[arb], box: list[arb], bits: int) -> Enclosure:
    def correction() -> list[arb]:
        with working(bits):
            return system.solved(balls(bits), box, value)

    return stepped(centre, box, correction)


def compared(image: Sequence[Any], box: Sequence[Any]) -> Status:
    """The three answers to: does the image lie inside the box?"""
    if not all(y.is_finite() for y in image):
        return Status.UNKNOWN
    if all(x.contains_interior(y) for x, y in zip(box, image, strict=True)):
        return Status.UNIQUE
    if any(not x.overlaps(y) for x, y in zip(box, image, strict=True)):
        return Status.EMPTY
    return Status.UNKNOWN


def krawczyk(problem: Problem, centre: list[arb], radii: list[float], bits: int) -> Enclosure:
    """What Krawczyk's operator proves about the cycles in a box; `lam` may be a ball.

    >>> from symbolic.tables import ellipse
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=arb("0.5", "0.01"))
    >>> krawczyk(axis, [arb("1.57"), arb("-1.57")], [0.01, 0.01], 64).status.name
    'UNIQUE'
    """
    with working(bits):
        box = [arb(x, r) for x, r in zip(centre, radii, strict=True)]
        try:
            lam = problem.at(balls(bits), centre)["lam"]
            at = Linearised(replace(problem, lam=lam.mid()), balls(bits), centre).terms
            slope = dense(Linearised(problem, balls(bits), box).plain)
            near = arb_mat([[x.mid() for x in row] for row in slope.tolist()]).inv()
        except ZeroDivisionError:
            return Enclosure(Status.UNKNOWN, box)
        inverse = arb_mat([[x.mid() for x in row] for row in near.tolist()])
        step = inverse * arb_mat([[x] for x in at.value])
        drift = inverse * arb_mat([[x] for x in at.by["lam"]])  # the rules are linear in lam
        one = arb_mat([[int(i == j) for j in range(len(centre))] for i in range(len(centre))])
        spread = (one - inverse * slope) * arb_mat([[x - m] for x, m in zip(box, centre, strict=True)])
        image = [m - step[i, 0] - drift[i, 0] * (lam - lam.mid()) + spread[i, 0] for i, m in enumerate(centre)]
        return Enclosure(compared(image, box), image)


def dense(chain: Chain) -> arb_mat:
    """The matrix of a chain."""
    n = len(chain.diagonal)
    rows = [[arb(0)] * n for _ in range(n)]
    for i, (lower, diagonal, upper) in enumerate(chain.rows):
        rows[i][i] += diagonal
        rows[i][i - 1] += lower * (chain.sign if i == 0 else 1)
        rows[i][(i + 1) % n] += upper * (chain.sign if i == n - 1 else 1)
    return arb_mat(rows)
