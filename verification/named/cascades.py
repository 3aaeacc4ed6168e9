"""Cascades of period doublings from any attracting cycle that random particles reach; each doubling is proved.

Section 6.6 of the paper ascribes isolated chaotic regions to such cascades of higher period.
"""

from dataclasses import dataclass
from functools import cache
from itertools import islice

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from numeric.sweeps.space import followed
from symbolic.tables import egg
from verification.cycles.cascade import FEIGENBAUM, doublings
from verification.named.locate import proof_near

DIGITS, PARTICLES, SEED = 15, 400, 1
STAGES = (1000, 4000, 35_000)  # bounces, after each of which particles are tested for being on the cycle


@dataclass(frozen=True)
class Cascade:
    """The periods that double and the contractions at which they do; `proved` if each is a supercritical flip."""

    periods: tuple[int, ...]
    lams: tuple[float, ...]
    proved: bool

    @property
    def ratios(self) -> list[float]:
        """Ratios of successive distances between doublings; they tend to Feigenbaum's 4.669."""
        gaps = np.diff(self.lams)
        return [float(ratio) for ratio in gaps[:-1] / gaps[1:]]

    @property
    def limit(self) -> float:
        """The contraction at which the cascade accumulates, estimated with Feigenbaum's ratio of distances."""
        return self.lams[-1] + (self.lams[-1] - self.lams[-2]) / (FEIGENBAUM - 1)


@cache
def cascade(alpha: Rational, lam: Rational, period: int, step: float, count: int = 3) -> Cascade:
    """The first `count` doublings of an attracting cycle of this period, followed from `lam` in steps of `step`.

    >>> found = cascade(Rational(2, 25), Rational(3, 10), 4, 0.005, count=1)  # the paper's lambda_3, section 6.6
    >>> found.periods, round(found.lams[0], 6), found.proved
    ((4,), 0.371236, True)
    """
    found = doublings(egg(3).at(alpha=alpha), reached(alpha, lam, period), float(lam), step)
    members = list(islice(found, count))
    proofs = [proof_near(member.problem, member.start, DIGITS, in_balls=True) for member in members]
    proved = all(proof.proved and proof.supercritical is True for proof in proofs)
    return Cascade(tuple(m.problem.period for m in members), tuple(m.lam for m in members), proved)


def reached(alpha: Rational, lam: Rational, period: int) -> list[float]:
    """The bounces of a cycle of this period that attracts a random particle; `ValueError` if there is none."""
    map = PinballMap("egg", lam=str(lam), alpha=str(alpha))
    starts = interior_starts(map, PARTICLES, SEED)
    for bounces in STAGES:
        found = followed(map, starts, (bounces,))
        on = np.flatnonzero(found.period == period)
        if on.size:
            first = found.starts.only(on[:1])
            return [float(x) for x in map.orbit(first.theta, first.phi, period - 1, first.component).theta[:, 0]]
        starts = found.starts
    raise ValueError(
        f"egg: none of {PARTICLES} particles at alpha = {alpha}, lam = {lam} ends on a cycle of period {period}"
    )
