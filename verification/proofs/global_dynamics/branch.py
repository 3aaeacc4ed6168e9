"""Enclosures of a branch of a saddle's unstable manifold: a power series in balls with a bound of the remainder.

Each point of the branch is a small box of phase points, whose orbit is followed in balls.
"""

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from flint import acb, arb

from verification.arithmetic.balls import balls, fraction_ball, working
from verification.proofs.manifolds.enclosed import (
    Enclosed,
    complex_balls,
    enclosed,
    enclosed_saddle,
    remainder,
)
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Saddle, SaddleCycle, horner
from verification.proofs.manifolds.tangency import one_cycle, scale

OUTER = 16  # the radius of the disc on which the collision rule is bounded: four bits for each order of the series


class ManifoldSeries(NamedTuple):
    """An enclosed unstable manifold: its power series, a bound of the remainder, the number of bits, and the map."""

    series: Enclosed
    error: arb
    bits: int
    map: Pinball

    def points(self, side: int, low: Sequence[float], high: Sequence[float]) -> list[tuple[arb, arb]]:
        """Boxes of phase points on one side of a saddle, with `z` from `factor**(low - 1)` to `factor**(high - 1)`."""
        found = []
        with working(self.bits):
            map, error = self.map.over(balls(self.bits)), arb(0, self.error)
            for a, b in zip(low, high, strict=True):
                power = arb(float(a)).union(arb(float(b))) - 1
                z = side * (power * self.series.factor.real.log()).exp()
                before, here = (horner([c.real for c in jet.c], z) + error for jet in self.series.pair())
                found.append((before, map.angle(before, here)[0]))
        return found


def unstable_branch(
    orbit: SaddleCycle, map: Pinball, lam: Fraction, bits: int, around: Saddle | None = None
) -> ManifoldSeries | None:
    """The saddle's unstable manifold at one contraction, as an enclosed series; None if it is not proved.

    With `around`, the saddle must be the one that `around` encloses over a range of contractions; without it the branch
    may belong to another cycle near `orbit`.
    """
    try:
        with working(bits):
            size = scale(orbit, map, float(lam), True, OUTER)
            at = enclosed_saddle(orbit, map.over(complex_balls(bits)), acb(fraction_ball(lam)))
            made = enclosed(at, True, bits // 4, size.unit, size.chief)
            error = remainder(made, OUTER)
            proved = made.factor.real > 1 and (around is None or one_cycle(around, at))  # keeps the sides
            return ManifoldSeries(made, error, bits, map) if proved else None
    except (ValueError, ArithmeticError):
        return None
