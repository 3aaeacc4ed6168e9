"""The tongue of the K-pointed egg: the bifurcation curves that lead to its chaotic attractor.

For odd K the vertex-to-flat diameter doubles its period on `alpha-tilde`; the symmetric cycle of period 4
that it bears breaks its symmetry (a pitchfork, on half the cycle), and what it bears doubles again and
again, up to an accumulation curve. Every rung is followed in the two letters from one start.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import pi

import numpy as np

from symbolic.cycles.thresholds import alpha_tilde
from symbolic.tables import egg
from symbolic.tables.symbols import lam
from verification.cycles.continuation.arc import Steps
from verification.cycles.continuation.branch import branch
from verification.cycles.continuation.curves import Curve, Degenerate, curve
from verification.cycles.continuation.switching import switched
from verification.cycles.recurrence.bifurcations import BifurcationKind
from verification.cycles.recurrence.chords import Chords
from verification.cycles.recurrence.closure import Closure
from verification.cycles.recurrence.recurrence import Array
from verification.named.feigenbaum import limit

TWO = ("alpha", "lam")
SHARE = 0.96  # of the shape whose diameter doubles at lam = 0: there every rung has its contraction
Tick = Callable[[str], None]


@dataclass(frozen=True)
class Rung:
    """One curve of the cascade: what becomes of a cycle of `period` bounces along it."""

    name: str
    period: int
    what: BifurcationKind
    curve: Curve = field(repr=False)

    @property
    def special(self) -> tuple[Degenerate, ...]:
        """Its points of codimension two."""
        return self.curve.special

    def lam(self, alpha: float) -> float | None:
        """The contraction on the curve at a shape; None where the curve does not go."""
        found = self.curve.crossing(alpha)
        return float(found[0][-1]) if found else None


def largest_shape(K: int) -> float:
    """The largest `alpha` with a convex table, `1/(1 + K**2)`."""
    return 1 / (1 + K * K)


def cascade(K: int = 3, highest: int = 64, tick: Tick = lambda name: None) -> Iterator[Rung]:
    """The curves from the diameter's doubling up to the cycles of `highest` bounces; for odd K.

    >>> rungs = cascade(3, 4)
    >>> [(rung.name, [d.what.value for d in rung.special]) for rung in rungs]  # doctest: +NORMALIZE_WHITESPACE
    [('doubling of 2', ['1:2 resonance']), ('symmetry breaking of 4', ['1:2 resonance']),
     ('doubling of 4', ['1:2 resonance'])]
    """
    if K % 2 == 0:
        raise ValueError(f"cascade: K = {K} is even, and no diameter doubles its period; accepted: odd K from 3")
    table, top = egg(K), largest_shape(K)
    at = {"alpha": SHARE * float(alpha_tilde(K).subs(lam, 0))}
    box, steps = ((top / 200, top), (0.0, 1.0)), Steps(largest=0.15)
    one = branch(Chords(table, (0, 0)), np.array([0.0, pi]), "lam", 0.0, (0.0, 1.0), at)
    period = 2
    while period <= highest:
        event = next(e for e in one.events if e.what in (BifurcationKind.FLIP, BifurcationKind.PITCHFORK))
        period = one.system.recurrence.period
        what = "doubling" if event.what is BifurcationKind.FLIP else "symmetry breaking"
        name = f"{what} of {period}"
        tick(name)
        found = curve(event.ring, BifurcationKind.FLIP, event.x, TWO, (at["alpha"], event.value), box, steps=steps)
        yield Rung(name, period, event.what, found)
        if period >= highest and event.what is BifurcationKind.FLIP:
            return
        one = switched(one, event, (0.0, 1.0))[0]


def fold(K: int = 3, p: int = 1, q: int = 3) -> Rung:
    """The fold of the polygon that turns by `2*pi*p/q`, one bounce of it followed (closed form: `polygons`)."""
    ring = polygon(K, p, q)
    top = largest_shape(K)
    at = {"alpha": 0.8 * top}
    one = branch(ring, np.array([pi / K]), "lam", 1.0, (0.0, 1.0), at)
    event = next(e for e in one.events if e.what is BifurcationKind.FOLD)
    box = ((top / 200, top), (0.0, 1.0))
    found = curve(ring, BifurcationKind.FOLD, event.x, TWO, (at["alpha"], event.value), box, steps=Steps(largest=0.15))
    return Rung(f"fold of {p}/{q}", q, BifurcationKind.FOLD, found)


def polygon(K: int, p: int, q: int) -> Chords:
    """One bounce of the cycle that turns by `2*pi*p/q` each time."""

    if K * p % q:
        raise ValueError(f"polygon: a turn by {p}/{q} does not map the egg with K = {K} to itself")
    return Chords(egg(K), (0,), Closure(1, (p, q)))


@dataclass(frozen=True)
class Accumulation:
    """Where the doublings pile up, a contraction with an error for each shape."""

    alpha: Array
    lam: Array
    error: Array


def accumulation(rungs: list[Rung], alphas: Array) -> Accumulation:
    """The end of the cascade at each shape that all the doublings reach.

    The error is the difference to a second extrapolation, or to the same one without the last rung if that is larger.
    """
    doublings = [rung for rung in rungs if rung.what is BifurcationKind.FLIP and rung.period > 2]
    found = []
    for alpha in alphas:
        values = [rung.lam(float(alpha)) for rung in doublings]
        if any(value is None for value in values):
            continue
        decimals = [repr(value) for value in values]
        estimate, shorter = limit(decimals), limit(decimals[:-1])
        error = max(estimate.error, abs(estimate.value - shorter.value))
        found.append((float(alpha), float(estimate.value), float(error)))
    rows = np.array(found).reshape(-1, 3)
    return Accumulation(rows[:, 0], rows[:, 1], rows[:, 2])
