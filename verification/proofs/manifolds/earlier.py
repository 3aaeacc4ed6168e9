"""A numerical search for earlier contacts of the same manifolds, in all flights of up to a given number of bounces.

A homoclinic contact is the first in a range of parameters only if no other flight from the unstable manifold to the
stable one touches it at a smaller parameter. The function `earlier` follows a fundamental domain of the unstable
branch, at the contact's parameter, bounce by bounce, and inserts points where neighbours separate. After each bounce,
for each rotation and reflection of the table, the gap to the local stable manifold is a function on the unstable one.
All its local extrema are found, with their derivatives in the parameter. If linear extrapolation in the parameter makes
an extremum 0 within the range, the secant method of `tangency` is started there, for the smallest such parameters
first.

It is a search in float64. It may miss folds smaller than the spacing of points, flights with more bounces, and gaps
larger than `NEAR`, and it does not distinguish contacts closer than `RESOLUTION`. So it finds earlier contacts, but
does not prove that there is none.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from numeric.backends import elementary
from verification.arithmetic.balls import ARRAYS, FLOAT64
from verification.cycles.recurrence import Array
from verification.proofs.manifolds.grow import INSIDE, gaps, turning
from verification.proofs.manifolds.plane_map import PlaneMap
from verification.proofs.manifolds.saddle import local, saddle
from verification.proofs.manifolds.tangency import Contact, Touch, tangency

START = 400  # points of the fundamental domain before any is added
SPACING = 0.05  # the initial distance of neighbours, in the plane of the map
CLOSER, LEAST_SPACING = 3, 1e-4
POINTS = 300_000  # with more points no further bounce is followed
LATE = 0.5  # extrema nearer to the saddle, relative to the local stable manifold, occur a round earlier
NEAR = 0.5  # the largest gap that is searched for extrema
FAR = 10.0  # a point with a larger coordinate has left
DIVIDED, SHARES = 6, 9  # subdivisions of an interval that holds an extremum, and points in each
STEP = 1e-9  # the step in the parameter for the derivative of an extremum
TRIED = 4  # the most extrema, those with the smallest extrapolated parameters, whose contact is computed
ALIKE = 1e-11  # the distance up to which extrema count as one, that with the fewest bounces
RESOLUTION = 1e-12  # in the parameter, for contacts in float64


@dataclass(frozen=True)
class Extrema:
    """Local extrema of the gap after a number of bounces: intervals of `z` that hold them, and a mask of the minima.

    `end` has the parameters of the extrema on the stable manifold.
    """

    bounces: int
    sign: int
    low: Array
    high: Array
    minimum: NDArray[np.bool_]
    end: Array


@dataclass(frozen=True)
class Earlier:
    """The result of a search: earlier contacts in the range, in order of their parameters, with error estimates.

    Flights of up to `bounces` bounces were followed, and their gaps have `extrema` extrema. For `lost` of the extrema
    that seem to vanish in the range, no contact could be computed.
    """

    contact: Contact
    low: float
    bounces: int
    spacing: float
    extrema: int
    contacts: tuple[Touch, ...]
    lost: int

    @property
    def first(self) -> Touch | None:
        """The contact with the smallest parameter; None if none was found."""
        return self.contacts[0] if self.contacts else None

    def __str__(self) -> str:
        looked = f"among {self.extrema} extrema of the gap, in flights of up to {self.bounces} bounces"
        if self.first:
            return f"not the first: an earlier contact at {float(self.first.parameter):.12f}, found {looked}"
        rest = f", at {self.lost} places not decided" if self.lost else ""
        return f"not shown; none earlier found down to {self.low:.10g} {looked}, points {self.spacing:.2g} apart{rest}"


def earlier(contact: Contact, map: PlaneMap, low: float, bounces: int) -> Earlier:
    """A search for contacts of the same manifolds at parameters from `low` up to that of a homoclinic contact.

    Flights have at most `bounces` bounces, or fewer if so many would need too many points. The spacing is refined until
    the contact itself is among the extrema found, and then once more by `CLOSER`. `ValueError` if it is never among
    them.

    >>> from sympy import Rational
    >>> from verification.proofs.manifolds.plane_map import Henon
    >>> from verification.proofs.manifolds.saddle import SaddleCycle
    >>> inner = SaddleCycle("inner fixed point", (0.63,))
    >>> contact = Contact(inner, inner, 6, 1, 0.3302553, -0.2905975, 1.3923134354)
    >>> earlier(contact, Henon(Rational(3, 10)), 1.39, 8).first is None
    True
    """
    if contact.kind != "homoclinic":
        raise ValueError("earlier: the contact is heteroclinic; accepted: contacts of the two manifolds of one saddle")
    contact = replace(contact, parameter=float(tangency(contact, map, 8).parameter))
    if not low < contact.parameter - STEP:
        raise ValueError(f"earlier: low = {low} is not below the contact's parameter {contact.parameter}")
    here, before = (BranchImages(contact, map, contact.parameter - away) for away in (0.0, STEP))
    spacing = SPACING

    def near(guess: Contact) -> bool:
        return abs(guess.parameter - contact.parameter) < ALIKE

    while not any(near(guess) for guess in _seen(contact, here, before, bounces, spacing)[2]):
        spacing /= CLOSER
        if spacing < LEAST_SPACING:
            raise ValueError(f"earlier: no flight of up to {bounces} bounces leads to the contact; give more bounces")
    spacing /= CLOSER
    reached, extrema, guesses = _seen(contact, here, before, bounces, spacing)
    touches, tried, lost = list[Touch](), set[int](), 0
    for guess in sorted(guesses, key=lambda guess: (round(guess.parameter / ALIKE), guess.bounces)):
        alike = round(guess.parameter / ALIKE)
        if not low < guess.parameter < contact.parameter - ALIKE or alike in tried:
            continue
        tried.add(alike)
        try:
            touch = tangency(guess, map, 8) if len(tried) <= TRIED else None
        except (ValueError, ArithmeticError):
            touch = None
        lost += touch is None
        known = touch and any(abs(touch.parameter - other.parameter) < RESOLUTION for other in touches)
        if touch and not known and low < touch.parameter < contact.parameter - RESOLUTION:
            touches.append(touch)
    touches.sort(key=lambda touch: float(touch.parameter))
    return Earlier(contact, low, reached, spacing, extrema, tuple(touches), lost)


def _seen(
    contact: Contact, here: "BranchImages", before: "BranchImages", bounces: int, spacing: float
) -> tuple[int, int, list[Contact]]:
    """Number of bounces followed, the number of extrema, and guesses of contacts at parameters up to this contact's."""
    reached, extrema, guesses = bounces, 0, list[Contact]()
    for side in here.sides:
        count = 0
        for found in here.extrema(side, bounces, spacing):
            count, extrema = found.bounces, extrema + found.low.size
            guesses += _guesses(contact, found, here, before)
        reached = min(reached, count)
    return reached, extrema, guesses


