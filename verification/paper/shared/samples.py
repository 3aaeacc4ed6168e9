"""Claims supported by sampling, with its error: the sizes of basins. Paper: section 6.4.

Many orbits at many contractions in one run: their exponents, and the cells of phase space they visit.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from sympy import Rational

from numeric import PinballMap
from numeric.pinball.sampling import Growth, interior_starts, phase_starts
from symbolic.cycles.polygons import saddle_node
from symbolic.expressions.signs import Finding, Outcome
from symbolic.tables.table import alpha
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import digits, judges

SHAPE = Rational(2, 25)
SEED = 1


def sampled(derived: str, evidence: str, agrees: bool) -> Judgement:
    """A claim that sampling supports within the error it states, and leaves open where it does not."""
    return Judgement(Finding(Outcome.UNKNOWN, evidence), derived, evidence=evidence if agrees else "")


def share_of_period_3(lam: str, starts: int = 400, bounces: int = 3000) -> float:
    """The share of random starts that end on period 3: their neighbourhood shrinks, off the diameters."""
    map = PinballMap("egg", lam=lam, alpha=str(SHAPE))
    ball = phase_starts(map, starts, SEED)
    end = map.exponents(ball.theta, ball.phi, 200, bounces, ball.component)
    return float(np.mean((end.nu_plus < 0) & (np.abs(end.phi) > 0.15)))


@judges("egg.period3_end_caption")
def end_of_period_3(claim: Claim) -> Judgement:
    """The fold in closed form, and why sampling sees it late: the basins are born with size 0."""
    shares = ", ".join(f"{share_of_period_3(lam):.1%} at {lam}" for lam in ("0.3785", "0.38", "0.39", "0.42"))
    found = digits(claim, saddle_node().subs(alpha, SHAPE), ("0.39", "0.378"))
    return replace(found, derived=f"{found.derived}; random starts that reach period 3: {shares}, so plots see it late")


SPECTRA_SEED, BALLS, BOUNCES, EARLY = 1, 48, 2000, 500
CELLS = 24  # along each side of phase space, in (s, sin(phi))
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Exponents of single orbits at several contractions: orbits along the last axis."""

    lams: Array
    plus: Array
    minus: Array

    @property
    def total(self) -> Array:
        """The sum of both."""
        return self.plus + self.minus

    @staticmethod
    def error(values: Array) -> Array:
        """Standard errors of the means over orbits, which start independently."""
        return np.asarray(np.std(values, axis=-1, ddof=1) / np.sqrt(values.shape[-1]))


@cache
def spectrum(table: str, lams: tuple[float, ...], balls: int = BALLS, bounces: int = BOUNCES) -> Spectrum:
    """The exponents of `balls` orbits at each contraction, after transients. Paper: figures of 4.1 and 5.3."""
    growth = settled(table, np.maximum(lams, 1e-300), balls)  # no log(0)
    growth.advance(bounces)
    plus = growth.stretch / bounces
    minus = growth.volume / bounces + np.log(growth.lam) - plus
    return Spectrum(np.array(lams), *(x.reshape(len(lams), balls) for x in (plus, minus)))


def settled(table: str, lams: Array, balls: int) -> Growth:
    """The same balls, started as in the paper's appendix, on their attractors at each contraction in turn."""
    map = PinballMap(table, lam=np.repeat(lams, balls))
    starts = interior_starts(map.at(1), balls, SPECTRA_SEED)
    growth = Growth(map, *(np.tile(field, len(lams)) for field in starts[:3]))
    growth.skip(EARLY)
    return growth


def visited(table: str, lams: tuple[float, ...], balls: int, bounces: int) -> Array:
    """How often each ball is in each cell of `(s, sin(phi))`: contraction, ball, cell."""
    growth = settled(table, np.array(lams), balls)
    map = growth.map
    orbit = map.orbit(growth.theta, growth.phi, bounces, growth.component)
    share = np.mod(map.arclength.s(orbit.theta, orbit.component) / map.arclength.perimeter, 1.0)
    row = np.minimum((share * CELLS).astype(int), CELLS - 1)
    column = np.minimum(((np.sin(orbit.phi) + 1) / 2 * CELLS).astype(int), CELLS - 1)
    number = np.arange(len(lams) * balls) * CELLS**2 + row * CELLS + column
    counts = np.bincount(number.ravel(), minlength=len(lams) * balls * CELLS**2)
    return counts.reshape(len(lams), balls, CELLS**2).astype(float)


@cache
def coverage(table: str, lams: tuple[float, ...]) -> Array:
    """The counts that the judges below share."""
    return visited(table, lams, 16, 4000)


def uneven(counts: Array) -> float:
    """The relative standard deviation of the cells' counts, beyond that of counting."""
    whole = counts.sum(axis=0)
    mean = float(np.mean(whole))
    return float(np.sqrt(max(np.var(whole) / mean - 1, 0.0) / mean))
