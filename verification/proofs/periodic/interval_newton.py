"""The proof that a box holds exactly one zero of a system, by the interval Newton operator or by Krawczyk's operator.

The interval Newton operator is for long cycles, Krawczyk's operator for wide boxes around short cycles. For a box `X`
with midpoint `m`, every zero in `X` lies in `N = m - F'(X)^-1 F(m)`, and when `N` lies in the interior of `X` there is
exactly one. `F'(X)^-1` is applied by elimination in balls, in linear time (see `verification.cycles.chain`); the
elimination needs no preconditioner, and contracts at least as well as with one.

Krawczyk's operator [Krawczyk1969] is `K = m - Y F(m) + (1 - Y F'(X)) (X - m)` with `Y` near the inverse of the midpoint
of `F'(X)`. The preconditioner is a full matrix, so the cost is cubic in the period; in return the balls of `F'(X)` may
be wide, for which elimination along the chain fails. For a ball of contractions the dependence on `lam` is the single
term `Y dF/dlam (lam - middle)`, with the derivative over the whole ball.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import Any

from flint import arb, arb_mat

from verification.arithmetic.balls import balls, working
from verification.cycles.chain import Chain
from verification.cycles.newton import System
from verification.cycles.problem import Linearised, Problem
from verification.rigorous.certificate import Certified
from verification.rigorous.theorem import Verdict, hypothesis


class ZeroStatus(Enum):
    """The verdict on the zeros of a system in a box."""

    UNIQUE = "exactly one zero in the box"
    EMPTY = "no zero in the box"
    UNKNOWN = "nothing proved; try a smaller box or more bits"


@dataclass(frozen=True)
class Enclosure:
    """A verdict on a box, and balls that contain every zero in the box."""

    status: ZeroStatus
    zero: list[Any]


def interval_newton(system: System, centre: list[arb], radius: arb, bits: int) -> Enclosure:
    """The verdict of the interval Newton operator on the box of `radius` around the exact point `centre`.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.problem import Problem
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
            return Enclosure(ZeroStatus.UNKNOWN, box)
        found = _image(system, value, centre, box, min(bits, slope_bits(len(centre))))
        if found.status is not ZeroStatus.UNIQUE:
            found = _image(system, value, centre, box, bits)
        return found


@dataclass(frozen=True, repr=False)
class UniqueZero(Certified):
    """A system has exactly one zero in the box of a given radius around a centre, both exact."""

    centre: tuple[arb, ...]
    radius: arb
    bits: int
    digits: int

    def __repr__(self) -> str:
        verdict = f"not proved: {', '.join(self.open)}" if self.open else "proved"
        return f"{type(self).__name__}({self.label}: {verdict})"

    @property
    def label(self) -> str:
        """The name of the system in messages."""
        return self.system.label

    @property
    def system(self) -> System:
        """The equations; `centre` has values of their unknowns."""
        raise NotImplementedError

    @cached_property
    def enclosure(self) -> Enclosure:
        """The verdict of the interval Newton operator on the box."""
        return interval_newton(self.system, list(self.centre), self.radius, self.bits)

    @property
    def value(self) -> arb:
        """The enclosure of the last unknown, which at a bifurcation is the free parameter."""
        value: arb = self.enclosure.zero[-1]
        return value

    @property
    def found(self) -> bool:
        """True if it is proved that the box has exactly one solution."""
        return self.enclosure.status is ZeroStatus.UNIQUE

    @hypothesis(refutable=True)
    def exists(self) -> Verdict:
        """The system has a solution in the box."""
        return {ZeroStatus.UNIQUE: True, ZeroStatus.EMPTY: False}.get(self.enclosure.status)

    @hypothesis(refutable=True)
    def unique(self) -> Verdict:
        """The system has no second solution in the box."""
        return self.exists

    def within_digits(self) -> bool:
        """True if the radius of the value is below `10**-digits`."""
        with working(self.bits):
            return bool(self.value.rad() < arb(10) ** -self.digits)


