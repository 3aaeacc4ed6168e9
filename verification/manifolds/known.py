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
"""

from dataclasses import replace

from sympy import Expr, Rational

from symbolic.tables import egg
from verification.arithmetic import FLOAT64
from verification.manifolds.recurrence import Pinball
from verification.manifolds.saddle import Orbit
from verification.manifolds.tangency import Contact, Gap, tangency
from verification.manifolds.windows import WINDOWS
from verification.progress import telling

SHAPE = Rational(2, 25)
STEP = Rational(1, 500)  # of the shape, in continuation
LEAST = Rational(1, 10_000)
TRIANGLE = Orbit("triangle of the vertices", (-0.165533,), 1, (1, 3))
MIRRORED = Orbit("cycle of period 8", (0.87019, 4.339815, 7.910758, 10.599687), -1, (7, 3))
SYMMETRIC = Orbit("symmetric cycle of period 4", (-0.645971, 2.02441), -1, (2, 3))
FOUR = Orbit("cycle of period 4", (-0.022673, 2.875498, 6.392393, 9.889393), 1, (6, 3))
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
