"""Tangencies of an unstable and a stable manifold in mpmath, and enclosures of bounces on local manifolds in balls.

*Balls.* Two neighbouring bounces on a local manifold are enclosed as functions of its parameter `z` and of the
contraction. Their polynomials are enclosed at one contraction, at a second contraction beside it, and over a complex
disc of contractions. The derivative by the contraction is the difference quotient, with an error from Cauchy's bound of
the second derivative on the disc. The remainder is bounded over the disc of contractions and the unit disc of `z`, so
Cauchy's bounds give its derivatives for `abs(z) <= 1/2`.

*mpmath.* An orbit from `z` on the local unstable manifold is followed for some bounces, into the neighbourhood where
the local stable manifold is a graph `following = S(here)`. The gap `following - S(here)` is a function of `z`,
evaluated on jets. At a fixed contraction Newton's method finds its extremum; the secant method finds the contraction
where the extremum is 0. The contact is quadratic where the second derivative is not 0, and unfolds transversally where
the derivative of the extremum by the contraction is not 0.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import mpmath
from flint import acb, arb

from verification.arithmetic.balls import FLOAT64, bits_of, multiprecision
from verification.arithmetic.iteration import Stop, Vector, iterated
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
from verification.proofs.manifolds.plane_map import PlaneMap, floating
from verification.proofs.manifolds.saddle import Local, Saddle, SaddleCycle, horner, local, saddle

REACH = 0.04  # the largest displacement of a bounce over the outer disc: short beside a chord
SMALLER = 3  # how often the unit is reduced at most
ROUGH = 28  # the order of the float64 series that sets the scale
Polynomials = list[list[arb]]


@dataclass(frozen=True)
class Precision:
    """The precision of a proof that a parameter lies within `10**-digits`."""

    digits: int

    @property
    def bits(self) -> int:
        """The precision of the balls: twice the digits, since a difference quotient loses half of them."""
        return bits_of(2 * self.digits, 150)

    @property
    def outer(self) -> int:
        """The radius of the disc on which the rule is bounded, chosen so that each order gains three digits or more."""
        return int(10 ** (3 + self.digits // 100))

    @property
    def order(self) -> int:
        """The order of the series, chosen so that `outer**-order` is small beside the box even after a long flight."""
        return math.ceil((self.digits + 20) / math.log10(self.outer))

    @property
    def step(self) -> arb:
        """The half width of the box of parameters."""
        return (arb(10) ** -self.digits).mid()

    @property
    def disc(self) -> arb:
        """The radius of the complex disc of parameters for Cauchy's bounds."""
        return (arb(10) ** -math.ceil(0.6 * self.digits)).mid()


@dataclass(frozen=True)
class Near:
    """A bounce near a saddle: its `place`, two derivatives by `z`, one by the parameter, and the mixed second one."""

    place: arb
    first: arb
    second: arb
    by_parameter: arb
    mixed: arb


@dataclass(frozen=True)
class Scale:
    """The scale of a local manifold: `unit` is the length of `z = 1` along the eigenvector whose entry `chief` is 1.

    `rough` is the series in float64; the polynomials have `more` orders than the precision requires.
    """

    unstable: bool
    unit: float
    chief: int
    rough: Local
    more: int = 0


@dataclass(frozen=True)
class Coefficients:
    """Two neighbouring bounces on a local manifold, as enclosed polynomials in `z`.

    The two are bounces -1 and 0 of the unstable manifold, or 0 and 1 of the stable one. `places` are the coefficients
    at the parameter itself, `slopes` their derivatives by it, valid up to two steps away. `error` bounds the remainder
    for all parameters up to `margin` farther; `saddle` is enclosed for the same parameters. `tube` encloses the bounces
    of a round and their neighbours for `abs(z) <= 1/2`.
    """

    saddle: Saddle
    scale: Scale
    places: Polynomials
    slopes: Polynomials
    error: arb
    margin: arb
    tube: list[arb]

    def at(self, i: int, z: arb, away: arb) -> Near:
        """Enclosure of bounce `i` (0 or 1) at `z`, for parameters that differ by `away` from that of `places`."""
        if not abs(z) < 0.5:
            raise TooWideError("exists", "the coordinate on the manifold leaves the disc of radius 1/2")
        slopes, e = self.slopes[i], self.error
        places = [c + s * away for c, s in zip(self.places[i], slopes, strict=True)]
        there: Jet = horner(places, Jet(z, arb(1), arb(0)))
        moving: Jet = horner(slopes, Jet(z, arb(1)))
        return Near(
            _within(there.c[0], e),
            _within(there.c[1], 2 * e),
            _within(2 * there.c[2], 8 * e),
            _within(moving.c[0], e / self.margin),
            _within(moving.c[1], 2 * e / self.margin),
        )


