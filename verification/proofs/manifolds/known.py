"""The crises of the three-pointed egg as tangencies: which saddle, and starts at `alpha = 0.08`.

Two crises join what period doubling and symmetry breaking had split, each when the unstable manifold of
the cycle that had split touches its own stable one: eight chaotic bands near one end of a diameter
become four at the cycle of period 4, and the two mirror images become one attractor at the symmetric cycle
of period 4 from which they had come.

Boundary crisis: the saddle is the triangle of the vertices, born at the fold of period 3. Its stable
manifold bounds the basin of the attracting triangle; its unstable manifold runs to the chaotic
attractor, whose outermost fold it is, and touches the stable one. Merging crisis: the saddle is a cycle
of period 8 that its mirror image repeats after 4 bounces. It is the cycle of the fractal basin boundary
that can be reached from the attractor near a diameter. Other shapes follow by continuation.

To many digits a crisis is found by two methods that share nothing but the chord. The value comes from the fold of a
long cycle that shadows the tangency (`shadows`): its distance to the tangency falls like `unstable**-rounds`, and a
cycle with four rounds more tells how far the shorter one was. The tangency of the manifolds themselves (`tangency`)
has to agree.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import mpmath
from sympy import Expr, Rational

from symbolic.tables import egg
from verification.arithmetic.balls import FLOAT64
from verification.arithmetic.progress import telling
from verification.cycles.recurrence.newton import refined
from verification.cycles.recurrence.recurrence import Closure
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.proof import LEAST_DIGITS, TangencyClaim, TangencyProof, sharpened, worked_through
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.manifolds.shadows import Shadow, shadow
from verification.proofs.manifolds.tangency import Contact, Gap, Touch, tangency
from verification.proofs.manifolds.windows import WINDOWS

SHAPE = Rational(2, 25)
STEP = Rational(1, 500)  # of the shape, in continuation
LEAST = Rational(1, 10_000)
TRIANGLE = Orbit("triangle of the vertices", (-0.165533,), Closure(1, (1, 3)))
MIRRORED = Orbit("cycle of period 8", (0.87019, 4.339815, 7.910758, 10.599687), Closure(-1, (7, 3)))
SYMMETRIC = Orbit("symmetric cycle of period 4", (-0.645971, 2.02441), Closure(-1, (2, 3)))
FOUR = Orbit("cycle of period 4", (-0.022673, 2.875498, 6.392393, 9.889393), Closure(1, (6, 3)))
CONTACTS = {
    "merging": Contact(MIRRORED, MIRRORED, 14, 1, -0.00396287, -0.00053713, 0.44343525),
    "boundary": Contact(TRIANGLE, TRIANGLE, 5, 1, 0.03431592, -0.02607124, 0.66214427),
    "band-merging": Contact(FOUR, FOUR, 20, 1, -0.01239661, 0.00116269, 0.39768737),
    "symmetry-restoring": Contact(SYMMETRIC, SYMMETRIC, 12, 1, -0.03158573, -0.00186500, 0.41026825),
} | WINDOWS
CONTACTS["band-merging-4"] = CONTACTS["band-merging"]  # as those of periods 8 and 16 are called


def table(alpha: Expr) -> Pinball:
    """The map of the three-pointed egg."""
    return Pinball(egg(3).at(alpha=alpha), turn=3)


def contact(kind: str, alpha: Expr) -> Contact:
    """A contact by its name at a shape, followed there from `alpha = 0.08`."""
    if kind not in CONTACTS:
        raise ValueError(f"crisis: {kind!r} is not known; accepted: {', '.join(CONTACTS)}")
    before = here = CONTACTS[kind]
    shape, step, last = SHAPE, STEP, STEP
    tick = telling(f"following the tangency to alpha = {alpha}")
    while shape != alpha:
        move = max(-step, min(step, alpha - shape))
        try:
            following = settled(extrapolated(before, here, float(move / last)), table(shape + move))
        except (ValueError, ArithmeticError) as why:
            step = step / 2
            if step < LEAST:
                raise ValueError(
                    f"{kind} crisis: followed from alpha = 0.08 to alpha = {alpha}, the tangency is lost beyond "
                    f"alpha = {float(shape):.5g} ({why}); accepted: shapes on this side of it"
                ) from why
            continue
        shape, last, before, here = shape + move, move, here, following
        tick(float(move / (alpha - SHAPE)))
    return here


def extrapolated(before: Contact, here: Contact, share: float) -> Contact:
    """The starts carried on, `share` times the last change."""
    names = ("letter", "z", "end")
    moved = {name: getattr(here, name) + share * (getattr(here, name) - getattr(before, name)) for name in names}
    return replace(here, **moved)


def settled(guess: Contact, map: Pinball) -> Contact:
    """The contact found from a guess, with starts taken from it."""
    letter = tangency(guess, map, 8).letter
    return Gap(guess, map.over(FLOAT64), letter, 28, 1e-16).contact()


MOST_DIGITS = 500
MANIFOLD_DIGITS = 20  # asked of the second method at most
SPARE = 4  # rounds by which the second cycle is longer


@dataclass(frozen=True)
class Crisis:
    """`letter +- error` and how it was found; `apart` is how far the two methods are from each other."""

    kind: str
    letter: Any
    error: Any
    touch: Touch
    apart: float
    cycle: Shadow

    @property
    def period(self) -> int:
        """Bounces of the cycle before it repeats, or repeats as its mirror image."""
        return self.cycle.problem.period

    @property
    def agrees(self) -> bool:
        """Do the two methods agree within their errors?"""
        return self.apart <= 10 * self.touch.error + float(self.error)

    @property
    def exponent(self) -> float:
        """Of the mean transient above a homoclinic crisis [GrebogiOttRomeirasYorke1987]."""
        return homoclinic_exponent(self.touch.multipliers[0], self.touch.multipliers[1])


def homoclinic_exponent(stable: float, unstable: float) -> float:
    """`ln|stable| / (2*ln|stable*unstable|)`, reached in the limit; at a finite distance see `local_exponent`.

    >>> homoclinic_exponent(1 / 16, 4)
    1.0
    """
    return math.log(abs(stable)) / (2 * math.log(abs(stable * unstable)))


def heteroclinic_exponent(stable: float, unstable: float) -> float:
    """`1/2 + ln|unstable|/|ln|stable||`, of the saddle inside the attractor.

    >>> heteroclinic_exponent(1 / 16, 4)
    1.0
    """
    return 0.5 + math.log(abs(unstable)) / abs(math.log(abs(stable)))


def crisis(kind: str, alpha: Expr, digits: int) -> Crisis:
    """The `merging` or the `boundary` crisis of the three-pointed egg to `digits` digits, not proved.

    >>> from sympy import Rational
    >>> mpmath.nstr(crisis("boundary", Rational(2, 25), 10).letter, 10)
    '0.6621442734'
    """
    if digits > MOST_DIGITS:
        raise ValueError(f"{kind} crisis: digits = {digits} is out of range; accepted: up to {MOST_DIGITS}")
    map = table(alpha)
    where = contact(kind, alpha)
    touch = tangency(where, map, min(digits, MANIFOLD_DIGITS))
    unstable = abs(touch.multipliers[1])
    rounds = math.ceil((digits + 2) * math.log(10) / math.log(unstable))
    found = []
    for more in (0, SPARE):
        cycle = shadow(where, map, float(touch.letter), rounds + more)
        found.append(refined(cycle.problem, cycle.start, digits + 5).z[-1])
    context = mpmath.MPContext()
    context.dps = digits + 10
    short, letter = found
    error = abs(context.mpf(letter) - context.mpf(short)) + context.mpf(10) ** -(digits + 2)
    return Crisis(kind, context.mpf(letter), error, touch, float(abs(context.mpf(touch.letter) - letter)), cycle)


def proof(found: Crisis, alpha: Expr, digits: int) -> TangencyProof:
    """The proof in balls of a tangency near the value, within `10**-digits` or less.

    It proves the contact of the manifolds, and not that the attractor ends there.
    """
    digits, map, touch = max(LEAST_DIGITS, digits), table(alpha), found.touch
    try:
        value = sharpened(touch.contact, map, str(touch.letter), digits)
    except (ValueError, ArithmeticError):  # then no proof succeeds either; which step fails the checks tell
        value = str(touch.letter)
    return worked_through(TangencyClaim(touch.contact, alpha, value, digits))


def decimals(found: Crisis) -> tuple[str, str]:
    """The value and its error as decimals, all digits of both."""
    return str(found.letter), mpmath.nstr(found.error, 3)
