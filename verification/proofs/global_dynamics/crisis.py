"""A boundary crisis between two contractions: a branch of a saddle's unstable manifold escapes from a trapping region.

The theorem, for `LOW < HIGH`, has three parts:

- for every `lam` from `LOW` to `HIGH` the saddle exists, one curve of cycles, and the boxes `taken` are trapping;
- at `LOW` all orbits of the branch enter the boxes `kept`, which are trapping and disjoint from `taken`;
- at `HIGH` one orbit of the branch enters `taken`.

Call `lam` good when all orbits of the branch enter some trapping region disjoint from `taken`. A trapping region is one
for all nearby contractions too, since it is compact, and the map is continuous on the smooth closed convex table. A
piece of the branch, from a point to its image after one round, with its rotated copies, is compact and moves
continuously, and every orbit of the branch meets it. So the good contractions are an open set that contains `LOW`.
`HIGH` is not good, because orbits in `taken` stay there. Therefore there is a first contraction in `(LOW, HIGH]` that
is not good. Where the boxes `kept` hold a chaotic attractor, this is its boundary crisis [GrebogiOttYorke1983]; that
the boxes do so is not proved.

Both sets of boxes are grown from a few cells, so a document need not list them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import numpy as np
from flint import acb, arb

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import ARRAYS, FLOAT64, balls, fraction_ball, working
from verification.arithmetic.series import Jet
from verification.cycles.systems import symmetries
from verification.maps.enclosed import EnclosedMap
from verification.proofs.global_dynamics.branch import OUTER, ManifoldSeries, unstable_branch
from verification.proofs.global_dynamics.images import SCENE, PinballImages
from verification.proofs.manifolds.certificate import orbit_of, orbit_said
from verification.proofs.manifolds.enclosed import (
    complex_balls,
    enclosed_saddle,
)
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Saddle, SaddleCycle, local, saddle
from verification.proofs.manifolds.tangency import one_cycle, scale
from verification.proofs.manifolds.touching import bounce
from verification.rigorous.absorbing import AbsorbingSet, grown
from verification.rigorous.boxes import Boxes
from verification.rigorous.certificate import RANGE, Certified, entry, whole
from verification.rigorous.theorem import hypothesis

BITS, MANY_BITS = 160, 640  # precision of balls; the larger for the orbit that leaves, whose balls grow fast
PIECES, ROUNDS = 1024, 3  # boxes along the branch at LOW, and rounds that they are mapped before the growth begins
CUTS = 16  # parts of the range of contractions, over each of which the saddle is enclosed
MOST_BOUNCES, SAMPLES = 400, 20_000
SOON, SEEN, AT_REST = (30, 60, 120, 300), 200, -0.02  # bounces before and for an exponent, and its bound on cycles
SLACK = 1e-14  # for each turn of 2*pi subtracted: more than its rounding error
FAR, NEAR = 10.0, 1e-5  # radians: the largest start, and the largest distance of the saddle at LOW from its given start


@dataclass(frozen=True, eq=False, repr=False)
class BoundaryCrisis(Certified):
    """The branch on one `side` of a saddle's unstable manifold is trapped at `lam[0]` and escapes at `lam[1]`.

    The saddle repeats after one bounce and a rotation of the table, like a regular polygon. The law depends on `eta`
    and `lam` only, and its exit angles stay below `pi/2` by a margin. The escaping orbit begins at `start`, a number
    from 0 to 1 along the piece of the branch from a point to its image. The boxes `taken` are grown from `sink`, a
    phase point `(theta, phi)`. Boxes are cells of a grid of `columns` by `rows`, each cut into `parts` by `parts`
    before it is mapped.
    """

    kind = "boundary crisis"
    scene: Scene = field(metadata=SCENE)
    saddle: SaddleCycle = field(metadata=entry(lambda given, _: orbit_of(given), orbit_said))
    side: int = field(metadata=entry(lambda given, _: given))
    lam: tuple[Fraction, Fraction] = field(metadata=RANGE)
    columns: int = field(metadata=whole("columns", 1 << 13))
    rows: int = field(metadata=whole("rows", 1 << 13))
    parts: int = field(metadata=whole("parts", 16))
    start: float = field(metadata=entry(lambda given, _: float(given)))
    sink: tuple[float, float] = field(metadata=entry(lambda given, _: (float(given[0]), float(given[1])), list))

    def __post_init__(self) -> None:
        if len(self.scene.table.components) != 1:
            raise ValueError(f"crisis: {self.scene.name} has several components; accepted: one smooth closed curve")
        closure, (low, high) = self.saddle.closure, self.lam
        turns = {Fraction(0)} | {Fraction(*g.shift) for g in symmetries(self.scene.table) if g.turn == 1}
        if len(self.saddle.start) != 1 or closure.turn != 1 or Fraction(*closure.shift) % 1 not in turns:
            raise ValueError(f"crisis: the {self.saddle.name} must be a fixed point of the map, up to a rotation")
        if self.scene.law.placed:
            raise ValueError(f"crisis: law = {self.scene.law} depends on the place; accepted: laws of eta and lam")
        if not all(abs(x) < FAR for x in (*self.saddle.start, *self.sink)):
            given = f"the saddle at {self.saddle.start}, the sink at {self.sink}"
            raise ValueError(f"crisis: {given}; accepted: numbers below {FAR}")
        if self.side not in (1, -1) or not 0 < low < high < 1 or not 0 <= self.start <= 1:
            given = f"side = {self.side}, lam = {low}:{high}, start = {self.start}"
            raise ValueError(f"crisis: {given}; accepted: side 1 or -1, 0 < LOW < HIGH < 1, start from 0 to 1")
        if not self.scene.law.uniform:
            PinballImages(self.scene, self.lam)  # raises ValueError where exit angles are not bounded below pi/2

    @property
    def name(self) -> str:
        """The statement in one line."""
        shape = "".join(f", {name} = {value}" for name, value in self.scene.shape.items())
        shape += "" if self.scene.law.uniform else f", phi = {self.scene.law}"
        (low, high), (p, q), (at,) = self.lam, self.saddle.closure.shift, self.saddle.start
        saddle = f"saddle at theta = {at:.5f}, {p}/{q} of a turn a bounce, side {self.side:+d}"
        return f"boundary crisis of {self.scene.name}{shape}, {saddle}: lam between {low} and {high}"

    @cached_property
    def branches(self) -> tuple[ManifoldSeries, ManifoldSeries] | None:
        """The enclosed unstable manifolds at the lower and the higher contraction; None if they are not proved."""
        if self.curve is None:
            return None
        below, above = (
            unstable_branch(around.orbit, self.map, lam, bits, around)
            for around, lam, bits in zip(self.curve, self.lam, (BITS, MANY_BITS), strict=True)
        )
        return None if below is None or above is None else (below, above)

    @cached_property
    def kept_boxes(self) -> AbsorbingSet | None:
        """The trapping boxes grown from the branch at the lower contraction; None if not proved."""
        if self.branches is None:
            return None
        ends, map = np.linspace(0, 1, PIECES + 1), PinballImages(self.scene, (self.lam[0],) * 2)
        pieces = bounding_boxes(self._turned(self.branches[0].points(self.side, ends[:-1].tolist(), ends[1:].tolist())))
        for _ in range(ROUNDS):
            pieces = None if pieces is None else _next(map, pieces)
        return None if pieces is None else grown(map, (self.columns, self.rows, self.parts), pieces)

    @cached_property
    def taken_boxes(self) -> AbsorbingSet | None:
        """The boxes grown from the sink, trapping for all contractions of the range at once; None if not proved."""
        seed = None if self.branches is None else bounding_boxes([(arb(self.sink[0]), arb(self.sink[1]))])
        return (
            None
            if seed is None
            else grown(PinballImages(self.scene, self.lam), (self.columns, self.rows, self.parts), seed)
        )

    @hypothesis(name="saddle")
    def saddle_exists(self) -> bool:
        """The saddle exists for each contraction of the range, on one curve of cycles."""
        return self.curve is not None

    @hypothesis
    def manifold(self) -> bool:
        """The saddle's unstable manifold is a series with a bounded remainder, at both contractions."""
        return self.branches is not None

    @hypothesis
    def kept(self) -> bool:
        """At the lower contraction all orbits of the branch enter a set of trapping boxes."""
        return self.kept_boxes is not None

    @hypothesis
    def taken(self) -> bool:
        """Boxes around the sink are trapping for each contraction of the range."""
        return self.taken_boxes is not None

    @hypothesis
    def apart(self) -> bool:
        """The boxes that trap the branch are disjoint from those around the sink."""
        return not (
            self.kept_boxes is None or self.taken_boxes is None or self.kept_boxes.meets(self.taken_boxes.boxes)
        )

    @hypothesis
    def leaves(self) -> bool:
        """At the higher contraction the orbit from `start` enters the boxes around the sink."""
        if self.branches is None or self.kept_boxes is None or self.taken_boxes is None:
            return False
        (point,) = self.branches[1].points(self.side, [self.start], [self.start])
        return enters(self.scene, self.lam[1], point, self.taken_boxes)

    @property
    def map(self) -> Pinball:
        """The map, given by its collision rule and composed with the rotation by which the saddle repeats."""
        return Pinball(self.scene.table, turn=self.saddle.closure.shift[1], law=self.scene.law)

    @cached_property
    def curve(self) -> tuple[Saddle, Saddle] | None:
        """The saddle, enclosed over the first and over the last subinterval of the range of contractions; or None.

        None is returned unless both are proved to lie on one curve of cycles over the whole range, and the saddle at
        the lower end to be near its given start.
        """
        ends = [self.lam[0] + (self.lam[1] - self.lam[0]) * Fraction(k, CUTS) for k in range(CUTS + 1)]
        map, orbit, parts = self.map.over(complex_balls(BITS)), self.saddle, list[Saddle]()
        try:
            with working(BITS):
                before = enclosed_saddle(orbit, map, acb(fraction_ball(ends[0])))
                if not abs(before.points[0] - orbit.start[0]) < NEAR:
                    return None
                for a, b in pairwise(ends):
                    around = enclosed_saddle(orbit, map, acb(fraction_ball(a).union(fraction_ball(b))))
                    orbit = replace(orbit, start=tuple(float(x.real.mid()) for x in around.points))
                    after = enclosed_saddle(orbit, map, acb(fraction_ball(b)))
                    if not (one_cycle(around, before) and one_cycle(around, after)):
                        return None
                    parts.append(replace(around, orbit=orbit))
                    before = after
        except (ValueError, ArithmeticError):
            return None
        return parts[0], parts[-1]

    def _turned(self, points: Sequence[tuple[arb, arb]]) -> list[tuple[arb, arb]]:
        """Phase points and their copies under rotations by which the saddle repeats; each orbit meets one of them."""
        with working(BITS):
            turn = self.saddle.closure.angle(balls(BITS))
            copies = range(Fraction(*self.saddle.closure.shift).denominator)
            return [(theta + k * turn, phi) for k in copies for theta, phi in points]


