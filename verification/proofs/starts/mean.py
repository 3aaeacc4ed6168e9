"""The mean of the larger exponent `nu_plus` over random starts on the cuspless table is negative near `lambda*`.

Let `u` be a bound of the share of starts that are not proved to converge to the cycle of period 2, let `nu < 0` be the
exponent of that cycle, and `M` a bound for the exponents of all orbits. Then the mean is at most `(1 - u)*nu + u*M`.
This is proved for every contraction from `LOW` to `HIGH`, an interval that contains `lambda*`, where a chaotic
attractor is born. Paper: section 5.3.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
from flint import arb
from sympy import Expr, Interval, Rational, S, integrate, log, pi

from symbolic import Scene
from symbolic.cycles.cycle import cuspless_horizontal, trace_and_determinant
from symbolic.expressions.signs import SignFinding, conjunction, positive
from symbolic.tables.geometry import velocity
from symbolic.tables.table import Table, lam, theta
from verification.arithmetic.arrays import hull
from verification.arithmetic.balls import enclose, working
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.starts.core import AbsorbingTube, attracts
from verification.proofs.starts.strips import bounded, remainder, speeds, strips

LOW, HIGH = Fraction("0.0712"), Fraction("0.0713")
ENTRY_TUBES = (0.405, 0.003), (0.4, 0.006), (0.38, 0.012), (0.36, 0.03)
CORE = AbsorbingTube(1, 0.0707, -0.0233, width=0.0006, inner=0.05, outer=0.41, cells=410, entry_tubes=ENTRY_TUBES)
MULTIPLIER = Rational(928, 1000)  # a bound of the moduli of the multipliers of period 2
RATE, BOUNCES, WEIGHT = Fraction("0.52"), 2, 0.05  # bound of nu_plus; bounces and weight of the norm that proves it
COLUMNS, ROWS = (512, 64), 48  # of the first strips
MESH = 2000  # points of each component, for the diameter
ENOUGH = 0.98  # relative to the measure of undecided starts at which the mean would be 0
BITS = 64
SLACK = 1 + 2.0**-40


@dataclass(frozen=True)
class Average:
    """The bound `mean`, with the `checks` of each step of its proof, and the bound `share` of undecided starts."""

    checks: dict[str, bool]
    share: float
    mean: float
    strips: int


def area(table: Table) -> Expr:
    """The area of a table, by Green's theorem.

    >>> from symbolic import tables
    >>> area(tables.cuspless)
    15*sqrt(3)/16 + pi
    """
    total = S.Zero
    for component in table.components:
        (x, y), (dx, dy) = component.point, velocity(component)
        total += integrate((x * dy - y * dx).expand(), (theta, component.start, component.end)) / 2
    return total.expand()


def diameter(map: PinballImages) -> float:
    """An upper bound of the diameter of a table, from a mesh of boundary points and the distance between neighbours.

    >>> cuspless = PinballImages(Scene("cuspless", lam="1/2"))
    >>> 0 < diameter(cuspless) - 1.5 * 3**0.5 < 0.01
    True
    """
    places, gap = [], 0.0
    for chart, ends in enumerate(map.charts):
        theta = np.linspace(*ends.x, MESH + 1)
        on = np.full(MESH, chart)
        x, y, *_ = map.place(np.full(MESH + 1, chart), hull(theta, theta))
        places.append(np.stack([x.m, y.m]))
        gap = max(gap, float(np.max(speeds(map, on, hull(theta[:-1], theta[1:])).upper() * np.diff(theta))))
    x, y = np.concatenate(places, axis=1)
    most = max(float(np.max(np.sqrt((x - a) * (x - a) + (y - b) * (y - b)))) for a, b in zip(x, y, strict=True))
    return (most + gap) * SLACK


def stable(trace: Expr, det: Expr, low: Fraction, high: Fraction) -> SignFinding:
    """The finding that both multipliers are below `MULTIPLIER` in modulus, for the whole range (Jury test)."""
    r, box = MULTIPLIER, {lam: Interval(Rational(str(low)), Rational(str(high)))}
    return conjunction(*(positive(x, box) for x in (r**2 - trace * r + det, r**2 + trace * r + det, r**2 - det)))


@cache
def average() -> Average:
    """A bound of the mean for each contraction of the range around `lambda*`; infinite if a step of the proof fails."""
    map = PinballImages(Scene("cuspless", lam=str(HIGH)), (LOW, HIGH))
    trace, det = trace_and_determinant(cuspless_horizontal())
    checks = attracts(map, CORE)
    checks["no orbit grows faster"] = bounded(map, float(RATE), BOUNCES, WEIGHT)
    checks["period 2 is as stable"] = bool(stable(trace, det, LOW, HIGH))
    nu, rate = float(enclose(log(MULTIPLIER) / 2).real.upper()), float(RATE)
    with working(BITS):
        ratio = float((arb(diameter(map)) / (2 * enclose(pi * area(map.map.table)).real)).upper())
    enough = -nu / (rate - nu) / ratio * ENOUGH
    left = remainder(map, CORE, strips(map, COLUMNS, ROWS), enough)
    share = left.measure * ratio * SLACK
    mean = ((1 - share) * nu + share * rate) if share < 1 and all(checks.values()) else np.inf
    return Average(checks, share, mean + 1e-12, left.strips)
