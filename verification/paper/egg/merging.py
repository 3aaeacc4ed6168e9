"""Judges of claims on the egg's three attractors, one around each diameter, and on their merging crisis. Section 6.7.

A set of boxes around an end of one diameter grows until it is mapped into itself. Up to `lam = 0.442` it is disjoint
from its copies rotated by thirds; at 0.44345 an orbit goes from one diameter to another. The contractions at which such
a region exists (it holds all starts near an end of one diameter and is disjoint from its copies) form an open set,
so between 0.442 and 0.44345 there is a smallest contraction at which no such region exists. In the same interval, at
0.4434352, a tangency of manifolds is proved.
"""

from fractions import Fraction
from functools import cache, reduce
from itertools import pairwise

import numpy as np
from flint import acb, arb
from sympy import Rational

from numeric import PinballMap
from numeric.backends import elementary
from symbolic.cycles.cycle import egg_diameter, is_double_normal
from symbolic.expressions.signs import SignFinding
from symbolic.tables.scene import Scene
from symbolic.tables.table import lam as letter
from verification.arithmetic.balls import balls, fraction_ball, working
from verification.maps.enclosed import EnclosedMap
from verification.paper.claims.claim import Claim, Judgement
from verification.paper.claims.judges import answer, by, counterexample, judges, sampled, shown
from verification.paper.egg.barriers import bounces
from verification.paper.judges.attractors import SHAPE, chaotic, cycles, egg, proved_at, strange, vertices
from verification.proofs.global_dynamics.crisis import bounding_boxes
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.manifolds.enclosed import complex_balls, enclosed_cycle
from verification.proofs.manifolds.known import CONTACTS, table
from verification.rigorous.absorbing import kept_apart
from verification.rigorous.boxes import Boxes

Range = tuple[str, str]
EXACT_SHAPE = Rational(2, 25)
PARTS = (  # ranges of contractions, and a grid for each
    ("0.42", "0.43", (3072, 1024, 2)),
    ("0.43", "0.435", (6144, 4096, 2)),
    ("0.435", "0.438", (8448, 5632, 2)),
    ("0.438", "0.44", (12288, 8192, 2)),
)
LAST, FINEST = "0.442", (24576, 16384, 2)  # the last contraction at which the regions are proved disjoint, and its grid
MERGED, START = "0.44345", (-0.001490727851852957, -0.0035529044873255713)  # the start of an orbit to another diameter
CLOSE, CUT = "0.02", 40  # half the sides of a box around an end of a diameter, which is cut into CUT by CUT parts
FAR = 0.8  # the largest distance from the ends of a diameter, in radians
ALONG = ("0.42", 20), ("0.42906", 28)  # two windows, and the period of the attracting cycles in every region
BETWEEN = ("0.43", "0.55", "0.65")  # contractions, each between two of the windows or above them
BEYOND = ("0.493", 9, "window-merging-9"), ("0.641", 18, "boundary")  # further windows, and the tangencies after them
WINDOW, PERIOD = "0.4201", 20  # where two cycles attract in each region
BITS, LONG, MOST_BOUNCES, STARTS = 160, 640, 200, 40


def about(theta: float = 0.0) -> Boxes:
    """Boxes that cover all phase points within `CLOSE` of `(theta, 0)` in both coordinates."""
    size = float(CLOSE) * (1 + 1e-12)
    return Boxes.one(*((at - size, at + size) for at in (theta, 0.0))).parts(CUT, CUT)[0]


def together(first: Boxes, more: Boxes) -> Boxes:
    """The boxes of both arrays, as one array."""
    ends = [(np.append(a[0], b[0]), np.append(a[1], b[1])) for a, b in zip(first[1:], more[1:], strict=True)]
    return Boxes(np.append(first.chart, more.chart), *ends)


def saddle_point() -> Boxes | None:
    """A box around a point of the saddle whose tangency gives strange attractors; None if this is not proved."""
    around, orbit = strange(SHAPE, "interior-crisis-1")[1], CONTACTS["interior-crisis-1"].unstable
    with working(BITS):
        plane = table(EXACT_SHAPE).over(complex_balls(BITS))
        before, here = (x.real for x in enclosed_cycle(orbit, plane, acb(around))[:2])
        return bounding_boxes([(before, table(EXACT_SHAPE).over(balls(BITS)).angle(before, here)[0])])


def in_window(lam: str, period: int) -> Boxes | None:
    """Boxes around a cycle that attracts near the first diameter; None if no such cycle is proved."""
    near = [a for a in cycles(egg(lam, STARTS), period) if vertices(a) == {0}]
    return bounces(lam, near[0].points) if near else None


