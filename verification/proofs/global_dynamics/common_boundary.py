"""A common boundary of two basins: orbits on a saddle's unstable manifold converge to two different cycles.

By the hypotheses of `CommonBoundary` each of two discs holds one cycle, and every orbit that enters the disc converges
to it. So *each neighbourhood of each point whose orbit converges to the saddle holds open sets of both basins*. Proof:
let `x` be such a point, and take a short curve through it, transverse to the saddle's stable manifold. The table is one
convex analytic curve and `lam > 0`, so the map is a diffeomorphism onto its image, and the images of the curve stay
transverse. By the inclination lemma they converge, as smooth curves, to each compact piece of the unstable manifold, on
both sides of the saddle. So some points of the curve follow each of the two given orbits on that manifold into the open
discs, and entering an open disc after finitely many bounces is an open condition. The point `x` itself is in neither
basin.

So the stable manifold of the saddle lies on the boundary of both basins.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import arb, fmpq

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import Array, BallArray
from verification.arithmetic.balls import fraction_ball, working
from verification.cycles.systems import symmetries
from verification.maps.enclosed import EnclosedMap
from verification.proofs.global_dynamics.branch import ManifoldSeries, unstable_branch
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.proof import smooth
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.rigorous.boxes import Boxes
from verification.rigorous.norms import in_frame, times
from verification.rigorous.theorem import Theorem, Verdict, hypothesis

BITS = 320  # of the balls in which orbits are followed
MOST_BOUNCES = 100
SMALL = 1e-80  # radians: half the width of a box around a start
CUT = 24  # a disc's rectangle is cut into CUT by CUT parts to enclose the derivative
SLACK = 1e-9  # relative; more than the rounding of a dozen operations


@dataclass(frozen=True)
class Disc:
    """The phase points `centre + inverse*u` with `|u| < radius`; `centre` is `(theta, phi)`."""

    centre: tuple[float, float]
    inverse: tuple[tuple[float, float], tuple[float, float]]
    radius: float

    @property
    def rectangle(self) -> tuple[float, float]:
        """Half the sides, in `theta` and `phi`, of a rectangle that holds the disc."""
        (a, b), (c, d) = self.inverse
        return self.radius * float(np.hypot(a, b)) * (1 + SLACK), self.radius * float(np.hypot(c, d)) * (1 + SLACK)


def disc(map: PinballImages, centre: tuple[float, float], radius: float) -> Disc:
    """A disc in a norm adapted to the derivative at `centre`, so that an attracting map is likely to contract it."""
    at = Boxes.one(*((value, value) for value in centre))
    (a, b), (c, d) = ((float(np.ravel(x.m)[0]) for x in row) for row in matrix(map.derivatives(at)[0][1]))
    values, vectors = np.linalg.eig(np.array([[a, b], [c, d]]))
    v = vectors[:, 0]
    frame = np.stack([v.real, v.imag], 1) if np.iscomplex(values[0]) else vectors.real
    return Disc(centre, ((float(frame[0, 0]), float(frame[0, 1])), (float(frame[1, 0]), float(frame[1, 1]))), radius)


def attracts(map: PinballImages, disc: Disc, turn: float) -> bool:
    """True if one bounce, turned back by `turn` radians, is proved to contract the closed disc into its interior.

    Then the turned-back map has one fixed point in the disc, and every orbit in the disc converges to it.
    """
    (x, y), (width, height) = disc.centre, disc.rectangle
    whole = Boxes.one((x - width, x + width), (y - height, y + height))
    parts, _ = whole.parts(CUT, CUT)
    ((piece, slopes),) = map.derivatives(parts)  # one component has one piece
    if not np.array_equal(piece.on, np.arange(CUT * CUT)):
        return False
    found = map.images(Boxes.one((x, x), (y, y)))
    if found.lost.size:
        return False
    off = []
    for (low, high), middle in zip((found.boxes.x, found.boxes.y), (x, y), strict=True):
        at = BallArray((low + high) / 2, (high - low) / 2 * (1 + SLACK) + 1e-15)
        off.append(at - middle)
    off[0] = off[0] - BallArray(turn, 1e-14)
    off[0] = off[0] - BallArray(2 * np.pi * np.rint(off[0].m / (2 * np.pi)), 1e-14)
    axes = [[BallArray(x) for x in row] for row in disc.inverse]
    (e, f), (g, h) = in_frame(disc.inverse, times(matrix(slopes), axes))
    norm = float(np.max(_length(e + h, g - f) + _length(e - h, f + g))) / 2 * (1 + SLACK)
    (u, _), (v, _) = in_frame(disc.inverse, [[each, each] for each in off])
    return bool(norm < 1 and norm * disc.radius + float(np.max(_length(u, v))) < disc.radius * (1 - SLACK))


def _length(x: BallArray, y: BallArray) -> Array:
    """Upper bounds of the Euclidean lengths of vectors."""
    return np.asarray(np.hypot(x.magnitude(), y.magnitude()) * (1 + SLACK))


def enters(scene: Scene, lam: Fraction, start: tuple[arb, arb], disc: Disc, turns: Sequence[Fraction]) -> bool:
    """True if the orbit of a phase point, followed in balls, is proved to enter the disc or a rotated copy of it."""
    map = EnclosedMap(PinballMap(scene, lam=float(lam)), lam, BITS)
    (a, b), (c, d) = disc.inverse
    for here in map.orbit(map.start(*start), MOST_BOUNCES):
        with working(BITS):
            pi, det = arb.pi(), arb(a) * d - arb(b) * c
            y = here.phi - disc.centre[1]
            for turn in turns:
                x = here.theta - disc.centre[0] - 2 * pi * fmpq(turn.numerator, turn.denominator)
                x -= 2 * pi * round(float(x.mid()) / (2 * np.pi))
                if ((d * x - b * y) / det) ** 2 + ((a * y - c * x) / det) ** 2 < arb(disc.radius) ** 2:
                    return True
    return False


def entered_around(found: "CommonBoundary", which: int, theta: Fraction, phi: Fraction) -> bool:
    """True if all orbits from a small box around a point are proved to enter the disc `which` or a rotated copy."""
    with working(BITS):
        x, y = (fraction_ball(value) + arb(0, SMALL) for value in (theta, phi))
    return enters(found.scene, found.lam, (x, y), found.discs[which], found.turns)


@dataclass(frozen=True)
class CommonBoundary(Theorem):
    """The stable manifold of a saddle lies on the boundary of the basins of two attracting cycles.

    Each cycle, and the saddle, repeats after one bounce and a rotation of the table. The two `starts` are points of the
    branch of the unstable manifold on one `side` (1 or -1), as numbers from 0 to 1 along the piece from a point to its
    image. The `sinks` are two phase points `(theta, phi)`. The orbit of the first start enters the disc of this
    `radius` around the first sink, and the orbit of the second start the disc around the second. `turn` has, for each
    sink, the fraction of a full turn by which a bounce rotates the cycle.
    """

    scene: Scene
    lam: Fraction
    saddle: SaddleCycle
    side: int
    starts: tuple[float, float]
    sinks: tuple[tuple[float, float], tuple[float, float]]
    turn: tuple[Fraction, Fraction]
    radius: float = 0.008

    def __post_init__(self) -> None:
        law = self.scene.law
        if len(self.scene.table.components) != 1 or not law.uniform:
            raise ValueError(
                f"boundary: {self.scene.name} is out of range; accepted: one smooth closed curve, phi = -lam*eta"
            )
        turns = self.turns
        for part in (*self.turn, Fraction(*self.saddle.closure.shift)):
            if part % 1 not in turns or len(self.saddle.start) != 1 or self.saddle.closure.turn != 1:
                wanted = (
                    f"a turn by {part} must be a symmetry of {self.scene.name}, the saddle fixed by a bounce and a turn"
                )
                raise ValueError(f"boundary: {wanted}")
        if self.side not in (1, -1) or not 0 < self.lam < 1:
            raise ValueError(f"boundary: side = {self.side}, lam = {self.lam}; accepted: side 1 or -1, 0 < lam < 1")

    @property
    def turns(self) -> tuple[Fraction, ...]:
        """The rotations that map the table to itself, as fractions of a full turn, 0 included."""
        kept = {Fraction(*g.shift) % 1 for g in symmetries(self.scene.table) if g.turn == 1}
        return tuple(sorted({Fraction(0)} | kept))

    @cached_property
    def map(self) -> PinballImages:
        """The enclosing map on boxes; `ValueError` unless the table is proved convex."""
        return PinballImages(self.scene, (self.lam, self.lam))

    @cached_property
    def discs(self) -> tuple[Disc, Disc]:
        """The discs around both sinks."""
        return disc(self.map, self.sinks[0], self.radius), disc(self.map, self.sinks[1], self.radius)

    @cached_property
    def plane(self) -> Pinball:
        """The map, given by its collision rule and composed with the rotation by which the saddle repeats."""
        return Pinball(self.scene.table, turn=self.saddle.closure.shift[1])

    @cached_property
    def branch(self) -> ManifoldSeries | None:
        """The enclosed unstable manifold of the saddle; None if it is not proved."""
        return unstable_branch(self.saddle, self.plane, self.lam, BITS)

    @hypothesis
    def smooth(self) -> Verdict:
        """The table is one convex analytic curve."""
        return smooth(self.plane)

    @hypothesis(name="discs")
    def discs_attract(self) -> bool:
        """Each disc is mapped into itself, up to a rotation of the table, by a contraction in some norm."""
        pairs = zip(self.discs, self.turn, strict=True)
        return all(attracts(self.map, one, 2 * np.pi * float(turn)) for one, turn in pairs)

    @hypothesis
    def apart(self) -> bool:
        """The discs have no exit angle in common; rotated copies have the same exit angles."""
        low, high = sorted((one.centre[1], one.rectangle[1]) for one in self.discs)
        return low[0] + low[1] < high[0] - high[1]

    @hypothesis(name="saddle")
    def saddle_exists(self) -> bool:
        """The saddle exists, and its unstable manifold is a series with a bounded remainder."""
        return self.branch is not None

    @hypothesis
    def first(self) -> bool:
        """An orbit on the unstable manifold enters the first disc."""
        return self._enters(0)

    @hypothesis
    def second(self) -> bool:
        """An orbit on the unstable manifold enters the second disc."""
        return self._enters(1)

    def _enters(self, which: int) -> bool:
        start = [self.starts[which]]
        (point,) = self.branch.points(self.side, start, start) if self.branch else (None,)
        return point is not None and enters(self.scene, self.lam, point, self.discs[which], self.turns)
