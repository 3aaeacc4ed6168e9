"""Enclosures of saddles and their local manifolds in complex balls, for every parameter in a ball at once.

A saddle of `p` bounces is the zero of its `p` collision rules, enclosed by an interval Newton step; the product of the
derivatives gives the multipliers. With these in balls `doubled` encloses the coefficients of the series order by order,
since each order is a linear system whose right side has only lower orders. The function `remainder` bounds the
truncation error, as follows.

Let `P[i]`, `0 <= i < p`, be the polynomials of order `N`, continued to all `i` by `P[i+p](z) = sign*P[i](mu*z) +
shift`. We look for functions `h[i]`, analytic on the unit disc, without terms up to order `N` and continued likewise,
such that `P + h` obeys the rule. Let `m` be the multiplier outwards: `mu` for the unstable manifold, `1/mu` for the
stable one. Going outwards, each rule is solved for its outermost point:

1. The rule along `P` is an analytic function without terms up to order `N`. So on the unit disc it is at most
   `R**-(N+1)` times its bound on the disc of radius `R` (Schwarz's lemma), which takes one evaluation in balls.
2. One round nearer to the saddle the functions are `sign*h[i](z/m)`, at most `abs(m)**-(N+1)` times the bound of `h[i]`
   (Schwarz again). This makes the sought functions small on the right side, and no inverse is needed.
3. Where the two inner points of a rule are off by at most `e1` and `e2`, the outermost one is off by at most `(defect +
   slope1*e1 + slope2*e2)/slope0`. The slopes are bounded over a convex tube around `P`, and `slope0` is not 0 there, so
   such a point exists and is the only one in the tube (an interval Newton step).

So a round outwards maps bounds `e[0], ..., e[p-1]` to bounds `E(e)`, and `E` is affine and monotone. It is checked that
`E(e) <= e < TUBE` for `e = 2*E(0)`. Then functions bounded by `e` are mapped to functions bounded by `e`, and distances
in the norm weighted by `e` are at least halved. The unique fixed point is `h`. It is analytic in the parameter, and
real for real parameters. Repeated division of `z` by `m` moves along an orbit to the saddle, so these functions
describe the manifold.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from flint import acb, acb_mat, arb, ctx, fmpq

from verification.arithmetic.balls import FUNCTIONS, BallWords, working
from verification.arithmetic.iteration import Stop, iterated
from verification.arithmetic.series import Jet
from verification.cycles.chain import trace_and_determinant
from verification.proofs.manifolds.plane_map import PlaneMap
from verification.proofs.manifolds.saddle import (
    Saddle,
    SaddleCycle,
    direction,
    doubled,
    horner,
    matrix,
    neighbours,
    padded,
    slopes,
)
from verification.proofs.periodic.interval_newton import ZeroStatus, stepped

NEWTON = 12
Rows = list[list[Any]]


class TooWideError(ValueError):
    """Balls are too wide for a step of the proof; `item` is the hypothesis that is left unproved."""

    def __init__(self, item: str, message: str) -> None:
        super().__init__(message)
        self.item = item


def complex_balls(bits: int) -> BallWords[acb]:
    """The functions of the generated kernels for complex balls, analytic wherever they are finite."""

    @cache
    def rational(p: int, n: int) -> acb:  # cached: a kernel asks for the same few at every call
        with working(bits):
            return acb(arb(fmpq(p, n)))

    with working(bits):
        pi = acb.pi()
    cut = {"atan": lambda x: abs(x.imag) < 1, "sqrt": lambda x: x.real > 0, "log": lambda x: x.real > 0}
    words = {word: _analytic(word, cut.get(word)) for word in FUNCTIONS}
    return BallWords(pi=pi, q=rational, root=lambda x, n: (words["log"](x) / n).exp(), **words)


def _analytic(word: str, defined: Callable[[acb], bool] | None) -> Callable[[Any], acb]:
    """A function of complex balls that is NaN where it may not be analytic over the whole ball."""

    method = getattr(acb, word)

    def function(x: Any) -> acb:
        ball = x if type(x) is acb else acb(x)
        made: acb = method(ball) if defined is None or defined(ball) else acb("nan")
        return made

    return function


def around_zero(radius: arb) -> acb:
    """A complex ball (a square) that contains all numbers of absolute value at most `radius`."""
    half = arb(0, radius.abs_upper())
    return acb(half, half)


def size(x: Any) -> arb:
    """An upper bound of the absolute value of a ball."""
    return arb(abs(x).abs_upper())


def enclosed_saddle(orbit: SaddleCycle, map: PlaneMap, parameter: acb) -> Saddle:
    """Enclosure of the saddle near the start for all parameters in a ball; `TooWideError` unless it is proved."""
    found = enclosed_cycle(orbit, map, parameter)
    stable, unstable = multipliers_of(orbit, map, found, parameter)
    if not (abs(stable) < 1 and abs(unstable) > 1):
        raise TooWideError(
            "saddle", f"not proved that one multiplier of the {orbit.name} is inside the unit circle, one outside"
        )
    return Saddle(orbit, map, parameter, tuple(found), stable, unstable)


def enclosed_cycle(orbit: SaddleCycle, map: PlaneMap, parameter: acb) -> list[acb]:
    """Enclosure of the points of the unique cycle near the start, for all parameters in a ball; else `TooWideError`."""

    def rule(x: Sequence[acb]) -> tuple[list[acb], Rows]:
        ring = padded(orbit, map, x)
        values = [map.rule(ring[i : i + 3], parameter) for i in range(len(x))]
        return values, matrix(orbit, slopes(orbit, map, x, parameter))

    return only_zero(rule, [acb(x) for x in orbit.start])


def attracting(orbit: SaddleCycle, map: PlaneMap, parameter: acb) -> bool | None:
    """True if there is a unique cycle near the start, with multipliers inside the unit circle; None if not proved."""
    try:
        points = enclosed_cycle(orbit, map, parameter)
    except TooWideError:
        return None
    trace, determinant = trace_and_determinant(slopes(orbit, map, points, parameter), orbit.closure.turn)
    return True if abs(determinant) < 1 and abs(trace) < abs(1 + determinant) else None


def only_zero(rule: Callable[[Sequence[acb]], tuple[list[acb], Rows]], start: Sequence[acb]) -> list[acb]:
    """The zero near `start` that an interval Newton step proves unique in a box; else `TooWideError`."""

    def step(values: list[acb], rows: Rows) -> list[acb]:
        try:
            found = acb_mat(rows).solve(acb_mat([[v] for v in values]))
        except ZeroDivisionError as why:
            raise TooWideError("saddle", "the linearised rules may be singular") from why
        return [found[i, 0] for i in range(len(values))]

    middle = iterated(lambda x: step(*rule(x)), start, Stop(steps=NEWTON), kept=acb.mid).x
    values, rows = rule(middle)
    box = tried(middle, step(values, rows))
    found = stepped(middle, box, lambda: step(values, rule(box)[1]))
    if found.status is not ZeroStatus.UNIQUE:
        raise TooWideError("saddle", "an interval Newton step did not contract; the balls are too wide")
    return found.zero


def tried(middle: Sequence[acb], steps: Sequence[acb]) -> list[acb]:
    """A box around the points `middle` that may hold a zero: four times as wide as the Newton steps `steps`."""
    least = arb(2) ** (-ctx.prec + 8)
    return [x + around_zero(4 * size(step) + least) for x, step in zip(middle, steps, strict=True)]


def multipliers_of(orbit: SaddleCycle, map: PlaneMap, points: Sequence[acb], parameter: acb) -> tuple[acb, acb]:
    """The stable and the unstable multiplier of one round; `TooWideError` unless they are proved real."""
    trace, determinant = trace_and_determinant(slopes(orbit, map, points, parameter), orbit.closure.turn)
    root = (trace * trace - 4 * determinant).sqrt()
    if not root.real > 0:
        raise TooWideError("saddle", f"the multipliers of the {orbit.name} may be complex")
    larger = (trace + root) / 2 if trace.real > 0 else (trace - root) / 2
    return determinant / larger, larger


@dataclass(frozen=True)
class Enclosed:
    """The enclosed series of a local manifold to some order; `z = 1` is `unit` along the eigenvector.

    The eigenvector has 1 as its entry `chief`. `coefficients` has the coefficients of the series of each bounce.
    """

    saddle: Saddle
    unstable: bool
    factor: acb
    coefficients: tuple[tuple[acb, ...], ...]

    @property
    def order(self) -> int:
        """The highest power of `z`."""
        return len(self.coefficients[0]) - 1

    def over(self, i: int, radius: arb) -> acb:
        """An enclosure of the polynomial of bounce `i`, for any integer `i`, over the disc of the given radius."""
        closure, (rounds, place) = self.saddle.orbit.closure, divmod(i, len(self.coefficients))
        x, *rest = self.coefficients[place]
        reach = radius * size(self.factor**rounds)
        moved: acb = closure.carried(x, closure.angle(self.saddle.map.words), rounds)
        return moved + around_zero(horner([arb(0), *(size(c) for c in rest)], reach))

    def ring(self) -> list[Jet]:
        """The polynomials of the bounces of a round, and of one more bounce on either side, as jets."""
        powers = [self.factor**k for k in range(self.order + 1)]
        return neighbours(self.saddle, [list(c) for c in self.coefficients], powers)

    def pair(self) -> tuple[Jet, Jet]:
        """Polynomials of the bounces -1 and 0 if unstable, else 0 and 1, whose arguments stay in the disc."""
        ring = self.ring()
        return (ring[0], ring[1]) if self.unstable else (ring[1], ring[2])


def enclosed(saddle: Saddle, unstable: bool, order: int, unit: float, chief: int) -> Enclosed:
    """The series of a local manifold to `order`, with enclosed coefficients; the eigenvector's entry `chief` is 1."""
    factor = saddle.unstable if unstable else saddle.stable
    found = direction(saddle, slopes(saddle.orbit, saddle.map, saddle.points, saddle.parameter), factor)
    series = [[x, v / found[chief]] for x, v in zip(saddle.points, found, strict=True)]
    while len(series[0]) <= order:
        series = doubled(saddle, factor, series, min(2 * len(series[0]), order + 1))
    scaled = tuple(tuple(c * acb(unit) ** k for k, c in enumerate(row)) for row in series)
    return Enclosed(saddle, unstable, factor, scaled)


