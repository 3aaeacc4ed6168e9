"""Local manifolds in complex balls, with a bound for all that a truncated series leaves out.

Let `m` be the multiplier that expands outwards, `P` the series and `P_N` its terms to order `N`. The
rule at `P_N(z), P_N(z/m), P_N(z/m**2)` is an analytic function `r(z)` without terms up to order `N`, so
on the unit disc it is at most `R**-(N+1)` times its bound on a disc of radius `R` (Schwarz). The true
manifold is `P_N + h`, where `h` is the fixed point of a map that contracts by at most
`k = |b|*m**-(N+1) + |c|*m**-(2*N+2)`, `b` and `c` the slopes of the map or its inverse: shifting `z` to
`z/m` makes functions without low orders small. Hence `|h| <= sup|r|/slope/(1 - k)` there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, arb, ctx, fmpq

from verification.arithmetic import FUNCTIONS, Arithmetic
from verification.manifolds.recurrence import Pinball, Recurrence
from verification.manifolds.saddle import Orbit, Saddle, padded, slopes
from verification.manifolds.series import doubled, horner
from verification.shooting.jets import Jet

OUTER = 12  # radius `R` of the disc on which the rule is bounded, in units of the working disc


class TooWideError(ValueError):
    """A step of the proof whose balls are too wide."""


def complex_balls(bits: int) -> Arithmetic:
    """The words of the kernels for complex balls, analytic wherever they are finite."""

    def rational(p: int, n: int) -> acb:
        with ctx.workprec(bits):
            return acb(arb(fmpq(p, n)))

    with ctx.workprec(bits):
        pi = acb.pi()
    cut = {"atan": lambda x: abs(x.imag) < 1, "sqrt": lambda x: x.real > 0, "log": lambda x: x.real > 0}
    return {word: _analytic(word, cut.get(word)) for word in FUNCTIONS} | {"q": rational, "pi": pi}


def _analytic(word: str, defined: Callable[[acb], bool] | None) -> Callable[[Any], acb]:
    """The function where it is analytic over the whole ball, and nothing at all where a cut may pass through."""

    def function(x: Any) -> acb:
        ball = acb(x)
        return getattr(ball, word)() if defined is None or defined(ball) else acb("nan")

    return function


def around_zero(radius: arb) -> acb:
    """A complex ball (a square) that contains all numbers of at most this size."""
    half = arb(0, radius.abs_upper())
    return acb(half, half)


def size(x: acb) -> arb:
    """An upper bound of the absolute value."""
    return arb(abs(x).abs_upper())


@dataclass(frozen=True)
class Enclosed:
    """`P_N` with enclosed coefficients on the unit disc, and `error`, which bounds the rest there."""

    saddle: Saddle
    factor: acb
    coefficients: tuple[acb, ...]
    error: arb

    def at(self, z: Jet) -> Jet:
        """The manifold along a curve of parameters in the disc of radius 1/2, where Cauchy bounds derivatives."""
        if not abs(z.c[0]) < 0.5:
            raise TooWideError("the parameter leaves the disc of radius 1/2")
        first, second = around_zero(2 * self.error), around_zero(4 * self.error)
        rest = Jet(around_zero(self.error), first * z.c[1], second * z.c[1] * z.c[1] + first * z.c[2])
        return horner(self.coefficients, z) + rest  # type: ignore[no-any-return]

    def points(self, z: Jet) -> tuple[Jet, Jet]:
        """Two neighbours of the orbit through `z`."""
        orbit = self.saddle.orbit
        return self.at(z), orbit.sign * self.at(self.factor * z) + orbit.shifted(self.saddle.map)


def enclosed_saddle(orbit: Orbit, map: Pinball, letter: acb, start: float) -> Saddle:
    """A saddle of one bounce, for every letter in a ball, by an interval Newton step."""

    def rule(x: acb) -> tuple[acb, acb]:
        near = padded(orbit, map, [x])
        return map.rule(near, letter), sum_of(orbit, slopes(orbit, map, [x], letter)[0])

    middle = acb(start)
    for _ in range(12):
        value, slope = rule(middle)
        middle = (middle - value / slope).mid()
    value, slope = rule(middle)
    box = middle + around_zero(4 * size(value / slope) + arb(2) ** (-ctx.prec + 8))
    found = middle - value / rule(box)[1]
    if not box.contains(found):
        raise TooWideError(f"the {orbit.name} is not enclosed")
    stable, unstable = multipliers_of(orbit, map, found, letter)
    return Saddle(orbit, map, letter, (found,), stable, unstable)


def sum_of(orbit: Orbit, row: tuple[acb, acb, acb]) -> acb:
    """The derivative of the rule when all three points move as the symmetry says."""
    return orbit.sign * row[0] + row[1] + orbit.sign * row[2]


def multipliers_of(orbit: Orbit, map: Pinball, x: acb, letter: acb) -> tuple[acb, acb]:
    """The roots of `after*m**2 + here*m + before`, the one inside the unit circle first."""
    before, here, after = slopes(orbit, map, [x], letter)[0]
    trace, determinant = -orbit.sign * here / after, before / after
    root = (trace * trace - 4 * determinant).sqrt()
    larger = (trace + root) / 2 if trace.real > 0 else (trace - root) / 2
    return determinant / larger, larger


def enclosed(saddle: Saddle, unstable: bool, order: int, unit: float) -> Enclosed:
    """The manifold of a saddle of one bounce, where `z = 1` is `unit` along the eigenvector."""
    factor = saddle.unstable if unstable else saddle.stable
    outwards = factor if unstable else 1 / factor
    series = [[saddle.points[0], acb(1)]]
    while len(series[0]) <= order:
        series = doubled(saddle, factor, series, min(2 * len(series[0]), order + 1))
    scaled = tuple(c * acb(unit) ** k for k, c in enumerate(series[0]))
    made = Enclosed(saddle, factor, scaled, arb(0))
    wide, narrow = (rule_over(made, outwards, unstable, radius) for radius in (OUTER, 1))
    outer, slope = wide[0], narrow[1]
    small = size(outer) * arb(OUTER) ** -(order + 1)
    first, second = (size(s) / arb(abs(slope).abs_lower()) for s in narrow[2:])
    shrink = arb(abs(1 / outwards).abs_upper()) ** (order + 1)
    contraction = first * shrink + second * shrink * shrink
    if not (contraction < 0.5 and abs(slope) > 0):
        raise TooWideError("the remainder of the series is not bounded")
    error = 2 * small / arb(abs(slope).abs_lower())
    if not (error < 1e-9 and first + second < 100):  # then the fixed point stays in the tube that `narrow` allows for
        raise TooWideError(f"the remainder of the series is only known to be below {error}")
    return Enclosed(saddle, factor, scaled, error)


def rule_over(made: Enclosed, outwards: acb, unstable: bool, radius: int) -> tuple[acb, acb, acb, acb]:
    """The rule over a disc of parameters, and its slopes by the outermost point, the next and the one after."""
    saddle, map = made.saddle, made.saddle.map
    tube = around_zero(arb("1e-6"))
    disc = around_zero(arb(radius))
    points = [horner(made.coefficients, disc / outwards**k) + tube for k in range(3)]  # outermost first
    near = neighbours(saddle.orbit, map, points[::-1] if unstable else points)
    rows = map.slopes(near, saddle.letter)
    ordered: Sequence[Any] = rows[::-1] if unstable else rows
    return map.rule(near, saddle.letter), ordered[0], ordered[1], ordered[2]


def neighbours(orbit: Orbit, map: Recurrence, points: Sequence[acb]) -> list[acb]:
    """Three successive points of the series, in the order of the orbit, as bounces around the middle one."""
    shift = orbit.shifted(map)
    before, here, after = points
    return [orbit.sign * (before - shift), here, orbit.sign * after + shift]
