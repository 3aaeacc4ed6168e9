"""Enclosures of the images of boxes under a pinball map: rectangles that hold the image of every point of a box.

In a convex table the line of a flight cuts the boundary into two arcs. Counterclockwise from the start, boundary points
before the landing lie to the right of the line, and those after the landing to the left. So two points, guessed in
float64, enclose the landings of a whole box once one is proved to lie to the right of every flight and the other to the
left, by the signs of cross products; no equation is solved. Within the arc between the two points the mean-value
theorem gives a closer enclosure. The exit angle depends only on the angles `tau` of the tangents,

    phi1 = -lam*eta1,    eta1 = phi0 + tau(theta1) - tau(theta0) - pi,

or `phi1` is another function of `eta1`, `lam` and `theta1`, of period `2*pi` in `theta1` on a closed curve.

Where the arc holds a join, the image is given for both sides of it. Paper: section 2.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from numeric import PinballMap
from numeric.lowering.lower import lower_law
from numeric.lowering.program import Program
from symbolic.tables.curves import is_periodic
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import (
    Array,
    ArrayOps,
    BallArray,
    Compiled,
    Indices,
    common_part,
    exactly,
    hull,
    spread,
)
from verification.cycles.systems import reflected
from verification.maps.first_hit import closes_smoothly, convex, tangents
from verification.proofs.global_dynamics.flights import Flights, LandingArcs, Slopes
from verification.rigorous.boxes import Boxes, Chart, Images, Row, collected
from verification.rigorous.certificate import RANGE, entry
from verification.rigorous.theorem import Theorem

STEPS, PLACES = 1 << 12, 1 << 6  # pieces of the incidence angles, and of each component for a law of the place
QUARTER = 1.5707963267948966  # below pi/2
SCENE = entry(lambda given, _: Scene.of(given), lambda scene: scene.document)  # an entry of certificates


@lru_cache(maxsize=16)
def compiled_curve(program: Program) -> Compiled:
    """A boundary curve as a function of balls, compiled once for all maps of a table."""
    return Compiled(lambda *values: program(ArrayOps(), *values))


class PinballImages:
    """The map of a scene whose table is proved convex, for every contraction from `lam[0]` to `lam[1]`.

    Phase space is the strip `|phi| <= top`, in which every particle is after one bounce: `top` is `lam*pi/2` for the
    paper's law, and a bound computed in balls for others. A landing on a join has no next bounce, so its images are
    those from both sides.

    >>> egg = PinballImages(Scene("egg", alpha="0.08", lam="1/2"))
    >>> egg.label
    'egg, alpha = 2/25, lam = 1/2'
    """

    def __init__(self, scene: Scene, lam: tuple[Fraction, Fraction] | None = None) -> None:
        self.scene = scene
        self.range = low, high = lam or (Fraction(str(scene.lam)),) * 2
        if not 0 <= low <= high < 1 or high == 0:
            raise ValueError(f"lam = {low}:{high} is no range; accepted: 0 <= LOW <= HIGH, with 0 < HIGH < 1")
        self.map = PinballMap(scene, lam=high)
        if convex(self.map.table) is not True:
            raise ValueError(f"{scene.name}: the table is not proved convex; accepted: convex tables")
        self.ops = ArrayOps()
        self.shape = [exactly(Fraction(x)) for x in self.map.exact_shape]
        self.closed = len(self.map.ir.parts) == 1
        if self.closed and not closes_smoothly(self.map.table):
            raise ValueError(f"{scene.name}: the boundary is not proved smooth where it closes; write it in components")
        self.ends = [tuple(part.ends(self.ops, *self.shape)) for part in self.map.ir.parts]
        if (law := scene.law.on(self.map.table)).measured or law.along is not None:
            wanted = "formulas without s, or with s on one closed curve whose arc length has a formula"
            raise ValueError(f"law = {law}: the arc length s cannot be enclosed over a box; accepted: {wanted}")
        self.law, self.placed = None if law.uniform else lower_law(law, lambda: self.map.table), law.placed
        if self.placed and self.closed and not is_periodic(law.phi):
            raise ValueError(f"law = {law}: it is not proved to have the period 2*pi in theta, which boxes need")
        self.contract()

    def contract(self) -> None:
        """Sets the attributes that depend on the range of contractions."""
        self.lam = hull(exactly(self.range[0]).lower(), exactly(self.range[1]).upper())
        self.top = float((self.lam * self.ops.pi / 2).upper()) if self.law is None else self._steepest()

    def _steepest(self) -> float:
        """An upper bound below `pi/2` of the law's exit angles, over all incidence angles and contractions."""
        law = self.scene.law
        law.check(self.range, *law.places(self.map.table))
        size = max(float(np.max(self.exit(*some).magnitude())) for some in self.incidences())
        if size < QUARTER:
            return size
        raise ValueError(f"law = {law}: |phi| is not proved to stay below pi/2 by a margin, as boxes need it")

    def incidences(self) -> Iterator[tuple[BallArray, BallArray]]:
        """All incidence angles, in pieces, each with the pieces of the boundary on which the law may differ."""
        angles = np.linspace(-1, 1, STEPS + 1) * float((self.ops.pi / 2).upper())
        ends, cuts = (self.ends, PLACES) if self.placed else (self.ends[:1], 1)
        for start, end in ends:
            for near, far in pairwise(np.linspace(float(start.lower()), float(end.upper()), cuts + 1)):
                yield hull(angles[:-1], angles[1:]), hull(near, far)

    def exit(self, eta: BallArray, theta: BallArray) -> BallArray:
        """The exit angles, by the mean-value theorem about the midpoints of incidence angles and landing parameters."""
        if self.law is None:
            return -(self.lam * eta)
        with np.errstate(all="ignore"):
            middle, place = BallArray(np.asarray(eta.m)), BallArray(np.asarray(theta.m) if self.placed else 0.0)
            at = spread(self.law.exit(self.ops, middle, self.lam, place)[0], middle.m)
            slope, drift = self.slopes(eta, theta)
            found = at - slope * (eta - middle)
            return found + drift * (theta - place) if self.placed else found

    def slopes(self, eta: BallArray, theta: BallArray) -> tuple[BallArray, BallArray]:
        """The slopes `-d phi/d eta` and `d phi/d theta` of the law, over incidence angles and landing parameters."""
        if self.law is None:
            return self.lam, BallArray(0.0)
        slope, drift = self.law.slopes(self.ops, eta, self.lam, theta if self.placed else BallArray(0.0))
        return spread(slope, np.asarray(eta.m)), spread(drift, np.asarray(eta.m)) if self.placed else BallArray(0.0)

    @cached_property
    def outer(self) -> Array:
        """For each component, doubles below its first and above its last parameter."""
        return np.array([(float(first.lower()), float(last.upper())) for first, last in self.ends]).T

    @cached_property
    def inner(self) -> Array:
        """For each component, doubles above its first and below its last parameter."""
        return np.array([(float(first.upper()), float(last.lower())) for first, last in self.ends]).T

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The components as charts, rounded outwards; the period of a closed curve is the nearest double."""
        ends = [[float(end.m) for end in self.ends[0]]] if self.closed else self.outer.T.tolist()
        parts = zip(self.map.ir.parts, ends, strict=True)
        return tuple(Chart(part.name, (*x,), (-self.top, self.top), self.closed, True) for part, x in parts)

    @property
    def joins(self) -> tuple[tuple[int, int], ...]:
        """Pairs of components: the end of the first is the start of the second; none for a single closed curve."""
        count = len(self.ends)
        return () if self.closed else tuple((i, (i + 1) % count) for i in range(count))

    @cached_property
    def mirrored(self) -> bool:
        """True if table and law are proved symmetric, so that the map commutes with `(theta, phi) -> -(theta, phi)`."""
        return reflected(self.map.table) and (self.law is None or self.scene.law.odd)

    @cached_property
    def homeomorphism(self) -> bool:
        """True if the map is proved continuous across joins and one-to-one, with nonzero determinant where it is
        smooth.

        The proof: the tangents agree at each join, so a flight that lands there leaves in the same direction for both
        components, if the law does not depend on the place. And a reversed flight has a single end, as the table is
        convex.
        """
        turns = tangents(self.map.table)
        alike = not self.placed and all(bool(a.is_zero and b.is_positive) for a, b in turns)
        return alike and self.range[0] > 0 and invertible(self)

    @property
    def label(self) -> str:
        shape, (low, high) = "".join(f", {name} = {value}" for name, value in self.scene.shape.items()), self.range
        law = "" if self.law is None else f", phi = {self.scene.law}"
        return f"{self.scene.name}{shape}{law}, lam = {low}" + ("" if low == high else f" to {high}")

    def place(self, chart: Indices, theta: BallArray) -> list[BallArray]:
        """Boundary point, velocity and acceleration at parameters of components."""
        if self.closed:
            return self.curves[0](theta, *self.shape)
        m, r = np.broadcast_arrays(theta.m, theta.r)
        made = [BallArray(np.empty(m.shape), np.empty(m.shape)) for _ in range(6)]
        for index, curve in enumerate(self.curves):
            on = np.flatnonzero(chart == index)
            for whole, value in zip(made, curve(BallArray(m[on], r[on]), *self.shape), strict=True):
                whole.m[on], whole.r[on] = value.m, value.r
        return made

    @cached_property
    def curves(self) -> list[Compiled]:
        """For each component, the function that gives point, velocity and acceleration from parameter and shape."""
        return [compiled_curve(part.curve) for part in self.map.ir.parts]

    def flights(self, boxes: Boxes) -> Flights:
        """The flights that leave a block of boxes."""
        return Flights(self, boxes)

    def images(self, boxes: Boxes) -> Images:
        with np.errstate(all="ignore"):  # infinite and NaN entries count as not proved
            flights = self.flights(boxes)
            rows = [self.row(*flights.landing(piece)) for piece in flights.pieces(*flights.arcs())]
        return collected(rows, boxes.chart.size)

    def row(self, piece: LandingArcs, theta: BallArray, eta: BallArray, phi: BallArray | None) -> Row:
        """The image rectangle of each box in a piece of landings."""
        on, chart, low, high, smooth = piece
        exit, top = self.exit(eta, theta), self.top
        phi = exit if phi is None else common_part(phi, exit)
        low_y, high_y = np.maximum(phi.lower(), -top), np.minimum(phi.upper(), top)
        known = np.isfinite(phi.r) & (low_y <= high_y)
        none = np.isfinite(phi.r) & (low_y > high_y) & (not smooth)  # no landing has such an angle
        low_y, high_y = np.where(known, low_y, -top), np.where(known, high_y, top)
        bad = np.isnan(low) | np.isnan(high)
        left, right = np.where(bad, np.nan, theta.lower()), np.where(bad, np.nan, theta.upper())
        return on[~none], chart[~none], left[~none], right[~none], low_y[~none], high_y[~none]

    def derivatives(self, boxes: Boxes) -> list[tuple[LandingArcs, Slopes]]:
        """The derivatives over boxes, for each piece of their arcs; an infinite radius means that nothing is proved."""
        with np.errstate(all="ignore"):
            pieces = (flights := self.flights(boxes)).pieces(*flights.arcs())
            return [(p, flights.slopes(p.on, p.chart, hull(p.low, p.high))) for p in pieces if p.on.size]


@dataclass(frozen=True)
class RangeTheorem(Theorem):
    """A theorem on a scene with a convex table that holds for each contraction of a range."""

    scene: Scene = field(metadata=SCENE)
    lam: tuple[Fraction, Fraction] = field(metadata=RANGE)

    @cached_property
    def map(self) -> PinballImages:
        """The map in boxes, over the whole range at once; `ValueError` unless the table is proved convex."""
        return PinballImages(self.scene, self.lam)


def invertible(map: PinballImages) -> bool:
    """True if the law's slope is proved to vanish nowhere, so that preimages of sets of measure 0 have measure 0."""
    if map.law is None:
        return True  # the slope is -lam, not 0
    slopes = [map.slopes(*some)[0] for some in map.incidences()]
    return all(np.all(slope.positive()) for slope in slopes) or all(np.all(slope.negative()) for slope in slopes)
