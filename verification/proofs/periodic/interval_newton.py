"""One zero in a box, by the interval Newton operator or Krawczyk's; no others, by a cover of all closed chains.

The interval Newton operator serves long cycles, Krawczyk's wide boxes around short ones. For a box `X` with midpoint
`m`, every zero in `X` lies in `N = m - F'(X)^-1 F(m)`, and when `N` lies in the interior of `X` there is exactly one.
`F'(X)^-1` is applied by elimination in balls, in linear time (see `verification.cycles.chain`); it plays
the part that a preconditioner has in Krawczyk's operator, and contracts at least as well.

Krawczyk's operator [Krawczyk1969] is
`K = m - Y F(m) + (1 - Y F'(X)) (X - m)` with `Y` near the inverse of the middle of `F'(X)`. The
preconditioner is a full matrix, so the cost is cubic in the period; in return the balls of `F'(X)`
may be wide, which elimination along the chain does not forgive. For a ball of contractions the
motion of the cycle with `lam` is kept in one piece, `Y dF/dlam (lam - middle)`, the derivative over all of the ball.

Are there other cycles of a short period? Around each known cycle Krawczyk's operator proves a neighbourhood that
holds no second one. Everything else is covered by boxes in the first bounce and the gaps between bounces; a box goes
when one collision rule, by enclosure or by the mean value theorem, or Krawczyk's operator cannot hold in it, and is
halved otherwise. On a convex table the chord's angle falls as its end moves on, so bounces that lie closer than the
gap at which it exceeds every exit angle of the law need not be looked at: `lam*pi/2` for the paper's, for others a
bound of `|phi|` over all incidence angles and places. A law of the place must be the same after a whole turn of
`theta`, and its cycles have no copies turned with the table. One of arc length that is an integral is not seen to be
the same: in a box that may reach the place where it jumps, the rule on either side must fail by enclosure.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import accumulate
from math import pi
from typing import Any

import numpy as np
from flint import arb, arb_mat
from sympy import Expr, S

from symbolic.expressions.text import constant, load
from symbolic.motion.chords import chord_kernel, law_kernel
from symbolic.tables.curves import is_periodic
from symbolic.tables.law import Law
from symbolic.tables.table import Table
from verification.arithmetic.balls import Box, balls, bisected, working
from verification.cycles.chain import Chain
from verification.cycles.lengths import arc_length
from verification.cycles.newton import System
from verification.cycles.problem import Linearised, Problem
from verification.cycles.search import Catalogue
from verification.cycles.systems import rotations
from verification.maps.first_hit import closes_smoothly, convex


class Status(Enum):
    """What is proved about the zeros in a box."""

    UNIQUE = "exactly one zero in the box"
    EMPTY = "no zero in the box"
    UNKNOWN = "nothing proved; try a smaller box or more bits"


@dataclass(frozen=True)
class Enclosure:
    """A status, and balls that contain every zero of the box that was examined."""

    status: Status
    zero: list[Any]


def interval_newton(system: System, centre: list[arb], radius: arb, bits: int) -> Enclosure:
    """What the interval Newton operator proves about the box of `radius` around exact `centre`.

    >>> from symbolic.tables import ellipse
    >>> from sympy import Rational
    >>> from verification.cycles.problem import Problem
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=Rational(1, 3))
    >>> with working(100):
    ...     near, off = [arb("1.5707963268"), arb("-1.5707963268")], [arb("0.5"), arb("-1.5")]
    >>> [interval_newton(axis, [x.mid() for x in c], arb("1e-9"), 100).status.name for c in (near, off)]
    ['UNIQUE', 'EMPTY']
    """
    with working(bits):
        box = [arb(x, radius) for x in centre]
        try:
            value = system.value(balls(bits), centre)
        except ZeroDivisionError:
            return Enclosure(Status.UNKNOWN, box)
        found = _image(system, value, centre, box, min(bits, slope_bits(len(centre))))
        if found.status is not Status.UNIQUE:
            found = _image(system, value, centre, box, bits)
        return found


def stepped(centre: Sequence[Any], box: Sequence[Any], correction: Callable[[], Sequence[Any]]) -> Enclosure:
    """What an interval Newton step proves of a box, in real or complex balls.

    `correction()` encloses `F'(box)^-1 F(centre)`; a division by 0 there proves nothing.
    """
    try:
        image = [x - d for x, d in zip(centre, correction(), strict=True)]
    except ZeroDivisionError:
        return Enclosure(Status.UNKNOWN, list(box))
    return Enclosure(compared(image, box), image)


def slope_bits(unknowns: int) -> int:
    """Bits that the derivatives need: `F` at the midpoint is tiny, so theirs need not grow with the digits.

    >>> slope_bits(3)
    144
    """
    return 128 + 8 * unknowns.bit_length()


def _image(system: System, value: list[arb], centre: list[arb], box: list[arb], bits: int) -> Enclosure:
    def correction() -> list[arb]:
        with working(bits):
            return system.solved(balls(bits), box, value)

    return stepped(centre, box, correction)


def compared(image: Sequence[Any], box: Sequence[Any]) -> Status:
    """The three answers to: does the image lie inside the box?"""
    if not all(y.is_finite() for y in image):
        return Status.UNKNOWN
    if all(x.contains_interior(y) for x, y in zip(box, image, strict=True)):
        return Status.UNIQUE
    if any(not x.overlaps(y) for x, y in zip(box, image, strict=True)):
        return Status.EMPTY
    return Status.UNKNOWN


def krawczyk(problem: Problem, centre: list[arb], radii: list[float], bits: int) -> Enclosure:
    """What Krawczyk's operator proves about the cycles in a box; `lam` may be a ball.

    >>> from symbolic.tables import ellipse
    >>> axis = Problem(ellipse.at(a=2), (0, 0), lam=arb("0.5", "0.01"))
    >>> krawczyk(axis, [arb("1.57"), arb("-1.57")], [0.01, 0.01], 64).status.name
    'UNIQUE'
    """
    with working(bits):
        box = [arb(x, r) for x, r in zip(centre, radii, strict=True)]
        try:
            lam = problem.at(balls(bits), centre)["lam"]
            at = Linearised(replace(problem, lam=lam.mid()), balls(bits), centre).terms
            by_lam = Linearised(problem, balls(bits), centre).terms.by["lam"]
            slope = dense(Linearised(problem, balls(bits), box).plain)
            near = arb_mat([[x.mid() for x in row] for row in slope.tolist()]).inv()
        except ZeroDivisionError:
            return Enclosure(Status.UNKNOWN, box)
        inverse = arb_mat([[x.mid() for x in row] for row in near.tolist()])
        step = inverse * arb_mat([[x] for x in at.value])
        drift = inverse * arb_mat([[x] for x in by_lam])
        one = arb_mat([[int(i == j) for j in range(len(centre))] for i in range(len(centre))])
        spread = (one - inverse * slope) * arb_mat([[x - m] for x, m in zip(box, centre, strict=True)])
        image = [m - step[i, 0] - drift[i, 0] * (lam - lam.mid()) + spread[i, 0] for i, m in enumerate(centre)]
        return Enclosure(compared(image, box), image)


def dense(chain: Chain) -> arb_mat:
    """The matrix of a chain."""
    n = len(chain.diagonal)
    rows = [[arb(0)] * n for _ in range(n)]
    for i, (lower, diagonal, upper) in enumerate(chain.rows):
        rows[i][i] += diagonal
        rows[i][i - 1] += lower * (chain.sign if i == 0 else 1)
        rows[i][(i + 1) % n] += upper * (chain.sign if i == n - 1 else 1)
    return arb_mat(rows)


BITS = 64
SMALLEST = 2.0**-30
ANGLES = 512  # pieces of the incidence angles
Tick = Callable[[str], None]
Reflection = Callable[[arb, arb], list[tuple[arb, arb, arb]]]


@dataclass(frozen=True)
class Completeness:
    """`complete`: there is no cycle of this period but the known ones; None when the budget ended first."""

    period: int
    complete: bool | None
    boxes: int
    known: int


def no_others(
    catalogue: Catalogue, lam: Expr, n: int, budget: int = 40_000, tick: Tick = lambda said: None
) -> Completeness:
    """Is the catalogue complete for period `n`? For convex tables of one smooth component.

    >>> from sympy import Rational
    >>> from symbolic.tables import ellipse
    >>> from verification.cycles.search import all_cycles
    >>> found = all_cycles(ellipse.at(a="3/2"), Rational(1, 4), 2).catalogue
    >>> no_others(found, Rational(1, 4), 2).complete
    True
    """
    table, known = catalogue.table, catalogue.count(n)
    if not closes_smoothly(table) or convex(table) is not True:
        return Completeness(n, None, 0, known)
    law = catalogue.law.on(table)
    if law.placed and not (law.measured or is_periodic(law.phi)):
        return Completeness(n, None, 0, known)
    with working(BITS):
        angle = load(chord_kernel(table, 0, 0, 1), balls(BITS))
        contraction = load(constant(lam), balls(BITS))()[0] + arb(0)
        reflected = reflection(law, contraction, table)
        gap = least_gap(angle, contraction * arb.pi() / 2 if law.uniform else steepest(law, reflected))
        if gap == 0:
            return Completeness(n, None, 0, known)
        problem = Problem(table, (0,) * n, lam=contraction, law=law)
        holds = neighbourhoods(catalogue, problem)
        cover = Cover(problem, angle, reflected, gap, holds)
        boxes, turned = 0, 1 if law.placed else rotations(table)
        for turns in range(1, n):
            queue = [start(turned, n, gap)]
            while queue:
                box = queue.pop()
                boxes += 1
                if boxes % 500 == 0:
                    tick(f"{boxes} boxes")
                if boxes > budget:
                    return Completeness(n, None, boxes, known)
                if cover.settled(box, turns):
                    continue
                if max(half for _, half in box) < SMALLEST:
                    return Completeness(n, None, boxes, known)
                queue += bisected(box)
    return Completeness(n, True, boxes, known)


def start(turn: int, n: int, gap: float) -> Box:
    """All chains: the first bounce up to a rotation of the table, every gap from the least to the largest.

    Middles and widths have so few binary digits that halving them rounds nothing: boxes that were a rounding apart
    would leave out a cycle between them, as one along a symmetry axis whose gap is pi.
    """
    reach, middle = np.ceil(2**10 * pi / turn) / 2**10, 3.125
    half = np.ceil(2**10 * (2 * pi - gap - middle)) / 2**10
    return ((0.0, float(reach)), *(((middle, float(half)),) * (n - 1)))


def reflection(law: Law, contraction: arb, table: Table) -> Reflection:
    """The exit angle at an incidence angle and a place, `-d phi/d eta` and `d phi/d theta`, in balls; on each side
    of where a law of arc length jumps, if the ball of places may reach there.
    """
    if law.uniform:
        return lambda eta, theta: [(-contraction * eta, contraction, arb(0))]
    made = law_kernel(law, 1, table.components[0] if law.measured else None)
    places = [made.results.index(name) for name in ("phi", "phi_eta", "phi_theta")]
    phi, length = load(made, balls(BITS)), arc_length(table) if law.measured else None

    def reflected(eta: arb, theta: arb) -> list[tuple[arb, arb, arb]]:
        sides = [[side, length.of(side)] for side in parted(theta)] if length else [[theta]]
        found = [[phi(eta, contraction, *side)[i] + arb(0) for i in places] for side in sides]
        return [(value, -slope, drift) for value, slope, drift in found]

    return reflected


def parted(theta: arb) -> list[arb]:
    """A ball of parameters, its middle between -pi and pi; and the same from the other end, if it may reach over one.

    >>> [len(parted(arb(x, "0.1"))) for x in (0, 3, 3.1, 3.2, 6.3)]
    [1, 1, 2, 2, 1]
    """
    half = arb.pi()
    theta = theta - 2 * half * round(float(theta.mid()) / (2 * pi))
    beyond = theta - 2 * half if theta.mid() > 0 else theta + 2 * half
    return [theta] if theta > -half and theta < half else [theta, beyond]


def steepest(law: Law, reflected: Reflection) -> arb:
    """A bound of `|phi|` over all incidence angles, and all places of a closed curve, each in pieces."""
    quarter, turns = arb.pi() / 2, 64 if law.placed else 1
    angles = [arb(2 * k + 1 - ANGLES, 1) / ANGLES * quarter for k in range(ANGLES)]
    places = [arb(2 * k + 1 - turns, 1) / turns * arb.pi() for k in range(turns)]
    sizes = [abs(exit).upper() for theta in places for eta in angles for exit, _, _ in reflected(eta, theta)]
    return max(sizes) if all(size.is_finite() for size in sizes) else quarter


def on_one_side(law: Law, box: Sequence[arb]) -> bool:
    """Does no ball reach over the place where a law of arc length jumps? Beyond, the equations are of another law."""
    return not law.measured or all(len(parted(theta)) == 1 for theta in box)


def stays_below(law: Law, lam: Any, table: Table) -> bool:
    """Is `|phi|` proved to stay below `pi/2` by a margin?"""
    with working(BITS):
        contraction = load(constant(S(lam)), balls(BITS))()[0] + arb(0)
        return bool(steepest(law, reflection(law, contraction, table)) < arb.pi() / 2)


def least_gap(angle: Any, largest: arb) -> float:
    """A gap at and below which a chord leaves more steeply than `largest`, whichever way it goes; 0 if none."""
    pieces, gap = 256, 1.5
    starts = [arb(2 * k + 1, 1) * arb.pi() / pieces for k in range(pieces)]
    while gap > 0:
        if all(angle(x, x + arb(gap))[0] > largest and angle(x, x - arb(gap))[0] < -largest for x in starts):
            return gap
        gap -= 1 / 16
    return 0.0


def neighbourhoods(catalogue: Catalogue, problem: Problem) -> list[tuple[list[float], float]]:
    """Centres and radii of boxes that hold one cycle each, for all bounces a known cycle can be begun with."""
    n, found = problem.period, []
    for cycle in catalogue.of(n):
        theta = np.unwrap(np.tile(cycle.theta, n // cycle.period))
        radius = 0.2
        while radius > 1e-7:
            centre = [arb(float(x)) for x in theta]
            if (
                on_one_side(problem.law, [arb(x, radius) for x in centre])
                and krawczyk(problem, centre, [radius] * n, BITS).status is Status.UNIQUE
            ):
                break
            radius /= 1.5
        else:
            continue
        found += [([float(x) for x in np.roll(theta, -k)], radius) for k in range(cycle.period)]
    return found


@dataclass(frozen=True)
class Cover:
    """What settles a box."""

    problem: Problem
    angle: Any
    reflected: Reflection
    gap: float
    holds: list[tuple[list[float], float]]

    def settled(self, box: Box, turns: int) -> bool:
        """True when the box holds no cycle, or lies in the neighbourhood of a known one."""
        wide = [arb(m, r) for m, r in box]
        last = 2 * turns * arb.pi() - sum(wide[1:], arb(0))
        if last < self.gap or last > 2 * arb.pi() - self.gap or any(d > wide[1] for d in [*wide[2:], last]):
            return True  # the first gap may be taken for the largest
        theta = list(accumulate(wide))
        exact = list(accumulate(arb(m) for m, _ in box))
        if not all(x.is_exact() for x in exact):
            return False
        if self._known([float(x) for x in exact], [float(t.rad()) for t in theta]):
            return True
        return self._impossible(box, exact, theta)

    def _known(self, middle: list[float], radii: list[float]) -> bool:
        for centre, radius in self.holds:
            if all(
                abs((m - c + pi) % (2 * pi) - pi) + r < radius - 1e-9
                for m, c, r in zip(middle, centre, radii, strict=True)
            ):
                return True
        return False

    def _impossible(self, box: Box, exact: list[arb], theta: list[arb]) -> bool:
        n = len(box)
        for i in range(n):
            here, before, after = theta[i], theta[i - 1], theta[(i + 1) % n]
            out, into = self.angle(here, after), self.angle(here, before)
            sides = self.reflected(into[0], here)
            values = [out[0] - exit for exit, _, _ in sides]
            if not all(value.is_finite() for value in values):
                return False
            if not any(value.contains(0) for value in values):
                return True
            if len(sides) > 1:
                continue  # where the law jumps it has no derivative
            (_, sigma, drift), back = sides[0], self.angle(exact[i], exact[i - 1])[0]
            at = self.angle(exact[i], exact[(i + 1) % n])[0] - self.reflected(back, exact[i])[0][0]
            slope = {i: out[1] + sigma * into[1] - drift}
            for j, s in ((i - 1) % n, sigma * into[2]), ((i + 1) % n, out[2]):
                slope[j] = slope.get(j, arb(0)) + s
            by_box = _by_gaps(slope, n)
            if not (at + sum((s * arb(0, box[k][1]) for k, s in enumerate(by_box)), arb(0))).contains(0):
                return True
        if max(half for _, half in box) > 0.15 or not on_one_side(self.problem.law, theta):
            return False
        return krawczyk(self.problem, exact, [float(t.rad()) for t in theta], BITS).status is Status.EMPTY


def _by_gaps(slope: dict[int, arb], n: int) -> list[arb]:
    """Derivatives by the bounces as derivatives by the first bounce and the gaps."""
    return [sum((s for j, s in slope.items() if j >= k), arb(0)) for k in range(n)]


def proofs(
    catalogue: Catalogue, lam: Expr, highest: int, budget: int, tick: Tick = lambda said: None
) -> Iterator[Completeness]:
    """The periods from 2 up to `highest`, until one stays open."""
    for n in range(2, highest + 1):
        found = no_others(catalogue, lam, n, budget, tick)
        yield found
        if found.complete is not True:
            return
