"""A proof in balls that a saddle's manifolds touch at one parameter of an interval, quadratically, at non-zero speed.

An interval Newton step for the system of `touching` proves that it has one zero in a box: the manifolds touch at one
parameter of it. Let `A` be the derivative of the orbit's equations there, `v` the vector that it takes to 0, and `u`
the vector from the left that it takes to 0, with the last entry 1. The last equation, with the others solved for all
unknowns but `z`, is the gap between the manifolds, a function `g` of `z` and the parameter. At the tangency `g_z = 0`,

    g_zz = u.(A'v)v,    g_parameter = u.(the equations' derivative by the parameter).

The first is not 0: the contact is quadratic. The second is not 0: the gap passes 0 as the parameter varies.

Under another law than the paper's a symmetry of the table is one of the map only where the law has it too: `objection`
says what is missing. Nothing else asks which law it is, as the rule and its derivatives have it in them.

`strange_attractors` checks what Mora and Viana ask for beside that. Then in every neighbourhood of the parameter there
is a set of positive measure for whose parameters the map has a strange attractor: it attracts an open set, and holds a
dense orbit along which vectors grow exponentially [MoraViana1993]. docs/global.md states the theorem, each hypothesis
and why symmetries of the table and signs of multipliers do no harm.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb
from sympy import Pow, Rational

from symbolic.expressions.text import load
from symbolic.motion.chords import law_kernel
from symbolic.tables.curves import is_periodic
from symbolic.tables.law import Law
from verification.arithmetic.balls import balls, between, working
from verification.arithmetic.iteration import Stop, iterated
from verification.cycles.systems import symmetries
from verification.maps.first_hit import closes_smoothly, convex
from verification.proofs.manifolds.enclosed import TooWideError
from verification.proofs.manifolds.plane_map import Pinball, PlaneMap
from verification.proofs.manifolds.tangency import Contact, Precision, multipliers_at
from verification.proofs.manifolds.touching import Point, Touching, Vector, generic
from verification.proofs.periodic.interval_newton import Status, slope_bits, stepped

LEAST_DIGITS = 24
NEWTON, LONG = 12, 60  # bounces beyond which a system is solved in halves first
NEAR = Rational(1, 10**6)  # the law is proved to be one for parameters so near the contact's
PIECES, PLACES = 2048, 64  # of incidence angles, and of the boundary under a law of the place
SMALL = 1e-5  # beside the box, where Newton's method ends
ITEMS = ("saddle", "remainder", "exists", "unique", "admissible", "quadratic", "transversal")  # in this order
Checks = Mapping[str, bool | None]


@dataclass(frozen=True)
class Proof:
    """A tangency in `parameter`, when every check is True; `bend` and `speed` are `g_zz` and `g_parameter`.

    `multipliers` are the stable and the unstable one of the saddle that the orbit leaves.
    """

    parameter: arb
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
        """Is it proved that the manifolds touch at one parameter, in whatever manner?"""
        return all(self.checks[item] is True for item in ITEMS[:5])


def tangency_proved(contact: Contact, map: PlaneMap, value: str, digits: int = LEAST_DIGITS) -> Proof:
    """The proof that the manifolds touch at one parameter within `10**-digits` of `value`, which has more digits.

    >>> from verification.proofs.manifolds.known import SHAPE, contact, table
    >>> triangle = contact("boundary", SHAPE)
    >>> tangency_proved(triangle, table(SHAPE), "0.66214427335822441948253455", 20).holds
    True
    """
    precision = Precision(digits)
    with working(precision.bits):
        parameter = arb(value).mid()
        try:
            system = Touching(contact, map, parameter, precision)
            if system.bounces > LONG:
                system.halves = True
                with suppress(ValueError, ArithmeticError):
                    if (found := _proved(system, map, precision)).holds:
                        return found
                system.halves = False
            return _proved(system, map, precision)
        except (ValueError, ArithmeticError) as why:
            known = ITEMS.index(why.item if isinstance(why, TooWideError) else "saddle")
            checks = {item: True if k < known else None for k, item in enumerate(ITEMS)}
            return Proof(arb(parameter, precision.step), checks)


def _proved(system: Touching, map: PlaneMap, precision: Precision) -> Proof:
    """The rest of the checklist, with both manifolds enclosed."""
    near = settled(system, precision).unknowns[:-1]
    centre, wide = Point.of([*near, system.parameter]), arb(10) ** -(precision.digits // 2)
    box = Point.of([*(arb(x, wide) for x in near), arb(system.parameter, precision.step)])
    at = system.linear(centre)
    with working(slope_bits(len(box.unknowns))):
        over = system.linear(box)
        step = over.step([*at.values, *at.along], "precond")
    proof = stepped(centre.unknowns, box.unknowns, lambda: step)
    image, found = proof.zero, {Status.UNIQUE: True, Status.EMPTY: False, Status.UNKNOWN: None}[proof.status]
    lawful = not objection(system.contact, map, float(system.parameter))
    checks: dict[str, bool | None] = {
        "saddle": True,
        "remainder": True,
        "exists": found,
        "unique": found,
        "admissible": admissible(map) if lawful else None,
    }
    if not found:
        return Proof(box.parameter, checks | {"quadratic": None, "transversal": None})
    if lawful:
        checks["admissible"] = checks["admissible"] or system.clear(Point.of(image)) or None
    bend, speed = generic(system.linear(Point.of(image)), Point.of(image).along)
    checks |= {"quadratic": _nonzero(bend), "transversal": _nonzero(speed)}
    left = system.pairs[0].saddle
    return Proof(image[-1], checks, bend, speed, multipliers_at(image[-1], left, map, precision))


def admissible(map: PlaneMap) -> bool | None:
    """True where any chord between two bounces meets the boundary nowhere on its way: in a convex table."""
    if not isinstance(map, Pinball):
        return True
    # bounces may run over the end of the parameter
    seamless = len(map.table.components) > 1 or closes_smoothly(map.table)
    return convex(map.table) if seamless else None


def objection(contact: Contact, map: PlaneMap, parameter: float) -> str:
    """Why a contact is none of its table or its law: what of its symmetry they lack, or where that is no law; else ''.

    >>> from verification.proofs.manifolds.known import CONTACTS, SHAPE, table
    >>> objection(CONTACTS["merging"], table(SHAPE, Law("-lam*eta + eta**2/99")), 0.44)
    'law = eta**2/99 - eta*lam: no odd function of eta, so mirror images of orbits are no orbits'
    """
    if not isinstance(map, Pinball):
        return ""
    law, own = map.law, {(g.turn, Fraction(*g.shift) % 1) for g in symmetries(map.table)} | {(1, Fraction(0))}
    asked = {(c.turn, Fraction(*c.shift) % 1) for c in (contact.unstable.closure, contact.stable.closure)}
    if not asked | ({(-1, Fraction(0))} if contact.sign < 0 else set()) <= own:
        return f"{map.table.name}: the orbit closes by a turn or a mirror that the table does not have"
    if law.uniform:
        return ""
    if law.parameters:
        return f"law = {law}: {', '.join(law.parameters)} is no number; write it into the formula"
    if law.measured:
        return f"law = {law}: tangencies are those of the egg, whose arc length s is no closed formula; write theta"
    closures = [orbit.closure for orbit in (contact.unstable, contact.stable)]
    if law.placed and (map.turn != 1 or not is_periodic(law.phi) or any(p % q for p, q in (c.shift for c in closures))):
        return f"law = {law}: the orbit closes by turns of the table, after which a law of the place is another one"
    if not law.odd and not contact.sign == 1 == min(closure.turn for closure in closures):
        return f"law = {law}: no odd function of eta, so mirror images of orbits are no orbits"
    low, high = (Rational(parameter) + side * NEAR for side in (-1, 1))
    finding = law.proof((max(low, Rational(0)), min(high, Rational(1))))
    return "" if finding else f"law = {law}: {finding.reason}"


def _nonzero(x: arb) -> bool | None:
    return True if x > 0 or x < 0 else None


def settled(system: Touching, precision: Precision) -> Point:
    """The zero by Newton's method, with the manifolds taken as affine in the parameter; not proved."""

    def correction(unknowns: Vector) -> Vector:
        linear = system.linear(Point.of(unknowns))
        return linear.step([*linear.values, *linear.along], "approx")

    stop = Stop(enough=precision.step * SMALL, steps=NEWTON)
    found = iterated(correction, system.start.unknowns, stop, kept=arb.mid)
    if not found.settled:
        raise TooWideError("exists", "Newton's method finds no contact near the start")
    return Point.of(found.x)


