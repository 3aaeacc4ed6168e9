"""Tangencies of the manifolds of saddles, in scenes whose boundary is one smooth formula: found, then proved.

Each tangency is found in float64 and then proved in balls. A crisis is such a tangency; it is not shown here that an
attractor changes there. If the boundary is not convex, each flight is proved to meet no other part of it.

If the boundary has several pieces, the map has kinks. A manifold that crosses a kink is bent or torn there and has no
power series across it; such manifolds are not followed, and no tangency is searched for (`objection_of`).
"""

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import arb

from symbolic.tables.definition import exact
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import decimal, working
from verification.cycles.recurrence import Closure
from verification.cycles.systems import reflected
from verification.maps.first_hit import closes_smoothly
from verification.named.bifurcations import FEW_SEARCHES, same_multipliers
from verification.named.locate import Located
from verification.named.questions import PeriodicOrbit, Tick, find_cycles
from verification.proofs.manifolds.certificate import Tangency
from verification.proofs.manifolds.grow import touches
from verification.proofs.manifolds.known import settled
from verification.proofs.manifolds.plane_map import pinball
from verification.proofs.manifolds.proof import LEAST_DIGITS, objection, sharpened
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.manifolds.tangency import Contact, Touch

BOUNCES, ROUNDS = 6, 6  # for which an unstable manifold is followed, at least
TRIED = 6  # places on it from which a tangency is sought
LEAST, BITS = 1e-12, 64  # the least error in float64, and the bits of the ball that holds it
SAME = 1e-6  # parameters of bounces that a symmetry exchanges, and of one tangency found twice, in float64


def objection_of(scene: Scene) -> str:
    """The reason why a scene has no search for tangencies; empty if boundary and law are one smooth formula each.

    >>> from symbolic import tables
    >>> objection_of(Scene(tables.stadium()))
    'its boundary has 4 pieces, and the map has kinks where they join: a manifold breaks there and is not followed'
    >>> objection_of(Scene("egg", alpha="2/25"))
    ''
    """
    table = scene.table
    broken = "a manifold breaks there and is not followed"
    if (pieces := len(table.components)) > 1:
        return f"its boundary has {pieces} pieces, and the map has kinks where they join: {broken}"
    if table.undefined:
        return f"its boundary has a cusp or a corner, where the map is not defined: {broken}"
    if not closes_smoothly(table):
        return f"its boundary does not close smoothly, and the map has kinks where it does not: {broken}"
    return "its law measures arc length, of which no power series is made" if scene.law.measured else ""


def tangencies(
    scene: Scene,
    *,
    period: int,
    lam: tuple[Any, Any] = ("0", "1"),
    digits: int = 30,
    searches: int = FEW_SEARCHES,
    tick: Tick | None = None,
) -> tuple[Located, ...]:
    """Tangencies of the manifolds of saddles up to a period, as the contraction varies, each with its proof.

    Cycles and their manifolds are examined at `searches` contractions. Each tangency that is certified is proved, but
    not that there are no others; there are infinitely many near any of them.
    """
    if why := objection_of(scene):
        raise ValueError(f"locate tangency: {scene.name}: {why}; accepted: a boundary of one smooth formula")
    low, high = (exact("lam", end) for end in lam)
    if not 0 < low < high <= 1:
        raise ValueError(
            f"locate tangency: lam from {low} to {high} is no interval of contractions; accepted: 0 < LOW < HIGH <= 1"
        )
    say, met = tick or (lambda said: None), dict[int, tuple[Touch, PeriodicOrbit]]()
    for i in range(searches):
        middle = low + (high - low) * Fraction(2 * i + 1, 2 * searches)
        for touch, cycle in near(scene.at(lam=str(middle)), (float(low), float(high)), period):
            met.setdefault(round(touch.parameter / SAME), (touch, cycle))
        say(f"lam = {float(middle):.4g}")
    return tuple(located(scene, *met[place], digits) for place in sorted(met))


