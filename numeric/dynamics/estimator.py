"""The estimator of exponents that all commands share: growth in blocks of bounces, error bars, and the bias of the
start.

Vectors turn to the direction of growth before anything is counted (`Growth.settle`); the angle that remains is included
in the error. The paper (appendix A.2) follows two vectors, after [DellagoPoschHoover1996]; here one vector and the
determinant suffice. In a polygon angles contract by `lam` at each bounce, so that `nu_minus` is exactly `log(lam)`, and
`nu_plus` is the logarithm of the determinant per bounce, less `log(lam)`.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.phase_points import Array, Labels, PhasePoints
from numeric.dynamics.recognition import Attractor, Kind
from numeric.dynamics.statistics import Estimate, estimate
from numeric.pinball.sampling import Growth, Starts

MOST = 1024  # largest number of blocks kept for an orbit
KEPT = 1 << 22  # numbers kept of each exponent
FLIGHTS = 128  # blocks over which flights are averaged
SAMPLED = 5  # sampled points of a component at which its curvature is tested
HEARD = 50_000_000  # bounces, of all particles together, between two chances to interrupt
STEPS = 32  # reports of progress in a count, at least


class ExponentEstimates(NamedTuple):
    """Both exponents per bounce and their sum, each with its error; `lower` and `total` are None at `lam = 0`.

    `naive` is what the error of `upper` would be if single bounces were independent.
    """

    upper: Estimate | None
    lower: Estimate | None
    total: Estimate | None
    naive: float | None = None

    @property
    def tau(self) -> float | None:
        """The integrated autocorrelation time of single bounces' growth, by batch means; 1/2 without correlation."""
        return None if not self.naive or self.upper is None else (self.upper.error / self.naive) ** 2 / 2


def with_bias(found: Estimate, bias: float) -> Estimate:
    """The estimate, its error enlarged by a bound of its bias."""
    return replace(found, error=float(np.hypot(found.error, bias)))


def straight(map: PinballMap) -> bool:
    """Is the table a polygon, and the law a uniform contraction?

    >>> straight(PinballMap("square", lam="0.5")), straight(PinballMap("stadium", lam="0.5"))
    (True, False)
    """
    each = np.repeat(np.arange(len(map.states.ends)), SAMPLED)
    low, high = np.array(map.states.ends)[each].T
    at = low + (high - low) * np.tile((np.arange(SAMPLED) + 0.5) / SAMPLED, len(map.states.ends))
    return map.reflection.uniform and not np.any(map.states.bending(each, at)[1])