def _within(x: arb, bound: arb) -> arb:
    """The ball of all numbers at most `bound` from `x`."""
    return x + arb(0, bound.abs_upper())


def scale(orbit: SaddleCycle, map: PlaneMap, parameter: float, unstable: bool, outer: int) -> Scale:
    """The scale at which the disc of radius `outer` moves bounces by `REACH`, from the series in float64."""
    made = local(saddle(orbit, map.over(FLOAT64), parameter), unstable, ROUGH)
    first = [abs(c[1]) for c in made.coefficients]
    return Scale(unstable, _reach(made) / outer, first.index(max(first)), made)


def _reach(made: Local) -> float:
    """The least length along the eigenvector at which the moduli of the terms of a bounce add up to `REACH`."""
    low, high = 0.0, 1.0
    while high - low > 1e-3 * high:
        middle = (low + high) / 2
        sums = (sum(abs(x) * (middle / made.unit) ** k for k, x in enumerate(c) if k) for c in made.coefficients)
        low, high = (middle, high) if max(sums) < REACH else (low, middle)
    return low


def smaller(orbit: SaddleCycle, map: PlaneMap, parameter: arb, scale: Scale, precision: Precision) -> Coefficients:
    """Two bounces on a local manifold, with the largest unit up to that of `scale` for which the remainder is bounded.

    Smaller units come with more orders. Along long cycles the radii of coefficients grow by up to 100 per order in the
    largest unit. Where a multiplier is near 1, only many orders outweigh the product of the slopes along a round.
    """
    for k in range(SMALLER):
        try:
            return pair(orbit, map, parameter, shrunk(scale, k), precision)
        except TooWideError as why:
            if why.item != "remainder":
                raise
    return pair(orbit, map, parameter, shrunk(scale, SMALLER), precision)


def shrunk(scale: Scale, times: int) -> Scale:
    """The scale after `times` steps, each of which divides the unit by ten and adds ten orders."""
    return replace(scale, unit=scale.unit / 10**times, more=10 * times)


def one_cycle(around: Saddle, here: Saddle) -> bool:
    """True if the cycle at one parameter is the unique cycle over a ball of parameters, as its balls lie within."""
    return all(ball.contains(x) for ball, x in zip(around.points, here.points, strict=True))


def multipliers_at(parameter: arb, around: Saddle, map: PlaneMap, precision: Precision) -> tuple[arb, arb]:
    """The stable and unstable multiplier at one parameter, enclosed more closely than over the whole disc."""
    at = enclosed_saddle(around.orbit, map.over(complex_balls(precision.bits)), acb(parameter))
    found = at if one_cycle(around, at) else around
    return found.stable.real, found.unstable.real


def pair(orbit: SaddleCycle, map: PlaneMap, parameter: arb, scale: Scale, precision: Precision) -> Coefficients:
    """Two bounces on a local manifold near an exact parameter; saddle and remainder are proved over a disc."""
    balls = map.over(complex_balls(precision.bits))
    step, disc = precision.step, precision.disc
    if not disc > 2 * step:
        raise TooWideError(
            "saddle", f"with {precision.digits} digits the disc of parameters is smaller than the steps in it"
        )
    beyond = (parameter + step).mid()

    def near(at: acb) -> Enclosed:
        order = precision.order + scale.more
        return enclosed(enclosed_saddle(orbit, balls, at), scale.unstable, order, scale.unit, scale.chief)

    def slope(here: acb, beside: acb, around: acb) -> arb:
        second = 2 * size(around - here) / (disc - 2 * step) ** 2
        return _within(((beside - here) / (beyond - parameter)).real, 4 * step * second)

    around = near(acb(parameter) + around_zero(disc))
    error = remainder(around, precision.outer)
    here, beside = near(acb(parameter)), near(acb(beyond))
    if not all(one_cycle(around.saddle, made.saddle) for made in (here, beside)):
        raise TooWideError("saddle", "the cycle at a parameter may be another than the one over the disc of parameters")
    bounces = list(zip(*(made.pair() for made in (here, beside, around)), strict=True))
    places = [[c.real for c in first.c] for first, _, _ in bounces]
    slopes = [[slope(*three) for three in zip(*(jet.c for jet in jets), strict=True)] for jets in bounces]
    tube = [_within(around.over(i, arb(0.5)).real, error) for i in range(-1, len(orbit.start) + 1)]
    return Coefficients(around.saddle, scale, places, slopes, error, disc - 2 * step, tube)


