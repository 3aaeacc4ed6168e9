"""Points next to which both of two basins lie: orbits along a saddle's unstable manifold go to either of two cycles.

What is proved, at one contraction:

- two discs without a common point are each taken into themselves, up to a turn of the table, by a contraction in a
  norm: each holds one cycle, and every orbit that enters it converges to that;
- of the orbits that leave a saddle along its unstable manifold one enters the one disc, and one the other.

So *each neighbourhood of each point whose orbit converges to the saddle holds open sets of both basins*. Let `x` be
such a point, and take a short curve through it, across the saddle's stable manifold. The table is one convex analytic
curve and `lam > 0`, so that the map is a diffeomorphism onto its image, and the images of the curve stay curves across.
By the inclination lemma they come, as smooth curves, near each compact piece of the unstable manifold, on both sides of
the saddle. Some points of the curve pass near each of the two orbits above, and enter the open discs after them; what
enters an open disc after finitely many bounces is open. The point `x` itself is in neither basin.

So the stable manifold of the saddle lies on the boundary of both basins. Nothing more is said: each basin is open, and
a point of it has a neighbourhood in it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import arb, fmpq
from numpy.typing import NDArray

from numeric import PinballMap
from symbolic.tables.scene import Scene
from verification.arithmetic.arrays import BallArray
from verification.arithmetic.balls import working
from verification.cycles.systems import symmetries
from verification.maps.enclosed import EnclosedMap
from verification.proofs.global_dynamics.boxes import Boxes
from verification.proofs.global_dynamics.branch import unstable_branch
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.proof import smooth
from verification.proofs.manifolds.saddle import Orbit

Array = NDArray[np.float64]
BITS = 320  # of the balls that follow an orbit
MOST_BOUNCES = 100
SMALL = 1e-80  # radians about a start, in either coordinate
CUT = 24  # parts of a disc's rectangle each way, over each of which the derivative is enclosed
SLACK = 1e-9  # more than some dozen roundings of doubles, relatively
CHECKS = ("smooth", "discs", "apart", "saddle", "first", "second")


@dataclass(frozen=True)
class Disc:
    """The phase points `centre + inverse*u` with `|u| < radius`; `centre` is `(theta, phi)`."""

    centre: tuple[float, float]
    inverse: tuple[tuple[float, float], tuple[float, float]]
    radius: float

    @property
    def rectangle(self) -> tuple[float, float]:
        """Half of the sides of a rectangle about the disc."""
        (a, b), (c, d) = self.inverse
        return self.radius * float(np.hypot(a, b)) * (1 + SLACK), self.radius * float(np.hypot(c, d)) * (1 + SLACK)


def disc(map: PinballImages, centre: tuple[float, float], radius: float) -> Disc:
    """A disc in the norm in which the derivative at a point off the diameters turns and shrinks; nothing is proved."""
    x, y = (np.array([value]) for value in centre)
    at = Boxes(np.array([0]), (x, x), (y, y))
    (a, b), (c, d) = ((float(np.ravel(x.m)[0]) for x in row) for row in matrix(map.derivatives(at)[0][1]))
    values, vectors = np.linalg.eig(np.array([[a, b], [c, d]]))
    v = vectors[:, 0]
    frame = np.stack([v.real, v.imag], 1) if np.iscomplex(values[0]) else vectors.real
    return Disc(centre, ((float(frame[0, 0]), float(frame[0, 1])), (float(frame[1, 0]), float(frame[1, 1]))), radius)


def attracts(map: PinballImages, disc: Disc, turn: float) -> bool:
    """Is the closed disc taken into its interior by a bounce and a turn back by `turn`, by a contraction in its norm?

    Then there is one fixed point in it, to which every orbit in it converges.
    """
    (x, y), (width, height) = disc.centre, disc.rectangle
    whole = Boxes(np.array([0]), *((np.array([c - h]), np.array([c + h])) for c, h in ((x, width), (y, height))))
    parts, _ = whole.parts(CUT, CUT)
    ((piece, slopes),) = map.derivatives(parts)  # one component has one piece
    if not np.array_equal(piece.on, np.arange(CUT * CUT)):
        return False
    found = map.images(Boxes(np.array([0]), (np.array([x]),) * 2, (np.array([y]),) * 2))
    if found.lost.size:
        return False
    off = []
    for (low, high), middle in zip((found.boxes.x, found.boxes.y), (x, y), strict=True):
        at = BallArray((low + high) / 2, (high - low) / 2 * (1 + SLACK) + 1e-15)
        off.append(at - middle)
    off[0] = off[0] - BallArray(turn, 1e-14)
    off[0] = off[0] - BallArray(2 * np.pi * np.rint(off[0].m / (2 * np.pi)), 1e-14)
    (a, b), (c, d) = disc.inverse
    det = BallArray(a) * d - BallArray(b) * c
    frame = (BallArray(d) / det, BallArray(-b) / det), (BallArray(-c) / det, BallArray(a) / det)
    (m, n), (p, q) = matrix(slopes)
    inner = (m * a + n * c, m * b + n * d), (p * a + q * c, p * b + q * d)
    (e, f), (g, h) = ([row[0] * inner[0][j] + row[1] * inner[1][j] for j in (0, 1)] for row in frame)
    norm = float(np.max(_length(e + h, g - f) + _length(e - h, f + g))) / 2 * (1 + SLACK)
    moved = [row[0] * off[0] + row[1] * off[1] for row in frame]
    return bool(norm < 1 and norm * disc.radius + float(np.max(_length(*moved))) < disc.radius * (1 - SLACK))


def _length(x: BallArray, y: BallArray) -> Array:
    """A bound for the length of vectors."""
    return np.asarray(np.hypot(x.magnitude(), y.magnitude()) * (1 + SLACK))


def enters(scene: Scene, lam: Fraction, start: tuple[arb, arb], disc: Disc, turns: Sequence[Fraction]) -> bool:
    """Does the orbit of a phase point enter the disc, or a turned copy? Followed in balls, each landing a first hit."""
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
    """Do all orbits from a small disc about a phase point enter the one of the two discs, or a turned copy?"""
    with working(BITS):
        x, y = (arb(fmpq(value.numerator, value.denominator)) + arb(0, SMALL) for value in (theta, phi))
    return enters(found.scene, found.lam, (x, y), found.discs[which], found.turns)


@dataclass(frozen=True)
class CommonBoundary:
    """The stable manifold of a saddle lies on the boundary of the basins of two attracting cycles.

    A round of each is one bounce and a turn of the table. On the unstable manifold's branch on one `side` of the
    saddle orbits begin at `starts`, each from 0 to 1 on a piece from a point to its image; the first enters a disc
    of the given `radius` about the first of the `sinks`, phase points `(theta, phi)`, and the second that about the
    second. `turn` is, for each sink, the part of a turn that a bounce makes.
    """

    scene: Scene
    lam: Fraction
    saddle: Orbit
    side: int
    starts: tuple[float, float]
    sinks: tuple[tuple[float, float], tuple[float, float]]
    turn: tuple[Fraction, Fraction]
    radius: float = 0.008

    def __post_init__(self) -> None:
        law = self.scene.law
        if len(self.scene.table.components) != 1 or not law.uniform:
            raise ValueError(f"boundary: {self.scene.name}; accepted: one smooth closed curve under phi = -lam*eta")
        turns = self.turns
        for part in (*self.turn, Fraction(*self.saddle.closure.shift)):
            if part % 1 not in turns or len(self.saddle.start) != 1 or self.saddle.closure.turn != 1:
                raise ValueError(f"boundary: {part} of a turn a bounce is no symmetry of the table {self.scene.name}")
        if self.side not in (1, -1) or not 0 < self.lam < 1:
            raise ValueError(f"boundary: side = {self.side} or lam = {self.lam} is out of range; lam is in (0, 1)")

    @property
    def turns(self) -> tuple[Fraction, ...]:
        """The turns that keep the table, as parts of a whole one."""
        kept = {Fraction(*g.shift) % 1 for g in symmetries(self.scene.table) if g.turn == 1}
        return tuple(sorted({Fraction(0)} | kept))

    @cached_property
    def map(self) -> PinballImages:
        """The map in boxes; `ValueError` unless the table is proved convex."""
        return PinballImages(self.scene, (self.lam, self.lam))

    @cached_property
    def discs(self) -> tuple[Disc, Disc]:
        """About both sinks."""
        return disc(self.map, self.sinks[0], self.radius), disc(self.map, self.sinks[1], self.radius)

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        found: dict[str, bool | None] = dict.fromkeys(CHECKS)
        plane = Pinball(self.scene.table, turn=self.saddle.closure.shift[1])
        found["smooth"] = smooth(plane)
        pairs = list(zip(self.discs, self.turn, strict=True))
        found["discs"] = all(attracts(self.map, one, 2 * np.pi * float(turn)) for one, turn in pairs) or None
        found["apart"] = self._apart() or None
        try:
            branch = unstable_branch(self.saddle, plane, self.lam, BITS)
            found["saddle"] = True
            for name, start, (one, _) in zip(("first", "second"), self.starts, pairs, strict=True):
                (point,) = branch.points(self.side, [start], [start])
                found[name] = enters(self.scene, self.lam, point, one, self.turns) or None
        except (ValueError, ArithmeticError):
            pass
        return found

    def _apart(self) -> bool:
        """Do exit angles tell the discs apart? Turned copies have the same."""
        low, high = sorted((one.centre[1], one.rectangle[1]) for one in self.discs)
        return low[0] + low[1] < high[0] - high[1]

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())
