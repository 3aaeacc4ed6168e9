"""Error bars of time averages: batch means over orbits and blocks, with batches long enough to forget.

Blocks of an orbit depend on each other, so their standard deviation over the square root of their number is wrong,
by a factor that can be anything. Neighbouring blocks are merged two by two [FlyvbjergPetersen1989] until
only as many batches are left as an error bar needs, and further while neighbours are seen to be correlated; what
their ends still share is put right with the autocorrelation time. The last level has one batch for each orbit: orbits
start independently, so that level is right however long the memory.

The dimension of a basin boundary, by the uncertainty exponent.

Two starts at a distance `eps` have different fates with probability `f(eps) ~ eps**a`, and the boundary has
dimension `2 - a` [McDonaldGrebogiOttYorke1985]. The same starts serve all distances, so the error
comes from resampling starts, not from a fit that takes distances for independent.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from numeric import PinballMap
from numeric.backends import elementary
from numeric.dynamics.basins import TRANSIENT, Window, labels, random_points, starts_at, whole
from numeric.dynamics.phase_points import Array
from numeric.dynamics.recognition import UNSETTLED, Attractor

ENOUGH = 32  # batches: the error bar is then known to one part in eight
FEWEST = 8  # batches, below which an error bar is a guess
SHARE = 0.25  # of a batch that the autocorrelation time may take
UNCORRELATED = 2.5  # standard deviations that the correlation of neighbours may show
WINDOW = 6.0  # autocorrelation times to sum over (Sokal)
SHORTEST = 32  # steps to sum over at least


@dataclass(frozen=True)
class Batches:
    """One level of merging: blocks to a batch, how many batches, the error they give, their correlation.

    `score` is the correlation of neighbours in units of its own standard deviation, were they independent.
    """

    batch: int
    count: int
    error: float
    score: float
    inside: bool  # more than one batch to an orbit


@dataclass(frozen=True)
class Estimate:
    """A mean with its standard error, the level of merging that gave it, and the memory `tau` in blocks."""

    mean: float
    error: float
    level: Batches
    tau: float

    @property
    def share(self) -> float:
        """The part of a batch that its neighbours know of; none when a batch is a whole orbit."""
        return self.tau / self.level.batch if self.level.inside else 0.0

    @property
    def trusted(self) -> bool:
        """Enough batches, and longer than the memory."""
        return self.level.count >= FEWEST and self.share < SHARE

    @property
    def interval(self) -> float:
        """Half the 95 per cent interval: Student's factor for this many batches times the error."""
        return float(stdtrit(max(self.level.count - 1, 1), 0.975) * self.error)


def levels(blocks: Array) -> list[Batches]:
    """The error at each level of merging, from single blocks to whole orbits. Blocks run along the first axis.

    The first blocks that make no power of two are left out of the errors.

    >>> [(level.batch, level.count) for level in levels(np.arange(18.0).reshape(9, 2))]
    [(1, 16), (2, 8), (4, 4), (8, 2)]
    """
    x = blocks[len(blocks) - (1 << (len(blocks).bit_length() - 1)) :]
    found, batch = [], 1
    grand = float(np.mean(x))
    while True:
        away = x - grand
        variance = float(np.sum(away**2)) / max(x.size - 1, 1)
        score = 0.0
        if len(x) > 1 and variance > 0:
            pairs = away[1:] * away[:-1]
            score = float(np.mean(pairs) / variance + 1 / x.size) * pairs.size**0.5
        error = float(np.sqrt(variance / x.size)) if x.size > 1 else float("nan")
        found.append(Batches(batch, x.size, error, score, len(x) > 1))
        if len(x) < 2:
            return found
        x, batch = (x[::2] + x[1::2]) / 2, 2 * batch


def estimate(blocks: Array) -> Estimate:
    """The mean over all blocks and orbits with its standard error; blocks run along the first axis.

    >>> white = np.random.default_rng(0).normal(size=(256, 10))
    >>> found = estimate(white)
    >>> found.level.batch, found.level.count, bool(0.8 < found.error * np.sqrt(2560) < 1.25), found.trusted
    (64, 40, True, True)
    """
    merged = levels(blocks)
    chosen = merged[0]
    for level in merged[1:]:
        if level.count < ENOUGH and (level.count < FEWEST or chosen.score < UNCORRELATED):
            break
        chosen = level
    tau = autocorrelation_time(blocks)
    # exact for one exponential; below 0 where neighbours alternate, and batches err on the safe side
    shared = (tau - 1 / (4 * tau)) / chosen.batch if chosen.inside and tau > 0 else 0.0
    missing = min(max(shared, -SHARE), 2 * SHARE)
    return Estimate(float(np.mean(blocks)), chosen.error / float(np.sqrt(1 - missing)), chosen, tau)