@cache
def region(lam: Range, grid: tuple[int, int, int], more: bool = False) -> SignFinding:
    """The finding of a trapping region around one diameter, disjoint from its rotated copies, for a range of `lam`.

    The region contains all starts near the end at `theta = 0`; with `more` also the saddle of a tangency and
    attracting cycles in two windows.
    """
    places = [saddle_point(), *(in_window(*one) for one in ALONG)] if more else []
    known = [place for place in places if place is not None]
    start = reduce(together, known, about()) if len(known) == len(places) else None
    kept = kept_apart(PinballImages(Scene("egg", alpha=SHAPE), (Fraction(lam[0]), Fraction(lam[1]))), grid, start)
    near = kept is not None and bool(np.all(np.abs(elementary.arcsin(np.sin(kept))) < FAR))
    return answer(near or None, f"{grid[0]} by {grid[1]} cells for {lam[0]} <= lam <= {lam[1]}")


@cache
def apart() -> SignFinding:
    """The finding that, from 0.42 to 0.44, three disjoint regions around the diameters are trapping."""
    low, high = PARTS[0][0], PARTS[-1][1]
    return by(
        f"for {low} <= lam <= {high} the boxes that grow from those within {CLOSE} of an end of a diameter "
        f"are a trapping region, within {FAR} radians of that diameter, and apart from its copies turned by thirds",
        *(region((a, b), cells) for a, b, cells in PARTS),
        shown("the diameter is normal to the boundary at both ends", is_double_normal(egg_diameter())),
    )


@judges("egg.three_attractors")
def three(claim: Claim) -> Judgement:
    """At each contraction there are at least three attractors; in a window, two cycles attract near each diameter."""
    near = [sorted(vertices(a)) for a in cycles(egg(WINDOW), PERIOD)]
    six = by(
        f"six cycles of period {PERIOD} attract at lam = {WINDOW}, in three regions",
        proved_at(WINDOW, PERIOD),
        answer(sorted(near) == [[k] for k in (0, 0, 1, 1, 2, 2)] or None, "two near each diameter"),
    )
    return Judgement(
        counterexample(
            "in windows of the range there are more, and they are cycles", six, at={letter: Rational(WINDOW)}
        ),
        "three regions without a common point, one about each diameter, are trapping for every lam from 0.42 to 0.44 "
        "(and at 0.442, see egg.merging_crisis): so there are three attractors or more, apart, near one diameter each; "
        "strange ones for a set of lam of positive measure (egg.windows_above). That there is only one in each is not "
        "so in windows",
        by("boxes", apart()),
        "At alpha = 0.08 each diameter has its own region of attractors, apart from the others, for every lambda from "
        f"0.42 to 0.44; a region may hold more than one attractor: at lambda = {WINDOW} two cycles of period {PERIOD} "
        "attract in each.",
    )


@cache
def alternates() -> SignFinding:
    """The finding that cycles and strange attractors alternate, as `lam` grows, in one trapping region."""
    low, high, grid = PARTS[0]
    chaos, tangency = strange(SHAPE, "interior-crisis-1")
    ends = [ball(ALONG[0][0]), tangency, ball(ALONG[1][0]), ball(high)]
    windows = " and ".join(f"a cycle of period {period} that attracts at {x}" for x, period in ALONG)
    return by(
        f"for {low} <= lam <= {high} one region about a diameter, the same for all, is trapping and apart from its "
        f"copies turned by thirds; it holds starts near an end of the diameter, {windows}, and a saddle",
        region((low, high), grid, True),
        answer(all(a < b for a, b in pairwise(ends)) or None, "at whose tangency, in between, strange attractors are"),
        chaos,
    )


