"""The period doublings that a cycle of the egg goes through as `lam` grows, each proved, and where they accumulate.

`verification.ladder` climbs the paper's cascade, from period 4 at the diameters. This one starts from any attracting
cycle that random balls reach, such as those of higher period to which section 6.6 ascribes isolated chaotic regions.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from sympy import Rational

from numeric import PinballMap
from numeric.pinball.sampling import interior_starts
from symbolic.tables import egg
from verification.locate import certify
from verification.shooting.follow import FEIGENBAUM, doubled, next_critical
from verification.shooting.problem import Kind, Problem

DIGITS, BALLS, TRANSIENT, SEED = 15, 400, 40_000, 1
RETURN = 1e-7  # of a ball on the cycle to where it was


@dataclass(frozen=True)
class Cascade:
    """The periods that double and the contractions at which they do; `proved` when each is a supercritical flip."""

    periods: tuple[int, ...]
    lams: tuple[float, ...]
    proved: bool

    @property
    def ratios(self) -> list[float]:
        """Of successive distances; they tend to Feigenbaum's 4.669."""
        gaps = np.diff(self.lams)
        return [float(ratio) for ratio in gaps[:-1] / gaps[1:]]

    @property
    def limit(self) -> float:
        """Where the cascade accumulates if further distances shrink by Feigenbaum's number: an estimate."""
        return self.lams[-1] + (self.lams[-1] - self.lams[-2]) / (FEIGENBAUM - 1)


@cache
def cascade(alpha: Rational, lam: Rational, period: int, step: float, rungs: int = 3) -> Cascade:
    """The first doublings of an attracting cycle of some period that exists at `lam`, followed in steps.

    >>> found = cascade(Rational(2, 25), Rational(3, 10), 4, 0.005, rungs=1)  # the paper's lambda_3, section 6.6
    >>> found.periods, round(found.lams[0], 6), found.proved
    ((4,), 0.371236, True)
    """
    table, at = egg(3).at(alpha=alpha), float(lam)
    critical = next_critical(table, reached(alpha, lam, period), at, step, Kind.FLIP)
    gap, periods, lams, proved = (critical[-1] - at) / 4, [period], [critical[-1]], True
    while True:
        problem = Problem(table, (0,) * periods[-1], Kind.FLIP, "lam")
        proof = certify(problem, critical, DIGITS)
        proved = proved and proof.certified and proof.supercritical is True
        if len(lams) == rungs:
            return Cascade(tuple(periods), tuple(lams), proved)
        theta, near = doubled(problem, critical, 0.3 * gap)
        critical = next_critical(table, theta, near, 0.15 * gap, Kind.FLIP)
        gap = (critical[-1] - lams[-1]) / FEIGENBAUM
        periods.append(2 * periods[-1])
        lams.append(critical[-1])


def reached(alpha: Rational, lam: Rational, period: int) -> list[float]:
    """The bounces of a cycle of this period on which a random ball ends; `ValueError` when none does."""
    map = PinballMap("egg", lam=str(lam), alpha=str(alpha))
    starts = interior_starts(map, BALLS, SEED)
    end = map.exponents(starts.theta, starts.phi, 1, TRANSIENT, starts.component)
    orbit = map.orbit(end.theta, end.phi, period)
    gap = np.hypot(orbit.x[1:] - orbit.x[0], orbit.y[1:] - orbit.y[0])
    there = (gap[-1] < RETURN) & np.all(gap[:-1] > RETURN, axis=0)
    if not np.any(there):
        raise ValueError(
            f"egg: none of {BALLS} balls at alpha = {alpha}, lam = {lam} ends on a cycle of period {period}"
        )
    return [float(x) for x in orbit.theta[:period, np.argmax(there)]]
