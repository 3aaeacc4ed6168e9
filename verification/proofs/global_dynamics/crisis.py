"""A boundary crisis between two contractions: below, a trapping region keeps a branch of a saddle's unstable manifold;
above, an orbit that leaves along the same branch ends elsewhere.

What is proved, for `LOW < HIGH`:

- for every `lam` from `LOW` to `HIGH` the saddle exists, one curve of cycles, and the boxes `taken` are trapping;
- at `LOW` all orbits that leave the saddle along the branch enter the boxes `kept`, trapping and apart from `taken`;
- at `HIGH` one orbit that leaves along the branch enters `taken`.

Call `lam` good when some trapping region apart from `taken` is entered by all orbits of the branch. A trapping region
is one for all nearby contractions too: the image of a compact set stays within its interior, that of the strip of phase
points after a bounce, since the table is one smooth closed curve, convex, and the map continuous. And a piece of the
branch, from a point to its image after a round, with its turned copies, is compact and moves continuously; every orbit
of the branch passes it. So good contractions are an open set, which holds `LOW`. `HIGH` is none: what is in `taken`
stays there. Therefore there is a first contraction in `(LOW, HIGH]` at which every such region is lost. Where what is
kept is a chaotic attractor, this is its boundary crisis [GrebogiOttYorke1983]; that is not proved here.

Both sets of boxes are what the outer images of a few cells grow to, so a document need not list them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from flint import acb, arb
from numpy.typing import NDArray

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.balls import ARRAYS, FLOAT64, balls, working
from verification.arithmetic.series import Jet
from verification.cycles.systems import symmetries
from verification.maps.enclosed import EnclosedMap
from verification.proofs.global_dynamics.apart import reached
from verification.proofs.global_dynamics.boxes import Boxes, Images
from verification.proofs.global_dynamics.branch import OUTER, Branch, exact, unstable_branch
from verification.proofs.global_dynamics.graph import CELLS, Cells, Grid, Mask, Rectangles
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.global_dynamics.regions import stated, whole
from verification.proofs.manifolds.claim import orbit_of, orbit_said
from verification.proofs.manifolds.enclosed import (
    TooWideError,
    complex_balls,
    enclosed_saddle,
)
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Orbit, Saddle, local, saddle
from verification.proofs.manifolds.tangency import one_cycle, scale
from verification.proofs.manifolds.touching import bounce

KIND, SCHEMA = "boundary crisis", 1
BITS, MANY_BITS = 160, 640  # of the balls; many for an orbit in balls, which grow faster than the orbit is unstable
PIECES, ROUNDS = 1024, 3  # of the branch at LOW, and how far it is followed before boxes take over
CUTS = 16  # of the contractions, over each of which the saddle is enclosed
MOST_BOUNCES, SAMPLES = 400, 20_000
SOON, SEEN, AT_REST = (30, 60, 120, 300), 200, -0.02  # bounces before an exponent and for it; cycles stay below
GRID = {"columns": 1 << 13, "rows": 1 << 13, "parts": 16}
SLACK = 1e-14  # for each turn of 2*pi taken off, more than that errs in float64
FAR, NEAR = 10.0, 1e-5  # radians: of a start at most, and between the saddle at LOW and where it is said to be
CHECKS = ("saddle", "manifold", "kept", "taken", "apart", "leaves")
Array = NDArray[np.float64]


@dataclass(frozen=True)
class BoundaryCrisis:
    """The branch on one `side` of a saddle's unstable manifold is kept at `lam[0]` and leaves at `lam[1]`.

    A round of the saddle is one bounce and a turn of the table, as that of a polygon is; the law is one of `eta` and
    `lam`, the same everywhere, below `pi/2` by a margin.
    `start` is where, on a piece of the branch from a point to its image, from 0 to 1, the orbit that leaves begins;
    `sink` is a phase point `(theta, phi)` from which `taken` is grown. The boxes are those of a grid of `columns` by
    `rows`, each cut into `parts` by `parts`.
    """

    scene: Scene
    saddle: Orbit
    side: int
    lam: tuple[Fraction, Fraction]
    columns: int
    rows: int
    parts: int
    start: float
    sink: tuple[float, float]

    def __post_init__(self) -> None:
        if len(self.scene.table.components) != 1:
            raise ValueError(f"crisis: {self.scene.name} has several components; accepted: one smooth closed curve")
        closure, (low, high) = self.saddle.closure, self.lam
        turns = {Fraction(0)} | {Fraction(*g.shift) for g in symmetries(self.scene.table) if g.turn == 1}
        if len(self.saddle.start) != 1 or closure.turn != 1 or Fraction(*closure.shift) % 1 not in turns:
            raise ValueError(f"crisis: a round of the {self.saddle.name} is not one bounce and a turn of the table")
        if self.scene.law.placed:
            raise ValueError(f"crisis: law = {self.scene.law}; a round turns the table; accepted: laws of eta and lam")
        if not all(abs(x) < FAR for x in (*self.saddle.start, *self.sink)):
            raise ValueError(f"crisis: the saddle at {self.saddle.start} or the sink at {self.sink} is out of range")
        if self.side not in (1, -1) or not 0 < low < high < 1 or not 0 <= self.start <= 1:
            raise ValueError(f"crisis: side = {self.side}, lam = {low}:{high} or start = {self.start} is out of range")
        if not self.scene.law.uniform:
            PinballImages(self.scene, self.lam)  # refuses a law without the strip in which all particles are

    @property
    def name(self) -> str:
        """What is stated."""
        shape = "".join(f", {name} = {value}" for name, value in self.scene.shape.items())
        shape += "" if self.scene.law.uniform else f", phi = {self.scene.law}"
        (low, high), (p, q), (at,) = self.lam, self.saddle.closure.shift, self.saddle.start
        saddle = f"saddle at theta = {at:.5f}, {p}/{q} of a turn a bounce, side {self.side:+d}"
        return f"boundary crisis of {self.scene.name}{shape}, {saddle}: lam between {low} and {high}"

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        found: dict[str, bool | None] = dict.fromkeys(CHECKS)
        low = self.lam[0]
        try:
            curve = self._continued()
            found["saddle"] = True
            branches = [self._branch(*one) for one in zip(curve, self.lam, (BITS, MANY_BITS), strict=True)]
            found["manifold"] = True
        except (ValueError, ArithmeticError):
            return found
        below, throughout = (PinballImages(self.scene, pair) for pair in ((low, low), self.lam))
        seed = boxed([(arb(self.sink[0]), arb(self.sink[1]))])
        taken = None if seed is None else self._grown(throughout, seed)
        found["taken"] = _proved(taken is not None)
        ends = np.linspace(0, 1, PIECES + 1)
        pieces = boxed(self._turned(self._launched(branches[0], ends[:-1], ends[1:])))
        for _ in range(ROUNDS):
            pieces = None if pieces is None else _next(below, pieces)
        kept = None if pieces is None else self._grown(below, pieces)
        found["kept"] = _proved(kept is not None)
        if kept is None or taken is None:
            return found
        found["apart"] = _proved(not _meets(kept, taken))
        found["leaves"] = _proved(self._leaves(branches[1], taken))
        return found

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())

    @property
    def map(self) -> Pinball:
        """The map, by its rule."""
        return Pinball(self.scene.table, turn=self.saddle.closure.shift[1], law=self.scene.law)

    def _continued(self) -> tuple[Saddle, Saddle]:
        """The saddle over the first and the last part of the contractions, of one curve of cycles over all of them.

        `TooWideError` where that is not proved, or where the saddle at the lower end is not where it is said to be.
        """
        ends = [self.lam[0] + (self.lam[1] - self.lam[0]) * Fraction(k, CUTS) for k in range(CUTS + 1)]
        with working(BITS):
            map, orbit, parts = self.map.over(complex_balls(BITS)), self.saddle, list[Saddle]()
            before = enclosed_saddle(orbit, map, exact(ends[0]))
            if not abs(before.points[0] - orbit.start[0]) < NEAR:
                raise TooWideError("saddle", "the saddle at the lower contraction is another than said")
            for a, b in pairwise(ends):
                around = enclosed_saddle(orbit, map, acb(exact(a).real.union(exact(b).real)))
                orbit = replace(orbit, start=tuple(float(x.real.mid()) for x in around.points))
                after = enclosed_saddle(orbit, map, exact(b))
                if not (one_cycle(around, before) and one_cycle(around, after)):
                    raise TooWideError("saddle", "the cycle at an end may be another than the one in between")
                parts.append(replace(around, orbit=orbit))
                before = after
        return parts[0], parts[-1]

    def _branch(self, around: Saddle, lam: Fraction, bits: int) -> Branch:
        """The series of the unstable manifold at one contraction, its remainder proved; `TooWideError`."""
        return unstable_branch(around.orbit, self.map, lam, bits, around)

    def _launched(self, branch: Branch, low: Array, high: Array) -> list[tuple[arb, arb]]:
        """Phase points on pieces of the branch, on one side."""
        return branch.points(self.side, low.tolist(), high.tolist())

    def _turned(self, points: Sequence[tuple[arb, arb]]) -> list[tuple[arb, arb]]:
        """Phase points with their turned copies: a round is a bounce and a turn, so an orbit passes one of them."""
        with working(BITS):
            turn = self.saddle.closure.angle(balls(BITS))
            copies = range(Fraction(*self.saddle.closure.shift).denominator)
            return [(theta + k * turn, phi) for k in copies for theta, phi in points]

    def _leaves(self, branch: Branch, taken: tuple[Grid, Mask]) -> bool:
        """Does the orbit from `start` enter the cells? Followed in balls, each landing a first hit."""
        at = np.array([self.start])
        ((theta, phi),) = self._launched(branch, at, at)
        return enters(self.scene, self.lam[1], (theta, phi), taken)

    def _grown(self, map: PinballImages, start: Boxes) -> tuple[Grid, Mask] | None:
        return grown(map, (self.columns, self.rows, self.parts), start)

    def to_dict(self) -> dict[str, Any]:
        """The statement as a JSON document."""
        said = {"schema": SCHEMA, "name": self.name, "kind": KIND, "scene": self.scene.document}
        said |= {"saddle": orbit_said(self.saddle)}
        grid = {"columns": self.columns, "rows": self.rows, "parts": self.parts}
        ends = {"side": self.side, "lam": [str(x) for x in self.lam]}
        return said | ends | grid | {"start": self.start, "sink": list(self.sink)}

    @classmethod
    def from_dict(cls, given: Mapping[str, Any]) -> "BoundaryCrisis":
        """The crisis of a document; `ValueError` names what is wrong with it."""
        try:
            scene, lam = stated(given, KIND, SCHEMA)
            columns, rows, parts = (whole(name, given[name], most) for name, most in GRID.items())
            side, start, sink = given["side"], float(given["start"]), (float(given["sink"][0]), float(given["sink"][1]))
            return cls(scene, orbit_of(given["saddle"]), side, lam, columns, rows, parts, start, sink)
        except (KeyError, IndexError, TypeError, AttributeError) as error:
            raise ValueError(f"certificate: the entry {error} is missing or of the wrong kind") from None


def bracket(
    scene: Scene, orbit: Orbit, side: int, lam: tuple[Fraction, Fraction], grid: tuple[int, int, int] = (2048, 2048, 1)
) -> BoundaryCrisis:
    """A crisis between two contractions, with an orbit that leaves found by sampling the branch in float64.

    `grid` is columns, rows and parts. `ValueError` where no sample comes to rest on a cycle at `lam[1]`. Nothing of it
    is proved yet: ask for its `checks`.

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
    for after in SOON:  # errors of a box grow along the way: the orbits that leave first serve best
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


