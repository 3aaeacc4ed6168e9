"""Two neighbouring bounces on a local manifold, as functions of the parameter and the letter, in real balls.

The polynomials are enclosed at one letter, at another a `step` away, and over a complex disc of letters. The
derivative by the letter is the difference quotient of the first two, give or take what Cauchy's bound of the
second derivative on the disc allows. The remainder is bounded over that disc, and over the unit disc of parameters;
so its derivatives are bounded by Cauchy as well, on parameters up to 1/2.
"""

import math
from dataclasses import dataclass, replace

from flint import acb, arb

from verification.arithmetic.balls import FLOAT64, bits_of
from verification.arithmetic.series import Jet
from verification.proofs.manifolds.enclosed import (
    Enclosed,
    TooWideError,
    around_zero,
    complex_balls,
    enclosed,
    enclosed_saddle,
    remainder,
    size,
)
from verification.proofs.manifolds.plane_map import PlaneMap
from verification.proofs.manifolds.saddle import Local, Orbit, Saddle, horner, local, saddle

REACH = 0.04  # how far the outer disc moves a bounce at most: little beside a chord, so that the rule stays finite
SMALLER = 3  # units that are tried before the last one
ROUGH = 28  # order of the series in float64 that sets the scale
Polynomials = list[list[arb]]


@dataclass(frozen=True)
class Precision:
    """What a proof of a letter within `10**-digits` computes with."""

    digits: int

    @property
    def bits(self) -> int:
        """Of the balls: twice the digits, since a difference quotient loses half of them."""
        return bits_of(2 * self.digits, 150)

    @property
    def outer(self) -> int:
        """The radius of the disc on which the rule is bounded, so that each order is worth three digits or more."""
        return int(10 ** (3 + self.digits // 100))

    @property
    def order(self) -> int:
        """Of the series, so that `outer**-order` is small beside the box even after a long flight."""
        return math.ceil((self.digits + 20) / math.log10(self.outer))

    @property
    def step(self) -> arb:
        """How far letters are from the middle of their box, at most."""
        return (arb(10) ** -self.digits).mid()

    @property
    def disc(self) -> arb:
        """The radius of the complex disc of letters on which Cauchy's bounds rest."""
        return (arb(10) ** -math.ceil(0.6 * self.digits)).mid()


@dataclass(frozen=True)
class Near:
    """A bounce: its place, its derivatives by `z`, by the letter, and by both."""

    place: arb
    first: arb
    second: arb
    by_letter: arb
    mixed: arb


@dataclass(frozen=True)
class Scale:
    """`unit` is the length of `z = 1` along the eigenvector whose entry `chief` is 1; `rough` the series in float64.

    The polynomials have so many orders `more` than the precision asks for.
    """

    unstable: bool
    unit: float
    chief: int
    rough: Local
    more: int = 0


@dataclass(frozen=True)
class Pair:
    """Coefficients of the two: `places` at the letter itself, `slopes` by it up to two steps away.

    The bounces are -1 and 0 of the unstable manifold, 0 and 1 of the stable one. `error` bounds the
    remainder for all letters at most `margin` from those; `saddle` is enclosed for the same letters.
    """

    saddle: Saddle
    scale: Scale
    places: Polynomials
    slopes: Polynomials
    error: arb
    margin: arb

    def at(self, i: int, z: arb, away: arb) -> Near:
        """Bounce `i` of the two over a ball of parameters, for letters `away` from the one of the places."""
        if not abs(z) < 0.5:
            raise TooWideError("exists", "the parameter leaves the disc of radius 1/2")
        slopes, e = self.slopes[i], self.error
        places = [c + s * away for c, s in zip(self.places[i], slopes, strict=True)]
        there: Jet = horner(places, Jet(z, arb(1), arb(0)))
        moving: Jet = horner(slopes, Jet(z, arb(1)))
        return Near(
            there.c[0] + _around(e),
            there.c[1] + _around(2 * e),
            2 * there.c[2] + _around(8 * e),
            moving.c[0] + _around(e / self.margin),
            moving.c[1] + _around(2 * e / self.margin),
        )


def _around(bound: arb) -> arb:
    return arb(0, bound.abs_upper())


def scale(orbit: Orbit, map: PlaneMap, letter: float, unstable: bool, outer: int) -> Scale:
    """The unit with which the disc of radius `outer` moves bounces by `REACH`, from the series in float64."""
    made = local(saddle(orbit, map.over(FLOAT64), letter), unstable, ROUGH)
    first = [abs(c[1]) for c in made.coefficients]
    return Scale(unstable, _reach(made) / outer, first.index(max(first)), made)


def _reach(made: Local) -> float:
    """How far along the eigenvector the absolute terms of a bounce sum up to `REACH`, where they do first."""
    low, high = 0.0, 1.0
    while high - low > 1e-3 * high:
        middle = (low + high) / 2
        sums = (sum(abs(x) * (middle / made.unit) ** k for k, x in enumerate(c) if k) for c in made.coefficients)
        low, high = (middle, high) if max(sums) < REACH else (low, middle)
    return low


def smaller(orbit: Orbit, map: PlaneMap, letter: arb, scale: Scale, precision: Precision) -> Pair:
    """The pair with the largest of a few units for which the remainder is bounded, each with more orders.

    Along long cycles the coefficients' balls grow with the order, in the largest unit by up to 100 for each; and
    the slopes along a round multiply to a number that only many orders outweigh where the multiplier is near 1.
    """
    for k in range(SMALLER):
        try:
            return pair(orbit, map, letter, shrunk(scale, k), precision)
        except TooWideError as why:
            if why.item != "remainder":
                raise
    return pair(orbit, map, letter, shrunk(scale, SMALLER), precision)


def shrunk(scale: Scale, times: int) -> Scale:
    """A tenth of the unit and ten orders more, so many times."""
    return replace(scale, unit=scale.unit / 10**times, more=10 * times)


def one_cycle(around: Saddle, here: Saddle) -> bool:
    """Is the cycle at one letter the one that is unique over a ball of letters? It is where its balls lie in those."""
    return all(ball.contains(x) for ball, x in zip(around.points, here.points, strict=True))


def pair(orbit: Orbit, map: PlaneMap, letter: arb, scale: Scale, precision: Precision) -> Pair:
    """The pair near an exact letter, with the saddle and the remainder proved for every letter of the disc."""
    balls = map.over(complex_balls(precision.bits))
    step, disc = precision.step, precision.disc
    beyond = (letter + step).mid()

    def near(at: acb) -> Enclosed:
        order = precision.order + scale.more
        return enclosed(enclosed_saddle(orbit, balls, at), scale.unstable, order, scale.unit, scale.chief)

    def slope(here: acb, beside: acb, around: acb) -> arb:
        second = 2 * size(around - here) / (disc - 2 * step) ** 2
        return ((beside - here) / (beyond - letter)).real + _around(4 * step * second)

    around = near(acb(letter) + around_zero(disc))
    error = remainder(around, precision.outer)
    here, beside = near(acb(letter)), near(acb(beyond))
    if not all(one_cycle(around.saddle, made.saddle) for made in (here, beside)):
        raise TooWideError("saddle", "the cycle at a letter may be another than the one over the disc of letters")
    bounces = list(zip(*(made.pair() for made in (here, beside, around)), strict=True))
    places = [[c.real for c in first.c] for first, _, _ in bounces]
    slopes = [[slope(*three) for three in zip(*(jet.c for jet in jets), strict=True)] for jets in bounces]
    return Pair(around.saddle, scale, places, slopes, error, disc - 2 * step)