def sharpened(contact: Contact, map: PlaneMap, value: str, digits: int) -> str:
    """The parameter of a contact to a few digits more than `digits`, from a value near it; not proved."""
    precision, before = Precision(digits), arb(1)
    with working(precision.bits):
        parameter = arb(value).mid()
        while True:
            found = settled(Touching(contact, map, parameter, precision), precision).parameter
            moved = abs(found - parameter)
            if moved < precision.step * SMALL or not moved < before / 2:
                return str(found.str(digits + 10, radius=False))
            parameter, before = found, moved


RESONANCES = 100  # up to this order they are excluded; linearising coordinates of any class need finitely many
STRANGE = ("tangency", "homoclinic", "analytic", "dissipative", "nonresonant")


def strange_attractors(contact: Contact, map: PlaneMap, proof: Proof) -> Checks:
    """The hypotheses of Mora and Viana, item by item; with all of them proved strange attractors are.

    `nonresonant` excludes `abs(stable)**i * abs(unstable)**j = 1` for all `j` and `1 <= i <= RESONANCES`.

    >>> from verification.proofs.manifolds.known import CONTACTS, SHAPE, table
    >>> triangle, egg = CONTACTS["boundary"], table(SHAPE)
    >>> set(strange_attractors(triangle, egg, tangency_proved(triangle, egg, "0.66214427335822441948", 10)).values())
    {True}
    """
    found: dict[str, bool | None] = dict.fromkeys(STRANGE)
    found["tangency"] = True if proof.holds else None
    found["homoclinic"] = contact.kind == "homoclinic"  # the same start leads to the same cycle
    found["analytic"] = smooth(map, proof.parameter)
    if proof.multipliers:
        with working(Precision(LEAST_DIGITS).bits):
            stable, unstable = (abs(x) for x in proof.multipliers)
            found["dissipative"] = True if stable * unstable < 1 else False if stable * unstable > 1 else None
            found["nonresonant"] = nonresonant(stable, unstable)
    return found