def bracket(
    scene: Scene,
    orbit: SaddleCycle,
    side: int,
    lam: tuple[Fraction, Fraction],
    grid: tuple[int, int, int] = (2048, 2048, 1),
) -> BoundaryCrisis:
    """A candidate for a crisis between two contractions; the escaping orbit is found by sampling in float64.

    `grid` is columns, rows and parts. `ValueError` if no sampled orbit converges to a cycle at `lam[1]`. The candidate
    is proved only if its `checks` say so.

    >>> from verification.proofs.manifolds.known import CONTACTS
    >>> triangle, ends = CONTACTS["boundary"].unstable, (Fraction(3, 5), Fraction(663, 1000))
    >>> bracket(Scene("egg", alpha="0.08"), triangle, 1, ends).name.partition(",")[0]
    'boundary crisis of egg'
    """
    low, high = (float(x) for x in lam)
    plane = Pinball(scene.table, turn=orbit.closure.shift[1], law=scene.law).over(ARRAYS)
    orbit = replace(orbit, start=tuple(saddle(orbit, plane.over(FLOAT64), low).points))
    made = local(saddle(orbit, plane.over(FLOAT64), high), True, 28)
    unit, factor = scale(orbit, plane, high, True, OUTER).unit, float(made.factor)
    start = (np.arange(SAMPLES) + 0.5) / SAMPLES
    z = Jet(side * unit * factor ** (start - 1))
    before, here = (bounce(made, j, z).c[0] for j in (-1, 0))
    map = PinballMap(scene, lam=high)
    theta, phi = before - 2 * np.pi * np.rint(before / (2 * np.pi)), plane.angle(before, here)[0]
    for after in SOON:  # balls grow along the orbit: orbits that escape early are best
        found = map.exponents(theta, phi, after, SEEN)
        rests = np.append(found.nu_plus < AT_REST, False)
        ends = np.flatnonzero(np.diff(np.append(False, rests).astype(int))).reshape(-1, 2)
        if ends.size:
            break
    else:
        raise ValueError(f"crisis: at lam = {high} none of {SAMPLES} orbits along the branch leaves; use a larger HIGH")
    first, last = ends[np.argmax(ends[:, 1] - ends[:, 0])]
    k = (first + last) // 2
    sink = float(found.theta[k]), float(found.phi[k])
    return BoundaryCrisis(scene, orbit, side, lam, *grid, float(start[k]), sink)


