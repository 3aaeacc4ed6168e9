"""The two crises of the egg's chaotic attractor by sampling: estimates of where, and the transient. Paper: section 6.7.

`verification.manifolds` has the same crises as tangencies, to many digits; this is what balls do.

Below a crisis no ball leaves the attractor; above it each bounce has a chance to, which grows from 0
like a power of the distance. So many balls are started on the attractor, and the contractions at
which some leave are bracketed. Just above a crisis a budget of bounces sees none leave; the error
reaches up to the contraction at which it saw ten.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from numeric import Exponents, PinballMap

BALLS, PART, TRANSIENT = 4096, 200, 2000
SEED = 1
BLOCKS = 6
Array = NDArray[np.float64]
Left = Callable[[Exponents], NDArray[np.bool_]]


@dataclass(frozen=True)
class Scaling:
    """`stay ~ distance**-exponent`; the error is a jackknife over blocks, as the points oscillate about the power."""

    exponent: float
    error: float
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Crisis:
    """`lam +- error`, with the mean number of bounces before leaving at a few contractions above."""

    lam: float
    error: float
    stays: tuple[tuple[float, float], ...]
    bounces: int


def changed_axis(ball: Exponents) -> NDArray[np.bool_]:
    """Is the ball away from the diameter on the x axis, near which it started?"""
    return np.asarray(np.round(ball.theta / (np.pi / 3)).astype(int) % 3 != 0)


def settled(ball: Exponents) -> NDArray[np.bool_]:
    """Does the ball's neighbourhood shrink, as it does only near a periodic attractor?"""
    return np.asarray(ball.nu_plus < -0.1)


KINDS: dict[str, tuple[Left, tuple[float, float]]] = {
    "merging": (changed_axis, (0.4425, 0.4450)),
    "boundary": (settled, (0.6500, 0.6700)),
}


def crisis(kind: str, alpha: str, tolerance: float = 2e-6, budget: int = 10**8) -> Crisis:
    """The `merging` crisis (three pieces become one) or the `boundary` crisis (the attractor vanishes).

    >>> found = crisis("merging", "0.08", tolerance=1e-3, budget=10**6)
    >>> abs(found.lam - 0.4434) < 1e-3
    True
    """
    left, (low, high) = KINDS[kind]
    if not np.isfinite(stay(left, alpha, high, budget)) or np.isfinite(stay(left, alpha, low, budget)):
        raise ValueError(f"{kind} crisis: none between lam = {low} and {high} at alpha = {alpha}; it is known at 0.08")
    stays: list[tuple[float, float]] = []
    spent = 2 * budget
    while high - low > tolerance:
        lam = (low + high) / 2
        mean = stay(left, alpha, lam, budget)
        spent += budget
        if np.isfinite(mean):
            high = lam
            stays.append((lam, mean))
        else:
            low = lam
    return Crisis((low + high) / 2, spread(stays, low, high, budget), tuple(stays), spent)


def stay(left: Left, alpha: str, lam: float, budget: int) -> float:
    """The mean number of bounces on the attractor before a ball leaves; infinite when none did."""
    map = PinballMap("egg", lam=lam, alpha=alpha)
    rng = np.random.default_rng(SEED)
    ball = map.exponents(rng.uniform(-0.05, 0.05, BALLS), rng.uniform(-0.05, 0.05, BALLS), TRANSIENT)
    ball = map.exponents(ball.theta, ball.phi, PART)
    inside = ~left(ball)
    theta, phi = ball.theta[inside], ball.phi[inside]
    gone = spent = 0
    while spent < budget and theta.size > gone:
        ball = map.exponents(theta, phi, PART)
        out = left(ball)
        spent += PART * theta.size
        gone += int(out.sum())
        if out.all() or gone >= 400:
            break
        keep = np.where(out, int(np.argmin(out)), np.arange(theta.size))  # who left is replaced by one who stayed
        theta, phi = ball.theta[keep], ball.phi[keep]
    return spent / gone if gone else float("inf")


def spread(stays: list[tuple[float, float]], low: float, high: float, budget: int) -> float:
    """From the middle of the bracket to the least contraction at which at least ten balls left within the budget.

    >>> spread([(0.5, 10.0), (0.4, 1e7)], 0.38, 0.4, 10**7)
    0.11
    """
    seen = [lam for lam, mean in stays if mean * 10 <= budget]
    return round(max((high - low) / 2, min(seen, default=high) - (low + high) / 2), 12)


def scaling(kind: str, alpha: str, at: float, distances: Array, budget: int = 10**9) -> Scaling:
    """The power of the mean stay above a crisis at `at`, from its values at `distances` above."""
    left, _ = KINDS[kind]
    stays = [(float(d), stay(left, alpha, at + float(d), budget)) for d in distances]
    return power(tuple((d, mean) for d, mean in stays if np.isfinite(mean)))


def power(points: tuple[tuple[float, float], ...]) -> Scaling:
    """The least-squares power through points in order, with a jackknife over `BLOCKS` blocks of neighbours.

    >>> power(tuple((x, x**-2) for x in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6))).exponent
    2.0
    """
    if len(points) < BLOCKS:
        raise ValueError(f"scaling: {len(points)} finite points are too few; accepted: {BLOCKS} or more")
    x, y = np.log(np.array(points)).T
    blocks = np.array_split(np.arange(x.size), BLOCKS)
    slopes = [_slope(np.delete(x, block), np.delete(y, block)) for block in blocks]
    error = np.sqrt((BLOCKS - 1) * np.mean((np.array(slopes) - np.mean(slopes)) ** 2))
    return Scaling(round(-_slope(x, y), 12), float(error), points)


def _slope(x: Array, y: Array) -> float:
    return float(np.polyfit(x, y, 1)[0])
