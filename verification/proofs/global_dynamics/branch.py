"""A branch of a saddle's unstable manifold in balls, and what orbits along it end in.

The branch is a power series with a bound for its remainder. A point of it is a small box of phase points, and its orbit
is followed in balls, each landing a first hit.
"""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from flint import acb, arb, fmpq

from verification.arithmetic.balls import balls, working
from verification.proofs.manifolds.enclosed import (
    Enclosed,
    TooWideError,
    complex_balls,
    enclosed,
    enclosed_saddle,
    remainder,
)
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Orbit, Saddle, horner
from verification.proofs.manifolds.tangency import one_cycle, scale

OUTER = 16  # the radius of the disc on which the rule is bounded: four bits for each order of the series


class Branch(NamedTuple):
    """The enclosed series of an unstable manifold, a bound for its remainder, the bits of its balls, and the map."""

    series: Enclosed
    error: arb
    bits: int
    map: Pinball

    def points(self, side: int, low: Sequence[float], high: Sequence[float]) -> list[tuple[arb, arb]]:
        """Phase points on pieces of one side: `z` from `factor**(low - 1)` to `factor**(high - 1)`."""
        found = []
        with working(self.bits):
            map, error = self.map.over(balls(self.bits)), arb(0, self.error)
            for a, b in zip(low, high, strict=True):
                power = arb(float(a)).union(arb(float(b))) - 1
                z = side * (power * self.series.factor.real.log()).exp()
                before, here = (horner([c.real for c in jet.c], z) + error for jet in self.series.pair())
                found.append((before, map.angle(before, here)[0]))
        return found


def unstable_branch(orbit: Orbit, map: Pinball, lam: Fraction, bits: int, around: Saddle | None = None) -> Branch:
    """The series of the unstable manifold at one contraction, its remainder proved; `TooWideError`.

    With `around` the saddle has to be the one enclosed there, over a range of contractions.
    """
    with working(bits):
        size = scale(orbit, map, float(lam), True, OUTER)
        at = enclosed_saddle(orbit, map.over(complex_balls(bits)), exact(lam))
        if around is not None and not one_cycle(around, at):
            raise TooWideError("saddle", "the branch may be that of another cycle")
        made = enclosed(at, True, bits // 4, size.unit, size.chief)
        error = remainder(made, OUTER)
        if not made.factor.real > 1:
            raise TooWideError("saddle", "the unstable multiplier is not above 1, and the branch has two sides")
        return Branch(made, error, bits, map)


def exact(x: Fraction) -> Any:
    """A fraction as a complex ball."""
    return acb(arb(fmpq(x.numerator, x.denominator)))
