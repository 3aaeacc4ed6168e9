"""The boundary of a basin above a barrier: the stable manifold of one saddle, a smooth curve.

Let the table be one smooth closed convex curve with a barrier, a closed curve around phase space that the map takes
below itself. Above it there are an attracting cycle with a disc in its basin, and a saddle; both repeat after one
bounce and a rotation of the table by `1/turns` of a full turn. The hypotheses are those of `BasinEdge`. Let `S` be the
set of starts whose orbits neither come below the barrier nor enter the disc. The orbit of such a start is an infinite
walk in the graph of cells, so from some bounce on it stays in the cells around the saddle, to which no walk returns
after leaving. There the difference between orbit and saddle does not grow, hence it shrinks, and the orbit converges to
the saddle. Conversely, orbits that converge to the saddle start in `S`. So *`S` is the stable manifold of the saddle*.
It is closed, since the other starts form two disjoint open sets: the basin of the cycle, and the starts whose orbits
come below the barrier.

*It is an embedded curve, as smooth as the map.* Let the orbit of `x` in `S` be in the interior of the cells around the
saddle from bounce `n` on. Points of `S` near `x` are in these cells at bounce `n` too, and stay there, since orbits
that leave never return and are not in `S`. So near `x` the set `S` is the preimage of the local stable manifold under a
diffeomorphism.

*The basin's boundary is a union of whole components of `S`.* The boundary lies in `S`. Each side of a short arc of `S`
lies in one of the two open sets, so all of the arc belongs to the boundary, or none. Nothing is proved below the
barrier. The theorem holds for each contraction `lam > 0` of a range; its hypotheses are strict inequalities, so it
holds for all nearby shapes and contractions too.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import acb, arb

from verification.arithmetic.arrays import Array, BallArray, Mask
from verification.arithmetic.balls import balls, fraction_ball, working
from verification.proofs.global_dynamics.barrier import Barrier
from verification.proofs.global_dynamics.common_boundary import Disc, attracts, disc
from verification.proofs.global_dynamics.flights import matrix
from verification.proofs.manifolds.enclosed import TooWideError, complex_balls, enclosed_saddle
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.rigorous.boxes import Boxes, Turned
from verification.rigorous.graph import LARGEST, Grid, refined
from verification.rigorous.norms import in_frame, times
from verification.rigorous.theorem import Theorem, hypothesis

BITS = 128
CELLS, COARSEST = (65536, 65536), 1024  # columns and rows of a rotation's share; size of the first blocks
PARTS = 2  # each cell is cut into PARTS by PARTS before it is mapped
NEAR, WITHIN = 4e-4, 1e-3  # half the sides of two squares around the saddle, in radians
CUT = 4  # the larger square is cut into CUT by CUT parts to enclose the derivative
SLACK = 1e-9  # relative; more than the rounding of a dozen operations


@dataclass(frozen=True)
class BasinEdge(Theorem):
    """The basin of a cycle above a barrier ends at the stable manifold of a saddle.

    `sink` is a phase point `(theta, phi)` of the cycle, which attracts a disc of `radius`. A bounce rotates the cycle
    and the saddle by `1/turns` of a full turn.
    """

    barrier: Barrier
    sink: tuple[float, float]
    saddle: SaddleCycle
    radius: float

    def __post_init__(self) -> None:
        closure, turns = self.saddle.closure, self.barrier.turns
        if turns < 2 or closure.turn != 1 or closure.shift != (1, turns) or len(self.saddle.start) != 1:
            raise ValueError(f"edge: the {self.saddle.name} must be a fixed point of the map, up to a rotation")

    @property
    def turn(self) -> float:
        """The angle by which a bounce rotates the cycle and the saddle, in radians."""
        return 2 * np.pi / self.barrier.turns

    @hypothesis(name="barrier")
    def barrier_holds(self) -> bool:
        """Orbits that come below the barrier stay below it."""
        return self.barrier.heights is not None

    @cached_property
    def disc(self) -> Disc:
        """The disc around the sink."""
        return disc(self.barrier.map, self.sink, self.radius)

    @cached_property
    def place(self) -> tuple[float, float] | None:
        """The phase point of the saddle, enclosed much closer than `NEAR` for all contractions; None if not proved."""
        with working(BITS):
            low, high = (fraction_ball(x) for x in self.barrier.lam)
            map = Pinball(self.barrier.map.map.table, turn=self.barrier.turns)
            try:
                here = enclosed_saddle(self.saddle, map.over(complex_balls(BITS)), acb(low.union(high))).points[0].real
            except (TooWideError, ArithmeticError):
                return None
            after = here + 2 * arb.pi() / self.barrier.turns
            phi = map.over(balls(BITS)).angle(here, after)[0]
            close = here.rad() < NEAR / 4 and phi.rad() < NEAR / 4
            return (float(here.mid()), float(phi.mid())) if close else None

    @hypothesis(name="disc")
    def disc_attracts(self) -> bool:
        """All orbits that enter the disc converge to the cycle, and the disc lies above the barrier."""
        sides = zip(self.disc.centre, self.disc.rectangle, strict=True)
        about = Boxes.one(*((c - half, c + half) for c, half in sides))
        return attracts(self.barrier.map, self.disc, self.turn) and bool(np.all(self.barrier.above(about)))

    @hypothesis(name="saddle")
    def saddle_exists(self) -> bool:
        """The saddle exists, within `NEAR` of one phase point for all contractions."""
        return self.place is not None

    def _about(self, half: float) -> Boxes:
        assert self.place is not None
        return Boxes.one(*((c - half, c + half) for c in self.place))

    @hypothesis
    def hyperbolic(self) -> bool:
        """Differences `(u, v)` near the saddle are mapped to `(u', v')` with `|u'| > max(|u|, |v'|)` if `|u| >= |v|`,
        and with `|v'| < |v|` if not.
        """
        if self.place is None:
            return False
        parts, _ = self._about(WITHIN).parts(CUT, CUT)
        ((piece, slopes),) = self.barrier.map.derivatives(parts)
        if not np.array_equal(piece.on, np.arange(CUT * CUT)):
            return False
        entries = matrix(slopes)
        middle = np.array([[float(np.mean(x.m)) for x in row] for row in entries])
        values, vectors = np.linalg.eig(middle)
        if np.any(np.iscomplex(values)):  # since NumPy 2.5 the type is always complex
            return False
        frame = vectors.real[:, np.argsort(-np.abs(values))].tolist()
        (uu, uv), (vu, vv) = in_frame(frame, times(entries, [[BallArray(x) for x in row] for row in frame]))
        one_sign = bool(np.all(uu.positive()) or np.all(uu.negative()))  # means along segments are not 0
        grown = np.min(np.abs(uu.m) - uu.r - uv.magnitude())
        shrunk = np.max(vu.magnitude() + vv.magnitude())
        far = np.max(entries[0][0].magnitude() + entries[0][1].magnitude()) * 2 * WITHIN
        return bool(one_sign and grown > 1 + SLACK and shrunk < 1 - SLACK and far < self.turn / 2)

    @hypothesis
    def alone(self) -> bool:
        """Of the cells above the barrier and outside the disc, only those at the saddle lie on closed walks.

        Cells are taken modulo rotations. Those at the saddle lie in the larger square, cover the smaller one, and no
        walk that leaves them returns.
        """
        if self.place is None or not np.all(self.barrier.above(self._about(NEAR))):
            return False
        map = Turned(self.barrier.map, self.barrier.turns)
        grid = Grid(map.charts, *CELLS, most=LARGEST**2)
        graph = refined(map, grid, COARSEST, PARTS, absorbed=self._absorbed, joint=self._meets)
        boxes = grid.boxes(graph.cells)
        near = graph.leaf & self._meets(boxes)
        some = np.append(near | graph.leaf & graph.recurrent[:-1], False)
        if np.any(self._absorbed(boxes.chosen(near))) or not graph.complete(some):
            return False  # the saddle may lie below the barrier
        return np.array_equal(graph.connected(some), some) and self._inside(boxes.chosen(some[:-1]))

    def _absorbed(self, boxes: Boxes) -> Mask:
        """A mask of the cells that lie below the barrier, or in the convex disc or a rotated copy of it."""
        (a, b), (c, d) = self.disc.inverse
        det, held = a * d - b * c, np.ones(boxes.chart.size, dtype=bool)
        for theta in boxes.x:
            for phi in boxes.y:
                x, y = self._beside(theta, self.disc.centre[0]), phi - self.disc.centre[1]
                held &= np.hypot((d * x - b * y) / det, (a * y - c * x) / det) < self.radius * (1 - SLACK)
        return held | self.barrier.below(boxes)

    def _meets(self, boxes: Boxes) -> Mask:
        """A mask of the cells that meet the smaller square around the saddle, or a rotated copy of it."""
        assert self.place is not None
        middles = [(low + high) / 2 for low, high in (boxes.x, boxes.y)]
        halves = [(high - low) / 2 for low, high in (boxes.x, boxes.y)]
        off = self._beside(middles[0], self.place[0]), middles[1] - self.place[1]
        return np.asarray((np.abs(off[0]) <= NEAR + halves[0]) & (np.abs(off[1]) <= NEAR + halves[1]))

    def _inside(self, boxes: Boxes) -> bool:
        """True if all cells lie within the larger square around the saddle."""
        assert self.place is not None
        x = [np.abs(self._beside(end, self.place[0])) for end in boxes.x]
        y = [np.abs(end - self.place[1]) for end in boxes.y]
        return bool(boxes.chart.size and np.all(np.concatenate([*x, *y]) < WITHIN * (1 - SLACK)))

    def _beside(self, theta: Array, centre: float) -> Array:
        """Differences of angles from `centre`, modulo the rotations of the table."""
        off = theta - centre
        return np.asarray(off - self.turn * np.rint(off / self.turn))
