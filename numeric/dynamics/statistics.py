"""Error bars of time averages: batch means over orbits and blocks, with batches longer than the memory of an orbit.

Blocks of an orbit depend on each other, so their standard deviation over the square root of their number is no valid
standard error. Neighbouring blocks are merged two by two [FlyvbjergPetersen1989] until only as many batches are left as
an error bar needs, and further while neighbours are seen to be correlated; the remaining correlation is corrected with
the autocorrelation time. The last level has one batch for each orbit: orbits start independently, so that its error is
right however long the correlations last.
"""

from dataclasses import dataclass

import numpy as np

from numeric.backends import elementary
from numeric.dynamics.phase_points import Array

ENOUGH = 32  # batches: the error bar is then known to one part in eight
FEWEST = 8  # batches, below which an error bar is a guess
SHARE = 0.25  # of a batch that the autocorrelation time may take
UNCORRELATED = 2.5  # standard deviations that the correlation of neighbours may show
WINDOW = 6.0  # autocorrelation times to sum over (Sokal)
SHORTEST = 32  # steps to sum over at least


@dataclass(frozen=True)
class Batches:
    """Batches of equal size: blocks per batch, number of batches, the standard error from them, and their correlation.

    `score` is the correlation of neighbours, divided by the standard deviation that it has for independent batches.
    """

    batch: int
    count: int
    error: float
    score: float
    inside: bool  # more than one batch to an orbit
    skewness: float  # of the batches; 0 for a symmetric distribution


@dataclass(frozen=True)
class Estimate:
    """A mean, its standard error, the batches that gave this error, and the autocorrelation time `tau` in blocks."""

    mean: float
    error: float
    level: Batches
    tau: float

    @property
    def share(self) -> float:
        """The autocorrelation time divided by the length of a batch; 0 when a batch is a whole orbit."""
        return self.tau / self.level.batch if self.level.inside else 0.0

    @property
    def reach(self) -> float:
        """The distance from the mean to the farther end of the 95 per cent interval."""
        low, high = self.interval
        return max(self.mean - low, high - self.mean)

    @property
    def trusted(self) -> bool:
        """Are there enough batches, each long compared with the autocorrelation time?"""
        return self.level.count >= FEWEST and self.share < SHARE

    @property
    def skewed(self) -> bool:
        """Are batches more skewed than 19 of 20 normal samples? Then rare batches make up much of the error."""
        return abs(self.level.skewness) > 1.96 * float(np.sqrt(6 / self.level.count))

    @property
    def interval(self) -> tuple[float, float]:
        """The ends of a 95 per cent interval: Student's, extended on either side to Hall's where that reaches farther.

        Hall's interval uses a cubic polynomial of Student's `t` that removes skewness to first order [Hall1992]. A run
        that met few of the rare batches has a biased mean and too small an error: there Hall's interval is longer.
        """
        from scipy.special import stdtrit  # a quarter of a second that a run without error bars does without

        student = float(stdtrit(max(self.level.count - 1, 1), 0.975))
        low, high = (_without_skewness(t, self.level.skewness / self.level.count**0.5) for t in (-student, student))
        return self.mean - self.error * max(high, student), self.mean - self.error * min(low, -student)


def _without_skewness(t: float, skewness: float) -> float:
    """The value of `t` at which Hall's polynomial, for a mean of this skewness, equals the given `t`."""
    if abs(skewness) < 1e-6:  # the limit
        return t
    cube = 1 + skewness * (t - skewness / 6)
    return 3 / skewness * (float(np.sign(cube) * elementary.root(abs(cube), 3)) - 1)


def levels(blocks: Array) -> list[Batches]:
    """The error of the mean for each size of batches, from single blocks to whole orbits; blocks on the first axis.

    The errors are those of the last `2**k` blocks, with `k` as large as possible.

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
        square = float(np.mean(away**2))
        skewness = float(np.mean(away * away**2)) / (square * square**0.5) if variance > 0 else 0.0
        found.append(Batches(batch, x.size, error, score, len(x) > 1, skewness))
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
    value (Sokal), beyond which it is noise; partial sums over the second half of the window are averaged, because on an
    attractor of several pieces, visited in turn, correlations oscillate for ever.

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