def located(scene: Scene, touch: Touch, cycle: PeriodicOrbit, digits: int) -> Located:
    """A tangency that was found, with its proof, or with the reason why it is not proved."""
    begun, contact = time.perf_counter(), touch.contact
    unstable, stable = touch.multipliers[1], touch.multipliers[0]
    notes = {
        "called": f"tangency of manifolds of a cycle of period {cycle.period}",
        "saddle": f"bounces at theta = {', '.join(f'{x:.6f}' for x in cycle.theta)}",
        "multipliers": f"{unstable:.6g} and {stable:.6g} in a round of {len(contact.unstable.start)} bounces",
        "orbit": f"{contact.bounces} bounces from the local unstable manifold to the stable one",
    }
    proof = proved(scene, contact, digits)
    if isinstance(proof, str):
        notes["open"] = proof
        with working(BITS):
            ball, checks = arb(touch.parameter, max(touch.error, LEAST)), dict[str, bool | None](touch=None)
        value, radius = f"{float(touch.parameter):.12f}", f"{max(touch.error, LEAST):.0e}"
    else:
        ball, checks = proof.value, dict(proof.checks)
        value, radius = decimal(ball, digits + 1)
    made = None if isinstance(proof, str) else proof
    return Located("tangency", value, radius, digits, checks, time.perf_counter() - begun, ball, made, notes)


def proved(scene: Scene, contact: Contact, digits: int) -> Tangency | str:
    """The proof that the manifolds touch, to `digits` digits or a few more; or the reason why there is none."""
    map, asked = pinball(scene.table, scene.law), max(digits, LEAST_DIGITS)
    if why := objection(contact, map, contact.parameter):
        return why
    try:
        value = sharpened(contact, map, repr(contact.parameter), asked)
        return Tangency(contact, scene.table, value, asked, scene.law)
    except (ValueError, ArithmeticError) as why:
        return str(why)


def near(
    scene: Scene, ends: tuple[float, float], period: int, seed: int = 1, heard: Tick = lambda said: None
) -> Iterator[tuple[Touch, PeriodicOrbit]]:
    """The tangencies, each with its saddle, that Newton's method finds from the scene's contraction, within `ends`."""
    mirror = scene.law.odd and reflected(scene.table)
    map, known = pinball(scene.table, scene.law), set[tuple[complex, ...]]()
    for cycle in find_cycles(scene, up_to=period, seed=seed, tick=heard):
        one, two = cycle.multipliers
        look = cycle.period, *same_multipliers(cycle)
        saddle = one.imag == 0 and min(abs(one), abs(two)) < 1 < max(abs(one), abs(two))
        if not saddle or look in known:
            continue
        known.add(look)
        heard("tangencies")
        orbit = round_of(cycle, map.turn, mirror)
        rounds = max(ROUNDS, BOUNCES // len(orbit.start))
        for touch in touches(orbit, map, float(scene.lam), rounds, TRIED, any_bounce=mirror):
            if ends[0] <= touch.parameter <= ends[1]:
                yield replace(touch, contact=settled(touch.contact, map)), cycle


def round_of(cycle: PeriodicOrbit, turn: int, mirrored: bool) -> SaddleCycle:
    """The shortest part of a cycle that gives it by turns of `2*pi/turn`, and mirrors if `mirrored`; angles increase.

    >>> from symbolic import Scene
    >>> egg, thirds = Scene("egg", alpha="2/25"), (0.0, 2.0943951, -2.0943951)
    >>> triangle = PeriodicOrbit(egg, (0,) * 3, thirds, (0.0,) * 3, (0j, 0j))
    >>> round_of(triangle, 3, True).closure.shift
    (1, 3)
    """
    x = [cycle.theta[0]]
    for theta in (*cycle.theta[1:], cycle.theta[0]):
        x.append(x[-1] + (theta - x[-1]) % (2 * math.pi))
    once = x[-1] - x[0]
    twice, unit, name = [*x[:-1], *(y + once for y in x[:-1])], 2 * math.pi / turn, f"cycle of period {cycle.period}"
    for k in range(1, cycle.period):
        for sign in (1, -1) if mirrored else (1,):
            moved = [(twice[i + k] - sign * twice[i]) / unit for i in range(cycle.period)]
            if all(abs(math.remainder(y - round(moved[0]), turn)) < SAME for y in moved):  # whole turns change nothing
                return SaddleCycle(name, tuple(x[:k]), Closure(sign, (round(moved[0]), turn)))
    return SaddleCycle(name, tuple(x[:-1]), Closure(1, (round(once / (2 * math.pi)), 1)))
