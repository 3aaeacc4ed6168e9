"""The theorem that a trapping region holds at most one attractor, from growth of unstable curves and a saddle.

*Lemma.* Let a map `T` be continuous and one-to-one on a compact set `R` that it takes into its interior; `R` lies in
charts joined end to end; inside each chart `T` is smooth with a nonzero determinant, except on the lines that are
mapped to joins. Suppose that

1. each cell of `R` has a cone of slopes with interior, and derivatives map cones into each other along edges (`cones`);
2. every unstable curve in `R` has an image with a smooth part that crosses a column of cells (`growth`);
3. every unstable curve that crosses a column has an image that crosses the rectangle `Q` of a saddle cycle `p`
   (`crossing`);
4. every unstable curve that crosses `Q` meets the stable set of `p`, and its images come near all points of the
   unstable manifold in `Q` (`saddle`).

Let `A` be the closure of `W^u(p)`, the unstable manifold of the cycle. Then `T(A) = A`, and `T` on `A` is topologically
transitive; the starts in `R` that converge to the cycle are dense in `R`; and every closed set `B` that holds an open
part of `R` with `T(B)` in `B`, or to which every start of an open part of `R` converges, contains `A`. So `R` holds at
most one *attractor*, which means a closed transitive set to which all starts near it converge. It does not follow that
`A` attracts all of `R`: a stable curve may miss `A`, as it may turn back at preimages of joins.

*Proof.* An open part of `R` holds an unstable curve, as cones have interior. By 2 to 4 its images cross `Q` infinitely
often, hold points of the stable set of `p`, and come near all points of `W^u(p)` in `Q`; as `T` is continuous, they
come near all points of `W^u(p)`. Every closed set that holds these images or their limits contains `A` (by Baire, some
start of the open part has an orbit that comes near each point of `W^u(p)`). If the open part meets `A`, it holds a
piece of `W^u(p)`, an unstable curve except for corners, whose images stay in `A`; so they come near any other open part
of `A`, which is transitivity. Two attractors both contain `A`, so a dense orbit of the first comes near the second and
converges to it: each lies in the other.

At the joins `T` is only assumed continuous; curves are cut there for counting only. If the table has a mirror symmetry
and `R` holds the mirror image of `p`, then `A` is its own mirror image, since each of the two unstable manifolds comes
near all points of the other. `T` may permute pieces of `A`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from verification.proofs.unstable_curves.anchor import SaddleRectangle, anchor
from verification.proofs.unstable_curves.cover import ConeField, JoinedMap, cover
from verification.proofs.unstable_curves.growth import CurveGrowth, growth
from verification.proofs.unstable_curves.spans import SpanMap, longest
from verification.rigorous.boxes import Boxes
from verification.rigorous.theorem import Theorem, hypothesis

LONGEST, BRANCHES = 80, 8  # the most bounces until a curve crosses the rectangle; parts of its image that are followed


@dataclass(frozen=True)
class NoTwoAttractors(Theorem):
    """The region that grows from `start` on a grid of `columns` by `rows` cells holds at most one attractor.

    `saddle` is a point `(chart, theta, phi)` of a cycle of `period` bounces in the region; `half` is half the width of
    the rectangle around this point.
    """

    map: JoinedMap
    columns: int
    rows: int
    start: Boxes
    saddle: tuple[int, float, float]
    period: int
    half: float

    @cached_property
    def region(self) -> ConeField | str:
        """The trapping region with its cones; or the reason, in words, why it is not proved."""
        return cover(self.map, self.columns, self.rows, self.start)

    @cached_property
    def growth(self) -> CurveGrowth | None:
        """The bounds of the sums of inverse stretches; None if the region is not proved."""
        return None if isinstance(self.region, str) else growth(self.region)

    @cached_property
    def anchor(self) -> SaddleRectangle | None:
        """The rectangle around the saddle; None if it is not proved."""
        return None if isinstance(self.region, str) else anchor(self.region, self.saddle, self.period, self.half)

    @cached_property
    def astray(self) -> int | None:
        """The number of cells from which curves across the column may miss the rectangle; None without a rectangle."""
        if isinstance(self.region, str) or self.anchor is None:
            return None
        return int(np.sum(~crossing(self.region, self.anchor)))

    @hypothesis
    def continuous(self) -> bool:
        """The map is continuous and one-to-one, on charts joined end to end."""
        return continuous(self.map)

    @hypothesis
    def cones(self) -> bool:
        """Each cell of the region has a cone that derivatives take into the cones of the cells to which edges lead."""
        return not isinstance(self.region, str)

    @hypothesis(name="growth")
    def grows(self) -> bool:
        """The sum of inverse stretches comes below 1: stretching outdoes folds."""
        return self.growth is not None and self.growth.bounces is not None

    @hypothesis(name="saddle")
    def saddle_crossed(self) -> bool:
        """Every unstable curve that crosses the rectangle meets the stable set of the saddle."""
        return self.anchor is not None

    @hypothesis
    def crossing(self) -> bool:
        """Every unstable curve that crosses a column has an image that crosses the rectangle."""
        return self.astray == 0

    @property
    def reason(self) -> str:
        """The conclusion if it is proved, or else the first hypothesis that is not proved, in words."""
        for name, words in self.open.items():
            why = self.region if name == "cones" else f"it is not proved that {words[0].lower()}{words[1:-1]}"
            return f"{self.map.label}: {why}"
        return f"{self.map.label}: at most one attractor in the region; the closure of an unstable manifold is in it"


def continuous(map: JoinedMap) -> bool:
    """True if the map is proved continuous and one-to-one, with nonzero determinant where it is smooth.

    Each chart must be joined to the next one, with the same range of `phi`.
    """
    count, joins = len(map.charts), set(map.joins)
    if joins - {(count - 1, 0)} != {(i, i + 1) for i in range(count - 1)} or len({c.y for c in map.charts}) > 1:
        return False
    return map.homeomorphism


def crossing(region: ConeField, at: SaddleRectangle) -> NDArray[np.bool_]:
    """A mask of the cells from which unstable curves across the column have images that are proved to cross `at`."""
    course = SpanMap(region)
    spans = course.columns()
    done = np.zeros(region.cells.chart.size, dtype=bool)
    for _ in range(LONGEST):
        done[spans.origin[spans.crossing(at.chart, at.low, at.high)]] = True
        spans = longest(spans.chosen(~done[spans.origin]), BRANCHES)
        if not spans.chart.size:
            break
        spans = course.step(spans)
    return done