def smooth(map: PlaneMap, parameter: arb | None = None) -> bool | None:
    """True when the map is analytic with an analytic inverse: in a convex table whose one curve closes smoothly.

    Of another law than the paper's it is asked besides that it has no roots, and falls as the incidence grows.
    """
    if not admissible(map):
        return None
    if not isinstance(map, Pinball):
        return True
    return True if closes_smoothly(map.table) and (map.law.uniform or falling(map.law, parameter)) else None


def falling(law: Law, parameter: arb | None) -> bool:
    """Is the law analytic with a negative derivative by `eta`, proved for all angles and places at a contraction?

    >>> falling(Law("-lam*eta + eta**3/40"), arb("0.6")), falling(Law("-lam*eta + eta**3/10"), arb("0.6"))
    (True, False)
    """
    if parameter is None or any(not power.exp.is_Integer for power in law.phi.atoms(Pow)):
        return False
    turns = PLACES if law.placed else 1
    with working(Precision(LEAST_DIGITS).bits):
        slope = load(law_kernel(law), balls(Precision(LEAST_DIGITS).bits))
        quarter, half = arb.pi() / 2, arb.pi()
        angles, places = (
            [whole * between(2 * k / n - 1, 2 * (k + 1) / n - 1) for k in range(n)]
            for whole, n in ((quarter, PIECES // turns), (half, turns))
        )
        return all(slope(eta, parameter, theta)[1] < 0 for eta in angles for theta in places)


def nonresonant(stable: arb, unstable: arb) -> bool | None:
    """Is no product of powers of two sizes of multipliers 1, up to the order of `RESONANCES`? None where not proved.

    >>> nonresonant(arb("0.3"), arb(2)), nonresonant(arb("0.25"), arb(2))
    (True, None)
    """
    ratio = -stable.log() / unstable.log()
    apart = all(not (i * ratio).contains_integer() for i in range(1, RESONANCES + 1))
    return True if ratio.is_finite() and apart else None