STEPS = 30
NOISE = 1e4  # times the goal: below this distance secants and steps are rounding noise


@dataclass(frozen=True)
class Contact:
    """A contact of two manifolds: the saddles, and starting values for `z`, for `end` on the stable manifold, and the
    parameter.

    `z` and `end` are displacements along the eigenvectors. After `bounces` bounces a symmetry of the table carries the
    point near the saddle of the stable manifold, with which it is compared; a reflection if `sign = -1`.
    """

    unstable: SaddleCycle
    stable: SaddleCycle
    bounces: int
    sign: int
    z: float
    end: float
    parameter: float

    @property
    def kind(self) -> str:
        """`homoclinic` or `heteroclinic`, modulo the table's symmetry."""
        return "homoclinic" if self.unstable == self.stable else "heteroclinic"

    def mirrored(self, early: int, late: int) -> int:
        """The sign after `early` more rounds at the start and `late` more at the end; each round may reflect."""
        turns: int = self.unstable.closure.turn**early * self.stable.closure.turn**late
        return self.sign * turns


@dataclass(frozen=True)
class Touch:
    """A tangency: the parameter with an error estimate, the derivatives that make it generic, and the multipliers."""

    contact: Contact
    parameter: Any
    error: float
    bend: float  # second derivative of the gap, in units of the local manifolds
    speed: float  # derivative of the smallest gap by the parameter
    multipliers: tuple[float, float, float, float]  # stable, unstable: of the saddle left, then of the saddle reached
    residual: float


class Gap:
    """The gap between orbits that start on the unstable manifold and the stable manifold, at one parameter."""

    def __init__(self, contact: Contact, map: PlaneMap, parameter: Any, order: int, tail: float) -> None:
        self.old, self.map, self.parameter = contact, map, parameter
        self.out = local(saddle(contact.unstable, map, parameter), True, order, tail)
        self.into = local(saddle(contact.stable, map, parameter), False, order, tail)
        early = rounds(contact.z / self.out.unit, float(self.out.factor))
        late = rounds(contact.end / self.into.unit, 1 / float(self.into.factor))
        self.bounces = contact.bounces + early * len(contact.unstable.start) + late * len(contact.stable.start)
        self.sign = contact.mirrored(early, late)
        self.scales = self.out.unit * float(self.out.factor) ** early, self.into.unit / float(self.into.factor) ** late
        self.start, self.end = contact.z / self.scales[0], contact.end / self.scales[1]

    def at(self, z: Any) -> tuple[Jet, Jet]:
        """The gap at `z` to second order, and the parameter on the stable manifold."""
        *_, here, following = self.orbit(z)
        here, following = turned(self.into, self.sign * here, self.sign * following)
        end = self.where(here)
        apart: Jet = following - self.into.points(end)[1]
        return apart, end

    def orbit(self, z: Any) -> list[Jet]:
        """The bounces from `z` on, with two derivatives by `z`."""
        map = self.map.lifted
        found = list(self.out.points(Jet(z, z * 0 + 1, z * 0)))
        for _ in range(self.bounces):
            found.append(map.following(found[-2], found[-1], self.parameter))
        return found

    def where(self, here: Jet) -> Jet:
        """The parameter of the point on the stable manifold whose first coordinate is `here`."""
        c = self.into.coefficients[0]
        slope = [k * x for k, x in enumerate(c)][1:]
        relative = 1.0

        def correction(unknown: Vector) -> Vector:
            nonlocal relative
            (z,) = unknown
            step = (horner(c, z) - here) / horner(slope, z)
            relative = max(abs(float(x)) / (1 + abs(float(y))) for x, y in zip(step.c, z.c, strict=True))
            return [step]

        start = Jet(*(here.c[0] * 0 + x for x in (self.end, 0, 0)))
        found = iterated(correction, [start], Stop(small=1e-6, steps=STEPS), lambda step: relative)
        if not found.settled:
            missed = "the orbit misses the neighbourhood of the stable manifold"
            raise ValueError(f"tangency: at {float(self.parameter)} {missed}")
        end: Jet = found.x[0]
        return end

    def extremum(self) -> tuple[Any, Jet, Jet]:
        """The `z` at which the gap is extremal, the gap there, and the parameter on the stable manifold."""

        def correction(z: Vector) -> Vector:
            gap, _ = self.at(*z)
            return [gap.c[1] / (2 * gap.c[2])]

        found = iterated(correction, [self.parameter * 0 + self.start], Stop(small=1e-5, steps=STEPS))
        if not found.settled:
            raise ValueError(f"tangency: at {float(self.parameter)} the gap has no minimum near the start")
        return (*found.x, *self.at(*found.x))

    def contact(self) -> Contact:
        """The contact of this gap, with the starting values found by the search for the extremum."""
        z, _, end = self.extremum()
        unstable, stable = (
            replace(made.saddle.orbit, start=tuple(float(x) for x in made.saddle.points))
            for made in (self.out, self.into)
        )
        place = float(z) * self.scales[0], float(end.c[0]) * self.scales[1]
        return Contact(unstable, stable, self.old.bounces, self.old.sign, *place, float(self.parameter))