def enters(scene: Scene, lam: Fraction, start: tuple[arb, arb], cells: tuple[Grid, Mask]) -> bool:
    """Does the orbit of a phase point enter the cells? Followed in balls, each landing a first hit."""
    map = EnclosedMap(PinballMap(scene, lam=float(lam)), lam, MANY_BITS)
    for here in map.orbit(map.start(*start), MOST_BOUNCES):
        box = boxed([(here.theta, here.phi)])
        if box is not None and _within(cells, box):
            return True
    return False


def grown(map: PinballImages, grid: tuple[int, int, int], start: Boxes) -> tuple[Grid, Mask] | None:
    """The cells that boxes meet, with all that their images meet, again and again; None where they have no end."""
    fine = Grid(map.charts, *grid[:2])
    numbers = reached(map, fine, start, grid[2], most=CELLS)
    if numbers is None:
        return None
    member = np.zeros((len(map.charts), *grid[:2]), dtype=bool)
    member.ravel()[numbers] = True
    return fine, member


def boxed(points: Sequence[tuple[arb, arb]]) -> Boxes | None:
    """Boxes about phase points of a table of one component; None where one is not finite."""
    (left, right), (bottom, top) = (
        [np.array([_outwards(x, up) for x in values]) for up in (False, True)] for values in zip(*points, strict=True)
    )
    if not np.isfinite([left, right, bottom, top]).all():
        return None
    return _turned_back(Boxes(np.zeros(len(points), dtype=np.int64), (left, right), (bottom, top)))


