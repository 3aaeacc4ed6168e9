"""Enclosed arc length to many digits: by rigorous integration of the speed, and by Taylor series for many values.

The series is made once on each stretch of a component. On a disc about the middle of a stretch, `WIDER` times as wide,
the speed is analytic and at most `M`. So by Cauchy's estimate the term of degree `k` is at most `M/WIDER**k`, which
bounds the sum of the terms left out. An orbit then needs the value of one polynomial a bounce.
"""

from bisect import bisect
from collections.abc import Callable, Iterator, Sequence
from math import ceil, floor, log2
from typing import Any

from flint import acb, arb, arb_poly, arb_series

from numeric.lowering.program import Program
from verification.arithmetic.balls import balls, working
from verification.arithmetic.series import coefficients, in_series, taylor
from verification.maps.flight import curve
from verification.maps.numbers import ComplexBalls

WIDER = 4  # width of the disc, over that of the stretch
LARGE = 2.0**40  # from this bound on, nothing is known
UNIT = 10  # stretches end at multiples of about 2**-UNIT of the component's length
NARROW = 2.0**-20  # share of a component: a shorter stretch is not divided further
FEW = 16  # so many lengths are integrated one by one: as much work as all series
GUARD = 20  # bits more than asked for


class ExactArcLength:
    """Function for the length of a component between two parameters, in balls of `bits` bits.

    >>> from numeric import PinballMap
    >>> length = ExactArcLength(PinballMap("circle").ir.parts[0].curve, [], (-arb.pi(), arb.pi()), 100)
    >>> length(arb(0), arb(1)).overlaps(arb(1))
    True
    """

    def __init__(self, program: Program, shape: Sequence[arb], ends: tuple[arb, arb], bits: int) -> None:
        self.program, self.shape, self.bits, self.asked = program, shape, bits + GUARD, 0
        self.low, self.high = (float(end.mid()) for end in ends)
        with working(self.bits):
            self.discs = curve(program, ComplexBalls(), [acb(x) for x in shape], 4)
        self.pieces: _Pieces | None = None

    def __call__(self, low: arb, high: arb) -> arb:
        """The length from one parameter to another, in a ball."""
        self.asked += 1
        with working(self.bits):
            if self.asked == FEW:
                self.pieces = _pieces(self)
            if self.pieces is not None:
                found = self.pieces(high) - self.pieces(low)
                if found.is_finite():
                    return found
            return self._integrated(low, high)

    def _integrated(self, low: arb, high: arb) -> arb:
        def speed(z: acb, analytic: bool) -> Any:
            _, _, dx, dy = self.discs(z)
            return (dx * dx + dy * dy).sqrt(analytic=analytic)

        found: arb = acb.integral(speed, acb(low), acb(high)).real
        return found


class _Pieces:
    """Function for the arc length from a component's start; `stretches`: middles, half lengths, bounds of the speed."""

    def __init__(
        self, stretches: Sequence[tuple[float, float, float]], series: Callable[[Any], Any], bits: int
    ) -> None:
        self.edges = [middle - half for middle, half, _ in stretches]
        self.pieces, reached = list[tuple[arb, arb, arb_poly]](), arb(0)
        for middle, half, bound in stretches:
            piece = _integral(series, middle, half, bound, bits)
            self.pieces.append((arb(middle), arb(half), piece + (reached - piece(arb(-1)))))
            reached = self.pieces[-1][2](arb(1))

    def __call__(self, theta: arb) -> arb:
        """The length up to a parameter; nan beyond an end."""
        middle, half, piece = self.pieces[max(bisect(self.edges, float(theta.mid())) - 1, 0)]
        share = (theta - middle) / half
        return piece(share) if abs(share) < 1 + 2.0**-20 else arb("nan")


def _pieces(length: ExactArcLength) -> _Pieces | None:
    """The length function by series; None where the speed is not shown to be analytic, as at a cusp."""
    stretches = list(_stretches(length.discs, length.low, length.high))
    if any(bound >= LARGE for _, _, bound in stretches):
        return None
    series = curve(length.program, in_series(balls(length.bits), arb_series), length.shape, 4)
    return _Pieces(sorted(stretches), series, length.bits)


def _stretches(discs: Callable[[acb], Any], low: float, high: float) -> Iterator[tuple[float, float, float]]:
    """Middle, half length and bound of the speed on the disc, for stretches that cover a component."""
    unit = 2.0 ** (floor(log2(high - low)) - UNIT)  # halves of halves of such ends are exact, so that stretches touch
    low, high = unit * floor(low / unit), unit * ceil(high / unit)
    queue = [(0.5 * (low + high), 0.5 * (high - low))]
    while queue:
        middle, half = queue.pop()
        around = arb(0, WIDER * half)
        _, _, dx, dy = discs(acb(middle + around, around))
        speed = abs((dx * dx + dy * dy).sqrt(analytic=True))
        if speed < LARGE or half < NARROW * (high - low):
            yield middle, half, float(speed.upper()) if speed < LARGE else LARGE
            continue
        queue += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]


def _integral(series: Callable[[Any], Any], middle: float, half: float, bound: float, bits: int) -> arb_poly:
    """The length from a stretch's middle, as a polynomial on [-1, 1] whose constant term encloses the remainder."""
    terms = max(4, ceil((bits + max(0.0, log2(bound * half))) / log2(WIDER)))
    with taylor(terms):
        _, _, dx, dy = series(arb_series([middle, half]))
        speed = (arb_series([1]) * (dx * dx + dy * dy)).sqrt()
        integral = [c * half / (k + 1) for k, c in enumerate(coefficients(speed, terms))]
    rest = arb(bound) * half * 2 / arb(WIDER) ** terms
    return arb_poly([arb(0, rest.upper()), *integral])
