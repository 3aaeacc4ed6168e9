"""Judges of claims that the egg's attractor expands as the contraction grows, by bounds of exit angles. Section 6.7.

Between a barrier and its mirror image there is a *maximal attractor*: it attracts all orbits there and contains every
attractor and every cycle. One barrier bounds its largest exit angle (its *extent*) from above for a range of
contractions. Cycles between the barriers bound it from below at single contractions. At each of these the extent is
larger than on a range of smaller contractions. Only samples show that the chaotic attractor, which may be a part of the
maximal one, has the same extent.

The attractor is not unique at every contraction between the crises at 0.4434 and 0.6621: in one window several cycles
attract, all of them between the barriers. (In other windows, such as that of period 9 at 0.493, the cycles lie beyond
the barriers.)
"""

from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise
from math import asin, ceil, floor, inf

import numpy as np
from flint import acb
from sympy import Rational

from symbolic.expressions.signs import SignFinding
from symbolic.tables.scene import Scene
from symbolic.tables.table import alpha as shape
from symbolic.tables.table import lam as letter
from verification.arithmetic.arrays import Array, Mask
from verification.arithmetic.balls import balls, fraction_ball, working
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled
from verification.paper.egg import crises
from verification.paper.egg.barriers import barrier, bounces
from verification.paper.judges.attractors import SHAPE, cycles, egg
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.crisis import bounding_boxes
from verification.proofs.manifolds.enclosed import TooWideError, complex_balls, enclosed_cycle
from verification.proofs.manifolds.known import CONTACTS, table
from verification.proofs.manifolds.saddle import padded
from verification.rigorous.boxes import Boxes

FIRST = "0.43"
STOPS = (FIRST, "0.5", "0.55")  # one barrier holds from each to the next
SADDLE, NAME = "0.506", "window-end-9"  # a contraction, and the tangency of its unstable cycle
WINDOW, PERIOD, COUNT, STARTS = "0.641", 18, 3, 40  # a contraction, and the period and number of attracting cycles
SEEN, BITS = "0.66", 160  # where chaotic orbits are sampled
REST = 1e-12  # above the rounding of a full turn


@cache
def saddle() -> Boxes | None:
    """The bounces of an unstable cycle as boxes, if it is proved to lie between the barriers; else None."""
    orbit, map = CONTACTS[NAME].unstable, table(Rational(SHAPE))
    with working(BITS):
        try:
            points = enclosed_cycle(orbit, map.over(complex_balls(BITS)), acb(fraction_ball(Fraction(SADDLE))))
        except TooWideError:
            return None
        real = map.over(balls(BITS))
        ring = padded(orbit, real, [point.real for point in points])[1:]
        boxes = bounding_boxes([(here, real.angle(here, there)[0]) for here, there in pairwise(ring)])
    return boxes if boxes and np.all(barrier(SADDLE).between(boxes)) else None


@cache
def kept() -> tuple[Boxes, ...]:
    """The bounces of the cycles in the window that are proved to attract and to lie between the barriers."""
    found = [bounces(WINDOW, cycle.points) for cycle in cycles(egg(WINDOW, STARTS), PERIOD)]
    return tuple(boxes for boxes in found if boxes and np.all(barrier(WINDOW).between(boxes)))


def reach() -> dict[str, float]:
    """A lower bound of the extent at each contraction, in order; 0 if none is proved."""
    found = {SADDLE: [boxes for boxes in (saddle(),) if boxes], WINDOW: kept()}
    return {lam: max(map(height, some), default=0.0) for lam, some in found.items()}


def height(boxes: Boxes) -> float:
    """A lower bound of the largest `|phi|` in the boxes."""
    return float(np.max(np.maximum(boxes.y[0], -boxes.y[1])))


@cache
def ceiling(low: str, high: str) -> float:
    """An upper bound of the extent for every contraction in a range; infinite if none is proved."""
    found = Barrier(Scene("egg", alpha=SHAPE), (Fraction(low), Fraction(high)))
    return inf if found.heights is None or not found.mirrored else float(np.max(found.heights))


def before(lam: str) -> tuple[str, float]:
    """The upper end of the last range of a barrier below `lam`, and an upper bound of the extent from 0.43 to there."""
    ranges = [(low, high) for low, high in pairwise(STOPS) if Fraction(high) < Fraction(lam)]
    return ranges[-1][1], max(ceiling(low, high) for low, high in ranges)