class BranchImages:
    """Images of one branch of a saddle's unstable manifold, at one parameter, and their gaps to its stable manifold."""

    def __init__(self, contact: Contact, map: PlaneMap, parameter: float) -> None:
        made = saddle(contact.unstable, map.over(FLOAT64), parameter)
        self.map, self.parameter = map.over(ARRAYS), parameter
        self.out, self.into = local(made, True), local(made, False)
        side = int(math.copysign(1, contact.z))
        self.sides = (side,) if made.unstable > 0 else (side, -side)  # a negative multiplier exchanges them
        self.end = INSIDE / abs(made.stable)

    def at(self, z: Array, bounces: int) -> tuple[Array, Array]:
        """Images in the plane, after `bounces` bounces, of the points with parameters `z` on the unstable manifold."""
        x, y = self.map.plane(*self.out.points(z))
        return self.map.advanced(np.asarray(x), np.asarray(y), self.parameter, bounces)

    def gap(self, points: tuple[Array, Array], sign: int) -> tuple[Array, Array]:
        """The gap at points of the plane, or at their mirror images if `sign` is -1, and the parameter on the stable
        manifold.

        Both are NaN at points that are not near the stable manifold.
        """
        turn = self.map.turn
        away = sign * points[0] - self.ends[2]
        if turn:
            away = np.remainder(away + np.pi / turn, 2 * np.pi / turn) - np.pi / turn
        near = np.nonzero((self.ends[0] <= away) & (away <= self.ends[1]))[0]
        gap, end = np.full(away.size, np.nan), np.full(away.size, np.nan)
        if near.size:
            here, following = self.map.neighbours(points[0][near], points[1][near], self.parameter)
            gap[near], end[near] = gaps(self.into, sign * here, sign * following, NEAR)
        return gap, end

    @cached_property
    def ends(self) -> tuple[float, float, float]:
        """Least and greatest first coordinate on the local stable manifold, minus the saddle's; and the saddle's."""
        here, following = self.into.points(np.linspace(-self.end, self.end, 201))
        x = np.asarray(self.map.plane(here, following)[0])
        middle = float(x[100])
        return float(np.min(x)) - middle, float(np.max(x)) - middle, middle

    def extrema(self, side: int, bounces: int, spacing: float) -> Iterator[Extrema]:
        """Extrema of the gap after 1 to `bounces` bounces, for `z` of the sign `side`; stops at `POINTS` points."""
        z = side * elementary.exp(np.linspace(-math.log(abs(float(self.out.factor))), 0, START))
        x, y = self.at(z, 0)
        for count in range(1, bounces + 1):
            x, y = self.map.advanced(x, y, self.parameter, 1)
            z, x, y = self.filled(z, x, y, count, spacing)
            for sign in (1, -1) if self.map.turn else (1,):
                gap, end = self.gap((x, y), sign)
                at = turning(gap)
                at = at[np.abs(end[at]) > LATE / self.end]  # nearer to the saddle it belongs to fewer bounces
                yield Extrema(count, sign, z[at - 1], z[at + 1], gap[at] < gap[at + 1], end[at])
            if z.size > POINTS:
                return

    def filled(self, z: Array, x: Array, y: Array, count: int, spacing: float) -> tuple[Array, Array, Array]:
        """The arrays `z`, `x`, `y` with points inserted where images under `count` bounces are over `spacing` apart."""
        away = np.diff(x)
        if self.map.turn:
            away = np.remainder(away + np.pi, 2 * np.pi) - np.pi
        apart = np.hypot(away, np.diff(y))
        gone = (np.abs(x) > FAR) | (np.abs(y) > FAR)
        apart[~np.isfinite(apart) | (gone[:-1] & gone[1:])] = 0.0
        parts = np.minimum(np.ceil(apart / spacing), START).astype(int)
        where = np.repeat(np.arange(parts.size), np.maximum(parts - 1, 0))
        if not where.size:
            return z, x, y
        starts = np.concatenate([[0], np.cumsum(np.maximum(parts - 1, 0))[:-1]])
        share = (np.arange(where.size) - starts[where] + 1) / parts[where]
        more = z[where] + share * (z[where + 1] - z[where])
        values = zip((z, x, y), (more, *self.at(more, count)), strict=True)
        z, x, y = (np.insert(old, where + 1, new) for old, new in values)
        return z, x, y

    def values(self, found: Extrema) -> tuple[Array, Array]:
        """The gap at each extremum, and the `z` at which it is attained, by repeated subdivision of their intervals."""
        low, high, kind = found.low, found.high, np.where(found.minimum, 1.0, -1.0)
        shares, which = np.linspace(0, 1, SHARES)[:, None], np.arange(low.size)
        for _ in range(DIVIDED):
            z = low + (high - low) * shares
            gap = self.gap(self.at(z.ravel(), found.bounces), found.sign)[0].reshape(z.shape)
            best = np.clip(np.argmin(np.where(np.isnan(gap), np.inf, gap * kind), axis=0), 1, SHARES - 2)
            low, high = z[best - 1, which], z[best + 1, which]
        return gap[best, which], z[best, which]


def _guesses(contact: Contact, found: Extrema, here: BranchImages, before: BranchImages) -> list[Contact]:
    """Guesses of contacts at parameters up to the given one's, where linear extrapolation makes an extremum vanish."""
    if not found.low.size:
        return []
    (value, z), (earlier, _) = here.values(found), before.values(found)
    with np.errstate(all="ignore"):
        place = contact.parameter - value * STEP / (value - earlier)
    good = np.nonzero(place < contact.parameter + ALIKE)[0]
    starts = zip(z[good] * here.out.unit, found.end[good] * here.into.unit, place[good], strict=True)
    orbit = contact.unstable
    return [Contact(orbit, orbit, found.bounces, found.sign, *(float(x) for x in start)) for start in starts]
