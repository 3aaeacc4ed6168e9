"""Arc length on every component, counted counterclockwise from the table's origin, and its inverse.

Closed forms for circle and cardioid, SciPy's elliptic integral for the ellipse, and for anything else
a Fourier or Chebyshev series of the speed, extended until its tail is below rounding, integrated term
by term. The inverse is Newton's method on these, whose derivative is the speed itself.
"""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from numeric.pinball.coordinates import States

Array = NDArray[np.float64]
MOST = 1 << 14  # terms; a boundary that needs more is not smooth
SETTLED = 1e-9  # radians: the step after one this short is below rounding
HIGHEST = 1 << 10  # degree of a Chebyshev series
ROUNDING = 4e-16  # of the largest speed: what a transform of rounded samples leaves in a coefficient that is 0


class Waves(NamedTuple):
    """The integral of a speed of period `2*pi` from 0: `mean*theta`, and waves of a few frequencies.

    >>> Waves.of(lambda theta: 2 + np.cos(3 * theta)).frequencies.tolist()
    [3]
    """

    mean: float
    frequencies: NDArray[np.int64]
    sines: Array  # coefficients of `sin(k*theta)`, and of `1 - cos(k*theta)` in the integral
    rises: Array

    @staticmethod
    def of(speed: Callable[[Array], Array]) -> "Waves":
        """From twice as many samples until they will do."""
        count = 64
        while True:
            theta = 2 * np.pi * np.arange(count) / count - np.pi
            values = speed(theta)
            c = np.fft.rfft(values) / count * (-1.0) ** np.arange(count // 2 + 1)
            if settled(c, values) or count >= MOST:
                break
            count *= 2
        kept = np.flatnonzero(np.abs(c[: count // 3]) > ROUNDING * np.max(values))[1:]
        terms = 2 * c[kept] / kept
        return Waves(c[0].real, kept, terms.real, -terms.imag)

    def __call__(self, theta: Array) -> Array:
        """The integral, smallest waves first."""
        flat = theta.ravel()
        k = self.frequencies[:, None]
        waves = self.sines[:, None] * np.sin(k * flat) + 2 * self.rises[:, None] * np.sin(k * flat / 2) ** 2
        return np.asarray((self.mean * flat + np.sum(waves[::-1], axis=0)).reshape(theta.shape))


def settled(coefficients: Array, values: Array) -> bool:
    """Whether the last third of the coefficients is what rounding leaves of such values."""
    last = coefficients[2 * (len(coefficients) - 1) // 3 :]
    return bool(np.max(np.abs(last)) < ROUNDING * np.max(values))


def chebyshev(speed: Callable[[Array], Array], low: float, high: float) -> Callable[[Array], Array]:
    """The integral of a speed from 0, or from `low` where 0 is beyond, from twice the degree until that will do.

    The coefficients are those of the waves of the speed in an angle whose cosine runs from one end to the other.
    """
    from numpy.polynomial import Chebyshev

    degree = 16
    while True:
        x = np.cos(np.pi * np.arange(degree + 1) / degree)
        values = speed(low + (high - low) * (1 + x) / 2)
        c = np.fft.hfft(values)[: degree + 1] / degree  # `values` is half of an even sequence
        c[0] /= 2
        if settled(c, values) or degree >= HIGHEST:
            break
        degree *= 2
    kept = np.flatnonzero(np.abs(c) > ROUNDING * np.max(values))
    integral = Chebyshev(c[: kept[-1] + 1], [low, high]).integ(lbnd=0.0 if low <= 0.0 <= high else low)
    return lambda theta: np.asarray(integral(theta))


class ArcLength:
    """The paper's `s`, not wrapped: `s` grows with `theta` on each component and is 0 at the origin."""

    def __init__(self, states: States) -> None:
        self.states = states
        self.lengths = [self._length(index) for index in range(len(states.ends))]
        index, program = states.boundary.blueprint.origin
        offsets = {}
        zero, (first, last) = float(program(states.ops, *states.shape)[0]), states.ends[index]
        reached = -float(self.lengths[index](np.array(min(max(zero, first), last))))  # 0 where nothing else is said
        for turn in range(len(states.ends)):
            at = (index + turn) % len(states.ends)
            low, high = states.ends[at]
            if turn:
                reached -= float(self.lengths[at](np.array(low)))
            offsets[at] = reached
            reached += float(self.lengths[at](np.array(high)))
        self.offsets = [offsets[i] for i in range(len(states.ends))]

    def s(self, theta: Array, component: NDArray[np.int64] | int = 0) -> Array:
        """Arc length at `theta`."""
        theta, component = np.broadcast_arrays(np.asarray(theta, dtype=float), component)
        out = np.empty(theta.shape)
        for index, (length, offset) in enumerate(zip(self.lengths, self.offsets, strict=True)):
            here = component == index
            out[here] = length(theta[here]) + offset
        return out

    def theta(self, s: Array, component: NDArray[np.int64] | int = 0) -> Array:
        """The parameter at arc length `s` on a component; ends of the component are included."""
        s, component = np.broadcast_arrays(np.asarray(s, dtype=float), component)
        out = np.empty(s.shape)
        for index, (low, high) in enumerate(self.states.ends):
            here = component == index
            if np.any(here):
                out[here] = self._inverse(index, s[here] - self.offsets[index], low, high)
        return out

    @cached_property
    def perimeter(self) -> float:
        """The length of the whole boundary."""
        return sum(
            float(length(np.array(high)) - length(np.array(low)))
            for length, (low, high) in zip(self.lengths, self.states.ends, strict=True)
        )

    def _inverse(self, index: int, s: Array, low: float, high: float) -> Array:
        length = self.lengths[index]
        bottom, top = float(length(np.array(low))), float(length(np.array(high)))
        slack = 1e-14 * (top - bottom)
        if np.any((s < bottom - slack) | (s > top + slack)):
            bad = s[(s < bottom - slack) | (s > top + slack)].flat[0] + self.offsets[index]
            name = self.states.boundary.blueprint.parts[index].name
            first, last = bottom + self.offsets[index], top + self.offsets[index]
            raise ValueError(f"s = {bad} is not on the {name}; there s lies in [{first:.17g}, {last:.17g}]")
        inverse = self.states.family.parameter(index, s)
        if inverse is not None:
            return inverse
        grid = np.linspace(low, high, 1025)
        theta = np.interp(s, length(grid), grid)
        where = np.full(theta.shape, index)
        for _ in range(6):
            step = (length(theta) - s) / self.states.speed(where, theta)
            theta = np.clip(theta - step, low, high)
            if np.max(np.abs(step), initial=0.0) < SETTLED:
                break
        return theta

    def _length(self, index: int) -> Callable[[Array], Array]:
        family = self.states.family
        if family.arclength(self.states.ops, index, np.zeros(1)) is not None:
            return lambda theta: np.asarray(family.arclength(self.states.ops, index, theta))
        m = family.elliptic()
        if m is not None:
            from scipy.special import ellipeinc

            return lambda theta: np.asarray(ellipeinc(theta, m))

        def speed(at: Array) -> Array:
            return self.states.speed(np.full(at.shape, index), at)

        low, high = self.states.ends[index]
        return Waves.of(speed).__call__ if self.states.boundary.closed else chebyshev(speed, low, high)