@cache
def expands() -> SignFinding:
    """The finding that, at each listed contraction, the extent is larger than on a range of smaller contractions."""
    steps = []
    for lam, low in reach().items():
        stop, most = before(lam)
        said = f"{down(low)} or more at {lam}, at most {up(most)} from {FIRST} to {stop}"
        steps.append(answer(low > most or None, said))
    return by("the largest exit angle of what is kept between a barrier and its mirror image", *steps)


@cache
def several() -> SignFinding:
    """The finding that several cycles attract in a window, all of them between the barriers."""
    return answer(
        len(kept()) == COUNT and not any(meet(one, other) for one, other in combinations(kept(), 2)),
        f"{COUNT} cycles of period {PERIOD} are proved to attract at lam = {WINDOW}, without a common bounce; all lie "
        "between a barrier and its mirror image",
    )


def meet(one: Boxes, other: Boxes) -> bool:
    """True if a box in `one` may meet a box in `other`, modulo full turns.

    >>> place = Boxes(np.zeros(1, dtype=int), (np.array([3.0]), np.array([3.5])), (np.zeros(1), np.ones(1)))
    >>> turned = place._replace(x=(place.x[0] - 2 * np.pi, place.x[1] - 2 * np.pi))
    >>> meet(place, turned), meet(place, place._replace(y=(np.array([1.5]), np.array([2.0]))))
    (True, False)
    """

    def near(here: tuple[Array, Array], there: tuple[Array, Array], shift: float) -> Mask:
        low, high = (end[:, None] + shift for end in here)
        return (low <= there[1] + REST) & (there[0] - REST <= high)

    turns = (near(one.x, other.x, 2 * np.pi * k) & near(one.y, other.y, 0.0) for k in (-1, 0, 1))
    return any(bool(np.any(both)) for both in turns)


def down(x: float) -> str:
    """The number as text, rounded down to four decimals."""
    return f"{floor(x * 10**4) / 10**4:.4f}"


def up(x: float) -> str:
    """The number as text, rounded up to four decimals."""
    return f"{ceil(x * 10**4) / 10**4:.4f}" if x < inf else "nothing"


def grown() -> str:
    """The bounds of the extent at the listed contractions, as text."""
    steps = [
        f"{down(low)} or more at {lam}, against {up(before(lam)[1])} at most before" for lam, low in reach().items()
    ]
    return f"its largest exit angle is {'; '.join(steps)}, from {FIRST} to {' and to '.join(STOPS[1:])}"


@judges("egg.attractor_expands")
def attractor_expands(claim: Claim) -> Judgement:
    """The maximal attractor is proved to expand; only samples show that the chaotic attractor reaches as far."""
    seen = asin(crises.extent(SEEN).height)
    return sampled(
        f"proved from {FIRST}, where it holds three attractors or more, to {WINDOW}: of all that is kept between a "
        f"barrier and its mirror image, where it attracts every orbit, {grown()}. That the chaotic attractor, which is "
        "a part of it, reaches as far is sampled; in windows cycles attract",
        f"proved: {expands().reason}; sampled: chaotic orbits have exit angles up to {seen:.4f} at {SEEN}",
        bool(expands()) and seen > before(SEEN)[1],
    )


@judges("egg.single_expands")
def single_expands(claim: Claim) -> Judgement:
    """In a window several cycles attract, so that the attractor is not single; the maximal attractor expands."""
    return Judgement(
        counterexample(
            "in windows between the crises what attracts is not single",
            several(),
            at={shape: Rational(SHAPE), letter: Rational(WINDOW)},
        ),
        "what expands is the largest attractor between a barrier and its mirror image, which attracts every orbit "
        f"there: {grown()}. It need not be single: at {WINDOW} it holds {COUNT} attracting cycles of period {PERIOD}. "
        "That it is single outside of windows, and chaotic, is not part of this",
        expands(),
        f"Not single all along: for alpha = {SHAPE} there are {COUNT} attracting cycles of period {PERIOD} at "
        f"lambda = {WINDOW}. Proved to expand is the set that holds all such attractors.",
    )
