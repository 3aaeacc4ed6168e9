"""A proof in balls that a saddle's manifolds touch, quadratically and with non-zero speed, within an interval.

The gap of `tangency` is a function `g(z, lam)`, here enclosed with its first two derivatives by `z` on
`Z x L`, `Z` and `L` intervals. Over all of it `g_zz` is not 0, and `g_z` has opposite signs at the ends of `Z`:
so for each `lam` in `L` there is one critical `z` in `Z`. Its value `e(lam)` has opposite signs at the ends
of `L`, so at some `lam` it is 0: the curves meet there with one tangent and different curvatures. The slope
`e' = g_lam` is kept from 0 by values on a complex disc around `L` (Cauchy): there is one such `lam`, and `e` passes 0.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from flint import acb, arb

from verification.arithmetic import bits_of, working
from verification.manifolds.enclosed import (
    Enclosed,
    TooWideError,
    around_zero,
    complex_balls,
    enclosed,
    enclosed_saddle,
    size,
)
from verification.manifolds.recurrence import Pinball, landing
from verification.manifolds.tangency import Contact
from verification.shooting.jets import Jet

UNIT = 0.01  # of the local series, along the eigenvectors
NEWTON = 12
DISC, STEP = "1e-24", "1e-40"  # radius of the complex disc of letters, and of the difference quotient in it
LEAST_DIGITS = 75  # along an orbit of ten bounces balls grow by 1e13, and twice that has to be small beside `STEP`
Checks = Mapping[str, bool | None]


@dataclass(frozen=True)
class Proof:
    """A tangency in `letter`, when every check is True."""

    letter: arb
    checks: Checks
    bend: arb = field(repr=False)
    speed: arb = field(repr=False)


class BallGap:
    """The gap between the manifolds of a saddle of one bounce, enclosed for every letter in a ball."""

    def __init__(self, contact: Contact, map: Pinball, letter: acb, order: int) -> None:
        if len(contact.unstable.start) != 1 or contact.unstable != contact.stable or contact.unstable.sign != 1:
            raise TooWideError(
                "the proof is for homoclinic tangencies of a saddle of one bounce that turns with the table"
            )
        self.map, self.letter = map, letter
        saddle = enclosed_saddle(contact.unstable, map, letter, contact.unstable.start[0])
        self.out, self.into = (enclosed(saddle, unstable, order, UNIT) for unstable in (True, False))
        unstable, stable = (float(m.real.mid()) for m in (saddle.unstable, saddle.stable))
        self.start, self.end, self.bounces = contact.z / UNIT, contact.end / UNIT, contact.bounces
        while abs(self.start * unstable) > 0.4:
            self.start, self.bounces = self.start / unstable, self.bounces + 1
        while abs(self.end) > 0.4:
            self.end, self.bounces = self.end * stable, self.bounces + 1

    def at(self, z: acb) -> Jet:
        """The gap and its first two Taylor coefficients by `z`, for every `z` in a ball."""
        before, here = self.out.points(Jet(z, acb(1), acb(0)))
        for _ in range(self.bounces):
            before, here = here, self.following(before, here)
        unit = 2 * self.map.words["pi"] / self.map.turn
        first, second = self.into.points(Jet(acb(self.end), acb(0), acb(0)))
        before = before - round(float(((before.c[0] - first.c[0]) / unit).real.mid())) * unit
        here = here - round(float(((here.c[0] - second.c[0]) / unit).real.mid())) * unit
        apart: Jet = here - self.into.points(self.where(before))[1]
        return apart

    def following(self, before: Jet, here: Jet) -> Jet:
        """Where the ball lands: an interval Newton step for the value, and the derivatives from the equation."""
        map = self.map.lifted
        phi = -self.letter * map.angle(here, before)[0]
        middle = acb(landing(map.table, _float(here.c[0]), _float(phi.c[0]), 0))
        angle = self.map.angle

        def residual(x: acb) -> acb:
            return acb(angle(here.c[0], x)[0] - phi.c[0])

        for _ in range(NEWTON):
            middle = (middle - residual(middle) / angle(here.c[0], middle)[2]).mid()
        value = contracted(middle, residual(middle), lambda x: angle(here.c[0], x)[2])

        def equation(x: Jet) -> tuple[Jet, Any]:
            found = map.angle(here, x)
            return found[0] - phi, found[2]

        return carried(value, equation)

    def where(self, here: Jet) -> Jet:
        """The parameter on the stable manifold whose first point is `here`."""
        into = self.into

        def parts(z: acb) -> tuple[acb, acb]:
            found = into.at(Jet(z, acb(1), acb(0)))
            return found.c[0] - here.c[0], found.c[1]

        middle = acb(self.end)
        for _ in range(NEWTON):
            value, slope = parts(middle)
            middle = (middle - value / slope).mid()
        value = contracted(middle, parts(middle)[0], lambda z: parts(z)[1])
        return carried(value, lambda z: (into.at(z) - here, _slope(into, z)))


def contracted(middle: acb, residual: acb, slope: Any) -> acb:
    """The zero that an interval Newton step proves to be there, and alone, near `middle`."""
    box = middle + around_zero(2 * size(residual / slope(middle)) + arb(2) ** -400)
    found = middle - residual / slope(box)
    if not box.contains(found):
        raise TooWideError("an interval Newton step did not contract; the balls are too wide")
    return acb(found)


def carried(value: acb, equation: Any) -> Jet:
    """The jet with this value that solves an equation: each step makes one more coefficient right."""
    x = Jet(value, acb(0), acb(0))
    for _ in range(2):
        residual, slope = equation(x)
        step = Jet(acb(0), *residual.c[1:]) / slope  # the residual's value is 0 on the solution
        x = Jet(value, x.c[1] - step.c[1], x.c[2] - step.c[2])
    return x


def _slope(local: Enclosed, z: Jet) -> Any:
    """The derivative of the manifold at the middle of a jet, which is what a Newton step on its coefficients needs."""
    return local.at(Jet(z.c[0], acb(1), acb(0))).c[1]


def _float(x: acb) -> float:
    return float(x.real.mid())


def tangency_proved(contact: Contact, map: Pinball, value: str, digits: int = LEAST_DIGITS) -> Proof:
    """The proof that the manifolds touch at a letter within `10**-digits` of `value`, which has as many digits."""
    bits, order = bits_of(2 * digits, 200), digits + 15
    with working(bits):
        balls = map.over(complex_balls(bits))
        letter, width = arb(value).mid(), arb(10) ** -digits

        def gap(at: acb) -> BallGap:
            return BallGap(contact, balls, at, order)

        point, whole = gap(acb(letter)), gap(acb(arb(letter, width.upper())))
        z = acb(point.start)
        for _ in range(NEWTON):
            found = point.at(z)
            z = (z - found.c[1] / (2 * found.c[2])).mid()
        spread, bend = whole.at(z).c[1], point.at(z).c[2]
        reach = (2 * size(spread) / arb(abs(bend).abs_lower())).mid()
        box = acb(arb(z.real.mid(), reach))
        over = whole.at(box).c[2].real
        ends = [whole.at((z + s * reach).mid()).c[1].real for s in (-1, 1)]
        values = []
        for s in (-1, 1):
            side = gap((letter + s * width).mid() * acb(1))
            values.append((side.at(z).c[0] + side.at(box).c[1] * (box - z)).real)
        speed = _speed(gap, letter, box)
        checks = {
            "quadratic": True if over > 0 or over < 0 else None,
            "one_critical_point": _opposite(*ends),
            "gap_changes_sign": _opposite(*values),
            "transversal": True if speed > 0 or speed < 0 else None,
        }
        return Proof(arb(letter, width.upper()), checks, 2 * over, speed)


def _opposite(a: arb, b: arb) -> bool | None:
    return True if (a > 0 and b < 0) or (a < 0 and b > 0) else None


def _speed(gap: Callable[[acb], BallGap], letter: arb, box: acb) -> arb:
    """The derivative of the gap by the letter, near `letter` and over a box of parameters.

    A difference quotient, and what Cauchy's bound of the second derivative on a disc allows around it.
    """
    step, radius = arb(STEP), arb(DISC)
    disc = gap(acb(letter) + around_zero(radius)).at(box).c[0]
    low, high = (gap(acb((letter + s * step).mid())).at(box).c[0] for s in (-1, 1))
    second = 2 * size(disc - disc.mid()) / (radius - step) ** 2
    return arb((high - low).real / (2 * step) + arb(0, (second * 2 * step).abs_upper()))
