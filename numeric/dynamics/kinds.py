"""What a ball ends on: an attractor, by its kind, its points and what was measured of it."""

from dataclasses import dataclass
from enum import Enum
from math import sqrt

from numeric import Status
from numeric.dynamics.phase_points import Places


class Kind(Enum):
    """What a ball ends on."""

    CYCLE = "an attracting cycle"
    CHAOTIC = "a chaotic set: an attractor when lam < 1"
    NEUTRAL = "cycles or curves that neither attract nor repel"
    STOPPED = "no attractor: the map is undefined there"


@dataclass(frozen=True)
class Share:
    """A part of the starts: how many, and the interval that holds the true share with 95 per cent confidence."""

    count: int
    of: int
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Attractor:
    """An attractor: its points (a cycle's in order, a cloud of others), and what was measured of it.

    `nu_plus` and `nu_minus` are per bounce, with standard errors (0 for a cycle, whose multipliers they come
    from). `reach` is the distance in `(x, y, sin(phi))` within which balls are taken to be caught: sampled,
    not proved. `stay` bounds the mean number of bounces before a ball leaves a chaotic attractor from below,
    with 95 per cent confidence: none of the balls seen left. `family` numbers attractors that are symmetry
    images of each other alike; `symmetry` is the attractor's own group, such as `D1`.
    """

    kind: Kind
    period: int
    points: Places
    multipliers: tuple[complex, complex] | None = None
    nu_plus: float = float("nan")
    nu_minus: float = float("nan")
    errors: tuple[float, float] = (0.0, 0.0)
    reach: float = 0.0
    stay: float = float("inf")
    status: Status = Status.REGULAR
    share: Share | None = None
    family: int = -1
    symmetry: str = ""


def wilson(count: int, of: int, z: float = 1.96) -> Share:
    """The share with Wilson's interval [Wilson1927], which never leaves 0 to 1 and is not empty at either.

    >>> share = wilson(0, 100)
    >>> share.low, round(share.high, 4)
    (0.0, 0.037)
    """
    p, w = count / of, z * z / of
    middle, half = (p + w / 2) / (1 + w), z * sqrt(p * (1 - p) / of + w / (4 * of)) / (1 + w)
    return Share(count, of, float(middle - half) if count else 0.0, float(middle + half) if count < of else 1.0)