class Count:
    """Growth per bounce along orbits, with blocks of bounces on the first axis and particles on the second.

    A block is one bounce at first; when there are `most` blocks, neighbours are merged in pairs. So there is an
    estimate at any time, and a run of any length fits in memory. If the run is known to be `long` bounces, blocks have
    their final length from the beginning, unless a block would take so long that Ctrl-C is heard late.
    """

    def __init__(self, growth: Growth, most: int = MOST, long: int = 0) -> None:
        self.growth, self.straight = growth, straight(growth.map)
        self.most = max(2, min(most, KEPT // growth.theta.size // 2 * 2))
        heard = max(1, HEARD // growth.theta.size)
        self.length, self.blocks = 1 << min((long // self.most).bit_length(), heard.bit_length() - 1), 0
        self._rows = np.empty((2, self.most, growth.theta.size))

    @property
    def up(self) -> Array:
        """Growth of the tangent vectors: logarithms per bounce."""
        return self._rows[0, : self.blocks]

    @property
    def volume(self) -> Array:
        """The logarithm of the growth of areas per bounce, without the part `log(lam)`."""
        return self._rows[1, : self.blocks]

    @property
    def bounces(self) -> int:
        """The number of bounces counted so far, for each particle."""
        return self.length * self.blocks

    def until(self, bounces: int) -> Iterator[int]:
        """Counts whole blocks up to `bounces` bounces, and yields the number counted so far, after some blocks each."""
        growth, heard = self.growth, min(HEARD // self.growth.theta.size, bounces // STEPS)
        while (left := (bounces - self.bounces) // self.length) > 0:
            some = min(left, self.most - self.blocks, max(1, heard // self.length))
            reached = growth.advance_blocks([self.length] * some)
            self._rows[:, self.blocks : self.blocks + some] = np.diff(reached, axis=1) / self.length
            self.blocks += some
            if self.blocks == self.most:
                self._rows[:, : self.most // 2] = (self._rows[:, ::2] + self._rows[:, 1::2]) / 2
                self.blocks, self.length = self.most // 2, 2 * self.length
            yield self.bounces

    def measured(self, members: Labels, blocks: int | None = None) -> ExponentEstimates:
        """The exponents of the particles `members`, from all blocks or from the first `blocks`.

        `Growth.settle` leaves a vector at a small angle to the direction of growth. While the vector turns to that
        direction, it gains or loses about this angle; divided by the bounces counted, this is a part of the error.
        """
        plus = self.up[:blocks, members]
        contraction = self.growth.contraction[members]
        total = self.volume[:blocks, members] + contraction
        if np.any(np.isneginf(total)):
            return ExponentEstimates(estimate(plus), None, None)
        minus = total - plus
        if self.straight:  # angles contract by lam at each bounce: exact, and no vector is needed
            plus, minus = self.volume[:blocks, members], np.broadcast_to(contraction, plus.shape)
        elif np.mean(plus) < np.mean(minus):
            plus, minus = minus, plus
        left = 0.0 if self.straight else float(np.mean(elementary.log(1 + self.growth.misalignment[members])))
        upper, lower = (with_bias(estimate(x), left / (len(plus) * self.length)) for x in (plus, minus))
        return ExponentEstimates(upper, lower, estimate(total))


def arrived(map: PinballMap, starts: Starts) -> Growth:
    """The state of particles at their starts; at `lam = 0` at their first landing, since the map then forgets `phi`."""
    if map.law == "slap":
        landed = map.step(starts.theta, starts.phi, starts.component)
        return Growth(map, landed.theta, 0.0 * landed.phi, landed.component)
    return Growth(map, starts.theta, starts.phi, starts.component)


def skipped(growth: Growth, bounces: int) -> None:
    """Moves particles by `bounces` without counting, about a second's work at a time, so that Ctrl-C can interrupt."""
    piece = max(1, HEARD // growth.theta.size)
    for done in range(0, bounces, piece):
        growth.skip(min(piece, bounces - done))


def measured_on(
    count: Count, members: Labels, attractor: Attractor | None, blocks: int | None = None
) -> ExponentEstimates:
    """The exponents over the particles of an attractor, from all blocks or from the first few.

    On a neutral set vectors grow like a power of time, so an exponent of 0 is measured as about `log(n)/n`; the error
    includes this difference.

    >>> from numeric.dynamics.exponents import surveyed
    >>> from numeric.pinball.sampling import interior_starts
    >>> circle = PinballMap("circle", lam=1)
    >>> upper = surveyed(circle, interior_starts(circle, 4, seed=1), 256, 100).groups[0].measured.upper
    >>> 0 < upper.mean <= upper.error
    True
    """
    found = count.measured(members, blocks)
    if attractor is None or attractor.kind is not Kind.NEUTRAL or found.upper is None:
        return found
    left = abs(found.upper.mean)
    upper, lower = replace(found.upper, error=max(found.upper.error, left)), found.lower
    if lower is not None and found.total is not None:  # the sum less the upper one
        lower = replace(lower, error=max(lower.error, left + np.nan_to_num(found.total.error)))
    return found._replace(upper=upper, lower=lower)


def mean_flight(map: PinballMap, particles: PhasePoints, bounces: int) -> Estimate:
    """The mean length of a flight over `bounces` bounces of particles on one attractor, in the table's unit of length.

    Particles that stop are left out. In the elastic map the mean over all of phase space is `pi*area/perimeter`:

    >>> from numeric.pinball.sampling import phase_starts
    >>> square = PinballMap("square", lam=1)
    >>> found = mean_flight(square, PhasePoints(*phase_starts(square, 2000, seed=1)[:3]), 500)
    >>> abs(found.mean - np.pi / 4) < 3 * found.error < 0.02
    True
    """
    length, last = max(1, bounces // FLIGHTS), np.empty((0, particles.size))
    place = {"x": last, "y": last}
    rows, going = [], np.ones(particles.size, dtype=bool)
    fields, piece = ("x", "y", "code"), length * particles.size
    for told in map.orbit_pieces(*particles[1:], bounces, particles.component, fields=fields, piece=piece):
        x, y = (np.concatenate([place[name], told[name]]) for name in place)
        rows.append(np.mean(np.hypot(np.diff(x, axis=0), np.diff(y, axis=0)), axis=0))
        place, going = {"x": x[-1:], "y": y[-1:]}, going & (told["code"][-1] == 0)
    return estimate(np.array(rows)[:, going])


def per_time(exponent: Estimate, flight: Estimate) -> tuple[float, float]:
    """An exponent per unit of time at speed 1, with its standard error: that per bounce over the mean flight."""
    rate = exponent.mean / flight.mean
    return rate, float(np.hypot(exponent.error, rate * flight.error) / flight.mean)