def _next(map: PinballImages, boxes: Boxes) -> Boxes | None:
    """The images of boxes, one for each; None where one is not proved."""
    images = map.images(boxes)
    if images.lost.size or not np.array_equal(images.source, np.arange(boxes.chart.size)):
        return None
    return _turned_back(images.boxes)


def _turned_back(boxes: Boxes) -> Boxes:
    """The same boxes with whole turns taken off, rounded outwards."""
    turns = 2 * np.pi * np.rint((boxes.x[0] + boxes.x[1]) / (4 * np.pi))
    slack = SLACK * (1 + np.abs(turns))
    return boxes._replace(x=(boxes.x[0] - turns - slack, boxes.x[1] - turns + slack))


def _outwards(x: arb, up: bool) -> float:
    """A double above, or below, every number of a ball."""
    return float(np.nextafter(float(x.upper() if up else x.lower()), np.inf if up else -np.inf))


def _as_images(boxes: Boxes) -> Images:
    return Images(np.arange(boxes.chart.size), boxes, np.zeros(0, dtype=np.int64))


def marked_cells(member: Mask) -> Cells:
    """The cells of a grid that are marked."""
    return Cells._make((*np.nonzero(member), np.ones(np.count_nonzero(member), dtype=np.int64)))


def _marked(grid: Grid, met: Rectangles) -> Mask:
    """The cells of rectangles: counts go up where a rectangle begins, and down where it ends."""
    counts = np.zeros((len(grid.charts), grid.columns + 1, grid.rows + 1), dtype=np.int32)
    beyond = met.right >= grid.columns  # they go on at the first column
    for some, left, right in (
        (slice(None), met.left, np.minimum(met.right, grid.columns - 1)),
        (beyond, np.zeros(beyond.sum(), dtype=int), met.right[beyond] - grid.columns),
    ):
        chart, bottom, top = met.chart[some], met.bottom[some], met.top[some] + 1
        for column, row, step in ((left, bottom, 1), (right + 1, top, 1), (left, top, -1), (right + 1, bottom, -1)):
            np.add.at(counts, (chart, column, row), step)
    return np.asarray(counts.cumsum(1, dtype=np.int32).cumsum(2, dtype=np.int32)[:, :-1, :-1] > 0)


def _meets(kept: tuple[Grid, Mask], taken: tuple[Grid, Mask]) -> bool:
    """May cells of two grids have a common point?"""
    grid, member = taken
    return bool(np.any(_marked(kept[0], kept[0].met(_as_images(grid.boxes(marked_cells(member))))) & kept[1]))


def _within(cells: tuple[Grid, Mask], boxes: Boxes) -> bool:
    """Do all boxes lie in the cells?"""
    grid, member = cells
    met = grid.met(_as_images(boxes))
    return not bool(np.any(_marked(grid, met) & ~member)) and not bool(met.out.any())


def _proved(held: bool) -> bool | None:
    return True if held else None
