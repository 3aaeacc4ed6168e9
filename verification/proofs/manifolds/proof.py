"""The theorem that manifolds of saddles have a generic tangency at one parameter of an interval, proved in balls.

An interval Newton step for the system of `touching` proves that it has one zero in a box, so the manifolds touch at one
parameter in the box. Let `A` be the derivative of the orbit's equations there, `v` its right null vector, and `u` its
left null vector with last entry 1. The last equation, with the others solved for all unknowns but `z`, is the gap
between the manifolds, a function `g` of `z` and the parameter. At the tangency `g_z = 0`,

    g_zz = u.(A'v)v,    g_parameter = u.(the equations' derivative by the parameter).

If `g_zz` is not 0, the contact is quadratic. If `g_parameter` is not 0, the gap passes 0 as the parameter varies.

Under a law other than the paper's a symmetry of the table need not be a symmetry of the map: `objection` says what is
missing. Everything else holds for any law, which enters through the rule and its derivatives.

`StrangeAttractors` adds the hypotheses of Mora and Viana. Then every neighbourhood of the parameter contains a set of
positive measure for whose parameters the map has a strange attractor: it attracts an open set, and holds a dense orbit
along which vectors grow exponentially [MoraViana1993]. docs/global.md states the theorem and each hypothesis, and how
symmetries of the table and negative multipliers are treated.
"""

from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

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
from verification.proofs.manifolds.touching import OrbitPoint, Touching, Vector, generic
from verification.proofs.periodic.interval_newton import ZeroStatus, slope_bits, stepped
from verification.rigorous.theorem import Theorem, Verdict, hypothesis

LEAST_DIGITS = 24
NEWTON, LONG = 12, 60  # steps; a flight of more than LONG bounces is solved in halves first
NEAR = Rational(1, 10**6)  # the law is proved valid for parameters so near the contact's
PIECES, PLACES = 2048, 64  # pieces of the incidence angles, and of the boundary for a law of the place
SMALL = 1e-5  # relative to the box: the last correction of Newton's method
STEPS = ("saddle", "remainder", "exists")  # the steps of an enclosure, in order


class EnclosedContact(NamedTuple):
    """Enclosed data of a contact; of the steps of the proof in `STEPS`, the first `steps` are proved.

    `bend` and `speed` are the derivatives `g_zz` and `g_parameter` of the gap, `multipliers` the stable and the
    unstable multiplier of the saddle that the orbit leaves.
    """

    parameter: arb
    steps: int = 0
    exists: Verdict = None
    system: Touching | None = None
    point: OrbitPoint | None = None
    bend: arb = arb("nan")
    speed: arb = arb("nan")
    multipliers: tuple[arb, ...] = ()