def enters(scene: Scene, lam: Fraction, start: tuple[arb, arb], cells: AbsorbingSet) -> bool:
    """True if the orbit of a phase point, followed in balls, is proved to enter the cells within `MOST_BOUNCES`."""
    map = EnclosedMap(PinballMap(scene, lam=float(lam)), lam, MANY_BITS)
    for here in map.orbit(map.start(*start), MOST_BOUNCES):
        box = bounding_boxes([(here.theta, here.phi)])
        if box is not None and cells.holds(box):
            return True
    return False


def bounding_boxes(points: Sequence[tuple[arb, arb]]) -> Boxes | None:
    """Boxes around phase points of a table of one component; None if a point is not finite."""
    (left, right), (bottom, top) = (
        [np.array([_outwards(x, up) for x in values]) for up in (False, True)] for values in zip(*points, strict=True)
    )
    if not np.isfinite([left, right, bottom, top]).all():
        return None
    return _turned_back(Boxes(np.zeros(len(points), dtype=np.int64), (left, right), (bottom, top)))


def _next(map: PinballImages, boxes: Boxes) -> Boxes | None:
    """The images of boxes, one box for each; None if an image is not enclosed or splits in two."""
    images = map.images(boxes)
    if images.lost.size or not np.array_equal(images.source, np.arange(boxes.chart.size)):
        return None
    return _turned_back(images.boxes)


def _turned_back(boxes: Boxes) -> Boxes:
    """The boxes, moved by full turns of `theta` so that they lie about 0, and rounded outwards."""
    turns = 2 * np.pi * np.rint((boxes.x[0] + boxes.x[1]) / (4 * np.pi))
    slack = SLACK * (1 + np.abs(turns))
    return boxes._replace(x=(boxes.x[0] - turns - slack, boxes.x[1] - turns + slack))


def _outwards(x: arb, up: bool) -> float:
    """A double above every number of a ball if `up`, else below every number."""
    return float(np.nextafter(float(x.upper() if up else x.lower()), np.inf if up else -np.inf))
