"""Claims on how the egg's attractor expands with the contraction, by bounds for its extent in exit angle. Section 6.7.

Between a barrier and its mirror image a largest set is kept that attracts all orbits there and holds every attractor
and every cycle. Its largest exit angle is bounded from above for all contractions of a range by one barrier. At single
contractions it is bounded from below, by cycles between the barriers of that contraction, unstable or attracting. At
each of these it is larger than at every contraction of a range before. That the chaotic attractor reaches as far as all
that is kept is sampled: it may be a part.

Nor is what attracts there single at each contraction between the crises, at 0.4434 and 0.6621: in a window several
cycles attract, all of them between the barriers of that contraction. (In some windows the cycles lie beyond the
barriers, those of period 9 at 0.493 for one; these are attractors beside what is kept, and say nothing of it.)
"""

from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise
from math import asin, ceil, floor, inf

import numpy as np
from numpy.typing import NDArray
from sympy import Rational

from symbolic.expressions.signs import Finding
from symbolic.tables.scene import Scene
from symbolic.tables.table import alpha as shape
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import balls, working
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled
from verification.paper.egg import crises
from verification.paper.egg.barriers import barrier, bounces
from verification.paper.judges.attractors import SHAPE, cycles, egg
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.branch import exact
from verification.proofs.global_dynamics.crisis import boxed
from verification.proofs.manifolds.enclosed import TooWideError, complex_balls, enclosed_cycle
from verification.proofs.manifolds.known import CONTACTS, table
from verification.proofs.manifolds.saddle import padded

FIRST = "0.43"
STOPS = (FIRST, "0.5", "0.55")  # one barrier serves all from each to the next
SADDLE, NAME = "0.506", "window-end-9"  # a contraction, and the contact to which its unstable cycle leads
WINDOW, PERIOD, COUNT, STARTS = "0.641", 18, 3, 40  # a contraction, and how many cycles of which period attract
SEEN, BITS = "0.66", 160  # where chaotic orbits are sampled
REST = 1e-12  # more than the rounding of a turn
Array = NDArray[np.float64]


@cache
def saddle() -> Boxes | None:
    """The bounces of the unstable cycle, where it is proved and lies between the barriers of its contraction."""
    orbit, map = CONTACTS[NAME].unstable, table(Rational(SHAPE))
    with working(BITS):
        try:
            points = enclosed_cycle(orbit, map.over(complex_balls(BITS)), exact(Fraction(SADDLE)))
        except TooWideError:
            return None
        real = map.over(balls(BITS))
        ring = padded(orbit, real, [point.real for point in points])[1:]
        boxes = boxed([(here, real.angle(here, there)[0]) for here, there in pairwise(ring)])
    return boxes if boxes and np.all(barrier(SADDLE).between(boxes)) else None


@cache
def kept() -> tuple[Boxes, ...]:
    """The bounces of the cycles that are proved to attract in the window, and to lie between its barriers."""
    found = [bounces(WINDOW, cycle.points) for cycle in cycles(egg(WINDOW, STARTS), PERIOD)]
    return tuple(boxes for boxes in found if boxes and np.all(barrier(WINDOW).between(boxes)))


def reach() -> dict[str, float]:
    """What is kept reaches as far, at contractions in order; 0 where nothing is proved."""
    found = {SADDLE: [boxes for boxes in (saddle(),) if boxes], WINDOW: kept()}
    return {lam: max(map(height, some), default=0.0) for lam, some in found.items()}


def height(boxes: Boxes) -> float:
    """Points of one of the boxes have exit angles at least as large."""
    return float(np.max(np.maximum(boxes.y[0], -boxes.y[1])))


@cache
def ceiling(low: str, high: str) -> float:
    """A bound for the extent at every contraction of a range; infinite where none is proved."""
    found = Barrier(Scene("egg", alpha=SHAPE), (Fraction(low), Fraction(high)))
    return inf if found.heights is None or not found.mirrored else float(np.max(found.heights))


def before(lam: str) -> tuple[str, float]:
    """Up to which contraction of the list below this one a bound serves, from `FIRST` on, and the bound."""
    ranges = [(low, high) for low, high in pairwise(STOPS) if Fraction(high) < Fraction(lam)]
    return ranges[-1][1], max(ceiling(low, high) for low, high in ranges)


@cache
def expands() -> Finding:
    """At each contraction of the list the extent is larger than at all those from `FIRST` to one before."""
    steps = []
    for lam, low in reach().items():
        stop, most = before(lam)
        said = f"{down(low)} or more at {lam}, at most {up(most)} from {FIRST} to {stop}"
        steps.append(answer(low > most or None, said))
    return by("the largest exit angle of what is kept between a barrier and its mirror image", *steps)


@cache
def several() -> Finding:
    """In a window different cycles attract, and all of them are kept."""
    return answer(
        len(kept()) == COUNT and not any(meet(one, other) for one, other in combinations(kept(), 2)),
        f"{COUNT} cycles of period {PERIOD} are proved to attract at lam = {WINDOW}, without a common bounce; all lie "
        "between a barrier and its mirror image",
    )


def meet(one: Boxes, other: Boxes) -> bool:
    """May a box of one have a point in common with a box of the other, whole turns apart?

    >>> place = Boxes(np.zeros(1, dtype=int), (np.array([3.0]), np.array([3.5])), (np.zeros(1), np.ones(1)))
    >>> turned = place._replace(x=(place.x[0] - 2 * np.pi, place.x[1] - 2 * np.pi))
    >>> meet(place, turned), meet(place, place._replace(y=(np.array([1.5]), np.array([2.0]))))
    (True, False)
    """

    def near(here: tuple[Array, Array], there: tuple[Array, Array], shift: float) -> NDArray[np.bool_]:
        low, high = (end[:, None] + shift for end in here)
        return (low <= there[1] + REST) & (there[0] - REST <= high)

    turns = (near(one.x, other.x, 2 * np.pi * k) & near(one.y, other.y, 0.0) for k in (-1, 0, 1))
    return any(bool(np.any(both)) for both in turns)


def down(x: float) -> str:
    """Four decimals, none above the number."""
    return f"{floor(x * 10**4) / 10**4:.4f}"


def up(x: float) -> str:
    """Four decimals, none below the number."""
    return f"{ceil(x * 10**4) / 10**4:.4f}" if x < inf else "nothing"


def grown() -> str:
    """The bounds in words."""
    steps = [
        f"{down(low)} or more at {lam}, against {up(before(lam)[1])} at most before" for lam, low in reach().items()
    ]
    return f"its largest exit angle is {'; '.join(steps)}, from {FIRST} to {' and to '.join(STOPS[1:])}"


@judges("egg.attractor_expands")
def attractor_expands(claim: Claim) -> Judgement:
    """Before the three regions have merged, and after: what is kept holds all of them."""
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
    """Not single in a window, where several cycles attract in the region kept; what is kept as a whole expands."""
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
