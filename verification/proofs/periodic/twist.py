"""Islands: an elliptic cycle of the elastic map whose twist is proved not to vanish is surrounded by invariant curves.

Moser's twist theorem [Moser1962] [SiegelMoser1971] asks of an area-preserving analytic map: a multiplier on the unit
circle whose first four powers are not 1, and a normal form `w -> mu*w*(1 + i*twist*|w|^2 + ...)` with `twist` not 0.
Both are decided by balls on an enclosed cycle. The theorem itself is taken from the literature.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import factorial
from typing import Any

from flint import acb, arb
from sympy import diff

from symbolic.cycles.twist import QUARTIC, Map, bounce, chord, composed
from symbolic.generation.text import kernel, load
from symbolic.tables.symbols import theta
from symbolic.tables.table import Table
from verification.arithmetic.words import balls, working


@dataclass(frozen=True)
class Twist:
    """Of an elliptic cycle: trace, twist, and the real part of the cubic coefficient, which conserved area makes 0."""

    trace: arb
    twist: arb
    drift: arb

    @property
    def islands(self) -> bool | None:
        """True when the hypotheses of the twist theorem are proved: no power of `mu` up to the fourth is 1."""
        elliptic = abs(self.trace) < 2 and self.trace != 0 and self.trace + 1 != 0
        return True if elliptic and (self.twist > 0 or self.twist < 0) else None


def twist(points: Table, components: Sequence[int], bounces: Sequence[arb], bits: int) -> Twist:
    """The twist of the elastic cycle through the enclosed boundary parameters.

    >>> from symbolic.tables import ellipse
    >>> axis = twist(ellipse.at(a=3), (0, 0), [-arb.pi() / 2, arb.pi() / 2], 100)  # trace 4*(1 - 2/9)^2 - 2
    >>> (81 * axis.trace).contains(34), axis.drift.contains(0)
    (True, True)
    """
    with working(bits):
        jets = [_jet(points, index, bits)(at) for index, at in zip(components, bounces, strict=True)]
        ends = [(jet[: QUARTIC + 1], jet[QUARTIC + 1 :]) for jet in jets]
        flights = zip(ends, [*ends[1:], ends[0]], strict=True)
        return normal_form(composed([bounce(chord(here, there, lambda x: x.sqrt())) for here, there in flights]))


def normal_form(map: Map) -> Twist:
    """Trace and twist of a map that preserves area, at an elliptic fixed point. `c1` as in [Kuznetsov2004]."""
    x, p = map
    A, B, D = x[1, 0], x[0, 1], p[0, 1]
    trace = A + D
    sine = (1 - trace * trace / 4).sqrt()
    sine = sine if B > 0 else -sine
    alpha, beta = (A - D) / (2 * sine), B / sine
    mu, scale = acb(trace / 2, sine), beta.sqrt()
    # x = scale*X, p = (P - alpha*X)/scale turns by the angle; z = X - i*P, so X = (z + w)/2, P = i*(z - w)/2
    one, i = acb(1), acb(0, 1)
    X = {(1, 0): one / 2, (0, 1): one / 2}
    P = {(1, 0): i / 2, (0, 1): -i / 2}
    here = {at: scale * c for at, c in X.items()}, {at: (P[at] - alpha * X[at]) / scale for at in X}
    moved = composed([here, map])
    turned = {
        at: moved[0].get(at, 0) / scale - i * (scale * moved[1].get(at, 0) + alpha * moved[0].get(at, 0) / scale)
        for at in {**moved[0], **moved[1]}
    }
    g20, g11, g02, g21 = (turned.get(at, acb(0)) * n for at, n in (((2, 0), 2), ((1, 1), 1), ((0, 2), 2), ((2, 1), 2)))
    bar = mu.conjugate()
    c1 = (
        g20 * g11 * (bar - 3 + 2 * mu) / (2 * (mu * mu - mu) * (bar - 1))
        + g11 * g11.conjugate() / (1 - bar)
        + g02 * g02.conjugate() / (2 * (mu * mu - bar))
        + g21 / 2
    )
    return Twist(trace, (bar * c1).imag, (bar * c1).real)


@cache
def _jet(table: Table, index: int, bits: int) -> Any:
    """The Taylor coefficients of `x`, then those of `y`, on a component."""
    x, y = table.components[index].point
    terms = {f"{name}{k}": diff(f, theta, k) / factorial(k) for name, f in (("x", x), ("y", y)) for k in range(5)}
    return load(kernel("jet", [theta], terms), balls(bits))