@judges("egg.windows_above")
def windows(claim: Claim) -> Judgement:
    """Attracting cycles and strange attractors are proved to alternate; that these are the observed ones is sampled."""
    (first, one), (second, other) = ALONG
    calm = [proved_at(x, period, starts=STARTS) for x, period, _ in BEYOND]
    wild = [strange(SHAPE, kind) for *_, kind in BEYOND]
    places = [(ball(x), value) for (x, *_), (_, value) in zip(BEYOND, wild, strict=True)]
    ends = [ball(second), *(end for pair in places for end in pair)]
    order = answer(all(a < b for a, b in pairwise(ends)) or None, "each of the contractions is above the one before")
    proof = by("windows and chaos in turn", alternates(), order, *calm, *(finding for finding, _ in wild))
    rates = {x: max((a.nu_plus for a in chaotic(egg(x, STARTS))), default=-1.0) for x in BETWEEN}
    said = ", ".join(f"{nu:.2f} at {x}" for x, nu in rates.items())
    return sampled(
        f"in one trapping region about a diameter, the same from 0.42 to 0.43: at {first} cycles of period {one} "
        "attract, next to 0.42842 there are strange attractors for a set of contractions of positive measure, at "
        f"{second} a cycle of period {other} attracts; at 0.493 and 0.641 cycles of period 9 and 18 attract, and "
        "strange attractors, in that sense, are next to 0.50453 and 0.66214: proved. That these are the attractor "
        "seen, and not tiny ones, is sampled. Such are found below 0.42 too (egg.chaotic_interval)",
        f"proved: {proof.reason}; sampled, between the windows: nu_+ of random starts is {said}",
        bool(proof) and min(rates.values()) > 0.01,
    )


def goes_over(lam: str, start: tuple[float, float]) -> bool:
    """True if an orbit from near `(0, 0)` is proved, in balls, to come near the rotated image of its start."""
    map = EnclosedMap(PinballMap(Scene("egg", alpha=SHAPE), lam=float(lam)), Fraction(lam), LONG)
    if not max(abs(x) for x in start) < float(CLOSE):
        return False
    for here in map.orbit(map.start(arb(start[0]), arb(start[1])), MOST_BOUNCES):
        with working(LONG):
            for turn in (1, 2):
                away = here.theta - 2 * arb.pi() * turn / 3
                away -= 2 * arb.pi() * round(float(away.mid()) / (2 * np.pi))
                if abs(away) < ball(CLOSE) and abs(here.phi) < ball(CLOSE):
                    return True
    return False


@cache
def merges() -> SignFinding:
    """The finding that the three regions exist at one contraction but not at a larger one; a tangency is in between."""
    chaos, tangency = strange(SHAPE, "merging")
    inside = bool(ball(LAST) < tangency) and bool(tangency < ball(MERGED))
    return by(
        f"a first contraction above {LAST}, and not above {MERGED}, has no trapping region that holds all starts "
        f"within {CLOSE} of an end of one diameter, apart from its copies turned by thirds",
        region((LAST, LAST), FINEST),
        answer(
            goes_over(MERGED, START) or None,
            f"at {MERGED} an orbit goes from within {CLOSE} of that end to within {CLOSE} of a turned copy",
        ),
        answer(inside or None, "the manifolds of a saddle touch in between"),
        chaos,
    )


@judges("egg.parts_join")
def parts_join(claim: Claim) -> Judgement:
    """The regions around the diameters are disjoint; at a larger contraction, an orbit goes from one to another."""
    tangency = strange(SHAPE, "merging")[1]
    return Judgement(
        by("three regions are apart, and no longer", merges()),
        f"three regions, each about one diameter, are trapping and apart at {LAST}, and at {MERGED} an orbit goes from "
        f"one diameter to another; in between, at {tangency.str(10, radius=False)}, manifolds of a cycle of period 8 "
        "touch. How many attractors each region holds is not part of this",
    )


@judges("egg.merging_crisis")
def merging_crisis(claim: Claim) -> Judgement:
    """It is proved that the three regions are lost; only samples show that this is a crisis of one attractor."""
    found, (_, tangency) = merges(), strange(SHAPE, "merging")
    gap = Fraction(str(claim.printed)) - Fraction(tangency.str(9, radius=False))
    counts = [len(chaotic(egg(x))) for x in ("0.442", "0.445")]
    return sampled(
        f"{tangency.str(10, radius=False)}: manifolds of a cycle of period 8 touch there, and the three regions are "
        f"lost between {LAST} and {MERGED}, proved; that each holds one chaotic attractor, and one holds all after, is "
        "sampled. It is not the first crisis above 0.42: next to 0.4284192 an attractor suddenly widens inside its "
        "region, where manifolds touch as well",
        f"proved: {found.reason}; {claim.printed} differs by {float(gap):.1e}; sampled: {counts[0]} chaotic attractors "
        f"of {STARTS} random starts at 0.442, {counts[1]} at 0.445",
        bool(found) and abs(gap) < Fraction(1, 10**4) and counts == [3, 1],
    )


def ball(decimal: str) -> arb:
    """A decimal as a ball."""
    with working(BITS):
        return fraction_ball(Fraction(decimal))
