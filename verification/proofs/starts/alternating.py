"""Strips of two basins, in turn, next to all of a saddle's stable manifold, on the cuspless table.

What is proved, at one contraction between `lambda*` and `lambda_c`:

- the vertical orbit of period 2 is a saddle, and its unstable manifold is a power series, with a bound for the rest;
  all chords of that series have their ends on the arc, so they are flights, the table being convex;
- all of a core about the horizontal orbit converges to it (`core`);
- a polygon about the orbit through both corners is taken into its interior (`verification.proofs.corner.half_return`),
  and every orbit in it that misses the joins has a positive exponent;
- of the orbits that leave the saddle along its unstable manifold one enters the core and one the polygon. Both are
  followed in balls until then, each landing a first hit inside a component, so near each the map is a diffeomorphism.

So *on each smooth curve that crosses the saddle's stable manifold, and is not tangent to it, infinitely many intervals,
of the one basin and of the other in turn, come to the point of crossing*. Let `x` be that point, with an orbit that
misses the joins. For `lam > 0` the map is a diffeomorphism near each of its bounces, so the images of the curve are
curves across, and by
the inclination lemma they come near each compact piece of the unstable manifold, as smooth curves. Each piece from a
point to its image under two bounces holds a point of either orbit, and what follows that orbit into the core or the
polygon is open. What part of the curve comes there after `2*n` bounces shrinks to `x` as `n` grows.

So each neighbourhood of a point of the stable manifold holds open sets of both basins, infinitely many of each. Both
basins are open, and nothing is said of points elsewhere. Paper: section 5.2, at `lam = 9/100`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import pi

from flint import arb, fmpq

from numeric import PinballMap
from symbolic import Scene, tables
from verification.arithmetic.balls import working
from verification.maps.enclosed import EnclosedMap
from verification.maps.exact import Bounce
from verification.proofs.corner.border_collision import holds
from verification.proofs.corner.corner import ARC, WALL, corner_parameters, enclosed
from verification.proofs.corner.half_return import Step, limit, step
from verification.proofs.global_dynamics.branch import Branch, unstable_branch
from verification.proofs.global_dynamics.images import PinballImages
from verification.proofs.manifolds.plane_map import Pinball
from verification.proofs.manifolds.saddle import Orbit
from verification.proofs.starts.core import Core, attracts

VERTICAL = Orbit("vertical orbit", (pi / 3, -pi / 3))
STARTS = 0.6, 0.9  # on the unstable manifold: towards the core, and towards the polygon
WIDE = 1e-5  # of the stretch of contractions about the one, for which the polygon is proved
BITS, MOST_BOUNCES = 320, 100
CHECKS = "saddle", "core", "polygon", "first", "second"


@dataclass(frozen=True)
class Alternating:
    """That strips of both basins alternate next to the stable manifold of the vertical orbit, at one contraction.

    On one side of the saddle orbits begin at `starts`, each from 0 to 1 on a piece of the unstable manifold from a
    point to its image under two bounces; the first enters the `core`, the second the polygon.
    """

    lam: Fraction
    core: Core
    starts: tuple[float, float] = STARTS
    side: int = 1

    def __post_init__(self) -> None:
        if self.side not in (1, -1) or not all(0 <= start <= 1 for start in self.starts):
            given = f"side = {self.side}, starts = {self.starts}"
            raise ValueError(f"strips: {given}; accepted: side 1 or -1, starts 0 to 1")

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """What is proved, item by item; None where nothing is."""
        found: dict[str, bool | None] = dict.fromkeys(CHECKS)
        images = PinballImages(Scene("cuspless"), (self.lam, self.lam))
        found["core"] = all(attracts(images, self.core).values()) or None
        found["polygon"] = self.polygon is not None or None
        try:
            branch = unstable_branch(VERTICAL, Pinball(tables.cardioid), self.lam, BITS)
        except (ValueError, ArithmeticError):
            return found
        if not on_the_arc(branch):
            return found
        found["saddle"] = True
        for name, start, inside in zip(("first", "second"), self.starts, (self.in_core, self.in_polygon), strict=True):
            (point,) = branch.points(self.side, [start], [start])
            found[name] = self._comes(point, inside) or None
        return found

    @property
    def proved(self) -> bool:
        """Is all of it proved?"""
        return all(value is True for value in self.checks.values())

    @cached_property
    def polygon(self) -> Step | None:
        """The trapping polygon, in units of `lam - lambda*`; None where it is not proved."""
        with working(BITS):
            e = float((arb(fmpq(self.lam.numerator, self.lam.denominator)) - enclosed()[1]).mid())
            found = step(limit(), (e - WIDE, e + WIDE)) if e > WIDE else None
        return found and found[1]

    def in_core(self, before: Bounce, here: Bounce) -> bool:
        """Is a bounce in the core or one of its gates?"""
        if here.component != self.core.chart:
            return False
        off = abs(here.phi - (self.core.slope + self.core.cubic * here.theta**2) * here.theta)
        sizes = ((self.core.outer, self.core.width), *self.core.gates)
        return any(bool(abs(here.theta) < outer) and bool(off < width) for outer, width in sizes)

    def in_polygon(self, before: Bounce, here: Bounce) -> bool:
        """Are two successive bounces those of a point of the polygon, or of its mirror image?

        Its coordinates are those of `half_return`: from the arc at `-theta1 + e*u` to `e*v` beyond the upper corner.
        """
        if self.polygon is None or before.component != ARC or here.component not in (ARC, WALL):
            return False
        theta1, star = enclosed()
        e = arb(fmpq(self.lam.numerator, self.lam.denominator)) - star
        corner = corner_parameters()[here.component]
        for sign in (1, -1):
            point = (sign * before.theta + theta1) / e, (sign * here.theta - corner) / e
            if holds(self.polygon.region, point):
                return True
        return False

    def _comes(self, point: tuple[arb, arb], inside: Callable[[Bounce, Bounce], bool]) -> bool:
        """Does the orbit of a phase point come there? Each landing is proved to be the first hit, off the joins."""
        map = EnclosedMap(PinballMap("cuspless", lam=float(self.lam)), self.lam, BITS)
        before = map.start(*point)
        for here in map.orbit(before, MOST_BOUNCES):
            with working(BITS):
                if inside(before, here):
                    return True
            before = here
        return False


def on_the_arc(branch: Branch) -> bool:
    """Do all chords of the series, for `abs(z) <= 1`, end on the arc? It is the cardioid's, and the table is convex."""
    with working(BITS):
        last = corner_parameters()[ARC]
        series = [jet.c for jet in branch.series.pair()]
        return all(bool(sum(map(abs, c), branch.error) < last) for c in series)