def autocorrelation_time(series: Array) -> float:
    """The integrated autocorrelation time `1/2 + sum of rho_k`, in steps of the series; 1/2 for independent steps.

    Steps run along the first axis, independent orbits along the second. The sum stops at `WINDOW` times its own
    value (Sokal), beyond which it is noise; partial sums over the second half of the window are averaged, since on an
    attractor of several pieces, visited in turn, correlations swing for ever.

    >>> white = np.random.default_rng(1).normal(size=(4096, 16))
    >>> bool(abs(autocorrelation_time(white) - 0.5) < 0.05)
    True
    >>> bool(autocorrelation_time(white + 3 * np.cos(np.pi * np.arange(4096))[:, None]) < 0.1)
    True
    """
    steps = len(series)
    away = series - np.mean(series)
    power = np.abs(np.fft.rfft(away, 2 * steps, axis=0)) ** 2
    covariance = np.fft.irfft(np.sum(power, axis=1))[:steps] / (steps - np.arange(steps)) / series.shape[1]
    if not covariance[0] > 0:
        return 0.5
    times = np.cumsum(covariance / covariance[0]) - 0.5
    lag = np.arange(1, steps + 1)
    sums = np.concatenate([[0.0], np.cumsum(times)])
    half = lag // 2
    mean = (sums[lag] - sums[half]) / (lag - half)
    enough = (lag >= WINDOW * mean) & (lag >= min(SHORTEST, steps // 4))
    return max(float(mean[np.argmax(enough)] if np.any(enough) else mean[steps // 4]), 0.0)


DISTANCES = tuple(10.0 ** (-k / 2) for k in range(4, 17))  # 1e-2 to 1e-8 in s and sin(phi)
FEWEST_STARTS = 10  # differing pairs at each of two distances, without which there is no fit
RESAMPLED = 400
NEWTON = 12  # steps, which double the digits


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """Pairs with different fates at each distance, and the fit over all; `smallest` to `largest` have enough pairs.

    `curvature` is the change of the local exponent per decade with its error: 0 for a power law.
    """

    distances: Array
    different: NDArray[np.int64]
    pairs: int
    exponent: float
    error: float
    curvature: tuple[float, float]
    largest: float
    smallest: float

    @property
    def dimension(self) -> float:
        """Of the boundary."""
        return 2 - self.exponent


def uncertainty(
    map: PinballMap,
    attractors: Sequence[Attractor],
    count: int,
    seed: int,
    window: Window | None = None,
    distances: Sequence[float] = DISTANCES,
    transient: int = TRANSIENT,
    sure: bool = True,
) -> Uncertainty:
    """The uncertainty exponent of the boundary between all basins in a window.

    A smooth boundary has the exponent 1:

    >>> from numeric.dynamics.attractors import find
    >>> map = PinballMap("egg", alpha="0.08", lam="0.2")
    >>> found = uncertainty(map, find(map, 100, 1), 4000, 1, distances=(0.03, 0.01, 0.003))
    >>> abs(found.exponent - 1) < 3 * found.error < 0.4
    True
    """
    rng = np.random.default_rng(seed)
    where = whole(map) if window is None else window
    s, height = random_points(where, count, rng)
    turn = rng.uniform(0, 2 * np.pi, count)
    centre = labels(map, starts_at(map, s, height), attractors, transient, sure)
    rows = []
    for eps in distances:
        near = starts_at(map, s + eps * np.cos(turn), height + eps * np.sin(turn))
        label = labels(map, near, attractors, transient, sure)
        rows.append((label != centre) & (label != UNSETTLED) & (centre != UNSETTLED))
    return fitted(np.array(distances), np.array(rows), rng)


def fitted(distances: Array, different: NDArray[np.bool_], rng: np.random.Generator) -> Uncertainty:
    """The power law through the shares of differing pairs; distances along the rows.

    >>> rng = np.random.default_rng(0)
    >>> eps = np.array([0.1, 0.01, 0.001])
    >>> found = fitted(eps, rng.uniform(size=20_000) < eps[:, None] ** 0.5, rng)
    >>> abs(found.exponent - 0.5) < 3 * found.error < 0.1
    True
    """
    counts, size = different.sum(axis=1), different.shape[1]
    used = counts >= FEWEST_STARTS
    if np.sum(used) < 2:
        nothing = float("nan")
        return Uncertainty(distances, counts, size, nothing, nothing, (nothing, nothing), nothing, nothing)
    draws = np.array([different[:, rng.integers(0, size, size)].sum(axis=1) for _ in range(RESAMPLED)])
    (slope, bend), *drawn = power_laws(elementary.log(distances), np.vstack([counts, draws]), size)
    errors, ends = np.nanstd(np.array(drawn), axis=0), distances[used]
    return Uncertainty(
        distances, counts, size, slope, float(errors[0]), (bend, float(errors[1])), float(max(ends)), float(min(ends))
    )


def power_laws(x: Array, counts: NDArray[np.int64], of: int) -> list[tuple[float, float]]:
    """Slope of `log f` against `log eps`, and its change per decade, for each row of counts.

    The most likely power law for binomial counts, by Newton's method: a count of 0 or 1 says as much as it
    knows. Logarithms of counts, the small ones left out, make the slope too small by a third of its error.
    """
    slopes = _most_likely(x, counts, of, 1)[:, 0]
    decade, curved = 2 * elementary.log(10), x.size > 2
    bends = decade * _most_likely(x, counts, of, 2)[:, 0] if curved else np.full(len(counts), np.nan)
    return [(float(slope), float(bend)) for slope, bend in zip(slopes, bends, strict=True)]


def _most_likely(x: Array, counts: NDArray[np.int64], of: int, degree: int) -> Array:
    """Coefficients of the polynomial `log f` of `x`, highest first, by reweighted least squares; a row for each row."""
    powers = np.vander(x - np.mean(x), degree + 1)  # the highest coefficient is the same about any point
    share = np.maximum(counts, 0.5) / of
    for _ in range(NEWTON):
        weight = of * share / (1 - share)
        wanted = weight * (elementary.log(share) + (counts / of - share) / share)
        normal = np.einsum("ri,ij,ik->rjk", weight, powers, powers)
        right = np.einsum("ri,ij->rj", wanted, powers)
        found: Array = np.einsum("rjk,rk->rj", np.linalg.pinv(normal, hermitian=True), right)
        share = np.clip(elementary.exp(found @ powers.T), 1e-300, 1 - 1 / (2 * of))
    return found