def stepped(centre: Sequence[Any], box: Sequence[Any], correction: Callable[[], Sequence[Any]]) -> Enclosure:
    """The verdict of an interval Newton step on a box, in real or complex balls.

    `correction()` encloses `F'(box)^-1 F(centre)`; if it divides by 0, nothing is proved.
    """
    try:
        image = [x - d for x, d in zip(centre, correction(), strict=True)]
    except ZeroDivisionError:
        return Enclosure(ZeroStatus.UNKNOWN, list(box))
    return Enclosure(compared(image, box), image)


def near_guess(guess: float, value: arb, slope: Callable[[arb], arb], radius: float, boxes: int) -> arb | None:
    """The zero of a function of one variable, by interval Newton steps on boxes around a guess, each twice as wide.

    `value` encloses the function at the guess, `slope(box)` its derivative on a box. None if no step is proved.

    >>> square = near_guess(1.4, arb(1.4) ** 2 - 2, lambda box: 2 * box, 1e-3, 10)
    >>> bool(square is not None and square.contains(arb(2).sqrt()))
    True
    """
    for doubling in range(boxes):
        box = arb(guess, radius * 2.0**doubling)
        image: arb = guess - value / slope(box)
        if box.contains_interior(image):  # which is no NaN
            return image
    return None


def slope_bits(unknowns: int) -> int:
    """The number of bits for the derivatives, which need not grow with the digits since `F` at the midpoint is tiny.

    >>> slope_bits(3)
    144
    """
    return 128 + 8 * unknowns.bit_length()


def _image(system: System, value: list[arb], centre: list[arb], box: list[arb], bits: int) -> Enclosure:
    def correction() -> list[arb]:
        with working(bits):
            return system.solved(balls(bits), box, value)

    return stepped(centre, box, correction)


def compared(image: Sequence[Any], box: Sequence[Any]) -> ZeroStatus:
    """The verdict on a box from its image: whether it lies inside the box, is disjoint from it, or neither."""
    if not all(y.is_finite() for y in image):
        return ZeroStatus.UNKNOWN
    if all(x.contains_interior(y) for x, y in zip(box, image, strict=True)):
        return ZeroStatus.UNIQUE
    if any(not x.overlaps(y) for x, y in zip(box, image, strict=True)):
        return ZeroStatus.EMPTY
    return ZeroStatus.UNKNOWN


def krawczyk(problem: Problem, centre: list[arb], radii: list[float], bits: int) -> Enclosure:
    """The verdict of Krawczyk's operator on the cycles in a box; `lam` may be a ball.

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
            by_lam = Linearised(problem, balls(bits), centre).terms.by["lam"]
            slope = dense(Linearised(problem, balls(bits), box).plain)
            near = arb_mat([[x.mid() for x in row] for row in slope.tolist()]).inv()
        except ZeroDivisionError:
            return Enclosure(ZeroStatus.UNKNOWN, box)
        inverse = arb_mat([[x.mid() for x in row] for row in near.tolist()])
        step = inverse * arb_mat([[x] for x in at.value])
        drift = inverse * arb_mat([[x] for x in by_lam])
        one = arb_mat([[int(i == j) for j in range(len(centre))] for i in range(len(centre))])
        spread = (one - inverse * slope) * arb_mat([[x - m] for x, m in zip(box, centre, strict=True)])
        image = [m - step[i, 0] - drift[i, 0] * (lam - lam.mid()) + spread[i, 0] for i, m in enumerate(centre)]
        return Enclosure(compared(image, box), image)


def dense(chain: Chain) -> arb_mat:
    """The matrix of a chain of linear equations, as a dense matrix."""
    n = len(chain.diagonal)
    rows = [[arb(0)] * n for _ in range(n)]
    for i, (lower, diagonal, upper) in enumerate(chain.rows):
        rows[i][i] += diagonal
        rows[i][i - 1] += lower * (chain.sign if i == 0 else 1)
        rows[i][(i + 1) % n] += upper * (chain.sign if i == n - 1 else 1)
    return arb_mat(rows)