def rounds(z: float, factor: float) -> int:
    """How many times `z` must be divided by `factor` until `abs(z) <= 1`."""
    return max(0, math.ceil(math.log(abs(z)) / math.log(abs(factor))))


def turned(into: Local, here: Any, following: Any) -> tuple[Any, Any]:
    """Two successive points, rotated by a symmetry of the table to lie as near to the saddle as possible."""
    map, ring = into.saddle.map, into.saddle.around()
    if not map.turn:
        return here, following
    unit = 2 * map.words.pi * map.words.q(1, map.turn)
    k = round((float(floating(here)) - float(ring[1])) / float(unit))
    here, following = here - k * unit, following - k * unit
    whole = round((float(floating(following)) - float(ring[2])) / (2 * math.pi))
    return here, following - 2 * map.words.pi * whole


def tangency(contact: Contact, map: PlaneMap, digits: int = 12) -> Touch:
    """The tangency that Newton's method and the secant method find from a contact, to about `digits` digits.

    The error estimate is the last secant step plus the tolerance of the iteration.
    """
    rough = secant(contact, map.over(FLOAT64), 28, 1e-16, (contact.parameter, contact.parameter + 1e-7), 1e-14)
    if digits <= 11:
        return rough
    context = mpmath.MPContext()
    context.dps = digits + 15
    exact, near = map.over(multiprecision(context)), context.mpf(rough.parameter)
    start = replace(contact, parameter=float(rough.parameter))
    order = 12 + digits
    found = secant(
        start, exact, order, 10.0 ** -(digits + 12), (near, near + context.mpf(10) ** -12), 10.0 ** -(digits + 2)
    )
    return found


def secant(contact: Contact, map: PlaneMap, order: int, tail: float, parameters: tuple[Any, Any], goal: float) -> Touch:
    """The tangency by the secant method, which varies the parameter until the extremum of the gap is 0."""
    a, b = parameters
    last = a, Gap(contact, map, a, order, tail).extremum()[1]
    steps: list[Touch] = []

    def correction(parameter: Vector) -> Vector:
        nonlocal last
        (b,), (a, before) = parameter, last
        gap = Gap(contact, map, b, order, tail)
        _, found, _ = gap.extremum()
        slope = (found.c[0] - before.c[0]) / (b - a)
        step, last = found.c[0] / slope, (b, found)
        speed = slope if not steps or abs(b - a) > NOISE * goal else steps[-1].speed
        out, into = gap.out.saddle, gap.into.saddle
        near = float(out.stable), float(out.unstable), float(into.stable), float(into.unstable)
        residual = max(gap.out.residual, gap.into.residual)
        error, bend = float(abs(step)) + goal, float(2 * found.c[2])
        steps.append(Touch(contact, b - step, error, bend, float(speed), near, residual))
        return [step]

    # after many bounces rounding noise dominates the gap
    found = iterated(correction, [b + 0 * a], Stop(small=NOISE * goal, enough=goal, steps=STEPS))
    if not found.settled:
        raise ValueError(f"tangency: secants from {contact.parameter} did not settle; the last was {float(found.x[0])}")
    return steps[len(found.sizes) - 1]  # the last step above the noise