@dataclass(frozen=True, repr=False)
class ManifoldsTouch(Theorem):
    """Manifolds touch at one parameter within `10**-digits` of `near`, quadratically, and pass through each other.

    >>> from verification.proofs.manifolds.known import SHAPE, contact, table
    >>> triangle = contact("boundary", SHAPE)
    >>> ManifoldsTouch(triangle, table(SHAPE), "0.66214427335822441948253455", 20).proved
    True
    """

    contact: Contact
    map: PlaneMap
    near: str
    digits: int = LEAST_DIGITS

    @cached_property
    def precision(self) -> Precision:
        """The bits, orders and radii that a proof to this number of digits uses."""
        return Precision(self.digits)

    @cached_property
    def enclosed(self) -> EnclosedContact:
        """Enclosed manifolds and their contact, by an interval Newton step; long flights are solved by halves first."""
        with working(self.precision.bits):
            parameter = arb(self.near).mid()
            try:
                system = Touching(self.contact, self.map, parameter, self.precision)
                if system.bounces > LONG:
                    system.halves = True
                    with suppress(ValueError, ArithmeticError):
                        found = self._solve(system)
                        if found.exists and self._admissible(found) and _nonzero(found.bend) and _nonzero(found.speed):
                            return found
                    system.halves = False
                return self._solve(system)
            except (ValueError, ArithmeticError) as why:
                step = STEPS.index(why.item if isinstance(why, TooWideError) else "saddle")
                return EnclosedContact(arb(parameter, self.precision.step), step)

    def _solve(self, system: Touching) -> EnclosedContact:
        near = settled(system, self.precision).unknowns[:-1]
        centre, wide = OrbitPoint.of([*near, system.parameter]), arb(10) ** -(self.digits // 2)
        box = OrbitPoint.of([*(arb(x, wide) for x in near), arb(system.parameter, self.precision.step)])
        at = system.linear(centre)
        with working(slope_bits(len(box.unknowns))):
            over = system.linear(box)
            step = over.step([*at.values, *at.along], "precond")
        proof = stepped(centre.unknowns, box.unknowns, lambda: step)
        found = {ZeroStatus.UNIQUE: True, ZeroStatus.EMPTY: False, ZeroStatus.UNKNOWN: None}[proof.status]
        if not found:
            return EnclosedContact(box.parameter, len(STEPS), found)
        image, left = proof.zero, system.pairs[0].saddle
        at_zero = OrbitPoint.of(image)
        bend, speed = generic(system.linear(at_zero), at_zero.along)
        multipliers = multipliers_at(image[-1], left, self.map, self.precision)
        return EnclosedContact(image[-1], len(STEPS), True, system, at_zero, bend, speed, multipliers)

    def _admissible(self, found: EnclosedContact) -> Verdict:
        with working(self.precision.bits):
            if found.steps < len(STEPS) or objection(self.contact, self.map, float(arb(self.near).mid())):
                return None
            return admissible(self.map) or (found.point and found.system and found.system.clear(found.point)) or None

    @property
    def value(self) -> arb:
        """The parameter at the tangency, as a ball."""
        return self.enclosed.parameter

    @property
    def touches(self) -> bool:
        """True if a contact of the manifolds at one parameter is proved, generic or not."""
        return self.enclosed.exists is True and self.admissible is True

    @hypothesis
    def saddle(self) -> bool:
        """The saddles exist for all parameters of the box."""
        return self.enclosed.steps > 0

    @hypothesis
    def remainder(self) -> bool:
        """The series of their manifolds have bounded remainders."""
        return self.enclosed.steps > 1

    @hypothesis(refutable=True)
    def exists(self) -> Verdict:
        """The manifolds touch at a parameter of the box."""
        return self.enclosed.exists

    @hypothesis(refutable=True)
    def unique(self) -> Verdict:
        """The manifolds touch at no other parameter of the box."""
        return self.enclosed.exists

    @hypothesis
    def admissible(self) -> Verdict:
        """Every chord of the orbit ends at its first hit, and table and law have the orbit's symmetries."""
        return self._admissible(self.enclosed)

    @hypothesis
    def quadratic(self) -> Verdict:
        """The second derivative of the gap between the manifolds is not 0."""
        return _nonzero(self.enclosed.bend)

    @hypothesis
    def transversal(self) -> Verdict:
        """The gap passes 0 as the parameter varies."""
        return _nonzero(self.enclosed.speed)

    @property
    def strange(self) -> "StrangeAttractors":
        """The theorem that strange attractors exist near the parameter."""
        return StrangeAttractors(self.contact, self.map, self.proved, self.value, self.enclosed.multipliers)


def admissible(map: PlaneMap) -> bool | None:
    """True if no chord between two bounces meets the boundary on its way, since the table is convex; else None."""
    if not isinstance(map, Pinball):
        return True
    # bounces may pass the end of the parameter range
    seamless = len(map.table.components) > 1 or closes_smoothly(map.table)
    return convex(map.table) if seamless else None


def objection(contact: Contact, map: PlaneMap, parameter: float) -> str:
    """The reason why a contact does not fit its table or law; empty if it does.

    The table or the law may lack a symmetry of the contact, or the law may not be proved valid near the parameter.

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


def settled(system: Touching, precision: Precision) -> OrbitPoint:
    """The zero of the system by Newton's method, with manifolds affine in the parameter; without a proof."""

    def correction(unknowns: Vector) -> Vector:
        linear = system.linear(OrbitPoint.of(unknowns))
        return linear.step([*linear.values, *linear.along], "approx")

    stop = Stop(enough=precision.step * SMALL, steps=NEWTON)
    found = iterated(correction, system.start.unknowns, stop, kept=arb.mid)
    if not found.settled:
        raise TooWideError("exists", "Newton's method finds no contact near the start")
    return OrbitPoint.of(found.x)


def sharpened(contact: Contact, map: PlaneMap, value: str, digits: int) -> str:
    """The parameter of a contact to ten digits more than `digits`, from a value near it; without a proof."""
    precision, before = Precision(digits), arb(1)
    with working(precision.bits):
        parameter = arb(value).mid()
        while True:
            found = settled(Touching(contact, map, parameter, precision), precision).parameter
            moved = abs(found - parameter)
            if moved < precision.step * SMALL or not moved < before / 2:
                return str(found.str(digits + 10, radius=False))
            parameter, before = found, moved


RESONANCES = 100  # the order up to which resonances are excluded, for smooth linearising coordinates


@dataclass(frozen=True, repr=False)
class StrangeAttractors(Theorem):
    """Near the parameter, on a set of parameters of positive measure, the map has strange attractors (Mora and Viana).

    `touches` is True where the tangency is proved; `multipliers` are the stable and the unstable multiplier of its
    saddle.

    >>> from verification.proofs.manifolds.known import CONTACTS, SHAPE, table
    >>> ManifoldsTouch(CONTACTS["boundary"], table(SHAPE), "0.66214427335822441948", 10).strange.proved
    True
    """

    contact: Contact
    map: PlaneMap
    touches: bool
    parameter: arb
    multipliers: tuple[arb, ...]

    @property
    def sizes(self) -> tuple[arb, ...]:
        """Absolute values of the multipliers; `ArithmeticError` if they are not enclosed."""
        if not self.multipliers:
            raise ArithmeticError("no multipliers are enclosed")
        return tuple(abs(x) for x in self.multipliers)

    @hypothesis
    def tangency(self) -> bool:
        """The manifolds touch at the parameter, quadratically, and pass through each other."""
        return self.touches

    @hypothesis(refutable=True)
    def homoclinic(self) -> bool:
        """The two manifolds belong to one cycle."""
        return self.contact.kind == "homoclinic"  # the same start leads to the same cycle

    @hypothesis
    def analytic(self) -> Verdict:
        """The map and its inverse are analytic."""
        return smooth(self.map, self.parameter)

    @hypothesis(refutable=True)
    def dissipative(self) -> Verdict:
        """The product of the multipliers is below 1 in modulus."""
        with working(Precision(LEAST_DIGITS).bits):
            stable, unstable = self.sizes
            return True if stable * unstable < 1 else False if stable * unstable > 1 else None

    @hypothesis
    def nonresonant(self) -> Verdict:
        """`abs(stable)**i * abs(unstable)**j` is not 1 for `1 <= i <= RESONANCES` and any `j`."""
        with working(Precision(LEAST_DIGITS).bits):
            return nonresonant(*self.sizes)


def smooth(map: PlaneMap, parameter: arb | None = None) -> bool | None:
    """True if the map is proved analytic with an analytic inverse, on a convex table with one smooth curve; else None.

    A law other than the paper's must have no roots, and must decrease in the incidence angle at `parameter`.
    """
    if not admissible(map):
        return None
    if not isinstance(map, Pinball):
        return True
    return True if closes_smoothly(map.table) and (map.law.uniform or falling(map.law, parameter)) else None


def falling(law: Law, parameter: arb | None) -> bool:
    """True if the law is proved analytic and decreasing in `eta`, for all angles and landings at `parameter`.

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
    """True if `stable**i * unstable**j` is proved not 1 for `1 <= i <= RESONANCES` and any `j`; else None.

    >>> nonresonant(arb("0.3"), arb(2)), nonresonant(arb("0.25"), arb(2))
    (True, None)
    """
    ratio = -stable.log() / unstable.log()
    apart = all(not (i * ratio).contains_integer() for i in range(1, RESONANCES + 1))
    return True if ratio.is_finite() and apart else None