TUBE = "1e-6"  # the radius of the tube over which slopes are bounded; the remainder must stay below it


def remainder(made: Enclosed, outer: int) -> arb:
    """A bound of the remainders of all bounces on the unit disc, from the rule on radius `outer`, or `TooWideError`."""
    if not vanishing(made):
        raise TooWideError(
            "remainder", "the series do not satisfy the rule up to their order, so they belong to no manifold"
        )
    slopes = round_outwards(made, outer)
    least = bounds(made, slopes, [arb(0)] * len(slopes))
    allowed = [2 * e for e in least]
    found = bounds(made, slopes, allowed)
    if not all(e <= a and a < arb(TUBE) for e, a in zip(found, allowed, strict=True)):
        raise TooWideError("remainder", "the remainder of the series is not bounded")
    return max(allowed, key=lambda e: e.mid())


def vanishing(made: Enclosed) -> bool:
    """True if all enclosed coefficients of the rules along the series contain 0, up to the order of the series."""
    map, ring = made.saddle.map, made.ring()
    triples = [ring[i : i + 3] for i in range(len(ring) - 2)]
    rules = [map.rule_along(triple, made.saddle.parameter) for triple in triples]
    return all(c.contains(0) for rule in rules for c in rule.c)


Outwards = list[tuple[int, arb, arb, arb]]  # for each bounce: defect, slopes by the next and second next point inwards


