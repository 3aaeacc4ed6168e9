"""A proof in balls that a saddle's manifolds touch at one letter of an interval, quadratically and with non-zero speed.

An interval Newton step for the system of `touching` proves that it has one zero in a box: the manifolds touch at
one letter of it. Let `A` be the derivative of the orbit's equations there, `v` the vector that it takes to 0, and
`u` the vector from the left that it takes to 0, with the last entry 1. The last equation, with the others solved for
all unknowns but `z`, is the gap between the manifolds, a function `g` of `z` and the letter. At the tangency `g_z = 0`,

    g_zz = u.(A'v)v,    g_letter = u.(the equations' derivative by the letter).

The first is not 0: the contact is quadratic. The second is not 0: the gap passes 0 as the letter varies.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from flint import arb, arb_mat

from verification.arithmetic.words import working
from verification.cycles.recurrence.chain import dot
from verification.maps.admissible import convex
from verification.proofs.manifolds.enclosed import TooWideError
from verification.proofs.manifolds.pair import Precision
from verification.proofs.manifolds.plane_map import Pinball, PlaneMap
from verification.proofs.manifolds.tangency import Contact
from verification.proofs.manifolds.touching import Linear, Point, Touching, Vector
from verification.proofs.periodic.interval_newton import Status, compared, slope_bits

LEAST_DIGITS = 24
NEWTON = 12
SMALL = 1e-5  # beside the box, where Newton's method ends
ITEMS = ("saddle", "remainder", "exists", "unique", "admissible", "quadratic", "transversal")  # in this order
Checks = Mapping[str, bool | None]


@dataclass(frozen=True)
class Proof:
    """A tangency in `letter`, when every check is True; `bend` and `speed` are `g_zz` and `g_letter`.

    `multipliers` are the stable and the unstable one of the saddle that the orbit leaves.
    """

    letter: arb
    checks: Checks
    bend: arb | None = field(default=None, repr=False)
    speed: arb | None = field(default=None, repr=False)
    multipliers: tuple[arb, ...] = field(default=(), repr=False)

    @property
    def holds(self) -> bool:
        """Is every check proved?"""
        return all(value is True for value in self.checks.values())

    @property
    def touches(self) -> bool:
        """Is it proved that the manifolds touch at one letter, in whatever manner?"""
        return all(self.checks[item] is True for item in ITEMS[:5])


def tangency_proved(contact: Contact, map: PlaneMap, value: str, digits: int = LEAST_DIGITS) -> Proof:
    """The proof that the manifolds touch at one letter within `10**-digits` of `value`, which has more digits.

    >>> from verification.proofs.manifolds.known import SHAPE, contact, table
    >>> triangle = contact("boundary", SHAPE)
    >>> tangency_proved(triangle, table(SHAPE), "0.66214427335822441948253455", 20).holds
    True
    """
    precision = Precision(digits)
    with working(precision.bits):
        letter = arb(value).mid()
        try:
            return _proved(Touching(contact, map, letter, precision), map, precision)
        except (ValueError, ArithmeticError) as why:
            known = ITEMS.index(why.item if isinstance(why, TooWideError) else "saddle")
            checks = {item: True if k < known else None for k, item in enumerate(ITEMS)}
            return Proof(arb(letter, precision.step), checks)


def _proved(system: Touching, map: PlaneMap, precision: Precision) -> Proof:
    """The rest of the checklist, with both manifolds enclosed."""
    near = settled(system, precision).unknowns[:-1]
    centre, wide = Point.of([*near, system.letter]), arb(10) ** -(precision.digits // 2)
    box = Point.of([*(arb(x, wide) for x in near), arb(system.letter, precision.step)])
    at = system.linear(centre)
    with working(slope_bits(len(box.unknowns))):
        over = system.linear(box)
        step = over.step([*at.values, *at.along], "precond")
    image = [x - d for x, d in zip(centre.unknowns, step, strict=True)]
    status = compared(image, box.unknowns)
    found = {Status.UNIQUE: True, Status.EMPTY: False, Status.UNKNOWN: None}[status]
    checks: dict[str, bool | None] = {
        "saddle": True,
        "remainder": True,
        "exists": found,
        "unique": found,
        "admissible": admissible(map),
    }
    if not found:
        return Proof(box.letter, checks | {"quadratic": None, "transversal": None})
    bend, speed = generic(system.linear(Point.of(image)), Point.of(image).along)
    checks |= {"quadratic": _nonzero(bend), "transversal": _nonzero(speed)}
    left = system.pairs[0].saddle
    return Proof(image[-1], checks, bend, speed, (left.stable.real, left.unstable.real))


def admissible(map: PlaneMap) -> bool | None:
    """True where each chord between two bounces meets the boundary nowhere on its way: in a convex table."""
    return convex(map.table) if isinstance(map, Pinball) else True


def generic(linear: Linear, along: Vector) -> tuple[arb, arb]:
    """`g_zz` and `g_letter` of the text above."""
    rows = arb_mat([row[1:] for row in linear.rows[:-1]])
    solved = rows.transpose().solve(arb_mat([[-x] for x in linear.rows[-1][1:]]), algorithm="precond")
    left = [*(solved[i, 0] for i in range(solved.nrows())), arb(1)]
    bend = dot(left, [dot(row, along) for row in linear.bent])
    return bend, dot(left, linear.by_letter)


def _nonzero(x: arb) -> bool | None:
    return True if x > 0 or x < 0 else None


def settled(system: Touching, precision: Precision) -> Point:
    """The zero by Newton's method, with the manifolds taken as affine in the letter; not proved."""
    at = system.start
    for _ in range(NEWTON):
        linear = system.linear(at)
        step = linear.step([*linear.values, *linear.along], "approx")
        at = Point.of([(x - d).mid() for x, d in zip(at.unknowns, step, strict=True)])
        if all(abs(d) < precision.step * SMALL for d in step):
            return at
    raise TooWideError("exists", "Newton's method finds no contact near the start")


def sharpened(contact: Contact, map: PlaneMap, value: str, digits: int) -> str:
    """The letter of a contact to a few digits more than `digits`, from a value near it; not proved."""
    precision, before = Precision(digits), arb(1)
    with working(precision.bits):
        letter = arb(value).mid()
        while True:
            found = settled(Touching(contact, map, letter, precision), precision).letter
            moved = abs(found - letter)
            if moved < precision.step * SMALL or not moved < before / 2:
                return str(found.str(digits + 10, radius=False))
            letter, before = found, moved
