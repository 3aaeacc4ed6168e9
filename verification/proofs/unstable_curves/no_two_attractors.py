"""No two attractors in a region, and a transitive set in any: growth, crossing, and contraction along stable curves.

*Lemma.* Let a map `T` be continuous and one-to-one on a compact set `R` that it takes into its interior; `R` lies
in charts joined end to end, inside each of which `T` is smooth with a determinant that is not 0 up to the lines
that are mapped to joins. Suppose that

1. each cell of `R` has a cone of slopes, with an inside, that derivatives take into the cones of the cells to which
   edges lead (`cones`);
2. every unstable curve in `R` has an image with a smooth part that crosses a column of cells (`growth`);
3. every unstable curve that crosses a column has an image that crosses the rectangle `Q` of a saddle cycle `p`
   (`crossing`);
4. every unstable curve that crosses `Q` meets the stable set of `p`, and its images come near all of the unstable
   manifold in `Q` (`saddle`).

Let `A` be the closure of `W^u(p)`, the manifold of all points of the cycle. Then `T(A) = A`, and `T` on `A` is
topologically transitive; the starts in `R` that converge to the cycle are dense in `R`; and every closed set `B` that
holds an open part of `R` with `T(B)` in `B`, or to which every start of an open part of `R` converges, contains `A`.
So `R` holds at most one *attractor*: a closed set, transitive, to which all starts near it converge. If, besides,

5. each orbit in `R` comes, again and again, to places where a stable curve that does not turn back meets `A`
   (`visits`),

then a start whose stable curve at one of these places meets `A` before it turns back converges to `A`. That every
start does, so that `A` attracts all of `R`, does not follow: a stable curve turns back at preimages of joins.

*Proof.* An open part of `R` holds an unstable curve, as cones have an inside. By 2 to 4 its images cross `Q` again
and again, hold points of the stable set of `p`, and come near all of `W^u(p)` in `Q`; as `T` is continuous,
near all of `W^u(p)`, which is the union of images of that. Whatever is closed, and holds these images or their
limits (by Baire, some start of the open part has an orbit that comes near each point of `W^u(p)`), contains `A`. If
the open set meets `A`, it holds a piece of `W^u(p)`, an unstable curve but for corners, whose images stay in `A`:
so they come near any other open part of `A`, which is transitivity. Of two attractors either contains `A`, so some
dense orbit of the one comes near the other, and converges to it: the one lies in the other. What meets a stable curve
of a start has its limit set (`attraction`).

At the joins `T` has no derivative and nothing is asked of it there but that it is continuous: curves are cut there
for the sake of counting only. If `R` holds the mirror image of `p` on a table that has one, `A` is its own: of the
two cycles either's unstable manifold is an unstable curve that comes near all of the other's. `T` may permute pieces
of `A`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from verification.proofs.global_dynamics import Boxes
from verification.proofs.unstable_curves.anchor import Anchor, anchor
from verification.proofs.unstable_curves.attraction import attraction
from verification.proofs.unstable_curves.cover import Cover, JoinedMap, cover
from verification.proofs.unstable_curves.growth import Growth, growth
from verification.proofs.unstable_curves.spans import Course, longest

LONGEST, BRANCHES = 80, 8  # bounces until a curve crosses the rectangle, and its parts that are followed
REFUSED = {
    "continuous": "the map is not known to be continuous and one-to-one, on charts joined end to end",
    "cones": "no region with cones was found",
    "growth": "the sum of inverse stretches does not come below 1: folds may undo what stretching does",
    "saddle": "the rectangle about the cycle is not proved to be crossed again by what crosses it",
    "crossing": "some curve that crosses a column is not seen to come to the rectangle",
    "visits": "some orbit is not seen to come again and again to where stable curves may meet the unstable manifold",
}


@dataclass(frozen=True)
class NoTwoAttractors:
    """The region that grows from `start` on a grid, and a saddle `(chart, theta, phi)` of a period in it.

    `half` is half the width of its rectangle, `around` how many cells the wide region reaches beyond the narrow one.
    """

    map: JoinedMap
    columns: int
    rows: int
    start: Boxes
    saddle: tuple[int, float, float]
    period: int
    half: float
    around: int = 16

    @cached_property
    def region(self) -> Cover | str:
        """The narrow region, in which curves grow."""
        return cover(self.map, self.columns, self.rows, self.start)

    @cached_property
    def wide(self) -> Cover | str:
        """The wide region, in which stable curves lie."""
        return cover(self.map, self.columns, self.rows, self.start, around=self.around)

    @cached_property
    def growth(self) -> Growth | None:
        """The sums of inverse stretches."""
        return None if isinstance(self.region, str) else growth(self.region)

    @cached_property
    def anchor(self) -> Anchor | None:
        """The rectangle about the saddle."""
        return None if isinstance(self.region, str) else anchor(self.region, self.saddle, self.period, self.half)

    @cached_property
    def astray(self) -> int | None:
        """Of how many cells curves that cross their columns are not seen to come to the rectangle."""
        if isinstance(self.region, str) or self.anchor is None:
            return None
        return int(np.sum(~crossing(self.region, self.anchor)))

    @cached_property
    def needed(self) -> dict[str, bool | None]:
        """What the hypotheses 1 to 4 ask for, item by item; None where it is not proved."""
        grown = self.growth is not None and self.growth.bounces is not None
        return {
            "continuous": continuous(self.map) or None,
            "cones": not isinstance(self.region, str) or None,
            "growth": grown or None,
            "saddle": self.anchor is not None or None,
            "crossing": self.astray == 0 or None,
        }

    @cached_property
    def checks(self) -> dict[str, bool | None]:
        """All that is proved; the last, which adds chances to converge to it, is not needed for what `proved` says."""
        region, wide, at = self.region, self.wide, self.anchor
        known = not (isinstance(region, str) or isinstance(wide, str) or at is None) and self.astray == 0
        chances = known and attraction(region, wide, at).proved  # type: ignore[arg-type]
        return self.needed | {"visits": chances or None}

    @property
    def proved(self) -> bool:
        """Do the hypotheses 1 to 4 hold? Then the region holds at most one attractor."""
        return all(self.needed.values())

    @property
    def reason(self) -> str:
        """What is missing, in words; of several the first."""
        for name, held in self.needed.items():
            if not held:
                why = self.region if name == "cones" and isinstance(self.region, str) else REFUSED[name]
                return f"{self.map.label}: {why}"
        return f"{self.map.label}: at most one attractor in the region; the closure of an unstable manifold is in it"


def continuous(map: JoinedMap) -> bool:
    """Is the map continuous and one-to-one, with a determinant that is not 0 where it is smooth?

    Each chart has to be joined to the next one, at the same heights.
    """
    count, joins = len(map.charts), set(map.joins)
    if joins - {(count - 1, 0)} != {(i, i + 1) for i in range(count - 1)} or len({c.y for c in map.charts}) > 1:
        return False
    return map.homeomorphism


def crossing(region: Cover, at: Anchor) -> NDArray[np.bool_]:
    """For each cell: has every unstable curve that crosses its column from there an image across the rectangle?"""
    course = Course(region)
    spans = course.columns()
    done = np.zeros(region.cells.chart.size, dtype=bool)
    for _ in range(LONGEST):
        done[spans.origin[spans.crossing(at.chart, at.low, at.high)]] = True
        spans = longest(spans.chosen(~done[spans.origin]), BRANCHES)
        if not spans.chart.size:
            break
        spans = course.step(spans)
    return done
