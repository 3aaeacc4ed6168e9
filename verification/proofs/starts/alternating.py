"""Two basins alternate along every curve that crosses the stable manifold of a saddle, on the cuspless table.

The hypotheses of `Alternating` are proved at one contraction between `lambda*` and `lambda_c`. The table is convex, so
chords are flights; the polygon is that of `verification.proofs.corner.half_return`, in which every orbit that misses
the joins has a positive exponent, and the *core* is a tube around the horizontal orbit. Two orbits that leave the
saddle are followed in balls. Each landing is proved to be a first hit inside a component, so the map is a
diffeomorphism near the orbits. So *on each smooth curve that crosses the saddle's stable manifold transversally,
infinitely many intervals of the two basins, alternately, accumulate at the crossing*. Proof: let `x` be the crossing,
with an orbit that misses the joins. For `lam > 0` the map is a diffeomorphism near each of its bounces, so images of
the curve are transverse curves, which converge to each compact piece of the unstable manifold by the inclination lemma.
Each piece from a point to its image under two bounces holds a point of each of the two orbits, and following that orbit
into the tube or the polygon is an open condition. The part of the curve that does so after `2*n` bounces shrinks to `x`
as `n` grows.

So each neighbourhood of a point of the stable manifold holds open sets of both basins, infinitely many of each. Nothing
is proved about other points. Paper: section 5.2, at `lam = 9/100`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import pi

from numeric import PinballMap
from symbolic import Scene, tables
from verification.arithmetic.balls import fraction_ball, working
from verification.maps.enclosed import EnclosedMap
from verification.maps.exact import Bounce
from verification.proofs.corner.border_collision import holds
from verification.proofs.corner.corner import ARC, WALL, corner_parameters, enclosed
from verification.proofs.corner.half_return import ProvedRange, limit, step
from verification.proofs.global_dynamics.branch import ManifoldSeries, unstable_branch
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import SaddleCycle
from verification.proofs.starts.core import AbsorbingTube, attracts
from verification.rigorous.theorem import Theorem, hypothesis

VERTICAL = SaddleCycle("vertical orbit", (pi / 3, -pi / 3))
STARTS = 0.6, 0.9  # on the unstable manifold: of an orbit to the core, and of one to the polygon
WIDE = 1e-5  # half the width of the range of contractions for which the polygon is proved
BITS, MOST_BOUNCES = 320, 100


@dataclass(frozen=True)
class Alternating(Theorem):
    """Strips of two basins alternate next to the stable manifold of the vertical orbit, at one contraction.

    On one side (1 or -1) of the saddle, two orbits begin at `starts`, numbers from 0 to 1 along a piece of the unstable
    manifold from a point to its image under two bounces; the first enters the `tube`, the second the polygon.
    """

    lam: Fraction
    tube: AbsorbingTube
    starts: tuple[float, float] = STARTS
    side: int = 1

    def __post_init__(self) -> None:
        if self.side not in (1, -1) or not all(0 <= start <= 1 for start in self.starts):
            given = f"side = {self.side}, starts = {self.starts}"
            raise ValueError(f"strips: {given}; accepted: side 1 or -1, starts from 0 to 1")

    @cached_property
    def branch(self) -> ManifoldSeries | None:
        """The enclosed unstable manifold of the saddle; None if it is not proved."""
        return unstable_branch(VERTICAL, Pinball(tables.cardioid), self.lam, BITS)

    @hypothesis
    def saddle(self) -> bool:
        """The vertical orbit is a saddle, and all chords of its unstable manifold's series end on the arc."""
        return self.branch is not None and on_the_arc(self.branch)

    @hypothesis
    def core(self) -> bool:
        """Every orbit in the tube converges to the horizontal orbit."""
        return all(attracts(PinballImages(Scene("cuspless"), (self.lam, self.lam)), self.tube).values())

    @hypothesis(name="polygon")
    def polygon_traps(self) -> bool:
        """A polygon around the orbit through both corners is mapped into its interior."""
        return self.polygon is not None

    @hypothesis
    def first(self) -> bool:
        """The orbit from the first of the starts enters the tube."""
        return self._comes(self.starts[0], self.in_tube)

    @hypothesis
    def second(self) -> bool:
        """The orbit from the second of the starts enters the polygon."""
        return self._comes(self.starts[1], self.in_polygon)

    @cached_property
    def polygon(self) -> ProvedRange | None:
        """The trapping polygon, in units of `lam - lambda*`; None if it is not proved."""
        with working(BITS):
            e = float((fraction_ball(self.lam) - enclosed()[1]).mid())
            found = step(limit(), (e - WIDE, e + WIDE)) if e > WIDE else None
        return found and found[1]

    def in_tube(self, before: Bounce, here: Bounce) -> bool:
        """True if a bounce is proved to lie in the tube or one of its entry tubes."""
        if here.component != self.tube.chart:
            return False
        off = abs(here.phi - (self.tube.slope + self.tube.cubic * here.theta**2) * here.theta)
        sizes = ((self.tube.outer, self.tube.width), *self.tube.entry_tubes)
        return any(bool(abs(here.theta) < outer) and bool(off < width) for outer, width in sizes)

    def in_polygon(self, before: Bounce, here: Bounce) -> bool:
        """True if two successive bounces are proved to be a point of the polygon, or of its mirror image.

        As in `half_return`, the point `(u, v)` stands for a flight from `-theta1 + e*u` to `e*v` beyond the upper
        corner.
        """
        if self.polygon is None or before.component != ARC or here.component not in (ARC, WALL):
            return False
        theta1, star = enclosed()
        e = fraction_ball(self.lam) - star
        corner = corner_parameters()[here.component]
        for sign in (1, -1):
            point = (sign * before.theta + theta1) / e, (sign * here.theta - corner) / e
            if holds(self.polygon.region, point):
                return True
        return False

    def _comes(self, start: float, inside: Callable[[Bounce, Bounce], bool]) -> bool:
        """True if the orbit from a start is proved to come `inside`, with all landings first hits off the joins."""
        if self.branch is None or not self.saddle:
            return False
        (point,) = self.branch.points(self.side, [start], [start])
        map = EnclosedMap(PinballMap("cuspless", lam=float(self.lam)), self.lam, BITS)
        before = map.start(*point)
        for here in map.orbit(before, MOST_BOUNCES):
            with working(BITS):
                if inside(before, here):
                    return True
            before = here
        return False


def on_the_arc(branch: ManifoldSeries) -> bool:
    """True if all chords of the series, for `abs(z) <= 1`, are proved to end on the arc of the cuspless table.

    The series is that of the full cardioid, of which the arc is a part; the table is convex.
    """
    with working(BITS):
        last = corner_parameters()[ARC]
        series = [jet.c for jet in branch.series.pair()]
        return all(bool(sum(map(abs, c), branch.error) < last) for c in series)