def round_outwards(made: Enclosed, outer: int) -> Outwards:
    """For each bounce of a round, its index, and the defect of its rule and two slopes, each divided by `slope0`."""
    map, parameter, p = made.saddle.map, made.saddle.parameter, len(made.coefficients)
    inside = -1 if made.unstable else 1
    found: Outwards = []
    for i in range(p) if made.unstable else reversed(range(p)):
        three = [i + inside + k for k in (-1, 0, 1)]
        defect = size(map.rule([made.over(j, arb(outer)) for j in three], parameter))
        tube = [made.over(j, arb(1)) + around_zero(arb(TUBE)) for j in three]
        rows = map.slopes(tube, parameter)
        far, here, outermost = rows if made.unstable else rows[::-1]
        least = arb(acb(outermost).abs_lower())
        if not least > 0:
            raise TooWideError("remainder", "a slope of the rule may be 0")
        found.append((i, defect / least * arb(outer) ** -(made.order + 1), size(here) / least, size(far) / least))
    return found


def bounds(made: Enclosed, slopes: Outwards, errors: list[arb]) -> list[arb]:
    """The bounds `E(e)` of the module docstring: the result of one round outwards from the bounds `errors`."""
    p, inside = len(errors), -1 if made.unstable else 1
    shrink = size(1 / made.factor if made.unstable else made.factor) ** (made.order + 1)
    known: dict[int, arb] = {}

    def bound(j: int) -> arb:
        return known[j] if j in known else errors[j % p] * shrink ** abs(j // p)

    for i, defect, here, far in slopes:
        known[i] = size(defect + here * bound(i + inside) + far * bound(i + 2 * inside))
    return [known[i] for i in range(p)]
